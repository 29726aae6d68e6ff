//! Hidden files that are opened only to add to them.

use crate::leftovers::{hidden_file, remove_leftovers};
use crate::whole_file::sync_name;
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use tempfile::TempPath;

/// A file in the making that is closed between additions, for outputs of which there are more than
/// can be open at once.
///
/// Unlike a [`crate::WholeFile`] it stays when the program is ended by a signal, for who goes on
/// with it.
#[derive(Debug)]
pub struct ClosedFile {
    path: TempPath,
    target: PathBuf,
}

impl ClosedFile {
    /// Begins a file.
    ///
    /// # Errors
    /// When no file can be made in the target's folder.
    pub fn create(target: &Path) -> io::Result<ClosedFile> {
        Ok(ClosedFile { path: hidden_file(target)?.into_temp_path(), target: target.to_owned() })
    }

    /// Goes on with a file of [`crate::leftovers`], of which the first `length` bytes stay.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn adopt(target: &Path, leftover: &Path, length: u64) -> io::Result<ClosedFile> {
        let file = File::options().write(true).open(leftover)?;
        file.set_len(length)?;
        Ok(ClosedFile { path: TempPath::try_from_path(leftover)?, target: target.to_owned() })
    }

    /// Adds to the end.
    ///
    /// # Errors
    /// When the file cannot be opened or written.
    pub fn append(&self, bytes: &[u8]) -> io::Result<()> {
        File::options().append(true).open(&self.path)?.write_all(bytes)
    }

    /// Gives the file its name, over a file that has it; it is on the disk then. Leftovers of
    /// killed programs are removed.
    ///
    /// # Errors
    /// When the disk is full or the name cannot be given.
    pub fn commit(self) -> io::Result<()> {
        File::options().append(true).open(&self.path)?.sync_all()?;
        self.path.persist(&self.target).map_err(|failed| failed.error)?;
        sync_name(&self.target);
        remove_leftovers(&self.target);
        Ok(())
    }

    /// Leaves the file as it is, to be found by [`crate::leftovers`].
    ///
    /// # Errors
    /// When the system refuses.
    pub fn keep(self) -> io::Result<()> {
        self.path.keep().map(drop).map_err(|failed| failed.error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::leftovers;
    use std::fs;

    #[test]
    fn what_was_kept_is_found_and_goes_on() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("file");
        let file = ClosedFile::create(&target).unwrap();
        file.append(b"whole half").unwrap();
        file.keep().unwrap();
        let found = leftovers(&target);
        let file = ClosedFile::adopt(&target, &found[0], 6).unwrap();
        file.append(b"again").unwrap();
        file.commit().unwrap();
        assert_eq!(fs::read(&target).unwrap(), b"whole again");
        assert!(leftovers(&target).is_empty());
    }
}
