//! `falsecolor`: maps brightness to colours, contours and bands.

mod own;
mod tables;

use crate::ToolError;
use crate::brightness::of_rgb;
pub use own::OwnComponent;
use radsight_picture::{Encoding, Header, PictureReader, PictureWriter, encode_rgbe};
use std::collections::VecDeque;
use std::f64::consts::PI;
use std::io::{Read, Write};
use tables::{DEFAULT, TURBO};

/// A colour scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Palette {
    /// `def`: from blue over green and red to yellow.
    Default,
    /// `spec`: the spectrum.
    Spectrum,
    /// `pm3d`: from black over blue, red and yellow.
    Pm3d,
    /// `hot`: from black over red and yellow to white.
    Hot,
    /// `eco`: blue below the middle, yellow above.
    Eco,
    /// `tbo`: turbo.
    Turbo,
}

/// The gamma of the displays for which some scales were designed.
const GAMMA: f64 = 2.2;

impl Palette {
    /// All palettes with their names.
    pub const ALL: [(&'static str, Palette); 6] = [
        ("def", Palette::Default),
        ("spec", Palette::Spectrum),
        ("pm3d", Palette::Pm3d),
        ("hot", Palette::Hot),
        ("eco", Palette::Eco),
        ("tbo", Palette::Turbo),
    ];

    /// The colour of a value in [0, 1]; values outside are extrapolated by the formula.
    #[must_use]
    pub fn color(self, value: f64) -> [f64; 3] {
        let clip = |value: f64| value.clamp(0.0, 1.0);
        let shown = |color: [f64; 3]| color.map(|part| part.powf(GAMMA));
        match self {
            Palette::Default => interpolated(value),
            Palette::Spectrum => {
                let green = if value > 0.375 { 1.6 - 1.6 * value } else { 8.0 / 3.0 * value };
                [1.6 * value - 0.6, green, 1.0 - 8.0 / 3.0 * value]
            }
            Palette::Pm3d => {
                let wave = clip((2.0 * PI * clip(value)).sin());
                shown([clip(value).sqrt(), clip(value * value * value), wave])
            }
            Palette::Hot => shown([clip(3.0 * value), clip(3.0 * value - 1.0), clip(3.0 * value - 2.0)]),
            Palette::Eco => shown([clip(2.0 * value), clip(2.0 * (value - 0.5)), clip(2.0 * (0.5 - value))]),
            Palette::Turbo => shown(turbo(value)),
        }
    }
}

fn interpolated(value: f64) -> [f64; 3] {
    // Radiance writes the step with the same digits.
    let position = value / 0.0454545 + 1.0;
    let last = DEFAULT.len();
    if position <= 1.0 || position.is_nan() {
        return DEFAULT[0];
    }
    if position >= last as f64 {
        return DEFAULT[last - 1];
    }
    let below = position.floor();
    let index = below as usize;
    std::array::from_fn(|i| (below + 1.0 - position) * DEFAULT[index - 1][i] + (position - below) * DEFAULT[index][i])
}

fn turbo(value: f64) -> [f64; 3] {
    if value > 1.0 {
        return TURBO[TURBO.len() - 1];
    }
    if value <= 0.0 || value.is_nan() {
        return TURBO[0];
    }
    let nearest = (value * 255.0 + 0.5).floor();
    let index = (nearest as usize).min(TURBO.len() - 1);
    let next = (index + 1).min(TURBO.len() - 1);
    std::array::from_fn(|i| TURBO[index][i] + (TURBO[next][i] - TURBO[index][i]) * (value * 255.0 - nearest))
}

/// Which pixels are coloured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coverage {
    /// All.
    All,
    /// All, in as many steps as there are divisions.
    Posterized,
    /// Lines between the divisions.
    Lines,
    /// Narrow bands around the limits of the divisions.
    Bands,
    /// None.
    None,
}

/// The mapping from brightness to colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// The brightness at the top of the scale, after the multiplier.
    pub top: f64,
    /// The factor of brightness, 179 for cd/m².
    pub multiplier: f64,
    /// Decades of a logarithmic scale; 0 for a linear one.
    pub decades: f64,
    /// Number of divisions.
    pub divisions: f64,
    /// Which pixels are coloured.
    pub coverage: Coverage,
    /// The palette.
    pub palette: Palette,
    /// Custom red, green and blue, which replace those of the palette.
    pub own: [Option<OwnComponent>; 3],
}

impl Scale {
    /// The scale position in [0, 1] of a value that is 1 at the top.
    fn mapped(&self, value: f64) -> f64 {
        if self.decades <= 0.0 {
            value
        } else if value > 10f64.powf(-self.decades) {
            value.log10() / self.decades + 1.0
        } else {
            0.0
        }
    }

    /// The colour of a scale position; `None` where the background shows. `around` holds the
    /// positions to the left, right, above and below.
    #[must_use]
    pub fn color(&self, position: f64, around: [f64; 4]) -> Option<[f32; 3]> {
        let divisions = self.divisions;
        let half = 1.0 / divisions / 2.0;
        let inside = position >= half && position < 1.0 + half;
        let crosses = |a: f64, b: f64| ((divisions * a).floor() - (divisions * b).floor()).abs() > 1e-7;
        let [left, right, above, below] = around;
        let is_colored = match self.coverage {
            Coverage::All | Coverage::Posterized => true,
            Coverage::Lines => inside && (crosses(left, right) || crosses(above, below)),
            Coverage::Bands => {
                let fraction = divisions * position - (divisions * position).floor();
                inside && !(0.1..0.9).contains(&fraction)
            }
            Coverage::None => false,
        };
        // The lowest division has no border, so the colours begin at the second.
        let shifted = |value: f64| (value - 1.0 / divisions) * divisions / (divisions - 1.0);
        let value = match self.coverage {
            Coverage::All => position,
            Coverage::Posterized => shifted(((position * divisions).floor() + 0.5) / divisions),
            _ => shifted(position),
        };
        is_colored.then(|| self.colored(value))
    }
}

