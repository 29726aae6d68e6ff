//! Whether directions are drawn with the density that is claimed, and weighted rightly.

use super::energy::hemispheres;
use super::{CheckOptions, Effort, Finding, Partition, Random, Worst, angles_text, evaluate, from_angles};
use crate::{Brdf, BrdfSample, Density};
use glam::DVec3;

const CHECK: &str = "sampling";

/// Standard deviations of a normal variable beyond which a deviation is no chance: one in 3 million.
const SIGNIFICANT: f64 = 5.0;
/// Cells that expect fewer samples are taken together.
const FEWEST_EXPECTED: f64 = 10.0;
/// Between numbers that the model computes in two ways.
const CONSISTENCY_TOLERANCE: f64 = 1e-5;

/// Draws directions at each outgoing angle and compares: the counts in cells with the integral of the density (chi²), the
/// density of each sample with that of `eval_pdf`, each weight with `f |cos θ_i| / pdf`, and the mean weight with the albedo.
#[must_use]
pub fn sampling(brdf: &dyn Brdf, options: &CheckOptions) -> Vec<Finding> {
    let mut findings = Vec::new();
    let (mut consistency, mut distribution, mut energy) = (Worst::default(), Worst::default(), Worst::default());
    for (stream, &degrees) in options.effort.outgoing_angles_deg().iter().enumerate() {
        let outgoing = from_angles(degrees.to_radians(), 0.7);
        let partition = Partition::new(outgoing, options.effort.fineness());
        let expected = expect(brdf, outgoing, &partition, options);
        let drawn = draw(brdf, outgoing, &partition, options, stream as u64, &mut consistency);
        compare_counts(&expected, &drawn, degrees, options.effort.quadrature_tolerance(), &mut distribution);
        compare_energy(&expected, &drawn, degrees, options, &mut energy);
    }
    findings.extend(consistency.into_findings());
    findings.extend(distribution.into_findings());
    findings.extend(energy.into_findings());
    findings
}

/// By quadrature.
struct Expected {
    /// Probability of each cell.
    cells: Vec<f64>,
    /// `∫ f |cos θ_i| dω_i` in each band.
    albedo: Vec<f64>,
}

/// By drawing.
struct Drawn {
    samples: f64,
    cells: Vec<f64>,
    /// Samples that were absorbed or perfectly specular.
    elsewhere: f64,
    /// Sum and sum of squares of the weights in each band, perfectly specular ones left out.
    weights: Vec<[f64; 2]>,
}

fn expect(brdf: &dyn Brdf, outgoing: DVec3, partition: &Partition, options: &CheckOptions) -> Expected {
    let mut expected = Expected { cells: vec![0.0; partition.cells()], albedo: vec![0.0; options.bands] };
    let (mut values, mut pdfs) = (Vec::new(), Vec::new());
    partition.visit(hemispheres(brdf), |cell, directions, solid_angles| {
        values.resize(directions.len() * options.bands, 0.0);
        pdfs.resize(directions.len(), 0.0);
        brdf.eval_pdf(outgoing, directions, &mut values, &mut pdfs);
        for (index, (direction, solid_angle)) in directions.iter().zip(solid_angles).enumerate() {
            expected.cells[cell] += pdfs[index] * solid_angle;
            for (band, sum) in expected.albedo.iter_mut().enumerate() {
                *sum += values[index * options.bands + band] * direction.z.abs() * solid_angle;
            }
        }
    });
    expected
}

fn draw(
    brdf: &dyn Brdf,
    outgoing: DVec3,
    partition: &Partition,
    options: &CheckOptions,
    stream: u64,
    consistency: &mut Worst,
) -> Drawn {
    let samples = if options.effort == Effort::Quick { 2000 } else { 100_000 };
    let mut random = Random::new(options.seed, 100 + stream);
    let mut drawn = Drawn {
        samples: f64::from(samples),
        cells: vec![0.0; partition.cells()],
        elsewhere: 0.0,
        weights: vec![[0.0; 2]; options.bands],
    };
    let mut weights = vec![0.0; options.bands];
    for number in 0..samples {
        let found = brdf.sample(outgoing, random.cube(), &mut weights);
        let Some(BrdfSample { incident, density: Density::Continuous(density) }) = found else {
            drawn.elsewhere += 1.0;
            continue;
        };
        drawn.cells[partition.cell_of(incident)] += 1.0;
        for (sum, weight) in drawn.weights.iter_mut().zip(&weights) {
            sum[0] += weight;
            sum[1] += weight * weight;
        }
        // Both functions are smooth: a part of the samples tells all.
        if number < 2000 {
            compare_with_eval(brdf, outgoing, incident, density, &weights, consistency);
        }
    }
    drawn
}

