//! Files that name commands, devices and forbidden outputs, that declare more data than they hold,
//! or that nest endlessly, in every format that names or counts something: each ends with a message
//! and an exit code, and leaves the folder unchanged.

use crate::program::{Folder, Run, command, run_with};
use std::fs;

const SCENE: &str =
    "void light l 0 0 3 1 1 1\nl sphere s 0 0 4 0 0 5 1\nvoid plastic p 0 0 5 .5 .5 .5 0 0\np sphere q 0 0 4 0 0 0 1\n";

/// A complete project, so that only the tested line is wrong.
const PROJECT: &str = "scene= scene.rad\nZONE= I -4 4 0 8 0 3\nRES= 4\nQUAL= L\n";

/// A hostile file with words that use it.
struct Attempt {
    /// Its name and content.
    file: (&'static str, String),
    words: &'static [&'static str],
    /// The expected exit code and message.
    code: i32,
    said: &'static str,
}

fn attempt(
    name: &'static str,
    text: impl Into<String>,
    words: &'static [&'static str],
    code: i32,
    said: &'static str,
) -> Attempt {
    Attempt { file: (name, text.into()), words, code, said }
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("scene.rad", SCENE);
    folder.file("precious", "years of work");
    folder
}

fn try_out(Attempt { file: (name, text), words, code, said }: &Attempt) {
    let folder = folder();
    folder.file(name, text);
    let (names, content) = (folder.names(), folder.read(name));
    let mut program = command(words);
    program.current_dir(folder.path("")).env("RADSIGHT_LIMIT_MEMORY", "300M");
    let Run { code: found, messages, .. } = run_with(&mut program, b"");
    let case = format!("{words:?} with {name}: {}", &text[..text.len().min(200)]);
    assert_eq!(found, *code, "{case}\n{messages}");
    assert!(messages.contains(said), "{case}\n{messages}");
    assert_eq!(folder.names(), names, "{case}: files came or went");
    assert_eq!(folder.read("precious"), b"years of work", "{case}");
    assert!(folder.read(name) == content, "{case}: it changed");
}

fn project(line: &str, said: &'static str) -> Attempt {
    attempt("a.rif", format!("{PROJECT}{line}\n"), &["rad", "a.rif"], 1, said)
}

#[test]
fn projects_name_no_commands_and_no_outputs_elsewhere() {
    let view = "view= d -vp 0 -3 1";
    for (line, said) in [
        (format!("OCTREE= a;touch hit;.oct\n{view}"), "characters with a meaning in a shell"),
        (format!("OCTREE= ../a.oct\n{view}"), "not below the current folder"),
        (format!("OCTREE= -o\n{view}"), "comes from a file and is not written"),
        (format!("OCTREE= .hidden.oct\n{view}"), "comes from a file and is not written"),
        (format!("PICTURE= /tmp/hit\n{view}"), "not below the current folder"),
        (format!("REPORT= 1 precious\n{view}"), "it exists"),
        (format!("OPTFILE= precious\n{view}"), "it exists"),
        (format!("materials= \"!touch hit\"\n{view}"), "refused to run"),
    ] {
        try_out(&project(&line, said));
    }
}

#[test]
fn headers_and_views_cause_nothing() {
    let header = "#?RADIANCE\noconv !touch hit\n!touch hit\nVIEW= -vf !touch\nSOFTWARE= `touch hit`\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\u{1}\u{1}\u{1}\u{1}";
    for (words, code) in [
        (&["getinfo", "a.hdr"][..], 0),
        (&["vwrays", "a.hdr"], 1),
        (&["rpict", "-vf", "a.hdr", "-x", "4", "-y", "4", "scene.rad"], 1),
        (&["pfilt", "-x", "1", "a.hdr"], 0),
        (&["pcomb", "-e", "lo=li(1)", "a.hdr"], 0),
    ] {
        try_out(&attempt("a.hdr", header, words, code, ""));
    }
    let view = "VIEW= -vtv @/etc/passwd -vf other.vf --allow-commands -o hit\n";
    try_out(&attempt("a.vf", view, &["rpict", "-vf", "a.vf", "-x", "4", "-y", "4", "scene.rad"], 0, ""));
}

