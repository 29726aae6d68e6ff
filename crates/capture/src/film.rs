//! Rays that the pixels behind a finite pinhole share.
//!
//! Behind a finite pinhole each pixel is a blurred point of the scene, and neighbouring pixels see
//! nearly the same points. Through a point of a pinhole of radius r at a focal distance f, a film
//! point x sees what a point pinhole at its centre shows at x + S·p, where p is the point of the
//! pinhole in radii and S = r·(1 + f/z) for points at a depth z. So the picture of a point pinhole,
//! convolved with the disk of radius S, is the picture of the finite pinhole, if the radiance that
//! leaves a point is the same for all points of the pinhole. It is nearly: its first derivative is
//! measured, and the convolution includes it (`derivative_kernels`).
//!
//! The picture of the point pinhole is the *unblurred film*. It has a margin, from where light is
//! blurred into the picture. Its rays pass through all points of the pinhole, each with the film
//! point from which it sees its point of the scene. So what depends on the pinhole's point is
//! averaged, and only its correlation over neighbouring pixels is lost.
//!
//! The convolution spreads the noise of each ray over all pixels of the disk. A pixel then needs
//! many times fewer rays of its own, and edges need not be resolved by the rays of each pixel.

use crate::Exposer;
use crate::cubic::{INTERPOLATED, cubic_weights};
use crate::subpixel_kernels::SubpixelKernels;
use crate::window_sums::WindowSums;
use glam::DVec2;
use radsight_pinhole::{CameraRay, Hole, Rays};
use radsight_render::{Ray, RayWorker, SpecularEnd};
use radsight_sampling::unit_disk;
use rayon::prelude::*;

/// Minimum radius of the disk, pixels: below, the pixels have little in common.
const MIN_RADIUS: f64 = 1.5;

/// Maximum radius of the disk, pixels: beyond, the convolution takes longer than rays.
const MAX_RADIUS: f64 = 24.0;

/// Accepted difference of the disk's radius between the surfaces of a scene, relative to it.
const MAX_DEPTH_EFFECT: f64 = 0.005;

/// The same for what mirrors show, whose depth is not known.
const MAX_FOCAL_RATIO: f64 = 0.03;

/// Points of the pinhole for the weights of the convolution.
const KERNEL_POINTS: u32 = 1 << 14;

/// The film of a point pinhole at the centre of a finite one.
#[derive(Debug)]
pub(crate) struct UnblurredFilm {
    columns: usize,
    rows: usize,
    /// Pixels around the picture, on each side along both axes.
    margin: [usize; 2],
    /// Shift of a film point per radius of the pinhole, pixels along columns and rows.
    shift: DVec2,
    kernels: Kernels,
    pub(crate) subpixel_kernels: SubpixelKernels,
    /// The least and the greatest ratio of the focal distance to the depth of what is seen.
    focal_ratios: [f64; 2],
    /// For each pixel of the film the number of pixels of the picture that it adds up to.
    shares: Vec<f64>,
}

/// A ray of a film.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FilmRay {
    pub(crate) ray: CameraRay,
    /// The pixel of the film that it sees.
    pub(crate) pixel: usize,
    /// The point of the film that it sees, pixels from its left and its top.
    pub(crate) point: DVec2,
    /// The pixel of the picture through which it passes, if any, and where.
    pub(crate) passage: Option<PixelPassage>,
}

/// Where a ray passes through a pixel and the pinhole.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PixelPassage {
    pub(crate) pixel: usize,
    /// From 0 to 1 along both axes.
    pub(crate) on_pixel: DVec2,
    /// In radii.
    pub(crate) on_pinhole: DVec2,
}

impl PixelPassage {
    /// Of the ray of a pixel for a point of the unit cube.
    pub(crate) fn new(pixel: usize, u: [f64; 4]) -> PixelPassage {
        PixelPassage { pixel, on_pixel: DVec2::new(u[0], u[1]), on_pinhole: unit_disk(u[2], u[3]).into() }
    }
}

