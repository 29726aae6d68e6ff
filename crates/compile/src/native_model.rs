//! Built-in models, which a scene names like those of a plugin.

use crate::model_source::{ModelRequest, ModelSource};
use radsight_brdf::{Brdf, native};
use radsight_diag::{Diagnostic, hint_nearest};
use radsight_retro::ModelError;
use std::sync::Arc;

/// Whether models of a `brdfplugin` primitive's library are built in.
#[must_use]
pub fn is_native_library(library: &str) -> bool {
    [native::LIBRARY, radsight_retro::LIBRARY].contains(&library)
}

/// The model of a `brdfplugin` primitive: built-in if its library is, otherwise from `models`.
pub(crate) fn native_or(models: &dyn ModelSource, request: &ModelRequest<'_>) -> Result<Arc<dyn Brdf>, Diagnostic> {
    let ModelRequest { model, words, numbers, bands, .. } = *request;
    let made = match request.library {
        native::LIBRARY => native::model(model, words, numbers, bands),
        radsight_retro::LIBRARY => {
            radsight_retro::model(model, words, numbers).map(|sheet| Arc::new(sheet) as Arc<dyn Brdf>)
        }
        _ => return models.model(request),
    };
    made.map_err(|error| at_token(&error, request))
}

/// The error at its token; at the model's name if a token is missing.
fn at_token(error: &ModelError, request: &ModelRequest<'_>) -> Diagnostic {
    let token = match error {
        ModelError::Word { index, .. } => 2 + index,
        ModelError::Number { index, .. } => 2 + request.words.len() + index,
        _ => 1,
    };
    let hint = match error {
        ModelError::Unknown { library: native::LIBRARY, name } => {
            hint_nearest(name, native::MODELS.iter().map(|model| model.name))
        }
        ModelError::Unknown { name, .. } => hint_nearest(name, radsight_retro::MODELS.iter().map(|model| model.name)),
        _ => None,
    };
    let diagnostic = Diagnostic::error(error.to_string()).maybe_hint(hint);
    match request.tokens.get(token).copied().or(request.span) {
        Some(span) => diagnostic.at(span),
        None => diagnostic,
    }
}
