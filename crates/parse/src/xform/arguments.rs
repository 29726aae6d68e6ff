//! The arguments of `xform`, with arrays and argument files expanded.

use crate::placement::{NewModifier, Placement};
use crate::syntax::{is_space, parse_integer};
use crate::transform_words;
use radsight_loader::{FileKind, LoadError, Loader};
use radsight_scene_generators::{Error, StandardInput};
use std::ops::Range;

/// Largest number of copies of one command.
pub(crate) const MAX_COPIES: usize = 10_000_000;

/// Largest nesting depth of argument files.
const MAX_DEPTH: usize = 32;

/// One step of the expansion.
pub(crate) enum Event<'a> {
    /// A comment or an empty line of an argument file.
    Comment(&'a str),
    /// One placement of all the files.
    Copy(&'a Copy),
}

/// One placement of all the files.
#[derive(Clone, Debug)]
pub(crate) struct Copy {
    /// The arguments of a real `xform` that makes this copy alone.
    pub(crate) words: Vec<String>,
    /// Range of the transform options in `words`.
    pub(crate) transform_words: Range<usize>,
    /// Their combined effect.
    pub(crate) placement: Placement,
    /// Whether commands in the files are run.
    pub(crate) runs_commands: bool,
    /// The files, each with its index among the user's arguments; standard input if empty.
    pub(crate) files: Vec<(String, usize)>,
    /// Index of the value of `-m` among the user's arguments.
    pub(crate) modifier_origin: Option<usize>,
}

/// A word and its index among the user's arguments.
#[derive(Clone)]
struct Argument {
    text: String,
    origin: usize,
}

/// Calls `visit` for every copy that the arguments request, in order.
///
/// # Errors
/// When the arguments are wrong or request too many copies, or when `visit` fails.
pub(crate) fn visit_copies(
    argv: &[String],
    standard_input: &dyn StandardInput,
    loader: &dyn Loader,
    visit: &mut dyn FnMut(Event<'_>) -> Result<(), Error>,
) -> Result<(), Error> {
    let words = argv.iter().enumerate().map(|(origin, text)| Argument { text: text.clone(), origin }).collect();
    let mut expansion = Expansion { standard_input, loader, visit, copies: 0, words: argv.len() };
    expansion.unroll(words, Nesting { depth: 0, copies: 1 })
}

/// The arrays and argument files around an argument list.
#[derive(Clone, Copy)]
struct Nesting {
    /// Depth of argument files.
    depth: usize,
    /// Number of copies that the surrounding arrays make.
    copies: u64,
}

struct Expansion<'a> {
    standard_input: &'a dyn StandardInput,
    loader: &'a dyn Loader,
    visit: &'a mut dyn FnMut(Event<'_>) -> Result<(), Error>,
    copies: usize,
    /// Number of the user's words.
    words: usize,
}

