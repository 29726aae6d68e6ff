//! Files with errors that name them.

use crate::error::BenchError;
use std::fs;
use std::path::Path;

pub(super) fn read_error(path: &Path, reason: String) -> BenchError {
    BenchError::Read { path: path.to_owned(), reason }
}

pub(super) fn read(path: &Path) -> Result<Vec<u8>, BenchError> {
    fs::read(path).map_err(|error| read_error(path, error.to_string()))
}

pub(super) fn write_error(path: &Path) -> impl Fn(std::io::Error) -> BenchError + use<> {
    let path = path.to_owned();
    move |reason| BenchError::Write { path: path.clone(), reason }
}

pub(super) fn make_folder(path: &Path) -> Result<(), BenchError> {
    fs::create_dir_all(path).map_err(write_error(path))
}

/// Writes an executable script of the shell.
pub(super) fn script(path: &Path, text: &str) -> Result<(), BenchError> {
    fs::write(path, format!("#!/bin/sh\n{text}\n")).map_err(write_error(path))?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        fs::set_permissions(path, fs::Permissions::from_mode(0o755)).map_err(write_error(path))?;
    }
    Ok(())
}

/// Copies a folder recursively, with permission to write.
pub(super) fn copy(from: &Path, to: &Path) -> Result<(), BenchError> {
    make_folder(to)?;
    let entries = fs::read_dir(from).map_err(|error| read_error(from, error.to_string()))?;
    for entry in entries.filter_map(Result::ok) {
        let (source, target) = (entry.path(), to.join(entry.file_name()));
        if source.is_dir() {
            copy(&source, &target)?;
        } else {
            // Not a copy of permissions: the copy is changed.
            fs::write(&target, read(&source)?).map_err(write_error(&target))?;
        }
    }
    Ok(())
}
