//! The rays that came of a ray: the hook of `rtrace -ot`.
//!
//! Where they are not wanted, all of this is one pointer that is null. Rays are noted as they are sent on, each below the one from which it comes;
//! what each has brought is summed up when the first is answered.

mod note;

use glam::DVec3;
use radsight_accel::Ray;
use radsight_compile::{FirstHit, RayTreeOutput, RenderOptions};
use radsight_ir::SurfaceHandle;
use radsight_texture::{BandValues, luminance, product};

/// What a ray brings or what counts of it, as a colour and, where spectra are traced, band by band.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayValue {
    /// Red, green and blue.
    pub color: [f64; 3],
    /// The value in each band where spectra are traced.
    pub spectrum: Option<BandValues>,
}

/// One of the rays that came of a ray, or that ray itself.
#[derive(Clone, Copy, Debug)]
pub struct TreeRay {
    /// How many rays are above it.
    pub depth: usize,
    /// Where it began and its direction.
    pub ray: Ray,
    /// Where it ended; the distance is from its own origin.
    pub hit: Option<FirstHit>,
    /// Radiance that it brought, W/(sr·m²), before the medium dims it that it crosses.
    pub value: RayValue,
    /// How much of its value is in that of the first ray.
    pub coefficient: RayValue,
    /// The product of the largest component of each coefficient on the way, 1 at most, as Radiance weighs rays.
    pub weight: f64,
    /// What of its value came by way of a mirror image at its end.
    pub mirrored: RayValue,
    /// The rest of its value.
    pub unmirrored: RayValue,
    /// Distance to what is seen in the mirror image, scene units; infinite for nothing.
    pub mirrored_distance: f64,
    /// Distance to what is seen otherwise, through panes and flat refraction, scene units; infinite for nothing.
    pub unmirrored_distance: f64,
    /// That of the two from where more than half of the value comes.
    pub effective_distance: f64,
}

/// Names a ray of a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NodeId(u32);

impl NodeId {
    /// Nothing is above the first ray, and no ray has a name where none is told.
    pub(crate) const NONE: NodeId = NodeId(u32::MAX);
}

/// How a ray leaves the end of the one above it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BounceType {
    /// As if nothing had been met.
    Passed,
    /// Through the surface, without being scattered.
    Transmitted { image: Image },
    /// Reflected without being scattered.
    Mirrored { image: Image },
    /// Drawn from a lobe.
    Drawn,
    /// Towards a light.
    Shadow,
}

/// Where that appears which is seen by way of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Image {
    /// At the distance of both rays: the surface is flat and smooth.
    InPlace,
    /// Anywhere; the distance is told as that of the surface.
    AtSurface,
}

impl Image {
    pub(crate) fn in_place_if(flat: bool) -> Image {
        if flat { Image::InPlace } else { Image::AtSurface }
    }
}

/// The rays of the present tree.
#[derive(Debug)]
pub(crate) struct RayTree<const BANDS: usize> {
    told: RayTreeOutput,
    nodes: Vec<Node<BANDS>>,
    /// The share in the first ray of what the next shadow rays bring to their point, and the ray that met it.
    lit: ([f64; BANDS], NodeId),
    /// The shadow ray in hand.
    shadow: NodeId,
}

#[derive(Clone, Copy, Debug)]
struct Node<const BANDS: usize> {
    above: NodeId,
    bounce: BounceType,
    ray: Ray,
    hit: Option<FirstHit>,
    /// Share in the first ray, at its origin and at its end.
    start: [f64; BANDS],
    arrival: [f64; BANDS],
    /// What the first ray gets of what was found at its end, and of what the medium on the way scatters.
    own: [f64; BANDS],
    haze: [f64; BANDS],
    target: Option<Target>,
}

/// Where a shadow ray goes.
#[derive(Clone, Copy, Debug)]
struct Target {
    light: SurfaceHandle,
    /// Whether only mirrors and prisms lead there.
    virtual_form: bool,
    /// Luminance that it brings where nothing is in the way.
    importance: f64,
}

impl<const BANDS: usize> RayTree<BANDS> {
    /// Memory for it, if it is wanted.
    pub(crate) fn wanted(options: &RenderOptions) -> Option<Box<RayTree<BANDS>>> {
        let tree = |told| {
            Box::new(RayTree { told, nodes: Vec::new(), lit: ([0.0; BANDS], NodeId::NONE), shadow: NodeId::NONE })
        };
        options.ray_tree.map(tree)
    }

    /// Forgets the tree before.
    pub(crate) fn clear(&mut self) {
        self.nodes.clear();
        self.shadow = NodeId::NONE;
    }

