//! Axis-aligned boxes in the scene, and their intersection with rays.

use glam::DVec3;
use radsight_render::Ray;

/// An axis-aligned box, scene units. Empty if a low coordinate is above the high one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// The corner with the smallest coordinates.
    pub low: DVec3,
    /// The corner with the largest coordinates.
    pub high: DVec3,
}

/// The region that a virtual source lights through its plane mirror or prism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LitRegion {
    /// The mirror or prism.
    pub mirror: Region,
    /// Centre of the virtual source, scene units.
    pub image: DVec3,
    /// Radius of a sphere around the virtual source, scene units.
    pub radius: f64,
}

impl Region {
    /// The empty region.
    pub const EMPTY: Region = Region { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    /// Extends the region to a point.
    pub fn add(&mut self, point: DVec3) {
        self.low = self.low.min(point);
        self.high = self.high.max(point);
    }

    /// The smallest box that contains both.
    #[must_use]
    pub fn union(&self, other: &Region) -> Region {
        Region { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Whether they have a point in common.
    #[must_use]
    pub fn meets(&self, other: &Region) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }

    /// The region enlarged by a margin on each side, scene units.
    #[must_use]
    pub fn grown(&self, margin: f64) -> Region {
        Region { low: self.low - margin, high: self.high + margin }
    }

    /// Extends the region by the part of a ray, up to a distance, that lies in another box.
    pub(crate) fn add_segment(&mut self, ray: &Ray, distance: f64, within: &Region) {
        let [a, b] = [within.low, within.high].map(|corner| (corner - ray.origin) / ray.direction);
        // On an axis perpendicular to the ray, the ray stays inside or outside. Exactly in the
        // plane of a side 0/0 is NaN, and the comparisons ignore the axis.
        let (near, far) = [(a.x, b.x), (a.y, b.y), (a.z, b.z)]
            .into_iter()
            .fold((0.0_f64, distance), |(near, far), (a, b)| (near.max(a.min(b)), far.min(a.max(b))));
        if near <= far && far.is_finite() {
            self.add(ray.at(near));
            self.add(ray.at(far));
        }
    }

    /// Centre and radius of the bounding sphere; `None` if the region is empty.
    pub(crate) fn sphere(&self) -> Option<(DVec3, f64)> {
        let is_empty = !self.low.cmple(self.high).all();
        (!is_empty).then(|| (0.5 * (self.low + self.high), 0.5 * self.low.distance(self.high)))
    }
}

impl LitRegion {
    /// Whether a point of a sphere may see the virtual source, by bounding spheres of it and the mirror.
    pub(crate) fn reaches(&self, (from, from_radius): (DVec3, f64)) -> bool {
        let Some((mirror, mirror_radius)) = self.mirror.sphere() else { return false };
        let way = self.image - from;
        let share = ((mirror - from).dot(way) / way.length_squared()).clamp(0.0, 1.0);
        let miss = (from + way * share).distance(mirror);
        // With a distance of zero nothing can be excluded.
        miss.is_nan() || miss <= mirror_radius + from_radius.max(self.radius)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Region = Region { low: DVec3::ZERO, high: DVec3::ONE };

    fn crossed(origin: [f64; 3], direction: [f64; 3], distance: f64) -> Region {
        let mut region = Region::EMPTY;
        let ray = Ray { origin: DVec3::from(origin), direction: DVec3::from(direction) };
        region.add_segment(&ray, distance, &UNIT);
        region
    }

    #[test]
    fn a_segment_is_clipped_at_both_ends() {
        let region = crossed([0.5, 0.5, 3.0], [0.0, 0.0, -1.0], 2.25);
        assert_eq!(region, Region { low: DVec3::new(0.5, 0.5, 0.75), high: DVec3::new(0.5, 0.5, 1.0) });
        assert_eq!(crossed([0.5, 0.5, 3.0], [0.0, 0.0, -1.0], f64::INFINITY).low.z, 0.0);
        assert_eq!(crossed([0.5, 0.5, 0.5], [0.0, 0.0, 1.0], f64::INFINITY).low.z, 0.5);
    }

    #[test]
    fn a_segment_that_misses_a_box_adds_nothing() {
        assert_eq!(crossed([1.5, 0.5, 3.0], [0.0, 0.0, -1.0], 9.0), Region::EMPTY);
        assert_eq!(crossed([0.5, 0.5, 3.0], [0.0, 0.0, -1.0], 1.5), Region::EMPTY);
        assert_eq!(crossed([0.5, 0.5, 3.0], [0.0, 0.0, 1.0], f64::INFINITY), Region::EMPTY);
        assert!(!Region::EMPTY.meets(&UNIT));
    }

    #[test]
    fn a_virtual_source_lights_what_sees_it_through_the_mirror() {
        let mirror = Region { low: DVec3::new(-1.0, -1.0, 0.0), high: DVec3::new(1.0, 1.0, 0.0) };
        let light = LitRegion { mirror, image: DVec3::new(0.0, 0.0, -10.0), radius: 0.1 };
        let at = |x: f64, z: f64| Region { low: DVec3::new(x, 0.0, z), high: DVec3::new(x + 0.1, 0.1, z) };
        let is_lit = |region: Region| region.sphere().is_some_and(|sphere| light.reaches(sphere));
        assert!(is_lit(at(1.0, 10.0)));
        assert!(!is_lit(at(9.0, 10.0)));
        assert!(!is_lit(at(0.0, -3.0)), "between the mirror and the image nothing is lit");
        assert!(!is_lit(Region::EMPTY));
    }
}
