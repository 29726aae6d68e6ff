//! Checks that every value is finite and not negative, even at degenerate directions.

use super::{CheckLevel, CheckOptions, Finding, Random, Worst, angles_text, direction_near, evaluate, from_angles};
use crate::{Brdf, Density};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

const CHECK: &str = "finite";

/// Evaluates and samples the model at ordinary, grazing and degenerate directions. A model without
/// transmission must be zero for directions on opposite sides.
#[must_use]
pub fn finite(brdf: &dyn Brdf, options: &CheckOptions) -> Vec<Finding> {
    let mut worst = Worst::default();
    let outgoing_directions = outgoing_directions(options.level);
    for &outgoing in &outgoing_directions {
        for incident in incident_directions(outgoing, options.level) {
            check_value(brdf, outgoing, incident, options, &mut worst);
        }
    }
    let mut findings = worst.into_findings();
    let mut worst = Worst::default();
    let mut random = Random::new(options.seed, 1);
    for &outgoing in &outgoing_directions {
        for u in sample_points(&mut random, options.level) {
            check_sample(brdf, outgoing, u, options, &mut worst);
        }
    }
    findings.extend(worst.into_findings());
    findings
}

fn outgoing_directions(level: CheckLevel) -> Vec<DVec3> {
    let mut polar: Vec<f64> = level.outgoing_angles_deg().iter().map(|degrees| degrees.to_radians()).collect();
    // On and below the horizon, and close to the normal.
    polar.extend([1e-9, FRAC_PI_2 - 1e-6, FRAC_PI_2, FRAC_PI_2 + 1e-6, 2.0, PI]);
    let mut all: Vec<DVec3> = polar.into_iter().map(|polar| from_angles(polar, 0.7)).collect();
    all.extend([DVec3::X, DVec3::Z, -DVec3::Z, DVec3::Y]);
    all
}

fn incident_directions(outgoing: DVec3, level: CheckLevel) -> Vec<DVec3> {
    let mut all = outgoing_directions(level);
    let mirror = DVec3::new(-outgoing.x, -outgoing.y, outgoing.z);
    for axis in [outgoing, mirror, -outgoing, -mirror] {
        all.push(axis);
        for (index, offset) in [1e-12, 1e-8, 1e-5, 1e-3, 0.1].into_iter().enumerate() {
            all.push(direction_near(axis, offset, index as f64));
        }
    }
    for azimuth in [0.7 + PI, 2.5, -1.0] {
        all.extend([89.0f64, 89.99, 89.999_999].map(|degrees| from_angles(degrees.to_radians(), azimuth)));
    }
    all
}

fn sample_points(random: &mut Random, level: CheckLevel) -> Vec<[f64; 3]> {
    const JUST_BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;
    let edges = [0.0, 0.5, JUST_BELOW_ONE];
    let corners = edges.iter().flat_map(|&a| edges.iter().flat_map(move |&b| edges.map(move |c| [a, b, c])));
    let more = if level == CheckLevel::Quick { 20 } else { 1000 };
    corners.chain(std::iter::repeat_with(|| random.cube()).take(more)).collect()
}

fn check_value(brdf: &dyn Brdf, outgoing: DVec3, incident: DVec3, options: &CheckOptions, worst: &mut Worst) {
    let (values, pdf) = evaluate(brdf, options.bands, outgoing, incident);
    for (what, number) in values.iter().map(|value| ("value", *value)).chain([("pdf", pdf)]) {
        if !(0.0..=f64::MAX).contains(&number) {
            worst.offer(CHECK, wrongness(number), || {
                format!("{what} {number} at {}, expected finite and at least 0", angles_text(outgoing, incident))
            });
        }
    }
    let across = outgoing.z * incident.z < 0.0;
    if across && !brdf.lobes().transmission && values.iter().any(|&value| value > 0.0) {
        worst.offer(CHECK, 1.0, || {
            let at = angles_text(outgoing, incident);
            format!(
                "value {} on the other side of the surface at {at}, but the model declares no transmission",
                values[0]
            )
        });
    }
}

fn check_sample(brdf: &dyn Brdf, outgoing: DVec3, u: [f64; 3], options: &CheckOptions, worst: &mut Worst) {
    let mut weights = vec![f64::NAN; options.bands];
    let Some(sample) = brdf.sample(outgoing, u, &mut weights) else { return };
    let at = || angles_text(outgoing, sample.incident);
    let off_unit = (sample.incident.length() - 1.0).abs();
    if off_unit > 1e-6 || off_unit.is_nan() {
        worst.offer(CHECK, off_unit / 1e-6, || {
            format!("sample returns a direction of length {}, expected 1, at {}", sample.incident.length(), at())
        });
    }
    if let Density::Continuous(density) = sample.density
        && !(f64::MIN_POSITIVE..=f64::MAX).contains(&density)
    {
        worst.offer(CHECK, wrongness(density), || {
            format!("sample returns a direction with density {density} at {}", at())
        });
    }
    for weight in weights {
        if !(0.0..=f64::MAX).contains(&weight) {
            worst.offer(CHECK, wrongness(weight), || format!("weight {weight} of a sample at {}", at()));
        }
    }
    let lobes = brdf.lobes();
    if sample.incident.z * outgoing.z < 0.0 && !lobes.transmission {
        worst.offer(CHECK, 1.0, || {
            format!("sample returns a direction below the surface at {}, but the model declares no transmission", at())
        });
    }
    if sample.density == Density::Delta && !lobes.delta {
        worst.offer(CHECK, 1.0, || {
            format!("sample returns a perfectly specular direction at {}, but the model declares no delta lobe", at())
        });
    }
}

/// Severity: not-a-number is worse than infinite, and infinite worse than negative.
fn wrongness(number: f64) -> f64 {
    match number {
        number if number.is_nan() => 3.0,
        number if number.is_infinite() => 2.0,
        _ => 1.5,
    }
}
