//! Rays of cameras with more than a pinhole in front of an upright sensor: diffraction, lens,
//! distortion, a shifted or tilted sensor.

use crate::camera_ray::CameraRay;
use crate::fresnel_pattern::{Draw, FresnelPattern, Wing};
use crate::surround::{Cell, Surround};
use crate::wings::Wings;
use crate::{BandWeights, PinholeCamera, PinholeModel, ThinLens};
use glam::DVec3;
use radsight_sampling::unit_disk;
use std::f64::consts::TAU;

/// Marks rays that are not drawn from a diffraction pattern.
const UNIFORM: u32 = u32::MAX;

/// Precomputed data of such a camera.
#[derive(Clone, Debug)]
pub(crate) struct GeneralRays {
    pattern: Option<FresnelPattern>,
    /// 1/D for the distance D of the objects for which diffraction is exact.
    object_curvature: f64,
    /// Set if rays sample only the core of the pattern.
    split: Option<SplitPattern>,
}

/// The wings of the diffraction pattern.
#[derive(Clone, Debug)]
struct SplitPattern {
    /// One per wavelength.
    wings: Vec<Wing>,
    surround: Surround,
}

impl GeneralRays {
    pub(crate) fn new(camera: &PinholeCamera) -> GeneralRays {
        let optics = camera.optics();
        let object_curvature = optics.object_distance_m.map_or(0.0, f64::recip);
        let pattern = camera.wavelength_m().filter(|_| camera.pinhole_model() == PinholeModel::Diffraction);
        let pattern = pattern.map(|wavelength| {
            let radius = 0.5 * camera.pinhole_diameter_m();
            let curvature = camera.focal_distance_m().recip() + object_curvature;
            let own = [wavelength];
            let wavelengths = if optics.band_wavelengths_m.is_empty() { &own[..] } else { &optics.band_wavelengths_m };
            let numbers: Vec<f64> = wavelengths.iter().map(|length| radius * radius * curvature / length).collect();
            if camera.convolves() {
                let unit_m = radius * (1.0 + camera.focal_distance_m() * object_curvature);
                let (core, wings) = Wing::split(&numbers, unit_m);
                return (core, Some(SplitPattern { wings, surround: Surround::new(camera) }));
            }
            (FresnelPattern::new(&numbers), None)
        });
        let (pattern, split) = pattern.map_or((None, None), |(pattern, split)| (Some(pattern), split));
        GeneralRays { pattern, object_curvature, split }
    }

    /// Number of exposed cells around the picture.
    pub(crate) fn surround_cells(&self) -> usize {
        self.split.as_ref().map_or(0, |split| split.surround.count())
    }

    /// Number of separate bands, as in [`crate::Rays::bands_apart`].
    pub(crate) fn bands_apart(&self, weights: &BandWeights) -> Option<usize> {
        let wings = self.split.as_ref().map(|split| split.wings.len())?;
        (wings > 1 || weights.has_mosaic()).then_some(wings.max(weights.as_slice().len()))
    }

    /// The picture, from the exposures of the pixels and of the cells around it. Separate bands of
    /// a cell follow each other.
    pub(crate) fn picture(&self, camera: &PinholeCamera, mut values: Vec<f64>, weights: &BandWeights) -> Vec<f64> {
        let Some(SplitPattern { wings, surround }) = &self.split else {
            values.truncate(camera.pixel_count() as usize);
            return values;
        };
        let Some(bands) = self.bands_apart(weights) else {
            return Wings::new(camera, &wings[0], surround).added_to(&values);
        };
        let of_band = |band: usize| {
            let own: Vec<f64> = values.iter().skip(band).step_by(bands).copied().collect();
            Wings::new(camera, &wings[band.min(wings.len() - 1)], surround).added_to(&own)
        };
        let whole: Vec<Vec<f64>> = (0..bands).map(of_band).collect();
        let mut light = vec![0.0; bands];
        let combined = |pixel: u64| {
            light.iter_mut().zip(&whole).for_each(|(light, band)| *light = band[pixel as usize]);
            weights.combine_apart(pixel, &light)
        };
        (0..camera.pixel_count()).map(combined).collect()
    }

