//! The wings of a diffraction pattern, added to a whole picture by convolution.
//!
//! The pattern P of a pinhole is the same all over the field: the picture is `V = P ∗ R` with R the
//! radiance in the directions of the sensor's points. Rays sample only the core A near the centre
//! (`P = A + B`, `α = ∫A`): they give `C = A ∗ R / α`. The wings B follow from the same picture.
//! With Fourier transforms
//!
//! `V = α C (1 + B/A)`
//!
//! Light from outside the picture comes from the [`Surround`], whose cells are exposed like pixels.
//! A bright spot then need not be hit by rare rays of all other pixels.

use crate::PinholeCamera;
use crate::fresnel_pattern::Wing;
use crate::surround::Surround;
use rustfft::num_complex::Complex;
use rustfft::{FftDirection, FftPlanner};

/// Where the core's transform is below this fraction of its maximum, the quotient is reduced to 0:
/// the picture has no signal there.
const MIN_CORE: f64 = 0.01;

/// Points per pixel in each direction at which the pattern is evaluated, in the first pixels from
/// its centre and farther out.
const POINTS: [i32; 2] = [8, 4];

/// Radius of the first pixels.
const NEAR_PIXELS: usize = 8;

/// Nodes in each direction at which light from far outside the picture is computed; it is smooth
/// between them.
const FAR_NODES: usize = 17;

/// Parts of a far cell in each direction at whose centres the pattern is evaluated.
const FAR_PARTS: u32 = 6;

/// Adds the wings to pictures of one camera.
#[derive(Clone, Debug)]
pub(crate) struct Wings<'a> {
    camera: &'a PinholeCamera,
    wing: &'a Wing,
    surround: &'a Surround,
}

impl<'a> Wings<'a> {
    pub(crate) fn new(camera: &'a PinholeCamera, wing: &'a Wing, surround: &'a Surround) -> Self {
        Wings { camera, wing, surround }
    }

    /// The picture with its wings, from the exposures of its pixels and of the cells around it by
    /// the core.
    ///
    /// The mean around the picture is subtracted first and added at the end, since a uniform
    /// picture is unchanged. This leaves little light at the cut-off of the margin.
    pub(crate) fn added_to(&self, values: &[f64]) -> Vec<f64> {
        let pixels = self.camera.pixel_count() as usize;
        let level = self.surround.near_mean(&values[pixels..]);
        let off: Vec<f64> = values.iter().map(|value| value - level).collect();
        // Negative values are errors of the quotient, not light.
        self.convolved(&off).into_iter().map(|value| (value + level).max(0.0)).collect()
    }

    fn convolved(&self, values: &[f64]) -> Vec<f64> {
        let (columns, rows) = (self.camera.columns() as usize, self.camera.rows() as usize);
        let pixels = columns * rows;
        let around = &values[pixels..];
        let margin = [columns / 2, rows / 2];
        let size = [2 * (columns + margin[0]), 2 * (rows + margin[1])];
        let mut planner = FftPlanner::new();
        let spectra = self.spectra(&mut planner, size);
        let mut blurred = self.field(size, |column, row| match self.pixel_at(margin, column, row) {
            Some(pixel) => values[pixel],
            None => self.cell_at(margin, column, row).map_or(0.0, |cell| around[cell]),
        });
        filter(&mut planner, &mut blurred, size, spectra.iter().map(|spectrum| spectrum.re));
        // Outside the picture the core has not been applied yet.
        let mut picture = blurred;
        for (index, value) in picture.iter_mut().enumerate() {
            let (column, row) = (index % size[0], index / size[0]);
            *value = Complex::from(match self.pixel_at(margin, column, row) {
                Some(pixel) => values[pixel],
                None => self.cell_at(margin, column, row).map_or(0.0, |_| value.re),
            });
        }
        filter(&mut planner, &mut picture, size, spectra.iter().map(|spectrum| spectrum.im));
        drop(spectra);
        let far = self.far_light(around);
        let scale = self.wing.core_share();
        let at = |pixel: usize| (pixel / columns + margin[1]) * size[0] + pixel % columns + margin[0];
        (0..pixels)
            .map(|pixel| {
                let place = [(pixel % columns) as f64 + 0.5, (pixel / columns) as f64 + 0.5];
                scale * values[pixel] + scale * picture[at(pixel)].re + far.at(place)
            })
            .collect()
    }

