//! Custom materials without a shared library.

use glam::DVec3;
use radsight_brdf::{Brdf, BrdfSample, Density, Lobes};
use radsight_diag::Diagnostic;
use radsight_parse::BrdfReplacement;
use radsight_render::{ModelRequest, ModelSource, NoModels};
use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

/// A reflectance model: values (1/sr, without the cosine), densities (1/sr) and samples. Directions
/// are in a local frame with +z along the shading normal and point away from the surface. A number
/// that is not finite or is negative is [`Error::Material`](crate::Error::Material).
pub use radsight_brdf::Brdf as Material;

/// Library name of models given as objects.
const IN_PROCESS: &str = "in process";

/// The models that replace materials of a scene, by material name.
#[derive(Clone, Debug, Default)]
pub(crate) struct Materials(BTreeMap<String, Arc<dyn Brdf>>);

impl Materials {
    pub(crate) fn insert(&mut self, material: &str, model: Arc<dyn Brdf>) {
        self.0.insert(material.to_owned(), model);
    }

    /// The replacements for the parser.
    pub(crate) fn replacements(&self) -> Vec<BrdfReplacement> {
        let replacement = |material: &String| BrdfReplacement {
            material: material.clone(),
            library: IN_PROCESS.to_owned(),
            model: material.clone(),
            words: Vec::new(),
            numbers: Vec::new(),
            span: None,
            tokens: Vec::new(),
        };
        self.0.keys().map(replacement).collect()
    }
}

impl ModelSource for Materials {
    fn model(&self, request: &ModelRequest<'_>) -> Result<Arc<dyn Brdf>, Diagnostic> {
        match self.0.get(request.model) {
            Some(model) if request.library == IN_PROCESS => {
                let (material, model) = (request.material.to_owned(), model.clone());
                Ok(Arc::new(CheckedModel { material, model, fault: OnceLock::new() }))
            }
            // A shared library named in the scene is foreign code. Library users pass models as
            // objects.
            _ => NoModels.model(request),
        }
    }
}

/// Negative numbers down to this are rounding errors of zero, 1/sr.
const ROUNDING: f64 = -1e-9;

/// Tolerance of the squared length of a sampled direction.
const UNIT_TOLERANCE: f64 = 1e-6;

/// A custom model whose numbers are checked. A wrong one counts as zero, and the picture is invalid.
#[derive(Debug)]
struct CheckedModel {
    material: String,
    model: Arc<dyn Brdf>,
    /// The first mistake.
    fault: OnceLock<String>,
}

impl CheckedModel {
    /// The number, or 0 for a wrong one.
    fn sound(&self, what: &str, number: f64, outgoing: DVec3, incident: DVec3) -> f64 {
        match number {
            0.0..=f64::MAX => number,
            ROUNDING..=0.0 => 0.0,
            _ => {
                self.mistake(&format!("{what} {number}, expected a finite number of 0 or more"), outgoing, incident);
                0.0
            }
        }
    }

    #[cold]
    fn mistake(&self, what: &str, outgoing: DVec3, incident: DVec3) {
        self.fault.get_or_init(|| {
            format!(
                "material \"{}\" gave the {what}; outgoing direction {outgoing:.6}, incident {incident:.6}",
                self.material
            )
        });
    }
}

impl Brdf for CheckedModel {
    fn lobes(&self) -> Lobes {
        self.model.lobes()
    }

    fn eval_pdf(&self, outgoing: DVec3, incident: &[DVec3], values: &mut [f64], pdfs: &mut [f64]) {
        // What a model does not write is zero.
        values.fill(0.0);
        pdfs.fill(0.0);
        self.model.eval_pdf(outgoing, incident, values, pdfs);
        let bands = values.len() / incident.len().max(1);
        for (index, value) in values.iter_mut().enumerate() {
            *value = self.sound("value", *value, outgoing, incident[index / bands]);
        }
        for (pdf, incident) in pdfs.iter_mut().zip(incident) {
            *pdf = self.sound("density", *pdf, outgoing, *incident);
        }
    }

    fn sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> Option<BrdfSample> {
        weights.fill(0.0);
        let sampled = self.model.sample(outgoing, u, weights)?;
        let incident = sampled.incident;
        let is_unit = (incident.length_squared() - 1.0).abs() < UNIT_TOLERANCE;
        if !is_unit {
            self.mistake("sampled direction below, expected a unit vector", outgoing, incident);
            return None;
        }
        if let Density::Continuous(pdf) = sampled.density
            && (pdf == 0.0 || !(0.0..=f64::MAX).contains(&pdf))
        {
            self.mistake(&format!("density {pdf} of a sample, expected a finite number above 0"), outgoing, incident);
            return None;
        }
        for weight in weights {
            *weight = self.sound("weight", *weight, outgoing, incident);
        }
        Some(sampled)
    }

    fn fault(&self) -> Option<String> {
        self.fault.get().cloned().or_else(|| self.model.fault())
    }
}
