//! The paper's own method: whole pictures from several points of the pinhole, shifted by whole
//! pixels and averaged.
//!
//! Section 3.2 of the paper, its pseudocode and Eq. 9. A sensor pixel with the image point x
//! (upright, one focal distance in front of the pinhole) looks through a pinhole point o along (x +
//! o, f). A picture with the eye at o, its window centred on its own axis, shows that direction at
//! x + o. So if o is a whole number of pixel pitches, the picture aligns with the sensor after a
//! shift by whole pixels, for objects at any distance. The pinhole is covered by a lattice of such
//! points; the weight of each is the fraction of the pinhole's area in its cell of the lattice.
//!
//! Eq. 7 remains as an approximation: cos⁴θ is evaluated at the centres of pixel and pinhole, and
//! the pinhole is sampled at lattice points.

use crate::{BandWeights, BandWeightsError, PinholeCamera, View};

/// One point of the pinhole.
#[derive(Clone, Debug, PartialEq)]
pub struct ShiftSample {
    /// The point, in whole pixels right of and above the pinhole's centre.
    pub offset_pixels: [i32; 2],
    /// The point, metres right of and above the pinhole's centre.
    pub offset_m: [f64; 2],
    /// The fraction of the pinhole's area that it represents; all add up to 1.
    pub weight: f64,
}

/// An error in the pictures given.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShiftError {
    /// The lattice would have too many points.
    #[error(
        "a pattern every {step} pixel(s) has more than {MAX_POSITIONS} points over the pinhole: take a larger step"
    )]
    TooManyPositions {
        /// Pixels between points.
        step: u32,
    },
    /// A picture of the wrong size.
    #[error("picture {index} has {found_columns} x {found_rows} pixels, expected {columns} x {rows}")]
    Size {
        /// Index of the picture, from 0.
        index: usize,
        /// Its columns.
        found_columns: u32,
        /// Its rows.
        found_rows: u32,
        /// The columns of [`ShiftPattern::view`].
        columns: u32,
        /// The rows of [`ShiftPattern::view`].
        rows: u32,
    },
    /// The number of values differs from the picture's size.
    #[error("picture {index} has {found} values, expected {expected}")]
    Values {
        /// Index of the picture, from 0.
        index: usize,
        /// Values found.
        found: usize,
        /// Columns × rows × bands.
        expected: usize,
    },
    /// The number of pictures differs from the number of points.
    #[error("{found} picture(s), expected {expected}: one for each pinhole position")]
    Count {
        /// Pictures found.
        found: usize,
        /// Points of the pattern.
        expected: usize,
    },
    /// The number of weights differs from the number of bands.
    #[error(transparent)]
    Bands(#[from] BandWeightsError),
}

/// A picture of radiances, W/(sr·m²): scanlines from the top, pixels from the left, bands
/// interleaved.
#[derive(Clone, Copy, Debug)]
pub struct RadiancePicture<'a> {
    /// Columns.
    pub columns: u32,
    /// Rows.
    pub rows: u32,
    /// Values per pixel.
    pub bands: usize,
    /// All values.
    pub values: &'a [f32],
}

/// Maximum number of points of a pattern.
const MAX_POSITIONS: i64 = 100_000;

/// The pattern of points over the pinhole.
#[derive(Clone, Debug, PartialEq)]
pub struct ShiftPattern {
    samples: Vec<ShiftSample>,
    margin: [u32; 2],
}

impl ShiftPattern {
    /// A lattice with a point every `step` pixels (at least 1) in both directions, one at the
    /// pinhole's centre. Points whose cell misses the pinhole are omitted; a point whose cell
    /// intersects the rim may itself lie just outside.
    ///
    /// # Errors
    /// If there would be too many points.
    pub fn new(camera: &PinholeCamera, step: u32) -> Result<Self, ShiftError> {
        let step = i64::from(step.clamp(1, i32::MAX as u32 / 2));
        let radius = 0.5 * camera.pinhole_diameter_m();
        let cell = camera.pixel_pitch_m().map(|pitch| pitch * step as f64);
        // The cell of point k reaches from (k − ½) to (k + ½) cells.
        let reach = cell.map(|cell| (radius / cell + 0.5).ceil().min(1e6) as i64);
        if (2 * reach[0] + 1) * (2 * reach[1] + 1) > MAX_POSITIONS {
            return Err(ShiftError::TooManyPositions { step: step as u32 });
        }
        let mut samples = Vec::new();
        let mut margin = [0, 0];
        for row in (-reach[1]..=reach[1]).rev() {
            for column in -reach[0]..=reach[0] {
                let offset_m = [column as f64 * cell[0], row as f64 * cell[1]];
                let area = disk_in_rectangle(radius, offset_m, cell);
                if area <= 1e-12 * camera.pinhole_area_m2() {
                    continue;
                }
                let offset_pixels = [(column * step) as i32, (row * step) as i32];
                margin = [0, 1].map(|axis| margin[axis].max(offset_pixels[axis].unsigned_abs()));
                samples.push(ShiftSample { offset_pixels, offset_m, weight: area / camera.pinhole_area_m2() });
            }
        }
        Ok(ShiftPattern { samples, margin })
    }

