//! Energy checks: directional albedo, and energy conservation.

use super::cell_statistics::{CellStatistics, hemispheres, mean_and_error};
use super::{CheckLevel, CheckOptions, Finding, Fineness, Partition, Worst, from_angles};
use crate::Brdf;
use glam::DVec3;

/// Directional albedo for one outgoing direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Albedo {
    /// `∫ f |cos θ_i| dω_i` in each band, by quadrature over lobes of finite width.
    pub continuous: Vec<f64>,
    /// Mean weight of perfectly specular samples in each band.
    pub delta: Vec<f64>,
    /// Largest standard error of `delta` over all bands.
    pub delta_error: f64,
}

impl Albedo {
    /// Total albedo of one band.
    #[must_use]
    pub fn total(&self, band: usize) -> f64 {
        self.continuous[band] + self.delta[band]
    }
}

impl CheckLevel {
    /// Tolerated relative error of the quadrature.
    pub(super) fn quadrature_tolerance(self) -> f64 {
        match self {
            CheckLevel::Quick => 0.03,
            CheckLevel::Thorough => 2e-3,
        }
    }

    pub(super) fn fineness(self) -> Fineness {
        match self {
            CheckLevel::Quick => {
                Fineness { core: 1e-5, rings_per_decade: 3, narrowest_sector: 0.02, sectors_per_decade: 1, nodes: 4 }
            }
            CheckLevel::Thorough => {
                Fineness { core: 1e-6, rings_per_decade: 6, narrowest_sector: 3e-4, sectors_per_decade: 2, nodes: 6 }
            }
        }
    }
}

/// Directional albedo for one outgoing direction.
#[must_use]
pub fn albedo(brdf: &dyn Brdf, outgoing: DVec3, options: &CheckOptions) -> Albedo {
    let samples = if options.level == CheckLevel::Quick { 1000 } else { 20_000 };
    let statistics = CellStatistics::new(brdf, outgoing, options, 11, samples, |_, _| ());
    let delta: Vec<(f64, f64)> =
        statistics.delta_weights.iter().map(|sums| mean_and_error(*sums, statistics.samples)).collect();
    Albedo {
        continuous: (0..options.bands).map(|band| statistics.albedo(band)).collect(),
        delta: delta.iter().map(|(mean, _)| *mean).collect(),
        delta_error: delta.iter().map(|(_, error)| *error).fold(0.0, f64::max),
    }
}

/// Largest angle from the normal for the check of reflected energy, degrees: measured data are
/// rarely reliable beyond.
const REFLECTED_UP_TO_DEG: f64 = 75.0;

/// Checks that the albedo is at most one at 0…89.9°. For a model without reciprocity it also checks
/// the energy reflected from one incident direction into all outgoing directions, up to 75°.
#[must_use]
pub fn energy(brdf: &dyn Brdf, options: &CheckOptions) -> Vec<Finding> {
    let mut worst = Worst::default();
    for &degrees in options.level.outgoing_angles_deg() {
        let outgoing = from_angles(degrees.to_radians(), 0.7);
        let found = albedo(brdf, outgoing, options);
        let allowed = 1.0 + options.level.quadrature_tolerance() + 5.0 * found.delta_error;
        for band in 0..options.bands {
            let total = found.total(band);
            if !(0.0..=allowed).contains(&total) {
                worst.offer("energy", total / allowed, || {
                    let percent = total * 100.0;
                    format!("the albedo is {percent:.2} % at outgoing angle {degrees}° in band {band}, expected at most 100 %")
                });
            }
        }
        if !options.reciprocal && degrees <= REFLECTED_UP_TO_DEG {
            offer_reflected(brdf, degrees, options, &mut worst);
        }
    }
    worst.into_findings()
}

fn offer_reflected(brdf: &dyn Brdf, degrees: f64, options: &CheckOptions, worst: &mut Worst) {
    let incident = [from_angles(degrees.to_radians(), 0.7)];
    let mut sums = vec![0.0; options.bands];
    let (mut values, mut pdf) = (vec![0.0; options.bands], [0.0]);
    // Here every direction is a call of its own.
    let fineness = Fineness { narrowest_sector: 0.02, nodes: 4, ..options.level.fineness() };
    Partition::new(incident[0], fineness).visit(hemispheres(brdf), |_, directions, solid_angles| {
        for (outgoing, solid_angle) in directions.iter().zip(solid_angles) {
            brdf.eval_pdf(*outgoing, &incident, &mut values, &mut pdf);
            for (sum, value) in sums.iter_mut().zip(&values) {
                *sum += value * outgoing.z.abs() * solid_angle;
            }
        }
    });
    let allowed = 1.0 + 5.0 * options.level.quadrature_tolerance();
    for (band, &total) in sums.iter().enumerate() {
        if !(0.0..=allowed).contains(&total) {
            worst.offer("energy", total / allowed, || {
                let percent = total * 100.0;
                format!("the model reflects {percent:.2} % of the light from incident angle {degrees}° in band {band}, expected at most 100 %")
            });
        }
    }
}
