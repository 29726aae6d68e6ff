//! Loads files from disk with Radiance's search rules.

use crate::commands::{mksource, oconv};
use crate::failure::{Failure, reason};
use crate::read_once;
use crate::trust::{Trust, shell};
use radsight::FileLoader;
use radsight_loader::{AS_IN_SHELL, FileKind, LoadError, Loaded, Loader};
use std::io::{self, Cursor, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::time::SystemTime;

pub(crate) use crate::trust::Commands;

/// Searches the folders of `RAYPATH` (the working folder if it is not set), then radsight's own
/// function library.
#[derive(Debug)]
pub(crate) struct DiskLoader {
    files: FileLoader,
    commands: Commands,
    shuffle_seed: u64,
}

impl DiskLoader {
    /// A loader for this process's working folder and environment.
    pub(crate) fn new(commands: Commands) -> DiskLoader {
        let folders = match std::env::var_os("RAYPATH").filter(|path| !path.is_empty()) {
            Some(path) => std::env::split_paths(&path)
                .map(|folder| if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder })
                .collect(),
            None => vec![PathBuf::from(".")],
        };
        let home = std::env::var_os("HOME").map(PathBuf::from).unwrap_or_default();
        DiskLoader { files: FileLoader::new(folders).home(home), commands, shuffle_seed: 0 }
    }

    /// A loader for a program called by the user: shuffled output differs in each run.
    pub(crate) fn shuffling(self) -> DiskLoader {
        let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        DiskLoader { shuffle_seed: since.as_nanos() as u64, ..self }
    }

    /// The path of a file. Inputs of programs are not looked for: their names are paths.
    fn find(&self, name: &str, kind: FileKind) -> Result<Option<PathBuf>, LoadError> {
        match kind {
            FileKind::Input => FileLoader::default().find(name),
            _ => self.files.find(name),
        }
    }
}

fn unreadable(path: &Path, error: &io::Error) -> LoadError {
    let path = path.display().to_string();
    match error.kind() {
        io::ErrorKind::InvalidInput => LoadError::OwnOutput { path },
        _ => LoadError::Unreadable { path, reason: reason(error) },
    }
}

impl Loader for DiskLoader {
    fn load(&self, name: &str, kind: FileKind) -> Result<Loaded, LoadError> {
        if let Some(path) = self.find(name, kind)? {
            let bytes = read_once::owned(&path).map_err(|error| unreadable(&path, &error))?;
            return Ok(Loaded { path: path.display().to_string(), bytes });
        }
        match kind {
            FileKind::Input => Err(LoadError::not_found(name, kind)),
            _ => self.files.built_in(name, kind),
        }
    }

    fn open(&self, name: &str, kind: FileKind) -> Result<Box<dyn Read>, LoadError> {
        match self.find(name, kind)? {
            Some(path) => match read_once::open(&path) {
                Ok(file) => Ok(Box::new(file)),
                Err(error) => Err(unreadable(&path, &error)),
            },
            None => Ok(Box::new(Cursor::new(self.load(name, kind)?.bytes))),
        }
    }

    fn open_command(&self, command: &str) -> Result<Box<dyn Read>, LoadError> {
        let Commands::Allowed(permit) = self.commands else {
            return Err(LoadError::CommandRefused { command: command.to_owned() });
        };
        let script = own_programs() + command;
        let started = shell(permit, &script).stdin(Stdio::null()).stdout(Stdio::piped()).spawn();
        let child = started
            .map_err(|error| LoadError::CommandFailed { command: command.to_owned(), reason: reason(&error) })?;
        Ok(Box::new(CommandOutput { child }))
    }

    fn shuffle_seed(&self) -> u64 {
        self.shuffle_seed
    }

    fn names_like(&self, pattern: &str) -> Vec<String> {
        file_names_like(pattern)
    }

    fn run_program(&self, argv: &[String], standard_input: Option<&[u8]>) -> Option<Result<Vec<u8>, LoadError>> {
        let made = match Path::new(argv.first()?).file_name()?.to_str()? {
            // pkgBSDF -i makes an octree of a sample's geometry.
            "oconv" if argv[1..] == ["-f", "-"] => {
                let made = oconv::frozen(standard_input.unwrap_or_default());
                let failed = |error: Failure| LoadError::CommandFailed {
                    command: argv.join(" "),
                    reason: error.message().to_owned(),
                };
                return Some(made.map_err(failed));
            }
            "mksource" => mksource::make(argv, &Trust::default()),
            // Generators such as replmarks -e run it.
            "xform" => radsight_parse::xform(argv, &standard_input.unwrap_or_default(), self),
            _ => return None,
        };
        Some(
            made.map(|output| output.standard_output)
                .map_err(|error| LoadError::CommandFailed { command: argv.join(" "), reason: error.to_string() }),
        )
    }

    fn run_command(&self, command: &str, standard_input: Option<&[u8]>) -> Result<Vec<u8>, LoadError> {
        let Commands::Allowed(permit) = self.commands else {
            return Err(LoadError::CommandRefused { command: command.to_owned() });
        };
        let failed = |reason: String| LoadError::CommandFailed { command: command.to_owned(), reason };
        let stdin = if standard_input.is_some() { Stdio::piped() } else { Stdio::null() };
        let mut child = shell(permit, command)
            .stdin(stdin)
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|error| failed(reason(&error)))?;
        let writer = child.stdin.take().zip(standard_input.map(<[u8]>::to_vec)).map(|(mut pipe, bytes)| {
            std::thread::Builder::new().spawn(move || {
                let _ = pipe.write_all(&bytes);
            })
        });
        // Without the thread the pipe is closed, and the command ends.
        let writer = writer.transpose().map_err(|error| failed(reason(&error)))?;
        let output = child.wait_with_output().map_err(|error| failed(reason(&error)))?;
        if let Some(writer) = writer {
            let _ = writer.join();
        }
        if output.status.success() { Ok(output.stdout) } else { Err(failed(output.status.to_string())) }
    }
}

/// Shell definitions by which a command calls our versions of Radiance's programs, as it does in
/// process.
fn own_programs() -> String {
    let Some(own) = std::env::current_exe().ok().and_then(|path| path.to_str().map(str::to_owned)) else {
        return String::new();
    };
    let own = own.replace('\'', "'\\''");
    let functions = radsight_options::programs().iter().map(|program| {
        let name = program.name;
        format!("{name}() {{ '{own}' {name} \"$@\"; }}\n")
    });
    functions.collect()
}

/// A stream of a command's output. Failure is an error at its end.
struct CommandOutput {
    child: Child,
}

impl Read for CommandOutput {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.child.stdout.as_mut().map_or(Ok(0), |output| output.read(buffer))?;
        if read == 0 && !buffer.is_empty() {
            let status = self.child.wait()?;
            if !status.success() {
                return Err(io::Error::other(status.to_string()));
            }
        }
        Ok(read)
    }
}

impl Drop for CommandOutput {
    fn drop(&mut self) {
        // The rest is not needed: the command ends at its next write.
        drop(self.child.stdout.take());
        let _ = self.child.wait();
    }
}

/// Files of the working folder that match a pattern, as in `sh`.
fn file_names_like(pattern: &str) -> Vec<String> {
    let Ok(paths) = glob::glob_with(pattern, AS_IN_SHELL) else { return Vec::new() };
    let prefix = if pattern.starts_with("./") { "./" } else { "" };
    let name = |path: PathBuf| path.to_str().map(|name| format!("{prefix}{}", name.trim_start_matches("./")));
    paths.filter_map(Result::ok).filter_map(name).collect()
}
