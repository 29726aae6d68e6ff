//! `-af`: an irradiance cache shared by runs and processes through a file.

use crate::program::{Folder, command, run_with};
use std::fs;
use std::process::{Command, Output};

/// A room with a lamp.
const ROOM: &str = "
void plastic grey 0 0 5 .5 .5 .5 0 0
void light bright 0 0 3 10 10 10
grey sphere ball 0 0 4 1 1 .5 .4
bright ring lamp 0 0 8 2 2 2.9 0 0 -1 0 .3
!genbox grey box 4 4 3 -i
";

fn room() -> Folder {
    let folder = Folder::new();
    folder.file("room.rad", ROOM);
    folder
}

/// `rpict` of the room from a corner, with further words.
fn picture(folder: &Folder, words: &[&str]) -> Command {
    let view = ["-vp", ".3", ".3", "1.5", "-vd", "1", "1", "-.2", "-vh", "80", "-vv", "80", "-x", "24", "-y", "24"];
    // With this accuracy the spacing of records does not depend on their number of rays.
    let mut all = vec!["rpict", "-ab", "1", "-ad", "64", "-aa", ".1"];
    all.extend(view);
    all.extend(words);
    all.push("room.rad");
    let mut rpict = command(&all);
    rpict.current_dir(folder.path(""));
    rpict
}

fn pixels(output: &Output) -> Vec<u8> {
    let end = output.stdout.windows(2).position(|pair| pair == b"\n\n").expect("a header ends");
    output.stdout[end..].to_vec()
}

#[track_caller]
fn rendered(folder: &Folder, words: &[&str]) -> Vec<u8> {
    let output = picture(folder, words).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    pixels(&output)
}

#[track_caller]
fn refused(folder: &Folder, words: &[&str], expected: &str) {
    let output = picture(folder, words).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains(expected) && said.contains("hint: "), "{said}");
    assert!(output.stdout.is_empty(), "nothing is written after a refusal");
}

#[test]
fn a_picture_with_a_full_file_has_the_bits_of_the_one_that_filled_it() {
    let folder = room();
    let without = rendered(&folder, &[]);
    let first = rendered(&folder, &["-af", "room.amb"]);
    assert!(first == without, "a file changes nothing");
    let file = fs::read(folder.path("room.amb")).unwrap();
    assert!(file.starts_with(b"#?RADIANCE\nrpict -ab 1"), "the header tells the command");
    // More rays would gather other values: the gathered ones are in the file.
    assert!(rendered(&folder, &["-af", "room.amb", "-ad", "300"]) == first, "all is in the file");
    assert!(rendered(&folder, &["-ad", "300"]) != first, "more rays make another picture");
    assert!(fs::read(folder.path("room.amb")).unwrap() == file, "nothing is added");
}

#[test]
fn another_view_and_single_rays_use_what_is_there_and_add_to_it() {
    let folder = room();
    rendered(&folder, &["-af", "room.amb"]);
    let length = || fs::metadata(folder.path("room.amb")).unwrap().len();
    let before = length();
    rendered(&folder, &["-af", "room.amb", "-vp", "3.7", "3.7", "1.5", "-vd", "-1", "-1", "-.2"]);
    assert!(length() > before, "the other corner is new");
    let rtrace = |words: &[&str]| {
        let all = [&["rtrace", "-h", "-I", "-ab", "1", "-ad", "64", "-aa", ".1"], words, &["room.rad"]].concat();
        let mut rtrace = command(&all);
        String::from_utf8(run_with(rtrace.current_dir(folder.path("")), b"2 3 0 0 0 1\n").done()).unwrap()
    };
    let shared = rtrace(&["-af", "room.amb"]);
    assert_eq!(rtrace(&["-af", "room.amb", "-ad", "300"]), shared);
    let number = |text: &str| text.split_whitespace().next().unwrap().parse::<f64>().unwrap();
    let alone = number(&rtrace(&["-ad", "4096"]));
    assert!((number(&shared) / alone - 1.0).abs() < 0.1, "{shared} against {alone}");
}

