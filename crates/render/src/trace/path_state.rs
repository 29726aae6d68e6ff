//! The state of a path.

use crate::mis::{CausticPath, MisState};
use crate::ray_tree::NodeId;
use crate::specular_chain::SpecularChain;
use crate::subtraction::SubtractionId;
use radsight_accel::{PrimitiveId, Ray};

/// Identifies a medium of the current ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct MediumId(pub(crate) u32);

/// A pending ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PathState<const BANDS: usize> {
    pub(crate) ray: Ray,
    pub(crate) from: Option<PrimitiveId>,
    pub(crate) throughput: [f64; BANDS],
    /// Number of branches into which the first ray has split on this path.
    pub(crate) split: f64,
    pub(crate) travelled: f64,
    pub(crate) mis: Option<MisState>,
    /// The specular interactions before the first scattering event.
    pub(crate) chain: SpecularChain,
    pub(crate) depth: u32,
    /// Whether it was not reflected yet, so that the distance of the first ray is limited with it.
    pub(crate) is_limited: bool,
    /// Number of reflections of any kind, which is limited.
    pub(crate) reflections: u32,
    pub(crate) ambient_bounces: u32,
    /// The medium that the ray crosses.
    pub(crate) medium: MediumId,
    /// The subtraction for the ray, and for rays through the surface that it hit.
    pub(crate) cut: SubtractionId,
    pub(crate) subtraction_beyond: SubtractionId,
    /// Whether diffuse interreflection is omitted at the surface that the ray hit.
    pub(crate) follows_no_diffuse: bool,
    /// Whether only plane mirrors and panes precede the ray.
    pub(crate) direct_view: bool,
    /// Its node, if a tree is requested; before it is added, that of its parent.
    pub(crate) node: NodeId,
}

impl<const BANDS: usize> PathState<BANDS> {
    /// Whether it was scattered by a surface, at its origin or before.
    pub(crate) fn is_scattered(&self) -> bool {
        self.mis.is_some()
    }

    /// Whether it only counts lamps behind specular surfaces.
    pub(crate) fn seeks_caustics(&self) -> bool {
        self.mis.is_some_and(|mis| mis.seeks_caustics())
    }

    /// The only chain in which it counts and the light where it must end, if its direction was
    /// solved for.
    pub(crate) fn caustic(&self) -> Option<CausticPath> {
        self.mis.and_then(|mis| mis.caustic())
    }

    /// The pdf ratio of its last sampled direction.
    pub(crate) fn pdf_ratio(&self) -> f64 {
        self.mis.map_or(1.0, |mis| mis.pdf_ratio)
    }
}
