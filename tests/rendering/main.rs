//! Rays and pictures of the renderer, compared with real Radiance, analytic answers and plain
//! sampling.

#[path = "../pictures/mod.rs"]
mod pictures;
#[path = "../program/mod.rs"]
mod program;

mod ambient_file;
mod bsdf;
mod coincident;
mod furnace;
mod glints;
mod interpolated_pictures;
mod light;
mod luminaires;
mod modifiers_above;
mod patterns;
mod plugin_pictures;
mod radiance;
mod rcontrib;
mod retro;
mod rpict;
mod rtrace;
mod scattering;
mod textured_normals;
