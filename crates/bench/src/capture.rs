//! `radsight-bench capture`.

use crate::args::Capture;
use crate::error::BenchError;
use crate::figure::Subject;
use crate::radiance::Radiance;
use crate::radsight::Radsight;
use crate::run::{RadianceOptions, Run, Setting, median};
use crate::{equal_error, machine, table};
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// Measures all figures and prints the tables.
pub(crate) fn run(arguments: &Capture) -> Result<(), BenchError> {
    if let Some(&value) = arguments.errors.iter().find(|error| !(error.is_finite() && **error > 0.0)) {
        return Err(BenchError::AskedError { value });
    }
    let repository =
        arguments.repo.clone().unwrap_or_else(|| PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")));
    let folder = tempfile::tempdir().map_err(|reason| BenchError::Temporary { reason })?;
    let radsight = Radsight::find();
    let radiance = if arguments.alone { Err("omitted by --alone".to_owned()) } else { Radiance::find() };
    let version = radiance.as_ref().map(|radiance| radiance.version().to_owned()).map_err(Clone::clone);
    print(&machine::describe(&radsight, &version));
    let bench = Bench { arguments, radsight, radiance: radiance.ok(), folder: folder.path() };
    let mut runs = Vec::new();
    for figure in &arguments.figures {
        let subject = Subject::read(*figure, &repository)?;
        bench.own_runs(&subject, &mut runs)?;
        bench.radiance_runs(&subject, &mut runs)?;
        if let Some(path) = &arguments.csv {
            // Print after every figure, so that an interrupted run keeps its results.
            fs::write(path, table::csv(&runs)).map_err(|reason| BenchError::Write { path: path.clone(), reason })?;
        }
    }
    print(&format!("\n{}", table::runs(&runs)));
    if bench.radiance.is_some() {
        print(
            "\nProcessor time at equal error (rtrace: itself alone, without rays, octree and average; radsight: everything)\n",
        );
        print(&equal_error::report(&runs, &arguments.figures));
    }
    Ok(())
}

struct Bench<'a> {
    arguments: &'a Capture,
    radsight: Radsight,
    radiance: Option<Radiance>,
    folder: &'a Path,
}

impl Bench<'_> {
    fn own_runs(&self, subject: &Subject, runs: &mut Vec<Run>) -> Result<(), BenchError> {
        let by_samples = self.arguments.samples.iter().map(|samples| Setting::Samples(*samples));
        let by_error = self.arguments.errors.iter().map(|error| Setting::Error(*error));
        for setting in by_samples.chain(by_error) {
            say(subject, setting);
            let repetitions = self.arguments.repeat;
            let measured: Result<Vec<_>, _> =
                (0..repetitions).map(|seed| self.radsight.capture(subject, setting, seed, self.folder)).collect();
            if let Some((cost, accuracy)) = median(&measured?) {
                runs.push(Run { figure: subject.figure, setting, cost, accuracy, repetitions });
            }
        }
        Ok(())
    }

    fn radiance_runs(&self, subject: &Subject, runs: &mut Vec<Run>) -> Result<(), BenchError> {
        let Some(radiance) = &self.radiance else { return Ok(()) };
        let octree = radiance.octree(&self.radsight, subject, self.folder)?;
        for options in [RadianceOptions::Subdivided, RadianceOptions::Defaults] {
            for samples in self.arguments.radiance_samples() {
                let setting = Setting::Radiance(options, samples);
                say(subject, setting);
                let (cost, accuracy) =
                    radiance.capture(&self.radsight, subject, &octree, options, samples, self.folder)?;
                runs.push(Run { figure: subject.figure, setting, cost, accuracy, repetitions: 1 });
            }
        }
        Ok(())
    }
}

/// Prints progress.
fn say(subject: &Subject, setting: Setting) {
    eprintln!("{} {} {setting}", subject.figure, setting.program());
}

/// Prints to standard output; a missing reader is no fault.
pub(crate) fn print(text: &str) {
    let _ = io::stdout().write_all(text.as_bytes());
}
