//! Built-in retroreflectors, which a scene names like those of a plugin.

use crate::model_source::{ModelRequest, ModelSource};
use radsight_brdf::Brdf;
use radsight_diag::{Diagnostic, hint_nearest};
use radsight_retro::{LIBRARY, MODELS, ModelError};
use std::sync::Arc;

/// The model of a `brdfplugin` primitive: built-in if the library is [`LIBRARY`], otherwise from
/// `models`.
pub(crate) fn native_or(models: &dyn ModelSource, request: &ModelRequest<'_>) -> Result<Arc<dyn Brdf>, Diagnostic> {
    if request.library != LIBRARY {
        return models.model(request);
    }
    let made = radsight_retro::model(request.model, request.words, request.numbers);
    made.map(|sheet| Arc::new(sheet) as Arc<dyn Brdf>).map_err(|error| at_token(&error, request))
}

/// The error at its token; at the model's name if a token is missing.
fn at_token(error: &ModelError, request: &ModelRequest<'_>) -> Diagnostic {
    let token = match error {
        ModelError::Word { index, .. } => 2 + index,
        ModelError::Number { index, .. } => 2 + request.words.len() + index,
        _ => 1,
    };
    let hint = match error {
        ModelError::Unknown { name } => hint_nearest(name, MODELS.iter().map(|model| model.name)),
        _ => None,
    };
    let diagnostic = Diagnostic::error(error.to_string()).maybe_hint(hint);
    match request.tokens.get(token).copied().or(request.span) {
        Some(span) => diagnostic.at(span),
        None => diagnostic,
    }
}
