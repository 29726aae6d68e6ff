//! The camera file: camera, light ring and sensor, and the ring as scene text.
#![forbid(unsafe_code)]
