//! The error of cached irradiance, estimated and corrected by independent paths.
//!
//! In some pixels camera rays are traced twice: with cached irradiance, and as independent paths,
//! which are unbiased. The mean D of the differences is an unbiased estimate of the noise and
//! interpolation bias of the cache in a pixel. It consists of batches of independent rays. For two
//! of them, A and B, `E[A·B]` is the squared error of the cache, whatever their noise. The mean of
//! the products of all pairs of batches, a U-statistic (Hoeffding 1948), is known better than that
//! of one pair. The same holds for the error that is left after a correction m that is independent
//! of A and B, such as one made from the surrounding pixels: `E[(A − m)(B − m)]`.
//!
//! A pixel's correction is `w·D + (1 − w)·m`. m is either a mean of D over surrounding pixels or 0,
//! whichever leaves less error there. w minimises the squared error `(1 − w)²·(A − m)(B − m) +
//! w²·Var D`. Both are chosen from the surrounding pixels alone, so the estimate of the error that
//! is left is unbiased (as in Stein's method). Where the cache is good, pixels remain unchanged;
//! where it is not, they become means of independent paths.
//!
//! Errors are relative to the true value of a pixel. Where the cache is wrong, that is not the
//! pixel's value: a pixel that is three halves as bright as the truth has an error of a half, not of
//! a third. So the pixel's value plus D is the unit, with D reduced by its standard error.
//!
//! Rays are allocated where they lower the estimated error or its uncertainty most. Large blocks of
//! pixels are divided into cells; one pixel represents each cell until more are needed.

use crate::view_camera::{ViewCamera, traced_both};
use radsight_adaptive::ray_number;
use radsight_render::Renderer;
use radsight_sampling::RaySampler;
use rayon::prelude::*;
use std::ops::Range;

/// Approximate number of pixels of a block that get the first rays.
const FIRST_PIXELS: usize = 1024;

/// Batches of rays of a pixel, each with its own scramble of the sequence.
const BATCHES: usize = 4;

/// First rays of each batch of a pixel. With fewer, the work often ends at the first look, before a
/// ray has met what is rare.
const FIRST_RAYS: u32 = 8;

/// Radius of the region around a pixel for its statistics, in cells.
const REGION_RADIUS: usize = 3;

/// Radii of the corrections' means, in cells.
const CORRECTION_RADII: [usize; 2] = [1, 3];

/// The means at these radii, and no correction.
const CORRECTIONS: usize = CORRECTION_RADII.len() + 1;

/// Number of standard errors by which the estimate must be below the requested error. Rare bright
/// paths need more than a normal distribution, and work that ends as soon as its estimate is low
/// enough ends where it is too low.
const CERTAINTY_ERRORS: f64 = 2.5;

/// Minimum benefit of a pixel's rays in one round, relative to the largest.
const MIN_BENEFIT: f64 = 0.1;

/// Minimum number of rays of a round, relative to those before it. The work ends as soon as its
/// estimate is low enough, so each further look at the estimate makes it too low on average.
const MIN_GROWTH: f64 = 0.5;

/// The residuals of a block of pixels, in units of the values to which errors are relative.
#[derive(Debug)]
pub(crate) struct Residuals {
    range: Range<usize>,
    columns: usize,
    rows: usize,
    /// Side of a cell, pixels.
    side: usize,
    pixels: Vec<Residual>,
    /// The values of the pixels, to which residuals are relative, in each band.
    units: Vec<[f64; 3]>,
    /// The part of the units that does not depend on the pixel's value, added in squares.
    floors: [f64; 3],
}

/// The residual of one pixel.
#[derive(Clone, Copy, Debug, Default)]
struct Residual {
    /// Sums over the rays of each batch.
    sums: [[f64; 3]; BATCHES],
    /// Rays of each batch.
    rays: u32,
}

/// Number of pairs of batches, counted in both orders.
const PAIRS: f64 = (BATCHES * (BATCHES - 1)) as f64;

impl Residual {
    /// The mean of a band in each batch.
    fn means(&self, band: usize) -> [f64; BATCHES] {
        self.sums.map(|sum| sum[band] / f64::from(self.rays.max(1)))
    }

