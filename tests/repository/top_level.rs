//! The top level of the repository, where commands are run and leave files behind.

use crate::program::root;
use std::process::Command;

const FOLDERS: [&str; 13] = [
    ".cargo",
    ".ci",
    ".github",
    "bindings",
    "crates",
    "docs",
    "examples",
    "fuzz",
    "plugins",
    "radiance-scenes",
    "src",
    "tests",
    "xtask",
];
const FILES: [&str; 13] = [
    ".editorconfig",
    ".gitignore",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "Cargo.lock",
    "Cargo.toml",
    "LICENSE",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "README.md",
    "deny.toml",
    "rust-toolchain.toml",
    "rustfmt.toml",
];

/// What is committed in the top level, if this is a clone.
fn committed() -> Option<String> {
    root().join(".git").exists().then(|| {
        let output = Command::new("git").args(["ls-files", "-z"]).current_dir(root()).output().expect("git is run");
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stdout).expect("names are text")
    })
}

/// Whether a committed file is in no known folder and is none of the known files.
fn is_stray(path: &str) -> bool {
    match path.split_once('/') {
        Some((folder, _)) => !FOLDERS.contains(&folder),
        None => !FILES.contains(&path),
    }
}

#[test]
fn no_file_is_left_behind_in_the_top_level() {
    let committed = committed().unwrap_or_default();
    let stray: Vec<&str> = committed.split_terminator('\0').filter(|path| is_stray(path)).collect();
    assert!(stray.is_empty(), "{stray:?}");
}

#[test]
fn stray_files_are_found() {
    assert!(["0", "out.png", "scratch/notes.md"].into_iter().all(is_stray));
    assert!(!["README.md", "src/main.rs"].into_iter().any(is_stray));
}
