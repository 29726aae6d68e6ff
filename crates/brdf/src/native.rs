//! Built-in models by name, as in a scene: `brdfplugin NAME  2 native MODEL  0  n numbers…`.
//!
//! The library name `native` refers to them: no file is loaded and no call crosses the plugin
//! interface. Each model is one file, which ends with its [`NativeModel`]; [`MODELS`] lists them.

use crate::Brdf;
use std::fmt::{self, Display, Formatter};
use std::sync::Arc;

pub use crate::native_model::{NativeModel, Parameter};

/// Library name of the built-in models.
pub const LIBRARY: &str = "native";

/// All built-in models.
pub const MODELS: &[NativeModel] = &[crate::lambert::MODEL, crate::minnaert::MODEL];

/// The error of a request, with its token.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ModelError {
    /// The model does not exist.
    Unknown {
        /// Name of the library.
        library: &'static str,
        /// Requested name.
        name: String,
    },
    /// The word with this index after the model's name is wrong.
    Word {
        /// Index from 0.
        index: usize,
        /// What was expected.
        message: String,
    },
    /// The number with this index is wrong.
    Number {
        /// Index from 0.
        index: usize,
        /// What was expected.
        message: String,
    },
    /// Numbers are missing, or contradict each other.
    Numbers(String),
}

impl Display for ModelError {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        match self {
            ModelError::Unknown { library, name } => write!(out, "library \"{library}\" has no model \"{name}\""),
            ModelError::Word { message, .. } | ModelError::Number { message, .. } | ModelError::Numbers(message) => {
                write!(out, "{message}")
            }
        }
    }
}

impl std::error::Error for ModelError {}

/// Makes a model from a scene's words and numbers, for one band or three.
///
/// ```
/// let matte = radsight_brdf::native::model("lambert", &[], &[0.5, 0.4, 0.3], 3);
/// assert!(matte.is_ok_and(|model| model.lobes().diffuse));
/// ```
///
/// # Errors
/// The first word or number that is wrong.
pub fn model(name: &str, words: &[String], numbers: &[f64], bands: usize) -> Result<Arc<dyn Brdf>, ModelError> {
    let unknown = || ModelError::Unknown { library: LIBRARY, name: name.to_owned() };
    let model = MODELS.iter().find(|model| model.name == name).ok_or_else(unknown)?;
    if let Some(word) = words.first() {
        let message = format!("extra word \"{word}\": model \"{name}\" takes no words");
        return Err(ModelError::Word { index: 0, message });
    }
    Ok((model.make)(&complete_numbers(name, model.parameters, numbers)?, bands))
}

/// Numbers for all parameters of a model: those given, then defaults.
///
/// # Errors
/// When a number is missing, superfluous or out of range.
pub fn complete_numbers(model: &str, parameters: &[Parameter], given: &[f64]) -> Result<Vec<f64>, ModelError> {
    let names: Vec<String> = parameters
        .iter()
        .map(|row| if row.default.is_some() { format!("[{}]", row.name) } else { row.name.to_owned() })
        .collect();
    let takes = format!("model \"{model}\" takes {}", names.join(" "));
    if let Some(extra) = given.get(parameters.len()) {
        let message = format!("extra number {extra}: {takes}");
        return Err(ModelError::Number { index: parameters.len(), message });
    }
    let mut complete = Vec::with_capacity(parameters.len());
    for (index, row) in parameters.iter().enumerate() {
        match given.get(index).copied().or(row.default) {
            Some(number) if number >= row.range[0] && number <= row.range[1] => complete.push(number),
            Some(number) => {
                let [least, most] = row.range;
                let unit = if row.unit == "1" { String::new() } else { format!(" {}", row.unit) };
                let message = format!("{} is {number}{unit}, expected at least {least} and at most {most}", row.name);
                return Err(ModelError::Number { index, message });
            }
            None => {
                let message = format!("number \"{}\" is missing: {takes}, found {}", row.name, given.len());
                return Err(ModelError::Numbers(message));
            }
        }
    }
    Ok(complete)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::{self, CheckOptions};

    /// The middle of each parameter's range.
    fn middle(model: &NativeModel) -> Vec<f64> {
        model.parameters.iter().map(|parameter| 0.5 * (parameter.range[0] + parameter.range[1])).collect()
    }

    #[test]
    fn every_model_passes_the_checks_in_the_middle_and_at_the_ends_of_its_ranges() {
        for native in MODELS {
            for end in 0..=2 {
                let numbers: Vec<f64> = match end {
                    2 => middle(native),
                    _ => native.parameters.iter().map(|parameter| parameter.range[end]).collect(),
                };
                let made = model(native.name, &[], &numbers, 3).expect("the numbers are in their ranges");
                let findings = check::all(made.as_ref(), &CheckOptions { bands: 3, ..CheckOptions::default() });
                assert!(findings.is_empty(), "{} {numbers:?}: {findings:#?}", native.name);
            }
        }
    }

    #[test]
    fn wrong_requests_name_the_token() {
        let message = |name: &str, words: &[String], numbers: &[f64]| {
            model(name, words, numbers, 1).map(|_| ()).unwrap_err().to_string()
        };
        assert_eq!(message("lambrt", &[], &[]), "library \"native\" has no model \"lambrt\"");
        assert_eq!(message("lambert", &["a".to_owned()], &[]), "extra word \"a\": model \"lambert\" takes no words");
        assert_eq!(message("lambert", &[], &[0.5, 2.0, 0.5]), "green is 2, expected at least 0 and at most 1");
        assert_eq!(
            message("lambert", &[], &[0.5]),
            "number \"green\" is missing: model \"lambert\" takes red green blue, found 1"
        );
    }
}
