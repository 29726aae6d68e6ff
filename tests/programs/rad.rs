//! `rad`: the commands of real `rad`, and their pictures.

use crate::program::{Folder, command, run_with};
use radsight_picture::Picture;
use radsight_test_support::Radiance;

const ROOM: &str = "
void plastic wall 0 0 5 .5 .4 .3 0 0
void light lamp 0 0 3 1 1 1
lamp sphere bulb 0 0 4 0 5 3 .5
wall polygon floor 0 0 12 -10 0 0 10 0 0 10 20 0 -10 20 0
";

const PROJECT: &str = "
# A room.
OCTREE= room.oct
scene= room.rad   more.rad \\
  last.rad
ZONE= I -4 4 0 8 0 3   # of interest
EXP= +2
RES= 24 18
QUAL= M
VAR = Hi
render= -dv+ \\# -st .1
view= def -vp 0 -3 1 -vh 60
view= Xa
view= -vp 1 2 3
";

fn bench() -> Folder {
    let folder = Folder::new();
    folder.file("room.rad", ROOM);
    folder.file("more.rad", "wall sphere ball 0 0 4 2 3 1 1\n");
    folder.file("last.rad", "wall sphere egg 0 0 4 -2 3 1 .5\n");
    folder.file("room.rif", PROJECT.replace("\\# ", ""));
    folder
}

#[test]
fn the_commands_are_those_of_real_rad() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = bench();
    let cases: [&[&str]; 16] = [
        &[],
        &["-e"],
        &["-V"],
        &["QUAL=low", "DET=High", "PEN=True"],
        &["QUAL=high", "DET=Low", "VAR=Med", "IND=2", "AMB=room.amb"],
        &["IND=1", "AMB=room.amb", "OPT=room.opt"],
        &["PEN=T", "EXP=.5", "REP=2.5 errors", "ZF=depth"],
        &["RES=100 50 1.2", "RAW=raw", "PIC=shown"],
        &["RAW=same", "PIC=same", "pfilt=-m .1 -t 3"],
        &["-v", "2"],
        &["-v", "def"],
        &["-v", "yZl"],
        &["-v", "-vta -vh 180"],
        &["-v", "Zl -vs .1", "UP=Y"],
        &["UP=-Z", "oconv=-r 100 -w", "rpict=-ps 1"],
        &["ill=more.rad", "mki=-ab 2", "mat=last.rad"],
    ];
    for words in cases {
        let (options, assignments): (Vec<&str>, Vec<&str>) =
            words.iter().partition(|word| !word.contains('=') || word.starts_with('-'));
        let words = [&["-n", "-w"], &options[..], &["room.rif"], &assignments[..]].concat();
        let ours = run_with(command(&[&["rad"], &words[..]].concat()).current_dir(folder.path("")), b"").text();
        let theirs = run_with(radiance.command("rad", &words).current_dir(folder.path("")), b"").text();
        // The name of a temporary file is random.
        let passing = theirs.split_whitespace().find(|word| word.starts_with("il") && word.len() == 8);
        let theirs = passing.map_or(theirs.clone(), |name| theirs.replace(name, ".room_illum.rad"));
        assert_eq!(ours, theirs, "{words:?}");
    }
}

#[test]
fn a_project_becomes_finished_pictures_once() {
    let folder = bench();
    let run = |words: &[&str]| {
        let words = [&["rad"], words, &["room.rif"]].concat();
        run_with(command(&words).current_dir(folder.path("")), b"")
    };
    let said = run(&["-v", "def"]).text();
    assert_eq!(said.lines().count(), 4, "{said}");
    let picture = Picture::read(&folder.read("room_def.hdr")).expect("a picture");
    assert_eq!((picture.width(), picture.height()), (24, 17));
    assert!(
        picture.header().to_text().contains("\nrpict -vp 0 -3 1 -vh 60 -x 48 -y 36 "),
        "{}",
        picture.header().to_text()
    );
    assert!(!folder.names().contains(&"room_def.unf".to_owned()), "the raw picture is gone");
    assert_eq!(run(&["-v", "def"]).text(), "", "nothing is out of date");
    assert_eq!(run(&["-s", "-N", "2"]).text(), "");
    assert!(folder.names().contains(&"room_3.hdr".to_owned()));
}

#[test]
fn mistakes_are_reported() {
    let folder = bench();
    let refuses = |words: &[&str], message: &str| {
        let run = run_with(command(&[&["rad"], words].concat()).current_dir(folder.path("")), b"");
        assert_eq!(run.messages, format!("radsight: {message}\n"));
        assert_ne!(run.code, 0);
    };
    refuses(&["none.rif"], "cannot read file \"none.rif\": no such file or directory");
    let expected = "expected a file name without white space";
    for (assignment, variable) in [("PICTURE=my pic", "PICTURE"), ("RAW=\"my raw\"", "RAWFILE"), ("ZF=a b", "ZFILE")] {
        let value = assignment.split_once('=').expect("an assignment").1.trim_matches('"');
        let message = format!("rad: variable {variable} is \"{value}\", {expected}");
        refuses(&["-n", "room.rif", assignment], &message);
    }
    refuses(&["-n", "room.rif", "QUAL=best"], "rad: variable QUALITY is \"best\", expected low, medium or high");
    refuses(&["-n", "room.rif", "FOO=1"], "rad: command line: unknown variable \"FOO\"");
    refuses(&["-n", "room.rif", "sce=lost.rad"], "rad: file \"lost.rad\" does not exist");
    refuses(
        &["-n", "-w", "room.rif", "RES=wide"],
        "rad: variable RESOLUTION is \"wide\", expected columns, and rows and pixel aspect if wanted",
    );
}
