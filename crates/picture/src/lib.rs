//! Radiance pictures, float matrices, headers and views.
#![forbid(unsafe_code)]
