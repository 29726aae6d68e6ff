//! Rays and pictures that the renderer makes, against real Radiance, analytic answers and plain sampling.

#[path = "../../crates/measured/tests/support/mod.rs"]
mod bsdf_files;
#[path = "../pictures/mod.rs"]
mod pictures;
#[path = "../program/mod.rs"]
mod program;
#[path = "../real_radiance/mod.rs"]
mod real_radiance;
#[path = "../../crates/brdf-host/tests/support/mod.rs"]
mod support;

mod bsdf;
mod coincident;
mod furnace;
mod interpolated_pictures;
mod light;
mod patterns;
mod plugin_pictures;
mod radiance;
mod rcontrib;
mod retro;
mod rpict;
mod rtrace;
mod scattering;
