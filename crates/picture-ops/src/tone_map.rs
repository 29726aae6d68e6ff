//! Tone mapping of a whole picture for a display, as in Radiance's converters (`ra_bmp -e`).
//!
//! The tone curve follows the same paper as [`condition`](mod@crate::condition), but from the
//! histogram of the pixels themselves, where `pcond` uses foveal samples. Radiance quantises
//! luminance; this code does not.

use crate::ToolError;
use crate::condition::{Luminance, RODS, VISIBLE, cones, threshold};
use crate::cumulative::{cumulative, share_at};
use radsight_picture::{Encoding, Header, PictureReader, RgbPrimaries};
use std::io::Read;

/// The tone curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tones {
    /// Contrast never exceeds the scene's (`auto`).
    Automatic,
    /// Contrast is limited to the contrast sensitivity of the eye, and dim colours are desaturated
    /// (`human`).
    Human,
    /// Linear; the brightest pixel has the display's largest luminance (`linear`).
    Linear,
}

/// The output colour space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Display {
    /// Shades of grey.
    Grey,
    /// Colours of these primaries.
    Color(RgbPrimaries),
}

/// The display's largest luminance in cd/m², and its dynamic range.
const TOP: f64 = 100.0;
const RANGE: f64 = 100.0;

/// Histogram bins per unit of brightness, the natural logarithm of luminance in cd/m².
const BINS_A_UNIT: f64 = 16.0;

/// The limits of brightness; darker pixels are black.
const DARKEST: f64 = -16.0;
const BRIGHTEST: f64 = 112.0;

/// The adjustment fails when fewer than one pixel in this many is left.
const LEFT: u64 = 500;

/// The adjustment ends when fewer than one pixel in this many is above the ceiling.
const ABOVE: u64 = 40;

/// Returns the display output of each pixel in file order, relative to the display's maximum; it
/// may slightly exceed 1.
///
/// # Errors
/// When the picture cannot be read, is black, or the primaries are invalid.
pub fn tone_map<R: Read>(
    mut reader: PictureReader<R>,
    tones: Tones,
    display: &Display,
) -> Result<Vec<[f32; 3]>, ToolError> {
    let resolution = reader.resolution();
    let scene = Scene::new(reader.header(), reader.encoding(), display)?;
    let mut pixels = Vec::new();
    let mut scanline = vec![[0.0f32; 3]; resolution.scanline_length()];
    for _ in 0..resolution.scanlines() {
        reader.read_three(&mut scanline)?;
        pixels.extend(scanline.iter().map(|pixel| scene.shown(*pixel)));
    }
    let luminance = |pixel: &[f32; 3]| scene.luminance(*pixel);
    let map = ToneMap::new(pixels.iter().map(luminance), tones)?;
    for pixel in &mut pixels {
        let luminance = scene.luminance(*pixel);
        let scale = map.light(luminance);
        *pixel = match display {
            _ if scale <= 0.0 => [0.0; 3],
            Display::Grey => [scale as f32; 3],
            Display::Color(_) if tones == Tones::Human => {
                with_rods(*pixel, luminance).map(|value| (value * scale / luminance) as f32)
            }
            Display::Color(_) => pixel.map(|value| (f64::from(value) * scale / luminance) as f32),
        };
    }
    Ok(pixels)
}

/// Conversion from stored pixels to the display's components in cd/m².
struct Scene {
    /// `None` if components stay unchanged.
    transform: Option<[[f32; 3]; 3]>,
    factor: f64,
    /// The weights of the components in the luminance.
    weights: [f64; 3],
}

