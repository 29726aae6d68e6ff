//! Visibility classes: possible blockers between a light and a surface, by shaft culling (Haines
//! and Wallace 1991).
//!
//! Every pair of a surface and a light is classified when the first ray hits the surface. If no
//! other surface reaches into their convex hull, no shadow ray is needed; if few do, only those are
//! tested. A flat surface with nothing but lights in front of it needs no rays for indirect light.
//! All tests are conservative: they cannot change the picture.

use crate::shader::{Kind, Shader, Substitution};
use glam::DVec3;
use radsight_accel::{Bounds, Geometry, MemberId, PrimitiveId, flat_normal};
use radsight_ir::{Scene, Shape, SurfaceHandle, ValidScene};
use radsight_light::{Light, LightForm};
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Maximum number of tests (pairs times surfaces). In larger scenes only some receivers are classified.
const MAX_TESTS: usize = 4_000_000;

/// Maximum number of blockers in a list; with more the acceleration structure is used.
const MAX_BLOCKERS: usize = 4;

/// Surfaces within this distance of a plane lie in it, relative to the scene's size.
const IN_PLANE: f64 = 1e-9;

/// Visibility between a surface and a light.
#[derive(Clone, Debug, PartialEq)]
pub enum VisibilityClass {
    /// The light faces away or is too far: it contributes nothing.
    Dark,
    /// Nothing blocks the light.
    Nothing,
    /// At most these members block the light.
    Few(Vec<MemberId>),
    /// Only surfaces within these bounds block the light.
    Within(Bounds),
    /// Any surface may block the light.
    Anything,
}

/// Visibility of the lights at one primitive.
#[derive(Clone, Debug)]
pub struct Receiver {
    /// Class of each light.
    pub between: Vec<VisibilityClass>,
    /// Whether everything in front of it is a sampled light.
    pub sees_only_lights: bool,
    /// Whether every light is also smaller than its highlight, so that light sampling alone is
    /// best.
    pub lights_suffice: bool,
}

/// Light that light sampling does not cover.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnsampledLight {
    /// No such light.
    None,
    /// Possibly such light.
    Some,
}

/// Visibility at the primitives that are classified: all of them, or in a large scene only
/// retroreflectors, which are lit by lamps alone if their highlight is known to be wider.
#[derive(Debug, Default)]
pub struct Visibility {
    receivers: Vec<PendingReceiver>,
    /// By primitive, the index of the receiver; [`UNCLASSIFIED`] for none.
    by_primitive: Vec<u32>,
    pairs: Pairs,
}

/// A receiver that is classified at its first use: many surfaces of a scene are never seen.
#[derive(Debug)]
struct PendingReceiver {
    occluder: usize,
    classified: OnceLock<Receiver>,
}

/// All surfaces and lights.
#[derive(Debug, Default)]
struct Pairs {
    occluders: Vec<Occluder>,
    /// The occluders, the largest first.
    order: Vec<usize>,
    lights: Vec<Light>,
    /// By light; `None` for a distant light or a virtual source.
    emitters: Vec<Option<Emitter>>,
    /// Surfaces within this distance of a plane lie in it, scene units.
    tolerance: f64,
    has_unsampled_light: bool,
}

impl Pairs {
    fn classify(&self, occluder: &Occluder) -> Receiver {
        let Pairs { occluders, lights, tolerance, .. } = self;
        let between = self.emitters.iter().zip(lights).map(|(emitter, light)| match emitter {
            Some(emitter) => self.between(occluder, (light, emitter)),
            None => VisibilityClass::Anything,
        });
        Receiver {
            between: between.collect(),
            sees_only_lights: !self.has_unsampled_light && sees_only_lights(occluder, occluders, lights, *tolerance),
            lights_suffice: lights_are_small(occluder, lights),
        }
    }

