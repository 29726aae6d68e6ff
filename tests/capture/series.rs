//! `radsight capture --variants`: every picture equals that of a single capture.

use crate::pictures::{Difference, exposure_file, show};
use crate::program::{Folder, gripps, radsight, root};
use radsight_picture::Image;

fn file(name: &str) -> String {
    root().join("tests/gripps").join(name).to_string_lossy().into_owned()
}

/// A folder with a table of pictures, and the words of its captures.
struct Series {
    folder: Folder,
    scenes: Vec<String>,
}

impl Series {
    fn new(table: &str, part: &str) -> Series {
        let folder = Folder::new();
        folder.file("table.csv", table);
        Series { folder, scenes: vec![gripps("sheet-retro.rad"), part.to_owned()] }
    }

    /// The pictures of the table.
    fn pictures(&self, names: &[&str], error: &str) -> Vec<Image<f32>> {
        let (table, out) = (self.folder.word("table.csv"), self.folder.word("series-{}.pfm"));
        self.capture(&file("part.toml"), &["--variants", &table, "--error", error, "--exposure", &out]);
        names.iter().map(|name| exposure_file(&self.folder.path(&format!("series-{name}.pfm")))).collect()
    }

    /// A single capture, with some words of the camera file replaced and the part's text
    /// transformed.
    fn alone(&self, replaced: [&str; 2], pose: &str, error: &str) -> Image<f32> {
        let camera = std::fs::read_to_string(file("part.toml")).expect("a camera file");
        assert!(camera.contains(replaced[0]));
        let camera = camera.replace(replaced[0], replaced[1]).replace("../../", &format!("{}/", root().display()));
        self.folder.file("alone.toml", &camera);
        self.folder.file("alone.rad", format!("!xform {pose} {}\n", self.scenes[1]));
        let (camera, part, out) =
            (self.folder.word("alone.toml"), self.folder.word("alone.rad"), self.folder.word("alone.pfm"));
        radsight(&["capture", &camera, &self.scenes[0], &part, "--error", error, "--exposure", &out]).done();
        exposure_file(&self.folder.path("alone.pfm"))
    }

    fn capture(&self, camera: &str, words: &[&str]) {
        let scenes = self.scenes.iter().map(String::as_str);
        let all: Vec<&str> = ["capture", camera].into_iter().chain(scenes).chain(words.iter().copied()).collect();
        radsight(&all).done();
    }
}

/// A lamp of the scene keeps its light when that of the ring changes.
#[test]
fn the_intensity_of_the_ring_changes_no_other_lamp() {
    let folder = Folder::new();
    let lamp = folder.file("lamp.rad", "void light l 0 0 3 20 20 20\nl sphere lamp 0 0 4 .02 .01 .1 .01\n");
    let series = Series::new("name,rig.led_intensity_w_per_sr\na,\nb,.11\n", &lamp);
    let [a, b]: [Image<f32>; 2] = series.pictures(&["a", "b"], ".05").try_into().expect("two");
    let single = series.alone(["led_intensity_w_per_sr = 0.055", "led_intensity_w_per_sr = 0.11"], "", ".05");
    assert!(b.data() == single.data());
    let [a, b] = [a, b].map(|image| image.data().iter().map(|value| f64::from(*value)).sum::<f64>());
    assert!(b < 1.99 * a && b > a, "{a} {b}");
}

#[test]
fn sensor_and_exposure_time_change_no_bit_of_a_picture() {
    let table = "name,sensor.gamma,camera.exposure_ms,rig.led_intensity_w_per_sr\na,,,\nb,.5,,\nc,,3.0,\nd,,,.11\n";
    let series = Series::new(table, &gripps("part-ball.rad"));
    let [a, b, c, d]: [Image<f32>; 4] = series.pictures(&["a", "b", "c", "d"], ".05").try_into().expect("four");
    let exposure = "exposure_ms = 10.0";
    let alone = |ms: &str| series.alone([exposure, ms], "", ".05");
    assert!(a.data() == alone(exposure).data() && b.data() == a.data());
    assert!(c.data() == alone("exposure_ms = 3.0").data());
    assert!(d.data().iter().zip(a.data()).all(|(d, a)| (d - 2.0 * a).abs() <= 1e-6 * a));
}

