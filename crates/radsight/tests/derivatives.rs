//! Derivatives of captures: against analytic answers, central differences of converged pictures,
//! and their own standard errors.

use radsight::{
    Capture, CaptureDerivatives, Derivative, Error, ExposureDerivatives, FisherInformation, MemoryLoader, Parameter,
    Scene,
};
use std::f64::consts::PI;

const RING: &str = "[rig]\nleds = 6\nring_diameter_mm = 30\nled_diameter_mm = 5\nled_intensity_w_per_sr = 0.05\n\
                    led_cone_deg = 40\n";

const SENSOR: &str = "[sensor]\nresponse = \"emva1288\"\nquantum_efficiency = 0.5\ngain_dn_per_e = 0.5\n\
                      dark_offset_dn = 20\nread_noise_e = 10\nfull_well_e = 30000\nbits = 12\n";

/// A camera half a metre above the plane z = 0.
struct Setup {
    pixels: [u32; 2],
    pitch_um: f64,
    model: &'static str,
    pinhole_mm: f64,
    distance_m: f64,
    ring: String,
}

impl Setup {
    fn new(pixels: [u32; 2], pitch_um: f64) -> Setup {
        Setup { pixels, pitch_um, model: "finite", pinhole_mm: 0.1, distance_m: 0.5, ring: String::new() }
    }

    fn capture(&self) -> Capture {
        let Setup { pixels: [columns, rows], pitch_um, model, pinhole_mm, distance_m, ring } = self;
        let text = format!(
            "[camera]\nposition_m = [0, 0, {distance_m}]\ndirection = [0, 0, -1]\nup = [0, 1, 0]\n\
             pixels = [{columns}, {rows}]\npixel_pitch_um = [{pitch_um}, {pitch_um}]\nfocal_distance_mm = 6.75\n\
             pinhole_diameter_mm = {pinhole_mm}\npinhole_model = \"{model}\"\nexposure_ms = 10\nwavelength_nm = 650\n{ring}"
        );
        Capture::from_text("camera.toml", text.as_bytes(), &MemoryLoader::default()).unwrap().error(0.05)
    }

    /// Width of a pixel on the plane, metres.
    fn on_plane(&self) -> f64 {
        self.pitch_um * 1e-6 * self.distance_m / 6.75e-3
    }
}

fn derivatives(capture: &Capture, scene: &str, names: &[&str], error: f64) -> ExposureDerivatives {
    let parameters: Vec<Parameter> = names.iter().map(|name| name.parse().unwrap()).collect();
    let scene = Scene::builder().text("scene.rad", scene);
    CaptureDerivatives::new(scene).expose(capture, &parameters, error).unwrap()
}

fn derivative(capture: &Capture, scene: &str, name: &str, error: f64) -> Derivative {
    derivatives(capture, scene, &[name], error).derivatives.remove(0).derivative
}

fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, count) = values.into_iter().fold((0.0, 0), |(sum, count), value| (sum + value * value, count + 1));
    (sum / f64::from(count)).sqrt()
}

/// Exposure of a pixel for a radiance of 1 on its axis, J/m².
fn exposure_per_radiance(setup: &Setup) -> f64 {
    0.01 * PI / 4.0 * (setup.pinhole_mm * 1e-3).powi(2) / 6.75e-3_f64.powi(2)
}

/// A bright card whose left edge is in the middle of column 5.
const CARD_LEFT: f64 = -0.001;

fn card() -> String {
    format!(
        "void glow white 0 0 4 1 1 1 0 white polygon card 0 0 12
         {CARD_LEFT} -.1 0  .1 -.1 0  .1 .1 0  {CARD_LEFT} .1 0"
    )
}

