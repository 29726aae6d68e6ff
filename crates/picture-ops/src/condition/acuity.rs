//! Acuity: dim regions are seen less sharply. An image pyramid is sampled by trilinear
//! interpolation at the local resolution of the eye.

use super::foveal::Fovea;
use super::luminance::Luminance;
use super::{TINY, between};
use crate::ToolError;
use radsight_picture::PictureReader;
use std::collections::VecDeque;
use std::f64::consts::PI;
use std::io::Read;

/// The finest visible detail at an adaptation luminance in cd/m², cycles per degree: a fit to
/// Shaler's data of 1937.
pub(super) fn cycles_a_degree(luminance: f64) -> f64 {
    17.25 * (1.4 * luminance.log10() + 0.35).atan() + 25.72
}

/// An image pyramid, and the visible detail at each foveal sample.
#[derive(Debug)]
pub(super) struct Acuity {
    /// Size of the finest visible detail in input pixels, at each foveal sample.
    detail: Vec<f32>,
    columns: usize,
    rows: usize,
    /// Size of the input: pixels per scanline and scanlines.
    size: [usize; 2],
    /// The pyramid: level n is the picture halved n times.
    levels: Vec<Level>,
}

/// The scanlines of one level that are still needed.
#[derive(Debug, Default)]
struct Level {
    scanlines: VecDeque<Vec<[f32; 3]>>,
    /// Number of scanlines made.
    made: usize,
}

/// Largest number of halvings.
const MOST_HALVINGS: usize = 30;

impl Acuity {
    pub(super) fn new(fovea: &Fovea, luminance: &Luminance) -> Acuity {
        let (columns, rows) = (fovea.columns(), fovea.rows());
        let size = [fovea.picture.scanline_length(), fovea.picture.scanlines()];
        let mut detail = vec![1.0f32; columns * rows];
        let directions = fovea.directions();
        let steps = [0.5 * columns as f64 / size[0] as f64, 0.5 * rows as f64 / size[1] as f64];
        let difference = |a: usize, b: usize, step: f64| -> [f64; 3] {
            std::array::from_fn(|i| step * f64::from(directions[a][i] - directions[b][i]))
        };
        for row in 1..rows - 1 {
            for column in 1..columns - 1 {
                let at = row * columns + column;
                let across = difference(at + 1, at - 1, steps[0]);
                let down = difference(at + columns, at - columns, steps[1]);
                let solid_angle = 0.5 * length(cross(across, down));
                if solid_angle > TINY * TINY {
                    let cycles = cycles_a_degree(luminance.of(fovea.colors[at]));
                    detail[at] = (PI / 180.0 / solid_angle.sqrt() / cycles) as f32;
                }
            }
        }
        let coarsest = detail.iter().copied().fold(1.0f32, f32::max);
        // Pixels at the border lack neighbours on one side.
        for column in 1..columns - 1 {
            detail[column] = detail[columns + column];
            detail[(rows - 1) * columns + column] = detail[(rows - 2) * columns + column];
        }
        for row in detail.chunks_exact_mut(columns) {
            row[0] = row[1];
            row[columns - 1] = row[columns - 2];
        }
        let halvings = (f64::from(coarsest).log2() as usize + 1).min(MOST_HALVINGS);
        let useful = |halvings: &usize| size[0] >> halvings >= 2 && size[1] >> halvings >= 2;
        let levels = (0..=halvings).take_while(|halvings| *halvings == 0 || useful(halvings));
        let levels = levels.map(|_| Level::default()).collect();
        Acuity { detail, columns, rows, size, levels }
    }

    /// The next scanline, blurred to the acuity of the eye.
    pub(super) fn read<R: Read>(
        &mut self,
        scanline: usize,
        reader: &mut PictureReader<R>,
        pixels: &mut [[f32; 3]],
    ) -> Result<(), ToolError> {
        for level in 0..self.levels.len() {
            let last = self.row_at(scanline, level).0 + usize::from(level > 0);
            self.make(level, last, reader)?;
        }
        let (row, down) = between(scanline, self.size[1], self.rows);
        for (position, pixel) in pixels.iter_mut().enumerate() {
            let (column, right) = between(position, self.size[0], self.columns);
            let detail = |row: usize| {
                let at = row * self.columns + column;
                (1.0 - right) * f64::from(self.detail[at]) + right * f64::from(self.detail[at + 1])
            };
            *pixel = self.sample(position, scanline, (1.0 - down) * detail(row) + down * detail(row + 1));
        }
        Ok(())
    }

