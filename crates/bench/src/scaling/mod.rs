//! `radsight-bench scaling`: growth of time and memory with triangles, lights, pixels and threads,
//! with other programs.

mod points;
mod scenes;

pub(crate) use points::section;

use crate::args::Scaling;
use crate::capture::print;
use crate::embree::Embree;
use crate::error::BenchError;
use crate::race::beside_this_program;
use crate::radiance::Radiance;
use crate::radsight::Radsight;
use crate::rays::{first_hits, plan_of, random_rays, traced, write_rays};
use crate::run::middle;
use crate::taken::{Taken, taken};
use crate::{generated, machine};
use points::{Measure, Points, Series};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The file that `race` includes in its page.
pub(crate) const FILE: &str = "scaling.csv";

/// Measures all series and writes a table and a CSV file.
pub(crate) fn run(arguments: &Scaling) -> Result<(), BenchError> {
    let temporary = tempfile::tempdir().map_err(|reason| BenchError::Temporary { reason })?;
    let radiance = if arguments.alone { Err("omitted by --alone".to_owned()) } else { Radiance::find() };
    let version = radiance.as_ref().map(|radiance| radiance.version().to_owned()).map_err(Clone::clone);
    print(&machine::describe(&Radsight::find(), &version));
    let folder = temporary.path();
    let mut bench =
        Bench { arguments, radsight: Radsight::find(), radiance: radiance.ok(), folder, points: Points::default() };
    bench.triangles()?;
    bench.lights()?;
    bench.pixels()?;
    bench.threads()?;
    print(&format!("\n{}", bench.points.to_text()));
    let folder = arguments.folder.clone().unwrap_or_else(beside_this_program);
    let path = folder.join(FILE);
    let written = fs::create_dir_all(&folder).and_then(|()| fs::write(&path, bench.points.to_csv()));
    written.map_err(|reason| BenchError::Write { path: path.clone(), reason })?;
    print(&format!("\nwrote {}\n", path.display()));
    Ok(())
}

struct Bench<'a> {
    arguments: &'a Scaling,
    radsight: Radsight,
    radiance: Option<Radiance>,
    folder: &'a Path,
    points: Points,
}

/// Number of rays for the measurement of time.
const RAYS: usize = 200_000;

/// Rays to a floor under lights.
const FLOOR_RAYS: usize = 4096;

