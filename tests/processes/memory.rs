//! The memory limit (`--limit-memory`): exceeding it gives a clear message, exit code 3 and no
//! half-written file.

use crate::bash;
use crate::program::{Folder, Run, command, run_with};

const INPUT: i32 = 1;
const USAGE: i32 = 2;
const FAULT: i32 = 3;

const COLUMNS: usize = 30_000;

/// A small run-length encoded picture that unpacks to 12 bytes per pixel.
fn bomb(rows: usize) -> Vec<u8> {
    let mut row = vec![2, 2, (COLUMNS >> 8) as u8, (COLUMNS & 0xff) as u8];
    for _ in 0..4 {
        let mut left = COLUMNS;
        while left > 0 {
            let run = left.min(127);
            row.extend([128 + run as u8, 128]);
            left -= run;
        }
    }
    let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {rows} +X {COLUMNS}\n").into_bytes();
    (0..rows).for_each(|_| bytes.extend_from_slice(&row));
    bytes
}

/// Runs in a folder with little memory, and checks that the folder is unchanged.
#[track_caller]
fn run_within(folder: &Folder, limit: &str, words: &[&str]) -> Run {
    let before = folder.names();
    let all = [&words[..1], &["--limit-memory", limit], &words[1..]].concat();
    let run = run_with(command(&all).current_dir(folder.path("")), b"");
    assert_eq!(folder.names(), before, "{words:?}: no file appears or goes");
    run
}

#[track_caller]
fn assert_exhausted(run: &Run, limit: &str) {
    assert_eq!(run.code, FAULT, "{}", run.messages);
    assert!(run.messages.starts_with("radsight: out of memory: "), "{}", run.messages);
    assert!(run.messages.contains(&format!("the limit of {limit}\nhint: --limit-memory")), "{}", run.messages);
}

#[test]
fn pictures_that_unpack_to_more_than_the_limit_end_the_program() {
    let folder = Folder::new();
    folder.file("bomb.hdr", bomb(2_000));
    for words in [&["protate", "bomb.hdr"][..], &["pflip", "-v", "bomb.hdr"], &["protate", "bomb.hdr", "out.hdr"]] {
        assert_exhausted(&run_within(&folder, "64M", words), "64 MB");
    }
}

#[test]
fn a_limit_of_the_caller_is_named() {
    let folder = Folder::new();
    folder.file("bomb.hdr", bomb(6_000));
    let run = bash(&folder, "ulimit -v 512000; \"$R\" pflip -v bomb.hdr > /dev/null");
    assert_eq!(run.code, FAULT, "{}", run.messages);
    assert!(run.messages.contains("would exceed the address space of 500 MB (ulimit -v)"), "{}", run.messages);
}

#[test]
fn pictures_that_are_read_row_by_row_need_little_memory() {
    let folder = Folder::new();
    folder.file("bomb.hdr", bomb(500));
    for words in
        [&["pfilt", "-x", "/100", "-y", "/100", "bomb.hdr"][..], &["pextrem", "bomb.hdr"], &["ra_ppm", "bomb.hdr"]]
    {
        let run = run_within(&folder, "64M", words);
        assert_eq!((run.code, run.messages.as_str()), (0, ""), "{words:?}");
    }
}

#[test]
fn long_lines_end_the_program() {
    let folder = Folder::new();
    folder.file("long.cal", format!("a={}1;", "1+".repeat(5_000_000)));
    folder.file(
        "long.rad",
        format!("void plastic p 0 0 5 .5 .5 .5 0 0\np polygon x 0 0 6000000 {}", "1 2 3 ".repeat(2_000_000)),
    );
    assert_exhausted(&run_within(&folder, "48M", &["rcalc", "-n", "-f", "long.cal"]), "48 MB");
    assert_exhausted(&run_within(&folder, "48M", &["check", "long.rad"]), "48 MB");
}

#[test]
fn the_environment_sets_the_limit_too() {
    let folder = Folder::new();
    folder.file("bomb.hdr", bomb(2_000));
    let mut command = command(&["protate", "bomb.hdr"]);
    command.current_dir(folder.path("")).env("RADSIGHT_LIMIT_MEMORY", "64M");
    assert_exhausted(&run_with(&mut command, b""), "64 MB");
}

#[test]
fn sizes_that_are_none_are_refused() {
    let folder = Folder::new();
    for wrong in ["much", "1", "-1G", "15M"] {
        let run = run_within(&folder, wrong, &["getinfo"]);
        let expected = format!("radsight: option \"--limit-memory\" is followed by \"{wrong}\", expected a size");
        assert_eq!(run.code, USAGE, "{}", run.messages);
        assert!(run.messages.starts_with(&expected), "{}", run.messages);
    }
}

#[test]
fn a_file_of_options_cannot_widen_the_limit() {
    let folder = Folder::new();
    folder.file("options", "--limit-memory 0");
    folder.file("scene.rad", "void light l\n0\n0\n3 1 1 1\nl sphere s\n0\n0\n4 0 0 0 1\n");
    let run = run_with(command(&["rpict", "@options", "scene.rad"]).current_dir(folder.path("")), b"");
    assert_eq!(run.code, USAGE, "{}", run.messages);
    assert!(run.messages.contains("option \"--limit-memory\" is not supported"), "{}", run.messages);
}

