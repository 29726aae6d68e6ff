//! Radiance pictures: RGBE, XYZE and spectra with a shared exponent.

use crate::color::xyz_to_rgb;
use crate::rgbe::{decode_rgbe, decode_spectrum, encode_rgbe, encode_spectrum};
use crate::{Header, Image, PictureError, Resolution, RgbPrimaries, scanline};
use radsight_units::photometry::WHITE_EFFICACY;

/// The meaning of a pixel's values.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Encoding {
    /// `32-bit_rle_rgbe`, the default: radiance in three bands, W/(sr·m²).
    Rgbe,
    /// `32-bit_rle_xyze`: CIE tristimulus values; Y is the luminance in cd/m².
    Xyze,
    /// `Radiance_spectra`: radiance in equal bands from the longest wavelength to the shortest,
    /// W/(sr·m²).
    Spectral {
        /// The longest wavelength, the limits between red and green and between green and blue, the
        /// shortest; in nm, decreasing.
        splits: [f32; 4],
    },
}

impl Encoding {
    /// The default of `WAVELENGTH_SPLITS`, nm.
    pub const USUAL_SPLITS: [f32; 4] = [780.0, 588.0, 480.0, 380.0];

    /// The value of the `FORMAT=` line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Encoding::Rgbe => "32-bit_rle_rgbe",
            Encoding::Xyze => "32-bit_rle_xyze",
            Encoding::Spectral { .. } => "Radiance_spectra",
        }
    }

    pub(crate) fn from_header(header: &Header) -> Result<Encoding, PictureError> {
        let Some(assignment) = header.assignments("FORMAT").last() else { return Ok(Encoding::Rgbe) };
        match assignment.value.as_ref() {
            "32-bit_rle_rgbe" => Ok(Encoding::Rgbe),
            "32-bit_rle_xyze" => Ok(Encoding::Xyze),
            "Radiance_spectra" => {
                let splits = header.wavelength_splits()?.unwrap_or(Encoding::USUAL_SPLITS);
                Ok(Encoding::Spectral { splits })
            }
            other => Err(PictureError::HeaderValue {
                line: assignment.line,
                name: "FORMAT",
                value: other.chars().take(60).collect(),
                expected: "32-bit_rle_rgbe, 32-bit_rle_xyze or Radiance_spectra for a picture",
            }),
        }
    }
}

/// A picture as stored: its header, and its pixels as bytes, four each for RGBE and XYZE.
///
/// Values are *raw* as decoded, or *radiance* with every EXPOSURE and COLORCORR of the header
/// undone.
///
/// ```
/// use radsight_picture::{Header, Image, Picture};
/// let grey = Image::new(2, 1, 1, vec![1.0f32, 0.25]).unwrap();
/// let mut header = Header::new("RADIANCE");
/// header.push_exposure(2.0);
/// let bytes = Picture::from_rgb(header, &grey).unwrap().to_bytes();
/// let picture = Picture::read(&bytes).unwrap();
/// assert_eq!(picture.values().pixel(1, 0), [0.25097656; 3]);
/// assert_eq!(picture.radiance().unwrap().pixel(1, 0), [0.12548828; 3]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    header: Header,
    encoding: Encoding,
    resolution: Resolution,
    pixels: Image<u8>,
}

/// A picture that may be incomplete, for example while it is being rendered.
#[derive(Clone, Debug, PartialEq)]
pub struct PartialPicture {
    /// The picture; missing pixels are black.
    pub picture: Picture,
    /// Number of complete scanlines, in the order of the resolution line.
    pub complete_scanlines: usize,
    /// Number of bytes read.
    pub used: usize,
    /// Why the next scanline could not be read; `None` if the picture is complete.
    pub error: Option<PictureError>,
}

