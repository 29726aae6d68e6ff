//! The calls of `rpict` in a folder, recorded with an `rpict` that only writes them down.
//!
//! A folder has a script `run.sh`, which runs once with the programs of real Radiance and once with
//! radsight's `oconv`, `xform` and `getbbox`. Or it has projects of `rad`, whose octrees real
//! Radiance makes for both programs.

use super::files::{copy, make_folder, read, read_error, script, write_error};
use crate::error::BenchError;
use crate::radiance::Radiance;
use crate::radsight::Radsight;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A recorded call of `rpict`.
#[derive(Clone, Debug)]
pub(super) struct Call {
    /// The folder in which it was called.
    pub(super) folder: PathBuf,
    pub(super) words: Vec<String>,
}

/// The same picture by both programs.
#[derive(Clone, Debug)]
pub(super) struct Pair {
    /// In tables and names of files.
    pub(super) name: String,
    pub(super) real: Call,
    pub(super) own: Call,
}

/// Prepares scenes.
pub(super) struct Preparation<'a> {
    pub(super) radiance: &'a Radiance,
    pub(super) radsight: &'a Radsight,
    /// Assignments that replace those of `rad` projects.
    pub(super) assignments: &'a [String],
}

/// The programs whose files are on PATH while a script runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Programs {
    Real,
    Own,
}

impl Programs {
    fn name(self) -> &'static str {
        match self {
            Programs::Real => "real",
            Programs::Own => "radsight",
        }
    }
}

/// File that tells that a folder is prepared.
const PREPARED: &str = "prepared";

impl Preparation<'_> {
    /// The calls of a folder, which is copied to `place` and prepared unless that was done before.
    pub(super) fn pairs(&self, scripts: &Path, place: &Path) -> Result<Vec<Pair>, BenchError> {
        let name = scripts.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let is_project = !scripts.join("run.sh").is_file();
        if !place.join(PREPARED).is_file() {
            copy(scripts, place)?;
            if is_project {
                self.record_projects(place)?;
            } else {
                self.record_script(place, Programs::Real)?;
                self.record_script(place, Programs::Own)?;
            }
            fs::write(place.join(PREPARED), "").map_err(write_error(&place.join(PREPARED)))?;
        }
        let real = recorded(&place.join("real-calls"))?;
        let own = if is_project { real.clone() } else { recorded(&place.join("radsight-calls"))? };
        let pair = |(index, (real, own))| Pair { name: format!("{name} {}", index + 1), real, own };
        Ok(real.into_iter().zip(own).enumerate().map(pair).collect())
    }

    fn record_script(&self, place: &Path, programs: Programs) -> Result<(), BenchError> {
        let mut command = self.recording(Command::new("sh"), place, programs)?;
        let made = place.join(format!("{}-made", programs.name()));
        make_folder(&made)?;
        finish(command.arg("run.sh").env("OUT", made).env("RADLIB", library(self.radiance)))
    }

    /// Runs `rad` on every project of the folder.
    fn record_projects(&self, place: &Path) -> Result<(), BenchError> {
        for project in projects(place)? {
            self.assign(&project)?;
            let mut command = self.recording(self.radiance.command("rad"), place, Programs::Real)?;
            finish(command.arg("-w").arg(&project))?;
        }
        Ok(())
    }

    /// Replaces assignments in a project: `rad` ignores an empty one on its command line.
    fn assign(&self, project: &Path) -> Result<(), BenchError> {
        let text = String::from_utf8_lossy(&read(project)?).into_owned();
        fs::write(project, assigned(&text, self.assignments)).map_err(write_error(project))
    }

    /// A command that finds the recording programs first.
    fn recording(&self, mut command: Command, place: &Path, programs: Programs) -> Result<Command, BenchError> {
        let (shims, calls) = (place.join(format!("{}-programs", programs.name())), place.join("calls"));
        let calls = calls.with_file_name(format!("{}-calls", programs.name()));
        make_folder(&shims)?;
        make_folder(&calls)?;
        self.write_shims(&shims, programs)?;
        let known = self.radiance.command("rpict");
        let known =
            known.get_envs().find(|(name, _)| *name == "PATH").and_then(|(_, value)| value.map(ToOwned::to_owned));
        let known = known.or_else(|| std::env::var_os("PATH")).unwrap_or_default();
        let path = std::env::join_paths(std::iter::once(shims).chain(std::env::split_paths(&known)))
            .map_err(|error| read_error(place, error.to_string()))?;
        command.current_dir(place).env("PATH", path).env("CALLS", calls);
        Ok(command)
    }

    fn write_shims(&self, folder: &Path, programs: Programs) -> Result<(), BenchError> {
        script(
            &folder.join("rpict"),
            "n=$(ls \"$CALLS\" | wc -l)\nmkdir \"$CALLS/$n\"\npwd > \"$CALLS/$n/folder\"\nprintf '%s\\n' \"$@\" > \"$CALLS/$n/words\"",
        )?;
        // There is no picture to filter.
        script(&folder.join("pfilt"), "true")?;
        if programs == Programs::Own {
            let program = self.radsight.command(&[]).get_program().to_string_lossy().into_owned();
            for name in ["xform", "getbbox"] {
                script(&folder.join(name), &format!("exec '{program}' {name} \"$@\""))?;
            }
            // The scripts' own commands are trusted.
            script(&folder.join("oconv"), &format!("exec '{program}' oconv --allow-commands \"$@\""))?;
        }
        Ok(())
    }
}

