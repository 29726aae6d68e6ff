//! Words of a command line that stand for others: `@FILE` for the words of a file, `$NAME` for those of an environment variable.
//!
//! As in Radiance, only where an option could stand, and what a file or variable holds may stand for others again.

use crate::failure::{Failure, reason};
use crate::read_once;
use std::path::Path;

/// More words than any command line needs.
const MOST_WORDS: usize = 1 << 16;

/// Deeper than any file needs: one that names itself ends here.
const MOST_EXPANSIONS: usize = 64;

/// Reads the command line of a program, of which the first word is its name: `take` takes one option from the front and says how many words it
/// used. Gives the words up to the scenes, as a header has them, and the scenes.
pub(crate) fn options_before_scenes(
    words: &[String],
    mut take: impl FnMut(&[String]) -> Result<usize, Failure>,
) -> Result<(Vec<String>, Vec<String>), Failure> {
    let mut words = words.to_vec();
    let mut at = 1;
    loop {
        expand_at(&mut words, at)?;
        match words.get(at) {
            Some(word) if word.starts_with('-') && word != "-" => at += take(&words[at..])?,
            _ => break,
        }
    }
    let scenes = words.split_off(at);
    Ok((words, scenes))
}

/// Replaces the word at `at` as long as it stands for others.
fn expand_at(words: &mut Vec<String>, at: usize) -> Result<(), Failure> {
    for _ in 0..MOST_EXPANSIONS {
        let Some(word) = words.get(at) else { return Ok(()) };
        let text = if let Some(path) = word.strip_prefix('@').filter(|path| !path.is_empty()) {
            read_once::owned(Path::new(path))
                .map(|bytes| String::from_utf8_lossy(&bytes).into_owned())
                .map_err(|error| Failure::usage(format!("cannot expand \"{word}\": {}", reason(&error))))?
        } else if let Some(name) = word.strip_prefix('$').filter(|name| !name.is_empty()) {
            std::env::var(name)
                .map_err(|_| Failure::usage(format!("cannot expand \"{word}\": no such environment variable")))?
        } else {
            return Ok(());
        };
        let meant: Vec<String> = text.split_whitespace().map(str::to_owned).collect();
        if words.len() + meant.len() > MOST_WORDS {
            return Err(Failure::usage(format!("cannot expand \"{word}\": more than {MOST_WORDS} words")));
        }
        words.splice(at..=at, meant);
    }
    Err(Failure::usage(format!("cannot expand \"{}\": it stands for itself", words[at])))
}
