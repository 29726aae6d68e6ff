//! `radsight-bench race`: pictures of many scenes by radsight, real Radiance and Mitsuba 3, and the
//! time of each to an error.

mod accuracy;
mod catalog;
mod halves;
mod mitsuba;
mod own;
mod page;
mod program;
mod real;
mod reference;
mod result;
mod scene;

use crate::args::Race;
use crate::capture::print;
use crate::error::BenchError;
use crate::radiance::Radiance;
use crate::radsight::Radsight;
use crate::taken::Taken;
use crate::{machine, scaling};
use accuracy::Accuracy;
use catalog::{Places, SCENES, chosen};
pub(crate) use halves::{Halves, put};
use mitsuba::{Mitsuba, VARIANTS};
use own::Own;
pub(crate) use program::{Program, read_picture};
use program::{Team, reading};
pub(crate) use real::{Real, RealKind};
use reference::{Criterion, Reference};
use result::{CSV_HEADING, Clock, Entrant, Run, SceneResult, Summary};
pub(crate) use scene::Scene;
use std::fs;
use std::path::{Path, PathBuf};

/// Renders all scenes and writes table, CSV file and page after each.
pub(crate) fn run(arguments: &Race) -> Result<(), BenchError> {
    if arguments.list {
        SCENES.iter().for_each(|(name, _)| print(&format!("{name}\n")));
        return Ok(());
    }
    let prepare = chosen(&arguments.scenes)?;
    let temporary = tempfile::tempdir().map_err(|reason| BenchError::Temporary { reason })?;
    let folder = arguments.folder.clone().unwrap_or_else(beside_this_program);
    let references = folder.join("references");
    fs::create_dir_all(&references).map_err(|reason| BenchError::Write { path: references.clone(), reason })?;
    let repository =
        arguments.repo.clone().unwrap_or_else(|| PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")));
    let shared = std::env::var_os("RADSIGHT_SHARED").map(PathBuf::from);
    let places = Places { repository: &repository, folder: temporary.path(), shared: shared.as_deref() };
    let radiance = if arguments.alone { Err("omitted by --alone".to_owned()) } else { Radiance::find() };
    let mut bench = Bench::new(arguments, radiance.as_ref(), temporary.path(), &folder);
    let version = radiance.as_ref().map(|radiance| radiance.version().to_owned()).map_err(Clone::clone);
    let machine = format!("{}{}", machine::describe(&Radsight::find(), &version), bench.versions);
    print(&machine);
    let clock = if arguments.wall { Clock::Wall } else { Clock::Processor };
    let mut results = Vec::new();
    for prepare in prepare {
        let Some(scene) = prepare(&places)? else {
            bench.missing.push("a published scene, missing in RADSIGHT_SHARED".to_owned());
            continue;
        };
        let result = bench.scene(scene, &references)?;
        print(&format!(
            "\n{}: {}\nreading, not counted: {}\n{}",
            result.scene.name,
            result.reference.check,
            result.read,
            page::runs(&result)
        ));
        results.push(result);
        // Write after every scene, so that an interrupted run keeps its results.
        let csv: String = results.iter().map(SceneResult::to_csv).collect();
        put(&folder.join("race.csv"), format!("{CSV_HEADING}{csv}").as_bytes())?;
        let growth = scaling::section(&fs::read_to_string(folder.join(scaling::FILE)).unwrap_or_default());
        let page = page::page(&machine, &bench.missing, &results, &Summary::new(&results, clock), clock, &growth);
        put(&folder.join("race.html"), page.as_bytes())?;
    }
    bench.missing.iter().for_each(|reason| print(&format!("missing: {reason}\n")));
    print(&format!("\nTime to an error ({})\n{}", clock.words(), Summary::new(&results, clock).to_text()));
    print(&format!("wrote race.csv and race.html to {}\n", folder.display()));
    Ok(())
}

/// `target/bench` where this program is `target/release/radsight-bench`.
pub(crate) fn beside_this_program() -> PathBuf {
    let own = std::env::current_exe().unwrap_or_default();
    own.parent().and_then(Path::parent).unwrap_or(Path::new(".")).join("bench")
}

struct Bench<'a> {
    arguments: &'a Race,
    own: Own,
    real: Vec<Real<'a>>,
    mitsuba: Vec<Mitsuba>,
    /// Programs and scenes that do not take part, with reasons.
    missing: Vec<String>,
    /// Lines for the description of the machine.
    versions: String,
    folder: &'a Path,
}

