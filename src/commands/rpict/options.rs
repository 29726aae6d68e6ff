//! The options of `rpict`, in Radiance's syntax.

use super::accounts::Accounts;
use super::defaults;
use crate::args::Reading;
use crate::commands::features;
use crate::control_file;
use crate::expand::{CommandWords, TakesOptions, options_before_scenes};
use crate::expected_rays;
use crate::failure::Failure;
use crate::option_table::options_of;
use crate::output_color::OutputColor;
use crate::output_format::OutputFormat;
use crate::render_args::{number, take_definition, take_highlight_samples, take_irradiance, take_one, take_own};
use crate::sampling_args;
use crate::switch::switched;
use crate::trust::{Existing, OutputName, Trust};
use crate::view_args::{self, ViewOrigin};
use radsight::{ErrorBudget, ErrorTarget, Interpolation, SamplingBudget};
use radsight_options::Settings;
use radsight_picture::ViewOptions;
use radsight_pinhole::stream::NumberFormat;
use radsight_render::RenderOptions;

/// Parses one option at the front; returns the number of words it used, 0 for another option.
type Taker = fn(&mut Options, &[String]) -> Result<usize, Failure>;

/// The parsed options.
#[derive(Debug)]
pub(super) struct Options {
    pub(super) render: RenderOptions,
    pub(super) reading: Reading,
    pub(super) view: ViewOptions,
    pub(super) view_origin: ViewOrigin,
    /// Largest number of columns and rows.
    pub(super) size: [usize; 2],
    /// The components of pixels. Primaries other than Radiance's are those of the scene's colours.
    pub(super) color: OutputColor,
    /// Four-byte pixels, or numbers.
    pub(super) format: OutputFormat,
    /// Pixel aspect, height divided by width; 0 to fill the size.
    pub(super) pixel_aspect: f64,
    /// `-pj`, if given.
    pixel_jitter: Option<f64>,
    pub(super) motion: f64,
    pub(super) aperture: f64,
    /// Spacing of the first samples, pixels (`-ps`).
    pub(super) sample_spacing: f64,
    /// The contrast below which pixels are interpolated (`-pt`).
    pub(super) contrast: f64,
    /// The requested sampling budget, if given.
    pub(super) sampling_budget: Option<SamplingBudget>,
    /// The part of it that is left to the pixels.
    pub(super) pixels: SamplingBudget,
    /// Seconds after which the refinement to a requested error stops, if given.
    pub(super) time_limit: Option<f64>,
    pub(super) threads: Option<usize>,
    /// Seconds between progress reports; 0 for none.
    pub(super) report: u64,
    /// The number of the first frame of a sequence; 0 for a single picture.
    pub(super) first_frame: i64,
    pub(super) output: Option<OutputName>,
    pub(super) depths: Option<OutputName>,
    pub(super) recover: Option<String>,
    pub(super) error_file: Option<OutputName>,
    control_file: Option<OutputName>,
    pub(super) accounts: Accounts,
    pub(super) scenes: Vec<String>,
    /// The words up to the scenes, for the picture's header.
    pub(super) command: Vec<String>,
    /// The options listed by `-defaults`.
    pub(super) settings: Settings,
}

/// Radiance's default of `-ds` for pictures.
const SOURCE_SAMPLING: f64 = 0.25;

