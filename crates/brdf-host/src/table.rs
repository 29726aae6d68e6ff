//! Parameter tables of models, and the check of a scene's words and numbers against them.

use crate::Error;
use radsight_brdf_abi::{Band, flags, parameter_flags};
use radsight_diag::hint_nearest;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A token of the primitive `void brdfplugin NAME  n LIBRARY MODEL words…  0  m numbers…`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Token {
    /// The library's name.
    Library,
    /// The model's name.
    Model,
    /// The word with this index, from 0, after library and model.
    Word(usize),
    /// The number with this index, from 0.
    Number(usize),
    /// The list of words as a whole, if one is missing.
    Words,
    /// The list of numbers as a whole, if one is missing.
    Numbers,
}

/// Description of a model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelInfo {
    /// Name in a scene.
    pub name: String,
    /// Description in one line.
    pub summary: String,
    /// Source of the formulas; may be empty.
    pub citation: String,
    /// Combination of [`radsight_brdf_abi::flags`].
    pub flags: u32,
    /// Parameters of the model.
    pub parameters: Vec<ParameterInfo>,
}

/// Description of a parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParameterInfo {
    /// Name, for messages.
    pub name: String,
    /// Unit, such as "rad"; may be empty.
    pub unit: String,
    /// Description in one sentence.
    pub doc: String,
    /// Kind of token in a scene.
    pub kind: ParameterKind,
    /// Whether it may be omitted.
    pub optional: bool,
    /// Default of an optional number; of a spectrum, in each band.
    #[serde(with = "crate::isolate::bits")]
    pub default_number: f64,
    /// Default of an optional word.
    pub default_word: String,
    /// Range of a number.
    pub range: Range,
}

/// Kind of token that a scene uses for a parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ParameterKind {
    /// One number.
    Number,
    /// One number without a fraction.
    Integer,
    /// Three numbers: red, green, blue.
    Spectrum,
    /// One word.
    Word,
    /// One word of these.
    Choice(Vec<String>),
    /// One word that names a file.
    File,
}

/// A range of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Range {
    /// Minimum; −∞ if there is none.
    #[serde(with = "crate::isolate::bits")]
    pub minimum: f64,
    /// Maximum; ∞ if there is none.
    #[serde(with = "crate::isolate::bits")]
    pub maximum: f64,
    /// Combination of [`radsight_brdf_abi::parameter_flags`].
    pub flags: u32,
}

impl Range {
    fn holds(&self, number: f64) -> bool {
        let above =
            number > self.minimum || (number == self.minimum && self.flags & parameter_flags::ABOVE_MINIMUM == 0);
        let below =
            number < self.maximum || (number == self.maximum && self.flags & parameter_flags::BELOW_MAXIMUM == 0);
        number.is_finite() && above && below
    }
}

impl std::fmt::Display for Range {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let least = if self.flags & parameter_flags::ABOVE_MINIMUM == 0 { "at least" } else { "above" };
        let most = if self.flags & parameter_flags::BELOW_MAXIMUM == 0 { "at most" } else { "below" };
        match (self.minimum.is_finite(), self.maximum.is_finite()) {
            (true, true) => write!(out, "{least} {} and {most} {}", self.minimum, self.maximum),
            (true, false) => write!(out, "{least} {}", self.minimum),
            (false, true) => write!(out, "{most} {}", self.maximum),
            (false, false) => write!(out, "a finite number"),
        }
    }
}

impl ParameterInfo {
    /// Number of real arguments that a scene needs for it.
    #[must_use]
    pub fn scene_numbers(&self) -> usize {
        match self.kind {
            ParameterKind::Number | ParameterKind::Integer => 1,
            ParameterKind::Spectrum => 3,
            _ => 0,
        }
    }

    fn is_word(&self) -> bool {
        self.scene_numbers() == 0
    }
}

/// Arguments of `create`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Arguments {
    /// One entry for each number, one for each band of a spectrum.
    #[serde(with = "crate::isolate::bit_list")]
    pub(crate) numbers: Vec<f64>,
    pub(crate) words: Vec<String>,
}

impl ModelInfo {
    /// Arguments for an index that no model has.
    pub(crate) fn unknown() -> Self {
        ModelInfo {
            name: "?".to_owned(),
            summary: String::new(),
            citation: String::new(),
            flags: 0,
            parameters: Vec::new(),
        }
    }

    /// Whether the model declares reciprocity.
    #[must_use]
    pub fn claims_reciprocity(&self) -> bool {
        self.flags & flags::RECIPROCAL != 0
    }

    /// Usage of the primitive, such as `brdfplugin NAME  2 retrosheet bead_sheet  0  3 rho_s alpha
    /// index`.
    #[must_use]
    pub fn usage(&self, library: &str) -> String {
        let of = |words: bool| -> Vec<String> {
            self.parameters.iter().filter(|row| row.is_word() == words).flat_map(ParameterInfo::usage).collect()
        };
        let (words, numbers) = (of(true), of(false));
        let listed = |items: &[String]| items.iter().map(|item| format!(" {item}")).collect::<String>();
        format!(
            "brdfplugin NAME  {} {library} {}{}  0  {}{}",
            words.len() + 2,
            self.name,
            listed(&words),
            numbers.len(),
            listed(&numbers)
        )
    }

