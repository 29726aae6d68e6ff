//! Runs scripts written for Radiance unchanged, with radsight's links first in `PATH`, and compares
//! with the results of real Radiance.
//!
//! The commands use few rays, so real Radiance's pictures vary much between runs. `RADSIGHT_ORACLE`
//! names a folder with repeated pictures, and with pictures from many rays (`docs/scenes.md`).

use crate::blocks::{Agreement, Noise};
use crate::commands::{oracle, radiance_values};
use crate::program::{Folder, Run, finish_command, radsight};
use crate::{pictures_folder, shared, side_by_side};
use radsight_picture::Image;
use radsight_test_support::Radiance;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// Side of a block, pixels.
const SIDE: usize = 8;

/// Options of real `rpict` besides a script's words, for other random numbers in each run.
const AGAIN: &str = "-u+";

/// Options for the truth: one ray per pixel at a multiple of the resolution; all lights in small
/// pieces, no irradiance cache.
const FINER: usize = 4;
const UNBIASED: &str = "-u+ -ps 1 -pj 1 -dj 1 -ds .05 -dt 0 -lw 1e-6 -ss 1 -aa 0 -ad 12 -as 0";

fn wanted(scene: &str) -> bool {
    std::env::var("RADSIGHT_ONLY").map_or(true, |only| only.split(',').any(|name| name == scene))
}

fn copy_folder(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder");
    for entry in fs::read_dir(from).expect("the scene's folder") {
        let entry = entry.expect("an entry");
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy_folder(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).expect("a copy");
        }
    }
}

/// The names of the scenes.
fn scenes(shared: &Path) -> Vec<String> {
    let names = fs::read_dir(shared.join("scenes")).expect("the scenes");
    let mut scenes: Vec<_> = names
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .filter(|scene| wanted(scene))
        .collect();
    scenes.sort();
    scenes
}

/// A copy of a scene's folder, and the path of its script's pictures.
struct Script {
    place: PathBuf,
    out: PathBuf,
}

impl Script {
    fn new(shared: &Path, scene: &str, folder: &Folder) -> Script {
        let place = folder.path(scene);
        copy_folder(&shared.join("scenes").join(scene), &place);
        Script { place, out: folder.path(&format!("{scene}-out")) }
    }

    fn run(&self, path: &str, library: &Path) -> Run {
        let mut script = Command::new("sh");
        script.arg(self.place.join("run.sh")).current_dir(&self.place);
        script.env("PATH", path).env("RADLIB", library).env("OUT", &self.out).env_remove("RAYPATH");
        finish_command(&mut script)
    }
}

/// The results of real Radiance for a scene, by name.
fn references(shared: &Path, scene: &str) -> Vec<(String, Image<f32>)> {
    let files = fs::read_dir(shared.join("ref/scenes").join(scene)).into_iter().flatten().flatten();
    let read = |path: &Path| radiance_values(&fs::read(path).expect("the reference"));
    let mut references: Vec<_> = files
        .map(|file| (file.file_name().to_string_lossy().trim_end_matches(".hdr").to_owned(), read(&file.path())))
        .collect();
    references.sort_by(|one, other| one.0.cmp(&other.0));
    references
}

/// Another picture of the same scene by real Radiance, if there is one.
fn kept(scene: &str, name: &str) -> Option<Image<f32>> {
    let path = oracle()?.join("scenes").join(scene).join(format!("{name}.hdr"));
    fs::read(path).ok().map(|bytes| radiance_values(&bytes))
}

/// Averages each block of pixels to one pixel.
fn averaged(picture: &Image<f32>, size: (usize, usize)) -> Image<f32> {
    let scale = (picture.width() as f64 / size.0 as f64).round() as usize;
    let mut coarse = Image::filled(size.0, size.1, 3, 0.0f32).expect("a picture");
    for y in 0..size.1 {
        for x in 0..size.0 {
            let mut sum = [0.0; 3];
            for index in 0..scale * scale {
                // If pixels are not exactly square a row may be missing.
                let row = (scale * y + index / scale).min(picture.height() - 1);
                let pixel = picture.pixel(scale * x + index % scale, row);
                sum.iter_mut().zip(pixel).for_each(|(sum, value)| *sum += value);
            }
            let count = (scale * scale) as f32;
            coarse.pixel_mut(x, y).copy_from_slice(&sum.map(|sum| sum / count));
        }
    }
    coarse
}

#[test]
#[ignore = "renders for minutes; run with --ignored --nocapture, in release"]
fn scripts_written_for_radiance() {
    let (Some(shared), Some(radiance)) = (shared(), Radiance::find()) else { return };
    let Some(library) = radiance.library() else { return };
    let folder = Folder::new();
    radsight(&["install-links", &folder.word("bin")]).done();
    let path = format!("{}:/usr/bin:/bin", folder.word("bin"));
    let mut failed = Vec::new();
    for scene in scenes(&shared) {
        let script = Script::new(&shared, &scene, &folder);
        let begin = Instant::now();
        let run = script.run(&path, &library);
        println!("{scene}: exit code {}, {:.1} s", run.code, begin.elapsed().as_secs_f64());
        if run.code != 0 {
            println!("    {}", run.messages.lines().next_back().unwrap_or_default());
            failed.push(scene.clone());
        }
        for (name, expected) in references(&shared, &scene) {
            let Ok(actual) = fs::read(script.out.join(format!("{name}.hdr"))) else { continue };
            let Ok(actual) = radsight_picture::Picture::read(&actual).and_then(|picture| picture.radiance()) else {
                println!("    {name:24} is not a picture");
                failed.push(format!("{scene}/{name}"));
                continue;
            };
            side_by_side::write(&pictures_folder(), &format!("{scene}-{name}"), &actual, &expected);
            if !agrees(&scene, &name, &actual, &expected) {
                failed.push(format!("{scene}/{name}"));
            }
        }
    }
    println!("pictures are in {}", pictures_folder().display());
    assert!(failed.is_empty(), "these do not agree: {failed:?}");
}

