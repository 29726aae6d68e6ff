//! Scenes of the race.

use crate::error::BenchError;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A prepared scene with a view.
#[derive(Clone, Debug)]
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    pub(crate) what: &'static str,
    /// Folder of its files, in which programs run.
    pub(crate) folder: PathBuf,
    /// The files of the scene, as `oconv` takes them.
    pub(crate) files: Vec<String>,
    /// The files for real Radiance, if they differ.
    pub(crate) radiance_files: Option<Vec<String>>,
    /// Folders of further files.
    pub(crate) library: Vec<PathBuf>,
    /// The view options.
    pub(crate) view: Vec<String>,
    pub(crate) size: [usize; 2],
    /// Options that define the computed light, for all of Radiance's programs: `-ab` and so on.
    pub(crate) task: Vec<String>,
    /// Further options of radsight.
    pub(crate) own_task: Vec<String>,
    /// The kind of settings that Radiance needs.
    pub(crate) light: Light,
    /// Whether Mitsuba supports the same materials and lights.
    pub(crate) translated: bool,
}

/// The difficulty of a scene, which selects the settings to try.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Light {
    /// Direct light only.
    Direct,
    /// Diffuse interreflection.
    Indirect,
}

/// Default width and height, pixels.
const SIDE: usize = 128;

/// Largest number of reflections in scenes with mirrors.
pub(crate) const LONGEST: &str = "-40";

/// Russian roulette in scenes with indirect light, so that both programs compute the same integral.
const PATHS: &str = "-lr -12 -lw 1e-4";

impl Scene {
    /// A scene with this many diffuse bounces in a separate folder; `files` and `view` are
    /// separated by spaces.
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
            radiance_files: None,
            library: Vec::new(),
            view: words(view),
            size: [SIDE, SIDE],
            task: words(&format!("-ab {bounces} {PATHS}")),
            own_task: Vec::new(),
            light: if bounces == 0 { Light::Direct } else { Light::Indirect },
            translated: false,
        }
    }

    /// Marks that Mitsuba can render it as well.
    pub(crate) fn translated(mut self) -> Scene {
        self.translated = true;
        self
    }

    /// Adds options for all of Radiance's programs.
    pub(crate) fn with(mut self, options: &str) -> Scene {
        self.task.extend(words(options));
        self
    }

    /// Includes light of lamps through mirrors and glass in the task. Real Radiance computes
    /// it for glows only, so it gets files in which the lamps are glows.
    pub(crate) fn with_caustics(mut self, radiance_files: &str) -> Scene {
        self.own_task.extend(words("--caustics"));
        self.radiance_files = Some(words(radiance_files));
        self
    }

    /// The files of real Radiance.
    pub(crate) fn files_of_radiance(&self) -> &[String] {
        self.radiance_files.as_ref().unwrap_or(&self.files)
    }

    /// Sets a program's folder and search path for the scene: its other folders precede `RAYPATH`.
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

    /// Whether paths continue through mirrors and glass until their weight is negligible.
    pub(crate) fn has_long_paths(&self) -> bool {
        self.task.iter().any(|word| word == LONGEST)
    }

    /// Options of size and view.
    pub(crate) fn frame(&self) -> Vec<String> {
        let [columns, rows] = self.size;
        let size = words(&format!("-x {columns} -y {rows} -pa 0"));
        self.view.iter().cloned().chain(size).collect()
    }

    /// Identity of the reference: the content of the scene's own files, and all options.
    pub(crate) fn fingerprint(&self) -> Result<u64, BenchError> {
        use std::hash::{DefaultHasher, Hash, Hasher};
        let mut hasher = DefaultHasher::new();
        // The paths of generated files change between runs.
        let names: Vec<&String> = self.files.iter().filter(|file| Path::new(file).is_relative()).collect();
        (&names, &self.view, &self.size, &self.task, &self.own_task).hash(&mut hasher);
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
