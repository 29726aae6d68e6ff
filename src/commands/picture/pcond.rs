//! `pcond`: tone maps a picture for a display as an observer would see the scene.
//!
//! `-h` all limits of the eye, or `-a` acuity, `-v` veiling glare, `-s` contrast sensitivity, `-c`
//! colour sensitivity, each toggled, or on (`+`) or off (`-`); `-w` weights the centre, `-i F`
//! reads fixation points from standard input with a weight F, `-I` reads a histogram from standard
//! input; `-l` linear, `-e E` linear with this factor (with a sign, stops); `-u L` largest
//! luminance of the display in cd/m², `-d R` its dynamic range; `-p …` its primaries, `-f FILE` its
//! calibration by macbethcal, `-m FILE` a colour warp; `-x FILE` writes the mapping.

use super::files::{failed, open_twice, put_file};
use crate::commands::words::Words;
use crate::failure::{Failure, Outcome};
use crate::input::{read_file, read_standard_input, use_default_threads};
use crate::output::{reserve_output, write_file};
use crate::switch::switched;
use crate::trust::OutputName;
use radsight_picture::{leading_number, scientific};
use radsight_picture_ops::condition::{
    Adaptation, ColorWarp, ConditionOptions, Device, Exposure, Eye, Macbeth, MappedLuminance, MeasuredHistogram,
    condition,
};
use std::mem::discriminant;

/// The source of adaptation.
#[derive(Clone, Copy, PartialEq)]
enum Source {
    Picture,
    Fixations { share: f64 },
    Histogram,
}

struct Typed {
    options: ConditionOptions,
    source: Source,
    center_weighted: bool,
    map: Option<OutputName>,
}

/// Runs the program.
pub(super) fn run(mut words: Words<'_>) -> Outcome {
    let mut typed = read_options(&mut words)?;
    if words.rest().is_empty() {
        return Err(Failure::usage("pcond: no picture is given, expected a file"));
    }
    let (path, target) = words.input_and_output()?;
    for file in [Some(target), typed.map.as_deref()].into_iter().flatten() {
        reserve_output(file)?;
    }
    typed.options.adaptation = adaptation(&typed)?;
    let source = open_twice(path)?;
    use_default_threads()?;
    let mut map = Vec::new();
    put_file(target, |out| {
        map = condition(source, &typed.options, &words.all(), out).map_err(|error| failed(path, error))?;
        Ok(())
    })?;
    match &typed.map {
        Some(file) => write_file(file, map_text(&map).as_bytes()),
        None => Ok(()),
    }
}

fn read_options(words: &mut Words<'_>) -> Result<Typed, Failure> {
    let options = ConditionOptions::default();
    let mut typed = Typed { options, source: Source::Picture, center_weighted: false, map: None };
    while let Some(option) = words.option()? {
        if !typed.take_switch(option)? {
            typed.take(option, words)?;
        }
    }
    Ok(typed)
}

impl Typed {
    /// Parses a switch; `false` if the option is not a switch.
    fn take_switch(&mut self, option: &str) -> Result<bool, Failure> {
        let eye = &mut self.options.eye;
        let is_all = *eye == Eye { acuity: true, veil: true, sensitivity: true, color: true };
        if let Some(all) = switched(option, "-h", is_all) {
            // A bare -h toggles each.
            let set = |now: bool| if option == "-h" { !now } else { all };
            *eye = Eye {
                acuity: set(eye.acuity),
                veil: set(eye.veil),
                sensitivity: set(eye.sensitivity),
                color: set(eye.color),
            };
            return Ok(true);
        }
        for (name, flag) in [
            ("-a", &mut eye.acuity),
            ("-v", &mut eye.veil),
            ("-s", &mut eye.sensitivity),
            ("-c", &mut eye.color),
            ("-w", &mut self.center_weighted),
        ] {
            if let Some(state) = switched(option, name, *flag) {
                *flag = state;
                return Ok(true);
            }
        }
        if let Some(linear) = switched(option, "-l", self.options.exposure != Exposure::Histogram) {
            self.options.exposure = match (linear, self.options.exposure) {
                (true, Exposure::Histogram) => Exposure::Linear,
                (true, given) => given,
                (false, _) => Exposure::Histogram,
            };
            return Ok(true);
        }
        if let Some(given) = switched(option, "-I", self.source == Source::Histogram) {
            self.choose(if given { Source::Histogram } else { Source::Picture })?;
            return Ok(true);
        }
        Ok(false)
    }

