//! Lights with their true extent, and the points on them from which light comes.
//!
//! A [`Light`] is an emitting surface or its image in mirrors and prisms ([`VirtualSource`]); [`Light::sample`] draws a point on it as a
//! receiver sees it, [`Light::pdf`] says with which density. A [`LightTree`] chooses a few of many by what they can give.
//!
//! Guarantees: whatever can be drawn has the density that `pdf` says, so both can be weighted against other techniques (Veach 1997);
//! a light that can give something at a point has a chance there. Knows no materials, no radiance and no occlusion.
#![forbid(unsafe_code)]

mod cover;
mod disk_overlap;
mod emission_profile;
mod form;
mod glow_radius;
mod light;
mod lobe_weighting;
mod tree;
mod tree_build;
mod tree_node;
mod virtual_source;
mod visible_side;

pub use emission_profile::EmissionProfile;
pub use form::{LightForm, LightSample, coordinates};
pub use light::{Light, LightCone, LightId};
pub use lobe_weighting::{DiskWarp, LobePeak};
pub use tree::{Choice, LightSampleCount, LightTree, MOST_PLACES, Reception, TreeCut};
pub use virtual_source::{Redirection, VirtualSource, virtual_form};
