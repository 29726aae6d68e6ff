//! Radiance's programs that make or change scene text: the generators, `xform`, `getbbox`.

use crate::disk::{Commands, DiskLoader};
use crate::failure::{Failure, Outcome, reason, render, say};
use crate::input::{read, scene_inputs};
use crate::output::{write_file, write_standard_output};
use glam::DVec3;
use radsight_generate::{Error, Output, StandardInput, padded};
use radsight_loader::LoadError;
use radsight_parse::{Purpose, ReadOptions, bounds, xform};
use std::cell::OnceCell;
use std::io::{IsTerminal, Read, stdin};

/// Programs of the shell that scenes call too, but that nobody wants replaced.
const OF_THE_SHELL: [&str; 3] = ["cat", "echo", "zcat"];

/// The names of the programs.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    let generators = radsight_generate::names().iter().copied().filter(|name| !OF_THE_SHELL.contains(name));
    generators.chain(["xform", "getbbox"])
}

/// Lets a scene's commands that are not known in process run through a shell; an option of ours in all these programs.
const ALLOW_COMMANDS: &str = "--allow-commands";

/// Runs a program; `argv[0]` is its name.
pub(crate) fn run(argv: &[String]) -> Outcome {
    // Commands among the inputs of rlam are the user's own.
    let is_allowed = argv[0] == "rlam" || argv.iter().any(|word| word == ALLOW_COMMANDS);
    let commands = if is_allowed { Commands::Allowed } else { Commands::Refused };
    let argv: Vec<String> = argv.iter().filter(|word| *word != ALLOW_COMMANDS).cloned().collect();
    let name = argv[0].as_str();
    if name == "getbbox" {
        return getbbox(&argv[1..], commands);
    }
    let input = Piped::default();
    let loader = DiskLoader::new(commands).shuffling();
    let made = match name {
        "xform" => xform(&argv, &input, &loader),
        _ => radsight_generate::run(&argv, &input, &loader),
    };
    finish(name, made)
}

/// Standard input, if it is piped in: a program that is typed at a terminal must not wait for it.
#[derive(Default)]
pub(super) struct Piped(OnceCell<Result<Vec<u8>, LoadError>>);

impl StandardInput for Piped {
    fn bytes(&self) -> Result<&[u8], LoadError> {
        self.0.get_or_init(read_piped).as_deref().map_err(LoadError::clone)
    }
}

fn read_piped() -> Result<Vec<u8>, LoadError> {
    let mut bytes = Vec::new();
    if !stdin().is_terminal() {
        let unreadable = |error| LoadError::Unreadable { path: "standard input".to_owned(), reason: reason(&error) };
        stdin().lock().read_to_end(&mut bytes).map_err(unreadable)?;
    }
    Ok(bytes)
}

/// Writes what a program has made, or tells why it has not.
pub(super) fn finish(name: &str, made: Result<Output, Error>) -> Outcome {
    let output = made.map_err(|error| {
        let says_its_name = error.program() == Some(name);
        Failure::input(if says_its_name { error.to_string() } else { format!("{name}: {error}") })
    })?;
    for warning in &output.warnings {
        say(&format!("{name}: warning - {warning}\n"));
    }
    for (file, bytes) in &output.files {
        write_file(file, bytes)?;
    }
    write_standard_output(&output.standard_output)
}

/// The numbers that real `getbbox` begins with, and prints of a scene without surfaces.
const NO_BOUNDS: f64 = 1e10;

fn getbbox(words: &[String], commands: Commands) -> Outcome {
    // As in Radiance the first letter of an option counts.
    let is_option = |word: &&String| word.starts_with('-') && word.len() > 1;
    let (mut has_header, mut is_quiet) = (true, false);
    for option in words.iter().take_while(is_option) {
        match option.as_bytes()[1] {
            b'h' => has_header = false,
            b'w' => is_quiet = true,
            _ => {
                let message = format!("getbbox: option \"{option}\" is not supported, expected -h, -w or files");
                return Err(Failure::usage(message));
            }
        }
    }
    let files: Vec<String> = words.iter().skip_while(is_option).cloned().collect();
    let files = if files.is_empty() { vec!["-".to_owned()] } else { files };
    let options = ReadOptions { purpose: Purpose::Places, ..ReadOptions::default() };
    let read = read(scene_inputs(&files, None)?, commands, &options);
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
    fn numbers_look_as_c_prints_them() {
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