    /// A ray over cell × pinhole for a cell around the picture.
    fn surround_ray(&self, camera: &PinholeCamera, per_scene_unit: f64, cell: &Cell, u: [f64; 4]) -> CameraRay {
        let [column, row] = [0, 1].map(|axis| cell.low[axis] + u[axis] * cell.size[axis]);
        let film = camera.optics().film.unwrap_or_default();
        let (chief, normal) = film.chief(camera.on_plane(column, row), camera.focal_distance_m());
        if chief.z <= 0.0 {
            return blocked_ray(camera, per_scene_unit);
        }
        let (a, b) = unit_disk(u[2], u[3]);
        let point = DVec3::new(a, b, 0.0) * (0.5 * camera.pinhole_diameter_m());
        self.through_point(
            camera,
            per_scene_unit,
            (chief, normal, 1.0),
            &PinholePoint { point, start: point, cell: UNIFORM },
        )
    }

    /// Multiplies bands by the relative density of their patterns, if these differ.
    #[inline]
    pub(crate) fn weigh_bands(&self, cell: u32, bands: &mut [f64]) {
        if cell == UNIFORM {
            return;
        }
        if let Some(pattern) = self.pattern.as_ref().filter(|pattern| pattern.bands() == bands.len()) {
            bands.iter_mut().enumerate().for_each(|(band, value)| *value *= pattern.ratio(band, cell));
        }
    }

    /// The ray of a pixel for a point of the unit cube, as in [`crate::Rays::ray`].
    pub(crate) fn ray(&self, camera: &PinholeCamera, per_scene_unit: f64, pixel: u64, u: [f64; 4]) -> CameraRay {
        if let (Some(split), Some(cell)) = (&self.split, pixel.checked_sub(camera.pixel_count())) {
            return self.surround_ray(camera, per_scene_unit, split.surround.cell(cell as usize), u);
        }
        let Some((chief, normal, area_ratio)) = chief(camera, pixel, u) else {
            return blocked_ray(camera, per_scene_unit);
        };
        self.through_point(camera, per_scene_unit, (chief, normal, area_ratio), &self.pinhole_point(camera, u))
    }

    /// The ray through a point of a pixel and a point of the pinhole, in its radii.
    pub(crate) fn ray_through(
        &self,
        camera: &PinholeCamera,
        per_scene_unit: f64,
        pixel: u64,
        [u, v]: [f64; 2],
        pinhole_point: [f64; 2],
    ) -> CameraRay {
        let Some(chief) = chief(camera, pixel, [u, v, 0.0, 0.0]) else { return blocked_ray(camera, per_scene_unit) };
        let radius =
            if camera.pinhole_model() == PinholeModel::Point { 0.0 } else { 0.5 * camera.pinhole_diameter_m() };
        let point = DVec3::new(pinhole_point[0], pinhole_point[1], 0.0) * radius;
        self.through_point(camera, per_scene_unit, chief, &PinholePoint { point, start: point, cell: 0 })
    }

    fn through_point(
        &self,
        camera: &PinholeCamera,
        per_scene_unit: f64,
        (chief, normal, area_ratio): (DVec3, DVec3, f64),
        pinhole_point: &PinholePoint,
    ) -> CameraRay {
        let to_pinhole = chief + pinhole_point.point;
        let focal2 = camera.focal_distance_m() * camera.focal_distance_m();
        let length2 = to_pinhole.length_squared();
        let cos4 = area_ratio * focal2 * to_pinhole.z * to_pinhole.dot(normal).max(0.0) / (length2 * length2);
        let (direction, passes) = match camera.lens() {
            Some(lens) => refracted(lens, pinhole_point.point, to_pinhole),
            // From its start on the pinhole, towards the point that the geometric ray meets at the
            // objects' distance.
            None => {
                (to_pinhole / to_pinhole.z + (pinhole_point.point - pinhole_point.start) * self.object_curvature, true)
            }
        };
        let in_scene =
            |vector: DVec3| camera.right() * vector.x + camera.up() * vector.y + camera.direction() * vector.z;
        CameraRay {
            origin: (camera.position_m() + in_scene(pinhole_point.start)) * per_scene_unit,
            direction: in_scene(direction).normalize(),
            cos4: if passes { cos4 } else { 0.0 },
            pattern_cell: pinhole_point.cell,
        }
    }

    fn pinhole_point(&self, camera: &PinholeCamera, u: [f64; 4]) -> PinholePoint {
        let radius = 0.5 * camera.pinhole_diameter_m();
        if let Some(pattern) = &self.pattern {
            let Draw { v, cell } = pattern.draw(u[2]);
            let (sin, cos) = (TAU * u[3]).sin_cos();
            let point = DVec3::new(cos, sin, 0.0) * (v * radius);
            // Light that is diffracted beyond the pinhole's shadow comes from its rim.
            return PinholePoint { point, start: point / v.max(1.0), cell };
        }
        if camera.pinhole_model() == PinholeModel::Point {
            return PinholePoint { point: DVec3::ZERO, start: DVec3::ZERO, cell: 0 };
        }
        let (a, b) = unit_disk(u[2], u[3]);
        let point = DVec3::new(a * radius, b * radius, 0.0);
        PinholePoint { point, start: point, cell: 0 }
    }
}

