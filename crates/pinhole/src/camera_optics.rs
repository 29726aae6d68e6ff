//! Rays of cameras that are more than a hole before an upright sensor: diffraction, lens, distortion, a sensor out of place.

use crate::fresnel_pattern::{Draw, FresnelPattern, Wing};
use crate::rays::CameraRay;
use crate::surround::{Cell, Surround};
use crate::wings::Wings;
use crate::{BandWeights, PinholeCamera, PinholeModel, ThinLens};
use glam::DVec3;
use radsight_sampling::unit_disk;
use std::f64::consts::TAU;

/// Stands for the place in a pattern of rays that are not drawn from one.
const EVEN: u32 = u32::MAX;

/// What the rays of such a camera need.
#[derive(Clone, Debug)]
pub(crate) struct GeneralRays {
    pattern: Option<FresnelPattern>,
    /// 1/D of the objects whose diffraction is exact.
    object_curvature: f64,
    /// Where rays draw only the core of the pattern.
    parted: Option<Parted>,
}

/// What the wings of a pattern come from.
#[derive(Clone, Debug)]
struct Parted {
    /// One for each wavelength.
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
                let (core, wings) = Wing::part(&numbers, unit_m);
                return (core, Some(Parted { wings, surround: Surround::new(camera) }));
            }
            (FresnelPattern::new(&numbers), None)
        });
        let (pattern, parted) = pattern.map_or((None, None), |(pattern, parted)| (Some(pattern), parted));
        GeneralRays { pattern, object_curvature, parted }
    }

    /// How many cells around the picture are exposed besides its pixels.
    pub(crate) fn cells_around(&self) -> usize {
        self.parted.as_ref().map_or(0, |parted| parted.surround.count())
    }

    /// How many bands are kept apart, as [`crate::Rays::bands_apart`] has them.
    pub(crate) fn bands_apart(&self, weights: &BandWeights) -> Option<usize> {
        let wings = self.parted.as_ref().map(|parted| parted.wings.len())?;
        (wings > 1 || weights.has_mosaic()).then_some(wings.max(weights.as_slice().len()))
    }

    /// The picture from the exposures of pixels and cells around it, the bands of each together where they are kept apart.
    pub(crate) fn picture(&self, camera: &PinholeCamera, mut values: Vec<f64>, weights: &BandWeights) -> Vec<f64> {
        let Some(Parted { wings, surround }) = &self.parted else {
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

    /// A ray over cell × hole for a cell around the picture.
    fn ray_around(&self, camera: &PinholeCamera, per_scene_unit: f64, cell: &Cell, u: [f64; 4]) -> CameraRay {
        let [column, row] = [0, 1].map(|axis| cell.low[axis] + u[axis] * cell.size[axis]);
        let film = camera.optics().film.unwrap_or_default();
        let (chief, normal) = film.chief(camera.on_plane(column, row), camera.focal_distance_m());
        if chief.z <= 0.0 {
            return no_ray(camera, per_scene_unit);
        }
        let (a, b) = unit_disk(u[2], u[3]);
        let point = DVec3::new(a, b, 0.0) * (0.5 * camera.pinhole_diameter_m());
        self.through_hole(camera, per_scene_unit, (chief, normal, 1.0), &OnHole { point, start: point, cell: EVEN })
    }

    /// Weighs bands by their patterns, where they differ.
    #[inline]
    pub(crate) fn weigh_bands(&self, cell: u32, bands: &mut [f64]) {
        if cell == EVEN {
            return;
        }
        if let Some(pattern) = self.pattern.as_ref().filter(|pattern| pattern.bands() == bands.len()) {
            bands.iter_mut().enumerate().for_each(|(band, value)| *value *= pattern.ratio(band, cell));
        }
    }

    /// The ray of a pixel for a point of the unit cube, as [`crate::Rays::ray`] has it.
    pub(crate) fn ray(&self, camera: &PinholeCamera, per_scene_unit: f64, pixel: u64, u: [f64; 4]) -> CameraRay {
        if let (Some(parted), Some(cell)) = (&self.parted, pixel.checked_sub(camera.pixel_count())) {
            return self.ray_around(camera, per_scene_unit, parted.surround.cell(cell as usize), u);
        }
        let Some((chief, normal, growth)) = chief(camera, pixel, u) else { return no_ray(camera, per_scene_unit) };
        self.through_hole(camera, per_scene_unit, (chief, normal, growth), &self.on_hole(camera, u))
    }

    /// The ray through a place on a pixel and a point of the hole, in its radii.
    pub(crate) fn ray_through(
        &self,
        camera: &PinholeCamera,
        per_scene_unit: f64,
        pixel: u64,
        [u, v]: [f64; 2],
        on_hole: [f64; 2],
    ) -> CameraRay {
        let Some(chief) = chief(camera, pixel, [u, v, 0.0, 0.0]) else { return no_ray(camera, per_scene_unit) };
        let radius =
            if camera.pinhole_model() == PinholeModel::Point { 0.0 } else { 0.5 * camera.pinhole_diameter_m() };
        let point = DVec3::new(on_hole[0], on_hole[1], 0.0) * radius;
        self.through_hole(camera, per_scene_unit, chief, &OnHole { point, start: point, cell: 0 })
    }

    fn through_hole(
        &self,
        camera: &PinholeCamera,
        per_scene_unit: f64,
        (chief, normal, growth): (DVec3, DVec3, f64),
        on_hole: &OnHole,
    ) -> CameraRay {
        let way = chief + on_hole.point;
        let focal2 = camera.focal_distance_m() * camera.focal_distance_m();
        let length2 = way.length_squared();
        let cos4 = growth * focal2 * way.z * way.dot(normal).max(0.0) / (length2 * length2);
        let (direction, passes) = match camera.lens() {
            Some(lens) => refracted(lens, on_hole.point, way),
            // Towards the point that the geometric ray meets at the objects' distance, from where it leaves the hole.
            None => (way / way.z + (on_hole.point - on_hole.start) * self.object_curvature, true),
        };
        let in_scene =
            |vector: DVec3| camera.right() * vector.x + camera.up() * vector.y + camera.direction() * vector.z;
        CameraRay {
            origin: (camera.position_m() + in_scene(on_hole.start)) * per_scene_unit,
            direction: in_scene(direction).normalize(),
            cos4: if passes { cos4 } else { 0.0 },
            pattern_cell: on_hole.cell,
        }
    }

    fn on_hole(&self, camera: &PinholeCamera, u: [f64; 4]) -> OnHole {
        let radius = 0.5 * camera.pinhole_diameter_m();
        if let Some(pattern) = &self.pattern {
            let Draw { v, cell } = pattern.draw(u[2]);
            let (sin, cos) = (TAU * u[3]).sin_cos();
            let point = DVec3::new(cos, sin, 0.0) * (v * radius);
            // Light that is bent beyond the hole's shadow comes from its rim.
            return OnHole { point, start: point / v.max(1.0), cell };
        }
        if camera.pinhole_model() == PinholeModel::Point {
            return OnHole { point: DVec3::ZERO, start: DVec3::ZERO, cell: 0 };
        }
        let (a, b) = unit_disk(u[2], u[3]);
        let point = DVec3::new(a * radius, b * radius, 0.0);
        OnHole { point, start: point, cell: 0 }
    }
}

/// Stands for the ray of a place on the sensor that sees nothing.
fn no_ray(camera: &PinholeCamera, per_scene_unit: f64) -> CameraRay {
    let origin = camera.position_m() * per_scene_unit;
    CameraRay { origin, direction: camera.direction(), cos4: 0.0, pattern_cell: 0 }
}

/// A ray's place on the plane of the hole, along (right, up, direction), metres.
struct OnHole {
    /// Where the straight line from the sensor meets that plane; diffraction takes it beyond the hole.
    point: DVec3,
    /// Where the ray leaves the hole.
    start: DVec3,
    cell: u32,
}

/// The way from a sensor point to the middle of the hole, the sensor's normal there, and the growth of area by distortion.
fn chief(camera: &PinholeCamera, pixel: u64, u: [f64; 4]) -> Option<(DVec3, DVec3, f64)> {
    let focal = camera.focal_distance_m();
    let optics = camera.optics();
    let (place, growth) = match &optics.matrix {
        None => (camera.on_image(pixel, u[0], u[1]), 1.0),
        Some(matrix) => {
            let columns = u64::from(camera.columns());
            let (column, row) = ((pixel % columns) as f64, (pixel / columns) as f64);
            let (slopes, growth) = matrix.slopes([column + u[0], row + u[1]])?;
            (slopes.map(|slope| slope * focal), growth)
        }
    };
    let (chief, normal) = optics.film.unwrap_or_default().chief(place, focal);
    (chief.z > 0.0).then_some((chief, normal, growth))
}

/// The direction behind a thin lens of a ray that meets it at `point` on its way, and whether it passes the front stop.
fn refracted(lens: &ThinLens, point: DVec3, way: DVec3) -> (DVec3, bool) {
    let direction = way / way.z - point / lens.focal_length_m;
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

    /// Where rays of one point of the sensor meet the plane `distance` before the camera, right and up of the axis.
    fn met(camera: &PinholeCamera, pixel: u64, distance: f64, count: u32) -> Vec<[f64; 2]> {
        let rays = Rays::new(camera, count, 0);
        let place = |sample: u32| {
            let mut u = rays.sampler(pixel, sample).take(radsight_sampling::DimensionSet::CAMERA);
            (u[0], u[1]) = (0.5, 0.5);
            let ray = rays.ray(pixel, u);
            let offset = ray.origin - camera.position_m();
            let way = distance - offset.dot(camera.direction());
            let at = offset + ray.direction * (way / ray.direction.dot(camera.direction()));
            [at.dot(camera.right()), at.dot(camera.up())]
        };
        (0..count).map(place).collect()
    }

    #[test]
    fn a_lens_gathers_what_it_makes_sharp_and_blurs_the_rest_as_the_closed_form_says() {
        let camera = with_lens(LENS);
        let pixel = 40 * 192 + 30;
        let sharp = met(&camera, pixel, 0.5, 512);
        let spread = |places: &[[f64; 2]]| {
            let largest = |axis: usize| places.iter().map(|at| at[axis]).fold(f64::MIN, f64::max);
            let least = |axis: usize| places.iter().map(|at| at[axis]).fold(f64::MAX, f64::min);
            [largest(0) - least(0), largest(1) - least(1)]
        };
        assert!(spread(&sharp).iter().all(|width| *width < 1e-12), "{:?}", spread(&sharp));
        for distance in [0.3, 0.8, 3.0] {
            // The image on the sensor of the disk that one sensor point sees.
            let width = spread(&met(&camera, pixel, distance, 4096))[0] * LENS.image_distance_m() / distance;
            let expected = LENS.blur_circle_m(distance);
            assert!((width / expected - 1.0).abs() < 5e-3, "{distance}: {width} against {expected}");
        }
        // A·F·|D − s|/(D (s − F)), the form of the textbooks.
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
        // Behind a corner of the sensor the two disks of radius 2 mm are so far apart.
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

    /// An even sky through a distorting lens: what falls on the whole sensor is what falls on the same directions without distortion.
    #[test]
    fn distortion_moves_light_and_keeps_it() {
        let distortion = Distortion::Rational([0.9, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let matrix = CameraMatrix { focal: [490.0; 2], center: [95.5, 82.0], distortion };
        let camera = paper_camera().with_pinhole_model(PinholeModel::Point).with_matrix(matrix).unwrap();
        let rays = Rays::new(&camera, 1, 0);
        let flux = |inside: &dyn Fn(DVec3) -> bool| {
            let all = 0..camera.pixel_count();
            let of_pixel = |pixel| Some(rays.of_sample(pixel, 0)).filter(|ray| inside(ray.direction));
            all.filter_map(of_pixel).map(|ray| ray.cos4).sum::<f64>() * camera.pixel_area_m2()
        };
        // Within slope 0.12 of the axis: π tan² F² for small angles, by cos⁴ a little less.
        let found = flux(&|direction: DVec3| direction.x.hypot(direction.y) < 0.12 * -direction.z);
        let expected = std::f64::consts::PI * (6.75e-3f64).powi(2) * (0.12f64.powi(2) / (1.0 + 0.12f64.powi(2)));
        assert!((found / expected - 1.0).abs() < 4e-3, "{found} against {expected}");
    }

    #[test]
    fn a_shifted_sensor_sees_to_the_side_and_a_tilted_one_as_its_plane_says() {
        let film = FilmPlane { shift_m: [1e-3, 0.0], tilt: [0.0, 0.0] };
        let middle = 82 * 192 + 95;
        let at = met(&paper_camera().with_pinhole_model(PinholeModel::Point).with_film_plane(film), middle, 1.0, 1)[0];
        let nominal = met(&paper_camera().with_pinhole_model(PinholeModel::Point), middle, 1.0, 1)[0];
        assert!((at[0] - nominal[0] - 1e-3 / 6.75e-3).abs() < 1e-9, "{at:?} {nominal:?}");
        // A sensor turned about its up by β: x goes to x cos β, the distance to f − x sin β.
        let film = FilmPlane { shift_m: [0.0; 2], tilt: [0.0, 0.1] };
        let camera = paper_camera().with_pinhole_model(PinholeModel::Point).with_film_plane(film);
        let x = 60.0 * 13.75e-6;
        let at = met(&camera, 82 * 192 + 95 + 60, 1.0, 1)[0];
        let nominal_x = x - 0.5 * 13.75e-6;
        let expected = nominal_x * 0.1f64.cos() / (6.75e-3 - nominal_x * 0.1f64.sin());
        assert!((at[0] - expected).abs() < 1e-9, "{} {expected}", at[0]);
    }

    #[test]
    fn diffraction_needs_a_wavelength() {
        let asked =
            CameraDescription { wavelength_m: None, pinhole_model: PinholeModel::Diffraction, ..paper_description() };
        assert!(PinholeCamera::new(&asked).is_err());
    }

    /// The image of a point 0.48 m before the paper's camera, as its rays draw it: shares of rays in rings about the place on the
    /// plane of the point, which the pattern foresees.
    #[test]
    fn rays_draw_the_pattern_of_a_point_at_the_objects_distance() {
        let camera = paper_camera().with_pinhole_model(PinholeModel::Diffraction).with_object_distance(0.48).unwrap();
        let camera = camera.with_whole_pattern();
        let middle = 82 * 192 + 96;
        let places = met(&camera, middle, 0.48, 1 << 15);
        let [center_x, center_y] = met(&paper_camera().with_pinhole_model(PinholeModel::Point), middle, 0.48, 1)[0];
        // On that plane the shadow's radius a (1 + f/D) is a (1 + D/f).
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