impl<'a> Bench<'a> {
    fn new(arguments: &'a Race, radiance: Result<&'a Radiance, &String>, temporary: &'a Path, folder: &Path) -> Self {
        let (mut missing, mut mitsuba, mut versions) = (Vec::new(), Vec::new(), String::new());
        let real = match radiance {
            Ok(radiance) => {
                [RealKind::Rtrace, RealKind::Rpict].map(|kind| Real::new(radiance, kind, arguments.limit)).into()
            }
            Err(reason) => {
                missing.push(format!("real Radiance: {reason}"));
                Vec::new()
            }
        };
        for variant in VARIANTS {
            match if arguments.alone {
                Err("omitted by --alone".to_owned())
            } else {
                Mitsuba::find(variant, &Radsight::find(), arguments.limit, folder)
            } {
                Ok(found) => {
                    versions.push_str(&format!("Mitsuba   {} {variant}\n", found.version()));
                    mitsuba.push(found);
                }
                Err(reason) => missing.push(format!("Mitsuba {variant}: {reason}")),
            }
        }
        Bench {
            arguments,
            own: Own { radsight: Radsight::find() },
            real,
            mitsuba,
            missing,
            versions,
            folder: temporary,
        }
    }

    /// Makes the reference, then runs every program's series up to the budget.
    fn scene(&mut self, scene: Scene, references: &Path) -> Result<SceneResult, BenchError> {
        eprintln!("{}: reference", scene.name);
        for real in &mut self.real {
            real.prepare(&scene, self.folder)?;
        }
        for mitsuba in &mut self.mitsuba {
            mitsuba.prepare(&scene, self.folder)?;
        }
        let criterion = Criterion { noise: self.arguments.reference_noise, seconds: self.arguments.reference_budget };
        let reference = Reference::make(&scene, &self.own, self.real.first(), criterion, (self.folder, references))?;
        let (mut entrants, mut read) = (Vec::new(), Vec::new());
        let programs = std::iter::once(&self.own as &dyn Program)
            .chain(self.real.iter().map(|real| real as &dyn Program))
            .chain(self.mitsuba.iter().map(|mitsuba| mitsuba as &dyn Program));
        for program in programs {
            match self.race(program, &scene, &reference) {
                Ok((of_program, reading, ended)) => {
                    entrants.extend(of_program);
                    self.missing.extend(ended);
                    read.push(format!("{} {:.3} s", program.name(), reading.processor));
                }
                // The race continues without programs that fail.
                Err(reason) if program.team() != Team::Radsight => {
                    self.missing.push(format!("{} on {}: {reason}", program.name(), scene.name));
                }
                Err(reason) => return Err(reason),
            }
        }
        Ok(SceneResult { scene, reference, read: read.join(", "), entrants })
    }

    /// Runs a program's series up to the budget; also returns the cost of reading the scene, and
    /// the settings that were stopped.
    fn race(
        &self,
        program: &dyn Program,
        scene: &Scene,
        reference: &Reference,
    ) -> Result<(Vec<Entrant>, Taken, Vec<String>), BenchError> {
        let reading = reading(program, scene)?;
        let (mut entrants, mut ended) = (Vec::new(), Vec::new());
        for series in program.series(scene) {
            let mut entrant = Entrant {
                team: program.team(),
                program: program.name(),
                series: series.name,
                unbiased: series.unbiased,
                runs: Vec::new(),
            };
            for setting in series.settings {
                eprintln!("{}: {} {}", scene.name, entrant.program, setting.label);
                let (taken, picture) = match program.render(scene, &setting, self.folder) {
                    Err(reason @ BenchError::TookTooLong { .. }) => {
                        ended.push(format!("{} on {}, {}: {reason}", entrant.program, scene.name, setting.label));
                        break;
                    }
                    rendered => rendered?,
                };
                let accuracy = Accuracy::new(&picture, &reference.image).less(reference.noise);
                let is_last = taken.processor > self.arguments.budget;
                entrant.runs.push(Run { label: setting.label, taken: taken.less(reading), accuracy, picture });
                if is_last {
                    break;
                }
            }
            entrants.push(entrant);
        }
        Ok((entrants, reading, ended))
    }
}
