//! What can stand between a light and a surface, and what a surface can see at all.
//!
//! Before the first ray every pair of a surface and a light is looked at: if no other surface reaches into the convex hull of the two,
//! no shadow ray is needed; if few do, only those are tested. A flat surface that has nothing but lights in front of it needs no ray to
//! find light by way of other surfaces. All tests are conservative: what is left out cannot change the picture.

use crate::shader::{Kind, Shader, Substitution};
use glam::DVec3;
use radsight_accel::{Geometry, MemberId, PrimitiveId, flat_normal};
use radsight_ir::{Scene, Shape, SurfaceHandle, ValidScene};
use radsight_light::{Light, LightForm};
use std::f64::consts::PI;

/// More pairs times surfaces than this are not looked at.
const MAX_TESTS: usize = 4_000_000;

/// More possible blockers than this are left to the hierarchy.
const MAX_BLOCKERS: usize = 4;

/// Surfaces within this share of the scene's size of a plane count as lying in it.
const IN_PLANE: f64 = 1e-9;

/// What stands between a surface and a light.
#[derive(Clone, Debug, PartialEq)]
pub enum VisibilityClass {
    /// The light shows the surface its back, or is too far: it gives nothing.
    Dark,
    /// Nothing.
    Nothing,
    /// At most these.
    Few(Vec<MemberId>),
    /// Anything.
    Anything,
}

/// What is known of one primitive.
#[derive(Clone, Debug)]
pub struct Receiver {
    /// By light.
    pub between: Vec<VisibilityClass>,
    /// Everything in front of it is a sampled light.
    pub sees_only_lights: bool,
    /// And every light is smaller than its highlight, so that sampling the lights alone is best.
    pub lights_suffice: bool,
}

/// What is known of all primitives; empty where the scene is too large to look at every pair.
#[derive(Debug, Default)]
pub struct Visibility {
    receivers: Vec<Receiver>,
}

impl Visibility {
    /// Knows nothing, so that everything is computed.
    pub fn everything() -> Visibility {
        Visibility::default()
    }

    /// Finds out what stands between the surfaces and lights of a scene; `unsampled_light` says whether light comes from elsewhere too.
    pub fn new<'a>(
        scene: &ValidScene,
        geometry: &Geometry,
        shader: impl Fn(SurfaceHandle) -> &'a Shader,
        lights: &[Light],
        unsampled_light: bool,
    ) -> Visibility {
        let count = geometry.len();
        if count.saturating_mul(count).saturating_mul(lights.len().max(1)) > MAX_TESTS {
            return Visibility::everything();
        }
        let bodies: Vec<Body> = geometry
            .members()
            .map(|(member, handle)| Body::new(scene, geometry, member, &shader(handle).kind, lights))
            .collect();
        let (_, radius) = geometry.bounding_sphere();
        let tolerance = IN_PLANE * radius;
        let emitters: Vec<Option<Emitter>> =
            lights.iter().map(|light| Emitter::new(light, &bodies, geometry.tolerance())).collect();
        let receivers = bodies
            .iter()
            .map(|body| Receiver {
                between: emitters
                    .iter()
                    .map(|emitter| match emitter {
                        Some(emitter) => between(body, emitter, &bodies, tolerance),
                        None => VisibilityClass::Anything,
                    })
                    .collect(),
                sees_only_lights: !unsampled_light && sees_only_lights(body, &bodies, lights, tolerance),
                lights_suffice: lights_are_small(body, lights),
            })
            .collect();
        Visibility { receivers }
    }

    /// What is known of a primitive.
    #[inline]
    pub fn receiver(&self, primitive: PrimitiveId) -> Option<&Receiver> {
        self.receivers.get(primitive.0 as usize)
    }

    /// Counts of what is saved, in words.
    pub fn summary(&self) -> [(usize, &'static str, &'static str); 4] {
        let pairs = |kind: fn(&VisibilityClass) -> bool| {
            self.receivers.iter().map(|receiver| receiver.between.iter().filter(|b| kind(b)).count()).sum()
        };
        let direct_only =
            self.receivers.iter().filter(|receiver| receiver.sees_only_lights && receiver.lights_suffice).count();
        [
            (
                pairs(|b| *b == VisibilityClass::Dark),
                "pairs of surface and light are skipped",
                "the light turns its back",
            ),
            (
                pairs(|b| *b == VisibilityClass::Nothing),
                "pairs of surface and light need no shadow ray",
                "nothing reaches into the space between them",
            ),
            (
                pairs(|b| matches!(b, VisibilityClass::Few(_))),
                "pairs of surface and light test a few surfaces only",
                "no other reaches into the space between them",
            ),
            (
                direct_only,
                "surfaces sample the lights alone",
                "nothing but lights is in front of them, each smaller than the highlight",
            ),
        ]
    }
}