const POSES: [&str; 4] = ["", "-t -.02 0 0", "-t .015 -.025 0", "-t -.03 -.012 0 -ry 12 -t .03 .012 .006"];

/// Pictures to an error of 2 % of a washer in four poses, behind a pinhole of this diameter.
fn moved_washers(diameter: &str) -> (Series, Vec<Image<f32>>) {
    let head = "name,camera.pinhole_diameter_mm,move top,move out*,move inside\n";
    let line = |(name, pose): (u32, &str)| format!("{name},{diameter},{pose},{pose},{pose}\n");
    let lines: String = (0..).zip(POSES).map(line).collect();
    let series = Series::new(&format!("{head}{lines}"), &file("tall-washer.rad"));
    let pictures = series.pictures(&["0", "1", "2", "3"], ".02");
    (series, pictures)
}

#[test]
fn pictures_of_a_moving_part_are_those_of_captures_alone() {
    let error = 0.02_f64;
    let (series, pictures) = moved_washers("0.1");
    for (pose, picture) in POSES.iter().zip(&pictures) {
        let truth = series.alone(["leds = 12", "leds = 12"], pose, ".01");
        let difference = Difference::new(picture, &truth);
        println!("{pose}: {difference:?}");
        if difference.rms > 1.2 * (error * error + 1e-4).sqrt() || difference.mean.abs() > 0.3 * error {
            let shown = show("series", picture, &truth);
            panic!("{pose}: {difference:?}; see {}", shown.display());
        }
    }
}

/// Behind a small pinhole pixels have rays of their own, and those that the part's light does not affect are
/// the same.
#[test]
fn pixels_that_a_moving_part_does_not_affect_are_shared() {
    let (_, pictures) = moved_washers("0.05");
    let shared = pictures[0].data().iter().zip(pictures[1].data()).filter(|(a, b)| a == b).count();
    assert!((40..400).contains(&shared), "{shared} of 480 pixels are shared");
}

#[test]
fn mistakes_of_a_series_are_reported_with_their_position() {
    let cases = [
        (
            "# top\nmove tup\n-t 1 0 0\n",
            "table.csv:2:6: error: the scene has no surface \"tup\" that could be moved\n  2 | move tup\n    |      ^^^\n",
        ),
        ("move background\n-t 1 0 0\n", "\"background\" cannot be moved: its modifier \"to_viewer\""),
        (
            "name,rig.ring_diameter_mm\na,20\nb,-3\n",
            "table.csv:3:3: error: \"ring_diameter_mm\" must be positive, not -3\n  3 | b,-3\n    |   ^^\n",
        ),
        ("name,rig.ring_diameter\na,3\n", "table.csv:1:6: error: unknown key \"ring_diameter\""),
        ("move top\n-s 2\n", "table.csv:2:1: error: the transform is not rigid"),
    ];
    for (table, expected) in cases {
        let series = Series::new(table, &file("tall-washer.rad"));
        let (camera, table, out) = (file("part.toml"), series.folder.word("table.csv"), series.folder.word("{}.pfm"));
        let [sheet, part] = &series.scenes[..] else { panic!("two scenes") };
        let run = |out: &str| radsight(&["capture", &camera, sheet, part, "--variants", &table, "--exposure", out]);
        let told = run(&out);
        assert!(told.code == 1 && told.messages.contains(expected), "{expected}\n{told:?}");
        let told = run("x.pfm");
        assert!(told.code == 2 && told.messages.contains("expected {} in it"), "{told:?}");
    }
}

#[test]
fn a_name_may_be_in_the_folder_too_and_a_series_is_not_resumed() {
    let series = Series::new("name,camera.exposure_ms\na,\nb,5\n", &file("tall-washer.rad"));
    let (camera, table) = (file("part.toml"), series.folder.word("table.csv"));
    for name in ["a", "b"] {
        std::fs::create_dir(series.folder.path(name)).expect("a folder");
    }
    let out = series.folder.word("{}/x-{}.pfm");
    let words = ["capture", &camera, &series.scenes[0], "--variants", &table, "--samples", "1", "--exposure", &out];
    radsight(&words).done();
    assert!(series.folder.path("a/x-a.pfm").exists() && series.folder.path("b/x-b.pfm").exists());
    let told = radsight(&[&words[..], &["--resume"]].concat());
    assert!(told.code == 2 && told.messages.contains("a series cannot be resumed"), "{told:?}");
}

