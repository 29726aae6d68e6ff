//! Reflectance models from elsewhere.

use radsight_brdf::Brdf;
use radsight_diag::{Diagnostic, Span};
use std::sync::Arc;

/// A reflectance model that a scene asks for.
#[derive(Clone, Copy, Debug)]
pub struct ModelRequest<'a> {
    /// Name of the material.
    pub material: &'a str,
    /// Where the material stands.
    pub span: Option<Span>,
    /// File name of the library, without directory and suffix.
    pub library: &'a str,
    /// Model in the library.
    pub model: &'a str,
    /// Further words.
    pub words: &'a [String],
    /// Parameters.
    pub numbers: &'a [f64],
    /// Where library, model, words and numbers stand, one after the other; empty where they stand nowhere.
    pub tokens: &'a [Span],
    /// One, or red, green and blue.
    pub bands: usize,
}

/// Where the reflectance models that a scene names come from.
pub trait ModelSource {
    /// The model of a `brdfplugin` primitive.
    ///
    /// # Errors
    /// What is wrong, at its token.
    fn model(&self, request: &ModelRequest<'_>) -> Result<Arc<dyn Brdf>, Diagnostic>;
}

/// Knows no model.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoModels;

impl ModelSource for NoModels {
    fn model(&self, request: &ModelRequest<'_>) -> Result<Arc<dyn Brdf>, Diagnostic> {
        let ModelRequest { library, model, .. } = request;
        let error = Diagnostic::error(format!("no plugin \"{library}\" with a model \"{model}\" is at hand"));
        Err(match request.span {
            Some(span) => error.at(span),
            None => error,
        })
    }
}
