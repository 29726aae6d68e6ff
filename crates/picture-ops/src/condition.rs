//! `pcond`: a picture as the eye would see the scene, within what a display can show.
//!
//! G. Ward Larson, H. Rushmeier, C. Piatko, "A Visibility Matching Tone Reproduction Operator for High Dynamic Range Scenes", IEEE
//! Transactions on Visualization and Computer Graphics 3(4), 1997: a histogram of what the fovea adapts to is turned into a map from
//! luminance to display, whose contrast nowhere exceeds what the eye has; glare, acuity and the colours of dim light follow the same
//! adaptation. Where Radiance's constants are others than the paper's, they are Radiance's.

mod acuity;
mod device;
mod foveal;
mod histogram;
mod luminance;
mod mapping;
mod scotopic;
mod veil;
mod warp;

use crate::ToolError;
use crate::drand48::Drand48;
use acuity::Acuity;
pub use device::{Device, Macbeth};
use foveal::Fovea;
use histogram::Histogram;
pub use histogram::{Adaptation, MeasuredHistogram};
pub(crate) use luminance::{Luminance, RODS};
pub(crate) use mapping::threshold;
use mapping::{Mapping, ToneMap};
use radsight_picture::{Encoding, Header, PictureReader, PictureWriter};
pub(crate) use scotopic::cones;
use std::io::{Read, Seek, Write};
use veil::Veil;
pub use warp::ColorWarp;

/// Which limits of the eye are imitated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Eye {
    /// What is too dim to be seen sharply is blurred.
    pub acuity: bool,
    /// Bright places cast a veil over the others.
    pub veil: bool,
    /// Contrast is what the eye has at the scene's luminance, instead of what keeps the scene's contrast.
    pub sensitivity: bool,
    /// Dim colours turn grey.
    pub color: bool,
}

/// How luminance becomes light of the display.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// By the histogram, where the picture has a wider range than the display.
    Histogram,
    /// In proportion, by a factor that follows from the adaptation.
    Linear,
    /// In proportion, by this factor, above 0.
    Factor(f64),
}

/// What is asked of [`condition`].
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionOptions {
    /// The limits of the eye; none by default.
    pub eye: Eye,
    /// What the eye adapts to; the whole picture by default.
    pub adaptation: Adaptation,
    /// How luminance becomes light; by the histogram by default.
    pub exposure: Exposure,
    /// The display's largest luminance, in cd/m²; 100 by default.
    pub display_top: f64,
    /// The display's largest luminance over its smallest; 100 by default.
    pub display_range: f64,
    /// The display's colours; Radiance's primaries by default.
    pub device: Device,
}

impl Default for ConditionOptions {
    fn default() -> ConditionOptions {
        ConditionOptions {
            eye: Eye::default(),
            adaptation: Adaptation::default(),
            exposure: Exposure::Histogram,
            display_top: 100.0,
            display_range: 100.0,
            device: Device::Standard,
        }
    }
}

/// A pair of the map from luminance of the scene to luminance of the display, both in cd/m².
pub type MappedLuminance = [f64; 2];

/// The luminances between which the eye sees by rods and cones, in cd/m²: below all is grey, above colours are full.
pub(crate) const MESOPIC: [f64; 2] = [5.62e-3, 5.62];
/// The smallest and the largest luminance that are looked at, in cd/m².
pub(crate) const VISIBLE: [f64; 2] = [1e-7, 1e7];
/// Below this something is zero.
const TINY: f64 = 1e-6;

