//! Textures, patterns and mixtures.

use super::functions::{CallForm, RootWord};
use super::materials::Lowered;
use super::modifiers::{Raw, Reference};
use super::reader::Reader;
use crate::Kind;
use radsight_diag::Diagnostic;
use radsight_ir::{
    Axis, DataGrid, GridCall, Handle, Mixture, MixtureAmount, MixtureArms, ModifierHandle, Pattern, PictureCall,
    Spectrum, Texture,
};

impl Reader<'_> {
    pub(super) fn texture(&mut self, raw: &Raw) -> Option<Texture> {
        match raw.kind {
            Kind::TexFunc => self.expressions(raw, 3).map(Texture::Function),
            Kind::TexData => {
                let functions = [0, 1, 2].map(|index| RootWord::Function(index, 3));
                self.grid_call(raw, &functions, &[3, 4, 5], 0).map(Texture::Data)
            }
            _ => self.not_yet(raw),
        }
    }

    pub(super) fn pattern(&mut self, raw: &Raw) -> Option<Pattern> {
        Some(match raw.kind {
            Kind::BrightFunc => Pattern::BrightFunction(self.expressions(raw, 1)?),
            Kind::ColorFunc => Pattern::ColorFunction(self.expressions(raw, 3)?),
            Kind::BrightData => Pattern::BrightData(self.grid_call(raw, &[RootWord::Function(0, 1)], &[1], 0)?),
            Kind::ColorData => {
                let functions = [0, 1, 2].map(|band| RootWord::Band(band, band));
                Pattern::ColorData(self.grid_call(raw, &functions, &[3, 4, 5], 0)?)
            }
            Kind::ColorPict => {
                let functions = [0, 1, 2].map(|band| RootWord::Band(band, band));
                Pattern::ColorPicture(self.picture_call(raw, &functions, 3)?)
            }
            Kind::SpecPict => {
                let grid = self.spectral_picture(&raw.strings[1])?;
                let roots = [RootWord::Function(0, 2), RootWord::Expression(4), RootWord::Expression(3)];
                let call = self.call(raw, &CallForm { file: 2, roots: &roots })?;
                Pattern::SpectrumPicture(GridCall { call, grids: vec![grid] })
            }
            Kind::Spectrum => Pattern::Spectrum(spectrum([raw.reals[0], raw.reals[1]], raw.reals[2..].to_vec())),
            Kind::SpecFile => {
                let grid = self.grid(&raw.strings[0])?;
                self.spectrum_file(raw, grid)?
            }
            Kind::SpecFunc => Pattern::SpectrumFunction {
                call: self.call(raw, &CallForm { file: 1, roots: &[RootWord::Function(0, 1)] })?,
                range_nm: [raw.reals[0].min(raw.reals[1]), raw.reals[0].max(raw.reals[1])],
            },
            Kind::SpecData => Pattern::SpectrumData(self.grid_call(raw, &[RootWord::Function(0, 2)], &[1], 1)?),
            Kind::BrightText | Kind::ColorText => Pattern::Text(self.text(raw)?),
            _ => return self.not_yet(raw),
        })
    }

    pub(super) fn mixture(&mut self, raw: &Raw, at: &Lowered<'_>) -> Option<Mixture> {
        let amount = match raw.kind {
            Kind::MixFunc => {
                let form = CallForm { file: 3, roots: &[RootWord::Expression(2)] };
                MixtureAmount::Function(self.call(raw, &form)?)
            }
            Kind::MixPict => MixtureAmount::Picture(self.picture_call(raw, &[RootWord::Function(2, 3)], 3)?),
            Kind::MixData => MixtureAmount::Data(self.grid_call(raw, &[RootWord::Function(2, 1)], &[3], 0)?),
            Kind::MixText => MixtureAmount::Text(self.text(raw)?),
            _ => return self.not_yet(raw),
        };
        let arm = |index: usize| -> Option<ModifierHandle> {
            match raw.references.get(index) {
                Some(Reference::To(handle)) => at(*handle),
                _ => None,
            }
        };
        Some(Mixture { arms: MixtureArms { foreground: arm(0), background: arm(1) }, amount })
    }

    /// A call with functions of values, data files, a function file, and one coordinate for each
    /// axis but the last `hidden` ones.
    fn grid_call(&mut self, raw: &Raw, functions: &[RootWord], files: &[usize], hidden: usize) -> Option<GridCall> {
        let mut grids: Vec<Handle<DataGrid>> = Vec::with_capacity(files.len());
        for &file in files {
            grids.push(self.grid(&raw.strings[file])?);
        }
        let dimensions = self.scene.grids[grids[0]].axes.len();
        for (grid, &file) in grids.iter().zip(files) {
            let found = self.scene.grids[*grid].axes.len();
            if found != dimensions || found <= hidden {
                let expected = if found <= hidden { hidden + 1 } else { dimensions };
                let message = format!("\"{}\" has {found} dimensions, expected {expected}", raw.strings[file].text);
                self.log.push(Diagnostic::error(message).at(raw.strings[file].span));
                return None;
            }
        }
        let function_file = files.last().copied().unwrap_or(0) + 1;
        let coordinates = (0..dimensions - hidden).map(|axis| RootWord::Expression(function_file + 1 + axis));
        let roots: Vec<RootWord> = functions.iter().copied().chain(coordinates).collect();
        let call = self.call(raw, &CallForm { file: function_file, roots: &roots })?;
        Some(GridCall { call, grids })
    }

    /// A call with functions of a colour, a picture, a function file, and the coordinates u and v.
    fn picture_call(&mut self, raw: &Raw, functions: &[RootWord], file: usize) -> Option<PictureCall> {
        let picture = self.picture(&raw.strings[file])?;
        let coordinates = [RootWord::Expression(file + 2), RootWord::Expression(file + 3)];
        let roots: Vec<RootWord> = functions.iter().copied().chain(coordinates).collect();
        let call = self.call(raw, &CallForm { file: file + 1, roots: &roots })?;
        Some(PictureCall { call, picture })
    }

    fn spectrum_file(&mut self, raw: &Raw, grid: Handle<DataGrid>) -> Option<Pattern> {
        let DataGrid { axes, values, file } = &self.scene.grids[grid];
        let [axis] = &axes[..] else {
            let message = format!("\"{file}\" has {} dimensions, expected 1", axes.len());
            self.log.push(Diagnostic::error(message).at(raw.strings[0].span));
            return None;
        };
        let values: Vec<f64> = values.iter().map(|value| f64::from(*value)).collect();
        Some(Pattern::Spectrum(match axis {
            Axis::Regular { first, last, .. } => spectrum([*first, *last], values),
            Axis::Irregular(points) => resampled(points, &values),
        }))
    }
}

/// Samples at equal steps between two wavelengths, nm. Each sample represents the step around it.
fn spectrum([first, last]: [f64; 2], values: Vec<f64>) -> Spectrum {
    let half_step = 0.5 * (last - first) / (values.len() as f64 - 1.0);
    Spectrum { range_nm: [first - half_step, last + half_step], values }
}

/// Resamples a spectrum with irregular wavelengths at twice as many equal steps, by linear
/// interpolation.
fn resampled(points: &[f64], values: &[f64]) -> Spectrum {
    let (first, last) = (points[0], points[points.len() - 1]);
    let count = 2 * points.len();
    let sample = |index: usize| {
        let at = first + (last - first) * index as f64 / (count as f64 - 1.0);
        let is_past = |point: f64| if last > first { point >= at } else { point <= at };
        let right = points.iter().position(|point| is_past(*point)).unwrap_or(points.len() - 1).max(1);
        let share = (at - points[right - 1]) / (points[right] - points[right - 1]);
        values[right - 1] + (values[right] - values[right - 1]) * share.clamp(0.0, 1.0)
    };
    spectrum([first, last], (0..count).map(sample).collect())
}
