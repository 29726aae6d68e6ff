//! Embree through the Python package `embreex`, whose loop over single rays is compiled.

use crate::rays::TraceResult;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

const SCRIPT: &str = include_str!("with_embree.py");

/// A running process with a scene and its rays, which traces them on request.
pub(crate) struct Embree {
    process: Child,
    asked: ChildStdin,
    answers: BufReader<ChildStdout>,
    /// Growth of the process in bytes, due to hierarchy and triangles.
    pub(crate) bytes: f64,
}

impl Embree {
    /// Reads a scene of triangles and a stream of rays; `folder` gets the script.
    pub(crate) fn start(scene: &Path, rays: &Path, folder: &Path) -> Result<Embree, String> {
        let Some(python) = std::env::var_os("RADSIGHT_EMBREE") else {
            return Err("RADSIGHT_EMBREE names no Python with the packages embreex and numpy".to_owned());
        };
        let script = folder.join("with_embree.py");
        std::fs::write(&script, SCRIPT).map_err(|error| error.to_string())?;
        let mut command = Command::new(PathBuf::from(python));
        command.arg(script).args([scene, rays]).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut process = command.spawn().map_err(|error| error.to_string())?;
        let (Some(asked), Some(answers)) = (process.stdin.take(), process.stdout.take()) else {
            return Err("its streams cannot be had".to_owned());
        };
        let mut embree = Embree { process, asked, answers: BufReader::new(answers), bytes: f64::NAN };
        let [bytes] = embree.numbers()?;
        embree.bytes = bytes;
        Ok(embree)
    }

    /// Traces all rays once.
    pub(crate) fn trace_all(&mut self) -> Result<TraceResult, String> {
        self.asked.write_all(b"\n").and_then(|()| self.asked.flush()).map_err(|error| error.to_string())?;
        let [seconds, hits, sum] = self.numbers()?;
        Ok(TraceResult { seconds, hits: hits as usize, sum })
    }

    fn numbers<const N: usize>(&mut self) -> Result<[f64; N], String> {
        let mut line = String::new();
        self.answers.read_line(&mut line).map_err(|error| error.to_string())?;
        let numbers: Vec<f64> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        numbers.try_into().map_err(|_| "it ended early".to_owned())
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        // It ends by itself with its input; one that hangs must not outlive the benchmark.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
