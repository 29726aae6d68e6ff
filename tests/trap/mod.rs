//! A folder with hostile files, and programs that run in it.

// Each test file is a program of its own and uses a part of this.
#![allow(dead_code)]

use crate::program::{Folder, Run, command, run_with};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A folder with hostile files. Programs run in its folder `work`.
pub(crate) struct Trap {
    pub(crate) folder: Folder,
}

/// Files that must not change.
pub(crate) const PRECIOUS: &str = "years of work\n";

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
    pub(crate) fn new() -> Trap {
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

    pub(crate) fn work(&self, name: &str) -> PathBuf {
        self.folder.path("work").join(name)
    }

    pub(crate) fn file(&self, name: &str, text: impl AsRef<[u8]>) {
        fs::write(self.work(name), text).expect("a file is written");
    }

    pub(crate) fn exists(&self, name: &str) -> bool {
        fs::symlink_metadata(self.work(name)).is_ok()
    }

    pub(crate) fn run(&self, words: &[&str]) -> Run {
        self.run_with(words, b"0 0 0 0 1 0\n")
    }

    pub(crate) fn run_with(&self, words: &[&str], input: &[u8]) -> Run {
        run_with(command(words).current_dir(self.work("")), input)
    }

    /// Splits words as a shell does, without quotes.
    pub(crate) fn run_line(&self, line: &str) -> Run {
        self.run(&line.split(' ').collect::<Vec<_>>())
    }

    /// All files and their content.
    pub(crate) fn state(&self) -> BTreeMap<PathBuf, Vec<u8>> {
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

    /// Removes the default output of mkillum.
    pub(crate) fn remove_illum_data(&self) {
        for entry in fs::read_dir(self.work("")).expect("a folder is read") {
            let path = entry.expect("an entry").path();
            let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            if name.starts_with("illum") && name.ends_with(".dat") {
                fs::remove_file(path).expect("it was written");
            }
        }
    }

    /// Runs the program and checks that it has only written messages and standard output.
    #[track_caller]
    pub(crate) fn leaves_no_trace(&self, words: &[&str], input: &[u8]) -> Run {
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

    /// The same, and the program must report the reason.
    #[track_caller]
    pub(crate) fn refuses(&self, words: &[&str], message: &str) {
        let run = self.leaves_no_trace(words, b"0 0 0 0 1 0\n");
        assert_ne!(run.code, 0, "{words:?}: {}", run.messages);
        assert!(run.messages.contains(message), "{words:?} says no \"{message}\": {}", run.messages);
    }
}

/// A library that leaves a mark when it is loaded; `None` without a C compiler.
pub(crate) fn evil_library(trap: &Trap) -> Option<PathBuf> {
    trap.file(
        "evil.c",
        "#include <fcntl.h>\nconst char radsight_brdf_entry[256] = {0};\n__attribute__((constructor)) static void evil(void) { (void)!open(\"ran\", O_CREAT, 0600); }\n",
    );
    let library = trap.work(&format!("{}evil{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX));
    let mut compiler = Command::new(std::env::var("CC").unwrap_or_else(|_| "cc".to_owned()));
    let made = compiler.args(["-shared", "-fPIC", "-o"]).arg(&library).arg(trap.work("evil.c")).output().ok()?;
    made.status.success().then_some(library)
}
