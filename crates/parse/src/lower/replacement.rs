//! Materials replaced by models from shared libraries.

use crate::syntax::parse_real;
use radsight_diag::Span;

/// A material and the model that replaces it.
#[derive(Clone, Debug, PartialEq)]
pub struct BrdfReplacement {
    /// The material's name.
    pub material: String,
    /// File name of the library, without directory and suffix.
    pub library: String,
    /// Model in the library.
    pub model: String,
    /// String parameters of the model.
    pub words: Vec<String>,
    /// Numeric parameters of the model.
    pub numbers: Vec<f64>,
    /// Span of the directive, if it stands in a scene.
    pub span: Option<Span>,
    /// Spans of library, model, words and numbers, if they stand in a scene.
    pub tokens: Vec<Span>,
}

impl BrdfReplacement {
    /// Parses the argument of `--brdf`: `material=library:model(number,…)`. The parentheses may be
    /// omitted.
    ///
    /// # Errors
    /// A message that names the mistake.
    pub fn parse(text: &str) -> Result<Self, String> {
        let expected = "expected material=library:model(number,…)";
        let (material, rest) = text.split_once('=').ok_or_else(|| format!("\"{text}\" has no \"=\", {expected}"))?;
        let (library, rest) = rest.split_once(':').ok_or_else(|| format!("\"{text}\" has no \":\", {expected}"))?;
        let (model, parameters) = match rest.split_once('(') {
            Some((model, list)) => {
                let list = list.strip_suffix(')').ok_or_else(|| format!("\"{text}\" does not end with \")\""))?;
                (model, list)
            }
            None => (rest, ""),
        };
        if [material, library, model].iter().any(|part| part.trim().is_empty()) {
            return Err(format!("\"{text}\" lacks a name, {expected}"));
        }
        let parameters = parameters.split(',').map(str::trim).filter(|word| !word.is_empty());
        Self::from_words([material, library, model].map(str::trim).into_iter().chain(parameters))
    }

    /// Parses `material library model`, string parameters, and numbers.
    ///
    /// # Errors
    /// A message that names the mistake.
    pub(crate) fn from_words<'a>(mut all: impl Iterator<Item = &'a str>) -> Result<Self, String> {
        let mut next = |what: &str| all.next().map(str::to_owned).ok_or_else(|| format!("missing {what}"));
        let (material, library, model) = (next("material")?, next("library")?, next("model")?);
        let (mut words, mut numbers) = (Vec::new(), Vec::new());
        for word in all {
            match parse_real(word.as_bytes()) {
                Some(number) if number.is_finite() => numbers.push(number),
                Some(_) => return Err(format!("number \"{word}\" is too large")),
                None if numbers.is_empty() => words.push(word.to_owned()),
                None => return Err(format!("expected a number, found \"{word}\"")),
            }
        }
        Ok(BrdfReplacement { material, library, model, words, numbers, span: None, tokens: Vec::new() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_option_is_read() {
        let read = BrdfReplacement::parse("sheeting=retrosheet:bead_sheet(.086, .00612,1.5)").unwrap();
        assert_eq!((&*read.material, &*read.library, &*read.model), ("sheeting", "retrosheet", "bead_sheet"));
        assert_eq!(read.numbers, [0.086, 0.006_12, 1.5]);
        assert_eq!(BrdfReplacement::parse("a=b:c").unwrap().numbers, [0.0; 0]);
        assert_eq!(BrdfReplacement::parse("a=b:c(d,1)").unwrap().words, ["d"]);
    }

    #[test]
    fn a_wrong_option_says_what_is_wrong() {
        for (text, expected) in [
            ("a", "\"a\" has no \"=\", expected material=library:model(number,…)"),
            ("a=b", "\"a=b\" has no \":\", expected material=library:model(number,…)"),
            ("a=b:c(1", "\"a=b:c(1\" does not end with \")\""),
            ("a=b:c(1,x)", "expected a number, found \"x\""),
            ("=b:c", "\"=b:c\" lacks a name, expected material=library:model(number,…)"),
        ] {
            assert_eq!(BrdfReplacement::parse(text).unwrap_err(), expected);
        }
    }
}