impl Picture {
    /// Reads a picture; bytes after it are ignored, as in Radiance.
    ///
    /// # Errors
    /// When the header or the resolution is wrong, or pixels are malformed or missing.
    pub fn read(bytes: &[u8]) -> Result<Picture, PictureError> {
        Ok(Picture::read_first(bytes)?.0)
    }

    /// Reads the picture at the start of the bytes. Also returns its length in bytes.
    ///
    /// # Errors
    /// As [`Picture::read`].
    pub fn read_first(bytes: &[u8]) -> Result<(Picture, usize), PictureError> {
        let partial = Picture::read_partial(bytes)?;
        match partial.error {
            Some(error) => Err(error),
            None => Ok((partial.picture, partial.used)),
        }
    }

    /// Reads the complete scanlines of a picture.
    ///
    /// # Errors
    /// When the header or the resolution is wrong, or the declared size far exceeds what the bytes
    /// can hold.
    pub fn read_partial(bytes: &[u8]) -> Result<PartialPicture, PictureError> {
        let (header, start) = Header::read(bytes)?;
        let encoding = Encoding::from_header(&header)?;
        let components = components_of(&header, encoding)?;
        let (resolution, start) = Resolution::read(bytes, start)?;
        let size = checked_size(bytes, start, &resolution, components)?;
        let mut stored = vec![0; size];
        let (complete_scanlines, used, error) =
            read_scanlines(bytes, start, resolution.scanline_length() * (components + 1), components, &mut stored);
        let pixels = resolution.upright(components + 1, stored)?;
        let picture = Picture { header, encoding, resolution, pixels };
        Ok(PartialPicture { picture, complete_scanlines, used, error })
    }

    /// Encodes RGB values; a single component is used for all three. Lines of `header` that
    /// describe the storage are replaced. It should have an EXPOSURE if the values are not
    /// radiances.
    ///
    /// # Errors
    /// [`PictureError::Shape`] unless there are one or three components.
    pub fn from_rgb(header: Header, values: &Image<f32>) -> Result<Picture, PictureError> {
        Picture::encode_three(header, values, Encoding::Rgbe)
    }

    /// Encodes CIE tristimulus values, Y in cd/m².
    ///
    /// # Errors
    /// [`PictureError::Shape`] unless there are three components.
    pub fn from_xyz(header: Header, values: &Image<f32>) -> Result<Picture, PictureError> {
        Picture::encode_three(header, values, Encoding::Xyze)
    }

    /// Encodes spectra in equal bands from the longest wavelength `splits[0]` to the shortest
    /// `splits[3]`, in nm.
    ///
    /// # Errors
    /// [`PictureError::Shape`] unless there are more than three components.
    pub fn from_spectra(header: Header, values: &Image<f32>, splits: [f32; 4]) -> Result<Picture, PictureError> {
        let components = values.components();
        if components <= 3 {
            return Err(bad_shape(values, "more than 3 components for spectra"));
        }
        let mut data = vec![0; values.width() * values.height() * (components + 1)];
        for (pixel, value) in data.chunks_exact_mut(components + 1).zip(values.pixels()) {
            encode_spectrum(value, pixel);
        }
        let pixels = Image::new(values.width(), values.height(), components + 1, data)?;
        let resolution = Resolution::standard(values.width(), values.height());
        Ok(Picture { header: header.history(), encoding: Encoding::Spectral { splits }, resolution, pixels })
    }

    fn encode_three(header: Header, values: &Image<f32>, encoding: Encoding) -> Result<Picture, PictureError> {
        let data: Vec<u8> = match values.components() {
            3 => values.data().as_chunks::<3>().0.iter().flat_map(|value| encode_rgbe(*value)).collect(),
            1 if encoding == Encoding::Rgbe => {
                values.data().iter().flat_map(|value| encode_rgbe([*value; 3])).collect()
            }
            _ => return Err(bad_shape(values, "1 or 3 components for a picture")),
        };
        let pixels = Image::new(values.width(), values.height(), scanline::PIXEL, data)?;
        let resolution = Resolution::standard(values.width(), values.height());
        Ok(Picture { header: header.history(), encoding, resolution, pixels })
    }

