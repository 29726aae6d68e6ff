//! The display's colour space: its primaries, a `macbethcal` calibration, or a colour warp.

use super::luminance::Luminance;
use super::warp::{ColorWarp, WarpGrid};
use crate::ToolError;
use crate::brightness::of_rgb;
use radsight_picture::{Header, RgbPrimaries, leading_number};

/// The output device.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Device {
    /// A display with Radiance's primaries.
    #[default]
    Standard,
    /// A display with these primaries.
    Primaries(RgbPrimaries),
    /// A display calibrated by `macbethcal`.
    Macbeth(Macbeth),
    /// A display described by a colour warp.
    Warp(ColorWarp),
}

/// The mapping that `macbethcal` writes as a `.cal` file: a matrix, then a curve of each component
/// through six points.
#[derive(Clone, Debug, PartialEq)]
pub struct Macbeth {
    matrix: [[f32; 3]; 3],
    from: [[f32; 6]; 3],
    to: [[f32; 6]; 3],
}

impl Macbeth {
    /// Parses such a file.
    ///
    /// # Errors
    /// The missing definition, as `macbethcal` would write it.
    pub fn read(text: &str) -> Result<Macbeth, &'static str> {
        let found = |start: &str, separators: &[&str], count: usize| {
            text.lines().find_map(|line| numbers(line.strip_prefix(start)?, separators, count))
        };
        let six =
            |start: &str| -> Option<[f32; 6]> { found(start, &["", ",", ",", ",", ",", ","], 6)?.try_into().ok() };
        let three = |start: &str| -> Option<[f32; 3]> { found(start, &["", "*rn +", "*gn +"], 3)?.try_into().ok() };
        Ok(Macbeth {
            from: [
                six("rxa(i) : select(i,").ok_or("rxa(i) : select(i,…)")?,
                six("gxa(i) : select(i,").ok_or("gxa(i) : select(i,…)")?,
                six("bxa(i) : select(i,").ok_or("bxa(i) : select(i,…)")?,
            ],
            to: [
                six("rya(i) : select(i,").ok_or("rya(i) : select(i,…)")?,
                six("gya(i) : select(i,").ok_or("gya(i) : select(i,…)")?,
                six("bya(i) : select(i,").ok_or("bya(i) : select(i,…)")?,
            ],
            matrix: [
                three("ro = ").ok_or("ro = …*rn + …*gn + …*bn")?,
                three("go = ").ok_or("go = …*rn + …*gn + …*bn")?,
                three("bo = ").ok_or("bo = …*rn + …*gn + …*bn")?,
            ],
        })
    }

    /// The display's smallest and largest output, by extrapolation of the curves.
    fn limits(&self) -> [[f32; 3]; 2] {
        let low = |i: usize| {
            let (from, to) = (self.from[i], self.to[i]);
            from[0] - to[0] * (from[1] - from[0]) / (to[1] - to[0])
        };
        let high = |i: usize| {
            let (from, to) = (self.from[i], self.to[i]);
            from[4] + (1.0 - to[4]) * (from[5] - from[4]) / (to[5] - to[4])
        };
        [std::array::from_fn(low), std::array::from_fn(high)]
    }

    fn curve(&self, component: usize, value: f32) -> f32 {
        let (from, to) = (&self.from[component], &self.to[component]);
        let before = (0..4).find(|i| from[i + 1] > value).unwrap_or(4);
        ((from[before + 1] - value) * to[before] + (value - from[before]) * to[before + 1])
            / (from[before + 1] - from[before])
    }
}

/// The numbers of a line, separated by these words.
fn numbers(text: &str, separators: &[&str], count: usize) -> Option<Vec<f32>> {
    let mut rest = text;
    let mut numbers = Vec::with_capacity(count);
    for separator in separators {
        for part in separator.split_whitespace() {
            rest = rest.trim_start().strip_prefix(part)?;
        }
        let (number, used) = leading_number(rest.as_bytes());
        if used == 0 {
            return None;
        }
        numbers.push(number as f32);
        rest = &rest[used..];
    }
    Some(numbers)
}

