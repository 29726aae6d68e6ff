//! The rays of a view's pixels.

use glam::DVec3;
use radsight_picture::{View, ViewKind};
use radsight_render::{Ray, RaySpacing, RayWorker, Traced};
use radsight_sampling::{DimensionSet, RaySampler, unit_disk};
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_8;

/// Generates the rays of a picture.
///
/// ```
/// use radsight_film::ViewCamera;
/// use radsight_picture::{View, ViewOptions};
/// let camera = ViewCamera::new(View::new(ViewOptions::default()).unwrap(), 3, 3);
/// let ray = camera.central_ray(1, 1).unwrap();
/// assert!(ray.direction.distance(glam::DVec3::Y) < 1e-15);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ViewCamera {
    view: View,
    columns: usize,
    rows: usize,
    /// Side of the square over which rays are distributed, in pixels (`-pj`). Default 0: all rays
    /// pass through the centre.
    pub jitter: f64,
    /// Diameter of the aperture in scene units (`-pd`); the focal distance is the length of the
    /// view direction. Default 0.
    pub aperture: f64,
    /// The view of the previous frame, and the fraction of the motion from it during which the
    /// shutter is open (`-pm`). Default none.
    pub motion: Option<(View, f64)>,
}

/// A ray through a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraRay {
    /// The origin, scene units.
    pub origin: DVec3,
    /// Unit.
    pub direction: DVec3,
    /// Distance of the aft clipping plane, scene units; `None` without one.
    pub length: Option<f64>,
}

impl ViewCamera {
    /// The camera of a view with this number of columns and rows.
    #[must_use]
    pub fn new(view: View, columns: usize, rows: usize) -> ViewCamera {
        ViewCamera { view, columns, rows, jitter: 0.0, aperture: 0.0, motion: None }
    }

    /// Columns.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The view.
    #[must_use]
    pub fn view(&self) -> &View {
        &self.view
    }

    /// Whether rays of a pixel start at different points or times.
    pub(crate) fn is_blurred(&self) -> bool {
        self.aperture > 0.0 || self.motion.is_some()
    }

    /// The same camera with rays over whole pixels.
    pub(crate) fn whole_pixels(&self) -> ViewCamera {
        ViewCamera { jitter: 1.0, ..*self }
    }

    /// The ray through the centre of a pixel and the centre of the aperture; `None` outside the
    /// view. Row 0 is the top.
    #[must_use]
    pub fn central_ray(&self, column: usize, row: usize) -> Option<CameraRay> {
        self.view_ray(&self.view, self.place(column, row, [0.5, 0.5]))
    }

    /// One ray through each square of `side` pixels, top row first, for the irradiance-cache
    /// pre-pass. Avoids the centres, which in a symmetric view lie exactly on the edges of a room.
    #[must_use]
    pub fn prepass_rays(&self, side: usize) -> Vec<Option<Ray>> {
        let side = side.max(1);
        let [across, down] = [self.columns.div_ceil(side), self.rows.div_ceil(side)];
        // The R₂ sequence (Roberts 2018) distributes the points evenly over the squares.
        let ray = |square: usize| {
            let [right, up] =
                [0.754_877_666_246_692_8, 0.569_840_290_998_053_3].map(|step| (square as f64 * step).fract());
            let column = (((square % across) as f64 + right) * side as f64).min(self.columns as f64);
            let below = self.rows as f64 - ((square / across + 1) * side) as f64;
            let from_bottom = (below + side as f64 * up).max(0.0);
            self.view_ray(&self.view, [column / self.columns as f64, from_bottom / self.rows as f64])
        };
        let squares = (0..across * down).into_par_iter();
        squares.map(|square| ray(square).and_then(|ray| Ray::new(ray.origin, ray.direction))).collect()
    }

