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
use radsight_film::{Interpolation, MAX_SAMPLES, SamplingBudget};
use radsight_picture::ViewOptions;
use radsight_pinhole::stream::NumberFormat;
use radsight_render::{Gathering, LightDivision, RenderOptions, Uncached};

/// Rays that no pixel exceeds for an asked error, from this error on; for less error so many more as that takes.
const MOST_SAMPLES: u32 = 1024;
const COARSE_ERROR: f64 = 0.02;

/// What of an error goes to the noise and the reach of shared irradiance, and to pixels; values that reach no farther than this are good enough for
/// any error.
const NOISE_SHARE: f64 = 1.5;
const REACH_SHARE: f64 = 0.5;
const NEAR_ENOUGH: f64 = 0.1;
const PIXEL_SHARE: f64 = 0.8;

/// Relative noise of the irradiance that N rays find, times √N: what Radiance's records have.
const NOISE_OF_A_RAY: f64 = 1.5;

/// Rays that a record traces in the mean where no error is asked for, as a share of those that Radiance's records do: neighbours share them.
const RECORD_SHARE: f64 = 0.75;

/// Radiance's default of `-pj`; a picture of which an error is asked averages whole pixels.
const USUAL_JITTER: f64 = 0.67;

/// Where an error is asked for, the whole picture's counts, not what is seen in its corners.
const EVENNESS: f64 = 0.1;

/// For errors below the coarse one places look around along more rays, in proportion to what noise needs: many places with few rays each come to no less noise,
/// for more time.
const MOST_THOROUGH: f64 = 16.0;

/// Caustics are shared where records disagree by less than so many times the noise; elsewhere pixels have as many rays as the asked error needs.
const CAUSTIC_BEND: f64 = 2.0;

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
    /// `-pj`, where it is said.
    pixel_jitter: Option<f64>,
    pub(super) motion: f64,
    pub(super) aperture: f64,
    /// Pixels between the first samples (`-ps`).
    pub(super) sample_spacing: f64,
    /// The contrast below which pixels are interpolated between samples (`-pt`).
    pub(super) contrast: f64,
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
            pixel_jitter: None,
            motion: 0.0,
            aperture: 0.0,
            sample_spacing: 4.0,
            contrast: 0.05,
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

    /// Gives the irradiance cache its part of the error that is asked for, or else of the rays that Radiance would trace. A value's noise may be more than
    /// the error, since a pixel sees several values; interpolation bias grows as the square of the distance that records reach.
    fn share_error(&mut self) {
        let gathering = &mut self.render.gathering;
        match self.effort {
            Some(SamplingBudget::Error { error, .. }) => {
                gathering.noise = NOISE_SHARE * error;
                gathering.evenness = EVENNESS;
                if gathering.accuracy > 0.0 && gathering.divisions > 1 {
                    let thoroughness = (COARSE_ERROR / error).powi(2).clamp(1.0, MOST_THOROUGH);
                    gathering.divisions = (f64::from(gathering.divisions) * thoroughness) as u32;
                }
                gathering.caustic_error = (CAUSTIC_BEND * gathering.noise).min(Gathering::MAX_INTERPOLATION_ERROR);
                gathering.accuracy = gathering.accuracy.min((REACH_SHARE * error.sqrt()).max(NEAR_ENOUGH));
            }
            Some(_) => {}
            None => {
                let rays = f64::from(gathering.divisions + gathering.super_samples);
                gathering.noise = NOISE_OF_A_RAY / rays.max(1.0).sqrt();
                gathering.record_share = RECORD_SHARE;
                gathering.most_residual = f64::INFINITY;
                self.render.light_division = LightDivision::BySize;
            }
        }
    }

    /// Side of the square in a pixel over which its rays are spread, in pixels.
    pub(super) fn jitter(&self) -> f64 {
        self.pixel_jitter.unwrap_or(if self.effort.is_some() { 1.0 } else { USUAL_JITTER })
    }

    /// The side in pixels of the squares that have one ray of the cache's pre-pass.
    pub(super) fn survey_spacing(&self) -> usize {
        if self.effort.is_some() { 1 } else { (0.5 * self.sample_spacing).max(1.0) as usize }
    }

    /// How many rays a pixel gets: where irradiance is shared, as many as the pixels' part of the error allows. Where nothing is said, what is smooth is
    /// interpolated as Radiance's options ask.
    pub(super) fn pixel_effort(&self) -> SamplingBudget {
        match self.effort {
            Some(SamplingBudget::Error { error, most }) => {
                let share = if self.render.ambient_bounces == 0 { 1.0 } else { PIXEL_SHARE };
                let finer = (COARSE_ERROR / error).max(1.0).powi(2);
                SamplingBudget::Error {
                    error: share * error,
                    most: (finer * f64::from(most)).min(MAX_SAMPLES.into()) as u32,
                }
            }
            Some(samples) => samples,
            None => {
                SamplingBudget::Interpolated(Interpolation { spacing: self.sample_spacing, contrast: self.contrast })
            }
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

    #[test]
    fn pictures_are_interpolated_as_radiances_options_say_unless_an_effort_is_asked_for() {
        for (words, spacing, contrast) in
            [("rpict a.oct", 4.0, 0.05), ("rpict -ps 1 -pt 0 a.oct", 1.0, 0.0), ("rpict -ps 8 -pt .2 a.oct", 8.0, 0.2)]
        {
            let expected = SamplingBudget::Interpolated(Interpolation { spacing, contrast });
            assert_eq!(parsed(words).pixel_effort(), expected, "{words}");
        }
        assert_eq!(parsed("rpict --samples 9 -ps 8 a.oct").pixel_effort(), SamplingBudget::Samples(9));
        assert!(matches!(parsed("rpict -ps 8 --error .1 a.oct").pixel_effort(), SamplingBudget::Error { .. }));
    }

    #[test]
    fn whole_pixels_are_averaged_where_an_effort_is_asked_for() {
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
