//! Radiance's own render tests, against pictures that real Radiance made of them.
//!
//! Scenes and references are not part of this repository: `RADSIGHT_SHARED` names the folder that has them. The octrees are
//! built by real Radiance's `rad`, so that only the rendering is compared.

use crate::blocks::Agreement;
use crate::program::{Folder, finish_command};
use crate::real_radiance::Radiance;
use crate::{pictures_folder, shared, side_by_side};
use radsight_picture::{Image, Picture};
use std::fs;
use std::path::Path;
use std::time::Instant;

/// One line of `commands.tsv`.
struct Reference {
    scene: String,
    picture: String,
    seconds: f64,
    words: Vec<String>,
}

fn references(folder: &Path) -> Vec<Reference> {
    let text = fs::read_to_string(folder.join("ref/renders/commands.tsv")).expect("the list of references");
    let read = |line: &str| {
        let columns: Vec<&str> = line.split('\t').collect();
        Reference {
            scene: columns[0].to_owned(),
            picture: columns[2].to_owned(),
            seconds: columns[3].parse().expect("seconds"),
            words: columns[4].split_whitespace().map(str::to_owned).collect(),
        }
    };
    text.lines().skip(1).map(read).collect()
}

/// `RADSIGHT_ONLY=mist,trans` renders only these scenes; `RADSIGHT_RPICT="--samples 16"` adds words to each command.
fn wanted(scene: &str) -> bool {
    std::env::var("RADSIGHT_ONLY").map_or(true, |only| only.split(',').any(|name| name == scene))
}

pub(crate) fn radiance_values(bytes: &[u8]) -> Image<f32> {
    Picture::read(bytes).expect("a picture").radiance().expect("its radiance")
}

#[test]
#[ignore = "renders for minutes; run with --ignored --nocapture, in release"]
fn radiance_render_tests() {
    let (Some(shared), Some(radiance)) = (shared(), Radiance::find()) else { return };
    let folder = Folder::new();
    for entry in fs::read_dir(shared.join("renders")).expect("the scenes") {
        let entry = entry.expect("an entry");
        fs::copy(entry.path(), folder.path(&entry.file_name().to_string_lossy())).expect("a copy");
    }
    let extra = std::env::var("RADSIGHT_RPICT").unwrap_or_default();
    let mut built = String::new();
    let mut failed = Vec::new();
    for reference in references(&shared).iter().filter(|reference| wanted(&reference.scene)) {
        let name = reference.picture.trim_end_matches(".hdr");
        if built != reference.scene {
            let rif = format!("{}.rif", reference.scene);
            let run = finish_command(radiance.command("rad", &["-v", "0", &rif]).current_dir(folder.path("")));
            assert_eq!(run.code, 0, "rad {rif}: {}", run.messages);
            built.clone_from(&reference.scene);
        }
        let (octree, options) = reference.words.split_last().expect("a command has words");
        let mut words: Vec<&str> = options.iter().map(String::as_str).chain(extra.split_whitespace()).collect();
        words.push(octree);
        let begin = Instant::now();
        let mut command = crate::program::command(&words);
        let run = finish_command(command.env("RAYPATH", radiance.raypath()).current_dir(folder.path("")));
        let seconds = begin.elapsed().as_secs_f64();
        if run.code != 0 {
            println!("{name:16} failed: {}", run.messages.lines().next().unwrap_or_default());
            failed.push(name.to_owned());
            continue;
        }
        let actual = radiance_values(&run.output);
        let expected = fs::read(shared.join("ref/renders").join(&reference.picture)).expect("the reference");
        let expected = radiance_values(&expected);
        let agreement = Agreement::new(&actual, &expected, None, 8);
        side_by_side::write(&pictures_folder(), &format!("renders-{name}"), &actual, &expected);
        let good = if agreement.is_good() { "good" } else { "BAD" };
        println!(
            "{name:16} {agreement}, {seconds:6.1} s (real: {:6.1} s of processor time)  {good}",
            reference.seconds
        );
        if !agreement.is_good() {
            failed.push(name.to_owned());
        }
    }
    println!("pictures are in {}", pictures_folder().display());
    assert!(failed.is_empty(), "these do not agree: {failed:?}");
}
