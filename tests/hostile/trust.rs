//! No file runs a command, loads a library, extends permissions or names an output that is not new
//! and below the current folder. `docs/security.md` has the rules; every program that reads scenes
//! is tested with files that break them.

use crate::program::{Folder, command, root, run_with};
use crate::trap::{Trap, evil_library};
use radsight_test_support::plugins;
use std::fs;
use std::path::{Path, PathBuf};

/// The programs that read scenes, with `SCENE` in place of the hostile file.
const READERS: [&str; 27] = [
    "check SCENE",
    "explain camera.toml SCENE",
    "capture camera.toml SCENE --samples 1 --exposure -",
    "oconv SCENE",
    "oconv -f plain.rad SCENE",
    "rpict -x 4 -y 4 SCENE",
    "rpict -x 4 -y 4 plain.rad SCENE",
    "rtrace SCENE",
    "rcontrib -m m SCENE",
    "rfluxmtx -c 1 - lights.rad SCENE",
    "rfluxmtx -c 1 - SCENE plain.rad",
    "rfluxmtx -c 1 SCENE lights.rad plain.rad",
    "rfluxmtx -c 1 SCENE SCENE SCENE",
    "mkillum -ab 0 SCENE < lights.rad",
    "mkillum -ab 0 plain.rad < SCENE",
    "mkillum -ab 0 SCENE < SCENE",
    "xform SCENE",
    "xform -e SCENE",
    "xform -n a -t 1 0 0 SCENE",
    "getbbox SCENE",
    "replmarks -x plain.rad m SCENE",
    "replmarks -e -x plain.rad m SCENE",
    "mksource SCENE",
    "obj2mesh -a SCENE pane.obj",
    "obj2mesh -l SCENE pane.obj",
    "rad rpict.rif",
    "pinterp -vf SCENE -fr SCENE plain.rad plain.rad",
];

#[test]
fn scenes_run_no_commands_in_any_program() {
    let trap = Trap::new();
    for scene in ["command.rad", "shell.rad", "inside.rad"] {
        trap.file("rpict.rif", format!("scene= {scene}\nZONE= I -1 1 -1 1 -1 1\nview= v -vp 0 0 0\nRES= 4\n"));
        for reader in READERS {
            let line = reader.replace("SCENE", scene);
            trap.leaves_no_trace(&line.split(' ').collect::<Vec<_>>(), b"0 0 0 0 1 0\n");
        }
        let text = fs::read(trap.work(scene)).expect("the scene");
        for words in
            [&["genskyvec"][..], &["xform"], &["getbbox"], &["oconv", "-"], &["rpict", "-x", "4"], &["replmarks"]]
        {
            trap.leaves_no_trace(words, &text);
        }
    }
}

#[test]
fn scenes_write_no_files_by_their_commands() {
    let trap = Trap::new();
    trap.file("rpict.rif", "scene= writes.rad\nZONE= I -1 1 -1 1 -1 1\nview= v -vp 0 0 0\nRES= 4\n");
    for reader in READERS.iter().filter(|reader| !reader.starts_with("rad")) {
        let line = reader.replace("SCENE", "writes.rad");
        trap.leaves_no_trace(&line.split(' ').collect::<Vec<_>>(), b"0 0 0 0 1 0\n");
    }
    trap.file("writes.rad", "!ies2rad -o ../escaped lamp.ies\n");
    trap.refuses(&["xform", "writes.rad"], "comes from a file and is not written");
}

#[test]
fn libraries_beside_a_scene_are_not_loaded_by_any_program() {
    let trap = Trap::new();
    if evil_library(&trap).is_none() {
        return;
    }
    for scene in ["replaced.rad", "plugin.rad", "path.rad", "outside.rad"] {
        for reader in READERS.iter().filter(|reader| !reader.starts_with("rad")) {
            let line = reader.replace("SCENE", scene);
            trap.leaves_no_trace(&line.split(' ').collect::<Vec<_>>(), b"0 0 0 0 1 0\n");
        }
        // Programs that render report the reason.
        for reader in ["rtrace", "rpict -x 4", "mkillum -ab 0", "rcontrib -m m"] {
            let words: Vec<&str> = reader.split(' ').chain(["lights.rad", scene]).collect();
            trap.refuses(&words, scene);
        }
    }
    let run = trap.leaves_no_trace(&["rtrace", "replaced.rad"], b"0 0 0 0 1 0\n");
    let library = format!("{}evil{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let expected = format!(
        "replaced.rad:1:19: error: library \"./{library}\" is beside the scene and is not loaded: a scene is input, not a program
  1 | #@radsight brdf m evil model 1
    |                   ^^^^
hint: --allow-plugins loads libraries beside the scene, --plugin-path DIR those of a folder
"
    );
    assert_eq!(run.messages, expected);
    assert_eq!(run.code, 1);
}

