//! The table of options and the programs: each option of the table is one of its program, with as
//! many values, and there are no others; help, `-defaults`, manual pages and completions are
//! generated from the same table.

use crate::program::{Folder, ROOM, Run, command, radsight, run_with};
use radsight_options::{OptionForm, Program, ProgramOption, programs};
use radsight_test_support::Radiance;
use std::process::Command;

/// An option that no program has: a program that reports it has used all words before it.
const NO_OPTION: &str = "--zz-no-such";

/// The words before the options of programs that parse these last.
const BEFORE: [(&str, &str); 8] = [
    ("genbox", "m n 1 1 1"),
    ("genblinds", "m n 1 1 1 3 10"),
    ("genprism", "m n 3 0 0 1 0 0 1"),
    ("genrev", "m n t 1 3"),
    ("gensurf", "m n s t 0 2 2"),
    ("genworm", "m n t 0 0 .1 3"),
    ("gensky", "6 21 12"),
    ("gendaylit", "6 21 12"),
];

/// Known options that are rejected with an explanation.
const REFUSED: [(&str, &str); 9] = [
    ("rpict", "-ap"),
    ("rtrace", "-ap"),
    ("rcontrib", "-ap"),
    ("mkillum", "-ap"),
    ("rpict", "-co"),
    ("rad", "-o"),
    ("ra_tiff", "-l"),
    ("falsecolor", "-spec"),
    ("rcontrib", "--error"),
];

/// Options whose remaining words are all values, or which read their file at once and find it
/// invalid.
const STAND_LAST: [(&str, &str); 5] =
    [("getinfo", "-a"), ("getinfo", "-r"), ("getinfo", "-c"), ("pcond", "-f"), ("pcond", "-m")];

/// A value for each name of a value in the table.
fn value(program: &str, option: &ProgramOption, name: &str) -> &'static str {
    match (option.name, name) {
        ("-vf", _) => "a.vf",
        ("-aE" | "-aI" | "-tI" | "-tE", _) => "names.txt",
        ("-M", _) if program == "rcontrib" => "names.txt",
        ("-a" | "-l", "FILE") => "materials.rad",
        ("-af", _) => "made.out",
        ("-o" | "-z" | "-r" | "-ro" | "-x" | "-P" | "-D" | "-M", "FILE") => "made.out",
        ("--error-map" | "--ray-map" | "--record" | "--allow-output", _) => "made.out",
        ("-pal", _) => "def",
        ("-i" | "-o", "FORMAT") => "a ${a} b",
        ("-f", _) if program == "xform" => "transforms.txt",
        ("-d", _) if program == "mksource" => "64",
        ("-mt" | "-m", "MATRIX") => "defs.cal",
        ("-m", "FILE") if program == "obj2rad" => "mapping.txt",
        (_, "FILE" | "FONT" | "OCTREE" | "MESH" | "DIR") => "defs.cal",
        (_, "FILE|DEFINITION" | "DEFINITION" | "DEFINITIONS") => "a:1",
        (_, "EXPRESSION" | "EXPR") => {
            if program == "falsecolor" {
                "v"
            } else if option.name == "-e" {
                "a=1"
            } else {
                "1"
            }
        }
        (_, "RX") => ".64",
        (_, "RY") => ".33",
        (_, "GX") => ".29",
        (_, "GY") => ".6",
        (_, "BX") => ".15",
        (_, "BY") => ".06",
        (_, "WX" | "WY") => ".333",
        (_, "FIRST") => "380",
        (_, "LAST") => "780",
        (_, "J" | "M" | "G") => "0.5",
        (_, "MATERIAL=LIBRARY:MODEL(…)") => "a=b:c()",
        (_, "NAME=VALUE,…") => "A=1",
        (_, "NAME=TEXT") => "a=b",
        (_, "RxC[xR1xC1…]") => "2x3",
        (_, "0|1|2") => "0",
        (_, "LETTERS|FILE") => "RGB",
        (_, "TOP|auto" | "N|/R") => "10",
        (_, "±N" | "±N|auto|human|linear") => "+1",
        (_, "OPTIONS") => "-h",
        (_, "COMMAND") => "cat",
        (_, "MODIFIER" | "NAME" | "MATERIAL" | "LAMP" | "LABEL" | "LINE" | "VIEW" | "DRIVER") => "name",
        _ => "3",
    }
}

