//! Integrals and sample counts of one outgoing direction, by cell.

use super::{CheckLevel, CheckOptions, Hemispheres, Partition, Random};
use crate::{Brdf, BrdfSample, Density};
use glam::DVec3;

/// Statistics of a model for one outgoing direction.
pub(super) struct CellStatistics {
    /// Probability of each cell, by quadrature of the density.
    pub(super) probabilities: Vec<f64>,
    /// `∫ f |cos θ_i| dω_i` in each cell and band, by quadrature.
    albedos: Vec<f64>,
    /// Number of samples in each cell.
    pub(super) counts: Vec<f64>,
    /// Total number of samples.
    pub(super) samples: f64,
    /// Number of absorbed or perfectly specular samples.
    pub(super) elsewhere: f64,
    /// Sum and sum of squares of the weights in each band, over all samples that are not perfectly
    /// specular.
    pub(super) weights: Vec<[f64; 2]>,
    /// The same over the perfectly specular samples.
    pub(super) delta_weights: Vec<[f64; 2]>,
    bands: usize,
}

/// A sample with a finite density, for further comparisons.
pub(super) struct FiniteSample<'a> {
    pub(super) incident: DVec3,
    pub(super) density: f64,
    pub(super) weights: &'a [f64],
}

/// Cells whose count deviates from the quadrature by this many standard deviations are refined.
const SUSPECT: f64 = 4.0;
/// Cells with more than this fraction of the albedo or of the samples are refined …
const NOTABLE: f64 = 5e-4;
/// … if a grid that is twice as fine differs by more than this.
const UNSTEADY: f64 = 5e-5;

impl CheckLevel {
    /// Refinement of a cell's grid in both directions, and the maximum number of refined cells,
    /// worst first.
    fn refinement(self) -> (usize, usize) {
        match self {
            CheckLevel::Quick => (8, 40),
            CheckLevel::Thorough => (16, 400),
        }
    }
}

