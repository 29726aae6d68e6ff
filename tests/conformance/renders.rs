//! Radiance's own render tests, against pictures that real Radiance made of them.

use crate::blocks::{Agreement, Noise};
use crate::commands::{Reference, Scenes, oracle, radiance_values, repeats};
use crate::real_radiance::Radiance;
use crate::{pictures_folder, shared, side_by_side};
use std::fs;
use std::time::Instant;

/// `RADSIGHT_RPICT="--samples 16"` adds words to each command. Our pictures stay for [`crate::truth`].
#[test]
#[ignore = "renders for minutes; run with --ignored --nocapture, in release"]
fn radiance_render_tests() {
    let (Some(shared), Some(radiance)) = (shared(), Radiance::find()) else { return };
    let mut scenes = Scenes::new(&shared, &radiance);
    let extra = std::env::var("RADSIGHT_RPICT").unwrap_or_default();
    let mut failed = Vec::new();
    for reference in Reference::all(&shared) {
        scenes.build(&reference);
        let name = &reference.name;
        let begin = Instant::now();
        let run = scenes.ours(&reference.words(&extra));
        let seconds = begin.elapsed().as_secs_f64();
        if run.code != 0 {
            println!("{name:16} failed: {}", run.messages.lines().next().unwrap_or_default());
            failed.push(name.clone());
            continue;
        }
        let actual = radiance_values(&run.output);
        side_by_side::write(&pictures_folder(), &format!("renders-{name}"), &actual, &reference.picture);
        fs::write(pictures_folder().join(format!("renders-{name}.hdr")), &run.output).expect("the picture is written");
        let repeats = oracle().map_or_else(Vec::new, |folder| repeats(&folder, &reference));
        let noise = if repeats.is_empty() { Noise::Unknown } else { Noise::Repeats(&repeats) };
        let agreement = Agreement::new(&actual, &reference.picture, noise, 8);
        let good = if agreement.is_good() { "good" } else { "BAD" };
        println!(
            "{name:16} {agreement}, {seconds:6.1} s (real: {:6.1} s of processor time)  {good}",
            reference.seconds
        );
        if !agreement.is_good() {
            failed.push(name.clone());
        }
    }
    println!("pictures are in {}", pictures_folder().display());
    assert!(failed.is_empty(), "these do not agree: {failed:?}");
}

/// Has real Radiance make each picture again, into the folder that `RADSIGHT_ORACLE` names, until there are `RADSIGHT_TIMES` (1): how they differ is
/// the references' own noise.
#[test]
#[ignore = "renders with real Radiance, for an hour"]
fn repeat_references() {
    let (Some(shared), Some(radiance), Some(folder)) = (shared(), Radiance::find(), oracle()) else { return };
    let times: usize = std::env::var("RADSIGHT_TIMES").map_or(1, |times| times.parse().expect("a number of times"));
    let mut scenes = Scenes::new(&shared, &radiance);
    for reference in Reference::all(&shared) {
        scenes.build(&reference);
        for count in repeats(&folder, &reference).len() + 1..=times {
            let name = format!("{}-{count}.hdr", reference.name);
            println!("{name}");
            let picture = scenes.real("rpict", &reference.words("")[1..], None).done();
            fs::write(folder.join(format!("{name}.part")), picture).expect("the picture is written");
            fs::rename(folder.join(format!("{name}.part")), folder.join(name)).expect("the picture is renamed");
        }
    }
}
