//! Files named on the command line or in a scene, each read once: the content of a pipe is kept for
//! repeated access.
//!
//! Every file read is recorded, so that no output replaces it (`output.rs`).

use radsight_output::inputs;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// The content of pipes and devices by name. Reading them again would block or find nothing.
static KEPT: Mutex<BTreeMap<PathBuf, Arc<[u8]>>> = Mutex::new(BTreeMap::new());

/// Opens a file for reading.
///
/// The error is `InvalidInput` for the file of standard output: it would grow while it is read.
pub(crate) fn open(path: &Path) -> io::Result<File> {
    let file = File::open(path)?;
    if file.metadata()?.is_dir() {
        return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder"));
    }
    if inputs::is_standard_output(path, &file) {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "standard output goes to the same file"));
    }
    inputs::remember(path, &file);
    Ok(file)
}

/// The bytes of a file, read without a copy.
pub(crate) fn shared(path: &Path) -> io::Result<Arc<[u8]>> {
    if let Some(bytes) = kept(path) {
        return Ok(bytes);
    }
    let mut file = open(path)?;
    let found = file.metadata()?;
    if !found.is_file() {
        return keep(path, &mut file);
    }
    let length = usize::try_from(found.len()).unwrap_or(0);
    let mut bytes: Arc<[u8]> = std::iter::repeat_n(0, length).collect();
    file.read_exact(Arc::get_mut(&mut bytes).expect("it is not shared yet"))?;
    // The file may have grown, or the system may generate it while it is read.
    let mut rest = Vec::new();
    file.read_to_end(&mut rest)?;
    Ok(if rest.is_empty() { bytes } else { [&bytes, &rest[..]].concat().into() })
}

/// The bytes of a file, mutable.
pub(crate) fn owned(path: &Path) -> io::Result<Vec<u8>> {
    if let Some(bytes) = kept(path) {
        return Ok(bytes.to_vec());
    }
    let mut file = open(path)?;
    if !file.metadata()?.is_file() {
        return Ok(keep(path, &mut file)?.to_vec());
    }
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The first bytes of a file, at most `most`.
pub(crate) fn beginning(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    if let Some(bytes) = kept(path) {
        return Ok(bytes.iter().take(most as usize).copied().collect());
    }
    let mut file = open(path)?;
    let mut bytes = Vec::new();
    match file.metadata()?.is_file() {
        true => drop(file.take(most).read_to_end(&mut bytes)?),
        false => bytes.extend(keep(path, &mut file)?.iter().take(most as usize)),
    }
    Ok(bytes)
}

fn kept(path: &Path) -> Option<Arc<[u8]>> {
    KEPT.lock().unwrap_or_else(PoisonError::into_inner).get(path).cloned()
}

fn keep(path: &Path, file: &mut File) -> io::Result<Arc<[u8]>> {
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes)?;
    let bytes: Arc<[u8]> = bytes.into();
    KEPT.lock().unwrap_or_else(PoisonError::into_inner).insert(path.to_owned(), bytes.clone());
    Ok(bytes)
}
