//! The pyramid of all rays between a point and a convex quadrilateral.
//!
//! Haines and Wallace, "Shaft Culling for Efficient Ray-Traced Radiosity", Eurographics Workshop on
//! Rendering 1991.

use glam::{DVec3, Vec3};

/// Four sides, the base, and the plane through the apex.
pub(crate) const SIDES: usize = 6;

/// Index of the base.
const BASE: usize = 4;

/// Smallest sine of the angle between the quadrilateral's plane and the direction to it.
const MIN_SINE: f64 = 1e-6;

/// A pyramid from a point to a convex quadrilateral.
#[derive(Clone, Copy, Debug)]
pub struct Shaft {
    apex: DVec3,
    /// Inward unit normals, and their dot product with a point of the side relative to the apex.
    sides: [(DVec3, f64); SIDES],
    /// The centre and the radius of the disk in the quadrilateral that alone matters.
    disk: Option<(DVec3, f64)>,
}

impl Shaft {
    /// The shaft from a point to the vertices of a convex quadrilateral, in order; `None` if the
    /// point is nearly in its plane.
    #[must_use]
    pub fn new(apex: DVec3, corners: [DVec3; 4]) -> Option<Shaft> {
        let corners = corners.map(|corner| corner - apex);
        let center = corners.iter().sum::<DVec3>() * 0.25;
        let base = (corners[2] - corners[0]).cross(corners[3] - corners[1]).try_normalize()?;
        let base = if base.dot(center) > 0.0 { -base } else { base };
        let height = base.dot(center);
        if -height < MIN_SINE * center.length() {
            return None;
        }
        let mut sides = [(DVec3::ZERO, 0.0); SIDES];
        for (index, side) in sides[..BASE].iter_mut().enumerate() {
            let normal = corners[index].cross(corners[(index + 1) % BASE]).try_normalize()?;
            *side = (if normal.dot(center) < 0.0 { -normal } else { normal }, 0.0);
        }
        sides[BASE] = (base, height);
        sides[BASE + 1] = (-base, 0.0);
        Some(Shaft { apex, sides, disk: None })
    }

    /// The same around the rays to a disk alone, which lies in the quadrilateral.
    #[must_use]
    pub fn to_disk(self, center: DVec3, radius: f64) -> Shaft {
        Shaft { disk: Some((center, radius)), ..self }
    }

    /// Whether a disk lies in the plane of the base, without overlapping the disk there: lamps of a
    /// ring beside each other.
    pub(crate) fn has_beside_it(&self, (center, normal, radius): (DVec3, DVec3, f64), tolerance: f64) -> bool {
        let (base, height) = self.sides[BASE];
        let is_in_plane = (base.dot(center - self.apex) - height).abs() <= tolerance
            && radius * base.cross(normal).length() <= tolerance;
        let is_apart = |(own, own_radius): (DVec3, f64)| own.distance(center) >= own_radius + radius + tolerance;
        is_in_plane && self.disk.is_some_and(is_apart)
    }

    /// The sides relative to another point in single precision: normals, and offsets that are
    /// negative outside.
    pub(crate) fn about(&self, center: DVec3) -> [(Vec3, f32); SIDES] {
        let apex = self.apex - center;
        self.sides.map(|(normal, offset)| (normal.as_vec3(), (-normal.dot(apex) - offset) as f32))
    }

    /// Whether all points are outside one side. Points on a side count as outside, those on the
    /// base as inside.
    pub(crate) fn excludes(&self, points: &[DVec3], tolerance: f64) -> bool {
        self.sides.iter().enumerate().any(|(index, (normal, offset))| {
            let slack = if index == BASE { -tolerance } else { tolerance };
            points.iter().all(|point| normal.dot(*point - self.apex) - offset < slack)
        })
    }
}
