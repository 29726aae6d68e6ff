//! Rays over pixel × pinhole.

use crate::camera_optics::GeneralRays;
use crate::camera_ray::CameraRay;
use crate::own_rays::FilmRays;
use crate::telecentric::TelecentricRays;
use crate::{BandWeights, PinholeCamera, PinholeModel};
use glam::DVec3;
use radsight_sampling::{DimensionSet, RaySampler, unit_disk};
use std::sync::Arc;

/// The distribution of a pixel's rays over the pinhole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hole {
    /// All rays pass through one point.
    Point,
    /// Uniform over a disk.
    Disk,
    /// By a diffraction pattern.
    Pattern,
    /// As a lens that is not thin, or a custom camera, distributes them.
    Other,
}

impl Hole {
    /// Whether [`Rays::ray_through`] has a ray for each of its points.
    #[must_use]
    pub fn has_points(self) -> bool {
        matches!(self, Hole::Point | Hole::Disk)
    }
}

/// All rays of a picture, in stream order: pixels in scanline order from the top left as seen from
/// the camera, the samples of a pixel together. Ray `pixel·samples + sample` uses that point of the
/// sample sequence.
#[derive(Clone, Debug)]
pub struct Rays {
    camera: PinholeCamera,
    samples: u32,
    seed: u64,
    origin: DVec3,
    toward: DVec3,
    radius_m: f64,
    per_scene_unit: f64,
    /// Data that a plain pinhole does not need.
    general: Option<GeneralRays>,
    /// Instead of a pinhole.
    own: Option<Arc<dyn FilmRays>>,
}

impl Rays {
    /// `samples` rays per pixel (at least one) with `seed`. A power of two converges fastest.
    #[must_use]
    pub fn new(camera: &PinholeCamera, samples: u32, seed: u64) -> Self {
        let per_scene_unit = camera.scene_unit_m().recip();
        Rays {
            samples: samples.max(1),
            seed,
            origin: camera.position_m() * per_scene_unit,
            toward: camera.direction() * camera.focal_distance_m(),
            radius_m: match camera.pinhole_model() {
                PinholeModel::Point => 0.0,
                PinholeModel::Finite | PinholeModel::Diffraction => 0.5 * camera.pinhole_diameter_m(),
            },
            per_scene_unit,
            general: (!camera.is_plain_pinhole()).then(|| GeneralRays::new(camera)),
            own: camera.telecentric_lens().map(|lens| Arc::new(TelecentricRays::new(*lens, camera)) as _),
            camera: camera.clone(),
        }
    }

    /// The rays of a custom camera, with the pixels, the exposure time and the exposure for a
    /// radiance of 1 of `camera`. Its weights replace cos⁴θ.
    #[must_use]
    pub fn with_own(camera: &PinholeCamera, own: Arc<dyn FilmRays>, samples: u32, seed: u64) -> Self {
        let camera = camera.clone().with_pinhole_model(PinholeModel::Finite);
        Rays { general: None, own: Some(own), ..Rays::new(&camera, samples, seed) }
    }

    /// Multiplies the bands of a ray by the relative density of their diffraction patterns.
    #[inline]
    pub fn weigh_bands(&self, ray: &CameraRay, bands: &mut [f64]) {
        if let Some(general) = &self.general {
            general.weigh_bands(ray.pattern_cell, bands);
        }
    }

    /// The camera.
    #[must_use]
    pub fn camera(&self) -> &PinholeCamera {
        &self.camera
    }