/// A surface as the tests see it.
struct Body {
    member: MemberId,
    surface: SurfaceHandle,
    /// Points whose convex hull holds the surface.
    hull: Vec<DVec3>,
    /// Front normal and a point, if it is flat.
    plane: Option<(DVec3, DVec3)>,
    is_light: bool,
    /// Solid angle of the narrowest highlight, sr.
    highlight: f64,
}

impl Body {
    fn new(scene: &Scene, geometry: &Geometry, member: MemberId, kind: &Kind, lights: &[Light]) -> Body {
        let surface = geometry.surface_of(member);
        let shape = scene.surfaces[surface].shape;
        let hull = hull(scene, geometry, shape);
        let plane = flat_normal(scene, shape).map(|normal| (normal, hull[0]));
        // What stands in for an illum is seen from behind.
        let is_seen = matches!(kind, Kind::Illum { substitute: Substitution::Shader(_), .. });
        let samples = |light: &Light| light.surface == surface && light.max_distance.is_infinite();
        let is_light = !is_seen && lights.iter().any(samples);
        let highlight = match kind {
            Kind::Glossy(glossy) | Kind::Retro(glossy) => 4.0 * PI * glossy.roughness * glossy.roughness,
            _ => 0.0,
        };
        Body { member, surface, hull, plane, is_light, highlight }
    }

    /// Lowest and highest value of a linear function over the surface.
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

/// Points whose convex hull holds a surface.
fn hull(scene: &Scene, geometry: &Geometry, shape: Shape) -> Vec<DVec3> {
    match shape {
        Shape::Polygon { start, count } => scene.vertices[start as usize..][..count as usize].to_vec(),
        Shape::Ring(handle) => {
            let ring = scene.rings[handle];
            let (x, y) = ring.normal.any_orthonormal_pair();
            let corner = |a: f64, b: f64| ring.center + (x * a + y * b) * ring.outer_radius;
            vec![corner(1.0, 1.0), corner(-1.0, 1.0), corner(-1.0, -1.0), corner(1.0, -1.0)]
        }
        shape => geometry.bounds(scene, shape).map_or(Vec::new(), |bounds| bounds.corners().to_vec()),
    }
}

/// A light with a place, and what is known of it for all receivers.
struct Emitter<'a> {
    light: &'a Light,
    source: &'a Body,
    /// Of each body whether it lies on the light, so that it may hide it from everywhere.
    hidden_by: Vec<bool>,
}

impl Emitter<'_> {
    /// None for a distant light and an image. What is no farther from it than `touch` lies on it.
    fn new<'a>(light: &'a Light, bodies: &'a [Body], touch: f64) -> Option<Emitter<'a>> {
        if !light.virtual_sources.is_empty() || light.radius.is_infinite() {
            return None;
        }
        let source = bodies.iter().find(|other| other.surface == light.surface)?;
        let hidden_by = bodies.iter().map(|other| lies_on(source, other, touch)).collect();
        Some(Emitter { light, source, hidden_by })
    }
}

