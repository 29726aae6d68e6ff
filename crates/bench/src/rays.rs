//! `radsight-bench rays`: rays without any order against a million triangles, beside Embree and real Radiance.

use crate::args::Rays;
use crate::capture::print;
use crate::cost::{measure, processor_time};
use crate::error::BenchError;
use crate::figure::{Disk, read};
use crate::radiance::Radiance;
use crate::radsight::Radsight;
use crate::table::Table;
use crate::{generated, machine};
use glam::DVec3;
use radsight_diag::Diagnostic;
use radsight_parse::{Input, Read, ReadOptions, read_scene};
use radsight_render::{NoModels, Ray, RenderOptions, RenderPlan};
use std::path::{Path, PathBuf};
use std::process::Command;

const SCRIPT: &str = include_str!("with_embree.py");

/// What a program answered.
pub(crate) struct Answer {
    /// Seconds of processor time for all rays.
    pub(crate) seconds: f64,
    /// Rays that met a triangle.
    hits: usize,
    /// Sum of the distances to what they met.
    sum: f64,
}

/// Times all programs on one thread and prints a table.
pub(crate) fn run(arguments: &Rays) -> Result<(), BenchError> {
    let folder = tempfile::tempdir().map_err(|reason| BenchError::Temporary { reason })?;
    let radiance = Radiance::find();
    let version = radiance.as_ref().map(|radiance| radiance.version().to_owned()).map_err(Clone::clone);
    print(&machine::describe(&Radsight::find(), &version));
    let file = folder.path().join(generated::triangles_in(folder.path(), arguments.squares)?);
    let rays = random_rays(arguments.rays as usize);
    let path = write_rays(folder.path(), &rays)?;

    let plan = plan_of(&file)?;
    let own = (0..arguments.repeat).map(|_| first_hits(&plan, &rays)).min_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let mut table = Table::new(&["program", "rays/s", "hits", "mean distance", "of radsight's rate"], 1);
    let rate = own.as_ref().map_or(f64::NAN, |own| rays.len() as f64 / own.seconds);
    if let Some(own) = &own {
        push(&mut table, "radsight, first hit", own, rays.len(), rate);
    }
    let blocked = (0..arguments.repeat).map(|_| blocked(&plan, &rays)).min_by(|a, b| a.seconds.total_cmp(&b.seconds));
    if let Some(blocked) = &blocked {
        push(&mut table, "radsight, any hit", blocked, rays.len(), rate);
    }
    match embree(&file, &path, folder.path(), arguments.repeat) {
        Ok((answer, _)) => push(&mut table, "Embree, first hit", &answer, rays.len(), rate),
        Err(reason) => print(&format!("Embree    missing: {reason}\n")),
    }
    if let Ok(radiance) = &radiance {
        let answer = traced(radiance, &file, &rays, folder.path())?;
        push(&mut table, "real rtrace, first hit", &answer, rays.len(), rate);
    }
    print(&format!("\n{}", table.to_text()));
    Ok(())
}

fn push(table: &mut Table, program: &str, answer: &Answer, rays: usize, own_rate: f64) {
    let rate = rays as f64 / answer.seconds;
    table.push(vec![
        program.to_owned(),
        format!("{rate:.0}"),
        answer.hits.to_string(),
        if answer.sum.is_nan() { "-".to_owned() } else { format!("{:.6}", answer.sum / answer.hits as f64) },
        format!("{:.2}", rate / own_rate),
    ]);
}

/// Rays from anywhere in the air above and in the land, in all directions; the same in every run.
pub(crate) fn random_rays(count: usize) -> Vec<Ray> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    // Marsaglia, "Xorshift RNGs", Journal of Statistical Software 8(14), 2003.
    let mut number = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let ray = |_| {
        let origin = DVec3::new(number(), number(), 0.2 * number() - 0.08);
        let (z, turn) = (2.0 * number() - 1.0, std::f64::consts::TAU * number());
        let level = (1.0 - z * z).max(0.0).sqrt();
        // What single precision holds, so that all programs get the same rays.
        let single = |vector: DVec3| vector.as_vec3().as_dvec3();
        Ray {
            origin: single(origin),
            direction: single(DVec3::new(level * turn.cos(), level * turn.sin(), z)).normalize(),
        }
    };
    (0..count).map(ray).collect()
}

/// Writes rays as a stream of doubles.
pub(crate) fn write_rays(folder: &Path, rays: &[Ray]) -> Result<PathBuf, BenchError> {
    let path = folder.join("rays.f64");
    let bytes: Vec<u8> = rays.iter().flat_map(|ray| [ray.origin, ray.direction]).flat_map(bytes_of).collect();
    std::fs::write(&path, bytes).map_err(|reason| BenchError::Write { path: path.clone(), reason })?;
    Ok(path)
}

