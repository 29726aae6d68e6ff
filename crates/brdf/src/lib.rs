//! What a reflectance model is, the built-in ones, and their statistical checks.
#![forbid(unsafe_code)]
