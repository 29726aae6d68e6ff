//! Hidden files that are open only while data are appended.

use crate::leftovers::{hidden_file, remove_leftovers};
use crate::whole_file::sync_name;
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use tempfile::TempPath;

/// An unfinished file that is closed between additions, for programs with more outputs than can be
/// open at once.
///
/// Unlike a [`crate::WholeFile`], it stays when a signal ends the program, so that another run can
/// continue it.
#[derive(Debug)]
pub struct ClosedFile {
    path: TempPath,
    target: PathBuf,
}

impl ClosedFile {
    /// Creates the file.
    ///
    /// # Errors
    /// When no file can be created in the target's folder.
    pub fn create(target: &Path) -> io::Result<ClosedFile> {
        Ok(ClosedFile { path: hidden_file(target)?.into_temp_path(), target: target.to_owned() })
    }

    /// Continues a file from [`crate::leftovers`] and keeps its first `length` bytes.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn adopt(target: &Path, leftover: &Path, length: u64) -> io::Result<ClosedFile> {
        let file = File::options().write(true).open(leftover)?;
        file.set_len(length)?;
        Ok(ClosedFile { path: TempPath::try_from_path(leftover)?, target: target.to_owned() })
    }

    /// Appends bytes.
    ///
    /// # Errors
    /// When the file cannot be opened or written.
    pub fn append(&self, bytes: &[u8]) -> io::Result<()> {
        File::options().append(true).open(&self.path)?.write_all(bytes)
    }

    /// Syncs the file to the disk and gives it its name, replacing a file of that name. Removes
    /// leftovers of killed programs.
    ///
    /// # Errors
    /// When the disk is full or the file cannot be renamed.
    pub fn commit(self) -> io::Result<()> {
        File::options().append(true).open(&self.path)?.sync_all()?;
        self.path.persist(&self.target).map_err(|failed| failed.error)?;
        sync_name(&self.target);
        remove_leftovers(&self.target);
        Ok(())
    }

    /// Keeps the unfinished file, to be found by [`crate::leftovers`].
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