    /// Possible blockers between a receiver and a light.
    fn between(&self, occluder: &Occluder, (light, emitter): (&Light, &Emitter)) -> VisibilityClass {
        let Pairs { occluders, order, tolerance, .. } = self;
        let Emitter { source, hidden_by } = emitter;
        let (source, tolerance) = (&occluders[*source], *tolerance);
        if occluder.surface == light.surface {
            return VisibilityClass::Anything;
        }
        if let Some((normal, point)) = light.form.plane()
            && occluder.range(normal).1 <= normal.dot(point) + tolerance
        {
            return VisibilityClass::Dark;
        }
        let axes = [Axis::X, Axis::Y, Axis::Z].into_iter();
        let normals = [occluder, source].into_iter().filter_map(|of| of.plane.map(|(normal, _)| Axis::Other(normal)));
        let extents: Vec<Extent> =
            axes.chain(normals).filter_map(|axis| Extent::new(axis, [occluder, source], tolerance)).collect();
        let may_block = |index: &&usize| {
            let other = &occluders[**index];
            other.surface != light.surface
                && (other.member != occluder.member || occluder.plane.is_none())
                && (hidden_by[**index] || !extents.iter().any(|extent| extent.leaves_out(other)))
        };
        let mut blockers: Vec<MemberId> =
            order.iter().filter(may_block).map(|index| occluders[*index].member).take(MAX_BLOCKERS + 1).collect();
        blockers.sort_unstable_by_key(|member| member.0);
        match blockers.len() {
            0 => VisibilityClass::Nothing,
            1..=MAX_BLOCKERS => VisibilityClass::Few(blockers),
            // The lamps around a camera light most of a retroreflector past the part that lies on it.
            _ if occluder.is_retroreflector => {
                // The largest ones come first: what is within their bounds needs no test.
                let around = |around: Option<Bounds>, index: &usize| {
                    let bounds = occluders[*index].bounds();
                    let is_new = around.is_none_or(|around| !around.contains(&bounds)) && may_block(&index);
                    if is_new { Some(around.map_or(bounds, |around| around.union(bounds))) } else { around }
                };
                order.iter().fold(None, around).map_or(VisibilityClass::Anything, VisibilityClass::Within)
            }
            _ => VisibilityClass::Anything,
        }
    }
}

const UNCLASSIFIED: u32 = u32::MAX;

impl Visibility {
    /// Without information: everything is computed.
    pub fn everything() -> Visibility {
        Visibility::default()
    }

    /// Prepares the classification of all pairs of surfaces and lights; `unsampled_light` says
    /// whether light sampling covers all light.
    pub fn new<'a>(
        scene: &ValidScene,
        geometry: &Geometry,
        shader: impl Fn(SurfaceHandle) -> &'a Shader,
        lights: &[Light],
        unsampled_light: UnsampledLight,
    ) -> Visibility {
        let count = geometry.len();
        let most = MAX_TESTS / count.saturating_mul(lights.len().max(1)).max(1);
        let is_retroreflector = |handle: SurfaceHandle| matches!(shader(handle).kind, Kind::Retro(_));
        if most < count && (most == 0 || !geometry.members().any(|(_, handle)| is_retroreflector(handle))) {
            return Visibility::everything();
        }
        let occluders: Vec<Occluder> = geometry
            .members()
            .map(|(member, handle)| Occluder::new(scene, geometry, member, &shader(handle).kind, lights))
            .collect();
        let order = largest_first(&occluders);
        let is_classified = |index: &usize| most >= count || is_retroreflector(occluders[*index].surface);
        let classified: Vec<usize> = order.iter().copied().filter(is_classified).take(most).collect();
        let (_, radius) = geometry.bounding_sphere();
        let emitters = lights.iter().map(|light| Emitter::new(light, &occluders, geometry.tolerance())).collect();
        let mut by_primitive = vec![UNCLASSIFIED; count];
        for (receiver, member) in classified.iter().enumerate() {
            by_primitive[*member] = receiver as u32;
        }
        let pending = |occluder| PendingReceiver { occluder, classified: OnceLock::new() };
        let receivers = classified.into_iter().map(pending).collect();
        let (lights, tolerance) = (lights.to_vec(), IN_PLANE * radius);
        let has_unsampled_light = unsampled_light == UnsampledLight::Some;
        let pairs = Pairs { occluders, order, lights, emitters, tolerance, has_unsampled_light };
        Visibility { receivers, by_primitive, pairs }
    }

    /// Visibility of the lights at a primitive.
    #[inline]
    pub fn receiver(&self, primitive: PrimitiveId) -> Option<&Receiver> {
        let index = self.by_primitive.get(primitive.0 as usize)?;
        self.receivers.get(*index as usize).map(|pending| self.classified(pending))
    }

    #[inline]
    fn classified<'s>(&'s self, PendingReceiver { occluder, classified }: &'s PendingReceiver) -> &'s Receiver {
        classified.get_or_init(|| self.pairs.classify(&self.pairs.occluders[*occluder]))
    }

    /// Counts of the savings, as text.
    pub fn summary(&self) -> [(usize, &'static str, &'static str); 5] {
        let receivers = || self.receivers.iter().map(|pending| self.classified(pending));
        let pairs = |kind: fn(&VisibilityClass) -> bool| {
            receivers().map(|receiver| receiver.between.iter().filter(|b| kind(b)).count()).sum()
        };
        let direct_only = receivers().filter(|receiver| receiver.sees_only_lights && receiver.lights_suffice).count();
        [
            (
                pairs(|b| *b == VisibilityClass::Dark),
                "pairs of surface and light that need no light sample",
                "the light faces away",
            ),
            (
                pairs(|b| *b == VisibilityClass::Nothing),
                "pairs of surface and light that need no shadow ray",
                "nothing reaches into the space between them",
            ),
            (
                pairs(|b| matches!(b, VisibilityClass::Few(_))),
                "pairs of surface and light that test a few surfaces only",
                "no other reaches into the space between them",
            ),
            (
                pairs(|b| matches!(b, VisibilityClass::Within(_))),
                "pairs of surface and light that need no shadow ray past some bounds",
                "all that reaches into the space between them is within the bounds",
            ),
            (
                direct_only,
                "surfaces that sample the lights alone",
                "nothing but lights is in front of them, each smaller than the highlight",
            ),
        ]
    }
}

