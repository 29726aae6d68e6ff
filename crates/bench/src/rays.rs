//! `radsight-bench rays`: incoherent rays through a million triangles, with Embree and real
//! Radiance.

use crate::args::Rays;
use crate::capture::print;
use crate::cost::{measure, processor_time};
use crate::embree::Embree;
use crate::error::BenchError;
use crate::figure::{Disk, read};
use crate::radiance::Radiance;
use crate::radsight::Radsight;
use crate::table::Table;
use crate::{generated, machine};
use glam::DVec3;
use radsight_diag::{Diagnostic, SourceMap};
use radsight_ir::ValidScene;
use radsight_parse::{Input, Read, ReadOptions, read_scene};
use radsight_render::{NoModels, Ray, RenderOptions, RenderPlan};
use std::path::{Path, PathBuf};

/// The result of a program.
pub(crate) struct TraceResult {
    /// Seconds of processor time for all rays.
    pub(crate) seconds: f64,
    /// Rays that hit a triangle.
    pub(crate) hits: usize,
    /// Sum of the distances to the hits.
    pub(crate) sum: f64,
}

/// Measures all programs on one thread, alternating, and prints a table.
pub(crate) fn run(arguments: &Rays) -> Result<(), BenchError> {
    let folder = tempfile::tempdir().map_err(|reason| BenchError::Temporary { reason })?;
    let radiance = Radiance::find();
    let version = radiance.as_ref().map(|radiance| radiance.version().to_owned()).map_err(Clone::clone);
    print(&machine::describe(&Radsight::find(), &version));
    let file = folder.path().join(generated::triangles_in(folder.path(), arguments.squares)?);
    let rays = random_rays(arguments.rays as usize);
    let path = write_rays(folder.path(), &rays)?;

    let source = SceneSource::read(&file)?;
    let (quick, thorough) = (CompiledScene::new(&source, 0.0)?, CompiledScene::new(&source, f64::INFINITY)?);
    let mut embree = Embree::start(&file, &path, folder.path());
    let mut series = [const { Vec::new() }; 5];
    for _ in 0..arguments.repeat {
        let [first, any, first_thorough, any_thorough, beside] = &mut series;
        if let Ok(embree) = &mut embree {
            beside.push(embree.trace_all().map_err(|reason| BenchError::Embree { reason })?);
        }
        first_thorough.push(first_hits(&thorough.plan, &rays));
        any_thorough.push(blocked(&thorough.plan, &rays));
        first.push(first_hits(&quick.plan, &rays));
        any.push(blocked(&quick.plan, &rays));
    }
    let mut table = Table::new(&["program", "rays/s", "hits", "mean distance", "of radsight's rate"], 1);
    let [first, any, first_thorough, any_thorough, beside] = &series;
    push(&mut table, "radsight, first hit, quick builder", first, rays.len(), first);
    push(&mut table, "radsight, any hit, quick builder", any, rays.len(), first);
    push(&mut table, "radsight, first hit, thorough builder", first_thorough, rays.len(), first);
    push(&mut table, "radsight, any hit, thorough builder", any_thorough, rays.len(), first);
    match &embree {
        Ok(_) => push(&mut table, "Embree, first hit", beside, rays.len(), first),
        Err(reason) => print(&format!("Embree    missing: {reason}\n")),
    }
    drop(embree);
    if let Ok(radiance) = &radiance {
        let answer = traced(radiance, &file, &rays, folder.path())?;
        push(&mut table, "real rtrace, first hit", &[answer], rays.len(), first);
    }
    print(&format!("\n{}\n{}{}", table.to_text(), quick.words("quick builder"), thorough.words("thorough builder")));
    Ok(())
}

/// A plan, and the cost of compiling it.
struct CompiledScene {
    plan: RenderPlan,
    /// Processor time, s.
    seconds: f64,
}

impl CompiledScene {
    fn new(source: &SceneSource<'_>, camera_rays: f64) -> Result<CompiledScene, BenchError> {
        let start = processor_time();
        Ok(CompiledScene { plan: source.plan(camera_rays)?, seconds: processor_time() - start })
    }

    fn words(&self, builder: &str) -> String {
        let megabytes = self.plan.hierarchy_bytes() as f64 / 1e6;
        format!("planned with {builder} in {:.2} s of processor time, {megabytes:.0} MB of hierarchy\n", self.seconds)
    }
}