impl Default for Options {
    fn default() -> Self {
        Options {
            render: RenderOptions { source_sampling: SOURCE_SAMPLING, ..radsight::Renderer::picture_options() },
            reading: Reading::default(),
            view: ViewOptions::default(),
            view_origin: ViewOrigin::default(),
            size: [512, 512],
            color: OutputColor::Rgb,
            format: OutputFormat::Pixels,
            pixel_aspect: 1.0,
            pixel_jitter: None,
            motion: 0.0,
            aperture: 0.0,
            sample_spacing: 4.0,
            contrast: 0.05,
            sampling_budget: None,
            pixels: SamplingBudget::Samples(1),
            time_limit: None,
            threads: None,
            report: 0,
            first_frame: 0,
            output: None,
            depths: None,
            recover: None,
            error_file: None,
            control_file: None,
            accounts: Accounts::default(),
            scenes: Vec::new(),
            command: Vec::new(),
            settings: Settings::new(options_of("rpict")),
        }
    }
}

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
    /// The recovered frame of a sequence (`-r` with a number).
    pub(super) fn recovered_frame(&self) -> Option<i64> {
        self.recover.as_ref().and_then(|name| name.parse().ok())
    }

    /// Parses the words, of which the first is the program's name. A control file stores them, or
    /// replaces them by stored ones.
    pub(super) fn parse(words: &[String], trust: &Trust) -> Result<Options, Failure> {
        let mut options = Options::parse_once(words, trust.clone())?;
        if let Some(file) = &options.control_file
            && let Some(kept) = control_file::keep_or_recall(file, words, &options.scenes)?
        {
            options = Options::parse_once(&kept, options.reading.trust.for_file())?;
        }
        options.pixels = options.budget().apply(&mut options.render);
        if !matches!(options.pixels, SamplingBudget::Interpolated(_)) {
            options.render.highlight_samples = 1.0;
        }
        options.render.camera_rays = options.expected_rays();
        if options.recover.is_some() && options.format != OutputFormat::Pixels {
            return Err(Failure::usage("rpict: -ff cannot continue a picture (-r, -ro)"));
        }
        if options.time_limit.is_some() && !matches!(options.pixels, SamplingBudget::Error(_)) {
            return Err(Failure::usage("rpict: --time-limit needs --error"));
        }
        options.accounts.check(&options)?;
        if options.scenes.is_empty() {
            options.scenes.push("-".to_owned());
        }
        Ok(options)
    }

    fn parse_once(words: &[String], trust: Trust) -> Result<Options, Failure> {
        let mut options = Options::default();
        let words = CommandWords::new(words, trust.origin());
        options.reading.trust = trust;
        (options.command, options.scenes) = options_before_scenes(words, &mut options)?;
        Ok(options)
    }

    /// Expected number of camera rays of a picture.
    fn expected_rays(&self) -> f64 {
        let pixels = (self.size[0] as u64).saturating_mul(self.size[1] as u64);
        match self.pixels {
            SamplingBudget::Samples(samples) => pixels as f64 * f64::from(samples),
            SamplingBudget::Error(ErrorTarget { error, .. }) => expected_rays::to_error(pixels, error),
            SamplingBudget::Interpolated(_) => pixels as f64,
        }
    }

    /// The requested quality: from `--error` or `--samples`, or else from Radiance's options.
    fn budget(&self) -> ErrorBudget {
        let preview = Interpolation { spacing: self.sample_spacing, contrast: self.contrast };
        self.sampling_budget.map_or(ErrorBudget::preview(preview), ErrorBudget::of)
    }

    /// Side of the square in a pixel over which its rays are jittered, pixels.
    pub(super) fn jitter(&self) -> f64 {
        self.pixel_jitter.unwrap_or(self.budget().pixel_jitter())
    }

    /// The side in pixels of the squares that get one ray of the cache's pre-pass.
    pub(super) fn prepass_spacing(&self) -> usize {
        self.budget().prepass_spacing(&self.render.gathering)
    }

    /// Parses one option; returns the number of words it used.
    fn take_option(&mut self, words: &[String]) -> Result<usize, Failure> {
        const TAKERS: [Taker; 10] = [
            |options, words| take_highlight_samples(words, &mut options.render),
            |options, words| take_one(words, &mut options.render),
            |options, words| view_args::take_one(words, &mut options.view, &mut options.view_origin),
            |options, words| take_own(words, &mut options.reading, &mut options.render),
            |options, words| sampling_args::take_one(words, ErrorBudget::MOST_SAMPLES, &mut options.sampling_budget),
            |options, words| Ok(take_irradiance(words, &mut options.render)),
            |options, words| take_definition(words, &mut options.reading),
            Options::take_sampling,
            Options::take_file,
            |options, words| options.accounts.take(words, &options.reading.trust),
        ];
        for taker in TAKERS {
            let used = taker(self, words)?;
            if used > 0 {
                return Ok(used);
            }
        }
        let word = words[0].as_str();
        match word {
            "-x" => self.size[0] = number(words, word, "a number of columns")?,
            "-y" => self.size[1] = number(words, word, "a number of rows")?,
            "-t" => self.report = number(words, word, "a number of seconds")?,
            "--time-limit" => self.time_limit = Some(positive(words, "seconds, 0 or more")?),
            "-n" | "--threads" => self.threads = Some(number(words, word, "a number of threads")?),
            _ if control_file::is_option(word) => {
                let file: String = number(words, word, "a control file")?;
                self.control_file = Some(self.reading.trust.output(&file, Existing::Kept)?);
            }
            "-S" => self.first_frame = number(words, word, "the number of a frame")?,
            "-defaults" | "-help" => return Err(Failure::answer(defaults::text(self))),
            "-version" => return Err(features::version()),
            "-pRGB" | "-pXYZ" | "-pc" => {
                let (color, used) = OutputColor::from_option(words)?.unwrap_or((OutputColor::Rgb, 1));
                self.color = color;
                return Ok(used);
            }
            "-co" | "-co+" | "-co1" => {
                return Err(Failure::usage(format!(
                    "rpict: option \"{word}\" is not supported, as in Radiance: spectral pictures come from vwrays and rtrace -co -fac"
                )));
            }
            "-co-" | "-co0" => return Ok(1),
            "-ff" => {
                self.format = OutputFormat::Numbers(NumberFormat::Float);
                return Ok(1);
            }
            _ => {
                if let Some(shown) = switched(word, "-w", !self.reading.no_warnings) {
                    self.reading.no_warnings = !shown;
                    return Ok(1);
                }
                return Ok(0);
            }
        }
        Ok(2)
    }

    /// Parses options about pixels and their rays.
    fn take_sampling(&mut self, words: &[String]) -> Result<usize, Failure> {
        let word = words[0].as_str();
        match word {
            "-pa" => self.pixel_aspect = number(words, word, "the height over the width of a pixel")?,
            "-pj" => self.pixel_jitter = Some(share(words, "a share of a pixel from 0 to 1")?),
            "-pm" => self.motion = share(words, "a share of the time between frames from 0 to 1")?,
            "-pd" => self.aperture = positive(words, "the diameter of the aperture, 0 or more")?,
            "-ps" => self.sample_spacing = positive(words, "the pixels between samples")?,
            "-pt" => self.contrast = positive(words, "a contrast, 0 or more")?,
            _ => return Ok(0),
        }
        Ok(2)
    }

    fn take_file(&mut self, words: &[String]) -> Result<usize, Failure> {
        let word = words[0].as_str();
        let file = || number::<String>(words, word, "a file");
        let output = |existing| self.reading.trust.output(&file()?, existing);
        match word {
            // Pictures are never overwritten, so a pattern of names is allowed.
            "-o" => self.output = Some(self.reading.trust.new_output(&file()?)?),
            "-z" => self.depths = Some(output(Existing::Kept)?),
            "-e" => self.error_file = Some(output(Existing::Messages)?),
            "-r" => self.recover = Some(file()?),
            "-ro" => {
                let file = output(Existing::Kept)?;
                self.recover = Some(file.to_string());
                self.output = Some(file);
            }
            _ => return Ok(0),
        }
        Ok(2)
    }
}

