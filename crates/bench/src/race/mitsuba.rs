//! Mitsuba 3, through a Python script that translates the common subset of scenes.

use super::halves::put;
use super::program::{Program, Series, Setting, Team, read_picture};
use super::scene::{Scene, words};
use crate::cost::measure;
use crate::error::BenchError;
use crate::radsight::Radsight;
use crate::taken::{Taken, taken_within};
use radsight_picture::Image;
use std::path::{Path, PathBuf};
use std::process::Command;

const SCRIPT: &str = include_str!("with_mitsuba.py");

/// One variant of Mitsuba.
#[derive(Debug)]
pub(crate) struct Mitsuba {
    python: PathBuf,
    script: PathBuf,
    variant: &'static str,
    version: String,
    /// Limit of processor time, seconds.
    limit: u64,
    /// Renders the picture of a sky.
    radsight: PathBuf,
    /// The last prepared scene, as text without commands.
    flat: PathBuf,
}

/// The compared variants: plain C++, and vectorised code compiled at run time.
pub(crate) const VARIANTS: [&str; 2] = ["scalar_rgb", "llvm_ad_rgb"];

impl Mitsuba {
    /// Uses the Python named by `RADSIGHT_MITSUBA`, or creates one in `folder` with the newest
    /// Mitsuba of the package index.
    ///
    /// # Errors
    /// A description of why Mitsuba is not available.
    pub(crate) fn find(
        variant: &'static str,
        radsight: &Radsight,
        limit: u64,
        folder: &Path,
    ) -> Result<Mitsuba, String> {
        let python = match std::env::var_os("RADSIGHT_MITSUBA") {
            Some(python) => PathBuf::from(python),
            None => own_python(&folder.join("mitsuba"))?,
        };
        let script = folder.join("with_mitsuba.py");
        put(&script, SCRIPT.as_bytes()).map_err(|error| error.to_string())?;
        let output = Command::new(&python).arg(&script).args(["probe", variant]).output();
        let output = output.map_err(|error| format!("{}: {error}", python.display()))?;
        if !output.status.success() {
            let messages = String::from_utf8_lossy(&output.stderr);
            let message = messages.lines().find(|line| !line.trim().is_empty()).unwrap_or_default();
            return Err(format!("mitsuba {variant} ends with {}: {message}", output.status));
        }
        let version = String::from_utf8_lossy(&output.stdout).trim().to_owned();
        let radsight = PathBuf::from(radsight.command(&[]).get_program());
        Ok(Mitsuba { python, script, variant, version, limit, radsight, flat: PathBuf::new() })
    }

    pub(crate) fn version(&self) -> &str {
        &self.version
    }

    /// The path depth in Mitsuba's count, which includes the light and the first surface. It also
    /// counts mirrors and glass: such scenes are dark enough for this not to matter.
    fn depth(scene: &Scene) -> i64 {
        let bounces =
            scene.task.iter().position(|word| word == "-ab").and_then(|at| scene.task.get(at + 1)?.parse().ok());
        if scene.has_long_paths() { -1 } else { bounces.unwrap_or(0) + 2 }
    }
}

/// A Python with Mitsuba in a separate folder.
fn own_python(folder: &Path) -> Result<PathBuf, String> {
    let python = folder.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    if python.is_file() {
        return Ok(python);
    }
    let run = |command: &mut Command| match command.output() {
        Ok(output) if output.status.success() => Ok(()),
        Ok(output) => Err(String::from_utf8_lossy(&output.stderr).lines().last().unwrap_or_default().to_owned()),
        Err(error) => Err(error.to_string()),
    };
    let made = run(Command::new("python3").args(["-m", "venv"]).arg(folder))
        .and_then(|()| run(Command::new(&python).args(["-m", "pip", "install", "mitsuba", "numpy"])));
    made.map(|()| python).map_err(|reason| format!("cannot create a Python environment with Mitsuba: {reason}"))
}

impl Program for Mitsuba {
    fn team(&self) -> Team {
        Team::Mitsuba
    }

    fn name(&self) -> String {
        format!("mitsuba {}", self.variant)
    }

    fn series(&self, scene: &Scene) -> Vec<Series> {
        if !scene.translated {
            return Vec::new();
        }
        let settings = |sampler: &str| {
            let setting = |rays: u32| Setting::of(format!("{rays} rays"), sampler, rays);
            [4, 16, 64, 256, 1024, 4096].map(setting).to_vec()
        };
        let series = |sampler: &str| Series { name: sampler.to_owned(), unbiased: true, settings: settings(sampler) };
        vec![series("independent"), series("ldsampler")]
    }

    fn prepare(&mut self, scene: &Scene, folder: &Path) -> Result<(), BenchError> {
        self.flat = folder.join("flat.rad");
        if !scene.translated {
            return Ok(());
        }
        let mut command = Command::new(&self.radsight);
        scene.place(command.args(["xform", "-e"]).args(&scene.files));
        measure(&mut command, None, Some(&self.flat), "").map(|_| ())
    }

    fn reading(&self, _: &Scene) -> Option<Command> {
        None
    }

    fn render(&self, scene: &Scene, setting: &Setting, folder: &Path) -> Result<(Taken, Image<f32>), BenchError> {
        let [output, messages] = ["mitsuba.pfm", "mitsuba.txt"].map(|name| folder.join(name));
        let mut command = Command::new(&self.python);
        command.arg(&self.script).args(["render", self.variant]).arg(&self.flat).arg(&output).arg(&self.radsight);
        command.args(scene.size.map(|side| side.to_string())).arg(setting.rays.to_string());
        command.arg(Mitsuba::depth(scene).to_string()).args(&setting.options).args(&scene.view);
        let whole = taken_within(Some(self.limit), &mut command, folder, (None, Some(&messages)))?;
        let text = String::from_utf8_lossy(&crate::figure::read(&messages)?).into_owned();
        // Only rendering counts, without the start of Python and the translation.
        let numbers: Vec<f64> = words(&text).iter().filter_map(|word| word.parse().ok()).collect();
        let rendering = match numbers[..] {
            [processor, wall] => Taken { processor, wall, ..whole },
            _ => whole,
        };
        Ok((rendering, read_picture(&output)?))
    }
}