#[test]
fn the_command_line_allows_libraries() {
    for option in ["--allow-plugins", "--plugin-path .", "--brdf m=evil:model(1)"] {
        let trap = Trap::new();
        if evil_library(&trap).is_none() {
            return;
        }
        let run = trap.run_line(&format!("rtrace {option} replaced.rad"));
        assert!(trap.exists("ran"), "{option}: {}", run.messages);
    }
    // A name on the command line permits no other.
    let trap = Trap::new();
    if evil_library(&trap).is_some() {
        // Whether the named library exists depends on what was built beside the program.
        let words = ["rtrace", "--brdf", "m=builtin:ward(.5,.5,.5,.2)", "lights.rad", "plugin.rad"];
        trap.leaves_no_trace(&words, b"0 0 0 0 1 0\n");
    }
}

#[test]
fn an_installed_plugin_works_without_a_word() {
    let folder = Folder::new();
    let installed = Folder::new();
    if plugins::c_plugin(&installed.path(""), "lambert.c", "chalk", &[]).is_none() {
        return;
    }
    folder.file(
        "ball.rad",
        "void light l 0 0 3 1 1 1\nvoid brdfplugin m 2 chalk lambert 0 3 .5 .5 .5\nm sphere s 0 0 4 0 5 0 1\n",
    );
    let run = |words: &[&str]| {
        let mut program = command(words);
        program.current_dir(folder.path("")).env("RADSIGHT_PLUGIN_PATH", installed.path(""));
        run_with(&mut program, b"0 0 0 0 1 0\n")
    };
    run(&["rtrace", "-h", "ball.rad"]).done();
    run(&["capture", "--help"]).done();
}

#[test]
fn files_of_options_widen_nothing() {
    let trap = Trap::new();
    if evil_library(&trap).is_none() {
        return;
    }
    let programs = [
        ("rpict -x 4", "SCENE"),
        ("rtrace", "SCENE"),
        ("rcontrib -m m", "SCENE"),
        ("rfluxmtx -c 1", "- lights.rad SCENE"),
        ("mkillum -ab 0", "SCENE"),
    ];
    let mut cases: Vec<(String, &str)> = vec![
        ("@commands.opt".to_owned(), "command.rad"),
        ("@nested.opt".to_owned(), "command.rad"),
        ("@outputs.opt".to_owned(), "plain.rad"),
        ("@plugins.opt".to_owned(), "replaced.rad"),
        ("@folder.opt".to_owned(), "replaced.rad"),
        ("@brdf.opt".to_owned(), "plain.rad"),
        ("@scene.opt".to_owned(), "plain.rad"),
    ];
    for (number, words) in [
        "-o keep",
        "-o ../escaped",
        "-z keep",
        "-z ../escaped",
        "-e keep",
        "-e ../escaped",
        "-ro keep",
        "-P keep",
        "-P ../escaped",
        "-PP ../escaped",
        "-fo+",
        "-o !touch",
        "-z f%d",
        "-r keep -o ../escaped",
    ]
    .into_iter()
    .enumerate()
    {
        trap.file(&format!("case{number}.opt"), words);
        cases.push((format!("@case{number}.opt"), "plain.rad"));
    }
    for (options, scene) in &cases {
        for (program, rest) in programs {
            let line = format!("{program} {options} {}", rest.replace("SCENE", scene));
            trap.leaves_no_trace(&line.split(' ').collect::<Vec<_>>(), b"0 0 0 0 1 0\n");
        }
    }
    trap.refuses(
        &["rpict", "@commands.opt", "command.rad"],
        "option \"--allow-commands\" comes from a file and is refused\nhint: only the command line may give it",
    );
    // Options of the command line also apply to a file's words; a variable is trusted.
    trap.run(&["rtrace", "--allow-commands", "@commands.opt", "command.rad"]).done();
    assert!(trap.exists("ran"));
    fs::remove_file(trap.work("ran")).expect("it was made");
    let mut program = command(&["rtrace", "$OPTIONS", "command.rad"]);
    run_with(program.current_dir(trap.work("")).env("OPTIONS", "--allow-commands"), b"").done();
    assert!(trap.exists("ran"));
    trap.file("new.opt", "-ab 0 -o new.hdr");
    trap.run(&["rpict", "-x", "4", "@new.opt", "plain.rad"]).done();
    assert!(trap.exists("new.hdr"), "a new file below the folder is made");
}

