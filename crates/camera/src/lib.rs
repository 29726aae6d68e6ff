//! The camera file: camera, light ring and sensor, and the ring as scene text.
//!
//! [`CameraFile::read`] takes the text of a `camera.toml` and gives checked values, or every
//! mistake in it with line, column and hint. [`Rig::scene_text`] writes the ring of LEDs as
//! Radiance scene text that stands on its own.
//!
//! Guarantees: a file that is read without error describes a camera, ring and sensor that exist;
//! hostile text ends in errors, in bounded time and memory. May not know the renderer; files come
//! through a [`Loader`].
//!
//! ```
//! use radsight_camera::CameraFile;
//! use radsight_diag::SourceMap;
//! use radsight_loader::MemoryLoader;
//! let text = b"[camera]
//! position_m = [0.0, 0.0, 0.48]
//! direction = [0.0, 0.0, -1.0]
//! up = [0.0, 1.0, 0.0]
//! pixels = [192, 165]
//! pixel_pitch_um = [13.75, 16.0]
//! focal_distance_mm = 6.75
//! pinhole_diameter_mm = -0.1
//! exposure_ms = 10.0
//! ";
//! let mut sources = SourceMap::default();
//! let errors = CameraFile::read("camera.toml", text, &mut sources, &MemoryLoader::default()).unwrap_err();
//! assert_eq!(
//!     errors[0].render(&sources),
//!     "camera.toml:8:23: error: \"pinhole_diameter_mm\" must be positive, not -0.1\n  8 | pinhole_diameter_mm = -0.1\n    |                       ^^^^\n"
//! );
//! ```
#![forbid(unsafe_code)]

mod alignment;
mod alignment_section;
mod angular_table;
mod camera_section;
mod flicker_section;
mod inapplicable;
mod key_place;
mod lobe_pattern;
mod matrix_file;
mod number_table;
mod parallel_section;
mod replaced_keys;
mod rig;
mod rig_section;
mod section;
mod sensor_section;
mod shutter;
mod summary;

pub use alignment::{Alignment, LedAlignment, Tolerances};
pub use angular_table::AngularTable;
pub use key_place::place_of;
pub use number_table::{NumberTable, NumberTableRow, read_measurements};
pub use replaced_keys::{KeyError, with_key};
pub use rig::{LedEmission, Rig};
pub use shutter::{Flicker, FlickeringLamp, Shutter, Waveform};

use alignment_section::Leds;
use radsight_diag::{Diagnostic, SourceId, SourceMap, hint_nearest};
use radsight_loader::Loader;
use radsight_pinhole::{BandWeights, BandWeightsError, PinholeCamera};
use radsight_sensor::{Bayer, Sensor};
use section::{Section, shorten};
use std::collections::BTreeSet;
use toml::de::{DeTable, DeValue};

/// The largest camera file that is read, bytes.
const LARGEST_FILE: usize = 1 << 20;

/// Messages about one file after which the rest are only counted.
const MOST_MESSAGES: usize = 50;

/// The tables of a camera file.
const SECTIONS: [&str; 6] = ["camera", "rig", "sensor", "alignment", "tolerances", "flicker"];

/// All that a camera file says.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraFile {
    /// The pinhole camera.
    pub camera: PinholeCamera,
    /// The light ring, where there is one.
    pub rig: Option<Rig>,
    /// The sensor, where there is one.
    pub sensor: Option<Sensor>,
    /// How the bands of a coloured scene add up, where the file says so; see
    /// [`CameraFile::band_weights_for`].
    pub band_weights: Option<BandWeights>,
    /// The mosaic of colour filters before the pixels, where there is one; its filters are in the
    /// band weights.
    pub mosaic: Option<Bayer>,
    /// Where the parts of this specimen are, where the file says that they are not at their nominal
    /// places; camera and rig have it.
    pub alignment: Option<Alignment>,
    /// When each row is exposed.
    pub shutter: Shutter,
    /// Lamps that flicker, each named once.
    pub flickering: Vec<FlickeringLamp>,
    /// Warnings: values that are allowed but are probably mistakes.
    pub warnings: Vec<Diagnostic>,
}