    /// The points, rows from the top of the pinhole, left to right.
    #[must_use]
    pub fn samples(&self) -> &[ShiftSample] {
        &self.samples
    }

    /// Margin of each picture beyond the sensor on each side (columns, rows), so that no shift
    /// leaves it.
    #[must_use]
    pub fn margin(&self) -> [u32; 2] {
        self.margin
    }

    /// The view of a point's picture. All pictures have the same size.
    #[must_use]
    pub fn view(&self, camera: &PinholeCamera, sample: &ShiftSample) -> View {
        View::through_pinhole(camera, sample.offset_m, self.margin)
    }
}

/// The weighted sum of shifted pictures, one picture at a time in the order of the pattern's
/// points.
#[derive(Debug)]
pub struct ShiftAverage<'a> {
    camera: &'a PinholeCamera,
    pattern: &'a ShiftPattern,
    weights: BandWeights,
    sum: Vec<f64>,
    pictures: usize,
}

impl<'a> ShiftAverage<'a> {
    /// Starts with no picture.
    #[must_use]
    pub fn new(camera: &'a PinholeCamera, pattern: &'a ShiftPattern, weights: &BandWeights) -> Self {
        let pixels = usize::try_from(camera.pixel_count()).expect("a camera has at most 2^28 pixels");
        ShiftAverage { camera, pattern, weights: weights.clone(), sum: vec![0.0; pixels], pictures: 0 }
    }

    /// Adds the picture of the next point.
    ///
    /// # Errors
    /// If the picture has the wrong size or number of bands, or there are more pictures than
    /// points.
    pub fn add(&mut self, picture: &RadiancePicture<'_>) -> Result<(), ShiftError> {
        let index = self.pictures;
        let samples = self.pattern.samples();
        let sample = samples.get(index).ok_or(ShiftError::Count { found: index + 1, expected: samples.len() })?.clone();
        self.check(picture, index)?;
        let weights = self.weights.for_bands(picture.bands)?;
        let mut bands = vec![0.0; picture.bands];
        let (columns, [margin_x, margin_y]) = (self.camera.columns(), self.pattern.margin.map(i64::from));
        for (pixel, sum) in self.sum.iter_mut().enumerate() {
            let (column, row) = (pixel as i64 % i64::from(columns), pixel as i64 / i64::from(columns));
            // Image point x is at x + o in the picture; rows count downwards.
            let column = column + margin_x + i64::from(sample.offset_pixels[0]);
            let row = row + margin_y - i64::from(sample.offset_pixels[1]);
            let at = (row * i64::from(picture.columns) + column) as usize * picture.bands;
            for (band, &value) in bands.iter_mut().zip(&picture.values[at..]) {
                *band = f64::from(value);
            }
            *sum += sample.weight * weights.combine_at(pixel as u64, &bands);
        }
        self.pictures += 1;
        Ok(())
    }

    /// The exposure of each pixel in J/m², Eq. 9: `E = I_ave cos⁴θ π d² τ / 4 f²`, θ at the centres
    /// of pixel and pinhole.
    ///
    /// # Errors
    /// If pictures are missing.
    pub fn finish(self) -> Result<Vec<f64>, ShiftError> {
        let expected = self.pattern.samples().len();
        if self.pictures != expected {
            return Err(ShiftError::Count { found: self.pictures, expected });
        }
        let scale = self.camera.exposure_per_radiance();
        let exposure = |(pixel, average): (usize, &f64)| average * self.camera.central_cos4(pixel as u64) * scale;
        Ok(self.sum.iter().enumerate().map(exposure).collect())
    }

