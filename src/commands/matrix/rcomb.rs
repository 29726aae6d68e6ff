//! `rcomb`: combines matrices and pictures by functions of their elements.
//!
//! `rcomb [-h] [-w] [-f[adfc]] [-n N] [-e definitions] [-f file] [-s F…] [-c …] [-C letters]
//! matrix… [-m[t] matrix]`: `co(component)`, `co` or `ro go bo` define the output (the sum by
//! default), from `ci(input,component) ri(input) gi bi`, `r c` (row and column), `wl(component)`,
//! `nfiles nrows ncols ncomp R G B PI`. `-s` and `-c` apply to the next matrix, or to the result if
//! after the last one. `-m` multiplies the result by a matrix, `-mt` by a transposed one.

use super::input::{Change, format, mismatch, read_matrix, result_format, wrong};
use crate::clock::push_date;
use crate::commands::words::Words;
use crate::disk::{Commands, DiskLoader};
use crate::failure::{Failure, Outcome, say};
use crate::input::use_default_threads;
use crate::output::write_standard_output;
use radsight_diag::SourceMap;
use radsight_loader::{FileKind, Loader};
use radsight_matrix::{Combination, Matrix, MatrixError, Stored};
use radsight_picture::Header;

/// The command line.
#[derive(Default)]
struct Request {
    /// The inputs with their changes.
    inputs: Vec<(String, Change)>,
    trailing: Change,
    definitions: Vec<Definition>,
    factor: Option<Factor>,
    format: Option<Stored>,
    leaves_headers_out: bool,
    no_warnings: bool,
}

enum Definition {
    Text(String),
    File(String),
}

/// A matrix by which the result is multiplied.
struct Factor {
    source: String,
    transposes: bool,
    /// Whether this happens after the components of the result are changed.
    comes_last: bool,
}

/// Runs the program.
pub(super) fn run(mut words: Words<'_>) -> Outcome {
    use_default_threads()?;
    let request = Request::read(&mut words)?;
    let (program, commands) = (words.program(), words.commands());
    let mut inputs = Vec::new();
    for (source, change) in &request.inputs {
        inputs.push(change.apply(program, source, read_matrix(program, source, commands)?, commands)?);
    }
    if !request.no_warnings {
        warn_of_kinds(program, &request, &inputs);
    }
    let header = header(&request, &words, &inputs);
    let failed = |(index, error): (usize, MatrixError)| {
        wrong(program, request.inputs.get(index).map_or("the result", |(source, _)| source.as_str()), &error)
    };
    let mut combination = Combination::new(inputs).map_err(failed)?;
    define(&mut combination, &request.definitions)?;
    let (combined, warnings) = combination.compute().map_err(|error| wrong(program, "the result", &error))?;
    if !request.no_warnings {
        for warning in warnings {
            say(&format!("{program}: warning - {warning}\n"));
        }
    }
    let result = finish(program, combined, &request, commands)?;
    let written = result.write(&header, result_format(request.format, &result));
    write_standard_output(&written.map_err(|error| wrong(program, "the result", &error))?)
}

impl Request {
    fn read(words: &mut Words<'_>) -> Result<Request, Failure> {
        let (mut request, mut change, mut all) = (Request::default(), Change::default(), None);
        while let Some(word) = words.next_if(|_| true) {
            if word.len() < 2 || !word.starts_with('-') {
                request.inputs.push((word.to_owned(), change.take_for_next(all.as_ref())));
                continue;
            }
            if change.take(words.meant(word)?, words, &mut all)? {
                if let (Some(factor), false) = (&mut request.factor, word == "-s") {
                    factor.comes_last = false;
                }
                continue;
            }
            match word {
                "-h" => request.leaves_headers_out = !request.leaves_headers_out,
                "-w" => request.no_warnings = !request.no_warnings,
                "-n" => drop(words.integer(word)?),
                "-e" => request.definitions.push(Definition::Text(words.value(word, "definitions")?.to_owned())),
                "-f" => request.definitions.push(Definition::File(words.value(word, "a file")?.to_owned())),
                "-m" | "-mt" => {
                    let source = words.value(word, "a matrix")?.to_owned();
                    request.factor = Some(Factor { source, transposes: word == "-mt", comes_last: true });
                }
                _ => match word.strip_prefix("-f").and_then(format) {
                    Some(format) => request.format = Some(format),
                    None => return Err(words.unknown(word)),
                },
            }
        }
        request.trailing = change;
        let factor = request.factor.iter().map(|factor| &factor.source);
        let from_input = request.inputs.iter().map(|(source, _)| source).chain(factor).filter(|source| *source == "-");
        if from_input.count() > 1 {
            return Err(Failure::usage("rcomb: standard input is named twice"));
        }
        if request.inputs.is_empty() {
            return Err(Failure::usage("rcomb: no matrix is given"));
        }
        Ok(request)
    }
}

/// Warns of inputs of another kind, such as a picture of X, Y and Z among pictures of red, green and blue.
fn warn_of_kinds(program: &str, request: &Request, inputs: &[Matrix]) {
    let [first, others @ ..] = inputs else { return };
    let mut stored = first.stored;
    for ((source, _), input) in request.inputs[1..].iter().zip(others) {
        match stored.with(input.stored) {
            Some(joint) => stored = joint,
            None => say(&mismatch(program, source, [stored, input.stored])),
        }
    }
}

fn define(combination: &mut Combination, definitions: &[Definition]) -> Outcome {
    let loader = DiskLoader::new(Commands::Refused);
    let mut sources = SourceMap::default();
    for definition in definitions {
        let (name, text) = match definition {
            Definition::Text(text) => ("option -e".to_owned(), text.clone().into_bytes()),
            Definition::File(name) => {
                let loaded = loader.load(name, FileKind::Function);
                let loaded = loaded.map_err(|error| Failure::input(format!("rcomb: {error}")))?;
                (loaded.path, loaded.bytes)
            }
        };
        let source = sources.add(name.as_str(), &text[..], None);
        let read = combination.environment().define(source, &text);
        read.map_err(|found| Failure::diagnostics(&found, &sources))?;
    }
    Ok(())
}

/// Applies the component changes and matrix products to the combination.
fn finish(program: &str, combined: Matrix, request: &Request, commands: Commands) -> Result<Matrix, Failure> {
    let changed = |matrix| request.trailing.apply(program, "the result", matrix, commands);
    let Some(factor) = &request.factor else { return changed(combined) };
    let right = read_matrix(program, &factor.source, commands)?;
    let right = if factor.transposes { right.transposed() } else { right };
    let times = |left: Matrix| {
        let stored = left.stored;
        let mut product = left.times(&right).map_err(|error| wrong(program, &factor.source, &error))?;
        product.stored = stored;
        Ok(product)
    };
    if factor.comes_last { times(changed(combined)?) } else { changed(times(combined)?) }
}

fn header(request: &Request, words: &Words<'_>, inputs: &[Matrix]) -> Header {
    let mut header = Header::new("RADIANCE");
    if !request.leaves_headers_out {
        for ((source, _), input) in request.inputs.iter().zip(inputs) {
            header.push_nested(source, &input.header);
        }
    }
    header.push_command(words.all());
    push_date(&mut header);
    header
}