    /// Checks a scene's words and numbers against the table, and adds the defaults.
    ///
    /// # Errors
    /// The first argument that does not fit, with its token.
    pub(crate) fn arguments(
        &self,
        words: &[String],
        numbers: &[f64],
        bands: &[Band],
        folder: Option<&Path>,
    ) -> Result<Arguments, Error> {
        Ok(Arguments { words: self.complete_words(words, folder)?, numbers: self.complete_numbers(numbers, bands)? })
    }

    fn complete_words(&self, given: &[String], folder: Option<&Path>) -> Result<Vec<String>, Error> {
        let rows: Vec<&ParameterInfo> = self.parameters.iter().filter(|row| row.is_word()).collect();
        if given.len() > rows.len() {
            return self.too_many(Token::Word(rows.len()), "word", &given[rows.len()], &rows);
        }
        let mut complete = Vec::with_capacity(rows.len());
        for (index, row) in rows.iter().enumerate() {
            match given.get(index) {
                Some(word) => complete.push(row.check_word(word, Token::Word(index), folder)?),
                None if row.optional => complete.push(row.default_word.clone()),
                None => return self.missing(Token::Words, "word", row, &rows, given.len()),
            }
        }
        Ok(complete)
    }

    fn complete_numbers(&self, given: &[f64], bands: &[Band]) -> Result<Vec<f64>, Error> {
        let rows: Vec<&ParameterInfo> = self.parameters.iter().filter(|row| !row.is_word()).collect();
        let mut complete = Vec::new();
        let mut next = 0;
        for row in &rows {
            let wanted = row.scene_numbers();
            let found = &given[next.min(given.len())..(next + wanted).min(given.len())];
            for (index, number) in found.iter().enumerate() {
                row.check_number(*number, Token::Number(next + index))?;
            }
            match *found {
                [] if row.optional => complete.extend(vec![row.default_number; row.band_numbers(bands)]),
                [red, green, blue] if wanted == 3 => complete.extend(spectrum_in_bands([red, green, blue], bands)),
                [number] if wanted == 1 => complete.push(number),
                _ => return self.missing(Token::Numbers, "number", row, &rows, given.len()),
            }
            next += wanted;
        }
        match given.get(next) {
            Some(extra) => self.too_many(Token::Number(next), "number", &extra.to_string(), &rows),
            None => Ok(complete),
        }
    }

    fn too_many<T>(&self, token: Token, what: &str, extra: &str, rows: &[&ParameterInfo]) -> Result<T, Error> {
        let message = match rows {
            [] => format!("extra {what} {extra}: model \"{}\" takes no {what}s", self.name),
            _ => format!("extra {what} {extra}: model \"{}\" takes {}", self.name, row_list(rows)),
        };
        Err(Error::Parameter { token, message, hint: None })
    }

    fn missing<T>(
        &self,
        token: Token,
        what: &str,
        row: &ParameterInfo,
        rows: &[&ParameterInfo],
        found: usize,
    ) -> Result<T, Error> {
        let message = format!(
            "{what} \"{}\" is missing: model \"{}\" takes {}, found {found}",
            row.name,
            self.name,
            row_list(rows)
        );
        Err(Error::Parameter {
            token,
            message,
            hint: (!row.doc.is_empty()).then(|| format!("{}: {}", row.name, row.doc)),
        })
    }
}

fn row_list(rows: &[&ParameterInfo]) -> String {
    let names: Vec<String> = rows.iter().flat_map(|row| row.usage()).collect();
    names.join(" ")
}

impl ParameterInfo {
    /// Tokens of the parameter in a scene; optional ones in brackets.
    fn usage(&self) -> Vec<String> {
        let dress = |name: String| if self.optional { format!("[{name}]") } else { name };
        match self.kind {
            ParameterKind::Spectrum => {
                ["red", "green", "blue"].iter().map(|band| dress(format!("{}.{band}", self.name))).collect()
            }
            _ => vec![dress(self.name.clone())],
        }
    }

    fn band_numbers(&self, bands: &[Band]) -> usize {
        if self.kind == ParameterKind::Spectrum { bands.len() } else { 1 }
    }

    fn check_number(&self, number: f64, token: Token) -> Result<(), Error> {
        let unit = if self.unit.is_empty() || self.unit == "1" { String::new() } else { format!(" {}", self.unit) };
        let wrong = |expected: String| {
            let message = format!("{} is {number}{unit}, expected {expected}", self.name);
            Err(Error::Parameter {
                token,
                message,
                hint: (!self.doc.is_empty()).then(|| format!("{}: {}", self.name, self.doc)),
            })
        };
        if !self.range.holds(number) {
            return wrong(self.range.to_string());
        }
        if self.kind == ParameterKind::Integer && number.fract() != 0.0 {
            return wrong("a whole number".to_owned());
        }
        Ok(())
    }

