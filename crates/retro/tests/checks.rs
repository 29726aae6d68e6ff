//! Every model passes the checks that plugins pass: finite values down to grazing, isotropy, reciprocity and energy where they
//! are claimed, chi² of the sampling in cells of log-angle about the retro and the mirror direction.

use glam::DVec3;
use radsight_brdf::check::{self, CheckOptions};
use radsight_brdf::{Brdf, check::Finding};
use radsight_retro::{Sheeting, model, model_info};

fn sheet(name: &str, words: &[&str], numbers: &[f64]) -> Sheeting {
    let words: Vec<String> = words.iter().map(|word| (*word).to_owned()).collect();
    model(name, &words, numbers).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn options(name: &str) -> CheckOptions {
    let isotropic = name != "cube_corner";
    CheckOptions { reciprocal: model_info(name).expect("a known model").reciprocal, isotropic, ..Default::default() }
}

fn assert_sound(name: &str, words: &[&str], numbers: &[f64]) {
    let findings = check::all(&sheet(name, words, numbers), &options(name));
    assert!(findings.is_empty(), "{name} {words:?} {numbers:?}: {findings:#?}");
}

#[test]
fn the_reciprocal_gaussian_is_sound_alone_and_under_a_film() {
    assert_sound("gauss_reciprocal", &[], &[0.086, 0.00612]);
    assert_sound("gauss_reciprocal", &[], &[0.6, 0.0003]);
    assert_sound("gauss_reciprocal", &[], &[0.4, 0.05, 0.3, 1.5, 0.05]);
}

#[test]
fn sharp_lobes_are_sound() {
    assert_sound("sharp", &[], &[0.086, 0.0102, 6.0]);
    assert_sound("sharp", &[], &[1.0, 0.002, 64.0]);
    assert_sound("sharp", &[], &[0.5, 0.1, 1.0, 0.2, 1.5, 0.2]);
}

#[test]
fn retroreflective_microfacets_are_sound() {
    assert_sound("mrm", &[], &[1.0, 0.01, 1.0]);
    assert_sound("mrm", &[], &[0.04, 0.3, 0.6]);
    assert_sound("mrm", &[], &[0.4, 0.1, 0.5, 0.3, 1.4, 0.1]);
}

#[test]
fn cube_corners_are_sound() {
    assert_sound("cube_corner", &["air"], &[1.586, 0.0005, 0.002]);
    assert_sound("cube_corner", &["metal"], &[1.49, 0.0, 0.01, 0.85]);
    assert_sound("cube_corner", &["air"], &[1.5, -0.001, 0.003, 0.85, 0.1, 1.3, 0.1]);
}

/// Of what is taken as it was measured only the sampling is ours.
#[test]
fn measured_models_are_drawn_from_as_they_say() {
    let series_983 =
        [0.2, 4.0, 800.0, 0.2, 30.0, 550.0, 0.2, 45.0, 345.0, 0.5, 4.0, 460.0, 0.5, 30.0, 215.0, 0.5, 45.0, 85.0];
    let table: Vec<f64> = [0.0, 1.0, 0.1].into_iter().chain(series_983).collect();
    let coated: Vec<f64> = [0.2, 1.5, 0.1].into_iter().chain(series_983).collect();
    let cases: [(&str, &[&str], &[f64]); 5] = [
        ("glass_bead", &["sheet"], &[8.0]),
        ("glass_bead", &["paint"], &[1.0, 0.2]),
        ("table", &[], &table),
        ("table", &[], &coated),
        ("paper1991", &[], &[0.086, 0.00612]),
    ];
    for (name, words, numbers) in cases {
        let sheet = sheet(name, words, numbers);
        let mut findings: Vec<Finding> = check::finite(&sheet, &options(name));
        findings.extend(check::sampling(&sheet, &options(name)));
        findings.extend(check::isotropy(&sheet, &options(name)));
        assert!(findings.is_empty(), "{name} {words:?} {numbers:?}: {findings:#?}");
    }
}

/// A white furnace: microfacets that reflect everything lose only what leaves them below the horizon.
#[test]
fn smooth_white_microfacets_return_everything() {
    let sheet = sheet("mrm", &[], &[1.0, 0.001, 1.0]);
    for degrees in [0.0f64, 30.0, 60.0] {
        let outgoing = DVec3::new(degrees.to_radians().sin(), 0.0, degrees.to_radians().cos());
        let albedo = check::albedo(&sheet, outgoing, &options("mrm")).total(0);
        assert!((albedo - 1.0).abs() < 5e-3, "{degrees}°: {albedo}");
    }
}

#[test]
fn sharp_sends_back_its_share_at_normal_incidence() {
    for order in [1.0, 2.0, 6.0, 64.0] {
        let sheet = sheet("sharp", &[], &[0.7, 0.01, order]);
        let albedo = check::albedo(&sheet, DVec3::Z, &options("sharp")).total(0);
        assert!((albedo / 0.7 - 1.0).abs() < 2e-3, "order {order}: {albedo}");
    }
}

#[test]
fn every_band_has_the_same_value() {
    let sheet = sheet("sharp", &[], &[0.7, 0.01, 4.0]);
    let (mut values, mut pdfs) = ([0.0; 6], [0.0; 2]);
    let outgoing = DVec3::Z;
    sheet.eval_pdf(outgoing, &[DVec3::Z, DVec3::new(0.6, 0.0, 0.8)], &mut values, &mut pdfs);
    assert!(values[0] > 1000.0 && values[0] == values[1] && values[1] == values[2]);
    assert_eq!(values[3..], [0.0; 3]);
}
