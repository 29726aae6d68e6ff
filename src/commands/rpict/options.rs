//! The options of `rpict`, as Radiance writes them.

use super::defaults;
use crate::args::Reading;
use crate::commands::features;
use crate::control_file;
use crate::effort_args;
use crate::expand::{CommandWords, TakesOptions, options_before_scenes};
use crate::failure::Failure;
use crate::output_color::OutputColor;
use crate::output_format::OutputFormat;
use crate::render_args::{number, take_definition, take_irradiance, take_one, take_own};
use crate::shown_options::{Program, ShownOptions};
use crate::switch::switched;
use crate::trust::{Existing, OutputName, Trust};
use crate::view_args;
use radsight_film::{MAX_SAMPLES, SamplingBudget};
use radsight_picture::ViewOptions;
use radsight_pinhole::stream::NumberFormat;
use radsight_render::{Gathering, RenderOptions, Uncached};

/// Rays that no pixel exceeds for an asked error, from this error on; for less error so many more as that takes.
const MOST_SAMPLES: u32 = 1024;
const COARSE_ERROR: f64 = 0.02;

/// The same when nothing is said.
const USUAL_SAMPLES: u32 = 128;

/// The error that is asked for when nothing is said: of pictures for which Radiance samples many of the pixels, of those with the fewest, and how it grows
/// with the root of the spacing between.
const LEAST_ERROR: f64 = 0.03;
const LARGEST_ERROR: f64 = 0.05;
const ERROR_OF_SPACING: f64 = 0.015;

/// What of an error goes to the noise and the reach of shared irradiance, and to pixels; values that reach no farther than this are good enough for
/// any error. When nothing is said the noise is less: a picture is then looked at, and blotches are seen more than grain.
const NOISE_SHARE: f64 = 1.5;
const USUAL_NOISE_SHARE: f64 = 0.7;
const REACH_SHARE: f64 = 0.5;
const NEAR_ENOUGH: f64 = 0.1;
const PIXEL_SHARE: f64 = 0.8;

/// Where an error is asked for, the whole picture's counts, not what is seen in its corners.
const EVENNESS: f64 = 0.1;

/// For errors below the coarse one places look around along more rays, in proportion to what noise needs: many places with few rays each come to no less noise,
/// for more time.
const MOST_THOROUGH: f64 = 16.0;

/// Caustics are shared where records disagree by less than so many times the noise; elsewhere pixels have as many rays as the asked error needs.
const CAUSTIC_BEND: f64 = 2.0;

/// The share of pixels when nothing is said, by the spacing of Radiance's samples: what it interpolates between them is less exact than that.
fn usual_pixel_share(spacing: f64) -> f64 {
    (0.75 * spacing.sqrt()).clamp(1.0, 1.5)
}

/// Takes one option from the front; gives how many words it used, 0 for something else.
type Taker = fn(&mut Options, &[String]) -> Result<usize, Failure>;

/// What is asked.
#[derive(Debug)]
pub(super) struct Options {
    pub(super) render: RenderOptions,
    pub(super) reading: Reading,
    pub(super) view: ViewOptions,
    /// Most columns and rows.
    pub(super) size: [usize; 2],
    /// The components of pixels. Other primaries than Radiance's are those in which the scene's colours are meant.
    pub(super) color: OutputColor,
    /// Pixels of four bytes, or numbers as they are.
    pub(super) format: OutputFormat,
    /// Height over width of a pixel; 0 for whatever fills the size.
    pub(super) pixel_aspect: f64,
    pub(super) pixel_jitter: f64,
    pub(super) motion: f64,
    pub(super) aperture: f64,
    /// Pixels between Radiance's samples. Here every pixel has its own: this tells only how good the picture shall be.
    pub(super) sample_spacing: f64,
    /// How many rays a pixel gets, where that is said.
    pub(super) effort: Option<SamplingBudget>,
    pub(super) threads: Option<usize>,
    /// Seconds between reports of progress; 0 for none.
    pub(super) report: u64,
    /// The number of the first frame of a sequence; 0 for a single picture.
    pub(super) first_frame: i64,
    pub(super) output: Option<OutputName>,
    pub(super) depths: Option<OutputName>,
    pub(super) recover: Option<String>,
    pub(super) error_file: Option<OutputName>,
    control_file: Option<OutputName>,
    pub(super) scenes: Vec<String>,
    /// The words up to the scenes, as the picture's header has them.
    pub(super) command: Vec<String>,
    /// What `-defaults` shows.
    pub(super) shown: ShownOptions,
}

