//! The built-in models pass, and the right check reports each defect.

use super::*;
use crate::{
    AshikhminShirley, BrdfSample, Density, GaussianTransmission, Lambert, Lobes, WardAnisotropic, WardIsotropic,
};
use std::f64::consts::{PI, TAU};

fn options(bands: usize) -> CheckOptions {
    CheckOptions { bands, ..CheckOptions::default() }
}

fn messages(findings: &[Finding]) -> Vec<&str> {
    findings.iter().map(|finding| finding.message.as_str()).collect()
}

#[test]
fn lambert_passes() {
    let findings = all(&Lambert { reflectance: [0.9, 0.5, 1.0] }, &options(3));
    assert!(findings.is_empty(), "{findings:#?}");
}

#[test]
fn wards_highlight_passes_at_every_width() {
    for roughness in [0.0005, 0.006, 0.05, 0.2, 0.5] {
        let findings = all(&WardIsotropic { specularity: [0.9], roughness }, &options(1));
        assert!(findings.is_empty(), "roughness {roughness}: {findings:#?}");
    }
}

#[test]
fn wards_anisotropic_highlight_passes_at_every_width() {
    for roughness in [[0.0005, 0.006], [0.05, 0.05], [0.3, 0.05], [0.5, 0.2]] {
        let model = WardAnisotropic { specularity: [0.9], roughness };
        let findings = all(&model, &CheckOptions { isotropic: false, ..options(1) });
        assert!(findings.is_empty(), "roughness {roughness:?}: {findings:#?}");
    }
}

#[test]
fn ashikhmins_highlight_passes_with_every_exponent() {
    for exponents in [[0.0, 0.0], [5.0, 500.0], [100.0, 100.0], [1e6, 1e4]] {
        let model = AshikhminShirley { specularity: [0.9], exponents };
        let findings = all(&model, &CheckOptions { isotropic: false, ..options(1) });
        assert!(findings.is_empty(), "exponents {exponents:?}: {findings:#?}");
    }
}

/// Energy is not checked: towards grazing incidence the root of the cosines makes this model gain
/// energy, as in Radiance.
#[test]
fn scattered_transmission_is_sampled_with_its_density() {
    for roughness in [[0.001, 0.001], [0.05, 0.05], [0.3, 0.3], [0.05, 0.2], [0.5, 0.1]] {
        let model = GaussianTransmission { transmittance: [0.9], roughness };
        let options = CheckOptions { isotropic: false, ..options(1) };
        let mut findings = finite(&model, &options);
        findings.extend(purity(&model, &options));
        findings.extend(sampling(&model, &options));
        assert!(findings.is_empty(), "roughness {roughness:?}: {findings:#?}");
    }
}

#[test]
fn albedo_of_lambert_is_its_reflectance_at_every_angle() {
    let model = Lambert { reflectance: [0.25, 0.75] };
    for degrees in [0.0f64, 60.0, 89.9] {
        let found = albedo(&model, from_angles(degrees.to_radians(), 1.0), &options(2));
        assert!((found.total(0) - 0.25).abs() < 1e-5 && (found.total(1) - 0.75).abs() < 1e-5, "{degrees}°: {found:?}");
    }
}

/// Lambert's model with one defect.
#[derive(Debug)]
enum Defect {
    /// Reflects 1.3 times the light.
    Gains,
    /// Samples uniformly, but returns the cosine's density.
    WrongDensity,
    /// Returns a wrong weight.
    WrongWeight,
    /// Depends on the incident angle only.
    OneWay,
    /// Is not a number at grazing incidence.
    Grazing,
    /// Depends on the azimuth.
    Brushed,
    /// Has a narrow retro lobe of the given width (radians) that its sampling ignores.
    HiddenLobe(f64),
    /// Transmits without declaring it.
    Leaks,
}

