//! Commands in scenes that need a shell or a renderer.

use crate::program::{self, Folder, command, run_with};
use radsight_test_support::plugins;

const PRINTS: &str = "!printf 'void sphere s 0 0 4 0 0 0 %s\\n' 2\n";

fn run(folder: &Folder, words: &[&str]) -> program::Run {
    let mut command = command(words);
    run_with(command.current_dir(folder.path("")), b"")
}

#[test]
fn an_unknown_command_is_refused_with_the_option_that_allows_it() {
    let folder = Folder::new();
    folder.file("scene.rad", PRINTS);
    for words in
        [&["check", "scene.rad"][..], &["getbbox", "scene.rad"], &["oconv", "scene.rad"], &["xform", "scene.rad"]]
    {
        let run = run(&folder, words);
        assert_eq!((run.code, run.output.len()), (1, 0), "{words:?}");
        assert!(run.messages.contains("refused to run"), "{}", run.messages);
        assert!(words[0] == "xform" || run.messages.contains("--allow-commands"), "{}", run.messages);
    }
}

#[test]
fn an_allowed_command_runs_where_its_scene_is_read() {
    let folder = Folder::new();
    folder.file("scene.rad", PRINTS);
    folder.file("size", "3\n");
    let text = run(&folder, &["getbbox", "--allow-commands", "-h", "scene.rad"]).text();
    assert_eq!(text.split_whitespace().next(), Some("-2"), "{text}");
    assert!(run(&folder, &["check", "--allow-commands", "scene.rad"]).text().starts_with("1 surface"));
    assert!(!run(&folder, &["oconv", "--allow-commands", "-f", "scene.rad"]).done().is_empty());
    assert!(run(&folder, &["xform", "--allow-commands", "-s", "2", "scene.rad"]).text().contains("sphere s"));
    folder.file("scene.rad", "!read r < size; echo void sphere s 0 0 4 0 0 0 $r\n");
    let text = run(&folder, &["getbbox", "--allow-commands", "-h", "scene.rad"]).text();
    assert_eq!(text.split_whitespace().next(), Some("-3"), "{text}");
}

#[test]
fn sources_are_made_of_an_octree_that_a_scene_names() {
    let folder = Folder::new();
    folder.file("sky.rad", "void glow sun 0 0 4 1000 500 250 0\nsun source disk 0 0 4 0 0 1 10\n");
    folder.file("sky.oct", run(&folder, &["oconv", "sky.rad"]).done());
    folder.file("scene.rad", "!mksource -d 20000 -t 1 -a 60 sky.oct\n");
    let text = run(&folder, &["xform", "scene.rad"]).text();
    let words: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).flat_map(str::split_whitespace).collect();
    // Light and solid angle of all sources together are those of the disk.
    let (mut color, mut light) = (0.0, 0.0);
    for (at, word) in words.iter().enumerate() {
        let number = |offset: usize| words[at + offset].parse::<f64>().unwrap();
        match *word {
            "illum" => color = number(5),
            "source" => light += color * (1.0 - (0.5 * number(8).to_radians()).cos()),
            _ => {}
        }
    }
    let expected = 1000.0 * (1.0 - 5.0_f64.to_radians().cos());
    assert!((light / expected - 1.0).abs() < 0.1, "{light} instead of {expected}:\n{text}");
}

#[test]
fn sources_made_of_themselves_come_to_an_end() {
    let folder = Folder::new();
    folder.file("scene.rad", "void sphere s 0 0 4 0 0 0 1\n");
    folder.file("scene.oct", run(&folder, &["oconv", "scene.rad"]).done());
    folder.file("scene.rad", "!mksource -d 40 scene.oct\nvoid sphere s 0 0 4 0 0 0 1\n");
    let run = run(&folder, &["check", "scene.rad"]);
    assert!(run.messages.contains("its sources depend on themselves"), "{}", run.messages);
}

#[test]
fn what_is_left_out_is_explained_and_measured() {
    let folder = Folder::new();
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/radiance-scenes/gripps");
    let camera = std::fs::read_to_string(format!("{scenes}/fig10.toml")).unwrap();
    folder.file("camera.toml", camera.replace("pixels = [192, 165]", "pixels = [8, 7]"));
    let sheet = format!("{scenes}/sheet-retro.rad");
    let told = run(&folder, &["explain", "camera.toml", &sheet]).text();
    assert!(told.contains("one band is traced: every colour") && !told.contains("saves"), "{told}");
    let measured = run(&folder, &["explain", "--measure", "camera.toml", &sheet]).text();
    for skip in ["equal bands", "hits behind opaque blockers", "refracted shadow rays", "media", "antimatter"] {
        assert_eq!(measured.matches(&format!("skipping {skip} saves")).count(), 1, "{skip}: {measured}");
    }
    assert_eq!(measured.lines().count(), told.lines().count());
}

