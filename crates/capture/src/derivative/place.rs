//! The four dimensions over which the light of a pixel is integrated.

use glam::{DVec2, DVec4};
use radsight_pinhole::{CameraRay, Rays};
use radsight_sampling::unit_disk;
use std::f64::consts::TAU;

/// A point of the pixel and one of the pinhole, which together are a ray: x and y from the pixel's
/// left and top in pixels, z and w from the pinhole's centre in its radii along (right, up). Velocities
/// and distances are in these units, too.
pub(super) type Place = DVec4;

/// The middle of pixel and pinhole.
pub(super) const MIDDLE: Place = DVec4::new(0.5, 0.5, 0.0, 0.0);

/// A point of the boundary.
pub(super) struct Border {
    pub(super) at: Place,
    /// Outward, unit.
    pub(super) normal: Place,
    /// Size of the boundary divided by that of what it encloses.
    pub(super) share: f64,
}

/// Draws a point of the boundary by random numbers.
pub(super) type DrawBorder = fn([f64; 4]) -> Border;

pub(super) fn ray(rays: &Rays, pixel: u64, at: Place) -> Option<CameraRay> {
    rays.ray_through(pixel, [at.x, at.y], [at.z, at.w])
}

/// A place uniform by area.
pub(super) fn uniform([a, b, c, d]: [f64; 4]) -> Place {
    let (right, up) = unit_disk(c, d);
    DVec4::new(a, b, right, up)
}

/// A place uniform on the sides of the pixel and on the pinhole.
pub(super) fn on_sides([a, _, c, d]: [f64; 4]) -> Border {
    let along = (4.0 * a).fract();
    let (on_pixel, normal) = match (4.0 * a) as u32 {
        0 => (DVec2::new(0.0, along), DVec4::NEG_X),
        1 => (DVec2::new(1.0, along), DVec4::X),
        2 => (DVec2::new(along, 0.0), DVec4::NEG_Y),
        _ => (DVec2::new(along, 1.0), DVec4::Y),
    };
    let (right, up) = unit_disk(c, d);
    Border { at: DVec4::new(on_pixel.x, on_pixel.y, right, up), normal, share: 4.0 }
}

/// A place uniform on the pixel and on the rim of the pinhole.
pub(super) fn on_rim([a, b, c, _]: [f64; 4]) -> Border {
    let (up, right) = (TAU * c).sin_cos();
    Border { at: DVec4::new(a, b, right, up), normal: DVec4::new(0.0, 0.0, right, up), share: 2.0 }
}
