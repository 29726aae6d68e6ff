//! A ray of a path, with what the path has brought along.

use crate::mis::{CausticPath, MisState};
use crate::ray_tree::NodeId;
use crate::specular_chain::SpecularChain;
use crate::subtraction::SubtractionId;
use radsight_accel::{PrimitiveId, Ray};

/// Names a medium that the present ray has met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct MediumId(pub(crate) u32);

/// A ray that waits to be traced.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PathState<const BANDS: usize> {
    pub(crate) ray: Ray,
    pub(crate) from: Option<PrimitiveId>,
    pub(crate) throughput: [f64; BANDS],
    /// Into how many rays the first one has split on the way here.
    pub(crate) split: f64,
    pub(crate) travelled: f64,
    pub(crate) mis: Option<MisState>,
    /// The specular interactions before it was first drawn from what a surface scatters.
    pub(crate) chain: SpecularChain,
    pub(crate) depth: u32,
    /// Reflections of any kind, which are limited.
    pub(crate) reflections: u32,
    pub(crate) ambient_bounces: u32,
    /// What fills the space that the ray crosses.
    pub(crate) medium: MediumId,
    /// What is cut away for the ray, and for what passes through the surface that it has met.
    pub(crate) cut: SubtractionId,
    pub(crate) subtraction_beyond: SubtractionId,
    /// Whether interreflection is left out at the surface that the ray has met.
    pub(crate) follows_no_diffuse: bool,
    /// Whether this is still the direct view, through nothing but plane mirrors and panes.
    pub(crate) direct_view: bool,
    /// Its name, where rays are told; before it is sent on, that of the ray above it.
    pub(crate) node: NodeId,
}

impl<const BANDS: usize> PathState<BANDS> {
    /// Whether it was drawn from what a surface scatters, at its origin or before.
    pub(crate) fn is_scattered(&self) -> bool {
        self.mis.is_some()
    }

    /// Whether it only looks for lamps behind specular surfaces.
    pub(crate) fn seeks_caustics(&self) -> bool {
        self.mis.is_some_and(|mis| mis.seeks_caustics())
    }

    /// The only chain in which it counts and the light where it has to end, where its direction was solved for.
    pub(crate) fn caustic(&self) -> Option<CausticPath> {
        self.mis.and_then(|mis| mis.caustic())
    }

    /// How many times as often its last drawn ray was drawn as by the lobe alone.
    pub(crate) fn pdf_ratio(&self) -> f64 {
        self.mis.map_or(1.0, |mis| mis.pdf_ratio)
    }
}