    /// Notes a ray that is sent on with a share in the first one.
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
            haze: [0.0; BANDS],
            target: None,
        });
        id
    }

    fn node(&mut self, id: NodeId) -> Option<&mut Node<BANDS>> {
        self.nodes.get_mut(id.0 as usize)
    }

    /// Notes where a ray ended; the first word counts.
    pub(crate) fn end(&mut self, id: NodeId, hit: FirstHit) {
        if let Some(node) = self.node(id) {
            node.hit.get_or_insert(hit);
        }
    }

    /// Notes the normal with textures where a ray ended.
    pub(crate) fn note_normal(&mut self, id: NodeId, normal: DVec3) {
        if let Some(hit) = self.node(id).and_then(|node| node.hit.as_mut()) {
            hit.perturbed_normal = normal;
        }
    }

    /// Notes what is left of a ray's value after the medium that it crosses, and what the first ray gets from there.
    pub(crate) fn dim(&mut self, id: NodeId, left: [f64; BANDS], haze: [f64; BANDS]) {
        if let Some(node) = self.node(id) {
            node.arrival = product(node.start, left);
            node.haze = haze;
        }
    }

    /// Notes what the first ray gets from where a ray ended.
    pub(crate) fn add(&mut self, id: NodeId, brought: [f64; BANDS]) {
        if let Some(node) = self.node(id) {
            node.own = std::array::from_fn(|band| node.own[band] + brought[band]);
        }
    }

    /// Light is looked for where a ray met a point; what comes counts with this share in the first ray.
    pub(crate) fn light(&mut self, share: [f64; BANDS], id: NodeId) {
        self.lit = (share, id);
    }
}

impl<const BANDS: usize> Node<BANDS> {
    fn distance(&self) -> f64 {
        self.hit.map_or(f64::INFINITY, |hit| hit.distance)
    }

    /// Whether it is told: shadow rays that meet nothing but their light are only where that is asked for, and those that meet nothing never.
    fn is_told(&self, told: RayTreeOutput) -> bool {
        match (&self.target, &self.hit) {
            (None, _) => true,
            (Some(_), None) => false,
            (Some(target), Some(hit)) if target.light == hit.surface => told == RayTreeOutput::AllAndLit,
            (Some(target), Some(hit)) => hit.distance.is_finite() || !target.virtual_form,
        }
    }
}

/// Which rays are below each.
struct Below {
    /// By ray; the last is the end of all.
    starts: Vec<usize>,
    rays: Vec<usize>,
}

impl Below {
    fn new<const BANDS: usize>(nodes: &[Node<BANDS>]) -> Below {
        let mut order: Vec<usize> = (1..nodes.len()).collect();
        // As in Radiance: shadow rays last, those first that promise most.
        let rank = |id: usize| nodes[id].target.map_or(f64::NEG_INFINITY, |target| -target.importance);
        order.sort_by(|a, b| nodes[*a].above.0.cmp(&nodes[*b].above.0).then(rank(*a).total_cmp(&rank(*b))));
        let starts = (0..=nodes.len()).map(|id| order.partition_point(|ray| (nodes[*ray].above.0 as usize) < id));
        Below { starts: starts.collect(), rays: order }
    }

    fn of(&self, id: usize) -> &[usize] {
        &self.rays[self.starts[id]..self.starts[id + 1]]
    }
}

/// What a ray brings, with all that comes of it.
#[derive(Clone, Copy, Debug)]
struct Sum<const BANDS: usize> {
    /// What the first ray gets.
    given: [f64; BANDS],
    /// The same of the mirror image at its end.
    given_mirrored: [f64; BANDS],
    /// Radiance that it brings, and by way of the mirror image at its end.
    value: [f64; BANDS],
    mirrored: [f64; BANDS],
    mirrored_distance: f64,
    unmirrored_distance: f64,
    weight: f64,
    /// Whether it is a shadow ray that found no light.
    is_missed: bool,
}

/// Radiance heeds the medium's dimming in a ray's weight only where it is stronger than this.
const DIMMING_THAT_WEIGHS: f64 = 0.1;

impl<const BANDS: usize> Sum<BANDS> {
    /// By ray. Rays come after those above them.
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
                // The point has what they bring.
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
        sum.given = added(sum.given, node.haze);
        let aimed_at = node.target.is_some_and(|target| node.hit.is_some_and(|hit| hit.surface == target.light));
        sum.is_missed = node.target.is_some() && !aimed_at && sum.given.iter().all(|band| *band <= 0.0);
        sum
    }

    /// As Radiance tells the distance of a ray.
    fn distance(&self) -> f64 {
        let by_mirror = luminance(&self.mirrored) > 0.5 * luminance(&self.value);
        if by_mirror { self.mirrored_distance } else { self.unmirrored_distance }
    }
}

impl<const BANDS: usize> Node<BANDS> {
    /// What the weight of a ray below is multiplied by.
    fn weight_onward(&self, below: &Node<BANDS>) -> f64 {
        let strongest = |of: [f64; BANDS]| of.into_iter().fold(0.0, f64::max);
        let left = strongest(divided(self.arrival, self.start));
        let dimmed = if -left.ln() > DIMMING_THAT_WEIGHS { left } else { 1.0 };
        match below.bounce {
            BounceType::Passed | BounceType::Shadow => dimmed,
            _ => dimmed * strongest(divided(below.start, self.arrival)).min(1.0),
        }
    }
}

fn added<const BANDS: usize>(a: [f64; BANDS], b: [f64; BANDS]) -> [f64; BANDS] {
    std::array::from_fn(|band| a[band] + b[band])
}

/// Where nothing of a band counts, nothing is known of it.
fn divided<const BANDS: usize>(a: [f64; BANDS], b: [f64; BANDS]) -> [f64; BANDS] {
    std::array::from_fn(|band| if b[band] > 0.0 { a[band] / b[band] } else { 0.0 })
}