/// The weights of the film around a pixel of the picture.
#[derive(Debug)]
struct Kernels {
    /// Of radiance.
    blur: Vec<f64>,
    /// Of radiance that is constant within each pixel of the film, [`sharpened`].
    constant: Vec<f64>,
    /// Of its relative derivatives along the two axes of the pinhole, per radius.
    derivatives: [Vec<f64>; 2],
    /// Number of pixels over which noise is averaged.
    area: f64,
}

impl UnblurredFilm {
    /// `None` where pixels cannot share rays.
    pub(crate) fn new(exposer: &Exposer<'_>) -> Option<UnblurredFilm> {
        let (rays, plan) = (exposer.rays, exposer.renderer.plan());
        let camera = rays.camera();
        if rays.hole() != Hole::Disk || !camera.is_plain_pinhole() || !plan.has_plain_surfaces_alone() {
            return None;
        }
        let radius = 0.5 * camera.pinhole_diameter_m();
        let [x, y] = camera.pixel_pitch_m().map(|pitch| radius / pitch);
        let is_suitable = |radius: f64| (MIN_RADIUS..=MAX_RADIUS).contains(&radius);
        if !(is_suitable(x) && is_suitable(y)) {
            return None;
        }
        let seen = focal_ratios(exposer, |_| true);
        // Where nothing is seen, the film is that of infinity.
        let focal_ratios = if seen[0] > seen[1] { [0.0; 2] } else { seen };
        let focal_ratio = shared_focal_ratio(focal_ratios)?;
        // A column is farther right, and a row is farther down.
        let shift = DVec2::new(x, -y) * (1.0 + focal_ratio);
        let margin = [x, y].map(|radius| (radius * (1.0 + focal_ratio)).ceil() as usize + INTERPOLATED / 2);
        let [columns, rows] = [(camera.columns(), margin[0]), (camera.rows(), margin[1])]
            .map(|(count, margin)| count as usize + 2 * margin);
        let kernels = Kernels::new(shift, margin);
        let subpixel_kernels = SubpixelKernels::new(shift, margin);
        let shares = Vec::new();
        let film = UnblurredFilm { columns, rows, margin, shift, kernels, subpixel_kernels, focal_ratios, shares };
        Some(UnblurredFilm { shares: film.shares(), ..film })
    }

    /// Whether it suits a scene that differs in some pixels of the picture: they can share rays.
    pub(crate) fn suits(&self, exposer: &Exposer<'_>, differs: impl Fn(usize) -> bool + Sync) -> bool {
        let extent = || union(self.focal_ratios, focal_ratios(exposer, differs));
        exposer.renderer.plan().has_plain_surfaces_alone() && shared_focal_ratio(extent()).is_some()
    }

    /// Whether each pixel of the film sees light that is refracted by dielectrics; empty without any.
    pub(crate) fn refracted(&self, exposer: &Exposer<'_>) -> Vec<bool> {
        if !exposer.renderer.plan().divides_rays {
            return Vec::new();
        }
        let places = [[0.1, 0.1], [0.9, 0.1], [0.5, 0.5], [0.1, 0.9], [0.9, 0.9]].map(DVec2::from);
        let of_pixel = |(worker, ends): &mut (RayWorker<'_>, Vec<SpecularEnd>), pixel: usize| {
            ends.clear();
            for ray in places.iter().filter_map(|place| self.ray_of_point(exposer.rays, self.corner(pixel) + *place)) {
                worker.specular_ends(&ray, ends);
            }
            ends.iter().any(|end| end.is_refracted)
        };
        let start = || (exposer.renderer.worker(), Vec::new());
        (0..self.pixel_count()).into_par_iter().with_min_len(64).map_init(start, of_pixel).collect()
    }

    /// The pixels of the picture into which marked pixels of the film are blurred.
    pub(crate) fn blurred_marks(&self, marks: &[bool]) -> Vec<bool> {
        let sums = WindowSums::new(marks.iter().map(|is_marked| [f64::from(u8::from(*is_marked))]), self.columns);
        let reach = self.margin[0].max(self.margin[1]);
        let in_picture = (0..marks.len()).filter(|pixel| self.in_picture(*pixel).is_some());
        in_picture.map(|pixel| marks[pixel] || sums.signed_around(pixel, reach)[0] > 0.5).collect()
    }

