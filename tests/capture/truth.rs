//! Compares captures of the paper's figures with `gripps/truth`: exposures from an independent
//! brute-force integration over pixel × pinhole disk × LED disk.
//!
//! The tolerances are for the few samples of a test, 1.5 times the measured values; the error falls
//! with more samples.

use crate::pictures::{Difference, exposure_file, greys, paper_grey, show};
use crate::program::{Folder, gripps, radsight, root};
use radsight_picture::Image;

/// The inputs of a figure, and its tolerances.
struct Figure {
    number: u32,
    scenes: &'static [&'static str],
    samples: &'static str,
    /// Tolerance of rms(E − T) / mean(T).
    rms: f64,
    /// The same without the worst thousandth of the pixels.
    rms_of_most: f64,
    /// Tolerance of |mean(E) / mean(T) − 1|.
    mean: f64,
}

const RETRO: &[&str] = &["sheet-retro.rad"];
const WASHER: &[&str] = &["sheet-retro.rad", "washer.rad"];

#[test]
fn figure_8_lambertian_sheet_point_pinhole_cone() {
    let scenes = &["sheet-lambertian.rad"];
    check(&Figure { number: 8, scenes, samples: "16", rms: 0.0018, rms_of_most: 0.0017, mean: 0.0001 });
}

#[test]
fn figure_9_retroreflector_point_pinhole_cone() {
    check(&Figure { number: 9, scenes: RETRO, samples: "64", rms: 0.008, rms_of_most: 0.0075, mean: 0.0005 });
}

#[test]
fn figure_10_retroreflector_finite_pinhole_cone() {
    check(&Figure { number: 10, scenes: RETRO, samples: "64", rms: 0.016, rms_of_most: 0.015, mean: 0.0005 });
}

#[test]
fn figure_11_retroreflector_finite_pinhole_table() {
    check(&Figure { number: 11, scenes: RETRO, samples: "32", rms: 0.007, rms_of_most: 0.007, mean: 0.0005 });
}

#[test]
fn figure_13_washer_point_pinhole_table() {
    check(&Figure { number: 13, scenes: WASHER, samples: "32", rms: 0.037, rms_of_most: 0.012, mean: 0.002 });
}

#[test]
fn figure_14_washer_finite_pinhole_table() {
    check(&Figure { number: 14, scenes: WASHER, samples: "64", rms: 0.029, rms_of_most: 0.015, mean: 0.002 });
}

#[test]
fn an_asked_error_is_the_true_error() {
    let captured = capture(11, RETRO, &["--error", "0.01"]);
    let difference = Difference::new(&captured.exposure, &captured.truth);
    assert!(difference.rms < 0.013, "asked for 1 %, got {difference:?}");
    // A far too large error estimate would waste the user's time. The first samples have 0.16 %.
    assert!(difference.rms > 0.0005, "asked for 1 %, got {difference:?}");
}

/// The edges of the lamps' cones are all over these pictures.
#[test]
fn an_asked_error_is_the_true_error_where_lamps_are_integrated() {
    for (number, scenes) in [(8, &["sheet-lambertian.rad"] as &[&str]), (9, RETRO)] {
        for (asked, text) in [(0.005, "0.005"), (0.02, "0.02")] {
            let captured = capture(number, scenes, &["--error", text]);
            let difference = Difference::new(&captured.exposure, &captured.truth);
            assert!(difference.rms < asked, "figure {number}: asked for {asked}, got {difference:?}");
            assert!(difference.rms > 0.2 * asked, "figure {number}: asked for {asked}, got {difference:?}");
            assert!(difference.mean.abs() < 0.2 * asked, "figure {number}: asked for {asked}, got {difference:?}");
        }
    }
}

/// Behind a finite pinhole pixels share rays.
#[test]
fn an_asked_error_is_the_true_error_where_pixels_share_rays() {
    for (number, scenes) in [(10, RETRO), (11, RETRO), (14, WASHER)] {
        for (asked, text) in [(0.003, "0.003"), (0.02, "0.02")] {
            let captured = capture(number, scenes, &["--error", text]);
            let difference = Difference::new(&captured.exposure, &captured.truth);
            assert!(difference.rms < asked, "figure {number}: asked for {asked}, got {difference:?}");
            assert!(difference.mean.abs() < 0.2 * asked, "figure {number}: asked for {asked}, got {difference:?}");
        }
    }
}

