//! Statistical checks that every model must pass, built in or plugin.
//!
//! Each check returns [`Finding`]s, worst first; an empty list means that the model passed. The
//! result is a function of the model and of [`CheckOptions::seed`]. Integrals and counts use cells
//! that are logarithmic in the angles to the mirror and the retro direction ([`Partition`]), so
//! that a lobe of a thousandth of a degree is detected.
//!
//! ```
//! use radsight_brdf::{Lambert, check};
//! let honest = Lambert { reflectance: [0.8] };
//! let options = check::CheckOptions { bands: 1, ..Default::default() };
//! assert!(check::all(&honest, &options).is_empty());
//! let bright = Lambert { reflectance: [1.3] };
//! let findings = check::all(&bright, &options);
//! assert!(findings[0].message.contains("130"), "{}", findings[0].message);
//! ```

mod cell_statistics;
mod chi_squared;
mod energy;
mod finite;
mod partition;
mod purity;
mod random;
mod reciprocity;

pub use chi_squared::sampling;
pub use energy::{Albedo, albedo, energy};
pub use finite::finite;
pub use partition::{Fineness, Hemispheres, Partition};
pub use purity::{isotropy, purity};
pub use random::Random;
pub use reciprocity::reciprocity;

use crate::Brdf;
use glam::DVec3;

/// Options of the checks.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckOptions {
    /// Number of bands of the model.
    pub bands: usize,
    /// Seed of all random numbers.
    pub seed: u64,
    /// How thoroughly to check.
    pub level: CheckLevel,
    /// Whether `f(o, i) = f(i, o)` must hold.
    pub reciprocal: bool,
    /// Whether the value may depend only on the azimuth between the directions.
    pub isotropic: bool,
}

impl Default for CheckOptions {
    fn default() -> Self {
        CheckOptions { bands: 1, seed: 1, level: CheckLevel::Thorough, reciprocal: true, isotropic: true }
    }
}

/// How thoroughly a check tests a model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CheckLevel {
    /// A few milliseconds: before every use.
    Quick,
    /// Seconds: for a new model.
    #[default]
    Thorough,
}

impl CheckLevel {
    /// Tested angles between the outgoing direction and the normal, degrees.
    #[must_use]
    pub fn outgoing_angles_deg(self) -> &'static [f64] {
        match self {
            CheckLevel::Quick => &[0.0, 45.0, 75.0, 85.0],
            CheckLevel::Thorough => &[0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 85.0, 89.0, 89.9],
        }
    }
}

/// A violated requirement.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Name of the check.
    pub check: &'static str,
    /// Message with angles and value, in lower case, without a full stop.
    pub message: String,
    /// Deviation as a multiple of the tolerance, at least 1.
    pub severity: f64,
}

/// Type of a check.
pub type Check = fn(&dyn Brdf, &CheckOptions) -> Vec<Finding>;

/// Runs all checks.
#[must_use]
pub fn all(brdf: &dyn Brdf, options: &CheckOptions) -> Vec<Finding> {
    let mut findings = finite(brdf, options);
    findings.extend(purity(brdf, options));
    findings.extend(isotropy(brdf, options));
    findings.extend(reciprocity(brdf, options));
    findings.extend(energy(brdf, options));
    findings.extend(sampling(brdf, options));
    findings
}

/// Keeps the worst finding of a kind and counts the others.
#[derive(Debug, Default)]
struct Worst {
    finding: Option<Finding>,
    others: usize,
}

impl Worst {
    /// `message` is built only for the worst finding so far.
    fn offer(&mut self, check: &'static str, severity: f64, message: impl FnOnce() -> String) {
        let severity = if severity.is_nan() { f64::INFINITY } else { severity };
        if self.finding.as_ref().is_none_or(|finding| severity > finding.severity) {
            self.others += usize::from(self.finding.is_some());
            self.finding = Some(Finding { check, message: message(), severity });
        } else {
            self.others += 1;
        }
    }

    fn into_findings(self) -> Vec<Finding> {
        let others = self.others;
        let add_count = |mut finding: Finding| {
            if others > 0 {
                finding.message += &format!(" (and {others} more)");
            }
            finding
        };
        self.finding.map(add_count).into_iter().collect()
    }
}

/// Evaluates a single pair of directions.
fn evaluate(brdf: &dyn Brdf, bands: usize, outgoing: DVec3, incident: DVec3) -> (Vec<f64>, f64) {
    let (mut values, mut pdf) = (vec![f64::NAN; bands], [f64::NAN]);
    brdf.eval_pdf(outgoing, &[incident], &mut values, &mut pdf);
    (values, pdf[0])
}

/// Direction at `polar` from the normal and `azimuth` from x, radians.
fn from_angles(polar: f64, azimuth: f64) -> DVec3 {
    let ((sin_polar, cos_polar), (sin, cos)) = (polar.sin_cos(), azimuth.sin_cos());
    DVec3::new(sin_polar * cos, sin_polar * sin, cos_polar)
}

/// Unit vector at `polar` from `axis`, at `azimuth` about it, radians.
fn direction_near(axis: DVec3, polar: f64, azimuth: f64) -> DVec3 {
    let (x, y) = axis.any_orthonormal_pair();
    let ((sin_polar, cos_polar), (sin, cos)) = (polar.sin_cos(), azimuth.sin_cos());
    ((x * cos + y * sin) * sin_polar + axis * cos_polar).normalize()
}

/// Both directions in degrees, for messages.
fn angles_text(outgoing: DVec3, incident: DVec3) -> String {
    let polar = |d: DVec3| d.x.hypot(d.y).atan2(d.z).to_degrees();
    let azimuth = (incident.y.atan2(incident.x) - outgoing.y.atan2(outgoing.x)).rem_euclid(std::f64::consts::TAU);
    format!(
        "outgoing angle {:.4}°, incident angle {:.4}°, azimuth between them {:.4}°",
        polar(outgoing),
        polar(incident),
        azimuth.to_degrees()
    )
}

#[cfg(test)]
mod tests;
