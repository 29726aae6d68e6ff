//! An adaptive filter that widens for outliers: each input pixel is spread over enough output
//! pixels that it contributes at most a given fraction to any. This removes single bright pixels
//! (fireflies).

use super::box_filter::put_box;
use super::gaussian::{DISK, Gaussian, REACH};
use super::{Bar, Resampling};
use crate::brightness::Brightness;

/// Largest filter radius, in radii.
const WIDEST: f64 = 5.0;
/// Tolerance of the fraction.
const FRACTION_TOLERANCE: f64 = 0.2;
/// Interval of the radius factor at which the search ends.
const MULTIPLE_TOLERANCE: f64 = 0.1;
/// Smaller values are zero.
const TINY: f64 = 1e-6;

#[derive(Debug)]
pub(super) struct Threshold {
    gaussian: Gaussian,
    fraction: f64,
    brightness: Brightness,
    components: usize,
    /// Output pixels on either side that an input pixel may reach.
    reach: usize,
    /// Output rows being accumulated, and the brightness of their boxes: ring buffers of `2 reach +
    /// 1` rows.
    sums: Vec<Vec<f32>>,
    grey: Vec<Vec<f32>>,
    next_row: usize,
    /// Sum and number of boxes around an output pixel, by truncated distance.
    ring_sums: Vec<f32>,
    ring_counts: Vec<i16>,
    weights: Vec<f32>,
}

impl Threshold {
    pub(super) fn new(
        radius: f64,
        fraction: f64,
        resampling: &Resampling,
        brightness: Brightness,
        components: usize,
    ) -> Threshold {
        let reach = (REACH * WIDEST * radius + 1.0) as usize;
        let reach = reach.min(resampling.rows.max(resampling.columns));
        Threshold {
            gaussian: Gaussian::new(radius, resampling).normalized(resampling),
            fraction,
            brightness,
            components,
            reach,
            sums: Vec::new(),
            grey: Vec::new(),
            next_row: 0,
            ring_sums: vec![0.0; reach + 1],
            ring_counts: vec![0; reach + 1],
            weights: Vec::new(),
        }
    }

    /// Input rows needed on either side of the central one for rows ahead.
    pub(super) fn reach(&self, resampling: &Resampling) -> usize {
        ((self.reach + 1) as f64 / resampling.y_scale) as usize + 1
    }

    /// Adds the input pixels in an output row's boxes. Returns the row that is complete, if any.
    pub(super) fn put(&mut self, row: usize, resampling: &Resampling, bar: &Bar) -> Option<&[f32]> {
        self.prepare(row, resampling, bar);
        for column in 0..resampling.columns {
            self.sum_rings(row, column, resampling);
            for y in resampling.box_rows(row) {
                let scanline = bar.row(y);
                for x in resampling.inside(resampling.box_columns(column)) {
                    let pixel = &scanline[resampling.wrapped(x) * self.components..][..self.components];
                    let multiple = self.multiple(self.brightness.of(pixel));
                    self.splat(pixel, [x, y as isize], [column, row], multiple, resampling);
                }
            }
        }
        let done = row.checked_sub(self.reach)?;
        Some(self.row(done))
    }

    /// The rows not written yet when the last one has been added.
    pub(super) fn held(&self, resampling: &Resampling) -> std::ops::Range<usize> {
        resampling.rows.saturating_sub(self.reach)..resampling.rows
    }

    pub(super) fn row(&self, row: usize) -> &[f32] {
        &self.sums[row % self.ring()]
    }

    fn ring(&self) -> usize {
        2 * self.reach + 1
    }

    /// Averages the boxes of the rows that come within reach, and starts these rows.
    fn prepare(&mut self, row: usize, resampling: &Resampling, bar: &Bar) {
        let mut mean = vec![0.0; self.components];
        while self.next_row <= row + self.reach && self.next_row < resampling.rows {
            let index = self.next_row % self.ring();
            if index == self.sums.len() {
                self.sums.push(vec![0.0; resampling.columns * self.components]);
                self.grey.push(vec![0.0; resampling.columns]);
            }
            for column in 0..resampling.columns {
                put_box::<0>(self.next_row, column, resampling, bar, &mut mean);
                self.grey[index][column] = self.brightness.of(&mean) as f32;
            }
            self.sums[index].fill(0.0);
            self.next_row += 1;
        }
    }

