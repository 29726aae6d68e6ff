//! `radsight oconv`: real Radiance reads its octrees, and renders the same scene as with its own.

use crate::program::{Folder, command, radsight, run_with};
use radsight_test_support::Radiance;
use std::process::Command;

const SCENE: &str = "void plastic red 0 0 5 .7 .2 .1 .05 .1\ninherit alias same red\nvoid light lamp 0 0 3 9 9 9\n\
    void metal chrome 0 0 5 .9 .9 .9 .9 0\n\
    lamp sphere bulb 0 0 4 0 0 3 .2\nred polygon floor 0 0 12 -4 -4 0 4 -4 0 4 4 0 -4 4 0\n\
    chrome cone spike 0 0 8 1 1 0 1 1 2 .7 .1\nsame ring disk 0 0 8 -1 -1 1 .3 .2 1 .2 .9\n\
    chrome tube pipe 0 0 7 -2 1 .5 2 2 .5 .3\nred bubble shell 0 0 4 0 0 0 6\n\
    !genprism red star 5 1 0 .3 .9 -.8 .6 -.8 -.6 .3 -.9 -l 0 0 .4 | xform -t 2 -2 0\n\
    !xform -n ball -a 12 -rz 30 -i 1 -t 0 0 .5 ball.rad\n\
    void glow sky 0 0 4 .3 .4 .5 0\nsky source dome 0 0 4 0 0 1 180\n";
const BALL: &str = "void glass pane 0 0 3 .9 .9 .9\npane sphere ball 0 0 4 2.5 0 0 .3\n";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("scene.rad", SCENE);
    folder.file("ball.rad", BALL);
    folder
}

/// Our program, in a folder.
fn ours(folder: &Folder, words: &[&str]) -> Vec<u8> {
    let mut command = command(words);
    run_with(command.current_dir(folder.path("")), b"").done()
}

fn theirs(mut command: Command, folder: &Folder, input: &str) -> Vec<f64> {
    let text = run_with(command.current_dir(folder.path("")), input.as_bytes()).text();
    text.split_whitespace().filter_map(|word| word.parse().ok()).collect()
}

/// Rays from all over the scene in many directions.
fn rays() -> String {
    let place = |index: f64, share: f64| 3.0 * ((index * share).fract() - 0.5);
    (0..400).map(f64::from).fold(String::new(), |text, i| {
        let origin = format!("{} {} {}", place(i, 0.618), place(i, 0.414), place(i, 0.732).abs() + 0.2);
        text + &format!("{origin} {} {} {}\n", place(i, 0.236), place(i, 0.871), place(i, 0.645))
    })
}

/// The result of real rtrace with an octree: the names of the surfaces that it hits and their
/// radiance.
fn seen(radiance: &Radiance, folder: &Folder, octree: &str) -> (String, Vec<f64>) {
    let words = ["-h", "-w", "-ab", "0", "-dj", "0", "-ss", "0", "-st", "0", "-lr", "3", "-ov"];
    let values = theirs(radiance.command("rtrace", &[&words[..], &[octree]].concat()), folder, &rays());
    let mut names = radiance.command("rtrace", &["-h", "-w", "-os", octree]);
    (run_with(names.current_dir(folder.path("")), rays().as_bytes()).text(), values)
}

#[track_caller]
fn assert_same_scene(radiance: &Radiance, folder: &Folder, octree: &str, expected: &str) {
    let ((names, values), (expected_names, expected_values)) =
        (seen(radiance, folder, octree), seen(radiance, folder, expected));
    assert_eq!(names, expected_names);
    assert_eq!(values.len(), expected_values.len());
    for (a, b) in values.iter().zip(&expected_values) {
        assert!((a - b).abs() <= 1e-4 * (a.abs() + b.abs() + 1e-6), "{a} instead of {b}");
    }
}

#[test]
fn real_radiance_sees_the_same_scene_in_our_octrees_as_in_its_own() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = folder();
    let expected = radiance.octree(&folder, &["-w", "scene.rad"]);
    for options in [&[][..], &["-f"], &["-r", "512", "-n", "2"], &["-b", "-7", "-7", "-7", "14"], &["-f", "-r", "64"]] {
        let words = [&["oconv"], options, &["scene.rad"]].concat();
        let octree = folder.file("ours.oct", ours(&folder, &words));
        assert_same_scene(&radiance, &folder, &octree, &expected);
    }
}

#[test]
fn the_cube_and_the_header_are_those_of_real_oconv() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = folder();
    let expected = radiance.octree(&folder, &["-w", "scene.rad"]);
    let octree = folder.file("ours.oct", ours(&folder, &["oconv", "scene.rad"]));
    let cube = |octree: &str| {
        let values = theirs(radiance.command("getinfo", &["-d", octree]), &folder, "");
        values[values.len() - 4..].to_vec()
    };
    for (a, b) in cube(&octree).iter().zip(cube(&expected)) {
        assert!((a - b).abs() < 1e-9, "{a} instead of {b}");
    }
    let mut getinfo = radiance.command("getinfo", &[&octree]);
    let text = run_with(&mut getinfo, b"").text();
    assert!(text.contains("oconv scene.rad") && text.contains("FORMAT=Radiance_octree"), "{text}");
}

#[test]
fn an_octree_grows_by_another_file() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = folder();
    folder.file("more.rad", "chrome sphere more 0 0 4 0 2 1 .4\n");
    let expected = radiance.octree(&folder, &["-w", "scene.rad", "more.rad"]);
    for option in [&[][..], &["-f"]] {
        let words = [&["oconv"], option, &["scene.rad"]].concat();
        folder.file("first.oct", ours(&folder, &words));
        let grown = ours(&folder, &["oconv", "-w", "-i", "first.oct", "more.rad"]);
        let grown = folder.file("grown.oct", grown);
        assert_same_scene(&radiance, &folder, &grown, &expected);
    }
}

