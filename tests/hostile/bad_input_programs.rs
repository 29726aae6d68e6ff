//! Radiance's programs with wrong words, files and streams: a message with the mistake and its
//! position, the right exit code, no panic, no half-written file.

use crate::program::{Folder, Run, command, run_with};
use radsight_picture::{Header, Image, Picture};

/// Exit code of wrong input.
const INPUT: i32 = 1;
/// Exit code of a wrong command line.
const USAGE: i32 = 2;
/// Exit code of a limit or a fault.
const FAULT: i32 = 3;

const SCENE: &str = "void plastic grey 0 0 5 .5 .5 .5 0 0
void light white 0 0 3 9 9 9
white sphere lamp 0 0 4 0 5 3 .5
grey polygon floor 0 0 12 -5 0 0  5 0 0  5 9 0  -5 9 0
";

/// A folder with a scene and a picture, and an older output that must survive.
fn bench() -> Folder {
    let folder = Folder::new();
    folder.file("scene.rad", SCENE);
    folder.file("older.hdr", "an older output");
    let values = Image::new(6, 4, 3, (0..72).map(|i| i as f32).collect()).expect("a shape");
    let picture = Picture::from_rgb(Header::new("RADIANCE"), &values).expect("a picture").to_bytes();
    folder.file("short.hdr", &picture[..picture.len() - 20]);
    folder.file("picture.hdr", picture);
    folder.file("huge.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2000000000 +X 2000000000\n");
    folder.file("nothing.hdr", "");
    folder.file("noise.hdr", [0xf5u8, 0, 1, 2, 3, 255, 254].repeat(40));
    folder
}

fn run(folder: &Folder, words: &str, input: &[u8]) -> Run {
    let words: Vec<&str> = words.split(' ').filter(|word| !word.is_empty()).collect();
    run_with(command(&words).current_dir(folder.path("")), input)
}

/// Checks that the program ends with this code, its message has these parts, and no file has
/// appeared or changed.
#[track_caller]
fn refuses(folder: &Folder, words: &str, input: &[u8], code: i32, parts: &[&str]) {
    let before = folder.names();
    let run = run(folder, words, input);
    assert_eq!(run.code, code, "{words}: {}", run.messages);
    for part in parts {
        assert!(run.messages.contains(part), "{words}: \"{part}\" is not in: {}", run.messages);
    }
    assert!(!run.messages.contains("panicked"), "{words}: {}", run.messages);
    assert_eq!(folder.names(), before, "{words}: a file appears or goes");
    assert_eq!(folder.read("older.hdr"), b"an older output", "{words}");
}

