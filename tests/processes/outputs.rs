//! Files appear whole or not at all, whatever happens to the program, and no output replaces an
//! input.

use crate::bash;
use crate::program::{Folder, Run, command, gripps, run_with};
use nix::sys::signal::{Signal, kill, killpg};
use nix::unistd::Pid;
use radsight_picture::Header;
use std::fs;
use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

const ROOM: &str = "
void plastic wall 0 0 5 .5 .4 .3 0 0
void light lamp 0 0 3 1 1 1
lamp sphere bulb 0 0 4 0 5 3 .5
wall polygon floor 0 0 12 -10 0 0 10 0 0 10 20 0 -10 20 0
wall sphere ball 0 0 4 0 4 1 .8
";

/// A slow rendering with an irradiance cache, to be interrupted.
const VIEW: [&str; 16] =
    ["-vp", "0", "-3", "1", "-vd", "0", "1", "0", "-x", "240", "-y", "240", "-ab", "1", "-ad", "8"];

fn room() -> Folder {
    let folder = Folder::new();
    folder.file("room.rad", ROOM);
    folder
}

fn in_folder(folder: &Folder, words: &[&str]) -> Command {
    let mut command = command(words);
    command.current_dir(folder.path(""));
    command
}

fn run(folder: &Folder, words: &[&str]) -> Run {
    run_with(&mut in_folder(folder, words), b"")
}

fn rpict<'w>(more: &[&'w str]) -> Vec<&'w str> {
    [&["rpict"], &VIEW[..], more, &["room.rad"]].concat()
}

/// The data after the header.
fn pixels(bytes: &[u8]) -> &[u8] {
    &bytes[Header::read(bytes).expect("a header").1..]
}

fn partial(bytes: &[u8]) -> Option<String> {
    let header = Header::read(bytes).expect("a header").0.to_text();
    header.lines().find_map(|line| line.strip_prefix("PARTIAL= ")).map(str::to_owned)
}

fn start(mut command: Command) -> Child {
    command.stdin(Stdio::null()).stdout(Stdio::null()).process_group(0).spawn().expect("the program starts")
}

fn remove(folder: &Folder, names: [&str; 2]) {
    names.iter().for_each(|name| fs::remove_file(folder.path(name)).expect("it was written"));
}

/// Attempts to interrupt a program before it ends.
const ATTEMPTS: u32 = 8;

fn pid(child: &Child) -> Pid {
    Pid::from_raw(i32::try_from(child.id()).expect("a small number"))
}

/// Whether this process ignores a signal, and so what it starts: scripts start jobs in the background
/// without SIGINT.
fn is_ignored(signal: Signal) -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal as u32 - 1) & 1 == 1)
}

/// Waits until a hidden file of this target has this many bytes.
fn wait_for_hidden(folder: &Folder, target: &str, bytes: u64, child: &mut Child) {
    let end = Instant::now() + Duration::from_secs(60);
    while Instant::now() < end {
        let is_hidden = |name: &String| name.starts_with(&format!(".{target}."));
        let sizes = folder.names().into_iter().filter(is_hidden);
        if sizes.filter_map(|name| fs::metadata(folder.path(&name)).ok()).any(|found| found.len() >= bytes) {
            return;
        }
        assert!(child.try_wait().expect("the child is known").is_none(), "the program ended before it was interrupted");
        sleep(Duration::from_millis(1));
    }
    panic!("no hidden file of {target}");
}