/// The ray of a sensor point that sees nothing.
fn blocked_ray(camera: &PinholeCamera, per_scene_unit: f64) -> CameraRay {
    let origin = camera.position_m() * per_scene_unit;
    CameraRay { origin, direction: camera.direction(), cos4: 0.0, pattern_cell: 0 }
}

/// A ray's position on the plane of the pinhole, along (right, up, direction), metres.
struct PinholePoint {
    /// Intersection of the plane with the straight line from the sensor; outside the pinhole with
    /// diffraction.
    point: DVec3,
    /// Where the ray leaves the pinhole.
    start: DVec3,
    cell: u32,
}

/// The vector from a sensor point to the centre of the pinhole, the sensor's normal there, and the
/// ratio of areas due to distortion.
fn chief(camera: &PinholeCamera, pixel: u64, u: [f64; 4]) -> Option<(DVec3, DVec3, f64)> {
    let focal = camera.focal_distance_m();
    let optics = camera.optics();
    let (place, area_ratio) = match &optics.matrix {
        None => (camera.on_image(pixel, u[0], u[1]), 1.0),
        Some(matrix) => {
            let columns = u64::from(camera.columns());
            let (column, row) = ((pixel % columns) as f64, (pixel / columns) as f64);
            let (slopes, area_ratio) = matrix.slopes([column + u[0], row + u[1]])?;
            (slopes.map(|slope| slope * focal), area_ratio)
        }
    };
    let (chief, normal) = optics.film.unwrap_or_default().chief(place, focal);
    (chief.z > 0.0).then_some((chief, normal, area_ratio))
}

/// The refracted direction of a ray that meets a thin lens at `point`, and whether it passes the
/// front stop.
fn refracted(lens: &ThinLens, point: DVec3, to_pinhole: DVec3) -> (DVec3, bool) {
    let direction = to_pinhole / to_pinhole.z - point / lens.focal_length_m;
    let passes = lens.front_stop.is_none_or(|stop| {
        let place = point + direction * stop.distance_m;
        place.x.hypot(place.y) <= 0.5 * stop.diameter_m
    });
    (direction, passes)
}

#[cfg(test)]
mod tests {
    use crate::camera::tests::{paper_camera, paper_description};
    use crate::{
        CameraDescription, CameraMatrix, Distortion, FilmPlane, FrontStop, PinholeCamera, PinholeModel, Rays, ThinLens,
        fresnel_irradiance,
    };
    use glam::DVec3;

    const LENS: ThinLens = ThinLens { focal_length_m: 8e-3, aperture_m: 4e-3, focus_distance_m: 0.5, front_stop: None };

    fn with_lens(lens: ThinLens) -> PinholeCamera {
        PinholeCamera::new(&paper_description()).unwrap().with_lens(lens).unwrap()
    }

    /// Where the rays of a sensor point meet the plane at `distance` in front of the camera, right
    /// and up of the axis.
    fn hits(camera: &PinholeCamera, pixel: u64, distance: f64, count: u32) -> Vec<[f64; 2]> {
        let rays = Rays::new(camera, count, 0);
        let place = |sample: u32| {
            let mut u = rays.sampler(pixel, sample).take(radsight_sampling::DimensionSet::CAMERA);
            (u[0], u[1]) = (0.5, 0.5);
            let ray = rays.ray(pixel, u);
            let offset = ray.origin - camera.position_m();
            let to_pinhole = distance - offset.dot(camera.direction());
            let at = offset + ray.direction * (to_pinhole / ray.direction.dot(camera.direction()));
            [at.dot(camera.right()), at.dot(camera.up())]
        };
        (0..count).map(place).collect()
    }

