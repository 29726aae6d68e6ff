//! Expands words of a command line: `@FILE` to the words of a file, `$NAME` to those of an
//! environment variable.
//!
//! As in Radiance, only where an option may stand, and recursively. Each word keeps its origin, so
//! that the words of a file cannot extend the permissions of the command line.

use crate::failure::{Failure, reason};
use crate::option_table::{check_words, parse_option};
use crate::read_once;
use crate::trust::{Origin, Trust};
use radsight_options::Settings;
use std::path::Path;

/// Largest number of words.
const MOST_WORDS: usize = 1 << 16;

/// Largest nesting depth; a file that names itself ends here.
const MOST_EXPANSIONS: usize = 64;

/// The words of a command line, of which the first is the program's name, with their origins.
#[derive(Clone, Debug, Default)]
pub(crate) struct CommandWords {
    words: Vec<String>,
    origins: Vec<Origin>,
}

impl CommandWords {
    /// All words from one origin.
    pub(crate) fn new(words: &[String], origin: Origin) -> CommandWords {
        CommandWords { words: words.to_vec(), origins: vec![origin; words.len()] }
    }

    /// Adds words from one origin.
    pub(crate) fn extend(&mut self, words: impl IntoIterator<Item = String>, origin: Origin) {
        self.words.extend(words);
        self.origins.resize(self.words.len(), origin);
    }

    /// Adds words with their origins.
    pub(crate) fn append(&mut self, mut others: CommandWords) {
        self.words.append(&mut others.words);
        self.origins.append(&mut others.origins);
    }

    /// The words without their origins.
    pub(crate) fn words(&self) -> &[String] {
        &self.words
    }

    /// Expands the word at `at` repeatedly.
    fn expand_at(&mut self, at: usize) -> Result<(), Failure> {
        for _ in 0..MOST_EXPANSIONS {
            let Some(word) = self.words.get(at) else { return Ok(()) };
            let (text, origin) = if let Some(path) = word.strip_prefix('@').filter(|path| !path.is_empty()) {
                let text = read_once::owned(Path::new(path))
                    .map(|bytes| String::from_utf8_lossy(&bytes).into_owned())
                    .map_err(|error| Failure::usage(format!("cannot expand \"{word}\": {}", reason(&error))))?;
                (text, Origin::File)
            } else if let Some(name) = word.strip_prefix('$').filter(|name| !name.is_empty()) {
                let text = std::env::var(name)
                    .map_err(|_| Failure::usage(format!("cannot expand \"{word}\": no such environment variable")))?;
                // The origin of a variable is the word that names it.
                (text, self.origins[at])
            } else {
                return Ok(());
            };
            let meant: Vec<String> = text.split_whitespace().map(str::to_owned).collect();
            if self.words.len() + meant.len() > MOST_WORDS {
                return Err(Failure::usage(format!("cannot expand \"{word}\": more than {MOST_WORDS} words")));
            }
            self.origins.splice(at..=at, std::iter::repeat_n(origin, meant.len()));
            self.words.splice(at..=at, meant);
        }
        Err(Failure::usage(format!("cannot expand \"{}\": it refers to itself", self.words[at])))
    }
}

/// The options of a program, parsed one by one.
pub(crate) trait TakesOptions {
    /// The permissions; they are updated with the origin of each option before it is parsed.
    fn trust(&mut self) -> &mut Trust;

    /// The current options, which also identify the program.
    fn settings(&mut self) -> &mut Settings;

    /// Parses one option of the table at the front; returns the number of words it used, 0 for
    /// none.
    fn take(&mut self, words: &[String]) -> Result<usize, Failure>;
}

/// Parses the command line of a program. Returns the words up to the scenes, for a header, and the
/// scenes.
pub(crate) fn options_before_scenes(
    mut all: CommandWords,
    options: &mut impl TakesOptions,
) -> Result<(Vec<String>, Vec<String>), Failure> {
    let mut at = 1;
    loop {
        all.expand_at(at)?;
        match all.words.get(at) {
            Some(word) if word.starts_with('-') && word != "-" => {
                let program = options.settings().program();
                let found = parse_option(program, word)?;
                options.settings().note(&found, &all.words[at..]);
                options.trust().reads_word_of(all.origins[at]);
                let used = options.take(&all.words[at..])?;
                check_words(program, &found, word, used)?;
                at += used;
            }
            _ => break,
        }
    }
    let CommandWords { mut words, mut origins } = all;
    let scenes = words.split_off(at.min(words.len()));
    for (scene, origin) in scenes.iter().zip(origins.split_off(at.min(origins.len()))) {
        options.trust().reads_word_of(origin);
        options.trust().check_command(scene)?;
    }
    Ok((words, scenes))
}
