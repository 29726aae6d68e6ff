//! Wrong input and wrong command lines: one clear message, the right exit code, and no half-written
//! file.

use crate::program::{Folder, Run, command, gripps, run_with};
use std::io::Read;

/// Exit code of wrong input.
const INPUT: i32 = 1;
/// Exit code of a wrong command line.
const USAGE: i32 = 2;
/// Exit code of a limit or a fault.
const FAULT: i32 = 3;

const CAMERA: &str = r#"[camera]
position_m = [0.0, 0.0, 0.48]
direction = [0.0, 0.0, -1.0]
up = [0.0, 1.0, 0.0]
pixels = [8, 6]
pixel_pitch_um = [330.0, 440.0]
focal_distance_mm = 6.75
pinhole_diameter_mm = 0.1
pinhole_model = "point"
exposure_ms = 10.0
wavelength_nm = 650.0

[rig]
leds = 12
ring_diameter_mm = 25.4
led_diameter_mm = 5.0
led_intensity_w_per_sr = 0.055
led_table = "table.csv"

[sensor]
response = "power-law"
k = 33844.0
gamma = 0.85
grey_background = 12
grey_max = 161
exposure_unit = "uJ/cm2"
bits = 8
"#;

/// The result of `--samples 1` for valid input, and its path.
const QUICK: [&str; 4] = ["--samples", "1", "-o", "out.png"];

/// A folder with valid input, and an older output that must survive.
struct Bench(Folder);

impl Bench {
    fn new() -> Bench {
        let folder = Folder::new();
        folder.file("camera.toml", CAMERA);
        folder.file("table.csv", std::fs::read(gripps("hlmp-8104.csv")).expect("the table is read"));
        folder.file("sheet.rad", std::fs::read(gripps("sheet-retro.rad")).expect("the sheet is read"));
        folder.file("out.png", OLDER);
        Bench(folder)
    }

    /// The bench with one more file.
    fn with(name: &str, text: impl AsRef<[u8]>) -> Bench {
        let bench = Bench::new();
        bench.0.file(name, text);
        bench
    }

    /// The bench with a camera file `bad.toml` in which one text is replaced.
    fn with_camera(good: &str, bad: &str) -> Bench {
        assert!(CAMERA.contains(good), "the camera file has {good}");
        Bench::with("bad.toml", CAMERA.replace(good, bad))
    }

    /// The bench with a scene file `bad.rad`.
    fn with_scene(text: impl AsRef<[u8]>) -> Bench {
        Bench::with("bad.rad", text)
    }

    fn run(&self, words: &[&str], input: &[u8]) -> Run {
        let before = self.0.names();
        let run = run_with(command(words).current_dir(self.0.path("")), input);
        assert_eq!(self.0.names(), before, "no file appears or goes");
        assert_eq!(self.0.read("out.png"), OLDER.as_bytes(), "the older output is as it was");
        run
    }

    /// Runs and compares exit code and the whole message.
    #[track_caller]
    fn refuses(&self, words: &[&str], code: i32, message: &str) {
        self.refuses_with(words, b"", code, message);
    }

    /// The same with something on standard input.
    #[track_caller]
    fn refuses_with(&self, words: &[&str], input: &[u8], code: i32, message: &str) {
        let run = self.run(words, input);
        assert_eq!(run.messages.trim_end(), message.trim_end());
        assert_eq!(run.code, code);
    }

    /// Captures with a camera and a scene, as in `refuses`.
    #[track_caller]
    fn refuses_capture(&self, camera: &str, scene: &str, message: &str) {
        self.refuses(&[&["capture", camera, scene], &QUICK[..]].concat(), INPUT, message);
    }
}

const OLDER: &str = "an older picture";

#[test]
fn the_bench_is_good_input() {
    let bench = Bench::new();
    let run = run_with(
        command(&["capture", "camera.toml", "sheet.rad", "--samples", "1", "-o", "new.png"])
            .current_dir(bench.0.path("")),
        b"",
    );
    assert_eq!((run.code, run.messages.as_str()), (0, ""));
    assert_eq!(bench.0.names(), ["camera.toml", "new.png", "out.png", "sheet.rad", "table.csv"]);
}

