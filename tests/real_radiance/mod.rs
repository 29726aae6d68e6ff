//! Real Radiance, from `RADSIGHT_RADIANCE` (a folder with `bin` and `lib`), else from `PATH`.

// Each test file is a program of its own and uses a part of this.
#![allow(dead_code)]

use crate::program::{Folder, run_with};
use std::env;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::Command;

/// Where the real programs are.
pub(crate) struct Radiance {
    home: Option<PathBuf>,
}

impl Radiance {
    /// Finds it, or says that a test is skipped.
    pub(crate) fn find() -> Option<Radiance> {
        let radiance = Radiance { home: env::var_os("RADSIGHT_RADIANCE").map(PathBuf::from) };
        let found = radiance.command("rtrace", &["-version"]).output().is_ok_and(|output| output.status.success());
        if !found {
            println!("skipped: real Radiance not found");
        }
        found.then_some(radiance)
    }

    /// One of its programs with these words.
    pub(crate) fn command(&self, program: &str, words: &[&str]) -> Command {
        let Some(home) = &self.home else {
            let mut command = Command::new(program);
            command.args(words);
            return command;
        };
        let mut command = Command::new(home.join("bin").join(program));
        let mut raypath = OsString::from(".:");
        raypath.push(home.join("lib"));
        // Its programs call each other by name.
        let mut path = OsString::from(home.join("bin"));
        path.push(":");
        path.push(env::var_os("PATH").unwrap_or_default());
        command.args(words).env("RAYPATH", raypath).env("PATH", path);
        command
    }

    /// Its folder of function files.
    pub(crate) fn library(&self) -> Option<PathBuf> {
        self.home.as_ref().map(|home| home.join("lib"))
    }

    /// Its folder of programs.
    pub(crate) fn programs(&self) -> Option<PathBuf> {
        self.home.as_ref().map(|home| home.join("bin"))
    }

    /// Where it and what should do the same look for files: the working directory, then its library.
    pub(crate) fn raypath(&self) -> String {
        self.library().map_or_else(|| ".".to_owned(), |library| format!(".:{}", library.display()))
    }

    /// An octree of scene files.
    pub(crate) fn octree(&self, folder: &Folder, scenes: &[&str]) -> String {
        let mut command = self.command("oconv", scenes);
        command.current_dir(folder.path(""));
        folder.file("scene.oct", run_with(&mut command, b"").done())
    }
}
