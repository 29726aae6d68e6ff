//! No arguments and no input make a program panic or loop forever, and mistakes are reported
//! clearly.

mod oracle;

use oracle::{Numbers, TestLoader, ours, words};
use radsight_scene_generators::{names, pipeline};

const NASTY: &[&str] = &[
    "",
    "-",
    "--",
    "0",
    "1",
    "2",
    "3",
    "7",
    "-1",
    ".5",
    "1e308",
    "-1e308",
    "1e-308",
    "1e9",
    "99999999999999999999",
    "nan",
    "-inf",
    "x",
    "é",
    "a b",
    "$1",
    "-e",
    "-f",
    "-s",
    "-a",
    "-o",
    "-r",
    "-l",
    "-i",
    "-n",
    "-t",
    "-x",
    "-m",
    "-P",
    "-W",
    "-E",
    "-ang",
    "+s",
    "-c",
    "-b",
    "-y",
    "-O",
    "-g",
    "-p",
    "-id",
    "-if99999999",
    "-in",
    "t",
    "s*t",
    "$1=$2",
    "$1=f(1);f(x)=f(x+1)",
    "${x}",
    "$(s)",
    "12:30EST",
    "+25:99",
    "file",
    "nofile",
    "f(",
    "\0",
    "\n",
    "sin(t)",
    "1/0",
    "hermite(1,2,3)",
];

fn loader() -> TestLoader {
    let mut loader = TestLoader::default();
    loader.files.insert("file".into(), b"1 2 3\nvoid polygon a 0 0 9 1 2 3 4 5 6 7 8 9\n!cat file\nv = 3".to_vec());
    loader
}

#[test]
fn random_arguments_never_panic() {
    let mut numbers = Numbers(41);
    let loader = loader();
    for round in 0..40_000 {
        let program = names()[round % names().len()];
        let mut argv = vec![program.to_owned()];
        argv.extend((0..numbers.below(14)).map(|_| NASTY[numbers.below(NASTY.len())].to_owned()));
        let input: Vec<u8> = (0..numbers.below(60)).map(|_| numbers.next() as u8).collect();
        if let Err(error) = ours(&argv, &input, &loader) {
            assert!(!error.to_string().is_empty());
            assert!(error.argument().is_none_or(|argument| argument <= argv.len()), "{argv:?}: {error:?}");
        }
    }
}

#[test]
fn damaged_command_lines_never_panic() {
    let mut numbers = Numbers(42);
    let loader = loader();
    let pieces = [
        "cat file",
        "| ",
        "; ",
        "(",
        ")",
        "'",
        "\"",
        "\\",
        "\n",
        "$x",
        "`",
        "* ",
        "< file ",
        "> ",
        "# ",
        " ",
        "é",
        "echo a ",
        "cnt 3",
        "rcalc -e '$1=$1'",
        "&",
        "~",
        "=",
    ];
    for _ in 0..40_000 {
        let line: String = (0..numbers.below(12)).map(|_| pieces[numbers.below(pieces.len())]).collect();
        if let Err(failed) = pipeline(&line, &loader, &|_, _| None) {
            assert!(failed.range.start <= failed.range.end && failed.range.end <= line.len(), "{line:?}: {failed:?}");
            assert!(line.is_char_boundary(failed.range.start) && line.is_char_boundary(failed.range.end));
        }
    }
}

#[test]
fn damaged_inputs_never_panic() {
    let mut numbers = Numbers(43);
    let mgf = "m a =\nrd .5\nc b =\ncxy .3 .3\nv p =\np 1 2 3\nn 0 0 1\no x\nxf -a 3 -t 1 2 3\nf p p p\nsph p 1\nxf\no\ncone p 1 p 2\n";
    let ies = "IESNA91\n[LAMP] x\nTILT=INCLUDE\n1 2 0 90 1 .5\n1 1000 1 3 2 1 2 .2 .3 .1\n1 1 60\n0 45 90\n0 90\n1 2 3 4 5 6\n";
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 .3 1\nusemtl a\ng b\nf 1//1 2//1 3//-1\nf 1 2 3 1\n";
    for (line, text) in [
        ("mgf2rad -s", mgf),
        ("ies2rad -o x", ies),
        ("obj2rad", obj),
        ("total -p", "1 2 3\n-4 5"),
        ("rcalc -i ${a}x${b} -o ${a*b}", "1x2\n3x4"),
        ("genprism m p -", "0 0 1 0 0 1"),
        ("gensurf m s s t - 2 2", "1 2 3 4 5 6 7 8 9"),
    ] {
        let argv = words(line);
        assert!(ours(&argv, text.as_bytes(), &loader()).is_ok(), "{line}");
        for _ in 0..3000 {
            let mut bytes = text.as_bytes().to_vec();
            for _ in 0..1 + numbers.below(4) {
                let place = numbers.below(bytes.len());
                match numbers.below(3) {
                    0 => bytes[place] = numbers.next() as u8,
                    1 => drop(bytes.remove(place)),
                    _ => bytes.insert(place, b"-9 \n/xe"[numbers.below(7)]),
                }
            }
            let _ = ours(&argv, &bytes, &loader());
        }
    }
}

