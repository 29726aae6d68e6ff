//! `pfilt`: exposure, size and star patterns.
//!
//! Two passes: the first finds the mean brightness and the pixels that shine, the second scales, filters and writes. Only the rows that
//! the filter needs are in memory.

mod bar;
mod gaussian;
mod measure;
mod rows;
mod stars;
mod threshold;

use crate::ToolError;
use crate::brightness::{Brightness, of_rgb, spread};
use bar::Bar;
pub use measure::{Measured, measure};
use radsight_picture::{Header, PictureReader, PictureWriter, Resolution, ViewKind, ViewOptions};
use rows::Rows;
use stars::Stars;
use std::io::{Read, Write};
use std::ops::Range;

/// A size of the output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Size {
    /// Pixels.
    Pixels(usize),
    /// Output pixels for each of the input.
    Scale(f64),
}

/// How an output pixel is made of input pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kernel {
    /// The mean of the input pixels whose middle is in the output pixel.
    Box,
    /// A Gaussian of this radius in output pixels.
    Gaussian {
        /// The radius, above 0.
        radius: f64,
    },
    /// As the Gaussian, but wider for pixels that would be more than a fraction of the output pixel.
    Threshold {
        /// The radius in output pixels, above 0.
        radius: f64,
        /// The largest fraction of an output pixel that one input pixel may make, above 0.
        fraction: f64,
    },
}

/// Whether shining pixels count in the average brightness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HotPixels {
    /// They do not.
    LeftOut,
    /// They do.
    Averaged,
}

/// Whether the header tells a change of the pixels' shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AspectRecord {
    /// The header gets a `PIXASPECT` where the shape changes.
    Written,
    /// Nothing is said: the change corrects the shape.
    LeftOut,
}

/// What is asked of [`filter`].
#[derive(Clone, Debug, PartialEq)]
pub struct FilterOptions {
    /// Columns of the output; all of the input's by default.
    pub columns: Size,
    /// Rows of the output; all of the input's by default.
    pub rows: Size,
    /// The shape of output pixels, height over width; `None` leaves it to the sizes.
    pub aspect: Option<f64>,
    /// What the header says about the shape.
    pub aspect_record: AspectRecord,
    /// What red, green and blue are multiplied by, beside the automatic exposure of two passes; 1 by default.
    pub exposure: [f32; 3],
    /// How output pixels are made; a box by default.
    pub kernel: Kernel,
    /// Whether shining pixels count in the average; left out by default.
    pub hot_pixels: HotPixels,
    /// The brightness from which a pixel shines, in W/(sr·m²); 100 by default.
    pub hot_level: f64,
    /// Half the number of points of a star at each shining pixel; 0, no stars, by default.
    pub star_lines: usize,
    /// How far stars spread, a fraction; 1e-4 by default.
    pub star_spread: f64,
}

impl Default for FilterOptions {
    fn default() -> FilterOptions {
        FilterOptions {
            columns: Size::Scale(1.0),
            rows: Size::Scale(1.0),
            aspect: None,
            aspect_record: AspectRecord::Written,
            exposure: [1.0; 3],
            kernel: Kernel::Box,
            hot_pixels: HotPixels::LeftOut,
            hot_level: 100.0,
            star_lines: 0,
            star_spread: 1e-4,
        }
    }
}

/// Filters with the exposure as given: one pass, so that the picture may come through a pipe. `command` goes to the header.
///
/// # Errors
/// When the picture cannot be read, or the output not be written.
pub fn filter_one_pass<R: Read, W: Write>(
    reader: PictureReader<R>,
    options: &FilterOptions,
    command: &[&str],
    target: W,
) -> Result<(), ToolError> {
    let measured = Measured::nothing(&reader);
    run(reader, options, &measured, command, target)
}

/// The second of two passes over the same picture. `command` goes to the header.
///
/// # Errors
/// When the picture cannot be read, or the output not be written.
pub fn filter<R: Read, W: Write>(
    reader: PictureReader<R>,
    options: &FilterOptions,
    measured: &Measured,
    command: &[&str],
    target: W,
) -> Result<(), ToolError> {
    run(reader, options, measured, command, target)
}

