//! Bases: divisions of a hemisphere of directions.

use crate::FluxError;
use radsight_measured::AngleBasis;
use radsight_sampling::unit_disk;
use radsight_sky::SkyDivision;
use std::f64::consts::{FRAC_PI_2, TAU};

/// A division of the hemisphere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// No division.
    Uniform,
    /// Shirley and Chiu's squares, with this many along each side.
    ShirleyChiu(u32),
    /// Reinhart's subdivision of Tregenza's sky: each patch divided this many times along each
    /// side.
    Reinhart(u32),
    /// One of Klems' bases.
    Klems(Klems),
    /// The CIE's sky scan, for receivers only.
    Cie,
}

/// Klems' bases.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Klems {
    /// 145 patches.
    Full,
    /// 77.
    Half,
    /// 41.
    Quarter,
}

/// Finest division along a side: 150 million patches.
const FINEST: u32 = 1 << 10;

impl Basis {
    /// Parses the value of `h=`, without its sign.
    pub(crate) fn from_word(word: &str) -> Result<Basis, FluxError> {
        let wrong = || FluxError::Basis { word: word.to_owned() };
        let digits: String = word.chars().filter(char::is_ascii_digit).collect();
        let size: u32 = if digits.is_empty() { 1 } else { digits.parse().map_err(|_| wrong())? };
        let letters = word.to_ascii_lowercase();
        let size = size.max(1);
        let basis = match letters.as_bytes() {
            [b'u' | b'1', ..] => Basis::Uniform,
            [b's', b'c', ..] if size > 1 => Basis::ShirleyChiu(size),
            [b'r' | b't', ..] => Basis::Reinhart(size),
            [b'k'] | [b'k', b'f' | b'1', ..] => Basis::Klems(Klems::Full),
            [b'k', b'h' | b'2', ..] => Basis::Klems(Klems::Half),
            [b'k', b'q' | b'4', ..] => Basis::Klems(Klems::Quarter),
            b"cie" => Basis::Cie,
            _ => return Err(wrong()),
        };
        let is_sane = !matches!(basis, Basis::ShirleyChiu(size) | Basis::Reinhart(size) if size > FINEST);
        is_sane.then_some(basis).ok_or_else(wrong)
    }
}

/// Samples directions of a basis.
#[derive(Clone, Debug)]
pub(crate) enum Directions {
    Uniform,
    ShirleyChiu(u32),
    Reinhart(SkyDivision),
    Klems(AngleBasis),
}

impl Directions {
    pub(crate) fn new(basis: Basis) -> Result<Directions, FluxError> {
        let klems = |which: Klems| AngleBasis::known().into_iter().nth(which as usize);
        match basis {
            Basis::Uniform => Ok(Directions::Uniform),
            Basis::ShirleyChiu(size) => Ok(Directions::ShirleyChiu(size)),
            Basis::Reinhart(size) => Ok(Directions::Reinhart(SkyDivision::new(size))),
            Basis::Klems(which) => klems(which).map(Directions::Klems).ok_or(FluxError::SendingCie),
            Basis::Cie => Err(FluxError::SendingCie),
        }
    }

    /// Number of patches.
    pub(crate) fn len(&self) -> u64 {
        match self {
            Directions::Uniform => 1,
            Directions::ShirleyChiu(size) => u64::from(size * size),
            Directions::Reinhart(sky) => sky.patches(),
            Directions::Klems(basis) => basis.len() as u64,
        }
    }

    /// Maps a point of the unit square to a direction in front, within a patch: its coordinates
    /// along u, v and the normal. As in Radiance it is uniform in projected solid angle, and for
    /// [`Basis::Reinhart`] in altitude.
    pub(crate) fn sample(&self, patch: u64, [a, b]: [f64; 2]) -> [f64; 3] {
        let (x, y) = match self {
            Directions::Uniform => unit_disk(a, b),
            Directions::ShirleyChiu(size) => {
                let (row, column) = ((patch / u64::from(*size)) as f64, (patch % u64::from(*size)) as f64);
                unit_disk((row + a) / f64::from(*size), (column + b) / f64::from(*size))
            }
            Directions::Reinhart(sky) => return reinhart(*sky, patch, [a, b]),
            Directions::Klems(basis) => {
                let [x, y] = basis.point(patch as usize, [a, b]);
                (x, y)
            }
        };
        [x, y, (1.0 - x * x - y * y).max(0.0).sqrt()]
    }
}

/// The first patch of a row is centred on the downward direction (−v).
fn reinhart(sky: SkyDivision, patch: u64, [a, b]: [f64; 2]) -> [f64; 3] {
    let (row, column) = sky.row_and_column(patch);
    let up = if row < sky.rows() { a } else { a * a };
    let altitude = ((f64::from(row) + up) * sky.row_height()).min(FRAC_PI_2);
    let azimuth = TAU * (column as f64 + b - 0.5) / sky.columns(row) as f64;
    let (sin, cos) = altitude.sin_cos();
    [azimuth.sin() * cos, -azimuth.cos() * cos, sin]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_name_bases() {
        for (word, basis) in [
            ("u", Basis::Uniform),
            ("kf", Basis::Klems(Klems::Full)),
            ("k", Basis::Klems(Klems::Full)),
            ("KH", Basis::Klems(Klems::Half)),
            ("k4", Basis::Klems(Klems::Quarter)),
            ("r", Basis::Reinhart(1)),
            ("r4", Basis::Reinhart(4)),
            ("t2", Basis::Reinhart(2)),
            ("sc25", Basis::ShirleyChiu(25)),
            ("cie", Basis::Cie),
        ] {
            assert_eq!(Basis::from_word(word), Ok(basis), "{word}");
        }
        for word in ["", "sc", "sc1", "q", "kx", "r99999", "r99999999999999999999"] {
            assert!(Basis::from_word(word).is_err(), "{word}");
        }
    }

    #[test]
    fn all_directions_are_in_front_and_unit() {
        for basis in ["u", "kf", "kh", "kq", "r1", "r3", "sc5"] {
            let directions = Directions::new(Basis::from_word(basis).unwrap()).unwrap();
            for patch in 0..directions.len() {
                for point in [[0.0, 0.0], [0.5, 0.5], [0.999, 0.001], [0.001, 0.999]] {
                    let [x, y, z] = directions.sample(patch, point);
                    assert!(z >= 0.0 && (x * x + y * y + z * z - 1.0).abs() < 1e-12, "{basis} {patch}");
                }
            }
        }
    }
}
