//! `pfilt`: exposure, size and star patterns.
//!
//! The first pass measures the mean brightness and finds hot pixels; the second scales, filters and
//! writes. Only the rows within the filter's support are in memory.

mod bar;
mod box_filter;
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

/// The size of the output along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Size {
    /// Number of pixels.
    Pixels(usize),
    /// Output pixels per input pixel.
    Scale(f64),
}

/// The reconstruction filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kernel {
    /// The mean of the input pixels whose centre lies in the output pixel.
    Box,
    /// A Gaussian with a radius in output pixels.
    Gaussian {
        /// The radius, above 0.
        radius: f64,
    },
    /// A Gaussian that widens for pixels that would contribute more than a fraction of an output
    /// pixel.
    Threshold {
        /// The radius in output pixels, above 0.
        radius: f64,
        /// The largest contribution of one input pixel to an output pixel, above 0.
        fraction: f64,
    },
}

/// Whether hot pixels count in the average brightness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HotPixels {
    /// The pixels are excluded.
    LeftOut,
    /// The pixels are included.
    Averaged,
}

/// Whether the header records a change of the pixel aspect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AspectRecord {
    /// A `PIXASPECT` line records it.
    Written,
    /// The change is not recorded: it corrects the aspect ratio.
    LeftOut,
}

/// Options of [`filter`].
#[derive(Clone, Debug, PartialEq)]
pub struct FilterOptions {
    /// Columns of the output; as in the input by default.
    pub columns: Size,
    /// Rows of the output; as in the input by default.
    pub rows: Size,
    /// Aspect of output pixels, height divided by width; `None` derives it from the sizes.
    pub aspect: Option<f64>,
    /// Whether the header records a change of the pixel aspect.
    pub aspect_record: AspectRecord,
    /// Factors of red, green and blue, besides the automatic exposure of two passes; 1 by default.
    pub exposure: [f32; 3],
    /// The reconstruction filter; a box by default.
    pub kernel: Kernel,
    /// Whether hot pixels count in the average; excluded by default.
    pub hot_pixels: HotPixels,
    /// The brightness threshold of hot pixels, W/(sr·m²); 100 by default.
    pub hot_level: f64,
    /// Half the number of points of a star at each hot pixel; 0, no stars, by default.
    pub star_lines: usize,
    /// Spread of the stars; larger values give longer points; 1e-4 by default.
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

/// Filters with the given exposure in one pass, so that the picture may come from a pipe. `command`
/// is added to the header.
///
/// # Errors
/// When the picture cannot be read, or the output cannot be written.
pub fn filter_one_pass<R: Read, W: Write>(
    reader: PictureReader<R>,
    options: &FilterOptions,
    command: &[&str],
    target: W,
) -> Result<(), ToolError> {
    let measured = Measured::nothing(&reader);
    run(reader, options, &measured, command, target)
}

/// The second of two passes over the same picture. `command` is added to the header.
///
/// # Errors
/// When the picture cannot be read, or the output cannot be written.
pub fn filter<R: Read, W: Write>(
    reader: PictureReader<R>,
    options: &FilterOptions,
    measured: &Measured,
    command: &[&str],
    target: W,
) -> Result<(), ToolError> {
    run(reader, options, measured, command, target)
}

/// The mapping between input and output pixels. Sizes are scanlines and pixels per scanline.
#[derive(Clone, Copy, Debug)]
struct Resampling {
    in_columns: usize,
    in_rows: usize,
    columns: usize,
    rows: usize,
    /// Output columns per input column.
    x_scale: f64,
    /// Output rows per input row.
    y_scale: f64,
    /// Whether the filter wraps around horizontally, as in a full panorama.
    wraps: bool,
}

impl Resampling {
    fn new<R: Read>(
        reader: &PictureReader<R>,
        options: &FilterOptions,
        rows_there: usize,
    ) -> Result<Resampling, ToolError> {
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
            return Err(ToolError::TooFewScanlines { rows: rows_there, expected: all_rows });
        }
        let wraps = upright && is_panorama(reader.header());
        Ok(Resampling { in_columns, in_rows: rows_there, columns, rows, x_scale, y_scale, wraps })
    }

    /// The input row at the centre of an output row.
    fn middle_row(&self, row: usize) -> usize {
        ((row as f64 + 0.5) * self.in_rows as f64 / self.rows as f64) as usize
    }

