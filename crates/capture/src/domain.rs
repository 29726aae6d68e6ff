//! The two dimensions in which images of lights are searched and sampled.
//!
//! A ray of a pixel is a point on the pixel and a point on the pinhole. One of them, here `fixed`,
//! is sampled uniformly; the other, a point of the domain, is aimed at images. Where an image is
//! blurred over more than a pixel, points of the pinhole are aimed; in focus, points on the pixel.

use glam::DVec2;
use radsight_pinhole::{CameraRay, Hole, Rays};
use radsight_sampling::unit_disk;
use std::f64::consts::PI;

/// The domain whose points are chosen so that rays hit lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Domain {
    /// The pinhole, in its radii.
    Disk,
    /// The pixel.
    Square,
}

impl Domain {
    /// The middle of the pixel, for [`Domain::Disk`] the middle of the fixed points.
    pub(crate) const MIDDLE_OF_PIXEL: DVec2 = DVec2::splat(0.5);

    /// That of all images behind a hole, unless they are in focus.
    pub(crate) fn of(hole: Hole) -> Domain {
        if hole == Hole::Point { Domain::Square } else { Domain::Disk }
    }

    pub(crate) fn middle(self) -> DVec2 {
        if self == Domain::Square { Domain::MIDDLE_OF_PIXEL } else { DVec2::ZERO }
    }

    /// The middle of the fixed points.
    pub(crate) fn middle_of_fixed(self) -> DVec2 {
        if self == Domain::Square { DVec2::ZERO } else { Domain::MIDDLE_OF_PIXEL }
    }

    /// The fixed point and the point of the domain of a point on the pixel and one on the pinhole.
    pub(crate) fn fixed_and_drawn(self, on_pixel: DVec2, on_pinhole: DVec2) -> (DVec2, DVec2) {
        if self == Domain::Square { (on_pinhole, on_pixel) } else { (on_pixel, on_pinhole) }
    }

    /// The ray through a fixed point and a point of the domain.
    pub(crate) fn ray(self, rays: &Rays, pixel: u64, fixed: DVec2, at: DVec2) -> Option<CameraRay> {
        // The same exchange leads back.
        let (on_pixel, on_pinhole) = self.fixed_and_drawn(fixed, at);
        let on_pinhole = if rays.hole() == Hole::Point { DVec2::ZERO } else { on_pinhole };
        rays.ray_through(pixel, on_pixel.into(), on_pinhole.into())
    }

    /// A fixed point uniform by area.
    pub(crate) fn uniform_fixed(self, u: [f64; 2]) -> DVec2 {
        let of_other = if self == Domain::Square { Domain::Disk } else { Domain::Square };
        of_other.uniform(u)
    }

    /// A point uniform by area.
    pub(crate) fn uniform(self, u: [f64; 2]) -> DVec2 {
        match self {
            Domain::Disk => DVec2::from(unit_disk(u[0], u[1])),
            Domain::Square => DVec2::from(u),
        }
    }

    pub(crate) fn contains(self, at: DVec2) -> bool {
        match self {
            Domain::Disk => at.length_squared() <= 1.0,
            Domain::Square => at.cmpge(DVec2::ZERO).all() && at.cmplt(DVec2::ONE).all(),
        }
    }

    /// Whether a disk overlaps the domain.
    pub(crate) fn meets(self, center: DVec2, radius: f64) -> bool {
        match self {
            Domain::Disk => center.length() <= 1.0 + radius,
            Domain::Square => center.distance(center.clamp(DVec2::ZERO, DVec2::ONE)) <= radius,
        }
    }

    pub(crate) fn area(self) -> f64 {
        if self == Domain::Disk { PI } else { 1.0 }
    }
}