    /// The mean of all batches.
    fn mean(&self) -> [f64; 3] {
        std::array::from_fn(|band| self.means(band).iter().sum::<f64>() / BATCHES as f64)
    }

    /// The variances of [`Residual::mean`].
    fn variances(&self) -> [f64; 3] {
        std::array::from_fn(|band| {
            let means = self.means(band);
            let mean = means.iter().sum::<f64>() / BATCHES as f64;
            means.iter().map(|batch| (batch - mean).powi(2)).sum::<f64>() / PAIRS
        })
    }

    /// The mean squared error of the bands after a correction, relative to the true value. The
    /// product of two batches is divided by the value that the other two find, which is independent
    /// of it.
    fn error_after(&self, correction: &[f64; 3], floors: &[f64; 3]) -> f64 {
        let products = |band: usize, pair: [f64; 2]| pair.map(|mean| mean - correction[band]).iter().product();
        self.mean_over_splits(floors, products)
    }

    /// The variance of [`Residual::mean`], a mean over the bands, relative to the true value. What
    /// two batches differ by is divided by the value that the other two find: a value with a rare
    /// bright path in it would hide how wrong it is.
    fn noise(&self, floors: &[f64; 3]) -> f64 {
        self.mean_over_splits(floors, |_, [one, other]| (one - other).powi(2) / (2 * BATCHES) as f64)
    }

    /// The square of the pixel's unit relative to that of its true value, a mean over the bands.
    fn scale(&self, floors: &[f64; 3]) -> f64 {
        self.mean_over_splits(floors, |_, _| 1.0)
    }

    /// The mean over the bands and all pairs of batches of a quantity of the means of a pair,
    /// relative to the square of the true value by the other two.
    fn mean_over_splits(&self, floors: &[f64; 3], quantity: impl Fn(usize, [f64; 2]) -> f64) -> f64 {
        let variances = self.variances();
        let of_band = |band: usize| {
            let means = self.means(band);
            let of_pair = |&[first, second, third, fourth]: &[usize; BATCHES]| {
                let residual = 0.5 * (means[third] + means[fourth]);
                // Of all batches, since two that miss a rare path do not know of its variance. The
                // term that correlates with the product is removed.
                let own = (means[first] - residual) * (means[second] - residual);
                let variance = 2.0 * (variances[band] + own / (2.0 * PAIRS)).max(0.0);
                quantity(band, [means[first], means[second]]) * true_value_scale(residual, variance, floors[band])
            };
            SPLITS.iter().map(of_pair).sum::<f64>() / SPLITS.len() as f64
        };
        (of_band(0) + of_band(1) + of_band(2)) / 3.0
    }
}

/// Each pair of batches, and the other two.
const SPLITS: [[usize; BATCHES]; 6] =
    [[0, 1, 2, 3], [0, 2, 1, 3], [0, 3, 1, 2], [1, 2, 0, 3], [1, 3, 0, 2], [2, 3, 0, 1]];

/// The square of a pixel's unit relative to that of its true value t, the pixel's value with its
/// residual. Noise of variance v makes the mean of 1/t² too large by a factor of 1 + 3v/t² (a Taylor
/// series to the second order), so 3v is added to t². `floor` is the part of the squared unit that
/// does not depend on the pixel's value.
fn true_value_scale(residual: f64, variance: f64, floor: f64) -> f64 {
    let value = ((1.0 - floor).sqrt() + residual).max(0.0);
    let square = value * value + floor + 3.0 * variance.min(MAX_VARIANCE);
    1.0 / square.max(MIN_SQUARE)
}

/// Variance up to which the Taylor series holds. Noisier true values count as darker than they are.
const MAX_VARIANCE: f64 = 0.2;

/// The least square of a true value that is distinguished, relative to that of the pixel.
const MIN_SQUARE: f64 = 1e-4;

/// The variance of a mean product of pairs of batches whose mean is `left`, where the mean of all
/// batches has the variance `noise`, both relative to the true value; `scale` is that of
/// [`true_value_scale`]. The second term is `(df/dD)²·Var D` for `f = D²/(1 + D)²`.
fn spread(noise: f64, left: f64, scale: f64) -> f64 {
    2.0 * (BATCHES as f64 / (BATCHES as f64 - 1.0)) * noise * noise + 4.0 * left * noise * scale
}