#[test]
fn missing_files() {
    let bench = Bench::with_camera("table.csv", "nowhere.csv");
    let none = "no such file or directory";
    bench.refuses_capture(
        "none.toml",
        "sheet.rad",
        &format!("radsight: cannot read camera file \"none.toml\": {none}"),
    );
    bench.refuses_capture("camera.toml", "none.rad", &format!("radsight: cannot read scene file \"none.rad\": {none}"));
    bench.refuses(
        &["pinhole", "shift", "camera.toml", "none.hdr"],
        INPUT,
        &format!("radsight: cannot read picture \"none.hdr\": {none}"),
    );
    bench.refuses_capture(
        "bad.toml",
        "sheet.rad",
        "bad.toml:18:13: error: cannot find file \"nowhere.csv\"
  18 | led_table = \"nowhere.csv\"
     |             ^^^^^^^^^^^^^",
    );
}

#[test]
fn folders_in_place_of_files() {
    let bench = Bench::new();
    bench.refuses_capture(".", "sheet.rad", "radsight: cannot read camera file \".\": it is a folder");
    bench.refuses_capture("camera.toml", ".", "radsight: cannot read scene file \".\": it is a folder");
}

#[cfg(unix)]
#[test]
fn a_file_that_may_not_be_read() {
    use std::os::unix::fs::PermissionsExt;
    let bench = Bench::with_scene("void plastic p 0 0 5 1 1 1 0 0\n");
    let path = bench.0.path("bad.rad");
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o000)).expect("the mode is set");
    if std::fs::read(&path).is_ok() {
        println!("skipped: this user may read everything");
        return;
    }
    bench.refuses_capture("camera.toml", "bad.rad", "radsight: cannot read scene file \"bad.rad\": permission denied");
}

#[test]
fn an_undefined_modifier() {
    let bench = Bench::with_scene("void plastic chrome1 0 0 5 1 1 1 0 0\nchrome sphere ball 0 0 4 0 0 0 .1\n");
    bench.refuses_capture(
        "camera.toml",
        "bad.rad",
        "bad.rad:2:1: error: undefined modifier \"chrome\"
  2 | chrome sphere ball 0 0 4 0 0 0 .1
    | ^^^^^^
hint: did you mean \"chrome1\"?",
    );
}

#[test]
fn a_wrong_number_of_arguments() {
    let bench = Bench::with_scene("void plastic white 0 0 5 1 1 1 0 0\nwhite sphere ball\n0 0 3 0 0 0\n");
    bench.refuses_capture(
        "camera.toml",
        "bad.rad",
        "bad.rad:3:5: error: sphere \"ball\" has 3 real arguments, expected 4
  3 | 0 0 3 0 0 0
    |     ^
hint: the real arguments are x, y, z, radius",
    );
}

#[test]
fn a_material_with_a_wrong_number_of_arguments_that_a_surface_wears() {
    let bench = Bench::with_scene("void plastic white 0 0 4 1 1 1 0\nwhite sphere ball 0 0 4 0 0 0 .1\n");
    let run = bench.run(&[&["capture", "camera.toml", "bad.rad"], &QUICK[..]].concat(), b"");
    assert_eq!(run.code, INPUT);
    let message =
        "error: a ray hit \"ball\", whose material cannot be used: plastic \"white\" has 4 real arguments, expected 5";
    assert!(run.messages.contains(message), "{}", run.messages);
}

#[test]
fn a_camera_key_with_a_typo() {
    let bench = Bench::with_camera("focal_distance_mm", "focal_distnace_mm");
    bench.refuses_capture(
        "bad.toml",
        "sheet.rad",
        "bad.toml:7:1: error: unknown key \"focal_distnace_mm\" in [camera]
  7 | focal_distnace_mm = 6.75
    | ^^^^^^^^^^^^^^^^^
hint: did you mean \"focal_distance_mm\"?",
    );
}

#[test]
fn a_negative_diameter() {
    let bench = Bench::with_camera("pinhole_diameter_mm = 0.1", "pinhole_diameter_mm = -0.1");
    bench.refuses_capture(
        "bad.toml",
        "sheet.rad",
        "bad.toml:8:23: error: \"pinhole_diameter_mm\" must be positive, not -0.1
  8 | pinhole_diameter_mm = -0.1
    |                       ^^^^",
    );
}

