//! The current options of a program, and their listing by `-defaults` in Radiance's format.
//!
//! Scripts read the listing and pass it to programs again. Some options control approximations that
//! radsight does not make; their values have no effect but are listed as given.

use crate::option::{Listing, ProgramOption};
use crate::program::{ParsedOption, Program};

/// The given or default values of all options of a program.
#[derive(Clone, Debug)]
pub struct Settings {
    program: &'static Program,
    /// The values of each option, in table order; `+` or `-` for a switch.
    values: Vec<Vec<String>>,
    /// The names of the given options, the last one last.
    latest: Vec<&'static str>,
}

impl Settings {
    /// The defaults.
    #[must_use]
    pub fn new(program: &'static Program) -> Settings {
        let values = program.options().map(|option| words_of(program.default_of(option)));
        Settings { program, values: values.collect(), latest: Vec::new() }
    }

    /// The program.
    #[must_use]
    pub fn program(&self) -> &'static Program {
        self.program
    }

    /// Records a parsed option with the values after it.
    pub fn note(&mut self, found: &ParsedOption, words: &[String]) {
        let options = self.program.options();
        let Some((option, values)) =
            options.zip(&mut self.values).find(|(option, _)| std::ptr::eq(*option, found.option))
        else {
            return;
        };
        if let Some(Listing::Switch(_) | Listing::SwitchOn(_)) = option.listing {
            let was_on = values.first().is_some_and(|state| state == "+");
            let is_on = found.state.unwrap_or(!was_on);
            *values = words_of(if is_on { "+" } else { "-" });
            return;
        }
        *values = words.iter().skip(1).take(option.value_count()).cloned().collect();
        self.latest.retain(|known| *known != option.name);
        self.latest.push(option.name);
    }

    /// The last given of some options, with its values; `None` if none was given.
    #[must_use]
    pub fn latest(&self, among: &[&str]) -> Option<(&'static str, &[String])> {
        let name = self.latest.iter().rev().find(|name| among.contains(name))?;
        let (_, values) = self.program.options().zip(&self.values).find(|(option, _)| option.name == *name)?;
        Some((name, values))
    }

    /// The first value of an option as a number; 0 for none.
    #[must_use]
    pub fn number(&self, name: &str) -> f64 {
        let values = self.program.options().zip(&self.values).find(|(option, _)| option.name == name);
        values.and_then(|(_, values)| values.first()?.parse().ok()).unwrap_or(0.0)
    }

    /// The lines of the listing, in table order. `computed` returns lines that depend on more than
    /// the option's words, or `None` to omit them.
    #[must_use]
    pub fn lines(&self, computed: &dyn Fn(&'static ProgramOption) -> Option<String>) -> Vec<String> {
        let has_spectra = self.number("-cs") > 3.0;
        let lines = self.program.options().zip(&self.values).filter_map(|(option, values)| match option.listing? {
            Listing::Computed => computed(option),
            _ if matches!(option.name, "-cs" | "-cw") && !has_spectra => None,
            listing => line(option.name, listing, values),
        });
        lines.collect()
    }
}

fn words_of(text: &str) -> Vec<String> {
    text.split_whitespace().map(str::to_owned).collect()
}

fn line(name: &str, listing: Listing, values: &[String]) -> Option<String> {
    let numbers: Vec<f64> = values.iter().map(|word| word.parse().unwrap_or(0.0)).collect();
    let joined = |text: &dyn Fn(f64) -> String| numbers.iter().map(|value| text(*value)).collect::<Vec<_>>().join(" ");
    let is_on = values.first().is_some_and(|state| state == "+");
    Some(match listing {
        Listing::Switch(states) => {
            let (sign, state) = if is_on { ('+', states[1]) } else { ('-', states[0]) };
            format!("{name}{sign}\t\t\t\t# {state}")
        }
        Listing::SwitchOn(state) if is_on => format!("{name}+\t\t\t\t# {state}"),
        Listing::SwitchOn(_) | Listing::Computed => return None,
        Listing::Whole(width, tabs, what) => {
            let note = if name == "-lr" && numbers.first().is_some_and(|limit| *limit <= 0.0) {
                " (Russian roulette)"
            } else {
                ""
            };
            format!("{name} {}{tabs}# {what}{note}", joined(&|value| format!("{:<width$}", value as i64)))
        }
        Listing::Fixed(tabs, what) => format!("{name} {}{tabs}# {what}", joined(&|value| format!("{value:.6}"))),
        Listing::OneDigit(tabs, what) => format!("{name} {}{tabs}# {what}", joined(&|value| format!("{value:.1}"))),
        Listing::Scientific(tabs, what) => format!("{name} {}{tabs}# {what}", joined(&scientific)),
    })
}

/// A number as C's `%.2e` prints it.
fn scientific(value: f64) -> String {
    let text = format!("{value:.2e}");
    let Some((digits, exponent)) = text.split_once('e') else { return text };
    let (sign, size) = exponent.strip_prefix('-').map_or(('+', exponent), |size| ('-', size));
    format!("{digits}e{sign}{size:0>2}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noted(program: &str, line: &str) -> Settings {
        let words: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
        let mut settings = Settings::new(crate::program(program).expect("a program"));
        let mut at = 0;
        while at < words.len() {
            let found = settings.program().parse_word(&words[at]).expect("an option");
            settings.note(&found, &words[at..]);
            at += found.words();
        }
        settings
    }

    #[test]
    fn options_without_effect_are_shown_as_they_are_given() {
        let lines = noted("rtrace", "-ds .05 -lr 4 -me 1e-3 2e-3 0 -u- -cs 20").lines(&|_| None);
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
        let threshold = |program| noted(program, "").number("-dt");
        assert_eq!(["rtrace", "rpict", "rcontrib"].map(threshold), [0.03, 0.05, 0.0]);
        assert!(noted("rpict", "-pt 0").lines(&|_| None).contains(&"-pt 0.000000\t\t\t# pixel threshold".to_owned()));
    }

    #[test]
    fn the_last_of_several_options_counts() {
        let settings = noted("rtrace", "-pXYZ -pY -w- -pXYZ");
        assert_eq!(settings.latest(&["-pXYZ", "-pY"]).map(|(name, _)| name), Some("-pXYZ"));
        assert_eq!(settings.latest(&["-pRGB"]), None);
    }

    #[test]
    fn a_bare_switch_turns_over() {
        let state =
            |line: &str| noted("rtrace", line).lines(&|_| None).into_iter().find(|line| line.starts_with("-bv"));
        assert!(state("").expect("a line").starts_with("-bv+"));
        assert!(state("-bv").expect("a line").starts_with("-bv-"));
        assert!(state("-bv -bv").expect("a line").starts_with("-bv+"));
        assert!(state("-bv0 -bv-").expect("a line").starts_with("-bv-"));
    }
}