#[test]
fn options_that_are_wrong() {
    let folder = bench();
    for (words, parts) in [
        ("rpict -x", &["option \"-x\" ends the command line, expected a number of columns after it"][..]),
        ("rpict -x wide scene.rad", &["option \"-x\" is followed by \"wide\", expected a number of columns"]),
        ("rpict -x 0 scene.rad", &["the picture has 0 by", "expected 1 to"]),
        ("rpict -x 2000000 -y 2000000 -pa 0 scene.rad", &["the picture has 2000000 by 2000000 pixels"]),
        ("rpict -vtx scene.rad", &["-vtx"]),
        ("rpict -vp 1 2 scene.rad", &["-vp"]),
        ("rpict -vd 0 0 0 scene.rad", &["view"]),
        ("rpict -vu 0 1 0 scene.rad", &["up"]),
        ("rpict -vh 200 scene.rad", &["200"]),
        ("rpict -pj 2 scene.rad", &["option \"-pj\" is 2, expected a share of a pixel from 0 to 1"]),
        ("rpict -pd -1 scene.rad", &["option \"-pd\" is -1"]),
        ("rpict -ab -1 scene.rad", &["option \"-ab\" is followed by \"-1\""]),
        ("rpict -av 1 -1 1 scene.rad", &["option \"-av\" with -1"]),
        ("rpict -cs 2 scene.rad", &["invalid sampling: 2 bands"]),
        ("rpict -pc 1 0 0 1 0 0 .3 .3 scene.rad", &[]),
        ("rpict -pc .1 .1 .2 .2 .3 .3 .3 .3 scene.rad", &["invalid primaries"]),
        ("rpict -P", &["option \"-P\" ends the command line"]),
        ("rpict -ap map.pm scene.rad", &["photon maps are not supported"]),
        ("rpict -co scene.rad", &["option \"-co\" is not supported", "rtrace -co -fac"]),
        ("rtrace -ss x scene.rad", &["option \"-ss\" is followed by \"x\""]),
        ("rtrace -aa nan scene.rad", &["option \"-aa\" is followed by \"nan\""]),
        ("rpict -lw -Infinity scene.rad", &["option \"-lw\" is followed by \"-Infinity\""]),
        ("rtrace -pY -fac scene.rad", &["need three components or more"]),
        ("rpict -qq scene.rad", &["rpict: option \"-qq\" is not supported"]),
        ("rpict @missing scene.rad", &["@missing"]),
        ("rpict $NO_SUCH_VARIABLE_HERE scene.rad", &["no such environment variable"]),
        ("rtrace -ot scene.rad", &["\"-o\" has no letters"]),
        ("rtrace -otvq scene.rad", &["\"q\" of \"-otvq\" is not an output", "tTvVdolLcpnNsmMwWrRxX~"]),
        ("rtrace -fac -otv scene.rad", &["hold a single value"]),
        ("rtrace -otv -ti", &["\"-ti\"", "the name of a modifier"]),
        ("rtrace -fz scene.rad", &["-fz"]),
        ("vwrays -q", &["-q"]),
        ("rad -q x.rif", &["-q"]),
        ("pfilt -x -5 picture.hdr", &[]),
        ("pcomb -e", &["option \"-e\" ends the command line"]),
        ("falsecolor -pal none -i picture.hdr", &["option \"-pal none\" is unknown"]),
        ("pcond -x", &["option \"-x\" ends the command line, expected a file after it"]),
        ("rpict -aE", &["option \"-aE\" ends the command line"]),
        ("oconv -q scene.rad", &["-q"]),
        ("rvu scene.rad", &["rvu is not part of radsight", "rpict"]),
        ("mkpmap scene.rad", &["mkpmap is not part of radsight"]),
        ("gensdaymtx a b", &["gensdaymtx is not part of radsight"]),
        ("rtcontrib -m lamp scene.oct", &["rtcontrib is not part of radsight", "rcontrib"]),
        ("rlux scene.oct", &["rlux is not part of radsight", "rtrace -I"]),
        ("rcrop 0 0 8 8 picture.hdr", &["rcrop is not part of radsight", "pcompos"]),
        ("pdfblur .1 8 a.vf", &["pdfblur is not part of radsight", "rpict -pd"]),
        ("genambpos -l 1 scene.amb", &["genambpos is not part of radsight", "ambient values"]),
        ("compamb x.rif", &["compamb is not part of radsight", "ambient values"]),
        ("glare x.glr", &["glare is not part of radsight", "Radiance's own"]),
        ("pveil picture.hdr", &["pveil is not part of radsight", "Radiance's own"]),
        ("objpict a.rad", &["objpict is not part of radsight", "Radiance's own"]),
        ("normpat a.hdr", &["normpat is not part of radsight", "Radiance's own"]),
        ("phisto a.hdr", &["phisto is not part of radsight", "Radiance's own"]),
        ("vwright 1", &["vwright is not part of radsight", "Radiance's own"]),
        ("ranimove a.ran", &["ranimove is not part of radsight", "Radiance's own"]),
    ] {
        if parts.is_empty() {
            // Only the orderly end is checked.
            let ended = run(&folder, words, b"");
            assert!((0..=3).contains(&ended.code) && !ended.messages.contains("panicked"), "{words}: {ended:?}");
            continue;
        }
        refuses(&folder, words, b"", USAGE, parts);
    }
}