#[test]
fn all_the_mistakes_of_a_camera_file_at_once() {
    let bench = Bench::new();
    let text = CAMERA.replace("6.75", "0").replace("gamma = 0.85", "gamma = \"steep\"").replace("[8, 6]", "[8]");
    bench.0.file("bad.toml", text);
    let run = bench.run(&[&["capture", "bad.toml", "sheet.rad"], &QUICK[..]].concat(), b"");
    assert_eq!(run.code, INPUT);
    for line in ["bad.toml:5:", "bad.toml:7:", "bad.toml:23:"] {
        assert!(run.messages.contains(line), "{line} in {}", run.messages);
    }
}

#[test]
fn a_nan_in_a_table() {
    let bench = Bench::with("table.csv", "angle_deg,relative_intensity\n0,1\n4,nan\n90,0\n");
    bench.refuses_capture(
        "camera.toml",
        "sheet.rad",
        "table.csv:3:3: error: relative_intensity is nan, expected a finite number
  3 | 4,nan
    |   ^^^
  from camera.toml:18:13",
    );
}

#[test]
fn an_empty_scene() {
    let bench = Bench::with_scene("# nothing but words\n");
    let run = bench.run(&[&["capture", "camera.toml", "bad.rad"], &QUICK[..]].concat(), b"");
    assert_eq!(run.code, INPUT);
    assert!(run.messages.ends_with("radsight: the scene is empty: nothing that a ray could hit\n"), "{}", run.messages);
}

#[test]
fn a_scene_without_light() {
    let bench = Bench::new();
    let (ring, sensor) = (CAMERA.find("[rig]").expect("a ring"), CAMERA.find("[sensor]").expect("a sensor"));
    bench.0.file("dark.toml", format!("{}{}", &CAMERA[..ring], &CAMERA[sensor..]));
    bench.refuses_capture(
        "dark.toml",
        "sheet.rad",
        "radsight: the scene has no light: nothing in it emits, and the camera file has no [rig]",
    );
    bench.refuses(&["rig", "dark.toml"], INPUT, "radsight: \"dark.toml\" has no [rig]");
}

