//! The scene as radsight understands it, and its validation.
#![forbid(unsafe_code)]