#[test]
fn an_interrupted_picture_is_saved_as_partial_and_goes_on_to_the_same_bits() {
    let folder = room();
    // Large enough that the signal comes long before the end.
    let rpict = |more: &[&'static str]| rpict(&[&["-x", "600", "-y", "600"], more].concat());
    run(&folder, &rpict(&["-o", "whole.hdr", "-z", "whole.zbf"])).done();
    let signals = [Signal::SIGTERM, Signal::SIGINT, Signal::SIGXCPU];
    for signal in signals.into_iter().filter(|signal| !is_ignored(*signal)) {
        let interrupted = || {
            let mut child = start(in_folder(&folder, &rpict(&["-o", "part.hdr", "-z", "part.zbf"])));
            wait_for_hidden(&folder, "part.hdr", 10_000, &mut child);
            // On a busy machine the program may end before.
            let _ = kill(pid(&child), signal);
            let ended = child.wait().expect("the program ends").signal();
            if ended.is_none() {
                remove(&folder, ["part.hdr", "part.zbf"]);
            }
            ended
        };
        let ended = (0..ATTEMPTS).find_map(|_| interrupted());
        assert_eq!(ended, Some(signal as i32), "the program ends by the signal");
        let saved = folder.read("part.hdr");
        assert!(partial(&saved).is_some_and(|words| words.ends_with(" of 600 rows")), "{:?}", partial(&saved));
        assert!(pixels(&folder.read("whole.hdr")).starts_with(pixels(&saved)));
        assert_eq!(folder.names(), ["part.hdr", "part.zbf", "room.rad", "whole.hdr", "whole.zbf"]);
        run(&folder, &rpict(&["-ro", "part.hdr", "-z", "part.zbf"])).done();
        let resumed = folder.read("part.hdr");
        assert_eq!(partial(&resumed), None);
        assert!(pixels(&resumed) == pixels(&folder.read("whole.hdr")), "the same bits");
        assert!(folder.read("part.zbf") == folder.read("whole.zbf"), "the same distances");
        ["part.hdr", "part.zbf"].iter().for_each(|name| fs::remove_file(folder.path(name)).expect("it is there"));
    }
}

#[test]
fn two_outputs_with_one_name_are_refused_before_the_work() {
    let folder = room();
    symlink("new", folder.path("link")).expect("a link");
    fs::create_dir(folder.path("inner")).expect("a folder");
    let rpict = |more: &[&'static str]| rpict(&[&["-x", "8", "-y", "8"], more].concat());
    let (camera, scene) = (gripps("fig10.toml"), gripps("rig-table.rad"));
    let capture = |more: &[&'static str]| {
        [&["capture", camera.as_str(), scene.as_str(), "--samples", "1"], more].concat().to_vec()
    };
    let cases = [
        rpict(&["-o", "new", "-z", "new"]),
        rpict(&["-o", "new", "-z", "link"]),
        rpict(&["-o", "inner/../new", "-z", "new"]),
        rpict(&["-z", "new", "-af", "new"]),
        rpict(&["-o", "new", "--samples", "2", "--record", "new"]),
        capture(&["-o", "new.png", "--record", "new.png"]),
        capture(&["--exposure", "new.mtx", "--record", "./new.mtx"]),
        vec!["rcontrib", "-ab", "1", "-o", "new", "-m", "lamp", "-o", "./new", "-m", "wall", "room.rad"],
        vec!["rsplit", "new", "./new"],
    ];
    for words in cases {
        let run = run_with(&mut in_folder(&folder, &words), b"0 0 1 0 0 1\n");
        assert_eq!(run.code, 2, "{words:?}: {}", run.messages);
        let said = ["is the name of two outputs", "are the same file"];
        assert!(said.iter().any(|words| run.messages.contains(words)), "{words:?}: {}", run.messages);
        assert!(folder.read("room.rad") == ROOM.as_bytes(), "{words:?}");
        let left: Vec<String> = folder.names().into_iter().filter(|name| name.starts_with('.')).collect();
        assert!(left.is_empty(), "{words:?} left {left:?}");
        let _ = fs::remove_file(folder.path("new"));
    }
}

#[test]
fn a_file_larger_than_allowed_is_a_failure_that_leaves_nothing() {
    let folder = room();
    run(&folder, &["rpict", "-x", "60", "-y", "60", "-o", "a.hdr", "room.rad"]).done();
    for script in [
        "oconv -o new.oct room.rad room.rad room.rad room.rad room.rad",
        "ra_xyze a.hdr new.hdr",
        "gensurf a b s t s+t 50 50 > text",
    ] {
        let run = bash(&folder, &format!("ulimit -f 1; \"$R\" {script}"));
        assert_eq!(run.code, 3, "{script}: {}", run.messages);
        assert!(run.messages.contains("too large"), "{script}: {}", run.messages);
        let left: Vec<String> = folder.names().into_iter().filter(|name| name.contains("new")).collect();
        assert!(left.is_empty(), "{script} left {left:?}");
    }
}

#[test]
fn an_interrupted_exposure_is_saved_as_partial() {
    let folder = Folder::new();
    let words = ["capture", &gripps("fig10.toml"), &gripps("rig-table.rad"), "--samples", "4000"];
    let words = [&words[..], &["-o", "grey.png", "--exposure", "exposure.mtx"]].concat();
    let mut child = start(in_folder(&folder, &words));
    sleep(Duration::from_millis(600));
    assert!(child.try_wait().expect("the child is known").is_none(), "the program ended before it was interrupted");
    kill(pid(&child), Signal::SIGTERM).expect("the signal is sent");
    assert_eq!(child.wait().expect("the program ends").signal(), Some(Signal::SIGTERM as i32));
    assert_eq!(folder.names(), ["exposure.mtx", "grey.png", "grey.png.checkpoint"]);
    let words = partial(&folder.read("exposure.mtx")).expect("it is marked");
    assert!(words.ends_with(" of 31680 pixels"), "{words}");
    assert!(folder.read("grey.png").windows(8).any(|part| part == b"PARTIAL="));
}

/// A small picture of Fig. 11's scene, which is started, interrupted and continued.
fn small_capture(folder: &Folder, effort: [&'static str; 2]) -> Vec<String> {
    let camera = fs::read_to_string(gripps("fig11.toml")).expect("a camera");
    folder.file("camera.toml", camera.replace("pixels = [192, 165]", "pixels = [32, 28]"));
    folder.file("hlmp-8104.csv", fs::read_to_string(gripps("hlmp-8104.csv")).expect("a table"));
    ["capture", "camera.toml", &gripps("sheet-retro.rad"), effort[0], effort[1]].map(str::to_owned).to_vec()
}

#[test]
fn an_interrupted_exposure_goes_on_to_the_same_bits() {
    for effort in [["--samples", "256"], ["--error", ".005"]] {
        let folder = Folder::new();
        let capture = small_capture(&folder, effort);
        let capture: Vec<&str> = capture.iter().map(String::as_str).collect();
        let begun = Instant::now();
        run(&folder, &[&capture[..], &["--exposure", "whole.pfm"]].concat()).done();
        let whole = begun.elapsed();
        let words = [&capture[..], &["-o", "grey.png", "--exposure", "part.pfm", "--resume"]].concat();
        let (mut interruptions, mut attempts) = (0, 0);
        loop {
            let mut child = start(in_folder(&folder, &words));
            sleep(whole * (4 + interruptions) / (12 << attempts));
            // The program may have ended by itself.
            let _ = kill(pid(&child), if is_ignored(Signal::SIGINT) { Signal::SIGTERM } else { Signal::SIGINT });
            if child.wait().expect("the program ends").signal().is_none() {
                if interruptions > 0 || attempts == ATTEMPTS {
                    break;
                }
                // It was faster than the first one: the machine is less busy now.
                attempts += 1;
                remove(&folder, ["grey.png", "part.pfm"]);
                continue;
            }
            interruptions += 1;
            assert!(interruptions < 200, "{effort:?}: it never ends");
        }
        assert!(interruptions > 0, "{effort:?}: it was not interrupted");
        assert!(folder.read("part.pfm") == folder.read("whole.pfm"), "{effort:?}: the same bits");
        assert_eq!(folder.names(), ["camera.toml", "grey.png", "hlmp-8104.csv", "part.pfm", "whole.pfm"], "{effort:?}");
    }
}

#[test]
fn a_checkpoint_of_something_else_is_refused() {
    let folder = Folder::new();
    let capture = small_capture(&folder, ["--samples", "4096"]);
    let capture: Vec<&str> = capture.iter().map(String::as_str).collect();
    let words = [&capture[..], &["-o", "grey.png"]].concat();
    let mut child = start(in_folder(&folder, &words));
    sleep(Duration::from_millis(300));
    kill(pid(&child), Signal::SIGTERM).expect("the signal is sent");
    child.wait().expect("the program ends");
    let saved = folder.read("grey.png.checkpoint");
    let other_seed = run(&folder, &[&words[..], &["--resume", "--seed", "1"]].concat());
    assert_eq!(other_seed.code, 1, "{}", other_seed.messages);
    let camera = String::from_utf8(folder.read("camera.toml")).expect("text");
    folder.file("camera.toml", camera.replace("exposure_ms = 10.0", "exposure_ms = 11.0"));
    let refused = run(&folder, &[&words[..], &["--resume"]].concat());
    assert_eq!(refused.code, 1, "{}", refused.messages);
    assert!(refused.messages.contains("it belongs to another scene, camera file"), "{}", refused.messages);
    folder.file("camera.toml", camera);
    folder.file("grey.png.checkpoint", &saved[..saved.len() - 1]);
    let broken = run(&folder, &[&words[..], &["--resume"]].concat());
    assert_eq!(broken.code, 1, "{}", broken.messages);
    assert!(broken.messages.contains("the checkpoint is damaged or incomplete"), "{}", broken.messages);
}

/// Default number of times that each program is killed.
const KILLS: u32 = 20;

/// Kills a program and its children at random times; `check` inspects the folder after each.
fn kill_at_random_moments(kills: u32, folder: &Folder, words: &[&str], check: &dyn Fn(&Folder)) {
    let begun = Instant::now();
    run(folder, words).done();
    let whole = begun.elapsed();
    check(folder);
    let mut random = SystemTime::now().duration_since(UNIX_EPOCH).expect("a time after 1970").subsec_nanos();
    for _ in 0..kills {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let mut child = start(in_folder(folder, words));
        sleep(whole.mul_f64(1.1 * f64::from(random >> 8) / f64::from(1 << 24)));
        // The program may have ended by itself.
        let _ = killpg(pid(&child), Signal::SIGKILL);
        child.wait().expect("the program ends");
        check(folder);
    }
}

/// Checks that a file is missing or correct; then removes it.
fn whole_or_absent(folder: &Folder, name: &str, is_whole: &dyn Fn(&[u8]) -> bool) {
    if folder.path(name).exists() {
        assert!(is_whole(&folder.read(name)), "{name} is half-written");
        fs::remove_file(folder.path(name)).expect("it is there");
    }
}

#[test]
fn a_killed_rpict_leaves_no_half_and_goes_on_to_the_same_bits() {
    killed_rpict(KILLS);
}

fn killed_rpict(kills: u32) {
    let folder = room();
    let rpict = |more: &[&'static str]| rpict(&[&["-x", "130", "-y", "130", "-ad", "4", "-dt", "1"], more].concat());
    run(&folder, &rpict(&["-o", "whole.hdr"])).done();
    let whole = folder.read("whole.hdr");
    let same = |bytes: &[u8]| pixels(bytes) == pixels(&whole);
    // Each run continues the output of the killed one before.
    kill_at_random_moments(kills, &folder, &rpict(&["-ro", "a.hdr"]), &|folder| {
        whole_or_absent(folder, "a.hdr", &same)
    });
    run(&folder, &rpict(&["-ro", "a.hdr"])).done();
    assert!(same(&folder.read("a.hdr")), "the same bits");
    assert_eq!(folder.names(), ["a.hdr", "room.rad", "whole.hdr"], "nothing is left over");
}

#[test]
fn a_killed_capture_leaves_no_half_and_goes_on_to_the_same_bits() {
    killed_capture(KILLS);
}

fn killed_capture(kills: u32) {
    let folder = Folder::new();
    let capture = small_capture(&folder, ["--error", ".02"]);
    let capture: Vec<&str> = capture.iter().map(String::as_str).collect();
    run(&folder, &[&capture[..], &["--exposure", "whole.pfm"]].concat()).done();
    let whole = folder.read("whole.pfm");
    let same = |bytes: &[u8]| bytes == whole;
    let words = [&capture[..], &["--exposure", "a.pfm", "--resume", "--checkpoint-interval", ".05"]].concat();
    // Each run continues the output of the killed one before.
    kill_at_random_moments(kills, &folder, &words, &|folder| whole_or_absent(folder, "a.pfm", &same));
    run(&folder, &words).done();
    assert!(same(&folder.read("a.pfm")), "the same bits");
    assert_eq!(folder.names(), ["a.pfm", "camera.toml", "hlmp-8104.csv", "whole.pfm"], "nothing is left over");
}

#[test]
fn a_killed_oconv_leaves_no_half() {
    killed_oconv(KILLS);
}

fn killed_oconv(kills: u32) {
    let folder = room();
    let text: String = (0..4000).map(|i| format!("wall sphere s{i} 0 0 4 {} {} 1 .3\n", i % 63, i / 63)).collect();
    folder.file("many.rad", ROOM.to_owned() + &text);
    let words = ["oconv", "-f", "-o", "a.oct", "many.rad"];
    run(&folder, &words).done();
    let whole = folder.read("a.oct");
    let same = |bytes: &[u8]| bytes == whole;
    kill_at_random_moments(kills, &folder, &words, &|folder| whole_or_absent(folder, "a.oct", &same));
    run(&folder, &words).done();
    assert_eq!(folder.names(), ["a.oct", "many.rad", "room.rad"], "nothing is left over");
}

#[test]
fn a_killed_rad_leaves_no_half_and_goes_on() {
    killed_rad(KILLS);
}

fn killed_rad(kills: u32) {
    let folder = room();
    let project = "OCTREE= a.oct\nscene= room.rad\nZONE= I -4 4 0 8 0 3\nRES= 128\nIND= 1\nview= def -vp 0 -3 1\n";
    folder.file("a.rif", project);
    let words = ["rad", "-s", "a.rif"];
    run(&folder, &words).done();
    let [octree, picture] = ["a.oct", "a_def.hdr"].map(|name| folder.read(name));
    let check = |folder: &Folder| {
        whole_or_absent(folder, "a_def.hdr", &|bytes| pixels(bytes) == pixels(&picture));
        if folder.path("a.oct").exists() {
            assert!(pixels(&folder.read("a.oct")) == pixels(&octree), "a.oct is half-written");
        }
        if folder.path("a_def.unf").exists() {
            let raw = folder.read("a_def.unf");
            assert!(radsight_picture::Picture::read(&raw).is_ok(), "a_def.unf is half-written");
        }
    };
    kill_at_random_moments(kills, &folder, &words, &check);
    run(&folder, &words).done();
    assert!(pixels(&folder.read("a_def.hdr")) == pixels(&picture), "the same bits");
    assert_eq!(folder.names(), ["a.oct", "a.rif", "a_def.hdr", "room.rad"], "nothing is left over");
}

#[test]
#[ignore = "takes minutes"]
fn two_hundred_kills_leave_no_half() {
    [killed_rpict, killed_capture, killed_oconv, killed_rad].into_iter().for_each(|program| program(200));
}

#[test]
fn rad_takes_an_empty_or_broken_raw_picture_as_nothing_done() {
    let folder = room();
    folder.file("a.rif", "OCTREE= a.oct\nscene= room.rad\nZONE= I -4 4 0 8 0 3\nRES= 8\nview= def -vp 0 -3 1\n");
    run(&folder, &["oconv", "-o", "a.oct", "room.rad"]).done();
    let header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 24 +X 24\n";
    for broken in ["", "no picture", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n", header] {
        folder.file("a_def.unf", broken);
        run(&folder, &["rad", "a.rif"]).done();
        let picture = radsight_picture::Picture::read(&folder.read("a_def.hdr")).expect("a picture");
        assert_eq!(picture.width(), 8, "{broken:?}");
        fs::remove_file(folder.path("a_def.hdr")).expect("it is there");
    }
}

#[test]
fn an_output_that_is_an_input_is_refused() {
    let folder = room();
    run(&folder, &rpict(&["-x", "16", "-y", "16", "-o", "p.hdr"])).done();
    folder.file("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    fs::hard_link(folder.path("p.hdr"), folder.path("hard.hdr")).expect("a hard link");
    symlink("p.hdr", folder.path("soft.hdr")).expect("a link");
    folder.file("many.txt", "1\n2\n");
    let before: Vec<Vec<u8>> = folder.names().iter().map(|name| folder.read(name)).collect();
    for words in [
        &["oconv", "-o", "room.rad", "room.rad"][..],
        &["obj2mesh", "mesh.obj", "mesh.obj"],
        &["ra_xyze", "p.hdr", "./p.hdr"],
        &["ra_xyze", "p.hdr", "soft.hdr"],
        &["ra_xyze", "soft.hdr", "hard.hdr"],
        &["ra_ppm", "p.hdr", "hard.hdr"],
        &["pcond", "-x", "p.hdr", "p.hdr"],
    ] {
        let run = run(&folder, words);
        assert_eq!(run.code, 2, "{words:?}: {}", run.messages);
        assert!(run.messages.contains("input"), "{words:?}: {}", run.messages);
    }
    for script in ["rcalc -e '$1=$1' many.txt >> many.txt", "total < many.txt >> many.txt", "pfilt p.hdr >> hard.hdr"] {
        let run = shell(&folder, script);
        assert_eq!(run.code, 2, "{script}: {}", run.messages);
        assert!(run.messages.contains("standard output goes to the same file"), "{script}: {}", run.messages);
    }
    let run = shell(&folder, "rsplit -f many.txt < many.txt");
    assert_eq!(run.code, 2, "{}", run.messages);
    assert!(run.messages.contains("the same file as standard input"), "{}", run.messages);
    let after: Vec<Vec<u8>> = folder.names().iter().map(|name| folder.read(name)).collect();
    assert!(before == after, "no file has changed");
}

#[test]
fn mkillum_replaces_data_that_its_scene_reads_when_asked() {
    let folder = Folder::new();
    let outside = "void glow sky 0 0 4 1 1 1 0\nsky source up 0 0 4 0 0 1 180\nvoid glass pane 0 0 3 .9 .9 .9\n";
    folder.file("outside.rad", outside);
    let surface = "pane polygon w 0 0 12 .5 0 1 .5 0 2.5 3.5 0 2.5 3.5 0 1\n";
    folder.file("windows.rad", format!("#@mkillum m=win f=win d=24 s=16 c=a\n{surface}"));
    let again =
        |scenes: &str| shell(&folder, &format!("mkillum {scenes} < windows.rad > made.rad && mv made.rad one.rad"));
    again("outside.rad").done();
    assert!(folder.names().contains(&"win.dat".to_owned()), "{:?}", folder.names());
    again("outside.rad one.rad").done();
    assert!(!folder.names().contains(&"win1.dat".to_owned()), "{:?}", folder.names());
}

/// Runs a program with the redirections of a shell.
fn shell(folder: &Folder, script: &str) -> Run {
    bash(folder, &format!("\"$R\" {script}"))
}

#[test]
fn special_targets_are_written_as_what_they_are() {
    let folder = room();
    let whole = run(&folder, &["oconv", "-f", "room.rad"]).done();
    let body = |bytes: &[u8]| pixels(bytes).to_vec();
    let written = |target: &str| run(&folder, &["oconv", "-f", "-o", target, "room.rad"]).done();
    assert!(body(&written("-")) == body(&whole) && body(&written("/dev/stdout")) == body(&whole));
    assert_eq!(written("/dev/null"), b"");
    assert!(!fs::metadata("/dev/null").expect("it is there").is_file());
    folder.file("real.oct", "old");
    symlink("real.oct", folder.path("link.oct")).expect("a link");
    symlink("new.oct", folder.path("dangling.oct")).expect("a link");
    for (target, real) in [("link.oct", "real.oct"), ("dangling.oct", "new.oct")] {
        written(target);
        assert!(folder.path(target).is_symlink(), "{target} stays a link");
        assert!(body(&folder.read(real)) == body(&whole));
    }
    let fifo = folder.word("fifo");
    make_fifo(&fifo);
    let reader = std::thread::spawn({
        let fifo = fifo.clone();
        move || fs::read(fifo).expect("the pipe is read")
    });
    written(&fifo);
    assert!(body(&reader.join().expect("the reader ends")) == body(&whole));
    assert_eq!(folder.names(), ["dangling.oct", "fifo", "link.oct", "new.oct", "real.oct", "room.rad"]);
}

fn make_fifo(path: &str) {
    let made = Command::new("mkfifo").arg(path).status().expect("mkfifo runs");
    assert!(made.success());
}

#[test]
fn a_file_keeps_its_mode_and_a_new_one_has_that_of_the_umask() {
    let folder = room();
    folder.file("a.oct", "old");
    fs::set_permissions(folder.path("a.oct"), fs::Permissions::from_mode(0o604)).expect("the mode is set");
    run(&folder, &["oconv", "-o", "a.oct", "room.rad"]).done();
    bash(&folder, "umask 027; \"$R\" oconv -o b.oct room.rad").done();
    let mode = |name: &str| fs::metadata(folder.path(name)).expect("it is there").mode() & 0o777;
    assert_eq!((mode("a.oct"), mode("b.oct")), (0o604, 0o640));
}

/// Programs with words that make them write to standard output, and their input.
fn writers() -> Vec<(Vec<&'static str>, &'static [u8])> {
    let words = |line: &'static str| line.split(' ').collect::<Vec<_>>();
    let named = [
        "rpict -vp 0 -3 1 -x 8 -y 8 room.rad",
        "rpict -o /dev/full -vp 0 -3 1 -x 8 -y 8 room.rad",
        "oconv room.rad",
        "vwrays -x 8 -y 8",
        "vwrays -d -x 8 -y 8",
        "genbox m n 1 1 1",
        "gensky 6 21 12",
        "gendaylit 6 21 12 -W 100 100",
        "xform room.rad",
        "getbbox room.rad",
        "cnt 5",
        "cnt 500000",
        "pfilt p.hdr",
        "pvalue p.hdr",
        "getinfo p.hdr",
        "pcomb p.hdr",
        "pcompos p.hdr 0 0",
        "pflip -h p.hdr",
        "protate p.hdr",
        "pextrem p.hdr",
        "pcond p.hdr",
        "falsecolor -i p.hdr",
        "ra_xyze p.hdr",
        "ra_tiff p.hdr /dev/full",
        "ra_tiff p.hdr /dev/stdout",
        "ra_ppm p.hdr",
        "ra_bmp p.hdr",
        "ra_rgbe p.hdr",
        "rmtxop p.hdr",
        "rcomb p.hdr",
        "psign -h 10 abc",
        "rpict -defaults",
        "rtrace -defaults",
        "rpict -version",
        "check room.rad",
        "--help",
        "--version",
        "rad -n a.rif",
    ];
    let piped: [(&str, &[u8]); 8] = [
        ("rtrace room.rad", b"0 -3 1 0 1 0\n"),
        ("rcontrib -m lamp room.rad", b"0 -3 1 0 1 0\n"),
        ("rcalc -e $1=$1", b"1\n2\n"),
        ("total", b"1\n2\n"),
        ("histo 0 4 4", b"1\n2\n"),
        ("rlam -", b"1\n2\n"),
        ("rcollate -h -fa1 -ic 1 -oc 2", b"1\n2\n"),
        ("rsplit -", b"1\n2\n"),
    ];
    named
        .into_iter()
        .map(|line| (words(line), &b""[..]))
        .chain(piped.map(|(line, input)| (words(line), input)))
        .collect()
}

fn bench() -> Folder {
    let folder = room();
    folder.file("a.rif", "OCTREE= a.oct\nscene= room.rad\nZONE= I -4 4 0 8 0 3\nRES= 8\nview= def -vp 0 -3 1\n");
    run(&folder, &["rpict", "-vp", "0", "-3", "1", "-x", "16", "-y", "16", "-o", "p.hdr", "room.rad"]).done();
    folder
}

#[test]
fn a_full_disk_is_a_fault_in_every_program() {
    let folder = bench();
    for (words, input) in writers() {
        let mut command = in_folder(&folder, &words);
        let full = fs::File::options().write(true).open("/dev/full").expect("the device is there");
        let mut child = command.stdin(Stdio::piped()).stdout(full).spawn().expect("the program starts");
        let mut pipe = child.stdin.take().expect("it is piped");
        let _ = std::io::Write::write_all(&mut pipe, input);
        drop(pipe);
        let output = child.wait_with_output().expect("the program ends");
        let messages = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{words:?}: {messages}");
        assert!(messages.contains("no space left on device"), "{words:?}: {messages}");
    }
    assert!(!folder.names().iter().any(|name| name.starts_with('.')), "nothing is left over");
}

#[test]
fn a_closed_pipe_is_success_in_every_program() {
    let folder = bench();
    for (words, input) in writers().into_iter().filter(|(words, _)| !words.contains(&"/dev/full")) {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let mut command = in_folder(&folder, &words);
        let mut child = command.stdin(Stdio::piped()).stdout(writer).spawn().expect("the program starts");
        let mut pipe = child.stdin.take().expect("it is piped");
        let _ = std::io::Write::write_all(&mut pipe, input);
        drop(pipe);
        let output = child.wait_with_output().expect("the program ends");
        let messages = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{words:?}: {messages}");
    }
}

#[test]
fn an_existing_picture_is_not_gone_over() {
    let folder = room();
    folder.file("p.hdr", "mine");
    let refused = run(&folder, &rpict(&["-x", "8", "-y", "8", "-o", "p.hdr"]));
    assert_eq!(refused.code, 1);
    assert!(refused.messages.contains("it exists"), "{}", refused.messages);
    assert_eq!(folder.read("p.hdr"), b"mine");
}