/// Sizes of input and output, in scanlines and pixels a scanline.
#[derive(Clone, Copy, Debug)]
struct Frame {
    in_columns: usize,
    in_rows: usize,
    columns: usize,
    rows: usize,
    /// Output columns for each input column.
    x_scale: f64,
    /// Output rows for each input row.
    y_scale: f64,
    /// Whether the filter goes on at the other side: a full panorama.
    wraps: bool,
}

impl Frame {
    fn new<R: Read>(reader: &PictureReader<R>, options: &FilterOptions, rows_there: usize) -> Result<Frame, ToolError> {
        let resolution = reader.resolution();
        let (in_columns, all_rows) = (resolution.scanline_length(), resolution.scanlines());
        let scaled = |size: Size, input: usize| match size {
            Size::Pixels(pixels) => pixels,
            Size::Scale(scale) => (scale * input as f64 + 0.5) as usize,
        };
        let (mut columns, mut rows) = (scaled(options.columns, in_columns), scaled(options.rows, all_rows));
        let upright = resolution.orientation.scanlines_are_rows;
        if let Some(aspect) = options.aspect {
            let input = reader.header().pixel_aspect()?;
            let input = if upright { input } else { 1.0 / input };
            let shape = input * all_rows as f64 / in_columns as f64 / aspect;
            if shape * columns as f64 > rows as f64 {
                columns = (rows as f64 / shape) as usize;
            } else {
                rows = (columns as f64 * shape) as usize;
            }
        }
        let x_scale = columns as f64 / in_columns as f64;
        let mut y_scale = rows as f64 / all_rows as f64;
        if rows_there < all_rows {
            rows = rows * rows_there / all_rows;
            y_scale = rows as f64 / rows_there as f64;
        }
        if rows == 0 || columns == 0 {
            return Err(ToolError::EmptyFrame { rows: rows_there, expected: all_rows });
        }
        let wraps = upright && is_panorama(reader.header());
        Ok(Frame { in_columns, in_rows: rows_there, columns, rows, x_scale, y_scale, wraps })
    }

    /// The input row in the middle of an output row.
    fn middle_row(&self, row: usize) -> usize {
        ((row as f64 + 0.5) * self.in_rows as f64 / self.rows as f64) as usize
    }

    /// The input column in the middle of an output column.
    fn middle_column(&self, column: usize) -> usize {
        ((column as f64 + 0.5) * self.in_columns as f64 / self.columns as f64) as usize
    }

    /// The input columns (which may lie outside, on either side) that are in an output column's box.
    fn box_columns(&self, column: usize) -> Range<isize> {
        boxed(column, self.middle_column(column), self.x_scale, self.in_columns / self.columns / 2 + 1)
    }

    /// The part of a range of input columns that there is: all of it where the filter goes on at the other side.
    fn inside(&self, columns: Range<isize>) -> Range<isize> {
        if self.wraps { columns } else { columns.start.max(0)..columns.end.min(self.in_columns as isize) }
    }

    /// The input column of a place that may lie outside, on either side.
    fn wrapped(&self, column: isize) -> usize {
        column.rem_euclid(self.in_columns as isize) as usize
    }

    /// The output column of a place that may lie outside, if the filter goes on at the other side.
    fn output_column(&self, column: isize) -> Option<usize> {
        let columns = self.columns as isize;
        if self.wraps {
            return Some(column.rem_euclid(columns) as usize);
        }
        (0..columns).contains(&column).then_some(column as usize)
    }

    /// The input rows that are in an output row's box.
    fn box_rows(&self, row: usize) -> Range<usize> {
        let rows = boxed(row, self.middle_row(row), self.y_scale, self.in_rows / self.rows / 2 + 1);
        rows.start.max(0) as usize..(rows.end.max(0) as usize).min(self.in_rows)
    }
}