fn bytes_of(vector: DVec3) -> impl Iterator<Item = u8> {
    vector.to_array().into_iter().flat_map(f64::to_ne_bytes)
}

pub(crate) fn plan_of(file: &Path) -> Result<RenderPlan, BenchError> {
    let name = file.to_string_lossy().into_owned();
    let Read { scene, sources, .. } = read_scene(&[Input::File(name)], &Disk, &ReadOptions::default());
    let wrong = |errors: Vec<Diagnostic>| {
        let reason = errors.iter().map(|error| error.render(&sources)).collect();
        BenchError::Read { path: file.to_owned(), reason }
    };
    let valid = scene.validate().map_err(wrong)?;
    RenderPlan::new(valid.scene, RenderOptions::default(), &NoModels).map_err(wrong)
}

pub(crate) fn first_hits(plan: &RenderPlan, rays: &[Ray]) -> Answer {
    let start = processor_time();
    let distances = rays.iter().filter_map(|ray| plan.distance(ray));
    let (hits, sum) = distances.fold((0, 0.0), |(hits, sum), distance| (hits + 1, sum + distance));
    Answer { seconds: processor_time() - start, hits, sum }
}

fn blocked(plan: &RenderPlan, rays: &[Ray]) -> Answer {
    let start = processor_time();
    let hits = rays.iter().filter(|ray| plan.is_blocked(ray, f64::MAX)).count();
    Answer { seconds: processor_time() - start, hits, sum: f64::NAN }
}

/// Embree through the Python package `embreex`, whose loop over single rays is compiled; tells also how many bytes its hierarchy has with
/// its triangles.
pub(crate) fn embree(scene: &Path, rays: &Path, folder: &Path, repeat: u32) -> Result<(Answer, f64), String> {
    let Some(python) = std::env::var_os("RADSIGHT_EMBREE") else {
        return Err("RADSIGHT_EMBREE names no Python with the packages embreex and numpy".to_owned());
    };
    let script = folder.join("with_embree.py");
    std::fs::write(&script, SCRIPT).map_err(|error| error.to_string())?;
    let told = Command::new(PathBuf::from(python)).arg(script).args([scene, rays]).arg(repeat.to_string()).output();
    let told = told.map_err(|error| error.to_string())?;
    let text = String::from_utf8_lossy(&told.stdout);
    let numbers: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    match numbers[..] {
        [seconds, hits, sum, bytes] => Ok((Answer { seconds, hits: hits as usize, sum }, bytes)),
        _ => Err(String::from_utf8_lossy(&told.stderr).lines().last().unwrap_or_default().to_owned()),
    }
}

/// Distances by real `rtrace`; the time for a single ray is taken off, which is that of loading.
pub(crate) fn traced(radiance: &Radiance, scene: &Path, rays: &[Ray], folder: &Path) -> Result<Answer, BenchError> {
    const HINT: &str = "; RADSIGHT_RADIANCE names a folder with bin and lib";
    let [octree, input, output] = ["land.oct", "rays.f32", "distances.f32"].map(|name| folder.join(name));
    measure(radiance.command("oconv").arg(scene), None, Some(&octree), HINT)?;
    let mut seconds = [0.0; 2];
    for (seconds, count) in seconds.iter_mut().zip([1, rays.len()]) {
        let floats = rays[..count].iter().flat_map(|ray| [ray.origin, ray.direction]);
        let bytes: Vec<u8> = floats.flat_map(|v| v.as_vec3().to_array()).flat_map(f32::to_ne_bytes).collect();
        std::fs::write(&input, bytes).map_err(|reason| BenchError::Write { path: input.clone(), reason })?;
        let mut trace = radiance.command("rtrace");
        trace.args(["-h", "-fff", "-oL"]).arg(&octree);
        *seconds = measure(&mut trace, Some(&input), Some(&output), HINT)?.processor;
    }
    let bytes = read(&output)?;
    // What meets nothing is told to be very far away.
    let distances = bytes.as_chunks::<4>().0.iter().map(|bytes| f64::from(f32::from_ne_bytes(*bytes)));
    let (hits, sum) = distances.filter(|d| *d < 1e9).fold((0, 0.0), |(hits, sum), d| (hits + 1, sum + d));
    Ok(Answer { seconds: seconds[1] - seconds[0], hits, sum })
}