    /// A function over the plane of the transform, which begins with the margin.
    fn field(&self, size: [usize; 2], value: impl Fn(usize, usize) -> f64) -> Vec<Complex<f64>> {
        (0..size[0] * size[1]).map(|index| Complex::from(value(index % size[0], index / size[0]))).collect()
    }

    /// The pixel at a point of the transform's plane.
    fn pixel_at(&self, margin: [usize; 2], column: usize, row: usize) -> Option<usize> {
        let (columns, rows) = (self.camera.columns() as usize, self.camera.rows() as usize);
        let (column, row) = (column.checked_sub(margin[0])?, row.checked_sub(margin[1])?);
        (column < columns && row < rows).then_some(row * columns + column)
    }

    /// The cell of the near surround at such a point; none beyond the margin.
    fn cell_at(&self, margin: [usize; 2], column: usize, row: usize) -> Option<usize> {
        let place = [column as f64 - margin[0] as f64 + 0.5, row as f64 - margin[1] as f64 + 0.5];
        self.surround.cell_at(place)
    }

    /// The transform of the core, 1 at frequency 0, as the real part and B/A as the imaginary part,
    /// over the frequencies of a periodic picture of this size. The pattern is averaged over pixels
    /// by the midpoint rule.
    fn spectra(&self, planner: &mut FftPlanner<f64>, size: [usize; 2]) -> Vec<Complex<f64>> {
        let pitch = self.camera.pixel_pitch_m();
        // Both parts are even, so their transforms are real: one is stored in the real part, one in
        // the imaginary part.
        let mut parts = vec![Complex::ZERO; size[0] * size[1]];
        for row in 0..=size[1] / 2 {
            for column in 0..=size[0] / 2 {
                let points = POINTS[usize::from(column.max(row) > NEAR_PIXELS)];
                let mut sum = Complex::ZERO;
                for step in 0..points * points {
                    let within = |step: i32| (f64::from(step) + 0.5) / f64::from(points) - 0.5;
                    let x = (column as f64 + within(step % points)) * pitch[0];
                    let y = (row as f64 + within(step / points)) * pitch[1];
                    let [core, wing] = self.wing.densities(x.hypot(y));
                    sum += Complex::new(core, wing);
                }
                let value = sum * (pitch[0] * pitch[1] / f64::from(points * points));
                let mirrored = |at: usize, size: usize| [at, (size - at) % size];
                for x in mirrored(column, size[0]) {
                    for y in mirrored(row, size[1]) {
                        parts[y * size[0] + x] = value;
                    }
                }
            }
        }
        transform(planner, &mut parts, size, FftDirection::Forward);
        let whole = parts[0].re;
        let least = (MIN_CORE * whole).powi(2);
        let quotient = |part: &Complex<f64>| part.im * part.re / (part.re * part.re + least);
        for part in &mut parts {
            *part = Complex::new(part.re / whole, quotient(part));
        }
        parts
    }