/// Whether a picture agrees with the reference, or, where it does not, is closer to the truth than
/// the reference. Prints a line of the table of `docs/scenes.md`.
fn agrees(scene: &str, name: &str, actual: &Image<f32>, expected: &Image<f32>) -> bool {
    let again: Vec<_> = (1..).map_while(|count| kept(scene, &format!("{name}-{count}"))).collect();
    let noise = Noise::of(&again);
    let [ours, itself] = [Some(actual), again.first()]
        .map(|picture| picture.map(|picture| Agreement::new(picture, expected, noise, SIDE)));
    let ours = ours.expect("a picture is there");
    let shares = |agreement: &Agreement| {
        let [mean, within, blocks] = [agreement.mean, agreement.within, agreement.blocks].map(|share| 100.0 * share);
        format!("{mean:+.1} % | {within:.0} % | {blocks:.0} %")
    };
    let itself = itself.as_ref().map_or_else(|| "| | ".to_owned(), shares);
    let truth = kept(scene, &format!("{name}-truth")).map(|truth| {
        let truth = averaged(&truth, (expected.width(), expected.height()));
        [actual, expected].map(|picture| Agreement::new(picture, &truth, Noise::Unknown, SIDE))
    });
    let from_truth = truth.map_or_else(
        || " | ".to_owned(),
        |both| {
            let [ours, reference] = both.map(|one| format!("{:+.1} %, {:.0} %", 100.0 * one.mean, 100.0 * one.within));
            format!("{ours} | {reference}")
        },
    );
    let is_nearer = truth.is_some_and(|[ours, reference]| ours.within > reference.within);
    let verdict = match (ours.is_good(), is_nearer) {
        (true, _) => "good",
        (false, true) => "nearer to the truth than the reference",
        (false, false) => "BAD",
    };
    println!("| `{name}` | {} | {itself} | {from_truth} | {verdict}", shares(&ours));
    ours.is_good() || is_nearer
}

/// Runs the scripts twice with real Radiance and other random numbers, into the folder that
/// `RADSIGHT_ORACLE` names.
#[test]
#[ignore = "renders with real Radiance for minutes"]
fn repeat_scripts() {
    for count in 1..=2 {
        keep_what_real_radiance_makes(&count.to_string(), AGAIN, 1);
    }
}

/// Computes the truth of their pictures with real Radiance.
#[test]
#[ignore = "renders with real Radiance for an hour"]
fn find_the_truth_of_scripts() {
    keep_what_real_radiance_makes("truth", UNBIASED, FINER);
}

/// Runs the scripts with real Radiance, where each `rpict` gets additional options and a multiple
/// of the resolution. Pictures are named after the reference, a dash and the ending.
fn keep_what_real_radiance_makes(ending: &str, options: &str, finer: usize) {
    let (Some(shared), Some(radiance), Some(kept)) = (shared(), Radiance::find(), oracle()) else { return };
    let (Some(library), Some(programs)) = (radiance.library(), radiance.programs()) else { return };
    let folder = Folder::new();
    let wrapper = folder.path("bin");
    fs::create_dir(&wrapper).expect("a folder");
    let real = programs.join("rpict");
    // The words are reversed once: sizes change on the way, and the options precede the octree.
    let words = format!(
        "#!/bin/sh\ncount=$#\nfor word; do\n    case $last in -x|-y) word=$(({finer} * word));; esac\n    count=$((count - 1))\n    \
         [ $count -gt 0 ] || set -- \"$@\" {options}\n    shift\n    set -- \"$@\" \"$word\"\n    last=$word\ndone\nexec {} \"$@\"\n",
        real.display()
    );
    fs::write(wrapper.join("rpict"), words).expect("a script");
    finish_command(Command::new("chmod").arg("+x").arg(wrapper.join("rpict"))).done();
    let path = format!("{}:{}:/usr/bin:/bin", wrapper.display(), programs.display());
    for scene in &scenes(&shared) {
        let place = kept.join("scenes").join(scene);
        let names: Vec<_> = references(&shared, scene).into_iter().map(|(name, _)| name).collect();
        let kept_as = |name: &str| place.join(format!("{name}-{ending}.hdr"));
        if names.iter().all(|name| kept_as(name).is_file()) {
            continue;
        }
        let script = Script::new(&shared, scene, &folder);
        println!("{scene}");
        script.run(&path, &library).done();
        fs::create_dir_all(&place).expect("a folder");
        for name in names {
            fs::copy(script.out.join(format!("{name}.hdr")), kept_as(&name)).expect("a picture is kept");
        }
    }
}
