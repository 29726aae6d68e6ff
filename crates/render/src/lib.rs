//! Traces rays through a valid scene.
//!
//! A [`RenderPlan`] is compiled once for a scene; a [`Renderer`] then traces rays on any number of
//! threads. The value of a ray depends on the plan, the seed and the ray's number in its stream,
//! never on threads or on other rays.
//!
//! Guarantees: no panic on a [`radsight_ir::ValidScene`]; finite lights are integrated over their
//! true extent. Knows neither files, nor text, nor shared libraries, nor cameras.
#![forbid(unsafe_code)]

mod cache_budget;
mod cache_occluders;
mod cache_point_search;
mod cache_prepass;
mod cache_query;
mod caching;
mod caustic;
mod caustic_chain;
mod checksum;
mod contribution;
mod cubature_error;
mod direct;
mod direct_record;
mod direct_residual;
mod gather;
mod guide_prepass;
mod guiding;
mod hemisphere_sampling;
mod indirect;
mod light_cubature;
mod light_image;
mod light_selection;
mod local_mean;
mod medium_boundary;
mod mirrored_light;
mod mis;
mod mixture;
mod model_batch;
mod model_light;
mod path_guide;
mod prism_manifold;
mod ray_spacing;
mod ray_tree;
mod renderer;
mod retrace;
mod saved_cache;
mod shadow;
mod shadow_blockers;
mod shadow_selection;
mod specular_chain;
mod specular_ends;
mod specular_return;
mod subtraction;
mod trace;
mod unshadowed_sample;

pub use contribution::Contribution;
pub use cubature_error::CubatureError;
pub use direct_record::{DirectRecord, NearRecord};
pub use light_image::{LightImage, Viewpoint};
pub use mirrored_light::{MirroredLight, light_offset};
pub use radsight_accel::Ray;
pub use radsight_compile::{
    AmbientSurfaces, BackFaces, BareSurfaces, Caustics, DirectThreshold, FirstHit, Gathering, GlobalMedium,
    LightDivision, Lights, ModelRequest, ModelSource, NoModels, OutlinedSurface, PathLimit, PlanDecision, Quantity,
    RayTreeOutput, RenderOptions, RenderPlan, SeenSurface, Skip, Skipping, SmoothView, TrackedValue, Uncached,
    check_materials, is_native_library,
};
pub use radsight_spectrum::Sampling;
pub use radsight_texture::BandValues;
pub use ray_spacing::RaySpacing;
pub use ray_tree::{RayValue, TreeRay};
pub use renderer::{RayWorker, Renderer};
pub use retrace::MAX_LIGHTS as MAX_MIRRORED_LIGHTS;
pub use saved_cache::CacheError;
pub use specular_ends::SpecularEnd;
pub use trace::{CountedLight, Traced};