#[test]
fn a_camera_without_sensor() {
    let bench = Bench::new();
    bench.0.file("blind.toml", &CAMERA[..CAMERA.find("[sensor]").expect("a sensor")]);
    bench.refuses_capture(
        "blind.toml",
        "sheet.rad",
        "radsight: \"blind.toml\" has no [sensor], expected one for a grey picture (or only --exposure)",
    );
    bench.refuses(&["sensor", "blind.toml"], INPUT, "radsight: \"blind.toml\" has no [sensor]");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk() {
    let bench = Bench::new();
    let full = "no space left on device";
    let capture = ["capture", "camera.toml", "sheet.rad", "--samples", "1", "-o", "/dev/full"];
    bench.refuses(&capture, FAULT, &format!("radsight: cannot write \"/dev/full\": {full}"));
    let stages: [&[&str]; 4] = [
        &["rig", "camera.toml"],
        &["check", "sheet.rad"],
        &["pinhole", "rays", "camera.toml", "--samples", "2"],
        &["rtrace", "sheet.rad"],
    ];
    for words in stages {
        let device = std::fs::File::options().write(true).open("/dev/full").expect("the full disk");
        let output = command(words).current_dir(bench.0.path("")).stdout(device).output().expect("the program runs");
        let messages = String::from_utf8_lossy(&output.stderr);
        assert_eq!(messages.trim_end(), format!("radsight: cannot write standard output: {full}"), "{words:?}");
        assert_eq!(output.status.code(), Some(FAULT), "{words:?}");
    }
}

#[test]
fn an_output_that_cannot_be() {
    let bench = Bench::new();
    let folder = bench.0.word("");
    let mut words = ["capture", "camera.toml", "sheet.rad", "--samples", "1", "-o", &folder];
    bench.refuses(&words, FAULT, &format!("radsight: cannot write \"{folder}\": it is a folder"));
    words[6] = "nowhere/out.png";
    bench.refuses(&words, FAULT, "radsight: cannot write \"nowhere/out.png\": no such file or directory");
    words[6] = "sheet.rad/out.png";
    bench.refuses(&words, FAULT, "radsight: cannot write \"sheet.rad/out.png\": not in a folder");
}

/// Reads the start of a program's output, closes the pipe, and returns exit code and messages.
fn read_a_little(mut command: std::process::Command) -> (Option<i32>, String) {
    let mut child = command.spawn().expect("the program starts");
    let mut pipe = child.stdout.take().expect("a pipe");
    pipe.read_exact(&mut [0; 64]).expect("the program writes something");
    drop(pipe);
    let output = child.wait_with_output().expect("the program ends");
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn a_closed_pipe_is_success() {
    let bench = Bench::new();
    let in_folder = |words: &[&str]| {
        let mut command = command(words);
        command.current_dir(bench.0.path(""));
        command
    };
    let rays = ["pinhole", "rays", "camera.toml", "--samples", "30000"];
    assert_eq!(read_a_little(in_folder(&rays)), (Some(0), String::new()));

    let mut source = in_folder(&rays).spawn().expect("the program starts");
    let mut trace = in_folder(&["rtrace", "-h", "-fda", "sheet.rad"]);
    trace.stdin(source.stdout.take().expect("a pipe"));
    assert_eq!(read_a_little(trace), (Some(0), String::new()));
    // Its reader has ended as well, for the same reason.
    assert_eq!(source.wait().expect("the program ends").code(), Some(0));
}

#[cfg(unix)]
#[test]
fn an_output_that_nobody_reads_at_all_is_success() {
    let bench = Bench::new();
    for words in [&["rig", "camera.toml"][..], &["check", "sheet.rad"], &["explain", "camera.toml", "sheet.rad"]] {
        let mut child = command(words).current_dir(bench.0.path("")).spawn().expect("the program starts");
        drop(child.stdout.take());
        drop(child.stderr.take());
        assert_eq!(child.wait().expect("the program ends").code(), Some(0), "{words:?}");
    }
}

#[test]
fn warnings_that_nobody_reads_are_no_fault() {
    let bench = Bench::with_scene("void plastic unused 0 0 4 1 1 1 0\n");
    let words = ["capture", "camera.toml", "bad.rad", "sheet.rad", "--samples", "1", "-o", "new.png"];
    let mut child = command(&words).current_dir(bench.0.path("")).spawn().expect("the program starts");
    drop(child.stderr.take());
    assert_eq!(child.wait().expect("the program ends").code(), Some(0));
    assert!(bench.0.names().contains(&"new.png".to_owned()));
}

#[test]
fn an_unknown_subcommand() {
    let run = Bench::new().run(&["captrue"], b"");
    assert_eq!(run.code, USAGE);
    assert!(run.messages.starts_with("error: unrecognized subcommand 'captrue'\n"), "{}", run.messages);
    assert!(run.messages.contains("tip: a similar subcommand exists: 'capture'"), "{}", run.messages);
}

#[test]
fn unknown_and_missing_options() {
    let bench = Bench::new();
    let cases: [(&[&str], &str); 5] = [
        (&["capture", "camera.toml", "sheet.rad", "--wrong"], "error: unexpected argument '--wrong' found"),
        (&["capture", "camera.toml", "sheet.rad"], "error: the following required arguments were not provided"),
        (&["check"], "error: the following required arguments were not provided"),
        (&["pinhole", "rays", "camera.toml"], "error: the following required arguments were not provided"),
        (&["sensor", "camera.toml", "--seed", "-1"], "error: unexpected argument '-1' found"),
    ];
    for (words, message) in cases {
        let run = bench.run(words, b"");
        assert!(run.messages.starts_with(message), "{words:?}: {}", run.messages);
        assert_eq!(run.code, USAGE, "{words:?}");
    }
}

#[test]
fn wrong_numbers_on_the_command_line() {
    let bench = Bench::new();
    let capture = |extra: &[&'static str], message: &str| {
        let words = [&["capture", "camera.toml", "sheet.rad", "-o", "out.png"], extra].concat();
        bench.refuses(&words, USAGE, message);
    };
    capture(&["--samples", "0"], "radsight: option \"--samples\" is 0, expected at least 1");
    capture(&["--threads", "0"], "radsight: option \"--threads\" is 0, expected at least 1");
    capture(&["--error", "0"], "radsight: option \"--error\" is 0, expected a relative error above 0, such as 0.005");
    capture(
        &["--error", "nan"],
        "radsight: option \"--error\" is NaN, expected a relative error above 0, such as 0.005",
    );
    capture(
        &["-ab", "many"],
        "radsight: option \"-ab\" is followed by \"many\", expected a number of bounces, 0 or more",
    );
    capture(
        &["-dr"],
        "radsight: option \"-dr\" ends the command line, expected a depth of virtual sources, 0 or more after it",
    );
    let words = ["capture", "camera.toml", "sheet.rad", "-o", "out.png", "--samples", "few"];
    let run = bench.run(&words, b"");
    assert!(run.messages.starts_with("error: invalid value 'few' for '--samples <N>'"), "{}", run.messages);
    assert_eq!(run.code, USAGE);
    let rays = |extra: &[&'static str], message: &str| {
        bench.refuses(&[&["pinhole", "rays", "camera.toml"], extra].concat(), USAGE, message);
    };
    rays(&["--samples", "0"], "radsight: option \"--samples\" is 0, expected at least 1");
    rays(&["--samples", "1", "-fx"], "radsight: option \"-fx\": expected -fa, -ff or -fd");
}

#[test]
fn rtrace_options() {
    let bench = Bench::new();
    let none = "radsight: rtrace: no scene is given, expected scene files after the options";
    bench.refuses(&["rtrace"], USAGE, none);
    bench.refuses(&["rtrace", "-h", "-n", "2"], USAGE, none);
    let unknown = "radsight: rtrace: option \"-zz\" is not supported\nhint: \"rtrace --help\" lists the options";
    bench.refuses(&["rtrace", "-zz", "sheet.rad"], USAGE, unknown);
    let letters = "expected -f, one of a, f, d, and one of a, f, d, c";
    bench.refuses(&["rtrace", "-fq", "sheet.rad"], USAGE, &format!("radsight: rtrace: option \"-fq\": {letters}"));
    bench.refuses(&["rtrace", "-faaa", "sheet.rad"], USAGE, &format!("radsight: rtrace: option \"-faaa\": {letters}"));
    let run = bench.run(&["rtrace", "-oq", "sheet.rad"], b"");
    assert!(run.messages.starts_with("radsight: rtrace: \"q\" of \"-oq\" is not an output"), "{}", run.messages);
    assert_eq!(run.code, USAGE);
    bench.refuses(
        &["rtrace", "none.rad"],
        INPUT,
        "radsight: cannot read scene file \"none.rad\": no such file or directory",
    );
}

#[test]
fn a_ray_stream_that_is_wrong() {
    let bench = Bench::new();
    let trace = |input: &str| bench.run(&["rtrace", "-h", "-oL", "sheet.rad"], input.as_bytes());

    let short = trace("0 0 1 0 0 -1\n0 0 1 0");
    assert_eq!(short.code, INPUT);
    assert!(short.messages.trim_end().ends_with("the stream ends after 4 of 6 numbers"), "{}", short.messages);
    assert_eq!(String::from_utf8_lossy(&short.output).trim(), "1.000000e+00", "the rays before are answered");

    let nan = trace("0 0 1 0 nan -1\n");
    assert_eq!(nan.code, INPUT);
    assert!(nan.messages.trim_end().ends_with("number 5 is NaN, expected a finite one"), "{}", nan.messages);

    let word = trace("0 0 1 0 zero -1\n");
    assert_eq!(word.code, INPUT);
    assert!(word.messages.trim_end().ends_with("\"zero\" is not a number"), "{}", word.messages);

    let half = bench.run(&["rtrace", "-h", "-fda", "sheet.rad"], &[0; 51]);
    assert_eq!(half.code, INPUT);
    assert!(half.messages.contains("the stream ends within a number (3 of 8 bytes)"), "{}", half.messages);
}

#[test]
fn a_radiance_stream_that_does_not_fit_the_rays() {
    let bench = Bench::new();
    let average = |words: &[&str], input: &[u8]| {
        let run = bench.run(&[&["pinhole", "average", "camera.toml", "--samples", "2"], words].concat(), input);
        assert_eq!(run.code, INPUT, "{}", run.messages);
        assert!(run.output.is_empty(), "no half of a matrix");
        run.messages
    };
    // 8 × 6 pixels, 2 rays each, 3 bands.
    let whole = 8 * 6 * 2 * 3 * 8;
    let short = average(&[], &vec![0; whole - 24]);
    assert!(short.contains("the stream ended after 95 of 96 radiances"), "{short}");
    let long = average(&[], &vec![0; whole + 24]);
    assert!(long.starts_with("radsight: standard input: "), "{long}");
    let nan: Vec<u8> = [vec![0; 80], f64::NAN.to_ne_bytes().to_vec(), vec![0; whole - 88]].concat();
    let nan = average(&[], &nan);
    assert!(nan.starts_with("radsight: standard input: ") && nan.contains("NaN"), "{nan}");
}

#[test]
fn an_exposure_that_is_none() {
    let bench = Bench::new();
    let sensor = |input: &[u8]| {
        let run = bench.run(&["sensor", "camera.toml"], input);
        assert_eq!(run.code, INPUT, "{}", run.messages);
        assert!(run.output.is_empty(), "no half of a picture");
        run.messages
    };
    assert!(sensor(b"").starts_with("radsight: standard input is not an exposure: "));
    assert!(sensor(&[7; 5000]).starts_with("radsight: standard input is not an exposure: "));
    let matrix = |values: &[f32]| {
        let mut bytes = b"#?RADIANCE\nNROWS=1\nNCOLS=2\nNCOMP=1\nFORMAT=float\n\n".to_vec();
        values.iter().for_each(|value| bytes.extend(value.to_ne_bytes()));
        bytes
    };
    assert!(sensor(&matrix(&[1e-6, f32::NAN])).contains("the exposure has the value NaN"));
    assert!(sensor(&matrix(&[1e-6, -1e-6])).contains("the exposure has the value -0.000001"));
    assert!(sensor(&matrix(&[1e-6])).starts_with("radsight: standard input is not an exposure: "));
}

#[test]
fn an_unknown_command_in_a_scene() {
    let bench = Bench::with_scene("!frobnicate 3\n");
    let message = "bad.rad:1:2: error: refused to run \"frobnicate 3\": a scene file is input, not a program
  1 | !frobnicate 3
    |  ^^^^^^^^^^
hint: external commands run only with --allow-commands";
    bench.refuses_capture("camera.toml", "bad.rad", message);
    bench.refuses(&["check", "bad.rad"], INPUT, message);
    bench.refuses(&["rtrace", "bad.rad"], INPUT, message);
}

#[test]
fn garbage_in_place_of_text() {
    let garbage: Vec<u8> = (0u32..4000).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    let bench = Bench::with_scene(&garbage);
    bench.0.file("bad.toml", &garbage);
    for words in [["check", "bad.rad"], ["rtrace", "bad.rad"], ["rig", "bad.toml"]] {
        let run = bench.run(&words, b"");
        assert_eq!(run.code, INPUT, "{words:?}");
        assert!(run.messages.starts_with(&format!("{}:", words[1])), "{words:?}: {}", run.messages);
        let is_plain = |c: char| c == '\n' || !c.is_control();
        assert!(run.messages.chars().all(is_plain), "a terminal is not told to do anything: {:?}", run.messages);
        assert!(run.messages.len() < 20_000, "the messages are short");
    }
}

#[test]
fn a_plugin_that_is_not_there() {
    let bench = Bench::with_scene(
        "void brdfplugin sheeting\n2 nolib_of_that_name bead_sheet\n0\n1 .5\nsheeting sphere ball 0 0 4 0 0 0 .1\n",
    );
    let run = bench.run(&[&["capture", "camera.toml", "bad.rad"], &QUICK[..]].concat(), b"");
    let message = "bad.rad:2:3: error: cannot find plugin library \"nolib_of_that_name\" in ";
    assert!(run.messages.starts_with(message), "{}", run.messages);
    assert_eq!(run.code, INPUT);
}

#[test]
fn check_tells_all_the_mistakes_of_a_scene() {
    let bench = Bench::with_scene(
        "one sphere a 0 0 4 0 0 0 1\nvoid plastic p 0 0 5 1 1 1 0 0\np sphere b 0 0 4 0 0 0 0\np shpere c 0 0 4 0 0 0 1\n",
    );
    let run = bench.run(&["check", "bad.rad"], b"");
    assert_eq!(run.code, INPUT);
    for part in ["bad.rad:1:1: error: undefined modifier \"one\"", "bad.rad:3:", "unknown type \"shpere\""] {
        assert!(run.messages.contains(part), "{part} in {}", run.messages);
    }
}
