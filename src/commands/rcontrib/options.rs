//! The options of `rcontrib`, in Radiance's syntax.

use super::bins::{BinRequest, Bins, Functions};
use super::defaults;
use crate::args::Reading;
use crate::commands::features;
use crate::expand::{CommandWords, TakesOptions, options_before_scenes};
use crate::failure::Failure;
use crate::input::read_file;
use crate::option_table::options_of;
use crate::output_format::OutputFormat;
use crate::render_args::{names_in, number, take_irradiance, take_one, take_own};
use crate::sampling_args;
use crate::switch::switched;
use crate::trust::{Existing, Origin, Trust};
use radsight_film::SamplingBudget;
use radsight_options::Settings;
use radsight_pinhole::stream::NumberFormat;
use radsight_render::{Gathering, PathLimit, Quantity, RenderOptions, Uncached};
use std::collections::HashSet;

/// Largest number of branches into which a ray splits at once.
const MOST_BRANCHES: f64 = 16_384.0;

/// The requested quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wanted {
    /// Coefficients: factors of an emitter's radiance (`-V-`).
    Coefficients,
    /// Contributions with the emitter's own radiance (`-V+`).
    Contributions,
}

/// A tracked modifier.
#[derive(Clone, Debug)]
pub(super) struct Tracked {
    pub(super) name: String,
    /// The origin of its name.
    pub(super) origin: Origin,
    /// Its output; `None` for standard output.
    pub(super) output: Option<OutputPattern>,
    pub(super) bin: BinRequest,
}

/// A file name, which may contain `%s` and `%d`, or a command after `!`.
#[derive(Clone, Debug)]
pub(super) struct OutputPattern {
    pub(super) text: String,
    /// The origin of the pattern.
    pub(super) origin: Origin,
}

/// The parsed options.
#[derive(Debug)]
pub(super) struct Options {
    pub(super) render: RenderOptions,
    pub(super) wanted: Wanted,
    pub(super) tracked: Vec<Tracked>,
    /// Rays per record; 0 for all.
    pub(super) accumulate: u64,
    pub(super) header: bool,
    pub(super) overwrites: bool,
    /// Which existing files may be overwritten if a file names them.
    pub(super) existing_of_files: Existing<'static>,
    /// Whether existing records in the files are kept.
    pub(super) recovers: bool,
    /// Whether rays are limited to the length of their direction vectors.
    pub(super) limits_distance: bool,
    pub(super) input_format: NumberFormat,
    pub(super) output_format: OutputFormat,
    pub(super) size: [u64; 2],
    pub(super) threads: Option<usize>,
    pub(super) reading: Reading,
    pub(super) scenes: Vec<String>,
    /// The words up to the scenes, for the header.
    pub(super) command: Vec<String>,
    /// The options listed by `-defaults`.
    pub(super) settings: Settings,
    /// Seconds between reports, which are not made (`-t`).
    pub(super) report: u64,
    sampling_budget: Option<SamplingBudget>,
    /// Number of times that a splitting ray is traced.
    rounds: u64,
    functions: Functions,
    /// Output of the modifiers named next.
    next_output: Option<OutputPattern>,
    next_bin: BinRequest,
}

