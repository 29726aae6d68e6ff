//! Reads and writes pictures of any size, one scanline at a time.

use crate::picture::{components_of, mean_of_parts, spectrum_parts};
use crate::rgbe::{decode_spectrum, encode_spectrum};
use crate::{Encoding, ForeignFormat, Header, PictureError, Resolution, decode_rgbe, encode_rgbe, scanline};
use std::io::{Read, Write};

/// Largest header, bytes.
const LONGEST_HEADER: usize = 1 << 24;
/// Longest scanline, pixels. One scanline is held in memory.
const LONGEST_SCANLINE: usize = 1 << 22;
/// Number of bytes per read.
const CHUNK: usize = 1 << 18;

/// Reads the scanlines of a picture in file order and holds one of them in memory.
///
/// ```
/// use radsight_picture::{Header, Image, Picture, PictureReader};
/// let grey = Image::new(2, 1, 1, vec![1.0f32, 0.25]).unwrap();
/// let bytes = Picture::from_rgb(Header::new("RADIANCE"), &grey).unwrap().to_bytes();
/// let mut reader = PictureReader::new(&bytes[..]).unwrap();
/// let mut values = vec![0.0; reader.resolution().scanline_length() * reader.components()];
/// reader.read_values(&mut values).unwrap();
/// assert_eq!(values[3..], [0.25097656; 3]);
/// assert!(reader.read_values(&mut values).is_err());
/// ```
#[derive(Debug)]
pub struct PictureReader<R> {
    bytes: Bytes<R>,
    header: Header,
    encoding: Encoding,
    components: usize,
    resolution: Resolution,
    storage: Storage,
    left: usize,
    stored: Vec<u8>,
    planes: Vec<u8>,
}

/// The number format of stored pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Storage {
    /// Mantissas with a shared exponent.
    Exponent,
    /// Little-endian floats.
    LittleEndian,
    /// Big-endian floats.
    BigEndian,
}

impl<R> PictureReader<R> {
    /// All lines of the header.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// The meaning of the values.
    pub fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// Values per pixel: 3, or more for spectra.
    pub fn components(&self) -> usize {
        self.components
    }

    /// The size, and the order of the pixels in the file.
    pub fn resolution(&self) -> Resolution {
        self.resolution
    }

    /// The last scanline read, as stored.
    pub fn stored(&self) -> &[u8] {
        &self.stored
    }

    /// Number of scanlines left to read.
    pub fn scanlines_left(&self) -> usize {
        self.left
    }
}

impl<R: Read> PictureReader<R> {
    /// Reads the header and the resolution.
    ///
    /// # Errors
    /// When one of them is wrong, or the source fails.
    pub fn new(source: R) -> Result<PictureReader<R>, PictureError> {
        let mut bytes = Bytes::new(source);
        let header = bytes.parse(LONGEST_HEADER, picture_header)?;
        PictureReader::of_picture(bytes, header)
    }

    fn of_picture(mut bytes: Bytes<R>, header: Header) -> Result<PictureReader<R>, PictureError> {
        let encoding = Encoding::from_header(&header)?;
        let components = components_of(&header, encoding)?;
        let resolution = bytes.parse(CHUNK, |bytes| Resolution::read(bytes, 0))?;
        PictureReader::over(bytes, header, encoding, components, resolution, Storage::Exponent)
    }

    /// The next picture of the same source, after all scanlines of this one, as in the frames of an
    /// animation; `None` at the end of the source.
    ///
    /// # Errors
    /// As [`PictureReader::new`].
    pub fn next_picture(mut self) -> Result<Option<PictureReader<R>>, PictureError> {
        if self.bytes.is_at_end()? {
            return Ok(None);
        }
        let header = self.bytes.parse(LONGEST_HEADER, Header::read)?;
        PictureReader::of_picture(self.bytes, header).map(Some)
    }

