//! Parts of a picture, put together.

use super::{JobResult, RenderJob};
use crate::error::Error;
use std::ops::Range;

/// This share of a band's mean is added in squares to a value where an error is taken relative to it, as in renderings to an
/// asked error: what is darker need not be more exact.
const DARK: f64 = 0.01;

/// A picture from the parts that are there; the others are black.
#[derive(Clone, Debug, PartialEq)]
pub struct MergedJob {
    /// What was asked for, without rows.
    pub job: RenderJob,
    /// Pixels in a row and rows.
    pub size: [usize; 2],
    /// 3 for radiances in red, green and blue, W/(sr·m²); 1 for exposures, J/m².
    pub components: usize,
    /// The components of each pixel, top row first.
    pub values: Vec<f32>,
    /// Estimated standard errors of them, in their unit; NaN with one sample.
    pub standard_errors: Vec<f32>,
    has_row: Vec<bool>,
}

impl MergedJob {
    /// Puts parts together, in any order. A part may be there twice.
    ///
    /// # Errors
    /// [`Error::Part`] for no parts, parts of different jobs, and parts that differ where they should not.
    pub fn of(parts: &[JobResult]) -> Result<MergedJob, Error> {
        let whole = |job: &RenderJob| RenderJob { rows: None, ..job.clone() };
        let bad = |index: usize, reason: &str| Error::Part { name: format!("part {index}"), reason: reason.to_owned() };
        let Some(first) = parts.first() else { return Err(bad(0, "there is none, expected at least one")) };
        let [columns, rows] = first.size;
        let numbers = columns * rows * first.components;
        let mut merged = MergedJob {
            job: whole(&first.job),
            size: first.size,
            components: first.components,
            values: vec![0.0; numbers],
            standard_errors: vec![f32::NAN; numbers],
            has_row: vec![false; rows],
        };
        for (index, part) in parts.iter().enumerate() {
            if (whole(&part.job), part.size, part.components) != (merged.job.clone(), merged.size, merged.components) {
                return Err(bad(index, "it belongs to another job than the first part"));
            }
            if !merged.take(part) {
                return Err(bad(
                    index,
                    "it has other values for a row that is there already, or not all of its values",
                ));
            }
        }
        Ok(merged)
    }

    /// Takes in a part; says whether it fits.
    fn take(&mut self, part: &JobResult) -> bool {
        let row_length = self.size[0] * self.components;
        let rows = part.rows();
        let numbers = rows.len() * row_length;
        if rows.end > self.size[1] || part.values.len() != numbers || part.standard_errors.len() != numbers {
            return false;
        }
        for row in rows.clone() {
            let (to, from) = (row * row_length, (row - rows.start) * row_length);
            let values = &part.values[from..from + row_length];
            let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<u32>>();
            if self.has_row[row] && bits(&self.values[to..to + row_length]) != bits(values) {
                return false;
            }
            self.values[to..to + row_length].copy_from_slice(values);
            self.standard_errors[to..to + row_length].copy_from_slice(&part.standard_errors[from..from + row_length]);
            self.has_row[row] = true;
        }
        true
    }

    /// The rows of which there is no part, as ranges.
    #[must_use]
    pub fn missing_rows(&self) -> Vec<Range<usize>> {
        let mut missing: Vec<Range<usize>> = Vec::new();
        for row in (0..self.size[1]).filter(|row| !self.has_row[*row]) {
            match missing.last_mut() {
                Some(range) if range.end == row => range.end = row + 1,
                _ => missing.push(row..row + 1),
            }
        }
        missing
    }

    /// Estimated relative error of the rows that are there: of radiances the root of the mean of `d²/(v² + (0.01·m)²)` over the bands of
    /// all pixels, d the standard error of a value v and m the mean of its band; of exposures the rms standard error as a share
    /// of the mean. `None` with one sample, and where nothing is there or all is black.
    #[must_use]
    pub fn relative_error(&self) -> Option<f64> {
        let row_length = self.size[0] * self.components;
        let known: Vec<usize> = (0..self.values.len()).filter(|number| self.has_row[number / row_length]).collect();
        let means: Vec<f64> = (0..self.components)
            .map(|band| {
                let of_band = known.iter().filter(|number| *number % self.components == band);
                let sum: f64 = of_band.map(|number| f64::from(self.values[*number])).sum();
                sum * self.components as f64 / known.len() as f64
            })
            .collect();
        let squared = |number: usize| {
            let (value, mean) = (f64::from(self.values[number]), means[number % self.components]);
            let unit = if self.components == 1 { mean } else { value.hypot(DARK * mean) };
            let error = f64::from(self.standard_errors[number]);
            // Where a band is black everywhere, nothing is to be exact.
            if error == 0.0 { 0.0 } else { (error / unit).powi(2) }
        };
        let sum: f64 = known.iter().map(|number| squared(*number)).sum();
        Some((sum / known.len() as f64).sqrt()).filter(|error| error.is_finite())
    }
}