/// What can stand between a body and a light.
fn between(body: &Body, emitter: &Emitter, bodies: &[Body], tolerance: f64) -> VisibilityClass {
    let Emitter { light, source, hidden_by } = emitter;
    if body.surface == light.surface {
        return VisibilityClass::Anything;
    }
    if let Some((normal, point)) = light.form.plane()
        && body.range(normal).1 <= normal.dot(point) + tolerance
    {
        return VisibilityClass::Dark;
    }
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].into_iter();
    let normals = [body, *source].into_iter().filter_map(|of| of.plane.map(|(normal, _)| normal));
    let extents: Vec<Extent> =
        axes.chain(normals).filter_map(|axis| Extent::new(axis, [body, *source], tolerance)).collect();
    let blockers: Vec<MemberId> = bodies
        .iter()
        .zip(hidden_by)
        .filter(|(other, _)| other.surface != light.surface)
        .filter(|(other, _)| other.member != body.member || body.plane.is_none())
        .filter(|(other, hides)| **hides || !extents.iter().any(|extent| extent.leaves_out(other)))
        .map(|(other, _)| other.member)
        .take(MAX_BLOCKERS + 1)
        .collect();
    match blockers.len() {
        0 => VisibilityClass::Nothing,
        1..=MAX_BLOCKERS => VisibilityClass::Few(blockers),
        _ => VisibilityClass::Anything,
    }
}

/// How far the hull of a receiver and a light extends along an axis.
struct Extent {
    axis: DVec3,
    /// What ends below this, or begins above, stands beside the hull.
    below: f64,
    above: f64,
}

impl Extent {
    /// What only touches the hull where the hull itself is flat stands beside the segments, not between their ends; a hull
    /// without extent along the axis has no inside to reach into.
    fn new(axis: DVec3, ends: [&Body; 2], tolerance: f64) -> Option<Extent> {
        let [a, b] = ends.map(|end| end.range(axis));
        let (low, high) = (a.0.min(b.0), a.1.max(b.1));
        (high - low > 4.0 * tolerance).then_some(Extent { axis, below: low + tolerance, above: high - tolerance })
    }

    /// Whether a plane perpendicular to the axis has the hull on one side and the body on the other, or in it.
    fn leaves_out(&self, body: &Body) -> bool {
        let (low, high) = body.range(self.axis);
        high <= self.below || low >= self.above
    }
}

/// Whether a body touches a flat light in more than an edge, as far as the boxes around them tell.
fn lies_on(source: &Body, other: &Body, touch: f64) -> bool {
    let overlap = |axis: DVec3| {
        let (a, b) = (source.range(axis), other.range(axis));
        a.1.min(b.1) - a.0.max(b.0)
    };
    let Some((normal, _)) = source.plane else { return false };
    let overlaps = [DVec3::X, DVec3::Y, DVec3::Z].map(overlap);
    overlap(normal) >= -touch
        && overlaps.iter().all(|overlap| *overlap >= -touch)
        && overlaps.iter().filter(|overlap| **overlap > touch).count() > 1
}

/// Whether all that lies in front of a flat body is lights.
fn sees_only_lights(body: &Body, bodies: &[Body], lights: &[Light], tolerance: f64) -> bool {
    let Some((normal, point)) = body.plane else { return false };
    let height = normal.dot(point);
    lights.iter().all(|light| light.virtual_sources.is_empty() && light.max_distance.is_infinite())
        && bodies.iter().all(|other| {
            let (low, high) = other.range(normal);
            let in_plane = low >= height - tolerance && high <= height + tolerance;
            // Both sides count: a ray can come from behind too.
            other.is_light || in_plane
        })
}

/// Whether every light covers less solid angle than the highlight, from wherever on the body it is seen.
fn lights_are_small(body: &Body, lights: &[Light]) -> bool {
    lights.iter().all(|light| match light.form {
        LightForm::Distant { half_angle_sin_squared_half, .. } => {
            4.0 * PI * half_angle_sin_squared_half <= body.highlight
        }
        _ => {
            let nearest = match body.plane {
                Some((normal, point)) => normal.dot(light.center - point).abs() - light.radius,
                None => 0.0,
            };
            nearest > 0.0 && light.form.area() <= body.highlight * nearest * nearest
        }
    })
}