#[test]
fn a_generator_leaves_standard_input_to_the_loop_that_it_stands_in() {
    let folder = Folder::new();
    folder.file("hours", "9\n12\n15\n");
    folder.file("numbers", "1 2\n");
    folder.file("ball.rad", "void sphere s 0 0 4 0 0 0 1\n");
    folder.file("corner.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.file("lamp.ies", "IESNA91\nTILT=NONE\n1 100 1 2 1 1 1 1 1 1\n1 1 10\n0 90\n0\n10 5\n");
    let place = "place here\nlatitude 40\nlongitude 10\ntime_zone 0\nsite_elevation 10\nweather_data_file_units 1\n";
    folder.file("hour.wea", format!("{place}6 21 12 500 200\n"));
    let header = "LOCATION,here,-,there,-,1,40,-10,0,10\n".to_owned() + &"-\n".repeat(6) + "DATA PERIODS,1,1\n";
    folder.file("hour.epw", header + "2001,6,21,12,0,-,0,0,0,0,0,0,0,0,500,200,0\n");
    for command in [
        "gensky 6 21 $hour",
        "cnt $hour",
        "xform -rz $hour ball.rad",
        "epw2wea hour.epw",
        "gendaymtx hour.wea",
        "obj2rad corner.obj",
        "ies2rad -o lamp lamp.ies",
        "rlam numbers numbers",
        "total numbers",
        "rcalc -e '$1=$2' numbers",
        "ev $hour",
    ] {
        let line = format!("while read hour; do \"$0\" {command} > made || exit 1; echo $hour; done < hours");
        let mut shell = std::process::Command::new("sh");
        shell.args(["-c", &line, env!("CARGO_BIN_EXE_radsight")]);
        assert_eq!(run_with(shell.current_dir(folder.path("")), b"").text(), "9\n12\n15\n", "{command}");
    }
}

#[test]
fn rlam_runs_the_commands_that_are_its_inputs() {
    let folder = Folder::new();
    folder.file("numbers", "1\n2\n");
    assert_eq!(run(&folder, &["rlam", "numbers", "!expr 3 + 4", "!cnt 2"]).text(), "1\t7\t\t0\n2\t\t1\n");
}

#[test]
fn unreadable_standard_input_is_reported() {
    let folder = Folder::new();
    let mut shell = std::process::Command::new("sh");
    shell.args(["-c", "\"$0\" total < .", env!("CARGO_BIN_EXE_radsight")]);
    let run = run_with(shell.current_dir(folder.path("")), b"");
    assert_eq!(run.code, 1, "{}", run.messages);
    assert!(run.messages.contains("total: cannot read \"standard input\": "), "{}", run.messages);
}

#[test]
fn a_message_names_its_program_once() {
    let folder = Folder::new();
    for (words, mistake) in [
        (&["cnt", "many"][..], "cnt: count is \"many\""),
        (&["rlam", "nowhere"], "rlam: cannot find file"),
        (&["genskyvec"], "genskyvec: standard input:"),
        (&["mksource", "-q"], "mksource: unknown option \"-q\""),
    ] {
        let run = run(&folder, words);
        let named = run.messages.matches(&format!("{}: ", words[0])).count();
        assert!(run.code != 0 && named == 1 && run.messages.contains(mistake), "{}", run.messages);
    }
}

/// `check` makes the models that a scene names as a picture does, those that no surface uses too.
#[test]
fn models_that_cannot_be_made_are_mistakes_of_a_scene() {
    let folder = Folder::new();
    let surface = "mat sphere ball 0 0 4 0 0 0 1\n";
    let cases = [
        ("2 native lambert 0 3 2 1 1", "scene.rad:1:42: error: red is 2, expected at least 0 and at most 1\n"),
        ("2 retro sharp 0 1 .5", "scene.rad:1:29: error: number \"half_width\" is missing"),
        ("2 native nix 0 0", "scene.rad:1:30: error: library \"native\" has no model \"nix\"\n"),
        ("2 nolib nix 0 0", "scene.rad:1:23: error: cannot find plugin library \"nolib\""),
    ];
    for (model, expected) in cases {
        for scene in [format!("void brdfplugin mat {model}\n"), format!("void brdfplugin mat {model}\n{surface}")] {
            folder.file("scene.rad", &scene);
            let run = run(&folder, &["check", "scene.rad"]);
            assert_eq!((run.code, run.messages.matches("error: ").count()), (1, 1), "{}", run.messages);
            assert!(run.messages.contains(expected), "{}", run.messages);
        }
    }
    folder.file("scene.rad", format!("void plastic mat 0 0 5 .5 .5 .5 0 0\n{surface}"));
    for model in ["native:lambert(5,5,5)", "nolib:nix(1)"] {
        let run = run(&folder, &["check", "scene.rad", "--brdf", &format!("mat={model}")]);
        assert!(run.code == 1 && run.messages.starts_with("scene.rad:1:1: error: "), "{}", run.messages);
    }
    let two =
        "void brdfplugin a 2 native nix 0 0\nvoid brdfplugin b 2 native lambert 0 3 -1 1 1\nb sphere s 0 0 4 0 0 0 1\n";
    folder.file("scene.rad", two);
    let run = run(&folder, &["check", "scene.rad"]);
    assert!(run.messages.contains("scene.rad:1:28: ") && run.messages.contains("scene.rad:2:40: "), "{}", run.messages);
}

#[test]
fn findings_of_a_self_check_are_errors_of_a_strict_check() {
    let folder = Folder::new();
    if plugins::c_plugin(&folder.path(""), "lambert.c", "bright", &["-DBROKEN_ENERGY"]).is_none() {
        return;
    }
    folder.file("scene.rad", "void brdfplugin mat 2 bright lambert 0 3 .9 .9 .9\nmat sphere s 0 0 4 0 0 0 1\n");
    let lenient = run(&folder, &["check", "--allow-plugins", "scene.rad"]);
    assert!(lenient.code == 0 && lenient.messages.contains("scene.rad:1:30: warning: "), "{}", lenient.messages);
    let strict = run(&folder, &["check", "--allow-plugins", "--strict", "scene.rad"]);
    assert!(strict.code == 1 && strict.messages.contains("fails its self-check: "), "{}", strict.messages);
    let refused = run(&folder, &["check", "scene.rad"]);
    assert!(refused.code == 1 && refused.messages.contains("is beside the scene and is not loaded"), "{refused:?}");
}
