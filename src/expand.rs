//! Words of a command line that stand for others: `@FILE` for the words of a file, `$NAME` for those of an environment variable.
//!
//! As in Radiance, only where an option could stand, and what a file or variable holds may stand
//! for others again. Each word keeps who wrote it, so that the words of a file cannot widen what
//! the command line allows.

use crate::failure::{Failure, reason};
use crate::option_table::{check_words, recognised};
use crate::read_once;
use crate::trust::{Origin, Trust};
use radsight_options::Settings;
use std::path::Path;

/// More words than any command line needs.
const MOST_WORDS: usize = 1 << 16;

/// Deeper than any file needs: one that names itself ends here.
const MOST_EXPANSIONS: usize = 64;

/// The words of a command line, of which the first is the program's name, and who wrote each.
#[derive(Clone, Debug, Default)]
pub(crate) struct CommandWords {
    words: Vec<String>,
    origins: Vec<Origin>,
}

impl CommandWords {
    /// All of them by one author.
    pub(crate) fn new(words: &[String], origin: Origin) -> CommandWords {
        CommandWords { words: words.to_vec(), origins: vec![origin; words.len()] }
    }

    /// Adds words of one author.
    pub(crate) fn extend(&mut self, words: impl IntoIterator<Item = String>, origin: Origin) {
        self.words.extend(words);
        self.origins.resize(self.words.len(), origin);
    }

    /// Adds words with their authors.
    pub(crate) fn append(&mut self, mut others: CommandWords) {
        self.words.append(&mut others.words);
        self.origins.append(&mut others.origins);
    }

    /// The words without their authors.
    pub(crate) fn words(&self) -> &[String] {
        &self.words
    }

    /// Replaces the word at `at` as long as it stands for others.
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
                // Whoever names the variable chooses what is said.
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
        Err(Failure::usage(format!("cannot expand \"{}\": it stands for itself", self.words[at])))
    }
}

/// The options of a program, taken one after another.
pub(crate) trait TakesOptions {
    /// What the command line allows; it is told who wrote each option before that is taken.
    fn trust(&mut self) -> &mut Trust;

    /// The options as they stand, which say what program this is.
    fn settings(&mut self) -> &mut Settings;

    /// Takes one option from the front, which the table has; gives how many words it used, 0 for none.
    fn take(&mut self, words: &[String]) -> Result<usize, Failure>;
}

/// Reads the command line of a program. Gives the words up to the scenes, as a header has them, and
/// the scenes.
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
                let found = recognised(program, word)?;
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
