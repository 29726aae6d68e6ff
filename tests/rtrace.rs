//! `rtrace`: what it says of rays, in which form, against real Radiance's.

mod program;
mod real_radiance;

use program::{Folder, command, run_with};
use real_radiance::Radiance;

const SCENE: &str = "
void brightfunc stripes 2 if(Px,1,.5) . 0 0
stripes plastic grey 0 0 5 .5 .4 .3 0 0
void light lamp 0 0 3 10 10 10
void glow sky 0 0 4 .1 .2 .3 0
lamp sphere bulb 0 0 4 0 5 3 .5
grey polygon floor 0 0 12 -10 0 0 10 0 0 10 20 0 -10 20 0
sky source dome 0 0 4 0 0 1 180
";

const RAYS: &str =
    "0 0 2 0 1 -.3\n0 0 1 .1 1 -.1\n0 0 2 .1 0 1\n0 0 2 0 5 1\n0 2 3 0 0 0\n.1 1 2 0 .1 -1\n0 0 2 0 -1 -.1\n";

/// The header without what differs from run to run, and the rest as it is.
fn parts(bytes: &[u8]) -> (Vec<String>, Vec<u8>) {
    let end = bytes.windows(2).position(|pair| pair == b"\n\n").map_or(0, |at| at + 2);
    let differs = ["oconv", "SOFTWARE=", "GMT=", "CAPDATE=", "rtrace"];
    let header = String::from_utf8_lossy(&bytes[..end]).into_owned();
    let lines = header.lines().filter(|line| !differs.iter().any(|start| line.starts_with(start)));
    (lines.map(str::to_owned).collect(), bytes[end..].to_vec())
}

fn both(radiance: &Radiance, words: &[&str], input: &str) -> [Vec<u8>; 2] {
    let folder = Folder::new();
    folder.file("scene.rad", SCENE);
    let octree = radiance.octree(&folder, &["scene.rad"]);
    let ours = [&["rtrace", "--samples", "1024"], words, &["scene.rad"]].concat();
    let ours = run_with(command(&ours).current_dir(folder.path("")), input.as_bytes()).done();
    let theirs = [&["-w-", "-ds", ".02"], words, &[&octree]].concat();
    let mut theirs = radiance.command("rtrace", &theirs);
    [ours, run_with(theirs.current_dir(folder.path("")), input.as_bytes()).done()]
}

/// Compares texts word for word, numbers to a share of them.
#[track_caller]
fn same_words(ours: &[u8], theirs: &[u8], what: &[&str]) {
    let [ours, theirs] = [ours, theirs].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    assert_eq!(ours.lines().count(), theirs.lines().count(), "{what:?}:\n{ours}{theirs}");
    for (our_line, their_line) in ours.lines().zip(theirs.lines()) {
        let [ours, theirs] = [our_line, their_line].map(|line| line.split('\t').collect::<Vec<_>>());
        let same = |(ours, theirs): (&&str, &&str)| match (ours.parse::<f64>(), theirs.parse::<f64>()) {
            (Ok(ours), Ok(theirs)) => (ours - theirs).abs() <= 1e-9 + 1e-3 * theirs.abs(),
            _ => ours == theirs,
        };
        let is_same = ours.len() == theirs.len() && ours.iter().zip(&theirs).all(same);
        assert!(is_same, "{what:?}:\n{our_line}\n{their_line}");
    }
}