/// Statistics of the surroundings of a pixel, without the pixel itself.
#[derive(Clone, Copy, Debug, Default)]
struct Surroundings {
    /// The correction with the smallest error, and its index.
    correction: [f64; 3],
    chosen: usize,
    /// The squared error after the correction.
    left: f64,
    /// Variance of the mean of a pixel's batches, if each has one ray.
    of_a_ray: f64,
}

impl Surroundings {
    /// With the correction that leaves the least squared error.
    fn with_least_error(
        corrections: &[[f64; 3]; CORRECTIONS],
        left: [f64; CORRECTIONS],
        of_a_ray: f64,
    ) -> Surroundings {
        let chosen = (0..CORRECTIONS).min_by(|a, b| left[*a].total_cmp(&left[*b])).unwrap_or(0);
        Surroundings { correction: corrections[chosen], chosen, left: left[chosen].max(0.0), of_a_ray }
    }
}

/// A quantity of each pixel, and its sum over the pixels with rays of each cell. Regions of many
/// pixels are summed by cells.
struct CellSums<'c, const N: usize> {
    cells: &'c [Vec<usize>],
    of_pixels: Vec<[f64; N]>,
    sums: Vec<[f64; N]>,
}

impl<'c, const N: usize> CellSums<'c, N> {
    fn new(cells: &'c [Vec<usize>], of_pixels: Vec<[f64; N]>) -> CellSums<'c, N> {
        let sums = cells.iter().map(|cell| sum_of(&of_pixels, cell.iter())).collect();
        CellSums { cells, of_pixels, sums }
    }

    /// The sum over a cell without one of its pixels, and the number of pixels.
    fn of_cell(&self, cell: usize, without: Option<usize>) -> ([f64; N], usize) {
        let Some(own) = without else { return (self.sums[cell], self.cells[cell].len()) };
        let others = || self.cells[cell].iter().filter(|other| **other != own);
        (sum_of(&self.of_pixels, others()), others().count())
    }
}

fn sum_of<'p, const N: usize>(values: &[[f64; N]], pixels: impl Iterator<Item = &'p usize>) -> [f64; N] {
    pixels.fold([0.0; N], |sum, pixel| std::array::from_fn(|index| sum[index] + values[*pixel][index]))
}

/// What the rays of a pixel tell, relative to its true value.
#[derive(Clone, Copy, Debug)]
struct KnownError {
    /// The squared error after each correction.
    left: [f64; CORRECTIONS],
    /// The variance of the pixel's residual.
    noise: f64,
    /// The square of the pixel's unit relative to that of its true value.
    scale: f64,
}

/// The quality of a block with the current corrections.
#[derive(Debug)]
pub(crate) struct Assessment {
    /// Added to each pixel.
    pub(crate) corrections: Vec<[f64; 3]>,
    /// Sum over the pixels of the remaining squared errors, and the variance of that sum.
    pub(crate) squared: f64,
    pub(crate) variance: f64,
    /// Approximate remaining squared error of each pixel.
    pub(crate) of_pixels: Vec<f64>,
    /// Factor of each pixel's other squared errors, which are relative to its value, for the true
    /// value.
    pub(crate) scales: Vec<f64>,
    options: Vec<Benefit>,
    /// Rays of each batch so far.
    rays: f64,
}

/// The benefit of further rays of a pixel.
#[derive(Clone, Copy, Debug)]
struct Benefit {
    pixel: usize,
    /// Reduction of the sum of squared errors, and of its variance.
    squared: f64,
    variance: f64,
    rays: f64,
}

impl Residuals {
    /// The state before the first ray. `units` are the values to which the errors of each pixel are
    /// relative; `floors` is the part of them that is the same for all.
    pub(crate) fn new(range: Range<usize>, columns: usize, units: Vec<[f64; 3]>, floors: [f64; 3]) -> Residuals {
        let rows = range.len() / columns.max(1);
        let side = ((range.len() as f64 / FIRST_PIXELS as f64).sqrt().ceil() as usize).max(1);
        let pixels = vec![Residual::default(); range.len()];
        Residuals { range, columns, rows, side, pixels, units, floors }
    }