#[test]
fn control_files_widen_nothing() {
    let trap = Trap::new();
    let folder = fs::canonicalize(trap.work("")).expect("the folder");
    for program in ["rpict", "rtrace"] {
        for words in [
            "--allow-commands\ncommand.rad",
            "-e\n../escaped\nplain.rad",
            "-e\nkeep\nplain.rad",
            "-o\n../escaped\nplain.rad",
            "-z\nkeep\nplain.rad",
            "!touch ran",
            "--plugin-path\n.\nreplaced.rad",
            "@commands.opt\ncommand.rad",
        ] {
            trap.file("control", format!("radsight\n{}\n{program}\n{words}\n", folder.display()));
            let run = trap.leaves_no_trace(&[program, "-P", "control"], b"0 0 0 0 1 0\n");
            assert_ne!(run.code, 0, "{program} {words}: {}", run.messages);
        }
        fs::remove_file(trap.work("control")).expect("it was written");
        // One of our programs repeats a stored command line.
        let first = trap.run(&[program, "-h-", "-w", "-P", "control", "plain.rad"]);
        if program == "rtrace" {
            let again = trap.run(&[program, "-P", "control"]);
            assert_eq!(first.done(), again.done());
        }
    }
}

#[test]
fn octrees_run_nothing() {
    let trap = Trap::new();
    // A name of the same length replaces the command.
    trap.file("abcdef.rad", fs::read(trap.work("plain.rad")).expect("a scene"));
    let octree = trap.run(&["oconv", "abcdef.rad"]).done();
    let at = octree.windows(11).rposition(|bytes| bytes == b"abcdef.rad\0").expect("the octree names its file");
    for name in ["!touch ran", "|touch ran"] {
        let mut hostile = octree.clone();
        hostile[at..at + 10].copy_from_slice(name.as_bytes());
        trap.file("evil.oct", hostile);
        for reader in READERS.iter().filter(|reader| !reader.starts_with("rad")) {
            let line = reader.replace("SCENE", "evil.oct");
            trap.leaves_no_trace(&line.split(' ').collect::<Vec<_>>(), b"0 0 0 0 1 0\n");
        }
        trap.leaves_no_trace(&["oconv", "-i", "evil.oct", "plain.rad"], b"");
        trap.file("instance.rad", "void instance i 1 evil.oct 0 0\n");
        trap.leaves_no_trace(&["rtrace", "instance.rad"], b"0 0 0 0 1 0\n");
    }
}

#[test]
fn words_of_a_file_are_obeyed_like_a_file() {
    let trap = Trap::new();
    for line in [
        "rpict --allow-commands command.rad",
        "rpict -o ../escaped plain.rad",
        "oconv --allow-commands command.rad",
        "pcomb !touch",
        "rmtxop !touch",
        "rsplit ../escaped",
        "rsplit !touch",
        "getinfo -c touch ran",
        "ra_ppm keep ../escaped",
        "obj2mesh pane.obj ../escaped",
        "rlam !touch -",
        "rcontrib -m m -o !touch plain.rad",
        "xform --allow-commands command.rad",
        "check --allow-commands command.rad",
        "ies2rad -o ../escaped lamp.ies",
        "capture camera.toml plain.rad --samples 1 --exposure ../escaped",
        "plugin check ./libevil.so",
        "plugin new escaped",
        "install-links ../escaped",
        "pinterp -vf plain.rad -z ../escaped plain.rad plain.rad",
        "dctimestep -o ../escaped plain.rad plain.rad",
    ] {
        let words: Vec<&str> = ["--words-of-file"].into_iter().chain(line.split(' ')).collect();
        let run = trap.leaves_no_trace(&words, b"1 2 3\n");
        assert_ne!(run.code, 0, "{line}");
    }
    trap.run(&["--allow-commands", "--words-of-file", "rtrace", "command.rad"]).done();
    assert!(trap.exists("ran"));
}