/// Text to attach to an option.
fn attached(program: &str, name: &str) -> &'static str {
    match (program, name) {
        (_, "-vt") => "v",
        (_, "=") => "+-",
        ("rtrace", "-o") => "v",
        ("total", "-") => "5",
        ("total", "-s") => "2",
        (_, "-t") => ",",
        ("pcomb", "-f") => "f",
        ("ies2rad", "-d") => "m",
        ("falsecolor", _) => "",
        _ => "a",
    }
}

/// All spellings of an option, each with its values.
fn spellings(program: &Program, option: &ProgramOption) -> Vec<Vec<String>> {
    let values = option.values.split_whitespace().map(|name| value(program.name, option, name).to_owned());
    let values: Vec<String> = if option.value_count() > 0 { values.collect() } else { Vec::new() };
    let with_values = |word: String| std::iter::once(word).chain(values.iter().cloned()).collect::<Vec<String>>();
    let words: Vec<String> = option
        .names()
        .flat_map(|name| match option.form {
            OptionForm::Switch => ["", "+", "-", "1", "0"].map(|state| format!("{name}{state}")).to_vec(),
            OptionForm::Attached => vec![format!("{name}{}", attached(program.name, option.name))],
            OptionForm::Signed => vec![name.to_owned(), format!("+{}", &name[1..])],
            OptionForm::Word | OptionForm::Beginning => vec![name.to_owned()],
        })
        .collect();
    words.into_iter().map(with_values).collect()
}

fn bench() -> Folder {
    let folder = Folder::new();
    folder.file("a.vf", "rview -vtv -vp 0 0 0 -vd 0 1 0 -vu 0 0 1 -vh 45 -vv 45\n");
    folder.file("names.txt", "one\ntwo\n");
    folder.file("transforms.txt", "-t 0 0 1\n");
    folder.file("materials.rad", "void plastic one 0 0 5 .5 .5 .5 0 0\n");
    folder.file("defs.cal", "twice(x):2*x;\n");
    folder.file("mapping.txt", "one (Material \"one\");\n");
    folder
}

fn run_in(folder: &Folder, words: &[String]) -> Run {
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    run_with(command(&words).current_dir(folder.path("")), b"#?RADIANCE\n\n")
}

fn is_among(list: &[(&str, &str)], program: &Program, option: &ProgramOption) -> bool {
    list.contains(&(program.name, option.name))
}

/// The words before an option on the command line.
fn before(program: &Program, option: &ProgramOption) -> Vec<String> {
    let operands = BEFORE.iter().find(|(name, _)| *name == program.name && option.name != "-ang");
    let operands = operands.map_or("", |(_, operands)| operands);
    std::iter::once(program.name).chain(operands.split_whitespace()).map(str::to_owned).collect()
}

