//! Axis-aligned boxes.

use glam::DVec3;
use radsight_ir::Transform;

/// An axis-aligned box in double precision.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounds {
    /// The corner with the smallest coordinates.
    pub min: DVec3,
    /// The corner with the largest coordinates.
    pub max: DVec3,
}

impl Bounds {
    pub(crate) fn point(point: DVec3) -> Bounds {
        Bounds { min: point, max: point }
    }

    /// The box around this and another one.
    #[must_use]
    pub fn union(self, other: Bounds) -> Bounds {
        Bounds { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether another box is within this one.
    #[must_use]
    pub fn contains(&self, other: &Bounds) -> bool {
        self.min.cmple(other.min).all() && self.max.cmpge(other.max).all()
    }

    pub(crate) fn around(center: DVec3, half: DVec3) -> Bounds {
        Bounds { min: center - half, max: center + half }
    }

    /// The bounding box of this box after a transform.
    pub(crate) fn transformed(self, transform: &Transform) -> Bounds {
        let corners = self.corners().map(|corner| transform.point(corner));
        corners[1..].iter().fold(Bounds::point(corners[0]), |bounds, corner| bounds.union(Bounds::point(*corner)))
    }

    /// The eight corners.
    #[must_use]
    pub fn corners(self) -> [DVec3; 8] {
        std::array::from_fn(|index| {
            let pick = |bit: usize, low: f64, high: f64| if index >> bit & 1 == 0 { low } else { high };
            DVec3::new(
                pick(0, self.min.x, self.max.x),
                pick(1, self.min.y, self.max.y),
                pick(2, self.min.z, self.max.z),
            )
        })
    }

    /// The largest absolute coordinate.
    pub(crate) fn reach(self) -> f64 {
        self.min.abs().max(self.max.abs()).max_element()
    }
}
