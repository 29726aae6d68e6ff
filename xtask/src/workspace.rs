//! The workspace: its folder, its crates, programs that run in it.

use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The repository's root.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask is a folder of the repository")
}

/// Runs a program in the repository's root.
pub(crate) fn run(program: &str, words: &[&str]) -> Result<(), String> {
    finish(Command::new(program).args(words))
}

/// Runs a command in the repository's root.
pub(crate) fn finish(command: &mut Command) -> Result<(), String> {
    match command.current_dir(root()).status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("{command:?}: {status}")),
        Err(error) => Err(format!("{}: {error}", command.get_program().display())),
    }
}

/// The platform that the compiler builds for, such as `x86_64-unknown-linux-gnu`.
pub(crate) fn host_triple() -> Result<String, String> {
    let output = Command::new("rustc").arg("-vV").output().map_err(|error| format!("rustc: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    let triple = text.lines().find_map(|line| line.strip_prefix("host: "));
    triple.map(str::to_owned).ok_or_else(|| "rustc -vV names no host".to_owned())
}

/// A crate of the workspace.
pub(crate) struct Package {
    /// The whole name.
    pub(crate) name: String,
    pub(crate) folder: PathBuf,
    /// Crates of the workspace that it is built on, by their whole names.
    pub(crate) edges: BTreeSet<String>,
    pub(crate) may_be_published: bool,
}

impl Package {
    /// The name without what all of them begin with.
    pub(crate) fn short_name(&self) -> &str {
        self.name.strip_prefix("radsight-").unwrap_or(&self.name)
    }

    /// Its sources, sorted.
    pub(crate) fn sources(&self) -> Vec<PathBuf> {
        let mut found = Vec::new();
        let mut folders = vec![self.folder.join("src")];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
                let path = entry.path();
                if path.is_dir() {
                    folders.push(path);
                } else if path.extension().is_some_and(|ending| ending == "rs") {
                    found.push(path);
                }
            }
        }
        found.sort();
        found
    }
}

/// The crates of the workspace, as cargo knows them.
pub(crate) fn packages() -> Result<Vec<Package>, String> {
    let words = ["metadata", "--format-version", "1", "--no-deps", "--offline"];
    let output = Command::new("cargo").args(words).current_dir(root()).output();
    let output = output.map_err(|error| format!("cargo: {error}"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    let metadata: Value = serde_json::from_slice(&output.stdout).map_err(|error| format!("cargo metadata: {error}"))?;
    let found = metadata["packages"].as_array().into_iter().flatten();
    let names: BTreeSet<&str> = found.clone().filter_map(|package| package["name"].as_str()).collect();
    Ok(found.filter_map(|package| read(package, &names)).collect())
}

fn read(package: &Value, names: &BTreeSet<&str>) -> Option<Package> {
    let edges = package["dependencies"].as_array().into_iter().flatten();
    let edges = edges.filter(|edge| edge["kind"].is_null()).filter_map(|edge| edge["name"].as_str());
    Some(Package {
        name: package["name"].as_str()?.to_owned(),
        folder: Path::new(package["manifest_path"].as_str()?).parent()?.to_owned(),
        edges: edges.filter(|name| names.contains(name)).map(str::to_owned).collect(),
        // An empty list of registries is what `publish = false` means.
        may_be_published: package["publish"].as_array().is_none_or(|registries| !registries.is_empty()),
    })
}
