//! Derivatives of captures by cameras with a lens or another projection: against analytic answers and
//! central differences of converged pictures.

use radsight::{Capture, CaptureDerivatives, Derivative, MemoryLoader, Parameter, Scene};
use std::f64::consts::PI;

/// A camera at the height `above` over the plane z = 0; `rest` are further lines.
fn capture(above: f64, pixels: [u32; 2], rest: &str) -> Capture {
    let [columns, rows] = pixels;
    let text = format!(
        "[camera]\nposition_m = [0, 0, {above}]\ndirection = [0, 0, -1]\nup = [0, 1, 0]\npixels = [{columns}, {rows}]\n\
         exposure_ms = 10\n{rest}"
    );
    Capture::from_text("camera.toml", text.as_bytes(), &MemoryLoader::default()).unwrap().error(0.05)
}

fn derivative(capture: &Capture, scene: &str, name: &str, error: f64) -> Derivative {
    let parameters: [Parameter; 1] = [name.parse().unwrap()];
    let scene = Scene::builder().text("scene.rad", scene);
    CaptureDerivatives::new(scene).expose(capture, &parameters, error).unwrap().derivatives.remove(0).derivative
}

fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, count) = values.into_iter().fold((0.0, 0), |(sum, count), value| (sum + value * value, count + 1));
    (sum / f64::from(count)).sqrt()
}

/// The central difference of plain exposures of two captures, each with its scene, and its noise.
fn difference(sides: &[(Capture, String); 2], by: f64, samples: u32) -> (Vec<f64>, f64) {
    let seeds = [1, 2, 3, 4];
    let of_seed = |seed: u64| -> Vec<f64> {
        let [below, above] = sides.each_ref().map(|(capture, scene)| {
            let capture = capture.clone().samples(samples).seed(seed);
            let scene = Scene::builder().text("scene.rad", scene).build().unwrap();
            capture.expose(&scene).unwrap().exposure_j_per_m2
        });
        above.iter().zip(&below).map(|(above, below)| (above - below) / by).collect()
    };
    let all = seeds.map(of_seed);
    let mean: Vec<f64> = (0..all[0].len()).map(|at| all.iter().map(|one| one[at]).sum::<f64>() / 4.0).collect();
    let noise = rms(all.iter().flat_map(|one| one.iter().zip(&mean).map(|(a, b)| a - b))) / 3f64.sqrt();
    (mean, noise)
}

/// The derivative is the central difference of `sides` within their errors.
fn assert_is_difference(found: &Derivative, sides: &[(Capture, String); 2], by: f64, case: &str) {
    let (truth, noise) = difference(sides, by, 1024);
    let size = rms(truth.iter().copied());
    let deviation = rms(found.values.iter().zip(&truth).map(|(value, truth)| value - truth));
    let stated = rms(found.standard_errors.iter().copied());
    println!(
        "{case}: deviation {:.4}, stated error {:.4}, by the step {:.4}, noise of the difference {:.4}",
        deviation / size,
        stated / size,
        found.step_error,
        noise / size
    );
    assert!(noise < 0.1 * size && stated < 0.1 * size && found.step_error < 0.05, "{case}: {noise} of {size}");
    let allowed = stated.hypot(noise).hypot(found.step_error * size);
    assert!(deviation < 1.4 * allowed + 0.01 * size, "{case}: {deviation} of {size}, stated {stated}, noise {noise}");
}

/// A lens of 6.75 mm at f/13.5 with pixels of 27 µm.
fn lens(focus_m: f64) -> String {
    format!("pixel_pitch_um = [27, 27]\nlens_focal_length_mm = 6.75\nf_number = 13.5\nfocus_distance_m = {focus_m}\n")
}

#[test]
fn the_edge_of_a_card_is_blurred_by_a_lens_that_is_focused_on_it_or_elsewhere() {
    const CARD_LEFT: f64 = -0.001;
    let card = format!(
        "void glow white 0 0 4 1 1 1 0 white polygon card 0 0 12
         {CARD_LEFT} -.1 0  .1 -.1 0  .1 .1 0  {CARD_LEFT} .1 0"
    );
    // The aperture's image on the card is 0, .005, .24, .39, 1.1 and 5 pixels wide.
    for focus in [0.5, 0.49, 10.0, 0.2, 0.1, 0.03] {
        let found = derivative(&capture(0.5, [12, 3], &lens(focus)), &card, "card.x", 0.005);
        let image = (1.0 / 6.75e-3_f64 - 1.0 / focus).recip();
        let on_plane = 27e-6 * 0.5 / image;
        let radius = 0.25e-3 * (1.0 - 0.5 / focus).abs();
        let per_radiance = 0.01 * PI * 0.25e-3_f64.powi(2) / image.powi(2);
        // The share of the aperture that sees the card from a place on the sensor.
        let share = |right_of_edge: f64| match right_of_edge / radius {
            ratio if ratio >= 1.0 => 1.0,
            ratio if ratio <= -1.0 => 0.0,
            ratio => 0.5 + (ratio * (1.0 - ratio * ratio).sqrt() + ratio.asin()) / PI,
        };
        for (pixel, value) in found.values.iter().enumerate() {
            let left = ((pixel % 12) as f64 - 6.0) * on_plane - CARD_LEFT;
            let expected = -per_radiance * (share(left + on_plane) - share(left)) / on_plane;
            let tolerance = 4.0 * found.standard_errors[pixel] + 3e-3 * per_radiance / on_plane;
            assert!(
                (value - expected).abs() <= tolerance,
                "focus {focus}, pixel {pixel}: {value:e} instead of {expected:e} +- {tolerance:e}"
            );
        }
        assert!(found.step_error < 0.01 && found.relative_error <= 0.005, "focus {focus}: {}", found.step_error);
    }
}

