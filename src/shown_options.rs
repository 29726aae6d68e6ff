//! The options of rendering as `-defaults` prints them, in Radiance's form and with Radiance's values.
//!
//! Scripts read them, and give them to a program again. Some steer approximations that radsight does not make: their
//! values change nothing, but are shown as they were given. This is kept apart from the renderer's own options.

use crate::output_format::OutputFormat;
use crate::switch::switched;
use radsight_picture::scientific;
use radsight_pinhole::stream::NumberFormat;

/// A program that prints its options.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Program {
    Rtrace,
    Rpict,
    Rcontrib,
    Mkillum,
}

/// How the values of an option are written.
#[derive(Clone, Copy, Debug)]
enum Form {
    /// What it means when it is off and on.
    Switch([&'static str; 2]),
    /// Whole numbers, padded to this width, with tabs after them.
    Whole(usize, &'static str),
    /// Numbers with six digits after the point, with tabs after them.
    Fixed(&'static str),
    /// Numbers with an exponent and two digits after the point, with tabs after them.
    Scientific(&'static str),
}
use Form::{Fixed, Scientific, Switch, Whole};

/// An option: its name, how it is written, what it is, and what it is in `rtrace` unless it is given.
type Entry = (&'static str, Form, &'static str, &'static [f64]);

/// In the order in which Radiance prints them.
const ENTRIES: [Entry; 30] = [
    ("-ps", Whole(9, "\t\t\t"), "pixel sample", &[4.0]),
    ("-pt", Fixed("\t\t\t"), "pixel threshold", &[0.05]),
    ("-i", Switch(["irradiance calculation off", "irradiance calculation on"]), "", &[0.0]),
    ("-u", Switch(["correlated quasi-Monte Carlo sampling", "uncorrelated Monte Carlo sampling"]), "", &[1.0]),
    ("-bv", Switch(["back face visibility off", "back face visibility on"]), "", &[1.0]),
    ("-dt", Fixed("\t\t\t"), "direct threshold", &[0.03]),
    ("-dc", Fixed("\t\t\t"), "direct certainty", &[0.75]),
    ("-dj", Fixed("\t\t\t"), "direct jitter", &[0.0]),
    ("-ds", Fixed("\t\t\t"), "direct sampling", &[0.2]),
    ("-dr", Whole(9, "\t\t\t"), "direct relays", &[2.0]),
    ("-dp", Whole(9, "\t\t\t"), "direct pretest density", &[512.0]),
    ("-dv", Switch(["direct visibility off", "direct visibility on"]), "", &[1.0]),
    ("-ss", Fixed("\t\t\t"), "specular sampling", &[1.0]),
    ("-st", Fixed("\t\t\t"), "specular threshold", &[0.15]),
    ("-av", Fixed("\t"), "ambient value", &[0.0; 3]),
    ("-aw", Whole(9, "\t\t\t"), "ambient value weight", &[0.0]),
    ("-ab", Whole(9, "\t\t\t"), "ambient bounces", &[0.0]),
    ("-aa", Fixed("\t\t\t"), "ambient accuracy", &[0.1]),
    ("-ar", Whole(9, "\t\t\t"), "ambient resolution", &[256.0]),
    ("-ad", Whole(9, "\t\t\t"), "ambient divisions", &[1024.0]),
    ("-as", Whole(9, "\t\t\t"), "ambient super-samples", &[512.0]),
    ("-me", Scientific("\t"), "mist extinction coefficient", &[0.0; 3]),
    ("-ma", Fixed("\t"), "mist scattering albedo", &[0.0; 3]),
    ("-mg", Fixed("\t\t\t"), "mist scattering eccentricity", &[0.0]),
    ("-ms", Fixed("\t\t\t"), "mist sampling distance", &[0.0]),
    ("-cs", Whole(2, "\t\t\t\t"), "number of spectral bins", &[3.0]),
    ("-cw", Whole(3, "\t\t\t"), "wavelength limits (nm)", &[380.0, 780.0]),
    ("-lr", Whole(9, "\t\t\t"), "limit reflection", &[-10.0]),
    ("-lw", Scientific("\t\t\t"), "limit weight", &[1e-4]),
    ("-am", Fixed("\t\t\t\t"), "max photon search radius", &[0.0]),
];

/// The options that belong to pictures.
const OF_PICTURES: [&str; 2] = ["-ps", "-pt"];

/// What differs from `rtrace` in the other programs, as they come.
const OF_RPICT: [(&str, f64); 11] = [
    ("-u", 0.0),
    ("-dt", 0.05),
    ("-dc", 0.5),
    ("-ds", 0.25),
    ("-dr", 1.0),
    ("-aa", 0.2),
    ("-ar", 64.0),
    ("-ad", 512.0),
    ("-as", 128.0),
    ("-lr", 7.0),
    ("-lw", 1e-4),
];
const OF_RCONTRIB: [(&str, f64); 9] = [
    ("-dt", 0.0),
    ("-dj", 0.9),
    ("-dr", 3.0),
    ("-st", 0.02),
    ("-ab", 1.0),
    ("-aa", 0.0),
    ("-ad", 350.0),
    ("-as", 0.0),
    ("-lw", 2e-3),
];
const OF_MKILLUM: [(&str, f64); 3] = [("-dj", 0.5), ("-dr", 3.0), ("-ab", 2.0)];

/// The options of a program as they stand.
#[derive(Clone, Debug)]
pub(crate) struct ShownOptions {
    /// One list for each of [`ENTRIES`].
    values: Vec<Vec<f64>>,
    /// The words that ask for the components of values (`-p…`).
    color: Vec<String>,
}

impl ShownOptions {
    /// Those that nothing was said about.
    pub(crate) fn new(program: Program) -> ShownOptions {
        let own: &[(&str, f64)] = match program {
            Program::Rtrace => &[],
            Program::Rpict => &OF_RPICT,
            Program::Rcontrib => &OF_RCONTRIB,
            Program::Mkillum => &OF_MKILLUM,
        };
        let values = ENTRIES.iter().map(|(name, _, _, usual)| {
            let own = own.iter().find(|(own, _)| own == name);
            own.map_or(usual.to_vec(), |(_, value)| vec![*value])
        });
        ShownOptions { values: values.collect(), color: vec!["-pRGB".to_owned()] }
    }

    /// Keeps what the first of some words says, if it is one of these options.
    pub(crate) fn note(&mut self, words: &[String]) {
        let word = words[0].as_str();
        match word {
            "-pRGB" | "-pXYZ" | "-pY" | "-pS" | "-pM" | "-pA" => self.color = words[..1].to_vec(),
            "-pc" => self.color = words.iter().take(9).cloned().collect(),
            _ => {}
        }
        for ((name, form, ..), values) in ENTRIES.iter().zip(&mut self.values) {
            if let Switch(_) = form {
                if let Some(on) = switched(word, name, values[0] != 0.0) {
                    values[0] = f64::from(u8::from(on));
                }
            } else if word == *name {
                let given = words[1..].iter().take(values.len()).map_while(|word| word.parse().ok());
                values.iter_mut().zip(given).for_each(|(value, given)| *value = given);
            }
        }
    }

    /// What components values have.
    pub(crate) fn color_line(&self) -> String {
        let word = self.color[0].as_str();
        let what = match word {
            "-pXYZ" => "CIE XYZ color output",
            "-pY" => "photopic output",
            "-pS" => "scotopic output",
            "-pM" => "melanopic output",
            "-pA" => "average output",
            "-pc" => {
                let numbers = self.color[1..].iter().filter_map(|word| word.parse().ok());
                let numbers: Vec<String> = numbers.map(|number: f64| format!(" {number:.4}")).collect();
                return format!("-pc{}\t# output color primaries and white point", numbers.concat());
            }
            _ => "standard RGB color output",
        };
        format!("{word}\t\t\t\t# {what}")
    }

    /// The spacing and threshold of pixels.
    pub(crate) fn pixel_lines(&self) -> Vec<String> {
        self.lines_of(|name| OF_PICTURES.contains(&name))
    }

    /// The options that all programs have.
    pub(crate) fn lines(&self) -> Vec<String> {
        let has_spectra = self.value("-cs") > 3.0;
        self.lines_of(|name| !OF_PICTURES.contains(&name) && (has_spectra || !matches!(name, "-cs" | "-cw")))
    }

    fn value(&self, name: &str) -> f64 {
        let place = ENTRIES.iter().position(|entry| entry.0 == name);
        place.map_or(0.0, |place| self.values[place][0])
    }

    fn lines_of(&self, wanted: impl Fn(&str) -> bool) -> Vec<String> {
        let entries = ENTRIES.iter().zip(&self.values).filter(|(entry, _)| wanted(entry.0));
        entries.map(|((name, form, what, _), values)| line(name, *form, what, values)).collect()
    }
}

/// Whether warnings are shown (`-w`).
pub(crate) fn warning_line(are_hidden: bool) -> String {
    if are_hidden { "-w-\t\t\t\t# warning messages off" } else { "-w+\t\t\t\t# warning messages on" }.to_owned()
}

/// How many threads there are (`-n`): those of the machine where nothing is said.
pub(crate) fn process_line(threads: Option<usize>) -> String {
    format!("-n {:<2}\t\t\t\t# number of rendering processes", threads.unwrap_or_else(rayon::current_num_threads))
}

/// Columns and rows of the output (`-x`, `-y`).
pub(crate) fn size_lines([columns, rows]: [u64; 2]) -> [String; 2] {
    let what = if columns > 0 && rows > 0 { "x resolution" } else { "flush interval" };
    [format!("-x {columns:<9}\t\t\t# {what}"), format!("-y {rows:<9}\t\t\t# y resolution")]
}

/// The formats of input and output (`-f`).
pub(crate) fn format_line(input: NumberFormat, output: OutputFormat) -> String {
    let [input, output] = [OutputFormat::Numbers(input), output].map(|format| format.name("32-bit_rle_rgbe"));
    let letter = |name: &str| if name.starts_with('3') { 'c' } else { name.chars().next().unwrap_or('a') };
    format!("-f{}{}\t\t\t\t# format input/output = {input}/{output}", letter(input), letter(output))
}

fn line(name: &str, form: Form, what: &str, values: &[f64]) -> String {
    let joined = |text: &dyn Fn(f64) -> String| values.iter().map(|value| text(*value)).collect::<Vec<_>>().join(" ");
    let note = if name == "-lr" && values[0] <= 0.0 { " (Russian roulette)" } else { "" };
    match form {
        Switch(states) => {
            let (sign, state) = if values[0] == 0.0 { ('-', states[0]) } else { ('+', states[1]) };
            format!("{name}{sign}\t\t\t\t# {state}")
        }
        Whole(width, tabs) => {
            let text = joined(&|value| format!("{:<width$}", value as i64));
            format!("{name} {text}{tabs}# {what}{note}")
        }
        // The photon maps' option is written in a way of its own.
        Fixed(tabs) if name == "-am" => format!("{name} {:.1}{tabs}# {what}", values[0]),
        Fixed(tabs) => format!("{name} {}{tabs}# {what}", joined(&|value| format!("{value:.6}"))),
        Scientific(tabs) => format!("{name} {}{tabs}# {what}", joined(&|value| scientific(value, 2))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noted(program: Program, line: &str) -> ShownOptions {
        let words: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
        let mut shown = ShownOptions::new(program);
        (0..words.len()).for_each(|at| shown.note(&words[at..]));
        shown
    }

    #[test]
    fn options_without_effect_are_shown_as_they_are_given() {
        let lines = noted(Program::Rtrace, "-ds .05 -lr 4 -me 1e-3 2e-3 0 -u- -cs 20").lines();
        for line in [
            "-ds 0.050000\t\t\t# direct sampling",
            "-lr 4        \t\t\t# limit reflection",
            "-me 1.00e-03 2.00e-03 0.00e+00\t# mist extinction coefficient",
            "-u-\t\t\t\t# correlated quasi-Monte Carlo sampling",
            "-cs 20\t\t\t\t# number of spectral bins",
            "-cw 380 780\t\t\t# wavelength limits (nm)",
            "-lw 1.00e-04\t\t\t# limit weight",
        ] {
            assert!(lines.iter().any(|shown| shown == line), "{line:?} is not among {lines:#?}");
        }
    }

    #[test]
    fn each_program_has_its_own_values() {
        let threshold = |program| noted(program, "").value("-dt");
        assert_eq!([Program::Rtrace, Program::Rpict, Program::Rcontrib].map(threshold), [0.03, 0.05, 0.0]);
        assert_eq!(noted(Program::Rpict, "-pt 0").pixel_lines()[1], "-pt 0.000000\t\t\t# pixel threshold");
    }
}
