//! Radiance's programs that generate or change scene text: the generators, `xform`, `getbbox`.

use crate::disk::DiskLoader;
use crate::failure::{Failure, Outcome, reason, render, say};
use crate::input::{read, scene_inputs};
use crate::option_table::{options_of, parse_option, unknown_option};
use crate::output::{extend_file, standard_output, write_file, write_standard_output};
use crate::trust::{Existing, Trust};
use glam::DVec3;
use radsight_loader::LoadError;
use radsight_parse::{Purpose, ReadOptions, bounds, xform};
use radsight_scene_generators::{Error, Output, StandardInput, padded};
use std::cell::{OnceCell, RefCell};
use std::io::{self, IsTerminal, Read, Write, stdin};
use std::rc::Rc;

/// Shell programs that scenes call; they need no replacement on the command line.
const OF_THE_SHELL: [&str; 3] = ["cat", "echo", "zcat"];

/// The names of the programs.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    let generators = radsight_scene_generators::names().iter().copied().filter(|name| !OF_THE_SHELL.contains(name));
    generators.chain(["xform", "getbbox"])
}

/// Programs that output the files written by commands in their scenes.
const OF_SCENES: [&str; 2] = ["xform", "replmarks"];

/// Runs a program; `argv[0]` is its name. Permissions of scenes follow the name in all these
/// programs.
pub(crate) fn run(argv: &[String], trust: &Trust) -> Outcome {
    let mut trust = trust.clone();
    let mut argv = argv.to_vec();
    while argv.len() > 1 {
        match trust.take(&argv[1..])? {
            0 => break,
            used => drop(argv.drain(1..=used)),
        }
    }
    let name = argv[0].as_str();
    if name == "getbbox" {
        return getbbox(&argv[1..], &trust);
    }
    // Commands among the inputs of rlam are words of the command line.
    let commands = if name == "rlam" { trust.own_commands() } else { trust.commands() };
    let input = Piped::default();
    let loader = DiskLoader::new(commands).shuffling();
    if name == "xform" {
        return finish(name, xform(&argv, &input, &loader), &trust);
    }
    let sink = Rc::new(RefCell::new(StreamingOutput::default()));
    let made = radsight_scene_generators::run_to(sink.clone(), &argv, &input, &loader);
    match sink.take().failed {
        Some(error) => Err(Failure::write("standard output", &error)),
        None => finish(name, made, &trust),
    }
}

/// Standard output of a streaming program. Keeps the reason of a failed write.
#[derive(Default)]
struct StreamingOutput {
    failed: Option<io::Error>,
}

impl Write for StreamingOutput {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        standard_output().write(bytes).map_err(|error| self.keep(error))
    }

    fn flush(&mut self) -> io::Result<()> {
        standard_output().flush().map_err(|error| self.keep(error))
    }
}

impl StreamingOutput {
    fn keep(&mut self, error: io::Error) -> io::Error {
        let kind = error.kind();
        if kind != io::ErrorKind::Interrupted {
            self.failed = Some(error);
        }
        kind.into()
    }
}

/// Standard input, if it is piped: a program called at a terminal must not wait for it.
#[derive(Default)]
pub(super) struct Piped(OnceCell<Result<Vec<u8>, LoadError>>);

impl StandardInput for Piped {
    fn bytes(&self) -> Result<&[u8], LoadError> {
        self.0.get_or_init(read_piped).as_deref().map_err(LoadError::clone)
    }

    /// A filter also waits for typed input.
    fn reader(&self) -> Result<Box<dyn Read + '_>, LoadError> {
        refuse_own_output()?;
        Ok(Box::new(stdin().lock()))
    }
}

/// The output would be read again, forever.
fn refuse_own_output() -> Result<(), LoadError> {
    match radsight_output::inputs::is_standard_input_standard_output() {
        true => Err(LoadError::OwnOutput { path: "standard input".to_owned() }),
        false => Ok(()),
    }
}