    fn sum_rings(&mut self, row: usize, column: usize, resampling: &Resampling) {
        self.ring_sums.fill(0.0);
        self.ring_counts.fill(0);
        let reach = self.reach as isize;
        for r in -reach..=reach {
            let Some(y) = row.checked_add_signed(r).filter(|y| *y < resampling.rows) else { continue };
            let grey = &self.grey[y % (2 * self.reach + 1)];
            for c in -reach..=reach {
                let squared = c * c + r * r;
                let Some(x) = resampling.output_column(column as isize + c) else { continue };
                if squared > reach * reach {
                    continue;
                }
                let ring = (squared as f64).sqrt() as usize;
                self.ring_sums[ring] += grey[x];
                self.ring_counts[ring] += 1;
            }
        }
    }

    /// The factor by which the filter must widen for a pixel of this brightness. The search is
    /// Radiance's, since its steps determine the result.
    fn multiple(&self, brightness: f64) -> f64 {
        let (radius, middle) = (self.gaussian.radius, f64::from(self.gaussian.middle()));
        let mut bounds = [1.0, self.reach as f64 / radius / REACH];
        let mut multiple = 1.0f64;
        for _ in 0..(4.0 / FRACTION_TOLERANCE) as usize {
            let Some(average) = self.average(multiple) else { return 1.0 };
            let denominator = multiple * multiple / middle - brightness / average;
            if denominator <= TINY {
                if multiple >= bounds[1] - MULTIPLE_TOLERANCE {
                    break;
                }
                multiple = bounds[1];
                continue;
            }
            let excess = (brightness / average - 1.0).abs();
            let found = excess / denominator;
            let near = (self.fraction - found).abs() / self.fraction <= FRACTION_TOLERANCE;
            let at_bound = if found <= self.fraction {
                multiple <= bounds[0] + MULTIPLE_TOLERANCE
            } else {
                multiple >= bounds[1] - MULTIPLE_TOLERANCE
            };
            if at_bound || near {
                break;
            }
            let before = multiple;
            multiple = (middle * (excess / self.fraction + brightness / average)).sqrt();
            if multiple < before {
                if multiple <= bounds[0] + TINY {
                    multiple = 0.5 * (bounds[0] + before);
                }
                bounds[1] = before;
            } else {
                if multiple >= bounds[1] - TINY {
                    multiple = 0.5 * (bounds[1] + before);
                }
                bounds[0] = before;
            }
        }
        multiple
    }

    /// The mean brightness of the neighbourhood under a filter widened by `multiple`; `None` for
    /// black.
    fn average(&self, multiple: f64) -> Option<f64> {
        let rings = ((DISK * REACH * self.gaussian.radius * multiple + 0.5) as usize).min(self.reach);
        let (mut sum, mut count) = (0.0, 0.0);
        for ring in (0..rings).rev() {
            let distance = (ring as f64 + 0.5) / (multiple * self.gaussian.radius);
            let weight = f64::from(self.gaussian.weight(distance * distance));
            sum += weight * f64::from(self.ring_sums[ring]);
            count += weight * f64::from(self.ring_counts[ring]);
        }
        (sum >= 1e-20).then(|| sum / count)
    }

    /// Adds an input pixel to the output pixels around it.
    fn splat(
        &mut self,
        pixel: &[f32],
        [x, y]: [isize; 2],
        [column, row]: [usize; 2],
        multiple: f64,
        resampling: &Resampling,
    ) {
        let radius = multiple * self.gaussian.radius;
        let size = ((REACH * radius + 1.0) as usize).min(self.reach) as isize;
        let (px, py) = (resampling.x_scale * (x as f64 + 0.5), resampling.y_scale * (y as f64 + 0.5));
        let rows = (row as isize - size).max(0)..(row as isize + size + 1).min(resampling.rows as isize);
        let columns = column as isize - size..column as isize + size + 1;
        let mut total = 0.0;
        self.weights.clear();
        for r in rows.clone() {
            let dy = (py - (r as f64 + 0.5)) / radius;
            for c in columns.clone().filter(|c| resampling.output_column(*c).is_some()) {
                let dx = (px - (c as f64 + 0.5)) / radius;
                let weight = self.gaussian.weight(dx * dx + dy * dy);
                total += f64::from(weight);
                self.weights.push(weight);
            }
        }
        let scale = 1.0 / total * resampling.x_scale.min(1.0) * resampling.y_scale.min(1.0);
        let mut weights = self.weights.iter();
        let ring = 2 * self.reach + 1;
        for r in rows {
            let sums = &mut self.sums[r as usize % ring];
            for column in columns.clone().filter_map(|c| resampling.output_column(c)) {
                let Some(weight) = weights.next() else { return };
                let weight = (scale * f64::from(*weight)) as f32;
                let sums = &mut sums[column * self.components..][..self.components];
                sums.iter_mut().zip(pixel).for_each(|(sum, value)| *sum += value * weight);
            }
        }
    }
}