#[test]
fn processes_that_run_at_once_share_one_file() {
    let folder = room();
    let corners = [[".3", ".3", "1.5", "1", "1", "-.2"], ["3.7", "3.7", "1.5", "-1", "-1", "-.2"]];
    let start = |[x, y, z, dx, dy, dz]: [&str; 6]| {
        let view = ["-vp", x, y, z, "-vd", dx, dy, dz, "-af", "room.amb"];
        picture(&folder, &view).stdout(std::process::Stdio::piped()).spawn().unwrap()
    };
    let running = corners.map(start);
    for process in running {
        assert!(process.wait_with_output().unwrap().status.success());
    }
    let file = fs::read(folder.path("room.amb")).unwrap();
    // The file has all records for both views, whichever process wrote last.
    for [x, y, z, dx, dy, dz] in corners {
        let view = ["-vp", x, y, z, "-vd", dx, dy, dz, "-af", "room.amb"];
        rendered(&folder, &view);
    }
    assert!(fs::read(folder.path("room.amb")).unwrap() == file, "nothing is added");
    let names = fs::read_dir(folder.path("")).unwrap().count();
    assert_eq!(names, 2, "the scene and the file are all there is");
}

#[test]
fn a_file_of_something_else_is_refused() {
    let folder = room();
    let amb = ["-af", "room.amb"];
    rendered(&folder, &amb);
    let file = fs::read(folder.path("room.amb")).unwrap();
    refused(&folder, &["-af", "room.amb", "-ab", "2"], "it was made with \"-ab 1\", expected \"-ab 2\"");
    refused(&folder, &["-af", "room.amb", "-av", ".1", ".1", ".1"], "it was made with \"-av 0 0 0\"");
    fs::write(folder.path("room.amb"), &file[..file.len() - 100]).unwrap();
    refused(&folder, &amb, "it is cut short or damaged");
    let mut changed = file.clone();
    let middle = changed.len() / 2;
    changed[middle] ^= 1;
    fs::write(folder.path("room.amb"), &changed).unwrap();
    refused(&folder, &amb, "it is cut short or damaged");
    fs::write(folder.path("room.amb"), b"#?RADIANCE\nrpict\nFORMAT=Radiance_ambval\n\n\x01").unwrap();
    refused(&folder, &amb, "it holds ambient values of real Radiance");
    fs::write(folder.path("room.amb"), "years of work").unwrap();
    refused(&folder, &amb, "it is not an irradiance cache");
    assert_eq!(fs::read(folder.path("room.amb")).unwrap(), b"years of work");
    fs::write(folder.path("room.amb"), &file).unwrap();
    folder.file("room.rad", ROOM.replace(".5 .5 .5 0 0", ".5 .5 .6 0 0"));
    refused(&folder, &amb, "it was made of another scene");
}

#[test]
fn without_accuracy_no_file_is_made() {
    let folder = room();
    let output = picture(&folder, &["-af", "room.amb", "-aa", "0"]).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && said.contains("zero ambient accuracy so \"room.amb\" not opened"), "{said}");
    assert!(!fs::exists(folder.path("room.amb")).unwrap());
}

#[test]
fn messages_in_a_file_stand_below_the_command_line() {
    let folder = room();
    rendered(&folder, &["-t", "1", "-e", "a log"]);
    rendered(&folder, &["-e", "a log"]);
    let log = fs::read_to_string(folder.path("a log")).unwrap();
    let marks = log.lines().filter(|line| *line == "**************").count();
    let commands = log.lines().filter(|line| line.starts_with("*** PID ") && line.contains(": rpict -ab 1 "));
    assert_eq!((marks, commands.count()), (2, 2), "{log}");
    assert!(log.contains("-e \"a log\" room.rad\n") && log.contains(" rays, 100.00% after "), "{log}");
}