    /// Light from outside the plane of the transform.
    fn far_light(&self, around: &[f64]) -> FarLight {
        let pitch = self.camera.pixel_pitch_m();
        let size = [f64::from(self.camera.columns()), f64::from(self.camera.rows())];
        let mut nodes = vec![0.0; FAR_NODES * FAR_NODES];
        for (index, node) in nodes.iter_mut().enumerate() {
            let place = [index % FAR_NODES, index / FAR_NODES].map(|step| step as f64 / (FAR_NODES - 1) as f64);
            for (cell, bounds) in self.surround.far_cells() {
                let density = |[column, row]: [f64; 2]| {
                    let x = (column - place[0] * size[0]) * pitch[0];
                    let y = (row - place[1] * size[1]) * pitch[1];
                    self.wing.densities(x.hypot(y))[1]
                };
                let mean = bounds.parts(FAR_PARTS).map(density).sum::<f64>() / f64::from(FAR_PARTS * FAR_PARTS);
                let energy = mean * bounds.area() * pitch[0] * pitch[1];
                *node += energy * around[cell];
            }
        }
        FarLight { nodes, size }
    }
}

/// Light from far away at nodes over the picture, interpolated linearly.
struct FarLight {
    nodes: Vec<f64>,
    size: [f64; 2],
}

impl FarLight {
    fn at(&self, place: [f64; 2]) -> f64 {
        let position = [0, 1].map(|axis| place[axis] / self.size[axis] * (FAR_NODES - 1) as f64);
        let cell = position.map(|at| (at as usize).min(FAR_NODES - 2));
        let [x, y] = [0, 1].map(|axis| position[axis] - cell[axis] as f64);
        let row = |row: usize| {
            let first = (cell[1] + row) * FAR_NODES + cell[0];
            self.nodes[first] * (1.0 - x) + self.nodes[first + 1] * x
        };
        row(0) * (1.0 - y) + row(1) * y
    }
}

/// Multiplies the transform of a field by real factors.
fn filter(
    planner: &mut FftPlanner<f64>,
    field: &mut [Complex<f64>],
    size: [usize; 2],
    factors: impl Iterator<Item = f64>,
) {
    transform(planner, field, size, FftDirection::Forward);
    let unit = (field.len() as f64).recip();
    field.iter_mut().zip(factors).for_each(|(value, factor)| *value *= unit * factor);
    transform(planner, field, size, FftDirection::Inverse);
}

/// The Fourier transform of a picture, not normalised.
fn transform(
    planner: &mut FftPlanner<f64>,
    picture: &mut [Complex<f64>],
    [columns, rows]: [usize; 2],
    direction: FftDirection,
) {
    planner.plan_fft(columns, direction).process(picture);
    let down = planner.plan_fft(rows, direction);
    let mut turned = transposed(picture, [columns, rows]);
    down.process(&mut turned);
    picture.copy_from_slice(&transposed(&turned, [rows, columns]));
}

fn transposed(picture: &[Complex<f64>], [columns, rows]: [usize; 2]) -> Vec<Complex<f64>> {
    (0..columns * rows).map(|index| picture[index % rows * columns + index / rows]).collect()
}

#[cfg(test)]
mod tests {
    use crate::camera::tests::paper_description;
    use crate::fresnel_pattern::Wing;
    use crate::{
        BandWeights, CameraDescription, FilmPlane, PinholeCamera, PinholeModel, Rays, fresnel_irradiance,
        fresnel_number,
    };
    use std::f64::consts::PI;

    const DISTANCE: f64 = 0.48;

    fn camera(pinhole_diameter_m: f64) -> PinholeCamera {
        camera_of(pinhole_diameter_m, [96, 80])
    }

    fn camera_of(pinhole_diameter_m: f64, pixels: [u32; 2]) -> PinholeCamera {
        let description = CameraDescription {
            pinhole_diameter_m,
            pinhole_model: PinholeModel::Diffraction,
            pixels,
            ..paper_description()
        };
        PinholeCamera::new(&description).unwrap().with_object_distance(DISTANCE).unwrap()
    }