    /// Columns and rows, with the margin.
    pub(crate) fn size(&self) -> [usize; 2] {
        [self.columns, self.rows]
    }

    /// Number of pixels, with the margin.
    pub(crate) fn pixel_count(&self) -> usize {
        self.columns * self.rows
    }

    /// Whether a pixel of the film is one of the picture, and which.
    pub(crate) fn in_picture(&self, pixel: usize) -> Option<usize> {
        let [columns, rows] = self.picture_size();
        let (x, y) = (pixel % self.columns, pixel / self.columns);
        let [x, y] = [x.wrapping_sub(self.margin[0]), y.wrapping_sub(self.margin[1])];
        (x < columns && y < rows).then(|| y * columns + x)
    }

    /// Number of pixels of the picture.
    pub(crate) fn picture_pixels(&self) -> usize {
        self.picture_size().into_iter().product()
    }

    fn picture_size(&self) -> [usize; 2] {
        [self.columns - 2 * self.margin[0], self.rows - 2 * self.margin[1]]
    }

    /// The ray that sees what a point pinhole would show at a place of a pixel, through a point of
    /// the pinhole, in its radii.
    pub(crate) fn ray(&self, rays: &Rays, pixel: usize, place: [f64; 2], on_pinhole: DVec2) -> Option<FilmRay> {
        let point = self.corner(pixel) + DVec2::from(place);
        self.ray_of(rays, (pixel, point), on_pinhole)
    }

    /// The same for a point of the film.
    pub(crate) fn ray_to_point(&self, rays: &Rays, point: DVec2, on_pinhole: DVec2) -> Option<FilmRay> {
        self.ray_of(rays, (self.pixel_at(point)?, point), on_pinhole)
    }

    fn ray_of(&self, rays: &Rays, (pixel, point): (usize, DVec2), on_pinhole: DVec2) -> Option<FilmRay> {
        let place = self.picture_point(point) - self.shift * on_pinhole;
        let ray = rays.ray_through(0, place.into(), on_pinhole.into())?;
        let [columns, rows] = self.picture_size();
        let is_inside = place.cmpge(DVec2::ZERO).all() && place.x < columns as f64 && place.y < rows as f64;
        let own = || place.y as usize * columns + place.x as usize;
        let passage = is_inside.then(|| PixelPassage { pixel: own(), on_pixel: place.fract(), on_pinhole });
        Some(FilmRay { ray, pixel, point, passage })
    }

    /// The ray that sees a point of the film through the middle of the pinhole.
    pub(crate) fn ray_of_point(&self, rays: &Rays, point: DVec2) -> Option<Ray> {
        let ray = rays.ray_through(0, self.picture_point(point).into(), [0.0; 2])?;
        Ray::new(ray.origin, ray.direction)
    }

    /// The same for a point of the unit cube.
    pub(crate) fn sampled_ray(&self, rays: &Rays, pixel: usize, u: [f64; 4]) -> Option<FilmRay> {
        self.ray(rays, pixel, [u[0], u[1]], unit_disk(u[2], u[3]).into())
    }

    /// The point of the film that a ray of the picture sees, with its pixel. `pixel` is that of the
    /// picture, by its index on the film.
    pub(crate) fn seen(&self, pixel: usize, passage: PixelPassage) -> Option<(DVec2, usize)> {
        let point = self.corner(pixel) + passage.on_pixel + self.shift * passage.on_pinhole;
        Some((point, self.pixel_at(point)?))
    }

    /// The same for a point of the picture, in pixels from its left and its top.
    pub(crate) fn seen_from(&self, at: DVec2, on_pinhole: DVec2) -> Option<(DVec2, usize)> {
        let point = at + self.margins() + self.shift * on_pinhole;
        Some((point, self.pixel_at(point)?))
    }

