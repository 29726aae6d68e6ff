//! `pcomb`: combines pictures by functions of their pixels.
//!
//! `pcomb [-h] [-w] [-ff] [-x N] [-y N] [-f file] [-e definitions] [ [-o] [-s F] [-c R G B] picture
//! …]`: `ro go bo` or `lo` define the output (the sum by default); `ri(n) gi(n) bi(n) li(n)` are
//! the inputs, with pixel offsets as second and third argument; `x y xmax ymax xres yres nfiles WE
//! PI re ge be le pa Ox Oy Oz Dx Dy Dz T S` as in Radiance. `-o` undoes exposures, `-s` and `-c`
//! multiply, `-ff` writes floats. A picture that begins with `!` is a command.

use super::files::{History, Source, failed, finish, open_any_image, output, write_failed};
use crate::commands::words::Words;
use crate::disk::{Commands, DiskLoader};
use crate::failure::{Failure, Outcome, say};
use radsight_cal::{Environment, NoHost};
use radsight_diag::SourceMap;
use radsight_loader::{FileKind, Loader};
use radsight_picture::{Encoding, Header, PictureReader, PictureWriter, Resolution};
use radsight_picture_ops::ToolError;
use radsight_picture_ops::combine::{Combination, CombineInput, Defined, Exposures, encoding, prepare};
use std::io::Write;

/// The options before the pictures.
struct Options {
    history: History,
    floats: bool,
    /// `-w`
    is_quiet: bool,
    /// Definitions and sizes, in the order of the command line.
    definitions: Vec<Definition>,
}

enum Definition {
    Columns(String),
    Rows(String),
    Text(String),
    File(String),
}

/// Runs the program.
pub(super) fn run(mut words: Words<'_>) -> Outcome {
    let options = read_options(&mut words)?;
    let (names, inputs) = open_inputs(&mut words)?;
    let (environment, size) = environment(&options, &inputs)?;
    let header = header(&options, &words, &names, &inputs);
    let encoding = encoding(&inputs);
    for (name, input) in names.iter().zip(&inputs) {
        let found = input.reader().encoding();
        if found != encoding {
            let [found, first] = [found, encoding].map(Encoding::name);
            options.warn(&format!(
                "\"{name}\" is {found}, but the first picture {first}; its numbers are combined as they are"
            ));
        }
    }
    let wrong = |error| match error {
        ToolError::Input { index, error } => failed(&names[index], error.into()),
        ToolError::OtherSize { index, .. } => failed(&names[index], error),
        error => failed("pcomb", error),
    };
    let mut combination = Combination::new(inputs, environment, size).map_err(wrong)?;
    let written = match options.floats {
        true => write_floats(&mut combination, header, size, &wrong),
        false => write_picture(&mut combination, header, size, &wrong),
    };
    combination.warnings().iter().for_each(|warning| options.warn(warning));
    written
}

fn write_picture(
    combination: &mut Combination<Source>,
    mut header: Header,
    size: [usize; 2],
    wrong: &dyn Fn(ToolError) -> Failure,
) -> Outcome {
    let mut values = vec![[0.0f32; 3]; size[0]];
    header.push_variable("FORMAT", combination.encoding().name());
    let write_wrong = |error: radsight_picture::PictureError| failed("standard output", error.into());
    let mut writer =
        PictureWriter::new(output(), &header, 3, Resolution::standard(size[0], size[1])).map_err(write_wrong)?;
    for row in 0..size[1] {
        combination.row(row, &mut values).map_err(wrong)?;
        writer.write_values(values.as_flattened()).map_err(write_wrong)?;
    }
    writer.finish().map_err(write_wrong)
}

fn write_floats(
    combination: &mut Combination<Source>,
    mut header: Header,
    size: [usize; 2],
    wrong: &dyn Fn(ToolError) -> Failure,
) -> Outcome {
    let mut values = vec![[0.0f32; 3]; size[0]];
    let components = if combination.defined() == Defined::Grey { 1 } else { 3 };
    for (name, value) in [("NROWS", size[1]), ("NCOLS", size[0]), ("NCOMP", components)] {
        header.push_variable(name, &value.to_string());
    }
    header.push_variable("BigEndian", if cfg!(target_endian = "big") { "1" } else { "0" });
    header.push_variable("FORMAT", "float");
    let mut out = output();
    out.write_all(&header.to_bytes()).map_err(|error| write_failed(&error))?;
    for row in 0..size[1] {
        combination.row(row, &mut values).map_err(wrong)?;
        let numbers = values.iter().flat_map(|value| &value[..components]);
        let bytes: Vec<u8> = numbers.flat_map(|value| value.to_ne_bytes()).collect();
        out.write_all(&bytes).map_err(|error| write_failed(&error))?;
    }
    finish(out)
}

impl Options {
    fn warn(&self, message: &str) {
        if !self.is_quiet {
            say(&format!("pcomb: warning - {message}\n"));
        }
    }
}