    /// The mean of a density over a pixel, by a midpoint rule.
    fn over_pixel(camera: &PinholeCamera, pixel: usize, point: [f64; 2], density: &dyn Fn(f64) -> f64) -> f64 {
        let points = 12;
        let sum: f64 = (0..points * points)
            .map(|step| {
                let u = (f64::from(step % points) + 0.5) / f64::from(points);
                let v = (f64::from(step / points) + 0.5) / f64::from(points);
                let [x, y] = camera.on_image(pixel as u64, u, v);
                density((x - point[0]).hypot(y - point[1]))
            })
            .sum();
        sum / f64::from(points * points)
    }

    /// A point between the centres of pixels, sampled by the core alone, becomes the pattern of
    /// Fresnel's integral.
    #[track_caller]
    fn check_point(pinhole_diameter_m: f64) {
        let camera = camera(pinhole_diameter_m);
        let number = fresnel_number(&camera, DISTANCE).unwrap();
        let unit = 0.5 * pinhole_diameter_m * (1.0 + camera.focal_distance_m() / DISTANCE);
        let (_, wings) = Wing::split(&[number], unit);
        let wing = &wings[0];
        let rays = Rays::new(&camera, 1, 0);
        let point = [0.3 * 13.75e-6, -0.2 * 16e-6];
        let pixels = camera.pixel_count() as usize;
        let core = |distance: f64| wing.densities(distance)[0] / wing.core_share();
        let mut values: Vec<f64> = (0..pixels).map(|pixel| over_pixel(&camera, pixel, point, &core)).collect();
        values.resize(rays.cells() as usize, 0.0);
        let found = rays.picture(values, &BandWeights::equal(1));
        let pattern =
            |distance: f64| PI * number * number * fresnel_irradiance(number, distance / unit) / (unit * unit);
        let expected: Vec<f64> = (0..pixels).map(|pixel| over_pixel(&camera, pixel, point, &pattern)).collect();
        let peak = expected.iter().copied().fold(0.0, f64::max);
        let off = found.iter().zip(&expected).map(|(found, expected)| (found - expected).abs()).fold(0.0, f64::max);
        println!("N {number}: off by {} of the peak", off / peak);
        assert!(off < 0.01 * peak, "N {number}: off by {} of the peak", off / peak);
    }

    #[test]
    fn a_point_becomes_the_fresnel_pattern_within_a_hundredth_of_its_peak() {
        check_point(0.1e-3);
        check_point(0.06e-3);
        check_point(0.25e-3);
        check_point(0.5e-3);
    }

    #[test]
    fn a_uniform_scene_stays_uniform() {
        for diameter in [0.05e-3, 0.1e-3, 0.3e-3] {
            let rays = Rays::new(&camera(diameter), 1, 0);
            let picture = rays.picture(vec![3.0; rays.cells() as usize], &BandWeights::equal(1));
            assert!(picture.iter().all(|value| (value - 3.0).abs() < 1e-9), "hole of {diameter} m");
        }
    }

    /// A black picture with light all around it, compared with the energy that the pattern
    /// diffracts over its edges. The step is the sharpest possible. The core there is known on its
    /// inner side alone, which costs under a hundredth of the step.
    #[test]
    fn light_from_around_the_picture_is_diffracted_into_it() {
        let camera = camera(0.1e-3);
        let number = fresnel_number(&camera, DISTANCE).unwrap();
        let unit = 0.05e-3 * (1.0 + camera.focal_distance_m() / DISTANCE);
        let (_, wings) = Wing::split(&[number], unit);
        let wing = &wings[0];
        let pixels = camera.pixel_count() as usize;
        let place = |pixel: usize| camera.on_image(pixel as u64, 0.5, 0.5);
        let from_inside = |pixel: usize, density: &dyn Fn(f64) -> f64| {
            let [x, y] = place(pixel);
            let at = |other: [f64; 2]| density((other[0] - x).hypot(other[1] - y));
            (0..pixels).map(|other| at(place(other))).sum::<f64>() * camera.pixel_area_m2()
        };
        let core = |distance: f64| wing.densities(distance)[0] / wing.core_share();
        let whole = |distance: f64| wing.densities(distance).iter().sum::<f64>();
        let mut values: Vec<f64> = (0..pixels).map(|pixel| 1.0 - from_inside(pixel, &core)).collect();
        let rays = Rays::new(&camera, 1, 0);
        values.resize(rays.cells() as usize, 1.0);
        let picture = rays.picture(values, &BandWeights::equal(1));
        for pixel in [40 * 96 + 48, 40 * 96 + 20, 40 * 96 + 8, 20 * 96 + 20, 10 * 96 + 48, 79 * 96 + 95, 40 * 96] {
            let expected = 1.0 - from_inside(pixel, &whole);
            assert!((picture[pixel] - expected).abs() < 8e-3, "{pixel}: {} against {expected}", picture[pixel]);
        }
    }

