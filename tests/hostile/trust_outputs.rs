//! Outputs named by receivers, comments of `mkillum` and projects of `rad` are new and below the
//! current folder, or earlier results of the same work; and projects run no commands.
//! `docs/security.md` has the rules.

use crate::trap::{PRECIOUS, Trap, evil_library};
use std::fs;
use std::path::Path;
use std::process::Command;

#[test]
fn receivers_write_only_new_files_below_the_current_folder() {
    let trap = Trap::new();
    let above = trap.folder.word("escaped");
    let fifo = Command::new("mkfifo").arg(trap.work("fifo")).status().is_ok_and(|status| status.success());
    let mut cases = vec![
        ("!touch ran", "it is a command"),
        ("!touch ran; cat", "it is a command"),
        ("|touch ran", "it is a command"),
        ("keep.mtx", "it exists and is not"),
        ("./keep.mtx", "it exists and is not"),
        ("../escaped", "it is not below the current folder"),
        ("away/escaped", "a symbolic link leads out of the current folder"),
        ("away/work/escaped", "new"),
        (above.as_str(), "it is not below the current folder"),
        ("link.mtx", "it is a symbolic link"),
        (".escaped", "it is hidden"),
        ("-rf", "it looks like an option"),
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
        if why == "it is a command" && name.starts_with('!') {
            trap.refuses(&words, "hint: --allow-commands lets input files run commands");
        }
        if why == "new" && name.starts_with("away") {
            // The link leads back into the folder.
            trap.run(&words).done();
            assert!(trap.exists("escaped"));
            fs::remove_file(trap.work("escaped")).expect("it was made");
        } else if why == "new" {
            trap.refuses(&words, "it exists and is not");
        } else {
            trap.refuses(&words, why);
            trap.refuses(&words, "receiver.rad:1:");
        }
    }
}

#[test]
fn names_of_modifiers_are_no_more_than_names() {
    let trap = Trap::new();
    let above = trap.folder.word("escaped");
    for (modifier, pattern) in [
        ("!touch ran", "%s"),
        ("../escaped", "%s"),
        (above.as_str(), "%s"),
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
    // A plain name may be outside the folder, where the user chooses.
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
    ] {
        let trap = Trap::new();
        trap.file("receiver.rad", receiver(name));
        let line = format!("rfluxmtx -ab 0 -I+ {options} - receiver.rad plain.rad").replace("  ", " ");
        trap.run_line(&line).done();
        assert!(trap.exists(made), "{line}");
        if name.starts_with("new.mtx") {
            // An earlier result of the same receiver is replaced; that of another one is not.
            trap.run_line(&line).done();
            fs::copy(trap.work("receiver.rad"), trap.work("other.rad")).expect("a copy");
            let words = line.replace("receiver.rad", "other.rad");
            trap.refuses(&words.split(' ').collect::<Vec<_>>(), "is not made by \"other.rad\"");
        }
        assert_ne!(fs::read(trap.work(made)).expect("it was made"), PRECIOUS.as_bytes(), "{line}");
    }
}

#[test]
fn illum_comments_write_only_new_files_below_the_current_folder() {
    let trap = Trap::new();
    let above = format!("o={}", trap.folder.word("escaped"));
    for (comment, why) in [
        ("o=../escaped", "it is not below the current folder"),
        (above.as_str(), "it is not below the current folder"),
        ("o=keep.rad", "is not scene text from mkillum"),
        ("o=away/escaped", "a symbolic link leads out"),
        ("o=link.mtx", "it is a symbolic link"),
        ("o=.escaped", "it is hidden"),
        ("o=!touch", "it is a command"),
        ("f=../escaped", "it is not below the current folder"),
        ("m=../escaped", "it is not below the current folder"),
        ("f=keep", "is not data from mkillum"),
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

const PROJECT: &str = "scene= plain.rad\nZONE= I -4 4 0 8 0 3\nRES= 4\nview= v -vp 0 0 0 -vd 0 1 0\n";

#[test]
fn projects_run_no_commands_and_widen_nothing() {
    let trap = Trap::new();
    let has_library = evil_library(&trap).is_some();
    // Files that the project writes before the refusal are its own.
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
            // Old enough that everything is rebuilt.
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
        trap.file("plain.rad", format!("{text}m sphere another{turn} 0 0 4 {turn} 4 0 1\n"));
        trap.run(&["rad", "-w", "room.rif"]).done();
        let after = names.clone().map(|name| fs::read(trap.work(&name)).expect("it was made again"));
        assert!(before[0] != after[0] && before[1] != after[1], "octree and picture are new");
    }
    // A picture of another project stays.
    trap.file("other.rif", format!("{PROJECT}PICTURE= out/room\n"));
    names.iter().for_each(|name| age(&trap.work(name)));
    trap.refuses(&["rad", "-w", "other.rif"], "is not made by \"other.rif\"");
    trap.run(&["rad", "-w", "--allow-outputs", "other.rif"]).done();
    trap.run(&["rad", "-w", "other.rif", "PICTURE=../said"]).done();
    assert!(trap.exists("../said_v.hdr"), "the command line may name any file");
}

#[cfg(unix)]
#[test]
fn links_in_the_folder_of_a_project_lead_nowhere() {
    for link in ["evil.oct", "evil_v.unf", "evil_v.hdr"] {
        let trap = Trap::new();
        std::os::unix::fs::symlink("../precious", trap.work(link)).expect("a link");
        age(&trap.folder.path("precious"));
        trap.file("evil.rif", PROJECT);
        let run = trap.run(&["rad", "-w", "evil.rif"]);
        assert_eq!(trap.folder.read("precious"), PRECIOUS.as_bytes(), "{link}: {}", run.messages);
        assert!(run.messages.contains("it is a symbolic link"), "{link}: {}", run.messages);
    }
}

#[test]
fn a_name_that_is_refused_is_shown_where_it_stands() {
    let trap = Trap::new();
    trap.file("evil.rif", format!("# mine\n{PROJECT}  OCTREE= ../escaped.oct # not mine\n"));
    let run = trap.run(&["rad", "evil.rif"]);
    let expected = "\
evil.rif:6:3: error: \"../escaped.oct\" comes from a file and is not written: it is not below the current folder
  6 |   OCTREE= ../escaped.oct # not mine
    |   ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
hint: --allow-outputs lets input files name any output; by default only new files below the current folder
";
    assert_eq!((run.messages.as_str(), run.code), (expected, 1));
}

#[cfg(unix)]
#[test]
fn links_where_contributions_are_written_aside_lead_nowhere() {
    let trap = Trap::new();
    std::os::unix::fs::symlink("../precious", trap.work(".new.mtx.part")).expect("a link");
    for options in ["", "-fo+ ", "-r "] {
        let line = format!("rcontrib {options}-fd -o new.mtx -m m plain.rad");
        let run = trap.run_line(&line);
        assert_eq!(trap.folder.read("precious"), PRECIOUS.as_bytes(), "{line}: {}", run.messages);
    }
}

#[test]
fn a_scene_that_is_read_again_writes_the_same_again() {
    let trap = Trap::new();
    trap.file("lamps.rad", "!ies2rad -o new lamp.ies\n");
    let first = trap.run(&["xform", "lamps.rad"]).text();
    assert!(trap.exists("new.rad") || trap.exists("new.dat"), "{first}");
    assert_eq!(trap.run(&["xform", "lamps.rad"]).text(), first);
    for file in ["new.rad", "new.dat"].into_iter().filter(|file| trap.exists(file)) {
        trap.file(file, PRECIOUS);
    }
    trap.refuses(&["xform", "lamps.rad"], "it exists");
}
