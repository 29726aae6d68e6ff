//! Integrals and samples of one outgoing direction, cell by cell.

use super::{CheckOptions, Effort, Hemispheres, Partition, Random};
use crate::{Brdf, BrdfSample, Density};
use glam::DVec3;

/// What a model does with one outgoing direction.
pub(super) struct Survey {
    /// Probability of each cell, by quadrature of the density.
    pub(super) probabilities: Vec<f64>,
    /// `∫ f |cos θ_i| dω_i` in each cell and band, by quadrature.
    albedos: Vec<f64>,
    /// Samples in each cell.
    pub(super) counts: Vec<f64>,
    /// How many were drawn.
    pub(super) samples: f64,
    /// Samples that were absorbed or perfectly specular.
    pub(super) elsewhere: f64,
    /// Sum and sum of squares of the weights in each band, of all samples but perfectly specular ones.
    pub(super) weights: Vec<[f64; 2]>,
    /// The same of the perfectly specular ones.
    pub(super) delta_weights: Vec<[f64; 2]>,
    bands: usize,
}

/// A sample with a density, for a closer look.
pub(super) struct Seen<'a> {
    pub(super) incident: DVec3,
    pub(super) density: f64,
    pub(super) weights: &'a [f64],
}

/// Cells whose count is this many standard deviations off the quadrature are integrated again.
const SUSPECT: f64 = 4.0;
/// So are cells with more than this share of the light or of the samples …
const NOTABLE: f64 = 5e-4;
/// … if a grid that is twice as fine differs by more than this.
const UNSTEADY: f64 = 5e-5;

impl Effort {
    /// How much finer such cells are integrated, in both directions, and how many at most, the worst first.
    fn refinement(self) -> (usize, usize) {
        match self {
            Effort::Quick => (8, 40),
            Effort::Thorough => (16, 400),
        }
    }
}

impl Survey {
    /// Integrates and draws; `look` sees each sample that has a density, with its number.
    ///
    /// Cells where the two disagree, and cells that hold much and change with the grid, are integrated again on a finer grid: a lobe
    /// that is narrow and off the mirror and retro directions may have slipped through. A real disagreement stays.
    pub(super) fn new(
        brdf: &dyn Brdf,
        outgoing: DVec3,
        options: &CheckOptions,
        stream: u64,
        samples: u32,
        mut look: impl FnMut(u32, Seen<'_>),
    ) -> Survey {
        let partition = Partition::new(outgoing, options.effort.fineness());
        let mut survey = Survey {
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
            survey.set(cell, &integral);
        });
        survey.draw(brdf, outgoing, &partition, &mut Random::new(options.seed, stream), samples, &mut look);
        let (refinement, most) = options.effort.refinement();
        for cell in survey.notable(most) {
            let finer = integrator.integrate_cell(&partition, cell, 2);
            if survey.distance(cell, &finer) > UNSTEADY {
                survey.set(cell, &integrator.integrate_cell(&partition, cell, refinement));
            }
        }
        for cell in survey.suspects(most) {
            survey.set(cell, &integrator.integrate_cell(&partition, cell, refinement));
        }
        survey
    }

    /// `∫ f |cos θ_i| dω_i` in a band.
    pub(super) fn albedo(&self, band: usize) -> f64 {
        self.albedos.iter().skip(band).step_by(self.bands).sum()
    }

    fn set(&mut self, cell: usize, integral: &Integral) {
        self.probabilities[cell] = integral.probability;
        self.albedos[cell * self.bands..][..self.bands].copy_from_slice(&integral.albedo);
    }

    /// How far a new integral is from that of the cell, in probability or albedo.
    fn distance(&self, cell: usize, integral: &Integral) -> f64 {
        let albedos = self.albedos[cell * self.bands..].iter().zip(&integral.albedo);
        let albedo = albedos.map(|(before, now)| (before - now).abs()).fold(0.0, f64::max);
        albedo.max((self.probabilities[cell] - integral.probability).abs())
    }

    /// Cells that hold much of the light or of the samples.
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
        look: &mut impl FnMut(u32, Seen<'_>),
    ) {
        let mut weights = vec![0.0; self.bands];
        for number in 0..samples {
            let sums = match brdf.sample(outgoing, random.cube(), &mut weights) {
                Some(BrdfSample { incident, density: Density::Continuous(density) }) => {
                    self.counts[partition.cell_of(incident)] += 1.0;
                    look(number, Seen { incident, density, weights: &weights });
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

/// Over a part of the sphere.
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

/// The hemispheres that a model can send light to.
pub(super) fn hemispheres(brdf: &dyn Brdf) -> Hemispheres {
    if brdf.lobes().transmission { Hemispheres::Both } else { Hemispheres::Upper }
}
