//! `mkillum`: windows as light sources, compared with real `mkillum`.

use crate::program::{Folder, Run, command, run_with};
use radsight_flux::{IllumDetail, IllumSurface, Shape};
use radsight_test_support::Radiance;
use radsight_test_support::plugins;

/// A sky, ground, and a wall that hides a part of both.
const OUTSIDE: &str = "\
void glow sky 0 0 4 1 1.1 1.4 0
sky source up 0 0 4 0 0 1 180
void glow ground 0 0 4 .2 .18 .15 0
ground source down 0 0 4 0 0 -1 180
void plastic dark 0 0 5 .1 .1 .1 0 0
dark polygon wall 0 0 12 -6 -4 0 6 -4 0 6 -4 4 -6 -4 4
void glass pane 0 0 3 .9 .9 .9
";

/// Small lights outside.
const LAMPS: &str = "\
void light solar 0 0 3 2e5 1.8e5 1.5e5
solar source sun 0 0 4 .3 -1 .9 .53
void light bulb 0 0 3 50 50 50
bulb sphere near 0 0 4 3 -2 3 .1
bulb ring far 0 0 8 1 -3 2 0 1 .1 0 .2
";

/// The surfaces that become lights, and those that do not.
const WINDOWS: &str = "\
# windows
#@mkillum m=win d=24 s=16 c=d
void plastic odd 0 0 5 .7 .7 .6 0 0
pane polygon w 0 0 12 .5 0 1 .5 0 2.5 3.5 0 2.5 3.5 0 1
#@mkillum c=n m=ball d=5
pane sphere s 0 0 4 2 -1 2 .2
#@mkillum d=0 s=4000 l+ m=disk c=a
void ring r 0 0 8 2 -1 2 0 1 0 0 .4
#@mkillum b=1000 s=16 l-
pane polygon dim 0 0 9 5 0 1 5 0 2 6 0 1
void polygon none 0 0 9 5 0 1 5 0 2 6 0 1
#@mkillum i=odd b=0 d=3 x=1
pane polygon other 0 0 9 7 0 1 7 0 2 8 0 1
#@mkillum n
odd cone k 0 0 8 0 0 0 0 0 1 .1 0
odd alias x odd
odd sphere \"a b\" 0 0 4 9 9 9 .1
";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("outside.rad", OUTSIDE);
    folder.file("lamps.rad", LAMPS);
    folder.file("windows.rad", WINDOWS);
    folder
}

fn ours(folder: &Folder, words: &str) -> Run {
    let words: Vec<&str> = words.split(' ').collect();
    run_with(command(&[&["mkillum"], &words[..]].concat()).current_dir(folder.path("")), b"")
}

/// The numbers of a file, header and all.
fn numbers(text: &[u8]) -> Vec<f64> {
    let text = String::from_utf8_lossy(text);
    text.split_whitespace().map(|word| word.parse().expect("a number")).collect()
}

/// Compares texts word by word; numbers within the relative tolerance `error`.
#[track_caller]
fn assert_words_like(ours: &str, theirs: &str, error: f64) {
    assert_eq!(ours.lines().count(), theirs.lines().count(), "{ours}\n{theirs}");
    for (our_line, their_line) in ours.lines().zip(theirs.lines()) {
        let (our_words, their_words) = (our_line.split_whitespace(), their_line.split_whitespace());
        assert_eq!(our_words.clone().count(), their_words.clone().count(), "{our_line}\n{their_line}");
        for (here, there) in our_words.zip(their_words) {
            let same = match (here.parse::<f64>(), there.parse::<f64>()) {
                (Ok(here), Ok(there)) => (here - there).abs() <= error * there.abs(),
                _ => here == there,
            };
            assert!(same, "{our_line}\n{their_line}");
        }
    }
}