    /// All lines of the header.
    #[must_use]
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// The header, mutable.
    pub fn header_mut(&mut self) -> &mut Header {
        &mut self.header
    }

    /// The meaning of the values.
    #[must_use]
    pub fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// The size, and the order of the pixels in the file.
    #[must_use]
    pub fn resolution(&self) -> Resolution {
        self.resolution
    }

    /// Width in pixels.
    #[must_use]
    pub fn width(&self) -> usize {
        self.pixels.width()
    }

    /// Height in pixels.
    #[must_use]
    pub fn height(&self) -> usize {
        self.pixels.height()
    }

    /// Values per pixel: 3, or more for spectra.
    #[must_use]
    pub fn components(&self) -> usize {
        self.pixels.components() - 1
    }

    /// The pixels as bytes: the mantissas of each, then its exponent; row 0 is the top.
    #[must_use]
    pub fn pixels(&self) -> &Image<u8> {
        &self.pixels
    }

    /// All raw values, as `pvalue` prints them, except that spectra keep all bands.
    #[must_use]
    pub fn values(&self) -> Image<f32> {
        self.scaled(&vec![1.0; self.components()])
    }

    /// The values of [`Picture::values`] by pixel, top row first; `None` unless there are three
    /// components.
    #[must_use]
    pub fn triples(&self) -> Option<Vec<[f32; 3]>> {
        let (pixels, rest) = self.pixels.data().as_chunks::<4>();
        (self.components() == 3 && rest.is_empty()).then(|| pixels.iter().copied().map(decode_rgbe).collect())
    }

    /// All values with exposure and colour correction undone: radiances in W/(sr·m²), or for XYZE
    /// tristimulus values with Y in cd/m². Bands of a spectrum beyond the third use the correction
    /// of the second.
    ///
    /// # Errors
    /// When an EXPOSURE or COLORCORR in the header is invalid.
    pub fn radiance(&self) -> Result<Image<f32>, PictureError> {
        let scale = self.header.radiance_scale()?;
        let scales: Vec<f32> = (0..self.components()).map(|i| *scale.get(i).unwrap_or(&scale[1])).collect();
        Ok(self.scaled(&scales))
    }

    fn scaled(&self, scales: &[f32]) -> Image<f32> {
        let components = self.components();
        let mut data = vec![0.0; self.width() * self.height() * components];
        let bytes = self.pixels.data();
        match scales {
            &[red, green, blue] => {
                let pixels = bytes.as_chunks::<4>().0;
                for (value, pixel) in data.as_chunks_mut::<3>().0.iter_mut().zip(pixels) {
                    let raw = decode_rgbe(*pixel);
                    *value = [raw[0] * red, raw[1] * green, raw[2] * blue];
                }
            }
            _ => {
                for (values, pixel) in data.chunks_exact_mut(components).zip(self.pixels.pixels()) {
                    decode_spectrum(pixel, values);
                    values.iter_mut().zip(scales).for_each(|(value, scale)| *value *= scale);
                }
            }
        }
        Image::new(self.width(), self.height(), components, data).expect("the data have this shape")
    }

    /// Raw values in three components: RGBE and XYZE unchanged, and the mean of a spectrum in its
    /// red, green and blue ranges. `pvalue` prints these, and `colorpict` uses them.
    #[must_use]
    pub fn three_values(&self) -> Image<f32> {
        let values = self.values();
        match self.encoding {
            Encoding::Spectral { splits } if values.components() > 3 => {
                let parts = spectrum_parts(values.components(), splits);
                let data = values.pixels().flat_map(|spectrum| mean_of_parts(spectrum, &parts)).collect();
                Image::new(values.width(), values.height(), 3, data).expect("three values for every pixel")
            }
            _ => values,
        }
    }

