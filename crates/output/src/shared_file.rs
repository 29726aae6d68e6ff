//! A file that several processes read and replace in turn.

use crate::WholeFile;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// A file with an advisory lock, so that no other holder of the lock replaces it. Dropping this
/// releases the lock.
///
/// Reading alone needs no lock: the file is always whole.
#[derive(Debug)]
pub struct SharedFile {
    file: File,
    target: PathBuf,
}

impl SharedFile {
    /// Waits for the lock. Creates an empty file if there is none.
    ///
    /// # Errors
    /// When the file cannot be opened for writing, or the system has no locks for it.
    pub fn lock(target: &Path) -> io::Result<SharedFile> {
        loop {
            let file = File::options().read(true).write(true).create(true).truncate(false).open(target)?;
            file.lock()?;
            // The previous holder of the lock has replaced the file.
            if is_still(&file, target)? {
                return Ok(SharedFile { file, target: target.to_owned() });
            }
        }
    }

    /// The whole content.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn read(&mut self) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.file.read_to_end(&mut bytes)?;
        Ok(bytes)
    }

    /// Replaces the file by a new one.
    ///
    /// # Errors
    /// When the new file cannot be written; the old one is unchanged then.
    pub fn replace(self, bytes: &[u8]) -> io::Result<()> {
        let mut whole = WholeFile::create(&self.target)?;
        whole.write_all(bytes)?;
        if cfg!(windows) {
            // Windows cannot replace an open file.
            drop(self.file);
        }
        whole.commit()
    }
}

#[cfg(unix)]
fn is_still(file: &File, target: &Path) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt;
    let (open, named) = (file.metadata()?, fs::metadata(target));
    match named {
        Ok(named) => Ok((open.dev(), open.ino()) == (named.dev(), named.ino())),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}

/// On Windows an open file keeps its name.
#[cfg(not(unix))]
fn is_still(_file: &File, target: &Path) -> io::Result<bool> {
    fs::exists(target)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_many_add_in_turn_is_all_there() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("shared");
        std::thread::scope(|scope| {
            for thread in 0..8u8 {
                let target = &target;
                scope.spawn(move || {
                    for _ in 0..8 {
                        let mut file = SharedFile::lock(target).unwrap();
                        let mut bytes = file.read().unwrap();
                        bytes.push(thread);
                        file.replace(&bytes).unwrap();
                    }
                });
            }
        });
        let mut bytes = fs::read(&target).unwrap();
        bytes.sort_unstable();
        assert_eq!(bytes, (0..8u8).flat_map(|thread| [thread; 8]).collect::<Vec<_>>());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "only the file itself is left");
    }
}