fn read_piped() -> Result<Vec<u8>, LoadError> {
    let mut bytes = Vec::new();
    if !stdin().is_terminal() {
        refuse_own_output()?;
        let unreadable = |error| LoadError::Unreadable { path: "standard input".to_owned(), reason: reason(&error) };
        stdin().lock().read_to_end(&mut bytes).map_err(unreadable)?;
    }
    Ok(bytes)
}

/// Writes the output of a program, or reports its error.
pub(super) fn finish(name: &str, made: Result<Output, Error>, trust: &Trust) -> Outcome {
    let output = made.map_err(|error| {
        let says_its_name = error.program() == Some(name);
        let message = if says_its_name { error.to_string() } else { format!("{name}: {error}") };
        match error {
            Error::Load(LoadError::OwnOutput { .. }) => Failure::usage(message),
            Error::Argument { .. } if says_its_name => Failure::usage(message),
            _ => Failure::input(message),
        }
    })?;
    for warning in &output.warnings {
        say(&format!("{name}: warning - {warning}\n"));
    }
    for (file, bytes) in &output.files {
        match OF_SCENES.contains(&name) {
            // If a scene is read again, the files of its commands already exist.
            true if holds(file, bytes) => continue,
            _ if file == "-" => write_standard_output(bytes)?,
            true => write_file(&trust.output_of_file(file, Existing::Kept)?, bytes)?,
            false if output.extended.as_ref() == Some(file) => {
                extend_file(&trust.output(file, Existing::Kept)?, bytes)?
            }
            false => write_file(&trust.output(file, Existing::Kept)?, bytes)?,
        }
    }
    write_standard_output(&output.standard_output)
}

/// Whether a file already has this content. Pipes are not read.
fn holds(file: &str, bytes: &[u8]) -> bool {
    let is_file = |found: std::fs::Metadata| found.is_file() && found.len() == bytes.len() as u64;
    std::fs::symlink_metadata(file).is_ok_and(is_file) && std::fs::read(file).is_ok_and(|found| found == bytes)
}

/// The initial bounds of real `getbbox`, which it prints for a scene without surfaces.
const NO_BOUNDS: f64 = 1e10;

fn getbbox(words: &[String], trust: &Trust) -> Outcome {
    let is_option = |word: &&String| word.starts_with('-') && word.len() > 1;
    let (mut has_header, mut is_quiet) = (true, false);
    let program = options_of("getbbox");
    for option in words.iter().take_while(is_option) {
        match parse_option(program, option)?.option.name {
            "-h" => has_header = false,
            "-w" => is_quiet = true,
            _ => return Err(unknown_option(program, option)),
        }
    }
    let files: Vec<String> = words.iter().skip_while(is_option).cloned().collect();
    let files = if files.is_empty() { vec!["-".to_owned()] } else { files };
    let options = ReadOptions { purpose: Purpose::Bounds, ..ReadOptions::default() };
    let read = read(scene_inputs(&files, None, trust)?, trust.commands(), &options);
    if read.has_errors() {
        return Err(Failure::diagnostics(&read.diagnostics, &read.sources));
    }
    if !is_quiet {
        say(&render(&read.diagnostics, &read.sources));
    }
    let (low, high) = bounds(&read.scene)
        .map_or((DVec3::splat(NO_BOUNDS), DVec3::splat(-NO_BOUNDS)), |bounds| (bounds.low, bounds.high));
    let mut text = String::new();
    if has_header {
        text.push_str("     xmin      xmax      ymin      ymax      zmin      zmax\n");
    }
    let columns = [low.x, high.x, low.y, high.y, low.z, high.z].map(|value| padded(value, 9, 6).to_string());
    text.push_str(&columns.join(" "));
    text.push('\n');
    write_standard_output(text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_formatted_as_in_c() {
        for (value, text) in [
            (0.0, "0"),
            (0.0175, "0.0175"),
            (-0.0005, "-0.0005"),
            (1e-5, "1e-05"),
            (1234567.0, "1.23457e+06"),
            (100.0, "100"),
        ] {
            assert_eq!(padded(value, 0, 6).to_string(), text);
        }
    }
}