    /// Radiances in Radiance's standard primaries, W/(sr·m²), for any encoding. Colours of XYZE
    /// outside the gamut are desaturated. `PRIMARIES` of an RGBE picture are ignored.
    ///
    /// # Errors
    /// When an EXPOSURE or COLORCORR in the header is invalid.
    pub fn rgb_radiance(&self) -> Result<Image<f32>, PictureError> {
        let scale = self.header.radiance_scale()?;
        let mut values = self.three_values();
        let to_rgb = RgbPrimaries::STANDARD.xyz_to_rgb();
        for value in values.data_mut().as_chunks_mut::<3>().0 {
            *value = std::array::from_fn(|i| value[i] * scale[i]);
            if let (Encoding::Xyze, Some(matrix)) = (self.encoding, &to_rgb) {
                *value = xyz_to_rgb(matrix, value.map(|component| component / WHITE_EFFICACY as f32));
            }
        }
        Ok(values)
    }

    /// The picture as a file, rows from the top, run-length encoded (spectra are stored flat).
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        self.to_bytes_in(Resolution::standard(self.width(), self.height()))
    }

    /// The picture as a file with its pixels in another order.
    ///
    /// # Panics
    /// If the resolution has another size.
    #[must_use]
    pub fn to_bytes_in(&self, resolution: Resolution) -> Vec<u8> {
        let mut header = self.header.history();
        if header.is_empty() {
            header = Header::new("RADIANCE");
        }
        if let Encoding::Spectral { splits: [longest, red, green, shortest] } = self.encoding {
            header.push_variable("NCOMP", &self.components().to_string());
            header.push_variable("WAVELENGTH_SPLITS", &format!(" {longest} {red} {green} {shortest}"));
        }
        header.push_variable("FORMAT", self.encoding.name());
        let mut out = header.to_bytes();
        out.extend_from_slice(format!("{resolution}\n").as_bytes());
        let stored = resolution.stored(&self.pixels);
        out.reserve(stored.len() + stored.len() / 64);
        if self.components() == 3 {
            let mut plane = Vec::new();
            for row in stored.chunks_exact(resolution.scanline_length() * scanline::PIXEL) {
                scanline::write(row, &mut out, &mut plane);
            }
        } else {
            out.extend_from_slice(&stored);
        }
        out
    }
}

fn bad_shape(values: &Image<f32>, expected: &'static str) -> PictureError {
    let (width, height, components) = (values.width(), values.height(), values.components());
    PictureError::Shape { width, height, components, values: values.data().len(), expected }
}

/// Number of values per pixel.
pub(crate) fn components_of(header: &Header, encoding: Encoding) -> Result<usize, PictureError> {
    let components = header.components()?.unwrap_or(3);
    let (fits, expected) = match encoding {
        Encoding::Spectral { .. } => (components >= 3, "at least 3 for spectra"),
        _ => (components == 3, "3 for RGBE and XYZE"),
    };
    if fits {
        return Ok(components);
    }
    let line = header.assignments("NCOMP").last().map_or(0, |assignment| assignment.line);
    Err(PictureError::HeaderValue { line, name: "NCOMP", value: components.to_string(), expected })
}

/// The size of the decoded pixels in bytes, if the remaining bytes can hold that many.
fn checked_size(bytes: &[u8], start: usize, resolution: &Resolution, components: usize) -> Result<usize, PictureError> {
    // A two-byte run encodes at most 127 decoded bytes. Only the old encoding can exceed this,
    // and it was never used for pictures of this size.
    const LARGEST_FROM_OLD_RUNS: usize = 1 << 26;
    const LARGEST_RATIO: usize = 64;
    let rest = &bytes[start..];
    let (length, scanlines) = (resolution.scanline_length(), resolution.scanlines());
    let size = length.checked_mul(scanlines).and_then(|pixels| pixels.checked_mul(components + 1));
    let fits = |size: usize| match components {
        3 => {
            scanline::can_hold(length, scanlines, rest)
                && size <= LARGEST_FROM_OLD_RUNS.max(rest.len().saturating_mul(LARGEST_RATIO))
        }
        _ => size <= rest.len(),
    };
    size.filter(|size| fits(*size)).ok_or(PictureError::TooLarge {
        offset: start,
        width: resolution.width as u64,
        height: resolution.height as u64,
        components: components as u64,
        available: rest.len(),
    })
}