#[test]
fn the_edge_of_a_card_moves_through_sharp_pixels_as_geometry_says() {
    let setup = Setup { model: "point", ..Setup::new([12, 3], 27.0) };
    // Pixels are 2 mm wide on the plane: the edge is in the middle of column 5.
    assert!((setup.on_plane() - 0.002).abs() < 1e-12);
    let found = derivative(&setup.capture(), &card(), "card.x", 0.005);
    let expected = -exposure_per_radiance(&setup) / setup.on_plane();
    for (pixel, value) in found.values.iter().enumerate() {
        let expected = if pixel % 12 == 5 { expected } else { 0.0 };
        let tolerance = 4.0 * found.standard_errors[pixel] + 1e-3 * expected.abs();
        assert!((value - expected).abs() <= tolerance, "pixel {pixel}: {value} instead of {expected}");
    }
    assert!(found.step_error < 0.01 && found.relative_error <= 0.005, "{found:?}");
}

#[test]
fn the_edge_of_a_card_is_blurred_by_the_pinhole() {
    let setup = Setup { distance_m: 0.5, ..Setup::new([12, 3], 27.0) };
    let found = derivative(&setup.capture(), &card(), "card.x", 0.005);
    // The pinhole's projection on the plane has radius R; a pixel at s sees the fraction of the
    // chord at its distance from the edge, averaged over the width of the pixel.
    let radius = 0.5e-4 * (1.0 + 0.5 / 6.75e-3);
    let chord = |distance: f64| 2.0 * (radius * radius - distance * distance).max(0.0).sqrt() / (PI * radius * radius);
    for (pixel, value) in found.values.iter().enumerate() {
        let centre = ((pixel % 12) as f64 - 5.5) * setup.on_plane();
        let within = (0..1000).map(|step| centre + ((f64::from(step) + 0.5) / 1000.0 - 0.5) * setup.on_plane());
        let mean = within.map(|point| chord(CARD_LEFT - point)).sum::<f64>() / 1000.0;
        let expected = -exposure_per_radiance(&setup) * mean;
        let tolerance = 4.0 * found.standard_errors[pixel] + 2e-3 * exposure_per_radiance(&setup) * chord(0.0);
        assert!((value - expected).abs() <= tolerance, "pixel {pixel}: {value} instead of {expected}");
    }
}

/// Almost no ray of a pixel meets a strip that is a fiftieth of its width.
#[test]
fn a_narrow_strip_takes_few_rays() {
    let (setup, width) = (Setup::new([12, 3], 27.0), 4e-5);
    let scene = format!(
        "void glow white 0 0 4 1 1 1 0 white polygon card_strip 0 0 12
         {0} -.1 0  {1} -.1 0  {1} .1 0  {0} .1 0
         void glow black 0 0 4 0 0 0 0
         black polygon card_left 0 0 12  -.1 -.1 0  {0} -.1 0  {0} .1 0  -.1 .1 0
         black polygon card_right 0 0 12  {1} -.1 0  .1 -.1 0  .1 .1 0  {1} .1 0",
        CARD_LEFT - 0.5 * width,
        CARD_LEFT + 0.5 * width
    );
    let found = derivative(&setup.capture(), &scene, "card_*.x", 0.005);
    assert!(found.relative_error <= 0.005 && found.rays < 3_000_000, "{found:?}");
    let radius = 0.5e-4 * (1.0 + 0.5 / 6.75e-3);
    let chord = |distance: f64| 2.0 * (radius * radius - distance * distance).max(0.0).sqrt() / (PI * radius * radius);
    let largest = exposure_per_radiance(&setup) * width * chord(0.0) / setup.on_plane();
    for (pixel, value) in found.values.iter().enumerate() {
        let [left, right] = [-6.0, -5.0].map(|side| ((pixel % 12) as f64 + side) * setup.on_plane());
        // The mean chord over the pixel changes by what enters and leaves at its sides.
        let change = (chord(CARD_LEFT - left) - chord(CARD_LEFT - right)) / setup.on_plane();
        let expected = exposure_per_radiance(&setup) * width * change;
        let tolerance = 4.0 * found.standard_errors[pixel] + 4e-3 * largest;
        assert!((value - expected).abs() <= tolerance, "pixel {pixel}: {value} instead of {expected}");
    }
}

