//! `radsight-bench rooms`: whether `rpict --error E` reaches E, over random rooms.
//!
//! Each seed makes a room, a view and options ([`room`]). Two independent references of independent
//! paths give an unbiased estimate of the error of each picture ([`comparison`]).

mod comparison;
mod random;
mod real_radiance;
mod reference;
mod room;
mod summary;
pub(crate) mod text;

use crate::args::Rooms;
use crate::capture::print;
use crate::error::BenchError;
use crate::race::{Scene, beside_this_program, put, read_picture};
use crate::radiance::Radiance;
use crate::radsight::Radsight;
use crate::table::Table;
use crate::taken::taken;
use comparison::Comparison;
use real_radiance::{RealRadiance, TimeRatio};
use reference::Reference;
use room::Room;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use summary::{Verdict, summary};

/// References are sufficient when the square of the smallest requested error is known to this
/// fraction.
const MAX_UNCERTAINTY: f64 = 1.0 / 9.0;

/// Relative tolerance between a reported error and the true one, beyond both intervals.
const TOLERANCE: f64 = 0.15;

/// Measures all seeds and prints a table and a summary.
pub(crate) fn run(arguments: &Rooms) -> Result<(), BenchError> {
    if let Some(&value) = arguments.errors.iter().find(|error| !(**error > 0.0 && error.is_finite())) {
        return Err(BenchError::AskedError { value });
    }
    let folder = arguments.folder.clone().unwrap_or_else(beside_this_program).join("rooms");
    let radiance = if arguments.beside {
        let missing = |reason| BenchError::Read { path: PathBuf::from("Radiance"), reason };
        Some(Radiance::find().map_err(missing)?)
    } else {
        None
    };
    let mut rows = Vec::new();
    let mut table = Table::new(&HEADING, 2);
    for seed in arguments.seeds.0..=arguments.seeds.1 {
        let place = RoomFolder::make(seed, arguments, &folder)?;
        if arguments.scenes_only {
            print(&format!("{}\n", place.folder.display()));
            continue;
        }
        for row in place.measure(arguments, radiance.as_ref())? {
            table.push(row.cells());
            print(&format!("{}\n", row.cells().join("  ")));
            rows.push(row);
        }
    }
    if !rows.is_empty() {
        print(&format!("\n{}\n{}", table.to_text(), summary(&rows, &arguments.errors)));
    }
    Ok(())
}

const HEADING: [&str; 11] = [
    "room",
    "contents",
    "requested %",
    "true %",
    "±",
    "blocks %",
    "reported %",
    "±",
    "processor s",
    "real Radiance takes",
    "stopped by",
];

/// A room in its own folder.
struct RoomFolder {
    seed: u64,
    room: Room,
    folder: PathBuf,
    size: [String; 2],
}

/// The result of one requested error.
struct Row {
    seed: u64,
    contents: String,
    requested: f64,
    found: Comparison,
    /// Error and half width of its interval, as reported by the program.
    reported: Option<[f64; 2]>,
    seconds: f64,
    /// Real Radiance at the same error.
    real: Option<TimeRatio>,
    stopped: String,
}

impl RoomFolder {
    fn make(seed: u64, arguments: &Rooms, folder: &Path) -> Result<RoomFolder, BenchError> {
        let room = Room::new(seed);
        let size = [arguments.columns, arguments.columns * 3 / 4].map(|side| side.max(1).to_string());
        let key = fingerprint(&[&room.scene, &room.view.join(" "), &room.options.join(" "), &size[0]]);
        let folder = folder.join(format!("{seed}-{key:016x}"));
        fs::create_dir_all(&folder).map_err(|reason| BenchError::Write { path: folder.clone(), reason })?;
        put(&folder.join("room.rad"), room.scene.as_bytes())?;
        put(&folder.join("view.vf"), format!("rvu {}\n", room.view.join(" ")).as_bytes())?;
        put(&folder.join("options.opt"), format!("{}\n", room.options.join(" ")).as_bytes())?;
        Ok(RoomFolder { seed, room, folder, size })
    }

    /// `rpict` with the room's view and options; the scene comes last.
    fn command(&self, radsight: &Radsight) -> Command {
        let mut command = radsight.command(&["rpict", "-w-", "-ff", "-pj", "1"]);
        command.args(["-x", &self.size[0], "-y", &self.size[1], "-pa", "1"]);
        command.args(&self.room.view).args(&self.room.options);
        command
    }

    /// The room for real Radiance.
    fn scene(&self) -> Scene {
        let bounces = self.room.options[1].parse().unwrap_or(1);
        let mut scene = Scene::new("room", "", &self.folder, "room.rad", &self.room.view.join(" "), bounces);
        scene.size = self.size.each_ref().map(|side| side.parse().unwrap_or(1));
        scene
    }

