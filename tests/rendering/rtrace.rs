//! `rtrace`: the output and its formats, compared with real Radiance.

use crate::program::{Folder, command, run_with};
use radsight_test_support::Radiance;

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

/// The header without lines that differ between runs, and the rest unchanged.
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

/// Compares texts word by word, and numbers with a relative tolerance.
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
        // A ray without direction has no record of its own in real Radiance: its point is that of
        // the ray before.
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
        &["-fac", "-cs", "6", "-co+"],
        &["-fac", "-cs", "10", "-co+"],
        &["-fac", "-cs", "22"],
    ] {
        let [ours, theirs] = both(&radiance, words, RAYS).map(|bytes| parts(&bytes));
        assert_eq!(ours.0, theirs.0, "{words:?}");
        assert_eq!(ours.1.len(), theirs.1.len(), "{words:?}");
        let apart = ours.1.iter().zip(&theirs.1).map(|(ours, theirs)| ours.abs_diff(*theirs)).max();
        assert!(apart <= Some(1), "{words:?}: bytes differ by {apart:?}");
    }
}

#[test]
fn components_of_a_color_stay_where_no_spectrum_ends() {
    let Some(radiance) = Radiance::find() else { return };
    for words in [&["-h", "-pXYZ", "-co-"][..], &["-h", "-pM", "-co-"], &["-h", "-co+", "-co-"]] {
        let [ours, theirs] = both(&radiance, words, RAYS);
        same_words(&ours, &theirs, words);
    }
}

/// Balls of mixtures with `void` above a floor.
#[test]
fn a_mixture_is_the_first_surface_even_where_it_is_void() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    let parts = "void glass gl 0 0 3 .6 .8 .7\nvoid plastic red 0 0 5 .6 .1 .1 0 0\n\
        void brightfunc bf 2 .5 . 0 0\nred polygon floor 0 0 12 -9 -9 -1 9 -9 -1 9 9 -1 -9 9 -1\n\
        void mixfunc none 4 gl void 0 . 0 0\nvoid mixfunc half 4 red void .5 . 0 0\n\
        void mixfunc all 4 gl void 1 . 0 0\nvoid mixfunc both 4 red gl .5 . 0 0\nvoid alias other half\n";
    let balls = ["none", "half", "all", "both", "other", "gl", "void"].into_iter().enumerate();
    let text: String = balls.map(|(at, name)| format!("{name} sphere b{at} 0 0 4 {} 0 0 .5\n", 2 * at)).collect();
    folder.file("scene.rad", format!("{parts}{text}"));
    let octree = radiance.octree(&folder, &["scene.rad"]);
    let rays: String = (0..7).map(|at| format!("{} .2 3 0 0 -1\n", 2.0 * f64::from(at) + 0.3)).collect();
    let words = ["-h", "-ab", "0", "-onNMp", &octree];
    let real = run_with(radiance.command("rtrace", &words).current_dir(folder.path("")), rays.as_bytes()).done();
    let ours: Vec<&str> = std::iter::once("rtrace").chain(words).collect();
    let ours = run_with(command(&ours).current_dir(folder.path("")), rays.as_bytes()).done();
    same_words(&ours, &real, &["mixtures"]);
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
fn no_ambient_divisions_are_no_interreflection() {
    let folder = Folder::new();
    folder.file("scene.rad", SCENE);
    let run = |program: &str, options: &str| {
        let words: Vec<&str> = [program, "-h"].into_iter().chain(options.split(' ')).chain(["scene.rad"]).collect();
        run_with(command(&words).current_dir(folder.path("")), b"0 3 .01 0 0 1\n").text()
    };
    let ambient = "-I -av .1 .2 .3";
    for options in ["-ab 2 -ad 0", "-ab 1 -ad 0 -aa 0", "-ab 1 -ad 0 -as 64"] {
        assert_eq!(run("rtrace", &format!("{ambient} {options}")), run("rtrace", &format!("{ambient} -ab 0")));
    }
    let values = run("rcontrib", "-I -ab 1 -ad 0 -m sky");
    assert!(first_values(&values).iter().all(|value| *value == 0.0), "{values}");
    if let Some(radiance) = Radiance::find() {
        let octree = radiance.octree(&folder, &["scene.rad"]);
        let words = ["-h", "-w", "-I", "-av", ".1", ".2", ".3", "-ab", "2", "-ad", "0", "-u+", "-dj", "0", &octree];
        let mut real = radiance.command("rtrace", &words);
        let real = run_with(real.current_dir(folder.path("")), b"0 3 .01 0 0 1\n").done();
        same_words(run("rtrace", &format!("{ambient} -ab 2 -ad 0 --samples 4096")).as_bytes(), &real, &["-ad 0"]);
    }
}