#[test]
fn light_of_a_moved_disk_is_neither_lost_nor_gained() {
    let scene = "void glow white 0 0 4 1 1 1 0 white ring disk 0 0 8 .001 .002 0 0 0 1 0 .008";
    for model in ["finite", "point"] {
        let setup = Setup { model, ..Setup::new([16, 14], 27.0) };
        let found = derivatives(&setup.capture(), scene, &["disk.x", "disk.y", "disk.z"], 0.01);
        for by in &found.derivatives {
            let by = &by.derivative;
            let size: f64 = by.values.iter().map(|value| value.abs()).sum();
            let noise = by.standard_errors.iter().map(|error| error * error).sum::<f64>().sqrt();
            // Nearer, a disk is larger in the picture.
            if by.values == found.derivatives[2].derivative.values {
                let total = found.exposure.values.iter().sum::<f64>();
                let expected = total * 2.0 / 0.5;
                let sum = by.values.iter().sum::<f64>();
                assert!((sum - expected).abs() < 4.0 * noise + 0.02 * expected, "{model}: {sum} of {expected}");
            } else {
                let sum = by.values.iter().sum::<f64>();
                assert!(size > 0.0 && sum.abs() < 4.0 * noise + 2e-3 * size, "{model}: {sum} of {size}");
            }
        }
    }
}

/// A white plane under one LED that emits the same radiance to all sides, c away from the axis.
#[test]
fn light_of_one_led_falls_with_distance_as_the_inverse_square_law_says() {
    let ring = "[rig]\nleds = 1\nring_diameter_mm = 200\nled_diameter_mm = 1\nled_intensity_w_per_sr = 1\n\
                led_cone_deg = 180\n";
    let setup = Setup { pinhole_mm: 0.01, ring: ring.to_owned(), ..Setup::new([3, 3], 200.0) };
    let scene = "void plastic white 0 0 5 1 1 1 0 0 white ring sheet 0 0 8 0 0 0 0 0 1 0 2";
    let found = derivatives(&setup.capture(), scene, &["distance", "led.intensity", "led[0].intensity"], 0.002);
    let exposure = |pixel: usize, distance: f64| {
        let slope = [(pixel % 3) as f64 - 1.0, 1.0 - (pixel / 3) as f64].map(|at| at * 200e-6 / 6.75e-3);
        let offset2 = (slope[0] * distance - 0.1).powi(2) + (slope[1] * distance).powi(2);
        let irradiance = distance * distance / (distance * distance + offset2).powi(2);
        let cos4 = (1.0 + slope[0] * slope[0] + slope[1] * slope[1]).powi(-2);
        exposure_per_radiance(&setup) * cos4 * irradiance / PI
    };
    let [distance, all, first] = [0, 1, 2].map(|index| &found.derivatives[index].derivative);
    for pixel in 0..9 {
        let expected = (exposure(pixel, 0.5005) - exposure(pixel, 0.4995)) / 0.001;
        let value = distance.values[pixel];
        assert!((value / expected - 1.0).abs() < 0.01, "pixel {pixel}: {value} instead of {expected}");
        for by in [all, first] {
            let value = by.values[pixel];
            assert!((value / exposure(pixel, 0.5) - 1.0).abs() < 0.01, "pixel {pixel}: {value}");
        }
    }
}

/// A box on a sheet in the light of a ring, with shadows.
const BOX: &str =
    "void plastic white 0 0 5 .8 .8 .8 0 0  white polygon sheet 0 0 12 -.2 -.2 0 .2 -.2 0 .2 .2 0 -.2 .2 0
    void plastic grey 0 0 5 .2 .2 .2 0 0  grey ring part_top 0 0 8 .004 .002 .012 0 0 1 0 .01
    grey cylinder part_side 0 0 7 .004 .002 0 .004 .002 .012 .01";

/// The same exposure by plain sampling, with a parameter changed by twice its step.
fn converged(capture: &Capture, scene: &str, seed: u64) -> Vec<f64> {
    let capture = capture.clone().samples(1024).seed(seed);
    let scene = capture.with_ring(Scene::builder().text("scene.rad", scene)).build().unwrap();
    capture.expose(&scene).unwrap().exposure_j_per_m2
}