#[test]
fn impossible_views_name_their_file_and_line() {
    let folder = bench();
    folder.file("parallel.vf", "# a view\nrvu -vp 1 2 3 -vd 0 0 1 -vu 0 0 1\n");
    folder.file("cut.vf", "rvu -vp 1 2 3\0 -vd 0 1 0\n");
    folder.file("kind.vf", "rvu -vtv\nVIEW= -vtz\n");
    folder.file("good.vf", "rvu -vp 1 2 3\n");
    folder
        .file("wide.hdr", "#?RADIANCE\nVIEW= -vtv -vh 500\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\u{1}\u{1}\u{1}\u{1}");
    for program in ["vwrays -x 1 -y 1 VIEW", "rpict -x 1 -y 1 VIEW scene.rad"] {
        let refuses = |view: &str, code: i32, parts: &[&str]| {
            refuses(&folder, &program.replace("VIEW", view), b"", code, parts);
        };
        refuses("-vf parallel.vf", INPUT, &["view file \"parallel.vf\": line 2: bad view: ", "parallel"]);
        refuses("-vf cut.vf", INPUT, &["view file \"cut.vf\": line 1: a zero byte"]);
        refuses("-vf kind.vf", INPUT, &["view file \"kind.vf\": line 2: unknown view type \"z\""]);
        refuses("-vf wide.hdr", INPUT, &["view file \"wide.hdr\": line 2: bad view: -vh is 500"]);
        // The command line is to blame.
        refuses("-vf good.vf -vh 500", USAGE, &["bad view: -vh is 500"]);
        refuses("-vf parallel.vf -vu 0 1 0 -vh 500", USAGE, &["bad view: -vh is 500"]);
    }
    refuses(&folder, "vwrays wide.hdr", b"", INPUT, &["picture \"wide.hdr\": bad view: -vh is 500"]);
    let views = b"VIEW= -vp 0 0 0 -vd 0 0 1\n";
    refuses(&folder, "rpict -x 1 -y 1 -S 1 -o out%d.hdr scene.rad", views, INPUT, &["standard input: bad view: "]);
    // Later options make the view possible.
    let mended = run(&folder, "vwrays -x 1 -y 1 -vf parallel.vf -vu 0 1 0", b"");
    assert_eq!(mended.code, 0, "{}", mended.messages);
}

#[test]
fn files_that_are_missing_or_none_at_all() {
    let folder = bench();
    for program in ["rpict", "rtrace", "oconv", "rcontrib -m white", "getbbox"] {
        refuses(&folder, &format!("{program} missing.rad"), b"", INPUT, &["missing.rad", "no such file"]);
        refuses(&folder, &format!("{program} noise.hdr"), b"", INPUT, &["noise.hdr"]);
    }
    refuses(&folder, "rpict -vf missing.vf scene.rad", b"", INPUT, &["missing.vf"]);
    refuses(&folder, "rpict -vf scene.rad scene.rad", b"", INPUT, &["scene.rad"]);
    refuses(&folder, "rpict -f missing.cal scene.rad", b"", INPUT, &["missing.cal"]);
    refuses(&folder, "rtrace -e x=( scene.rad", b"", INPUT, &["option -e:1:", "expected an expression"]);
    refuses(&folder, "rad missing.rif", b"", INPUT, &["missing.rif"]);
    refuses(&folder, "vwrays missing.hdr", b"", INPUT, &["missing.hdr"]);
    for program in
        ["pfilt", "pcond", "pvalue", "pcomb", "pextrem", "pflip -h", "ra_xyze", "ra_ppm", "ra_tiff", "falsecolor -i"]
    {
        let ending = if program == "ra_tiff" { " out.tif" } else { "" };
        refuses(&folder, &format!("{program} missing.hdr{ending}"), b"", INPUT, &["missing.hdr"]);
        refuses(&folder, &format!("{program} nothing.hdr{ending}"), b"", INPUT, &["nothing.hdr"]);
        refuses(&folder, &format!("{program} noise.hdr{ending}"), b"", INPUT, &["noise.hdr"]);
    }
}

#[test]
fn pictures_that_end_too_early_or_are_too_large() {
    let folder = bench();
    for program in ["pcond", "pcomb", "pextrem", "pflip -h", "ra_xyze", "ra_ppm", "falsecolor -i"] {
        refuses(&folder, &format!("{program} short.hdr"), b"", INPUT, &["short.hdr"]);
    }
    for program in ["pfilt", "pcond", "pcomb", "pextrem", "pflip -v", "ra_ppm", "pvalue", "falsecolor -i"] {
        refuses(&folder, &format!("{program} huge.hdr"), b"", INPUT, &["huge.hdr"]);
    }
    refuses(&folder, "rpict -ro older.hdr scene.rad", b"", INPUT, &["bad recover file \"older.hdr\""]);
}

