//! Averages radiance over pixel and pinhole.
#![forbid(unsafe_code)]