    /// The point of the picture that a point of the film is, pixels from its left and its top.
    pub(crate) fn picture_point(&self, point: DVec2) -> DVec2 {
        point - self.margins()
    }

    /// The pixels of the film within a distance along each axis from a point of the picture.
    pub(crate) fn pixels_around(&self, at: DVec2, reach: DVec2) -> impl Iterator<Item = usize> {
        let (at, columns) = (at + self.margins(), self.columns);
        // Negative numbers become 0.
        let along =
            |at: f64, reach: f64, count: usize| (at - reach) as usize..((at + reach).ceil() as usize).min(count);
        let across = along(at.x, reach.x, self.columns);
        along(at.y, reach.y, self.rows).flat_map(move |row| across.clone().map(move |column| row * columns + column))
    }

    /// Shift of a film point per radius of the pinhole, pixels along columns and rows.
    pub(crate) fn shift(&self) -> DVec2 {
        self.shift
    }

    /// The first corner of a pixel, pixels from the left and the top of the film.
    pub(crate) fn corner(&self, pixel: usize) -> DVec2 {
        DVec2::new((pixel % self.columns) as f64, (pixel / self.columns) as f64)
    }

    pub(crate) fn margins(&self) -> DVec2 {
        DVec2::new(self.margin[0] as f64, self.margin[1] as f64)
    }

    pub(crate) fn pixel_at(&self, place: DVec2) -> Option<usize> {
        let is_inside = place.cmpge(DVec2::ZERO).all() && place.x < self.columns as f64 && place.y < self.rows as f64;
        is_inside.then(|| place.y as usize * self.columns + place.x as usize)
    }

    /// The number of pixels of the picture that a pixel of the film adds up to, between 0 and about
    /// 1.
    pub(crate) fn share(&self, pixel: usize) -> f64 {
        self.shares[pixel]
    }

    /// The sum over the picture of the squared weights of a film pixel that stands for `area` of
    /// them.
    pub(crate) fn squared_weights(&self, area: f64, mean_squared_weight: f64) -> f64 {
        let interpolated = if area > 1.0 { area / mean_squared_weight } else { 0.0 };
        area * area / (interpolated + self.kernels.area)
    }

    /// The picture of some values of the film, in the frame of the film; 0 in the margin.
    pub(crate) fn blurred(&self, values: &[f64]) -> Vec<f64> {
        self.convolved(values, &self.kernels.blur)
    }

    /// The same if each value is that of a whole pixel.
    pub(crate) fn blurred_by_pixels(&self, values: &[f64]) -> Vec<f64> {
        self.convolved(values, &self.kernels.constant)
    }

    /// The same of values times a coordinate of the point of the pinhole, by its axis.
    pub(crate) fn blurred_moments(&self, values: &[f64], axis: usize) -> Vec<f64> {
        self.convolved(values, &self.kernels.derivatives[axis])
    }

    /// The mean over the picture of values in the frame of the film.
    pub(crate) fn mean_over_picture(&self, values: &[f64]) -> f64 {
        let pixels = values.iter().enumerate().filter(|(pixel, _)| self.in_picture(*pixel).is_some());
        pixels.map(|(_, value)| value).sum::<f64>() / self.picture_pixels() as f64
    }

    pub(crate) fn convolved(&self, values: &[f64], kernel: &[f64]) -> Vec<f64> {
        let ([columns, rows], [left, top]) = (self.picture_size(), self.margin);
        let width = 2 * left + 1;
        let mut picture = vec![0.0; values.len()];
        picture.par_chunks_exact_mut(self.columns).enumerate().skip(top).take(rows).for_each(|(row, sums)| {
            let sums = &mut sums[left..left + columns];
            for (index, weight) in kernel.iter().enumerate().filter(|(_, weight)| **weight != 0.0) {
                let start = (row - top + index / width) * self.columns + index % width;
                let near = &values[start..start + columns];
                sums.iter_mut().zip(near).for_each(|(sum, value)| *sum += weight * value);
            }
        });
        picture
    }

