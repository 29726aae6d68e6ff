//! Real Radiance: traces the same camera rays through its `rtrace`.

use crate::accuracy::Accuracy;
use crate::cost::{Cost, measure};
use crate::error::BenchError;
use crate::figure::Subject;
use crate::radsight::{Radsight, compare};
use crate::run::RadianceOptions;
use std::path::{Path, PathBuf};
use std::process::Command;

const HINT: &str = "; RADSIGHT_RADIANCE names a folder with bin and lib";

/// Real Radiance's programs.
#[derive(Debug)]
pub(crate) struct Radiance {
    programs: Option<PathBuf>,
    library: Option<PathBuf>,
    version: String,
}

/// A figure compiled by real Radiance.
#[derive(Debug)]
pub(crate) struct Octree {
    path: PathBuf,
}

impl Radiance {
    /// From `RADSIGHT_RADIANCE`, else on PATH.
    ///
    /// # Errors
    /// A description of why it is not available.
    pub(crate) fn find() -> Result<Radiance, String> {
        let home = std::env::var_os("RADSIGHT_RADIANCE").map(PathBuf::from);
        let (programs, library) =
            (home.as_ref().map(|home| home.join("bin")), home.as_ref().map(|home| home.join("lib")));
        let radiance = Radiance { programs, library, version: String::new() };
        let place =
            home.map_or_else(|| "on PATH".to_owned(), |home| format!("in RADSIGHT_RADIANCE={}", home.display()));
        match radiance.command("rtrace").arg("-version").output() {
            Ok(output) if output.status.success() => {
                let version = String::from_utf8_lossy(&output.stdout).trim().to_owned();
                Ok(Radiance { version, ..radiance })
            }
            Ok(output) => Err(format!("rtrace {place} ends with {}", output.status)),
            Err(error) => Err(format!("rtrace {place}: {error}")),
        }
    }

    /// The output of `rtrace -version`.
    pub(crate) fn version(&self) -> &str {
        &self.version
    }

    pub(crate) fn command(&self, name: &str) -> Command {
        let program = self.programs.as_ref().map_or_else(|| PathBuf::from(name), |folder| folder.join(name));
        let mut command = Command::new(program);
        // Scenes name other files of their folder, and Radiance's programs call each other.
        if let Some(Ok(path)) = self.library.as_ref().map(|library| std::env::join_paths([Path::new("."), library])) {
            command.env("RAYPATH", path);
        }
        if let Some(folder) = &self.programs {
            let others = std::env::var_os("PATH").unwrap_or_default();
            let folders = std::iter::once(folder.clone()).chain(std::env::split_paths(&others));
            if let Ok(path) = std::env::join_paths(folders) {
                command.env("PATH", path);
            }
        }
        command
    }

    /// Scene and light ring in one octree.
    pub(crate) fn octree(&self, radsight: &Radsight, subject: &Subject, folder: &Path) -> Result<Octree, BenchError> {
        let (rig, path) = (folder.join("rig.rad"), folder.join(format!("{}.oct", subject.figure)));
        radsight.run(radsight.command(&["rig"]).arg(&subject.camera), None, Some(&rig))?;
        measure(self.command("oconv").args(&subject.scenes).arg(&rig), None, Some(&path), HINT)?;
        Ok(Octree { path })
    }

    /// The time of `rtrace` alone, with two processes, and the accuracy of its result for `samples`
    /// rays per pixel.
    pub(crate) fn capture(
        &self,
        radsight: &Radsight,
        subject: &Subject,
        octree: &Octree,
        options: RadianceOptions,
        samples: u32,
        folder: &Path,
    ) -> Result<(Cost, Accuracy), BenchError> {
        let [rays, radiance, exposure] = ["rays", "radiance", "exposure.mtx"].map(|name| folder.join(name));
        let samples = samples.to_string();
        let mut make_rays = radsight.command(&["pinhole", "rays", "--samples", &samples, "-f", "d"]);
        radsight.run(make_rays.arg(&subject.camera), None, Some(&rays))?;
        let mut trace = self.command("rtrace");
        trace.args(["-n", "2", "-h", "-fdd"]).args(options.words()).arg(&octree.path);
        let cost = measure(&mut trace, Some(&rays), Some(&radiance), HINT)?;
        let mut average = radsight.command(&["pinhole", "average", "--samples", &samples, "-f", "d"]);
        radsight.run(average.arg(&subject.camera), Some(&radiance), Some(&exposure))?;
        Ok((cost, compare(&exposure, subject)?))
    }
}