impl CameraFile {
    /// Reads the text of a camera file, called `name` in messages. Files that it names are looked
    /// for beside it.
    ///
    /// # Errors
    /// Everything that is wrong with the file; never empty.
    pub fn read(
        name: &str,
        bytes: &[u8],
        sources: &mut SourceMap,
        loader: &dyn Loader,
    ) -> Result<Self, Vec<Diagnostic>> {
        let source = sources.add(name, bytes, None);
        let text = as_text(bytes, source, sources).map_err(|error| vec![error])?;
        let (document, errors) = DeTable::parse_recoverable(text);
        if !errors.is_empty() {
            return Err(syntax_errors(&errors, text, source, sources));
        }
        let mut found = Found::default();
        let file = read_document(document.get_ref(), name, source, sources, loader, &mut found);
        match file {
            Some(file) if found.errors.is_empty() => Ok(CameraFile { warnings: found.warnings, ..file }),
            _ => Err(in_file_order(found.errors, source)),
        }
    }

    /// How bright lamps that flicker so are while each row is exposed, as shares of their mean; one
    /// share for all rows where the shutter is global.
    #[must_use]
    pub fn brightness_by_row(&self, flicker: &Flicker) -> Vec<f64> {
        let rows = if self.shutter == Shutter::Global { 1 } else { self.camera.rows() };
        let exposure_s = self.camera.exposure_s();
        (0..rows).map(|row| flicker.mean(self.shutter.start_s(row), exposure_s)).collect()
    }

    /// The weights for radiances of `bands` bands: those of the file, or equal ones.
    ///
    /// # Errors
    /// When the file gives weights or wavelengths for another number of bands.
    pub fn band_weights_for(&self, bands: usize) -> Result<BandWeights, BandWeightsError> {
        let wavelengths = self.camera.band_wavelengths_m().len();
        let is_even = self.band_weights.as_ref().is_none_or(|weights| {
            let weights = weights.as_slice();
            weights.len() == wavelengths && weights.iter().all(|weight| *weight == weights[0])
        });
        if wavelengths > 0 && wavelengths != bands && !(bands == 1 && is_even) {
            return Err(BandWeightsError::Wavelengths { bands, wavelengths });
        }
        self.band_weights.as_ref().map_or_else(|| Ok(BandWeights::equal(bands)), |weights| weights.for_bands(bands))
    }
}

/// Messages collected while reading.
#[derive(Debug, Default)]
pub(crate) struct Found {
    pub(crate) errors: Vec<Diagnostic>,
    pub(crate) warnings: Vec<Diagnostic>,
}

fn as_text<'a>(bytes: &'a [u8], source: SourceId, sources: &SourceMap) -> Result<&'a str, Diagnostic> {
    if bytes.len() > LARGEST_FILE {
        return Err(Diagnostic::error(format!(
            "the camera file has {} bytes, expected at most {LARGEST_FILE}",
            bytes.len()
        ))
        .at(sources.span(source, 0, 0)));
    }
    std::str::from_utf8(bytes).map_err(|error| {
        let at = error.valid_up_to();
        Diagnostic::error("the camera file is not UTF-8 text").at(sources.span(source, at, at + 1))
    })
}

/// The messages of the TOML parser, the first of each line: later ones of a line mostly follow
/// from the first.
fn syntax_errors(errors: &[toml::de::Error], text: &str, source: SourceId, sources: &SourceMap) -> Vec<Diagnostic> {
    let mut diagnostics = Vec::new();
    let mut lines_seen = BTreeSet::new();
    for error in errors {
        let span = error.span().unwrap_or(0..0);
        let before = &text.as_bytes()[..span.start.min(text.len())];
        let line_start = before.iter().rposition(|&byte| byte == b'\n').map_or(0, |at| at + 1);
        if lines_seen.insert(line_start) {
            let message = error.message().lines().collect::<Vec<_>>().join(", ");
            let line = text[line_start..].lines().next().unwrap_or_default();
            let error = Diagnostic::error(shorten(&message)).at(sources.span(source, span.start, span.end));
            diagnostics.push(error.maybe_hint(number_hint(line)));
        }
        if diagnostics.len() == MOST_MESSAGES {
            break;
        }
    }
    in_file_order(diagnostics, source)
}