fn read_options(words: &mut Words<'_>) -> Result<Options, Failure> {
    let mut options = Options { history: History::Copied, floats: false, is_quiet: false, definitions: Vec::new() };
    while let Some(option) =
        words.next_if(|word| matches!(word.as_bytes(), [b'-', b'x' | b'y' | b'w' | b'h' | b'f' | b'e', ..]))
    {
        let expected = "its definition";
        match words.meant(option)? {
            "-x" => options.definitions.push(Definition::Columns(words.value(option, expected)?.to_owned())),
            "-y" => options.definitions.push(Definition::Rows(words.value(option, expected)?.to_owned())),
            "-e" => options.definitions.push(Definition::Text(words.value(option, "definitions")?.to_owned())),
            "-f" => options.definitions.push(Definition::File(words.value(option, "a file")?.to_owned())),
            "-w" => options.is_quiet = !options.is_quiet,
            "-h" => options.history = options.history.other(),
            _ if option.starts_with("-f") && option.len() > 2 => options.floats = option.starts_with("-ff"),
            _ => return Err(words.unknown(option)),
        }
    }
    Ok(options)
}

type Inputs = (Vec<String>, Vec<CombineInput<Source>>);

fn open_inputs(words: &mut Words<'_>) -> Result<Inputs, Failure> {
    let (mut names, mut inputs) = (Vec::new(), Vec::new());
    let (mut factors, mut exposures) = ([1.0f32; 3], Exposures::AsStored);
    while let Some(word) = words.next_if(|_| true) {
        let is_option = word.len() > 1 && word.starts_with('-');
        match if is_option { words.meant(word)? } else { word } {
            "-o" => exposures = Exposures::Undone,
            "-s" => {
                let factor = words.number(word)?;
                factors = factors.map(|part| (f64::from(part) * factor) as f32);
            }
            "-c" => {
                for part in &mut factors {
                    *part = (f64::from(*part) * words.number(word)?) as f32;
                }
            }
            _ if is_option => {
                return Err(words.unknown(word));
            }
            _ => {
                let path = word;
                let wrong = |error| failed(path, error);
                let reader = PictureReader::picture_or_matrix(open_any_image(path, words.commands())?)
                    .map_err(|error| wrong(error.into()))?;
                inputs.push(CombineInput::new(reader, factors, exposures).map_err(wrong)?);
                names.push(path.to_owned());
                (factors, exposures) = ([1.0; 3], Exposures::AsStored);
            }
        }
    }
    Ok((names, inputs))
}

/// The environment of the definitions, and the output size that they give.
fn environment(options: &Options, inputs: &[CombineInput<Source>]) -> Result<(Environment, [usize; 2]), Failure> {
    let mut environment = Environment::new();
    prepare(&mut environment, inputs);
    let loader = DiskLoader::new(Commands::Refused);
    let mut sources = SourceMap::default();
    for definition in &options.definitions {
        match definition {
            Definition::Columns(text) | Definition::Rows(text) => {
                let source = sources.add("pcomb", text.as_bytes(), None);
                let handle = environment.expression(source, text.as_bytes());
                let value = handle
                    .map_err(|found| vec![found])
                    .and_then(|handle| environment.eval(handle, &[], &NoHost))
                    .map_err(|found| Failure::diagnostics(&found, &sources))?;
                let name = if matches!(definition, Definition::Columns(_)) { "xres" } else { "yres" };
                environment.set_constant(name, value);
            }
            Definition::Text(text) => {
                let source = sources.add("-e", text.as_bytes(), None);
                let read = environment.define(source, text.as_bytes());
                read.map_err(|found| Failure::diagnostics(&found, &sources))?;
            }
            Definition::File(name) => {
                let loaded = loader.load(name, FileKind::Function);
                let loaded = loaded.map_err(|error| Failure::input(format!("pcomb: {error}")))?;
                let source = sources.add(&loaded.path, &loaded.bytes[..], None);
                let read = environment.define(source, &loaded.bytes);
                read.map_err(|found| Failure::diagnostics(&found, &sources))?;
            }
        }
    }
    let mut size = [0; 2];
    for (size, name) in size.iter_mut().zip(["xres", "yres"]) {
        let handle = environment.variable(name);
        let value = environment.eval(handle, &[], &NoHost).map_err(|found| Failure::diagnostics(&found, &sources))?;
        *size = (value + 0.5) as usize;
        if *size == 0 || *size > 1 << 22 {
            return Err(Failure::input(format!("pcomb: {name} is {value}, expected 1 to 4194304 pixels")));
        }
    }
    Ok((environment, size))
}

fn header(options: &Options, words: &Words<'_>, names: &[String], inputs: &[CombineInput<Source>]) -> Header {
    let mut header = super::files::dated_header();
    for (name, input) in names.iter().zip(inputs) {
        let mut nested = input.reader().header().clone();
        for stored in ["FORMAT", "BigEndian", "NROWS", "NCOLS"] {
            nested.remove(stored);
        }
        if input.exposures() == Exposures::Undone {
            nested.remove("EXPOSURE");
            nested.remove("COLORCORR");
        }
        options.history.push(&mut header, name, &nested);
    }
    header.push_command(words.all());
    if let Some(view) = inputs.iter().find_map(CombineInput::view) {
        header.push_variable("VIEW", &view.options().to_full_string());
    }
    header
}
