//! Similarity transforms, as made by `xform`.

use glam::{DMat3, DVec3};

/// A rotation or reflection, uniform scale and translation: `p ↦ scale·rotation·p + translation`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Orthonormal matrix; its determinant is −1 for a reflection.
    pub rotation: DMat3,
    /// Uniform scale, above zero.
    pub scale: f64,
    /// Translation, scene units.
    pub translation: DVec3,
}

impl Default for Transform {
    fn default() -> Self {
        Transform::IDENTITY
    }
}

impl Transform {
    /// The identity.
    pub const IDENTITY: Transform = Transform { rotation: DMat3::IDENTITY, scale: 1.0, translation: DVec3::ZERO };

    /// Transforms a point.
    #[must_use]
    pub fn point(&self, point: DVec3) -> DVec3 {
        self.rotation * point * self.scale + self.translation
    }

    /// Transforms a unit direction; the length is preserved.
    #[must_use]
    pub fn direction(&self, direction: DVec3) -> DVec3 {
        self.rotation * direction
    }

    /// This transform followed by `next`.
    #[must_use]
    pub fn then(&self, next: &Transform) -> Transform {
        Transform {
            rotation: next.rotation * self.rotation,
            scale: next.scale * self.scale,
            translation: next.point(self.translation),
        }
    }

    /// The inverse transform.
    #[must_use]
    pub fn inverse(&self) -> Transform {
        let rotation = self.rotation.transpose();
        let scale = 1.0 / self.scale;
        Transform { rotation, scale, translation: rotation * -self.translation * scale }
    }

    /// Whether it reverses handedness.
    #[must_use]
    pub fn is_mirror_image(&self) -> bool {
        self.rotation.determinant() < 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_undoes() {
        let transform = Transform {
            rotation: DMat3::from_rotation_z(0.3) * DMat3::from_rotation_x(1.1),
            scale: 2.5,
            translation: DVec3::new(1.0, -2.0, 3.0),
        };
        let point = DVec3::new(0.2, 0.4, -7.0);
        assert!(transform.then(&transform.inverse()).point(point).distance(point) < 1e-12);
        assert!(transform.inverse().point(transform.point(point)).distance(point) < 1e-12);
    }
}
