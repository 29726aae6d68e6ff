//! MGF transforms: those of Radiance's `xform`, on a stack, with arrays.

use crate::number_text::{leading_integer, whole_number};

/// Rows of a matrix that is applied to row vectors (x, y, z, 1) from the right.
type Matrix = [[f64; 4]; 4];

const IDENTITY: Matrix = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

/// A transform of points, with its scale.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Transform {
    matrix: Matrix,
    /// Scale of lengths; above zero.
    scale: f64,
    /// Whether it is a reflection, which reverses faces.
    pub(crate) is_mirrored: bool,
}

impl Default for Transform {
    fn default() -> Self {
        Transform { matrix: IDENTITY, scale: 1.0, is_mirrored: false }
    }
}

impl Transform {
    /// Parses `-t x y z`, `-rx` `-ry` `-rz` degrees, `-s factor`, `-mx` `-my` `-mz`, and `-i n`,
    /// which repeats what follows.
    pub(crate) fn read(words: &[String]) -> Result<Transform, String> {
        let (mut whole, mut part) = (Transform::default(), Transform::default());
        let mut repeats = 1;
        let mut rest = words;
        while let [option, values @ ..] = rest {
            let number = |index: usize| -> Result<f64, String> {
                let word = values.get(index).ok_or_else(|| format!("{option} lacks a number"))?;
                let value = whole_number(word).filter(|value| value.is_finite());
                value.ok_or_else(|| format!("{option} is followed by \"{word}\", expected a number"))
            };
            let mut matrix = IDENTITY;
            let mut factor = 1.0;
            let taken = match option.as_str() {
                "-t" => {
                    matrix[3][..3].copy_from_slice(&[number(0)?, number(1)?, number(2)?]);
                    3
                }
                "-rx" | "-ry" | "-rz" => {
                    let axis = usize::from(option.as_bytes()[2] - b'x');
                    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                    let (sine, cosine) = (std::f64::consts::PI / 180.0 * number(0)?).sin_cos();
                    (matrix[u][u], matrix[v][v], matrix[u][v], matrix[v][u]) = (cosine, cosine, sine, -sine);
                    1
                }
                "-s" => {
                    factor = number(0)?;
                    if factor == 0.0 {
                        return Err("-s 0 leaves nothing".to_owned());
                    }
                    (0..3).for_each(|axis| matrix[axis][axis] = factor);
                    1
                }
                "-mx" | "-my" | "-mz" => {
                    let axis = usize::from(option.as_bytes()[2] - b'x');
                    matrix[axis][axis] = -1.0;
                    factor = -1.0;
                    0
                }
                "-i" => {
                    whole = whole.then_repeated(part, repeats);
                    repeats =
                        values.first().and_then(|word| leading_integer(word)).map_or(0, |(count, _)| count.max(0));
                    part = Transform::default();
                    1
                }
                _ => return Err(format!("\"{option}\" is not an option of xform")),
            };
            part = part.then(&Transform { matrix, scale: factor.abs(), is_mirrored: factor < 0.0 });
            rest = &values[taken.min(values.len())..];
        }
        Ok(whole.then_repeated(part, repeats))
    }

    /// This transform followed by another.
    pub(crate) fn then(&self, next: &Transform) -> Transform {
        let matrix = std::array::from_fn(|row| {
            std::array::from_fn(|column| (0..4).map(|i| self.matrix[row][i] * next.matrix[i][column]).sum())
        });
        Transform { matrix, scale: self.scale * next.scale, is_mirrored: self.is_mirrored != next.is_mirrored }
    }

    /// Repetition by squaring, so that a large count costs little.
    fn then_repeated(&self, mut part: Transform, mut count: i64) -> Transform {
        let mut result = *self;
        while count > 0 {
            if count & 1 == 1 {
                result = result.then(&part);
            }
            part = part.then(&part.clone());
            count >>= 1;
        }
        result
    }

    pub(crate) fn point(&self, point: [f64; 3]) -> [f64; 3] {
        let vector = self.vector(point);
        std::array::from_fn(|axis| vector[axis] + self.matrix[3][axis])
    }

    fn vector(&self, vector: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| (0..3).map(|i| vector[i] * self.matrix[i][axis]).sum())
    }

    /// Transforms a direction; its length is unchanged.
    pub(crate) fn direction(&self, direction: [f64; 3]) -> [f64; 3] {
        self.vector(direction).map(|value| value / self.scale)
    }

    pub(crate) fn length(&self, length: f64) -> f64 {
        length * self.scale
    }
}
