//! Traces rays through a valid scene.
//!
//! A [`RenderPlan`] decides once what a scene needs; a [`Renderer`] then answers rays from any number of threads. The value of a
//! ray depends on the plan, the seed and the ray's number in its stream, never on threads or on other rays.
//!
//! Guarantees: no panic on a [`radsight_ir::ValidScene`]; finite lights are integrated over their true extent. Knows neither
//! files, nor text, nor shared libraries, nor cameras.
#![forbid(unsafe_code)]

mod antimatter;
mod bands;
mod beam;
mod beyond;
mod bodies;
mod bright_places;
mod cast;
mod compile;
mod compile_scatter;
mod compile_steps;
mod contribution;
mod direct;
mod frame;
mod function_lobe;
mod gather;
mod geometry;
mod glow_range;
mod indirect;
mod lens;
mod lettering;
mod light;
mod light_form;
mod light_power;
mod light_tree;
mod light_tree_build;
mod lighting;
mod link;
mod look_out;
mod measured_lobe;
mod medium;
mod mixture;
mod model_light;
mod openings;
mod options;
mod plan;
mod prism;
mod prism_image;
mod prism_path;
mod ray;
mod reach;
mod recognise;
mod refraction;
mod renderer;
mod scatter;
mod shader;
mod shadow;
mod spectral_pattern;
mod step;
mod surface_light;
mod survey;
mod tilt;
mod trace;
mod tree;
mod veils;
mod view;
mod visible_side;
mod weak_highlight;

pub use bands::BandValues;
pub use cast::FirstHit;
pub use contribution::Contribution;
pub use options::{
    AmbientSurfaces, BackFaces, BareSurfaces, Gathering, GlobalMedium, Lights, PathLimit, Quantity, RenderOptions,
    Skip, Skipping, ToldRays, TrackedValue, Unshared,
};
pub use plan::{Decision, ModelRequest, ModelSource, NoModels, RenderPlan};
pub use radsight_spectrum::Sampling;
pub use ray::{Ray, Spread};
pub use renderer::{RayWorker, Renderer};
pub use trace::Traced;
pub use tree::{RayValue, ToldRay};