#[test]
fn mistakes_name_the_argument_and_the_usage() {
    let message = |line: &str| ours(&words(line), b"", &loader()).unwrap_err().to_string();
    let usage = "\nusage: genbox material name xsize ysize zsize [-i] [-b bevel | -r round [-n nsegs] [-s]] [-o]";
    for (line, mistake) in [
        ("genbox m b 1 2", "genbox: missing zsize"),
        ("genbox m b 1 two 3", "genbox: ysize is \"two\", expected a finite number"),
        ("genbox m b 1 -2 3", "genbox: ysize is -2, expected a number above zero"),
        ("genbox m b 1 nan 3", "genbox: ysize is \"nan\", expected a finite number"),
        ("genbox m b 1 1e400 3", "genbox: ysize is \"1e400\", expected a finite number"),
        ("genbox m b 1 2 3 -q", "genbox: unknown option \"-q\""),
        ("genbox m b 1 2 3 4", "genbox: unexpected argument \"4\""),
        ("genbox m b 1 2 3 -r", "genbox: missing round (-r)"),
    ] {
        assert_eq!(message(line), format!("{mistake}{usage}"));
    }
    let first_line = |line: &str| message(line).lines().next().unwrap_or_default().to_owned();
    for (line, mistake) in [
        ("genprism m p 4 0 0 1 1 2", "genprism: 4 vertices are declared, but coordinates are given for 2"),
        ("genprism m p 2 0 0 1 1", "genprism: 2 vertices, expected at least 3"),
        ("genprism m p 3 0 0 1 0 0 1 -l 1 1 0", "genprism: the extrusion's z is 0, expected it to leave the xy plane"),
        ("genprism m p 3 0 0 1 0 0 1 -r 2", "genprism: rounding by 2 is greater than the height 1"),
        ("genprism m p 3 0 0 0 0 0 1 -r .2", "genprism: vertex 2 repeats the one before, so its side has no length"),
        ("genprism m p nofile", "cannot find file \"nofile\""),
        ("gensky 13 1 12", "gensky: month is 13, expected 1 to 12"),
        ("gensky 3 1 12x", "gensky: hour is \"12x\", expected one of the time zones YST YDT"),
        (
            "gensky 3 1 noon",
            "gensky: hour is \"noon\", expected a time such as 14:30, 14.5 or +14.5 (solar), and perhaps a time zone",
        ),
        ("gendaylit 3 1 24 -P 2 .1", "gendaylit: hour is \"24\", expected a number from 0 to below 24"),
        ("gendaylit 3 1 12 -O 4", "gendaylit: output (-O) is 4, expected 0, 1 or 2"),
        ("genworm m w t t t 1", "genworm: missing nseg"),
        ("genworm m w t t t 1 0", "genworm: nseg is 0, expected a count of at least 1"),
        ("genblinds m b 9 1 1 1 0 -r 1", "genblinds: slats of depth 9 cannot be curved to a circle of diameter 2"),
        ("genclock soon", "genclock: time is \"soon\", expected HH:MM or HH.hh"),
        ("genbeads m b 0 0 0 1 1 1 0 0 0 0 0 0 .1 0", "genbeads: inc is 0, expected a number above zero"),
        ("replmarks mark", "replmarks: no modifier of markers is named"),
        ("replmarks -m x mark", "replmarks: nothing to replace the markers \"mark\" with: -x, -i or -I is missing"),
        ("nosuch", "unknown program \"nosuch\""),
        ("ies2rad", "ies2rad: neither an input file nor an output name (-o) is given"),
        ("pkgBSDF -s", "pkgBSDF: missing BSDF file"),
        ("pkgBSDF -s a.xml b.xml", "pkgBSDF: -s writes the scene of one BSDF file"),
    ] {
        assert!(first_line(line).starts_with(mistake), "{line}: {}", first_line(line));
    }
}

#[test]
fn text_after_a_number_is_ignored_as_in_c_with_a_warning() {
    let output = ours(&words("genbox m b 1m 2, 3"), b"", &loader()).unwrap();
    assert_eq!(output.warnings, ["xsize is \"1m\"; \"m\" is ignored", "ysize is \"2,\"; \",\" is ignored"]);
}

#[test]
fn the_names_are_sorted_and_known() {
    for pair in names().windows(2) {
        assert!(pair[0] <= pair[1], "{} is listed before {}, expected after it", pair[0], pair[1]);
    }
    assert!(names().iter().all(|name| radsight_scene_generators::knows(name)));
    assert!(radsight_scene_generators::knows("/usr/local/bin/genbox") && !radsight_scene_generators::knows("xform"));
}
