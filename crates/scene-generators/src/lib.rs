//! In-process replacements of the commands that Radiance scenes call.
//!
//! A scene line such as `!genbox wood crate 1 1 1 | xform -t 0 0 2` runs here, without a shell, a
//! disk or a second process. [`pipeline`] splits the line as `sh` does in simple cases
//! ([`shell_words`]) and passes each command to [`run`]. The output is the text of the real
//! program; numbers are rounded as in C's `printf`.
//!
//! Guarantees: no argument causes a panic; time and memory are bounded ([`MAX_OUTPUT_BYTES`]); the
//! same arguments give the same bytes. An [`Error`] refers to an argument, and a [`PipelineError`]
//! to its range in the line.
//!
//! `mksource` and `genskyvec` need a renderer, so they are separate functions, [`mksource()`] and
//! [`genskyvec()`], which the caller offers.
//!
//! This crate may not know the scene, the disk, the clock or the environment. Files come from a
//! [`Loader`], and `xform`, which needs the scene parser, comes from the caller as `extra`.
//!
//! ```
//! use radsight_loader::MemoryLoader;
//! let loader = MemoryLoader::default().with("corners", "0 0  1 0  0 1");
//! let output = radsight_scene_generators::pipeline("cat corners | genprism wood wedge - -l 0 0 2", &loader, &|_, _| None).unwrap();
//! assert!(String::from_utf8(output.standard_output).unwrap().contains("wood polygon wedge.b"));
//! ```
#![forbid(unsafe_code)]

mod arguments;
mod calibration_target;
mod cat;
mod cie;
mod cnt;
mod ear_clipping;
mod echo;
mod epw2wea;
mod error;
mod ev;
mod facets;
mod functions;
mod genbeads;
mod genblinds;
mod genbox;
mod genclock;
mod gendaylit;
mod gendaymtx;
mod genprism;
mod genrev;
mod gensky;
mod genskyvec;
mod gensurf;
mod genworm;
mod grid_data;
mod histo;
mod ies2rad;
mod lamps;
mod matching;
mod mgf;
mod mgf2rad;
mod mksource;
mod number_text;
mod obj2rad;
mod perez;
mod pipeline;
mod pkgbsdf;
mod rcalc;
mod rcollate;
mod record_format;
mod record_output;
mod records;
mod replmarks;
mod rlam;
mod scene_words;
pub mod shell_words;
mod sky_patches;
mod sun;
mod supply;
mod tabfunc;
mod text;
mod total;
mod wavefront_mesh;
mod weather;
mod zcat;

pub use calibration_target::{CalibrationTarget, MOST_MARKS, TargetError, TargetPattern};
pub use error::Error;
pub use genskyvec::{OpenSky, genskyvec};
pub use lamps::lamp_color;
pub use mksource::{EnvironmentRadiance, OpenEnvironment, mksource};
pub use pipeline::{PipelineError, WrittenFiles, pipeline};
pub use text::{General, MAX_OUTPUT_BYTES, Sink, padded};
pub use wavefront_mesh::{WavefrontMesh, WavefrontTriangle};

use radsight_loader::{FileKind, LoadError, Loader};
use std::borrow::Cow;
use std::io::Read;
use supply::Supply;
use text::Text;

/// The result of a command.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Output {
    /// Standard output; scene text for a generator.
    pub standard_output: Vec<u8>,
    /// Warnings on standard error, one message each, without the program's name.
    pub warnings: Vec<String>,
    /// Files that the program writes, by name. The reader of the standard output must be able to
    /// load them.
    pub files: Vec<(String, Vec<u8>)>,
    /// The name of the one of `files` whose bytes follow what the file already holds.
    pub extended: Option<String>,
}

/// Runs a command that this crate lacks (`xform`); `None` if the caller lacks it too.
pub type Extra<'a> = dyn Fn(&[String], Option<&[u8]>) -> Option<Result<Output, Error>> + 'a;

/// Standard input, empty if there is none. Only programs that read it may access it: in a shell's
/// loop it holds the input of later iterations.
pub trait StandardInput {
    /// The whole input; repeated calls return the same bytes.
    ///
    /// # Errors
    /// When it cannot be read.
    fn bytes(&self) -> Result<&[u8], LoadError>;

    /// A stream of the unread part.
    ///
    /// # Errors
    /// When it cannot be read.
    fn reader(&self) -> Result<Box<dyn Read + '_>, LoadError> {
        Ok(Box::new(self.bytes()?))
    }
}

impl<T: AsRef<[u8]>> StandardInput for T {
    fn bytes(&self) -> Result<&[u8], LoadError> {
        Ok(self.as_ref())
    }
}

/// The environment of a program.
pub(crate) struct Invocation<'a> {
    pub(crate) argv: &'a [String],
    standard_input: &'a dyn StandardInput,
    pub(crate) loader: &'a dyn Loader,
    pub(crate) extra: &'a Extra<'a>,
    sink: Option<Sink>,
}

