//! Rows of the output, by one of the three kernels.

use super::gaussian::Gaussian;
use super::threshold::Threshold;
use super::{Bar, Frame, Kernel};
use crate::ToolError;
use crate::brightness::Brightness;
use radsight_picture::PictureWriter;
use rayon::prelude::*;
use std::io::Write;

/// Output pixels that a thread does at a time.
const PIXELS_AT_A_TIME: usize = 256;

/// Makes rows of the output out of those of the input.
#[derive(Debug)]
pub(super) struct Rows {
    method: Method,
    row: Vec<f32>,
    components: usize,
    /// Input rows on either side of the middle one that a row needs.
    reach: usize,
}

#[derive(Debug)]
enum Method {
    Box,
    Gaussian(Gaussian),
    Threshold(Box<Threshold>),
}

impl Rows {
    pub(super) fn new(kernel: Kernel, frame: &Frame, brightness: Brightness, components: usize) -> Rows {
        let box_reach = frame.in_rows / frame.rows / 2 + 1;
        let enlarges = frame.rows >= frame.in_rows && frame.columns >= frame.in_columns;
        let in_output = |radius: f64| if enlarges { radius * ((frame.y_scale + frame.x_scale) / 2.0) } else { radius };
        let (method, reach) = match kernel {
            Kernel::Box => (Method::Box, box_reach),
            Kernel::Gaussian { radius } => {
                let gaussian = Gaussian::new(in_output(radius), frame);
                let reach = gaussian.reach(frame.y_scale);
                (Method::Gaussian(gaussian), reach)
            }
            Kernel::Threshold { radius, fraction } => {
                let threshold = Threshold::new(in_output(radius), fraction, frame, brightness, components);
                let reach = threshold.reach(frame) + box_reach;
                (Method::Threshold(Box::new(threshold)), reach)
            }
        };
        Rows { method, row: vec![0.0; frame.columns * components], components, reach: reach.min(frame.in_rows) }
    }

    pub(super) fn reach(&self) -> usize {
        self.reach
    }

    /// Makes a row of the output and writes it, or one before it.
    pub(super) fn put<W: Write>(
        &mut self,
        row: usize,
        frame: &Frame,
        bar: &Bar,
        writer: &mut PictureWriter<W>,
    ) -> Result<(), ToolError> {
        if let Method::Threshold(threshold) = &mut self.method {
            if let Some(done) = threshold.put(row, frame, bar) {
                writer.write_values(done)?;
            }
            return Ok(());
        }
        match self.components {
            3 => self.fill::<3>(row, frame, bar),
            _ => self.fill::<0>(row, frame, bar),
        }
        Ok(writer.write_values(&self.row)?)
    }

    /// Writes the rows that are still held back.
    pub(super) fn finish<W: Write>(&mut self, frame: &Frame, writer: &mut PictureWriter<W>) -> Result<(), ToolError> {
        let Method::Threshold(threshold) = &self.method else { return Ok(()) };
        for row in threshold.held(frame) {
            writer.write_values(threshold.row(row))?;
        }
        Ok(())
    }

    fn fill<const N: usize>(&mut self, row: usize, frame: &Frame, bar: &Bar) {
        let (components, method) = (self.components, &self.method);
        let parts = self.row.par_chunks_mut(PIXELS_AT_A_TIME * components).enumerate();
        parts.for_each(|(part, pixels)| {
            for (offset, sums) in pixels.chunks_exact_mut(components).enumerate() {
                let column = part * PIXELS_AT_A_TIME + offset;
                match method {
                    Method::Gaussian(gaussian) => gaussian.put::<N>(row, column, frame, bar, sums),
                    _ => put_box::<N>(row, column, frame, bar, sums),
                }
            }
        });
    }
}

/// The mean of the input pixels in an output pixel. `N` is the number of components, or 0 if only `sums` knows it.
pub(super) fn put_box<const N: usize>(row: usize, column: usize, frame: &Frame, bar: &Bar, sums: &mut [f32]) {
    let components = if N == 0 { sums.len() } else { N };
    let sums = &mut sums[..components];
    let columns = frame.inside(frame.box_columns(column));
    let mut count = 0u32;
    sums.fill(0.0);
    for y in frame.box_rows(row) {
        let scanline = bar.row(y);
        for x in columns.clone() {
            count += 1;
            let pixel = &scanline[frame.wrapped(x) * components..][..components];
            sums.iter_mut().zip(pixel).for_each(|(sum, value)| *sum += value);
        }
    }
    if count > 1 {
        let scale = (1.0 / f64::from(count)) as f32;
        sums.iter_mut().for_each(|sum| *sum *= scale);
    }
}