/// The first value of each record.
fn first_values(text: &str) -> Vec<f64> {
    let first = |line: &str| line.split_whitespace().next().expect("a value").parse().expect("a number");
    text.lines().map(first).collect()
}

/// The mean of some values, and their standard deviation.
fn mean_and_spread(values: &[f64]) -> (f64, f64) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (values.len() - 1) as f64).sqrt())
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
        mean_and_spread(&first_values(&text))
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
    let values = first_values(&output);
    // A sphere of radiance 1 and radius r at distance d, seen at the angle θ to the normal: π
    // (r/d)² cos θ.
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

#[test]
fn responses_of_spectra_are_those_of_real_rtrace() {
    let Some(radiance) = Radiance::find() else { return };
    // Rays to the sky and to the lamp, whose spectra are not those of a colour.
    let scene = "void spectrum yellow 0 0 6 380 780 .1 .2 1.5 .9\nyellow glow sky 0 0 4 1 1 1 0\nsky source dome 0 0 4 0 0 1 360\n";
    let folder = Folder::new();
    folder.file("scene.rad", scene);
    let octree = radiance.octree(&folder, &["scene.rad"]);
    for response in ["-pS", "-pM", "-pY"] {
        for sampling in [&["-cs", "18"][..], &["-cs", "7", "-cw", "400", "720"]] {
            let words = [&["-h", "-w-", response], sampling].concat();
            let ours = [&["rtrace"], &words[..], &["scene.rad"]].concat();
            let ours = run_with(command(&ours).current_dir(folder.path("")), b"0 0 0 0 0 1\n").text();
            let mut theirs = radiance.command("rtrace", &[&words[..], &[&octree]].concat());
            let theirs = run_with(theirs.current_dir(folder.path("")), b"0 0 0 0 0 1\n").text();
            let [ours, theirs] = [ours, theirs].map(|text| text.trim().parse::<f64>().expect("a number"));
            assert!((ours / theirs - 1.0).abs() < 0.01, "{words:?}: {ours}, real {theirs}");
        }
    }
}

#[test]
fn hartmanns_constant_moves_lights_and_does_not_colour_them() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    let prism = "void light lamp 0 0 3 1000 1000 1000\nlamp sphere bulb 0 0 4 20 -4 0 .2\n\
                 void dielectric glass 0 0 5 1 1 1 1.5 300\n\
                 glass polygon a 0 0 12 0 -2 -1  0 -2 1  0 2 1  0 2 -1\n\
                 glass polygon b 0 0 12 0 -2 -1  1.6 -2 -1 1.6 -2 1 0 -2 1\n\
                 glass polygon c 0 0 12 1.6 -2 -1 0 2 -1 0 2 1 1.6 -2 1\n\
                 glass polygon d 0 0 9 0 -2 1 1.6 -2 1 0 2 1\nglass polygon e 0 0 9 0 -2 -1 0 2 -1 1.6 -2 -1\n";
    folder.file("prism.rad", prism);
    let octree = radiance.octree(&folder, &["prism.rad"]);
    let rays: String = (-300..300).map(|step| format!("-5 0 0 1 {} .001\n", f64::from(step) * 1e-3)).collect();
    let mut theirs = radiance.command("rtrace", &["-h", "-w-", &octree]);
    let theirs = run_with(theirs.current_dir(folder.path("")), rays.as_bytes()).done();
    let mut ours = command(&["rtrace", "-h", "prism.rad"]);
    let ours = run_with(ours.current_dir(folder.path("")), rays.as_bytes()).done();
    same_words(&ours, &theirs, &["prism"]);
    let values = String::from_utf8_lossy(&ours).into_owned();
    let lit =
        |line: &&str| line.split_whitespace().next().is_some_and(|red| red.parse::<f64>().is_ok_and(|red| red > 1.0));
    assert!(values.lines().filter(lit).count() > 4, "the lamp is seen");
}