impl Scale {
    /// The colour of a value in [0, 1].
    fn colored(&self, value: f64) -> [f32; 3] {
        let mut color = self.palette.color(value);
        for (part, own) in color.iter_mut().zip(&self.own) {
            if let Some(own) = own {
                *part = own.at(value);
            }
        }
        color.map(|part| part.clamp(0.0, 1.0) as f32)
    }
}

/// The background of uncoloured pixels.
pub enum Background<R> {
    /// Black.
    Black,
    /// The picture itself.
    Same,
    /// Another picture of the same size.
    Other(PictureReader<R>),
}

impl<R: Read> Background<R> {
    /// The encoding of another picture.
    fn encoding(&self) -> Option<Encoding> {
        match self {
            Background::Other(other) => Some(other.encoding()),
            Background::Black | Background::Same => None,
        }
    }
}

/// Colours a picture row by row. The colours are red, green and blue, as must be the pixels of the
/// picture and of its background: those of another encoding would be shown as wrong colours.
///
/// # Errors
/// When a picture cannot be read or is not RGBE, the background has another size, or the output
/// cannot be written. Errors of the background have the index 1.
pub fn falsecolor<R: Read, W: Write>(
    mut reader: PictureReader<R>,
    mut background: Background<R>,
    scale: &Scale,
    header: &Header,
    target: W,
) -> Result<(), ToolError> {
    let resolution = reader.resolution();
    let (columns, rows) = (resolution.scanline_length(), resolution.scanlines());
    if let Background::Other(other) = &background {
        let found = [other.resolution().scanline_length(), other.resolution().scanlines()];
        if found != [columns, rows] {
            return Err(ToolError::OtherSize { index: 1, found, expected: [columns, rows] });
        }
    }
    for found in [Some(reader.encoding()), background.encoding()].into_iter().flatten() {
        if found != Encoding::Rgbe {
            return Err(ToolError::NotRgbe { found });
        }
    }
    let exposure = exposure(reader.header())?;
    let norm = scale.multiplier / scale.top / exposure;
    let mut writer = PictureWriter::new(target, header, 3, radsight_picture::Resolution::standard(columns, rows))?;
    let mut window: VecDeque<Row> = VecDeque::new();
    let mut behind = vec![[0.0f32; 3]; columns];
    for row in 0..rows {
        // The row, and those above and below it, if any.
        while window.back().is_none_or(|last| last.number < (row + 1).min(rows - 1)) {
            let number = window.back().map_or(0, |last| last.number + 1);
            let mut pixels = vec![[0.0f32; 3]; columns];
            reader.read_three(&mut pixels)?;
            let positions = pixels.iter().map(|pixel| scale.mapped(of_rgb(*pixel) * norm)).collect();
            window.push_back(Row { number, pixels, positions });
        }
        while window.front().is_some_and(|first| first.number + 1 < row) {
            window.pop_front();
        }
        if let Background::Other(other) = &mut background {
            other.read_three(&mut behind).map_err(|error| ToolError::Input { index: 1, error })?;
        }
        let index = window.iter().position(|found| found.number == row).unwrap_or(0);
        let here = &window[index];
        let above = &window[index.saturating_sub(1)];
        let below = &window[(index + 1).min(window.len() - 1)];
        let color = |column: usize| {
            let around = [
                here.positions[column.saturating_sub(1)],
                here.positions[(column + 1).min(columns - 1)],
                above.positions[column],
                below.positions[column],
            ];
            let background = || match background {
                Background::Black => [0.0; 3],
                Background::Same => here.pixels[column],
                Background::Other(_) => behind[column],
            };
            encode_rgbe(scale.color(here.positions[column], around).unwrap_or_else(background))
        };
        let stored: Vec<u8> = (0..columns).flat_map(color).collect();
        writer.write_stored(&stored)?;
    }
    Ok(writer.finish()?)
}

/// A row of the picture and the scale positions of its pixels.
struct Row {
    number: usize,
    pixels: Vec<[f32; 3]>,
    positions: Vec<f64>,
}

/// The product of all exposures and corrections of a header, as a brightness.
fn exposure(header: &Header) -> Result<f64, ToolError> {
    let correction = header.color_correction()?;
    let exposure = header.exposure()?;
    Ok(of_rgb(correction.map(|part| (part * exposure) as f32)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_of_the_scales_are_their_first_and_last_colours() {
        assert_eq!(Palette::Default.color(-1.0), DEFAULT[0]);
        assert_eq!(Palette::Default.color(2.0), DEFAULT[22]);
        assert_eq!(Palette::Hot.color(1.0), [1.0; 3]);
        assert_eq!(Palette::Eco.color(0.0), [0.0, 0.0, 1.0]);
    }

    #[test]
    fn lines_are_where_the_division_changes() {
        let scale = Scale {
            top: 1.0,
            multiplier: 1.0,
            decades: 0.0,
            divisions: 4.0,
            coverage: Coverage::Lines,
            palette: Palette::Spectrum,
            own: Default::default(),
        };
        assert!(scale.color(0.5, [0.49, 0.51, 0.5, 0.5]).is_some());
        assert!(scale.color(0.6, [0.55, 0.65, 0.6, 0.6]).is_none());
        assert!(scale.color(0.1, [0.1, 0.3, 0.1, 0.1]).is_none());
    }
}