#[test]
fn derivatives_are_central_differences_of_converged_pictures() {
    let setup = Setup { ring: RING.to_owned(), ..Setup::new([12, 10], 60.0) };
    let moved = |x: f64| BOX.replace(" .004 .002", &format!(" {} .002", 0.004 + x));
    let with = |key: &str, value: f64| {
        let ring = RING.replace("ring_diameter_mm = 30", &format!("ring_diameter_mm = {}", 30.0 + value));
        match key {
            "ring" => Setup { ring, ..Setup::new([12, 10], 60.0) }.capture(),
            "pinhole" => {
                Setup { pinhole_mm: 0.1 + value, ring: RING.to_owned(), ..Setup::new([12, 10], 60.0) }.capture()
            }
            _ => Setup { distance_m: 0.5 + value, ring: RING.to_owned(), ..Setup::new([12, 10], 60.0) }.capture(),
        }
    };
    let same = BOX.to_owned();
    type Sides = [(Capture, String); 2];
    let cases: [(&str, [f64; 2], Sides); 4] = [
        ("part_*.x", [1e-3, 0.01], [-1e-3, 1e-3].map(|x| (setup.capture(), moved(x)))),
        ("distance", [2e-3, 0.01], [-2e-3, 2e-3].map(|by| (with("distance", by), same.clone()))),
        ("pinhole.diameter", [4e-6, 0.01], [-4e-3, 4e-3].map(|by| (with("pinhole", by), same.clone()))),
        ("ring.diameter", [1e-3, 0.1], [-1.0, 1.0].map(|by| (with("ring", by), same.clone()))),
    ];
    for (name, [step, requested], sides) in cases {
        let found = derivative(&setup.capture(), BOX, name, requested);
        let truths: Vec<Vec<f64>> = (1..5)
            .map(|seed| {
                let [below, above] = sides.clone().map(|(capture, scene)| converged(&capture, &scene, seed));
                above.iter().zip(&below).map(|(above, below)| (above - below) / (2.0 * step)).collect()
            })
            .collect();
        let truth: Vec<f64> = (0..120).map(|at| truths.iter().map(|truth| truth[at]).sum::<f64>() / 4.0).collect();
        let noise = rms(truths.iter().flat_map(|one| one.iter().zip(&truth).map(|(a, b)| a - b))) / 3f64.sqrt();
        let size = rms(truth.iter().copied());
        let difference = rms(found.values.iter().zip(&truth).map(|(value, truth)| value - truth));
        println!("{name}: difference {:.4}, noise of the truth {:.4}", difference / size, noise / size);
        // The light of this ring hardly changes with its diameter: the error ends at the largest
        // number of rays.
        let is_reached = found.relative_error <= 1.05 * requested;
        assert!(is_reached || name == "ring.diameter", "{name}: {}", found.relative_error);
        let allowed = (found.relative_error.max(requested) * size).hypot(noise).hypot(found.step_error * size);
        assert!(difference < 1.4 * allowed + 0.01 * size, "{name}: {difference} of {size}, noise {noise}");
    }
}

#[test]
fn standard_errors_are_those_of_many_seeds() {
    let setup = Setup { ring: RING.to_owned(), ..Setup::new([12, 10], 60.0) };
    for name in ["part_*.x", "focal.distance"] {
        let runs: Vec<Derivative> =
            (0..20).map(|seed| derivative(&setup.capture().seed(seed), BOX, name, 0.08)).collect();
        let mean: Vec<f64> = (0..120).map(|at| runs.iter().map(|run| run.values[at]).sum::<f64>() / 20.0).collect();
        let deviations = rms(runs.iter().flat_map(|run| run.values.iter().zip(&mean).map(|(a, b)| a - b)));
        let stated = rms(runs.iter().flat_map(|run| run.standard_errors.iter().copied()));
        let ratio = deviations * (20.0_f64 / 19.0).sqrt() / stated;
        println!("{name}: {ratio}");
        assert!((0.8..1.2).contains(&ratio), "{name}: {ratio}");
    }
}

/// A mirror that shows a bright card above the camera, whose edge is the line x = .03.
const MIRROR: &str = "void mirror silver 0 0 3 1 1 1  silver ring mirror 0 0 8 0 0 0 0 0 1 0 .1
    void glow white 0 0 4 1 1 1 0  white polygon card 0 0 12 .03 -.5 .6  .03 .5 .6  .9 .5 .6  .9 -.5 .6";

