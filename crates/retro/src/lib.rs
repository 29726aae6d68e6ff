//! Retroreflector models.
#![forbid(unsafe_code)]