#[test]
fn meshes_and_octrees_are_placed_in_our_octrees() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = folder();
    folder.file("part.oct", ours(&folder, &["oconv", "-f", "ball.rad"]));
    folder.file("pair.obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n");
    let mut obj2mesh = radiance.command("obj2mesh", &["pair.obj", "pair.rtm"]);
    run_with(obj2mesh.current_dir(folder.path("")), b"").done();
    let text = "void instance one 5 part.oct -t 0 0 1 0 0\nvoid plastic p 0 0 5 .5 .5 .5 0 0\n\
        p mesh two 7 pair.rtm -rx 30 -t 1 1 1 0 0\nvoid glow g 0 0 4 1 1 1 0\ng source s 0 0 4 0 0 1 360\n";
    folder.file("placed.rad", text);
    let expected = radiance.octree(&folder, &["-w", "placed.rad"]);
    for option in [&[][..], &["-f"]] {
        let words = [&["oconv"], option, &["placed.rad"]].concat();
        let octree = folder.file("ours.oct", ours(&folder, &words));
        assert_same_scene(&radiance, &folder, &octree, &expected);
    }
}

#[test]
fn our_programs_read_octrees_wherever_they_read_scenes() {
    let folder = folder();
    for option in [&[][..], &["-f"]] {
        let words = [&["oconv"], option, &["scene.rad"]].concat();
        folder.file("scene.oct", ours(&folder, &words));
        let from_text = ours(&folder, &["getbbox", "-h", "scene.rad"]);
        assert_eq!(ours(&folder, &["getbbox", "-h", "scene.oct"]), from_text);
        assert_eq!(ours(&folder, &["check", "scene.oct"]), ours(&folder, &["check", "scene.rad"]));
        let trace = |scene: &str| {
            let mut command = command(&["rtrace", "-h", "-os", scene]);
            run_with(command.current_dir(folder.path("")), rays().as_bytes()).text()
        };
        assert_eq!(trace("scene.oct"), trace("scene.rad"));
    }
}

#[test]
fn an_octree_from_standard_input_is_frozen() {
    let folder = folder();
    let mut command = command(&["oconv", "-"]);
    let octree = run_with(command.current_dir(folder.path("")), b"void sphere s 0 0 4 0 0 0 1\n").done();
    let read = radsight_formats::Octree::read(&octree).unwrap();
    assert!(matches!(read.content, radsight_formats::OctreeContent::Objects(objects) if objects.len() == 1));
}

#[test]
fn a_wrong_command_line_says_what_is_wrong() {
    for (words, message) in [
        (&["oconv", "-q"][..], "oconv: option \"-q\" is unknown"),
        (&["oconv", "-n", "x"], "oconv: option \"-n\" is \"x\", expected a number"),
        (&["oconv", "-b", "1", "2"], "oconv: missing value of \"-b\""),
        (&["oconv", "-i", "a.oct", "-b", "0", "0", "0", "1"], "oconv: -i and -b both give the cube"),
    ] {
        let run = radsight(words);
        assert_eq!(run.code, 2);
        assert!(run.messages.contains(message), "{}", run.messages);
    }
    let run = radsight(&["oconv", "-b", "0", "0", "0", "1", "!echo void sphere s 0 0 4 0 0 0 1"]);
    assert_eq!((run.code, run.messages.trim_end()), (1, "radsight: oconv: the cube does not hold the whole scene"));
}

/// Real oconv takes numbers below 1 as 1: with 0, each cube of a surface would be divided down to
/// the resolution.
#[test]
fn at_least_one_surface_is_left_in_a_cube() {
    let folder = Folder::new();
    let scene =
        folder.file("two.rad", "void plastic p 0 0 5 1 1 1 0 0\np sphere a 0 0 4 0 0 0 1\np sphere b 0 0 4 3 0 0 1\n");
    let tree = |limit: &str| {
        let bytes = ours(&folder, &["oconv", "-n", limit, &scene]);
        let header = bytes.windows(2).position(|pair| pair == b"\n\n").expect("a header");
        bytes[header..].to_vec()
    };
    let expected = tree("1");
    assert_eq!(tree("0"), expected);
    assert_eq!(tree("-3"), expected);
}

/// Real oconv does not end with seven such triangles: nothing separates them, so that it would
/// divide the triangle into 200 million cubes.
#[test]
fn octrees_of_coincident_surfaces_end_and_real_radiance_reads_them() {
    let folder = Folder::new();
    for count in [7, 2600] {
        let material = "void plastic p 0 0 5 1 1 1 0 0\n".to_owned();
        let scene = (0..count).fold(material, |text, _| text + "p polygon t 0 0 9 0 0 0 1 0 0 0 1 .3\n");
        folder.file("scene.rad", scene);
        let run = run_with(command(&["oconv", "scene.rad"]).current_dir(folder.path("")), b"");
        let is_too_many = count > 511;
        let said = if is_too_many { "2089 surfaces are missing from cubes that more than 511 touch" } else { "" };
        assert!(run.messages.contains(said) && run.messages.is_empty() != is_too_many, "{}", run.messages);
        let octree = run.done();
        assert!(octree.len() < 20_000_000, "{} bytes", octree.len());
        folder.file("scene.oct", octree);
        let Some(radiance) = Radiance::find() else { continue };
        let words = ["-h", "-w", "-ab", "0", "-op", "scene.oct"];
        let points = theirs(radiance.command("rtrace", &words), &folder, ".3 .3 2 0 0 -1\n.9 .05 2 0 0 -1\n");
        assert_eq!(points, [0.3, 0.3, 0.09, 0.9, 0.05, 0.015]);
    }
}