impl Bench<'_> {
    /// Loading, first hits and memory for increasing numbers of triangles.
    fn triangles(&mut self) -> Result<(), BenchError> {
        let rays = random_rays(RAYS);
        let stream = write_rays(self.folder, &rays)?;
        for squares in [22, 71, 224, 707, 2236] {
            let count = f64::from(2 * squares * squares);
            if count > self.arguments.triangles {
                break;
            }
            let file = self.folder.join(generated::triangles_in(self.folder, squares)?);
            let load = Series::new("triangles", "radsight", Measure::Seconds("load"));
            let own = self.measured(self.radsight.command(&["rtrace", "-h"]).arg(&file), None)?;
            self.points.push(load, count, own.processor);
            self.points.push(load.of("radsight", Measure::Bytes("peak a triangle")), count, own.peak * MIB / count);
            let plan = plan_of(&file)?;
            let hits = first_hits(&plan, &rays);
            let first = Series::new("triangles", "radsight", Measure::Microseconds("first hit"));
            self.points.push(first, count, 1e6 * hits.seconds / RAYS as f64);
            let bytes = plan.hierarchy_bytes() as f64;
            self.points.push(first.of("radsight", Measure::Bytes("hierarchy a triangle")), count, bytes / count);
            drop(plan);
            if count <= MAX_EMBREE_TRIANGLES && !self.arguments.alone {
                let answer = Embree::start(&file, &stream, self.folder)
                    .and_then(|mut embree| Ok((embree.trace_all()?, embree.bytes)));
                match answer {
                    Ok((hits, bytes)) => {
                        self.points.push(first.of("Embree", first.measure), count, 1e6 * hits.seconds / RAYS as f64);
                        let series = first.of("Embree", Measure::Bytes("hierarchy a triangle"));
                        self.points.push(series, count, bytes / count);
                    }
                    Err(reason) => print(&format!("Embree    missing: {reason}\n")),
                }
            }
            self.triangles_beside(&file, &rays, count)?;
        }
        Ok(())
    }

    /// Real Radiance's octree, and rays into it.
    fn triangles_beside(&mut self, file: &Path, rays: &[radsight_render::Ray], count: f64) -> Result<(), BenchError> {
        let load = Series::new("triangles", "oconv", Measure::Seconds("load"));
        let Some(radiance) =
            self.radiance.as_ref().filter(|_| self.points.may_go_on(load, count, self.arguments.budget))
        else {
            return Ok(());
        };
        let octree = self.folder.join("scaling.oct");
        let made = taken(radiance.command("oconv").args(["-w"]).arg(file), self.folder, None, Some(&octree))?;
        let hits = traced(radiance, file, rays, self.folder)?;
        self.points.push(load, count, made.processor);
        self.points.push(load.of("oconv", Measure::Bytes("peak a triangle")), count, made.peak * MIB / count);
        let size = fs::metadata(&octree).map_or(f64::NAN, |found| found.len() as f64);
        self.points.push(load.of("oconv", Measure::Bytes("octree a triangle")), count, size / count);
        let first = load.of("real rtrace", Measure::Microseconds("first hit"));
        self.points.push(first, count, 1e6 * hits.seconds / RAYS as f64);
        Ok(())
    }

    /// A floor under increasing numbers of lights, per ray.
    fn lights(&mut self) -> Result<(), BenchError> {
        let [one, all] = scenes::rays_to_the_floor(self.folder, FLOOR_RAYS)?;
        for lights in [1, 10, 100, 1000, 10_000, 100_000] {
            let size = f64::from(lights);
            let file = scenes::floor_under_lights(self.folder, lights)?;
            let own = Series::new("lights", "radsight", Measure::Microseconds("ray"));
            let trace = |stream: &Path| {
                let words = ["rtrace", "-h", "-fff", "-ab", "0", "--samples", "1", "-n", "1"];
                self.measured(self.radsight.command(&words).arg(&file), Some(stream))
            };
            let seconds = trace(&all)?.processor - trace(&one)?.processor;
            self.points.push(own, size, 1e6 * seconds / FLOOR_RAYS as f64);
            let real = own.of("real rtrace", own.measure);
            let Some(radiance) = &self.radiance else { continue };
            // The time per ray is stored, and the budget applies to all.
            if !self.points.may_go_on(real, size, self.arguments.budget * 1e6 / FLOOR_RAYS as f64) {
                continue;
            }
            let octree = self.folder.join("lights.oct");
            taken(radiance.command("oconv").args(["-w"]).arg(&file), self.folder, None, Some(&octree))?;
            let trace = |stream: &Path| {
                self.measured(radiance.command("rtrace").args(["-h", "-fff", "-ab", "0"]).arg(&octree), Some(stream))
            };
            let seconds = trace(&all)?.processor - trace(&one)?.processor;
            self.points.push(real, size, 1e6 * seconds / FLOOR_RAYS as f64);
        }
        Ok(())
    }

    /// Pictures of a room with increasing numbers of pixels, one ray each.
    fn pixels(&mut self) -> Result<(), BenchError> {
        let file = scenes::room(self.folder)?;
        let octree = self.folder.join("room.oct");
        if let Some(radiance) = &self.radiance {
            taken(radiance.command("oconv").args(["-w"]).arg(&file), self.folder, None, Some(&octree))?;
        }
        for side in [64, 128, 256, 512, 1024] {
            let size = f64::from(side * side);
            let [side_text, pixels] = [side.to_string(), side.to_string()];
            let frame = ["-x", &side_text, "-y", &pixels, "-pa", "0", "-ab", "0"];
            let picture = Series::new("pixels", "radsight", Measure::Seconds("picture"));
            let mut own = self.radsight.command(&["rpict"]);
            own.args(scenes::ROOM_VIEW).args(frame).args(["--samples", "1", "-n", "1"]).arg(&file);
            self.points.push(picture, size, self.measured(&mut own, None)?.processor);
            if let Some(radiance) = &self.radiance {
                let mut real = radiance.command("rpict");
                real.args(scenes::ROOM_VIEW).args(frame).args(["-ps", "1"]).arg(&octree);
                self.points.push(
                    picture.of("real rpict", picture.measure),
                    size,
                    self.measured(&mut real, None)?.processor,
                );
            }
        }
        Ok(())
    }

    /// The same picture with increasing numbers of threads, by wall time.
    fn threads(&mut self) -> Result<(), BenchError> {
        let file = scenes::room(self.folder)?;
        let most = std::thread::available_parallelism().map_or(1, usize::from);
        let counts = (0..).map(|power| 1 << power).take_while(|threads| *threads < most).chain([most]);
        for threads in counts {
            let mut own = self.radsight.command(&["rpict"]);
            own.args(scenes::ROOM_VIEW).args([
                "-x",
                "512",
                "-y",
                "512",
                "-pa",
                "0",
                "-ab",
                "0",
                "--samples",
                "8",
                "-n",
            ]);
            let wall = self.measured(own.arg(threads.to_string()).arg(&file), None)?.wall;
            self.points.push(
                Series::new("threads", "radsight", Measure::Seconds("picture, wall")),
                threads as f64,
                wall,
            );
        }
        Ok(())
    }

    /// The medians of a program's costs.
    fn measured(&self, program: &mut Command, input: Option<&Path>) -> Result<Taken, BenchError> {
        let output: PathBuf = self.folder.join("answer");
        let runs: Vec<Taken> = (0..self.arguments.repeat)
            .map(|_| taken(program, self.folder, input, Some(&output)))
            .collect::<Result<_, _>>()?;
        let of = |value: fn(&Taken) -> f64| middle(runs.iter().map(value).collect()).unwrap_or(f64::NAN);
        Ok(Taken { processor: of(|run| run.processor), wall: of(|run| run.wall), peak: of(|run| run.peak) })
    }
}

const MIB: f64 = (1 << 20) as f64;

/// The script that reads triangles for Embree needs a kilobyte per triangle.
const MAX_EMBREE_TRIANGLES: f64 = 2e6;