#[test]
fn processes_start_and_libraries_load_only_in_known_files() {
    let places = [
        ("Command::new(", &["src/trust/mod.rs"][..]),
        ("Registry::new(", &["src/commands/plugin.rs", "src/plugins.rs"]),
        ("SearchPath::default(", &["src/commands/plugin.rs", "src/plugins.rs"]),
        ("Library::load(", &["src/commands/plugin.rs"]),
        ("libloading", &[]),
        ("CommandPermit(", &["src/trust/mod.rs"]),
    ];
    let mut files = Vec::new();
    sources(&root().join("src"), &mut files);
    assert!(files.len() > 50);
    for (what, allowed) in places {
        for file in &files {
            let text = fs::read_to_string(file).expect("a source");
            let name = file.strip_prefix(root()).expect("below the root").display().to_string();
            assert!(!text.contains(what) || allowed.contains(&name.as_str()), "{name} has {what}");
        }
    }
}

fn sources(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        match path.is_dir() {
            true => sources(&path, files),
            false => files.push(path),
        }
    }
}

#[test]
fn formats_that_hold_no_scene_cause_nothing() {
    let trap = Trap::new();
    let camera = fs::read_to_string(trap.work("camera.toml")).expect("a camera");
    let rig = "[rig]\nleds = 2\nring_diameter_mm = 25.4\nled_diameter_mm = 5.0\nled_intensity_w_per_sr = 0.055\nled_cone_deg = 7.0\n";
    for table in ["!touch ran", "|touch ran", "../precious", "$(touch ran)"] {
        trap.file("evil.toml", format!("{camera}{rig}led_table = \"{table}\"\n"));
        for line in ["rig evil.toml", "explain evil.toml plain.rad", "pinhole rays evil.toml --samples 1 -f a"] {
            trap.leaves_no_trace(&line.split(' ').collect::<Vec<_>>(), b"");
        }
    }
    let picture = trap.run(&["rpict", "-x", "2", "-y", "2", "plain.rad"]).done();
    let header = b"#?RADIANCE\n!touch ran\nrpict --allow-commands -o keep -z ../escaped !touch ran\nVIEW= -vf !touch -o keep\noconv !touch ran\nRADPROJECT= !touch ran\n";
    let evil = [&header[..], &picture[11..]].concat();
    trap.file("evil.hdr", &evil);
    trap.file("evil.cal", "!touch ran;\nx = system(\"touch ran\");\n");
    trap.file("evil.vf", "rvu -o keep -z ../escaped -vp 0 0 0 --allow-commands !touch ran\n");
    trap.file("evil.ies", "IESNA:LM-63-1995\n[MANUFAC] !touch ran\nTILT=!touch ran\n1 1000 1 3 1 1 2 0 0 0\n1 1 50\n0 45 90\n0\n100 80 0\n");
    trap.file("evil.xml", "<!DOCTYPE a [<!ENTITY b SYSTEM \"../precious\">]><WindowElement>&b;</WindowElement>\n");
    trap.file("formats.rad", "void brightfunc f 2 x evil.cal 0 0\nf BSDF m 6 0 evil.xml 0 0 1 . 0 0\nm sphere s 0 0 4 0 5 0 1\n!ies2rad -p evil.ies\n!xform -f evil.vf plain.rad\n");
    for line in [
        "getinfo evil.hdr",
        "pfilt -1 evil.hdr",
        "pcomb evil.hdr",
        "pcomb -f evil.cal evil.hdr",
        "pcompos evil.hdr 0 0",
        "pvalue evil.hdr",
        "pcond evil.hdr",
        "ra_ppm evil.hdr -",
        "falsecolor -i evil.hdr",
        "rmtxop evil.hdr",
        "rcomb evil.hdr",
        "dctimestep evil.hdr evil.hdr",
        "pextrem evil.hdr",
        "vwrays evil.hdr",
        "vwrays -vf evil.vf -x 2 -y 2",
        "rpict -vf evil.vf -x 2 -y 2 plain.rad",
        "rpict -vf evil.hdr -x 2 -y 2 plain.rad",
        "rpict -r evil.hdr plain.rad",
        "rtrace -f evil.cal plain.rad",
        "rcalc -f evil.cal -e $1=x(1)",
        "rtrace formats.rad",
        "oconv -f formats.rad",
        "ies2rad -o - evil.ies",
        "sensor evil.toml",
        "calibrate evil.hdr",
    ] {
        trap.leaves_no_trace(&line.split(' ').collect::<Vec<_>>(), &evil);
    }
}