/// The Fisher information needs the noise of a sensor, which is known before anything is traced.
#[test]
fn the_fisher_information_is_refused_at_once_without_a_sensor() {
    let folder = Folder::new();
    let camera = folder.file("camera.toml", SMALL_CAMERA);
    let scene = folder.file("scene.rad", SMALL_SCENE);
    let out = folder.word("f.json");
    let words =
        ["capture", &camera, &scene, "--derivative", "distance", "--derivative-error", "1e-9", "--fisher", &out];
    let told = radsight(&words);
    assert!(told.code == 1 && told.messages.contains("has no [sensor], expected one for --fisher"), "{told:?}");
}

/// A picture that another program would take for something else is refused before anything is traced.
#[test]
fn names_of_other_pictures_are_refused() {
    let words = ["capture", &file("part.toml"), &gripps("sheet-retro.rad"), "-o", "picture.JPG"];
    let run = radsight(&words);
    assert_eq!(run.code, 2, "{}", run.messages);
    assert!(run.messages.contains("written as PNG; for example \"picture.png\""), "{}", run.messages);
}

/// A camera whose pixels share the rays of highlights, so that no number of rays reaches an error of 5 %.
const SMALL_CAMERA: &str = "[camera]
position_m = [0.0, 0.0, 0.3]
direction = [0.0, 0.0, -1.0]
up = [0.0, 1.0, 0.0]
pixels = [12, 10]
pixel_pitch_um = [200.0, 150.0]
focal_distance_mm = 10.0
pinhole_diameter_mm = 0.1
pinhole_model = \"point\"
exposure_ms = 10.0
wavelength_nm = 650.0

[rig]
leds = 6
ring_diameter_mm = 40.0
led_diameter_mm = 5.0
led_intensity_w_per_sr = 0.05
led_cone_deg = 20.0
";

/// A rough metal part on a sheet.
const SMALL_SCENE: &str = "void plastic grey 0 0 5 .5 .4 .3 0 0
grey polygon sheet 0 0 12 -1 -1 0 1 -1 0 1 1 0 -1 1 0
void metal m 0 0 5 .8 .7 .6 .3 .2
m sphere part_ball 0 0 4 .01 .004 .006 .006
m polygon part_tri 0 0 9 -.03 -.02 .004  -.01 -.02 .012  -.02 .01 .002
";

#[test]
fn a_series_says_once_which_pictures_miss_the_error() {
    let folder = Folder::new();
    let camera = folder.file("camera.toml", SMALL_CAMERA);
    let scene = folder.file("scene.rad", SMALL_SCENE);
    let table = folder.file("table.csv", "name,camera.exposure_ms,rig.ring_diameter_mm\na,,\nb,5,\nc,,30\n");
    let [out, derivatives] = ["{}.pfm", "d-{}.pfm"].map(|name| folder.word(name));
    let run = |words: &[&str]| {
        let all: Vec<&str> = ["capture", &camera, &scene].into_iter().chain(words.iter().copied()).collect();
        let run = radsight(&all);
        assert_eq!(run.code, 0, "{run:?}");
        run.messages
    };
    let said = run(&["--variants", &table, "--exposure", &out, "--error", ".05", "--seed", "4"]);
    assert_eq!(said.matches("is left out (-ab 0)").count(), 1, "{said}");
    assert_eq!(said.matches("more than requested").count(), 1, "{said}");
    assert!(said.contains("note: all 3 pictures, the worst of which: the estimated error is "), "{said}");
    let said = run(&["--derivative", "exposure.time", "--derivatives", &derivatives, "--error", ".05", "--seed", "4"]);
    assert_eq!(said.matches("is left out (-ab 0)").count(), 1, "{said}");
    assert_eq!(said.matches("more than requested").count(), 1, "{said}");
}
