//! Files and command lines that real Radiance accepts unchanged.

use crate::program::{Folder, Run, command, run_with};
use radsight_test_support::Radiance;

/// A room for a quick picture.
const ROOM: &str = "void plastic white 0 0 5 .5 .5 .5 0 0\nvoid light lamp 0 0 3 10 10 10\n!genbox white box 2 2 2 -i\n\
    lamp polygon panel 0 0 12 .5 .5 1.9 .5 1.5 1.9 1.5 1.5 1.9 1.5 .5 1.9\n";
const VIEW: [&str; 8] = ["-vp", "1", ".1", "1", "-vd", "0", "1", "0"];
const PICTURE: [&str; 4] = ["-x", "8", "-y", "8"];

fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("room.rad", ROOM);
    folder
}

fn run_in(folder: &Folder, words: &[&str], input: &str) -> Run {
    run_with(command(words).current_dir(folder.path("")), input.as_bytes())
}

fn picture(folder: &Folder) -> Vec<u8> {
    let words = [&["rpict"], &PICTURE[..], &VIEW, &["room.rad"]].concat();
    run_in(folder, &words, "").done()
}

fn header(bytes: &[u8]) -> Vec<String> {
    let text = String::from_utf8_lossy(bytes);
    text.lines().take_while(|line| !line.is_empty()).map(str::to_owned).collect()
}

fn bsdf_scene(folder: &Folder, xml: &[u8]) {
    folder.file("data.xml", xml);
    let scene = "void BSDF pane 6 0 data.xml 0 1 0 . 0 0\npane polygon p 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n\
        void glow sky 0 0 4 1 1 1 0\nsky source dome 0 0 4 0 0 1 360\n";
    folder.file("pane.rad", scene);
}

#[test]
fn a_bsdf_file_with_its_makers_words_before_the_xml_is_read() {
    let folder = Folder::new();
    let xml = DIFFUSE.as_bytes();
    bsdf_scene(&folder, xml);
    let ray = "0.5 0.5 1 0 0 -1\n";
    let expected = run_in(&folder, &["rtrace", "-h", "pane.rad"], ray).text();
    bsdf_scene(&folder, &[b"genBSDF -n 4 +f +b < pane.rad > data.xml\n", xml, b"\ndone\n"].concat());
    let found = run_in(&folder, &["rtrace", "-h", "pane.rad"], ray);
    assert_eq!(found.messages, "");
    assert_eq!(found.text(), expected);
}

#[test]
fn a_bsdf_file_without_xml_stops_a_picture_before_its_header_but_not_oconv() {
    let folder = Folder::new();
    bsdf_scene(&folder, b"genBSDF: no such file\n");
    for words in [&["rpict", "-x", "4", "-y", "4", "pane.rad"][..], &["rtrace", "pane.rad"]] {
        let run = run_in(&folder, words, "0.5 0.5 1 0 0 -1\n");
        assert_eq!((run.code, run.output.len()), (1, 0), "{words:?}");
        assert!(run.messages.contains("data.xml:1:1: error: there is no XML in it"), "{}", run.messages);
    }
    assert!(!run_in(&folder, &["oconv", "pane.rad"], "").done().is_empty());
}

#[test]
fn a_pattern_of_a_scene_command_is_the_files_it_matches_or_stays() {
    let folder = Folder::new();
    folder.file("part1.rad", "white sphere a 0 0 4 0 0 0 1\n");
    folder.file("part2.rad", "white sphere b 0 0 4 0 0 5 1\n");
    let scene = "void plastic white 0 0 5 .5 .5 .5 0 0\n! genrev white tube t*0.994 0.05 32 | xform -t 0 0 1\n\
        !xform -t 9 0 0 part?.rad\n!cat part[12].rad\n";
    folder.file("scene.rad", scene);
    let text = run_in(&folder, &["xform", "-e", "scene.rad"], "").text();
    assert_eq!(text.matches("sphere").count(), 4, "{text}");
    let tubes = text.lines().filter(|line| line.contains("cylinder") || line.contains("tube")).count();
    assert!(tubes >= 32, "{text}");
    assert_eq!(run_in(&folder, &["oconv", "scene.rad"], "").code, 0);
}

#[test]
fn a_renderer_refuses_an_octree_that_is_empty() {
    let folder = folder();
    folder.file("none.oct", "");
    for words in [
        &["rtrace", "none.oct"][..],
        &["rpict", "none.oct"],
        &["rpict"],
        &["rcontrib", "-m", "white", "none.oct"],
        &["mkillum", "none.oct", "<", "room.rad"],
        &["rtrace", "room.rad", "none.oct"],
    ] {
        let run = run_in(&folder, words, "");
        assert_eq!((run.code, run.output.len()), (1, 0), "{words:?}: {}", run.messages);
        assert!(run.messages.contains("is empty: neither an octree nor a scene"), "{words:?}: {}", run.messages);
    }
    let octree = run_in(&folder, &["oconv", "none.oct"], "");
    assert!(octree.messages.contains("warning: \"none.oct\" is empty"), "{}", octree.messages);
    assert!(!octree.done().is_empty());
}

