//! Low-discrepancy sample points, a function of seed, ray, and dimension only.
#![forbid(unsafe_code)]