    #[test]
    fn core_and_wing_hold_the_whole_energy() {
        for number in [0.05, 0.578, 3.0, 40.0] {
            let (_, wings) = Wing::split(&[number], 1.0);
            let wing = &wings[0];
            let radius = |step: i32| 0.05 * (1.0 + 4e-4f64).powi(step);
            let beyond: f64 = (0..40_000)
                .map(|step| {
                    let (low, high) = (radius(step), radius(step + 1));
                    wing.densities(0.5 * (low + high))[1] * PI * (high * high - low * low)
                })
                .sum();
            let whole = wing.core_share() + beyond;
            assert!((whole - 1.0).abs() < 1e-4, "N {number}: {whole}");
        }
    }

    #[test]
    fn cameras_that_need_the_whole_pattern_sample_it() {
        let rays = |camera: &PinholeCamera| Rays::new(camera, 1, 0).cells();
        let plain = camera(0.1e-3);
        assert!(rays(&plain) > plain.pixel_count());
        assert_eq!(rays(&plain.clone().with_whole_pattern()), plain.pixel_count());
        let bands = |lengths: &[f64]| plain.clone().with_band_wavelengths(lengths.to_vec()).unwrap();
        assert!(rays(&bands(&WAVELENGTHS_M)) > plain.pixel_count());
        assert_eq!(rays(&bands(&[650e-9, 600e-9, 550e-9, 500e-9])), plain.pixel_count());
        let film = |shift: f64, tilt: f64| FilmPlane { shift_m: [shift, 0.0], tilt: [0.0, tilt] };
        assert!(rays(&plain.clone().with_film_plane(film(1e-3, 0.02))) > plain.pixel_count());
        let tilted = plain.clone().with_film_plane(film(1e-3, 0.1));
        assert_eq!((rays(&tilted), tilted.whole_pattern_reason().is_some()), (plain.pixel_count(), true));
        assert_eq!(plain.whole_pattern_reason(), None);
    }

    const WAVELENGTHS_M: [f64; 3] = [620e-9, 540e-9, 460e-9];

    /// A point in three bands: its image by each core, and the expected pattern of each by
    /// Fresnel's integral.
    fn three_bands() -> (Rays, Vec<f64>, Vec<Vec<f64>>) {
        let camera = camera_of(0.1e-3, [48, 40]).with_band_wavelengths(WAVELENGTHS_M.to_vec()).unwrap();
        let unit = 0.05e-3 * (1.0 + camera.focal_distance_m() / DISTANCE);
        let number = fresnel_number(&camera, DISTANCE).unwrap() * camera.wavelength_m().unwrap();
        let numbers = WAVELENGTHS_M.map(|wavelength| number / wavelength);
        let (_, wings) = Wing::split(&numbers, unit);
        let (rays, point) = (Rays::new(&camera, 1, 0), [0.3 * 13.75e-6, -0.2 * 16e-6]);
        let mut values = vec![0.0; 3 * rays.cells() as usize];
        let mut patterns = vec![Vec::new(); 3];
        for pixel in 0..camera.pixel_count() as usize {
            for band in 0..3 {
                let (wing, number) = (&wings[band], numbers[band]);
                let core = |distance: f64| wing.densities(distance)[0] / wing.core_share();
                values[3 * pixel + band] = over_pixel(&camera, pixel, point, &core);
                let pattern =
                    |distance: f64| PI * number * number * fresnel_irradiance(number, distance / unit) / (unit * unit);
                patterns[band].push(over_pixel(&camera, pixel, point, &pattern));
            }
        }
        (rays, values, patterns)
    }

