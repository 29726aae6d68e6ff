//! Shaft culling: one query of the hierarchy replaces all rays from a point to a flat cover of a
//! light.
//!
//! The query is conservative: it may report an occluder where there is none, never the other way
//! round.

use crate::bounds::Bounds;
use crate::geometry::Geometry;
use crate::ids::{MemberId, PrimitiveId};
use crate::shaft::Shaft;
use radsight_ir::{Shape, ValidScene};

impl Geometry {
    /// Whether anything overlaps a shaft, other than the two primitives at its ends.
    #[must_use]
    pub fn reaches_into(&self, scene: &ValidScene, shaft: &Shaft, ends: [Option<PrimitiveId>; 2]) -> bool {
        self.hierarchy.any_in(shaft, |slot| {
            let member = MemberId(slot);
            let is_end = self.is_plain(member) && ends.contains(&Some(member.primitive()));
            !is_end && !self.is_outside(scene, shaft, member)
        })
    }

    fn is_outside(&self, scene: &ValidScene, shaft: &Shaft, member: MemberId) -> bool {
        match self.shapes[member.0 as usize] {
            Shape::Polygon { start, count } => shaft.excludes(scene.polygon_vertices(start, count), self.tolerance),
            Shape::Ring(handle)
                if shaft.has_beside_it(
                    (scene.rings[handle].center, scene.rings[handle].normal, scene.rings[handle].outer_radius),
                    self.tolerance,
                ) =>
            {
                true
            }
            shape => {
                let bounds = self.bounds(scene, shape).map(Bounds::corners);
                bounds.is_none_or(|corners| shaft.excludes(&corners, self.tolerance))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Builder;
    use crate::coincident::Substance;
    use crate::random::numbers;
    use glam::DVec3;
    use radsight_ir::{Facing, Ring, Scene, Sphere, Surface};

    const LAMP: [DVec3; 4] = [
        DVec3::new(-1.0, -1.0, 2.0),
        DVec3::new(1.0, -1.0, 2.0),
        DVec3::new(1.0, 1.0, 2.0),
        DVec3::new(-1.0, 1.0, 2.0),
    ];

    fn scene(balls: &[(DVec3, f64)]) -> (ValidScene, Geometry) {
        let mut scene = Scene::default();
        let name = scene.names.add("ball");
        for &(center, radius) in balls {
            let ball = scene.spheres.add(Sphere { center, radius, facing: Facing::Outward });
            scene.surfaces.add(Surface { name, span: None, modifier: None, shape: Shape::Sphere(ball) });
        }
        let scene = scene.validate().unwrap().scene;
        let geometry = Geometry::build(&scene, |_, _| Substance::Opaque, |_| true, Builder::Quick).unwrap();
        (scene, geometry)
    }

    fn reaches_in(balls: &[(DVec3, f64)]) -> bool {
        let (scene, geometry) = scene(balls);
        geometry.reaches_into(&scene, &Shaft::new(DVec3::ZERO, LAMP).unwrap(), [None; 2])
    }

    #[test]
    fn an_occluder_overlaps_the_shaft() {
        assert!(reaches_in(&[(DVec3::new(0.0, 0.0, 1.0), 0.1)]));
        assert!(reaches_in(&[(DVec3::new(0.55, 0.0, 1.0), 0.1)]));
        assert!(reaches_in(&[(DVec3::new(-0.9, 0.9, 2.0), 0.05)]));
    }

    #[test]
    fn other_surfaces_do_not_overlap_the_shaft() {
        let beside = (DVec3::new(0.8, 0.0, 1.0), 0.1);
        let beyond = (DVec3::new(0.0, 0.0, 2.5), 0.3);
        let below = (DVec3::new(0.0, 0.0, -0.5), 0.3);
        assert!(!reaches_in(&[beside, beyond, below]));
    }

    #[test]
    fn the_primitives_at_the_ends_are_ignored() {
        let (scene, geometry) = scene(&[(DVec3::new(0.0, 0.0, 1.0), 0.1)]);
        let shaft = Shaft::new(DVec3::ZERO, LAMP).unwrap();
        assert!(!geometry.reaches_into(&scene, &shaft, [None, Some(PrimitiveId(0))]));
    }

    /// Two lamps of a ring, whose bounding squares overlap.
    #[test]
    fn a_disk_beside_a_disk_in_its_plane_does_not_block() {
        let mut scene = Scene::default();
        let name = scene.names.add("lamp");
        let blocks = |center: DVec3, normal: DVec3| {
            let mut scene = scene.clone();
            let ring = scene.rings.add(Ring { center, normal, inner_radius: 0.0, outer_radius: 1.0 });
            scene.surfaces.add(Surface { name, span: None, modifier: None, shape: Shape::Ring(ring) });
            let scene = scene.validate().unwrap().scene;
            let geometry = Geometry::build(&scene, |_, _| Substance::Opaque, |_| true, Builder::Quick).unwrap();
            let shaft = Shaft::new(DVec3::ZERO, LAMP).unwrap().to_disk(2.0 * DVec3::Z, 1.0);
            geometry.reaches_into(&scene, &shaft, [None; 2])
        };
        assert!(!blocks(DVec3::new(1.5, 1.5, 2.0), -DVec3::Z));
        assert!(blocks(DVec3::new(1.3, 1.3, 2.0), -DVec3::Z));
        assert!(blocks(DVec3::new(1.5, 1.5, 1.9), -DVec3::Z));
        // Perpendicular to the plane it reaches into the shaft, in the plane it does not.
        let beside = DVec3::new(0.9, 1.8, 2.0);
        assert!(blocks(beside, DVec3::X) && !blocks(beside, DVec3::Z));
    }

    #[test]
    fn a_point_in_the_plane_of_the_cover_has_no_shaft() {
        assert!(Shaft::new(DVec3::new(3.0, 0.0, 2.0), LAMP).is_none());
    }

    /// If nothing overlaps the shaft, no ray to the cover hits anything.
    #[test]
    fn no_ray_is_blocked_in_an_empty_shaft() {
        let mut random = numbers(1);
        let mut empty = 0;
        for _ in 0..400 {
            let balls: [(DVec3, f64); 3] = std::array::from_fn(|_| {
                (DVec3::new(3.0 * random() - 1.5, 3.0 * random() - 1.5, 2.0 * random()), 0.2 * random())
            });
            let (scene, geometry) = scene(&balls);
            let shaft = Shaft::new(DVec3::ZERO, LAMP).unwrap();
            if geometry.reaches_into(&scene, &shaft, [None; 2]) {
                continue;
            }
            empty += 1;
            for _ in 0..64 {
                let target = DVec3::new(2.0 * random() - 1.0, 2.0 * random() - 1.0, 2.0);
                let ray = crate::Ray::new(DVec3::ZERO, target).unwrap();
                let met = geometry.distance(&scene, &ray);
                assert!(met.is_none_or(|distance| distance > target.length()), "{balls:?} {target}");
            }
        }
        assert!(empty > 40, "{empty} of 400 are empty");
    }
}