fn share(words: &[String], expected: &str) -> Result<f64, Failure> {
    let value: f64 = number(words, &words[0], expected)?;
    if (0.0..=1.0).contains(&value) {
        return Ok(value);
    }
    Err(Failure::usage(format!("option \"{}\" is {value}, expected {expected}", words[0])))
}

fn positive(words: &[String], expected: &str) -> Result<f64, Failure> {
    let value: f64 = number(words, &words[0], expected)?;
    if value >= 0.0 && value.is_finite() {
        return Ok(value);
    }
    Err(Failure::usage(format!("option \"{}\" is {value}, expected {expected}", words[0])))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(words: &str) -> Options {
        let words: Vec<String> = words.split_whitespace().map(str::to_owned).collect();
        let Ok(options) = Trust::of_process(words.clone()).and_then(|(trust, words)| Options::parse(&words, &trust))
        else {
            panic!("{words:?} are options")
        };
        options
    }

    #[test]
    fn pictures_are_interpolated_as_radiances_options_say_unless_rays_are_asked_for() {
        for (words, spacing, contrast) in
            [("rpict a.oct", 4.0, 0.05), ("rpict -ps 1 -pt 0 a.oct", 1.0, 0.0), ("rpict -ps 8 -pt .2 a.oct", 8.0, 0.2)]
        {
            let expected = SamplingBudget::Interpolated(Interpolation { spacing, contrast });
            assert_eq!(parsed(words).pixels, expected, "{words}");
        }
        assert_eq!(parsed("rpict --samples 9 -ps 8 a.oct").pixels, SamplingBudget::Samples(9));
        assert!(matches!(parsed("rpict -ps 8 --error .1 a.oct").pixels, SamplingBudget::Error(_)));
    }

    #[test]
    fn whole_pixels_are_averaged_where_rays_are_asked_for() {
        for (words, expected) in [
            ("rpict a.oct", 0.67),
            ("rpict --error .1 a.oct", 1.0),
            ("rpict --samples 4 a.oct", 1.0),
            ("rpict -pj .5 --error .1 a.oct", 0.5),
        ] {
            assert_eq!(parsed(words).jitter(), expected, "{words}");
        }
    }

    #[test]
    fn small_errors_gather_more_rays_where_these_are_cached() {
        for (words, expected) in [
            ("rpict -ad 100 a.oct", 100),
            ("rpict -ad 100 --error .05 a.oct", 100),
            ("rpict -ad 100 --error .01 a.oct", 400),
            ("rpict -ad 100 --error .0001 a.oct", 1600),
            ("rpict -ad 1 -aa 0 --error .01 a.oct", 1),
            ("rpict -ad 100 -aa 0 --error .01 a.oct", 100),
        ] {
            assert_eq!(parsed(words).render.gathering.divisions, expected, "{words}");
        }
    }
}
