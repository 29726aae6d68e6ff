//! Curved mirrors, whose reflections of lights and of retroreflected light no light sampling finds.

use crate::shader::{Kind, Shader};
use glam::DVec3;
use radsight_accel::{Bounds, Geometry, MemberId, Ray, RayFrame, flat_normal, is_flat};
use radsight_bsdf::Scatterer;
use radsight_ir::{Shape, SurfaceHandle, ValidScene};
use radsight_texture::reflect;

/// Tangent of the angle from the retroreflection direction within which mirrors are searched. It
/// covers lamps at four times a camera's distance from its light ring.
const REACH: f64 = 0.1;

/// Maximum number of mirrors; more become one group.
const MOST: usize = 64;

/// Bounding sphere of a mirror, or of a group of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflector {
    center: DVec3,
    radius: f64,
    /// `None` for a group, or if it is not known.
    member: Option<MemberId>,
}

impl Reflector {
    /// Around the bounds of one mirror, or of a group without a member.
    #[must_use]
    pub fn around(bounds: Bounds, member: Option<MemberId>) -> Reflector {
        Reflector { center: 0.5 * (bounds.min + bounds.max), radius: 0.5 * bounds.min.distance(bounds.max), member }
    }

    /// Whether a ray hits it if nothing is in front of it. Always true without a member.
    #[must_use]
    pub fn is_hit(&self, geometry: &Geometry, scene: &ValidScene, ray: &Ray) -> bool {
        let hits =
            |member| geometry.any_of_member(scene, member, (ray, &RayFrame::new(ray)), None, f64::INFINITY, |_| true);
        self.member.is_none_or(hits)
    }

    /// Unit direction towards it from a point outside, and the tangent of its half angle.
    #[must_use]
    pub fn cone(&self, from: DVec3) -> Option<(DVec3, f64)> {
        let offset = self.center - from;
        let distance = offset.length();
        (distance > self.radius)
            .then(|| (offset / distance, self.radius / (distance * distance - self.radius * self.radius).sqrt()))
    }

    /// Whether part of it may be within 0.1 rad of the unit direction from a point.
    #[inline]
    #[must_use]
    pub fn is_near(&self, from: DVec3, direction: DVec3) -> bool {
        let offset = self.center - from;
        let along = offset.dot(direction);
        let farthest = along + self.radius;
        if farthest <= 0.0 {
            return false;
        }
        let reach = self.radius + REACH * farthest;
        (offset - direction * along).length_squared() <= reach * reach
    }
}

/// Maximum number of flat reflectors, and of their pairs with lights.
const MOST_FLAT: usize = 64;
const MOST_FLAT_PAIRS: usize = 4096;

/// The plane of a flat specular surface that makes no virtual sources: a pane, a polished or a
/// dielectric surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatReflector {
    point: DVec3,
    /// Unit.
    normal: DVec3,
}

impl FlatReflector {
    /// The mirror image of a point.
    #[must_use]
    pub fn image_of_point(&self, point: DVec3) -> DVec3 {
        self.point + self.image_of_direction(point - self.point)
    }

    /// The mirror image of a direction.
    #[must_use]
    pub fn image_of_direction(&self, direction: DVec3) -> DVec3 {
        reflect(direction, self.normal)
    }
}

/// The flat specular surfaces of a scene that make no virtual sources.
#[derive(Clone, Debug, Default)]
pub struct FlatReflectors {
    /// Without those in instances; empty if there are too many for a search.
    pub surfaces: Vec<FlatReflector>,
    /// Whether all panes of the scene are among them, and plain.
    pub hold_all_panes: bool,
}