    fn check_word(&self, word: &str, token: Token, folder: Option<&Path>) -> Result<String, Error> {
        let wrong = |message: String, hint| Err(Error::Parameter { token, message, hint });
        if word.contains('\0') {
            return wrong(format!("{} contains a zero byte", self.name), None);
        }
        match &self.kind {
            ParameterKind::Choice(choices) if !choices.iter().any(|choice| choice == word) => {
                let hint = hint_nearest(word, choices.iter().map(String::as_str));
                wrong(format!("{} is \"{word}\", expected one of {}", self.name, choices.join(", ")), hint)
            }
            ParameterKind::File => {
                let beside = folder.map(|folder| folder.join(word)).filter(|path| path.is_file());
                Ok(beside.and_then(|path| path.to_str().map(str::to_owned)).unwrap_or_else(|| word.to_owned()))
            }
            _ => Ok(word.to_owned()),
        }
    }
}

/// A scene's colour in the bands of a rendering. Three bands are red, green and blue; otherwise
/// each band takes the component in whose part of the spectrum its centre lies, with the limits of
/// Radiance 6.
fn spectrum_in_bands(colour: [f64; 3], bands: &[Band]) -> Vec<f64> {
    const RED_FROM_M: f64 = 588e-9;
    const GREEN_FROM_M: f64 = 480e-9;
    if bands.len() == 3 {
        return colour.to_vec();
    }
    let pick = |band: &Band| match band.centre_m {
        centre if centre >= RED_FROM_M => colour[0],
        centre if centre >= GREEN_FROM_M => colour[1],
        _ => colour[2],
    };
    bands.iter().map(pick).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(name: &str, kind: ParameterKind, minimum: f64, maximum: f64, flags: u32) -> ParameterInfo {
        ParameterInfo {
            name: name.to_owned(),
            unit: "1".to_owned(),
            doc: String::new(),
            kind,
            optional: false,
            default_number: 0.0,
            default_word: String::new(),
            range: Range { minimum, maximum, flags },
        }
    }

    fn model() -> ModelInfo {
        let metals = ParameterKind::Choice(vec!["steel".to_owned(), "copper".to_owned()]);
        let mut layers = row("layers", ParameterKind::Integer, 1.0, 9.0, 0);
        layers.optional = true;
        layers.default_number = 2.0;
        ModelInfo {
            name: "m".to_owned(),
            summary: String::new(),
            citation: String::new(),
            flags: 0,
            parameters: vec![
                row("metal", metals, 0.0, 0.0, 0),
                row("colour", ParameterKind::Spectrum, 0.0, 1.0, 0),
                row("roughness", ParameterKind::Number, 0.0, 1.0, parameter_flags::ABOVE_MINIMUM),
                layers,
            ],
        }
    }

    const GREEN_LASER: Band = Band { centre_m: 532e-9, low_m: 531e-9, high_m: 533e-9 };

    fn refusal(words: &[&str], numbers: &[f64]) -> (Token, String, Option<String>) {
        let words: Vec<String> = words.iter().map(|&word| word.to_owned()).collect();
        match model().arguments(&words, numbers, &[GREEN_LASER], None) {
            Err(Error::Parameter { token, message, hint }) => (token, message, hint),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn defaults_are_filled_in_and_a_spectrum_is_taken_to_the_bands() {
        let arguments =
            model().arguments(&["steel".to_owned()], &[0.1, 0.2, 0.3, 0.5], &[GREEN_LASER; 2], None).unwrap();
        assert_eq!(arguments, Arguments { numbers: vec![0.2, 0.2, 0.5, 2.0], words: vec!["steel".to_owned()] });
    }

    #[test]
    fn each_error_names_its_token() {
        assert_eq!(
            refusal(&["stel"], &[]),
            (
                Token::Word(0),
                "metal is \"stel\", expected one of steel, copper".to_owned(),
                Some("did you mean \"steel\"?".to_owned())
            )
        );
        assert_eq!(
            refusal(&["steel"], &[0.1, 1.2, 0.1, 0.5]),
            (Token::Number(1), "colour is 1.2, expected at least 0 and at most 1".to_owned(), None)
        );
        assert_eq!(
            refusal(&["steel"], &[0.1, 0.2, 0.1, 0.0]),
            (Token::Number(3), "roughness is 0, expected above 0 and at most 1".to_owned(), None)
        );
        assert_eq!(refusal(&["steel"], &[0.1, 0.2, 0.1, 0.5, 1.5]).1, "layers is 1.5, expected a whole number");
        assert_eq!(
            refusal(&["steel"], &[0.1, 0.2]),
            (
                Token::Numbers,
                "number \"colour\" is missing: model \"m\" takes colour.red colour.green colour.blue roughness [layers], found 2".to_owned(),
                None
            )
        );
        assert_eq!(refusal(&["steel"], &[0.1, 0.2, 0.1, 0.5, 1.0, 7.0]).0, Token::Number(5));
        assert_eq!(refusal(&["steel", "x"], &[]).0, Token::Word(1));
        assert_eq!(refusal(&[], &[]).0, Token::Words);
        assert_eq!(refusal(&["steel"], &[f64::NAN]).0, Token::Number(0));
    }
}
