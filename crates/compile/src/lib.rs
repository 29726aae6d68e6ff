//! Compiles a valid scene for rendering: flat tables with ids, and decisions about the work that
//! can be skipped.
//!
//! A [`RenderPlan`] holds everything that tracing rays needs: shaders by id, lights with their
//! virtual sources, portals, the blockers between surfaces and lights, and media. It is plain data
//! that integrators read.
//!
//! Guarantees: no panic on a [`radsight_ir::ValidScene`]; a plan depends on scene, options and
//! models alone. The crate knows no integrator.
#![forbid(unsafe_code)]

mod antimatter;
mod compile;
mod compile_scatter;
mod compile_steps;
mod direct_threshold;
mod emission;
mod emission_cone;
mod first_hit;
mod function_faults;
mod hierarchy_choice;
mod light_policy;
mod light_power;
mod lighting;
mod material_check;
mod medium;
mod mist_lights;
mod model_source;
mod narrow_highlight;
mod native_model;
mod option_check;
mod options;
mod outlined_surface;
mod panes;
mod plan;
mod plan_build;
mod plan_decisions;
mod portal_search;
mod portals;
mod prism;
mod prism_image;
mod reflectors;
mod refraction;
mod shader;
mod shader_sets;
mod smooth_view;
mod specialise;
mod substance;
mod unbounded;
mod unbounded_radiance;
mod veiled;
mod veils;
mod visibility_class;

pub use antimatter::Antimatter;
pub use direct_threshold::DirectThreshold;
pub use emission::{emission, given, uniform_emission};
pub use first_hit::{DISTANT, FirstHit};
pub use material_check::check_materials;
pub use medium::{Medium, MistKind};
pub use mist_lights::MistLights;
pub use model_source::{ModelRequest, ModelSource, NoModels};
pub use narrow_highlight::SeenSurface;
pub use native_model::is_native_library;
pub use option_check::OptionOutOfRange;
pub use options::{
    AmbientSurfaces, BackFaces, BareSurfaces, Caustics, Gathering, GlobalMedium, LightDivision, Lights, PathLimit,
    Quantity, RayTreeOutput, RenderOptions, Skip, Skipping, TrackedValue, Uncached,
};
pub use outlined_surface::OutlinedSurface;
pub use plan::{IllumView, PlanDecision, RenderPlan, Sky};
pub use portals::{MOST_PORTALS, Portal, PortalForm, Portals, VisiblePortals};
pub use prism::PrismKind;
pub use reflectors::{FlatReflector, FlatReflectors, Reflector};
pub use refraction::{DielectricInterface, RaySide, Refracted};
pub use shader::{Emitter, EmitterType, Kind, MixtureKind, Shader, Substitution, Unusable};
pub use smooth_view::SmoothView;
pub use unbounded::Unbounded;
pub use visibility_class::{Receiver, Visibility, VisibilityClass};