    #[test]
    fn each_band_becomes_its_own_pattern_behind_colour_filters_too() {
        let (rays, values, patterns) = three_bands();
        let peak = patterns.iter().flatten().copied().fold(0.0, f64::max);
        let check = |weights: &BandWeights, what: &str| {
            let found = rays.picture(values.clone(), weights);
            let of_pixel =
                |pixel: usize| weights.combine_apart(pixel as u64, &[0, 1, 2].map(|band| patterns[band][pixel]));
            let off = (0..found.len()).map(|pixel| (found[pixel] - of_pixel(pixel)).abs()).fold(0.0, f64::max);
            assert!(off < 5e-3 * peak, "{what}: off by {} of the peak", off / peak);
        };
        check(&BandWeights::new(&[1.0, 0.0, 0.0]).unwrap(), "first band");
        check(&BandWeights::new(&[0.0, 0.0, 1.0]).unwrap(), "last band");
        let filters = [vec![1.0, 0.1, 0.0], vec![0.1, 0.8, 0.1], vec![0.0, 0.1, 1.0]];
        check(&BandWeights::equal(3).with_mosaic(48, [0, 1, 1, 2], &filters).unwrap(), "mosaic");
        // A grey scene is white light of equal weights.
        let grey = rays.picture(values.clone(), &BandWeights::equal(1));
        let white = rays.picture(values.clone(), &BandWeights::equal(3));
        assert!(grey.iter().zip(&white).all(|(grey, white)| (grey - white).abs() < 1e-12 * peak));
        // The bands differ by far more than the tolerance.
        let apart = patterns[0].iter().zip(&patterns[2]).map(|(red, blue)| (red - blue).abs()).fold(0.0, f64::max);
        assert!(apart > 0.1 * peak);
    }

    #[test]
    fn filters_keep_a_uniform_scene_uniform() {
        let rays = Rays::new(&camera(0.1e-3), 1, 0);
        let filters = [vec![1.0, 0.1, 0.0], vec![0.1, 0.8, 0.1], vec![0.0, 0.1, 1.0]];
        let weights = BandWeights::equal(3).with_mosaic(96, [0, 1, 1, 2], &filters).unwrap();
        assert_eq!((rays.bands_apart(&weights), rays.bands_apart(&BandWeights::equal(3))), (Some(3), None));
        let picture = rays.picture([3.0, 2.0, 1.0].repeat(rays.cells() as usize), &weights);
        for (pixel, value) in picture.iter().enumerate() {
            assert!((value - weights.combine_at(pixel as u64, &[3.0, 2.0, 1.0])).abs() < 1e-9, "{pixel}: {value}");
        }
    }

    /// The rays of one pixel in a grey scene of 1: the mean of each band is the same, for whichever
    /// core they were drawn.
    #[test]
    fn every_band_keeps_its_energy() {
        let camera = camera(0.1e-3).with_band_wavelengths(WAVELENGTHS_M.to_vec()).unwrap();
        let rays = Rays::new(&camera, 4096, 0);
        for cell in [camera.pixel_count() / 2, camera.pixel_count() + 3] {
            let mut sums = [0.0; 3];
            for sample in 0..4096 {
                let mut bands = [0.0; 3];
                rays.keep_apart(&rays.of_sample(cell, sample), &[1.0], &mut bands);
                sums.iter_mut().zip(bands).for_each(|(sum, band)| *sum += band / 4096.0);
            }
            assert!(sums.iter().all(|sum| (sum - 1.0).abs() < 1e-3), "{cell}: {sums:?}");
        }
    }

