//! Conservative tests of what may block the segments from a point to a ball: shafts (Haines and
//! Wallace 1991) that are exact for the curved primitives.

use crate::bounds::Bounds;
use crate::geometry::Geometry;
use crate::ids::MemberId;
use glam::DVec3;
use radsight_ir::{Cone, Ring, Shape, Sphere, ValidScene};

/// All segments from a point to a ball. At a share t of their lengths they are within t·radius of
/// the axis.
#[derive(Clone, Copy, Debug)]
pub struct Beam {
    /// Where all segments begin.
    pub from: DVec3,
    /// Centre of the ball.
    pub to: DVec3,
    /// Radius of the ball, scene units.
    pub radius: f64,
}

/// Two shares of the length of a beam, in order.
type Part = [f64; 2];

impl Beam {
    /// The part of the axis where segments may be between two heights above a plane, given the
    /// heights of both ends; `None` if there is none.
    fn between(&self, [start, end]: [f64; 2], [low, high]: [f64; 2]) -> Option<Part> {
        let rise = end - start;
        // start + t·(rise ± radius) is a limit of the heights.
        let above = part_below(low - start, rise + self.radius, -1.0)?;
        let below = part_below(high - start, rise - self.radius, 1.0)?;
        let part = [f64::max(above[0], below[0]), f64::min(above[1], below[1])];
        (part[0] <= part[1]).then_some(part)
    }

    /// Smallest and largest distance from an axis through the origin of segments within a part;
    /// `across` are the vectors from the axis to the two ends, perpendicular to it.
    fn distances(&self, [start, end]: [DVec3; 2], part: Part) -> [f64; 2] {
        let [first, last] = part.map(|share| start.lerp(end, share));
        let along = last - first;
        let share = (-first.dot(along) / along.length_squared()).clamp(0.0, 1.0);
        let nearest = if share.is_finite() { first + along * share } else { first };
        let spread = self.radius * part[1];
        [nearest.length() - spread, first.length().max(last.length()) + spread]
    }

    /// Whether no segment comes within `tolerance` of a box.
    #[must_use]
    pub fn misses_bounds(&self, bounds: &Bounds, tolerance: f64) -> bool {
        let mut part = [0.0, 1.0];
        for axis in 0..3 {
            let [start, end] = [self.from[axis], self.to[axis]];
            let Some([first, last]) =
                self.between([start, end], [bounds.min[axis] - tolerance, bounds.max[axis] + tolerance])
            else {
                return true;
            };
            part = [f64::max(part[0], first), f64::min(part[1], last)];
        }
        part[0] > part[1]
    }

    fn misses_sphere(&self, sphere: &Sphere, tolerance: f64) -> bool {
        let [nearest, farthest] = self.distances([self.from, self.to].map(|end| end - sphere.center), [0.0, 1.0]);
        nearest > sphere.radius + tolerance || farthest < sphere.radius - tolerance
    }

    fn misses_ring(&self, ring: &Ring, tolerance: f64) -> bool {
        let ends = [self.from, self.to].map(|end| end - ring.center);
        let heights = ends.map(|end| end.dot(ring.normal));
        let Some(part) = self.between(heights, [-tolerance, tolerance]) else { return true };
        let across = [0, 1].map(|index| ends[index] - ring.normal * heights[index]);
        let [nearest, farthest] = self.distances(across, part);
        nearest > ring.outer_radius + tolerance || farthest < ring.inner_radius - tolerance
    }

    fn misses_cone(&self, cone: &Cone, tolerance: f64) -> bool {
        let axis = cone.apex - cone.base;
        let length = axis.length();
        let axis = axis / length;
        let ends = [self.from, self.to].map(|end| end - cone.base);
        let heights = ends.map(|end| end.dot(axis));
        let Some(part) = self.between(heights, [-tolerance, length + tolerance]) else { return true };
        let across = [0, 1].map(|index| ends[index] - axis * heights[index]);
        let [nearest, farthest] = self.distances(across, part);
        nearest > cone.base_radius.max(cone.apex_radius) + tolerance
            || farthest < cone.base_radius.min(cone.apex_radius) - tolerance
    }
}

/// The part of [0, 1] where `sign·(rate·t − limit)` is at most 0.
fn part_below(limit: f64, rate: f64, sign: f64) -> Option<Part> {
    let (limit, rate) = (sign * limit, sign * rate);
    let part = if rate > 0.0 {
        [0.0, limit / rate]
    } else if rate < 0.0 {
        [limit / rate, 1.0]
    } else if limit >= 0.0 {
        [0.0, 1.0]
    } else {
        return None;
    };
    let part = [part[0].max(0.0), part[1].min(1.0)];
    (part[0] <= part[1]).then_some(part)
}

