//! Scripts written for Radiance, run unchanged with radsight's links first in `PATH`, against what real Radiance made of them.

use crate::blocks::{Agreement, Noise};
use crate::commands::radiance_values;
use crate::program::{Folder, finish_command, radsight};
use crate::real_radiance::Radiance;
use crate::{pictures_folder, shared, side_by_side};
use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

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

#[test]
#[ignore = "renders for minutes; run with --ignored --nocapture, in release"]
fn scripts_written_for_radiance() {
    let (Some(shared), Some(radiance)) = (shared(), Radiance::find()) else { return };
    let Some(library) = radiance.library() else { return };
    let folder = Folder::new();
    radsight(&["install-links", &folder.word("bin")]).done();
    let path = format!("{}:/usr/bin:/bin", folder.word("bin"));
    let mut failed = Vec::new();
    let mut scenes: Vec<_> = fs::read_dir(shared.join("scenes"))
        .expect("the scenes")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .filter(|scene| wanted(scene))
        .collect();
    scenes.sort();
    for scene in scenes {
        let place = folder.path(&scene);
        copy_folder(&shared.join("scenes").join(&scene), &place);
        let out = folder.path(&format!("{scene}-out"));
        let begin = Instant::now();
        let mut script = Command::new("sh");
        script.arg(place.join("run.sh")).current_dir(&place);
        script.env("PATH", &path).env("RADLIB", &library).env("OUT", &out).env_remove("RAYPATH");
        let run = finish_command(&mut script);
        let seconds = begin.elapsed().as_secs_f64();
        println!("{scene}: exit code {}, {seconds:.1} s", run.code);
        if run.code != 0 {
            println!("    {}", run.messages.lines().next_back().unwrap_or_default());
            failed.push(scene.clone());
        }
        let mut references: Vec<_> =
            fs::read_dir(shared.join("ref/scenes").join(&scene)).into_iter().flatten().flatten().collect();
        references.sort_by_key(std::fs::DirEntry::file_name);
        for reference in references {
            let name = reference.file_name().to_string_lossy().trim_end_matches(".hdr").to_owned();
            let expected = radiance_values(&fs::read(reference.path()).expect("the reference"));
            let Ok(actual) = fs::read(out.join(reference.file_name())) else { continue };
            let Ok(actual) = radsight_picture::Picture::read(&actual).and_then(|picture| picture.radiance()) else {
                println!("    {name:24} is not a picture");
                failed.push(format!("{scene}/{name}"));
                continue;
            };
            let agreement = Agreement::new(&actual, &expected, Noise::Unknown, 8);
            side_by_side::write(&pictures_folder(), &format!("{scene}-{name}"), &actual, &expected);
            let good = if agreement.is_good() { "good" } else { "BAD" };
            println!("    {name:24} {agreement}  {good}");
            if !agreement.is_good() {
                failed.push(format!("{scene}/{name}"));
            }
        }
    }
    println!("pictures are in {}", pictures_folder().display());
    assert!(failed.is_empty(), "these do not agree: {failed:?}");
}
