//! Stars around the pixels that shine, as diffraction at a lens's blades draws them.

use super::measure::HotPixel;
use super::{FilterOptions, Frame, Measured};
use crate::brightness::{of_rgb, spread};
use crate::drand48::Drand48;
use radsight_picture::Encoding;
use std::f64::consts::PI;

/// Below this something is zero.
const TINY: f64 = 1e-6;

/// The slopes of the stars' lines: of each shining pixel one of a number of directions, in the order that Radiance draws them.
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

/// The stars of a picture.
#[derive(Debug)]
pub(super) struct Stars<'a> {
    hot: &'a [HotPixel],
    /// The square of the distance, in pixels, up to which a line is as bright as its pixel.
    reach: f64,
    columns: usize,
}

impl Stars<'_> {
    pub(super) fn new<'a>(
        options: &FilterOptions,
        measured: &'a Measured,
        exposure: [f32; 3],
        frame: &Frame,
    ) -> Stars<'a> {
        let (columns, rows) = (frame.in_columns as f64, frame.in_rows as f64);
        let reach =
            options.star_spread / (measured.hot_level * of_rgb(exposure)) * (columns * columns + rows * rows) / 4.0;
        Stars { hot: &measured.hot, reach, columns: frame.in_columns }
    }

    /// Adds what all lines have in a row.
    pub(super) fn draw(&self, row: usize, scanline: &mut [f32], encoding: Encoding, components: usize) {
        // The last pixel that was found comes first: the sums depend on the order.
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

    /// The columns that a star's line has in a row.
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

/// How much of a pixel its star's line has somewhere.
enum Part {
    Whole,
    Scaled(f64),
}
