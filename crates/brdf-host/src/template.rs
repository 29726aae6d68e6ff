//! Files of a new plugin project, for `radsight plugin new`.

use std::path::{Path, PathBuf};

/// Language of the project.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Language {
    /// Rust, with the SDK of the workspace in this folder.
    Rust {
        /// Root of radsight's sources.
        sources: PathBuf,
    },
    /// C, with the header alone.
    C,
}

/// A file of the project.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProjectFile {
    /// Relative to the project's folder.
    pub path: PathBuf,
    /// Its content.
    pub text: String,
}

/// Why no project is created.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ProjectError {
    /// The name is not suitable for a library and a model.
    #[error("\"{name}\" cannot be the name of a plugin: expected a letter, then letters, digits, \"_\" and \"-\"")]
    BadName {
        /// Name as written.
        name: String,
    },
    /// The folder contains no SDK.
    #[error("\"{}\" does not hold radsight's sources: it has no crates/brdf-sdk", folder.display())]
    NoSdk {
        /// The folder.
        folder: PathBuf,
    },
}

/// The sources from which this program was built, if they still exist.
#[must_use]
pub fn own_sources() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent()?.parent()?;
    has_sdk(root).then(|| root.to_owned())
}

fn has_sdk(root: &Path) -> bool {
    root.join("crates/brdf-sdk/Cargo.toml").is_file() && root.join("crates/brdf-host/Cargo.toml").is_file()
}

/// Files of a project that builds and passes `radsight plugin check` unchanged.
///
/// # Errors
/// If the name is not suitable, or the folder of the SDK is wrong.
pub fn new_project(name: &str, language: &Language) -> Result<Vec<ProjectFile>, ProjectError> {
    let letters = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    if !letters || !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        return Err(ProjectError::BadName { name: name.to_owned() });
    }
    let ident = name.replace('-', "_");
    let fill = |text: &str| text.replace("@NAME@", name).replace("@IDENT@", &ident);
    let file = |path: &str, text: String| ProjectFile { path: PathBuf::from(path), text };
    let example = |folder: &str| fill(include_str!("../templates/example.rad.in")).replace("@FOLDER@", folder);
    match language {
        Language::C => Ok(vec![
            file(&format!("{ident}.c"), fill(include_str!("../templates/c/plugin.c.in"))),
            file("radsight_brdf.h", radsight_brdf_abi::HEADER.to_owned()),
            file("Makefile", fill(include_str!("../templates/c/Makefile.in"))),
            file("example.rad", example(".")),
        ]),
        Language::Rust { sources } => {
            if !has_sdk(sources) {
                return Err(ProjectError::NoSdk { folder: sources.clone() });
            }
            let dependency = |krate: &str| {
                let path = sources.join("crates").join(krate).to_string_lossy().into_owned();
                format!("{{ path = {} }}", toml_text(&path))
            };
            let cargo = fill(include_str!("../templates/rust/Cargo.toml.in"))
                .replace("@SDK@", &dependency("brdf-sdk"))
                .replace("@HOST@", &dependency("brdf-host"));
            Ok(vec![
                file("Cargo.toml", cargo),
                file("src/lib.rs", fill(include_str!("../templates/rust/lib.rs.in"))),
                file("tests/check.rs", fill(include_str!("../templates/rust/check.rs.in"))),
                file("example.rad", example("target/release")),
            ])
        }
    }
}

/// A basic string of TOML.
fn toml_text(text: &str) -> String {
    let escape = |c: char| match c {
        '"' | '\\' => format!("\\{c}"),
        c if c.is_control() => format!("\\u{:04x}", c as u32),
        c => c.to_string(),
    };
    format!("\"{}\"", text.chars().map(escape).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_must_suit_a_library_and_a_model() {
        for name in ["", "9lives", "a b", "../x", "é"] {
            assert!(new_project(name, &Language::C).is_err(), "{name}");
        }
        assert_eq!(new_project("my-paint", &Language::C).unwrap()[0].path, Path::new("my_paint.c"));
    }

    #[test]
    fn no_placeholder_is_left() {
        let rust = Language::Rust { sources: own_sources().unwrap() };
        for language in [Language::C, rust] {
            for file in new_project("paint", &language).unwrap() {
                for place in ["@NAME@", "@IDENT@", "@SDK@", "@HOST@", "@FOLDER@"] {
                    assert!(!file.text.contains(place), "{place} in {}", file.path.display());
                }
            }
        }
    }
}
