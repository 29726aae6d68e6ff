//! All outputs of the program: files that appear whole or not at all, pipes and devices, standard
//! output.

use crate::failure::{Failure, Outcome, reason};
use radsight_brdf_host::guard;
use radsight_output::{Destination, WholeFile, folder_of, inputs, reserve};
use radsight_picture::{FileFormat, Header, Image, write_image};
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// An output being written. A file gets its name in [`Output::commit`]; dropped before, it leaves
/// nothing.
pub(crate) struct Output {
    name: String,
    sink: Sink,
}

enum Sink {
    Standard,
    /// A pipe, a device or an open file, written directly.
    Stream(File),
    Whole(WholeFile),
}

impl Output {
    /// Opens the output with a name from the command line; `-` is standard output. A file of that
    /// name is replaced.
    pub(crate) fn create(name: &str) -> Result<Output, Failure> {
        Output::open(name, &resolve(name)?)
    }

    fn open(name: &str, destination: &Destination) -> Result<Output, Failure> {
        let opened = match destination {
            Destination::StandardOutput => Ok(Sink::Standard),
            Destination::Stream(path) => File::options().append(true).open(path).map(Sink::Stream),
            Destination::File(path) => WholeFile::create(path).map(Sink::Whole),
        };
        let sink = opened.map_err(|error| failed(name, &error))?;
        Ok(Output { name: name.to_owned(), sink })
    }

    /// The file for another program's standard output; `None` for our own.
    pub(crate) fn file(&self) -> Option<&File> {
        match &self.sink {
            Sink::Standard => None,
            Sink::Stream(file) => Some(file),
            Sink::Whole(file) => Some(file.file()),
        }
    }

    /// Writes and flushes bytes; a failure names the output.
    pub(crate) fn put(&mut self, bytes: &[u8]) -> Outcome {
        let written = self.write_all(bytes).and_then(|()| self.flush());
        written.map_err(|error| self.failed(&error))
    }

    /// Gives a file its name.
    pub(crate) fn commit(self) -> Outcome {
        self.finish(WholeFile::commit)
    }

    /// Gives a file its name unless a file of that name exists.
    pub(crate) fn commit_new(self) -> Outcome {
        self.finish(WholeFile::commit_new)
    }

    /// Keeps a file under its hidden name, so that another run can continue it.
    pub(crate) fn keep(self) {
        if let Sink::Whole(file) = self.sink {
            file.keep();
        }
    }

    /// The path of an unfinished file.
    pub(crate) fn hidden_path(&self) -> Option<&Path> {
        match &self.sink {
            Sink::Whole(file) => Some(file.hidden_path()),
            Sink::Standard | Sink::Stream(_) => None,
        }
    }

    fn finish(mut self, commit: impl FnOnce(WholeFile) -> io::Result<()>) -> Outcome {
        let name = self.name.clone();
        self.flush().map_err(|error| self.failed(&error))?;
        match self.sink {
            Sink::Whole(file) => commit(file).map_err(|error| failed(&name, &error)),
            Sink::Standard | Sink::Stream(_) => Ok(()),
        }
    }

