//! What is rendered.

use crate::error::BenchError;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A scene with a view, ready to be rendered.
#[derive(Clone, Debug)]
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    pub(crate) what: &'static str,
    /// Where its files are and its programs run.
    pub(crate) folder: PathBuf,
    /// The files that make the scene, as `oconv` takes them.
    pub(crate) files: Vec<String>,
    /// Folders of further files.
    pub(crate) library: Vec<PathBuf>,
    /// The view, as options.
    pub(crate) view: Vec<String>,
    pub(crate) size: [usize; 2],
    /// Options that say what is to be computed, to be given to all of Radiance's programs: `-ab` and the like.
    pub(crate) task: Vec<String>,
    /// How Radiance can be made to compute it.
    pub(crate) light: Light,
    /// Whether Mitsuba has the same materials and lights.
    pub(crate) translated: bool,
}

/// What makes a scene hard, and so which options are worth trying.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Light {
    /// Only light that comes from its sources straight.
    Direct,
    /// Light by way of diffuse surfaces too.
    Indirect,
}

/// Pixels along each side, unless a scene says otherwise.
const SIDE: usize = 128;

/// After this many reflections paths of scenes with mirrors end.
pub(crate) const LONGEST: &str = "-40";

/// Paths of scenes with indirect light end at random, so that both programs compute the same integral.
const PATHS: &str = "-lr -12 -lw 1e-4";

impl Scene {
    /// A scene of so many bounces of diffuse light in a folder of its own; `files` and `view` are words with spaces between them.
    pub(crate) fn new(
        name: &'static str,
        what: &'static str,
        folder: &Path,
        files: &str,
        view: &str,
        bounces: u32,
    ) -> Scene {
        Scene {
            name,
            what,
            folder: folder.to_owned(),
            files: words(files),
            library: Vec::new(),
            view: words(view),
            size: [SIDE, SIDE],
            task: words(&format!("-ab {bounces} {PATHS}")),
            light: if bounces == 0 { Light::Direct } else { Light::Indirect },
            translated: false,
        }
    }

    /// That Mitsuba can render it as well.
    pub(crate) fn translated(mut self) -> Scene {
        self.translated = true;
        self
    }

    /// With options that all of Radiance's programs get.
    pub(crate) fn with(mut self, options: &str) -> Scene {
        self.task.extend(words(options));
        self
    }

    /// Lets a program find the scene's files: it runs in the scene's folder, and looks in its other folders before `RAYPATH`'s.
    pub(crate) fn place(&self, command: &mut Command) {
        let given =
            command.get_envs().find(|(name, _)| *name == "RAYPATH").and_then(|(_, value)| value.map(OsString::from));
        let others = given.or_else(|| std::env::var_os("RAYPATH")).unwrap_or_default();
        let own = std::iter::once(PathBuf::from(".")).chain(self.library.iter().cloned());
        if let Ok(path) = std::env::join_paths(own.chain(std::env::split_paths(&others))) {
            command.env("RAYPATH", path);
        }
        command.current_dir(&self.folder);
    }

    /// Whether paths are followed until they carry nothing, by way of mirrors and glass.
    pub(crate) fn has_long_paths(&self) -> bool {
        self.task.iter().any(|word| word == LONGEST)
    }

    /// Options of size and view.
    pub(crate) fn frame(&self) -> Vec<String> {
        let [columns, rows] = self.size;
        let size = words(&format!("-x {columns} -y {rows} -pa 0"));
        self.view.iter().cloned().chain(size).collect()
    }

    /// What the reference depends on: the files by their content, as far as they are the scene's own, and all options.
    pub(crate) fn fingerprint(&self) -> Result<u64, BenchError> {
        use std::hash::{DefaultHasher, Hash, Hasher};
        let mut hasher = DefaultHasher::new();
        // Where generated files stand changes from run to run.
        let names: Vec<&String> = self.files.iter().filter(|file| Path::new(file).is_relative()).collect();
        (&names, &self.view, &self.size, &self.task).hash(&mut hasher);
        for file in &self.files {
            let path = self.folder.join(file);
            std::fs::read(&path)
                .map_err(|error| BenchError::Read { path, reason: error.to_string() })?
                .hash(&mut hasher);
        }
        Ok(hasher.finish())
    }
}

/// Words with spaces between them.
pub(crate) fn words(text: &str) -> Vec<String> {
    text.split_whitespace().map(str::to_owned).collect()
}