    fn measure(&self, arguments: &Rooms, radiance: Option<&Radiance>) -> Result<Vec<Row>, BenchError> {
        let smallest = arguments.errors.iter().copied().fold(f64::INFINITY, f64::min);
        let mut reference = Reference::read(self.folder.join("reference"));
        reference.improve(&|radsight| self.command(radsight), arguments.reference_budget, &self.folder, &|halves| {
            // Assumes that the picture has exactly the requested error.
            let noise = Comparison::new(halves[0], [halves[1], halves[1]]).pixels.value.max(0.0);
            let pixels = halves[0].data().len() as f64 / 3.0;
            (noise * noise + 2.0 * smallest.powi(2) * noise).sqrt() / pixels.sqrt()
                < 0.5 * MAX_UNCERTAINTY * smallest.powi(2)
        })?;
        let Some(halves) = reference.halves() else { return Ok(Vec::new()) };
        let real_radiance = match radiance {
            Some(radiance) => {
                Some(RealRadiance::new(radiance, &self.scene(), halves, (smallest, arguments.beside_limit))?)
            }
            None => None,
        };
        let contents = self.room.contents.join(" ");
        let mut rows = Vec::new();
        for &requested in &arguments.errors {
            let [output, notes] = ["picture.floats", "notes.txt"].map(|name| self.folder.join(name));
            let _ = fs::remove_file(&notes);
            let mut command = Radsight::find().command(&["rpict"]);
            command.args(self.command(&Radsight::find()).get_args().skip(2));
            command.args(["--error", &requested.to_string(), "-e", "notes.txt"]);
            if let Some(seconds) = arguments.limit {
                command.args(["--time-limit", &seconds.to_string()]);
            }
            command.arg("room.rad");
            let took = taken(&mut command, &self.folder, None, Some(&output))?;
            let notes = fs::read_to_string(&notes).unwrap_or_default();
            let found = Comparison::new(&read_picture(&output)?, halves);
            rows.push(Row {
                seed: self.seed,
                contents: format!("-ab {} {contents}", self.room.options[1]),
                requested,
                found,
                real: real_radiance
                    .as_ref()
                    .and_then(|real_radiance| real_radiance.ratio_to(found.pixels.error(), took.processor)),
                reported: reported(&notes),
                seconds: took.processor,
                stopped: stopped(&notes),
            });
        }
        Ok(rows)
    }
}

/// The first two percentages of a note.
fn reported(notes: &str) -> Option<[f64; 2]> {
    let words: Vec<&str> = notes.split_whitespace().collect();
    let percentages = words.windows(2).filter(|pair| pair[1].starts_with('%'));
    let numbers: Vec<f64> = percentages.filter_map(|pair| pair[0].parse::<f64>().ok()).map(|n| n / 100.0).collect();
    numbers.first_chunk().copied()
}

/// The note's reason for stopping.
fn stopped(notes: &str) -> String {
    notes.split_once("stopped by ").map_or_else(String::new, |(_, reason)| reason.trim().to_owned())
}

impl Row {
    /// The interval of the error relative to the requested one.
    fn verdict(&self) -> Verdict {
        let [low, high] = self.found.pixels.interval();
        if high <= self.requested {
            Verdict::AtOrBelow
        } else if low > self.requested {
            Verdict::Above
        } else {
            Verdict::Undecided
        }
    }

    /// Whether the intervals of the true and of the reported error overlap within the tolerance.
    fn agrees(&self) -> bool {
        let Some([error, half]) = self.reported else { return false };
        let [low, high] = self.found.pixels.interval();
        error - half <= high * (1.0 + TOLERANCE) && error + half >= low * (1.0 - TOLERANCE)
    }

    fn cells(&self) -> Vec<String> {
        let percent = |share: f64| format!("{:.2}", 100.0 * share);
        let [low, high] = self.found.pixels.interval();
        let reported = self.reported.map_or(["?".to_owned(), "?".to_owned()], |pair| pair.map(percent));
        let [error, half] = reported;
        let mark = match self.verdict() {
            Verdict::AtOrBelow => "",
            Verdict::Above => " !",
            Verdict::Undecided => " ?",
        };
        vec![
            self.seed.to_string(),
            self.contents.clone(),
            percent(self.requested),
            percent(self.found.pixels.error()) + mark,
            percent(0.5 * (high - low)),
            percent(self.found.blocks.error()),
            error,
            half + if self.agrees() { "" } else { " !" },
            format!("{:.2}", self.seconds),
            self.real.map_or_else(String::new, |times| times.to_string()),
            match self.verdict() {
                Verdict::Above if self.stopped.is_empty() => "nothing".to_owned(),
                _ => self.stopped.clone(),
            },
        ]
    }
}

/// A hash of texts (FNV-1a).
fn fingerprint(texts: &[&str]) -> u64 {
    let bytes = texts.iter().flat_map(|text| text.bytes().chain([0]));
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// The seeds `A..B`, both included, or one seed.
pub(crate) fn seeds(text: &str) -> Result<(u64, u64), String> {
    let (first, last) = text.split_once("..").unwrap_or((text, text));
    match (first.parse(), last.trim_start_matches('=').parse()) {
        (Ok(first), Ok(last)) if first <= last => Ok((first, last)),
        _ => Err("expected A..B, two whole numbers of which the first is no larger".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::comparison::Squared;
    use super::*;

    #[test]
    fn notes_are_understood() {
        let note = "rpict: note: the error is 4.12 % ± 0.34 % (95 %) with 12.5 rays each; stopped by --time-limit 3\n";
        assert_eq!(reported(note).map(|pair| pair.map(|n| (1e6 * n).round())), Some([41200.0, 3400.0]));
        assert_eq!(stopped(note), "--time-limit 3");
        assert_eq!(stopped("rpict: note: the error is 4.12 % ± 0.34 %\n"), "");
    }

    #[test]
    fn seeds_are_a_range_or_one() {
        assert_eq!(seeds("3..9"), Ok((3, 9)));
        assert_eq!(seeds("7"), Ok((7, 7)));
        assert!(seeds("9..3").is_err() && seeds("a").is_err());
    }

    #[test]
    fn a_square_that_noise_makes_negative_is_no_error() {
        assert_eq!(Squared { value: -1.0, standard_error: 0.1 }.error(), 0.0);
    }
}
