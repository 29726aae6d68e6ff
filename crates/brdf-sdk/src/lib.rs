//! A safe Rust layer for authors of BRDF plugins.
