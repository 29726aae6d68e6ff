//! Lights of finite extent, and points sampled on them.
//!
//! A [`Light`] is an emitting surface or its image in mirrors and prisms ([`VirtualSource`]).
//! [`Light::sample`] samples a point on it for a receiver; [`Light::pdf`] gives the density of a
//! point. [`Light::cubature`] gives the nodes of a rule instead, where the light is a small disk and
//! the lobe smooth. A [`LightTree`] selects a few of many lights by importance.
//!
//! Guarantees: `pdf` is the density of `sample`, so that multiple importance sampling can combine
//! it with other techniques (Veach 1997); a light that can illuminate a point has a positive
//! probability there. The crate knows no materials, no radiance and no occlusion.
#![forbid(unsafe_code)]

mod bilinear;
mod cover;
mod cubature;
mod disk_nodes;
mod disk_overlap;
mod emission_profile;
mod form;
mod glow_radius;
mod light;
mod lobe_weighting;
mod outline;
mod spherical_rectangle;
mod tree;
mod tree_build;
mod tree_node;
mod virtual_source;
mod visible_side;

pub use disk_nodes::{DiskFrame, DiskNodeGroup, DiskNodes, LANES};
pub use emission_profile::EmissionProfile;
pub use form::{LightForm, LightSample, coordinates};
pub use light::{Light, LightCone, LightCubature, LightId, LightSampler};
pub use lobe_weighting::{DiskWarp, LobePeak, ReceiverCosine};
pub use tree::{Choice, LightSampleCount, LightTree, MOST_SAMPLES, Reception, TreeCut};
pub use virtual_source::{Redirection, VirtualSource, virtual_form};