/// The input positions whose middle is within half an output pixel, of at most `reach` on either side.
fn boxed(output: usize, middle: usize, scale: f64, reach: usize) -> Range<isize> {
    let (middle, reach) = (middle as isize, reach as isize);
    let distance = |input: isize| {
        if scale < 1.0 { scale * input as f64 - (output as f64 + 0.5) } else { (input - middle) as f64 }
    };
    let (first, last) = (middle + 1 - reach, middle + reach);
    let start = (first..=last).find(|input| distance(*input) >= -0.5).unwrap_or(last + 1);
    let end = (start..=last).find(|input| distance(*input) >= 0.5).unwrap_or(last + 1);
    start..end
}

/// Whether the view of a header goes all around.
fn is_panorama(header: &Header) -> bool {
    const ALL_AROUND: f64 = 360.0 - 1e-6;
    let view = ViewOptions::from_header(header).ok().flatten();
    view.is_some_and(|view| view.kind == ViewKind::Cylindrical && view.horizontal >= ALL_AROUND)
}

fn run<R: Read, W: Write>(
    mut reader: PictureReader<R>,
    options: &FilterOptions,
    measured: &Measured,
    command: &[&str],
    target: W,
) -> Result<(), ToolError> {
    let frame = Frame::new(&reader, options, measured.rows)?;
    let (encoding, components) = (reader.encoding(), reader.components());
    let exposure = measured.exposure(options);
    let stars = Stars::new(options, measured, exposure, &frame);
    let factors = spread(exposure, encoding, components);
    let mut rows = Rows::new(options.kernel, &frame, Brightness::new(encoding, components), components);
    let mut bar = Bar::new(rows.reach(), frame.in_columns * components);
    let header = output_header(&reader, options, &frame, exposure, command);
    let mut writer = PictureWriter::new(target, &header, components, output_resolution(&reader, &frame))?;
    let mut read = 0;
    for row in 0..frame.rows {
        let last = frame.middle_row(row) + rows.reach();
        while read <= last && read < frame.in_rows {
            let scanline = bar.next(read);
            reader.read_values(scanline)?;
            stars.draw(read, scanline, encoding, components);
            for pixel in scanline.chunks_exact_mut(components) {
                pixel.iter_mut().zip(&factors).for_each(|(value, factor)| *value *= factor);
            }
            read += 1;
        }
        rows.put(row, &frame, &bar, &mut writer)?;
    }
    rows.finish(&frame, &mut writer)?;
    // Whoever writes into our pipe is not to be stopped by its end.
    while reader.scanlines_left() > 0 && reader.read_stored().is_ok() {}
    Ok(writer.finish()?)
}

/// Whether two factors are the same within two per cent, as the eye cannot tell them apart.
fn nearly_equal(a: f64, b: f64) -> bool {
    a >= 0.98 * b && a <= 1.02 * b
}

/// All lines of the input, the command, and what has changed.
fn output_header<R: Read>(
    reader: &PictureReader<R>,
    options: &FilterOptions,
    frame: &Frame,
    exposure: [f32; 3],
    command: &[&str],
) -> Header {
    let mut header = reader.header().clone();
    header.push_command(command.iter().copied());
    if options.aspect_record == AspectRecord::Written {
        let upright = reader.resolution().orientation.scanlines_are_rows;
        let change = if upright { frame.x_scale / frame.y_scale } else { frame.y_scale / frame.x_scale };
        if !(0.995..=1.005).contains(&change) {
            header.push_variable("PIXASPECT", &format!("{change:.6}"));
        }
    }
    let mean = of_rgb(exposure);
    if !nearly_equal(mean, 1.0) {
        header.push_exposure(mean);
    }
    let [red, green, blue] = exposure.map(|part| (f64::from(part) * (1.0 / mean)) as f32).map(f64::from);
    if !nearly_equal(red, green) || !nearly_equal(green, blue) {
        header.push_variable("COLORCORR", &format!(" {red:.6} {green:.6} {blue:.6}"));
    }
    header
}

fn output_resolution<R: Read>(reader: &PictureReader<R>, frame: &Frame) -> Resolution {
    let orientation = reader.resolution().orientation;
    let (width, height) =
        if orientation.scanlines_are_rows { (frame.columns, frame.rows) } else { (frame.rows, frame.columns) };
    Resolution { width, height, orientation }
}
