//! Files that appear whole or not at all.

use crate::failure::{Failure, Outcome, reason};
use radsight_brdf_host::guard::standard_output::StandardOutput;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writes a file aside and renames it; a device or pipe is written directly. `-` is standard output.
pub(crate) fn write_file(path: &str, bytes: &[u8]) -> Outcome {
    if path == "-" {
        return write_standard_output(bytes);
    }
    let path = Path::new(path);
    let named = || format!("\"{}\"", path.display());
    let special = fs::metadata(path).is_ok_and(|found| !found.is_file());
    if special {
        let written = File::options().write(true).open(path).and_then(|mut file| file.write_all(bytes));
        return written.map_err(|error| Failure::write(&named(), &error));
    }
    let aside = beside(path, &format!("{}.part", std::process::id()));
    let written = File::create(&aside).and_then(|mut file| {
        file.write_all(bytes)?;
        file.sync_all()
    });
    let renamed = written.and_then(|()| fs::rename(&aside, path));
    renamed.map_err(|error| {
        let _ = fs::remove_file(&aside);
        Failure::write(&named(), &error)
    })
}

/// Checks that a file could be written, before long work is begun for it.
pub(crate) fn check_writable(path: &str) -> Outcome {
    if path == "-" {
        return Ok(());
    }
    let path = Path::new(path);
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match fs::metadata(folder) {
        Ok(found) if found.is_dir() => {}
        Ok(_) => return Err(Failure::fault(format!("cannot write \"{}\": not in a folder", path.display()))),
        Err(error) => {
            return Err(Failure::fault(format!("cannot write \"{}\": {}", path.display(), reason(&error))));
        }
    }
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => {
            Err(Failure::fault(format!("cannot write \"{}\": it is a folder", path.display())))
        }
        _ => Ok(()),
    }
}

/// Writes to standard output.
pub(crate) fn write_standard_output(bytes: &[u8]) -> Outcome {
    let mut out = StandardOutput;
    out.write_all(bytes).and_then(|()| out.flush()).map_err(|error| Failure::write("standard output", &error))
}

/// A hidden file beside another one, with its name and an ending: where that is written until it is whole.
pub(crate) fn beside(path: &Path, ending: &str) -> PathBuf {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    path.with_file_name(format!(".{name}.{ending}"))
}