/// The folder with real Radiance's function files.
pub(super) fn library(radiance: &Radiance) -> PathBuf {
    let command = radiance.command("rpict");
    let path = command.get_envs().find(|(name, _)| *name == "RAYPATH").and_then(|(_, value)| value);
    path.and_then(|path| std::env::split_paths(path).last()).unwrap_or_else(|| PathBuf::from("."))
}

/// The folders to measure: those with a script or a project, and those of a folder of folders.
pub(super) fn scene_folders(folders: &[PathBuf]) -> Result<Vec<PathBuf>, BenchError> {
    let mut found = Vec::new();
    for folder in folders {
        if folder.join("run.sh").is_file() || !projects(folder)?.is_empty() {
            found.push(folder.clone());
        } else {
            let inner = entries(folder)?.into_iter().filter(|inner| inner.join("run.sh").is_file());
            found.extend(inner);
        }
    }
    Ok(found)
}

fn projects(folder: &Path) -> Result<Vec<PathBuf>, BenchError> {
    Ok(entries(folder)?.into_iter().filter(|path| path.extension().is_some_and(|end| end == "rif")).collect())
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>, BenchError> {
    let entries = fs::read_dir(folder).map_err(|error| read_error(folder, error.to_string()))?;
    let mut paths: Vec<PathBuf> = entries.filter_map(Result::ok).map(|entry| entry.path()).collect();
    paths.sort();
    Ok(paths)
}

/// The calls in the order of their numbers.
fn recorded(calls: &Path) -> Result<Vec<Call>, BenchError> {
    let mut found = Vec::new();
    while let Ok(folder) = fs::read_to_string(calls.join(format!("{}/folder", found.len()))) {
        let words = read(&calls.join(format!("{}/words", found.len())))?;
        let words = String::from_utf8_lossy(&words).lines().map(str::to_owned).collect();
        found.push(Call { folder: PathBuf::from(folder.trim_end()), words });
    }
    Ok(found)
}

fn finish(command: &mut Command) -> Result<(), BenchError> {
    let name = command.get_program().to_string_lossy().into_owned();
    let done = command.output().map_err(|error| read_error(Path::new(&name), error.to_string()))?;
    if done.status.success() {
        return Ok(());
    }
    let message = String::from_utf8_lossy(&done.stderr).into_owned();
    Err(BenchError::Failed { command: name, status: done.status, message })
}

/// A project with assignments instead of its own to the same variables; an empty one only removes.
/// `rad` recognises variables by their first letters.
fn assigned(text: &str, assignments: &[String]) -> String {
    let replaced = |line: &&str| {
        let name = variable(line);
        !assignments.iter().any(|assignment| !name.is_empty() && variable(assignment).starts_with(&name))
    };
    let kept = text.lines().filter(replaced);
    let new = assignments.iter().map(String::as_str).filter(|assignment| !assignment.trim_end().ends_with('='));
    kept.chain(new).map(|line| format!("{line}\n")).collect()
}

/// The variable that a line assigns to, in capitals.
fn variable(line: &str) -> String {
    line.split_once('=').map_or_else(String::new, |(name, _)| name.trim().to_ascii_uppercase())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn assignments_replace_abbreviated_variables() {
        let assignments = ["RESOLUTION=128", "AMBFILE="].map(str::to_owned);
        let text = assigned("# a test\nres = 1024\nAMB= a.amb\nview= def -vf a.vf\n", &assignments);
        assert_eq!(text, "# a test\nview= def -vf a.vf\nRESOLUTION=128\n");
    }

    #[test]
    fn folders_of_folders_are_opened() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["b", "a"] {
            fs::create_dir(folder.path().join(name)).unwrap();
            fs::write(folder.path().join(name).join("run.sh"), "true\n").unwrap();
        }
        fs::create_dir(folder.path().join("empty")).unwrap();
        let found = scene_folders(&[folder.path().to_owned()]).unwrap();
        assert_eq!(found, ["a", "b"].map(|name| folder.path().join(name)));
    }
}
