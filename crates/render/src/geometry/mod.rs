//! Exact intersections under a bounding volume hierarchy.
//!
//! The hierarchy is in single precision about the scene's centre, with boxes padded by more than its rounding; what it
//! proposes is decided in double precision. A ray that starts far outside is first moved to the scene's bounding sphere.

mod cone;
mod disk;
mod polygon;
mod sphere;

use crate::ray::{Hit, PrimitiveId, Ray};
use glam::{DVec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::ray::{Ray as BoxRay, RayHit};
use radsight_ir::{Scene, Shape, SurfaceHandle, ValidScene};

pub(crate) use polygon::RayFrame;

/// Padding of boxes as a share of the scene's size: well above the rounding of single precision in the slab tests.
const BOX_PADDING: f64 = 2e-6;

/// A hit nearer than this share of the scene's largest coordinate is the surface that the ray starts from.
const SELF_HIT: f64 = 1e-10;

/// Fewer primitives than this are tested one by one.
const LIST_IS_FASTER: usize = 6;

/// All surfaces that a ray can hit at a finite distance.
#[derive(Debug)]
pub(crate) struct Geometry {
    /// The surface of each primitive.
    surfaces: Vec<SurfaceHandle>,
    bvh: CwBvh,
    center: DVec3,
    radius: f64,
    nearest: f64,
}

impl Geometry {
    /// `wanted` tells which surfaces can matter at all.
    pub(crate) fn build(scene: &Scene, wanted: impl Fn(SurfaceHandle) -> bool) -> Geometry {
        let mut surfaces = Vec::new();
        let mut boxes = Vec::new();
        for (handle, surface) in scene.surfaces.iter() {
            if !wanted(handle) {
                continue;
            }
            if let Some(bounds) = bounds(scene, surface.shape) {
                surfaces.push(handle);
                boxes.push(bounds);
            }
        }
        let whole = boxes.iter().copied().reduce(|a: Bounds, b| a.union(b)).unwrap_or(Bounds::point(DVec3::ZERO));
        let center = (whole.min + whole.max) * 0.5;
        let radius = 0.5 * (whole.max - whole.min).length();
        let padding = DVec3::splat(BOX_PADDING * radius);
        let padded: Vec<Aabb> = boxes
            .iter()
            .map(|bounds| {
                let low = bounds.min - center - padding;
                let high = bounds.max - center + padding;
                Aabb::new(Vec3A::from(low.as_vec3()), Vec3A::from(high.as_vec3()))
            })
            .collect();
        let bvh = if padded.len() < LIST_IS_FASTER {
            CwBvh::default()
        } else {
            build_cwbvh(&padded, BvhBuildParams::medium_build(), &mut Default::default())
        };
        let reach = whole.min.abs().max(whole.max.abs()).max_element();
        Geometry { surfaces, bvh, center, radius, nearest: SELF_HIT * reach }
    }

    /// Centre and radius of a sphere around all surfaces.
    pub(crate) fn bounding_sphere(&self) -> (DVec3, f64) {
        (self.center, self.radius)
    }

    /// How many primitives there are.
    pub(crate) fn len(&self) -> usize {
        self.surfaces.len()
    }

    /// The surfaces, by primitive.
    pub(crate) fn surfaces(&self) -> impl Iterator<Item = (PrimitiveId, SurfaceHandle)> {
        self.surfaces.iter().enumerate().map(|(index, handle)| (PrimitiveId(index as u32), *handle))
    }

    /// The first surface along the ray, `from` excluded where it is flat.
    pub(crate) fn first_hit(&self, scene: &ValidScene, ray: &Ray, from: Option<PrimitiveId>) -> Option<Hit> {
        let frame = RayFrame::new(ray);
        let mut best: Option<(f64, PrimitiveId)> = None;
        let mut farthest = f64::INFINITY;
        self.visit(ray, f64::INFINITY, |primitive| {
            if let Some(distance) = self.intersect(scene, primitive, ray, &frame, from, farthest) {
                farthest = distance;
                best = Some((distance, primitive));
            }
            farthest
        });
        let (distance, primitive) = best?;
        let surface = self.surfaces[primitive.0 as usize];
        let point = ray.at(distance);
        let (point, front) = surface_point(scene, scene.surfaces[surface].shape, point);
        Some(Hit { distance, primitive, surface, point, front })
    }

    /// Visits the primitives that a ray may meet before `limit`, until `visit` returns a limit below zero.
    fn visit(&self, ray: &Ray, limit: f64, mut visit: impl FnMut(PrimitiveId) -> f64) {
        if self.bvh.nodes.is_empty() {
            for index in 0..self.surfaces.len() {
                if visit(PrimitiveId(index as u32)) < 0.0 {
                    return;
                }
            }
            return;
        }
        let from_center = ray.origin - self.center;
        let along = from_center.dot(ray.direction);
        // A start outside twice the bounding sphere moves up to it: single precision is for what is near.
        let skip = if from_center.length_squared() > 4.0 * self.radius * self.radius {
            (-along - 1.5 * self.radius).max(0.0)
        } else {
            0.0
        };
        let start = from_center + ray.direction * skip;
        let to_single = |distance: f64| ((distance - skip).max(0.0) as f32).next_up();
        let box_ray = BoxRay::new(
            Vec3A::from(start.as_vec3()),
            Vec3A::from(ray.direction.as_vec3()),
            0.0,
            to_single(limit).min(f32::MAX),
        );
        let indices = &self.bvh.primitive_indices;
        let mut hit = RayHit::none();
        self.bvh.ray_traverse(box_ray, &mut hit, |_, slot| to_single(visit(PrimitiveId(indices[slot]))));
    }

    /// Distance to one primitive, if it lies after the start and before `farthest`.
    #[inline]
    pub(crate) fn intersect(
        &self,
        scene: &ValidScene,
        primitive: PrimitiveId,
        ray: &Ray,
        frame: &RayFrame,
        from: Option<PrimitiveId>,
        farthest: f64,
    ) -> Option<f64> {
        let range = self.nearest..farthest;
        match scene.surfaces[self.surfaces[primitive.0 as usize]].shape {
            // A flat surface is never met again by a ray that starts on it.
            _ if from == Some(primitive) && self.is_flat(scene, primitive) => None,
            Shape::Polygon { start, count } => {
                let vertices = &scene.vertices[start as usize..][..count as usize];
                polygon::intersect(vertices, ray, frame, range)
            }
            Shape::Sphere(handle) => sphere::intersect(&scene.spheres[handle], ray, range),
            Shape::Cone(handle) => cone::intersect(&scene.cones[handle], ray, range),
            Shape::Ring(handle) => disk::intersect(&scene.rings[handle], ray, range),
            Shape::Source(_) | Shape::Mesh(_) | Shape::Instance(_) => None,
        }
    }

    /// The surface of a primitive.
    pub(crate) fn surface_of(&self, primitive: PrimitiveId) -> SurfaceHandle {
        self.surfaces[primitive.0 as usize]
    }

    /// A point of a primitive, moved onto it where that is cheap, and the unit normal there on the front side.
    pub(crate) fn surface_at(&self, scene: &ValidScene, primitive: PrimitiveId, point: DVec3) -> (DVec3, DVec3) {
        surface_point(scene, scene.surfaces[self.surface_of(primitive)].shape, point)
    }

    fn is_flat(&self, scene: &ValidScene, primitive: PrimitiveId) -> bool {
        is_flat(scene.surfaces[self.surfaces[primitive.0 as usize]].shape)
    }

    /// Calls `block` for each surface between `origin` and `origin + direction·distance`, until it returns true.
    pub(crate) fn any_between(
        &self,
        scene: &ValidScene,
        ray: &Ray,
        from: Option<PrimitiveId>,
        distance: f64,
        mut block: impl FnMut(PrimitiveId, SurfaceHandle, f64) -> bool,
    ) -> bool {
        let frame = RayFrame::new(ray);
        let mut blocked = false;
        self.visit(ray, distance, |primitive| {
            if blocked {
                return -1.0;
            }
            if let Some(at) = self.intersect(scene, primitive, ray, &frame, from, distance)
                && block(primitive, self.surfaces[primitive.0 as usize], at)
            {
                blocked = true;
                return -1.0;
            }
            distance
        });
        blocked
    }
}

/// Whether all of a surface lies in one plane.
pub(crate) fn is_flat(shape: Shape) -> bool {
    matches!(shape, Shape::Polygon { .. } | Shape::Ring(_))
}

/// The point moved onto the surface where that is cheap, and the unit normal on the front side.
fn surface_point(scene: &Scene, shape: Shape, point: DVec3) -> (DVec3, DVec3) {
    match shape {
        Shape::Polygon { start, count } => {
            (point, polygon::normal(&scene.vertices[start as usize..][..count as usize]))
        }
        Shape::Sphere(handle) => sphere::surface_point(&scene.spheres[handle], point),
        Shape::Cone(handle) => (point, cone::normal(&scene.cones[handle], point)),
        Shape::Ring(handle) => (point, scene.rings[handle].normal),
        Shape::Source(_) | Shape::Mesh(_) | Shape::Instance(_) => (point, DVec3::Z),
    }
}

/// The front normal of a flat surface.
pub(crate) fn flat_normal(scene: &Scene, shape: Shape) -> Option<DVec3> {
    is_flat(shape).then(|| surface_point(scene, shape, DVec3::ZERO).1)
}

/// An axis-aligned box in double precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    pub(crate) min: DVec3,
    pub(crate) max: DVec3,
}

