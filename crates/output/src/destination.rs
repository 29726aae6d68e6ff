//! Resolves the name of an output.

use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

/// Largest number of links in a row, as in Linux.
const MOST_LINKS: usize = 40;

/// The destination of an output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Destination {
    /// `-`, or a name such as `/dev/stdout`.
    StandardOutput,
    /// A device, a pipe, a socket, or another open file of this process such as `/dev/fd/3`. Output
    /// is written to it directly.
    Stream(PathBuf),
    /// A file, existing or not, after following all links. It appears whole.
    File(PathBuf),
}

impl Destination {
    /// Resolves a name and its links.
    ///
    /// # Errors
    /// When the name is empty or a folder's, when links form a cycle, or when a folder on the way
    /// cannot be read.
    pub fn of(name: &str) -> io::Result<Destination> {
        if name == "-" {
            return Ok(Destination::StandardOutput);
        }
        if name.is_empty() {
            return Err(io::Error::new(io::ErrorKind::NotFound, "the name is empty"));
        }
        let mut path = PathBuf::from(name);
        for _ in 0..MOST_LINKS {
            if let Some(number) = descriptor(&path) {
                return Ok(if number == 1 { Destination::StandardOutput } else { Destination::Stream(path) });
            }
            let found = match fs::symlink_metadata(&path) {
                Ok(found) => found.file_type(),
                Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Destination::File(path)),
                Err(error) => return Err(error),
            };
            if found.is_dir() {
                return Err(io::ErrorKind::IsADirectory.into());
            }
            if !found.is_symlink() {
                return Ok(if found.is_file() { Destination::File(path) } else { Destination::Stream(path) });
            }
            path = path.parent().unwrap_or(Path::new("")).join(fs::read_link(&path)?);
        }
        Err(io::Error::other("too many levels of links"))
    }
}

/// The number of an open file of this process in a path such as `/dev/fd/3` or `/proc/self/fd/3`.
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
            assert_eq!(Destination::of(name).unwrap(), Destination::StandardOutput, "{name}");
        }
        assert_eq!(Destination::of("/dev/fd/7").unwrap(), Destination::Stream("/dev/fd/7".into()));
        assert_eq!(Destination::of("/dev/null").unwrap(), Destination::Stream("/dev/null".into()));
    }

    #[test]
    fn links_are_followed_to_what_may_not_be_there_yet() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        symlink("second", at("first")).unwrap();
        symlink(at("file"), at("second")).unwrap();
        symlink("/dev/stdout", at("out")).unwrap();
        symlink("circle", at("circle")).unwrap();
        assert_eq!(Destination::of(at("first").to_str().unwrap()).unwrap(), Destination::File(at("file")));
        assert_eq!(Destination::of(at("out").to_str().unwrap()).unwrap(), Destination::StandardOutput);
        assert!(Destination::of(at("circle").to_str().unwrap()).is_err());
        assert_eq!(Destination::of(folder.path().to_str().unwrap()).unwrap_err().kind(), io::ErrorKind::IsADirectory);
    }
}
