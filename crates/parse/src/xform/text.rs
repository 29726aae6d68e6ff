//! Scene text in, scene text out.

use super::arguments::{Copy, Event, visit_copies};
use crate::commands::{DirectoryLoader, command_line, directory_of};
use crate::syntax::{Item, Items, Primitive, Word, is_space};
use crate::{Kind, placement::Placement};
use radsight_diag::SourceMap;
use radsight_loader::{FileKind, LoadError, Loader};
use radsight_scene_generators::{Error, MAX_OUTPUT_BYTES, Output, StandardInput, WrittenFiles, padded};
use std::io::Write;

/// Largest nesting depth of commands.
const MAX_DEPTH: usize = 32;

/// Runs `xform` on text. `argv[0]` is the program's name; without files, it reads standard input.
///
/// # Errors
/// When an argument, a file or a primitive is wrong, a command in a file fails, or the output is
/// too large.
pub fn xform(argv: &[String], standard_input: &dyn StandardInput, loader: &dyn Loader) -> Result<Output, Error> {
    run(argv, standard_input, loader, 0)
}

pub(crate) fn run(
    argv: &[String],
    standard_input: &dyn StandardInput,
    loader: &dyn Loader,
    depth: usize,
) -> Result<Output, Error> {
    if depth > MAX_DEPTH {
        return Err(too_deep());
    }
    let mut output = Output::default();
    visit_copies(argv, standard_input, loader, &mut |event| {
        match event {
            Event::Comment(line) => writeln!(output.standard_output, "{line}").map_err(too_large)?,
            Event::Copy(copy) => place_files(copy, standard_input, loader, depth, &mut output)?,
        }
        Ok(())
    })?;
    Ok(output)
}

fn place_files(
    copy: &Copy,
    standard_input: &dyn StandardInput,
    loader: &dyn Loader,
    depth: usize,
    output: &mut Output,
) -> Result<(), Error> {
    writeln!(output.standard_output, "# {}", copy.words[..copy.transform_words.end].join(" ")).map_err(too_large)?;
    if copy.files.is_empty() {
        let text = standard_input.bytes()?;
        return Placer { copy, loader, depth, output, source: "standard input".to_owned() }.text(text);
    }
    for (name, _) in &copy.files {
        let loaded = loader.load(name, FileKind::Scene)?;
        let directory = if copy.runs_commands { directory_of(&loaded.path) } else { String::new() };
        let loader = DirectoryLoader { directory, loader };
        Placer { copy, loader: &loader, depth, output, source: name.clone() }.text(&loaded.bytes)?;
    }
    Ok(())
}

/// Writes the placed form of one text.
struct Placer<'a> {
    copy: &'a Copy,
    loader: &'a dyn Loader,
    depth: usize,
    output: &'a mut Output,
    source: String,
}

