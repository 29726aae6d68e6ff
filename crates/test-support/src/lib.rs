//! What the tests of several crates need.
//!
//! - [`Radiance`]: the real programs, which tests compare with.
//! - [`plugins`]: reflectance models built on the spot, in Rust and in C.
//! - [`bsdf_files`]: BSDF files of every form.
//!
//! Guarantees: a test that cannot run says so and passes, unless the environment says that it must run
//! ([`REQUIRE_RADIANCE`]). Tests alone may depend on this crate, and it knows no other crate of radsight.
#![forbid(unsafe_code)]

pub mod bsdf_files;
pub mod plugins;
mod radiance;
mod random;

pub use radiance::{REQUIRE_RADIANCE, Radiance};
pub use random::Random;
