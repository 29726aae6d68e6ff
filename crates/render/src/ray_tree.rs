//! The tree of rays that a ray causes, for `rtrace -ot`.
//!
//! If no tree is requested, all of this costs one null pointer. Rays are recorded when they are
//! created, each below its parent; values are summed up when the first ray is finished.

mod note;

use glam::DVec3;
use radsight_accel::Ray;
use radsight_compile::{FirstHit, RayTreeOutput, RenderOptions};
use radsight_ir::SurfaceHandle;
use radsight_texture::{BandValues, luminance, product};

/// The value of a ray or its coefficient, as a colour and, in spectral rendering, by band.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayValue {
    /// Red, green and blue.
    pub color: [f64; 3],
    /// The value in each band in spectral rendering.
    pub spectrum: Option<BandValues>,
}

/// A ray of the tree.
#[derive(Clone, Copy, Debug)]
pub struct TreeRay {
    /// Number of its ancestors.
    pub depth: usize,
    /// Its origin and direction.
    pub ray: Ray,
    /// Its end; the distance is from its own origin.
    pub hit: Option<FirstHit>,
    /// Its radiance, W/(sr·m²), before attenuation by the medium that it crosses.
    pub value: RayValue,
    /// The fraction of its value in that of the first ray.
    pub coefficient: RayValue,
    /// The product of the largest component of each coefficient along the path, at most 1, as in
    /// Radiance.
    pub weight: f64,
    /// The part of its value due to a mirror image at its end.
    pub mirrored: RayValue,
    /// The other part of its value.
    pub unmirrored: RayValue,
    /// Distance to the mirror image, scene units; infinite for nothing.
    pub mirrored_distance: f64,
    /// Distance to the other part, through panes and flat refraction, scene units; infinite for
    /// nothing.
    pub unmirrored_distance: f64,
    /// Whichever of the two contributes more than half of the value.
    pub effective_distance: f64,
}

/// Identifies a ray of a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NodeId(u32);

impl NodeId {
    /// The parent of the first ray, and every ray if no tree is requested.
    pub(crate) const NONE: NodeId = NodeId(u32::MAX);
}

/// How a ray leaves the end of its parent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BounceType {
    /// Without interaction.
    Passed,
    /// Through the surface, without scattering.
    Transmitted { image: Image },
    /// Reflected without scattering.
    Mirrored { image: Image },
    /// Sampled from a lobe.
    Sampled,
    /// Towards a light.
    Shadow,
}

/// The apparent position of what is seen through a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Image {
    /// At the total distance of both rays: the surface is flat and smooth.
    InPlace,
    /// Undefined; the distance is that of the surface.
    AtSurface,
}

/// The rays of the current tree.
#[derive(Debug)]
pub(crate) struct RayTree<const BANDS: usize> {
    output: RayTreeOutput,
    nodes: Vec<Node<BANDS>>,
    /// The coefficient of the next shadow rays relative to the first ray, and the ray that ends at
    /// their point.
    lit: ([f64; BANDS], NodeId),
    /// The current shadow ray.
    shadow: NodeId,
}

#[derive(Clone, Copy, Debug)]
struct Node<const BANDS: usize> {
    above: NodeId,
    bounce: BounceType,
    ray: Ray,
    hit: Option<FirstHit>,
    /// Coefficient relative to the first ray, at its origin and at its end.
    start: [f64; BANDS],
    arrival: [f64; BANDS],
    /// The contribution to the first ray of emission at its end, and of light scattered by the
    /// medium along it.
    own: [f64; BANDS],
    in_scattered: [f64; BANDS],
    target: Option<Target>,
}

/// The target of a shadow ray.
#[derive(Clone, Copy, Debug)]
struct Target {
    light: SurfaceHandle,
    /// Whether only mirrors and prisms lead there.
    virtual_form: bool,
    /// Its luminance without occlusion.
    importance: f64,
}

impl<const BANDS: usize> RayTree<BANDS> {
    /// Allocates memory if a tree is requested.
    pub(crate) fn wanted(options: &RenderOptions) -> Option<Box<RayTree<BANDS>>> {
        let tree = |output| {
            Box::new(RayTree { output, nodes: Vec::new(), lit: ([0.0; BANDS], NodeId::NONE), shadow: NodeId::NONE })
        };
        options.ray_tree.map(tree)
    }

    /// Removes the previous tree.
    pub(crate) fn clear(&mut self) {
        self.nodes.clear();
        self.shadow = NodeId::NONE;
    }

