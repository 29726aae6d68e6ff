//! Small scenes through real Radiance and through us.

use crate::small_scene::{Materials, SmallScene};
use arbitrary::Unstructured;
use radsight::{MemoryLoader, Ray, RenderOptions, Renderer, Scene};
use radsight_picture::{View, ViewOptions};
use radsight_render::PathLimit;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::LazyLock;

/// Rays of each scene, along a side of the view.
const SIDE: usize = 8;

/// How far the means of a scene may be apart, as a share: the sun is half a degree wide, and
/// Radiance has it in one place.
const TOLERANCE: f64 = 0.02;

/// Rays of a scene that may see something else: those that pass along an edge.
const EDGES: usize = 4;

/// Processor time for each of Radiance's programs: `oconv` does not end on some scenes.
const TIME_LIMIT: &str = "--cpu=2";

/// The folder of real Radiance's programs, where the environment names it.
static PROGRAMS: LazyLock<Option<PathBuf>> =
    LazyLock::new(|| std::env::var_os("RADSIGHT_RADIANCE").map(|folder| Path::new(&folder).join("bin")));

/// Renders a scene of plain materials by real Radiance, too: the means of its rays are the same.
/// Does nothing where the variable `RADSIGHT_RADIANCE` names no Radiance.
///
/// # Panics
/// If the means are apart.
pub fn against_real_radiance(bytes: &[u8]) {
    let Some(programs) = PROGRAMS.as_ref() else { return };
    let Ok(scene) = SmallScene::of(&mut Unstructured::new(bytes), Materials::Plain) else { return };
    let Some(rays) = rays(&scene.view) else { return };
    let Some(ours) = ours(&scene.text, &rays) else { return };
    let Some(theirs) = theirs(programs, &scene.text, &rays) else { return };
    let mut pairs: Vec<[f64; 2]> = ours.into_iter().zip(theirs).map(|(ours, theirs)| [ours, theirs]).collect();
    pairs.sort_by(|a, b| (a[0] - a[1]).abs().total_cmp(&(b[0] - b[1]).abs()));
    pairs.truncate(rays.len() - EDGES);
    let [ours, theirs] = [0, 1].map(|side| pairs.iter().map(|pair| pair[side]).sum::<f64>() / pairs.len() as f64);
    let is_same = (ours - theirs).abs() <= TOLERANCE * theirs.abs() + 1e-6;
    assert!(is_same, "{ours}, but {theirs} in Radiance\n{}{}\n{pairs:?}", scene.text, scene.view);
}

fn rays(view: &str) -> Option<Vec<Ray>> {
    let mut options = ViewOptions::default();
    options.apply_file(format!("VIEW= {view}\n").as_bytes()).ok()?;
    let view = View::new(options).ok()?;
    // Not the middles, which the edges of even coordinates pass through.
    let at = |index: usize| (index as f64 + 0.437) / SIDE as f64;
    let places = (0..SIDE * SIDE).map(|index| [at(index % SIDE), at(index / SIDE)]);
    places.map(|place| view.ray(place).and_then(|ray| Ray::new(ray.origin, ray.direction))).collect()
}

/// Mean radiance of the bands, by ray.
fn ours(text: &str, rays: &[Ray]) -> Option<Vec<f64>> {
    let scene = Scene::builder().loader(MemoryLoader::default()).text("small.rad", text).build().ok()?;
    let options = RenderOptions { path_limit: PathLimit::Cut(6), least_weight: 1e-6, ..RenderOptions::default() };
    let traced = Renderer::with_options(&scene, options).ok()?.trace(rays).ok()?;
    Some(traced.iter().map(|traced| traced.value.iter().sum::<f64>() / 3.0).collect())
}

fn theirs(programs: &Path, text: &str, rays: &[Ray]) -> Option<Vec<f64>> {
    let [scene, octree, list] = ["rad", "oct", "rays"]
        .map(|kind| std::env::temp_dir().join(format!("radsight-differential-{}.{kind}", std::process::id())));
    let told = |ray: &Ray| {
        let [o, d] = [ray.origin, ray.direction];
        format!("{} {} {} {} {} {}\n", o.x, o.y, o.z, d.x, d.y, d.z)
    };
    std::fs::write(&scene, text).ok()?;
    std::fs::write(&list, rays.iter().map(told).collect::<String>()).ok()?;
    std::fs::write(&octree, output(limited(&programs.join("oconv")).arg(&scene).stdin(Stdio::null()))?).ok()?;
    let options = "-h -ov -ab 0 -dj 0 -dt 0 -dc 1 -dr 2 -lr 6 -lw 1e-6 -st 0";
    let mut rtrace = limited(&programs.join("rtrace"));
    let answers = output(rtrace.args(options.split(' ')).arg(&octree).stdin(File::open(&list).ok()?))?;
    let words = String::from_utf8(answers).ok()?;
    let numbers: Vec<f64> = words.split_whitespace().map_while(|word| word.parse().ok()).collect();
    let means: Vec<f64> = numbers.chunks_exact(3).map(|bands| bands.iter().sum::<f64>() / 3.0).collect();
    (means.len() == rays.len()).then_some(means)
}

/// A program that ends after `TIME_LIMIT`, even if this one is killed before.
fn limited(program: &Path) -> Command {
    let mut command = Command::new("prlimit");
    command.arg(TIME_LIMIT).arg(program);
    command
}

/// What a program prints, if it ends well.
fn output(command: &mut Command) -> Option<Vec<u8>> {
    let file = std::env::temp_dir().join(format!("radsight-differential-{}.out", std::process::id()));
    let status = command.stdout(File::create(&file).ok()?).stderr(Stdio::null()).status().ok()?;
    status.success().then(|| std::fs::read(file).ok())?
}