    /// Reads the header and the size of a picture, or of a float matrix with one or three
    /// components. The components of a matrix are treated as those of an RGBE picture.
    ///
    /// # Errors
    /// As [`PictureReader::new`].
    pub fn picture_or_matrix(source: R) -> Result<PictureReader<R>, PictureError> {
        let mut bytes = Bytes::new(source);
        let header = bytes.parse(LONGEST_HEADER, picture_header)?;
        if header.format().is_none_or(|format| format != "float") {
            return PictureReader::of_picture(bytes, header);
        }
        let components = header.components()?.unwrap_or(1);
        if components != 1 && components != 3 {
            let line = header.assignments("NCOMP").last().map_or(0, |assignment| assignment.line);
            let value = components.to_string();
            return Err(PictureError::HeaderValue { line, name: "NCOMP", value, expected: "1 or 3" });
        }
        let resolution = match (header.count("NCOLS")?, header.count("NROWS")?) {
            (Some(columns), Some(rows)) => Resolution::standard(columns, rows),
            _ => bytes.parse(CHUNK, |bytes| Resolution::read(bytes, 0))?,
        };
        let is_big = header.is_big_endian().unwrap_or(cfg!(target_endian = "big"));
        let storage = if is_big { Storage::BigEndian } else { Storage::LittleEndian };
        PictureReader::over(bytes, header, Encoding::Rgbe, components, resolution, storage)
    }

    fn over(
        bytes: Bytes<R>,
        header: Header,
        encoding: Encoding,
        components: usize,
        resolution: Resolution,
        storage: Storage,
    ) -> Result<PictureReader<R>, PictureError> {
        check_length(&resolution, components)?;
        let left = resolution.scanlines();
        let (stored, planes) = (Vec::new(), Vec::new());
        Ok(PictureReader { bytes, header, encoding, components, resolution, storage, left, stored, planes })
    }

    /// The next scanline as stored: mantissas and exponent of each pixel, or the bytes of its
    /// floats.
    ///
    /// # Errors
    /// When it is malformed or missing, or the source fails.
    pub fn read_stored(&mut self) -> Result<&[u8], PictureError> {
        let length = self.resolution.scanline_length();
        if self.left == 0 {
            return Err(PictureError::Truncated { offset: self.bytes.offset(), expected: "another scanline".into() });
        }
        let (stored, planes) = (&mut self.stored, &mut self.planes);
        let size = match self.storage {
            Storage::Exponent => length * (self.components + 1),
            _ => length * self.components * size_of::<f32>(),
        };
        if self.components == 3 && self.storage == Storage::Exponent {
            // Only runs can make a scanline longer than its pixels, by one count each; no encoder
            // writes empty counts.
            let longest = CHUNK + 16 * size;
            // Memory is allocated as bytes arrive, so a large number in a header costs nothing.
            self.bytes.parse(longest, |bytes| {
                if stored.is_empty() && bytes.len() < scanline::PIXEL {
                    return Err(PictureError::Truncated { offset: bytes.len(), expected: "more pixels".into() });
                }
                stored.resize(size, 0);
                Ok(((), scanline::read(bytes, 0, stored, planes)?))
            })?;
        } else {
            self.bytes.parse(size, |bytes| match bytes.get(..size) {
                Some(found) => {
                    stored.clear();
                    stored.extend_from_slice(found);
                    Ok(((), size))
                }
                None => Err(PictureError::Truncated { offset: bytes.len(), expected: "more pixels".into() }),
            })?;
        }
        self.left -= 1;
        Ok(&self.stored)
    }

