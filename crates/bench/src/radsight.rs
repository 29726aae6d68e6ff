//! The `radsight` program built beside this one.

use crate::accuracy::Accuracy;
use crate::cost::{Cost, measure};
use crate::error::BenchError;
use crate::figure::{Subject, read};
use crate::run::Setting;
use radsight_picture::read_image;
use std::path::{Path, PathBuf};
use std::process::Command;

const HINT: &str = "; build it with `cargo build --release -p radsight-cli`";

/// The `radsight` program.
#[derive(Debug)]
pub(crate) struct Radsight {
    program: PathBuf,
}

impl Radsight {
    /// The program in the folder of this one.
    pub(crate) fn find() -> Radsight {
        let folder = std::env::current_exe().ok().and_then(|own| own.parent().map(Path::to_owned)).unwrap_or_default();
        Radsight { program: folder.join(format!("radsight{}", std::env::consts::EXE_SUFFIX)) }
    }

    /// The program with arguments.
    pub(crate) fn command(&self, words: &[&str]) -> Command {
        let mut command = Command::new(&self.program);
        command.args(words);
        command
    }

    /// Runs it with its streams in files.
    pub(crate) fn run(
        &self,
        command: &mut Command,
        input: Option<&Path>,
        output: Option<&Path>,
    ) -> Result<Cost, BenchError> {
        measure(command, input, output, HINT)
    }

    /// Captures a figure and compares it with its truth.
    pub(crate) fn capture(
        &self,
        subject: &Subject,
        setting: Setting,
        seed: u32,
        folder: &Path,
    ) -> Result<(Cost, Accuracy), BenchError> {
        let exposure = folder.join("exposure.pfm");
        let mut command = self.command(&["capture"]);
        match setting {
            Setting::Samples(samples) => command.args(["--samples", &samples.to_string()]),
            Setting::Error(error) => command.args(["--error", &error.to_string()]),
            Setting::Radiance(..) => &mut command,
        };
        command.args(["--seed", &seed.to_string()]).arg("--exposure").arg(&exposure);
        command.arg(&subject.camera).args(&subject.scenes);
        let cost = self.run(&mut command, None, None)?;
        Ok((cost, compare(&exposure, subject)?))
    }
}

/// Compares an exposure file with the truth.
pub(crate) fn compare(path: &Path, subject: &Subject) -> Result<Accuracy, BenchError> {
    let image = read_image(&read(path)?)
        .map_err(|error| BenchError::Read { path: path.to_owned(), reason: error.to_string() })?
        .image;
    let exposures: Vec<f64> = image.data().iter().map(|value| f64::from(*value)).collect();
    Accuracy::new(&format!("a capture of {}", subject.figure), &exposures, subject)
}
