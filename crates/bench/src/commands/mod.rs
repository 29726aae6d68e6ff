//! `radsight-bench commands`: published `rpict` commands, unchanged, with real Radiance.
//!
//! [`calls`] records the commands of a folder. Then each program renders every picture in turns.
//! The truth is by real Radiance without interpolation ([`truth`]), whichever program is measured.

mod calls;
mod files;
mod nearness;
mod row;
mod truth;

use crate::args::Commands;
use crate::capture::print;
use crate::error::BenchError;
use crate::machine;
use crate::race::{beside_this_program, read_picture};
use crate::radiance::Radiance;
use crate::radsight::Radsight;
use crate::taken::{Taken, taken};
use calls::{Call, Pair, Preparation, library, scene_folders};
use files::read_error;
use nearness::near;
use row::{HEADING, Row, Values, median, summary};
use std::path::{Path, PathBuf};
use std::process::Command;
use truth::{Criterion, Truth};

/// Pictures that take real Radiance longer are rendered once, s.
const LONG: f64 = 5.0;

/// Measures all folders, and prints a table of Markdown, row by row, and a summary.
pub(crate) fn run(arguments: &Commands) -> Result<(), BenchError> {
    let radsight = Radsight::find();
    let radiance = Radiance::find().map_err(|reason| read_error(Path::new("Radiance"), reason))?;
    print(&machine::describe(&radsight, &Ok(radiance.version().to_owned())));
    print(&format!("\n{HEADING}\n"));
    let folder = arguments.folder.clone().unwrap_or_else(beside_this_program).join("commands");
    let preparation = Preparation { radiance: &radiance, radsight: &radsight, assignments: &arguments.assignments };
    let mut rows = Vec::new();
    for scripts in scene_folders(&arguments.folders)? {
        let place = folder.join(scripts.file_name().unwrap_or_default());
        for (index, pair) in preparation.pairs(&scripts, &place)?.into_iter().enumerate() {
            let picture = Picture { pair, index, place: &place, radsight: &radsight, radiance: &radiance };
            let row = picture.measure(arguments)?;
            print(&format!("{}\n", row.to_markdown()));
            rows.push(row);
        }
    }
    print(&format!("\n{}", summary(&rows)));
    Ok(())
}

/// A picture to measure, whose files have its index in their names.
struct Picture<'a> {
    pair: Pair,
    index: usize,
    place: &'a Path,
    radsight: &'a Radsight,
    radiance: &'a Radiance,
}

impl Picture<'_> {
    fn measure(&self, arguments: &Commands) -> Result<Row, BenchError> {
        let (mut real, mut own) = (Vec::new(), Vec::new());
        while real.len() < arguments.repeat as usize {
            let took = self.render(self.radiance.command("rpict"), &self.pair.real, "real")?;
            real.push(took.processor);
            own.push(self.render(self.radsight.command(&["rpict"]), &self.pair.own, "radsight")?.processor);
            if took.processor > LONG {
                break;
            }
        }
        let [peer, ours] = ["real", "radsight"].map(|name| read_picture(&self.file(name)));
        let (peer, ours) = (peer?, ours?);
        let criterion = Criterion { noise: arguments.truth_noise, seconds: arguments.truth_budget };
        let path = truth::path(self.place, self.index, &self.pair.real);
        let truth = Truth::make(&self.pair.real, &peer, self.radiance, criterion, &path)?;
        let (peer, ours) = (near(&peer, &truth.image), near(&ours, &truth.image));
        Ok(Row {
            name: self.pair.name.clone(),
            seconds: Values { real: median(&mut real), own: median(&mut own) },
            blocks: Values { real: peer.blocks, own: ours.blocks },
            error: Values { real: peer.error, own: ours.error },
            noise: truth.noise,
        })
    }

    fn render(&self, mut command: Command, call: &Call, name: &str) -> Result<Taken, BenchError> {
        rpict(command.args(&call.words), call, self.radiance, &self.file(name))
    }

    fn file(&self, name: &str) -> PathBuf {
        self.place.join(format!("{}-{name}.hdr", self.index + 1))
    }
}

/// Runs `rpict` where its call was recorded.
fn rpict(command: &mut Command, call: &Call, radiance: &Radiance, output: &Path) -> Result<Taken, BenchError> {
    let path = [Path::new("."), Path::new("lib"), &library(radiance)].map(Path::to_owned);
    if let Ok(path) = std::env::join_paths(path) {
        command.env("RAYPATH", path);
    }
    taken(command, &call.folder, None, Some(output))
}