#[test]
fn every_output_says_what_real_rtrace_says() {
    let Some(radiance) = Radiance::find() else { return };
    let cases: [&[&str]; 16] = [
        &["-odoLlcpNnsmMw~"],
        &["-ovl"],
        &["-oLsmM"],
        &["-oW", "-w-"],
        &["-ovL", "-ld+"],
        &["-oLp", "-ld"],
        &["-pXYZ"],
        &["-pY", "-ovL"],
        &["-pS"],
        &["-pM"],
        &["-pA"],
        &["-pc", ".7", ".3", ".2", ".7", ".14", ".05", ".3127", ".329"],
        &["-I"],
        &["-h"],
        &["-x", "3", "-y", "2"],
        &["-h-", "-x", "2"],
    ];
    for words in cases {
        // A ray without direction has no record of its own in real Radiance: its point is left from the ray before.
        let input: String =
            RAYS.lines().filter(|line| !line.ends_with("0 0 0")).map(|line| format!("{line}\n")).collect();
        let [ours, theirs] = both(&radiance, words, &input);
        let (our_header, ours) = parts(&ours);
        let (their_header, theirs) = parts(&theirs);
        assert_eq!(our_header, their_header, "{words:?}");
        same_words(&ours, &theirs, words);
    }
}

#[test]
fn pixels_are_those_of_real_rtrace() {
    let Some(radiance) = Radiance::find() else { return };
    for words in [
        &["-fac"][..],
        &["-fac", "-pXYZ"],
        &["-fac", "-x", "7", "-y", "1"],
        &["-fac", "-cs", "9", "-co+", "-x", "7", "-y", "1"],
        &["-fac", "-cs", "9"],
    ] {
        let [ours, theirs] = both(&radiance, words, RAYS).map(|bytes| parts(&bytes));
        assert_eq!(ours.0, theirs.0, "{words:?}");
        assert_eq!(ours.1.len(), theirs.1.len(), "{words:?}");
        let apart = ours.1.iter().zip(&theirs.1).map(|(ours, theirs)| ours.abs_diff(*theirs)).max();
        assert!(apart <= Some(1), "{words:?}: bytes differ by {apart:?}");
    }
}

#[test]
fn rays_end_behind_glass_too() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    let pane = "void glass clear 0 0 3 .9 .9 .9\nclear polygon pane 0 0 12 -9 1 -9  9 1 -9  9 1 9  -9 1 9\n";
    folder.file(
        "scene.rad",
        format!("{pane}void glow sky 0 0 4 4 3 2 0\nsky polygon beyond 0 0 12 -9 3 -9  -9 3 9  9 3 9  9 3 -9\n"),
    );
    let octree = radiance.octree(&folder, &["scene.rad"]);
    for direction in ["0 .5 0", "0 2 0", "0 4 0"] {
        let input = format!("0 0 0 {direction}\n");
        let words = ["-h", "-ld+", "-ovL", &octree];
        let real = run_with(radiance.command("rtrace", &words).current_dir(folder.path("")), input.as_bytes()).done();
        let ours: Vec<&str> = std::iter::once("rtrace").chain(words).collect();
        let ours = run_with(command(&ours).current_dir(folder.path("")), input.as_bytes()).done();
        same_words(&ours, &real, &[direction]);
    }
}

#[test]
fn a_command_may_stand_for_the_scene() {
    let folder = Folder::new();
    folder.file("scene.rad", SCENE);
    let run = |scene: &str| {
        let words = ["rtrace", "-oL", scene];
        run_with(command(&words).current_dir(folder.path("")), RAYS.as_bytes())
    };
    let [of_command, of_file] = ["!cat scene.rad", "scene.rad"].map(|scene| parts(&run(scene).done()));
    assert_eq!(of_command.1, of_file.1);
    assert!(of_command.0.contains(&"cat scene.rad".to_owned()), "{:?}", of_command.0);
    let failed = run("!exit 3");
    assert!(failed.code == 1 && failed.messages.contains("command \"exit 3\""), "{}", failed.messages);
}

