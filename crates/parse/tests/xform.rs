//! Our `xform` against the real one.

mod support;

use radsight_parse::xform;
use support::{Disk, Radiance, difference, files_below, shared};

const EVERY_TYPE: &str = "# all types whose arguments change
void plastic \"red paint\" 0 0 5 .5 .1 .1 0 0
void texfunc t 8 a b \"c d\" f.cal -t 1 0 0 0 2 3 3
void glow g 0 0 4 1 1 1 7
void spotlight s 0 0 7 1 2 3 40 0 .5 -1
void dielectric d 0 0 5 .5 .6 .7 1.5 0
void interface i 0 0 8 .5 .6 .7 1.5 .8 .9 1 1
void mist m 2 a b>c 0 7 .1 .2 .3 .4 .5 .6 .7
void mist m0 0 0 0
void mist m3 0 0 3 .1 .2 .3
void brighttext b 4 font.fnt . two words 0 12 0 0 0 1 0 0 0 -1 0 1 .5 .25
void mixtext x 4 a b font.fnt file 0 9 0 0 0 1 0 0 0 -1 0
void colorpict p 9 red green blue 'a b.hdr' . u v -s 2 0 0
void illum il 1 g 0 3 1 1 1
void alias al il
inherit alias al2 al
\"red paint\" polygon p1 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0
\"red paint\" sphere 's 1' 0 0 4 1 2 3 .5
void bubble b 0 0 4 1 2 3 .5
void cone c 0 0 8 0 0 0 0 0 1 1 .5
void cup c 0 0 8 0 0 0 0 0 1 1 .5
void cylinder cy 0 0 7 0 0 0 0 0 1 1
void tube cy 0 0 7 0 0 0 0 0 1 1
void ring r 0 0 8 1 2 3 0 0 1 0 1
void source so 0 0 4 0 1 1 .5
void instance in 3 a.oct -rx 90 0 0
void mesh me 1 a.rtm 0 0
!echo void sphere echoed 0 0 4 1 2 3 4
";

const OPTIONS: &[&str] = &[
    "",
    "-t 1 2 3",
    "-rx 30 -ry 40 -rz 50 -t 1 2 3",
    "-s 2.5 -mx",
    "-my -t 0 0 1 -mz",
    "-s -2 -rx 10",
    "-I",
    "-I -mx",
    "-n top -m other -t 1 0 0",
    "-n a -n b -m c -m d",
    "-a 3 -t 1 0 0",
    "-n row -a 2 -t 1 0 0 -a 2 -rz 45 -i 1 -s .5",
    "-i 3 -t 1 0 0 -i 2 -rz 20",
    "-c -t 1 0 0",
    "-c -n k -e -I -rz 90",
    "-f args -t 0 0 1",
    "-n x -f args",
    "-a 2 -t 5 0 0 -f args",
];

const ARGUMENT_FILE: &str = "# first\n-t 0 0 1\n\n!xform -rz 90 \\\n -mx\n-t '1' \"2\" 3\n";

#[test]
fn every_option_changes_every_type_as_real_xform_does() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("all.rad"), EVERY_TYPE).unwrap();
    std::fs::write(folder.path().join("args"), ARGUMENT_FILE).unwrap();
    let loader = Disk { folder: folder.path().to_owned(), library: None };
    for options in OPTIONS {
        let mut arguments: Vec<&str> = options.split_whitespace().collect();
        arguments.push("all.rad");
        let (theirs, _) = radiance.run("xform", &arguments, folder.path());
        let argv: Vec<String> = ["xform"].iter().chain(&arguments).map(|word| (*word).to_owned()).collect();
        let ours = xform(&argv, b"", &loader).unwrap_or_else(|error| panic!("{options}: {error}"));
        if let Some(difference) = difference(&ours.standard_output, &theirs, 2e-12) {
            panic!("xform {options}: {difference}");
        }
    }
}

