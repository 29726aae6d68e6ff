//! The options of `rtrace`, in Radiance's syntax.

use super::defaults;
use super::tree::{Ends, TreeOutput};
use crate::args::Reading;
use crate::commands::features;
use crate::control_file;
use crate::expand::{CommandWords, TakesOptions, options_before_scenes};
use crate::failure::Failure;
use crate::option_table::options_of;
use crate::output_color::OutputColor;
use crate::output_format::OutputFormat;
use crate::render_args::{
    names_in_file, number, take_definition, take_highlight_samples, take_irradiance, take_one, take_own,
};
use crate::sampling_args;
use crate::switch::switched;
use crate::trust::{Existing, OutputName, Trust};
use radsight_film::SamplingBudget;
use radsight_options::Settings;
use radsight_pinhole::stream::NumberFormat;
use radsight_render::{BareSurfaces, Gathering, Quantity, RayTreeOutput, RenderOptions, Uncached};

/// The parsed options.
#[derive(Debug)]
pub(super) struct Options {
    pub(super) render: RenderOptions,
    pub(super) header: bool,
    pub(super) input_format: NumberFormat,
    pub(super) output_format: OutputFormat,
    pub(super) output: Vec<Field>,
    /// The output of ray trees, and the surfaces where they end.
    pub(super) tree: Option<TreeOutput>,
    pub(super) tree_ends: Ends,
    pub(super) color: OutputColor,
    /// Columns and rows of the rays' picture; a column count alone is the flush interval.
    pub(super) size: [u64; 2],
    /// Whether rays are limited to the length of their direction vectors.
    pub(super) limits_distance: bool,
    /// The requested number of samples; `None` for the default of [`Options::sampling_budget`].
    asked_budget: Option<SamplingBudget>,
    pub(super) threads: Option<usize>,
    pub(super) reading: Reading,
    pub(super) error_file: Option<OutputName>,
    control_file: Option<OutputName>,
    pub(super) scenes: Vec<String>,
    /// The words up to the scenes, for the header.
    pub(super) command: Vec<String>,
    /// The options listed by `-defaults`.
    pub(super) settings: Settings,
    /// The letters after `-o`.
    pub(super) letters: String,
}

/// Largest number of samples of a ray for a requested error.
const MOST_SAMPLES: u32 = 4096;

/// One letter of `-o`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Field {
    Value,
    Contribution,
    Direction,
    Origin,
    EffectiveDistance,
    FirstDistance,
    Local,
    Point,
    PerturbedNormal,
    Normal,
    Surface,
    Modifier,
    Material,
    Weight,
    Coefficient,
    Mirrored,
    MirroredDistance,
    Unmirrored,
    UnmirroredDistance,
    Tilde,
}

impl Field {
    fn from_letter(letter: char) -> Option<Field> {
        Some(match letter {
            'v' => Field::Value,
            'V' => Field::Contribution,
            'd' => Field::Direction,
            'o' => Field::Origin,
            'l' => Field::EffectiveDistance,
            'L' => Field::FirstDistance,
            'c' => Field::Local,
            'p' => Field::Point,
            'n' => Field::PerturbedNormal,
            'N' => Field::Normal,
            's' => Field::Surface,
            'm' => Field::Modifier,
            'M' => Field::Material,
            'w' => Field::Weight,
            'W' => Field::Coefficient,
            'r' => Field::Mirrored,
            'R' => Field::MirroredDistance,
            'x' => Field::Unmirrored,
            'X' => Field::UnmirroredDistance,
            '~' => Field::Tilde,
            _ => return None,
        })
    }

    /// Whether it needs more than the first hit of the ray.
    pub(super) fn needs_tracing(self) -> bool {
        use Field::{EffectiveDistance, PerturbedNormal};
        self.is_value() || self.distinguishes_mirrors() || matches!(self, EffectiveDistance | PerturbedNormal)
    }

    /// Whether it distinguishes mirrored and unmirrored parts.
    fn distinguishes_mirrors(self) -> bool {
        use Field::{Mirrored, MirroredDistance, Unmirrored, UnmirroredDistance};
        matches!(self, Mirrored | MirroredDistance | Unmirrored | UnmirroredDistance)
    }

    fn is_value(self) -> bool {
        use Field::{Coefficient, Contribution, Mirrored, Unmirrored, Value};
        matches!(self, Value | Contribution | Coefficient | Mirrored | Unmirrored)
    }
}

/// All letters of `-o`.
const LETTERS: &str = "tTvVdolLcpnNsmMwWrRxX~";

