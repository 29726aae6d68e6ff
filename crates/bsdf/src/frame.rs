//! Local frames of surfaces.

use glam::DVec3;

/// A right-handed frame with +z on a unit normal.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    x: DVec3,
    y: DVec3,
    /// The unit normal.
    pub z: DVec3,
}

/// A normal closer than this to the scene's z axis has no meridian.
const POLE: f64 = 1e-6;

impl Frame {
    /// A frame of arbitrary azimuth.
    #[inline]
    pub fn new(normal: DVec3) -> Frame {
        let (x, y) = normal.any_orthonormal_pair();
        Frame { x, y, z: normal }
    }

    /// The frame whose x axis is closest to `direction`; none if that is parallel to the normal.
    pub fn along(normal: DVec3, direction: DVec3) -> Option<Frame> {
        let y = normal.cross(direction).try_normalize()?;
        Some(Frame { x: y.cross(normal), y, z: normal })
    }

    /// The frame of a model without an orientation of its own: x is horizontal (perpendicular to
    /// the scene's z axis) and turns continuously with the surface. On a normal along z, x is the
    /// scene's x.
    pub fn level(normal: DVec3) -> Frame {
        let x = if normal.x.hypot(normal.y) > POLE { DVec3::Z.cross(normal) } else { DVec3::X };
        Frame::along(normal, x).unwrap_or_else(|| Frame::new(normal))
    }

    /// Transforms a vector from the scene to the frame.
    #[inline]
    pub fn to_local(self, v: DVec3) -> DVec3 {
        DVec3::new(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }

    /// Transforms a vector from the frame to the scene.
    #[inline]
    pub fn to_scene(self, v: DVec3) -> DVec3 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_frame_turns_with_the_normal_without_a_jump() {
        let normal = |azimuth: f64| DVec3::new(azimuth.cos(), azimuth.sin(), 0.7).normalize();
        for step in 0..1000 {
            let azimuth = f64::from(step) * 0.01;
            let (here, there) = (Frame::level(normal(azimuth)), Frame::level(normal(azimuth + 1e-4)));
            assert!(here.x.distance(there.x) < 2e-4 && here.y.distance(there.y) < 2e-4, "{azimuth}");
            assert!(here.x.z.abs() < 1e-12 && here.x.cross(here.y).distance(here.z) < 1e-12);
        }
        assert_eq!(Frame::level(DVec3::Z).x, DVec3::X);
    }
}
