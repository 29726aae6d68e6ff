//! Reads Radiance scene text and lowers it to the scene.
#![forbid(unsafe_code)]