    /// Spacing of the rays of neighbouring squares of `side` pixels, at the centre of the picture.
    #[must_use]
    pub fn spread(&self, side: usize) -> RaySpacing {
        let (column, row) = (self.columns / 2, self.rows / 2);
        let beside =
            [[0.5, 0.5], [1.5, 0.5], [0.5, 1.5]].map(|at| self.view_ray(&self.view, self.pixel_place(column, row, at)));
        let [Some(ray), Some(right), Some(above)] = beside else { return RaySpacing::UNKNOWN };
        let apart = |of: fn(&CameraRay) -> DVec3| 0.5 * (of(&right).distance(of(&ray)) + of(&above).distance(of(&ray)));
        let side = side.max(1) as f64;
        RaySpacing { width: side * apart(|ray| ray.origin), angle: side * apart(|ray| ray.direction) }
    }

    /// A ray at the sampler's point of pixel, aperture and time; `None` outside the view.
    #[must_use]
    pub fn ray(&self, column: usize, row: usize, sampler: &RaySampler) -> Option<CameraRay> {
        self.ray_of(column, row, sampler.take(DimensionSet::CAMERA), sampler)
    }

    /// The same for another point of pixel and aperture in the unit cube.
    pub(crate) fn ray_of(
        &self,
        column: usize,
        row: usize,
        [x, y, across, along]: [f64; 4],
        sampler: &RaySampler,
    ) -> Option<CameraRay> {
        self.ray_at(self.place(column, row, [x, y]), [across, along], sampler)
    }

    /// The ray through a point of the unit square over which the rays of a pixel are distributed,
    /// and the centre of the aperture, without motion.
    pub(crate) fn still_ray(&self, column: usize, row: usize, at: [f64; 2]) -> Option<CameraRay> {
        self.view_ray(&self.view, self.place(column, row, at))
    }

    /// A ray through any point of the view, (0, 0) the lower left corner and (1, 1) the upper
    /// right, distributed like those of pixels.
    #[must_use]
    pub fn ray_near(&self, [x, y]: [f64; 2], sampler: &RaySampler) -> Option<CameraRay> {
        let [right, up, across, along] = sampler.take(DimensionSet::CAMERA);
        let place = [x + self.jittered(right) / self.columns as f64, y + self.jittered(up) / self.rows as f64];
        self.ray_at(place, [across, along], sampler)
    }

    /// The ray through a point of the view, (0, 0) the lower left corner and (1, 1) the upper right,
    /// and a point of the unit square for the aperture, without motion. An aperture with depth has
    /// that of its middle.
    #[must_use]
    pub fn ray_through(&self, place: [f64; 2], aperture: [f64; 2]) -> Option<CameraRay> {
        let ray = self.view_ray(&self.view, place)?;
        if self.aperture > 0.0 { self.through_aperture(&ray, aperture, 0.5) } else { Some(ray) }
    }

    /// The point of the view of a sample of a pixel.
    fn place(&self, column: usize, row: usize, [x, y]: [f64; 2]) -> [f64; 2] {
        self.pixel_place(column, row, [0.5 + self.jittered(x), 0.5 + self.jittered(y)])
    }

    /// The point of the view of an offset from the lower left corner of a pixel, in pixels.
    fn pixel_place(&self, column: usize, row: usize, [right, up]: [f64; 2]) -> [f64; 2] {
        let from_left = column as f64 + right;
        let from_bottom = (self.rows - 1 - row) as f64 + up;
        [from_left / self.columns as f64, from_bottom / self.rows as f64]
    }

    fn jittered(&self, u: f64) -> f64 {
        self.jitter * (u - 0.5)
    }

    fn ray_at(&self, place: [f64; 2], aperture: [f64; 2], sampler: &RaySampler) -> Option<CameraRay> {
        let mut ray = self.view_ray(&self.view, place)?;
        if self.motion.is_none() && self.aperture <= 0.0 {
            return Some(ray);
        }
        let [time, depth, ..] = sampler.take(DimensionSet::SHUTTER);
        if let Some((before, share)) = &self.motion
            && let Some(earlier) = self.view_ray(before, place)
        {
            ray = between(&ray, &earlier, share * (0.5 - time))?;
        }
        if self.aperture > 0.0 { self.through_aperture(&ray, aperture, depth) } else { Some(ray) }
    }