#[test]
fn a_turned_mirror_turns_what_it_shows_by_twice_its_angle() {
    let setup = Setup::new([16, 3], 60.0);
    let found = derivative(&setup.capture(), MIRROR, "mirror.ry", 0.01);
    // The ray to the point x of the mirror ends at x·(1 + .6/.5) + 2·.6·θ on the card's plane.
    let edge_per_degree = 2.0 * 0.6 / (1.0 + 0.6 / 0.5) * 1f64.to_radians();
    let expected = exposure_per_radiance(&setup) * edge_per_degree / setup.on_plane();
    let in_row = found.values.iter().sum::<f64>().abs() / 3.0;
    assert!((in_row / expected - 1.0).abs() < 0.015, "{in_row:e} instead of {expected:e}");
}

#[test]
fn the_step_of_an_angle_does_not_matter() {
    let setup = Setup { ring: RING.to_owned(), ..Setup::new([12, 10], 60.0) };
    let found = derivative(&setup.capture(), BOX, "part_*.ry", 0.03);
    println!("error {}, by the step {}", found.relative_error, found.step_error);
    assert!(found.relative_error <= 0.032 && found.step_error < 0.01, "{}", found.step_error);
}

/// A ring of mirror whose walls are seen by one ray in thirty. Without a term of its own for rays that
/// show the ring, 245,000 rays are needed.
const RAISED_RING: &str = "void plastic sheet_paint 0 0 5 .5 .5 .5 0 0
    sheet_paint polygon sheet 0 0 12 -.2 -.2 0 .2 -.2 0 .2 .2 0 -.2 .2 0
    void mirror steel 0 0 3 .8 .8 .8  steel ring part_top 0 0 8 .03 .012 .005 0 0 1 .0065 .0125
    steel cylinder part_outside 0 0 7 .03 .012 .003 .03 .012 .005 .0125
    steel tube part_inside 0 0 7 .03 .012 .003 .03 .012 .005 .0065";

#[test]
fn rays_that_show_no_part_are_few() {
    let setup = Setup { ring: RING.to_owned(), ..Setup::new([24, 20], 30.0) };
    let found = derivative(&setup.capture(), RAISED_RING, "part_*.x", 0.02);
    println!("{} rays, {} pixels with outlines", found.rays, found.outline_pixels);
    assert!(found.relative_error <= 0.021, "{}", found.relative_error);
    assert!(found.rays < 190_000, "{} rays", found.rays);
}

/// The best linear estimate of the card's position from noisy pictures reaches the bound.
#[test]
fn the_picture_bounds_the_precision_of_a_position() {
    let setup = Setup { ring: SENSOR.to_owned(), ..Setup::new([12, 3], 27.0) };
    let capture = setup.capture().error(1e-3);
    let exposed = derivatives(&capture, &card(), &["card.x", "pinhole.diameter"], 0.005);
    let sensor = capture.camera_file().sensor.as_ref().unwrap();
    let information = FisherInformation::new(&exposed, Some(sensor)).unwrap();
    let bound = information.deviations_alone[0];
    let together = information.deviations_together.as_ref().unwrap();
    assert!(together[0] >= bound && together[1] >= information.deviations_alone[1]);
    let grey: Vec<_> = exposed.exposure.values.iter().map(|value| sensor.grey_statistics(*value)).collect();
    let by_x = &exposed.derivatives[0].derivative.values;
    let weights: Vec<f64> =
        grey.iter().zip(by_x).map(|(grey, by_x)| grey.slope * by_x / grey.variance * bound * bound).collect();
    let estimates = (0..2000).map(|seed| {
        let picture = sensor.greys(&exposed.exposure.values, seed);
        let off = picture.iter().zip(&grey).map(|(value, grey)| f64::from(*value) - grey.mean);
        off.zip(&weights).map(|(off, weight)| off * weight).sum::<f64>()
    });
    let deviation = rms(estimates);
    // The deviation of 2000 estimates is known to 1.6 %.
    assert!((deviation / bound - 1.0).abs() < 0.06, "{deviation} m, bound {bound} m");
    assert!(information.to_json().contains("\"card.x\""));
}

