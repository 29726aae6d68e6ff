//! Reciprocity check (Helmholtz): `f(o, i) = f(i, o)`.

use super::{CheckLevel, CheckOptions, Finding, Random, Worst, angles_text, direction_near, evaluate, from_angles};
use crate::Brdf;
use glam::DVec3;
use std::f64::consts::TAU;

/// Relative tolerance.
const RELATIVE: f64 = 1e-4;
/// Absolute tolerance, 1/sr.
const ABSOLUTE: f64 = 1e-7;

/// Compares pairs of directions on the front: independent ones, and ones close to each other's
/// mirror and retro directions, at distances uniform in the logarithm.
#[must_use]
pub fn reciprocity(brdf: &dyn Brdf, options: &CheckOptions) -> Vec<Finding> {
    let mut worst = Worst::default();
    if !options.reciprocal {
        return Vec::new();
    }
    let mut random = Random::new(options.seed, 2);
    let pairs = if options.level == CheckLevel::Quick { 300 } else { 10_000 };
    for index in 0..pairs {
        let outgoing = anywhere(&mut random);
        let mirror = DVec3::new(-outgoing.x, -outgoing.y, outgoing.z);
        let distance = 10f64.powf(-6.0 * random.uniform());
        let azimuth = TAU * random.uniform();
        let incident = match index % 3 {
            0 => anywhere(&mut random),
            1 => direction_near(mirror, distance, azimuth),
            _ => direction_near(outgoing, distance, azimuth),
        };
        if incident.z > 0.0 {
            compare(brdf, outgoing, incident, options, &mut worst);
        }
    }
    worst.into_findings()
}

/// Uniform in the polar angle, which makes grazing directions frequent.
fn anywhere(random: &mut Random) -> DVec3 {
    from_angles(89.95f64.to_radians() * random.uniform(), TAU * random.uniform())
}

fn compare(brdf: &dyn Brdf, outgoing: DVec3, incident: DVec3, options: &CheckOptions, worst: &mut Worst) {
    let (there, _) = evaluate(brdf, options.bands, outgoing, incident);
    let (back, _) = evaluate(brdf, options.bands, incident, outgoing);
    for (band, (there, back)) in there.into_iter().zip(back).enumerate() {
        let off = (there - back).abs() / (RELATIVE * there.max(back) + ABSOLUTE);
        if off > 1.0 || off.is_nan() {
            worst.offer("reciprocity", off, || {
                let at = angles_text(outgoing, incident);
                format!("f is {there:.6e} but {back:.6e} with exchanged directions in band {band} at {at}")
            });
        }
    }
}