    fn check(&self, picture: &RadiancePicture<'_>, index: usize) -> Result<(), ShiftError> {
        let [margin_x, margin_y] = self.pattern.margin;
        let (columns, rows) = (self.camera.columns() + 2 * margin_x, self.camera.rows() + 2 * margin_y);
        if (picture.columns, picture.rows) != (columns, rows) {
            let (found_columns, found_rows) = (picture.columns, picture.rows);
            return Err(ShiftError::Size { index, found_columns, found_rows, columns, rows });
        }
        let expected = columns as usize * rows as usize * picture.bands;
        if picture.bands == 0 || picture.values.len() != expected {
            return Err(ShiftError::Values { index, found: picture.values.len(), expected });
        }
        Ok(())
    }
}

/// Exact area of the intersection of a rectangle and a disk about the origin.
fn disk_in_rectangle(radius: f64, centre: [f64; 2], size: [f64; 2]) -> f64 {
    let [left, right] = [-0.5, 0.5].map(|half| (centre[0] + half * size[0]).clamp(-radius, radius));
    let [bottom, top] = [-0.5, 0.5].map(|half| (centre[1] + half * size[1]).clamp(-radius, radius));
    (disk_below(radius, left, right, top) - disk_below(radius, left, right, bottom)).max(0.0)
}

/// Area of the part of the disk with x in `[left, right]` and y below `y`; all three are at most
/// the radius.
fn disk_below(radius: f64, left: f64, right: f64, y: f64) -> f64 {
    // The line at height y is inside the circle for |x| < reach.
    let reach = (radius * radius - y * y).max(0.0).sqrt();
    let half_area =
        |from: f64, to: f64| if to > from { circle_integral(radius, to) - circle_integral(radius, from) } else { 0.0 };
    let within = [left.clamp(-reach, reach), right.clamp(-reach, reach)];
    let cut = half_area(within[0], within[1]) + y * (within[1] - within[0]);
    let beside = half_area(left, within[0].min(right).max(left)) + half_area(within[1].max(left), right);
    if y > 0.0 { cut + 2.0 * beside } else { cut }
}

