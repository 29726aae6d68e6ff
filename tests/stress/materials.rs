//! Materials at the limits of their parameters, and touching dielectrics.

use crate::light::mean;
use crate::rays::Numbers;
use crate::table::{count, row};
use glam::DVec3;
use radsight::RenderOptions;
use radsight_brdf::{Brdf, Density};
use radsight_render::PathLimit;

const RAYS: usize = 4_096;

/// In a white furnace, from normal incidence to 0.0001° above the surface, no material reflects
/// more than it receives.
#[test]
fn roughness_and_grazing() {
    let mut wrong = 0;
    let mut tried = 0;
    for (material, most) in [
        ("plastic m 0 0 5 .5 .5 .5 .3 {r}", 1.0),
        ("metal m 0 0 5 1 1 1 .9 {r}", 1.0),
        ("trans m 0 0 7 1 1 1 .05 {r} .5 .5", 1.0),
    ] {
        let mut worst: f64 = 0.0;
        for roughness in [0.0, 1e-9, 1e-4, 0.01, 0.2, 0.5, 1.0] {
            for degrees in [0.0_f64, 60.0, 89.0, 89.9999] {
                let text = material.replace("{r}", &format!("{roughness:e}"));
                let scene = format!(
                    "void {text}\nm polygon sheet 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\nvoid glow white 0 0 4 1 1 1 0\nwhite source all 0 0 4 0 0 1 360\n"
                );
                let (wide, high) = degrees.to_radians().sin_cos();
                let options = RenderOptions { ambient_bounces: 1, least_weight: 1e-6, ..RenderOptions::default() };
                let from = DVec3::new(-wide, 0.0, high) * 1e-3;
                let (found, bad) = mean(&scene, options, from, DVec3::new(wide, 0.0, -high), RAYS);
                (wrong, tried) = (wrong + bad, tried + 3 * RAYS);
                worst = worst.max(found / most - 1.0);
            }
        }
        let name = material.split(' ').next().unwrap_or(material);
        row(&format!("{name} of roughness 0 … 1 at 0° … 89.9999°"), "gain in a white furnace", 0.01, worst.max(0.0));
    }
    count("the same", "values below zero or no numbers", tried, wrong);
}

/// The albedo from sampled directions, compared with the integral of the lobe.
#[test]
fn retroreflectors_from_a_hair_to_a_hemisphere() {
    for (model, widths) in [
        ("paper1991", &[1e-5, 1e-4, 1e-3, 0.01, 0.1, 0.2][..]),
        ("gauss_reciprocal", &[1e-5, 1e-4, 1e-3, 0.01, 0.1, 0.2]),
        ("sharp", &[1e-5, 1e-4, 1e-3, 0.01, 0.1, 0.5]),
        ("mrm", &[5e-4, 0.01, 0.1, 1.0]),
    ] {
        for width in widths {
            let numbers: &[f64] = match model {
                "sharp" => &[0.8, *width, 4.0],
                "mrm" => &[0.8, *width, 1.0],
                _ => &[0.8, *width],
            };
            let sheet = radsight_retro::model(model, &[], numbers).expect("the model takes it");
            for degrees in [0.0_f64, 30.0, 89.9999] {
                let (sin, cos) = degrees.to_radians().sin_cos();
                let outgoing = DVec3::new(sin, 0.0, cos);
                let drawn = albedo_of_draws(&sheet, outgoing);
                let integral = integral_of_lobe(&sheet, outgoing, *width);
                let case = format!("{model} {width:.0e} wide at {degrees}°");
                assert!(drawn.is_finite() && drawn >= 0.0, "{case}: {drawn}");
                if degrees < 80.0 {
                    row(
                        &case,
                        "sampled albedo, against the integral",
                        0.02,
                        (drawn - integral).abs() / integral.max(0.01),
                    );
                } else {
                    row(&case, "sampled albedo, above 1", 0.01, (drawn - 1.0).max(0.0));
                }
            }
        }
    }
    let refused = radsight_retro::model("paper1991", &[], &[0.8, 1.0]).map(|_| ());
    assert!(refused.is_err_and(|error| error.to_string().contains("alpha")), "a Gaussian of 1 radian is no lobe");
}