fn read_scanlines(
    bytes: &[u8],
    start: usize,
    scanline_size: usize,
    components: usize,
    stored: &mut [u8],
) -> (usize, usize, Option<PictureError>) {
    if components != 3 {
        let size = stored.len();
        stored.copy_from_slice(&bytes[start..start + size]);
        return (size / scanline_size, start + size, None);
    }
    let (mut at, mut planes) = (start, Vec::new());
    for (done, row) in stored.chunks_exact_mut(scanline_size).enumerate() {
        match scanline::read(bytes, at, row, &mut planes) {
            Ok(next) => at = next,
            Err(error) => {
                row.fill(0);
                return (done, at, Some(error));
            }
        }
    }
    (stored.len() / scanline_size, at, None)
}

/// The range (0 red, 1 green, 2 blue) of each band, by its central wavelength.
pub(crate) fn spectrum_parts(bands: usize, splits: [f32; 4]) -> Vec<usize> {
    let step = f64::from(splits[3] - splits[0]) / bands as f64;
    let mut part = 0;
    let part_of = |band: usize| {
        let middle = f64::from(splits[0]) + (band as f64 + 0.5) * step;
        // Advance at most one range per band, so that each has a band if there are enough.
        if part < 2 && middle < f64::from(splits[part + 1]) {
            part += 1;
        }
        part
    };
    (0..bands).map(part_of).collect()
}

/// The mean of a spectrum in its red, green and blue ranges.
#[must_use]
pub fn mean_of_spectrum(spectrum: &[f32], splits: [f32; 4]) -> [f32; 3] {
    mean_of_parts(spectrum, &spectrum_parts(spectrum.len(), splits))
}