impl Default for Options {
    fn default() -> Self {
        // Radiance's defaults for pictures.
        let gathering = Gathering {
            accuracy: 0.2,
            resolution: 64,
            divisions: 512,
            super_samples: 128,
            uncached: Uncached::DrawOne,
            ..Gathering::default()
        };
        Options {
            render: RenderOptions {
                mirror_sources: 1,
                gathering,
                highlight_threshold: 0.15,
                ..RenderOptions::default()
            },
            reading: Reading::default(),
            view: ViewOptions::default(),
            size: [512, 512],
            color: OutputColor::Rgb,
            format: OutputFormat::Pixels,
            pixel_aspect: 1.0,
            pixel_jitter: 0.67,
            motion: 0.0,
            aperture: 0.0,
            sample_spacing: 4.0,
            effort: None,
            threads: None,
            report: 0,
            first_frame: 0,
            output: None,
            depths: None,
            recover: None,
            error_file: None,
            control_file: None,
            scenes: Vec::new(),
            command: Vec::new(),
            shown: ShownOptions::new(Program::Rpict),
        }
    }
}

impl TakesOptions for Options {
    fn trust(&mut self) -> &mut Trust {
        &mut self.reading.trust
    }

    fn take(&mut self, words: &[String]) -> Result<usize, Failure> {
        self.shown.note(words);
        self.take_option(words)
    }
}

impl Options {
    /// The frame of a sequence that is recovered (`-r` with a number).
    pub(super) fn recovered_frame(&self) -> Option<i64> {
        self.recover.as_ref().and_then(|name| name.parse().ok())
    }

