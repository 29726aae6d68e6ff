//! Support for the tests of several crates.
//!
//! - [`Radiance`]: the real programs, for comparison.
//! - [`plugins`]: reflectance models built during the tests, in Rust and in C.
//! - [`bsdf_files`]: BSDF files of every form.
//!
//! Guarantees: a test that cannot run prints a note and passes, unless the environment requires it
//! to run ([`REQUIRE_RADIANCE`]). Only tests may depend on this crate, and it depends on no other
//! crate of radsight.
#![forbid(unsafe_code)]

pub mod bsdf_files;
pub mod plugins;
mod radiance;
mod random;

pub use radiance::{REQUIRE_RADIANCE, Radiance};
pub use random::Random;