    fn take(&mut self, option: &str, words: &mut Words<'_>) -> Outcome {
        const LEAST: f64 = 1e-6;
        match option {
            "-i" => {
                let share = words.number(option)?;
                self.choose(if share > LEAST { Source::Fixations { share: share.min(1.0) } } else { Source::Picture })?;
            }
            "-e" => {
                let word = words.value(option, "an exposure")?;
                let number = words.number_in(word, option)?;
                let factor = if word.starts_with(['+', '-']) { 2f64.powf(number) } else { number };
                self.options.exposure = Exposure::Factor(factor);
            }
            "-p" => self.show_with(Device::Primaries(words.primaries(option)?))?,
            "-f" => {
                let path = words.value(option, "a file that macbethcal wrote")?;
                let bytes = read_file(path, "calibration")?;
                let missing = |what| Failure::input(format!("{path}: expected \"{what}\" as macbethcal writes it"));
                let calibration = Macbeth::read(&String::from_utf8_lossy(&bytes)).map_err(missing)?;
                self.show_with(Device::Macbeth(calibration))?;
            }
            "-m" => {
                let path = words.value(option, "a file of colours and what each becomes")?;
                let bytes = read_file(path, "colour warp")?;
                let missing = |what| Failure::input(format!("{path}: expected {what}"));
                let warp = ColorWarp::read(&String::from_utf8_lossy(&bytes)).map_err(missing)?;
                self.show_with(Device::Warp(warp))?;
            }
            "-u" => self.options.display_top = above(words.number(option)?, LEAST, "-u")?,
            "-d" => self.options.display_range = above(words.number(option)?, 1.0, "-d")?,
            "-x" => self.map = Some(words.output_value(option, "a file")?),
            _ => return Err(words.unknown(option)),
        }
        Ok(())
    }

    fn choose(&mut self, source: Source) -> Outcome {
        let is_other = discriminant(&source) != discriminant(&self.source);
        if is_other && source != Source::Picture && self.source != Source::Picture {
            return Err(Failure::usage("pcond: options \"-i\" and \"-I\" both read standard input, expected one"));
        }
        self.source = source;
        Ok(())
    }

    fn show_with(&mut self, device: Device) -> Outcome {
        let is_other = discriminant(&device) != discriminant(&self.options.device);
        if is_other && self.options.device != Device::Standard {
            return Err(Failure::usage("pcond: options \"-p\", \"-f\" and \"-m\" exclude each other"));
        }
        self.options.device = device;
        Ok(())
    }
}

fn above(number: f64, least: f64, option: &str) -> Result<f64, Failure> {
    if number > least {
        return Ok(number);
    }
    Err(Failure::usage(format!("pcond: option \"{option}\" is followed by {number}, expected more than {least}")))
}

/// Reads what standard input holds for the adaptation.
fn adaptation(typed: &Typed) -> Result<Adaptation, Failure> {
    let center_weighted = typed.center_weighted;
    let mut fixations = None;
    match typed.source {
        Source::Picture => {}
        Source::Fixations { share } => {
            let places = pairs("fixations")?.into_iter().map(|pair| pair.map(|number| number as i64)).collect();
            fixations = Some((places, share));
        }
        Source::Histogram => {
            let histogram = MeasuredHistogram::new(&pairs("histogram")?);
            let wrong = |reason| Failure::input(format!("histogram on standard input: {reason}"));
            return Ok(Adaptation::Measured(histogram.map_err(wrong)?));
        }
    }
    Ok(Adaptation::Everything { center_weighted, fixations })
}

/// The pairs of numbers on standard input.
fn pairs(what: &str) -> Result<Vec<[f64; 2]>, Failure> {
    let bytes = read_standard_input()?;
    let mut numbers = Vec::new();
    for word in bytes.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()) {
        let (number, used) = leading_number(word);
        if used != word.len() || !number.is_finite() {
            let word = String::from_utf8_lossy(word);
            return Err(Failure::input(format!("{what} on standard input: \"{word}\" is not a number")));
        }
        numbers.push(number);
    }
    match numbers.as_chunks::<2>() {
        (pairs, []) => Ok(pairs.to_vec()),
        _ => Err(Failure::input(format!("{what} on standard input: an odd number of numbers, expected pairs"))),
    }
}

fn map_text(map: &[MappedLuminance]) -> String {
    map.iter().map(|[world, shown]| format!("{} {}\n", scientific(*world, 6), scientific(*shown, 6))).collect()
}