pub(crate) fn mean_of_parts(spectrum: &[f32], parts: &[usize]) -> [f32; 3] {
    let (mut sums, mut counts) = ([0.0f32; 3], [0u16; 3]);
    for (value, part) in spectrum.iter().zip(parts) {
        sums[*part] += value;
        counts[*part] += 1;
    }
    std::array::from_fn(|i| if counts[i] > 1 { sums[i] / f32::from(counts[i]) } else { sums[i] })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gradient(width: usize, height: usize, components: usize) -> Image<f32> {
        let data = (0..width * height * components).map(|i| (i as f32 * 0.37).exp2() % 7.0).collect();
        Image::new(width, height, components, data).unwrap()
    }

    #[test]
    fn triples_are_the_values() {
        let rgb = Picture::from_rgb(Header::default(), &gradient(3, 2, 3)).unwrap();
        let values = rgb.values();
        assert_eq!(rgb.triples().unwrap().as_flattened(), values.data());
    }

    #[test]
    fn encoding_twice_changes_nothing() {
        for (width, height) in [(1, 1), (5, 3), (17, 2), (400, 7)] {
            let picture = Picture::from_rgb(Header::new("RADIANCE"), &gradient(width, height, 3)).unwrap();
            let bytes = picture.to_bytes();
            let read = Picture::read(&bytes).unwrap();
            assert_eq!(read.pixels(), picture.pixels());
            assert_eq!(read.to_bytes(), bytes);
            let again = Picture::from_rgb(Header::default(), &read.values()).unwrap();
            assert_eq!(again.pixels(), picture.pixels());
        }
    }

    #[test]
    fn scanlines_one_by_one_make_the_same_file() {
        let image = gradient(30, 3, 3);
        let bytes = Picture::from_rgb(Header::new("RADIANCE"), &image).unwrap().to_bytes();
        let mut rows = Vec::new();
        for row in image.rows() {
            crate::write_rgbe_scanline(row.as_chunks().0, &mut rows);
        }
        assert!(bytes.ends_with(&rows) && !rows.is_empty());
    }

    #[test]
    fn spectra_keep_their_bands_and_splits() {
        let splits = [830.0, 588.0, 480.0, 360.0];
        let picture = Picture::from_spectra(Header::new("RADIANCE"), &gradient(4, 3, 7), splits).unwrap();
        let read = Picture::read(&picture.to_bytes()).unwrap();
        assert_eq!((read.encoding(), read.components()), (Encoding::Spectral { splits }, 7));
        assert_eq!(read.pixels(), picture.pixels());
        assert_eq!(read.three_values().components(), 3);
    }

    #[test]
    fn a_cut_picture_gives_its_whole_scanlines() {
        let picture = Picture::from_rgb(Header::new("RADIANCE"), &gradient(40, 6, 3)).unwrap();
        let bytes = picture.to_bytes();
        let partial = Picture::read_partial(&bytes[..bytes.len() - 3]).unwrap();
        assert_eq!(partial.complete_scanlines, 5);
        assert_eq!(partial.picture.pixels().row(4), picture.pixels().row(4));
        assert!(partial.picture.pixels().row(5).iter().all(|byte| *byte == 0));
        assert_eq!(
            partial.error,
            Some(PictureError::Truncated { offset: bytes.len() - 3, expected: "more pixels".into() })
        );
        assert!(Picture::read(&bytes[..bytes.len() - 3]).is_err());
    }

    #[test]
    fn two_concatenated_pictures_are_separated() {
        let first = Picture::from_rgb(Header::new("RADIANCE"), &gradient(20, 2, 3)).unwrap().to_bytes();
        let (_, used) = Picture::read_first(&[&first[..], b"#?RADIANCE"].concat()).unwrap();
        assert_eq!(used, first.len());
    }

    #[test]
    fn hostile_sizes_fail_at_once() {
        for size in ["-Y 1000000000 +X 1000000000", "-Y 100000 +X 100000", "+X 2147483647 +Y 1"] {
            for more in ["", "FORMAT=Radiance_spectra\nNCOMP=9\n"] {
                let text = format!("#?RADIANCE\n{more}\n{size}\n\x02\x02\x03\x04 and more that is not enough");
                assert!(matches!(Picture::read(text.as_bytes()), Err(PictureError::TooLarge { .. })), "{text:?}");
            }
        }
    }

    #[test]
    fn xyz_becomes_rgb_radiance() {
        let white = Image::new(1, 1, 3, vec![179f32; 3]).unwrap();
        let picture = Picture::from_xyz(Header::default(), &white).unwrap();
        let rgb = picture.rgb_radiance().unwrap();
        assert!(rgb.data().iter().all(|value| (value - 1.0).abs() < 0.004), "{rgb:?}");
    }

    #[test]
    fn wrong_headers_are_named() {
        let error = |text: &str| Picture::read(text.as_bytes()).unwrap_err().to_string();
        assert_eq!(
            error("#?RADIANCE\nFORMAT=ascii\n\n-Y 1 +X 1\nabcd"),
            "header line 2: FORMAT is \"ascii\", expected 32-bit_rle_rgbe, 32-bit_rle_xyze or Radiance_spectra for a picture"
        );
        assert_eq!(
            error("x\nNCOMP=4\n\n-Y 1 +X 1\nabcd"),
            "header line 2: NCOMP is \"4\", expected 3 for RGBE and XYZE"
        );
        assert_eq!(
            error("x\n\n-Y 1 +Z 1\nabcd"),
            "byte 3: expected a resolution such as -Y 480 +X 640, found \"-Y 1 +Z 1\""
        );
    }
}