/// Conditions a picture and gives the map that was used. `command` goes to the header.
///
/// # Errors
/// When the picture cannot be read or has nothing visible, or the output not be written.
pub fn condition<S: Read + Seek, W: Write>(
    mut source: S,
    options: &ConditionOptions,
    command: &[&str],
    target: W,
) -> Result<Vec<MappedLuminance>, ToolError> {
    let mut reader = reopened(&mut source)?;
    let (input, resolution) = (reader.header().clone(), reader.resolution());
    let luminance = Luminance::new(&input, reader.encoding())?;
    let mut fovea = Fovea::new(reader, resolution, &input)?;
    let mut random = Drand48::default();
    let mut histogram = Histogram::new(&options.adaptation, &fovea, &luminance, &mut random, &mut source)?;
    let mut plan = Plan::new(options, &histogram, &fovea);
    let mut veil = None;
    if plan.eye.veil {
        veil = Some(Veil::new(&mut fovea)?);
        histogram = Histogram::new(&options.adaptation, &fovea, &luminance, &mut random, &mut source)?;
    }
    let mapping = plan.mapping(options, &histogram, &luminance);
    let correction = options.device.correction(&input, &luminance)?;
    let recorded = mapping.recorded_exposure(&luminance);
    let header = output_header(&input, command, &options.device, recorded);
    let mut acuity = plan.eye.acuity.then(|| Acuity::new(&fovea, &luminance));
    reader = reopened(&mut source)?;
    let mut writer = PictureWriter::new(target, &header, 3, resolution)?;
    let mut pixels = vec![[0.0f32; 3]; resolution.scanline_length()];
    for scanline in 0..resolution.scanlines() {
        match &mut acuity {
            Some(acuity) => acuity.read(scanline, &mut reader, &mut pixels)?,
            None => reader.read_three(&mut pixels)?,
        }
        if let Some(veil) = &veil {
            veil.add(scanline, &resolution, &mut pixels);
        }
        if plan.eye.color {
            pixels.iter_mut().for_each(|pixel| scotopic::fade(pixel, &luminance));
        }
        pixels.iter_mut().for_each(|pixel| mapping.map(pixel, &luminance));
        if let Some(correction) = &correction {
            pixels.iter_mut().for_each(|pixel| *pixel = correction.apply(*pixel));
        }
        writer.write_values(pixels.as_flattened())?;
    }
    writer.finish()?;
    Ok(mapping.pairs(&histogram, options, &luminance))
}

/// The picture from its start.
fn reopened<S: Read + Seek>(source: &mut S) -> Result<PictureReader<&mut S>, ToolError> {
    source.rewind().map_err(radsight_picture::PictureError::from)?;
    Ok(PictureReader::new(source)?)
}

/// What is worth doing to a picture.
struct Plan {
    eye: Eye,
    is_linear: bool,
}

impl Plan {
    fn new(options: &ConditionOptions, histogram: &Histogram, fovea: &Fovea) -> Plan {
        /// The smallest range of brightness, in natural logarithms, in which glare is seen.
        const GLARING: f64 = 4.5;
        let range = histogram.range();
        let is_linear = options.exposure != Exposure::Histogram || range <= options.display_range.ln();
        let mut eye = options.eye;
        eye.veil &= range >= GLARING;
        let dim = histogram.percentile(0.05).exp();
        eye.acuity &= acuity::cycles_a_degree(dim) < fovea.pixels_a_degree() / 2.0;
        eye.color &= dim < MESOPIC[1];
        Plan { eye, is_linear }
    }

    fn mapping(&mut self, options: &ConditionOptions, histogram: &Histogram, luminance: &Luminance) -> Mapping {
        let tone_map = if self.is_linear { None } else { ToneMap::new(histogram, options) };
        match tone_map {
            Some(map) => Mapping::Tones(Box::new(map)),
            None => Mapping::linear(options, histogram, luminance),
        }
    }
}

/// All lines of the input but those that no longer hold, the command, and what has changed.
fn output_header(input: &Header, command: &[&str], device: &Device, exposure: Option<f64>) -> Header {
    let mut header = input.clone();
    for name in ["FORMAT", "NCOMP", "WAVELENGTH_SPLITS", "PRIMARIES", "EXPOSURE"] {
        header.remove(name);
    }
    header.push_command(command.iter().copied());
    if let Device::Primaries(primaries) = device {
        header.push_variable("PRIMARIES", &primaries.to_header_value());
    }
    if let Some(exposure) = exposure {
        header.push_exposure(exposure);
    }
    header.push_variable("FORMAT", Encoding::Rgbe.name());
    header
}

/// Where a pixel lies between the samples of a smaller picture: the sample before it, and how far it is towards the next.
fn between(position: usize, length: usize, samples: usize) -> (usize, f64) {
    let place = (position as f64 + 0.5) / length as f64 * samples as f64 - 0.5;
    // Cut towards zero, so that what lies before the first sample is extrapolated.
    let before = (place as usize).min(samples.saturating_sub(2));
    (before, place - before as f64)
}
