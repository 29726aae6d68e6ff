//! Nobody's file runs a command, loads a library, widens what is allowed or names a file that is not new and below the current
//! folder. `docs/security.md` has the rules; every program that reads scenes is tried here on files that break them.

mod program;
#[path = "../crates/brdf-host/tests/support/mod.rs"]
mod support;

use program::{Folder, Run, command, root, run_with};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A folder with hostile files. Programs run in the folder `work` of it.
struct Trap {
    folder: Folder,
}

/// What must never change.
const PRECIOUS: &str = "years of work\n";

/// Files of a hostile folder with their texts.
const FILES: [(&str, &str); 34] = [
    ("keep", PRECIOUS),
    ("keep.mtx", PRECIOUS),
    ("keep.dat", PRECIOUS),
    ("keep.oct", PRECIOUS),
    ("keep.rad", PRECIOUS),
    ("keep.amb", PRECIOUS),
    ("keep.opt", PRECIOUS),
    ("keep_v.hdr", PRECIOUS),
    ("keep_v.unf", PRECIOUS),
    ("keep_v.zbf", PRECIOUS),
    (
        "plain.rad",
        "void light lamp 0 0 3 1 1 1\nvoid plastic m 0 0 5 .5 .5 .5 0 0\nlamp sphere b 0 0 4 0 5 3 .5\nm sphere s 0 0 4 0 5 0 1\n",
    ),
    ("sky.rad", "void plastic m 0 0 5 .5 .5 .5 0 0\nvoid glow g 0 0 4 1 1 1 0\ng source s 0 0 4 0 0 1 360\n"),
    ("lights.rad", "void light lamp 0 0 3 1 1 1\nlamp sphere b 0 0 4 0 5 3 .5\n"),
    ("command.rad", "void plastic m 0 0 5 .5 .5 .5 0 0\nm sphere s 0 0 4 0 5 0 1\n!touch ran\n"),
    (
        "shell.rad",
        "m sphere s 0 0 4 0 5 0 1\n!echo; touch ran\n!genbox m b 1 1 1 > keep\n!echo `touch ran`\n!cat <(touch ran)\n!genbox m $(touch ran) 1 1 1\n!{ touch ran; }\n!touch ran | cat\n!touch ran &\n",
    ),
    (
        "inside.rad",
        "m sphere s 0 0 4 0 5 0 1\n!mksource '!touch ran'\n!rlam '!touch ran' -\n!cat '!touch ran'\n!total '!touch ran'\n!rcalc -e '$1=1' '!touch ran'\n!xform '!touch ran'\n!xform -n a '!touch ran'\n!replmarks -x '!touch ran' m keep\n!getinfo -c touch ran\n!rpict -o keep plain.rad\n!rcontrib -o '!touch ran' -m m plain.rad\n!obj2mesh keep ../escaped\n!rad evil.rif\n!radsight plugin list --plugin-path .\n!xform --allow-commands command.rad\n!/bin/sh -c 'touch ran'\n!./ran.sh\n!env touch ran\n",
    ),
    (
        "writes.rad",
        "!ies2rad -o ../escaped lamp.ies\n!ies2rad -o keep lamp.ies\n!gendaymtx -M keep weather.wea\nvoid plastic m 0 0 5 .5 .5 .5 0 0\nm sphere s 0 0 4 0 5 0 1\n",
    ),
    ("lamp.ies", "IESNA:LM-63-1995\nTILT=NONE\n1 1000 1 3 1 1 2 0 0 0\n1 1 50\n0 45 90\n0\n100 80 0\n"),
    (
        "weather.wea",
        "place x\nlatitude 40\nlongitude 75\ntime_zone 75\nsite_elevation 1\nweather_data_file_units 1\n6 21 12 800 100\n",
    ),
    ("replaced.rad", "#@radsight brdf m evil model 1\nvoid plastic m 0 0 5 .5 .5 .5 0 0\nm sphere s 0 0 4 0 5 0 1\n"),
    ("plugin.rad", "void brdfplugin m 2 evil model 0 0\nm sphere s 0 0 4 0 5 0 1\n"),
    ("path.rad", "void brdfplugin m 2 ./libevil.so model 0 0\nm sphere s 0 0 4 0 5 0 1\n"),
    ("outside.rad", "void brdfplugin m 2 ../work/libevil model 0 0\nm sphere s 0 0 4 0 5 0 1\n"),
    (
        "camera.toml",
        "[camera]\nposition_m = [0.0, 0.0, 0.0]\ndirection = [0.0, 1.0, 0.0]\nup = [0.0, 0.0, 1.0]\npixels = [2, 2]\npixel_pitch_um = [13.75, 16.0]\nfocal_distance_mm = 6.75\npinhole_diameter_mm = 0.1\nexposure_ms = 10.0\n",
    ),
    ("pane.obj", "mtllib !touch.ran\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ("ran.sh", "#!/bin/sh\ntouch ran\n"),
    ("commands.opt", "--allow-commands"),
    ("outputs.opt", "--allow-outputs -o ../escaped"),
    ("plugins.opt", "--allow-plugins"),
    ("folder.opt", "--plugin-path ."),
    ("brdf.opt", "--brdf m=evil:model(1)"),
    ("scene.opt", "-ab 0 !touch\tran"),
    ("nested.opt", "@commands.opt"),
    ("rayinit.cal", "x : system(touch ran);\n"),
];

impl Trap {
    fn new() -> Trap {
        let trap = Trap { folder: Folder::new() };
        trap.folder.file("precious", PRECIOUS);
        fs::create_dir(trap.folder.path("work")).expect("a folder");
        for (name, text) in FILES {
            trap.file(name, text);
        }
        #[cfg(unix)]
        {
            use std::os::unix::fs::{PermissionsExt, symlink};
            symlink("../precious", trap.work("link.mtx")).expect("a link");
            symlink("../precious", trap.work("link.dat")).expect("a link");
            symlink("..", trap.work("away")).expect("a link");
            fs::set_permissions(trap.work("ran.sh"), fs::Permissions::from_mode(0o755)).expect("permissions");
        }
        trap
    }

    fn work(&self, name: &str) -> PathBuf {
        self.folder.path("work").join(name)
    }

    fn file(&self, name: &str, text: impl AsRef<[u8]>) {
        fs::write(self.work(name), text).expect("a file is written");
    }

    fn exists(&self, name: &str) -> bool {
        fs::symlink_metadata(self.work(name)).is_ok()
    }

    fn run(&self, words: &[&str]) -> Run {
        self.run_with(words, b"0 0 0 0 1 0\n")
    }

    fn run_with(&self, words: &[&str], input: &[u8]) -> Run {
        run_with(command(words).current_dir(self.work("")), input)
    }

    /// Words as a shell splits those without quotation marks.
    fn run_line(&self, line: &str) -> Run {
        self.run(&line.split(' ').collect::<Vec<_>>())
    }

    /// All files and what they hold.
    fn state(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        fn add(folder: &Path, files: &mut BTreeMap<PathBuf, Vec<u8>>) {
            for entry in fs::read_dir(folder).expect("a folder is read") {
                let path = entry.expect("an entry").path();
                match fs::symlink_metadata(&path).expect("it is there") {
                    found if found.is_dir() => add(&path, files),
                    found if found.is_file() => drop(files.insert(path.clone(), fs::read(&path).expect("a file"))),
                    _ => drop(files.insert(path, Vec::new())),
                }
            }
        }
        let mut files = BTreeMap::new();
        add(&self.folder.path(""), &mut files);
        files
    }

    /// Removes what mkillum writes when nobody names it.
    fn remove_illum_data(&self) {
        for entry in fs::read_dir(self.work("")).expect("a folder is read") {
            let path = entry.expect("an entry").path();
            let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            if name.starts_with("illum") && name.ends_with(".dat") {
                fs::remove_file(path).expect("it was written");
            }
        }
    }

    /// Runs the program and checks that nothing came of it but messages and standard output.
    #[track_caller]
    fn leaves_no_trace(&self, words: &[&str], input: &[u8]) -> Run {
        let before = self.state();
        let run = self.run_with(words, input);
        if words[0] == "mkillum" {
            self.remove_illum_data();
        }
        let after = self.state();
        let changed: Vec<&PathBuf> = after
            .iter()
            .filter(|(path, bytes)| before.get(*path) != Some(bytes))
            .map(|(path, _)| path)
            .chain(before.keys().filter(|path| !after.contains_key(*path)))
            .collect();
        assert!(changed.is_empty(), "{words:?} changed {changed:?}: {}", run.messages);
        assert!(run.code >= 0, "{words:?} died: {}", run.messages);
        run
    }

    /// The same, and the program has to say why it did not.
    #[track_caller]
    fn refuses(&self, words: &[&str], message: &str) {
        let run = self.leaves_no_trace(words, b"0 0 0 0 1 0\n");
        assert_ne!(run.code, 0, "{words:?}: {}", run.messages);
        assert!(run.messages.contains(message), "{words:?} says no \"{message}\": {}", run.messages);
    }
}

/// The programs that read scenes, with `SCENE` where the hostile file stands.
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

/// A library whose first act is to leave a mark; `None` without a C compiler.
fn evil_library(trap: &Trap) -> Option<PathBuf> {
    trap.file(
        "evil.c",
        "#include <fcntl.h>\nconst char radsight_brdf_entry[256] = {0};\n__attribute__((constructor)) static void evil(void) { (void)!open(\"ran\", O_CREAT, 0600); }\n",
    );
    let library = trap.work(&format!("{}evil{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX));
    let mut compiler = Command::new(std::env::var("CC").unwrap_or_else(|_| "cc".to_owned()));
    let made = compiler.args(["-shared", "-fPIC", "-o"]).arg(&library).arg(trap.work("evil.c")).output().ok()?;
    made.status.success().then_some(library)
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
        // Those that render say why.
        for reader in ["rtrace", "rpict -x 4", "mkillum -ab 0", "rcontrib -m m"] {
            let words: Vec<&str> = reader.split(' ').chain(["lights.rad", scene]).collect();
            trap.refuses(&words, scene);
        }
    }
    let run = trap.leaves_no_trace(&["rtrace", "replaced.rad"], b"0 0 0 0 1 0\n");
    let library = format!("{}evil{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let expected = format!(
        "replaced.rad:1:19: error: library \"./{library}\" stands beside the scene and is not loaded: a scene is input, not a program
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
    // A name that the command line gives allows no other.
    let trap = Trap::new();
    if evil_library(&trap).is_some() {
        trap.refuses(&["rtrace", "--brdf", "m=builtin:ward(.5,.5,.5,.2)", "lights.rad", "plugin.rad"], "evil");
    }
}

#[test]
fn an_installed_plugin_works_without_a_word() {
    let folder = Folder::new();
    let installed = Folder::new();
    if support::c_plugin(&installed.path(""), "lambert.c", "chalk", &[]).is_none() {
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
fn receivers_write_only_new_files_below_the_current_folder() {
    let trap = Trap::new();
    let above = trap.folder.word("escaped");
    let fifo = Command::new("mkfifo").arg(trap.work("fifo")).status().is_ok_and(|status| status.success());
    let mut cases = vec![
        ("!touch ran", "it is a command"),
        ("!touch ran; cat", "it is a command"),
        ("|touch ran", "it is a command"),
        ("keep.mtx", "it is there already, and is not"),
        ("./keep.mtx", "it is there already, and is not"),
        ("../escaped", "it is not below the current folder"),
        ("away/escaped", "a symbolic link leads out of the current folder"),
        ("away/work/escaped", "new"),
        (above.as_str(), "it is not below the current folder"),
        ("link.mtx", "it is a symbolic link"),
        (".escaped", "it is hidden"),
        ("-rf", "it looks like an option"),
        ("/dev/stdout", "it is not below the current folder"),
        ("kee%s.mtx", "new"),
    ];
    if fifo {
        cases.push(("fifo", "it is a device or pipe"));
    }
    for (name, why) in cases {
        let receiver =
            format!("#@rfluxmtx h=u u=+Y o=\"{name}\"\nvoid glow p 0 0 4 1 1 1 0\np source s 0 0 4 0 0 1 180\n");
        trap.file("receiver.rad", receiver);
        let words = ["rfluxmtx", "-ab", "0", "-I+", "-", "receiver.rad", "plain.rad"];
        if why == "new" && name.starts_with("away") {
            // The link leads back into the folder.
            trap.run(&words).done();
            assert!(trap.exists("escaped"));
            fs::remove_file(trap.work("escaped")).expect("it was made");
        } else if why == "new" {
            trap.refuses(&words, "it is there already, and is not");
        } else {
            trap.refuses(&words, why);
            trap.refuses(&words, "receiver.rad:1:");
        }
    }
}

#[test]
fn names_of_modifiers_are_no_more_than_names() {
    let trap = Trap::new();
    for (modifier, pattern) in [
        ("!touch ran", "%s"),
        ("../escaped", "%s"),
        ("/tmp", "%s"),
        ("../escaped", "new_%s.mtx"),
        (".escaped", "%s.mtx"),
        ("$(touch ran)", "!cat > %s"),
        ("`touch ran`", "!echo %s > new.txt"),
        ("x;touch ran;", "!echo %s > new.txt"),
    ] {
        let quoted = format!("\"{modifier}\"");
        trap.file(
            "receiver.rad",
            format!("#@rfluxmtx h=u u=+Y\nvoid glow {quoted} 0 0 4 1 1 1 0\n{quoted} source s 0 0 4 0 0 1 180\n"),
        );
        trap.file("names", modifier.replace(' ', "\t"));
        trap.refuses(
            &["rfluxmtx", "-ab", "0", "-I+", "-o", pattern, "-", "receiver.rad", "plain.rad"],
            "comes from a file",
        );
        if !modifier.contains(' ') {
            trap.refuses(&["rcontrib", "-o", pattern, "-M", "names", "plain.rad"], "comes from a file");
        }
    }
    // A plain name goes where the user says, outside of the folder too.
    trap.file("names", "m");
    trap.run(&["rcontrib", "-o", "../out_%s.dat", "-M", "names", "plain.rad"]).done();
    trap.run(&["rcontrib", "-o", "!cat > cat_%s.dat", "-M", "names", "plain.rad"]).done();
    assert!(trap.exists("../out_m.dat") && trap.exists("cat_m.dat"));
}

#[test]
fn the_command_line_allows_what_receivers_name() {
    let receiver = |name: &str| {
        format!("#@rfluxmtx h=u u=+Y o=\"{name}\"\nvoid glow p 0 0 4 1 1 1 0\np source s 0 0 4 0 0 1 180\n")
    };
    for (options, name, made) in [
        ("", "new.mtx", "new.mtx"),
        ("", "new_%s.mtx", "new_p.mtx"),
        ("-fo", "keep.mtx", "keep.mtx"),
        ("--allow-outputs -fo+", "../escaped", "../escaped"),
        ("--allow-commands", "!cat > new.txt", "new.txt"),
        ("-fo", "/dev/null", "keep"),
    ] {
        let trap = Trap::new();
        trap.file("receiver.rad", receiver(name));
        let line = format!("rfluxmtx -ab 0 -I+ {options} - receiver.rad plain.rad").replace("  ", " ");
        trap.run_line(&line).done();
        assert!(trap.exists(made), "{line}");
        if name.starts_with("new.mtx") {
            // What the same receiver made before is made again; what another one made is not replaced.
            trap.run_line(&line).done();
            fs::copy(trap.work("receiver.rad"), trap.work("other.rad")).expect("a copy");
            let words = line.replace("receiver.rad", "other.rad");
            trap.refuses(&words.split(' ').collect::<Vec<_>>(), "is not what \"other.rad\" made");
        }
        if name != "/dev/null" {
            assert_ne!(fs::read(trap.work(made)).expect("it was made"), PRECIOUS.as_bytes(), "{line}");
        }
    }
}

#[test]
fn illum_comments_write_only_new_files_below_the_current_folder() {
    let trap = Trap::new();
    for (comment, why) in [
        ("o=../escaped", "it is not below the current folder"),
        ("o=/tmp/radsight_escaped", "it is not below the current folder"),
        ("o=keep.rad", "is not scene text of mkillum"),
        ("o=away/escaped", "a symbolic link leads out"),
        ("o=link.mtx", "it is a symbolic link"),
        ("o=.escaped", "it is hidden"),
        ("o=!touch", "it is a command"),
        ("f=../escaped", "it is not below the current folder"),
        ("m=../escaped", "it is not below the current folder"),
        ("f=keep", "is not data of mkillum"),
        ("f=link", "it is a symbolic link"),
        ("f=away/escaped", "a symbolic link leads out"),
        ("f=.escaped", "it is hidden"),
        ("c=d f=../escaped", "it is not below the current folder"),
    ] {
        trap.file("window.rad", format!("#@mkillum d=1 s=1 {comment}\nm polygon w 0 0 9 0 1 0 1 1 0 1 1 1\n"));
        trap.refuses(&["mkillum", "-ab", "0", "sky.rad", "<", "window.rad"], why);
    }
    trap.file("window.rad", "#@mkillum d=1 s=1 f=../said o=../said.rad\nm polygon w 0 0 9 0 1 0 1 1 0 1 1 1\n");
    trap.run(&["mkillum", "-ab", "0", "--allow-outputs", "sky.rad", "<", "window.rad"]).done();
    assert!(trap.exists("../said.dat") && trap.exists("../said.rad"), "the command line allows outputs");
}

#[test]
fn mkillum_replaces_what_it_made_before() {
    let trap = Trap::new();
    let window =
        "void glass m 0 0 3 .9 .9 .9\n#@mkillum d=2 s=1 f=win o=made.rad\nm polygon w 0 0 9 -1 1 0 1 1 0 1 1 1\n";
    trap.file("window.rad", window);
    let words = ["mkillum", "-ab", "0", "sky.rad", "<", "window.rad"];
    trap.run(&words).done();
    let first = fs::read(trap.work("made.rad")).expect("it was made");
    assert!(trap.exists("win.dat"));
    trap.run(&words).done();
    assert_eq!(fs::read(trap.work("made.rad")).expect("it was made again"), first);
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
        "-o f%d",
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
        "option \"--allow-commands\" comes from a file and is not obeyed\nhint: only the command line itself may give it",
    );
    // What the command line itself says holds for the file's words, too; a variable is the user's own.
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
        // One of our own does again what it did.
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
    // A name of the same length stands for the command.
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

const PROJECT: &str = "scene= plain.rad\nZONE= I -4 4 0 8 0 3\nRES= 4\nview= v -vp 0 0 0 -vd 0 1 0\n";

#[test]
fn projects_run_no_commands_and_widen_nothing() {
    let trap = Trap::new();
    let has_library = evil_library(&trap).is_some();
    // Anything that the project makes before it is refused is its own.
    let own = |name: &str| name.starts_with("evil.oct") || name.starts_with("evil_") || name.starts_with("evil0");
    for line in [
        "oconv= --allow-commands\nscene= command.rad",
        "oconv= oconv --allow-commands\nscene= command.rad",
        "scene= command.rad",
        "scene= \"!touch ran\"",
        "scene= !touch ran",
        "objects= \"!touch ran\"",
        "materials= \"!touch ran\"",
        "illum= \"!touch ran\"",
        "illum= command.rad\nmkillum= --allow-commands",
        "oconv= /bin/sh",
        "oconv= touch ran;oconv",
        "oconv= ./ran.sh",
        "oconv= ./ran.sh -f",
        "rpict= ./ran.sh",
        "rpict= touch ran",
        "pfilt= ./ran.sh",
        "pfilt= -1 !touch",
        "mkillum= ./ran.sh\nillum= lights.rad",
        "mkpmap= ./ran.sh\nPGMAP= x.pm 10",
        "rpict= -ps 1 \"!touch ran\"",
        "render= \"!touch ran\"",
        "render= --allow-commands \"!touch ran\"",
        "render= --words-of-file rpict \"!touch ran\"",
        "render= @commands.opt",
        "render= $(touch\tran)",
        "render= `touch\tran`",
        "render= --plugin-path .\nscene= replaced.rad",
        "render= --allow-plugins\nscene= replaced.rad",
        "view= w -vp 0 0 0 \"!touch ran\"",
        "view= w -vf !touch",
        "OCTREE= !touch ran",
        "OCTREE= \"a.oct;touch ran\"",
        "PICTURE= \"a;touch ran\"",
        "PICTURE= $(touch\tran)",
    ] {
        if line.contains("replaced") && !has_library {
            continue;
        }
        trap.file("evil.rif", format!("{PROJECT}{line}\n"));
        let before = trap.state();
        let run = trap.run(&["rad", "-w", "evil.rif"]);
        assert!(!trap.exists("ran"), "{line}: {}", run.messages);
        assert!(run.code >= 0, "{line}: {}", run.messages);
        let after = trap.state();
        for (path, bytes) in &before {
            assert_eq!(after.get(path), Some(bytes), "{line} changed {path:?}: {}", run.messages);
        }
        for path in after.keys().filter(|path| !before.contains_key(*path)) {
            let name = path.strip_prefix(trap.work("")).map(|name| name.display().to_string());
            let is_own = name.is_ok_and(|name| own(&name) || line.contains("PICTURE") || line.contains("a.oct"));
            assert!(is_own, "{line} made {path:?}: {}", run.messages);
            fs::remove_file(path).expect("it was made");
        }
    }
    trap.file("evil.rif", format!("{PROJECT}scene= command.rad\n"));
    trap.run(&["rad", "--allow-commands", "-w", "evil.rif"]).done();
    assert!(trap.exists("ran"), "the command line allows commands");
}

#[test]
fn projects_write_only_what_is_theirs() {
    let trap = Trap::new();
    let above = trap.folder.word("escaped");
    let absolute = format!("PICTURE= {above}");
    for line in [
        "OCTREE= keep.oct",
        "OCTREE= keep",
        "OCTREE= ../escaped.oct",
        "OCTREE= away/escaped.oct",
        "OCTREE= link.mtx",
        "OCTREE= -f",
        "OCTREE= .escaped",
        "PICTURE= keep",
        "PICTURE= ../escaped",
        absolute.as_str(),
        "PICTURE= away/escaped",
        "RAWFILE= keep",
        "RAWFILE= ../escaped",
        "RAWFILE= keep\nPICTURE= keep",
        "ZFILE= keep",
        "ZFILE= ../escaped",
        "OPTFILE= keep",
        "OPTFILE= plain.rad",
        "OPTFILE= ../escaped",
        "OPTFILE= .bashrc",
        "AMBFILE= keep.amb\nINDIRECT= 1",
        "REPORT= 1 keep",
        "REPORT= 1 ../escaped",
        "view= ../../escaped -vp 0 0 0",
        "view= /../../escaped -vp 0 0 0",
        "rpict= -o keep",
        "rpict= -o ../escaped",
        "rpict= -z ../escaped",
        "rpict= -e keep",
        "rpict= -ro keep_v.unf",
        "rpict= -P ../escaped",
        "render= -o ../escaped > keep",
        "render= > keep",
        "pfilt= > ../escaped",
        "OPTFILE= new.opt\nrender= -z ../escaped",
    ] {
        for options in [&[][..], &["-n"], &["-t"]] {
            // Old enough that everything is made again.
            let old = trap.state();
            trap.file("evil.rif", format!("{PROJECT}{line}\n"));
            let run = trap.run(&[&["rad", "-w"], options, &["evil.rif"]].concat());
            let after = trap.state();
            for (path, bytes) in &old {
                let is_own = path.ends_with("evil.rif");
                assert!(is_own || after.get(path) == Some(bytes), "{line} changed {path:?}: {}", run.messages);
            }
            for path in after.keys().filter(|path| !old.contains_key(*path)) {
                let name = path.strip_prefix(trap.work("")).map(|name| name.display().to_string());
                let is_own = name.is_ok_and(|name| name.starts_with("evil") || name == "new.opt");
                assert!(is_own, "{line} made {path:?}: {}", run.messages);
                fs::remove_file(path).expect("it was made");
            }
        }
    }
}

/// Makes a file as old as it gets.
fn age(path: &Path) {
    let file = fs::File::options().append(true).open(path).expect("a file is opened");
    file.set_modified(std::time::SystemTime::UNIX_EPOCH + std::time::Duration::from_secs(1_000_000)).expect("a date");
}

#[test]
fn projects_make_again_what_they_made_before() {
    let trap = Trap::new();
    fs::create_dir(trap.work("out")).expect("a folder");
    let project = format!(
        "{PROJECT}OCTREE= out/room.oct\nPICTURE= out/room\nRAWFILE= out/raw\nZFILE= out/room\nOPTFILE= out/room.opt\nREPORT= 0 out/log\nINDIRECT= 1\nAMBFILE= out/room.amb\n"
    );
    trap.file("room.rif", project);
    let names = ["room.oct", "room_v.hdr", "room_v.zbf", "room.opt", "log"].map(|name| format!("out/{name}"));
    trap.run(&["rad", "-w", "room.rif"]).done();
    for turn in 0..2 {
        let before = names.clone().map(|name| fs::read(trap.work(&name)).expect("it was made"));
        names.iter().for_each(|name| age(&trap.work(name)));
        let text = fs::read_to_string(trap.work("plain.rad")).expect("a scene");
        trap.file("plain.rad", format!("{text}m sphere another{turn} 0 0 4 {turn} 4 0 .5\n"));
        trap.run(&["rad", "-w", "room.rif"]).done();
        let after = names.clone().map(|name| fs::read(trap.work(&name)).expect("it was made again"));
        assert!(before[0] != after[0] && before[1] != after[1], "octree and picture are new");
    }
    // A picture of somebody else's octree stays.
    trap.file("other.rif", format!("{PROJECT}PICTURE= out/room\n"));
    names.iter().for_each(|name| age(&trap.work(name)));
    trap.refuses(&["rad", "-w", "other.rif"], "is not what \"other.rif\" made");
    trap.run(&["rad", "-w", "--allow-outputs", "other.rif"]).done();
    trap.run(&["rad", "-w", "other.rif", "PICTURE=../said"]).done();
    assert!(trap.exists("../said_v.hdr"), "the command line may name any file");
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
    ] {
        let words: Vec<&str> = ["--words-of-file"].into_iter().chain(line.split(' ')).collect();
        let run = trap.leaves_no_trace(&words, b"1 2 3\n");
        assert_ne!(run.code, 0, "{line}");
    }
    trap.run(&["--allow-commands", "--words-of-file", "rtrace", "command.rad"]).done();
    assert!(trap.exists("ran"));
}

#[test]
fn processes_start_and_libraries_load_in_known_places_only() {
    let places = [
        ("Command::new(", &["src/trust/mod.rs"][..]),
        ("Registry::new(", &["src/commands/plugin.rs", "src/plugins.rs"]),
        ("SearchPath::default(", &["src/plugins.rs"]),
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