    /// One pixel of each cell.
    pub(crate) fn first_pixels(&self) -> Vec<usize> {
        let (across, down) = self.cells();
        let pixel = |cell: usize| {
            let (left, top) = (cell % across * self.side, cell / across * self.side);
            // Steps of the R₂ sequence (Roberts 2018).
            let [x, y] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3].map(|step| (cell as f64 * step).fract());
            let [width, height] = [self.side.min(self.columns - left), self.side.min(self.rows - top)];
            (top + (y * height as f64) as usize) * self.columns + left + (x * width as f64) as usize
        };
        (0..across * down).map(pixel).collect()
    }

    fn cells(&self) -> (usize, usize) {
        (self.columns.div_ceil(self.side), self.rows.div_ceil(self.side))
    }

    fn cell_of(&self, pixel: usize) -> (usize, usize) {
        (pixel % self.columns / self.side, pixel / self.columns / self.side)
    }

    /// Rays so far, of all batches and both techniques.
    pub(crate) fn rays_of(&self, pixel: usize) -> u32 {
        2 * BATCHES as u32 * self.pixels[pixel].rays
    }

    /// Doubles the rays of pixels, or traces their first ones.
    pub(crate) fn trace(&mut self, renderer: &Renderer, camera: &ViewCamera, chosen: &[usize]) {
        let (first, film) = (self.range.start, (camera.columns() * camera.rows()) as u64);
        let (pixels, units) = (&self.pixels, &self.units);
        let sums: Vec<([[f64; 3]; BATCHES], u32)> = chosen
            .par_iter()
            .with_max_len(4)
            .map_init(
                || renderer.worker(),
                |worker, &pixel| {
                    let before = pixels[pixel].rays;
                    let further = if before == 0 { FIRST_RAYS } else { before };
                    let (column, row) = ((first + pixel) % camera.columns(), (first + pixel) / camera.columns());
                    let batch = |batch: usize| {
                        // Each batch has its own scramble of the sequence, different from that of
                        // the film's pixels.
                        let stream = (first + pixel) as u64 + (1 + batch as u64) * film;
                        let mut sum = [0.0; 3];
                        for sample in before..before + further {
                            let index = ray_number(stream, sample);
                            let sampler = RaySampler::new(renderer.plan().seed(), index);
                            let Some(ray) = camera.ray(column, row, &sampler) else { continue };
                            let Some([cached, single]) = traced_both(worker, index, &ray) else { continue };
                            let unit = units[pixel];
                            sum = std::array::from_fn(|band| sum[band] + (single[band] - cached[band]) / unit[band]);
                        }
                        sum
                    };
                    (std::array::from_fn(batch), further)
                },
            )
            .collect();
        for (&pixel, (sums, further)) in chosen.iter().zip(sums) {
            let residual = &mut self.pixels[pixel];
            for (own, further) in residual.sums.iter_mut().zip(sums) {
                *own = std::array::from_fn(|band| own[band] + further[band]);
            }
            residual.rays += further;
        }
    }

    /// The pixels with rays, by cell.
    fn sampled(&self) -> Vec<Vec<usize>> {
        let (across, down) = self.cells();
        let mut cells = vec![Vec::new(); across * down];
        for pixel in (0..self.pixels.len()).filter(|pixel| self.pixels[*pixel].rays > 0) {
            let (column, row) = self.cell_of(pixel);
            cells[row * across + column].push(pixel);
        }
        cells
    }

    /// The weighted mean of a quantity over the pixels with rays around a pixel, without itself, with
    /// weights that fall to zero; 0 if there are none.
    fn around<const N: usize>(&self, quantity: &CellSums<'_, N>, pixel: usize, radius: usize) -> [f64; N] {
        let (across, down) = self.cells();
        let (column, row) = self.cell_of(pixel);
        let (mut sums, mut weights) = ([0.0; N], 0.0);
        for y in row.saturating_sub(radius)..(row + radius + 1).min(down) {
            for x in column.saturating_sub(radius)..(column + radius + 1).min(across) {
                let is_own = (x, y) == (column, row);
                let (sum, count) = quantity.of_cell(y * across + x, is_own.then_some(pixel));
                let weight = ((radius + 1 - x.abs_diff(column)) * (radius + 1 - y.abs_diff(row))) as f64;
                sums = std::array::from_fn(|index| sums[index] + weight * sum[index]);
                weights += weight * count as f64;
            }
        }
        sums.map(|sum| sum / f64::max(weights, f64::MIN_POSITIVE))
    }

    /// The current quality of the block; no pixel gets more than `most` rays.
    pub(crate) fn assess(&self, most: u32) -> Assessment {
        let cells = self.sampled();
        let means = CellSums::new(&cells, self.pixels.iter().map(Residual::mean).collect());
        let corrections = self.of_all(|pixel| {
            let [near, far] = CORRECTION_RADII.map(|radius| self.around(&means, pixel, radius));
            [[0.0; 3], near, far]
        });
        let known = self.of_all(|pixel| {
            let residual = &self.pixels[pixel];
            let unit = self.units[pixel];
            let floors = std::array::from_fn(|band| (self.floors[band] / unit[band]).powi(2).min(1.0));
            KnownError {
                left: corrections[pixel].map(|correction| residual.error_after(&correction, &floors)),
                noise: residual.noise(&floors),
                scale: residual.scale(&floors),
            }
        });
        let statistics = (known.iter().zip(&self.pixels))
            .map(|(known, pixel)| {
                let [none, near, far] = known.left;
                [none, near, far, known.noise * f64::from(pixel.rays)]
            })
            .collect();
        let statistics = CellSums::new(&cells, statistics);
        let around = self.of_all(|pixel| {
            let [none, near, far, of_a_ray] = self.around(&statistics, pixel, REGION_RADIUS);
            Surroundings::with_least_error(&corrections[pixel], [none, near, far], of_a_ray)
        });
        self.conclude(&cells, &around, &known, most)
    }

    /// A value of each pixel of the block.
    fn of_all<T: Send>(&self, of_pixel: impl Fn(usize) -> T + Send + Sync) -> Vec<T> {
        (0..self.pixels.len()).into_par_iter().with_min_len(64).map(of_pixel).collect()
    }

    fn conclude(&self, cells: &[Vec<usize>], around: &[Surroundings], known: &[KnownError], most: u32) -> Assessment {
        let own_weight = |pixel: usize| {
            let noise = around[pixel].of_a_ray / f64::from(self.pixels[pixel].rays.max(1));
            let both = around[pixel].left + noise;
            if self.pixels[pixel].rays == 0 || both <= 0.0 { 0.0 } else { around[pixel].left / both }
        };
        let mut assessment = Assessment {
            corrections: vec![[0.0; 3]; self.pixels.len()],
            squared: 0.0,
            variance: 0.0,
            of_pixels: vec![0.0; self.pixels.len()],
            scales: known.iter().map(|known| known.scale).collect(),
            options: Vec::new(),
            rays: self.pixels.iter().map(|pixel| f64::from(pixel.rays)).sum(),
        };
        let mut found = vec![[0.0; 2]; self.pixels.len()];
        for (pixel, residual) in self.pixels.iter().enumerate() {
            let (Surroundings { correction, .. }, own) = (around[pixel], own_weight(pixel));
            let (mean, unit) = (residual.mean(), self.units[pixel]);
            assessment.corrections[pixel] =
                std::array::from_fn(|band| unit[band] * (own * mean[band] + (1.0 - own) * correction[band]));
            assessment.of_pixels[pixel] = (1.0 - own) * around[pixel].left;
            let KnownError { left, noise, scale } = known[pixel];
            let left = left[around[pixel].chosen];
            let squared = (1.0 - own).powi(2) * left + own * own * noise;
            let spread = (1.0 - own).powi(4) * spread(noise, left.max(0.0), scale) + own.powi(4) * noise * noise;
            found[pixel] = [squared, spread];
        }
        for cell in cells {
            self.add_cell(cell, (around, known, &found), most, &mut assessment);
        }
        // Scales the estimates of single pixels from their surroundings to the estimate of all.
        let sum: f64 = assessment.of_pixels.iter().sum();
        let total = assessment.squared.max(0.0);
        let even = total / self.pixels.len().max(1) as f64;
        assessment.of_pixels.iter_mut().for_each(|left| *left = if sum > 0.0 { *left * (total / sum) } else { even });
        assessment
    }

    /// Adds the pixels of a cell. Those without rays are assumed to be corrected from their
    /// surroundings alone.
    fn add_cell(
        &self,
        cell: &[usize],
        (around, known, found): (&[Surroundings], &[KnownError], &[[f64; 2]]),
        most: u32,
        assessment: &mut Assessment,
    ) {
        let Some(&one) = cell.first() else { return };
        let (column, row) = self.cell_of(one);
        let rows = row * self.side..((row + 1) * self.side).min(self.rows);
        let columns = column * self.side..((column + 1) * self.side).min(self.columns);
        let pixels = rows.flat_map(|y| columns.clone().map(move |x| y * self.columns + x)).collect::<Vec<usize>>();
        let others = (pixels.len() - cell.len()) as f64 / cell.len() as f64;
        for &pixel in cell {
            let [own, spread] = found[pixel];
            let value = own + others * known[pixel].left[around[pixel].chosen];
            assessment.squared += value;
            // Where all pixels have rays, only their noise makes the sum uncertain; where some
            // represent others, so does their difference.
            let difference = (value - assessment.of_pixels[pixel] - others * around[pixel].left).powi(2);
            assessment.variance += if others > 0.0 { difference } else { spread };
        }
        for pixel in pixels {
            let rays = self.pixels[pixel].rays;
            let further = if rays == 0 { FIRST_RAYS } else { rays };
            if (rays + further) * BATCHES as u32 / 2 > most {
                continue;
            }
            let Surroundings { left, of_a_ray, .. } = around[pixel];
            let [now, then] = [rays, rays + further].map(|rays| of_a_ray / f64::from(rays.max(1)));
            let remains = |noise: f64| if left > 0.0 { left * noise / (left + noise) } else { 0.0 };
            let squared = if rays == 0 { left - remains(then) } else { remains(now) - remains(then) };
            let spread = |noise: f64| spread(noise, left, 1.0);
            let variance = if rays == 0 {
                let [before, after] = [cell.len(), cell.len() + 1].map(|count| 1.0 / count as f64);
                (1.0 + others).powi(2) * (cell.len() as f64).powi(2) * (before - after) * (spread(then) + left * left)
            } else {
                (1.0 + others).powi(2) * (spread(now) - spread(then))
            };
            assessment.options.push(Benefit { pixel, squared, variance, rays: f64::from(further) });
        }
    }
}