/// How a number without a digit on one side of its point is written in TOML.
fn number_hint(line: &str) -> Option<String> {
    let (_, value) = line.split('#').next()?.split_once('=')?;
    let lacks_digit = |word: &&str| word.trim_start_matches(['+', '-']).starts_with('.') || word.ends_with('.');
    let mut words = value.split(|letter: char| letter.is_whitespace() || "[],".contains(letter)).filter(lacks_digit);
    let number: f64 = words.find_map(|word| word.parse().ok())?;
    Some(format!("write {number:?}"))
}

/// Messages of the file itself by their place in it, then those of other files, at most
/// [`MOST_MESSAGES`].
fn in_file_order(mut messages: Vec<Diagnostic>, source: SourceId) -> Vec<Diagnostic> {
    messages.sort_by_key(|message| message.span.map(|span| (span.source != source, span.source, span.start)));
    let left_out = messages.len().saturating_sub(MOST_MESSAGES);
    messages.truncate(MOST_MESSAGES);
    if left_out > 0 {
        messages.push(Diagnostic::error(format!("{left_out} more errors")));
    }
    messages
}

fn read_document(
    document: &DeTable<'_>,
    name: &str,
    source: SourceId,
    sources: &mut SourceMap,
    loader: &dyn Loader,
    found: &mut Found,
) -> Option<CameraFile> {
    for (key, value) in document.iter().filter(|(key, _)| !SECTIONS.contains(&key.get_ref().as_ref())) {
        let place = sources.span(source, key.span().start, key.span().end);
        let kind = if matches!(value.get_ref(), DeValue::Table(_)) { "table" } else { "key" };
        let message = format!(
            "unknown {kind} \"{}\", expected [camera], [rig], [sensor], [alignment], [tolerances] and [flicker]",
            shorten(key.get_ref())
        );
        found.errors.push(Diagnostic::error(message).at(place).maybe_hint(hint_nearest(key.get_ref(), SECTIONS)));
    }
    let camera_section = Section::open(document, "camera", source, sources, found);
    if camera_section.is_none() && !document.contains_key("camera") {
        found.errors.push(Diagnostic::error("the camera file has no [camera]").at(sources.span(source, 0, 0)));
    }
    let camera = camera_section.and_then(|section| camera_section::read(section, name, sources, loader, found));
    let (camera, shutter) = camera.map_or((None, Shutter::Global), |(camera, shutter)| (Some(camera), shutter));
    let lamps = Section::open_inner(document, "flicker", source, sources, found);
    let flickering: Vec<FlickeringLamp> = lamps
        .into_iter()
        .filter_map(|(modifier, section)| flicker_section::read(modifier, section, sources, found))
        .collect();
    let rig = Section::open(document, "rig", source, sources, found)
        .and_then(|section| rig_section::read(section, camera.as_ref(), name, sources, loader, found));
    let sensor = Section::open(document, "sensor", source, sources, found)
        .and_then(|section| sensor_section::read(section, camera.as_ref(), name, sources, loader, found));
    let (sensor, band_weights, mosaic) =
        sensor.map_or((None, None, None), |read| (Some(read.sensor), read.band_weights, read.mosaic));
    let leds = match &rig {
        Some(rig) => Leds::Known(rig.leds as usize),
        None if document.contains_key("rig") => Leds::Wrong,
        None => Leds::None,
    };
    let stated = Section::open(document, "alignment", source, sources, found);
    let tolerated = Section::open(document, "tolerances", source, sources, found);
    let alignment = alignment_section::read(stated, tolerated, leds, sources, found);
    let (camera, rig) = match &alignment {
        Some(alignment) => alignment_section::apply(alignment, camera?, rig, found)?,
        None => (camera?, rig),
    };
    // The light that the wings of a pattern add to a row belongs to the time of that row.
    let rolls = shutter != Shutter::Global && !flickering.is_empty();
    let camera = if rolls { camera.with_whole_pattern() } else { camera };
    let warnings = Vec::new();
    Some(CameraFile { camera, rig, sensor, band_weights, mosaic, alignment, shutter, flickering, warnings })
}
