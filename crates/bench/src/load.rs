//! `radsight-bench load`: from scene text to what a ray can be sent into, beside real Radiance's `oconv`.
//!
//! radsight reads the scene and builds its hierarchies in `rtrace` without a ray; `oconv` writes its octree to nowhere. Each program is
//! run by a copy of this one, which tells what its only child took.

use crate::args::Load;
use crate::cost::measure;
use crate::error::BenchError;
use crate::radiance::Radiance;
use crate::radsight::Radsight;
use crate::run::middle;
use crate::table::Table;
use crate::{generated, machine};
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

/// What a program took.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Taken {
    /// Processor time, s.
    processor: f64,
    /// From start to end, s.
    wall: f64,
    /// The most memory that was resident, MiB. NaN where the system does not tell.
    peak: f64,
}

/// Measures both generated scenes and prints a table.
pub(crate) fn run(arguments: &Load) -> Result<(), BenchError> {
    let folder = tempfile::tempdir().map_err(|reason| BenchError::Temporary { reason })?;
    let radsight = Radsight::find();
    let radiance = Radiance::find();
    let version = radiance.as_ref().map(|radiance| radiance.version().to_owned()).map_err(Clone::clone);
    print(&machine::describe(&radsight, &version));
    let mut table =
        Table::new(&["scene", "program", "processor s", "wall s", "peak MiB", "times faster", "of the memory"], 2);
    for scene in generated::write(folder.path())? {
        let own =
            median(arguments.repeat, || taken(&mut radsight.command(&["rtrace", "-h", scene.file]), folder.path()))?;
        push(&mut table, scene.what, "radsight", own, None);
        if let Ok(radiance) = &radiance {
            let oconv = || taken(radiance.command("oconv").args(["-w", scene.file]), folder.path());
            let peer = median(arguments.repeat, oconv)?;
            push(&mut table, scene.what, "oconv", peer, Some(own));
        }
    }
    print(&format!("\n{}", table.to_text()));
    Ok(())
}

fn push(table: &mut Table, scene: &str, program: &str, taken: Taken, own: Option<Taken>) {
    let ratio = |ratio: fn(Taken, Taken) -> f64| own.map_or(String::new(), |own| format!("{:.2}", ratio(taken, own)));
    table.push(vec![
        scene.to_owned(),
        program.to_owned(),
        format!("{:.2}", taken.processor),
        format!("{:.2}", taken.wall),
        format!("{:.0}", taken.peak),
        ratio(|peer, own| peer.processor / own.processor),
        ratio(|peer, own| own.peak / peer.peak),
    ]);
}

fn print(text: &str) {
    // A closed pipe is success.
    let _ = std::io::stdout().write_all(text.as_bytes());
}

fn median(repeat: u32, mut run: impl FnMut() -> Result<Taken, BenchError>) -> Result<Taken, BenchError> {
    let runs: Vec<Taken> = (0..repeat).map(|_| run()).collect::<Result<_, _>>()?;
    let of = |value: fn(&Taken) -> f64| middle(runs.iter().map(value).collect()).unwrap_or(f64::NAN);
    Ok(Taken { processor: of(|run| run.processor), wall: of(|run| run.wall), peak: of(|run| run.peak) })
}

/// Runs a program in `folder` by way of `radsight-bench cost`, which this reads.
fn taken(program: &mut Command, folder: &Path) -> Result<Taken, BenchError> {
    let own = std::env::current_exe().map_err(|reason| start_error("radsight-bench", reason))?;
    let mut wrapper = Command::new(own);
    wrapper.arg("cost").arg("--").arg(program.get_program()).args(program.get_args()).current_dir(folder);
    for (name, value) in program.get_envs() {
        if let Some(value) = value {
            wrapper.env(name, value);
        }
    }
    let output =
        wrapper.stderr(Stdio::inherit()).output().map_err(|reason| start_error("radsight-bench cost", reason))?;
    let text = String::from_utf8_lossy(&output.stdout);
    let numbers: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    match numbers[..] {
        [processor, wall, peak] if output.status.success() => Ok(Taken { processor, wall, peak }),
        _ => Err(BenchError::Failed {
            command: program.get_program().to_string_lossy().into_owned(),
            status: output.status,
            message: text.into_owned(),
        }),
    }
}

fn start_error(program: &str, reason: std::io::Error) -> BenchError {
    BenchError::Start { program: program.to_owned(), reason, hint: "" }
}

/// `radsight-bench cost`: runs a program and prints its processor time and wall time in s and its peak memory in MiB.
pub(crate) fn cost(words: &[String]) -> Result<(), BenchError> {
    let Some((program, arguments)) = words.split_first() else { return Ok(()) };
    let cost = measure(Command::new(program).args(arguments), None, None, "")?;
    print(&format!("{} {} {}\n", cost.processor, cost.wall, peak_of_children()));
    Ok(())
}

/// The most memory that any child had resident, MiB.
#[cfg(unix)]
fn peak_of_children() -> f64 {
    use nix::sys::resource::{UsageWho, getrusage};
    // Linux counts in KiB.
    getrusage(UsageWho::RUSAGE_CHILDREN).map_or(f64::NAN, |usage| usage.max_rss() as f64 / 1024.0)
}

#[cfg(not(unix))]
fn peak_of_children() -> f64 {
    f64::NAN
}