/// Bounds of a surface for these tests.
#[derive(Debug)]
struct Occluder {
    member: MemberId,
    surface: SurfaceHandle,
    /// Points whose convex hull contains the surface.
    hull: Vec<DVec3>,
    /// Its minimum and maximum along each coordinate axis.
    bounds: [(f64, f64); 3],
    is_retroreflector: bool,
    /// Front normal and a point of the plane, if it is flat.
    plane: Option<(DVec3, DVec3)>,
    is_light: bool,
    /// Centre and outer radius of a ring.
    ring: Option<(DVec3, f64)>,
    /// Solid angle of the narrowest highlight, sr.
    highlight: f64,
}

impl Occluder {
    fn new(scene: &Scene, geometry: &Geometry, member: MemberId, kind: &Kind, lights: &[Light]) -> Occluder {
        let surface = geometry.surface_of(member);
        let shape = scene.surfaces[surface].shape;
        let hull = hull(scene, geometry, shape);
        let plane = flat_normal(scene, shape).map(|normal| (normal, hull[0]));
        // The alternate material of an illum is seen from behind.
        let is_seen = matches!(kind, Kind::Illum { substitute: Substitution::Shader(_), .. });
        let samples = |light: &Light| light.surface == surface && light.max_distance.is_infinite();
        let is_light = !is_seen && lights.iter().any(samples);
        let highlight = match kind {
            Kind::Glossy(glossy) | Kind::Retro(glossy) => 4.0 * PI * glossy.roughness * glossy.roughness,
            _ => 0.0,
        };
        let bounds = DVec3::AXES.map(|axis| range(&hull, axis));
        let ring = match shape {
            Shape::Ring(handle) => Some((scene.rings[handle].center, scene.rings[handle].outer_radius)),
            _ => None,
        };
        let is_retroreflector = matches!(kind, Kind::Retro(_));
        Occluder { member, surface, hull, bounds, is_retroreflector, plane, is_light, ring, highlight }
    }

    fn bounds(&self) -> Bounds {
        let [x, y, z] = self.bounds;
        Bounds { min: DVec3::new(x.0, y.0, z.0), max: DVec3::new(x.1, y.1, z.1) }
    }

    /// Minimum and maximum of a linear function over the surface.
    fn range(&self, axis: DVec3) -> (f64, f64) {
        range(&self.hull, axis)
    }
}

fn range(points: &[DVec3], axis: DVec3) -> (f64, f64) {
    points
        .iter()
        .map(|point| axis.dot(*point))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
}

/// Points whose convex hull contains the surface.
fn hull(scene: &Scene, geometry: &Geometry, shape: Shape) -> Vec<DVec3> {
    match shape {
        Shape::Polygon { start, count } => scene.polygon_vertices(start, count).to_vec(),
        Shape::Ring(handle) => {
            let ring = scene.rings[handle];
            let (x, y) = ring.normal.any_orthonormal_pair();
            let corner = |a: f64, b: f64| ring.center + (x * a + y * b) * ring.outer_radius;
            vec![corner(1.0, 1.0), corner(-1.0, 1.0), corner(-1.0, -1.0), corner(1.0, -1.0)]
        }
        shape => geometry.bounds(scene, shape).map_or(Vec::new(), |bounds| bounds.corners().to_vec()),
    }
}

/// A light at finite distance, with what is the same for all receivers.
#[derive(Debug)]
struct Emitter {
    /// The index of its occluder.
    source: usize,
    /// For each occluder, whether it lies on the light and may therefore block it from everywhere.
    hidden_by: Vec<bool>,
}

