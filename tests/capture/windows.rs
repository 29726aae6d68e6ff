//! Captures through protective windows: panes across the view of a camera.

use crate::pictures::{Difference, exposure_file};
use crate::program::{Folder, gripps, radsight, root};
use radsight_picture::Image;
use std::path::Path;

/// Transmissivity and index of refraction of the panes.
const TRANSMISSIVITY: f64 = 0.96;
const INDEX: f64 = 1.52;

/// The fractions of light that a pane reflects and transmits at an angle, by Fresnel's equations and all
/// reflections within it; both polarisations.
fn pane(angle: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    let inside = (1.0 - (sin / INDEX).powi(2)).sqrt();
    let amplitudes = [(cos - INDEX * inside) / (cos + INDEX * inside), (inside - INDEX * cos) / (inside + INDEX * cos)];
    let absorbed = TRANSMISSIVITY.powf(1.0 / inside);
    let of_both =
        |of_one: &dyn Fn(f64) -> f64| amplitudes.iter().map(|amplitude| of_one(amplitude.powi(2))).sum::<f64>() / 2.0;
    let transmitted = |r: f64| (1.0 - r).powi(2) * absorbed / (1.0 - (r * absorbed).powi(2));
    let reflected = |r: f64| r + r * absorbed * transmitted(r);
    [of_both(&reflected), of_both(&transmitted)]
}

/// A square of a material 0.3 m above the sheet, tilted about the y axis.
fn window(material: &str, tilt: f64) -> String {
    let (sin, cos) = tilt.sin_cos();
    let corner = |x: f64, y: f64| format!("{} {y} {}\n", x * cos, 0.3 + x * sin);
    let corners = [corner(-0.2, -0.2), corner(0.2, -0.2), corner(0.2, 0.2), corner(-0.2, 0.2)].concat();
    format!("void {material}\nm polygon window\n0\n0\n12\n{corners}")
}

fn glass(tilt: f64) -> String {
    window(&format!("glass m\n0\n0\n3 {TRANSMISSIVITY} {TRANSMISSIVITY} {TRANSMISSIVITY}\n"), tilt)
}

struct Captured {
    exposure: Image<f32>,
    rays: f64,
}

fn capture(camera: &str, scenes: &[&str], options: &[&str]) -> Captured {
    let folder = Folder::new();
    let camera = if Path::new(camera).is_absolute() { camera.into() } else { root().join("tests/gripps").join(camera) };
    let (camera, out, record) = (camera.to_string_lossy().into_owned(), folder.word("x.pfm"), folder.word("x.json"));
    let mut words = vec!["capture", &camera, "--exposure", &out, "--record", &record];
    words.extend(scenes.iter().chain(options).copied());
    radsight(&words).done();
    let record = std::fs::read_to_string(folder.path("x.json")).expect("a record");
    let record: serde_json::Value = serde_json::from_str(&record).expect("JSON");
    Captured { exposure: exposure_file(&folder.path("x.pfm")), rays: record["rays"].as_f64().expect("a number") }
}

fn times(image: &Image<f32>, factor: f64) -> Image<f32> {
    let values = image.data().iter().map(|value| (f64::from(*value) * factor) as f32).collect();
    Image::new(image.width(), image.height(), 1, values).expect("a picture")
}

/// Captures of a window across the view, and of a mirror in its place with the same reflectance.
fn captured_window_and_mirror(camera: &str, error: &str) -> [Captured; 2] {
    let folder = Folder::new();
    let [reflected, _] = pane(0.0);
    let mirror = window(&format!("mirror m\n0\n0\n3 {reflected} {reflected} {reflected}\n"), 0.0);
    [("window.rad", glass(0.0)), ("mirror.rad", mirror)].map(|(name, scene)| {
        std::fs::write(folder.path(name), scene).expect("written");
        capture(camera, &[&folder.word(name)], &["--error", error])
    })
}

/// Captures of scenes behind a window tilted by 15 degrees, which shows no LED, and without it; and how the
/// former differs from the latter times the squared transmittance.
fn captured_behind_tilted_window(scenes: &[&str]) -> ([Captured; 2], Difference) {
    let (folder, tilt) = (Folder::new(), 15_f64.to_radians());
    std::fs::write(folder.path("window.rad"), glass(tilt)).expect("written");
    let (camera, error, window) = ("part-fine.toml", ["--error", "0.005"], folder.word("window.rad"));
    let with = capture(camera, &[scenes, &[window.as_str()]].concat(), &error);
    let without = capture(camera, scenes, &error);
    let [_, transmitted] = pane(tilt);
    let difference = Difference::new(&with.exposure, &times(&without.exposure, transmitted * transmitted));
    println!("{difference:?}, {} and {} rays", without.rays, with.rays);
    ([with, without], difference)
}

