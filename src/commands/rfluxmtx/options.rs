//! The options of `rfluxmtx`: its own, and those passed to `rcontrib`.

use crate::expand::{CommandWords, TakesOptions, options_before_scenes};
use crate::failure::{Failure, say};
use crate::option_table::{options_of, unknown_option};
use crate::render_args::number;
use crate::switch::switched;
use crate::trust::{Existing, Trust};
use radsight_options::Settings;

/// The parsed options.
#[derive(Debug)]
pub(super) struct Options {
    pub(super) is_verbose: bool,
    no_warnings: bool,
    /// Position of a direction within its patch, as an expression.
    pub(super) jitter: Option<String>,
    /// Rays per direction of the sender, or per record.
    pub(super) samples: u64,
    /// Seed of the rays of a sender, and of those that follow them.
    pub(super) seed: u64,
    /// Options passed to `rcontrib` unchanged.
    pub(super) passed: CommandWords,
    /// Permissions that the command line gives to files.
    pub(super) trust: Trust,
    /// Which existing files the receivers may overwrite.
    pub(super) existing: Existing<'static>,
    /// `-I`, `-i`, `-x`, `-y` and `-ld`, which apply to rays from standard input.
    ray_words: Vec<String>,
    /// The letters of `-f` for input and output.
    formats: [char; 2],
    /// Hemisphere samples of a point (`-ad`), and whether the number of paths per ray is given.
    divisions: f64,
    says_paths: bool,
    /// `None` for rays from standard input.
    pub(super) sender: Option<String>,
    pub(super) receiver: String,
    pub(super) system: Vec<String>,
    /// The given options.
    settings: Settings,
}

const USAGE: &str = "rfluxmtx: expected a sender (or -) and a receiver after the options";

/// Default number of rays per direction of a sender.
const USUAL_SAMPLES: u64 = 10_000;

impl TakesOptions for Options {
    fn trust(&mut self) -> &mut Trust {
        &mut self.trust
    }

    fn settings(&mut self) -> &mut Settings {
        &mut self.settings
    }

    fn take(&mut self, words: &[String]) -> Result<usize, Failure> {
        self.take_one(words)
    }
}

impl Options {
    /// Parses the words, of which the first is the program's name.
    pub(super) fn parse(words: &[String], trust: &Trust) -> Result<Options, Failure> {
        let mut options = Options {
            is_verbose: false,
            no_warnings: false,
            jitter: None,
            samples: 0,
            seed: 0,
            passed: CommandWords::default(),
            trust: trust.clone(),
            existing: Existing::Kept,
            ray_words: Vec::new(),
            formats: ['a', 'a'],
            divisions: 350.0,
            says_paths: false,
            sender: None,
            receiver: String::new(),
            system: Vec::new(),
            settings: Settings::new(options_of("rfluxmtx")),
        };
        let words = CommandWords::new(words, trust.origin());
        let (_, files) = options_before_scenes(words, &mut options)?;
        let [sender, receiver, system @ ..] = &files[..] else { return Err(Failure::usage(USAGE)) };
        options.sender = (sender != "-").then(|| sender.clone());
        options.receiver.clone_from(receiver);
        // Piped input has no name.
        if receiver != "-" && !receiver.starts_with('!') {
            options.trust.work_for(receiver);
        }
        options.take_system(system)?;
        if options.samples == 0 {
            options.samples = if options.sender.is_some() { USUAL_SAMPLES } else { 1 };
        }
        options.check()?;
        Ok(options)
    }

    /// Parses one option; returns the number of words it used.
    fn take_one(&mut self, words: &[String]) -> Result<usize, Failure> {
        let word = words[0].as_str();
        let used = self.trust.take(words)?;
        if used > 0 {
            return Ok(used);
        }
        if let Some(overwrites) = switched(word, "-fo", self.existing == Existing::Replaced) {
            self.trust.check_overwriting(word)?;
            self.existing = if overwrites { Existing::Replaced } else { Existing::Kept };
            return Ok(1);
        }
        match word {
            "-v" => self.is_verbose = !self.is_verbose,
            "-bj" => return self.jitter(words),
            "-c" => {
                let expected = "a number of rays, 1 or more";
                self.samples = number(words, word, expected)?;
                if self.samples == 0 {
                    return Err(Failure::usage(format!("rfluxmtx: option \"-c\" with 0: expected {expected}")));
                }
                return Ok(2);
            }
            "-x" | "-y" => {
                let count: u64 = number(words, word, "a number of columns or rows")?;
                self.ray_words.extend([word.to_owned(), count.to_string()]);
                return Ok(2);
            }
            "-I" | "-I+" | "-I-" | "-i" | "-i+" | "-i-" | "-ld" | "-ld+" | "-ld-" => {
                self.ray_words.push(word.to_owned());
            }
            _ => return self.pass(words),
        }
        Ok(1)
    }

