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
mod bsdf;
mod cache_prepass;
mod cast;
mod compile;
mod compile_scatter;
mod compile_steps;
mod contribution;
mod direct;
mod disk_overlap;
mod emission_profile;
mod frame;
mod function_lobe;
mod gather;
mod glow_radius;
mod guiding;
mod hemisphere_sampling;
mod indirect;
mod lettering;
mod light;
mod light_form;
mod light_power;
mod light_tree;
mod light_tree_build;
mod lighting;
mod lobe_weighting;
mod measured_lobe;
mod medium;
mod medium_boundary;
mod mis;
mod mixture;
mod model_light;
mod options;
mod plan;
mod portals;
mod prism;
mod prism_image;
mod prism_manifold;
mod ray_spacing;
mod ray_tree;
mod refraction;
mod renderer;
mod scatter;
mod shader;
mod shadow;
mod specialise;
mod spectral_pattern;
mod specular_threshold;
mod step;
mod substance;
mod surface_interaction;
mod trace;
mod transmission_lobe;
mod veils;
mod visibility_class;
mod visible_side;

pub use bands::BandValues;
pub use cast::FirstHit;
pub use contribution::Contribution;
pub use options::{
    AmbientSurfaces, BackFaces, BareSurfaces, Gathering, GlobalMedium, Lights, PathLimit, Quantity, RayTreeOutput,
    RenderOptions, Skip, Skipping, TrackedValue, Uncached,
};
pub use plan::{ModelRequest, ModelSource, NoModels, PlanDecision, RenderPlan};
pub use radsight_accel::Ray;
pub use radsight_spectrum::Sampling;
pub use ray_spacing::RaySpacing;
pub use ray_tree::{RayValue, TreeRay};
pub use renderer::{RayWorker, Renderer};
pub use trace::Traced;