    /// Rays per pixel.
    #[must_use]
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// The seed of the sample sequence.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Total number of rays.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.cells() * u64::from(self.samples)
    }

    /// Number of exposed cells: the pixels and, with diffraction, after them cells of the sensor's
    /// plane around the picture, whose light is diffracted into it.
    #[must_use]
    pub fn cells(&self) -> u64 {
        let around = self.general.as_ref().map_or(0, GeneralRays::surround_cells);
        self.camera.pixel_count() + around as u64
    }

    /// Number of separate bands of each of [`Rays::cells`]; `None` if they are combined ray by ray.
    /// Diffraction needs separate bands if they have different patterns or pixels have colour
    /// filters.
    #[must_use]
    pub fn bands_apart(&self, weights: &BandWeights) -> Option<usize> {
        self.general.as_ref().and_then(|general| general.bands_apart(weights))
    }

    /// The separate bands of a ray, from the bands of its radiance. A grey radiance is equal in
    /// all.
    ///
    /// # Panics
    /// If `radiance` is empty.
    #[inline]
    pub fn keep_apart(&self, ray: &CameraRay, radiance: &[f64], bands: &mut [f64]) {
        let last = radiance.len() - 1;
        bands.iter_mut().enumerate().for_each(|(band, value)| *value = radiance[band.min(last)]);
        self.weigh_bands(ray, bands);
    }

    /// The exposures of the pixels from those of all [`Rays::cells`], each the mean over its own
    /// rays; separate bands of a cell follow each other. Only diffraction makes a difference: it
    /// spreads light over the picture.
    ///
    /// # Panics
    /// If `exposures` has another length.
    #[must_use]
    pub fn picture(&self, exposures: Vec<f64>, weights: &BandWeights) -> Vec<f64> {
        let bands = self.bands_apart(weights).unwrap_or(1);
        assert_eq!(exposures.len(), self.cells() as usize * bands, "one exposure a cell and band");
        match &self.general {
            Some(general) => general.picture(&self.camera, exposures, weights),
            None => exposures,
        }
    }

    /// The sample point of a ray, from which the renderer takes further dimensions.
    #[inline]
    #[must_use]
    pub fn sampler(&self, pixel: u64, sample: u32) -> RaySampler {
        RaySampler::new(self.seed, pixel * u64::from(self.samples) + u64::from(sample))
    }

    /// Ray `sample` of `pixel`.
    #[inline]
    #[must_use]
    pub fn of_sample(&self, pixel: u64, sample: u32) -> CameraRay {
        self.ray(pixel, self.sampler(pixel, sample).take(DimensionSet::CAMERA))
    }

    /// Ray number `index` in stream order.
    #[inline]
    #[must_use]
    pub fn of_index(&self, index: u64) -> CameraRay {
        let samples = u64::from(self.samples);
        self.of_sample(index / samples, (index % samples) as u32)
    }

    /// The ray of `pixel` for a point of the unit cube: `u[0]`, `u[1]` sample the pixel (from its
    /// left, from its top), `u[2]`, `u[3]` the pinhole, both uniformly by area.
    #[inline]
    #[must_use]
    pub fn ray(&self, pixel: u64, u: [f64; 4]) -> CameraRay {
        let camera = &self.camera;
        if let Some(own) = &self.own {
            let columns = u64::from(camera.columns());
            let place = [(pixel % columns) as f64 + u[0], (pixel / columns) as f64 + u[1]];
            let film = [place[0] / f64::from(camera.columns()), place[1] / f64::from(camera.rows())];
            return CameraRay::from_film(own.ray(film, [u[2], u[3]]));
        }
        if let Some(general) = &self.general {
            return general.ray(camera, self.per_scene_unit, pixel, u);
        }
        if self.radius_m == 0.0 {
            let [x, y] = camera.on_image(pixel, u[0], u[1]);
            return self.through(self.origin, x, y);
        }
        self.plain_ray(pixel, [u[0], u[1]], unit_disk(u[2], u[3]))
    }

    /// What `u[2]` and `u[3]` sample.
    #[must_use]
    pub fn hole(&self) -> Hole {
        match self.camera.pinhole_model() {
            _ if self.own.is_some() => Hole::Other,
            PinholeModel::Point => Hole::Point,
            PinholeModel::Finite => Hole::Disk,
            PinholeModel::Diffraction => Hole::Pattern,
        }
    }

    /// The ray of `pixel` through a point on it, from its left and its top in pixels, and a point
    /// of the pinhole, in its radii along (right, up). `None` unless [`Hole::has_points`].
    #[must_use]
    pub fn ray_through(&self, pixel: u64, place: [f64; 2], pinhole_point: [f64; 2]) -> Option<CameraRay> {
        match (&self.general, self.hole()) {
            (_, Hole::Pattern | Hole::Other) => None,
            (Some(general), _) => {
                Some(general.ray_through(&self.camera, self.per_scene_unit, pixel, place, pinhole_point))
            }
            (None, _) => Some(self.plain_ray(pixel, place, pinhole_point.into())),
        }
    }

    /// The point of the picture that the rays with this direction through a point of the pinhole pass,
    /// in pixels from its left and its top: the inverse of [`Rays::ray_through`]. `None` behind the
    /// pinhole and unless [`PinholeCamera::is_plain_pinhole`].
    #[must_use]
    pub fn picture_point(&self, direction: DVec3, pinhole_point: [f64; 2]) -> Option<[f64; 2]> {
        let camera = &self.camera;
        let forward = direction.dot(camera.direction());
        if self.general.is_some() || self.own.is_some() || forward <= 0.0 {
            return None;
        }
        let far = camera.focal_distance_m() / forward;
        let [a, b] = pinhole_point.map(|at| at * self.radius_m);
        Some(camera.in_pixels([far * direction.dot(camera.right()) - a, far * direction.dot(camera.up()) - b]))
    }

    fn plain_ray(&self, pixel: u64, [u, v]: [f64; 2], (a, b): (f64, f64)) -> CameraRay {
        let camera = &self.camera;
        let [x, y] = camera.on_image(pixel, u, v);
        let (a, b) = (a * self.radius_m, b * self.radius_m);
        let offset = camera.right() * (a * self.per_scene_unit) + camera.up() * (b * self.per_scene_unit);
        self.through(self.origin + offset, x + a, y + b)
    }

    /// The ray from `origin` whose h−p is (`x`, `y`, f) in metres along (right, up, direction).
    #[inline]
    fn through(&self, origin: DVec3, x: f64, y: f64) -> CameraRay {
        let camera = &self.camera;
        let focal2 = camera.focal_distance_m() * camera.focal_distance_m();
        let length2 = focal2 + x * x + y * y;
        let cos2 = focal2 / length2;
        CameraRay {
            origin,
            direction: (self.toward + camera.right() * x + camera.up() * y) / length2.sqrt(),
            cos4: cos2 * cos2,
            pattern_cell: 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CameraDescription;
    use crate::camera::tests::{paper_camera, paper_description};

    #[test]
    fn a_scene_point_up_and_right_of_the_axis_is_in_the_upper_right_of_the_picture() {
        let camera = paper_camera();
        let rays = Rays::new(&camera, 1, 0);
        let hit = |column: u64, row: u64| {
            let ray = rays.ray(row * 192 + column, [0.5; 4]);
            ray.origin + ray.direction * (ray.origin.z / -ray.direction.z)
        };
        let upper_right = hit(180, 10);
        assert!(upper_right.x > 0.05 && upper_right.y > 0.05, "{upper_right}");
        // Column 180 is 84.5 pixels right of the axis: 84.5 · 13.75 µm · 480/6.75 on the sheet.
        assert!((upper_right.x - 84.5 * 13.75e-6 * 0.48 / 6.75e-3).abs() < 1e-12);
        assert!((upper_right.y - 72.0 * 16e-6 * 0.48 / 6.75e-3).abs() < 1e-12);
        let lower_left = hit(5, 160);
        assert!(lower_left.x < 0.0 && lower_left.y < 0.0);
    }

    #[test]
    fn the_sensor_point_is_behind_the_hole_and_the_ray_runs_through_both() {
        let camera = paper_camera();
        let rays = Rays::new(&camera, 1, 0);
        let [x, y] = camera.on_image(100, 0.25, 0.75);
        let sensor_point = camera.position_m() - camera.direction() * 6.75e-3 - camera.right() * x - camera.up() * y;
        let ray = rays.ray(100, [0.25, 0.75, 0.9, 0.2]);
        assert!((ray.origin - camera.position_m()).length() <= 0.05e-3 + 1e-15);
        assert!((ray.direction - (ray.origin - sensor_point).normalize()).length() < 1e-14);
        assert!((ray.cos4 - ray.direction.dot(camera.direction()).powi(4)).abs() < 1e-14);
    }

    #[test]
    fn the_picture_point_of_a_ray_is_that_through_which_it_passes() {
        let camera = paper_camera();
        let rays = Rays::new(&camera, 1, 0);
        for (place, on_pinhole) in
            [([0.5, 0.5], [0.0, 0.0]), ([180.3, 17.9], [0.6, -0.7]), ([-4.0, 170.0], [-0.9, 0.1])]
        {
            let ray = rays.ray_through(0, place, on_pinhole).unwrap();
            let found = rays.picture_point(ray.direction, on_pinhole).unwrap();
            assert!(found.iter().zip(place).all(|(found, place)| (found - place).abs() < 1e-9), "{found:?}");
            assert!(rays.picture_point(-ray.direction, on_pinhole).is_none());
        }
    }

    #[test]
    fn all_rays_of_a_point_pinhole_start_at_its_centre() {
        let camera = paper_camera().with_pinhole_model(PinholeModel::Point);
        let rays = Rays::new(&camera, 8, 3);
        for index in 0..64 {
            assert_eq!(rays.of_index(index).origin, camera.position_m());
        }
    }

    #[test]
    fn scene_units_change_origins_and_nothing_else() {
        let metres = Rays::new(&paper_camera(), 4, 0);
        let description = CameraDescription { scene_unit_m: 1e-3, ..paper_description() };
        let millimetres = Rays::new(&PinholeCamera::new(&description).unwrap(), 4, 0);
        for index in 0..32 {
            let (a, b) = (metres.of_index(index), millimetres.of_index(index));
            assert!((a.origin * 1e3 - b.origin).length() < 1e-12);
            assert_eq!((a.direction, a.cos4), (b.direction, b.cos4));
        }
    }

    #[test]
    fn rays_start_uniformly_over_the_hole() {
        let camera = paper_camera();
        let rays = Rays::new(&camera, 4096, 0);
        let (mut mean, mut second) = (DVec3::ZERO, DVec3::ZERO);
        for sample in 0..4096 {
            let offset = rays.of_sample(77, sample).origin - camera.position_m();
            assert_eq!(offset.z, 0.0);
            mean += offset / 4096.0;
            second += offset * offset / 4096.0;
        }
        // A uniform disk of radius r has the second moment r²/4 along each axis.
        let expected = (0.05e-3f64).powi(2) / 4.0;
        assert!(mean.length() < 1e-7, "{mean}");
        assert!((second.x / expected - 1.0).abs() < 2e-3 && (second.y / expected - 1.0).abs() < 2e-3, "{second}");
    }

    /// ∫∫ cos⁴θ over pixel and pinhole by a tensor Gauss rule on the pixel and a polar rule on the
    /// pinhole.
    fn mean_cos4_by_quadrature(camera: &PinholeCamera, pixel: u64) -> f64 {
        let node = (0.6f64).sqrt();
        let gauss = [(-node, 5.0 / 18.0), (0.0, 8.0 / 18.0), (node, 5.0 / 18.0)];
        let f2 = camera.focal_distance_m().powi(2);
        let mut sum = 0.0;
        for (s, weight_s) in gauss {
            for (t, weight_t) in gauss {
                let [x, y] = camera.on_image(pixel, 0.5 + 0.5 * s, 0.5 + 0.5 * t);
                for (v, weight_v) in gauss {
                    // Equal steps of r² are equal areas.
                    let radius = 0.5 * camera.pinhole_diameter_m() * (0.5 + 0.5 * v).sqrt();
                    for k in 0..16 {
                        let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 16.0).sin_cos();
                        let across2 = (x + radius * cos).powi(2) + (y + radius * sin).powi(2);
                        sum += weight_s * weight_t * weight_v / 16.0 * (f2 / (f2 + across2)).powi(2);
                    }
                }
            }
        }
        sum
    }

    #[test]
    fn the_mean_of_cos4_agrees_with_quadrature() {
        let description = CameraDescription { pinhole_diameter_m: 2e-3, ..paper_description() };
        let camera = PinholeCamera::new(&description).unwrap();
        let rays = Rays::new(&camera, 4096, 1);
        for pixel in [0, 191, 82 * 192 + 96, 164 * 192] {
            let mean = (0..4096).map(|sample| rays.of_sample(pixel, sample).cos4).sum::<f64>() / 4096.0;
            let expected = mean_cos4_by_quadrature(&camera, pixel);
            assert!((mean / expected - 1.0).abs() < 3e-5, "pixel {pixel}: {mean} against {expected}");
        }
    }
}