impl Defect {
    fn value(&self, outgoing: DVec3, incident: DVec3) -> f64 {
        let lambert = 0.5 / PI;
        match self {
            Defect::Gains => 1.3 / PI,
            Defect::OneWay => lambert * incident.z,
            Defect::Grazing if incident.z < 0.01 => f64::NAN,
            Defect::Brushed => lambert * (1.0 + 0.5 * incident.x),
            Defect::HiddenLobe(width) => {
                let angle = 2.0 * ((outgoing - incident).length() / 2.0).asin();
                lambert + 0.2 * (-(angle / width).powi(2)).exp() / (PI * width * width)
            }
            _ => lambert,
        }
    }
}

impl Brdf for Defect {
    fn lobes(&self) -> Lobes {
        Lobes { diffuse: true, ..Lobes::default() }
    }

    fn eval_pdf(&self, outgoing: DVec3, incident: &[DVec3], values: &mut [f64], pdfs: &mut [f64]) {
        for ((direction, value), pdf) in incident.iter().zip(values).zip(pdfs) {
            let lit = (outgoing.z > 0.0 && direction.z > 0.0) || matches!(self, Defect::Leaks);
            *value = if lit { self.value(outgoing, *direction) } else { 0.0 };
            *pdf = if outgoing.z > 0.0 { direction.z.max(0.0) / PI } else { 0.0 };
        }
    }

    fn sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> Option<BrdfSample> {
        let z = if matches!(self, Defect::WrongDensity) { 1.0 - u[0] } else { (1.0 - u[0]).sqrt() };
        let incident = from_angles(z.acos(), TAU * u[1]);
        if outgoing.z <= 0.0 || incident.z <= 0.0 {
            return None;
        }
        weights[0] = self.value(outgoing, incident) * PI * if matches!(self, Defect::WrongWeight) { 0.9 } else { 1.0 };
        Some(BrdfSample { incident, density: Density::Continuous(incident.z / PI) })
    }
}

#[test]
fn a_model_that_gains_energy_is_caught() {
    let findings = energy(&Defect::Gains, &options(1));
    assert_eq!(
        messages(&findings),
        ["the albedo is 130.00 % at outgoing angle 0° in band 0, expected at most 100 % (and 8 more)"]
    );
}

#[test]
fn a_wrong_density_is_caught() {
    let findings = sampling(&Defect::WrongDensity, &options(1));
    assert!(findings.iter().any(|f| f.message.starts_with("samples do not have the density")), "{findings:#?}");
}

#[test]
fn a_wrong_weight_is_caught() {
    let findings = sampling(&Defect::WrongWeight, &options(1));
    assert!(findings[0].message.starts_with("the weight of a sample is 4.5"), "{findings:#?}");
}

#[test]
fn a_one_way_model_is_caught_only_if_it_claims_reciprocity() {
    assert_eq!(reciprocity(&Defect::OneWay, &options(1)).len(), 1);
    assert!(reciprocity(&Defect::OneWay, &CheckOptions { reciprocal: false, ..options(1) }).is_empty());
}

#[test]
fn nan_at_grazing_incidence_is_caught() {
    let findings = finite(&Defect::Grazing, &options(1));
    assert!(findings[0].message.starts_with("value NaN at outgoing angle"), "{findings:#?}");
}

#[test]
fn dependence_on_azimuth_is_caught() {
    assert_eq!(isotropy(&Defect::Brushed, &options(1)).len(), 1);
}

#[test]
fn a_lobe_that_sampling_misses_is_caught_however_narrow() {
    for degrees in [0.2f64, 0.01, 0.001] {
        let findings = sampling(&Defect::HiddenLobe(degrees.to_radians()), &options(1));
        assert!(
            findings.iter().any(|f| f.message.starts_with("the mean weight of samples is 0.5")),
            "{degrees}°: {findings:#?}"
        );
    }
}

#[test]
fn light_on_the_other_side_needs_to_be_declared() {
    let findings = finite(&Defect::Leaks, &options(1));
    assert!(findings[0].message.contains("declares no transmission"), "{findings:#?}");
}
