//! Which cells of an interpolated picture are smooth, and which of its first samples are noisy.

use crate::grid::{Cell, Pixel, numbered};
use crate::interpolated::{Block, NOISE_REDUCTION, PROBES};
use crate::pixel_sample::{Sample, Surface};
use radsight_sampling::RaySampler;

/// Samples on the coarsest grid that differ from the mean of those on both sides by less than this
/// fraction of the allowed contrast are not noisy.
const SMOOTH_DIFFERENCE: f64 = 0.25;

/// Where the steps along a side of a cell and beside it differ by less than this fraction of the
/// allowed contrast, light changes linearly. Then larger steps are interpolated too, up to so many
/// times the allowed contrast.
const LINEAR_DIFFERENCE: f64 = 0.5;
const LARGEST_STEP: f64 = 4.0;

/// Number of rings of glossy cells around a noisy one that are divided with it.
const HIGHLIGHT_RINGS: u32 = 2;

/// Number of standard errors by which two samples may differ by chance.
const CHANCE_ERRORS: f64 = 2.0;

impl Block<'_> {
    /// Whether all pixels of a cell can be interpolated from its corners.
    pub(crate) fn is_smooth(&self, cell: &Cell) -> bool {
        let corners = cell.corners().map(|corner| self.sampled(corner));
        let [Some(first), Some(second), Some(third), Some(fourth)] = corners else { return false };
        let corners = [first, second, third, fourth];
        let mut agree = true;
        for (index, one) in corners.iter().enumerate() {
            for other in &corners[index + 1..] {
                if !one.surface.joins(&other.surface) {
                    return false;
                }
                agree = agree && self.agree(one, other);
            }
        }
        if !agree && !self.is_linear(cell) {
            return false;
        }
        if self.may_show_glint(&corners) {
            return false;
        }
        self.probes(cell).all(|pixel| self.probe(pixel, &first.surface))
    }

    /// Whether two samples differ by no more than the allowed contrast, or than moderate noise.
    pub(crate) fn agree(&self, one: &Sample, other: &Sample) -> bool {
        let chance = CHANCE_ERRORS * (one.variance + other.variance).sqrt();
        (0..3).all(|band| {
            let [a, b] = [one, other].map(|sample| sample.value[band]);
            let allowed = self.allowed_difference(a, b);
            (a - b).abs() <= allowed + chance.min(NOISE_REDUCTION * allowed) + self.darkness
        })
    }

    /// Whether light changes linearly along each side of a cell and beyond its ends.
    fn is_linear(&self, cell: &Cell) -> bool {
        let [left, right, top, bottom] = [cell.left, cell.right, cell.top, cell.bottom];
        let [across, down] = [right - left, bottom - top];
        let in_row = |row: usize| {
            let at = |column: Option<usize>| Some((column.filter(|column| *column < self.camera.columns())?, row));
            self.is_linear_step([(left, row), (right, row)], [at(left.checked_sub(across)), at(Some(right + across))])
        };
        let in_column = |column: usize| {
            let at = |row: Option<usize>| Some((column, row.filter(|row| *row < self.rows)?));
            let ends = [at(top.checked_sub(down)), at(Some(bottom + down))];
            self.is_linear_step([(column, top), (column, bottom)], ends)
        };
        in_row(top) && in_row(bottom) && in_column(left) && in_column(right)
    }

    /// Whether the step between two samples is like those before and after it. One of them may be
    /// missing, as at the edge of a surface.
    fn is_linear_step(&self, ends: [Pixel; 2], beyond: [Option<Pixel>; 2]) -> bool {
        let [Some(first), Some(last)] = ends.map(|pixel| self.sampled(pixel)) else { return false };
        let [before, after] = beyond.map(|pixel| self.joined(first, pixel?));
        if before.is_none() && after.is_none() {
            return false;
        }
        (0..3).all(|band| {
            let [a, b] = [first, last].map(|sample| sample.value[band]);
            let (step, allowed) = (b - a, self.allowed_difference(a, b));
            let is_like = |other: f64| (step - other).abs() <= LINEAR_DIFFERENCE * allowed + self.darkness;
            step.abs() <= LARGEST_STEP * allowed + self.darkness
                && before.is_none_or(|before| is_like(a - before.value[band]))
                && after.is_none_or(|after| is_like(after.value[band] - b))
        })
    }

    /// The allowed contrast of two values, times their mean.
    pub(crate) fn allowed_difference(&self, a: f64, b: f64) -> f64 {
        0.5 * self.interpolation.contrast * (a + b)
    }

    /// Pixels of a cell in which a probe ray looks for other surfaces.
    fn probes(&self, cell: &Cell) -> impl Iterator<Item = (usize, usize)> + use<> {
        let quarters = |first: usize, last: usize| {
            let size = last - first;
            let (places, count) =
                if size >= 4 { ([first + size / 4, last - size / 4], 2) } else { ([first + size / 2; 2], 1) };
            places.into_iter().take(count)
        };
        let columns = quarters(cell.left, cell.right);
        quarters(cell.top, cell.bottom).flat_map(move |row| columns.clone().map(move |column| (column, row)))
    }

    /// Whether a pixel sees the surface of a corner first, or nothing but drawn lights.
    fn probe(&self, (column, row): (usize, usize), corner: &Surface) -> bool {
        let row = row + self.first_row;
        let ray = if self.camera.is_blurred() {
            let sampler = RaySampler::new(self.renderer.plan().seed(), numbered([column, row], (1, 1), 1, 0) | PROBES);
            self.lights.ray_beside(self.camera, column, row, &sampler)
        } else {
            self.lights.central_ray_beside(self.camera, column, row)
        };
        self.lights.cover(self.camera, column, row)
            || ray.and_then(|ray| self.first_surface(&ray)).is_some_and(|surface| corner.continues(&surface))
    }

    /// By pixel, the samples of the coarsest grid that sampled a highlight, or differ from what those
    /// beside them on the same surface suggest.
    pub(crate) fn noisy_samples(&self, [columns, rows]: [&[usize]; 2]) -> Vec<bool> {
        let mut is_noisy = vec![false; self.samples.pixels()];
        // Few rays find that a blurred body covers a part of a pixel.
        let is_blurred = self.camera.is_blurred();
        let beside =
            |places: &[usize], index: usize| [index.checked_sub(1), Some(index + 1)].map(|i| places.get(i?).copied());
        for (down, row) in rows.iter().enumerate() {
            for (right, column) in columns.iter().enumerate() {
                let pixel = self.at((*column, *row));
                let Some(sample) = self.samples.get(pixel) else { continue };
                is_noisy[pixel] |= is_blurred || sample.is_glossy;
                let in_row = beside(columns, right).map(|column| column.map(|column| (column, *row)));
                let in_column = beside(rows, down).map(|row| row.map(|row| (*column, row)));
                for pair in [in_row, in_column] {
                    if !self.fits_between(sample, pair.map(|pixel| self.joined(sample, pixel?))) {
                        // Those beside it may agree with one another by chance.
                        is_noisy[pixel] = true;
                        pair.into_iter().flatten().for_each(|other| is_noisy[self.at(other)] = true);
                    }
                }
            }
        }
        is_noisy
    }

    /// The sample of a pixel, if it sees the same surface as another one.
    fn joined(&self, sample: &Sample, pixel: Pixel) -> Option<&Sample> {
        self.sampled(pixel).filter(|other| sample.surface.joins(&other.surface))
    }

    /// Whether a sample is near to the mean of those on both sides, or to one of them if the other is
    /// missing.
    fn fits_between(&self, sample: &Sample, beside: [Option<&Sample>; 2]) -> bool {
        let (Some(one), Some(other)) = (beside[0].or(beside[1]), beside[1].or(beside[0])) else { return true };
        (0..3).all(|band| {
            let (value, mean) = (sample.value[band], 0.5 * (one.value[band] + other.value[band]));
            (value - mean).abs() <= SMOOTH_DIFFERENCE * self.allowed_difference(value, mean) + self.darkness
        })
    }

    /// Divides glossy cells next to noisy ones. A cell whose corners all missed a rare bright
    /// reflection looks smooth: interpolating it, but not its neighbours, would lose light.
    pub(crate) fn spread_noise(&self, cells: &[Cell], is_smooth: &mut [bool]) {
        let glossy: Vec<usize> = (0..cells.len()).filter(|index| self.is_glossy(&cells[*index])).collect();
        if glossy.is_empty() {
            return;
        }
        let corners = |index: usize| cells[index].corners().map(|corner| self.at(corner));
        let mut is_noisy = vec![false; self.samples.pixels()];
        for _ in 0..HIGHLIGHT_RINGS {
            for index in glossy.iter().filter(|index| !is_smooth[**index]) {
                corners(*index).into_iter().for_each(|corner| is_noisy[corner] = true);
            }
            for index in &glossy {
                is_smooth[*index] &= !corners(*index).into_iter().any(|corner| is_noisy[corner]);
            }
        }
    }

    /// Whether all corners of a cell see the same surface and sample its highlight.
    fn is_glossy(&self, cell: &Cell) -> bool {
        let [Some(first), Some(second), Some(third), Some(fourth)] = cell.corners().map(|corner| self.sampled(corner))
        else {
            return false;
        };
        first.is_glossy
            && [second, third, fourth].into_iter().all(|other| other.is_glossy && first.surface.joins(&other.surface))
    }
}
