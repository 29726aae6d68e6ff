//! How surfaces scatter light: the native materials of Radiance, evaluated and sampled.
//!
//! A [`Scatterer`] is a material with its parameters. Given a [`BsdfContext`] it returns a
//! [`SurfaceScattering`]: a [`Bsdf`] for everything that is spread over directions, and at most two
//! perfectly specular rays. [`Bsdf::eval`] gives value and density for a direction;
//! [`Bsdf::sample_highlight`] and [`Bsdf::sample_diffuse`] sample directions with these densities.
//!
//! Guarantees: a sample has the density that `eval` gives; no panic on a
//! [`radsight_ir::ValidScene`]. The crate knows neither geometry nor occlusion. Of light sampling
//! it knows the shape of a lobe ([`radsight_light::Reception`]).
#![forbid(unsafe_code)]

mod ashikhmin;
mod bsdf;
mod context;
mod diffuse_lobe;
mod frame;
mod function_lobe;
mod functions;
mod glossy;
mod lobe_moments;
mod measured;
mod measured_lobe;
mod sample;
mod scatterer;
mod sheet;
#[cfg(test)]
mod sheet_tests;
mod smooth_lobe;
mod specular_threshold;
mod transmission_lobe;
mod ward_function;

pub use ashikhmin::AshikhminKind;
pub use bsdf::{Bsdf, FresnelCoat, Highlight, HighlightShape, colored, model_bands, of_model, pane, sum, through_pane};
pub use context::{BsdfContext, SpecularBounce, SurfaceScattering};
pub use diffuse_lobe::{DiffuseLobe, DiffuseSample};
pub use frame::Frame;
pub use function_lobe::{FunctionLobe, LobeFunction, MaterialView, Surroundings};
pub use functions::{BrtdKind, ScatteringKind};
pub use glossy::GlossyKind;
pub use measured::{MeasuredKind, MeasuredPart, Pose};
pub use measured_lobe::{JitteredView, MeasuredLobe, PeakCells};
pub use sample::{BsdfSample, BsdfValue, PdfRequest};
pub use scatterer::Scatterer;
pub use sheet::Sheet;
pub use smooth_lobe::SmoothLobe;
pub use specular_threshold::{BelowThreshold, LobeStrength};
pub use transmission_lobe::{Transmission, TransmissionLobe};
pub use ward_function::{Appearances, Component, WardFunctionKind};
