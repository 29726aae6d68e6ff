//! One program: its options, in groups.

use crate::option::{OptionForm, ProgramOption};
use radsight_diag::nearest;

/// A program.
#[derive(Clone, Copy, Debug)]
pub struct Program {
    /// Its name.
    pub name: &'static str,
    /// Its purpose, in one line without a full stop.
    pub summary: &'static str,
    /// Its command line.
    pub synopsis: &'static str,
    /// A description for its manual page; empty for none.
    pub description: &'static str,
    /// The options in the order of help and `-defaults`.
    pub groups: &'static [Group],
    /// Defaults that differ from those of shared options: name and values.
    pub defaults: &'static [(&'static str, &'static str)],
}

/// Options under a heading.
#[derive(Clone, Copy, Debug)]
pub struct Group {
    /// The heading.
    pub title: &'static str,
    /// The options.
    pub options: &'static [ProgramOption],
}

/// A word parsed as an option.
#[derive(Clone, Copy, Debug)]
pub struct ParsedOption {
    /// The option.
    pub option: &'static ProgramOption,
    /// The state set by a switch; `None` for other options, and for a switch that is toggled.
    pub state: Option<bool>,
}

impl ParsedOption {
    /// Number of words of the option, including its own.
    #[must_use]
    pub fn words(&self) -> usize {
        1 + self.option.value_count()
    }
}

/// Largest number of options listed in an error.
const MOST_LISTED: usize = 24;

impl Program {
    /// All options.
    pub fn options(&self) -> impl Iterator<Item = &'static ProgramOption> + use<> {
        self.groups.iter().flat_map(|group| group.options)
    }

    /// The default of an option in this program.
    #[must_use]
    pub fn default_of(&self, option: &ProgramOption) -> &'static str {
        self.defaults.iter().find(|(name, _)| *name == option.name).map_or(option.default, |(_, own)| own)
    }

    /// Parses a word as an option. An exact name takes precedence over a switch, and a switch over
    /// the longest prefix.
    #[must_use]
    pub fn parse_word(&self, word: &str) -> Option<ParsedOption> {
        let plain = |option| ParsedOption { option, state: None };
        let is_whole = |option: &&ProgramOption| option.form != OptionForm::Attached;
        let whole = self.options().filter(is_whole).find(|option| option.names().any(|name| name == word));
        if let Some(option) = whole {
            return Some(plain(option));
        }
        let toggled = self.options().filter(|option| option.form == OptionForm::Switch).find_map(|option| {
            let state = match word.strip_prefix(option.name)? {
                "+" | "1" => Some(true),
                "-" | "0" => Some(false),
                _ => return None,
            };
            Some(ParsedOption { option, state })
        });
        toggled.or_else(|| self.options().filter(|option| begins(option, word)).max_by_key(longest).map(plain))
    }

    /// The option most similar to a word, if a typing error is likely.
    #[must_use]
    pub fn near(&self, word: &str) -> Option<&'static str> {
        let names = || self.options().flat_map(ProgramOption::names);
        let other_case = names().find(|name| name.eq_ignore_ascii_case(word) && *name != word);
        // A name of two characters is similar to all others of two characters.
        let long_enough = |name: &&str| name.len().min(word.len()) > 2;
        other_case.or_else(|| nearest(word, names().filter(long_enough)))
    }

    /// The hint for an unknown option: the most similar option, or where options are listed.
    #[must_use]
    pub fn hint(&self, word: &str) -> String {
        if let Some(near) = self.near(word) {
            return format!("did you mean \"{near}\"?");
        }
        let own: Vec<&str> = self.options().map(|option| option.name).filter(|name| !name.starts_with("--")).collect();
        match own.len() {
            0 => format!("{} has no options of its own", self.name),
            1..=MOST_LISTED => format!("expected {}", own.join(" ")),
            _ => format!("\"{} --help\" lists the options", self.name),
        }
    }
}

fn begins(option: &ProgramOption, word: &str) -> bool {
    match option.form {
        OptionForm::Attached | OptionForm::Beginning => option.names().any(|name| word.starts_with(name)),
        OptionForm::Signed => word.strip_prefix('+').is_some_and(|bare| bare == &option.name[1..]),
        OptionForm::Word | OptionForm::Switch => false,
    }
}

fn longest(option: &&'static ProgramOption) -> usize {
    option.name.len()
}