impl Assessment {
    /// Upper bound of the remaining error: the estimate plus some standard errors.
    pub(crate) fn upper(&self) -> f64 {
        self.squared.max(0.0) + CERTAINTY_ERRORS * self.variance.sqrt()
    }

    /// The pixels to trace further until the bound is at most `allowed`, and at least
    /// [`MIN_GROWTH`] more rays; none if it is already, or if nothing helps.
    pub(crate) fn wanted(&self, allowed: f64) -> Vec<usize> {
        if self.upper() <= allowed {
            return Vec::new();
        }
        let deviation = self.variance.sqrt().max(f64::MIN_POSITIVE);
        let benefit =
            |option: &Benefit| (option.squared + 0.5 * CERTAINTY_ERRORS * option.variance / deviation) / option.rays;
        let mut options: Vec<(f64, &Benefit)> = self.options.iter().map(|option| (benefit(option), option)).collect();
        options.retain(|(benefit, _)| *benefit > 0.0);
        options.sort_by(|(one, _), (two, _)| two.total_cmp(one));
        let least = MIN_BENEFIT * options.first().map_or(0.0, |(benefit, _)| *benefit);
        let (mut squared, mut variance, mut wanted) = (self.squared.max(0.0), self.variance, Vec::new());
        let mut further = 0.0;
        for (benefit, option) in options {
            let is_enough = squared.max(0.0) + CERTAINTY_ERRORS * variance.max(0.0).sqrt() <= allowed;
            if benefit < least || is_enough && further >= MIN_GROWTH * self.rays {
                break;
            }
            further += option.rays;
            squared -= option.squared;
            variance -= option.variance;
            wanted.push(option.pixel);
        }
        wanted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLUMNS: usize = 48;
    const PIXELS: usize = 48 * 36;
    /// Rays of each batch.
    const RAYS: u32 = 8;

    /// Uniform noise of this standard deviation (SplitMix64).
    fn noise(state: &mut u64, deviation: f64) -> f64 {
        *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = *state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z >> 11) as f64 / (1_u64 << 53) as f64 - 0.5) * 12f64.sqrt() * deviation
    }

    /// Residuals of a block with the cache error `truth`, from rays of this standard deviation in
    /// one of `every` pixels.
    fn residuals(seed: u64, truth: &[f64], deviation: f64, every: usize) -> Residuals {
        let mut residuals = Residuals::new(0..PIXELS, COLUMNS, vec![[1.0; 3]; PIXELS], [0.0; 3]);
        let mut state = seed;
        let chosen = if every > 1 { residuals.first_pixels() } else { (0..PIXELS).collect() };
        for pixel in chosen {
            let rays = f64::from(RAYS);
            let sums = std::array::from_fn(|_| [rays * truth[pixel] + rays.sqrt() * noise(&mut state, deviation); 3]);
            residuals.pixels[pixel] = Residual { sums, rays: RAYS };
        }
        residuals
    }

    /// The squared error after correction, relative to the true values: residuals are relative to
    /// pixels of 1.
    fn left(assessment: &Assessment, truth: &[f64]) -> f64 {
        let squared = |(correction, truth): (&[f64; 3], &f64)| ((correction[0] - truth) / (1.0 + truth)).powi(2);
        assessment.corrections.iter().zip(truth).map(squared).sum()
    }

    /// No error, a smooth one, one with an edge, one that differs from all neighbours, and one that is
    /// too bright.
    fn truths() -> [Vec<f64>; 5] {
        let truth = |of: &dyn Fn(usize, usize) -> f64| (0..PIXELS).map(|at| of(at % COLUMNS, at / COLUMNS)).collect();
        [
            truth(&|_, _| 0.0),
            truth(&|x, y| 0.1 * (0.1 * x as f64).sin() + 0.05 * (0.2 * y as f64).cos()),
            truth(&|x, _| if x < 20 { 0.3 } else { 0.0 }),
            truth(&|x, y| if (7 * x + 11 * y) % 13 == 0 { 0.4 } else { 0.0 }),
            truth(&|x, y| if (7 * x + 11 * y) % 13 == 0 { -0.3 } else { 0.0 }),
        ]
    }

    #[test]
    fn the_estimate_of_the_remaining_error_is_unbiased() {
        for (number, truth) in truths().iter().enumerate() {
            for every in [1, 2] {
                let (mut found, mut actual, mut variance) = (0.0, 0.0, 0.0);
                for seed in 0..24 {
                    let assessment = residuals(seed, truth, 0.8, every).assess(1 << 16);
                    found += assessment.squared;
                    actual += left(&assessment, truth);
                    variance += assessment.variance;
                }
                let apart = (found - actual).abs();
                assert!(
                    apart < 3.0 * variance.sqrt() + 0.05 * actual,
                    "{number}, {every}: {found} for {actual} ± {}",
                    variance.sqrt()
                );
            }
        }
    }

    #[test]
    fn rare_bright_rays_do_not_hide_how_wrong_a_pixel_is() {
        const PROBABILITY: f64 = 5e-4;
        const BRIGHTNESS: f64 = 80.0;
        let truth = vec![PROBABILITY * BRIGHTNESS; PIXELS];
        let (mut found, mut actual) = (0.0, 0.0);
        for seed in 0..240 {
            let mut state = 1000 + seed;
            let mut residuals = Residuals::new(0..PIXELS, COLUMNS, vec![[1.0; 3]; PIXELS], [0.0; 3]);
            for pixel in &mut residuals.pixels {
                let mut ray = || {
                    let is_bright = noise(&mut state, 1.0) / 12f64.sqrt() + 0.5 < PROBABILITY;
                    noise(&mut state, 0.8) + if is_bright { BRIGHTNESS } else { 0.0 }
                };
                let sums = std::array::from_fn(|_| [(0..RAYS).map(|_| ray()).sum(); 3]);
                *pixel = Residual { sums, rays: RAYS };
            }
            let assessment = residuals.assess(1 << 16);
            found += assessment.squared;
            actual += left(&assessment, &truth);
        }
        assert!((0.85..1.3).contains(&(found / actual)), "{found} for {actual}");
    }

    #[test]
    fn the_estimate_varies_by_its_variance() {
        for (number, truth) in truths().iter().enumerate() {
            let assessments: Vec<Assessment> =
                (100..148).map(|seed| residuals(seed, truth, 0.8, 1).assess(1 << 16)).collect();
            let mean = |of: &dyn Fn(&Assessment) -> f64| assessments.iter().map(of).sum::<f64>() / 48.0;
            let found = mean(&|assessment| assessment.squared);
            let spread = mean(&|assessment| (assessment.squared - found).powi(2)).sqrt();
            let expected = mean(&|assessment| assessment.variance).sqrt();
            assert!((0.7..1.4).contains(&(spread / expected)), "{number}: {spread} for {expected}");
        }
    }

    #[test]
    fn means_around_a_pixel_exclude_it_and_pixels_without_rays() {
        let mut residuals = residuals(2, &vec![0.0; PIXELS], 0.8, 2);
        let pixel = 20 * COLUMNS + 21;
        residuals.pixels[pixel].rays = RAYS;
        let cells = residuals.sampled();
        let values: Vec<[f64; 1]> = (0..PIXELS).map(|index| [(7 * index % 11) as f64]).collect();
        let ([column, row], radius) = (<[usize; 2]>::from(residuals.cell_of(pixel)), 3);
        let (mut sum, mut weights) = (0.0, 0.0);
        for other in (0..PIXELS).filter(|other| *other != pixel && residuals.pixels[*other].rays > 0) {
            let (x, y) = residuals.cell_of(other);
            let weight = (4_usize.saturating_sub(x.abs_diff(column)) * 4_usize.saturating_sub(y.abs_diff(row))) as f64;
            sum += weight * values[other][0];
            weights += weight;
        }
        let [mean] = residuals.around(&CellSums::new(&cells, values), pixel, radius);
        assert!((mean - sum / weights).abs() < 1e-12, "{mean}, not {}", sum / weights);
    }

    #[test]
    fn smooth_errors_of_the_cache_are_corrected() {
        let [none, smooth, ..] = truths();
        let uncorrected: f64 = smooth.iter().map(|truth| (truth / (1.0 + truth)).powi(2)).sum();
        let corrected = left(&residuals(1, &smooth, 0.8, 1).assess(1 << 16), &smooth);
        assert!(corrected < 0.5 * uncorrected, "{corrected} of {uncorrected}");
        let alone = PIXELS as f64 * 0.8 * 0.8 / f64::from(BATCHES as u32 * RAYS);
        let made = left(&residuals(1, &none, 0.8, 1).assess(1 << 16), &none);
        assert!(made < 0.05 * alone, "{made}, where pixels alone would have {alone}");
    }

    #[test]
    fn rays_are_allocated_where_the_cache_is_wrong() {
        let [_, _, edge, ..] = truths();
        // The cache is too bright there.
        let edge: Vec<f64> = edge.iter().map(|truth| -truth).collect();
        let assessment = residuals(3, &edge, 0.8, 1).assess(1 << 16);
        assert!(assessment.wanted(1e9).is_empty());
        let wanted = assessment.wanted(assessment.upper() - 1.0);
        let wrong = wanted.iter().filter(|pixel| **pixel % COLUMNS < 24).count();
        assert!(!wanted.is_empty() && 2 * wrong > wanted.len(), "{wrong} of {}", wanted.len());
        assert!(residuals(3, &edge, 0.8, 1).assess(RAYS).wanted(0.0).is_empty());
    }
}