    /// The input column at the centre of an output column.
    fn middle_column(&self, column: usize) -> usize {
        ((column as f64 + 0.5) * self.in_columns as f64 / self.columns as f64) as usize
    }

    /// The input columns in an output column's box; they may lie outside on either side.
    fn box_columns(&self, column: usize) -> Range<isize> {
        boxed(column, self.middle_column(column), self.x_scale, self.in_columns / self.columns / 2 + 1)
    }

    /// The existing part of a range of input columns; all of it if the filter wraps around.
    fn inside(&self, columns: Range<isize>) -> Range<isize> {
        if self.wraps { columns } else { columns.start.max(0)..columns.end.min(self.in_columns as isize) }
    }

    /// The input column of a position that may lie outside.
    fn wrapped(&self, column: isize) -> usize {
        column.rem_euclid(self.in_columns as isize) as usize
    }

    /// The output column of a position that may lie outside, if the filter wraps around.
    fn output_column(&self, column: isize) -> Option<usize> {
        let columns = self.columns as isize;
        if self.wraps {
            return Some(column.rem_euclid(columns) as usize);
        }
        (0..columns).contains(&column).then_some(column as usize)
    }

    /// The input rows in an output row's box.
    fn box_rows(&self, row: usize) -> Range<usize> {
        let rows = boxed(row, self.middle_row(row), self.y_scale, self.in_rows / self.rows / 2 + 1);
        rows.start.max(0) as usize..(rows.end.max(0) as usize).min(self.in_rows)
    }
}

/// The input positions whose centre is within half an output pixel, at most `reach` on either side.
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

/// Whether the header's view is a full panorama.
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
    let resampling = Resampling::new(&reader, options, measured.rows)?;
    let (encoding, components) = (reader.encoding(), reader.components());
    let exposure = measured.exposure(options);
    let stars = Stars::new(options, measured, exposure, &resampling);
    let factors = spread(exposure, encoding, components);
    let mut rows = Rows::new(options.kernel, &resampling, Brightness::new(encoding, components), components);
    let mut bar = Bar::new(rows.reach(), resampling.in_columns * components);
    let header = output_header(&reader, options, &resampling, exposure, command);
    let mut writer = PictureWriter::new(target, &header, components, output_resolution(&reader, &resampling))?;
    let mut read = 0;
    for row in 0..resampling.rows {
        let last = resampling.middle_row(row) + rows.reach();
        while read <= last && read < resampling.in_rows {
            let scanline = bar.next(read);
            reader.read_values(scanline)?;
            stars.draw(read, scanline, encoding, components);
            for pixel in scanline.chunks_exact_mut(components) {
                pixel.iter_mut().zip(&factors).for_each(|(value, factor)| *value *= factor);
            }
            read += 1;
        }
        rows.put(row, &resampling, &bar, &mut writer)?;
    }
    rows.finish(&resampling, &mut writer)?;
    // Consume the rest, so that the writer of our input pipe is not stopped.
    while reader.scanlines_left() > 0 && reader.read_stored().is_ok() {}
    Ok(writer.finish()?)
}

/// Whether two factors agree within two per cent, an invisible difference.
fn nearly_equal(a: f64, b: f64) -> bool {
    a >= 0.98 * b && a <= 1.02 * b
}

/// The lines of the input, the command, and the changed variables.
fn output_header<R: Read>(
    reader: &PictureReader<R>,
    options: &FilterOptions,
    resampling: &Resampling,
    exposure: [f32; 3],
    command: &[&str],
) -> Header {
    let mut header = reader.header().clone();
    header.push_command(command.iter().copied());
    if options.aspect_record == AspectRecord::Written {
        let upright = reader.resolution().orientation.scanlines_are_rows;
        let change =
            if upright { resampling.x_scale / resampling.y_scale } else { resampling.y_scale / resampling.x_scale };
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

fn output_resolution<R: Read>(reader: &PictureReader<R>, resampling: &Resampling) -> Resolution {
    let orientation = reader.resolution().orientation;
    let (width, height) = if orientation.scanlines_are_rows {
        (resampling.columns, resampling.rows)
    } else {
        (resampling.rows, resampling.columns)
    };
    Resolution { width, height, orientation }
}