/// The light of LEDs passes it twice, and what it reflects is seen elsewhere. Pixels share rays as without it.
#[test]
fn a_tilted_window_dims_the_sheet() {
    let ([with, without], difference) = captured_behind_tilted_window(&[&gripps("sheet-retro.rad")]);
    assert!(difference.rms < 0.007 && difference.mean.abs() < 0.002, "{difference:?}");
    assert!(with.rays < 4.0 * without.rays, "{} and {} rays", without.rays, with.rays);
}

/// As a mirror of the same reflectance does, whose images of LEDs are known as virtual sources.
#[test]
fn a_window_across_the_view_shows_the_leds() {
    let [window, mirror] = captured_window_and_mirror("centre-fine.toml", "0.005");
    let difference = Difference::new(&window.exposure, &mirror.exposure);
    println!("{difference:?}, {} rays", window.rays);
    assert!(difference.rms < 0.012 && difference.mean.abs() < 0.003, "{difference:?}");
    assert!(window.rays < 1e6, "{} rays", window.rays);
}

/// The images of LEDs fill whole pixels of a lens, and are nearly in its focus: aimed rays would mostly pass
/// other pixels.
#[test]
fn a_window_before_a_lens_shows_the_leds() {
    let folder = Folder::new();
    let camera = "[camera]\nposition_m = [0, 0, 0.48]\ndirection = [0, 0, -1]\nup = [0, 1, 0]\npixels = [32, 28]\n\
        pixel_pitch_um = [27.5, 32]\nlens_focal_length_mm = 6.75\nf_number = 4\nfocus_distance_m = 0.48\n\
        exposure_ms = 10\nwavelength_nm = 650\n\
        [rig]\nleds = 12\nring_diameter_mm = 25.4\nled_diameter_mm = 5\nled_intensity_w_per_sr = 0.055\nled_cone_deg = 40\n";
    std::fs::write(folder.path("camera.toml"), camera).expect("written");
    let [window, mirror] = captured_window_and_mirror(&folder.word("camera.toml"), "0.02");
    let difference = Difference::new(&window.exposure, &mirror.exposure);
    println!("{difference:?}, {} and {} rays", window.rays, mirror.rays);
    assert!(difference.rms < 0.03 && difference.mean.abs() < 0.005, "{difference:?}");
    assert!(window.rays < 1e6, "{} rays", window.rays);
}

/// Two panes show images of LEDs behind several reflections, as a density of rays over a region.
/// `tests/gripps/truth/two-windows.pfm` is the mean of two captures by `--samples 2048` with different seeds.
/// Its noise is 0.64 % of the mean exposure.
#[test]
fn two_windows_show_the_leds_twice() {
    let (folder, sheet) = (Folder::new(), gripps("sheet-retro.rad"));
    let scene = root().join("tests/gripps/two-windows.rad").to_string_lossy().into_owned();
    let camera = std::fs::read_to_string(root().join("tests/gripps/centre-fine.toml")).expect("a camera");
    let table = gripps("hlmp-8104.csv");
    let camera = camera
        .replace("[0.00625, 0.00417, -0.99997]", "[0.0, 0.0, -1.0]")
        .replace("[48, 40]", "[48, 41]")
        .replace("../../radiance-scenes/gripps/hlmp-8104.csv", &table);
    std::fs::write(folder.path("camera.toml"), camera).expect("written");
    let captured = capture(&folder.word("camera.toml"), &[&sheet, &scene], &["--error", "0.005"]);
    let truth = exposure_file(&root().join("tests/gripps/truth/two-windows.pfm"));
    let difference = Difference::new(&captured.exposure, &truth);
    println!("{difference:?}, {} rays", captured.rays);
    assert!(difference.rms < 0.011 && difference.mean.abs() < 0.003, "{difference:?}");
}

/// A part behind a window: no ray of the polished ball's images of LEDs is lost, and none counts twice.
#[test]
fn a_part_behind_a_window_keeps_its_images() {
    let scenes = [gripps("sheet-retro.rad"), gripps("part-ball.rad")];
    let (_, difference) = captured_behind_tilted_window(&scenes.each_ref().map(String::as_str));
    assert!(difference.rms < 0.012 && difference.mean.abs() < 0.004, "{difference:?}");
}