impl Expansion<'_> {
    fn unroll(&mut self, words: Vec<Argument>, nesting: Nesting) -> Result<(), Error> {
        if let Some(at) = words.iter().skip(1).position(|word| word.text == "-f") {
            return self.argument_file(&words, at + 1, nesting);
        }
        if let Some(at) = words.iter().skip(1).position(|word| word.text == "-a") {
            return self.array(&words, at + 1, nesting);
        }
        self.copies += 1;
        if self.copies > MAX_COPIES {
            let mistake = format!("the arrays make more than {MAX_COPIES} copies");
            return Err(self.too_much(words.get(1), mistake));
        }
        let copy = self.copy(&words)?;
        (self.visit)(Event::Copy(&copy))
    }

    /// `-a n`: the rest of the transform is applied 0, 1, … n−1 times.
    fn array(&mut self, words: &[Argument], at: usize, nesting: Nesting) -> Result<(), Error> {
        let Some(count_word) = words.get(at + 1) else { return Err(self.wrong(None, "missing count of -a")) };
        let count = match parse_integer(count_word.text.trim().as_bytes()) {
            Some(count) if count > 0 => count,
            _ => {
                let mistake = format!("the count of -a is \"{}\", expected an integer above zero", count_word.text);
                return Err(self.wrong(Some(count_word), mistake));
            }
        };
        let copies = nesting.copies.saturating_mul(count as u64);
        if copies > MAX_COPIES as u64 {
            let mistake = format!("the array makes {copies} copies, expected at most {MAX_COPIES}");
            return Err(self.too_much(Some(count_word), mistake));
        }
        let old_name = names(words).next_back().map(|at| words[at].text.clone());
        for index in 0..count {
            let mut copy = words.to_vec();
            copy[at].text = "-i".to_owned();
            copy[at + 1].text = index.to_string();
            match &old_name {
                Some(old) => names(words).for_each(|name| copy[name].text = format!("{old}.{index}")),
                None => insert_name(&mut copy, format!("a{index}")),
            }
            self.unroll(copy, Nesting { copies, ..nesting })?;
        }
        Ok(())
    }

    /// `-f file`: each line of the file replaces `-f file` in turn.
    fn argument_file(&mut self, words: &[Argument], at: usize, nesting: Nesting) -> Result<(), Error> {
        let Some(name) = words.get(at + 1).filter(|name| name.text == "-" || !name.text.starts_with('-')) else {
            return Err(self.wrong(words.get(at + 1), "missing file of -f"));
        };
        if nesting.depth >= MAX_DEPTH {
            let mistake = format!("argument files are nested more than {MAX_DEPTH} deep");
            return Err(self.wrong(Some(name), mistake));
        }
        let bytes = self.load(&name.text)?;
        let text = String::from_utf8_lossy(&bytes);
        let mut index = 0;
        for line in logical_lines(&text) {
            if line.is_empty() || line.starts_with('#') {
                (self.visit)(Event::Comment(&line))?;
                continue;
            }
            let mut copy = words[..at].to_vec();
            copy.extend(line_words(&line).into_iter().map(|text| Argument { text, origin: name.origin }));
            copy.extend_from_slice(&words[at + 2..]);
            let first_name = names(&copy).next();
            match first_name {
                Some(at) => copy[at].text = format!("{}.{index}", copy[at].text),
                None => insert_name(&mut copy, format!("i{index}")),
            }
            self.unroll(copy, Nesting { depth: nesting.depth + 1, ..nesting })?;
            index += 1;
        }
        if index == 0 {
            return Err(self.wrong(Some(name), format!("argument file \"{}\" has no arguments", name.text)));
        }
        Ok(())
    }

    fn load(&self, name: &str) -> Result<Vec<u8>, LoadError> {
        match name {
            "-" => self.standard_input.bytes().map(<[u8]>::to_vec),
            _ => self.loader.load(name, FileKind::Other).map(|loaded| loaded.bytes),
        }
    }

    fn copy(&self, words: &[Argument]) -> Result<Copy, Error> {
        let mut placement = Placement::default();
        let (mut runs_commands, mut modifier_origin) = (true, None);
        let mut at = 1;
        while let Some(word) = words.get(at) {
            match (&*word.text, words.get(at + 1)) {
                ("-m", Some(name)) => {
                    if placement.modifier.is_none() {
                        placement.modifier = Some(NewModifier { name: name.text.clone(), span: None });
                        modifier_origin = Some(name.origin);
                    }
                    at += 1;
                }
                ("-n", Some(name)) => {
                    if !placement.prefix.is_empty() {
                        placement.prefix.push('.');
                    }
                    placement.prefix.push_str(&name.text);
                    at += 1;
                }
                ("-c", _) => runs_commands = false,
                ("-e", _) => runs_commands = true,
                ("-I", _) => placement.inside_out = !placement.inside_out,
                _ => break,
            }
            at += 1;
        }
        let texts: Vec<String> = words.iter().map(|word| word.text.clone()).collect();
        let first = at.min(texts.len());
        let read = transform_words::read(&texts[first..]);
        if let Some(stopped) = read.stopped {
            return Err(self.wrong(words.get(first + stopped.index), stopped.mistake));
        }
        let end = first + read.taken;
        placement.transform = read.transform;
        if !(placement.transform.scale.is_finite() && placement.transform.translation.is_finite()) {
            return Err(self.wrong(words.get(first), "the transform overflows to infinity"));
        }
        let files = words[end..].iter().map(|file| (file.text.clone(), file.origin)).collect();
        Ok(Copy { transform_words: first..end, words: texts, placement, runs_commands, files, modifier_origin })
    }

    /// An error about a word, or about a missing one.
    fn wrong(&self, word: Option<&Argument>, mistake: impl Into<String>) -> Error {
        let argument = word.map_or(self.words, |word| word.origin);
        let usage = radsight_options::program("xform").map_or("", |program| program.synopsis);
        Error::Argument { program: "xform".to_owned(), mistake: mistake.into(), usage, argument }
    }

    fn too_much(&self, word: Option<&Argument>, mistake: String) -> Error {
        let argument = word.map_or(self.words, |word| word.origin);
        Error::Limit { program: "xform".to_owned(), mistake, argument }
    }
}

/// Indices of the values of `-n`.
fn names(words: &[Argument]) -> impl DoubleEndedIterator<Item = usize> + '_ {
    (2..words.len()).filter(|at| words[at - 1].text == "-n")
}

fn insert_name(words: &mut Vec<Argument>, name: String) {
    let origin = words[0].origin;
    let option = Argument { text: "-n".to_owned(), origin };
    words.splice(1..1, [option, Argument { text: name, origin }]);
}

/// Lines, where a `\` before the line end joins the next line.
fn logical_lines(text: &str) -> impl Iterator<Item = String> + '_ {
    let mut lines = text.lines();
    std::iter::from_fn(move || {
        let mut line = lines.next()?.to_owned();
        while line.ends_with('\\') {
            line.pop();
            line.push(' ');
            line.push_str(lines.next().unwrap_or_default());
        }
        Some(line)
    })
}

/// The words of a line of an argument file: quotes of either kind at the start of a word, `\`
/// before any character.
fn line_words(line: &str) -> Vec<String> {
    let line = line.strip_prefix('!').unwrap_or(line);
    let mut rest = line.strip_prefix("xform ").unwrap_or(line);
    let mut words = Vec::new();
    loop {
        rest = rest.trim_start_matches(|character: char| character.is_ascii() && is_space(character as u8));
        let Some(first) = rest.chars().next() else { return words };
        if first == '"' || first == '\'' {
            let (word, after) = rest[1..].split_once(first).unwrap_or((&rest[1..], ""));
            words.push(word.to_owned());
            rest = after;
            continue;
        }
        let rest_of_word = if first == '\\' { &rest[1..] } else { rest };
        let end = rest_of_word.find(|character: char| character.is_ascii() && is_space(character as u8));
        let (word, after) = rest_of_word.split_at(end.unwrap_or(rest_of_word.len()));
        words.push(word.to_owned());
        rest = after;
    }
}
