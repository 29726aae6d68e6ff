//! Glints of small lights in pictures of `rpict` without `--error` or `--samples`, whose exact amount of light is known.
//!
//! Seen from far away, a mirror ball of radius R shows a distant light of radiance L and solid angle Ω on an area of
//! R²Ω/4: the reflected direction turns twice as fast as the normal, and a normal at an angle θ covers an area of R² cos θ
//! for each solid angle, while the reflected direction covers 4 cos θ for each solid angle of the half vector.

use super::interpolated_pictures::red_of;
use std::f64::consts::{FRAC_PI_4, PI};
use std::fmt::Write as _;

const SIDE: usize = 48;
const SEEDS: u32 = 8;

/// Width of the view, scene units.
const WIDTH: f64 = 2.4;
const VIEW: &str = "-vtl -vp 0 -5 0 -vd 0 1 0 -vh 2.4 -vv 2.4 -x 48 -y 48 -ff";

const RADIANCE: f64 = 1e6;
const DIAMETER_DEG: f64 = 0.53;

fn solid_angle() -> f64 {
    2.0 * PI * (1.0 - (0.5 * DIAMETER_DEG.to_radians()).cos())
}

/// A sun that mirrors reflect to the viewer where their normal is at 30° from the view.
fn sun() -> String {
    let aside = (PI / 3.0).sin();
    format!(
        "void light bright 0 0 3 {RADIANCE} {RADIANCE} {RADIANCE}
         bright source sun 0 0 4 {} {} {} {DIAMETER_DEG}
         void metal chrome 0 0 5 1 1 1 1 0\n",
        0.6 * aside,
        -(PI / 3.0).cos(),
        0.8 * aside,
    )
}

/// The light of the pictures of some seeds, times the area that it covers, square scene units.
fn light(scene: &str, options: &str) -> Vec<f64> {
    let area = (WIDTH / SIDE as f64).powi(2);
    let picture = |seed: u32| red_of(SIDE, scene, &format!("{VIEW} {options} --seed {seed}"));
    (1..=SEEDS).map(|seed| area * picture(seed).iter().sum::<f64>()).collect()
}

#[track_caller]
fn assert_are(values: &[f64], expected: f64) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    assert!((mean / expected - 1.0).abs() < 0.05, "{mean} instead of {expected}: {values:?}");
    assert!(values.iter().all(|value| (value / expected - 1.0).abs() < 0.25), "{expected}: {values:?}");
}

#[test]
fn a_glint_far_smaller_than_a_pixel_has_its_light() {
    let radius = 1.0;
    let scene = sun() + &format!("chrome sphere ball 0 0 4 0 0 0 {radius}\n");
    let expected = RADIANCE * solid_angle() * radius * radius / 4.0;
    for options in ["", "-ps 1", "-ps 8 -pt .2"] {
        assert_are(&light(&scene, options), expected);
    }
}

#[test]
fn a_glint_of_turned_normals_has_its_light() {
    // A flat mirror with the normals of a paraboloid of this curvature: one at an angle θ covers an area of 1 / (k² cos³ θ).
    let curvature = 1.0;
    let scene = sun()
        + &format!(
            "void texfunc bowl 4 {curvature}*Px 0 {curvature}*Pz . 0 0
             bowl metal mirror 0 0 5 1 1 1 1 0
             mirror polygon plate 0 0 12 -1 0 -1 1 0 -1 1 0 1 -1 0 1\n"
        );
    let cosine = (PI / 6.0).cos();
    let expected = RADIANCE * solid_angle() / (4.0 * curvature * curvature * cosine.powi(4));
    assert_are(&light(&scene, ""), expected);
}

#[test]
fn a_hidden_light_has_no_glint() {
    let mut scene = sun() + "chrome sphere ball 0 0 4 0 0 0 1\nvoid plastic black 0 0 5 0 0 0 0 0\n";
    let toward = [0.6, -0.5, 0.8].map(|axis: f64| 4.0 * axis);
    let [x, y, z] = toward;
    writeln!(scene, "black sphere shade 0 0 4 {x} {y} {z} 1.2").unwrap();
    assert!(light(&scene, "").iter().all(|light| light.abs() < FRAC_PI_4 * 1e-6));
}
