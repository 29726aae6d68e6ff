//! A file that is written under a hidden name until it is complete.

use crate::interrupt::{FileGuard, make_file};
use crate::leftovers::{folder_of, hidden_file, remove_leftovers};
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// An unfinished file. Dropped before [`WholeFile::commit`], it leaves nothing.
#[derive(Debug)]
pub struct WholeFile {
    file: NamedTempFile,
    guard: FileGuard,
    target: PathBuf,
}

/// Number of names to try. Another process may take a name for a leftover.
const MOST_TRIES: usize = 16;

impl WholeFile {
    /// Creates the file, with the mode of the file that it replaces or the mode that the umask
    /// allows.
    ///
    /// The target name is used as it stands: a link of that name would be replaced
    /// ([`crate::Destination`] follows links).
    ///
    /// # Errors
    /// When no file can be created in the target's folder.
    pub fn create(target: &Path) -> io::Result<WholeFile> {
        for _ in 0..MOST_TRIES {
            let begun = WholeFile::begin(target)?;
            // The lock marks the file as no leftover. Another process may have removed it before.
            let _ = begun.file.as_file().lock();
            if begun.file.path().exists() {
                return Ok(begun);
            }
        }
        Err(io::Error::other("another process keeps removing the unfinished hidden file beside it"))
    }

    fn begin(target: &Path) -> io::Result<WholeFile> {
        let (file, guard) = make_file(|| {
            let file = hidden_file(target)?;
            let path = file.path().to_owned();
            Ok((file, path))
        })?;
        Ok(WholeFile { file, guard, target: target.to_owned() })
    }

    /// The open file.
    #[must_use]
    pub fn file(&self) -> &File {
        self.file.as_file()
    }

    /// The path of the finished file.
    #[must_use]
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Syncs the file to the disk and gives it its name, replacing a file of that name. Removes
    /// leftovers of killed programs.
    ///
    /// # Errors
    /// When the disk is full or the file cannot be renamed; the target is unchanged then.
    pub fn commit(self) -> io::Result<()> {
        let target = self.target.clone();
        self.finish(|file, target| file.persist(target).map_err(|failed| failed.error))?;
        remove_leftovers(&target);
        Ok(())
    }

    /// Gives the file its name unless a file of that name exists.
    ///
    /// # Errors
    /// `AlreadyExists` when it does, and as [`WholeFile::commit`].
    pub fn commit_new(self) -> io::Result<()> {
        let target = self.target.clone();
        self.finish(|file, target| file.persist_noclobber(target).map_err(|failed| failed.error))?;
        remove_leftovers(&target);
        Ok(())
    }

    /// The path of the unfinished file.
    #[must_use]
    pub fn hidden_path(&self) -> &Path {
        self.file.path()
    }

    /// Keeps the unfinished file under its hidden name, to be found by [`crate::leftovers`].
    pub fn keep(self) {
        let WholeFile { file, guard, .. } = self;
        // If the system refuses to keep it, the file is lost as without this call.
        guard.release(|| drop(file.keep()));
    }

    fn finish(self, rename: impl FnOnce(NamedTempFile, &Path) -> io::Result<File>) -> io::Result<()> {
        let WholeFile { file, guard, target } = self;
        file.as_file().sync_all()?;
        guard.release(|| rename(file, &target))?;
        sync_name(&target);
        Ok(())
    }
}

impl Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.as_file_mut().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A name is on the disk when its folder is. Not every file system can sync a folder; the file is
/// whole in any case.
pub(crate) fn sync_name(target: &Path) {
    if let Ok(folder) = File::open(folder_of(target)) {
        let _ = folder.sync_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::leftovers;
    use std::fs;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_dropped_file_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("file");
        let mut file = WholeFile::create(&target).unwrap();
        file.write_all(b"half").unwrap();
        drop(file);
        assert_eq!(names(folder.path()), Vec::<String>::new());
    }

    #[test]
    fn a_new_file_goes_over_no_other() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("file");
        fs::write(&target, "old").unwrap();
        let error = WholeFile::create(&target).unwrap().commit_new().unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::AlreadyExists);
        assert_eq!(fs::read(&target).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["file"]);
    }

    #[test]
    fn leftovers_go_with_the_next_file_but_not_what_is_being_written() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("file");
        fs::write(folder.path().join(".file.abcdef.part"), "left").unwrap();
        fs::write(folder.path().join(".other.abcdef.part"), "of another").unwrap();
        let other = WholeFile::create(&target).unwrap();
        assert_eq!(leftovers(&target).len(), 1);
        WholeFile::create(&target).unwrap().commit().unwrap();
        assert!(leftovers(&target).is_empty());
        assert!(other.file.path().exists());
        drop(other);
        assert_eq!(names(folder.path()), [".other.abcdef.part", "file"]);
    }

    #[test]
    fn names_as_long_as_the_file_system_allows_can_be_written() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("é".repeat(127));
        WholeFile::create(&target).unwrap().commit().unwrap();
        assert!(target.exists());
    }

    #[cfg(unix)]
    #[test]
    fn the_mode_is_that_of_the_file_before_or_what_the_umask_allows() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (target, plain) = (folder.path().join("file"), folder.path().join("plain"));
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        fs::write(&target, "old").unwrap();
        fs::set_permissions(&target, fs::Permissions::from_mode(0o640)).unwrap();
        WholeFile::create(&target).unwrap().commit().unwrap();
        assert_eq!(mode(&target), 0o640);
        fs::write(&plain, "").unwrap();
        let new = folder.path().join("new");
        WholeFile::create(&new).unwrap().commit().unwrap();
        assert_eq!(mode(&new), mode(&plain));
    }
}
