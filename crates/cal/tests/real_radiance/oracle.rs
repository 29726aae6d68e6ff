//! Real Radiance's programs.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// An installation of real Radiance.
pub(crate) struct Radiance {
    bin: Option<PathBuf>,
    pub(crate) lib: Option<PathBuf>,
    /// Whether it detects that a function's value is not a number; builds with fast mathematics do
    /// not.
    pub(crate) sees_faults: bool,
}

impl Radiance {
    /// Finds the installation, or prints that the test is skipped.
    pub(crate) fn find() -> Option<Radiance> {
        let real = radsight_test_support::Radiance::find()?;
        let raypath = std::env::var("RAYPATH").unwrap_or_default();
        let on_raypath = raypath.split(':').map(PathBuf::from).find(|folder| folder.join("rayinit.cal").exists());
        let mut found = Radiance {
            bin: real.programs(),
            lib: real.library().filter(|lib| lib.exists()).or(on_raypath),
            sees_faults: false,
        };
        let (output, _) = found.run("rcalc", &["-n", "-e", "$1=1+acos(2)"], b"")?;
        found.sees_faults = String::from_utf8_lossy(&output).trim() == "1";
        Some(found)
    }

    /// Output of a program and its messages; `None` if it fails.
    pub(crate) fn run(&self, program: &str, arguments: &[&str], input: &[u8]) -> Option<(Vec<u8>, String)> {
        let output = self.output(None, program, arguments, input)?;
        let messages = String::from_utf8_lossy(&output.stderr).into_owned();
        output.status.success().then_some((output.stdout, messages))
    }

    /// Output of a program, or its messages if it fails.
    pub(crate) fn try_run(&self, program: &str, arguments: &[&str], input: &[u8]) -> Result<Vec<u8>, String> {
        let output = self.output(None, program, arguments, input).ok_or_else(String::new)?;
        match output.status.success() {
            true => Ok(output.stdout),
            false => Err(String::from_utf8_lossy(&output.stderr).into_owned()),
        }
    }

    /// Output of a program that runs in a folder.
    pub(crate) fn run_in(&self, folder: &Path, program: &str, arguments: &[&str], input: &[u8]) -> Option<Vec<u8>> {
        let output = self.output(Some(folder), program, arguments, input)?;
        if !output.status.success() {
            println!("{program}: {}", String::from_utf8_lossy(&output.stderr));
        }
        output.status.success().then_some(output.stdout)
    }

    fn output(&self, folder: Option<&Path>, program: &str, arguments: &[&str], input: &[u8]) -> Option<Output> {
        let path = self.bin.as_ref().map_or_else(|| PathBuf::from(program), |bin| bin.join(program));
        let mut command = Command::new(path);
        if let Some(folder) = folder {
            command.current_dir(folder);
        }
        if let Some(lib) = &self.lib {
            command.env("RAYPATH", format!(".:{}", lib.display()));
        }
        let pipes = command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = pipes.spawn().ok()?;
        let mut stdin = child.stdin.take()?;
        let input = input.to_vec();
        let feeding = std::thread::spawn(move || stdin.write_all(&input));
        let output = child.wait_with_output().ok()?;
        let _ = feeding.join();
        Some(output)
    }
}

/// Numbers as bytes.
pub(crate) fn to_bytes(numbers: &[f64]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_ne_bytes()).collect()
}

/// Bytes as numbers.
pub(crate) fn to_numbers(bytes: &[u8]) -> Vec<f64> {
    bytes.chunks_exact(8).map(|chunk| f64::from_ne_bytes(chunk.try_into().unwrap())).collect()
}