/// A row with the fastest repetition. The last column is the median over the repetitions of the
/// ratio to `own`.
fn push(table: &mut Table, program: &str, repetitions: &[TraceResult], rays: usize, own: &[TraceResult]) {
    let Some(best) = repetitions.iter().min_by(|a, b| a.seconds.total_cmp(&b.seconds)) else { return };
    let mut ratios: Vec<f64> =
        repetitions.iter().zip(own).map(|(trace_all, own)| own.seconds / trace_all.seconds).collect();
    ratios.sort_by(f64::total_cmp);
    table.push(vec![
        program.to_owned(),
        format!("{:.0}", rays as f64 / best.seconds),
        best.hits.to_string(),
        if best.sum.is_nan() { "-".to_owned() } else { format!("{:.6}", best.sum / best.hits as f64) },
        format!("{:.2}", ratios[ratios.len() / 2]),
    ]);
}

/// Rays that start anywhere in the air above and in the terrain, in all directions; the same in
/// every run.
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
        let (z, trace_all) = (2.0 * number() - 1.0, std::f64::consts::TAU * number());
        let level = (1.0 - z * z).max(0.0).sqrt();
        // Rounded to single precision, so that all programs get the same rays.
        let single = |vector: DVec3| vector.as_vec3().as_dvec3();
        Ray {
            origin: single(origin),
            direction: single(DVec3::new(level * trace_all.cos(), level * trace_all.sin(), z)).normalize(),
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

/// Compiles a scene for few rays.
pub(crate) fn plan_of(file: &Path) -> Result<RenderPlan, BenchError> {
    SceneSource::read(file)?.plan(0.0)
}

/// A scene that is compiled in several ways.
struct SceneSource<'f> {
    file: &'f Path,
    scene: ValidScene,
    sources: SourceMap,
}

impl SceneSource<'_> {
    fn read(file: &Path) -> Result<SceneSource<'_>, BenchError> {
        let name = file.to_string_lossy().into_owned();
        let Read { scene, sources, .. } = read_scene(&[Input::File(name)], &Disk, &ReadOptions::default());
        let valid = scene.validate().map_err(|errors| wrong(file, &errors, &sources))?;
        Ok(SceneSource { file, scene: valid.scene, sources })
    }

    /// For this number of camera rays.
    fn plan(&self, camera_rays: f64) -> Result<RenderPlan, BenchError> {
        let options = RenderOptions { camera_rays, ..RenderOptions::default() };
        let plan = RenderPlan::new(self.scene.clone(), options, &NoModels);
        plan.map_err(|errors| wrong(self.file, &errors, &self.sources))
    }
}

fn wrong(file: &Path, errors: &[Diagnostic], sources: &SourceMap) -> BenchError {
    let reason = errors.iter().map(|error| error.render(sources)).collect();
    BenchError::Read { path: file.to_owned(), reason }
}

pub(crate) fn first_hits(plan: &RenderPlan, rays: &[Ray]) -> TraceResult {
    let start = processor_time();
    let distances = rays.iter().filter_map(|ray| plan.distance(ray));
    let (hits, sum) = distances.fold((0, 0.0), |(hits, sum), distance| (hits + 1, sum + distance));
    TraceResult { seconds: processor_time() - start, hits, sum }
}

fn blocked(plan: &RenderPlan, rays: &[Ray]) -> TraceResult {
    let start = processor_time();
    let hits = rays.iter().filter(|ray| plan.is_blocked(ray, f64::MAX)).count();
    TraceResult { seconds: processor_time() - start, hits, sum: f64::NAN }
}

/// Distances by real `rtrace`. The time of a run with a single ray, which is that of loading, is
/// subtracted.
pub(crate) fn traced(
    radiance: &Radiance,
    scene: &Path,
    rays: &[Ray],
    folder: &Path,
) -> Result<TraceResult, BenchError> {
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
    // Rays that hit nothing have a very large distance.
    let distances = bytes.as_chunks::<4>().0.iter().map(|bytes| f64::from(f32::from_ne_bytes(*bytes)));
    let (hits, sum) = distances.filter(|d| *d < 1e9).fold((0, 0.0), |(hits, sum), d| (hits + 1, sum + d));
    Ok(TraceResult { seconds: seconds[1] - seconds[0], hits, sum })
}