/// Its alternate material lets the lamp through again: in its distribution, the lamp would count
/// twice.
#[test]
fn a_lamp_behind_a_window_is_no_part_of_its_distribution() {
    let folder = folder();
    folder.file("lamp.rad", "void light bulb 0 0 3 50 50 50\nbulb sphere near 0 0 4 2 -2 2 .1\n");
    let surface = "pane polygon w 0 0 12 .5 0 1 .5 0 2.5 3.5 0 2.5 3.5 0 1\n";
    folder.file("window.rad", format!("void glass pane 0 0 3 .9 .9 .9\n#@mkillum i=pane d=6 s=64 b=0\n{surface}"));
    for visible in ["-dv+", "-dv-"] {
        let run = ours(&folder, &format!("-ab 0 {visible} lamp.rad < window.rad"));
        let made = String::from_utf8(run.done()).expect("text");
        assert!(!made.contains("illum 0") && made.contains("pane polygon w"), "{visible}: {made}");
    }
    let Some(radiance) = Radiance::find() else { return };
    // The light of the lamp that a floor reflects is part of it.
    folder.file("floor.rad", "void plastic white 0 0 5 .5 .5 .5 0 0\nwhite ring floor 0 0 8 2 -2 0 0 0 1 0 5\n");
    folder
        .file("bright.rad", format!("void glass pane 0 0 3 .9 .9 .9\n#@mkillum i=pane d=6 s=3000 c=a b=0\n{surface}"));
    radiance.octree(&folder, &["lamp.rad", "floor.rad"]);
    let words = ["-w", "-ab", "0", "scene.oct", "<", "bright.rad"];
    let programs = [command(&[&["mkillum"], &words[..]].concat()), radiance.command("mkillum", &words)];
    let [ours, theirs] = programs.map(|mut program| run_with(program.current_dir(folder.path("")), b"").text());
    let color =
        |text: &str| text.lines().rfind(|line| line.starts_with("3 0.")).map(|line| numbers(line.as_bytes())[1]);
    let [Some(ours), Some(theirs)] = [&ours, &theirs].map(|text| color(text)) else { panic!("{ours}\n{theirs}") };
    assert!((ours / theirs - 1.0).abs() < 0.02, "{ours} {theirs}");
}

#[test]
fn text_and_data_are_those_of_real_mkillum() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = folder();
    radiance.octree(&folder, &["-f", "outside.rad", "windows.rad"]);
    let words = ["-w", "-u-", "-ab", "0", "scene.oct", "<", "windows.rad"];
    let files = ["winR.dat", "winG.dat", "winB.dat", "ball.dat"];
    let mut found = Vec::new();
    for mut program in [command(&[&["mkillum"], &words[..]].concat()), radiance.command("mkillum", &words)] {
        let text = run_with(program.current_dir(folder.path("")), b"").text();
        found.push((text, files.map(|file| numbers(&folder.read(file)))));
        files.iter().for_each(|file| std::fs::remove_file(folder.path(file)).expect("a data file is removed"));
    }
    let [(our_text, our_data), (their_text, their_data)] = &found[..] else { panic!("two programs") };
    // The name with a space, which real mkillum writes without quotes.
    assert_words_like(&our_text.replace("\"a b\"", "a b"), their_text, 0.06);
    for ((ours, theirs), file) in our_data.iter().zip(their_data).zip(files) {
        assert_eq!(ours[..7], theirs[..7], "{file}");
        let (ours, theirs) = (&ours[7..], &theirs[7..]);
        assert_eq!(ours.len(), theirs.len(), "{file}");
        let apart = ours.iter().zip(theirs).map(|(a, b)| (a - b).abs()).sum::<f64>() / ours.len() as f64;
        let mean = theirs.iter().sum::<f64>() / theirs.len() as f64;
        assert!(apart < 0.15 * mean, "{file}: {apart} of {mean}");
    }
}

#[test]
fn a_light_has_the_irradiance_of_its_window() {
    let folder = folder();
    folder.file("lit.rad", "#@mkillum c=a l+ s=512\npane polygon w 0 0 12 .5 0 1 .5 0 2.5 3.5 0 2.5 3.5 0 1\n");
    let text = ours(&folder, "-ab 0 outside.rad lamps.rad lit.rad < lit.rad").text();
    let light = text.lines().skip_while(|line| !line.contains(" light ")).nth(3).expect("a light");
    let mean: Vec<f64> = light.split_whitespace().skip(1).map(|word| word.parse().expect("a number")).collect();
    let at = |k: u32| (f64::from(k) + 0.5) / 16.0;
    let points: String =
        (0..256).map(|k| format!("{} .01 {} 0 -1 0\n", 0.5 + 3.0 * at(k % 16), 1.0 + 1.5 * at(k / 16))).collect();
    let words = ["rtrace", "-h", "-I", "-ab", "1", "-ad", "1024", "outside.rad", "lamps.rad", "lit.rad"];
    let mut program = command(&words);
    let found = numbers(&run_with(program.current_dir(folder.path("")), points.as_bytes()).done());
    for (band, mean) in mean.iter().enumerate() {
        let irradiance = found.iter().skip(band).step_by(3).sum::<f64>() / 256.0;
        let radiance = irradiance / std::f64::consts::PI;
        assert!((mean / radiance - 1.0).abs() < 0.02, "{mean} {radiance}");
    }
}