impl Default for Options {
    fn default() -> Self {
        // Radiance's defaults for contributions; each ray has its own value, so no irradiance is
        // cached.
        let gathering = Gathering { accuracy: 0.0, divisions: 350, uncached: Uncached::Split, ..Gathering::default() };
        let render = RenderOptions {
            gathering,
            ambient_bounces: 1,
            mirror_sources: 3,
            highlight_threshold: 0.02,
            least_weight: 2e-3,
            path_limit: PathLimit::RouletteUpTo(10),
            ..RenderOptions::default()
        };
        Options {
            render,
            wanted: Wanted::Coefficients,
            tracked: Vec::new(),
            accumulate: 1,
            header: true,
            overwrites: false,
            existing_of_files: Existing::Kept,
            recovers: false,
            limits_distance: false,
            input_format: NumberFormat::Ascii,
            output_format: OutputFormat::Numbers(NumberFormat::Ascii),
            size: [0, 0],
            threads: None,
            reading: Reading::default(),
            scenes: Vec::new(),
            command: Vec::new(),
            settings: Settings::new(options_of("rcontrib")),
            report: 0,
            sampling_budget: None,
            rounds: 1,
            functions: Functions::new(),
            next_output: None,
            next_bin: BinRequest::default(),
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
    /// Parses the words, of which the first is the program's name.
    pub(super) fn parse(words: CommandWords, trust: &Trust) -> Result<Options, Failure> {
        let mut options = Options::default();
        options.reading.trust = trust.clone();
        (options.command, options.scenes) = options_before_scenes(words, &mut options)?;
        options.check()?;
        Ok(options)
    }

    fn check(&mut self) -> Result<(), Failure> {
        if self.tracked.is_empty() {
            return Err(Failure::usage("rcontrib: no modifier is given, expected -m or -M"));
        }
        if self.scenes.is_empty() {
            return Err(Failure::usage(
                "rcontrib: no scene is given, expected an octree or scene files after the options",
            ));
        }
        if self.accumulate == 0 {
            self.size = [0, 0];
        }
        self.render.gathering.accuracy = 0.0;
        if self.sampling_budget.is_some() {
            self.render.gathering.uncached = Uncached::TraceOne;
        } else if self.render.ambient_bounces > 0 {
            self.share_branches();
        }
        Ok(())
    }

    /// Traces each ray several times if it would split into very many: threads share these, and the
    /// contributions fit into memory. A white surface splits a ray into at most 0.8 divided by the
    /// smallest weight.
    fn share_branches(&mut self) {
        let divisions = f64::from(self.render.gathering.divisions.max(1));
        let most = divisions.min(0.8 / self.render.least_weight).max(1.0);
        self.rounds = (most / MOST_BRANCHES).ceil() as u64;
        if self.rounds > 1 {
            self.render.gathering.divisions = (most / self.rounds as f64).ceil() as u32;
        }
    }

    /// Parses one option; returns the number of words it used.
    fn take_option(&mut self, words: &[String]) -> Result<usize, Failure> {
        // Some rendering options begin with the same letter as these.
        let mut used = self.take_named(words)?;
        if used == 0 {
            used = take_one(words, &mut self.render)?;
        }
        if used == 0 {
            used = take_own(words, &mut self.reading, &mut self.render)?;
        }
        if used == 0 {
            used = take_irradiance(words, &mut self.render);
        }
        if used == 0 {
            used = sampling_args::take_one(words, 0, &mut self.sampling_budget)?;
        }
        if used == 0 {
            used = self.take_switch(&words[0])?;
        }
        if let Some(SamplingBudget::Error(_)) = self.sampling_budget {
            return Err(Failure::usage("rcontrib: option \"--error\" is not supported, expected --samples or -ad"));
        }
        Ok(used)
    }

    fn take_named(&mut self, words: &[String]) -> Result<usize, Failure> {
        let word = words[0].as_str();
        match word {
            "-n" => self.threads = Some(number(words, word, "a number of threads")?),
            "-x" => self.size[0] = number(words, word, "a number of columns, or a flush interval")?,
            "-y" => self.size[1] = number(words, word, "a number of rows")?,
            "-c" => {
                // As in Radiance, a negative number accumulates all rays, too.
                let rays: i64 = number(words, word, "a number of rays for each record, 0 for all")?;
                self.accumulate = rays.try_into().unwrap_or(0);
            }
            "-t" => self.report = number(words, word, "a number of seconds")?,
            "-o" => {
                let text = number(words, word, "an output of the following modifiers")?;
                self.next_output = Some(OutputPattern { text, origin: self.reading.trust.word_origin() });
            }
            "-p" => {
                let text: String = number(words, word, "parameters, as in MF=4")?;
                self.next_bin.parameters = Some(self.functions.set_parameters(&text)?);
            }
            "-b" => self.next_bin.expression = Some(number(words, word, "an expression for the bin")?),
            "-bn" => {
                let text: String = number(words, word, "a number of bins")?;
                self.next_bin.count = self.functions.count(&text)?;
            }
            "-f" => self.functions.load_file(&number::<String>(words, word, "a file of functions")?)?,
            "-e" => self.functions.define(&number::<String>(words, word, "a definition, as in MF:4")?)?,
            "-m" => self.track(number(words, word, "the name of a modifier")?, self.reading.trust.word_origin())?,
            "-M" => self.track_all(&number::<String>(words, word, "a file of modifiers' names")?)?,
            "-defaults" | "-help" => return Err(Failure::answer(defaults::text(self))),
            "-version" => return Err(features::version()),
            _ => return Ok(0),
        }
        Ok(2)
    }

    fn take_switch(&mut self, word: &str) -> Result<usize, Failure> {
        let quantity = self.render.quantity;
        if let Some(on) = switched(word, "-V", self.wanted == Wanted::Contributions) {
            self.wanted = if on { Wanted::Contributions } else { Wanted::Coefficients };
        } else if let Some(on) = switched(word, "-I", quantity == Quantity::Irradiance) {
            self.render.quantity = if on { Quantity::Irradiance } else { Quantity::Radiance };
        } else if let Some(on) = switched(word, "-fo", self.overwrites) {
            self.reading.trust.check_overwriting(word)?;
            self.overwrites = on;
        } else if let Some(on) = switched(word, "-h", self.header) {
            self.header = on;
        } else if let Some(on) = switched(word, "-w", !self.reading.no_warnings) {
            self.reading.no_warnings = !on;
        } else if let Some(on) = switched(word, "-r", self.recovers) {
            self.reading.trust.check_overwriting(word)?;
            self.recovers = on;
        } else if let Some(on) = switched(word, "-ld", self.limits_distance) {
            self.limits_distance = on;
        } else if let Some(letters) = word.strip_prefix("-f") {
            self.formats(letters)?;
        } else {
            return Ok(0);
        }
        Ok(1)
    }

    fn formats(&mut self, letters: &str) -> Result<(), Failure> {
        let unknown = || {
            Failure::usage(format!(
                "rcontrib: format \"-f{letters}\" is unknown, expected -f then a, f or d, and a, f, d or c"
            ))
        };
        (self.input_format, self.output_format) = OutputFormat::pair_from_letters(letters).ok_or_else(unknown)?;
        Ok(())
    }

    fn track(&mut self, name: String, origin: Origin) -> Result<(), Failure> {
        if name == "void" {
            return Err(Failure::usage("rcontrib: \"void\" cannot be tracked"));
        }
        if self.tracked.iter().any(|tracked| tracked.name == name) {
            return Err(Failure::usage(format!("rcontrib: modifier \"{name}\" is named twice")));
        }
        self.tracked.push(Tracked { name, origin, output: self.next_output.clone(), bin: self.next_bin.clone() });
        Ok(())
    }

    fn track_all(&mut self, file: &str) -> Result<(), Failure> {
        let bytes = read_file(file, "modifiers")?;
        let mut known: HashSet<String> = self.tracked.iter().map(|tracked| tracked.name.clone()).collect();
        for name in names_in(&bytes) {
            if name == "void" || !known.insert(name.clone()) {
                return self.track(name, Origin::File);
            }
            let (output, bin) = (self.next_output.clone(), self.next_bin.clone());
            self.tracked.push(Tracked { name, origin: Origin::File, output, bin });
        }
        Ok(())
    }

    /// The bins of all modifiers.
    pub(super) fn bins(&self) -> Result<Bins, Failure> {
        let requests = self.tracked.iter().map(|tracked| (tracked.name.as_str(), &tracked.bin));
        self.functions.compile(requests)
    }

    /// The number of times that each ray is traced: once if it splits into the requested number of
    /// paths, otherwise that number.
    pub(super) fn samples(&self) -> u64 {
        match self.sampling_budget {
            Some(SamplingBudget::Samples(samples)) => u64::from(samples),
            _ => self.rounds,
        }
    }

    /// The approximate number of paths per ray.
    pub(super) fn paths(&self) -> u64 {
        match self.sampling_budget {
            None if self.render.ambient_bounces > 0 => self.rounds * u64::from(self.render.gathering.divisions.max(1)),
            _ => self.samples(),
        }
    }

    /// Number of components of a value.
    pub(super) fn components(&self) -> usize {
        self.render.sampling.bands()
    }

    /// Number of rays on standard input; `None` for all.
    pub(super) fn expected_rays(&self) -> Option<u64> {
        let [columns, rows] = self.size;
        let records = if columns > 0 { columns.saturating_mul(rows) } else { rows };
        (records > 0).then(|| records.saturating_mul(self.accumulate.max(1)))
    }

    /// Number of records between flushes, if requested.
    pub(super) fn flush_interval(&self) -> Option<u64> {
        let [columns, rows] = self.size;
        (columns > 0 && (rows == 0 || columns == 1)).then_some(columns)
    }
}