/// Each of 41 files includes the next twice.
#[test]
fn files_that_double_what_they_include_are_refused() {
    for line in ["!cat", "!xform -t 1 0 0"] {
        let folder = Folder::new();
        for i in 0..40 {
            folder.file(&format!("f{i}.rad"), format!("{line} f{0}.rad\n", i + 1).repeat(2));
        }
        folder.file("f40.rad", "void plastic p 0 0 5 .5 .5 .5 0 0\np sphere s 0 0 4 0 0 0 1\n");
        let run = run_within(&folder, "1G", &["oconv", "f0.rad"]);
        assert_eq!(run.code, INPUT, "{}", run.messages);
        let expected = "include each other more than 8 deep are read more than 65536 times";
        assert!(run.messages.contains(expected), "{}", run.messages);
        assert!(run.messages.len() < 20_000, "{} bytes of messages", run.messages.len());
    }
}

/// A file may lower the limits of plugins, but not raise them.
#[test]
fn a_file_of_options_cannot_let_plugins_take_more() {
    let folder = Folder::new();
    folder.file("scene.rad", "void light l\n0\n0\n3 1 1 1\nl sphere s\n0\n0\n4 0 0 0 1\n");
    for (options, code) in [
        ("--plugin-time-limit 0", INPUT),
        ("--plugin-memory-limit 0", INPUT),
        ("--plugin-time-limit 1000000", INPUT),
        ("--plugin-time-limit 5 --plugin-memory-limit 100", 0),
    ] {
        folder.file("options", options);
        let words = ["rpict", "@options", "-x", "4", "-y", "4", "scene.rad"];
        let run = run_with(command(&words).current_dir(folder.path("")), b"");
        assert_eq!(run.code, code, "{options}: {}", run.messages);
        assert_eq!(run.messages.contains("comes from a file and is refused"), code == INPUT, "{}", run.messages);
    }
}

/// Runs a copy of the program as a user who may have one process, and so no further threads; `None`
/// if the tools for that are missing.
fn run_without_threads(folder: &Folder, words: &str) -> Option<Run> {
    use std::os::unix::fs::MetadataExt;
    let mut limited = std::process::Command::new("prlimit");
    limited.arg("--nproc=1:1");
    // Root has no such limit, so the test becomes nobody.
    if std::fs::metadata("/proc/self").is_ok_and(|found| found.uid() == 0) {
        limited.args(["setpriv", "--reuid", "65534", "--clear-groups"]);
    }
    limited.arg(folder.path("radsight")).args(words.split(' ')).current_dir(folder.path(""));
    let run = run_with_if_found(&mut limited, b"0 -4 0 0 1 0\n")?;
    let is_missing = run.messages.starts_with("prlimit: ") || run.messages.starts_with("setpriv: ");
    (!is_missing).then_some(run)
}

fn run_with_if_found(command: &mut std::process::Command, input: &[u8]) -> Option<Run> {
    let is_found = std::process::Command::new(command.get_program()).arg("--version").output().is_ok();
    is_found.then(|| run_with(command, input))
}

#[test]
fn a_lack_of_threads_is_reported() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new();
    // Where another user can run it.
    std::fs::copy(env!("CARGO_BIN_EXE_radsight"), folder.path("radsight")).expect("the program is copied");
    std::fs::set_permissions(folder.path(""), std::fs::Permissions::from_mode(0o755))
        .expect("the folder's mode is set");
    folder.file("picture.hdr", bomb(4));
    folder.file("scene.rad", "void light l\n0\n0\n3 1 1 1\nl sphere s\n0\n0\n4 0 0 0 1\n");
    folder.file("matrix", "NROWS=2\nNCOLS=2\nNCOMP=1\nFORMAT=ascii\n\n1 0\n0 1\n");
    for words in [
        "pfilt picture.hdr",
        "oconv scene.rad",
        "rtrace scene.rad",
        "rpict scene.rad",
        "rmtxop matrix . matrix",
        "rcontrib -m l scene.rad",
    ] {
        let Some(run) = run_without_threads(&folder, words) else {
            println!("skipped: prlimit or setpriv is missing");
            return;
        };
        assert_eq!(run.code, FAULT, "{words}: {}", run.messages);
        assert!(run.messages.contains("radsight: cannot start "), "{words}: {}", run.messages);
        assert!(!run.messages.contains("panicked"), "{words}: {}", run.messages);
    }
}

#[test]
fn output_that_was_closed_at_the_start_is_a_fault() {
    let folder = Folder::new();
    folder.file("picture.hdr", bomb(1));
    for words in ["getinfo picture.hdr", "pfilt picture.hdr", "rcalc -n -e '$1=1'", "cnt 3"] {
        let run = bash(&folder, &format!("exec \"$R\" {words} >&-"));
        assert_eq!(run.code, FAULT, "{words}: {}", run.messages);
        assert!(run.messages.contains("it was closed when the program started"), "{words}: {}", run.messages);
    }
}