/// A white court with the sun on one of its walls.
const COURT: &str = "\
void glow sky 0 0 4 1 1 1 0
sky source up 0 0 4 0 0 1 180
void light solar 0 0 3 2e5 2e5 2e5
solar source sun 0 0 4 .3 1 1.6 .53
void plastic white 0 0 5 .7 .7 .7 0 0
white polygon ground 0 0 12 -2 -4 0 6 -4 0 6 .2 0 -2 .2 0
white polygon south 0 0 12 -2 -4 0 -2 -4 6 6 -4 6 6 -4 0
white polygon north 0 0 12 -2 .2 0 -2 .2 6 6 .2 6 6 .2 0
white polygon west 0 0 12 -2 -4 0 -2 -4 6 -2 .2 6 -2 .2 0
white polygon east 0 0 12 6 -4 0 6 -4 6 6 .2 6 6 .2 0
void glass pane 0 0 3 .9 .9 .9
";

#[test]
fn light_between_walls_is_what_rays_that_share_nothing_find() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = folder();
    let corners = [0.5, 0.0, 1.0, 0.5, 0.0, 2.5, 3.5, 0.0, 2.5, 3.5, 0.0, 1.0];
    let window = format!("pane polygon w 0 0 12{}\n", corners.map(|corner| format!(" {corner}")).concat());
    folder.file("court.rad", COURT);
    folder.file("window.rad", format!("#@mkillum m=win d=6 s=256\n{window}"));
    let text = ours(&folder, "-ab 2 court.rad window.rad < window.rad").text();
    let color = text.lines().skip_while(|line| !line.contains(" illum ")).nth(3).expect("an illum");
    let mean: f64 = color.split(' ').nth(1).and_then(|word| word.parse().ok()).expect("a number");
    let data = numbers(&folder.read("win.dat"));
    let surface = IllumSurface::flat("w", Shape::Polygon, &corners, IllumDetail { density: 6, samples: 256 });
    let surface = surface.expect("a surface");
    let [rows, columns] = surface.cells();
    assert_eq!([data[3], data[6]], [rows + 1, columns + 1].map(|count| count as f64));
    let rays: Vec<u8> = (0..surface.rays())
        .flat_map(|number| surface.ray(number))
        .flat_map(|vector| vector.to_array())
        .flat_map(f64::to_ne_bytes)
        .collect();
    radiance.octree(&folder, &["-f", "court.rad", "window.rad"]);
    let words = ["-h", "-fda", "-u-", "-ab", "2", "-aa", "0", "-ad", "32", "-as", "0", "-lw", "1e-6", "scene.oct"];
    let found = run_with(radiance.command("rtrace", &words).current_dir(folder.path("")), &rays).done();
    let found: Vec<f64> = numbers(&found).into_iter().step_by(3).collect();
    for (cell, found) in found.chunks_exact(256).enumerate() {
        let expected = found.iter().sum::<f64>() / 256.0;
        // The first row of the data is beyond the pole, and the last column repeats the first.
        let ours = mean * data[7 + (1 + cell / columns) * (columns + 1) + cell % columns];
        assert!((ours / expected - 1.0).abs() < 0.04, "direction {cell}: {ours}, expected {expected}");
    }
}

