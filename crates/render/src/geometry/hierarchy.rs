//! The hierarchy of boxes.
//!
//! It is in single precision about the centre of what it holds, with boxes padded by more than its rounding; what it proposes is
//! decided in double precision. A ray that starts far outside is first moved to the bounding sphere.

use super::bounds::Bounds;
use crate::ray::Ray;
use glam::{DVec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::ray::{Ray as BoxRay, RayHit};

/// Padding of boxes as a share of the size of the whole: well above the rounding of single precision in the slab tests.
const BOX_PADDING: f64 = 2e-6;

/// Fewer items than this are tested one by one.
const LIST_IS_FASTER: usize = 6;

/// Boxes in boxes around items that are numbered from 0.
#[derive(Debug)]
pub(super) struct Hierarchy {
    bvh: CwBvh,
    items: u32,
    bounds: Bounds,
    center: DVec3,
    radius: f64,
}

impl Hierarchy {
    pub(super) fn build(boxes: &[Bounds]) -> Hierarchy {
        let bounds = boxes.iter().copied().reduce(Bounds::union).unwrap_or(Bounds::point(DVec3::ZERO));
        let center = (bounds.min + bounds.max) * 0.5;
        let radius = 0.5 * (bounds.max - bounds.min).length();
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
        Hierarchy { bvh, items: boxes.len() as u32, bounds, center, radius }
    }

    /// The box around all items.
    pub(super) fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Centre and radius of a sphere around all items.
    pub(super) fn bounding_sphere(&self) -> (DVec3, f64) {
        (self.center, self.radius)
    }

    /// Visits the items that a ray may meet before `limit`, until `visit` returns a limit below zero.
    pub(super) fn visit(&self, ray: &Ray, limit: f64, mut visit: impl FnMut(u32) -> f64) {
        if self.bvh.nodes.is_empty() {
            for index in 0..self.items {
                if visit(index) < 0.0 {
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
        self.bvh.ray_traverse(box_ray, &mut hit, |_, slot| to_single(visit(indices[slot])));
    }
}