/// The density and the weight of a sample against `eval_pdf`.
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

/// Pearson's chi², with the error of the quadrature added to the variance, as a normal deviate by the cube-root approximation
/// of Wilson and Hilferty, "The Distribution of Chi-Square", PNAS 17, 1931.
fn compare_counts(expected: &Expected, drawn: &Drawn, degrees: f64, quadrature: f64, distribution: &mut Worst) {
    let total: f64 = expected.cells.iter().sum();
    if !(-quadrature..=1.0 + 5.0 * quadrature).contains(&total) {
        distribution.offer(CHECK, 1e9 * total, || {
            format!("the density integrates to {total:.4} at outgoing angle {degrees}°, expected at most 1")
        });
        return;
    }
    let elsewhere = (drawn.elsewhere, (1.0 - total).max(0.0) * drawn.samples);
    let cells = drawn.cells.iter().zip(&expected.cells).map(|(&count, &p)| (count, p * drawn.samples));
    let mut pooled = (0.0, 0.0);
    let (mut statistic, mut terms) = (0.0, 0.0f64);
    let mut add = |(count, expected): (f64, f64)| {
        let tolerance = quadrature * expected;
        // The part that absorption takes is a difference of integrals and has the error of their sum.
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
    let absorbed_tolerance = quadrature * drawn.samples;
    let excess = ((elsewhere.0 - elsewhere.1).abs() - absorbed_tolerance).max(0.0);
    add((elsewhere.1 + excess, elsewhere.1));
    let freedom = (terms - 1.0).max(1.0);
    let spread = 2.0 / (9.0 * freedom);
    let deviate = ((statistic / freedom).cbrt() - (1.0 - spread)) / spread.sqrt();
    if deviate > SIGNIFICANT || deviate.is_nan() {
        distribution.offer(CHECK, deviate / SIGNIFICANT, || {
            let where_ = worst_cell(expected, drawn);
            format!(
                "directions are not drawn with the density that is claimed at outgoing angle {degrees}°: chi² {statistic:.0} with {freedom:.0} degrees of freedom, {deviate:.1} standard deviations off; {where_}"
            )
        });
    }
}

/// Where most of the deviation is.
fn worst_cell(expected: &Expected, drawn: &Drawn) -> String {
    let cells = drawn.cells.iter().zip(&expected.cells).map(|(&count, &p)| (count, p * drawn.samples));
    let deviation = |&(count, expected): &(f64, f64)| (count - expected).abs() / expected.max(1.0).sqrt();
    match cells.max_by(|a, b| deviation(a).total_cmp(&deviation(b))) {
        Some((count, expected)) => {
            format!("in the worst cell {count:.0} of {:.0} samples, expected {expected:.1}", drawn.samples)
        }
        None => String::new(),
    }
}

fn compare_energy(expected: &Expected, drawn: &Drawn, degrees: f64, options: &CheckOptions, energy: &mut Worst) {
    for band in 0..options.bands {
        let [sum, squares] = drawn.weights[band];
        let mean = sum / drawn.samples;
        let error = ((squares / drawn.samples - mean * mean).max(0.0) / drawn.samples).sqrt();
        let right = expected.albedo[band];
        let allowed = SIGNIFICANT * error + 2.0 * options.effort.quadrature_tolerance() * right + 1e-6;
        let off = (mean - right).abs();
        if off > allowed || off.is_nan() {
            energy.offer(CHECK, off / allowed, || {
                format!("the mean weight of samples is {mean:.5} at outgoing angle {degrees}° in band {band}, but f·|cos| integrates to {right:.5}")
            });
        }
    }
}