/// The correction applied to each pixel.
#[derive(Clone, Debug)]
pub(super) enum Correction {
    Matrix { matrix: [[f32; 3]; 3], limits: [[f32; 3]; 2], curves: Option<Box<Macbeth>> },
    Warp(Box<WarpGrid>),
}

/// The smallest and largest output of an ideal display.
const UNIT: [[f32; 3]; 2] = [[0.0; 3], [1.0; 3]];

impl Device {
    /// The correction; `None` if the input already has the display's primaries.
    pub(super) fn correction(&self, header: &Header, luminance: &Luminance) -> Result<Option<Correction>, ToolError> {
        let output = match self {
            Device::Macbeth(_) if luminance.is_xyz() => return Err(ToolError::CalibratedXyz),
            Device::Macbeth(curves) => {
                let (matrix, limits) = (curves.matrix, curves.limits());
                return Ok(Some(Correction::Matrix { matrix, limits, curves: Some(Box::new(curves.clone())) }));
            }
            Device::Warp(warp) => return Ok(Some(Correction::Warp(Box::new(WarpGrid::new(warp))))),
            Device::Standard => RgbPrimaries::STANDARD,
            Device::Primaries(primaries) => *primaries,
        };
        let matrix = if luminance.is_xyz() {
            output.xyz_to_rgb()
        } else if *self == Device::Standard && header.primaries()?.is_none() {
            return Ok(None);
        } else {
            luminance.primaries.rgb_to_rgb(&output)
        };
        let matrix = matrix.ok_or(ToolError::Primaries)?;
        let rows = std::array::from_fn(|i| matrix.row(i).to_array().map(|value| value as f32));
        Ok(Some(Correction::Matrix { matrix: rows, limits: UNIT, curves: None }))
    }
}

impl Correction {
    pub(super) fn apply(&self, pixel: [f32; 3]) -> [f32; 3] {
        let (matrix, limits, curves) = match self {
            Correction::Matrix { matrix, limits, curves } => (matrix, limits, curves),
            Correction::Warp(grid) => return clipped(grid.apply(pixel), UNIT),
        };
        let color = matrix.map(|row| row[0] * pixel[0] + row[1] * pixel[1] + row[2] * pixel[2]);
        let color = clipped(color, *limits);
        match curves {
            Some(curves) => std::array::from_fn(|i| curves.curve(i, color[i])),
            None => color,
        }
    }
}

/// Desaturates a colour towards the grey of its brightness until the display can show it.
fn clipped(color: [f32; 3], [lower, upper]: [[f32; 3]; 2]) -> [f32; 3] {
    let grey = of_rgb(color.map(|value| value.clamp(0.0, 1.0)));
    let mean = |limit: [f32; 3]| 1.0 / 3.0 * f64::from(limit[0] + limit[1] + limit[2]);
    let (darkest, brightest) = (mean(lower), mean(upper));
    if grey < darkest {
        return lower;
    }
    if grey > brightest {
        return upper;
    }
    let part = (grey - darkest) / (brightest - darkest);
    let greys: [f32; 3] =
        std::array::from_fn(|i| (part * f64::from(upper[i]) + (1.0 - part) * f64::from(lower[i])) as f32);
    let mut kept = 1.0f64;
    let mut outside = false;
    for i in 0..3 {
        let limit = match color[i] {
            value if value < lower[i] => lower[i],
            value if value > upper[i] => upper[i],
            _ => continue,
        };
        outside = true;
        kept = kept.min(f64::from((limit - greys[i]) / (color[i] - greys[i])));
    }
    if !outside {
        return color;
    }
    std::array::from_fn(|i| (kept * f64::from(color[i]) + (1.0 - kept) * f64::from(greys[i])) as f32)
}