#[test]
fn files_of_options_write_nothing_elsewhere_and_end() {
    let rpict = &["rpict", "@a", "-vp", "0", "-5", "0", "-x", "4", "-y", "4", "scene.rad"];
    for (text, code, said) in [
        ("@a", 2, "refers to itself"),
        ("-o /tmp/hit", 1, "not below the current folder"),
        ("-o precious", 1, "it exists"),
        ("-P ../hit", 1, "not below the current folder"),
        ("-e precious", 1, "it exists"),
        ("-z !touch", 1, "it is a command"),
        ("--words-of-file --allow-commands", 2, ""),
        ("--limit-memory 0", 2, ""),
    ] {
        try_out(&attempt("a", text, rpict, code, said));
    }
}

#[test]
fn comments_and_receivers_write_nothing_elsewhere() {
    let window = "void glow g 0 0 4 1 1 1 0\ng polygon w 0 0 9 0 0 0 1 0 0 0 1 0\n";
    for (comment, said) in [
        ("h=kf u=Y o=\"|touch hit\"", "it is a command"),
        ("h=kf u=Y o=.hit", "comes from a file and is not written"),
        ("h=r999999 u=Y", "is not a basis"),
    ] {
        let text = format!("#@rfluxmtx {comment}\n{window}");
        try_out(&attempt("r.rad", text, &["rfluxmtx", "scene.rad", "r.rad", "scene.rad"], 1, said));
    }
}

#[test]
fn devices_without_end_end_at_the_limit() {
    if !cfg!(target_os = "linux") {
        return;
    }
    let surface = "b plastic m 0 0 5 1 1 1 0 0 m sphere s 0 0 4 0 0 0 1\n";
    let rpict = &["rpict", "-x", "2", "-y", "2", "a.rad"];
    for text in [
        format!("void brightdata b 4 noop /dev/zero . Px 0 0\n{surface}"),
        format!("void colorpict b 7 red green blue /dev/zero . Px Py 0 0\n{surface}"),
        format!("void brightfunc b 2 f /dev/zero 0 0\n{surface}"),
        "void mesh m 1 /dev/zero 0 0\n".to_owned(),
        "void instance m 1 /dev/zero 0 0\n".to_owned(),
    ] {
        try_out(&attempt("a.rad", text, rpict, 3, "out of memory"));
    }
    try_out(&attempt("a", "@/dev/zero", &["rpict", "@a"], 3, "out of memory"));
}

#[test]
fn endless_nesting_is_reported() {
    let deep = 200_000;
    let rcalc = &["rcalc", "-n", "-f", "a.cal", "-e", "$1=x"];
    for (name, text, words, said) in [
        ("a.toml", format!("a={}", "[".repeat(deep)), &["capture", "a.toml", "scene.rad", "-o", "g.png"][..], "recurs"),
        ("a.toml", format!("[{}a]", "a.".repeat(deep)), &["capture", "a.toml", "scene.rad", "-o", "g.png"], "recurs"),
        ("a.toml", format!("a={}", "{b=".repeat(deep)), &["capture", "a.toml", "scene.rad", "-o", "g.png"], "recurs"),
        ("a.cal", format!("x = {}1{};", "(".repeat(deep), ")".repeat(deep)), rcalc, "nested more than"),
        ("a.cal", format!("x = {}1;", "1^".repeat(deep)), rcalc, "nested more than"),
        ("a.cal", format!("f(a)=a;x = {}1{};", "f(".repeat(deep), ")".repeat(deep)), rcalc, "nested more than"),
        ("a.xml", format!("<?xml version=\"1.0\"?><WindowElement>{}", "<a>".repeat(deep)), &["rmtxop", "a.xml"], ""),
        ("a.mgf", "i a.mgf\n".to_owned(), &["mgf2rad", "a.mgf"], "more than 32 deep"),
    ] {
        try_out(&attempt(name, text, words, 1, said));
    }
}