fn albedo_of_draws(sheet: &impl Brdf, outgoing: DVec3) -> f64 {
    let side: u32 = 96;
    let mut sum = 0.0;
    for row in 0..side {
        for column in 0..side {
            let [u, v] = [column, row].map(|at| (f64::from(at) + 0.5) / f64::from(side));
            let choice = (f64::from(row * side + column) * 0.618_033_988_749_895).fract();
            let mut weight = [0.0];
            if let Some(sample) = sheet.sample(outgoing, [u, v, choice], &mut weight) {
                assert!(weight[0].is_finite() && weight[0] >= 0.0, "{weight:?}");
                assert!(
                    !matches!(sample.density, Density::Continuous(density) if !(density.is_finite() && density >= 0.0))
                );
                sum += weight[0];
            }
        }
    }
    sum / f64::from(side * side)
}

/// ∫ f·cos θ over the hemisphere, in rings around the retroreflection direction whose widths grow
/// from a hundredth of the lobe's.
fn integral_of_lobe(sheet: &impl Brdf, outgoing: DVec3, width: f64) -> f64 {
    let (x, y) = outgoing.any_orthonormal_pair();
    let (rings, slices): (u32, u32) = (1_500, 64);
    let (low, high) = ((width * 1e-3).ln(), std::f64::consts::PI.ln());
    let step = (high - low) / f64::from(rings);
    let mut sum = 0.0;
    for ring in 0..rings {
        let angle = (low + step * (f64::from(ring) + 0.5)).exp();
        for slice in 0..slices {
            let (sin, cos) = (std::f64::consts::TAU * (f64::from(slice) + 0.5) / f64::from(slices)).sin_cos();
            let incident = outgoing * angle.cos() + (x * cos + y * sin) * angle.sin();
            if incident.z <= 0.0 {
                continue;
            }
            let (mut value, mut pdf) = ([0.0], [0.0]);
            sheet.eval_pdf(outgoing, &[incident], &mut value, &mut pdf);
            sum += value[0] * incident.z * angle.sin() * angle * step * std::f64::consts::TAU / f64::from(slices);
        }
    }
    sum
}

/// Glass in water in glass with touching or nearly touching surfaces: light of a uniform
/// environment is unchanged.
#[test]
fn dielectrics_that_touch() {
    for gap in [0.0, 1e-12, 1e-9, 1e-6, 1e-3] {
        let scene = format!(
            "void dielectric glass 0 0 5 1 1 1 1.5 0\nvoid dielectric water 0 0 5 1 1 1 1.33 0\n\
             void interface both 0 0 8 1 1 1 1.33 1 1 1 1.5\n\
             glass sphere outer 0 0 4 0 0 0 1\nboth sphere inner 0 0 4 0 0 {:e} .5\nwater sphere beside 0 0 4 {:e} 0 0 1\n\
             void glow white 0 0 4 1 1 1 0\nwhite source all 0 0 4 0 0 1 360\n",
            0.5 - gap,
            2.0 + gap
        );
        let options = RenderOptions { path_limit: PathLimit::Roulette, least_weight: 1e-3, ..RenderOptions::default() };
        let mut numbers = Numbers::new(6);
        let (mut sum, mut wrong) = (0.0, 0);
        let views = 64;
        for _ in 0..views {
            let origin = numbers.direction() * 5.0;
            let aim = [DVec3::X, DVec3::Z, DVec3::ZERO][numbers.index(3)] + numbers.direction() * 0.3;
            let (found, bad) = mean(&scene, options.clone(), origin, aim - origin, 256);
            (sum, wrong) = (sum + found, wrong + bad);
        }
        count(&format!("dielectrics {gap:.0e} apart"), "values below zero or no numbers", views * 768, wrong);
        row(
            &format!("dielectrics {gap:.0e} apart"),
            "radiance in a white furnace, against 1",
            0.02,
            (sum / views as f64 - 1.0).abs(),
        );
    }
}
