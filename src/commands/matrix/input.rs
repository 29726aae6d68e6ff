//! Reads matrices from files, standard input and commands, and parses the options that change them.

use crate::commands::words::Words;
use crate::disk::Commands;
use crate::failure::Failure;
use crate::input::{read_file, read_source};
use radsight_matrix::{Matrix, MatrixError, Stored, Transform, Wanted, bsdf_matrix};
use radsight_picture::leading_number;
use radsight_scene_generators::source_name;

/// The changes applied to a matrix after reading.
#[derive(Clone, Debug, Default)]
pub(super) struct Change {
    /// `-s`
    pub(super) factors: Vec<f64>,
    /// `-c`, `-C`
    pub(super) components: Option<Components>,
    /// `-t`
    pub(super) transposes: bool,
}

/// The requested components.
#[derive(Clone, Debug)]
pub(super) enum Components {
    Coefficients(Vec<f64>),
    /// Letters, or the name of a file with these components.
    Named(String),
}

/// The bytes of a file, of standard input (`-`), or of a command's output after `!`.
pub(super) fn read_bytes(source: &str, commands: Commands) -> Result<Vec<u8>, Failure> {
    read_source(source, commands, |path| read_file(path, "matrix"))
}

/// The error of a named matrix.
pub(super) fn wrong(program: &str, source: &str, error: &MatrixError) -> Failure {
    Failure::input(format!("{program}: {}: {error}", source_name(source)))
}

/// The warning that values of different kinds are combined as they are.
pub(super) fn mismatch(program: &str, source: &str, [before, own]: [Stored; 2]) -> String {
    let [before, own] = [before, own].map(kind);
    format!("{program}: warning - {}: {own} combined with {before}\n", source_name(source))
}

fn kind(stored: Stored) -> &'static str {
    match stored {
        Stored::Rgbe => "a picture of red, green and blue (RGBE)",
        Stored::Xyze => "a picture of X, Y and Z (XYZE)",
        Stored::Spectra => "a picture of spectra",
        Stored::Float | Stored::Ascii | Stored::Double => "a matrix of numbers",
    }
}

/// Reads a picture or a float matrix.
pub(super) fn read_matrix(program: &str, source: &str, commands: Commands) -> Result<Matrix, Failure> {
    Matrix::read(&read_bytes(source, commands)?).map_err(|error| wrong(program, source, &error))
}

/// Reads a matrix, or a BSDF file if the name ends in `.xml`.
pub(super) fn read_factor(program: &str, source: &str, wanted: Wanted, commands: Commands) -> Result<Matrix, Failure> {
    if source.starts_with('!') || !source.to_ascii_lowercase().ends_with(".xml") {
        return read_matrix(program, source, commands);
    }
    bsdf_matrix(&read_bytes(source, commands)?, wanted).map_err(|error| wrong(program, source, &error))
}

impl Change {
    /// Takes the changes of the next matrix and resets them. `all` are its components by default.
    pub(super) fn take_for_next(&mut self, all: Option<&String>) -> Change {
        let mut own = std::mem::take(self);
        own.components = own.components.or_else(|| all.cloned().map(Components::Named));
        own
    }

    /// Applies components and factors, and then the transpose.
    pub(super) fn apply(
        &self,
        program: &str,
        source: &str,
        matrix: Matrix,
        commands: Commands,
    ) -> Result<Matrix, Failure> {
        let failed = |error: MatrixError| wrong(program, source, &error);
        let mut changed = matrix;
        if let Some(components) = &self.components {
            let transform = match components {
                Components::Coefficients(coefficients) => Transform::Coefficients(coefficients.clone()),
                Components::Named(name) if name.contains('.') => read_matrix(program, name, commands)?.kind(),
                Components::Named(letters) => Transform::Letters(letters.clone()),
            };
            changed = changed.transformed(&transform, &self.factors).map_err(failed)?;
        } else if !self.factors.is_empty() {
            changed.scale(&self.factors).map_err(failed)?;
        }
        Ok(if self.transposes { changed.transposed() } else { changed })
    }

    /// Parses `-s`, `-c` or `-C`; returns whether the option was one of them. Letters after `-C`
    /// apply to all following matrices.
    pub(super) fn take(
        &mut self,
        option: &str,
        words: &mut Words<'_>,
        all: &mut Option<String>,
    ) -> Result<bool, Failure> {
        let expected = "numbers, letters of components, or a file";
        match option {
            "-s" => {
                self.factors = numbers(words)?;
                if self.factors.is_empty() {
                    return Err(Failure::usage(format!(
                        "{}: option \"-s\" has no factors, expected numbers after it",
                        words.program()
                    )));
                }
            }
            "-C" => {
                let name = words.value(option, expected)?.to_owned();
                *all = Some(name.clone());
                self.components = Some(Components::Named(name));
            }
            "-c" => {
                let coefficients = numbers(words)?;
                self.components = Some(match coefficients.is_empty() {
                    true => Components::Named(words.value(option, expected)?.to_owned()),
                    false => Components::Coefficients(coefficients),
                });
            }
            _ => return Ok(false),
        }
        Ok(true)
    }
}

/// All numbers at the start of the remaining words.
fn numbers(words: &mut Words<'_>) -> Result<Vec<f64>, Failure> {
    let is_number = |word: &str| {
        let (value, used) = leading_number(word.as_bytes());
        used > 0 && used == word.len() && value.is_finite()
    };
    let mut found = Vec::new();
    while let Some(word) = words.next_if(is_number) {
        found.push(leading_number(word.as_bytes()).0);
    }
    Ok(found)
}

/// The format of a letter.
pub(super) fn format(letter: &str) -> Option<Stored> {
    Some(match letter {
        "a" => Stored::Ascii,
        "f" => Stored::Float,
        "d" => Stored::Double,
        "c" => Stored::Rgbe,
        _ => return None,
    })
}

/// The output format: as requested, or as the result; doubles are written in single precision.
pub(super) fn result_format(asked: Option<Stored>, result: &Matrix) -> Stored {
    asked.unwrap_or(if result.stored == Stored::Double { Stored::Float } else { result.stored })
}
