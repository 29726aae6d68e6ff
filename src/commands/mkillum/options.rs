//! The options of `mkillum`: rendering options and files.

use super::parameters::{Becomes, Colors, Parameters};
use crate::args::Reading;
use crate::expand::{CommandWords, TakesOptions, options_before_scenes};
use crate::failure::Failure;
use crate::listed_options::seed_line;
use crate::option_table::options_of;
use crate::render_args::{number, take_definition, take_irradiance, take_one, take_own};
use crate::sampling_args;
use crate::trust::Trust;
use radsight_film::SamplingBudget;
use radsight_options::{ProgramOption, Settings};
use radsight_render::{Gathering, PathLimit, RenderOptions};

/// The parsed options.
#[derive(Debug)]
pub(super) struct Options {
    pub(super) render: RenderOptions,
    sampling_budget: Option<SamplingBudget>,
    pub(super) threads: Option<usize>,
    pub(super) reading: Reading,
    pub(super) scenes: Vec<String>,
    /// The files with surfaces; `-` for standard input.
    pub(super) inputs: Vec<String>,
    /// The words up to the inputs, for the header.
    pub(super) command: Vec<String>,
    /// The options listed by `-defaults`.
    settings: Settings,
}

/// Default number of paths per ray: hemisphere samples cause about as much noise in each direction
/// of a window.
const USUAL_PATHS: u32 = 8;

/// Largest number of paths per ray for a requested error.
const MOST_PATHS: u32 = 4096;

impl TakesOptions for Options {
    fn trust(&mut self) -> &mut Trust {
        &mut self.reading.trust
    }

    fn settings(&mut self) -> &mut Settings {
        &mut self.settings
    }

    fn take(&mut self, words: &[String]) -> Result<usize, Failure> {
        self.take_option(words)
    }
}

impl Options {
    /// Parses the words, of which the first is the program's name.
    pub(super) fn parse(words: &[String], trust: &Trust) -> Result<Options, Failure> {
        // Radiance's defaults, but without a cache: thousands of rays of a window are averaged.
        let gathering = Gathering { accuracy: 0.0, divisions: 1024, super_samples: 512, ..Gathering::default() };
        let render = RenderOptions {
            gathering,
            ambient_bounces: 2,
            mirror_sources: 3,
            highlight_threshold: 0.15,
            least_weight: 1e-4,
            path_limit: PathLimit::RouletteUpTo(10),
            ..RenderOptions::default()
        };
        let mut options = Options {
            render,
            sampling_budget: None,
            threads: None,
            reading: Reading::trusted(trust),
            scenes: Vec::new(),
            inputs: Vec::new(),
            command: Vec::new(),
            settings: Settings::new(options_of("mkillum")),
        };
        (options.command, options.scenes) =
            options_before_scenes(CommandWords::new(words, trust.origin()), &mut options)?;
        if let Some(place) = options.scenes.iter().position(|word| word == "<") {
            options.inputs = options.scenes.split_off(place + 1);
            options.scenes.pop();
            if options.inputs.is_empty() {
                return Err(Failure::usage("mkillum: no file is given after \"<\", expected files with surfaces"));
            }
        } else {
            options.inputs.push("-".to_owned());
        }
        if options.scenes.is_empty() {
            return Err(Failure::usage("mkillum: no scene is given, expected an octree or scene files"));
        }
        if options.scenes.iter().chain(&options.inputs).filter(|file| *file == "-").count() > 1 {
            return Err(Failure::usage(
                "mkillum: the scene and the surfaces are both standard input, expected files for one of them after \"<\"",
            ));
        }
        options.command.extend(options.scenes.iter().cloned());
        options.render.gathering.accuracy = 0.0;
        Ok(options)
    }

    /// Parses one option; returns the number of words it used.
    fn take_option(&mut self, words: &[String]) -> Result<usize, Failure> {
        let mut used = take_one(words, &mut self.render)?;
        if used == 0 {
            used = take_own(words, &mut self.reading, &mut self.render)?;
        }
        if used == 0 {
            used = take_definition(words, &mut self.reading)?;
        }
        if used == 0 {
            // Irradiance of surfaces is not radiance of windows, so it is ignored, as in Radiance.
            used = take_irradiance(words, &mut RenderOptions::default());
        }
        if used == 0 {
            used = sampling_args::take_one(words, MOST_PATHS, &mut self.sampling_budget)?;
        }
        if used > 0 {
            return Ok(used);
        }
        let word = words[0].as_str();
        match word {
            "-w" => self.reading.no_warnings = true,
            "-defaults" => return Err(Failure::answer(self.defaults())),
            "-n" => {
                self.threads = Some(number(words, word, "a number of threads")?);
                return Ok(2);
            }
            _ => return Ok(0),
        }
        Ok(1)
    }

    /// The number of paths per ray.
    pub(super) fn sampling_budget(&self) -> SamplingBudget {
        let paths = if self.render.ambient_bounces > 0 { USUAL_PATHS } else { 1 };
        self.sampling_budget.unwrap_or(SamplingBudget::Samples(paths))
    }

    /// The listing of `-defaults`.
    fn defaults(&self) -> String {
        let parameters = Parameters::default();
        let colors = match parameters.colors {
            Colors::Nothing => "c=n\t\t\t\t# color none",
            Colors::Mean => "c=a\t\t\t\t# color average",
            Colors::Spread => "c=d\t\t\t\t# color distribution",
        };
        let becomes = match parameters.becomes {
            Becomes::Illum => "l-\t\t\t\t# light type off",
            Becomes::Light => "l+\t\t\t\t# light type on",
        };
        let mut lines = vec![
            format!("m={:<15}\t\t# material name", parameters.material),
            format!("f={:<15}\t\t# data file name", parameters.data_file),
            colors.to_owned(),
            becomes.to_owned(),
            format!("d={}\t\t\t\t# density of directions", parameters.density),
            format!("s={}\t\t\t\t# samples per direction", parameters.samples),
            format!("b={:.6}\t\t\t# minimum average brightness", parameters.least_brightness),
        ];
        let computed = |option: &ProgramOption| (option.name == "--seed").then(|| seed_line(self.render.seed));
        lines.extend(self.settings.lines(&computed));
        lines.join("\n") + "\n"
    }
}
