//! Streams of rays and radiances as numbers.
//!
//! [`RayStream`] writes origin and direction, six numbers per ray. [`ExposureStream`] reads the
//! radiances that `rtrace` returns and gives the exposure of each pixel after its last ray. Both
//! work in pieces, so memory stays bounded.

use crate::{BandWeights, BandWeightsError, CameraRay, PixelAverage, Rays};

/// Maximum length of a number as text, in bytes.
const MAX_NUMBER_BYTES: usize = 64;

/// First bytes of every Radiance header.
const HEADER_MAGIC: &[u8] = b"#?RADIANCE";

/// Number formats, by the letter of Radiance's `-f` option.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NumberFormat {
    /// `d`: 8-byte binary in native byte order. Exact.
    #[default]
    Double,
    /// `f`: 4-byte binary in native byte order.
    Float,
    /// `a`: text. Written with enough digits to recover a double exactly.
    Ascii,
}

impl NumberFormat {
    /// The format of a letter.
    #[must_use]
    pub fn from_letter(letter: char) -> Option<Self> {
        match letter {
            'd' => Some(NumberFormat::Double),
            'f' => Some(NumberFormat::Float),
            'a' => Some(NumberFormat::Ascii),
            _ => None,
        }
    }

    /// Appends `values` as one record: in text with tabs between them and a line end.
    pub fn encode(self, values: &[f64], out: &mut Vec<u8>) {
        match self {
            NumberFormat::Double => values.iter().for_each(|value| out.extend(value.to_ne_bytes())),
            NumberFormat::Float => values.iter().for_each(|value| out.extend((*value as f32).to_ne_bytes())),
            NumberFormat::Ascii => {
                let words: Vec<String> = values.iter().map(|value| format!("{value:e}")).collect();
                out.extend(words.join("\t").into_bytes());
                out.push(b'\n');
            }
        }
    }

    /// Bytes of one number; `None` for text.
    fn width(self) -> Option<usize> {
        match self {
            NumberFormat::Double => Some(8),
            NumberFormat::Float => Some(4),
            NumberFormat::Ascii => None,
        }
    }
}

/// Appends one ray: origin x y z, direction x y z.
pub fn encode_ray(format: NumberFormat, ray: &CameraRay, out: &mut Vec<u8>) {
    let (o, d) = (ray.origin, ray.direction);
    format.encode(&[o.x, o.y, o.z, d.x, d.y, d.z], out);
}

/// The rays of a picture in stream order, a piece at a time.
#[derive(Debug)]
pub struct RayStream<'a> {
    rays: &'a Rays,
    format: NumberFormat,
    next: u64,
}

impl<'a> RayStream<'a> {
    /// Starts at the first ray.
    #[must_use]
    pub fn new(rays: &'a Rays, format: NumberFormat) -> Self {
        RayStream { rays, format, next: 0 }
    }

    /// Appends up to `most` rays and returns how many; 0 at the end.
    pub fn fill(&mut self, most: u64, out: &mut Vec<u8>) -> u64 {
        let end = self.next.saturating_add(most).min(self.rays.count());
        let start = std::mem::replace(&mut self.next, end);
        (start..end).for_each(|index| encode_ray(self.format, &self.rays.of_index(index), out));
        end - start
    }
}

/// An error in a stream of radiances.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StreamError {
    /// Fewer radiances than rays.
    #[error(
        "the stream ended after {found} of {expected} radiances of {bands} value(s){}: were samples and seed the same as for the rays?",
        left_over(*.left_over_bytes)
    )]
    Short {
        /// Complete radiances received.
        found: u64,
        /// Number of rays.
        expected: u64,
        /// Values per radiance.
        bands: usize,
        /// Bytes of an incomplete radiance.
        left_over_bytes: u64,
    },
    /// More radiances than rays.
    #[error("the stream continues after all {expected} radiances of {bands} value(s)")]
    Long {
        /// Number of rays.
        expected: u64,
        /// Values per radiance.
        bands: usize,
    },
    /// `rtrace` was run without `-h`.
    #[error("the stream begins with a Radiance header, expected bare numbers: give rtrace the option -h")]
    Header,
    /// Text that is not a number.
    #[error("radiance {radiance} (from 0): expected a number, found \"{text}\"")]
    NotANumber {
        /// Index of the radiance, from 0.
        radiance: u64,
        /// The text, truncated if it is long.
        text: String,
    },
    /// A NaN or an infinity.
    #[error("radiance {radiance} (from 0) is {value}, expected a finite number")]
    NotFinite {
        /// Index of the radiance, from 0.
        radiance: u64,
        /// The value.
        value: f64,
    },
    /// The number of weights differs from the number of bands.
    #[error(transparent)]
    Bands(#[from] BandWeightsError),
}

