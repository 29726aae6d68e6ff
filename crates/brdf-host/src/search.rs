//! Search path of plugin libraries.

use crate::Error;
use radsight_diag::nearest;
use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::path::{Path, PathBuf};

/// Folders in the order of the search.
///
/// The program adds: `--plugin-path`, the variable `RADSIGHT_PLUGIN_PATH`, the scene's folder, its
/// own `plugins` folder.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SearchPath {
    folders: Vec<PathBuf>,
}

impl SearchPath {
    /// Appends a folder.
    pub fn push(&mut self, folder: impl Into<PathBuf>) {
        let folder = folder.into();
        if !self.folders.contains(&folder) {
            self.folders.push(folder);
        }
    }

    /// Appends the folders of a list in the system's format (`:` between them, `;` on Windows),
    /// without empty ones.
    pub fn push_list(&mut self, list: &std::ffi::OsStr) {
        std::env::split_paths(list).filter(|folder| !folder.as_os_str().is_empty()).for_each(|f| self.push(f));
    }

    /// Folders in the order of the search.
    #[must_use]
    pub fn folders(&self) -> &[PathBuf] {
        &self.folders
    }

    /// File of the library `name`, a name without folder, prefix or suffix: a scene must not name
    /// paths.
    ///
    /// # Errors
    /// If the name is a path, or no folder has the library.
    pub fn find(&self, name: &str) -> Result<PathBuf, Error> {
        let bare = !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '-');
        if !bare {
            return Err(Error::BadLibraryName { name: name.to_owned() });
        }
        let files = [format!("{DLL_PREFIX}{name}{DLL_SUFFIX}"), format!("{name}{DLL_SUFFIX}")];
        self.folders
            .iter()
            .flat_map(|folder| files.iter().map(move |file| folder.join(file)))
            .find(|path| path.is_file())
            .ok_or_else(|| self.not_found(name))
    }

    /// Names and files of all libraries in the folders, whether or not they are plugins. A name in
    /// an earlier folder hides later ones.
    #[must_use]
    pub fn libraries(&self) -> Vec<(String, PathBuf)> {
        let mut found: Vec<(String, PathBuf)> = Vec::new();
        for folder in &self.folders {
            let Ok(entries) = std::fs::read_dir(folder) else { continue };
            let mut here: Vec<_> = entries
                .filter_map(|entry| entry.ok().map(|e| e.path()))
                .filter_map(|path| Some((library_name(&path)?, path)))
                .collect();
            here.sort();
            for (name, path) in here {
                if found.iter().all(|(known, _)| *known != name) {
                    found.push((name, path));
                }
            }
        }
        found
    }

    fn not_found(&self, name: &str) -> Error {
        let searched = if self.folders.is_empty() {
            ": no folder is searched".to_owned()
        } else {
            let list: Vec<String> = self.folders.iter().map(|folder| format!("\"{}\"", folder.display())).collect();
            format!(" in {}", list.join(", "))
        };
        let libraries = self.libraries();
        let similar = nearest(name, libraries.iter().map(|(name, _)| name.as_str())).map(str::to_owned);
        Error::LibraryNotFound { name: name.to_owned(), searched, similar }
    }
}

/// Library name of a file: `libretrosheet.so` is `retrosheet`.
#[must_use]
pub fn library_name(path: &Path) -> Option<String> {
    let file = path.file_name()?.to_str()?;
    let stem = file.strip_suffix(DLL_SUFFIX)?;
    let name = stem.strip_prefix(DLL_PREFIX).unwrap_or(stem);
    (!name.is_empty()).then(|| name.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_cannot_name_a_path() {
        let search = SearchPath::default();
        for name in ["../x", "/lib/x", "a/b", "", "c:x", "x.so"] {
            assert!(matches!(search.find(name), Err(Error::BadLibraryName { .. })), "{name}");
        }
    }

    #[test]
    fn a_missing_library_names_the_folders_and_a_similar_one() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(format!("{DLL_PREFIX}retrosheet{DLL_SUFFIX}")), "").unwrap();
        let mut search = SearchPath::default();
        search.push(folder.path());
        assert!(search.find("retrosheet").is_ok());
        let error = search.find("retroshet").unwrap_err();
        assert_eq!(
            error.to_string(),
            format!("cannot find plugin library \"retroshet\" in \"{}\"", folder.path().display())
        );
        assert_eq!(error.hint().unwrap(), "did you mean \"retrosheet\"?");
    }
}