impl Emitter {
    /// `None` for a distant light or a virtual source. A surface no farther from it than `touch`
    /// lies on it.
    fn new(light: &Light, occluders: &[Occluder], touch: f64) -> Option<Emitter> {
        if !light.virtual_sources.is_empty() || light.radius.is_infinite() {
            return None;
        }
        let source = occluders.iter().position(|other| other.surface == light.surface)?;
        let hidden_by = occluders.iter().map(|other| lies_on(&occluders[source], other, touch)).collect();
        Some(Emitter { source, hidden_by })
    }
}

/// The indices of occluders by the size of their bounds: most segments that are blocked at all are
/// blocked by large ones, which end the search.
fn largest_first(occluders: &[Occluder]) -> Vec<usize> {
    let size = |index: &usize| occluders[*index].bounds.iter().map(|(low, high)| high - low).sum::<f64>();
    let mut order: Vec<usize> = (0..occluders.len()).collect();
    order.sort_by(|one, other| size(other).total_cmp(&size(one)));
    order
}

/// An axis along which surfaces are compared.
#[derive(Clone, Copy)]
enum Axis {
    X,
    Y,
    Z,
    Other(DVec3),
}

impl Axis {
    /// Minimum and maximum of a surface along the axis.
    #[inline]
    fn range(self, occluder: &Occluder) -> (f64, f64) {
        match self {
            Axis::X => occluder.bounds[0],
            Axis::Y => occluder.bounds[1],
            Axis::Z => occluder.bounds[2],
            Axis::Other(axis) => occluder.range(axis),
        }
    }
}

/// The extent of the hull of a receiver and a light along an axis.
struct Extent {
    axis: Axis,
    /// A surface that ends below this, or begins above `above`, is beside the hull.
    below: f64,
    above: f64,
}

impl Extent {
    /// `None` if the hull has no extent along the axis, and so no inside. A surface that only
    /// touches a flat face of the hull is beside the segments, not between their ends.
    fn new(axis: Axis, ends: [&Occluder; 2], tolerance: f64) -> Option<Extent> {
        let [a, b] = ends.map(|end| axis.range(end));
        let (low, high) = (a.0.min(b.0), a.1.max(b.1));
        (high - low > 4.0 * tolerance).then_some(Extent { axis, below: low + tolerance, above: high - tolerance })
    }

    /// Whether a plane perpendicular to the axis separates the hull from the occluder, or contains
    /// it.
    fn leaves_out(&self, occluder: &Occluder) -> bool {
        let (low, high) = self.axis.range(occluder);
        high <= self.below || low >= self.above
    }
}

/// Whether a surface touches a flat light in more than an edge, judged by bounding boxes, and rings
/// by their circles: the boxes of neighbours in a ring of lamps overlap.
fn lies_on(source: &Occluder, other: &Occluder, touch: f64) -> bool {
    if let (Some((center, radius)), Some((other, other_radius))) = (source.ring, other.ring)
        && center.distance(other) > radius + other_radius + touch
    {
        return false;
    }
    let overlap = |axis: Axis| {
        let (a, b) = (axis.range(source), axis.range(other));
        a.1.min(b.1) - a.0.max(b.0)
    };
    let Some((normal, _)) = source.plane else { return false };
    let overlaps = [Axis::X, Axis::Y, Axis::Z].map(overlap);
    overlaps.iter().all(|overlap| *overlap >= -touch)
        && overlaps.iter().filter(|overlap| **overlap > touch).count() > 1
        && overlap(Axis::Other(normal)) >= -touch
}

/// Whether everything in front of a flat surface is a light.
fn sees_only_lights(occluder: &Occluder, occluders: &[Occluder], lights: &[Light], tolerance: f64) -> bool {
    let Some((normal, point)) = occluder.plane else { return false };
    let height = normal.dot(point);
    lights.iter().all(|light| light.virtual_sources.is_empty() && light.max_distance.is_infinite())
        && occluders.iter().all(|other| {
            let (low, high) = other.range(normal);
            let in_plane = low >= height - tolerance && high <= height + tolerance;
            // Both sides count: a ray can come from behind too.
            other.is_light || in_plane
        })
}

/// Whether every light has less solid angle than the highlight, from any point of the surface.
fn lights_are_small(occluder: &Occluder, lights: &[Light]) -> bool {
    lights.iter().all(|light| match light.form {
        LightForm::Distant { half_angle_sin_squared_half, .. } => {
            4.0 * PI * half_angle_sin_squared_half <= occluder.highlight
        }
        _ => {
            let nearest = match occluder.plane {
                Some((normal, point)) => normal.dot(light.center - point).abs() - light.radius,
                None => 0.0,
            };
            nearest > 0.0 && light.form.area() <= occluder.highlight * nearest * nearest
        }
    })
}
