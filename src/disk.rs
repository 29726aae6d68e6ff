//! Files of the disk, searched as Radiance searches them.

use crate::commands::mksource;
use crate::failure::reason;
use crate::trust::{Trust, shell};
use radsight_loader::{AS_IN_SHELL, FileKind, LoadError, Loaded, Loader};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::SystemTime;

pub(crate) use crate::trust::Commands;

/// Looks in the folders of `RAYPATH` (the working folder when it is not set), and then in radsight's own function library.
#[derive(Debug)]
pub(crate) struct DiskLoader {
    folders: Vec<PathBuf>,
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
        DiskLoader { folders, commands, shuffle_seed: 0 }
    }

    /// The same for a program that a user typed: what it shuffles is in another order each time.
    pub(crate) fn shuffling(self) -> DiskLoader {
        let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        DiskLoader { shuffle_seed: since.as_nanos() as u64, ..self }
    }

    /// Where a name is looked for: names that say where they are only there, others in each folder.
    fn candidates(&self, name: &str) -> Vec<PathBuf> {
        let path = Path::new(name);
        let says_where = path.is_absolute() || name.starts_with("./") || name.starts_with("../");
        if says_where {
            return vec![path.to_owned()];
        }
        if let Some(rest) = name.strip_prefix("~/") {
            let home = std::env::var_os("HOME").map(PathBuf::from).unwrap_or_default();
            return vec![home.join(rest)];
        }
        self.folders
            .iter()
            .map(|folder| if folder == Path::new(".") { path.to_owned() } else { folder.join(path) })
            .collect()
    }

    fn searched(&self, name: &str) -> String {
        let folders = self.candidates(name).len();
        match folders {
            0 | 1 => String::new(),
            _ => {
                let list: Vec<String> = self.folders.iter().map(|folder| folder.display().to_string()).collect();
                format!(" in RAYPATH ({})", list.join(", "))
            }
        }
    }
}

impl Loader for DiskLoader {
    fn load(&self, name: &str, kind: FileKind) -> Result<Loaded, LoadError> {
        for candidate in self.candidates(name) {
            let found = match fs::metadata(&candidate) {
                Ok(found) => found,
                Err(_) => continue,
            };
            let path = candidate.display().to_string();
            if found.is_dir() {
                return Err(LoadError::Unreadable { path, reason: "it is a folder".to_owned() });
            }
            return match fs::read(&candidate) {
                Ok(bytes) => Ok(Loaded { path, bytes }),
                Err(error) => Err(LoadError::Unreadable { path, reason: reason(&error) }),
            };
        }
        if let Some(text) = radsight_cal::library::file(name).filter(|_| kind == FileKind::Function) {
            return Ok(Loaded { path: format!("<{name} of radsight>"), bytes: text.as_bytes().to_vec() });
        }
        Err(LoadError::NotFound { name: name.to_owned(), kind: kind.words(), searched: self.searched(name) })
    }

    fn shuffle_seed(&self) -> u64 {
        self.shuffle_seed
    }

    fn names_like(&self, pattern: &str) -> Vec<String> {
        file_names_like(pattern)
    }

    fn run_program(&self, argv: &[String], standard_input: Option<&[u8]>) -> Option<Result<Vec<u8>, LoadError>> {
        let made = match Path::new(argv.first()?).file_name()?.to_str()? {
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
            std::thread::spawn(move || {
                let _ = pipe.write_all(&bytes);
            })
        });
        let output = child.wait_with_output().map_err(|error| failed(reason(&error)))?;
        if let Some(writer) = writer {
            let _ = writer.join();
        }
        if output.status.success() { Ok(output.stdout) } else { Err(failed(output.status.to_string())) }
    }
}

/// Files of the working folder that a pattern matches, as `sh` finds them.
fn file_names_like(pattern: &str) -> Vec<String> {
    let Ok(paths) = glob::glob_with(pattern, AS_IN_SHELL) else { return Vec::new() };
    let prefix = if pattern.starts_with("./") { "./" } else { "" };
    let name = |path: PathBuf| path.to_str().map(|name| format!("{prefix}{}", name.trim_start_matches("./")));
    paths.filter_map(Result::ok).filter_map(name).collect()
}