    #[test]
    fn a_lens_focuses_and_blurs_as_the_closed_form_says() {
        let camera = with_lens(LENS);
        let pixel = 40 * 192 + 30;
        let sharp = hits(&camera, pixel, 0.5, 512);
        let spread = |places: &[[f64; 2]]| {
            let largest = |axis: usize| places.iter().map(|at| at[axis]).fold(f64::MIN, f64::max);
            let least = |axis: usize| places.iter().map(|at| at[axis]).fold(f64::MAX, f64::min);
            [largest(0) - least(0), largest(1) - least(1)]
        };
        assert!(spread(&sharp).iter().all(|width| *width < 1e-12), "{:?}", spread(&sharp));
        for distance in [0.3, 0.8, 3.0] {
            // The image on the sensor of the disk that one sensor point sees.
            let width = spread(&hits(&camera, pixel, distance, 4096))[0] * LENS.image_distance_m() / distance;
            let expected = LENS.blur_circle_m(distance);
            assert!((width / expected - 1.0).abs() < 5e-3, "{distance}: {width} against {expected}");
        }
        // A·F·|D − s|/(D (s − F)), the textbook formula.
        let expected = 4e-3 * 8e-3 * 0.3 / (0.8 * (0.5 - 8e-3));
        assert!((LENS.blur_circle_m(0.8) / expected - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_small_aperture_falls_off_with_cos4() {
        let camera = with_lens(ThinLens { aperture_m: 1e-5, ..LENS });
        let rays = Rays::new(&camera, 64, 0);
        for pixel in [0, 191, 96, 82 * 192 + 96] {
            let mean = (0..64).map(|sample| rays.of_sample(pixel, sample).cos4).sum::<f64>() / 64.0;
            assert!((mean / camera.central_cos4(pixel) - 1.0).abs() < 1e-4, "{pixel}: {mean}");
        }
    }

    #[test]
    fn a_front_stop_cuts_slanted_beams_as_two_disks_overlap() {
        let stop = FrontStop { distance_m: 8e-3, diameter_m: 4e-3 };
        let camera = with_lens(ThinLens { focus_distance_m: f64::INFINITY, front_stop: Some(stop), ..LENS });
        let rays = Rays::new(&camera, 1 << 14, 0);
        let share = |pixel: u64| {
            let passed = (0..1u32 << 14).filter(|&sample| rays.of_sample(pixel, sample).cos4 > 0.0).count();
            passed as f64 / f64::from(1u32 << 14)
        };
        // The distance between the two disks of radius 2 mm, seen from a corner of the sensor.
        let offset = 8e-3 * (95.5f64 * 13.75e-6).hypot(82.0 * 16e-6) / 8e-3;
        let half = offset / 2.0 / 2e-3;
        let expected = (2.0 * half.acos() - 2.0 * half * (1.0 - half * half).sqrt()) / std::f64::consts::PI;
        assert!((share(0) - expected).abs() < 4e-3, "{} against {expected}", share(0));
        assert!(share(82 * 192 + 96) > 0.99);
    }

    #[test]
    fn a_matrix_without_distortion_sees_as_a_plain_camera_does() {
        let plain = paper_camera();
        let focal = [6.75e-3 / 13.75e-6, 6.75e-3 / 16e-6];
        let matrix = CameraMatrix { focal, center: [95.5, 82.0], distortion: Distortion::Rational([0.0; 12]) };
        let camera = paper_camera().with_matrix(matrix).unwrap();
        let (a, b) = (Rays::new(&plain, 16, 3), Rays::new(&camera, 16, 3));
        for index in (0..plain.pixel_count() * 16).step_by(7919) {
            let (a, b) = (a.of_index(index), b.of_index(index));
            assert!((a.direction - b.direction).length() < 1e-9 && (a.cos4 - b.cos4).abs() < 1e-8);
            assert!((a.origin - b.origin).length() < 1e-12);
        }
    }

    /// A uniform sky through a distorting lens: the flux on the whole sensor equals that of the
    /// same directions without distortion.
    #[test]
    fn distortion_conserves_flux() {
        let distortion = Distortion::Rational([0.9, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let matrix = CameraMatrix { focal: [490.0; 2], center: [95.5, 82.0], distortion };
        let camera = paper_camera().with_pinhole_model(PinholeModel::Point).with_matrix(matrix).unwrap();
        let rays = Rays::new(&camera, 1, 0);
        let flux = |inside: &dyn Fn(DVec3) -> bool| {
            let all = 0..camera.pixel_count();
            let of_pixel = |pixel| Some(rays.of_sample(pixel, 0)).filter(|ray| inside(ray.direction));
            all.filter_map(of_pixel).map(|ray| ray.cos4).sum::<f64>() * camera.pixel_area_m2()
        };
        // Within slope 0.12 of the axis: π tan² F² for small angles, slightly less due to cos⁴.
        let found = flux(&|direction: DVec3| direction.x.hypot(direction.y) < 0.12 * -direction.z);
        let expected = std::f64::consts::PI * (6.75e-3f64).powi(2) * (0.12f64.powi(2) / (1.0 + 0.12f64.powi(2)));
        assert!((found / expected - 1.0).abs() < 4e-3, "{found} against {expected}");
    }

    #[test]
    fn shifted_and_tilted_sensors_see_along_their_plane() {
        let film = FilmPlane { shift_m: [1e-3, 0.0], tilt: [0.0, 0.0] };
        let middle = 82 * 192 + 95;
        let at = hits(&paper_camera().with_pinhole_model(PinholeModel::Point).with_film_plane(film), middle, 1.0, 1)[0];
        let nominal = hits(&paper_camera().with_pinhole_model(PinholeModel::Point), middle, 1.0, 1)[0];
        assert!((at[0] - nominal[0] - 1e-3 / 6.75e-3).abs() < 1e-9, "{at:?} {nominal:?}");
        // A sensor rotated about its up axis by β: x becomes x cos β, the distance f − x sin β.
        let film = FilmPlane { shift_m: [0.0; 2], tilt: [0.0, 0.1] };
        let camera = paper_camera().with_pinhole_model(PinholeModel::Point).with_film_plane(film);
        let x = 60.0 * 13.75e-6;
        let at = hits(&camera, 82 * 192 + 95 + 60, 1.0, 1)[0];
        let nominal_x = x - 0.5 * 13.75e-6;
        let expected = nominal_x * 0.1f64.cos() / (6.75e-3 - nominal_x * 0.1f64.sin());
        assert!((at[0] - expected).abs() < 1e-9, "{} {expected}", at[0]);
    }

    #[test]
    fn diffraction_needs_a_wavelength() {
        let description =
            CameraDescription { wavelength_m: None, pinhole_model: PinholeModel::Diffraction, ..paper_description() };
        assert!(PinholeCamera::new(&description).is_err());
    }

    /// The image of a point 0.48 m in front of the paper's camera: the fraction of rays in rings on
    /// the plane of the point, compared with the diffraction pattern.
    #[test]
    fn rays_draw_the_pattern_of_a_point_at_the_objects_distance() {
        let camera = paper_camera().with_pinhole_model(PinholeModel::Diffraction).with_object_distance(0.48).unwrap();
        let camera = camera.with_whole_pattern();
        let middle = 82 * 192 + 96;
        let places = hits(&camera, middle, 0.48, 1 << 15);
        let [center_x, center_y] = hits(&paper_camera().with_pinhole_model(PinholeModel::Point), middle, 0.48, 1)[0];
        // The radius a (1 + f/D) of the shadow becomes a (1 + D/f) on that plane.
        let radius = 0.05e-3 * (1.0 + 0.48 / 6.75e-3);
        let number = crate::fresnel_number(&camera, 0.48).unwrap();
        for ring in 0..12 {
            let (low, high) = (0.2 * f64::from(ring), 0.2 * f64::from(ring + 1));
            let distance = |at: &&[f64; 2]| (at[0] - center_x).hypot(at[1] - center_y) / radius;
            let found =
                places.iter().filter(|at| (low..high).contains(&distance(at))).count() as f64 / places.len() as f64;
            let steps = 50;
            let expected: f64 = (0..steps)
                .map(|step| low + (high - low) * (f64::from(step) + 0.5) / f64::from(steps))
                .map(|v| 2.0 * std::f64::consts::PI.powi(2) * number * number * v * fresnel_irradiance(number, v))
                .sum::<f64>()
                * (high - low)
                / f64::from(steps);
            assert!((found - expected).abs() < 1e-3, "ring from {low}: {found} against {expected}");
        }
    }

    #[test]
    fn the_papers_camera_has_a_full_width_of_45_micrometres_where_the_disk_has_101() {
        let (far, near) = (0.48, 6.75e-3);
        let number = crate::fresnel_number(&paper_camera(), far).unwrap();
        let peak = fresnel_irradiance(number, 0.0);
        let half = (1..10_000).map(|k| f64::from(k) * 1e-4).find(|v| fresnel_irradiance(number, *v) < 0.5 * peak);
        let radius = 0.05e-3 * (1.0 + near / far);
        assert!((2.0 * radius - 101.4e-6).abs() < 0.1e-6);
        let width = 2.0 * half.unwrap() * radius;
        assert!((width - 45e-6).abs() < 2e-6, "{width}");
    }
}
