//! What the commands in scene text need besides their programs: a directory to search, and a line
//! without line ends.

use radsight_loader::{FileKind, LoadError, Loaded, Loader};

/// Searches a directory first. `xform` uses the directory of the file that it reads, so commands in
/// the file find files beside it.
pub(crate) struct DirectoryLoader<'a> {
    /// The directory; empty for none.
    pub(crate) directory: String,
    pub(crate) loader: &'a dyn Loader,
}

impl Loader for DirectoryLoader<'_> {
    fn load(&self, name: &str, kind: FileKind) -> Result<Loaded, LoadError> {
        let is_elsewhere = self.directory.is_empty() || name.starts_with(['/', '~']);
        if !is_elsewhere && let Ok(loaded) = self.loader.load(&format!("{}/{name}", self.directory), kind) {
            return Ok(loaded);
        }
        self.loader.load(name, kind)
    }

    fn written(&self, name: &str) -> Option<Vec<u8>> {
        self.loader.written(name)
    }

    fn names_like(&self, pattern: &str) -> Vec<String> {
        if self.directory.is_empty() || pattern.starts_with('/') {
            return self.loader.names_like(pattern);
        }
        // The directory's own name is not part of the pattern.
        let folder = format!("{}/", self.directory);
        let names = self.loader.names_like(&format!("{}{pattern}", glob_literal(&folder)));
        names.into_iter().map(|name| name.strip_prefix(&folder).map(str::to_owned).unwrap_or(name)).collect()
    }

    fn run_program(&self, argv: &[String], standard_input: Option<&[u8]>) -> Option<Result<Vec<u8>, LoadError>> {
        self.loader.run_program(argv, standard_input)
    }

    fn run_command(&self, command: &str, standard_input: Option<&[u8]>) -> Result<Vec<u8>, LoadError> {
        if self.directory.is_empty() {
            return self.loader.run_command(command, standard_input);
        }
        let directory = radsight_scene_generators::shell_words::join(std::slice::from_ref(&self.directory));
        self.loader.run_command(&format!("cd {directory} && {command}"), standard_input)
    }
}

/// A pattern that matches this name and nothing else.
fn glob_literal(name: &str) -> String {
    name.chars().fold(String::with_capacity(name.len()), |mut pattern, character| {
        match character {
            '*' | '?' | '[' | ']' => pattern.extend(['[', character, ']']),
            _ => pattern.push(character),
        }
        pattern
    })
}

/// The directory part of a path; empty if there is none.
pub(crate) fn directory_of(path: &str) -> String {
    match path.rfind('/') {
        Some(0) => "/".to_owned(),
        Some(at) => path[..at].strip_prefix("./").unwrap_or(&path[..at]).to_owned(),
        None => String::new(),
    }
}

/// A `!` line as a shell gets it: without the `!`, and with one-byte line ends. All other bytes
/// keep their offsets.
pub(crate) fn command_line(line: &[u8]) -> String {
    let mut bytes = line.get(1..).unwrap_or_default().to_vec();
    for at in 0..bytes.len() {
        if bytes[at] == b'\r' {
            let is_pair = bytes.get(at + 1) == Some(&b'\n');
            bytes[at] = b'\n';
            if is_pair {
                bytes[at + 1] = b' ';
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