/// Finds the flat specular surfaces.
pub(crate) fn find_flat_reflectors<'a>(
    scene: &ValidScene,
    geometry: &Geometry,
    shaders: &[Shader],
    shader: impl Fn(SurfaceHandle) -> &'a Shader,
    lights: usize,
) -> FlatReflectors {
    let is_specular = |kind: &Kind, shape| matches!(kind, Kind::Glass { .. }) || mirrors(kind, shape);
    let mut found = FlatReflectors { surfaces: Vec::new(), hold_all_panes: true };
    if !shaders.iter().any(|shader| is_specular(&shader.kind, None)) {
        return found;
    }
    for (_, handle) in geometry.listed_members() {
        let (shape, shader) = (scene.surfaces[handle].shape, shader(handle));
        let is_pane = matches!(shader.kind, Kind::Glass { .. });
        found.hold_all_panes &= !is_pane || shader.is_plain_pane();
        let point = match shape {
            Shape::Polygon { start, .. } => scene.polygon_vertices(start, 1)[0],
            Shape::Ring(ring) => scene.rings[ring].center,
            // The contents of meshes and instances are not examined.
            _ => {
                found.hold_all_panes &= !(is_pane || matches!(shape, Shape::Mesh(_) | Shape::Instance(_)));
                continue;
            }
        };
        let is_found = is_specular(&shader.kind, Some(shape));
        let Some(normal) = flat_normal(scene, shape).filter(|_| is_found) else { continue };
        if found.surfaces.len() == MOST_FLAT || (found.surfaces.len() + 1) * lights > MOST_FLAT_PAIRS {
            return FlatReflectors::default();
        }
        found.surfaces.push(FlatReflector { point, normal });
    }
    found
}

/// Mirrors of a scene that make no virtual sources.
pub(crate) fn find_reflectors<'a>(
    scene: &ValidScene,
    geometry: &Geometry,
    shaders: &[Shader],
    shader: impl Fn(SurfaceHandle) -> &'a Shader,
) -> Vec<Reflector> {
    if !shaders.iter().any(|shader| mirrors(&shader.kind, None)) {
        return Vec::new();
    }
    let is_mirror = |handle: SurfaceHandle| match scene.surfaces[handle].shape {
        // Their contents are not examined.
        Shape::Mesh(_) | Shape::Instance(_) => true,
        shape => mirrors(&shader(handle).kind, Some(shape)),
    };
    let mirrors: Vec<(MemberId, SurfaceHandle)> =
        geometry.listed_members().filter(|(_, handle)| is_mirror(*handle)).collect();
    let bounds = |(_, handle): &(MemberId, SurfaceHandle)| geometry.bounds(scene, scene.surfaces[*handle].shape);
    if mirrors.len() > MOST {
        let around = |a: Bounds, b: Bounds| Bounds { min: a.min.min(b.min), max: a.max.max(b.max) };
        let group = mirrors.iter().filter_map(bounds).reduce(around);
        return group.map(|bounds| Reflector::around(bounds, None)).into_iter().collect();
    }
    let reflector = |mirror: &(MemberId, SurfaceHandle)| match scene.surfaces[mirror.1].shape {
        Shape::Sphere(sphere) => {
            let sphere = &scene.spheres[sphere];
            Some(Reflector { center: sphere.center, radius: sphere.radius, member: Some(mirror.0) })
        }
        _ => bounds(mirror).map(|bounds| Reflector::around(bounds, Some(mirror.0))),
    };
    mirrors.iter().filter_map(reflector).collect()
}

/// Whether a surface, of any shape if none is given, may reflect specularly in a way that light
/// sampling does not cover.
fn mirrors(kind: &Kind, shape: Option<Shape>) -> bool {
    match kind {
        Kind::Mirror { substitute, .. } => substitute.is_none() && !shape.is_some_and(is_flat),
        Kind::Glossy(glossy) => glossy.is_smooth() && glossy.specularity > 0.0,
        Kind::Scatterer(scatterer) => !matches!(**scatterer, Scatterer::Measured(_)) && scatterer.may_be_specular(),
        // Even a few per cent of a lamp are the brightest that a camera sees.
        Kind::Dielectric(_) => true,
        _ => false,
    }
}