#[test]
fn the_seed_changes_the_rays_of_a_window() {
    let [first, again, other] = ["0", "0", "1"].map(|seed| {
        let folder = folder();
        folder.file("lit.rad", "#@mkillum m=lit l+ s=4 d=4\npane polygon w 0 0 12 .5 0 1 .5 0 2.5 3.5 0 2.5 3.5 0 1\n");
        ours(&folder, &format!("-ab 0 --seed {seed} outside.rad lamps.rad lit.rad < lit.rad")).text();
        folder.read("lit.dat")
    });
    assert!(first == again && first != other);
}

#[test]
fn a_scene_on_standard_input_is_read_once() {
    let folder = folder();
    let window = "#@mkillum m=lit c=a l+ s=16 d=6\npane polygon w 0 0 12 .5 0 1 .5 0 2.5 3.5 0 2.5 3.5 0 1\n";
    folder.file("lit.rad", window);
    let from_files = ours(&folder, "-ab 0 outside.rad lamps.rad lit.rad < lit.rad").text();
    std::fs::remove_file(folder.path("lit.dat")).expect("a data file is removed");
    let mut program = command(&["mkillum", "-ab", "0", "-", "<", "lit.rad"]);
    let scene = [OUTSIDE, LAMPS, window].concat();
    let from_input = run_with(program.current_dir(folder.path("")), scene.as_bytes()).text();
    let without_command = |text: &str| text.split_once('\n').map(|(_, rest)| rest.to_owned());
    assert_eq!(without_command(&from_files), without_command(&from_input));
    assert!(from_input.contains(" light lit"), "{from_input}");
}

#[test]
fn faults_of_plugins_are_reported_where_lights_are_sampled() {
    let folder = folder();
    if plugins::c_plugin(&folder.path(""), "lambert.c", "torn", &["-DBROKEN_STATUS"]).is_none() {
        return;
    }
    folder.file(
        "facade.rad",
        "void glass pane 0 0 3 .9 .9 .9\nvoid brdfplugin plaster 2 torn lambert 0 3 .5 .5 .5\nplaster polygon f 0 0 12 -6 -4 0 6 -4 0 6 -4 4 -6 -4 4\n",
    );
    folder.file("lit.rad", "#@mkillum l+ s=16 d=6\npane polygon w 0 0 12 .5 0 1 .5 0 2.5 3.5 0 2.5 3.5 0 1\n");
    let run = ours(&folder, "--allow-plugins -ab 0 facade.rad lamps.rad lit.rad < lit.rad");
    assert_eq!(run.messages.matches("eval_pdf failed (internal fault)").count(), 1, "{}", run.messages);
    run.done();
}

#[test]
fn what_was_there_is_kept_and_what_is_named_is_replaced() {
    let folder = folder();
    let window = "pane polygon w 0 0 9 0 0 1 0 0 2 1 0 1\n";
    let other = "pane ring v 0 0 8 3 0 1 0 -1 0 0 .1\n";
    folder.file("some.rad", format!("#@mkillum m=a d=1 s=1 o=made.rad\n{window}{other}#@mkillum f=kept\n{window}"));
    folder.file("a.dat", "mine");
    // Only its own data are replaced: other files are kept and reported (`tests/hostile/trust.rs`).
    folder.file("kept.dat", "2\n0.000000 1.500000 1\n0.000000 6.283185 1\n\n 1.000000e+00\n");
    let old = folder.read("kept.dat");
    assert_eq!(ours(&folder, "-ab 0 outside.rad some.rad < some.rad").text(), "", "all goes to the file");
    assert_eq!(folder.read("a.dat"), b"mine");
    assert_ne!(folder.read("kept.dat"), old);
    let made = String::from_utf8(folder.read("made.rad")).expect("text");
    assert!(
        made.starts_with("# mkillum -ab 0 outside.rad some.rad\n#@mkillum !\n# mkillum m=a d=1 s=1 o=made.rad\n"),
        "{made}"
    );
    for name in ["a1.dat", "a2.dat"] {
        assert!(made.contains(&format!("5 noneg {name}\n\tillum.cal il_alth il_azih\n0\n9\n")), "{made}");
    }
    // The result is a scene, which a second run leaves unchanged.
    let again = ours(&folder, "outside.rad made.rad < made.rad");
    assert!(again.messages.contains("made.rad was processed before"), "{}", again.messages);
    let mut program = command(&["mkillum", "outside.rad", "made.rad"]);
    let piped = run_with(program.current_dir(folder.path("")), &folder.read("made.rad"));
    assert!(piped.messages.contains("standard input was processed before"), "{}", piped.messages);
    let again = again.text();
    assert_eq!(again.matches(" illum ").count(), 3, "{again}");
}

