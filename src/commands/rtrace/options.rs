//! The options of `rtrace`, as Radiance writes them.

use crate::args::Reading;
use crate::failure::Failure;
use crate::render_args::{number, take_one, take_own};
use radsight_pinhole::stream::NumberFormat;
use radsight_render::{Gathering, Quantity, RenderOptions, Unshared};

/// What is asked.
#[derive(Debug)]
pub(super) struct Options {
    pub(super) render: RenderOptions,
    pub(super) header: bool,
    pub(super) input_format: NumberFormat,
    pub(super) output_format: NumberFormat,
    pub(super) output: Vec<Field>,
    pub(super) threads: Option<usize>,
    pub(super) unbuffered: bool,
    pub(super) reading: Reading,
    pub(super) scenes: Vec<String>,
}

/// One letter of `-o`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Field {
    Value,
    Direction,
    Origin,
    EffectiveDistance,
    FirstDistance,
    Point,
    PerturbedNormal,
    Normal,
    Surface,
    Modifier,
    Weight,
}

impl Field {
    fn from_letter(letter: char) -> Option<Field> {
        Some(match letter {
            'v' => Field::Value,
            'd' => Field::Direction,
            'o' => Field::Origin,
            'l' => Field::EffectiveDistance,
            'L' => Field::FirstDistance,
            'p' => Field::Point,
            'n' => Field::PerturbedNormal,
            'N' => Field::Normal,
            's' => Field::Surface,
            'm' => Field::Modifier,
            'w' => Field::Weight,
            _ => return None,
        })
    }
}

/// Letters of `-o` that Radiance knows and radsight does not give.
const OTHER_LETTERS: &str = "tTfFrRxXcMUVWg~-i";

impl Options {
    /// Reads the words after the program's name.
    pub(super) fn parse(words: &[String]) -> Result<Options, Failure> {
        // Radiance's defaults for single rays.
        let gathering = Gathering {
            accuracy: 0.1,
            resolution: 256,
            divisions: 1024,
            super_samples: 512,
            unshared: Unshared::LookAround,
        };
        let mut options = Options {
            render: RenderOptions { gathering, ..RenderOptions::default() },
            header: true,
            input_format: NumberFormat::Ascii,
            output_format: NumberFormat::Ascii,
            output: vec![Field::Value],
            threads: None,
            unbuffered: false,
            reading: Reading::default(),
            scenes: Vec::new(),
        };
        let mut at = 0;
        while at < words.len() && words[at].starts_with('-') && words[at] != "-" {
            at += options.take(&words[at..])?;
        }
        options.scenes = words[at..].to_vec();
        if options.scenes.is_empty() {
            return Err(Failure::usage("rtrace: no scene is named, expected scene files after the options"));
        }
        Ok(options)
    }

    /// Takes one option; gives how many words it used.
    fn take(&mut self, words: &[String]) -> Result<usize, Failure> {
        let used = take_one(words, &mut self.render)?;
        if used > 0 {
            return Ok(used);
        }
        let used = take_own(words, &mut self.reading, &mut self.render)?;
        if used > 0 {
            return Ok(used);
        }
        let word = words[0].as_str();
        match word {
            "-h" | "-h-" => self.header = false,
            "-h+" => self.header = true,
            "-I" | "-I+" => self.render.quantity = Quantity::Irradiance,
            "-i" | "-i+" => self.render.quantity = Quantity::SurfaceIrradiance,
            "-I-" | "-i-" => self.render.quantity = Quantity::Radiance,
            "-ld-" | "-w" | "-w+" | "-w-" | "-pRGB" => {}
            "-n" => {
                self.threads = Some(number(words, word, "a number of threads")?);
                return Ok(2);
            }
            "-x" => {
                let interval: u64 = number(words, word, "a flush interval")?;
                self.unbuffered = interval == 1;
                return Ok(2);
            }
            "-y" => {
                let _: u64 = number(words, word, "a number of rows")?;
                return Ok(2);
            }
            _ if word.starts_with("-f") => self.formats(word)?,
            _ if word.starts_with("-o") => self.fields(word)?,
            _ => return Err(Failure::usage(format!("rtrace: option \"{word}\" is not supported"))),
        }
        Ok(1)
    }

    fn formats(&mut self, word: &str) -> Result<(), Failure> {
        let wrong = || Failure::usage(format!("rtrace: option \"{word}\": expected -f and one or two of a, f, d"));
        let letters: Vec<NumberFormat> =
            word[2..].chars().map(NumberFormat::from_letter).collect::<Option<_>>().ok_or_else(wrong)?;
        match letters[..] {
            [both] => (self.input_format, self.output_format) = (both, both),
            [input, output] => (self.input_format, self.output_format) = (input, output),
            _ => return Err(wrong()),
        }
        Ok(())
    }

    fn fields(&mut self, word: &str) -> Result<(), Failure> {
        self.output.clear();
        for letter in word[2..].chars() {
            match Field::from_letter(letter) {
                Some(field) => self.output.push(field),
                None if OTHER_LETTERS.contains(letter) => {
                    return Err(Failure::usage(format!("rtrace: output \"{letter}\" of \"{word}\" is not supported")));
                }
                None => {
                    return Err(Failure::usage(format!(
                        "rtrace: \"{letter}\" of \"{word}\" is no output, expected some of vdolLpnNsmw"
                    )));
                }
            }
        }
        if self.output.is_empty() {
            return Err(Failure::usage("rtrace: option \"-o\" names no output, expected some of vdolLpnNsmw"));
        }
        Ok(())
    }
}