#[test]
fn mistakes_of_a_scene_have_their_position_in_every_program() {
    let folder = bench();
    folder.file("bad.rad", format!("{SCENE}gery sphere ball 0 0 4 0 0 1 1\n"));
    for program in ["rpict -x 4 -y 4", "rtrace", "rcontrib -m white", "oconv"] {
        let place =
            ["bad.rad:5:1: ", "undefined modifier \"gery\"", "gery sphere ball", "^^^^", "did you mean \"grey\"?"];
        refuses(&folder, &format!("{program} bad.rad"), b"", INPUT, &place);
    }
    folder.file("cut.oct", b"#?RADIANCE\nFORMAT=Radiance_octree\n\n\x03\x00".as_slice());
    refuses(&folder, "rpict cut.oct", b"", INPUT, &["cut.oct"]);
}

#[test]
fn outputs_that_cannot_be() {
    let folder = bench();
    refuses(
        &folder,
        "rpict -x 4 -y 4 -o older.hdr scene.rad",
        b"",
        INPUT,
        &["cannot open output file \"older.hdr\": it exists"],
    );
    refuses(
        &folder,
        "rpict -x 4 -y 4 -o nowhere/x.hdr scene.rad",
        b"",
        FAULT,
        &["cannot write \"nowhere/x.hdr\": no such file"],
    );
    refuses(&folder, "rpict -x 4 -y 4 -z . scene.rad", b"", FAULT, &["cannot write \".\""]);
    refuses(&folder, "pcond picture.hdr nowhere/x.hdr", b"", FAULT, &["cannot write \"nowhere/x.hdr\""]);
    refuses(&folder, "pcond picture.hdr .", b"", FAULT, &["cannot write \".\": it is a folder"]);
    refuses(&folder, "ra_xyze picture.hdr nowhere/x.hdr", b"", FAULT, &["cannot write \"nowhere/x.hdr\""]);
    refuses(&folder, "rcontrib -o . -fo+ -m white scene.rad", b"0 0 1 0 1 0\n", FAULT, &["cannot write \".\""]);
}

#[test]
fn streams_of_rays_that_are_wrong() {
    let folder = bench();
    for program in ["rtrace -h", "rcontrib -h -m white"] {
        let name = program.split(' ').next().expect("a name");
        let first = format!("{name}: standard input, ray 1:");
        refuses(&folder, &format!("{program} scene.rad"), b"1 2 x 0 0 1\n", INPUT, &[&first, "\"x\" is not a number"]);
        refuses(
            &folder,
            &format!("{program} scene.rad"),
            b"1 2 nan 0 0 1\n",
            INPUT,
            &[&first, "expected a finite one"],
        );
        refuses(
            &folder,
            &format!("{program} -ff scene.rad"),
            b"12345",
            INPUT,
            &[&first, "the stream ends within a number"],
        );
        let second = format!("{name}: standard input, ray 2:");
        let endless = [b"0 0 1 0 1 0 ".as_slice(), &[b'7'; 10_000]].concat();
        refuses(&folder, &format!("{program} scene.rad"), &endless, INPUT, &[&second, "longer than 4096 characters"]);
    }
}

#[test]
fn pipes_that_nobody_reads_are_success() {
    let folder = bench();
    let rays = b"0 0 1 0 1 0\n".repeat(4000);
    for words in [
        "rpict -x 200 -y 200 scene.rad",
        "vwrays -fd -x 300 -y 300",
        "rtrace -fad scene.rad",
        "rcontrib -fad -ab 0 -m white scene.rad",
        "pcond picture.hdr",
        "pvalue picture.hdr",
    ] {
        let words: Vec<&str> = words.split(' ').collect();
        let mut child = command(&words)
            .current_dir(folder.path(""))
            .stdin(std::process::Stdio::piped())
            .spawn()
            .expect("it starts");
        drop(child.stdout.take());
        let mut input = child.stdin.take().expect("a pipe");
        let bytes = rays.clone();
        let writer = std::thread::spawn(move || drop(std::io::Write::write_all(&mut input, &bytes)));
        let ended = child.wait_with_output().expect("it ends");
        writer.join().expect("the writer ends");
        let messages = String::from_utf8_lossy(&ended.stderr).into_owned();
        assert_eq!(ended.status.code(), Some(0), "{words:?}: {messages}");
    }
}
