//! Every model passes the checks of plugins: finite values down to grazing incidence, isotropy,
//! reciprocity and energy conservation where the model declares them, and chi² of the sampling in
//! cells of log-angle about the retro and the mirror direction.

use glam::DVec3;
use radsight_brdf::check::{self, CheckOptions};
use radsight_brdf::{Brdf, check::Finding};
use radsight_retro::{Geometry, MODELS, RetroTable, Row, Sheeting, model, model_info};

fn sheet(name: &str, words: &[&str], numbers: &[f64]) -> Sheeting {
    let words: Vec<String> = words.iter().map(|word| (*word).to_owned()).collect();
    model(name, &words, numbers).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn options(name: &str) -> CheckOptions {
    let isotropic = !matches!(name, "cube_corner" | "table");
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

/// For measured models only the sampling is checked.
#[test]
fn measured_models_are_sampled_with_their_density() {
    let series_983 =
        [0.2, 4.0, 800.0, 0.2, 30.0, 550.0, 0.2, 45.0, 345.0, 0.5, 4.0, 460.0, 0.5, 30.0, 215.0, 0.5, 45.0, 85.0];
    let table: Vec<f64> = [0.0, 1.0, 0.1].into_iter().chain(series_983).collect();
    let coated: Vec<f64> = [0.2, 1.5, 0.1].into_iter().chain(series_983).collect();
    // Brighter by half along the datum mark than across it.
    let turned: Vec<f64> = [0.0, 1.0, 0.1]
        .into_iter()
        .chain(
            series_983
                .chunks(3)
                .flat_map(|row| {
                    [0.0, 90.0]
                        .map(|rotation| [row[0], row[1], rotation, row[2] * if rotation == 0.0 { 1.2 } else { 0.8 }])
                })
                .flatten(),
        )
        .collect();
    let cases: [(&str, &[&str], &[f64]); 6] = [
        ("glass_bead", &["sheet"], &[8.0]),
        ("glass_bead", &["paint"], &[1.0, 0.2]),
        ("table", &[], &table),
        ("table", &[], &coated),
        ("table", &["three_angles"], &turned),
        ("paper1991", &[], &[0.086, 0.00612]),
    ];
    for (name, words, numbers) in cases {
        let sheet = sheet(name, words, numbers);
        let mut findings: Vec<Finding> = check::finite(&sheet, &options(name));
        findings.extend(check::sampling(&sheet, &options(name)));
        if !words.contains(&"three_angles") {
            findings.extend(check::isotropy(&sheet, &options("paper1991")));
        }
        assert!(findings.is_empty(), "{name} {words:?} {numbers:?}: {findings:#?}");
    }
}

/// A model of each kind, and its coefficients at the angles of a data sheet.
fn of_each_kind() -> Vec<(&'static str, Sheeting)> {
    let row = [0.2, -4.0, 800.0, 0.5, -4.0, 460.0];
    let table: Vec<f64> = [0.0, 1.0, 0.1].into_iter().chain(row).collect();
    let kinds: Vec<(&str, Sheeting)> = vec![
        ("paper1991", sheet("paper1991", &[], &[0.086, 0.00612])),
        ("gauss_reciprocal", sheet("gauss_reciprocal", &[], &[0.086, 0.00612])),
        ("sharp", sheet("sharp", &[], &[0.086, 0.0102, 2.0])),
        ("mrm", sheet("mrm", &[], &[0.04, 0.02, 0.6])),
        ("glass_bead", sheet("glass_bead", &["sheet"], &[8.0])),
        ("cube_corner", sheet("cube_corner", &["air"], &[1.586, 0.0005, 0.01])),
        ("table", sheet("table", &[], &table)),
    ];
    assert_eq!(kinds.iter().map(|kind| kind.0).collect::<Vec<_>>(), MODELS.map(|model| model.name));
    kinds
}

/// Terms shared by a batch do not change the values of its directions.
#[test]
fn a_batch_equals_single_evaluations() {
    for (name, sheet) in of_each_kind() {
        let outgoing = Geometry::from_degrees(0.0, 20.0, 35.0).directions().0;
        let near = [(0.1, 35.0), (0.7, 30.0), (3.0, 0.0), (60.0, 90.0)];
        let incident = near.map(|(angle, turn)| Geometry::from_degrees(0.0, 20.0 + angle, turn).directions().0);
        let (mut values, mut pdfs) = ([0.0; 4], [0.0; 4]);
        sheet.eval_pdf(outgoing, &incident, &mut values, &mut pdfs);
        for (index, direction) in incident.into_iter().enumerate() {
            assert_eq!((values[index], pdfs[index]), sheet.value_and_pdf(outgoing, direction), "{name} {direction}");
        }
        assert!(values[0] > 0.0, "{name}");
    }
}

/// The BRDF of a table of a model's coefficients returns these coefficients.
#[test]
fn the_coefficients_of_each_model_survive_a_round_trip() {
    for (name, sheet) in of_each_kind() {
        let coefficient = |sheet: &Sheeting, at: Geometry| {
            let (observer, light) = at.directions();
            at.coefficient(sheet.value_and_pdf(observer, light).0)
        };
        let mut rows = Vec::new();
        for observation in [0.1, 0.2, 0.33, 0.5, 1.0, 1.5] {
            for entrance in [-4.0, 5.0, 20.0, 30.0, 40.0] {
                for rotation in [0.0, 45.0, 90.0] {
                    let geometry = Geometry::from_degrees(observation, entrance, rotation);
                    rows.push(Row { geometry, coefficient: coefficient(&sheet, geometry) });
                }
            }
        }
        assert!(rows.iter().all(|row| row.coefficient > 0.0), "{name}: {rows:?}");
        let table = RetroTable::new(&rows).unwrap();
        let words = ["three_angles".to_owned()];
        let numbers = rows.iter().flat_map(|Row { geometry, coefficient }| {
            let angles = [geometry.observation, geometry.entrance, geometry.rotation].map(f64::to_degrees);
            [angles[0], angles[1], angles[2], *coefficient]
        });
        let numbers: Vec<f64> = [0.0, 1.0, 0.1].into_iter().chain(numbers).collect();
        let by_scene = model("table", &words, &numbers).unwrap();
        for Row { geometry, coefficient: expected } in &rows {
            let (observer, light) = geometry.directions();
            let brdf = table.value(observer, light);
            assert!((geometry.brdf(*expected) / brdf - 1.0).abs() < 1e-6, "{name} {geometry:?}");
            let back = coefficient(&by_scene, *geometry);
            assert!((back / expected - 1.0).abs() < 1e-6, "{name} {geometry:?}: {back} for {expected}");
        }
    }
}

/// A white furnace: perfectly reflecting microfacets lose only the light reflected below the
/// horizon.
#[test]
fn smooth_white_microfacets_conserve_energy() {
    let sheet = sheet("mrm", &[], &[1.0, 0.001, 1.0]);
    for degrees in [0.0f64, 30.0, 60.0] {
        let outgoing = DVec3::new(degrees.to_radians().sin(), 0.0, degrees.to_radians().cos());
        let albedo = check::albedo(&sheet, outgoing, &options("mrm")).total(0);
        assert!((albedo - 1.0).abs() < 5e-3, "{degrees}°: {albedo}");
    }
}

#[test]
fn sharp_returns_rho_at_normal_incidence() {
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
