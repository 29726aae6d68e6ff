//! Computes output rows with one of the three filters.

use super::box_filter::put_box;
use super::gaussian::Gaussian;
use super::threshold::Threshold;
use super::{Bar, Kernel, Resampling};
use crate::ToolError;
use crate::brightness::Brightness;
use radsight_picture::PictureWriter;
use rayon::prelude::*;
use std::io::Write;

/// Output pixels per work item of a thread.
const PIXELS_AT_A_TIME: usize = 256;

/// Computes output rows from input rows.
#[derive(Debug)]
pub(super) struct Rows {
    method: Method,
    row: Vec<f32>,
    components: usize,
    /// Input rows needed on either side of the central one.
    reach: usize,
}

#[derive(Debug)]
enum Method {
    Box,
    Gaussian(Gaussian),
    Threshold(Box<Threshold>),
}

impl Rows {
    pub(super) fn new(kernel: Kernel, resampling: &Resampling, brightness: Brightness, components: usize) -> Rows {
        let box_reach = resampling.in_rows / resampling.rows / 2 + 1;
        let enlarges = resampling.rows >= resampling.in_rows && resampling.columns >= resampling.in_columns;
        let in_output =
            |radius: f64| if enlarges { radius * ((resampling.y_scale + resampling.x_scale) / 2.0) } else { radius };
        let (method, reach) = match kernel {
            Kernel::Box => (Method::Box, box_reach),
            Kernel::Gaussian { radius } => {
                let gaussian = Gaussian::new(in_output(radius), resampling);
                let reach = gaussian.reach(resampling.y_scale);
                (Method::Gaussian(gaussian), reach)
            }
            Kernel::Threshold { radius, fraction } => {
                let threshold = Threshold::new(in_output(radius), fraction, resampling, brightness, components);
                let reach = threshold.reach(resampling) + box_reach;
                (Method::Threshold(Box::new(threshold)), reach)
            }
        };
        Rows {
            method,
            row: vec![0.0; resampling.columns * components],
            components,
            reach: reach.min(resampling.in_rows),
        }
    }

    pub(super) fn reach(&self) -> usize {
        self.reach
    }

    /// Computes a row of the output and writes it, or an earlier one.
    pub(super) fn put<W: Write>(
        &mut self,
        row: usize,
        resampling: &Resampling,
        bar: &Bar,
        writer: &mut PictureWriter<W>,
    ) -> Result<(), ToolError> {
        if let Method::Threshold(threshold) = &mut self.method {
            if let Some(done) = threshold.put(row, resampling, bar) {
                writer.write_values(done)?;
            }
            return Ok(());
        }
        match self.components {
            3 => self.fill::<3>(row, resampling, bar),
            _ => self.fill::<0>(row, resampling, bar),
        }
        Ok(writer.write_values(&self.row)?)
    }

    /// Writes the pending rows.
    pub(super) fn finish<W: Write>(
        &mut self,
        resampling: &Resampling,
        writer: &mut PictureWriter<W>,
    ) -> Result<(), ToolError> {
        let Method::Threshold(threshold) = &self.method else { return Ok(()) };
        for row in threshold.held(resampling) {
            writer.write_values(threshold.row(row))?;
        }
        Ok(())
    }

    fn fill<const N: usize>(&mut self, row: usize, resampling: &Resampling, bar: &Bar) {
        let (components, method) = (self.components, &self.method);
        let parts = self.row.par_chunks_mut(PIXELS_AT_A_TIME * components).enumerate();
        parts.for_each(|(part, pixels)| {
            for (offset, sums) in pixels.chunks_exact_mut(components).enumerate() {
                let column = part * PIXELS_AT_A_TIME + offset;
                match method {
                    Method::Gaussian(gaussian) => gaussian.put::<N>(row, column, resampling, bar, sums),
                    _ => put_box::<N>(row, column, resampling, bar, sums),
                }
            }
        });
    }
}
