//! Custom materials without a shared library.

use radsight_brdf::Brdf;
use radsight_diag::Diagnostic;
use radsight_parse::BrdfReplacement;
use radsight_render::{ModelRequest, ModelSource, NoModels};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A reflectance model: values (1/sr, without the cosine), densities (1/sr) and samples. Directions
/// are in a local frame with +z along the shading normal and point away from the surface.
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
            Some(model) if request.library == IN_PROCESS => Ok(model.clone()),
            // A shared library named in the scene is foreign code. Library users pass models as
            // objects.
            _ => NoModels.model(request),
        }
    }
}
