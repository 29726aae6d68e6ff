//! Reflectance models of plugins.

use radsight_brdf::Brdf;
use radsight_diag::{Diagnostic, Span};
use radsight_ir::{Material, Modifier, ModifierKind, Scene};
use std::sync::Arc;

/// A request of the scene for a reflectance model.
#[derive(Clone, Copy, Debug)]
pub struct ModelRequest<'a> {
    /// Name of the material.
    pub material: &'a str,
    /// Position of the material in the scene text.
    pub span: Option<Span>,
    /// Name of the library file, without directory and suffix.
    pub library: &'a str,
    /// Name of the model in the library.
    pub model: &'a str,
    /// Remaining string arguments.
    pub words: &'a [String],
    /// Real arguments.
    pub numbers: &'a [f64],
    /// Positions of library, model, strings and numbers, in this order; empty if there are none.
    pub tokens: &'a [Span],
    /// Number of bands: one, or three for red, green and blue.
    pub bands: usize,
}

impl<'a> ModelRequest<'a> {
    /// The request of a `brdfplugin` material; `None` for another modifier.
    pub(crate) fn of(scene: &'a Scene, modifier: &'a Modifier, bands: usize) -> Option<ModelRequest<'a>> {
        let ModifierKind::Material(Material::Plugin { library, model, words, numbers, tokens }) = &modifier.kind else {
            return None;
        };
        let (material, span) = (scene.names.get(modifier.name), modifier.span);
        Some(ModelRequest { material, span, library, model, words, numbers, tokens, bands })
    }
}

/// Source of the reflectance models that a scene names.
pub trait ModelSource {
    /// The model of a `brdfplugin` primitive.
    ///
    /// # Errors
    /// The error, at the position of its token.
    fn model(&self, request: &ModelRequest<'_>) -> Result<Arc<dyn Brdf>, Diagnostic>;
}

/// A source without models.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoModels;

impl ModelSource for NoModels {
    fn model(&self, request: &ModelRequest<'_>) -> Result<Arc<dyn Brdf>, Diagnostic> {
        let ModelRequest { library, model, .. } = request;
        let error = Diagnostic::error(format!("no plugin \"{library}\" with a model \"{model}\" was found"));
        Err(match request.span {
            Some(span) => error.at(span),
            None => error,
        })
    }
}