    /// The raw values of the next scanline, [`PictureReader::components`] per pixel.
    ///
    /// # Errors
    /// As [`PictureReader::read_stored`].
    pub fn read_values(&mut self, values: &mut [f32]) -> Result<(), PictureError> {
        let (components, storage) = (self.components, self.storage);
        let stored = self.read_stored()?;
        if storage != Storage::Exponent {
            let from_bytes = if storage == Storage::BigEndian { f32::from_be_bytes } else { f32::from_le_bytes };
            for (value, bytes) in values.iter_mut().zip(stored.as_chunks::<4>().0) {
                *value = from_bytes(*bytes);
            }
        } else if components == 3 {
            for (value, pixel) in values.as_chunks_mut::<3>().0.iter_mut().zip(stored.as_chunks::<4>().0) {
                *value = decode_rgbe(*pixel);
            }
        } else {
            for (value, pixel) in values.chunks_exact_mut(components).zip(stored.chunks_exact(components + 1)) {
                decode_spectrum(pixel, value);
            }
        }
        Ok(())
    }
}

impl<R: Read> PictureReader<R> {
    /// The next scanline as pixels with three mantissas. A spectrum or a matrix is reduced to three
    /// values.
    ///
    /// # Errors
    /// As [`PictureReader::read_stored`].
    pub fn read_pixels(&mut self, pixels: &mut [[u8; 4]]) -> Result<(), PictureError> {
        if self.components == 3 && self.storage == Storage::Exponent {
            pixels.as_flattened_mut().copy_from_slice(self.read_stored()?);
            return Ok(());
        }
        let mut values = vec![[0.0; 3]; pixels.len()];
        self.read_three(&mut values)?;
        pixels.iter_mut().zip(values).for_each(|(pixel, value)| *pixel = encode_rgbe(value));
        Ok(())
    }

    /// The raw values of the next scanline in three components: the mean of a
    /// spectrum in its colour ranges, the value of a grey matrix repeated.
    ///
    /// # Errors
    /// As [`PictureReader::read_stored`].
    pub fn read_three(&mut self, values: &mut [[f32; 3]]) -> Result<(), PictureError> {
        let (components, encoding) = (self.components, self.encoding);
        match encoding {
            Encoding::Spectral { splits } if components > 3 => {
                let parts = spectrum_parts(components, splits);
                let mut spectrum = vec![0.0; components];
                let stored = self.read_stored()?;
                for (value, pixel) in values.iter_mut().zip(stored.chunks_exact(components + 1)) {
                    decode_spectrum(pixel, &mut spectrum);
                    *value = mean_of_parts(&spectrum, &parts);
                }
                Ok(())
            }
            _ if components == 1 => {
                let mut grey = vec![0.0; values.len()];
                self.read_values(&mut grey)?;
                values.iter_mut().zip(grey).for_each(|(value, grey)| *value = [grey; 3]);
                Ok(())
            }
            _ => self.read_values(values.as_flattened_mut()),
        }
    }
}

/// Writes a picture one scanline at a time. The header is written first, unchanged.
#[derive(Debug)]
pub struct PictureWriter<W> {
    target: W,
    components: usize,
    encoded: Vec<u8>,
    stored: Vec<u8>,
    plane: Vec<u8>,
}

impl<W: Write> PictureWriter<W> {
    /// Writes the header, the empty line after it, and the resolution.
    ///
    /// # Errors
    /// When scanlines are too long to hold in memory, or the target fails.
    pub fn new(
        mut target: W,
        header: &Header,
        components: usize,
        resolution: Resolution,
    ) -> Result<PictureWriter<W>, PictureError> {
        check_length(&resolution, components)?;
        target.write_all(&header.to_bytes())?;
        writeln!(target, "{resolution}")?;
        let (encoded, stored, plane) = (Vec::new(), Vec::new(), Vec::new());
        Ok(PictureWriter { target, components, encoded, stored, plane })
    }

    /// Writes a scanline of raw values.
    ///
    /// # Errors
    /// When the target fails.
    pub fn write_values(&mut self, values: &[f32]) -> Result<(), PictureError> {
        let mut stored = std::mem::take(&mut self.stored);
        stored.clear();
        if self.components == 3 {
            stored.extend(values.as_chunks::<3>().0.iter().flat_map(|value| encode_rgbe(*value)));
        } else {
            stored.resize(values.len() / self.components * (self.components + 1), 0);
            for (pixel, value) in stored.chunks_exact_mut(self.components + 1).zip(values.chunks_exact(self.components))
            {
                encode_spectrum(value, pixel);
            }
        }
        let written = self.write_stored(&stored);
        self.stored = stored;
        written
    }