/// A spot half a pixel wide lies between the points of any lattice but those of the finest, and a
/// smooth sheet around it.
#[test]
fn a_small_spot_on_a_smooth_sheet_is_not_interpolated_away() {
    let folder = Folder::new();
    let spot = folder.file(
        "spot.rad",
        "void plastic white 0 0 5 .9 .9 .9 0 0\nwhite ring spot 0 0 8 .0213 .0104 .0001 0 0 1 0 .0012\n",
    );
    let (camera, sheet) = (gripps("fig11.toml"), gripps("sheet-retro.rad"));
    let captured = |effort: [&str; 2], name: &str| {
        let out = folder.word(name);
        radsight(&["capture", &camera, &sheet, &spot, effort[0], effort[1], "--exposure", &out]).done();
        exposure_file(&folder.path(name))
    };
    let [sparse, every] = [captured(["--error", ".01"], "a.pfm"), captured(["--samples", "16"], "b.pfm")];
    let difference = Difference::new(&sparse, &every);
    assert!(difference.rms < 0.02, "{difference:?}");
    // Around the spot, whose middle is at column 117 and row 73.
    let near = || (66..81).flat_map(|row| (110..125).map(move |column| row * 192 + column));
    let sum = |picture: &Image<f32>| near().map(|pixel| f64::from(picture.data()[pixel])).sum::<f64>();
    assert!((sum(&sparse) / sum(&every) - 1.0).abs() < 0.01, "{} for {}", sum(&sparse), sum(&every));
}

/// The lattice lies elsewhere with each seed, so that what interpolation errs falls in the mean as
/// noise does.
#[test]
fn the_mean_over_seeds_of_an_interpolated_picture_is_the_truth() {
    const SEEDS: usize = 6;
    let captures: Vec<Image<f32>> =
        (0..SEEDS).map(|seed| capture(11, RETRO, &["--error", "0.02", "--seed", &seed.to_string()]).exposure).collect();
    let truth = exposure_file(&root().join("tests/gripps/truth/t11.pfm"));
    let mean: Vec<f32> = (0..truth.data().len())
        .map(|pixel| captures.iter().map(|picture| picture.data()[pixel]).sum::<f32>() / SEEDS as f32)
        .collect();
    let mean = Image::new(truth.width(), truth.height(), 1, mean).expect("a picture");
    let alone = captures.iter().map(|picture| Difference::new(picture, &truth).rms.powi(2)).sum::<f64>();
    let (alone, together) = ((alone / SEEDS as f64).sqrt(), Difference::new(&mean, &truth));
    assert!(alone < 0.022, "{alone}");
    assert!(together.rms < 1.3 * alone / (SEEDS as f64).sqrt() + 0.001, "{together:?}, one by one {alone}");
    assert!(together.mean.abs() < 0.002, "{together:?}");
}

struct Captured {
    exposure: Image<f32>,
    greys: Image<u16>,
    truth: Image<f32>,
}

fn capture(number: u32, scenes: &[&str], effort: &[&str]) -> Captured {
    let folder = Folder::new();
    let camera = gripps(&format!("fig{number:02}.toml"));
    let scenes: Vec<String> = scenes.iter().map(|name| gripps(name)).collect();
    let (matrix, picture) = (folder.word("x.pfm"), folder.word("x.png"));
    let mut words = vec!["capture", &camera];
    words.extend(scenes.iter().map(String::as_str));
    words.extend(effort);
    words.extend(["--exposure", &matrix, "-o", &picture]);
    radsight(&words).done();
    Captured {
        exposure: exposure_file(&folder.path("x.pfm")),
        greys: greys(&folder.read("x.png")),
        truth: exposure_file(&root().join(format!("tests/gripps/truth/t{number}.pfm"))),
    }
}

fn check(figure: &Figure) {
    let captured = capture(figure.number, figure.scenes, &["--samples", figure.samples]);
    let difference = Difference::new(&captured.exposure, &captured.truth);
    let pairs = captured.greys.data().iter().zip(captured.truth.data());
    let near = pairs.filter(|(grey, truth)| grey.abs_diff(paper_grey(**truth)) <= 1).count();
    let near = near as f64 / captured.truth.data().len() as f64;
    println!("figure {}: {difference:?}, {:.3} % of the greys within 1", figure.number, 100.0 * near);
    let good = difference.rms <= figure.rms
        && difference.rms_of_most <= figure.rms_of_most
        && difference.mean.abs() <= figure.mean
        && near >= 0.995;
    if !good {
        let shown = show(&format!("figure-{}", figure.number), &captured.exposure, &captured.truth);
        panic!("figure {}: {difference:?}, {near} of the greys within 1; see {}", figure.number, shown.display());
    }
}