fn left_over(bytes: u64) -> String {
    if bytes == 0 { String::new() } else { format!(" and {bytes} byte(s) of the next") }
}

/// Converts a stream of radiances to exposures.
#[derive(Debug)]
pub struct ExposureStream<'a> {
    rays: &'a Rays,
    weights: BandWeights,
    format: NumberFormat,
    bands: usize,
    started: bool,
    pending: Vec<u8>,
    values: Vec<f64>,
    next: u64,
    /// One per separate band, or one.
    averages: Vec<PixelAverage>,
    /// The separate bands of a ray.
    apart: Vec<f64>,
}

impl<'a> ExposureStream<'a> {
    /// Expects `bands` values per ray (at least one) in `format`.
    ///
    /// # Errors
    /// If `weights` are for another number of bands.
    pub fn new(rays: &'a Rays, weights: &BandWeights, format: NumberFormat, bands: usize) -> Result<Self, StreamError> {
        let bands = bands.max(1);
        let weights = weights.for_bands(bands)?;
        let apart = rays.bands_apart(&weights);
        Ok(ExposureStream {
            averages: vec![PixelAverage::default(); apart.unwrap_or(1)],
            apart: vec![0.0; apart.unwrap_or(0)],
            rays,
            weights,
            format,
            bands,
            started: false,
            pending: Vec::new(),
            values: Vec::with_capacity(bands),
            next: 0,
        })
    }

    /// Reads the next piece of the stream and appends the exposure (J/m²) of each completed pixel,
    /// by separate band of [`Rays::bands_apart`].
    ///
    /// # Errors
    /// If the piece contains something other than finite numbers, or more than expected.
    pub fn feed(&mut self, piece: &[u8], exposures: &mut Vec<f64>) -> Result<(), StreamError> {
        self.pending.extend_from_slice(piece);
        if !self.started {
            if self.pending.starts_with(HEADER_MAGIC) {
                return Err(StreamError::Header);
            }
            if HEADER_MAGIC.starts_with(&self.pending) {
                return Ok(()); // Too little to tell; a stream that ends here is short in any case.
            }
            self.started = true;
        }
        let pending = std::mem::take(&mut self.pending);
        let used = match self.format.width() {
            Some(width) => self.take_binary(&pending, width, exposures)?,
            None => self.take_text(&pending, exposures)?,
        };
        self.pending = pending[used..].to_vec();
        Ok(())
    }

    /// Ends the stream. Appends the pixel that a last number without white space after it
    /// completes.
    ///
    /// # Errors
    /// If radiances are missing.
    pub fn finish(mut self, exposures: &mut Vec<f64>) -> Result<(), StreamError> {
        if self.format == NumberFormat::Ascii && !self.pending.is_empty() {
            self.started = true;
            self.feed(b"\n", exposures)?;
        }
        let expected = self.rays.count();
        let width = self.format.width().unwrap_or(1);
        let left_over_bytes = (self.values.len() * width + self.pending.len()) as u64;
        if self.next < expected {
            return Err(StreamError::Short { found: self.next, expected, bands: self.bands, left_over_bytes });
        }
        if left_over_bytes > 0 {
            return Err(StreamError::Long { expected, bands: self.bands });
        }
        Ok(())
    }

    fn take_binary(&mut self, bytes: &[u8], width: usize, exposures: &mut Vec<f64>) -> Result<usize, StreamError> {
        let whole = bytes.chunks_exact(width);
        let used = bytes.len() - whole.remainder().len();
        for number in whole {
            let value = match number.try_into() {
                Ok(double) => f64::from_ne_bytes(double),
                Err(_) => f64::from(f32::from_ne_bytes([number[0], number[1], number[2], number[3]])),
            };
            self.take_value(value, exposures)?;
        }
        Ok(used)
    }