impl Scene {
    fn new(header: &Header, encoding: Encoding, display: &Display) -> Result<Scene, ToolError> {
        let luminance = Luminance::new(header, encoding)?;
        let factor = luminance.efficacy() / luminance.exposure;
        let row = |primaries: &RgbPrimaries| primaries.rgb_to_xyz().map(|matrix| matrix.row(1).to_array());
        let (matrix, weights) = match display {
            Display::Grey if luminance.is_xyz() => {
                return Ok(Scene { transform: None, factor, weights: [0.0, 1.0, 0.0] });
            }
            Display::Grey => (None, row(&luminance.primaries)),
            Display::Color(primaries) if luminance.is_xyz() => (primaries.xyz_to_rgb(), row(primaries)),
            Display::Color(primaries) => (luminance.primaries.rgb_to_rgb(primaries), row(primaries)),
        };
        if matrix.is_none() && *display != Display::Grey {
            return Err(ToolError::Primaries);
        }
        let transform =
            matrix.map(|matrix| std::array::from_fn(|i| matrix.row(i).to_array().map(|value| value as f32)));
        Ok(Scene { transform, factor, weights: weights.ok_or(ToolError::Primaries)? })
    }

    fn shown(&self, pixel: [f32; 3]) -> [f32; 3] {
        let color = match &self.transform {
            Some(rows) => rows.map(|row| row[0] * pixel[0] + row[1] * pixel[1] + row[2] * pixel[2]),
            None => pixel,
        };
        color.map(|value| (f64::from(value) * self.factor).max(0.0) as f32)
    }

    fn luminance(&self, color: [f32; 3]) -> f64 {
        color.iter().zip(self.weights).map(|(value, weight)| f64::from(*value) * weight).sum()
    }
}

/// A colour mixed with the grey that rods see, by its luminance in cd/m².
fn with_rods(color: [f32; 3], luminance: f64) -> [f64; 3] {
    let color = color.map(f64::from);
    let cones = cones(luminance);
    let rods: f64 = color.iter().zip(RODS).map(|(value, weight)| value * weight).sum();
    color.map(|value| cones * value + (1.0 - cones) * rods)
}

/// The mapping from scene luminance to display output.
enum ToneMap {
    Linear {
        /// Output divided by luminance.
        factor: f64,
    },
    /// By the cumulative distribution at each bin, and 1.
    Adjusted { limits: [f64; 2], cumulative: Vec<f64> },
}

impl ToneMap {
    fn new(luminances: impl Iterator<Item = f64>, tones: Tones) -> Result<ToneMap, ToolError> {
        let mut counts = vec![0u64; ((BRIGHTEST - DARKEST) * BINS_A_UNIT) as usize + 1];
        let mut limits = [f64::INFINITY, f64::NEG_INFINITY];
        for brightness in luminances.map(f64::ln).filter(|brightness| (DARKEST..=BRIGHTEST).contains(brightness)) {
            counts[bin(brightness)] += 1;
            limits = [limits[0].min(brightness), limits[1].max(brightness)];
        }
        let [low, high] = limits;
        if low > high {
            return Err(ToolError::NothingVisible { most: VISIBLE[1] });
        }
        let histogram = Histogram { first: bin(low), counts: counts[bin(low)..=bin(high)].to_vec() };
        let fits = high - low < RANGE.ln();
        let adjusted = if tones == Tones::Linear || fits { None } else { histogram.adjusted(limits, tones) };
        Ok(match adjusted {
            Some(cumulative) => ToneMap::Adjusted { limits, cumulative },
            None if tones == Tones::Human => {
                let middle = TOP / RANGE.sqrt();
                ToneMap::Linear { factor: threshold(middle) / threshold(histogram.mean().exp()) / TOP }
            }
            None => ToneMap::Linear { factor: high.exp().recip() },
        })
    }

    /// The output for a luminance, relative to the display's maximum.
    fn light(&self, luminance: f64) -> f64 {
        /// The output of the display's black.
        const BLACK: f64 = 1.0 / RANGE;
        let brightness = luminance.ln();
        if brightness.is_nan() || brightness < DARKEST {
            return 0.0;
        }
        match self {
            ToneMap::Linear { factor } => {
                let light = factor * luminance;
                // Values just above black fade into it.
                let above = if light >= 2.0 * BLACK { light - BLACK } else { light * light / (4.0 * BLACK) };
                above / (1.0 - BLACK)
            }
            ToneMap::Adjusted { limits: [low, high], cumulative } => {
                let bins = cumulative.len() - 1;
                let position = ((brightness - low) / (high - low)).clamp(0.0, 1.0) * bins as f64;
                (RANGE.powf(share_at(cumulative, position) - 1.0) - BLACK) / (1.0 - BLACK)
            }
        }
    }
}

