//! Flickering lamps under a global and a rolling shutter, through the program.

use crate::program::{Folder, Run, command, run_with};
use std::f64::consts::PI;

const ROWS: usize = 40;
const COLUMNS: usize = 12;
const EXPOSURE_S: f64 = 0.002;
const LINE_TIME_S: f64 = 250e-6;
const SCENE: &str = "void plastic floor 0 0 5 .6 .6 .6 0 0\nvoid light tube 0 0 3 900 900 900\nvoid light steady 0 0 3 500 500 500\n\
    floor polygon f 0 0 12 -1 -1 0 1 -1 0 1 1 0 -1 1 0\nsteady sphere s 0 0 4 -.3 .2 .9 .02\n";
const TUBE: &str = "tube sphere t 0 0 4 .3 .2 .9 .02\n";
const FLICKER: &str = "[flicker.tube]\nfrequency_hz = 100\nmodulation = 0.6\nphase_deg = 25\n";

fn camera(model: &str, shutter: &str, more: &str) -> String {
    format!(
        "[camera]\nposition_m = [0, 0, 0.48]\ndirection = [0, 0, -1]\nup = [0, 1, 0]\npixels = [{COLUMNS}, {ROWS}]\n\
        pixel_pitch_um = [50, 40]\nfocal_distance_mm = 6.75\npinhole_diameter_mm = 0.1\nwavelength_nm = 650\n\
        exposure_ms = 2\npinhole_model = \"{model}\"\n{shutter}\n{more}"
    )
}

const ROLLING: &str = "shutter = \"rolling\"\nline_time_us = 250";

fn capture(camera: &str, scene: &str, effort: &[&str]) -> Run {
    let folder = Folder::new();
    folder.file("camera.toml", camera);
    folder.file("scene.rad", scene);
    let words = ["capture", "camera.toml", "scene.rad", "--exposure", "-"];
    run_with(command(&[&words[..], effort].concat()).current_dir(folder.path("")), b"")
}

/// Exposures in file order, at the end of the file.
fn exposures(camera: &str, scene: &str, effort: &[&str]) -> Vec<f64> {
    let bytes = capture(camera, scene, effort).done();
    let numbers = &bytes[bytes.len() - 4 * ROWS * COLUMNS..];
    numbers.chunks(4).map(|four| f64::from(f32::from_le_bytes(four.try_into().unwrap()))).collect()
}

#[track_caller]
fn refused(run: &Run, message: &str) {
    assert!(run.code == 1 && run.messages.contains(message), "{}: {}", run.code, run.messages);
}

/// The mean of 1 + 0.6 cos(2π 100 t + 25°) over the exposure of a row.
fn share(row: usize) -> f64 {
    let phase = |time: f64| 2.0 * PI * 100.0 * time + 25f64.to_radians();
    let start = row as f64 * LINE_TIME_S;
    1.0 + 0.6 * (phase(start + EXPOSURE_S).sin() - phase(start).sin()) / (2.0 * PI * 100.0 * EXPOSURE_S)
}

#[test]
fn a_rolling_shutter_shows_the_bands_of_the_waveform_integral() {
    let lit = format!("{SCENE}{TUBE}");
    for model in ["finite", "diffraction"] {
        let effort = ["--samples", "8"];
        let both = exposures(&camera(model, ROLLING, FLICKER), &lit, &effort);
        // Rays must be sampled alike: a steady lamp in [flicker] makes a diffracting camera use its
        // full pattern.
        let still = FLICKER.replace("0.6", "0");
        let whole = exposures(&camera(model, ROLLING, &still), &lit, &effort);
        let steady = exposures(
            &camera(model, ROLLING, &still),
            &format!("{}{TUBE}", SCENE.replace("500 500 500", "0 0 0")),
            &effort,
        );
        for pixel in 0..ROWS * COLUMNS {
            let (tube, rest) = (steady[pixel], whole[pixel] - steady[pixel]);
            let expected = rest + share(pixel / COLUMNS) * tube;
            assert!((both[pixel] / expected - 1.0).abs() < 0.02, "{model} {pixel}: {} against {expected}", both[pixel]);
        }
        let mean = |row: usize| both[row * COLUMNS..(row + 1) * COLUMNS].iter().sum::<f64>();
        assert!(mean(16) < 0.9 * mean(36), "{model}: {} {}", mean(16), mean(36));
    }
}

