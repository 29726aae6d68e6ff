//! Additional outputs of a picture: error map, ray map, run record.

use super::defaults;
use super::options::Options;
use crate::commands::report::ERROR_MAP;
use crate::failure::{Failure, Outcome};
use crate::output::{reserve_output, write_file, write_image_file};
use crate::render_args::number;
use crate::run_record::Stopwatch;
use crate::trust::{Existing, OutputName, Trust};
use radsight_film::{ErrorTarget, Film, SamplingBudget};
use radsight_picture::{Header, Image};
use radsight_render::Renderer;
use radsight_report::{ErrorEstimate, RunRecord};

/// The requested files besides the picture.
#[derive(Debug, Default)]
pub(super) struct Accounts {
    error_map: Option<OutputName>,
    ray_map: Option<OutputName>,
    record: Option<OutputName>,
}

impl Accounts {
    /// Parses one option at the front; returns the number of words it used, 0 for another option.
    pub(super) fn take(&mut self, words: &[String], trust: &Trust) -> Result<usize, Failure> {
        let place = match words[0].as_str() {
            "--error-map" => &mut self.error_map,
            "--ray-map" => &mut self.ray_map,
            "--record" => &mut self.record,
            _ => return Ok(0),
        };
        let file: String = number(words, &words[0], "a file")?;
        *place = Some(trust.output(&file, Existing::Kept)?);
        Ok(2)
    }

    fn is_empty(&self) -> bool {
        self.error_map.is_none() && self.ray_map.is_none() && self.record.is_none()
    }

    /// Checks what can be checked before the scene is read.
    pub(super) fn check(&self, options: &Options) -> Outcome {
        if self.is_empty() {
            return Ok(());
        }
        let wrong = |message: &str| Err(Failure::usage(format!("rpict: {message}")));
        if options.first_frame > 0 {
            return wrong("--error-map, --ray-map and --record are for single pictures, not for sequences (-S)");
        }
        if options.recover.is_some() {
            return wrong("--error-map, --ray-map and --record cannot be combined with recovered rows (-r, -ro)");
        }
        match options.pixels {
            SamplingBudget::Error(_) => {}
            _ if self.error_map.is_some() => return wrong("--error-map needs --error"),
            SamplingBudget::Interpolated(_) if self.ray_map.is_some() => {
                return wrong("--ray-map needs --error or --samples");
            }
            _ => {}
        }
        let files = [&self.error_map, &self.ray_map, &self.record];
        files.into_iter().flatten().filter(|name| ***name != *"-").try_for_each(|name| reserve_output(name).map(drop))
    }

    /// Writes the reports of a finished picture.
    pub(super) fn write(
        &self,
        options: &Options,
        header: &Header,
        renderer: &Renderer,
        film: &Film<'_>,
        stopwatch: &mut Stopwatch,
    ) -> Outcome {
        if self.is_empty() {
            return Ok(());
        }
        let columns = film.columns();
        let write_map = |path: &str, header: &Header, values: Vec<f32>| {
            let image = Image::new(columns, values.len() / columns, 1, values);
            write_image_file(path, header, &image.map_err(|error| Failure::fault(error.to_string()))?)
        };
        if let (Some(path), Some(errors)) = (&self.error_map, film.relative_errors()) {
            let mut header = header.history();
            header.push_variable(ERROR_MAP, " relative");
            write_map(path, &header, errors)?;
        }
        if let (Some(path), Some(samples)) = (&self.ray_map, film.samples()) {
            write_map(path, &header.history(), samples.into_iter().map(|samples| samples as f32).collect())?;
        }
        match &self.record {
            Some(path) => {
                stopwatch.lap("pixels traced and written");
                write_file(path, record(options, renderer, film, stopwatch).to_json().as_bytes())
            }
            None => Ok(()),
        }
    }
}

fn record(options: &Options, renderer: &Renderer, film: &Film<'_>, stopwatch: &Stopwatch) -> RunRecord {
    let mut record = stopwatch.record(renderer.plan(), &options.command);
    record.command.extend(options.scenes.iter().cloned());
    let asked = match options.sampling_budget {
        Some(SamplingBudget::Error(ErrorTarget { error, .. })) => Some(error),
        _ => None,
    };
    record.error = film.estimate().map(|estimate| ErrorEstimate {
        asked,
        reached: estimate.error,
        uncertainty: Some(estimate.uncertainty),
    });
    record.rays = film.samples().map(|samples| samples.into_iter().map(u64::from).sum());
    record.cache_noise = renderer.irradiance_noise();
    // In the form of -defaults: the words of an option, and its description behind #.
    for line in defaults::text(options).lines() {
        let (words, what) = line.split_once('#').unwrap_or((line, ""));
        record.push_setting(words.trim(), what.trim());
    }
    record
}
