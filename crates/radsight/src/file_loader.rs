//! Loads files from disk, with Radiance's search rules.

use radsight_loader::{FileKind, LoadError, Loaded, Loader};
use std::io;
use std::path::{Path, PathBuf};

/// Searches folders, then radsight's built-in function files. Runs no commands.
///
/// ```
/// use radsight::{FileKind, FileLoader, Loader};
/// let loader = FileLoader::default();
/// assert!(loader.load("rayinit.cal", FileKind::Function).is_ok());
/// assert!(loader.load("no such file.rad", FileKind::Scene).is_err());
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileLoader {
    folders: Vec<PathBuf>,
    home: Option<PathBuf>,
}

/// Searches only the working folder.
impl Default for FileLoader {
    fn default() -> Self {
        FileLoader::new([PathBuf::from(".")])
    }
}

impl FileLoader {
    /// Searches these folders in order, as Radiance searches `RAYPATH`.
    ///
    /// ```
    /// use radsight::FileLoader;
    /// let loader = FileLoader::new(["lib".into(), "/usr/share/radiance".into()]);
    /// assert_eq!(loader.candidates("a.cal")[1].to_str(), Some("/usr/share/radiance/a.cal"));
    /// ```
    #[must_use]
    pub fn new(folders: impl IntoIterator<Item = PathBuf>) -> FileLoader {
        FileLoader { folders: folders.into_iter().collect(), home: None }
    }

    /// Sets the folder for `~/`.
    ///
    /// ```
    /// use radsight::FileLoader;
    /// let loader = FileLoader::default().home("/home/ann".into());
    /// assert_eq!(loader.candidates("~/a.cal")[0].to_str(), Some("/home/ann/a.cal"));
    /// ```
    #[must_use]
    pub fn home(self, home: PathBuf) -> FileLoader {
        FileLoader { home: Some(home), ..self }
    }

    /// The candidate paths of a name: a name with an explicit folder is looked up only there,
    /// others in each folder.
    ///
    /// ```
    /// let loader = radsight::FileLoader::new(["lib".into()]);
    /// assert_eq!(loader.candidates("./a.cal")[0].to_str(), Some("./a.cal"));
    /// ```
    #[must_use]
    pub fn candidates(&self, name: &str) -> Vec<PathBuf> {
        let path = Path::new(name);
        let says_where = path.is_absolute() || name.starts_with("./") || name.starts_with("../");
        if says_where {
            return vec![path.to_owned()];
        }
        if let Some(rest) = name.strip_prefix("~/") {
            return vec![self.home.clone().unwrap_or_default().join(rest)];
        }
        self.folders
            .iter()
            .map(|folder| if folder == Path::new(".") { path.to_owned() } else { folder.join(path) })
            .collect()
    }

    /// The first existing candidate; `None` if there is none.
    ///
    /// ```
    /// assert_eq!(radsight::FileLoader::default().find("no such file.cal")?, None);
    /// # Ok::<(), radsight::LoadError>(())
    /// ```
    ///
    /// # Errors
    /// When the candidate is a folder.
    pub fn find(&self, name: &str) -> Result<Option<PathBuf>, LoadError> {
        for candidate in self.candidates(name) {
            match std::fs::metadata(&candidate) {
                Ok(found) if found.is_dir() => {
                    let path = candidate.display().to_string();
                    return Err(LoadError::Unreadable { path, reason: "it is a folder".to_owned() });
                }
                Ok(_) => return Ok(Some(candidate)),
                Err(_) => {}
            }
        }
        Ok(None)
    }

    /// The built-in function file with this name.
    ///
    /// ```
    /// assert!(radsight::FileLoader::default().built_in("rayinit.cal", radsight::FileKind::Function).is_ok());
    /// ```
    ///
    /// # Errors
    /// When there is none.
    pub fn built_in(&self, name: &str, kind: FileKind) -> Result<Loaded, LoadError> {
        if let Some(text) = radsight_cal::library::file(name).filter(|_| kind == FileKind::Function) {
            return Ok(Loaded { path: format!("<{name} of radsight>"), bytes: text.as_bytes().to_vec() });
        }
        Err(LoadError::NotFound { name: name.to_owned(), kind: kind.words(), searched: self.searched(name) })
    }

    fn searched(&self, name: &str) -> String {
        match self.candidates(name).len() {
            0 | 1 => String::new(),
            _ => {
                let list: Vec<String> = self.folders.iter().map(|folder| folder.display().to_string()).collect();
                format!(" in RAYPATH ({})", list.join(", "))
            }
        }
    }
}

pub(crate) fn unreadable(path: &Path, error: &io::Error) -> LoadError {
    LoadError::Unreadable { path: path.display().to_string(), reason: error.to_string() }
}

impl Loader for FileLoader {
    fn load(&self, name: &str, kind: FileKind) -> Result<Loaded, LoadError> {
        match self.find(name)? {
            Some(path) => match std::fs::read(&path) {
                Ok(bytes) => Ok(Loaded { path: path.display().to_string(), bytes }),
                Err(error) => Err(unreadable(&path, &error)),
            },
            None => self.built_in(name, kind),
        }
    }

    fn run_command(&self, command: &str, _standard_input: Option<&[u8]>) -> Result<Vec<u8>, LoadError> {
        Err(LoadError::CommandRefused { command: command.to_owned() })
    }
}
