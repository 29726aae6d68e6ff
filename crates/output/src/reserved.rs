//! The files that this process will write, so that no output replaces another one.

use crate::leftovers::folder_of;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The names under which files were reserved, by canonical folder and name.
static RESERVED: Mutex<BTreeMap<PathBuf, String>> = Mutex::new(BTreeMap::new());

/// Reserves a file, existing or not, for one output of this process. `name` is how the user calls
/// it; `path` is that of [`Destination::File`](crate::Destination::File).
///
/// # Errors
/// When the file is reserved already: the name under which it is.
pub fn reserve(path: &Path, name: &str) -> Result<(), String> {
    // A file in a folder that does not exist cannot be written, so nothing is lost.
    let (Ok(folder), Some(file)) = (fs::canonicalize(folder_of(path)), path.file_name()) else { return Ok(()) };
    match RESERVED.lock().unwrap_or_else(PoisonError::into_inner).entry(folder.join(file)) {
        Entry::Occupied(other) => Err(other.get().clone()),
        Entry::Vacant(free) => {
            free.insert(name.to_owned());
            Ok(())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_reserved_once_whatever_leads_to_it() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("inner")).unwrap();
        let at = |name: &str| folder.path().join(name);
        assert_eq!(reserve(&at("picture"), "first"), Ok(()));
        assert_eq!(reserve(&at("inner/../picture"), "second"), Err("first".to_owned()));
        assert_eq!(reserve(&at("inner/picture"), "third"), Ok(()));
        assert_eq!(reserve(&at("missing/picture"), "fourth"), Ok(()));
    }
}
