//! Merges the parts of a picture.

use super::{JobResult, RenderJob, Tile};
use crate::error::Error;

/// The square of this fraction of a band's mean is added to the square of a value to which an error
/// is relative, as in renderings to a requested error: darker pixels need not be more accurate.
const DARK: f64 = 0.01;

/// A picture merged from parts; pixels of missing parts are black.
///
/// ```
/// use radsight::{JobTarget, MergedJob, RenderJob, Renderer, Scene, View};
/// let scene = Scene::from_text("void glow white 0 0 4 1 1 1 0 white sphere ball 0 0 4 0 9 0 2")?;
/// let view = View::from_args("-vp 0 0 0 -vd 0 1 0 -vh 40 -vv 40")?;
/// let parts = RenderJob::new(JobTarget::picture(&view, 8, 8), 2).split(2, [8, 8])?;
/// let merged = MergedJob::of(&[Renderer::new(&scene)?.run_job(&parts[0])?])?;
/// assert_eq!((merged.size, merged.missing()[0].rows.clone()), ([8, 8], 4..8));
/// # Ok::<(), radsight::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct MergedJob {
    /// The job, without a part.
    pub job: RenderJob,
    /// Columns and rows; rays are one row.
    pub size: [usize; 2],
    /// 3 for red, green and blue in W/(sr·m²) or the unit of a job of rays; 1 for exposures, J/m².
    pub components: usize,
    /// The components of each pixel, top row first.
    pub values: Vec<f32>,
    /// Estimated standard errors of the values, in their unit; NaN with one sample.
    pub standard_errors: Vec<f32>,
    has_pixel: Vec<bool>,
}

impl MergedJob {
    /// Merges parts in any order. A part may occur twice.
    ///
    /// ```
    /// # use radsight::example::{scene, view};
    /// use radsight::{JobTarget, RenderJob, Renderer};
    /// let job = RenderJob::new(JobTarget::picture(&view(), 8, 8), 2);
    /// let parts = job.split(2, [8, 8])?;
    /// let mut renderer = Renderer::new(&scene())?;
    /// let results = [renderer.run_job(&parts[1])?, renderer.run_job(&parts[0])?];
    /// let merged = radsight::MergedJob::of(&results)?;
    /// assert_eq!((merged.values.len(), merged.missing().len()), (3 * 64, 0));
    /// # Ok::<(), radsight::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Part`] for no parts, parts of different jobs, and duplicate parts
    /// with different values.
    pub fn of(parts: &[JobResult]) -> Result<MergedJob, Error> {
        let bad = |index: usize, reason: &str| Error::Part { name: format!("part {index}"), reason: reason.to_owned() };
        let Some(first) = parts.first() else { return Err(bad(0, "there is none, expected at least one")) };
        let [columns, rows] = first.size;
        let numbers = columns * rows * first.components;
        let mut merged = MergedJob {
            job: first.job.whole(),
            size: first.size,
            components: first.components,
            values: vec![0.0; numbers],
            standard_errors: vec![f32::NAN; numbers],
            has_pixel: vec![false; columns * rows],
        };
        for (index, part) in parts.iter().enumerate() {
            if (part.job.whole(), part.size, part.components) != (merged.job.clone(), merged.size, merged.components) {
                return Err(bad(index, "it belongs to another job than the first part"));
            }
            if !merged.take(part) {
                return Err(bad(
                    index,
                    "it has other values for a pixel that is there already, or not all of its values",
                ));
            }
        }
        Ok(merged)
    }

    /// Adds a part; returns whether it belongs to the job.
    fn take(&mut self, part: &JobResult) -> bool {
        let Ok(tile) = part.tile() else { return false };
        let length = tile.columns.len() * self.components;
        let numbers = tile.rows.len() * length;
        if part.values.len() != numbers || part.standard_errors.len() != numbers {
            return false;
        }
        let parts = part.values.chunks_exact(length).zip(part.standard_errors.chunks_exact(length));
        for (row, (values, errors)) in tile.rows.zip(parts) {
            let pixels = row * self.size[0] + tile.columns.start..row * self.size[0] + tile.columns.end;
            let numbers = pixels.start * self.components..pixels.end * self.components;
            let there =
                self.has_pixel[pixels.clone()].iter().flat_map(|there| std::iter::repeat_n(there, self.components));
            let differs = |((old, new), there): ((&f32, &f32), &bool)| *there && old.to_bits() != new.to_bits();
            if self.values[numbers.clone()].iter().zip(values).zip(there).any(differs) {
                return false;
            }
            self.values[numbers.clone()].copy_from_slice(values);
            self.standard_errors[numbers].copy_from_slice(errors);
            self.has_pixel[pixels].fill(true);
        }
        true
    }

    /// The pixels of missing parts, as rectangles from the top.
    #[must_use]
    pub fn missing(&self) -> Vec<Tile> {
        let columns = self.size[0];
        let mut missing: Vec<Tile> = Vec::new();
        for (row, there) in self.has_pixel.chunks(columns).enumerate() {
            let mut column = 0;
            while let Some(start) = there[column..].iter().position(|there| !there).map(|offset| column + offset) {
                let end = there[start..].iter().position(|there| *there).map_or(columns, |offset| start + offset);
                match missing.iter_mut().find(|tile| tile.rows.end == row && tile.columns == (start..end)) {
                    Some(tile) => tile.rows.end = row + 1,
                    None => missing.push(Tile { columns: start..end, rows: row..row + 1 }),
                }
                column = end;
            }
        }
        missing
    }

    /// Estimated relative error of the existing pixels. For radiances: the root of the mean of
    /// `d²/(v² + (0.01·m)²)` over the bands of all pixels, d the standard error of a value v and m
    /// the mean of its band. For exposures: the rms standard error relative to the mean. `None`
    /// with one sample, without pixels, and for black pictures.
    ///
    /// ```
    /// # use radsight::example::{scene, view};
    /// use radsight::{JobTarget, RenderJob, Renderer};
    /// let job = RenderJob::new(JobTarget::picture(&view(), 8, 8), 2);
    /// let merged = radsight::MergedJob::of(&[Renderer::new(&scene())?.run_job(&job)?])?;
    /// assert!(merged.relative_error().unwrap() < 1.0);
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn relative_error(&self) -> Option<f64> {
        let is_there = |number: &usize| self.has_pixel[number / self.components];
        let known: Vec<usize> = (0..self.values.len()).filter(is_there).collect();
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
            // A band that is black everywhere has no relative error.
            if error == 0.0 { 0.0 } else { (error / unit).powi(2) }
        };
        let sum: f64 = known.iter().map(|number| squared(*number)).sum();
        Some((sum / known.len() as f64).sqrt()).filter(|error| error.is_finite())
    }
}