#[test]
fn real_files_are_placed_as_real_xform_places_them() {
    let (Some(radiance), Some(shared)) = (Radiance::find(), shared()) else { return };
    let options = ["-c", "-n", "p", "-rx", "20", "-s", "2", "-mx", "-t", "1", "2", "3"];
    let (mut compared, mut wrong) = (0, Vec::new());
    for file in files_below(&shared) {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        let is_scene = file.extension().is_some_and(|extension| ["rad", "mat"].iter().any(|known| extension == *known));
        let folder = file.parent().unwrap();
        if !is_scene || file.metadata().unwrap().len() > 2_000_000 {
            continue;
        }
        let arguments: Vec<&str> = options.iter().copied().chain([&*name]).collect();
        let (theirs, succeeded) = radiance.run("xform", &arguments, folder);
        let argv: Vec<String> = ["xform"].iter().chain(&arguments).map(|word| (*word).to_owned()).collect();
        let loader = Disk { folder: folder.to_owned(), library: None };
        match xform(&argv, b"", &loader) {
            Ok(ours) if succeeded => {
                let found = difference(&ours.standard_output, &theirs, 1e-11);
                wrong.extend(found.map(|difference| format!("{}: {difference}", file.display())));
            }
            Err(error) if succeeded => wrong.push(format!("{}: {error}", file.display())),
            Ok(_) => wrong.push(format!("{}: real xform fails", file.display())),
            Err(_) => {}
        }
        compared += 1;
    }
    assert!(wrong.is_empty(), "{} of {compared} differ:\n{}", wrong.len(), wrong.join("\n"));
    assert!(compared > 100, "only {compared} files");
}

#[test]
fn arguments_that_are_wrong_are_named() {
    let loader = radsight_loader::MemoryLoader::default().with("a.rad", "").with("args", "# nothing\n");
    for (arguments, expected, at) in [
        ("-t 1 2 a.rad", "z of -t is \"a.rad\", expected a number", 4),
        ("-a x a.rad", "the count of -a is \"x\", expected an integer above zero", 2),
        ("-a 1000000000 -t 1 0 0 a.rad", "the array makes 1000000000 copies, expected at most 10000000", 2),
        ("-a 10000 -a 10000 a.rad", "the array makes 100000000 copies, expected at most 10000000", 4),
        ("-q a.rad", "unknown transform option \"-q\"", 1),
        ("-a 2 -rx 1 -s 0 a.rad", "the factor of -s is 0", 6),
        ("-f args a.rad", "argument file \"args\" has no arguments", 2),
        ("-i 1000000000 -s 2 a.rad", "the transform overflows to infinity", 1),
    ] {
        let argv: Vec<String> = ["xform"].into_iter().chain(arguments.split(' ')).map(str::to_owned).collect();
        let error = xform(&argv, b"", &loader).unwrap_err();
        assert!(error.to_string().contains(expected), "{arguments}: {error}");
        assert!(at == 0 || error.argument() == Some(at), "{arguments}: {:?}", error.argument());
    }
}

#[test]
fn a_file_that_includes_itself_is_an_error() {
    let loader = radsight_loader::MemoryLoader::default().with("a.rad", "!xform a.rad\n!xform a.rad\n");
    let error = xform(&["xform".into(), "a.rad".into()], b"", &loader).unwrap_err();
    assert!(error.to_string().contains("more than 32 deep"), "{error}");
}

/// Real xform has no such limit: without these copies the scene would be another one.
#[test]
fn a_command_of_a_file_that_exceeds_a_limit_is_an_error() {
    let array = "!xform -a 1000000000 -t 1 0 0 ball.rad\n";
    let loader = radsight_loader::MemoryLoader::default().with("a.rad", array).with("ball.rad", "");
    let error = xform(&["xform".into(), "a.rad".into()], b"", &loader).unwrap_err();
    assert!(error.to_string().contains("expected at most 10000000"), "{error}");
}
