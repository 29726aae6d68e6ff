//! Checks that crates can be packaged.

use crate::workspace::{self, Package};
use std::fs;
use std::process::Command;

/// Fields that a registry requires in addition to cargo.
const WANTED: [&str; 6] = ["description", "license", "keywords", "categories", "readme", "documentation"];

/// Lists the content of each package, and checks the fields that a registry shows.
pub(crate) fn check() -> Result<(), String> {
    let packages = workspace::packages()?;
    let mut mistakes = Vec::new();
    for package in packages.iter().filter(|package| package.may_be_published) {
        mistakes.extend(missing(package)?.into_iter().map(|field| format!("{}: no {field}", package.name)));
        mistakes.extend(unlisted(package).err());
    }
    if mistakes.is_empty() { Ok(()) } else { Err(mistakes.join("\n")) }
}

/// Cargo's message if it cannot list the content of a package.
fn unlisted(package: &Package) -> Result<(), String> {
    let words = ["package", "--list", "--allow-dirty", "--quiet", "--package", &package.name];
    let output = Command::new("cargo").args(words).current_dir(workspace::root()).output();
    let output = output.map_err(|error| format!("cargo: {error}"))?;
    if output.status.success() { Ok(()) } else { Err(String::from_utf8_lossy(&output.stderr).into_owned()) }
}

fn missing(package: &Package) -> Result<Vec<&'static str>, String> {
    let path = package.folder.join("Cargo.toml");
    let text = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let has = |field: &str| text.lines().any(|line| line.starts_with(field));
    Ok(WANTED.into_iter().filter(|field| !has(field)).collect())
}
