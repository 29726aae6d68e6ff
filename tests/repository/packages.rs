//! Packages: a published crate includes no file from outside of its folder.
//!
//! `cargo xtask package` checks the list of each package's files.

use crate::sources::{crate_folders, lines_without_comments, rust_files};
use std::fs;
use std::path::{Component, Path, PathBuf};

/// The folders of the published crates.
fn published() -> Vec<PathBuf> {
    let is_published = |folder: &PathBuf| {
        fs::read_to_string(folder.join("Cargo.toml")).is_ok_and(|text| text.contains("\npublish.workspace = true\n"))
    };
    crate_folders("crates").into_iter().filter(is_published).collect()
}

/// The paths that a source includes, relative to its folder.
fn included(text: &str) -> Vec<&str> {
    let after = |start: &'static str| text.split(start).skip(1);
    let calls = ["include_str!(\"", "include_bytes!(\"", "include!(\"", "#[path = \""];
    calls.into_iter().flat_map(after).filter_map(|rest| rest.split('"').next()).collect()
}

/// Whether a path, followed from a folder `depth` levels below the crate, leaves the crate.
fn leaves(depth: usize, path: &str) -> bool {
    let mut level = depth as i64;
    Path::new(path).components().any(|component| {
        level += if component == Component::ParentDir { -1 } else { 1 };
        level < 0
    })
}

#[test]
fn published_crates_include_only_their_own_files() {
    let (mut outside, mut count) = (Vec::new(), 0);
    for folder in published() {
        for file in rust_files(&folder.join("src")) {
            let depth = file.strip_prefix(&folder).expect("it is inside").components().count() - 1;
            let text = fs::read_to_string(&file).expect("the file is read");
            let text = lines_without_comments(&text).collect::<Vec<_>>().join("\n");
            for path in included(&text) {
                count += 1;
                outside.extend(leaves(depth, path).then(|| format!("{}: {path}", file.display())));
            }
        }
    }
    assert!(outside.is_empty(), "these would be missing in a package:\n{}", outside.join("\n"));
    assert!(count > 80, "{count} included files were found");
}

#[test]
fn published_crates_have_the_licences_of_the_root() {
    for folder in published() {
        for name in ["LICENSE-APACHE", "LICENSE-MIT"] {
            let text = fs::read_to_string(folder.join(name)).unwrap_or_default();
            let of_root = fs::read_to_string(name).expect("the root has its licences");
            assert_eq!(text, of_root, "{} lacks {name} or has another one", folder.display());
        }
    }
}

#[test]
fn a_path_that_leaves_the_crate_is_found() {
    let text = "#[doc = include_str!(\"../../../README.md\")]\nconst A: &str = include_str!(\"../library/a.cal\");";
    let found: Vec<bool> = included(text).into_iter().map(|path| leaves(1, path)).collect();
    assert_eq!(found, [true, false]);
}