/// No rough surface, and lights so small that their sample points do not matter.
const GLASSWORK: &str = "
void light lamp 0 0 3 1e8 2e8 3e8
lamp sphere bulb 0 0 4 0 0 5 1e-4
void light sunlight 0 0 3 1e7 9e6 8e6
sunlight source sun 0 0 4 .3 -.6 .8 .002
void plastic coated 0 0 5 .5 .4 .3 .1 0
coated ring floor 0 0 8 0 0 0 0 0 1 0 5
void glass pane 0 0 3 .9 .8 .7
pane polygon window 0 0 12 -1.3 -1.3 2 1.3 -1.3 2 1.3 1.3 2 -1.3 1.3 2
void mirror silver 0 0 3 .8 .7 .6
silver polygon looking_glass 0 0 12 3 2 0 3 -2 0 3 -2 4 3 2 4
void dielectric crystal 0 0 5 .9 .8 .7 1.5 0
crystal sphere ball 0 0 4 -2 0 1 .7
void trans frosted 0 0 7 .6 .5 .4 .1 0 .7 .4
frosted polygon screen 0 0 12 -1 3 .5 1 3 .5 1 3 2.5 -1 3 2.5
void trans clear 0 0 7 .9 .9 .8 .02 0 .9 .9
clear polygon veil 0 0 12 -1 -3 .5 1 -3 .5 1 -3 2.5 -1 -3 2.5
void colorfunc tint 4 .5+.1*Px .6 .7 . 0 0
tint alias void_tint tint
tint polygon ghost 0 0 12 -4 -1 0 -4 1 0 -4 1 3 -4 -1 3
void metal brass 0 0 5 .7 .5 .2 .9 0
brass sphere bowl 0 0 4 2 2 1 .6
";

const VIEW_RAYS: [&str; 9] = [
    "0 -.3 4 .1 .1 -1\n",
    "1.6 .1 1 1 .13 .11\n",
    "-2 -3 1.2 .03 1 .02\n",
    "0 0 1.2 .01 1 .1\n",
    "0 0 1.2 .01 -1 .1\n",
    "0 0 1 .2 .1 -1\n",
    "-3 .2 1 -1 .1 .2\n",
    "2 .1 1.3 .04 1 .05\n",
    "0 0 3 .1 .2 1\n",
];

fn compare_rays(radiance: &Radiance, words: &[&str], rays: &str) -> [Vec<u8>; 2] {
    let folder = Folder::new();
    folder.file("glasswork.rad", GLASSWORK);
    let octree = radiance.octree(&folder, &["glasswork.rad"]);
    let fixed = ["-h", "-w-", "-u-", "-dt", "0", "-dj", "0", "-lw", "1e-3", "-lr", "4"];
    let ours = [&["rtrace"][..], &fixed, words, &["glasswork.rad"]].concat();
    let ours = run_with(command(&ours).current_dir(folder.path("")), rays.as_bytes()).done();
    let mut theirs = radiance.command("rtrace", &[&fixed[..], words, &[&octree]].concat());
    [ours, run_with(theirs.current_dir(folder.path("")), rays.as_bytes()).done()]
}

#[test]
fn trees_of_rays_are_those_of_real_rtrace() {
    let Some(radiance) = Radiance::find() else { return };
    let cases: [&[&str]; 8] = [
        &["-otvL"],
        &["-oTvlLmsM"],
        &["-otw"],
        &["-otopnN", "-ti", "pane", "-ti", "coated", "-ti", "crystal", "-ti", "silver", "-ti", "tint"],
        &["-oTV"],
        &["-ovtrRxX"],
        &["-otm~L", "-ti", "pane", "-ti", "coated"],
        &["-oTmL", "-te", "pane"],
    ];
    for words in cases {
        for rays in VIEW_RAYS {
            let [ours, theirs] = compare_rays(&radiance, words, rays);
            same_words(&ours, &theirs, &[words, &[rays]].concat());
        }
    }
}

#[test]
fn mirror_images_are_distinguished_as_in_real_rtrace() {
    let Some(radiance) = Radiance::find() else { return };
    for words in [["-orR"], ["-oxX"], ["-oRXvrx"]] {
        let [ours, theirs] = compare_rays(&radiance, &words, &VIEW_RAYS.concat());
        same_words(&ours, &theirs, &words);
    }
    // A flat mirror has its image behind it, and glass shows the pattern of the surface behind it.
    let [ours, _] = compare_rays(&radiance, &["-oRX", "-pY"], VIEW_RAYS[1]);
    assert!(String::from_utf8_lossy(&ours).split_whitespace().all(|word| word.parse::<f64>().is_ok()));
}