impl Default for Options {
    fn default() -> Self {
        // Radiance's defaults for single rays.
        let gathering = Gathering {
            accuracy: 0.1,
            resolution: 256,
            divisions: 1024,
            super_samples: 512,
            uncached: Uncached::Split,
            ..Gathering::default()
        };
        Options {
            render: RenderOptions { gathering, highlight_threshold: 0.15, ..RenderOptions::default() },
            header: true,
            input_format: NumberFormat::Ascii,
            output_format: OutputFormat::Numbers(NumberFormat::Ascii),
            output: vec![Field::Value],
            tree: None,
            tree_ends: Ends::Anywhere,
            color: OutputColor::Rgb,
            size: [0, 0],
            limits_distance: false,
            asked_budget: None,
            threads: None,
            reading: Reading::default(),
            error_file: None,
            control_file: None,
            scenes: Vec::new(),
            command: Vec::new(),
            settings: Settings::new(options_of("rtrace")),
            letters: "v".to_owned(),
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
    /// Parses the words, of which the first is the program's name. A control file stores them, or
    /// replaces them by stored ones.
    pub(super) fn parse(words: &[String], trust: &Trust) -> Result<Options, Failure> {
        let mut options = Options::parse_once(words, trust.clone())?;
        if let Some(file) = &options.control_file
            && let Some(kept) = control_file::keep_or_recall(file, words, &options.scenes)?
        {
            options = Options::parse_once(&kept, options.reading.trust.for_file())?;
        }
        if options.scenes.is_empty() {
            return Err(Failure::usage("rtrace: no scene is given, expected scene files after the options"));
        }
        options.check()?;
        options.request_ray_trees();
        options.render.gathering.bounded = options.asked_budget.is_none();
        Ok(options)
    }

    fn parse_once(words: &[String], trust: Trust) -> Result<Options, Failure> {
        let mut options = Options::default();
        let words = CommandWords::new(words, trust.origin());
        options.reading.trust = trust;
        (options.command, options.scenes) = options_before_scenes(words, &mut options)?;
        Ok(options)
    }

    /// Requests from the renderer the rays and surfaces in the output.
    fn request_ray_trees(&mut self) {
        let tells_ends = |field: &Field| !matches!(field, Field::Value | Field::Contribution);
        if self.tree.is_some() || self.output.iter().any(tells_ends) {
            self.render.bare_surfaces = BareSurfaces::Reported;
        }
        let tells_mirrors = self.output.iter().any(|field| field.distinguishes_mirrors());
        self.render.ray_tree = match &self.tree {
            Some(tree) => {
                // Cached irradiance has no rays of the current ray tree.
                self.render.gathering =
                    Gathering { accuracy: 0.0, uncached: Uncached::TraceOne, ..self.render.gathering };
                Some(tree.rays)
            }
            None => tells_mirrors.then_some(RayTreeOutput::All),
        };
    }

    fn check(&self) -> Result<(), Failure> {
        let is_one_value = matches!(self.output[..], [Field::Value | Field::Mirrored | Field::Unmirrored]);
        if self.output_format == OutputFormat::Pixels && (self.tree.is_some() || !is_one_value) {
            return Err(Failure::usage("rtrace: pixels (-f.c) hold a single value, expected -ov, -or or -ox"));
        }
        if self.output_format == OutputFormat::Pixels && self.components() < 3 {
            return Err(Failure::usage(
                "rtrace: pixels (-f.c) need three components or more, expected -pRGB, -pXYZ, -pc or -co",
            ));
        }
        if self.render.quantity != Quantity::Radiance
            && self.tree.is_none()
            && !self.output.iter().any(|field| field.needs_tracing())
        {
            return Err(Failure::usage("rtrace: irradiance (-I, -i) is requested without a value, expected -ov"));
        }
        Ok(())
    }

    /// Parses one option; returns the number of words it used.
    fn take_option(&mut self, words: &[String]) -> Result<usize, Failure> {
        let mut used = take_highlight_samples(words, &mut self.render)?;
        if used == 0 {
            used = take_one(words, &mut self.render)?;
        }
        if used == 0 {
            used = take_own(words, &mut self.reading, &mut self.render)?;
        }
        if used == 0 {
            used = take_definition(words, &mut self.reading)?;
        }
        if used == 0 {
            used = take_irradiance(words, &mut self.render);
        }
        if used == 0 {
            used = sampling_args::take_one(words, MOST_SAMPLES, &mut self.asked_budget)?;
        }
        if used == 0 {
            used = self.take_switch(&words[0]);
        }
        if used > 0 {
            return Ok(used);
        }
        let word = words[0].as_str();
        match word {
            "-n" => self.threads = Some(number(words, word, "a number of threads")?),
            "-x" => self.size[0] = number(words, word, "a number of columns, or a flush interval")?,
            "-y" => self.size[1] = number(words, word, "a number of rows")?,
            "-e" => {
                let file: String = number(words, word, "a file for messages")?;
                self.error_file = Some(self.reading.trust.output(&file, Existing::Messages)?);
            }
            "-ti" | "-te" => self.tree_ends.name(word, vec![number(words, word, "the name of a modifier")?]),
            "-tI" | "-tE" => {
                let file: String = number(words, word, "a file of modifiers' names")?;
                self.tree_ends.name(word, names_in_file(word, &file)?);
            }
            "-defaults" | "-help" => return Err(Failure::answer(defaults::text(self))),
            "-version" => return Err(features::version()),
            _ if control_file::is_option(word) => {
                let file: String = number(words, word, "a control file")?;
                self.control_file = Some(self.reading.trust.output(&file, Existing::Kept)?);
            }
            _ if word.starts_with("-f") => return self.formats(word).map(|()| 1),
            _ if word.starts_with("-o") => return self.fields(word).map(|()| 1),
            _ => {
                let is_spectral = self.color == OutputColor::Bands;
                if let Some(spectral) = switched(word, "-co", is_spectral) {
                    // Without a spectrum, other components stay.
                    self.color = match spectral {
                        true => OutputColor::Bands,
                        false if is_spectral => OutputColor::Rgb,
                        false => self.color,
                    };
                    return Ok(1);
                }
                if let Some((color, used)) = OutputColor::from_option(words)? {
                    self.color = color;
                    return Ok(used);
                }
                return Ok(0);
            }
        }
        Ok(2)
    }

    fn take_switch(&mut self, word: &str) -> usize {
        let quantity = self.render.quantity;
        if let Some(on) = switched(word, "-I", quantity == Quantity::Irradiance) {
            self.render.quantity = if on { Quantity::Irradiance } else { Quantity::Radiance };
        } else if let Some(on) = switched(word, "-h", self.header) {
            self.header = on;
        } else if let Some(on) = switched(word, "-w", !self.reading.no_warnings) {
            self.reading.no_warnings = !on;
        } else if let Some(on) = switched(word, "-ld", self.limits_distance) {
            self.limits_distance = on;
        } else {
            return 0;
        }
        1
    }

    fn formats(&mut self, word: &str) -> Result<(), Failure> {
        let wrong =
            || Failure::usage(format!("rtrace: option \"{word}\": expected -f, one of a, f, d, and one of a, f, d, c"));
        (self.input_format, self.output_format) = OutputFormat::pair_from_letters(&word[2..]).ok_or_else(wrong)?;
        Ok(())
    }

    fn fields(&mut self, word: &str) -> Result<(), Failure> {
        word[2..].clone_into(&mut self.letters);
        self.output.clear();
        self.tree = None;
        let mut rays = RayTreeOutput::All;
        for (place, letter) in word[2..].char_indices() {
            let is_last = place + 3 == word.len();
            let fields = self.tree.as_mut().map_or(&mut self.output, |tree| &mut tree.fields);
            match (letter, Field::from_letter(letter)) {
                (_, Some(field)) => fields.push(field),
                ('t' | 'T', _) => {
                    if letter == 'T' {
                        rays = RayTreeOutput::AllAndLit;
                    }
                    // As in Radiance, it is ignored if nothing follows, and resets the list if
                    // repeated.
                    if !is_last {
                        self.tree = Some(TreeOutput { rays, fields: Vec::new() });
                    }
                }
                _ => {
                    return Err(Failure::usage(format!(
                        "rtrace: \"{letter}\" of \"{word}\" is not an output, expected letters of {LETTERS}"
                    )));
                }
            }
        }
        if self.output.is_empty() && self.tree.is_none() {
            return Err(Failure::usage(format!("rtrace: option \"-o\" has no letters, expected letters of {LETTERS}")));
        }
        Ok(())
    }

    /// Number of samples per ray: one, unless more are requested.
    pub(super) fn sampling_budget(&self) -> SamplingBudget {
        self.asked_budget.unwrap_or(SamplingBudget::Samples(1))
    }

    /// Whether rays are limited to their direction vectors, and report it.
    pub(super) fn limits_rays(&self) -> bool {
        self.limits_distance && self.render.quantity != Quantity::Irradiance
    }

    /// Number of components of a value.
    pub(super) fn components(&self) -> usize {
        self.color.components(self.render.sampling.bands())
    }

    /// Number of numbers in a record; a name counts as one.
    pub(super) fn numbers(&self) -> usize {
        let numbers = |field: &Field| match field {
            field if field.is_value() => self.components(),
            Field::Direction | Field::Origin | Field::Point | Field::PerturbedNormal | Field::Normal => 3,
            Field::Local => 2,
            Field::Tilde => 0,
            _ => 1,
        };
        self.output.iter().map(numbers).sum()
    }
}
