//! Checks that crates can be packaged.

use crate::workspace::{self, Package};
use std::fs;
use std::process::Command;

/// Fields that a registry requires in addition to cargo.
const WANTED: [&str; 6] = ["description", "license", "keywords", "categories", "readme", "documentation"];

/// Files that every package has.
const FILES: [&str; 5] = ["Cargo.toml", "LICENSE-APACHE", "LICENSE-MIT", "README.md", "src/"];

/// Folders and files that a package may have in addition; cargo writes the first three.
const OPTIONAL: [&str; 7] =
    [".cargo_vcs_info.json", "Cargo.lock", "Cargo.toml.orig", "CHANGELOG.md", "include/", "library/", "templates/"];

/// Checks the files of each package, and the fields that a registry shows.
pub(crate) fn check() -> Result<(), String> {
    let packages = workspace::packages()?;
    let mut mistakes = Vec::new();
    for package in packages.iter().filter(|package| package.may_be_published) {
        let found = [missing_fields(package)?, wrong_files(&files(package)?)].concat();
        mistakes.extend(found.into_iter().map(|mistake| format!("{}: {mistake}", package.name)));
    }
    if mistakes.is_empty() { Ok(()) } else { Err(mistakes.join("\n")) }
}

fn missing_fields(package: &Package) -> Result<Vec<String>, String> {
    let path = package.folder.join("Cargo.toml");
    let text = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let has = |field: &str| text.lines().any(|line| line.starts_with(field));
    Ok(WANTED.into_iter().filter(|field| !has(field)).map(|field| format!("no {field}")).collect())
}

/// The files of a package, as cargo lists them.
fn files(package: &Package) -> Result<Vec<String>, String> {
    let words = ["package", "--list", "--allow-dirty", "--quiet", "--package", &package.name];
    let output = Command::new("cargo").args(words).current_dir(workspace::root()).output();
    let output = output.map_err(|error| format!("cargo: {error}"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    // Windows separates folders by backslashes.
    Ok(String::from_utf8_lossy(&output.stdout).lines().map(|line| line.replace('\\', "/")).collect())
}

/// What a package lacks, and what does not belong in it.
fn wrong_files(files: &[String]) -> Vec<String> {
    let is = |file: &str, known: &str| if known.ends_with('/') { file.starts_with(known) } else { file == known };
    let lacking = FILES.iter().filter(|known| !files.iter().any(|file| is(file, known)));
    let foreign = files.iter().filter(|file| !FILES.iter().chain(&OPTIONAL).any(|known| is(file, known)));
    let lacking = lacking.map(|known| format!("no {known} in the package"));
    lacking.chain(foreign.map(|file| format!("{file} does not belong in the package"))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_and_foreign_files_are_found() {
        let files = ["Cargo.toml", "Cargo.lock", "LICENSE-MIT", "README.md", "src/lib.rs", "tests/errors.rs"];
        let found = wrong_files(&files.map(str::to_owned));
        assert_eq!(found, ["no LICENSE-APACHE in the package", "tests/errors.rs does not belong in the package"]);
    }
}
