//! What stands on the surface around a record, and hides it from the points behind.
//!
//! A record next to a wall must not be used on the other side of it. The record's own gather rays
//! tell in which directions, and from which distance on, something may be in between; only there
//! the caller is asked ([`Occluders`]). Ward's programs mark such directions, too, and trace a ray
//! there (Radiance's `ambient.c`, corrals).
//!
//! Nor must a record on a panel be used on the wall behind it, whose normal is the same. A record
//! that is higher than a point hides from it if something lies above the point.

use crate::emitter::GatherHit;
use crate::stored::{Stored, StoredBytes};
use glam::DVec3;
use std::f64::consts::PI;

/// What hides points of surfaces from each other.
pub trait Occluders: Sync {
    /// Whether something opaque that stands on the surface separates `to` from the point `from`,
    /// whose unit normal is given.
    fn separate(&self, from: DVec3, normal: DVec3, to: DVec3) -> bool;

    /// Whether something opaque lies above the point `from` of a surface, up to this height along its
    /// unit normal.
    fn cover(&self, from: DVec3, normal: DVec3, height: f64) -> bool;
}

/// No occluders: all points see each other.
#[derive(Clone, Copy, Debug)]
pub struct Unobstructed;

impl Occluders for Unobstructed {
    fn separate(&self, _from: DVec3, _normal: DVec3, _to: DVec3) -> bool {
        false
    }

    fn cover(&self, _from: DVec3, _normal: DVec3, _height: f64) -> bool {
        false
    }
}

/// The distances from a record within its tangent plane to what stands around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Obstacles {
    /// By sector of the tangent plane; infinite where nothing was found.
    distances: [f32; SECTORS],
}

/// Number of sectors of the tangent plane.
const SECTORS: usize = 16;

/// Hits count up to this sine of their elevation above the tangent plane squared: 45 degrees.
/// Whatever stands on the surface is hit by such rays, and most of what hangs above it is not.
const MAX_SQUARED_ELEVATION: f64 = 0.5;

/// Something may be in between from this fraction of the distance to the nearest hit on: rays may
/// have missed its nearest point.
const MARGIN: f64 = 0.5;

impl Obstacles {
    /// Nothing.
    pub(crate) const NONE: Self = Obstacles { distances: [f32::INFINITY; SECTORS] };

    /// From the hits of all rays of a record with this frame.
    pub(crate) fn new<const BANDS: usize>([x, y, normal]: [DVec3; 3], hits: &[GatherHit<BANDS>]) -> Self {
        let mut obstacles = Obstacles::NONE;
        // Rays of a hemisphere are about so far apart.
        let (sine, cosine) = (PI / hits.len().max(1) as f64).sqrt().sin_cos();
        for hit in hits.iter().filter(|hit| hit.distance.is_finite()) {
            let elevation = hit.direction.dot(normal);
            if elevation * elevation > MAX_SQUARED_ELEVATION {
                continue;
            }
            let distance = (hit.distance * (1.0 - elevation * elevation).sqrt()) as f32;
            let [x, y] = [x, y].map(|axis| hit.direction.dot(axis));
            let [across, up] = [sine * x, sine * y];
            let [along, aside] = [cosine * x, cosine * y];
            for (x, y) in [(along + up, aside - across), (x, y), (along - up, aside + across)] {
                let nearest = &mut obstacles.distances[sector(x, y)];
                *nearest = nearest.min(distance);
            }
        }
        obstacles
    }

    /// Adds those of further rays from the same position.
    pub(crate) fn add(&mut self, other: &Obstacles) {
        for (nearest, other) in self.distances.iter_mut().zip(other.distances) {
            *nearest = nearest.min(other);
        }
    }

    /// Whether the obstacles may hide the record from a point at this offset in its tangent plane.
    pub(crate) fn may_hide(&self, x: f64, y: f64) -> bool {
        let nearest = MARGIN * f64::from(self.distances[sector(x, y)]);
        x * x + y * y > nearest * nearest
    }

    /// Whether restored distances are possible.
    pub(crate) fn is_usable(&self) -> bool {
        self.distances.iter().all(|distance| *distance >= 0.0)
    }
}

/// The sector of a direction: quarters of the square around the origin in equal parts, which needs
/// no angle.
fn sector(x: f64, y: f64) -> usize {
    let sum = x.abs() + y.abs();
    if sum == 0.0 {
        return 0;
    }
    let share = y / sum;
    // From 0 to 4, starting at -y.
    let turn = if x >= 0.0 { 1.0 + share } else { 3.0 - share };
    ((turn * (0.25 * SECTORS as f64)) as usize).min(SECTORS - 1)
}

impl Stored for Obstacles {
    fn store(&self, bytes: &mut Vec<u8>) {
        self.distances.store(bytes);
    }

    fn restore(bytes: &mut StoredBytes<'_>) -> Option<Self> {
        Some(Obstacles { distances: Stored::restore(bytes)? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hit(direction: DVec3, distance: f64) -> GatherHit<1> {
        GatherHit { direction: direction.normalize(), distance, normal: None, irradiance: [1.0] }
    }

    #[test]
    fn sectors_go_around_once() {
        let mut counts = [0; SECTORS];
        for step in 0..3600 {
            let (sine, cosine) = (f64::from(step) * 0.1_f64.to_radians()).sin_cos();
            counts[sector(cosine, sine)] += 1;
        }
        assert!(counts.iter().all(|count| (150..300).contains(count)), "{counts:?}");
        assert_eq!(sector(0.0, 0.0), 0);
    }

    #[test]
    fn a_wall_hides_only_what_is_behind_it() {
        // A wall in the plane x = 1, hit by rays near the surface, and a ceiling above.
        let mut hits: Vec<_> = (-8..9).map(|y| f64::from(y) * 0.1).map(|y| hit(DVec3::new(1.0, y, 0.3), 1.1)).collect();
        hits.push(hit(DVec3::new(-0.1, 0.0, 1.0), 0.5));
        hits.push(hit(DVec3::new(-1.0, 0.0, 0.1), f64::INFINITY));
        let obstacles = Obstacles::new([DVec3::X, DVec3::Y, DVec3::Z], &hits);
        assert!(obstacles.may_hide(1.2, 0.0) && obstacles.may_hide(1.2, 0.5));
        assert!(!obstacles.may_hide(0.4, 0.0) && !obstacles.may_hide(-9.0, 0.0) && !obstacles.may_hide(0.0, 0.0));
        let mut both = Obstacles::NONE;
        both.add(&obstacles);
        assert!(both == obstacles && both.is_usable());
    }
}
