//! Parameters in a comment `#@rfluxmtx`.

use crate::{Basis, FluxError};
use glam::DVec3;

/// Orientation of a basis' azimuths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hand {
    /// Right-handed coordinates (`h=+…`).
    #[default]
    Right,
    /// Left-handed coordinates (`h=-…`).
    Left,
}

/// Parameters of a group of surfaces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parameters {
    /// Basis (`h=`).
    pub basis: Option<Basis>,
    /// Orientation of the basis' azimuths.
    pub hand: Hand,
    /// Up direction (`u=`), unit.
    pub up: Option<DVec3>,
    /// File of a receiver's matrix (`o=`), or a command after `!`.
    pub output: Option<String>,
}

impl Parameters {
    /// Parses the text after `#@rfluxmtx`; a repeated parameter replaces the earlier one.
    ///
    /// # Errors
    /// If a word is not a parameter.
    pub fn read(&mut self, text: &str) -> Result<(), FluxError> {
        let mut rest = text.trim_start();
        while !rest.is_empty() {
            let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
            let word = &rest[..end];
            let mut after = &rest[end..];
            if let Some(basis) = word.strip_prefix("h=") {
                self.hand = if basis.starts_with('-') { Hand::Left } else { Hand::Right };
                self.basis = Some(Basis::from_word(basis.strip_prefix(['+', '-']).unwrap_or(basis))?);
            } else if let Some(direction) = word.strip_prefix("u=") {
                self.up = Some(unit_direction(direction)?);
            } else if let Some(name) = rest.strip_prefix("o=") {
                let (output, rest) = output(name)?;
                self.output = Some(output.to_owned());
                after = rest;
            } else {
                return Err(FluxError::Parameter { word: word.to_owned() });
            }
            rest = after.trim_start();
        }
        Ok(())
    }

    /// Default parameters of the next receiver: its basis is that of this one.
    #[must_use]
    pub fn next(&self) -> Parameters {
        Parameters { up: None, output: None, ..self.clone() }
    }
}

/// Splits off a file name, which may be in quotation marks.
fn output(text: &str) -> Result<(&str, &str), FluxError> {
    let (name, after) = match text.chars().next() {
        Some(mark @ ('"' | '\'')) => text[1..].split_once(mark).ok_or(FluxError::Output)?,
        _ => text.split_at(text.find(char::is_whitespace).unwrap_or(text.len())),
    };
    if name.is_empty() { Err(FluxError::Output) } else { Ok((name, after)) }
}

/// Parses an axis with a sign, or three numbers.
fn unit_direction(word: &str) -> Result<DVec3, FluxError> {
    let wrong = || FluxError::Direction { word: word.to_owned() };
    let name = word.trim_start_matches(['+', '-']);
    let sign = if (word.len() - name.len()) > 0 && word.matches('-').count() % 2 == 1 { -1.0 } else { 1.0 };
    match name {
        "x" | "X" => return Ok(DVec3::X * sign),
        "y" | "Y" => return Ok(DVec3::Y * sign),
        "z" | "Z" => return Ok(DVec3::Z * sign),
        _ => {}
    }
    let numbers: Vec<f64> = word.split(',').map_while(|number| number.parse().ok()).collect();
    let [x, y, z] = numbers[..] else { return Err(wrong()) };
    DVec3::new(x, y, z).try_normalize().filter(|_| word.split(',').count() == 3).ok_or_else(wrong)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_read_in_any_order() {
        let mut parameters = Parameters::default();
        parameters.read(" u=-Z  o=\"a file.mtx\"\th=-kh\n").unwrap();
        let expected = Parameters {
            basis: Some(Basis::Klems(crate::Klems::Half)),
            hand: Hand::Left,
            up: Some(-DVec3::Z),
            output: Some("a file.mtx".to_owned()),
        };
        assert_eq!(parameters, expected);
        parameters.read("u=0,0,-4 o=!cat").unwrap();
        assert_eq!((parameters.up, parameters.output.as_deref()), (Some(-DVec3::Z), Some("!cat")));
    }

    #[test]
    fn wrong_parameters_are_reported() {
        for (text, message) in [
            ("h=q", "\"q\" is not a basis, expected u, kf, kh, kq, r and a number, sc and a number, or cie"),
            ("u=W", "\"W\" is not a direction, expected X, Y or Z with a sign, or three numbers with commas"),
            ("u=1,2", "\"1,2\" is not a direction, expected X, Y or Z with a sign, or three numbers with commas"),
            ("o=", "\"o=\" names no file"),
            ("o='a", "\"o=\" names no file"),
            ("h=kf z=1", "\"z=1\" is not a parameter, expected h=, u= or o="),
        ] {
            assert_eq!(Parameters::default().read(text).unwrap_err().to_string(), message);
        }
    }
}