fn bin(brightness: f64) -> usize {
    ((brightness - DARKEST) * BINS_A_UNIT) as usize
}

/// Number of pixels per brightness bin, from the darkest to the brightest.
struct Histogram {
    /// Index of the first bin.
    first: usize,
    counts: Vec<u64>,
}

impl Histogram {
    /// The brightness at the centre of a bin.
    fn middle(&self, bin: usize) -> f64 {
        DARKEST + ((self.first + bin) as f64 + 0.5) / BINS_A_UNIT
    }

    fn mean(&self) -> f64 {
        let sum: f64 = self.counts.iter().enumerate().map(|(bin, count)| *count as f64 * self.middle(bin)).sum();
        sum / self.counts.iter().sum::<u64>() as f64
    }

    /// Truncates bins above the ceiling until the excess is small. Returns the cumulative
    /// distribution at each bin, and 1; `None` if too little is left.
    fn adjusted(&self, [low, high]: [f64; 2], tones: Tones) -> Option<Vec<f64>> {
        let mut counts = self.counts.clone();
        let mut total: u64 = counts.iter().sum();
        let least = total / LEFT + 1;
        loop {
            let cumulative = cumulative(counts.iter().map(|count| *count as f64), total as f64);
            // The count of a bin whose contrast equals the scene's (Eq. 6 of the paper).
            let even = total as f64 * (high - low) / (counts.len() as f64 * RANGE.ln());
            let mut trimmings = 0;
            for (bin, count) in counts.iter_mut().enumerate() {
                let ratio = match tones {
                    Tones::Human => {
                        let world = self.middle(bin).exp();
                        let shown = TOP * RANGE.powf(0.5 * (cumulative[bin] + cumulative[bin + 1]) - 1.0);
                        // Eq. 10.
                        threshold(shown) * world / (threshold(world) * shown)
                    }
                    _ => 1.0,
                };
                let kept = (*count).min((even * ratio + 1.0) as u64);
                trimmings += *count - kept;
                *count = kept;
            }
            total -= trimmings;
            if total <= least {
                return None;
            }
            if ABOVE * trimmings <= total {
                return Some(cumulative);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light(luminances: &[f64], tones: Tones) -> Vec<f64> {
        let map = ToneMap::new(luminances.iter().copied(), tones).expect("something is visible");
        luminances.iter().map(|luminance| map.light(*luminance)).collect()
    }

    #[test]
    fn what_fits_the_display_keeps_its_contrast() {
        for tones in [Tones::Automatic, Tones::Linear] {
            let found = light(&[10.0, 20.0, 40.0], tones);
            // Subtract the display's black.
            let expected = [0.25f64, 0.5, 1.0].map(|light| (light - 0.01) / 0.99);
            assert!(found.iter().zip(expected).all(|(found, light)| (found - light).abs() < 1e-12), "{found:?}");
        }
    }

    #[test]
    fn a_wide_range_is_pressed_together_and_keeps_its_order() {
        let luminances: Vec<f64> = (0..1000).map(|i| 10f64.powf(f64::from(i) / 125.0 - 3.0)).collect();
        for tones in [Tones::Automatic, Tones::Human] {
            let found = light(&luminances, tones);
            assert!(found.windows(2).all(|two| two[0] <= two[1]), "{tones:?}");
            assert!((found[999] - 1.0).abs() < 0.02 && found[0] < 1e-3, "{tones:?}: {} {}", found[0], found[999]);
            // Contrast never exceeds the scene's.
            let shown = |light: f64| light * 0.99 + 0.01;
            let step = luminances[1] / luminances[0];
            assert!(tones == Tones::Human || found.windows(2).all(|two| shown(two[1]) / shown(two[0]) <= step * 1.01));
        }
        let linear = light(&luminances, Tones::Linear);
        assert!(linear.iter().filter(|light| **light > 0.01).count() < 300);
    }

    #[test]
    fn black_is_nothing_to_map() {
        for luminances in [&[0.0, 0.0][..], &[f64::NAN], &[]] {
            assert!(ToneMap::new(luminances.iter().copied(), Tones::Automatic).is_err());
        }
    }
}