    pub(crate) fn failed(&self, error: &io::Error) -> Failure {
        match self.sink {
            Sink::Standard => Failure::write("standard output", error),
            Sink::Stream(_) | Sink::Whole(_) => failed(&self.name, error),
        }
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.sink {
            Sink::Standard => standard_output().write(bytes),
            Sink::Stream(file) => file.write(bytes),
            Sink::Whole(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &self.sink {
            Sink::Standard => standard_output().flush(),
            Sink::Stream(_) | Sink::Whole(_) => Ok(()),
        }
    }
}

fn failed(name: &str, error: &io::Error) -> Failure {
    Failure::write(&format!("\"{name}\""), error)
}

/// The destination of a name, if it may be written.
fn resolve(name: &str) -> Result<Destination, Failure> {
    let destination = resolve_any(name)?;
    if let Destination::File(path) = &destination {
        refuse_inputs(name, path)?;
    }
    Ok(destination)
}

fn resolve_any(name: &str) -> Result<Destination, Failure> {
    Destination::of(name).map_err(|error| match error.kind() {
        io::ErrorKind::IsADirectory => Failure::fault(format!("cannot write \"{name}\": it is a folder")),
        io::ErrorKind::NotADirectory => Failure::fault(format!("cannot write \"{name}\": not in a folder")),
        _ => failed(name, &error),
    })
}

/// The file of a name; `None` for a pipe, a device or standard output.
pub(crate) fn file_path(name: &str) -> Result<Option<PathBuf>, Failure> {
    match resolve(name)? {
        Destination::File(path) => Ok(Some(path)),
        Destination::StandardOutput | Destination::Stream(_) => Ok(None),
    }
}

fn refuse_inputs(name: &str, path: &Path) -> Outcome {
    match inputs::name_of(path) {
        Some(input) if input == name => {
            Err(Failure::usage(format!("\"{name}\" is an input and an output, expected another name for the output")))
        }
        Some(input) => {
            let input = if input == "standard input" { input } else { format!("the input \"{input}\"") };
            Err(Failure::usage(format!("\"{name}\" is an output, but it is the same file as {input}")))
        }
        None => Ok(()),
    }
}

/// Writes an image of values in the format of the file name, or else as a Radiance float matrix.
pub(crate) fn write_image_file(path: &str, header: &Header, image: &Image<f32>) -> Outcome {
    let format = FileFormat::from_name(path).unwrap_or(FileFormat::Matrix);
    let bytes = write_image(format, header, image).map_err(|error| Failure::fault(error.to_string()))?;
    write_file(path, &bytes)
}

/// Writes a file whole; a device or pipe is written directly. `-` is standard output.
pub(crate) fn write_file(name: &str, bytes: &[u8]) -> Outcome {
    let mut output = Output::create(name)?;
    output.put(bytes)?;
    output.commit()
}

/// Adds bytes to the end of a file, which gets all of them or none.
pub(crate) fn extend_file(name: &str, bytes: &[u8]) -> Outcome {
    let old = match file_path(name)? {
        None => Vec::new(),
        Some(path) => match fs::read(path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(failed(name, &error)),
            read => read.unwrap_or_default(),
        },
    };
    write_file(name, &[&old, bytes].concat())
}

/// Writes a file whole that was read: only if the user requested it.
pub(crate) fn replace_file(name: &str, bytes: &[u8]) -> Outcome {
    let mut output = Output::open(name, &resolve_any(name)?)?;
    output.put(bytes)?;
    output.commit()
}

/// Opens a file to append to, reserved for that; its content is kept in any case.
pub(crate) fn append(name: &str) -> Result<File, Failure> {
    reserve_output(name)?;
    let path = match resolve(name)? {
        Destination::StandardOutput => "/dev/stdout".into(),
        Destination::Stream(path) | Destination::File(path) => path,
    };
    let opened = File::options().create(true).append(true).open(&path);
    opened.map_err(|error| failed(name, &error))
}

/// Reserves a file for one output, before long work: checks that it can be written and that no other
/// output has this name. Returns its path; `None` for a pipe, a device or standard output.
pub(crate) fn reserve_output(name: &str) -> Result<Option<PathBuf>, Failure> {
    let Some(path) = file_path(name)? else { return Ok(None) };
    reserve(&path, name).map_err(|other| match other == name {
        true => Failure::usage(format!("\"{name}\" is the name of two outputs, expected a name for each")),
        false => Failure::usage(format!("the outputs \"{other}\" and \"{name}\" are the same file")),
    })?;
    match fs::metadata(folder_of(&path)) {
        Ok(found) if found.is_dir() => Ok(Some(path)),
        Ok(_) => Err(Failure::fault(format!("cannot write \"{name}\": not in a folder"))),
        Err(error) => Err(Failure::fault(format!("cannot write \"{name}\": {}", reason(&error)))),
    }
}

/// The type of standard output, separated from the output of plugins.
pub(crate) type StandardOutput = guard::standard_output::StandardOutput;

/// Standard output; all modules use this function.
pub(crate) fn standard_output() -> StandardOutput {
    guard::standard_output::StandardOutput
}

/// Writes to standard output.
pub(crate) fn write_standard_output(bytes: &[u8]) -> Outcome {
    let mut out = standard_output();
    out.write_all(bytes).and_then(|()| out.flush()).map_err(|error| Failure::write("standard output", &error))
}