/// The mean grey value grows with time by the light and by the dark current.
#[test]
fn the_dark_current_tells_the_exposure_time() {
    let capture = Setup { ring: format!("{SENSOR}dark_current_e_per_s = 1e5\n"), ..Setup::new([6, 4], 27.0) }
        .capture()
        .error(1e-3);
    let exposed = derivatives(&capture, &card(), &["exposure.time"], 0.005);
    let sensor = capture.camera_file().sensor.as_ref().unwrap();
    // The gain is 0.5.
    let by_dark = 0.5 * 1e5;
    let of_pixel = |(exposure, by_time): (&f64, &f64)| {
        let grey = sensor.grey_statistics(*exposure);
        (grey.slope * by_time + if grey.slope > 0.0 { by_dark } else { 0.0 }).powi(2) / grey.variance
    };
    let values = exposed.exposure.values.iter().zip(&exposed.derivatives[0].derivative.values);
    let expected = values.map(of_pixel).sum::<f64>().sqrt().recip();
    let found = FisherInformation::new(&exposed, Some(sensor)).unwrap().deviations_alone[0];
    assert!((found / expected - 1.0).abs() < 1e-3, "{found} s, expected {expected} s");
}

#[test]
fn parameters_that_a_capture_does_not_have_are_errors() {
    let scene = || Scene::builder().text("scene.rad", BOX);
    let setup = Setup::new([2, 2], 60.0);
    let message = |name: &str, capture: &Capture| {
        let parameters = [name.parse::<Parameter>().unwrap()];
        CaptureDerivatives::new(scene()).expose(capture, &parameters, 0.1).unwrap_err().to_string()
    };
    let ringed = Setup { ring: RING.to_owned(), ..Setup::new([2, 2], 60.0) }.capture();
    assert!(message("led.intensity", &setup.capture()).contains("has no [rig]"));
    assert!(message("led[6].intensity", &ringed).contains("the ring has 6 LEDs"));
    assert!(message("prat_*.x", &ringed).contains("the scene has no surface \"prat_*\""));
    let parameters = ["distance".parse::<Parameter>().unwrap()];
    let wrong = CaptureDerivatives::new(scene()).expose(&ringed, &parameters, 0.0);
    assert!(matches!(wrong, Err(Error::Option { option: "derivative error", .. })));
    let none = CaptureDerivatives::new(scene()).expose(&ringed, &[], 0.1);
    assert!(matches!(none, Err(Error::Option { option: "number of parameters", .. })));
    let twice = [parameters[0].clone(), parameters[0].clone()];
    let twice = CaptureDerivatives::new(scene()).expose(&ringed, &twice, 0.1).unwrap_err().to_string();
    assert!(twice.contains("distance") && twice.contains("it is given twice"), "{twice}");
    let exposed = derivatives(&ringed, BOX, &["distance"], 0.5);
    assert!(matches!(FisherInformation::new(&exposed, None), Err(Error::NoSensor)));
}

#[test]
fn the_rotation_of_a_sphere_about_its_middle_is_zero_after_the_first_rays() {
    let scene = "void light lamp 0 0 3 100 100 100 lamp sphere bulb 0 0 4 .1 .05 .3 .01
        void metal steel 0 0 5 .5 .5 .5 .9 .05 steel sphere ball 0 0 4 0 0 .01 .01
        void plastic stone 0 0 5 .5 .5 .5 0 0 stone ring floor 0 0 8 0 0 0 0 0 1 0 .1";
    let capture = Setup::new([12, 10], 200.0).capture();
    for name in ["ball.rx", "ball.rz"] {
        let found = derivative(&capture, scene, name, 0.05);
        assert!(found.values.iter().chain(&found.standard_errors).all(|value| *value == 0.0), "{name}");
        assert!(found.relative_error == 0.0 && found.rays < 200_000, "{name}: {} rays", found.rays);
    }
    // A shift of the same ball is none of that.
    assert!(derivative(&capture, scene, "ball.x", 0.1).values.iter().any(|value| *value != 0.0));
}