impl CellStatistics {
    /// Integrates and samples the model; `inspect` gets each sample of finite density, with its
    /// number.
    ///
    /// Cells where both disagree, and large cells whose integral changes with the grid, are
    /// integrated again on a finer grid: a narrow lobe away from the mirror and retro directions
    /// may have been missed. A real disagreement remains.
    pub(super) fn new(
        brdf: &dyn Brdf,
        outgoing: DVec3,
        options: &CheckOptions,
        stream: u64,
        samples: u32,
        mut inspect: impl FnMut(u32, FiniteSample<'_>),
    ) -> CellStatistics {
        let partition = Partition::new(outgoing, options.level.fineness());
        let mut statistics = CellStatistics {
            probabilities: vec![0.0; partition.cells()],
            albedos: vec![0.0; partition.cells() * options.bands],
            counts: vec![0.0; partition.cells()],
            samples: f64::from(samples),
            elsewhere: 0.0,
            weights: vec![[0.0; 2]; options.bands],
            delta_weights: vec![[0.0; 2]; options.bands],
            bands: options.bands,
        };
        let mut integrator = Integrator { brdf, outgoing, bands: options.bands, values: Vec::new(), pdfs: Vec::new() };
        partition.visit(hemispheres(brdf), |cell, directions, solid_angles| {
            let integral = integrator.integrate(directions, solid_angles);
            statistics.set(cell, &integral);
        });
        statistics.draw(brdf, outgoing, &partition, &mut Random::new(options.seed, stream), samples, &mut inspect);
        let (refinement, most) = options.level.refinement();
        for cell in statistics.notable(most) {
            let finer = integrator.integrate_cell(&partition, cell, 2);
            if statistics.distance(cell, &finer) > UNSTEADY {
                statistics.set(cell, &integrator.integrate_cell(&partition, cell, refinement));
            }
        }
        for cell in statistics.suspects(most) {
            statistics.set(cell, &integrator.integrate_cell(&partition, cell, refinement));
        }
        statistics
    }

    /// `∫ f |cos θ_i| dω_i` in a band.
    pub(super) fn albedo(&self, band: usize) -> f64 {
        self.albedos.iter().skip(band).step_by(self.bands).sum()
    }

    fn set(&mut self, cell: usize, integral: &Integral) {
        self.probabilities[cell] = integral.probability;
        self.albedos[cell * self.bands..][..self.bands].copy_from_slice(&integral.albedo);
    }

    /// Difference between a new integral and that of the cell, in probability or albedo.
    fn distance(&self, cell: usize, integral: &Integral) -> f64 {
        let albedos = self.albedos[cell * self.bands..].iter().zip(&integral.albedo);
        let albedo = albedos.map(|(before, now)| (before - now).abs()).fold(0.0, f64::max);
        albedo.max((self.probabilities[cell] - integral.probability).abs())
    }

    /// Cells with a large fraction of the albedo or of the samples.
    fn notable(&self, most: usize) -> Vec<usize> {
        let share = |cell: usize| {
            let albedo = self.albedos[cell * self.bands..][..self.bands].iter().copied().fold(0.0, f64::max);
            albedo.max(self.probabilities[cell]).max(self.counts[cell] / self.samples)
        };
        let mut cells: Vec<usize> = (0..self.counts.len()).filter(|&cell| share(cell) > NOTABLE).collect();
        cells.sort_by(|&a, &b| share(b).total_cmp(&share(a)));
        cells.truncate(10 * most);
        cells
    }

    fn draw(
        &mut self,
        brdf: &dyn Brdf,
        outgoing: DVec3,
        partition: &Partition,
        random: &mut Random,
        samples: u32,
        inspect: &mut impl FnMut(u32, FiniteSample<'_>),
    ) {
        let mut weights = vec![0.0; self.bands];
        for number in 0..samples {
            let sums = match brdf.sample(outgoing, random.cube(), &mut weights) {
                Some(BrdfSample { incident, density: Density::Continuous(density) }) => {
                    self.counts[partition.cell_of(incident)] += 1.0;
                    inspect(number, FiniteSample { incident, density, weights: &weights });
                    &mut self.weights
                }
                Some(_) => {
                    self.elsewhere += 1.0;
                    &mut self.delta_weights
                }
                None => {
                    self.elsewhere += 1.0;
                    continue;
                }
            };
            for (sum, weight) in sums.iter_mut().zip(&weights) {
                sum[0] += weight;
                sum[1] += weight * weight;
            }
        }
    }

    /// Cells where counts and quadrature disagree, the worst first.
    fn suspects(&self, most: usize) -> Vec<usize> {
        let off = |cell: &usize| {
            let (count, expected) = (self.counts[*cell], self.probabilities[*cell] * self.samples);
            (count - expected).abs() / expected.min(count).max(1.0).sqrt()
        };
        let mut cells: Vec<usize> = (0..self.counts.len()).filter(|cell| off(cell) > SUSPECT).collect();
        cells.sort_by(|a, b| off(b).total_cmp(&off(a)));
        cells.truncate(most);
        cells
    }
}

/// Integral over a part of the sphere.
struct Integral {
    probability: f64,
    albedo: Vec<f64>,
}

/// Evaluates a model at quadrature points.
struct Integrator<'a> {
    brdf: &'a dyn Brdf,
    outgoing: DVec3,
    bands: usize,
    values: Vec<f64>,
    pdfs: Vec<f64>,
}

impl Integrator<'_> {
    fn integrate(&mut self, directions: &[DVec3], solid_angles: &[f64]) -> Integral {
        self.values.resize(directions.len() * self.bands, 0.0);
        self.pdfs.resize(directions.len(), 0.0);
        self.brdf.eval_pdf(self.outgoing, directions, &mut self.values, &mut self.pdfs);
        let mut integral = Integral { probability: 0.0, albedo: vec![0.0; self.bands] };
        for (index, (direction, solid_angle)) in directions.iter().zip(solid_angles).enumerate() {
            integral.probability += self.pdfs[index] * solid_angle;
            let values = &self.values[index * self.bands..][..self.bands];
            for (sum, value) in integral.albedo.iter_mut().zip(values) {
                *sum += value * direction.z.abs() * solid_angle;
            }
        }
        integral
    }

    fn integrate_cell(&mut self, partition: &Partition, cell: usize, refinement: usize) -> Integral {
        let mut total = Integral { probability: 0.0, albedo: vec![0.0; self.bands] };
        partition.visit_cell(cell, refinement, |directions, solid_angles| {
            let part = self.integrate(directions, solid_angles);
            total.probability += part.probability;
            total.albedo.iter_mut().zip(part.albedo).for_each(|(sum, part)| *sum += part);
        });
        total
    }
}

/// Mean and standard error of a sum and a sum of squares.
pub(super) fn mean_and_error([sum, squares]: [f64; 2], samples: f64) -> (f64, f64) {
    let mean = sum / samples;
    (mean, ((squares / samples - mean * mean).max(0.0) / samples).sqrt())
}

/// The hemispheres into which a model scatters light.
pub(super) fn hemispheres(brdf: &dyn Brdf) -> Hemispheres {
    if brdf.lobes().transmission { Hemispheres::Both } else { Hemispheres::Upper }
}
