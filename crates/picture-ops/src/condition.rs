//! `pcond`: tone mapping that reproduces what an observer would see, within the range of a display.
//!
//! G. Ward Larson, H. Rushmeier, C. Piatko, "A Visibility Matching Tone Reproduction Operator for
//! High Dynamic Range Scenes", IEEE Transactions on Visualization and Computer Graphics 3(4), 1997.
//! A histogram of foveal adaptation luminances is adjusted so that displayed contrast nowhere
//! exceeds visible contrast. Veiling glare, acuity and mesopic colour follow the same adaptation.
//! Where Radiance's constants differ from the paper's, Radiance's are used.

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

/// The simulated limits of the eye.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Eye {
    /// Blurs regions that are too dim to be seen sharply.
    pub acuity: bool,
    /// Adds the veiling glare of bright regions.
    pub veil: bool,
    /// Limits contrast to the contrast sensitivity of the eye instead of the scene's contrast.
    pub sensitivity: bool,
    /// Desaturates dim colours.
    pub color: bool,
}

/// The mapping from luminance to display output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// Histogram adjustment, if the scene's range exceeds the display's.
    Histogram,
    /// A linear factor that follows from the adaptation.
    Linear,
    /// This linear factor, above 0.
    Factor(f64),
}

/// Options of [`condition`].
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionOptions {
    /// The simulated limits of the eye; none by default.
    pub eye: Eye,
    /// The source of adaptation; the whole picture by default.
    pub adaptation: Adaptation,
    /// The mapping from luminance to display output; histogram adjustment by default.
    pub exposure: Exposure,
    /// The display's largest luminance, cd/m²; 100 by default.
    pub display_top: f64,
    /// The display's dynamic range, its largest luminance divided by its smallest; 100 by default.
    pub display_range: f64,
    /// The display's colour space; Radiance's primaries by default.
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

/// A pair of scene luminance and display luminance, cd/m².
pub type MappedLuminance = [f64; 2];

/// The mesopic range, cd/m²: below it vision is by rods alone, above it by cones alone.
pub(crate) const MESOPIC: [f64; 2] = [5.62e-3, 5.62];
/// The smallest and the largest luminance considered, cd/m².
pub(crate) const VISIBLE: [f64; 2] = [1e-7, 1e7];
/// Smaller values are zero.
const TINY: f64 = 1e-6;

/// Tone maps a picture and returns the mapping used. `command` is added to the header.
///
/// # Errors
/// When the picture cannot be read or has no visible pixel, or the output cannot be written.
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

/// A reader at the start of the picture.
fn reopened<S: Read + Seek>(source: &mut S) -> Result<PictureReader<&mut S>, ToolError> {
    source.rewind().map_err(radsight_picture::PictureError::from)?;
    Ok(PictureReader::new(source)?)
}

/// The steps to apply to a picture.
struct Plan {
    eye: Eye,
    is_linear: bool,
}

impl Plan {
    fn new(options: &ConditionOptions, histogram: &Histogram, fovea: &Fovea) -> Plan {
        /// The smallest range of brightness, in natural logarithms, that causes visible glare.
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

/// The output header: the valid lines of the input, the command, and the changed variables.
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

/// Interpolation position of a pixel in a smaller picture: the sample before it, and the fraction
/// towards the next.
fn between(position: usize, length: usize, samples: usize) -> (usize, f64) {
    let at = (position as f64 + 0.5) / length as f64 * samples as f64 - 0.5;
    // Truncation towards zero, so that positions before the first sample are extrapolated.
    let before = (at as usize).min(samples.saturating_sub(2));
    (before, at - before as f64)
}
