//! The gallery: its scenes are valid, also for real Radiance, and its pictures exist and are small.

use crate::program::{Folder, command, root, run_with};
use radsight_picture::read_png;
use radsight_test_support::Radiance;

const SCENES: [&str; 5] = ["materials", "daylight", "prisms", "mist", "spectra"];

/// Largest picture of the README, bytes.
const LARGEST: usize = 150_000;

#[test]
fn no_scene_of_the_gallery_has_a_mistake() {
    for scene in SCENES {
        let words = ["check", "--strict", &format!("{scene}.rad")];
        let run = run_with(command(&words).current_dir(root().join("radiance-scenes/gallery")), b"");
        assert!(run.text().ends_with("no error\n"), "{scene}");
    }
}

#[test]
fn real_radiance_reads_the_scenes_as_well() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    let gallery = root().join("radiance-scenes/gallery");
    for scene in SCENES {
        let mut oconv = radiance.command("oconv", &[&format!("{scene}.rad")]);
        let octree = run_with(oconv.current_dir(&gallery), b"").done();
        let octree = folder.file("scene.oct", octree);
        let mut rtrace = radiance.command("rtrace", &["-h", "-w-", "-ab", "1", "-ad", "16", &octree]);
        let value = run_with(rtrace.current_dir(&gallery), b".1 .2 1.9 0 .9 -.5\n").done();
        assert!(!value.is_empty(), "{scene}");
    }
}

#[test]
fn every_picture_of_the_gallery_is_shown_and_small() {
    let readme = std::fs::read_to_string(root().join("README.md")).expect("the README is read");
    for name in SCENES.iter().copied().chain(["sheeting"]) {
        let file = format!("docs/gallery/{name}.png");
        assert!(readme.contains(&format!("({file})")), "{file} is not in the README");
        let bytes = std::fs::read(root().join(&file)).expect("the picture is read");
        assert!(bytes.len() < LARGEST, "{file} has {} bytes", bytes.len());
        read_png(&bytes).expect("a PNG");
    }
}