/// A coloured lamp among grey ones: its bands count as they do without flicker.
#[test]
fn a_coloured_lamp_flickers_in_all_its_bands() {
    let coloured = SCENE.replace("900 900 900", "2000 500 200");
    let [scene, grey] = [&*coloured, SCENE].map(|scene| format!("{scene}{TUBE}"));
    let effort = ["--samples", "8"];
    let of = |scene: &str| exposures(&camera("finite", ROLLING, FLICKER), scene, &effort);
    // The mean of the bands is that of the grey lamp.
    for (pixel, (own, grey)) in of(&scene).iter().zip(of(&grey)).enumerate() {
        assert!((own / grey - 1.0).abs() < 1e-5, "{pixel}: {own} against {grey}");
    }
}

#[test]
fn the_asked_error_is_reached_with_bands_too() {
    let lit = format!("{SCENE}{TUBE}");
    let effort = ["--error", "0.002"];
    let bands = exposures(&camera("finite", ROLLING, FLICKER), &lit, &effort);
    let whole = exposures(&camera("finite", ROLLING, ""), &lit, &effort);
    let rest = exposures(&camera("finite", ROLLING, ""), SCENE, &effort);
    for pixel in 0..ROWS * COLUMNS {
        let expected = rest[pixel] + share(pixel / COLUMNS) * (whole[pixel] - rest[pixel]);
        assert!((bands[pixel] / expected - 1.0).abs() < 0.02, "{pixel}: {} against {expected}", bands[pixel]);
    }
}

#[test]
fn under_a_global_shutter_a_flickering_lamp_is_a_lamp_of_another_brightness() {
    let effort = ["--samples", "8"];
    let flickering = exposures(&camera("finite", "", FLICKER), &format!("{SCENE}{TUBE}"), &effort);
    let scaled = format!("{}", 900.0 * share(0));
    let bright = format!("{SCENE}{TUBE}").replace("900 900 900", &format!("{scaled} {scaled} {scaled}"));
    let expected = exposures(&camera("finite", "", ""), &bright, &effort);
    assert!(flickering.iter().zip(&expected).all(|(a, b)| (a / b - 1.0).abs() < 1e-5));
    assert!((share(0) - 1.0).abs() > 0.1);
}

#[test]
fn a_lamp_flickers_under_its_other_names_too() {
    let effort = ["--samples", "4"];
    let renamed = TUBE.replacen("tube", "other", 1);
    let alias = format!("{SCENE}void alias other tube\n{renamed}");
    for shutter in ["", ROLLING] {
        let camera = |section: &str| camera("finite", shutter, section);
        let expected = exposures(&camera(FLICKER), &format!("{SCENE}{TUBE}"), &effort);
        assert_eq!(exposures(&camera(FLICKER), &alias, &effort), expected);
        // A section of its own counts.
        let own = format!("{FLICKER}{}", FLICKER.replace("tube", "other").replace("0.6", "0"));
        assert_eq!(exposures(&camera(&own), &alias, &effort), exposures(&camera(""), &alias, &effort));
    }
}

#[test]
fn a_lamp_that_the_scene_lacks_is_an_error_that_lists_those_it_has() {
    let lit = format!("{SCENE}{TUBE}");
    let run = capture(&camera("finite", ROLLING, &FLICKER.replace("tube", "tub")), &lit, &["--samples", "1"]);
    refused(&run, "error: [flicker.tub]: the scene has no light, illum, glow or spotlight of this name\n");
    refused(&run, " | [flicker.tub]\n");
    refused(&run, "hint: it has tube, steady");
}

#[test]
fn a_rolling_shutter_without_line_time_and_a_modulation_above_one_are_errors() {
    let bad = camera("finite", "shutter = \"rolling\"", &FLICKER.replace("0.6", "1.6"));
    let run = capture(&bad, SCENE, &["--samples", "1"]);
    refused(&run, "\"modulation\" must be at most 1, not 1.6");
    refused(&run, "[camera] has no \"line_time_us\"");
}