#[test]
fn modifiers_from_a_file_take_part_in_interreflection_or_do_not() {
    let folder = Folder::new();
    folder.file("scene.rad", "void glow sky 0 0 4 1 1 1 0\nsky source dome 0 0 4 0 0 1 360\nvoid plastic grey 0 0 5 .5 .5 .5 0 0\ngrey ring floor 0 0 8 0 0 0 0 0 1 0 9\n");
    folder.file("names.txt", "other\n\"grey\"\n");
    let value = |option: &str| {
        let words = ["rtrace", "-h", "-ab", "1", "-av", ".2", ".2", ".2", option, "names.txt", "scene.rad"];
        let text = run_with(command(&words).current_dir(folder.path("")), b"0 0 1 0 0 -1\n").text();
        text.split_whitespace().next().and_then(|word| word.parse::<f64>().ok()).expect("a number")
    };
    assert!((value("-aI") - 0.5).abs() < 1e-3 && (value("-aE") - 0.1).abs() < 1e-6);
}

#[test]
fn more_samples_make_highlights_less_noisy() {
    let folder = Folder::new();
    let stripes = "void brightfunc stripes 2 if(sin(9*Dx)*sin(9*Dy),2,0) . 0 0\nstripes glow sky 0 0 4 1 1 1 0\nsky source dome 0 0 4 0 0 1 180\n";
    folder.file(
        "scene.rad",
        format!("{stripes}void metal rough 0 0 5 .8 .8 .8 1 .2\nrough ring floor 0 0 8 0 0 0 0 0 1 0 9\n"),
    );
    let rays = "0 0 1 .2 .1 -1\n".repeat(400);
    let spread = |samples: &str| {
        let words = ["rtrace", "-h", "-st", "0", "-ss", samples, "scene.rad"];
        let text = run_with(command(&words).current_dir(folder.path("")), rays.as_bytes()).text();
        let values = text.lines().filter_map(|line| line.split_whitespace().next()?.parse::<f64>().ok());
        let values: Vec<f64> = values.collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64;
        (mean, variance.sqrt())
    };
    let [(one, one_spread), (many, many_spread)] = [spread("1"), spread("16")];
    assert!((one - many).abs() < 0.1 * many, "{one} with one, {many} with sixteen");
    assert!(many_spread < 0.4 * one_spread, "{one_spread} with one, {many_spread} with sixteen");
}

#[test]
fn irradiance_is_known_well_without_being_asked() {
    let folder = Folder::new();
    folder.file("scene.rad", "void light lamp 0 0 3 1 1 1\nlamp sphere bulb 0 0 4 0 0 2 1\n");
    let words = ["rtrace", "-h", "-I", "scene.rad"];
    let output = run_with(command(&words).current_dir(folder.path("")), b"0 0 0 0 0 1\n1 0 0 0 0 1\n").text();
    let values: Vec<f64> = output
        .lines()
        .map(|line| line.split_whitespace().next().expect("a value").parse().expect("a number"))
        .collect();
    // A sphere of radiance 1 and radius r at distance d, seen at the angle θ to the normal: π (r/d)² cos θ.
    let expected = [std::f64::consts::PI / 4.0, std::f64::consts::PI / 5.0 * (4.0f64 / 5.0).sqrt()];
    for (value, expected) in values.iter().zip(expected) {
        assert!((value / expected - 1.0).abs() < 0.05, "{value}, expected {expected}");
    }
}

#[test]
fn the_work_ends_after_the_rays_of_the_picture() {
    let folder = Folder::new();
    folder.file("scene.rad", SCENE);
    let run = |words: &[&str]| {
        let words = [&["rtrace", "-h", "-oL"], words, &["scene.rad"]].concat();
        run_with(command(&words).current_dir(folder.path("")), RAYS.as_bytes())
    };
    assert_eq!(run(&["-x", "2", "-y", "2"]).text().lines().count(), 5);
    assert_eq!(run(&["-y", "3"]).text().lines().count(), 3);
    let short = run(&["-x", "10", "-y", "10"]);
    assert_eq!(short.messages, "rtrace: warning - unexpected EOF on input\n");
    assert_eq!(short.text().lines().count(), 1 + RAYS.lines().count());
}