#[test]
fn rad_makes_lights_of_windows() {
    let folder = folder();
    folder.file("room.rad", "void plastic white 0 0 5 .7 .7 .7 0 0\n!genbox white room 4 5 3 -i | xform -t 0 .5 0\n");
    folder.file("pane.rad", "#@mkillum d=4 s=4\npane polygon w 0 0 12 .5 0 1 .5 0 2.5 3.5 0 2.5 3.5 0 1\n");
    folder.file(
        "house.rif",
        "ZONE= I 0 4 0 5 0 3\nmaterials= outside.rad\nscene= room.rad\nillum= pane.rad\nmkillum= -ab 0\nRES= 16\nview= def -vp 2 4 1.5 -vd 0 -1 0\n",
    );
    // A file of the user, whatever its name, stays.
    let own = folder.file("house_illum.rad", "# mine\n");
    let mut program = command(&["rad", "-w", "house.rif"]);
    let said = run_with(program.current_dir(folder.path("")), b"").text();
    assert!(said.contains("mkillum -ab 0 house0.oct \"<\" pane.rad > .house_illum.rad"), "{said}");
    assert_eq!(std::fs::read_to_string(own).unwrap(), "# mine\n");
    assert!(!folder.names().contains(&".house_illum.rad".to_owned()), "{:?}", folder.names());
    assert!(folder.names().contains(&"illum.dat".to_owned()), "{:?}", folder.names());
    assert!(folder.names().contains(&"house_def.hdr".to_owned()), "{:?}", folder.names());
}

#[test]
fn mistakes_are_reported() {
    let folder = folder();
    folder.file(
        "cone.rad",
        "#@mkillum q=1 d=x\npane cone k 0 0 8 0 0 0 0 0 1 .1 0\npane polygon p 0 0 9 0 0 0 1 1 1 2 2 2\n",
    );
    let run = ours(&folder, "outside.rad < cone.rad");
    for part in [
        "cone.rad: \"q=1 d=x\" after #@mkillum is unknown, expected m= ",
        "cone \"k\" cannot become a light source, expected a polygon, ring or sphere",
        "surface \"p\" has no area; it does not become a light source",
    ] {
        assert!(run.messages.contains(part), "{part}: {}", run.messages);
    }
    let text = run.text();
    assert!(text.contains("\npane cone k\n") && text.contains("\npane polygon p\n"), "{text}");
    folder.file("made.rad", "!genbox pane box 1 1 1\n!unheard of\n");
    let made = ours(&folder, "outside.rad < made.rad");
    assert_eq!(made.code, 1, "{}", made.messages);
    assert!(made.messages.contains("unheard"), "{}", made.messages);
    folder.file("boxed.rad", "#@mkillum n\n!genbox pane box 1 1 1\n");
    assert_eq!(ours(&folder, "outside.rad < boxed.rad").text().matches("pane polygon box.").count(), 6);
    folder.file("many.rad", "#@mkillum d=4000000 s=4000000\npane sphere s 0 0 4 0 0 0 1\n");
    folder.file("torn.rad", "pane polygon p 0 0 9 0 0\n");
    for (words, code, message) in [
        ("outside.rad <", 2, "no file is given after \"<\""),
        ("-ab 0", 2, "no scene is given"),
        ("-", 2, "the scene and the surfaces are both standard input"),
        ("-zz outside.rad", 2, "option \"-zz\" is not supported"),
        ("-P x outside.rad", 2, "option \"-P\" is not supported"),
        ("outside.rad < nowhere.rad", 1, "nowhere.rad"),
        ("outside.rad < many.rad", 1, "surface \"s\" needs too many rays"),
        ("outside.rad < torn.rad", 1, "torn.rad"),
    ] {
        let run = ours(&folder, words);
        assert_eq!((run.code, run.output.len()), (code, 0), "{words}: {}", run.messages);
        assert!(run.messages.contains(message), "{words}: {}", run.messages);
    }
}