    /// [`UnblurredFilm::share`] of all pixels: the picture's pixels, convolved. The disk is
    /// symmetric.
    fn shares(&self) -> Vec<f64> {
        let (width, [left, top]) = (2 * self.margin[0] + 1, self.margin);
        let [columns, rows] = self.picture_size();
        let mut shares = vec![0.0; self.columns * self.rows];
        for (index, weight) in self.kernels.blur.iter().enumerate() {
            let (right, down) = (index % width, index / width);
            debug_assert!(right <= 2 * left && down <= 2 * top);
            for row in (down..down + rows).map(|row| row * self.columns) {
                shares[row + right..row + right + columns].iter_mut().for_each(|share| *share += weight);
            }
        }
        shares
    }
}

impl Kernels {
    /// For a shift by radius and a kernel that reaches `margin` pixels to each side.
    fn new(shift: DVec2, margin: [usize; 2]) -> Kernels {
        let [width, height] = margin.map(|margin| 2 * margin + 1);
        let mut moments = [(); 3].map(|()| vec![0.0; width * height]);
        let mut constant = vec![0.0; width * height];
        for u in kernel_points() {
            let (sin, cos) = (std::f64::consts::TAU * u[1]).sin_cos();
            let on_pinhole = u[0].sqrt() * DVec2::new(cos, sin);
            let at = shift * on_pinhole;
            let [columns, rows] = [at.x, at.y].map(cubic_weights);
            let first = [at.x, at.y].map(|at| at.floor() as isize - 1);
            let nearest =
                [(at.x, margin[0]), (at.y, margin[1])].map(|(at, margin)| (at.round() + margin as f64) as usize);
            constant[nearest[1] * width + nearest[0]] += f64::from(KERNEL_POINTS).recip();
            for (down, by_row) in rows.into_iter().enumerate() {
                for (right, by_column) in columns.into_iter().enumerate() {
                    let x = (first[0] + right as isize + margin[0] as isize) as usize;
                    let y = (first[1] + down as isize + margin[1] as isize) as usize;
                    let weight = by_row * by_column / f64::from(KERNEL_POINTS);
                    let factors = [1.0, on_pinhole.x, on_pinhole.y];
                    moments.iter_mut().zip(factors).for_each(|(sums, factor)| sums[y * width + x] += weight * factor);
                }
            }
        }
        let constant = sharpened(&constant, width);
        let [blur, x, y] = moments;
        let area = blur.iter().map(|weight| weight * weight).sum::<f64>().recip();
        Kernels { blur, constant, derivatives: [x, y], area }
    }
}

/// A kernel of pixels of constant radiance, without the blur that a smooth function suffers by them:
/// 1/24 of its second derivatives.
fn sharpened(kernel: &[f64], width: usize) -> Vec<f64> {
    let at = |index: Option<usize>| index.and_then(|index| kernel.get(index)).copied().unwrap_or(0.0);
    let of_pixel = |(index, own): (usize, &f64)| {
        let near = [index.checked_sub(1), Some(index + 1), index.checked_sub(width), Some(index + width)];
        own - near.into_iter().map(|near| at(near) - own).sum::<f64>() / 24.0
    };
    kernel.iter().enumerate().map(of_pixel).collect()
}

/// Points of the unit square for the points of the pinhole, even over it.
pub(crate) fn kernel_points() -> impl ExactSizeIterator<Item = [f64; 2]> {
    let count = f64::from(KERNEL_POINTS);
    (0..KERNEL_POINTS).map(move |index| [(f64::from(index) + 0.5) / count, (f64::from(index) * GOLDEN_RATIO).fract()])
}

/// Its multiples fill the unit interval evenly.
const GOLDEN_RATIO: f64 = 0.618_033_988_749_894_9;

