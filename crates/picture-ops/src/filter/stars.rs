//! Star patterns around hot pixels, as from diffraction at a lens's aperture blades.

use super::{FilterOptions, Measured, Resampling};
use crate::brightness::{of_rgb, spread};
use crate::drand48::Drand48;
use radsight_picture::Encoding;
use std::f64::consts::PI;

/// Smaller values are zero.
const TINY: f64 = 1e-6;

/// The slopes of star lines: each hot pixel has one of a number of directions, in the random order
/// of Radiance.
#[derive(Debug)]
pub(super) struct Slopes {
    lines: usize,
    random: Drand48,
}

impl Slopes {
    pub(super) fn new(lines: usize) -> Slopes {
        Slopes { lines, random: Drand48::default() }
    }

    pub(super) fn next(&mut self) -> f64 {
        let line = (self.random.next_integer() * self.lines as u64) >> 31;
        let angle = PI * (0.5 - (line as f64 + 0.5) / self.lines as f64);
        angle.tan()
    }
}

/// A pixel above the threshold.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct HotPixel {
    pub(super) color: [f32; 3],
    pub(super) column: usize,
    pub(super) row: usize,
    /// The slope of its star's line, rows per column.
    pub(super) slope: f64,
}

/// The stars of a picture.
#[derive(Debug)]
pub(super) struct Stars<'a> {
    hot: &'a [HotPixel],
    /// The squared distance, in pixels, up to which a line is as bright as its pixel.
    reach: f64,
    columns: usize,
}

impl Stars<'_> {
    pub(super) fn new<'a>(
        options: &FilterOptions,
        measured: &'a Measured,
        exposure: [f32; 3],
        resampling: &Resampling,
    ) -> Stars<'a> {
        let (columns, rows) = (resampling.in_columns as f64, resampling.in_rows as f64);
        let reach =
            options.star_spread / (measured.hot_level * of_rgb(exposure)) * (columns * columns + rows * rows) / 4.0;
        Stars { hot: &measured.hot, reach, columns: resampling.in_columns }
    }

    /// Adds the star lines that cross a row.
    pub(super) fn draw(&self, row: usize, scanline: &mut [f32], encoding: Encoding, components: usize) {
        // Start with the last pixel found: the sums depend on the order.
        for hot in self.hot.iter().rev() {
            for column in self.crossed(row, hot) {
                let Some(part) = self.part(row, column, hot) else { continue };
                let color = match part {
                    Part::Whole => hot.color,
                    Part::Scaled(scale) => hot.color.map(|value| (f64::from(value) * scale) as f32),
                };
                let pixel = &mut scanline[column * components..][..components];
                pixel.iter_mut().zip(spread(color, encoding, components)).for_each(|(value, more)| *value += more);
            }
        }
    }

    /// The columns that a star line crosses in a row.
    fn crossed(&self, row: usize, hot: &HotPixel) -> std::ops::Range<usize> {
        let (rise, middle) = (row as f64 - hot.row as f64, hot.column as f64);
        let at = |half: f64| ((rise + half) / hot.slope + middle) as i64;
        let (first, last) = match hot.slope {
            slope if slope > TINY => (at(-0.5), at(0.5)),
            slope if slope < -TINY => (at(0.5), at(-0.5)),
            _ if row == hot.row => (0, i64::MAX),
            _ => return 0..0,
        };
        let end = (last.max(-1).saturating_add(1) as usize).min(self.columns);
        first.max(0) as usize..end
    }

    fn part(&self, row: usize, column: usize, hot: &HotPixel) -> Option<Part> {
        let (x, y) = (column as f64 - hot.column as f64, row as f64 - hot.row as f64);
        let distance = x * x + y * y;
        if distance > self.reach {
            let scale = self.reach / distance;
            (scale >= TINY).then_some(Part::Scaled(scale))
        } else {
            (distance > TINY).then_some(Part::Whole)
        }
    }
}

/// The contribution of a star line to a pixel.
enum Part {
    Whole,
    Scaled(f64),
}