    fn jitter(&mut self, words: &[String]) -> Result<usize, Failure> {
        self.jitter = Some(number(words, "-bj", "an expression for the jitter")?);
        Ok(2)
    }

    /// Passes an option with its values to `rcontrib`.
    fn pass(&mut self, words: &[String]) -> Result<usize, Failure> {
        let word = words[0].as_str();
        let program = self.settings.program();
        let unknown = || unknown_option(program, word);
        if let Some(letters) = word.strip_prefix("-f").filter(|letters| !letters.is_empty()) {
            let letters: Vec<char> = letters.chars().collect();
            self.formats = match letters[..] {
                [both @ ('a' | 'f' | 'd')] => [both, both],
                [input @ ('a' | 'f' | 'd'), output @ ('a' | 'f' | 'd' | 'c')] => [input, output],
                _ => return Err(unknown()),
            };
            return Ok(1);
        }
        let values = program.parse_word(word).ok_or_else(unknown)?.option.value_count();
        let Some(taken) = words.get(..=values) else {
            return Err(Failure::usage(format!(
                "rfluxmtx: option \"{word}\" ends the command line, expected {values} values after it"
            )));
        };
        match word {
            "-w" | "-w-" => self.no_warnings = true,
            "-ad" => self.divisions = number(words, word, "a number of rays")?,
            "--samples" => self.says_paths = true,
            "--seed" => self.seed = number(words, word, "a whole number")?,
            _ => {}
        }
        self.passed.extend(taken.iter().cloned(), self.trust.word_origin());
        Ok(1 + values)
    }

    /// Parses the words after the receiver: scene files, an octree after `-i`, and options of
    /// `oconv` without effect here.
    fn take_system(&mut self, words: &[String]) -> Result<(), Failure> {
        for word in words {
            match word.as_str() {
                "-i" | "-f" | "-w" => {}
                option if option.starts_with('-') && option != "-" => {
                    return Err(Failure::usage(format!(
                        "rfluxmtx: \"{option}\" is not supported among the scene files, expected -i and an octree, or files"
                    )));
                }
                file => self.system.push(file.to_owned()),
            }
        }
        Ok(())
    }

    fn check(&self) -> Result<(), Failure> {
        let is_irradiance = |word: &&String| word.starts_with("-I") || word.starts_with("-i");
        match self.ray_words.iter().find(is_irradiance) {
            Some(word) if self.sender.is_some() => {
                Err(Failure::usage(format!("rfluxmtx: option \"{word}\" applies only to rays from standard input (-)")))
            }
            _ => Ok(()),
        }
    }

    /// The words for `rcontrib` if rays come from standard input.
    pub(super) fn pass_through_words(&self) -> Vec<String> {
        let mut words = self.ray_words.clone();
        words.extend([format!("-f{}{}", self.formats[0], self.formats[1]), "-c".to_owned()]);
        words.push(self.samples.to_string());
        words
    }

    /// The words for `rcontrib` about the generated rays, for a number of directions.
    pub(super) fn sampling_words(&self, bins: u64) -> Vec<String> {
        let mut words = vec![format!("-fd{}", self.formats[1])];
        if !self.says_paths {
            words.extend(["-ad".to_owned(), self.paths().to_string()]);
        }
        words.extend(["-c".to_owned(), self.samples.to_string(), "-y".to_owned(), bins.to_string()]);
        words
    }

    /// Number of paths per ray. The paths of a record are averaged, so a record with many rays
    /// needs few paths for each.
    fn paths(&self) -> u64 {
        (self.divisions / (self.samples as f64).sqrt()).ceil().clamp(1.0, 1e6) as u64
    }

    pub(super) fn warn(&self, what: &str) {
        if !self.no_warnings {
            say(&format!("rfluxmtx: warning - {what}\n"));
        }
    }
}