#[test]
fn the_contributions_of_a_tree_add_up_to_its_value() {
    let folder = Folder::new();
    folder.file("scene.rad", SCENE);
    // Sampled rays and shadow rays end there: direct light and one bounce of the sky.
    let words = ["rtrace", "-h", "-ab", "1", "-lw", "1e-9", "-oTVms", "scene.rad"];
    let text = run_with(command(&words).current_dir(folder.path("")), b"0 0 2 0 1 -.3\n").text();
    let record = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        (words[0].parse::<f64>().expect("a number"), words[3].to_owned())
    };
    let told: Vec<(f64, String)> = text.lines().map(record).collect();
    let (total, _) = told.last().expect("the ray itself");
    let parts: f64 = told[..told.len() - 1].iter().map(|(part, _)| part).sum();
    assert!(told.len() >= 3 && (parts - total).abs() < 1e-5 * total, "{text}");
    assert!(told.iter().any(|(_, name)| name == "lamp") && told.iter().any(|(_, name)| name == "sky"), "{text}");
}

/// Where real rtrace is persistent, ours stores the command line.
#[test]
fn a_control_file_says_again_what_was_asked() {
    let folder = Folder::new();
    folder.file("scene.rad", "void glow shine 0 0 4 1 2 3 0\nshine sphere ball 0 0 4 0 0 0 1\n");
    let run = |words: &str, input: &str| {
        let words: Vec<&str> = words.split(' ').collect();
        run_with(command(&words).current_dir(folder.path("")), input.as_bytes())
    };
    let input = "0 0 5 0 0 -1\n";
    let first = run("rtrace -h -ovL -P some.per scene.rad", input).text();
    assert_eq!(
        first.split_whitespace().collect::<Vec<_>>(),
        ["1.000000e+00", "2.000000e+00", "3.000000e+00", "4.000000e+00"]
    );
    assert_eq!(run("rtrace -PP some.per", input).text(), first);
    // No process number is stored that a script would kill.
    assert!(folder.read("some.per").starts_with(b"radsight\n"));
    let picture = "rpict -vp 0 0 5 -vd 0 0 -1 -vu 0 1 0 -x 4 -y 4 --samples 1 -S 3 -o p%d.hdr -PP view.per scene.rad";
    let views = "VIEW= -vp 0 0 5 -vd 0 0 -1 -vu 0 1 0\n";
    run(picture, views).done();
    std::fs::remove_file(folder.path("p3.hdr")).expect("a picture is removed");
    run("rpict -PP view.per", views).done();
    assert!(folder.names().contains(&"p3.hdr".to_owned()), "{:?}", folder.names());
    folder.file("real.per", "somewhere 4711 /tmp/in /tmp/out /tmp/err\n");
    folder.file("elsewhere.per", "radsight\n/nowhere\nrtrace\nscene.rad\n");
    for (words, code, message) in [
        ("rtrace -P new.per", 2, "no scene is given, and control file \"new.per\" has no command line yet"),
        ("rtrace -P real.per scene.rad", 1, "\"real.per\": it belongs to another program"),
        ("rpict -P real.per", 1, "\"real.per\": it belongs to another program"),
        ("rtrace -P view.per", 1, "its command line is for rpict, expected rtrace"),
        ("rtrace -P elsewhere.per", 1, "its command line was stored in the folder \"/nowhere\""),
        ("rtrace -P", 2, "option \"-P\" ends the command line"),
    ] {
        let run = run(words, input);
        assert_eq!((run.code, run.output.len()), (code, 0), "{words}: {}", run.messages);
        assert!(run.messages.contains(message), "{words}: {}", run.messages);
    }
    assert_eq!(folder.read("real.per"), b"somewhere 4711 /tmp/in /tmp/out /tmp/err\n", "it is left as it was");
}

