//! Checks that a value depends on its directions only: not on the batch, the order, the thread, or
//! the azimuth of the frame.

use super::{CheckLevel, CheckOptions, Finding, Random, Worst, angles_text, evaluate, from_angles};
use crate::Brdf;
use glam::{DMat3, DVec3};
use std::f64::consts::{PI, TAU};

/// Relative tolerance between a batch and single calls: vectorised models may round differently.
const BATCH_TOLERANCE: f64 = 1e-9;
/// Relative tolerance between two azimuths of an isotropic model.
const AZIMUTH_TOLERANCE: f64 = 1e-6;
const THREADS: usize = 4;

/// Compares single calls with a batch, one order with another, and one thread with several.
#[must_use]
pub fn purity(brdf: &dyn Brdf, options: &CheckOptions) -> Vec<Finding> {
    let mut random = Random::new(options.seed, 3);
    let count = if options.level == CheckLevel::Quick { 16 } else { 333 };
    let directions: Vec<DVec3> =
        (0..count).map(|_| from_angles(0.55 * PI * random.uniform(), TAU * random.uniform())).collect();
    let mut worst = Worst::default();
    for &degrees in options.level.outgoing_angles_deg() {
        let outgoing = from_angles(degrees.to_radians(), 0.7);
        let batch = evaluate_batch(brdf, outgoing, &directions, options.bands);
        compare_single(brdf, outgoing, &directions, &batch, options, &mut worst);
        compare_order(brdf, outgoing, &directions, options, &mut worst);
    }
    if options.level == CheckLevel::Thorough {
        compare_threads(brdf, &directions, options, &mut worst);
    }
    worst.into_findings()
}

/// Checks that an isotropic model is invariant under rotation of both directions about the normal.
#[must_use]
pub fn isotropy(brdf: &dyn Brdf, options: &CheckOptions) -> Vec<Finding> {
    let mut worst = Worst::default();
    if !options.isotropic {
        return Vec::new();
    }
    let mut random = Random::new(options.seed, 4);
    let pairs = if options.level == CheckLevel::Quick { 50 } else { 2000 };
    for _ in 0..pairs {
        let mut direction = || from_angles(89f64.to_radians() * random.uniform(), TAU * random.uniform());
        let (outgoing, incident) = (direction(), direction());
        let turn = DMat3::from_rotation_z(TAU * random.uniform());
        let (here, _) = evaluate(brdf, options.bands, outgoing, incident);
        let (there, _) = evaluate(brdf, options.bands, turn * outgoing, turn * incident);
        for (here, there) in here.into_iter().zip(there) {
            let off = (here - there).abs() / (AZIMUTH_TOLERANCE * here.max(there) + 1e-9);
            if off > 1.0 || off.is_nan() {
                worst.offer("isotropy", off, || {
                    let at = angles_text(outgoing, incident);
                    format!("value {here:.6e} but {there:.6e} when both directions are rotated about the normal at {at}, but the model does not declare anisotropy")
                });
            }
        }
    }
    worst.into_findings()
}

/// Values by direction, then densities.
fn evaluate_batch(brdf: &dyn Brdf, outgoing: DVec3, directions: &[DVec3], bands: usize) -> (Vec<f64>, Vec<f64>) {
    let (mut values, mut pdfs) = (vec![0.0; directions.len() * bands], vec![0.0; directions.len()]);
    brdf.eval_pdf(outgoing, directions, &mut values, &mut pdfs);
    (values, pdfs)
}

fn compare_single(
    brdf: &dyn Brdf,
    outgoing: DVec3,
    directions: &[DVec3],
    batch: &(Vec<f64>, Vec<f64>),
    options: &CheckOptions,
    worst: &mut Worst,
) {
    for (index, &incident) in directions.iter().enumerate() {
        let (values, pdf) = evaluate(brdf, options.bands, outgoing, incident);
        let in_batch = batch.0[index * options.bands..][..options.bands].iter().chain([&batch.1[index]]);
        for (single, in_batch) in values.iter().chain([&pdf]).zip(in_batch) {
            // Two NaN are no difference; that they are no values is another check's finding.
            if single.is_nan() && in_batch.is_nan() {
                continue;
            }
            let off = (single - in_batch).abs() / (BATCH_TOLERANCE * single.max(*in_batch) + 1e-300);
            if off > 1.0 || off.is_nan() {
                worst.offer("purity", off, || {
                    let at = angles_text(outgoing, incident);
                    format!("{single:.9e} in a single call but {in_batch:.9e} in a batch at {at}")
                });
            }
        }
    }
}

/// Compares the same directions in reverse order: all bits must be equal.
fn compare_order(brdf: &dyn Brdf, outgoing: DVec3, directions: &[DVec3], options: &CheckOptions, worst: &mut Worst) {
    let backwards: Vec<DVec3> = directions.iter().rev().copied().collect();
    let (forth, _) = evaluate_batch(brdf, outgoing, directions, options.bands);
    let (back, _) = evaluate_batch(brdf, outgoing, &backwards, options.bands);
    for (index, &incident) in directions.iter().enumerate() {
        let mirrored = directions.len() - 1 - index;
        let (here, there) = (forth[index * options.bands], back[mirrored * options.bands]);
        if here.to_bits() != there.to_bits() && !(here.is_nan() && there.is_nan()) {
            let off = (here - there).abs() / here.abs().max(f64::MIN_POSITIVE) / BATCH_TOLERANCE;
            // A vectorised model may round the rest of a batch differently.
            if off > 1.0 || off.is_nan() {
                worst.offer("purity", off, || {
                    let at = angles_text(outgoing, incident);
                    format!("{here:.9e} but {there:.9e} with the batch in another order at {at}")
                });
            }
        }
    }
}

/// Evaluates the same batches on several threads at once: all bits must equal those of one thread.
fn compare_threads(brdf: &dyn Brdf, directions: &[DVec3], options: &CheckOptions, worst: &mut Worst) {
    let work = || -> Vec<(Vec<f64>, Vec<f64>)> {
        let outgoing = directions.iter().filter(|direction| direction.z > 0.0).take(40);
        outgoing.map(|&outgoing| evaluate_batch(brdf, outgoing, directions, options.bands)).collect()
    };
    let alone = work();
    let bits = |batches: &[(Vec<f64>, Vec<f64>)]| -> Vec<u64> {
        batches.iter().flat_map(|(values, pdfs)| values.iter().chain(pdfs)).map(|number| number.to_bits()).collect()
    };
    let differing = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..THREADS).map(|_| scope.spawn(work)).collect();
        let results = threads
            .into_iter()
            .map(|thread| thread.join().map_or(usize::MAX, |result| differences(&bits(&alone), &bits(&result))));
        results.max().unwrap_or(0)
    });
    if differing > 0 {
        worst.offer("purity", f64::INFINITY, || {
            format!("{differing} numbers differ when {THREADS} threads evaluate the same batches at once")
        });
    }
}

fn differences(left: &[u64], right: &[u64]) -> usize {
    left.iter().zip(right).filter(|(left, right)| left != right).count()
}