    /// A pixel interpolated between the two levels whose pixel size is nearest to `detail` input
    /// pixels.
    fn sample(&self, position: usize, scanline: usize, detail: f64) -> [f32; 3] {
        let pixels = |level: usize| (1u64 << level) as f64;
        let mut level = self.levels.len() - 1;
        while level > 0 && pixels(level - 1) > detail {
            level -= 1;
        }
        let coarse = self.value(position, scanline, level);
        if level == 0 {
            return coarse;
        }
        let fine = self.value(position, scanline, level - 1);
        let part = (pixels(level) - detail) / pixels(level - 1);
        std::array::from_fn(|i| (f64::from(coarse[i]) * (1.0 - part)) as f32 + (f64::from(fine[i]) * part) as f32)
    }

    /// The row of a level before a scanline of the input, and the fraction towards the next row.
    fn row_at(&self, scanline: usize, level: usize) -> (usize, f64) {
        halved_position(scanline, level, self.size[1])
    }

    /// The value of a level interpolated at a pixel of the input.
    fn value(&self, position: usize, scanline: usize, level: usize) -> [f32; 3] {
        let (row, down) = self.row_at(scanline, level);
        let upper = self.levels[level].scanline(row);
        if level == 0 {
            return upper[position];
        }
        let lower = self.levels[level].scanline(row + 1);
        let (column, right) = halved_position(position, level, self.size[0]);
        let scaled = |value: f32, part: f64| (f64::from(value) * part) as f32;
        let mixed =
            |line: &[[f32; 3]], i: usize| scaled(line[column][i], 1.0 - right) + scaled(line[column + 1][i], right);
        std::array::from_fn(|i| {
            let value = scaled(mixed(upper, i), 1.0 - down) + scaled(mixed(lower, i), down);
            value.max(0.0)
        })
    }

    /// Makes the scanlines of a level up to `last`.
    fn make<R: Read>(&mut self, level: usize, last: usize, reader: &mut PictureReader<R>) -> Result<(), ToolError> {
        while self.levels[level].made <= last {
            let next = self.levels[level].made;
            let made = if level == 0 {
                let mut scanline = vec![[0.0; 3]; self.size[0]];
                reader.read_three(&mut scanline)?;
                scanline
            } else {
                self.make(level - 1, 2 * next + 1, reader)?;
                let finer = &self.levels[level - 1];
                halved(finer.scanline(2 * next), finer.scanline(2 * next + 1))
            };
            let kept = 2 << (self.levels.len() - 1 - level);
            self.levels[level].push(made, kept);
        }
        Ok(())
    }
}

impl Level {
    /// Adds a scanline and drops those that are no longer needed.
    fn push(&mut self, scanline: Vec<[f32; 3]>, kept: usize) {
        self.scanlines.push_back(scanline);
        self.made += 1;
        if self.scanlines.len() > kept {
            self.scanlines.pop_front();
        }
    }

    fn scanline(&self, row: usize) -> &[[f32; 3]] {
        let first = self.made - self.scanlines.len();
        &self.scanlines[row.saturating_sub(first)]
    }
}

/// The pixel of a level before a pixel of the input, and the fraction towards the next one.
fn halved_position(at: usize, level: usize, length: usize) -> (usize, f64) {
    if level == 0 {
        return (at, 0.0);
    }
    let position = (at as f64 + 0.5) / (1u64 << level) as f64 - 0.5;
    let before = (position as usize).min((length >> level) - 2);
    (before, position - before as f64)
}

/// Means of 2 × 2 pixels.
fn halved(upper: &[[f32; 3]], lower: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let pairs = upper.as_chunks::<2>().0.iter().zip(lower.as_chunks::<2>().0);
    let mean = |(upper, lower): (&[[f32; 3]; 2], &[[f32; 3]; 2])| {
        std::array::from_fn(|i| 0.25 * (upper[0][i] + upper[1][i] + lower[0][i] + lower[1][i]))
    };
    pairs.map(mean).collect()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn length(a: [f64; 3]) -> f64 {
    a.iter().map(|part| part * part).sum::<f64>().sqrt()
}