    fn take_text(&mut self, bytes: &[u8], exposures: &mut Vec<f64>) -> Result<usize, StreamError> {
        // The last word may continue in the next piece.
        let used = bytes.iter().rposition(u8::is_ascii_whitespace).map_or(0, |at| at + 1);
        if bytes.len() - used > MAX_NUMBER_BYTES {
            return Err(self.not_a_number(&bytes[used..]));
        }
        for word in bytes[..used].split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()) {
            let value = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
            self.take_value(value.ok_or_else(|| self.not_a_number(word))?, exposures)?;
        }
        Ok(used)
    }

    fn not_a_number(&self, word: &[u8]) -> StreamError {
        let text = String::from_utf8_lossy(&word[..word.len().min(MAX_NUMBER_BYTES)]).into_owned();
        StreamError::NotANumber { radiance: self.next, text }
    }

    fn take_value(&mut self, value: f64, exposures: &mut Vec<f64>) -> Result<(), StreamError> {
        if self.next == self.rays.count() {
            return Err(StreamError::Long { expected: self.next, bands: self.bands });
        }
        if !value.is_finite() {
            return Err(StreamError::NotFinite { radiance: self.next, value });
        }
        self.values.push(value);
        if self.values.len() == self.bands {
            self.take_radiance();
            self.values.clear();
            self.next += 1;
            if self.averages[0].count() == self.rays.samples() {
                let camera = self.rays.camera();
                exposures.extend(self.averages.iter_mut().map(|average| std::mem::take(average).exposure(camera)));
            }
        }
        Ok(())
    }

    /// Adds a complete radiance to the average of its pixel.
    fn take_radiance(&mut self) {
        let ray = self.rays.of_index(self.next);
        if self.apart.is_empty() {
            self.rays.weigh_bands(&ray, &mut self.values);
            let pixel = self.next / u64::from(self.rays.samples());
            self.averages[0].add(ray.cos4, self.weights.combine_at(pixel, &self.values));
            return;
        }
        self.rays.keep_apart(&ray, &self.values, &mut self.apart);
        self.averages.iter_mut().zip(&self.apart).for_each(|(average, band)| average.add(ray.cos4, *band));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::tests::paper_description;
    use crate::{CameraDescription, PinholeCamera};

    fn small_rays(samples: u32) -> Rays {
        let camera = PinholeCamera::new(&CameraDescription { pixels: [5, 3], ..paper_description() }).unwrap();
        Rays::new(&camera, samples, 9)
    }

    fn radiance(index: u64, band: u64) -> f64 {
        ((index * 3 + band) as f64 * 0.7391).sin().abs() / 3.0
    }

    fn answer(rays: &Rays, format: NumberFormat, bands: u64) -> Vec<u8> {
        let mut bytes = Vec::new();
        for index in 0..rays.count() {
            format.encode(&(0..bands).map(|band| radiance(index, band)).collect::<Vec<_>>(), &mut bytes);
        }
        bytes
    }

    fn exposures(
        rays: &Rays,
        format: NumberFormat,
        bands: usize,
        bytes: &[u8],
        piece: usize,
    ) -> Result<Vec<f64>, StreamError> {
        let mut out = Vec::new();
        let mut stream = ExposureStream::new(rays, &BandWeights::equal(3), format, bands)?;
        bytes.chunks(piece).try_for_each(|piece| stream.feed(piece, &mut out))?;
        stream.finish(&mut out)?;
        Ok(out)
    }

    fn fused(rays: &Rays, bands: u64) -> Vec<f64> {
        let weights = BandWeights::equal(bands as usize);
        let pixel = |pixel: u64| {
            let mut average = PixelAverage::default();
            for sample in 0..rays.samples() {
                let index = pixel * u64::from(rays.samples()) + u64::from(sample);
                let bands: Vec<f64> = (0..bands).map(|band| radiance(index, band)).collect();
                average.add(rays.of_sample(pixel, sample).cos4, weights.combine(&bands));
            }
            average.exposure(rays.camera())
        };
        (0..rays.camera().pixel_count()).map(pixel).collect()
    }

    #[test]
    fn the_stream_gives_the_same_bits_as_the_fused_average_in_doubles_and_in_text() {
        let rays = small_rays(7);
        for (format, bands) in [(NumberFormat::Double, 1), (NumberFormat::Double, 3), (NumberFormat::Ascii, 3)] {
            let bytes = answer(&rays, format, bands);
            for piece in [1, 7, 64, 100_000] {
                let streamed = exposures(&rays, format, bands as usize, &bytes, piece).unwrap();
                assert_eq!(streamed, fused(&rays, bands), "{format:?}, {bands} bands, pieces of {piece}");
            }
        }
    }

    #[test]
    fn floats_agree_to_single_precision() {
        let rays = small_rays(4);
        let bytes = answer(&rays, NumberFormat::Float, 3);
        let streamed = exposures(&rays, NumberFormat::Float, 3, &bytes, 10).unwrap();
        for (a, b) in streamed.iter().zip(fused(&rays, 3)) {
            assert!((a / b - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn rays_come_back_from_text_and_doubles_with_every_bit() {
        let rays = small_rays(2);
        for format in [NumberFormat::Double, NumberFormat::Ascii] {
            let mut bytes = Vec::new();
            let mut stream = RayStream::new(&rays, format);
            while stream.fill(4, &mut bytes) > 0 {}
            let values: Vec<f64> = match format {
                NumberFormat::Double => {
                    bytes.chunks_exact(8).map(|b| f64::from_ne_bytes(b.try_into().unwrap())).collect()
                }
                _ => String::from_utf8(bytes).unwrap().split_whitespace().map(|w| w.parse().unwrap()).collect(),
            };
            assert_eq!(values.len(), 5 * 3 * 2 * 6);
            for (index, six) in values.chunks(6).enumerate() {
                let ray = rays.of_index(index as u64);
                assert_eq!(six, [ray.origin.to_array(), ray.direction.to_array()].concat());
            }
        }
    }

    #[test]
    fn a_short_stream_says_how_much_is_missing() {
        let rays = small_rays(2);
        let bytes = answer(&rays, NumberFormat::Double, 3);
        let error = exposures(&rays, NumberFormat::Double, 3, &bytes[..24 * 10 + 11], 16).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the stream ended after 10 of 30 radiances of 3 value(s) and 11 byte(s) of the next: \
             were samples and seed the same as for the rays?"
        );
        let empty = exposures(&rays, NumberFormat::Ascii, 3, b"", 16).unwrap_err();
        assert!(empty.to_string().starts_with("the stream ended after 0 of 30 radiances of 3 value(s):"), "{empty}");
    }

    #[test]
    fn an_overlong_stream_is_refused() {
        let rays = small_rays(2);
        let mut bytes = answer(&rays, NumberFormat::Double, 1);
        bytes.push(0);
        let error = exposures(&rays, NumberFormat::Double, 1, &bytes, 16).unwrap_err();
        assert_eq!(error.to_string(), "the stream continues after all 30 radiances of 1 value(s)");
        let three = answer(&rays, NumberFormat::Ascii, 3);
        assert!(matches!(exposures(&rays, NumberFormat::Ascii, 1, &three, 9), Err(StreamError::Long { .. })));
    }

    #[test]
    fn a_header_is_recognised_whatever_the_format() {
        let rays = small_rays(2);
        for format in [NumberFormat::Double, NumberFormat::Float, NumberFormat::Ascii] {
            let text = b"#?RADIANCE\nrtrace -fdd\n\n";
            for piece in [3, 100] {
                assert_eq!(exposures(&rays, format, 3, text, piece).unwrap_err(), StreamError::Header);
            }
        }
    }

    #[test]
    fn hostile_text_is_named_and_bounded() {
        let rays = small_rays(2);
        let error = exposures(&rays, NumberFormat::Ascii, 1, b"1 2 three 4", 3).unwrap_err();
        assert_eq!(error.to_string(), "radiance 2 (from 0): expected a number, found \"three\"");
        let error = exposures(&rays, NumberFormat::Ascii, 1, b"1 nan", 3).unwrap_err();
        assert_eq!(error.to_string(), "radiance 1 (from 0) is NaN, expected a finite number");
        assert!(matches!(
            exposures(&rays, NumberFormat::Ascii, 1, &[b'7'; 100_000], 4096),
            Err(StreamError::NotANumber { .. })
        ));
    }
}
