//! Where the name of an output leads.

use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

/// As many links in a row as Linux follows.
const MOST_LINKS: usize = 40;

/// Where the name of an output leads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// `-`, or a name such as `/dev/stdout`.
    StandardOutput,
    /// A device, a pipe, a socket, or another open file of this process such as `/dev/fd/3`. It is
    /// written directly.
    Stream(PathBuf),
    /// A file that is there or not, at the end of all links. It appears whole.
    File(PathBuf),
}

impl Place {
    /// Follows a name and its links.
    ///
    /// # Errors
    /// When the name is empty or a folder's, when links go in a circle, or when a folder on the way
    /// cannot be read.
    pub fn of(name: &str) -> io::Result<Place> {
        if name == "-" {
            return Ok(Place::StandardOutput);
        }
        if name.is_empty() {
            return Err(io::Error::new(io::ErrorKind::NotFound, "the name is empty"));
        }
        let mut path = PathBuf::from(name);
        for _ in 0..MOST_LINKS {
            if let Some(number) = descriptor(&path) {
                return Ok(if number == 1 { Place::StandardOutput } else { Place::Stream(path) });
            }
            let found = match fs::symlink_metadata(&path) {
                Ok(found) => found.file_type(),
                Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Place::File(path)),
                Err(error) => return Err(error),
            };
            if found.is_dir() {
                return Err(io::ErrorKind::IsADirectory.into());
            }
            if !found.is_symlink() {
                return Ok(if found.is_file() { Place::File(path) } else { Place::Stream(path) });
            }
            path = path.parent().unwrap_or(Path::new("")).join(fs::read_link(&path)?);
        }
        Err(io::Error::other("too many levels of links"))
    }
}

/// The number of an open file of this process that a path names, as in `/dev/fd/3` and
/// `/proc/self/fd/3`.
fn descriptor(path: &Path) -> Option<u32> {
    let words: Option<Vec<&str>> = path
        .components()
        .map(|component| match component {
            Component::RootDir => Some("/"),
            Component::Normal(word) => word.to_str(),
            _ => None,
        })
        .collect();
    match words?.as_slice() {
        ["/", "dev", "stdout"] => Some(1),
        ["/", "dev", "stderr"] => Some(2),
        ["/", "dev", "fd", number] => number.parse().ok(),
        ["/", "proc", "self" | "thread-self", "fd", number] => number.parse().ok(),
        ["/", "proc", process, "fd", number] if *process == std::process::id().to_string() => number.parse().ok(),
        _ => None,
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    #[test]
    fn names_of_standard_output_lead_there() {
        for name in ["-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"] {
            assert_eq!(Place::of(name).unwrap(), Place::StandardOutput, "{name}");
        }
        assert_eq!(Place::of("/dev/fd/7").unwrap(), Place::Stream("/dev/fd/7".into()));
        assert_eq!(Place::of("/dev/null").unwrap(), Place::Stream("/dev/null".into()));
    }

    #[test]
    fn links_are_followed_to_what_may_not_be_there_yet() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        symlink("second", at("first")).unwrap();
        symlink(at("file"), at("second")).unwrap();
        symlink("/dev/stdout", at("out")).unwrap();
        symlink("circle", at("circle")).unwrap();
        assert_eq!(Place::of(at("first").to_str().unwrap()).unwrap(), Place::File(at("file")));
        assert_eq!(Place::of(at("out").to_str().unwrap()).unwrap(), Place::StandardOutput);
        assert!(Place::of(at("circle").to_str().unwrap()).is_err());
        assert_eq!(Place::of(folder.path().to_str().unwrap()).unwrap_err().kind(), io::ErrorKind::IsADirectory);
    }
}