/// A bright disk before a wall.
fn disk(x: f64, radius: f64) -> String {
    format!(
        "void glow g 0 0 4 3 3 3 0  void glow bg 0 0 4 .5 .5 .5 0
         bg polygon back 0 0 12 -5 -5 -.3 5 -5 -.3 5 5 -.3 -5 5 -.3  g ring part 0 0 8 {x} 0 0 0 0 1 0 {radius}"
    )
}

#[test]
fn a_part_moves_before_a_lens_as_central_differences_say() {
    let wide = "pixel_pitch_um = [200, 200]\nlens_focal_length_mm = 6\nf_number = 2\n";
    let usual = "pixel_pitch_um = [3.45, 3.45]\nlens_focal_length_mm = 16\nf_number = 8\nfocus_distance_m = ";
    let tilted = "[alignment]\nsensor_tilt_deg = [8, 10]\nsensor_shift_um = [150, -60]\n";
    let large = "focal_distance_mm = 6\npixel_pitch_um = [200, 200]\npinhole_diameter_mm = 0.2\n";
    // The sides of the disk are in the middle of a pixel: differences of a sharp disk whose side is at the
    // border of one are 5 % off.
    let cases = [
        (0.5, 0.0576, format!("{wide}focus_distance_m = 0.5\n")),
        (0.5, 0.0576, format!("{wide}focus_distance_m = 0.49\n")),
        (0.5, 0.0576, format!("{wide}focus_distance_m = 0.25\n")),
        (0.5, 0.0576, format!("{wide}focus_distance_m = 0.05\n")),
        (0.5, 0.0576, format!("{wide}focus_distance_m = 1e3\n")),
        (0.5, 0.0576, format!("{wide}focus_distance_m = 0.25\nfront_stop_mm = [10, 3]\n")),
        (0.5, 0.0576, format!("{wide}focus_distance_m = 0.5\nfront_stop_mm = [10, 3]\n")),
        (0.5, 0.0576, format!("{wide}focus_distance_m = 0.5\nprojection = \"equidistant\"\n{tilted}")),
        (0.5, 0.0576, format!("{wide}focus_distance_m = 0.4\n{tilted}")),
        (0.5, 0.0576, format!("{large}{tilted}")),
        (0.5, 0.0576, large.to_owned()),
        (0.3, 0.000214, format!("{usual}0.3\n")),
        (0.3, 0.000214, format!("{usual}0.295\n")),
        (0.3, 0.000214, format!("{usual}0.31\n")),
    ];
    for (above, radius, rest) in cases {
        let capture = capture(above, [12, 10], &rest);
        let by = 0.02 * radius;
        let sides = [-by, by].map(|x| (capture.clone(), disk(x, radius)));
        let found = derivative(&capture, &disk(0.0, radius), "part.x", 0.02);
        assert_is_difference(&found, &sides, 2.0 * by, &rest);
    }
}

/// A sky that is brighter on one side and at some angles.
const SKY: &str = "void brightfunc p 2 1+.4*cos(6*Dx)+.3*sin(7*Dy) . 0 0
    p glow g 0 0 4 2 2 2 0  g source s 0 0 4 0 0 -1 360";

#[test]
fn the_picture_of_every_projection_grows_with_the_focal_distance() {
    let at = |focal_mm: f64, rest: &str| {
        let rest = format!("focal_distance_mm = {focal_mm}\npinhole_diameter_mm = 0.1\n{rest}");
        (capture(0.5, [24, 20], &rest), SKY.to_owned())
    };
    for projection in ["perspective", "equidistant", "orthographic", "stereographic", "cylindrical"] {
        let rest = format!("pixel_pitch_um = [200, 200]\nprojection = \"{projection}\"\n");
        let found = derivative(&at(6.0, &rest).0, SKY, "focal.distance", 0.005);
        assert_is_difference(&found, &[at(5.97, &rest), at(6.03, &rest)], 6e-5, projection);
    }
}

#[test]
fn the_picture_of_a_calibrated_camera_grows_with_the_focal_distance() {
    let at = |focal_mm: f64| {
        // Pixels of 200 µm on the same sensor.
        let focal = focal_mm / 0.2;
        let matrix = format!(
            "%YAML:1.0\n---\nimage_width: 24\nimage_height: 20\n\
             camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   \
             data: [ {focal}, 0., 12., 0., {focal}, 9., 0., 0., 1. ]\n\
             distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n   \
             data: [ -0.1, 0.02, 1e-3, -5e-4, 0. ]\n"
        );
        let loader = MemoryLoader::default().with("calibration.yaml", matrix.into_bytes());
        let text = format!(
            "[camera]\nposition_m = [0, 0, 0.5]\ndirection = [0, 0, -1]\nup = [0, 1, 0]\nexposure_ms = 10\n\
             camera_matrix = \"calibration.yaml\"\nfocal_distance_mm = {focal_mm}\npinhole_diameter_mm = 0.1\n"
        );
        let capture = Capture::from_text("camera.toml", text.as_bytes(), &loader).unwrap().error(0.05);
        (capture, SKY.to_owned())
    };
    let found = derivative(&at(6.0).0, SKY, "focal.distance", 0.005);
    assert_is_difference(&found, &[at(5.97), at(6.03)], 6e-5, "calibrated");
}