#[test]
fn getbbox_needs_no_materials() {
    let folder = Folder::new();
    folder.file("scene.rad", "void alias a nowhere\na sphere s 0 0 4 0 0 5 1\nb polygon p 0 0 9 0 0 0 1 0 0 1 2 0\n");
    let names = "     xmin      xmax      ymin      ymax      zmin      zmax\n";
    let numbers = "       -1         1        -1         2         0         6\n";
    let text = run_in(&folder, &["getbbox", "scene.rad"], "").text();
    assert_eq!(text, [names, numbers].concat());
    assert_eq!(run_in(&folder, &["getbbox", "-h", "-w", "scene.rad"], "").text(), numbers);
    folder.file("empty.rad", "");
    let numbers = "    1e+10    -1e+10     1e+10    -1e+10     1e+10    -1e+10\n";
    assert_eq!(run_in(&folder, &["getbbox", "-h", "empty.rad"], "").text(), numbers);
}

#[test]
fn cnt_shuffles_a_users_lines_each_time_and_a_scenes_always_alike() {
    let folder = Folder::new();
    let shuffled = || run_in(&folder, &["cnt", "-s", "20", "10"], "").text();
    let [first, second] = [shuffled(), shuffled()];
    assert_ne!(first, second);
    let sorted = |text: &str| {
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        lines.sort();
        lines
    };
    assert_eq!(sorted(&first), sorted(&run_in(&folder, &["cnt", "20", "10"], "").text()));
    let program = "!cnt -s 9 | rcalc -o 'void sphere s 0 0 4 ${$1} 0 0 1 ' -e '$1=$1'\n";
    folder.file("scene.rad", program);
    let scene = || run_in(&folder, &["xform", "-e", "scene.rad"], "").text();
    assert_eq!(scene(), scene());
}

#[test]
fn the_first_letter_of_an_option_counts_where_it_does_in_radiance() {
    let folder = folder();
    folder.file("a.hdr", picture(&folder));
    let same = |one: &[&str], other: &[&str]| {
        let pixels = |words: &[&str]| {
            let bytes = run_in(&folder, words, "").done();
            let end = bytes.windows(2).position(|two| two == b"\n\n").expect("a header");
            bytes[end..].to_vec()
        };
        assert!(pixels(one) == pixels(other), "{one:?} and {other:?} differ");
    };
    same(&["oconv", "-w-", "room.rad"], &["oconv", "room.rad"]);
    same(&["oconv", "-frozen", "room.rad"], &["oconv", "-f", "room.rad"]);
    same(&["pcomb", "-w-", "a.hdr"], &["pcomb", "a.hdr"]);
    same(&["pcomb", "-scale", "2", "a.hdr"], &["pcomb", "-s", "2", "a.hdr"]);
    same(&["falsecolor", "-mask", "10", "-i", "a.hdr"], &["falsecolor", "-m", "10", "-i", "a.hdr"]);
    same(&["falsecolor", "-log10", "2", "-i", "a.hdr"], &["falsecolor", "-log", "2", "-i", "a.hdr"]);
    assert!(header(&run_in(&folder, &["pcomb", "-h-", "a.hdr"], "").done()).iter().all(|line| !line.contains("rpict")));
}

#[test]
fn fixations_on_nothing_leave_the_whole_picture_to_adapt_to() {
    let folder = folder();
    folder.file("a.hdr", picture(&folder));
    let pixels = |words: &[&str]| {
        let bytes = run_in(&folder, words, "").done();
        let end = bytes.windows(2).position(|two| two == b"\n\n").expect("a header");
        bytes[end..].to_vec()
    };
    assert!(pixels(&["pcond", "-i", "1", "a.hdr"]) == pixels(&["pcond", "a.hdr"]));
}

#[test]
fn replmarks_expands_the_transforms_itself() {
    let folder = Folder::new();
    folder.file("object.rad", "void sphere s 0 0 4 0 0 0 1\n");
    let marks = "mark polygon m 0 0 9 0 0 0 2 0 0 2 1 0\n";
    let words = ["replmarks", "-e", "-x", "object.rad", "mark"];
    let text = run_in(&folder, &words, marks).text();
    assert!(text.contains("sphere m.s"), "{text}");
}

#[test]
fn headers_have_the_local_date_and_that_of_greenwich() {
    let folder = folder();
    folder.file("a.hdr", picture(&folder));
    for words in
        [&["pcomb", "a.hdr"][..], &["pcompos", "a.hdr", "0", "0"], &["rpict", "-x", "1", "-y", "1", "room.rad"]]
    {
        let made = run_with(command(words).current_dir(folder.path("")).env("TZ", "XXX-05:30"), b"").done();
        let lines = header(&made);
        let clock = |name: &str| {
            let line = lines.iter().find(|line| line.starts_with(name)).expect("the header has the date");
            let time: Vec<i64> = line[line.len() - 8..].split(':').map(|part| part.parse().unwrap()).collect();
            time[0] * 60 + time[1]
        };
        let ahead = (clock("CAPDATE= ") - clock("GMT= ")).rem_euclid(24 * 60);
        assert_eq!(ahead, 5 * 60 + 30, "{words:?}: {lines:?}");
    }
}