/// The least and the greatest ratio of the focal distance to the depth of what some pixels of the
/// camera see.
fn focal_ratios(exposer: &Exposer<'_>, is_seen: impl Fn(usize) -> bool + Sync) -> [f64; 2] {
    let (rays, plan) = (exposer.rays, exposer.renderer.plan());
    let camera = rays.camera();
    let of_pixel = |pixel: usize| {
        let ray = rays.ray_through(pixel as u64, [0.5; 2], [0.0; 2])?;
        let distance = plan.distance_behind_panes(&Ray::new(ray.origin, ray.direction)?)?;
        let depth = distance * camera.scene_unit_m() * ray.direction.dot(camera.direction());
        Some(camera.focal_distance_m() / depth)
    };
    let pixels = (0..camera.pixel_count() as usize).into_par_iter().with_min_len(64);
    let ratios = pixels.filter(|pixel| is_seen(*pixel)).filter_map(of_pixel);
    ratios.map(|ratio| [ratio; 2]).reduce(|| [f64::INFINITY, 0.0], union)
}

fn union(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// The mean of two extreme focal ratios; `None` where depths differ too much.
fn shared_focal_ratio([least, most]: [f64; 2]) -> Option<f64> {
    let is_even = most - least <= MAX_DEPTH_EFFECT * (1.0 + most) && most <= MAX_FOCAL_RATIO;
    is_even.then_some(0.5 * (least + most))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn film(radii: [f64; 2], size: [usize; 2]) -> UnblurredFilm {
        let margin = radii.map(|radius| radius.ceil() as usize + INTERPOLATED / 2);
        let [columns, rows] = [0, 1].map(|axis| size[axis] + 2 * margin[axis]);
        let shift = DVec2::new(radii[0], -radii[1]);
        let kernels = Kernels::new(shift, margin);
        let focal_ratios = [0.0; 2];
        let subpixel_kernels = SubpixelKernels::new(shift, margin);
        let shares = Vec::new();
        let film = UnblurredFilm { columns, rows, margin, shift, kernels, subpixel_kernels, focal_ratios, shares };
        UnblurredFilm { shares: film.shares(), ..film }
    }

    /// Values of all pixels by their coordinates in the picture.
    pub(crate) fn values(film: &UnblurredFilm, of_point: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let at = |index: usize, margin: usize| index as f64 - margin as f64;
        let pixels = 0..film.pixel_count();
        pixels.map(|p| of_point(at(p % film.columns, film.margin[0]), at(p / film.columns, film.margin[1]))).collect()
    }

    pub(crate) fn in_picture(film: &UnblurredFilm, picture: &[f64]) -> Vec<f64> {
        (0..picture.len()).filter(|pixel| film.in_picture(*pixel).is_some()).map(|pixel| picture[pixel]).collect()
    }

    #[test]
    fn a_quadratic_function_is_blurred_exactly() {
        let film = film([3.7, 3.2], [9, 7]);
        let picture = film.blurred(&values(&film, |x, y| 2.0 + x - 0.5 * y + 0.3 * x * x - 0.1 * y * y + 0.2 * x * y));
        // The mean of x² over a disk of radius r is r²/4.
        let added = 0.25 * (0.3 * 3.7 * 3.7 - 0.1 * 3.2 * 3.2);
        for (pixel, value) in in_picture(&film, &picture).into_iter().enumerate() {
            let (x, y) = ((pixel % 9) as f64, (pixel / 9) as f64);
            let correct = 2.0 + x - 0.5 * y + 0.3 * x * x - 0.1 * y * y + 0.2 * x * y + added;
            assert!((value - correct).abs() < 2e-3, "{value} for {correct}");
        }
    }

    /// Fraction of a disk on the left of a vertical line at an offset from its centre.
    pub(crate) fn left_of(radius: f64, offset: f64) -> f64 {
        let t = (offset / radius).clamp(-1.0, 1.0);
        0.5 + (t * (1.0 - t * t).sqrt() + t.asin()) / std::f64::consts::PI
    }

    #[test]
    fn the_weights_of_all_film_pixels_add_up_to_the_picture() {
        let film = film([3.7, 3.2], [12, 10]);
        let uniform = in_picture(&film, &film.blurred(&vec![1.0; film.pixel_count()]));
        assert!(uniform.iter().all(|value| (value - 1.0).abs() < 1e-9));
        assert!((film.shares.iter().sum::<f64>() / 120.0 - 1.0).abs() < 1e-9);
    }
}
