//! Words of a command line that stand for others: `@FILE` for the words of a file, `$NAME` for those of an environment variable.
//!
//! As in Radiance, only where an option could stand, and what a file or variable holds may stand for others again.

use crate::failure::{Failure, reason};

/// More words than any command line needs.
const MOST_WORDS: usize = 1 << 16;

/// Deeper than any file needs: one that names itself ends here.
const MOST_EXPANSIONS: usize = 64;

/// Replaces the word at `at` as long as it stands for others.
pub(crate) fn expand_at(words: &mut Vec<String>, at: usize) -> Result<(), Failure> {
    for _ in 0..MOST_EXPANSIONS {
        let Some(word) = words.get(at) else { return Ok(()) };
        let text = if let Some(path) = word.strip_prefix('@').filter(|path| !path.is_empty()) {
            std::fs::read(path)
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
