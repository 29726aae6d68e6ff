//! Real Radiance, from `RADSIGHT_RADIANCE` (a folder with `bin` and `lib`), else from `PATH`.

use std::env;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;

/// If this variable is `1`, tests fail where real Radiance is missing.
pub const REQUIRE_RADIANCE: &str = "RADSIGHT_REQUIRE_RADIANCE";

/// The location of the real programs.
#[derive(Clone, Debug)]
pub struct Radiance {
    home: Option<PathBuf>,
}

impl Radiance {
    /// Finds real Radiance, or notes that a test is skipped.
    ///
    /// # Panics
    /// If it is missing and [`REQUIRE_RADIANCE`] is `1`.
    #[must_use]
    pub fn find() -> Option<Radiance> {
        let radiance = Radiance { home: env::var_os("RADSIGHT_RADIANCE").map(PathBuf::from) };
        let version = radiance.command("rtrace", &["-version"]).output();
        if version.is_ok_and(|output| output.status.success()) {
            return Some(radiance);
        }
        Self::missing(env::var_os(REQUIRE_RADIANCE).as_deref());
        None
    }

    fn missing(required: Option<&OsStr>) {
        assert!(
            required.is_none_or(|value| value != "1"),
            "real Radiance not found, and {REQUIRE_RADIANCE}=1: name its folder in RADSIGHT_RADIANCE or put it on PATH"
        );
        println!("skipped: real Radiance not found");
    }

    /// A command for one of its programs with these arguments.
    #[must_use]
    pub fn command(&self, program: &str, words: &[&str]) -> Command {
        let Some(home) = &self.home else {
            let mut command = Command::new(program);
            command.args(words);
            return command;
        };
        let mut command = Command::new(home.join("bin").join(program));
        let mut raypath = OsString::from(".:");
        raypath.push(home.join("lib"));
        command.args(words).env("RAYPATH", raypath).env("PATH", self.path());
        command
    }

    /// The search path with its programs first: they call each other by name.
    #[must_use]
    pub fn path(&self) -> OsString {
        let mut path = OsString::new();
        if let Some(programs) = self.programs() {
            path.push(programs);
            path.push(":");
        }
        path.push(env::var_os("PATH").unwrap_or_default());
        path
    }

    /// Runs one of its programs in a folder with this standard input, and returns its output.
    ///
    /// # Panics
    /// When the program fails.
    #[must_use]
    #[track_caller]
    pub fn run(&self, folder: &Path, program: &str, words: &[&str], input: &[u8]) -> Vec<u8> {
        let mut command = self.command(program, words);
        command.current_dir(folder).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("the real program starts");
        let mut pipe = child.stdin.take().expect("standard input is a pipe");
        let input = input.to_vec();
        // A program that stops at a mistake closes the pipe, so a failed write is not our error.
        let writer = thread::spawn(move || drop(pipe.write_all(&input)));
        let output = child.wait_with_output().expect("the real program ends");
        writer.join().expect("the writer ends");
        assert!(output.status.success(), "{program}: {}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    }

    /// Its folder of function files.
    #[must_use]
    pub fn library(&self) -> Option<PathBuf> {
        self.home.as_ref().map(|home| home.join("lib"))
    }

    /// Its folder of programs.
    #[must_use]
    pub fn programs(&self) -> Option<PathBuf> {
        self.home.as_ref().map(|home| home.join("bin"))
    }

    /// The search path for files in comparisons: the working directory, then its library.
    #[must_use]
    pub fn raypath(&self) -> String {
        self.library().map_or_else(|| ".".to_owned(), |library| format!(".:{}", library.display()))
    }

    /// Compiles scene files in a folder to an octree and returns its name.
    ///
    /// # Panics
    /// When `oconv` fails.
    #[track_caller]
    pub fn octree(&self, folder: impl AsRef<Path>, scenes: &[&str]) -> String {
        let folder = folder.as_ref();
        let octree = folder.join("scene.oct");
        fs::write(&octree, self.run(folder, "oconv", scenes, b"")).expect("a file is written");
        octree.display().to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_radiance_is_skipped_where_nobody_requires_it() {
        Radiance::missing(None);
        Radiance::missing(Some(OsStr::new("0")));
    }

    #[test]
    #[should_panic(expected = "real Radiance not found, and RADSIGHT_REQUIRE_RADIANCE=1")]
    fn a_missing_radiance_fails_where_it_is_required() {
        Radiance::missing(Some(OsStr::new("1")));
    }

    #[test]
    fn its_programs_come_first_on_the_path() {
        let radiance = Radiance { home: Some(PathBuf::from("radiance")) };
        assert!(radiance.path().to_string_lossy().starts_with("radiance/bin:"));
        assert_eq!(radiance.raypath(), ".:radiance/lib");
    }
}