    /// A point on the plane at the objects' distance, seen from each point of a tilted sensor
    /// through core and whole pattern.
    #[test]
    fn a_small_tilt_keeps_the_convolution() {
        let film = FilmPlane { shift_m: [0.4e-3, 0.0], tilt: [0.0, 0.045] };
        let camera = camera(0.1e-3).with_film_plane(film);
        let (focal, radius) = (camera.focal_distance_m(), 0.05e-3);
        let number = fresnel_number(&camera, DISTANCE).unwrap();
        let unit = radius * (1.0 + focal / DISTANCE);
        let (_, wings) = Wing::split(&[number], unit);
        let rays = Rays::new(&camera, 1, 0);
        assert!(rays.cells() > camera.pixel_count());
        let chief = |pixel: u64, u: f64, v: f64| film.chief(camera.on_image(pixel, u, v), focal);
        // Near the edge, where the sensor's distance differs most from its mean.
        let (aim, _) = chief(40 * 96 + 85, 0.8, 0.3);
        let seen = |pixel: u64, core_only: bool| {
            let points = 6;
            let density = |step: i32| {
                let within = |step: i32| (f64::from(step) + 0.5) / f64::from(points);
                let (chief, normal) = chief(pixel, within(step % points), within(step / points));
                let point = (aim / aim.z - chief / chief.z) * DISTANCE / (DISTANCE / chief.z + 1.0);
                let to_pinhole = chief + point;
                let densities = wings[0].densities(point.length() / radius * unit);
                let light = if core_only { densities[0] / wings[0].core_share() } else { densities[0] + densities[1] };
                let cos4 = focal * focal * to_pinhole.z * to_pinhole.dot(normal) / to_pinhole.length_squared().powi(2);
                light * cos4 * ((DISTANCE / focal + 1.0) / (DISTANCE / chief.z + 1.0)).powi(2)
            };
            (0..points * points).map(density).sum::<f64>() / f64::from(points * points)
        };
        let pixels = camera.pixel_count();
        let mut values: Vec<f64> = (0..pixels).map(|pixel| seen(pixel, true)).collect();
        values.resize(rays.cells() as usize, 0.0);
        let found = rays.picture(values, &BandWeights::equal(1));
        let expected: Vec<f64> = (0..pixels).map(|pixel| seen(pixel, false)).collect();
        let peak = expected.iter().copied().fold(0.0, f64::max);
        let off = found.iter().zip(&expected).map(|(found, expected)| (found - expected).abs()).fold(0.0, f64::max);
        println!("tilted: off by {} of the peak", off / peak);
        assert!(off < 5e-3 * peak, "off by {} of the peak", off / peak);
    }

    #[test]
    fn cells_around_a_shifted_sensor_are_shifted_with_it() {
        let film = FilmPlane { shift_m: [0.8e-3, -0.3e-3], tilt: [0.0; 2] };
        let (upright, shifted) = (camera(0.1e-3), camera(0.1e-3).with_film_plane(film));
        let slope = |camera: &PinholeCamera, cell: u64| {
            let ray = Rays::new(camera, 1, 0).ray(cell, [0.5, 0.5, 0.3, 0.7]);
            let along = ray.direction.dot(camera.direction());
            [ray.direction.dot(camera.right()) / along, ray.direction.dot(camera.up()) / along]
        };
        for cell in [0, upright.pixel_count() + 5, upright.pixel_count() + 200] {
            let (before, after) = (slope(&upright, cell), slope(&shifted, cell));
            for axis in 0..2 {
                let expected = film.shift_m[axis] / upright.focal_distance_m();
                assert!((after[axis] - before[axis] - expected).abs() < 1e-9, "{cell}: {before:?} {after:?}");
            }
        }
    }
}