/// ∫ √(r² − x²) dx from 0 to `x`.
fn circle_integral(radius: f64, x: f64) -> f64 {
    0.5 * (x * (radius * radius - x * x).max(0.0).sqrt() + radius * radius * (x / radius).clamp(-1.0, 1.0).asin())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::tests::{paper_camera, paper_description};
    use crate::{CameraDescription, PixelAverage, Rays};

    #[test]
    fn the_area_of_a_disk_in_a_rectangle_agrees_with_counting() {
        for (centre, size) in [
            ([0.3, 0.2], [0.5, 0.7]),
            ([0.9, 0.1], [0.6, 3.0]),
            ([-0.8, -0.7], [0.5, 0.5]),
            ([0.0, 0.0], [5.0, 0.4]),
            ([0.0, 0.95], [0.3, 0.3]),
            ([2.0, 0.0], [0.5, 0.5]),
        ] {
            let n = 2000;
            let mut inside = 0;
            for i in 0..n * n {
                let x = centre[0] + size[0] * ((f64::from(i % n) + 0.5) / f64::from(n) - 0.5);
                let y = centre[1] + size[1] * ((f64::from(i / n) + 0.5) / f64::from(n) - 0.5);
                inside += i32::from(x * x + y * y < 1.0);
            }
            let counted = f64::from(inside) / f64::from(n * n) * size[0] * size[1];
            let exact = disk_in_rectangle(1.0, centre, size);
            assert!(
                (exact - counted).abs() < 1e-3 * (counted + 0.01),
                "{centre:?} {size:?}: {exact} against {counted}"
            );
        }
    }

    #[test]
    fn weights_add_up_to_1_and_keep_the_second_moment_of_the_disk() {
        let camera = paper_camera();
        for (step, tolerance) in [(1, 0.05), (2, 0.12)] {
            let pattern = ShiftPattern::new(&camera, step).unwrap();
            let sum: f64 = pattern.samples().iter().map(|sample| sample.weight).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{sum}");
            for axis in 0..2 {
                let moments = |power: i32| -> f64 {
                    pattern.samples().iter().map(|s| s.weight * s.offset_m[axis].powi(power)).sum()
                };
                let expected = (0.05e-3f64).powi(2) / 4.0;
                assert!(moments(1).abs() < 1e-18);
                assert!((moments(2) / expected - 1.0).abs() < tolerance, "step {step}: {}", moments(2) / expected);
            }
        }
    }

    #[test]
    fn a_hole_smaller_than_a_pixel_has_one_point() {
        let description = CameraDescription { pinhole_diameter_m: 5e-6, ..paper_description() };
        let pattern = ShiftPattern::new(&PinholeCamera::new(&description).unwrap(), 1).unwrap();
        assert_eq!(pattern.samples().len(), 1);
        assert!((pattern.samples()[0].weight - 1.0).abs() < 1e-15);
        assert_eq!(pattern.margin(), [0, 0]);
    }

    #[test]
    fn a_hole_of_a_million_pixels_is_refused() {
        let description = CameraDescription { pinhole_diameter_m: 1e9, ..paper_description() };
        let error = ShiftPattern::new(&PinholeCamera::new(&description).unwrap(), 1).unwrap_err();
        assert!(error.to_string().contains("take a larger step"), "{error}");
    }

    /// A sheet with a smooth pattern, with the exact average and with shifted pictures.
    #[test]
    fn shifted_pictures_agree_with_the_exact_average() {
        let camera = PinholeCamera::new(&CameraDescription { pixels: [24, 16], ..paper_description() }).unwrap();
        let sheet = |x: f64, y: f64| 1.0 + 0.5 * (x * 300.0).sin() * (y * 250.0 + 0.3).cos();
        let pattern = ShiftPattern::new(&camera, 1).unwrap();
        let mut average = ShiftAverage::new(&camera, &pattern, &BandWeights::equal(1));
        for sample in pattern.samples() {
            let view = pattern.view(&camera, sample);
            let mut values = Vec::new();
            for row in 0..view.pixels[1] {
                for column in 0..view.pixels[0] {
                    // The mean over a pixel, as in the filtered picture of the pseudocode.
                    let mut mean = 0.0;
                    for k in 0..16u32 {
                        let (u, v) = ((f64::from(k % 4) + 0.5) / 4.0, (f64::from(k / 4) + 0.5) / 4.0);
                        let x = (f64::from(column) + u - f64::from(view.pixels[0]) / 2.0) * 13.75e-6 / 6.75e-3 * 0.48;
                        let y = (f64::from(view.pixels[1]) / 2.0 - f64::from(row) - v) * 16e-6 / 6.75e-3 * 0.48;
                        mean += sheet(view.position.x + x, view.position.y + y) / 16.0;
                    }
                    values.push(mean as f32);
                }
            }
            let [columns, rows] = view.pixels;
            average.add(&RadiancePicture { columns, rows, bands: 1, values: &values }).unwrap();
        }
        let shifted = average.finish().unwrap();

        let rays = Rays::new(&camera, 1024, 0);
        let mut worst: f64 = 0.0;
        let mut contrast: f64 = 0.0;
        for (pixel, shifted) in (0..camera.pixel_count()).zip(shifted) {
            let mut exact = PixelAverage::default();
            for sample in 0..1024 {
                let ray = rays.of_sample(pixel, sample);
                let hit = ray.origin + ray.direction * (ray.origin.z / -ray.direction.z);
                exact.add(ray.cos4, sheet(hit.x, hit.y));
            }
            let exact = exact.exposure(&camera);
            worst = worst.max((shifted / exact - 1.0).abs());
            contrast = contrast.max((exact / camera.exposure_per_radiance() - 1.0).abs());
        }
        assert!(contrast > 0.05, "the pattern must still show: {contrast}");
        assert!(worst < 0.01, "worst pixel is off by {worst}");
    }

    #[test]
    fn wrong_pictures_are_named() {
        let camera = paper_camera();
        let pattern = ShiftPattern::new(&camera, 4).unwrap();
        let weights = BandWeights::equal(1);
        let mut average = ShiftAverage::new(&camera, &pattern, &weights);
        let error =
            average.add(&RadiancePicture { columns: 192, rows: 165, bands: 1, values: &[] }).unwrap_err().to_string();
        assert!(error.starts_with("picture 0 has 192 x 165 pixels, expected 200 x 17"), "{error}");
        assert!(matches!(average.finish(), Err(ShiftError::Count { found: 0, .. })));
    }
}