#[test]
fn a_tiff_keeps_the_date_of_its_picture() {
    let folder = folder();
    folder.file("a.hdr", picture(&folder));
    run_in(&folder, &["ra_tiff", "a.hdr", "a.tif"], "").done();
    let back = run_in(&folder, &["ra_tiff", "-r", "a.tif"], "").done();
    let date = |bytes: &[u8]| header(bytes).into_iter().find(|line| line.starts_with("CAPDATE="));
    let expected = date(&run_in(&folder, &["pfilt", "-1", "a.hdr"], "").done());
    assert!(expected.is_some());
    assert_eq!(date(&back), expected);
}

#[test]
fn version_stands_anywhere_among_the_options() {
    let folder = folder();
    for words in [
        &["rtrace", "-version", "room.oct"][..],
        &["rtrace", "-h", "-ab", "2", "-version", "-unknown"],
        &["rpict", "-x", "4", "-version"],
        &["rcontrib", "-n", "2", "-version", "room.oct"],
    ] {
        let text = run_in(&folder, words, "").text();
        assert!(text.starts_with("RADIANCE 6.0a (radsight "), "{words:?}: {text}");
    }
}

#[test]
fn reports_have_radiances_form() {
    let folder = folder();
    let words = [&["rpict", "-t", "9"], &PICTURE[..], &VIEW, &["room.rad"]].concat();
    let run = run_in(&folder, &words, "");
    let reports: Vec<&str> = run.messages.lines().filter(|line| line.contains(" hours on ")).collect();
    assert_eq!(reports.len(), 2, "{}", run.messages);
    let words: Vec<&str> = reports[1].split(' ').collect();
    let ["rpict:", rays, "rays,", "100.00%", "after", user, system, real, "hours", "on", _, "(PID", process] =
        words[..]
    else {
        panic!("{}", reports[1])
    };
    assert!(rays.parse::<u64>().is_ok_and(|rays| rays >= 64), "{rays}");
    for (time, unit) in [(user, 'u'), (system, 's'), (real, 'r')] {
        assert!(time.strip_suffix(unit).is_some_and(|hours| hours.parse::<f64>().is_ok()), "{time}");
    }
    assert!(process.ends_with(')'));
}

#[test]
fn defaults_are_those_of_real_radiance_and_ours_after_them() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = folder();
    for words in [
        &["rtrace"][..],
        &["rtrace", "-h", "-otv", "-fad", "-pXYZ", "-x", "3", "-y", "4", "-i", "-I", "-w", "-ds", ".1", "-u-"],
        &["rtrace", "-cs", "20", "-co+", "-av", "1", "2", "3", "-lr", "0", "-bv-", "-dv"],
        &["rpict"],
        &[
            "rpict", "-ps", "1", "-pt", "0", "-vth", "-vp", "1", "2", "3", "-pXYZ", "-t", "5", "-w-", "-me", ".1",
            ".1", "0",
        ],
        &["rcontrib"],
        &["rcontrib", "-V+", "-fdd", "-c", "0", "-t", "3", "-I+", "-ab", "3", "-lw", "1e-6"],
        &["mkillum"],
    ] {
        let words = [words, &["-defaults"]].concat();
        let lines = |run: Run| -> Vec<String> { run.text().lines().map(str::to_owned).collect() };
        let real = lines(run_with(&mut radiance.command(words[0], &words[1..]), b""));
        let ours = lines(run_in(&folder, &words, ""));
        // The number of threads depends on the machine, and options of our own follow.
        let is_same = |(real, ours): (&String, &String)| real == ours || real.starts_with("-n ");
        assert!(real.iter().zip(&ours).all(is_same), "{words:?}:\n{real:#?}\n{ours:#?}");
        assert!(ours.len() > real.len() && ours[real.len()..].iter().all(|line| line.starts_with("--")), "{ours:#?}");
    }
}

/// A BSDF that scatters half of the light on both sides.
const DIFFUSE: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<WindowElement><FileType>BSDF</FileType><Optical><Layer><Material><Name>half</Name></Material>
<DataDefinition><IncidentDataStructure>TensorTree3</IncidentDataStructure></DataDefinition>
<WavelengthData><Wavelength unit="Integral">Visible</Wavelength><WavelengthDataBlock>
<WavelengthDataDirection>Reflection Back</WavelengthDataDirection><AngleBasis>LBNL/Shirley-Chiu</AngleBasis>
<ScatteringData>{ .159 }</ScatteringData></WavelengthDataBlock></WavelengthData></Layer></Optical></WindowElement>
"#;
