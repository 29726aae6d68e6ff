//! The components of output values (`-p…`, `-co`).

use crate::failure::Failure;
use crate::render_args::number;
use glam::{DMat3, DVec3};
use radsight_picture::{RgbPrimaries, WHITE_EFFICACY, xyz_to_rgb};
use radsight_spectrum::{MELANOPIC_OF_RGB, Response, SCOTOPIC_OF_RGB, Sampling};

/// The components of a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum OutputColor {
    /// Red, green and blue as in the scene.
    Rgb,
    /// CIE X, Y, Z, Y in cd/m² (or lux).
    Xyz(DMat3),
    /// Red, green and blue of other primaries: the matrices to X, Y, Z, and from there.
    Primaries(RgbPrimaries, [DMat3; 2]),
    /// Every traced band.
    Bands,
    /// One number: the sum of red, green and blue with these weights.
    Weighted([f64; 3]),
    /// The same, with a spectral response if spectra are traced.
    Response(Response, [f64; 3]),
}

impl OutputColor {
    /// The components for an option, and the number of words it uses; `None` for another option.
    pub(crate) fn from_option(words: &[String]) -> Result<Option<(OutputColor, usize)>, Failure> {
        let standard = RgbPrimaries::STANDARD;
        let impossible = || {
            Failure::usage(format!(
                "option \"{}\": invalid primaries, expected primaries that are not collinear and a white inside their triangle",
                words[0]
            ))
        };
        let to_xyz = standard.rgb_to_xyz().ok_or_else(impossible)?;
        let color = match words[0].as_str() {
            "-pRGB" => OutputColor::Rgb,
            "-pXYZ" => OutputColor::Xyz(to_xyz * WHITE_EFFICACY),
            "-pY" => OutputColor::Weighted(to_xyz.row(1).to_array().map(|weight| weight * WHITE_EFFICACY)),
            "-pS" => OutputColor::Response(Response::Scotopic, SCOTOPIC_OF_RGB),
            "-pM" => OutputColor::Response(Response::Melanopic, MELANOPIC_OF_RGB),
            "-pA" => OutputColor::Weighted([1.0 / 3.0; 3]),
            "-pc" => {
                let mut numbers = [0.0; 8];
                for (offset, value) in numbers.iter_mut().enumerate() {
                    *value = number(&words[offset.min(words.len() - 1)..], "-pc", "eight chromaticities")?;
                }
                let primaries = RgbPrimaries::from_array(numbers);
                let from_xyz = primaries.xyz_to_rgb().ok_or_else(impossible)?;
                return Ok(Some((OutputColor::Primaries(primaries, [to_xyz, from_xyz]), 9)));
            }
            _ => return Ok(None),
        };
        Ok(Some((color, 1)))
    }

    /// Number of components of a value for this many traced bands.
    pub(crate) fn components(&self, bands: usize) -> usize {
        match self {
            OutputColor::Weighted(_) | OutputColor::Response(..) => 1,
            OutputColor::Bands => bands,
            _ => 3,
        }
    }

    /// The primaries for a header; none for the standard ones.
    pub(crate) fn primaries(&self) -> Option<RgbPrimaries> {
        match self {
            OutputColor::Xyz(_) => Some(RgbPrimaries::XYZ),
            OutputColor::Primaries(primaries, _) => Some(*primaries),
            _ => None,
        }
    }

    /// The value of 1 W in these components: lm, or W.
    pub(crate) fn unit(&self) -> f64 {
        match self {
            OutputColor::Xyz(_) => WHITE_EFFICACY,
            OutputColor::Weighted(weights) => weights.iter().sum(),
            OutputColor::Response(response, _) => response.white_efficacy(),
            OutputColor::Rgb | OutputColor::Primaries(..) | OutputColor::Bands => 1.0,
        }
    }

    /// The response to a spectrum; `None` if the colour suffices.
    pub(crate) fn of_spectrum(&self, bands: &[f32], sampling: &Sampling) -> Option<f64> {
        let OutputColor::Response(response, _) = self else { return None };
        let [first, .., last] = sampling.splits_nm();
        let shares = response.of_whole_bands(bands.len(), [first, last]);
        let sum: f64 = bands.iter().zip(shares).map(|(band, share)| f64::from(*band) * share).sum();
        Some(sum * response.white_efficacy())
    }

    /// Converts a value to these components; further components are unused.
    pub(crate) fn of(&self, value: [f64; 3]) -> [f64; 3] {
        match self {
            OutputColor::Rgb | OutputColor::Bands => value,
            OutputColor::Xyz(matrix) => (*matrix * DVec3::from(value)).to_array(),
            OutputColor::Primaries(_, [to_xyz, from_xyz]) => {
                let xyz = (*to_xyz * DVec3::from(value)).to_array();
                xyz_to_rgb(from_xyz, xyz.map(|component| component as f32)).map(f64::from)
            }
            OutputColor::Weighted(weights) | OutputColor::Response(_, weights) => {
                [value.iter().zip(weights).map(|(band, weight)| band * weight).sum(), 0.0, 0.0]
            }
        }
    }
}