impl Placer<'_> {
    fn text(&mut self, text: &[u8]) -> Result<(), Error> {
        let mut items = Items::new(text).map_err(|error| self.wrong(text, &error))?;
        let (mut count, mut reals) = (0, Vec::new());
        while let Some(item) = items.advance() {
            match item.map_err(|error| self.wrong(text, &error))? {
                Item::Comment(place) => {
                    let out = &mut self.output.standard_output;
                    out.extend_from_slice(&text[place.start as usize..place.end as usize]);
                    out.push(b'\n');
                    continue;
                }
                Item::Command(place) => self.command(&text[place.start as usize..place.end as usize])?,
                Item::Alias(alias) => {
                    let out = &mut self.output.standard_output;
                    out.push(b'\n');
                    let unquoted = |word| alias.text(word);
                    write_word(out, &unquoted(alias.modifier));
                    out.extend_from_slice(b" alias ");
                    write_word(out, &unquoted(alias.name));
                    out.extend_from_slice(b"\n\t");
                    // Real xform drops the quotes here and then cannot read its own output.
                    write_word(out, &unquoted(alias.target));
                    out.push(b'\n');
                }
                Item::Primitive(primitive) => self.primitive(&primitive, &mut reals)?,
            }
            count += 1;
            if self.output.standard_output.len() > MAX_OUTPUT_BYTES {
                return Err(Error::OutputTooLarge { limit_bytes: MAX_OUTPUT_BYTES });
            }
        }
        if count == 0 {
            self.output.warnings.push(format!("\"{}\" is empty", self.source));
        }
        Ok(())
    }

    fn command(&mut self, line: &[u8]) -> Result<(), Error> {
        let command = command_line(line);
        if !self.copy.runs_commands {
            return self.postpone(&command);
        }
        let deeper = self.depth + 1;
        // Commands refer to the files of earlier ones, such as those of `ies2rad`.
        let loader = WrittenFiles::new(self.loader, &self.output.files);
        let output = radsight_scene_generators::pipeline(&command, &loader, &|argv, standard_input| {
            super::is_xform(&argv[0]).then(|| run(argv, &standard_input.unwrap_or_default(), &loader, deeper))
        });
        let output = match output {
            Ok(output) => output,
            Err(error) if is_fatal(&error.error) => return Err(error.error),
            // Real xform also continues when a command in a file fails.
            Err(error) => {
                self.output.warnings.push(format!("\"{command}\" in \"{}\" failed: {}", self.source, error.error));
                return Ok(());
            }
        };
        self.output.warnings.extend(output.warnings);
        self.output.files.extend(output.files);
        let source = std::mem::replace(&mut self.source, format!("!{command}"));
        self.depth = deeper;
        let result = if deeper > MAX_DEPTH { Err(too_deep()) } else { self.text(&output.standard_output) };
        self.depth = deeper - 1;
        self.source = source;
        result
    }

    /// `-c`: keeps the command and appends the transform.
    fn postpone(&mut self, command: &str) -> Result<(), Error> {
        let copy = self.copy;
        let options = copy.words[1..copy.transform_words.end].iter().enumerate();
        let kept = options.filter(|(at, word)| at + 1 >= copy.transform_words.start || *word != "-c");
        let words: String = kept.map(|(_, word)| format!(" {word}")).collect();
        let out = &mut self.output.standard_output;
        write!(out, "\n!{command}").map_err(too_large)?;
        if copy.transform_words.end > 1 {
            write!(out, " | {} -e{words}", copy.words[0]).map_err(too_large)?;
        }
        out.push(b'\n');
        Ok(())
    }

    fn primitive(&mut self, primitive: &Primitive<'_>, reals: &mut Vec<f64>) -> Result<(), Error> {
        let kind = primitive.kind;
        let placement = &self.copy.placement;
        if !has_right_counts(kind, primitive.strings.len(), primitive.reals.len()) {
            let name = String::from_utf8_lossy(&primitive.text(primitive.name)).into_owned();
            let mistake = format!("{}: {kind} \"{name}\" has a wrong number of arguments", self.source);
            return Err(impossible(mistake));
        }
        placement.reals(kind, primitive.reals, reals);
        write_primitive(&mut self.output.standard_output, primitive, self.copy, reals).map_err(too_large)
    }

    fn wrong(&self, text: &[u8], error: &crate::syntax::SyntaxError) -> Error {
        let mut sources = SourceMap::default();
        let source = sources.add(&*self.source, text, None);
        let at = sources.position(sources.span(source, error.place.start as usize, error.place.end as usize));
        let mistake = format!("line {}, column {}: {}", at.line, at.column, error.mistake);
        Error::Input { program: "xform".to_owned(), source_name: self.source.clone(), mistake }
    }
}

fn write_primitive(out: &mut Vec<u8>, primitive: &Primitive<'_>, copy: &Copy, reals: &[f64]) -> std::io::Result<()> {
    let (kind, placement) = (primitive.kind, &copy.placement);
    out.push(b'\n');
    match &placement.modifier {
        Some(new) if !kind.is_modifier() => write_word(out, new.name.as_bytes()),
        _ => write_word(out, &primitive.text(primitive.modifier)),
    }
    write!(out, " {} ", placement.kind(kind))?;
    let name = primitive.text(primitive.name);
    if placement.prefix.is_empty() || kind.is_modifier() {
        write_word(out, &name);
    } else {
        write_word(out, &[placement.prefix.as_bytes(), b".", &name].concat());
    }
    out.push(b'\n');
    write_strings(out, primitive, copy)?;
    writeln!(out, "\n{}{}", primitive.integers.len(), joined(primitive.integers))?;
    write!(out, "{}", reals.len())?;
    write_reals(out, kind, reals)
}

fn write_strings(out: &mut Vec<u8>, primitive: &Primitive<'_>, copy: &Copy) -> std::io::Result<()> {
    let transform = &copy.words[copy.transform_words.clone()];
    let mut added: Vec<&str> = Vec::new();
    if primitive.kind.takes_transform_words() {
        // The words so far may end in `-i`, which the new ones must not join.
        if transform.first().is_some_and(|first| first != "-i") {
            added.extend(["-i", "1"]);
        }
        added.extend(transform.iter().map(|word| &**word));
    }
    write!(out, "{}", primitive.strings.len() + added.len())?;
    for &word in primitive.strings {
        out.push(b' ');
        match primitive.kind {
            Kind::Mist => write_word(out, mist_source(primitive, word, &copy.placement).as_bytes()),
            _ => write_word(out, &primitive.text(word)),
        }
    }
    for word in added {
        write!(out, " {word}")?;
    }
    Ok(())
}