    /// Writes a scanline of pixels as stored: mantissas and exponent of each.
    ///
    /// # Errors
    /// When the target fails.
    pub fn write_stored(&mut self, stored: &[u8]) -> Result<(), PictureError> {
        if self.components != 3 {
            return self.write_flat(stored);
        }
        self.encoded.clear();
        scanline::write(stored, &mut self.encoded, &mut self.plane);
        Ok(self.target.write_all(&self.encoded)?)
    }

    /// Writes a scanline of pixels as stored, without run-length encoding.
    ///
    /// # Errors
    /// When the target fails.
    pub fn write_flat(&mut self, stored: &[u8]) -> Result<(), PictureError> {
        Ok(self.target.write_all(stored)?)
    }

    /// Flushes buffered data.
    ///
    /// # Errors
    /// When the target fails.
    pub fn finish(mut self) -> Result<(), PictureError> {
        Ok(self.target.flush()?)
    }
}

fn check_length(resolution: &Resolution, components: usize) -> Result<(), PictureError> {
    if resolution.scanline_length() <= LONGEST_SCANLINE {
        return Ok(());
    }
    Err(PictureError::Shape {
        width: resolution.width,
        height: resolution.height,
        components,
        values: 0,
        expected: "scanlines of at most 4194304 pixels",
    })
}

/// The header of a picture. Headers need no identifier, so other formats are told by their first
/// bytes.
fn picture_header(bytes: &[u8]) -> Result<(Header, usize), PictureError> {
    match ForeignFormat::from_content(bytes) {
        Some(found) => Err(PictureError::OtherFormat { found }),
        None => Header::read(bytes),
    }
}

/// The unused bytes of a source.
#[derive(Debug)]
struct Bytes<R> {
    source: R,
    buffer: Vec<u8>,
    /// Start of the unused bytes in the buffer.
    start: usize,
    /// Offset of the buffer in the source.
    before: usize,
    ended: bool,
}

impl<R: Read> Bytes<R> {
    fn new(source: R) -> Bytes<R> {
        Bytes { source, buffer: Vec::new(), start: 0, before: 0, ended: false }
    }

    fn offset(&self) -> usize {
        self.before + self.start
    }

    /// Runs a parser on the available bytes, and again on more bytes as long as it finds the end
    /// too early. The number of bytes doubles each time, so the work is linear. No more than
    /// `longest` bytes are passed.
    fn parse<T>(
        &mut self,
        longest: usize,
        mut parser: impl FnMut(&[u8]) -> Result<(T, usize), PictureError>,
    ) -> Result<T, PictureError> {
        loop {
            let error = match parser(&self.buffer[self.start..]) {
                Ok((parsed, used)) => {
                    self.start += used;
                    return Ok(parsed);
                }
                Err(error) => error,
            };
            let held = self.buffer.len() - self.start;
            // An error in a partial input may disappear with more bytes, such as a line without its
            // end.
            if self.ended || held >= longest || !(error.is_truncation() || held < LONGEST_LINE) {
                return Err(error.at(self.offset()));
            }
            self.fetch(held.max(CHUNK))?;
        }
    }

    fn is_at_end(&mut self) -> Result<bool, PictureError> {
        if self.start == self.buffer.len() && !self.ended {
            self.fetch(CHUNK)?;
        }
        Ok(self.start == self.buffer.len())
    }

    fn fetch(&mut self, count: usize) -> Result<(), PictureError> {
        self.buffer.drain(..self.start);
        self.before += self.start;
        self.start = 0;
        let wanted = self.source.by_ref().take(count as u64).read_to_end(&mut self.buffer)?;
        self.ended = wanted < count;
        Ok(())
    }
}

/// An error within this many bytes may be caused by an incomplete line.
const LONGEST_LINE: usize = 512;
