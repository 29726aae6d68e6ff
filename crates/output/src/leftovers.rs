//! Hidden files of programs that were killed.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use tempfile::{Builder, NamedTempFile};

/// Suffix of the names of hidden files.
pub(crate) const SUFFIX: &str = ".part";

/// Number of random characters in the names of hidden files.
pub(crate) const RANDOM_CHARACTERS: usize = 6;

/// Longest target name, bytes. File systems allow 255; a hidden name adds a prefix and a suffix.
const LONGEST_NAME: usize = 200;

/// Prefix of the names of a target's hidden files.
pub(crate) fn prefix(target: &Path) -> OsString {
    let name = target.file_name().unwrap_or_default();
    let mut prefix = OsString::from(".");
    match name.to_str() {
        Some(text) => {
            let fits = |(start, letter): &(usize, char)| start + letter.len_utf8() <= LONGEST_NAME;
            prefix.push(text.char_indices().take_while(fits).map(|(_, letter)| letter).collect::<String>());
        }
        None => prefix.push(name),
    }
    prefix.push(".");
    prefix
}

/// The folder of a target; `.` for a bare name.
#[must_use]
pub fn folder_of(target: &Path) -> &Path {
    target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Creates a hidden file for a target, with the mode of the file that it replaces or the mode that
/// the umask allows.
pub(crate) fn hidden_file(target: &Path) -> io::Result<NamedTempFile> {
    let prefix = prefix(target);
    let mut builder = Builder::new();
    builder.prefix(&prefix).suffix(SUFFIX).rand_bytes(RANDOM_CHARACTERS);
    #[cfg(unix)]
    let builder = {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666))
    };
    let before = fs::metadata(target).ok();
    if before.is_some() {
        // A write-protected file is not replaced.
        File::options().write(true).open(target)?;
    }
    let file = builder.tempfile_in(folder_of(target))?;
    if let Some(before) = before {
        // A process that may not set the mode may still write.
        let _ = file.as_file().set_permissions(before.permissions());
    }
    Ok(file)
}

/// The hidden files of a target that no running program writes.
#[must_use]
pub fn leftovers(target: &Path) -> Vec<PathBuf> {
    let prefix = prefix(target);
    let Ok(entries) = fs::read_dir(folder_of(target)) else { return Vec::new() };
    let mut found: Vec<PathBuf> = entries
        .filter_map(Result::ok)
        .filter(|entry| is_hidden(entry.file_name().as_encoded_bytes(), prefix.as_encoded_bytes()))
        .filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_file()))
        .map(|entry| entry.path())
        .filter(|path| abandoned(path).is_some())
        .collect();
    found.sort();
    found
}

/// Removes the hidden files of a target that no running program writes.
pub(crate) fn remove_leftovers(target: &Path) {
    for path in leftovers(target) {
        // Keep the lock until the name is removed, so that a program that creates a file of this
        // name takes another one.
        let Some(lock) = abandoned(&path) else { continue };
        let _ = fs::remove_file(&path);
        drop(lock);
    }
}

/// Removes a file, if it is there, and the hidden files of programs that were killed while they wrote
/// it.
///
/// # Errors
///
/// The file cannot be removed.
pub fn remove(target: &Path) -> io::Result<()> {
    remove_leftovers(target);
    match fs::remove_file(target) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// The locked file, unless another process has it locked.
fn abandoned(path: &Path) -> Option<File> {
    let file = File::open(path).ok()?;
    file.try_lock().ok()?;
    Some(file)
}

fn is_hidden(name: &[u8], prefix: &[u8]) -> bool {
    let random = name.strip_prefix(prefix).and_then(|rest| rest.strip_suffix(SUFFIX.as_bytes()));
    random.is_some_and(|random| random.len() == RANDOM_CHARACTERS && random.iter().all(u8::is_ascii_alphanumeric))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hidden_names_belong_to_one_target() {
        let is = |name: &str, target: &str| is_hidden(name.as_bytes(), prefix(Path::new(target)).as_encoded_bytes());
        assert!(is(".a.hdr.x1Y2z3.part", "folder/a.hdr"));
        assert!(!is(".a.hdr.x1Y2z3.part", "a"));
        assert!(!is(".a.hdr.part", "a.hdr"));
        assert!(!is(".a.hdr.x1/2z3.part", "a.hdr"));
    }

    #[test]
    fn a_file_is_removed_with_its_leftovers() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        for name in ["a", ".a.abcdef.part", ".b.abcdef.part"] {
            fs::write(path(name), "text").unwrap();
        }
        remove(&path("a")).unwrap();
        assert!(!path("a").exists() && !path(".a.abcdef.part").exists() && path(".b.abcdef.part").exists());
        // Killed before it was there.
        fs::write(path(".a.abcdef.part"), "text").unwrap();
        remove(&path("a")).unwrap();
        assert!(!path(".a.abcdef.part").exists());
        fs::create_dir(path("folder")).unwrap();
        assert!(remove(&path("folder")).is_err());
    }
}