#[test]
fn every_option_of_the_table_is_read_by_its_program_with_its_values() {
    let folder = bench();
    let mut wrong = Vec::new();
    for program in programs() {
        for option in program.options().filter(|option| option.name != "--help") {
            for spelling in spellings(program, option) {
                let words = [before(program, option), spelling.clone(), vec![NO_OPTION.to_owned()]].concat();
                let run = run_in(&folder, &words);
                let complains = run.code == 2 && run.messages.contains(NO_OPTION);
                let is_right = match option.name {
                    "-defaults" if spelling[0] == "-help" || program.name.starts_with("gen") => true,
                    "-defaults" | "-version" => run.code == 0,
                    "-features" => run.code == 1 && run.messages.contains("missing feature"),
                    _ if is_among(&REFUSED, program, option) && !complains => {
                        run.code != 0 && !run.messages.contains("hint: ") && run.messages.contains(option.name)
                    }
                    _ if is_among(&STAND_LAST, program, option) => !run.messages.contains("is not supported"),
                    _ => complains,
                };
                if !is_right {
                    wrong.push(format!("{words:?}: {} {}", run.code, run.messages));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} of the table's options are not their programs':\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn every_program_answers_help_with_its_options() {
    for program in programs() {
        let help = radsight(&[program.name, "--help"]).text();
        assert!(help.starts_with(&format!("{}: ", program.name)) && help.contains(program.synopsis), "{help}");
        for option in program.options() {
            assert!(help.contains(&option.usage()), "{} says nothing of {}", program.name, option.name);
        }
        assert!(help.lines().all(|line| line.starts_with("Usage: ") || line.chars().count() <= 100), "{help}");
    }
}

#[test]
fn an_unknown_option_is_reported_with_the_nearest_one() {
    for (words, hint) in [
        ("rpict --sampels 4 a.rad", "hint: did you mean \"--samples\"?"),
        ("rtrace -ABx a.rad", "hint: did you mean \"-ab\"?"),
        ("pflip -V a.hdr", "hint: did you mean \"-v\"?"),
        ("ra_ppm -q a.hdr", "hint: expected -r -a -b -s -g -e"),
        ("rcontrib -q a.rad", "hint: \"rcontrib --help\" lists the options"),
        ("genclock -q 3", "unknown option \"-q\""),
    ] {
        let run = radsight(&words.split_whitespace().collect::<Vec<_>>());
        assert!(run.code == 2 && run.messages.contains(hint), "{words}: {} {}", run.code, run.messages);
    }
}

#[test]
fn defaults_are_printed_as_the_real_programs_print_them() {
    let Some(radiance) = Radiance::find() else { return };
    for program in ["rtrace", "rpict", "rcontrib", "mkillum"] {
        let real = run_with(&mut radiance.command(program, &["-defaults"]), b"").text();
        let ours = radsight(&[program, "-defaults"]).text();
        // The number of processors depends on the machine, and only radsight has a seed.
        let kept = |text: &str| -> Vec<String> {
            text.lines().filter(|line| !line.starts_with("-n ") && !line.starts_with("--")).map(str::to_owned).collect()
        };
        assert_eq!(kept(&ours), kept(&real), "{program}");
    }
}

/// The default of each option that has one, as words of a command line.
fn words_of_defaults(program: &Program) -> Vec<String> {
    let given = program.options().filter(|option| !program.default_of(option).is_empty());
    let words = given.flat_map(|option| {
        let default = program.default_of(option);
        match option.form {
            OptionForm::Switch | OptionForm::Attached => vec![format!("{}{default}", option.name)],
            _ => std::iter::once(option.name).chain(default.split_whitespace()).map(str::to_owned).collect(),
        }
    });
    words.collect()
}

#[test]
fn defaults_of_the_table_are_those_of_the_programs() {
    let folder = Folder::new();
    folder.file("room.rad", ROOM);
    let view = "-vp 0 -3 1 -vd 0 1 -.2 -x 20 -y 14 -ab 1 room.rad";
    for (name, more, input) in [
        ("rpict", view, ""),
        ("rtrace", "-ab 1 room.rad", "0 -3 1 0 1 -.2\n0 4 1 .1 .3 -1\n"),
        ("rcontrib", "-m light room.rad", "0 -3 1 0 1 -.2\n0 4 1 .1 .3 -1\n"),
    ] {
        let program = radsight_options::program(name).expect("a program");
        let made = |options: Vec<String>| {
            let words = [vec![name.to_owned()], options, more.split(' ').map(str::to_owned).collect()].concat();
            let words: Vec<&str> = words.iter().map(String::as_str).collect();
            let made = run_with(command(&words).current_dir(folder.path("")), input.as_bytes()).done();
            // The header has the command line.
            let end = made.windows(2).position(|pair| pair == b"\n\n").expect("a header");
            made[end..].to_vec()
        };
        assert!(made(Vec::new()) == made(words_of_defaults(program)), "{name}: other values than by the table");
    }
}

/// Runs a checker on a file, if the checker is installed.
fn check(checker: &str, words: &[&str], file: &str) -> Option<Run> {
    let is_there = Command::new("sh").args(["-c", &format!("command -v {checker}")]).output();
    is_there
        .is_ok_and(|found| found.status.success())
        // In the locale C the pages have characters that the terminal of `man` lacks.
        .then(|| run_with(Command::new(checker).env("LC_ALL", "C.UTF-8").args(words).arg(file), b""))
}

#[test]
fn manual_pages_and_completions_are_installed_beside_the_links() {
    let folder = Folder::new();
    let bin = folder.word("bin");
    let made = radsight(&["install-links", &bin]).text();
    let mut pages = 0;
    for file in made.lines().filter(|line| line.contains("/share/")) {
        let text = std::fs::read_to_string(file).expect("an installed file is text");
        assert!(text.contains("radsight"), "{file} has no mark");
        let checked = match file {
            _ if file.contains("/man1/") => {
                pages += 1;
                assert!(text.contains(".SH NAME") && text.contains(".SH SYNOPSIS"), "{file}");
                check("mandoc", &["-T", "lint", "-W", "error"], file)
                    .or_else(|| check("man", &["--warnings", "-l"], file))
            }
            _ if file.contains("/bash-completion/") => check("bash", &["-n"], file),
            _ if file.contains("/zsh/") => check("zsh", &["-n"], file),
            _ => check("fish", &["-n"], file),
        };
        if let Some(run) = checked {
            assert!(run.code == 0 && run.messages.is_empty(), "{file}: {}", run.messages);
        }
    }
    assert!(pages > programs().len(), "{pages} pages of {} programs and radsight", programs().len());
    for program in programs() {
        assert!(folder.path("bin").join(program.name).is_symlink(), "no link for {}", program.name);
        for place in ["man/man1/NAME.1", "bash-completion/completions/NAME", "zsh/site-functions/_NAME"] {
            let place = place.replace("NAME", program.name);
            assert!(folder.path("bin/share").join(&place).is_file(), "no {place}");
        }
    }
    assert!(folder.path("bin/share/man/man1/radsight-capture.1").is_file());
    radsight(&["install-links", &bin]).done();
}

#[test]
fn a_page_of_somebody_else_stays() {
    let folder = Folder::new();
    std::fs::create_dir_all(folder.path("share/man/man1")).expect("a folder");
    folder.file("share/man/man1/rpict.1", ".TH RPICT 1\n");
    let run = radsight(&["install-links", &folder.word("bin"), "--share", &folder.word("share")]);
    assert!(run.code == 1 && run.messages.contains("was not written by radsight"), "{} {}", run.code, run.messages);
    assert_eq!(folder.read("share/man/man1/rpict.1"), b".TH RPICT 1\n");
    radsight(&["install-links", &folder.word("links"), "--only-links"]).done();
    assert!(!folder.path("links/share").exists());
}

#[test]
fn bash_completes_the_options_of_a_program() {
    let folder = Folder::new();
    radsight(&["install-links", &folder.word("bin")]).done();
    let script = format!(
        "source '{}'; COMP_WORDS=(rpict --err); COMP_CWORD=1; _radsight_rpict; echo \"${{COMPREPLY[*]}}\"",
        folder.word("bin/share/bash-completion/completions/rpict")
    );
    let completed = run_with(Command::new("bash").args(["-c", &script]), b"").text();
    let mut completed: Vec<&str> = completed.split_whitespace().collect();
    completed.sort_unstable();
    assert_eq!(completed, ["--error", "--error-map"]);
}