    /// Records a new ray with its coefficient relative to the first one.
    pub(crate) fn begin(&mut self, above: NodeId, bounce: BounceType, ray: Ray, share: [f64; BANDS]) -> NodeId {
        let id = NodeId(self.nodes.len() as u32);
        self.nodes.push(Node {
            above,
            bounce,
            ray,
            hit: None,
            start: share,
            arrival: share,
            own: [0.0; BANDS],
            in_scattered: [0.0; BANDS],
            target: None,
        });
        id
    }

    fn node(&mut self, id: NodeId) -> Option<&mut Node<BANDS>> {
        self.nodes.get_mut(id.0 as usize)
    }

    /// Records the end of a ray; only the first call counts.
    pub(crate) fn end(&mut self, id: NodeId, hit: FirstHit) {
        if let Some(node) = self.node(id) {
            node.hit.get_or_insert(hit);
        }
    }

    /// Records the perturbed normal at the end of a ray.
    pub(crate) fn note_normal(&mut self, id: NodeId, normal: DVec3) {
        if let Some(hit) = self.node(id).and_then(|node| node.hit.as_mut()) {
            hit.perturbed_normal = normal;
        }
    }

    /// Records the attenuation of a ray by its medium, and the light scattered there.
    pub(crate) fn dim(&mut self, id: NodeId, left: [f64; BANDS], in_scattered: [f64; BANDS]) {
        if let Some(node) = self.node(id) {
            node.arrival = product(node.start, left);
            node.in_scattered = in_scattered;
        }
    }

    /// Records a contribution from the end of a ray to the first ray.
    pub(crate) fn add(&mut self, id: NodeId, brought: [f64; BANDS]) {
        if let Some(node) = self.node(id) {
            node.own = std::array::from_fn(|band| node.own[band] + brought[band]);
        }
    }

    /// Begins light sampling at the end of a ray; `share` is the coefficient of the point relative
    /// to the first ray.
    pub(crate) fn light(&mut self, share: [f64; BANDS], id: NodeId) {
        self.lit = (share, id);
    }
}

impl<const BANDS: usize> Node<BANDS> {
    fn distance(&self) -> f64 {
        self.hit.map_or(f64::INFINITY, |hit| hit.distance)
    }

    /// Whether it is part of the output: unobstructed shadow rays are optional, and shadow rays
    /// that hit nothing are never output.
    fn is_output(&self, output: RayTreeOutput) -> bool {
        match (&self.target, &self.hit) {
            (None, _) => true,
            (Some(_), None) => false,
            (Some(target), Some(hit)) if target.light == hit.surface => output == RayTreeOutput::AllAndLit,
            (Some(target), Some(hit)) => hit.distance.is_finite() || !target.virtual_form,
        }
    }
}

/// The children of each ray.
struct Below {
    /// By ray; the last element is the end of all.
    starts: Vec<usize>,
    rays: Vec<usize>,
}

impl Below {
    fn new<const BANDS: usize>(nodes: &[Node<BANDS>]) -> Below {
        let mut order: Vec<usize> = (1..nodes.len()).collect();
        // As in Radiance: shadow rays last, the most important first.
        let rank = |id: usize| nodes[id].target.map_or(f64::NEG_INFINITY, |target| -target.importance);
        order.sort_by(|a, b| nodes[*a].above.0.cmp(&nodes[*b].above.0).then(rank(*a).total_cmp(&rank(*b))));
        let starts = (0..=nodes.len()).map(|id| order.partition_point(|ray| (nodes[*ray].above.0 as usize) < id));
        Below { starts: starts.collect(), rays: order }
    }

    fn of(&self, id: usize) -> &[usize] {
        &self.rays[self.starts[id]..self.starts[id + 1]]
    }
}

/// The value of a ray, including its descendants.
#[derive(Clone, Copy, Debug)]
struct Sum<const BANDS: usize> {
    /// The contribution to the first ray.
    given: [f64; BANDS],
    /// The part of it due to the mirror image at its end.
    given_mirrored: [f64; BANDS],
    /// Its radiance, and the part due to the mirror image at its end.
    value: [f64; BANDS],
    mirrored: [f64; BANDS],
    mirrored_distance: f64,
    unmirrored_distance: f64,
    weight: f64,
    /// Whether it is a shadow ray that found no light.
    is_missed: bool,
}

/// Radiance includes the medium's attenuation in a ray's weight only if it is stronger than this.
const MIN_ATTENUATION: f64 = 0.1;

