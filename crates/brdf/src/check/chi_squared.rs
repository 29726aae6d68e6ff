//! Sampling checks: distribution, densities and weights of samples.

use super::cell_statistics::{CellStatistics, mean_and_error};
use super::{CheckLevel, CheckOptions, Finding, Worst, angles_text, evaluate, from_angles};
use crate::Brdf;
use glam::DVec3;

const CHECK: &str = "sampling";

/// Standard deviations of a normal variable that count as significant: one chance in 3 million.
const SIGNIFICANT: f64 = 5.0;
/// Cells with fewer expected samples are merged.
const FEWEST_EXPECTED: f64 = 10.0;
/// Relative tolerance between numbers that the model computes in two ways.
const CONSISTENCY_TOLERANCE: f64 = 1e-5;

/// Samples directions at each outgoing angle and compares the counts in cells with the integral of
/// the density (chi²), the density of each sample with `eval_pdf`, each weight with
/// `f |cos θ_i| / pdf`, and the mean weight with the albedo.
#[must_use]
pub fn sampling(brdf: &dyn Brdf, options: &CheckOptions) -> Vec<Finding> {
    let mut findings = Vec::new();
    let (mut consistency, mut distribution, mut energy) = (Worst::default(), Worst::default(), Worst::default());
    let samples = if options.level == CheckLevel::Quick { 2000 } else { 100_000 };
    for (stream, &degrees) in options.level.outgoing_angles_deg().iter().enumerate() {
        let outgoing = from_angles(degrees.to_radians(), 0.7);
        let statistics =
            CellStatistics::new(brdf, outgoing, options, 100 + stream as u64, samples, |number, sample| {
                // Both functions are smooth: a subset of the samples suffices.
                if number < 2000 {
                    compare_with_eval(
                        brdf,
                        outgoing,
                        sample.incident,
                        sample.density,
                        sample.weights,
                        &mut consistency,
                    );
                }
            });
        compare_counts(&statistics, degrees, options.level.quadrature_tolerance(), &mut distribution);
        compare_energy(&statistics, degrees, options, &mut energy);
    }
    findings.extend(consistency.into_findings());
    findings.extend(distribution.into_findings());
    findings.extend(energy.into_findings());
    findings
}

/// Compares a sample's density and weight with `eval_pdf`.
fn compare_with_eval(
    brdf: &dyn Brdf,
    outgoing: DVec3,
    incident: DVec3,
    density: f64,
    weights: &[f64],
    consistency: &mut Worst,
) {
    let (values, pdf) = evaluate(brdf, weights.len(), outgoing, incident);
    let off = (density / pdf - 1.0).abs();
    if off > CONSISTENCY_TOLERANCE || off.is_nan() {
        consistency.offer(CHECK, off / CONSISTENCY_TOLERANCE, || {
            let at = angles_text(outgoing, incident);
            format!("sample gives the density {density:.6e}, eval_pdf {pdf:.6e} for the same directions at {at}")
        });
    }
    for (band, (&weight, value)) in weights.iter().zip(values).enumerate() {
        let right = value * incident.z.abs() / density;
        let off = (weight - right).abs() / right.abs().max(1e-12);
        if off > CONSISTENCY_TOLERANCE || off.is_nan() {
            consistency.offer(CHECK, off / CONSISTENCY_TOLERANCE, || {
                let at = angles_text(outgoing, incident);
                format!("the weight of a sample is {weight:.6e} in band {band}, but f·|cos|/pdf is {right:.6e} at {at}")
            });
        }
    }
}

/// Pearson's chi², with the quadrature error added to the variance, as a normal deviate by the
/// cube-root approximation of Wilson and Hilferty, "The Distribution of Chi-Square", PNAS 17, 1931.
fn compare_counts(statistics: &CellStatistics, degrees: f64, quadrature: f64, distribution: &mut Worst) {
    let total: f64 = statistics.probabilities.iter().sum();
    if !(-quadrature..=1.0 + 5.0 * quadrature).contains(&total) {
        distribution.offer(CHECK, 1e9 * total, || {
            format!("the density integrates to {total:.4} at outgoing angle {degrees}°, expected at most 1")
        });
        return;
    }
    let elsewhere = (statistics.elsewhere, (1.0 - total).max(0.0) * statistics.samples);
    let cells =
        statistics.counts.iter().zip(&statistics.probabilities).map(|(&count, &p)| (count, p * statistics.samples));
    let mut pooled = (0.0, 0.0);
    let (mut statistic, mut terms) = (0.0, 0.0f64);
    let mut add = |(count, expected): (f64, f64)| {
        let tolerance = quadrature * expected;
        // The absorbed fraction is a difference of integrals and has the error of their sum.
        statistic += (count - expected).powi(2) / (expected + tolerance * tolerance).max(1.0);
        terms += 1.0;
    };
    for (count, expected) in cells {
        if expected < FEWEST_EXPECTED {
            pooled = (pooled.0 + count, pooled.1 + expected);
        } else {
            add((count, expected));
        }
    }
    add(pooled);
    let absorbed_tolerance = quadrature * statistics.samples;
    let excess = ((elsewhere.0 - elsewhere.1).abs() - absorbed_tolerance).max(0.0);
    add((elsewhere.1 + excess, elsewhere.1));
    let freedom = (terms - 1.0).max(1.0);
    let spread = 2.0 / (9.0 * freedom);
    let deviate = ((statistic / freedom).cbrt() - (1.0 - spread)) / spread.sqrt();
    if deviate > SIGNIFICANT || deviate.is_nan() {
        distribution.offer(CHECK, deviate / SIGNIFICANT, || {
            let where_ = worst_cell(statistics);
            format!(
                "samples do not have the density of eval_pdf at outgoing angle {degrees}°: chi² {statistic:.0} with {freedom:.0} degrees of freedom, {deviate:.1} standard deviations off; {where_}"
            )
        });
    }
}

/// The cell with the largest deviation.
fn worst_cell(statistics: &CellStatistics) -> String {
    let cells =
        statistics.counts.iter().zip(&statistics.probabilities).map(|(&count, &p)| (count, p * statistics.samples));
    let deviation = |&(count, expected): &(f64, f64)| (count - expected).abs() / expected.max(1.0).sqrt();
    match cells.max_by(|a, b| deviation(a).total_cmp(&deviation(b))) {
        Some((count, expected)) => {
            format!("in the worst cell {count:.0} of {:.0} samples, expected {expected:.1}", statistics.samples)
        }
        None => String::new(),
    }
}

fn compare_energy(statistics: &CellStatistics, degrees: f64, options: &CheckOptions, energy: &mut Worst) {
    for band in 0..options.bands {
        let (mean, error) = mean_and_error(statistics.weights[band], statistics.samples);
        let right = statistics.albedo(band);
        let allowed = SIGNIFICANT * error + 2.0 * options.level.quadrature_tolerance() * right + 1e-6;
        let off = (mean - right).abs();
        if off > allowed || off.is_nan() {
            energy.offer(CHECK, off / allowed, || {
                format!("the mean weight of samples is {mean:.5} at outgoing angle {degrees}° in band {band}, but f·|cos| integrates to {right:.5}")
            });
        }
    }
}