/// The name of an input in messages.
#[must_use]
pub fn source_name(name: &str) -> &str {
    if name == "-" { "standard input" } else { name }
}

impl<'a> Invocation<'a> {
    /// Standard input, empty if there is none.
    pub(crate) fn standard_input(&self) -> Result<&'a [u8], Error> {
        Ok(self.standard_input.bytes()?)
    }

    /// The content of an input: standard input (`-`) or a file.
    pub(crate) fn input(&self, name: &str, kind: FileKind) -> Result<Cow<'a, [u8]>, Error> {
        match name {
            "-" => self.standard_input().map(Cow::Borrowed),
            name => Ok(Cow::Owned(self.loader.load(name, kind)?.bytes)),
        }
    }

    /// A stream of an input.
    pub(crate) fn supply(&self, name: &str, kind: FileKind) -> Result<Supply<'a>, Error> {
        let source = match name {
            "-" => self.standard_input.reader()?,
            name => self.loader.open(name, kind)?,
        };
        Ok(Supply::new(name, source))
    }

    /// The program's output, streamed while it runs if the caller requests that.
    pub(crate) fn text(&self) -> Text {
        Text::to(self.sink.clone())
    }
}

type Program = fn(&Invocation<'_>) -> Result<Output, Error>;

/// All programs, sorted by name.
const PROGRAMS: &[(&str, Program)] = &[
    ("cat", cat::run),
    ("cnt", cnt::run),
    ("echo", echo::run),
    ("epw2wea", epw2wea::run),
    ("ev", ev::run),
    ("genbeads", genbeads::run),
    ("genblinds", genblinds::run),
    ("genbox", genbox::run),
    ("genclock", genclock::run),
    ("gendaylit", gendaylit::run),
    ("gendaymtx", gendaymtx::run),
    ("genprism", genprism::run),
    ("genrev", genrev::run),
    ("gensky", gensky::run),
    ("gensurf", gensurf::run),
    ("genworm", genworm::run),
    ("histo", histo::run),
    ("ies2rad", ies2rad::run),
    ("mgf2rad", mgf2rad::run),
    ("obj2rad", obj2rad::run),
    ("pkgBSDF", pkgbsdf::run),
    ("rcalc", rcalc::run),
    ("rcollate", rcollate::run),
    ("replmarks", replmarks::run),
    ("rlam", rlam::run),
    ("tabfunc", tabfunc::run),
    ("total", total::run),
    ("zcat", zcat::run),
];

/// The names of all programs of [`run`], sorted.
#[must_use]
pub fn names() -> &'static [&'static str] {
    const NAMES: [&str; PROGRAMS.len()] = {
        let mut names = [""; PROGRAMS.len()];
        let mut index = 0;
        while index < names.len() {
            names[index] = PROGRAMS[index].0;
            index += 1;
        }
        names
    };
    &NAMES
}

/// Whether [`run`] provides the program; a leading directory is ignored, as in
/// `/usr/local/bin/genbox`.
#[must_use]
pub fn knows(program: &str) -> bool {
    find(program).is_some()
}

/// Runs one command. `argv[0]` is the program's name.
///
/// # Errors
/// When the program is unknown, its arguments or input are wrong, a file or standard input cannot
/// be read, or the output would be too large.
pub fn run(argv: &[String], standard_input: &dyn StandardInput, loader: &dyn Loader) -> Result<Output, Error> {
    run_with(argv, standard_input, loader, &|_, _| None)
}

/// Runs one command and streams its output while it runs. Line-by-line programs (`cnt`, `rcalc`,
/// `rcollate`, `rlam`, `total`) need memory for one record only. Output before an error is sent
/// before the error is returned.
///
/// [`Output::standard_output`] is the part that was not streamed: all of it for other programs.
///
/// # Errors
/// As [`run`], and [`Error::OutputTooLarge`] when the sink fails; the sink keeps the reason.
pub fn run_to(
    sink: Sink,
    argv: &[String],
    standard_input: &dyn StandardInput,
    loader: &dyn Loader,
) -> Result<Output, Error> {
    run_invocation(&Invocation { argv, standard_input, loader, extra: &|_, _| None, sink: Some(sink) })
}

pub(crate) fn run_with(
    argv: &[String],
    standard_input: &dyn StandardInput,
    loader: &dyn Loader,
    extra: &Extra<'_>,
) -> Result<Output, Error> {
    run_invocation(&Invocation { argv, standard_input, loader, extra, sink: None })
}

fn run_invocation(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let name = invocation.argv.first().map_or("", String::as_str);
    match find(name) {
        Some(program) => program(invocation),
        None => Err(Error::UnknownProgram { program: name.to_owned() }),
    }
}

fn find(program: &str) -> Option<Program> {
    let name = program.rsplit('/').next().unwrap_or(program);
    let index = PROGRAMS.binary_search_by_key(&name, |entry| entry.0).ok()?;
    Some(PROGRAMS[index].1)
}