/// A wall beside a large light. Where something hides a part of the light, the noise is that of the
/// parts into which `-ds` divides it; where nothing does, even a single point makes hardly any.
#[test]
fn a_large_light_is_sampled_in_parts() {
    let light = "void light l 0 0 3 40 40 40\nl polygon l1 0 0 12 -1 -1 2.5 -1 0 2.5 0 0 2.5 0 -1 2.5\n\
                 w polygon p 0 0 12 -1 0 0 1 0 0 1 0 2 -1 0 2\n";
    let screen = "void plastic black 0 0 5 0 0 0 0 0\n\
                  black polygon s 0 0 12 -.6 -1 2.4 -.6 0 2.4 -.4 0 2.4 -.4 -1 2.4\n";
    let spread = |material: &str, screen: &str, options: &[&str]| {
        let folder = Folder::new();
        folder.file("scene.rad", format!("void {material}\n{light}{screen}"));
        let words = [&["rtrace", "-h", "-ab", "0"], options, &["scene.rad"]].concat();
        let rays = "0 -3 1 0 3 -.45\n".repeat(200);
        let text = run_with(command(&words).current_dir(folder.path("")), rays.as_bytes()).text();
        let (mean, spread) = mean_and_spread(&first_values(&text));
        spread / mean
    };
    // The light is on the other side of a lobe that is transmitted, and of one that is reflected.
    let materials = [
        "plastic w 0 0 5 .5 .5 .5 0 0",
        "trans w 0 0 7 .7 .7 .7 .04 .1 .5 1",
        "trans w 0 0 7 .7 .7 .7 0 .05 .28 .99",
        "WGMDfunc w 13 void 0 0 0 void .2 .05 .05 void 0 0 1 . 0 9 .5 .5 .5 0 0 0 0 0 0",
    ];
    for material in materials {
        let [default, fine, whole] =
            [&[][..], &["-ds", ".1"], &["-ds", "0"]].map(|options| spread(material, screen, options));
        assert!(default < 0.05 && fine < 0.3 * default, "{material}: {default} {fine}");
        assert!((0.2..0.8).contains(&whole), "{material}: {whole}");
        let unhidden = spread(material, "", &["-ds", "0"]);
        assert!(unhidden < 0.05, "{material}: {unhidden}");
    }
}

/// A spotlight may be infinitely far away; the distance of its focus means nothing there.
#[test]
fn a_distant_spotlight_is_a_light() {
    let scene = |light: &str| {
        format!(
            "void {light}\nl source sun 0 0 4 0 0 1 5\nvoid plastic p 0 0 5 .5 .5 .5 0 0\np ring floor 0 0 8 0 0 0 0 0 1 0 9\n"
        )
    };
    let folder = Folder::new();
    let [spot, plain] = ["spotlight l 0 0 7 10 20 30 60 0 0 -1", "light l 0 0 3 10 20 30"].map(|light| {
        folder.file("scene.rad", scene(light));
        let words = ["rtrace", "-h", "-ab", "0", "scene.rad"];
        run_with(command(&words).current_dir(folder.path("")), b"0 0 1 .1 0 -1\n").text()
    });
    assert_eq!(spot, plain);
    assert!(first_values(&spot)[0] > 0.0);
}

/// As Radiance says: transparent surfaces are ignored, whatever they absorb.
#[test]
fn irradiance_is_that_behind_transparent_bodies() {
    let wall = "void plastic grey 0 0 5 .5 .5 .5 0 0\nvoid light lamp 0 0 3 100 100 100\n\
                grey polygon wall 0 0 12 -5 4 -5 -5 4 5 5 4 5 5 4 -5\nlamp sphere l 0 0 4 6 0 6 .3\n";
    let of = |body: &str| {
        let folder = Folder::new();
        folder.file("scene.rad", format!("{wall}{body}"));
        let words = ["rtrace", "-h", "-i", "-ab", "0", "--samples", "64", "scene.rad"];
        let text = run_with(command(&words).current_dir(folder.path("")), b"0 0 0 0 1 0\n").text();
        text.split_whitespace().map(|word| word.parse().expect("a number")).collect::<Vec<f64>>()
    };
    let pane = "m polygon p 0 0 12 -1 2 -1 1 2 -1 1 2 1 -1 2 1\n";
    let ball = "m sphere b 0 0 4 0 2 0 .5\n";
    let bodies = [
        format!("void glass m 0 0 3 .5 .6 .7\n{pane}"),
        format!("void dielectric m 0 0 5 .3 .6 .7 1.5 0\n{ball}"),
        format!("void interface m 0 0 8 .3 .6 .7 1.5 .9 .9 .9 1.3\n{ball}"),
        format!("void trans m 0 0 7 .8 .8 .8 .06 .1 .5 .5\n{pane}"),
        format!("void trans2 m 4 1 0 0 . 0 8 .8 .8 .8 .06 .1 .1 .5 .5\n{pane}"),
        format!("void BRTDfunc m 10 .1 .1 .1 .2 .2 .2 0 0 0 . 0 9 .2 .2 .2 .3 .3 .3 .2 .2 .2\n{pane}"),
    ];
    let behind = of("");
    assert!(behind[0] > 0.1, "{behind:?}");
    for body in bodies {
        let found = of(&body);
        assert!(found.iter().zip(&behind).all(|(a, b)| (a / b - 1.0).abs() < 1e-3), "{body}: {found:?} {behind:?}");
    }
    // An opaque one has an irradiance of its own.
    assert!((of(&format!("void plastic m 0 0 5 .5 .5 .5 0 0\n{pane}"))[0] / behind[0] - 1.0).abs() > 0.1);
}