fn mist_source(primitive: &Primitive<'_>, word: Word, placement: &Placement) -> String {
    placement.mist_source(&String::from_utf8_lossy(&primitive.text(word)))
}

fn write_reals(out: &mut Vec<u8>, kind: Kind, reals: &[f64]) -> std::io::Result<()> {
    match kind {
        Kind::Polygon => write_rows(out, &[3].repeat(reals.len() / 3), reals),
        Kind::Cone | Kind::Cup | Kind::Ring => write_rows(out, &[3, 3, 2], reals),
        Kind::Cylinder | Kind::Tube => write_rows(out, &[3, 3, 1], reals),
        Kind::BrightText | Kind::ColorText | Kind::MixText => {
            write_rows(out, &[3].repeat(reals.len().div_ceil(3)), reals)
        }
        Kind::Mist | Kind::Dielectric => {
            reals.iter().try_for_each(|value| write!(out, " {}", padded(*value, 12, 6)))?;
            out.push(b'\n');
            Ok(())
        }
        Kind::Interface => {
            for side in reals.chunks(4) {
                out.push(b'\n');
                side.iter().try_for_each(|value| write!(out, " {}", padded(*value, 12, 6)))?;
            }
            out.push(b'\n');
            Ok(())
        }
        Kind::Spotlight => write_rows_after_count(out, &[4, 3], reals),
        _ => {
            reals.iter().try_for_each(|value| write!(out, " {}", padded(*value, 18, 12)))?;
            out.push(b'\n');
            Ok(())
        }
    }
}

/// Writes rows of numbers below the count.
fn write_rows(out: &mut Vec<u8>, rows: &[usize], reals: &[f64]) -> std::io::Result<()> {
    out.push(b'\n');
    write_rows_after_count(out, rows, reals)
}

fn write_rows_after_count(out: &mut Vec<u8>, rows: &[usize], reals: &[f64]) -> std::io::Result<()> {
    let mut rest = reals;
    for &length in rows {
        let (row, after) = rest.split_at(length.min(rest.len()));
        row.iter().try_for_each(|value| write!(out, " {}", padded(*value, 18, 12)))?;
        out.push(b'\n');
        rest = after;
    }
    Ok(())
}

fn joined(integers: &[i64]) -> String {
    integers.iter().map(|value| format!(" {value}")).collect()
}

/// Whether real `xform` accepts the counts.
fn has_right_counts(kind: Kind, strings: usize, reals: usize) -> bool {
    match kind {
        Kind::Source | Kind::Sphere | Kind::Bubble | Kind::Glow => (strings, reals) == (0, 4),
        Kind::Polygon => strings == 0 && reals.is_multiple_of(3),
        Kind::Cone | Kind::Cup | Kind::Ring | Kind::Interface => (strings, reals) == (0, 8),
        Kind::Cylinder | Kind::Tube | Kind::Spotlight => (strings, reals) == (0, 7),
        Kind::Dielectric => (strings, reals) == (0, 5),
        Kind::Mist => reals <= 7,
        Kind::BrightText | Kind::ColorText | Kind::MixText => reals >= 9,
        _ => true,
    }
}

/// Writes a word, quoted if necessary.
pub(crate) fn write_word(out: &mut Vec<u8>, word: &[u8]) {
    // A quote in the middle would be read as the start of a quoted part.
    let inner = word.get(1..word.len().saturating_sub(1)).unwrap_or_default();
    let quote = match inner.iter().rev().find(|byte| matches!(byte, b'"' | b'\'')) {
        Some(b'"') => Some(b'\''),
        Some(_) => Some(b'"'),
        None => (word.is_empty() || word.iter().any(|byte| is_space(*byte))).then_some(b'"'),
    };
    out.extend(quote);
    out.extend_from_slice(word);
    out.extend(quote);
}

fn impossible(mistake: String) -> Error {
    Error::Impossible { program: "xform".to_owned(), mistake }
}

fn too_deep() -> Error {
    impossible(format!("commands are nested more than {MAX_DEPTH} deep"))
}

/// Whether an error in a command ends everything. Exceeded limits would be exceeded again and
/// again. A command that is not permitted would be run by real xform, so continuing without it
/// would change the scene.
fn is_fatal(error: &Error) -> bool {
    let is_refused = matches!(error, Error::Syntax(_) | Error::Load(LoadError::CommandRefused { .. }));
    is_refused || error.is_limit() || *error == too_deep()
}

/// The error of a failed write: writing into memory fails only when none is left.
fn too_large(_: std::io::Error) -> Error {
    Error::OutputTooLarge { limit_bytes: MAX_OUTPUT_BYTES }
}
