//! The rays of a view's pixels.

use glam::DVec3;
use radsight_picture::{View, ViewKind};
use radsight_render::{Ray, RaySpacing, RayWorker, Traced};
use radsight_sampling::{DimensionSet, RaySampler, unit_disk};
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_8;

/// Where the rays of a picture start and go.
///
/// ```
/// use radsight_film::ViewCamera;
/// use radsight_picture::{View, ViewOptions};
/// let lens = ViewCamera::new(View::new(ViewOptions::default()).unwrap(), 3, 3);
/// let ray = lens.central_ray(1, 1).unwrap();
/// assert!(ray.direction.distance(glam::DVec3::Y) < 1e-15);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ViewCamera {
    view: View,
    columns: usize,
    rows: usize,
    /// Side of the square that rays are spread over, in pixels (`-pj`). Default 0: all through the middle.
    pub jitter: f64,
    /// Diameter of the aperture in scene units (`-pd`); what is as far as the view direction is long is sharp. Default 0.
    pub aperture: f64,
    /// The view of the frame before, and the share of the way from it during which the shutter is open (`-pm`). Default none.
    pub motion: Option<(View, f64)>,
}

/// A ray through a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraRay {
    /// Where it starts, scene units.
    pub origin: DVec3,
    /// Unit.
    pub direction: DVec3,
    /// How far away the aft clipping plane is, scene units; `None` without one.
    pub length: Option<f64>,
}

impl ViewCamera {
    /// The lens of a view whose picture has so many columns and rows.
    #[must_use]
    pub fn new(view: View, columns: usize, rows: usize) -> ViewCamera {
        ViewCamera { view, columns, rows, jitter: 0.0, aperture: 0.0, motion: None }
    }

    /// Pixels in a row.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Rows of pixels.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The view.
    #[must_use]
    pub fn view(&self) -> &View {
        &self.view
    }

    /// The ray through the middle of a pixel from the middle of the aperture; `None` where the view shows nothing. Row 0 is the top.
    #[must_use]
    pub fn central_ray(&self, column: usize, row: usize) -> Option<CameraRay> {
        self.view_ray(&self.view, self.place(column, row, [0.5, 0.5]))
    }

    /// A ray through some place of each square of so many pixels' side, top row first: those for which irradiance is gathered
    /// beforehand. Not through the middles, which in a symmetric view lie on the very edges of a room.
    #[must_use]
    pub fn prepass_rays(&self, side: usize) -> Vec<Option<Ray>> {
        let side = side.max(1);
        let [across, down] = [self.columns.div_ceil(side), self.rows.div_ceil(side)];
        // Steps of the R₂ sequence (Roberts 2018) are spread evenly over the squares.
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

    /// How far apart the rays of neighbouring squares of so many pixels' side are, in the middle of the picture.
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

    /// A ray through a pixel at the sampler's place in pixel, aperture and time; `None` where the view shows nothing.
    #[must_use]
    pub fn ray(&self, column: usize, row: usize, sampler: &RaySampler) -> Option<CameraRay> {
        let [x, y, across, along] = sampler.take(DimensionSet::CAMERA);
        self.ray_at(self.place(column, row, [x, y]), [across, along], sampler)
    }

    /// The same through the middle of the pixel.
    #[must_use]
    pub fn middle_ray(&self, column: usize, row: usize, sampler: &RaySampler) -> Option<CameraRay> {
        let [.., across, along] = sampler.take(DimensionSet::CAMERA);
        self.ray_at(self.place(column, row, [0.5, 0.5]), [across, along], sampler)
    }

    /// A ray through any place in the view, (0, 0) the lower left corner and (1, 1) the upper right, spread as the pixels are.
    #[must_use]
    pub fn ray_near(&self, [x, y]: [f64; 2], sampler: &RaySampler) -> Option<CameraRay> {
        let [right, up, across, along] = sampler.take(DimensionSet::CAMERA);
        let place = [x + self.jittered(right) / self.columns as f64, y + self.jittered(up) / self.rows as f64];
        self.ray_at(place, [across, along], sampler)
    }

    /// The place in the view of a sample of a pixel.
    fn place(&self, column: usize, row: usize, [x, y]: [f64; 2]) -> [f64; 2] {
        self.pixel_place(column, row, [0.5 + self.jittered(x), 0.5 + self.jittered(y)])
    }

    /// The place in the view of a point whose distance from the lower left corner of a pixel is given in pixels.
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

    /// The ray from another place of the aperture to the same place in the focal surface: a plane for perspective and parallel
    /// views, whose aperture is a disk, else a sphere, whose aperture has a depth too (as Radiance's `jitteraperture`).
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

    /// How much farther a clipping surface is along a direction than straight ahead.
    fn slant(&self, direction: DVec3) -> f64 {
        match self.view.options().kind {
            ViewKind::Perspective | ViewKind::Parallel => direction.dot(self.view.direction()).recip(),
            ViewKind::Cylindrical => direction.reject_from_normalized(self.view.above()).length_recip(),
            _ => 1.0,
        }
    }
}

/// The ray a share of the way from one to another.
fn between(to: &CameraRay, from: &CameraRay, share: f64) -> Option<CameraRay> {
    let direction = to.direction.lerp(from.direction, share).try_normalize()?;
    let length = match (to.length, from.length) {
        (Some(to), Some(from)) => Some(to + (from - to) * share),
        (length, _) => length,
    };
    Some(CameraRay { origin: to.origin.lerp(from.origin, share), direction, length })
}

/// What a ray finds; `None` for nothing, as beyond the aft clipping plane.
pub(crate) fn traced(worker: &mut RayWorker<'_>, index: u64, ray: &CameraRay) -> Option<Traced> {
    let traced = Ray::new(ray.origin, ray.direction).map(|ray| worker.trace(index, &ray))?;
    let is_clipped = ray.length.is_some_and(|length| traced.first_hit.is_none_or(|hit| hit.distance > length));
    (!is_clipped).then_some(traced)
}

/// The radiance that a ray finds with cached irradiance, and by a single path; `None` for nothing.
pub(crate) fn traced_both(worker: &mut RayWorker<'_>, index: u64, ray: &CameraRay) -> Option<[[f64; 3]; 2]> {
    let cached = traced(worker, index, ray)?;
    let ray = Ray::new(ray.origin, ray.direction)?;
    Some([cached.value, worker.trace_uncached(index, &ray).value])
}
