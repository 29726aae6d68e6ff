//! The files that this process has read, so that no output overwrites one of them.

use std::collections::BTreeMap;
use std::fs::{self, File, Metadata};
use std::io;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Device, number and time of birth, where the file system has one: the number of a file that was
/// removed is soon that of another one.
#[cfg(unix)]
type Identity = (u64, u64, Option<std::time::SystemTime>);
#[cfg(not(unix))]
type Identity = std::path::PathBuf;

/// The names under which files were read.
static READ: Mutex<BTreeMap<Identity, String>> = Mutex::new(BTreeMap::new());

/// Records a file as an input. Pipes and devices are not recorded, since writing to them destroys
/// nothing.
pub fn remember(path: &Path, file: &File) {
    if let Some(identity) = file.metadata().ok().and_then(|found| identity(path, &found)) {
        let mut read = READ.lock().unwrap_or_else(PoisonError::into_inner);
        read.entry(identity).or_insert_with(|| path.display().to_string());
    }
}

/// The name under which this file was read, if it was. Standard input counts as read.
#[must_use]
pub fn name_of(path: &Path) -> Option<String> {
    let wanted = fs::metadata(path).ok().and_then(|found| identity(path, &found))?;
    let named = READ.lock().unwrap_or_else(PoisonError::into_inner).get(&wanted).cloned();
    named.or_else(|| {
        let input = standard_input().ok().and_then(|found| identity(Path::new("-"), &found));
        (input == Some(wanted)).then(|| "standard input".to_owned())
    })
}

/// The names under which files were read, one per file.
#[must_use]
pub fn names() -> Vec<String> {
    READ.lock().unwrap_or_else(PoisonError::into_inner).values().cloned().collect()
}

/// Removes a file from the inputs: it belongs to this program, which rewrites it.
pub fn forget(path: &Path) {
    if let Some(identity) = fs::metadata(path).ok().and_then(|found| identity(path, &found)) {
        READ.lock().unwrap_or_else(PoisonError::into_inner).remove(&identity);
    }
}

/// Whether standard output goes to this file.
#[must_use]
pub fn is_standard_output(path: &Path, file: &File) -> bool {
    let of = |found: io::Result<Metadata>| found.ok().and_then(|found| identity(path, &found));
    of(file.metadata()).is_some_and(|wanted| of(standard_output()) == Some(wanted))
}

/// Whether standard input and standard output are the same file.
#[must_use]
pub fn is_standard_input_standard_output() -> bool {
    let of = |found: io::Result<Metadata>| found.ok().and_then(|found| identity(Path::new("-"), &found));
    of(standard_input()).is_some_and(|wanted| of(standard_output()) == Some(wanted))
}

#[cfg(unix)]
fn identity(_path: &Path, found: &Metadata) -> Option<Identity> {
    use std::os::unix::fs::MetadataExt;
    found.is_file().then(|| (found.dev(), found.ino(), found.created().ok()))
}

#[cfg(not(unix))]
fn identity(path: &Path, found: &Metadata) -> Option<Identity> {
    found.is_file().then(|| fs::canonicalize(path).ok()).flatten()
}

#[cfg(unix)]
fn standard_output() -> io::Result<Metadata> {
    use std::os::fd::AsFd;
    File::from(io::stdout().as_fd().try_clone_to_owned()?).metadata()
}

#[cfg(unix)]
fn standard_input() -> io::Result<Metadata> {
    use std::os::fd::AsFd;
    File::from(io::stdin().as_fd().try_clone_to_owned()?).metadata()
}

#[cfg(not(unix))]
fn standard_output() -> io::Result<Metadata> {
    Err(io::ErrorKind::Unsupported.into())
}

#[cfg(not(unix))]
fn standard_input() -> io::Result<Metadata> {
    Err(io::ErrorKind::Unsupported.into())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn an_input_is_known_through_links_and_hard_links() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for name in ["read", "other"] {
            fs::write(at(name), "x").unwrap();
        }
        std::os::unix::fs::symlink(at("read"), at("link")).unwrap();
        fs::hard_link(at("read"), at("hard")).unwrap();
        remember(&at("read"), &File::open(at("read")).unwrap());
        for name in ["read", "link", "hard"] {
            assert_eq!(name_of(&at(name)), Some(at("read").display().to_string()), "{name}");
        }
        assert_eq!(name_of(&at("other")), None);
        assert_eq!(name_of(&at("missing")), None);
    }

    #[test]
    fn a_new_file_with_the_number_of_a_removed_input_is_none() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("read"), "x").unwrap();
        let file = File::open(at("read")).unwrap();
        let has_birth = file.metadata().unwrap().created().is_ok();
        remember(&at("read"), &file);
        drop(file);
        fs::remove_file(at("read")).unwrap();
        fs::write(at("new"), "x").unwrap();
        assert!(!has_birth || name_of(&at("new")).is_none());
    }
}
