//! Requests for too many threads or too much work end quickly with a clear message.

use crate::program::{Folder, Run, command, run_with};
use std::fmt::Write;

/// Exit code of wrong input.
const INPUT: i32 = 1;
/// Exit code of a limit or a fault.
const FAULT: i32 = 3;

const VIEW: [&str; 14] = ["-vp", "0", "-4", "0", "-vd", "0", "1", "0", "-x", "4", "-y", "4", "-pj", "0"];

/// A lamp, and a ball with the last of `count` mixtures, each of which mixes the previous one with
/// itself.
fn doubling_mixtures(count: usize) -> String {
    let mut scene = "void light lamp\n0\n0\n3 9e6 9e6 9e6\nlamp source l\n0\n0\n4 0 -1 1 .01\n\
                     void plastic m0\n0\n0\n5 .5 .5 .5 0 0\n"
        .to_owned();
    for i in 1..=count {
        writeln!(scene, "void mixfunc m{i}\n4 m{0} m{0} .5 .\n0\n0", i - 1).expect("a string takes everything");
    }
    write!(scene, "m{count} sphere ball\n0\n0\n4 0 0 0 1\n").expect("a string takes everything");
    scene
}

/// Renders this scene with few pixels.
fn picture_of(scene: &str) -> Run {
    let folder = Folder::new();
    folder.file("scene.rad", scene);
    let mut words = vec!["rpict"];
    words.extend(VIEW);
    words.extend(["-ab", "0", "scene.rad"]);
    run_with(command(&words).current_dir(folder.path("")), b"")
}

#[test]
fn mixtures_that_double_with_each_line_are_refused() {
    for count in [13, 59] {
        let run = picture_of(&doubling_mixtures(count));
        assert_eq!(run.code, INPUT, "{count} mixtures: {}", run.messages);
        assert!(
            run.messages.contains("scene.rad:61:1: error: mixture \"m13\" holds 8191 mixtures"),
            "{}",
            run.messages
        );
        assert!(run.output.is_empty(), "{count} mixtures");
    }
}

/// The first values of the pixels of the scene's picture.
fn values_of(scene: &str) -> Vec<f64> {
    let folder = Folder::new();
    folder.file("picture.hdr", picture_of(scene).done());
    let mut command = command(&["pvalue", "-h", "-H", "-d", "-b", "picture.hdr"]);
    let text = run_with(command.current_dir(folder.path("")), b"").text();
    text.split_whitespace().map(|word| word.parse().expect("pvalue writes numbers")).collect()
}

#[test]
fn mixtures_within_the_limit_are_what_they_mix() {
    let [plain, mixed] = [0, 12].map(|count| values_of(&doubling_mixtures(count)));
    assert_eq!((plain.len(), mixed.len()), (16, 16));
    assert!(plain.iter().any(|value| *value > 0.), "the ball is lit");
    for (plain, mixed) in plain.iter().zip(&mixed) {
        assert!((plain - mixed).abs() <= 0.02 * plain, "{plain} is mixed to {mixed}");
    }
}

#[test]
fn millions_of_threads_are_refused() {
    let folder = Folder::new();
    folder.file("scene.rad", doubling_mixtures(0));
    for (program, option) in [("rpict", "-n"), ("rtrace", "-n"), ("rcontrib", "-n")] {
        let mut words = vec![program, option, "5000000"];
        if program == "rcontrib" {
            words.extend(["-m", "lamp"]);
        }
        words.push("scene.rad");
        let run = run_with(command(&words).current_dir(folder.path("")), b"0 -4 0 0 1 0\n");
        assert_eq!(run.code, FAULT, "{program}: {}", run.messages);
        assert!(
            run.messages.contains("cannot start 5000000 threads: the limit is 4096"),
            "{program}: {}",
            run.messages
        );
    }
}