#[test]
fn tangled_outlines_are_reported() {
    // Laps around a triangle that grow: none of their points is repeated.
    let corner = |lap: f64, [x, y]: [f64; 2]| format!("{} {} 1\n", x + lap * (x - 0.3), y + lap * (y - 0.3));
    let laps = |count: u32| -> String {
        let lap = |i| [[0., 0.], [1., 0.], [0., 1.]].map(|point| corner(f64::from(i) * 1e-6, point));
        (0..count).flat_map(lap).collect()
    };
    let polygon = |count: u32| format!("polygon a 0 0 {}\n{}", 9 * count, laps(count));
    let face = |count: u32| {
        let corners: String = (1..=3 * count).map(|i| format!(" {i}")).collect();
        format!("{}f{corners}\n", laps(count).lines().map(|line| format!("v {line}\n")).collect::<String>())
    };
    let light = |count| format!("void light l 0 0 3 1 1 1\nl {}", polygon(count));
    let sender = |count| format!("#@rfluxmtx h=u\nvoid glow l 0 0 4 1 1 1 0\nl {}", polygon(count));
    let crossing = "has an outline that intersects itself";
    let large = "has an outline of more than 20000 corners";
    for (count, said) in [(1_000, crossing), (7_000, large)] {
        try_out(&attempt("a.rad", light(count), &["rpict", "-x", "4", "a.rad"], 1, said));
        try_out(&attempt("a.obj", face(count), &["obj2mesh", "a.obj"], 1, said));
        try_out(&attempt("a.rad", sender(count), &["rfluxmtx", "a.rad", "a.rad", "scene.rad"], 1, said));
    }
}

#[test]
fn products_larger_than_the_limit_of_memory_are_refused() {
    let rows = 33_000;
    let column = format!("#?RADIANCE\nNROWS={rows}\nNCOLS=1\nNCOMP=1\nFORMAT=ascii\n\n{}", "1\n".repeat(rows));
    let words = &["rmtxop", "a.mtx", ".", "-t", "a.mtx"];
    try_out(&attempt("a.mtx", column, words, 3, "would exceed the limit of 300 MB"));
}

#[test]
fn counts_that_exceed_a_file_are_reported() {
    let header = |lines: &str| format!("#?RADIANCE\n{lines}\n");
    let picture = header("FORMAT=32-bit_rle_rgbe\n\n-Y 2000000000 +X 2000000000");
    let matrix = header("NCOMP=3\nNROWS=2000000000\nNCOLS=2000000000\nFORMAT=float\n");
    let rpict = &["rpict", "-x", "2", "-y", "2", "a.rad"][..];
    for words in [
        &["pfilt", "-x", "8", "a.hdr"][..],
        &["pextrem", "a.hdr"],
        &["pvalue", "a.hdr"],
        &["pflip", "-h", "a.hdr"],
        &["protate", "a.hdr"],
        &["pcond", "a.hdr"],
        &["ra_tiff", "a.hdr", "b.tif"],
    ] {
        try_out(&attempt("a.hdr", picture.clone(), words, 1, "2000000000"));
    }
    for words in [&["rmtxop", "a.mtx"][..], &["rmtxop", "-t", "a.mtx"], &["dctimestep", "a.mtx", "a.mtx"]] {
        try_out(&attempt("a.mtx", matrix.clone(), words, 1, "a.mtx"));
    }
    for (text, code, said) in [
        ("void polygon p 0 0 999999999999 1 2 3\n", 1, "declares"),
        ("void colorpict p 999999999 a b c\n", 1, "declares"),
        // A command that fails in Radiance, too, is a warning; these are refused here alone.
        ("!genbox m n 1 1\n", 0, "missing"),
        ("!xform -a 1000000000 -t 1 0 0 scene.rad\n", 1, "at most"),
        ("!gensurf m n x y z 100000 100000\n", 1, "exceeds"),
        ("!genrev m n t t 1000000000\n", 1, "exceeds"),
    ] {
        try_out(&attempt("a.rad", text, rpict, code, said));
    }
    let luminaire = "IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 999999999 999999999 1 1 0 0 0\n1 1 1\n0\n0\n1\n";
    try_out(&attempt("a.ies", luminaire, &["ies2rad", "-o", "lamp", "a.ies"], 1, "declared"));
}

#[test]
fn names_do_not_speak_to_the_terminal() {
    let folder = folder();
    folder.file("a.rad", "void plastic \u{1b}[31mred 0 0 5 1 1 1 0 0\nnope sphere \u{1b}]0;title\u{7} 0 0 4 0 0 0 1\n");
    let run = run_with(command(&["rpict", "-x", "2", "-y", "2", "a.rad"]).current_dir(folder.path("")), b"");
    assert_eq!(run.code, 1);
    assert!(!run.messages.contains(['\u{1b}', '\u{7}']), "{:?}", run.messages);
    assert!(fs::exists(folder.path("precious")).expect("the folder is read"));
}