    /// Reads the words, of which the first is the program's name. Where they name a control file, it keeps them, or says what they were before.
    pub(super) fn parse(words: &[String], trust: &Trust) -> Result<Options, Failure> {
        let mut options = Options::parse_once(words, trust.clone())?;
        if let Some(file) = &options.control_file
            && let Some(kept) = control_file::keep_or_recall(file, words, &options.scenes)?
        {
            options = Options::parse_once(&kept, options.reading.trust.for_file())?;
        }
        options.share_error();
        if options.recover.is_some() && options.format != OutputFormat::Pixels {
            return Err(Failure::usage("rpict: -ff begins a picture anew, it does not continue one (-r, -ro)"));
        }
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

    /// What is spent on the picture.
    pub(super) fn effort(&self) -> SamplingBudget {
        let usual = (ERROR_OF_SPACING * self.sample_spacing.sqrt()).clamp(LEAST_ERROR, LARGEST_ERROR);
        self.effort.unwrap_or(SamplingBudget::Error { error: usual, most: USUAL_SAMPLES })
    }

    /// Gives shared irradiance its part of the error that is asked for. A value's noise may be more than the error, since a pixel sees several values;
    /// what bends them away from the truth grows as the square of the distance that they reach.
    fn share_error(&mut self) {
        if let SamplingBudget::Error { error, .. } = self.effort() {
            let gathering = &mut self.render.gathering;
            if self.effort.is_some() {
                gathering.noise = NOISE_SHARE * error;
                gathering.evenness = EVENNESS;
                if gathering.accuracy > 0.0 && gathering.divisions > 1 {
                    let thoroughness = (COARSE_ERROR / error).powi(2).clamp(1.0, MOST_THOROUGH);
                    gathering.divisions = (f64::from(gathering.divisions) * thoroughness) as u32;
                }
                gathering.caustic_error = (CAUSTIC_BEND * gathering.noise).min(Gathering::MAX_INTERPOLATION_ERROR);
            } else {
                gathering.noise = USUAL_NOISE_SHARE * error;
            }
            gathering.accuracy = gathering.accuracy.min((REACH_SHARE * error.sqrt()).max(NEAR_ENOUGH));
        }
    }

    /// How many rays a pixel gets: where irradiance is shared, as many as the pixels' part of the error allows.
    pub(super) fn pixel_effort(&self) -> SamplingBudget {
        match self.effort() {
            SamplingBudget::Error { error, most } => {
                let share = match self.effort {
                    _ if self.render.ambient_bounces == 0 => 1.0,
                    Some(_) => PIXEL_SHARE,
                    None => usual_pixel_share(self.sample_spacing),
                };
                let finer = (COARSE_ERROR / error).max(1.0).powi(2);
                SamplingBudget::Error {
                    error: share * error,
                    most: (finer * f64::from(most)).min(MAX_SAMPLES.into()) as u32,
                }
            }
            samples => samples,
        }
    }

    /// Takes one option; gives how many words it used.
    fn take_option(&mut self, words: &[String]) -> Result<usize, Failure> {
        const TAKERS: [Taker; 8] = [
            |options, words| take_one(words, &mut options.render),
            |options, words| view_args::take_one(words, &mut options.view),
            |options, words| take_own(words, &mut options.reading, &mut options.render),
            |options, words| effort_args::take_one(words, MOST_SAMPLES, &mut options.effort),
            |options, words| Ok(take_irradiance(words, &mut options.render)),
            |options, words| take_definition(words, &mut options.reading),
            Options::take_sampling,
            Options::take_file,
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
            "-co" | "-co+" => {
                return Err(Failure::usage(format!(
                    "rpict: option \"{word}\" is not supported, as in Radiance: spectral pictures come from vwrays and rtrace -co -fac"
                )));
            }
            "-co-" => return Ok(1),
            "-ff" => {
                self.format = OutputFormat::Numbers(NumberFormat::Float);
                return Ok(1);
            }
            _ => {
                if let Some(shown) = switched(word, "-w", !self.reading.no_warnings) {
                    self.reading.no_warnings = !shown;
                    return Ok(1);
                }
                return Err(Failure::usage(format!("rpict: option \"{word}\" is not supported")));
            }
        }
        Ok(2)
    }

    /// The options about pixels and the rays through them.
    fn take_sampling(&mut self, words: &[String]) -> Result<usize, Failure> {
        let word = words[0].as_str();
        match word {
            "-pa" => self.pixel_aspect = number(words, word, "the height over the width of a pixel")?,
            "-pj" => self.pixel_jitter = share(words, "a share of a pixel from 0 to 1")?,
            "-pm" => self.motion = share(words, "a share of the time between frames from 0 to 1")?,
            "-pd" => self.aperture = positive(words, "the diameter of the aperture, 0 or more")?,
            "-ps" => self.sample_spacing = positive(words, "the pixels between samples")?,
            // There is nothing between samples to interpolate: every pixel has its own.
            "-pt" => drop(number::<f64>(words, word, "a number")?),
            _ => return Ok(0),
        }
        Ok(2)
    }

    fn take_file(&mut self, words: &[String]) -> Result<usize, Failure> {
        let word = words[0].as_str();
        let file = || number::<String>(words, word, "a file");
        let output = |existing| self.reading.trust.output(&file()?, existing);
        match word {
            // Pictures are never written over, so that a pattern of names will do.
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

    fn asked_error(words: &str) -> f64 {
        match parsed(words).effort() {
            SamplingBudget::Error { error, .. } => error,
            SamplingBudget::Samples(samples) => panic!("{samples} rays for each pixel"),
        }
    }

    #[test]
    fn pictures_with_fewer_samples_may_be_less_exact() {
        for (words, expected) in [
            ("rpict a.oct", 0.03),
            ("rpict -ps 1 a.oct", 0.03),
            ("rpict -ps 16 -ps 1 a.oct", 0.03),
            ("rpict -ps 16 a.oct", 0.05),
            ("rpict -ps 16 --error .1 a.oct", 0.1),
        ] {
            assert!((asked_error(words) - expected).abs() < 1e-12, "{words}: {}", asked_error(words));
        }
    }

    #[test]
    fn small_errors_look_around_along_more_rays_where_these_are_shared() {
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