/// A tube near a floor, whose middle is much farther away than its nearest point. Real Radiance with fine parts gives
/// 253.8 and 212.2.
#[test]
fn long_lights_have_samples_along_their_length() {
    let irradiance = |light: &str, seed: u32| -> f64 {
        let folder = Folder::new();
        folder.file(
            "scene.rad",
            format!(
                "void plastic white 0 0 5 .8 .8 .8 0 0\nvoid light strip 0 0 3 3000 2500 2000\n{light}\
                 white polygon floor 0 0 12 0 -2 0 4 -2 0 4 2 0 0 2 0\n"
            ),
        );
        let seed = seed.to_string();
        let words = ["rtrace", "-h", "-w", "-I", "--seed", &seed, "scene.rad"];
        let text = run_with(command(&words).current_dir(folder.path("")), b"2 .17 .001 0 0 1\n").text();
        first_values(&text)[0]
    };
    let lights = [
        ("strip cylinder tube 0 0 7 .3 0 .26 3.9 0 .26 .01\n", 253.8, 0.08),
        ("strip polygon tube 0 0 12 .3 -.01 .26 .3 .01 .26 3.9 .01 .26 3.9 -.01 .26\n", 212.2, 0.04),
    ];
    for (light, expected, most) in lights {
        let values: Vec<f64> = (1..=16).map(|seed| irradiance(light, seed) / expected - 1.0).collect();
        let (mean, spread) = mean_and_spread(&values);
        assert!(spread < most && mean.abs() < 3.0 * spread / 4.0 + 0.002, "{light}: {mean} ± {spread}");
    }
}

/// Radiance turns normals to the viewer for surfaces that it treats as a sheet with two sides.
#[test]
fn perturbed_normals_of_back_faces_are_those_of_real_rtrace() {
    let alternate = "void plastic q 0 0 5 .5 .5 .5 0 0\n";
    for (material, is_turned) in [
        ("light m 0 0 3 1 1 1", false),
        ("glow m 0 0 4 1 1 1 0", false),
        ("spotlight m 0 0 7 1 1 1 30 0 0 -1", false),
        ("illum m 0 0 3 1 1 1", false),
        ("illum m 1 q 0 3 1 1 1", true),
        ("mirror m 0 0 3 .5 .5 .5", false),
        ("mirror m 1 q 0 3 .5 .5 .5", true),
        ("mist m 0 0 0", false),
        ("prism1 m 5 1 0 0 1 . 0 0", false),
        ("BRTDfunc m 10 .1 .1 .1 0 0 0 0 0 0 . 0 9 .1 .1 .1 .1 .1 .1 0 0 0", false),
        ("plastic m 0 0 5 .5 .5 .5 0 0", true),
        ("trans m 0 0 7 .5 .5 .5 0 0 .5 .5", true),
        ("glass m 0 0 3 .9 .9 .9", true),
        ("dielectric m 0 0 5 1 1 1 1.5 0", false),
    ] {
        let folder = Folder::new();
        folder.file("scene.rad", format!("{alternate}void {material}\nm ring s 0 0 8 0 0 0 0 0 1 0 3\n"));
        let rays = b"0 .1 5 0 0 -1\n0 .1 -5 0 0 1\n";
        let words = ["rtrace", "-h", "-w", "-ab", "0", "-on"];
        let normals = |text: String| -> Vec<f64> {
            text.split_whitespace().skip(2).step_by(3).map(|word| word.parse().expect("a number")).collect()
        };
        let mut ours = command(&[&words[..], &["scene.rad"]].concat());
        let ours = run_with(ours.current_dir(folder.path("")), rays).text();
        assert_eq!(normals(ours), [1.0, if is_turned { -1.0 } else { 1.0 }], "{material}");
        if let Some(radiance) = Radiance::find() {
            let octree = radiance.octree(&folder, &["scene.rad"]);
            let mut real = radiance.command("rtrace", &[&words[1..], &[octree.as_str()]].concat());
            let real = run_with(real.current_dir(folder.path("")), rays).text();
            assert_eq!(normals(real), [1.0, if is_turned { -1.0 } else { 1.0 }], "{material}");
        }
    }
}
