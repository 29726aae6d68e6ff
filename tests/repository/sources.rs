//! The crates and Rust files of the repository.

use crate::program::root;
use std::fs;
use std::path::{Path, PathBuf};

/// The folders of the crates in a folder of the repository, sorted.
pub(crate) fn crate_folders(folder: &str) -> Vec<PathBuf> {
    let entries =
        root().join(folder).read_dir().expect("the folder is read").map(|entry| entry.expect("an entry").path());
    let mut folders: Vec<PathBuf> = entries.filter(|path| path.join("Cargo.toml").is_file()).collect();
    folders.sort();
    folders
}

/// The Rust files below a folder, except in `target`.
pub(crate) fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("the folder is read") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.extend((!path.ends_with("target")).then_some(path));
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                found.push(path);
            }
        }
    }
    found
}

/// The lines of a text without their comments.
pub(crate) fn lines_without_comments(text: &str) -> impl Iterator<Item = &str> {
    text.lines().map(|line| line.split("//").next().unwrap_or_default())
}