impl Geometry {
    /// Whether a member may block a segment of the beam: certainly not, if false.
    #[must_use]
    pub fn may_block(&self, scene: &ValidScene, member: MemberId, beam: &Beam) -> bool {
        let misses = match self.shapes[member.0 as usize] {
            Shape::Sphere(handle) => beam.misses_sphere(&scene.spheres[handle], self.tolerance),
            Shape::Ring(handle) => beam.misses_ring(&scene.rings[handle], self.tolerance),
            Shape::Cone(handle) => beam.misses_cone(&scene.cones[handle], self.tolerance),
            shape => self.bounds(scene, shape).is_some_and(|bounds| beam.misses_bounds(&bounds, self.tolerance)),
        };
        !misses
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::coincident::Substance;
    use crate::random::numbers;
    use crate::{Builder, Ray};
    use radsight_ir::{Facing, Scene, Surface};

    /// A scene of one surface.
    fn built(shape: impl FnOnce(&mut Scene) -> Shape) -> (ValidScene, Geometry) {
        let mut scene = Scene::default();
        let name = scene.names.add("part");
        let shape = shape(&mut scene);
        scene.surfaces.add(Surface { name, span: None, modifier: None, shape });
        let scene = scene.validate().unwrap().scene;
        let geometry = Geometry::build(&scene, |_, _| Substance::Opaque, |_| true, Builder::Quick).unwrap();
        (scene, geometry)
    }

    fn washer_wall(radius: f64) -> (ValidScene, Geometry) {
        built(|scene| {
            let apex = DVec3::new(0.0, 0.0, 2.0);
            let (base_radius, apex_radius) = (radius, radius);
            let wall = Cone { base: DVec3::ZERO, apex, base_radius, apex_radius, facing: Facing::Outward };
            Shape::Cone(scene.cones.add(wall))
        })
    }

    fn may_block((scene, geometry): &(ValidScene, Geometry), from: DVec3, to: DVec3, radius: f64) -> bool {
        geometry.may_block(scene, MemberId(0), &Beam { from, to, radius })
    }

    #[test]
    fn a_wall_blocks_beams_that_cross_it_alone() {
        let wall = washer_wall(6.0);
        let lamp = DVec3::new(10.0, 0.0, 480.0);
        assert!(!may_block(&wall, DVec3::ZERO, lamp, 2.5), "within the hole");
        assert!(!may_block(&wall, DVec3::new(5.9, 0.0, 0.0), DVec3::new(5.9, 0.0, 480.0), 2.5), "beside the wall");
        assert!(
            may_block(&wall, DVec3::new(5.995, 0.0, 0.0), DVec3::new(5.9, 0.0, 480.0), 2.5),
            "the rim is in the way"
        );
        assert!(may_block(&wall, DVec3::new(-6.01, 0.0, 0.0), lamp, 2.5), "leans over the wall");
        assert!(!may_block(&wall, DVec3::new(6.1, 0.0, 0.0), lamp, 2.5), "outside");
        assert!(may_block(&wall, DVec3::new(-20.0, 0.0, 1.0), DVec3::new(20.0, 0.0, 1.0), 0.1), "across");
        assert!(!may_block(&wall, DVec3::new(-20.0, 0.0, 3.0), DVec3::new(20.0, 0.0, 3.0), 0.9), "above");
    }

    #[test]
    fn a_ring_does_not_block_its_hole() {
        let ring = built(|scene| {
            let ring = Ring { center: DVec3::Z, normal: DVec3::Z, inner_radius: 1.0, outer_radius: 2.0 };
            Shape::Ring(scene.rings.add(ring))
        });
        let up = DVec3::new(0.0, 0.0, 10.0);
        assert!(!may_block(&ring, DVec3::ZERO, up, 4.0));
        assert!(may_block(&ring, DVec3::ZERO, up, 11.0));
        assert!(may_block(&ring, DVec3::new(1.5, 0.0, 0.0), up, 1.0));
        assert!(!may_block(&ring, DVec3::new(3.0, 0.0, 0.0), up, 1.0));
        assert!(!may_block(&ring, DVec3::new(0.0, 0.0, 1.1), up, 5.0), "begins and ends above it");
        assert!(may_block(&ring, DVec3::new(0.0, 0.0, 1.1), up, 30.0), "may end below it");
    }

    /// No ray of a beam that nothing may block hits anything.
    #[test]
    fn rays_of_free_beams_are_free() {
        let mut random = numbers(7);
        let [mut free, mut blocked] = [0; 2];
        for case in 0..3000 {
            let mut point = |size: f64| DVec3::new(random() - 0.5, random() - 0.5, random() - 0.5) * size;
            let (center, axis) = (point(1.0), point(2.0));
            let (from, to) = (point(4.0), point(4.0));
            let [a, b, radius] = [random() + 0.05, random() + 0.05, 0.4 * random()];
            let part = built(|scene| match case % 4 {
                0 => Shape::Sphere(scene.spheres.add(Sphere { center, radius: a, facing: Facing::Outward })),
                1 => {
                    let (inner_radius, normal) = (b.min(0.9 * a), axis.normalize());
                    Shape::Ring(scene.rings.add(Ring { center, normal, inner_radius, outer_radius: a }))
                }
                2 => {
                    let (base, apex, facing) = (center, center + axis, Facing::Inward);
                    Shape::Cone(scene.cones.add(Cone { base, apex, base_radius: a, apex_radius: b, facing }))
                }
                _ => {
                    let start = scene.vertices.len() as u32;
                    scene.vertices.extend([center, center + axis, center + axis.any_orthogonal_vector()]);
                    Shape::Polygon { start, count: 3 }
                }
            });
            if may_block(&part, from, to, radius) {
                blocked += 1;
                continue;
            }
            free += 1;
            for _ in 0..40 {
                let mut number = || 2.0 * random() - 1.0;
                let inside = DVec3::new(number(), number(), number());
                let target = to + inside * (radius / inside.length().max(1.0)) - from;
                let ray = Ray::new(from, target).unwrap();
                let met = part.1.distance(&part.0, &ray);
                assert!(met.is_none_or(|distance| distance > target.length()), "case {case}: {from} {to} {radius}");
            }
        }
        assert!(free > 500 && blocked > 500, "{free} {blocked}");
    }
}