impl<const BANDS: usize> Sum<BANDS> {
    /// By ray. Children come after their parents.
    fn all(nodes: &[Node<BANDS>], below: &Below) -> Vec<Sum<BANDS>> {
        let mut sums: Vec<Sum<BANDS>> = vec![Sum::NOTHING; nodes.len()];
        for id in (0..nodes.len()).rev() {
            sums[id] = Sum::of(nodes, id, below.of(id), &sums);
        }
        for id in 0..nodes.len() {
            let Some(above) = nodes.get(nodes[id].above.0 as usize) else { continue };
            sums[id].weight = sums[nodes[id].above.0 as usize].weight * above.weight_onward(&nodes[id]);
        }
        sums
    }

    const NOTHING: Sum<BANDS> = Sum {
        given: [0.0; BANDS],
        given_mirrored: [0.0; BANDS],
        value: [0.0; BANDS],
        mirrored: [0.0; BANDS],
        mirrored_distance: f64::INFINITY,
        unmirrored_distance: f64::INFINITY,
        weight: 1.0,
        is_missed: false,
    };

    fn of(nodes: &[Node<BANDS>], id: usize, below: &[usize], sums: &[Sum<BANDS>]) -> Sum<BANDS> {
        let node = &nodes[id];
        let mut sum = Sum { given: node.own, unmirrored_distance: node.distance(), ..Sum::NOTHING };
        let mut brightest = [0.0; 2];
        for (bounce, child) in below.iter().map(|child| (nodes[*child].bounce, &sums[*child])) {
            if bounce == BounceType::Shadow {
                // The point includes their values.
                continue;
            }
            sum.given = added(sum.given, child.given);
            let bright = luminance(&child.given);
            match bounce {
                BounceType::Passed => {
                    sum.given_mirrored = added(sum.given_mirrored, child.given_mirrored);
                    sum.mirrored_distance = node.distance() + child.mirrored_distance;
                    sum.unmirrored_distance = node.distance() + child.unmirrored_distance;
                }
                BounceType::Mirrored { image } => {
                    sum.given_mirrored = added(sum.given_mirrored, child.given);
                    if bright >= brightest[0] {
                        let beyond = if image == Image::InPlace { child.distance() } else { 0.0 };
                        (brightest[0], sum.mirrored_distance) = (bright, node.distance() + beyond);
                    }
                }
                BounceType::Transmitted { image: Image::InPlace } if bright >= brightest[1] => {
                    (brightest[1], sum.unmirrored_distance) = (bright, node.distance() + child.distance());
                }
                _ => {}
            }
        }
        sum.value = divided(sum.given, node.arrival);
        sum.mirrored = divided(sum.given_mirrored, node.arrival);
        sum.given = added(sum.given, node.in_scattered);
        let aimed_at = node.target.is_some_and(|target| node.hit.is_some_and(|hit| hit.surface == target.light));
        sum.is_missed = node.target.is_some() && !aimed_at && sum.given.iter().all(|band| *band <= 0.0);
        sum
    }

    /// The distance of a ray as defined by Radiance.
    fn distance(&self) -> f64 {
        let by_mirror = luminance(&self.mirrored) > 0.5 * luminance(&self.value);
        if by_mirror { self.mirrored_distance } else { self.unmirrored_distance }
    }
}

impl<const BANDS: usize> Node<BANDS> {
    /// The ratio of a child's weight to that of the ray.
    fn weight_onward(&self, below: &Node<BANDS>) -> f64 {
        let strongest = |of: [f64; BANDS]| of.into_iter().fold(0.0, f64::max);
        let left = strongest(divided(self.arrival, self.start));
        let dimmed = if -left.ln() > MIN_ATTENUATION { left } else { 1.0 };
        match below.bounce {
            BounceType::Passed | BounceType::Shadow => dimmed,
            _ => dimmed * strongest(divided(below.start, self.arrival)).min(1.0),
        }
    }
}

fn added<const BANDS: usize>(a: [f64; BANDS], b: [f64; BANDS]) -> [f64; BANDS] {
    std::array::from_fn(|band| a[band] + b[band])
}

/// 0 where a band has no coefficient, since its value is unknown.
fn divided<const BANDS: usize>(a: [f64; BANDS], b: [f64; BANDS]) -> [f64; BANDS] {
    std::array::from_fn(|band| if b[band] > 0.0 { a[band] / b[band] } else { 0.0 })
}