    fn view_ray(&self, view: &View, place: [f64; 2]) -> Option<CameraRay> {
        let ray = view.ray(place)?;
        Some(CameraRay { origin: ray.origin, direction: ray.direction, length: ray.length })
    }

    /// Moves a ray to another point of the aperture, towards the same point of the focal surface: a
    /// plane for perspective and parallel views, whose aperture is a disk, otherwise a sphere,
    /// whose aperture has depth as well (as in Radiance's `jitteraperture`).
    fn through_aperture(&self, ray: &CameraRay, [across, along]: [f64; 2], depth: f64) -> Option<CameraRay> {
        let options = self.view.options();
        let focal_distance = options.direction.length();
        let (x, y) = unit_disk(across, along);
        let radius = 0.5 * self.aperture;
        let mut offset = self.view.right() * (radius * x) + self.view.above() * (radius * y);
        if !matches!(options.kind, ViewKind::Perspective | ViewKind::Parallel) {
            offset += self.view.direction() * (FRAC_PI_8 * self.aperture * (1.0 - 2.0 * depth));
        }
        let slant = self.slant(ray.direction);
        let eye = ray.origin - ray.direction * (options.fore * slant);
        let focus = match options.kind {
            ViewKind::Perspective => focal_distance * slant,
            _ => focal_distance,
        };
        let start = eye + offset;
        let direction = (eye + ray.direction * focus - start).try_normalize()?;
        let origin = start + direction * (options.fore * self.slant(direction));
        Some(CameraRay { origin, direction, length: ray.length })
    }

    /// Ratio of the distance of a clipping surface along a direction to that straight ahead.
    fn slant(&self, direction: DVec3) -> f64 {
        match self.view.options().kind {
            ViewKind::Perspective | ViewKind::Parallel => direction.dot(self.view.direction()).recip(),
            ViewKind::Cylindrical => direction.reject_from_normalized(self.view.above()).length_recip(),
            _ => 1.0,
        }
    }
}

/// Interpolates between two rays.
fn between(to: &CameraRay, from: &CameraRay, share: f64) -> Option<CameraRay> {
    let direction = to.direction.lerp(from.direction, share).try_normalize()?;
    let length = match (to.length, from.length) {
        (Some(to), Some(from)) => Some(to + (from - to) * share),
        (length, _) => length,
    };
    Some(CameraRay { origin: to.origin.lerp(from.origin, share), direction, length })
}

/// The radiance of a ray; `None` if it hits nothing, as beyond the aft clipping plane.
pub(crate) fn traced(worker: &mut RayWorker<'_>, index: u64, ray: &CameraRay) -> Option<Traced> {
    traced_by(worker, ray, |worker, ray| worker.trace(index, ray))
}

/// What `trace` finds along a ray; `None` if it hits nothing, as beyond the aft clipping plane, which hides what
/// is behind transparent surfaces too.
pub(crate) fn traced_by<'p>(
    worker: &mut RayWorker<'p>,
    ray: &CameraRay,
    trace: impl FnOnce(&mut RayWorker<'p>, &Ray) -> Traced,
) -> Option<Traced> {
    worker.limit_distance(ray.length.unwrap_or(f64::INFINITY));
    let traced = Ray::new(ray.origin, ray.direction).map(|ray| trace(worker, &ray))?;
    (ray.length.is_none() || traced.first_hit.is_some()).then_some(traced)
}

/// The radiance of a ray with cached irradiance, and by an independent path; `None` for nothing.
pub(crate) fn traced_both(worker: &mut RayWorker<'_>, index: u64, ray: &CameraRay) -> Option<[[f64; 3]; 2]> {
    let cached = traced(worker, index, ray)?;
    let ray = Ray::new(ray.origin, ray.direction)?;
    Some([cached.value, worker.trace_uncached(index, &ray).value])
}
