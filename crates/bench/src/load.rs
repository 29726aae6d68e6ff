//! `radsight-bench load`: from scene text to a traceable hierarchy, with real Radiance's `oconv`.
//!
//! radsight reads the scene and builds its hierarchies in `rtrace` without a ray; `oconv` writes
//! its octree to the null device. Each program is run by a copy of this one, which reports the cost
//! of its only child.

use crate::args::Load;
use crate::error::BenchError;
use crate::radiance::Radiance;
use crate::radsight::Radsight;
use crate::run::middle;
use crate::table::Table;
use crate::taken::{Taken, taken};
use crate::{generated, machine};
use std::io::Write as _;

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
        let own = median(arguments.repeat, || {
            taken(&mut radsight.command(&["rtrace", "-h", scene.file]), folder.path(), None, None)
        })?;
        push(&mut table, scene.what, "radsight", own, None);
        if let Ok(radiance) = &radiance {
            let oconv = || taken(radiance.command("oconv").args(["-w", scene.file]), folder.path(), None, None);
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
