//! Traces rays through a valid scene.
#![forbid(unsafe_code)]