impl Bounds {
    fn point(point: DVec3) -> Bounds {
        Bounds { min: point, max: point }
    }

    pub(crate) fn union(self, other: Bounds) -> Bounds {
        Bounds { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    fn around(center: DVec3, half: DVec3) -> Bounds {
        Bounds { min: center - half, max: center + half }
    }

    /// The eight corners.
    pub(crate) fn corners(self) -> [DVec3; 8] {
        std::array::from_fn(|index| {
            let pick = |bit: usize, low: f64, high: f64| if index >> bit & 1 == 0 { low } else { high };
            DVec3::new(
                pick(0, self.min.x, self.max.x),
                pick(1, self.min.y, self.max.y),
                pick(2, self.min.z, self.max.z),
            )
        })
    }
}

/// The box around a surface; none for what has no place.
pub(crate) fn bounds(scene: &Scene, shape: Shape) -> Option<Bounds> {
    match shape {
        Shape::Polygon { start, count } => {
            let vertices = &scene.vertices[start as usize..][..count as usize];
            vertices.iter().map(|vertex| Bounds::point(*vertex)).reduce(Bounds::union)
        }
        Shape::Sphere(handle) => {
            let sphere = &scene.spheres[handle];
            Some(Bounds::around(sphere.center, DVec3::splat(sphere.radius)))
        }
        Shape::Cone(handle) => {
            let cone = &scene.cones[handle];
            let reach = disk::reach((cone.apex - cone.base).normalize());
            let base = Bounds::around(cone.base, reach * cone.base_radius);
            Some(base.union(Bounds::around(cone.apex, reach * cone.apex_radius)))
        }
        Shape::Ring(handle) => {
            let ring = &scene.rings[handle];
            Some(Bounds::around(ring.center, disk::reach(ring.normal) * ring.outer_radius))
        }
        Shape::Source(_) | Shape::Mesh(_) | Shape::Instance(_) => None,
    }
}

/// Unit normal of a polygon, if it has an area.
pub(crate) fn polygon_normal(vertices: &[DVec3]) -> Option<DVec3> {
    polygon::area_vector(vertices).try_normalize()
}
