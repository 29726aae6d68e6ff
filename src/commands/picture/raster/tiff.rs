//! `ra_tiff [-b] [-w|-f|-L] [-z] [-g GAMMA] [-e ±STOPS] input output`: TIFF with 8 bits, 16 (`-w`),
//! floats (`-f`) or LogLuv (`-L`), grey (`-b`), compressed (`-z`); `-r` converts to Radiance, to
//! XYZE with `-x`.

use super::{Colors, Direction, GAMMA, Pixels, open_picture, put_file, rows_of, stops, transformed};
use super::{impossible, write_picture};
use crate::commands::picture::files::{Source, failed, open};
use crate::commands::picture::three_values::ThreeValues;
use crate::commands::words::Words;
use crate::failure::{Failure, Outcome, reason};
use glam::DMat3;
use radsight_picture::{
    Encoding, Header, PictureError, PictureReader, RgbPrimaries, Tiff, TiffColors, TiffCompression, TiffPixels,
    TiffTags, WHITE_EFFICACY, decode_rgbe, encode_rgbe, read_tiff_pixels, write_tiff_pixels, xyz_to_rgb,
};
use radsight_picture_ops::brightness::of_rgb;
use radsight_picture_ops::gamma::{GammaTable, shifted, with_grey};
use radsight_picture_ops::gamut::{Gamut, within_gamut};
use std::io::Read;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Depth {
    Bytes,
    Words,
    Floats,
    LogLuv,
}

struct Options {
    direction: Direction,
    colors: Colors,
    depth: Depth,
    compression: TiffCompression,
    gamma: f64,
    stops: i32,
    /// The encoding of a picture made from TIFF.
    encoding: Encoding,
}

/// Runs the program.
pub(crate) fn run(mut words: Words<'_>) -> Outcome {
    let mut options = Options {
        direction: Direction::FromRadiance,
        colors: Colors::Color,
        depth: Depth::Bytes,
        compression: TiffCompression::None,
        gamma: GAMMA,
        stops: 0,
        encoding: Encoding::Rgbe,
    };
    while let Some(option) = words.option()? {
        match option {
            "-b" => options.colors = Colors::Grey,
            "-w" => options.depth = Depth::Words,
            "-f" => options.depth = Depth::Floats,
            "-z" => options.compression = TiffCompression::Lzw,
            "-g" => options.gamma = words.number(option)?,
            "-e" => options.stops = stops(&mut words, option)?,
            "-r" => options.direction = Direction::ToRadiance,
            "-L" => options.depth = Depth::LogLuv,
            "-x" => {
                options.encoding = match options.encoding {
                    Encoding::Xyze => Encoding::Rgbe,
                    _ => Encoding::Xyze,
                }
            }
            "-l" => {
                return Err(Failure::usage(
                    "ra_tiff: option \"-l\" (24-bit LogLuv) is not supported, expected -L or -f for the full range",
                ));
            }
            _ => return Err(words.unknown(option)),
        }
    }
    match options.direction {
        Direction::FromRadiance => from_radiance(&options, &words),
        Direction::ToRadiance => to_radiance(&options, &words),
    }
}

fn from_radiance(options: &Options, words: &Words<'_>) -> Outcome {
    let (path, target) = words.input_and_output()?;
    if options.depth == Depth::LogLuv && options.colors == Colors::Grey {
        return Err(Failure::usage(
            "ra_tiff: -b with -L (grey LogLuv) is not supported, expected one of them".to_owned(),
        ));
    }
    let reader = open_picture(path)?;
    let mut header = reader.header().history();
    header.push_command(words.all());
    if options.stops != 0 {
        header.push_exposure(options.scale());
    }
    let wrong = |error: PictureError| failed(path, error.into());
    let picture = options.tiff(reader, header).map_err(wrong)?;
    let bytes = write_tiff_pixels(&picture, options.compression).map_err(wrong)?;
    put_file(target, |out| out.write_all(&bytes).map_err(|error| Failure::write(target, &error)))
}

impl Options {
    fn scale(&self) -> f64 {
        2f64.powi(self.stops)
    }

    /// The content of a TIFF file for a picture.
    fn tiff(&self, reader: PictureReader<Source>, header: Header) -> Result<Tiff, PictureError> {
        let resolution = reader.resolution();
        // XYZE has luminance, RGBE radiance.
        let efficacy = if reader.encoding() == Encoding::Xyze { 1.0 } else { WHITE_EFFICACY };
        let mut tags = TiffTags::from_header(reader.header())?;
        tags.nits = Some(efficacy / reader.header().exposure()? / self.scale());
        let components = if self.colors == Colors::Grey { 1 } else { 3 };
        let colors = if self.depth == Depth::LogLuv { TiffColors::Xyz } else { TiffColors::Rgb };
        let primaries = tags.primaries.unwrap_or(RgbPrimaries::STANDARD);
        let pixels = match self.depth {
            Depth::Bytes => TiffPixels::Bytes(self.bytes(reader, &primaries)?),
            Depth::Words => {
                let floats = self.floats(reader, &primaries)?;
                TiffPixels::Words(floats.into_iter().map(|value| self.word(value)).collect())
            }
            Depth::Floats | Depth::LogLuv => TiffPixels::Floats(self.floats(reader, &primaries)?),
        };
        Ok(Tiff { resolution, components, pixels, colors, tags, header: Some(header) })
    }

    fn bytes(&self, reader: PictureReader<Source>, primaries: &RgbPrimaries) -> Result<Vec<u8>, PictureError> {
        let table = GammaTable::new(self.gamma);
        let mut pixels = match self.colors {
            Colors::Color => Pixels::new(reader, self.stops, primaries)?,
            Colors::Grey => Pixels::for_grey(reader, self.stops),
        };
        let mut bytes = Vec::new();
        for _ in 0..pixels.size().1 {
            for pixel in pixels.next()? {
                match self.colors {
                    Colors::Color => bytes.extend_from_slice(&table.to_bytes(*pixel)),
                    Colors::Grey => bytes.push(table.to_bytes(with_grey(*pixel))[1]),
                }
            }
        }
        Ok(bytes)
    }

    /// Values for 16 bits, floats and LogLuv. Spectra are integrated.
    fn floats(&self, reader: PictureReader<Source>, primaries: &RgbPrimaries) -> Result<Vec<f32>, PictureError> {
        let mut pixels = ThreeValues::new(reader);
        let resolution = pixels.reader().resolution();
        let are_xyz = pixels.are_xyz();
        let matrix = match (self.depth, are_xyz) {
            _ if self.colors == Colors::Grey => None,
            (Depth::LogLuv, false) => Some(primaries.rgb_to_xyz().ok_or(impossible(0, primaries))?),
            (Depth::LogLuv, true) | (_, false) => None,
            (_, true) => Some(primaries.xyz_to_rgb().ok_or(impossible(0, primaries))?),
        };
        let matrix = matrix.map(rows_of);
        let scale = self.scale();
        let (mut row, mut floats) = (vec![[0.0f32; 3]; resolution.scanline_length()], Vec::new());
        for _ in 0..resolution.scanlines() {
            pixels.read(&mut row)?;
            for value in &row {
                let value = matrix.as_ref().map_or(*value, |matrix| self.converted(matrix, *value));
                let grey = || if are_xyz { f64::from(value[1]) } else { of_rgb(value) };
                match self.colors {
                    Colors::Grey => floats.push((grey() * scale) as f32),
                    Colors::Color => floats.extend(value.map(|part| (f64::from(part) * scale) as f32)),
                }
            }
        }
        Ok(floats)
    }

    /// A value in other primaries. Only integers need a positive one.
    fn converted(&self, matrix: &[[f32; 3]; 3], value: [f32; 3]) -> [f32; 3] {
        match transformed(matrix, value) {
            rgb if self.depth == Depth::Words => within_gamut(rgb, of_rgb(rgb), Gamut::Positive),
            value => value,
        }
    }

    fn word(&self, value: f32) -> u16 {
        match value {
            value if value <= 0.0 => 0,
            value if value >= 1.0 => u16::MAX,
            value => (65536.0 * f64::from(value).powf(1.0 / self.gamma)) as u16,
        }
    }

    /// The pixel of a TIFF whose numbers begin at `start`, before its exposure is changed.
    fn pixel(&self, picture: &Tiff, start: usize, table: &GammaTable) -> [u8; 4] {
        let at = |component: usize| start + if picture.components < 3 { 0 } else { component };
        match &picture.pixels {
            TiffPixels::Bytes(bytes) => table.pixel(std::array::from_fn(|i| bytes[at(i)])),
            TiffPixels::Words(words) => encode_rgbe(std::array::from_fn(|i| {
                ((f64::from(words[at(i)]) + 0.5) / 65536.0).powf(self.gamma) as f32
            })),
            TiffPixels::Floats(floats) => encode_rgbe(std::array::from_fn(|i| floats[at(i)])),
        }
    }

    /// The header of a picture made from a TIFF, in the order of lines of Radiance's converter.
    fn header(&self, words: &Words<'_>, tags: &TiffTags) -> Header {
        /// Shapes of pixels that are as good as square.
        const SQUARE: std::ops::RangeInclusive<f64> = 0.995..=1.005;
        let mut header = Header::new("RADIANCE");
        header.push_command(words.taken());
        if let Some(aspect) = tags.pixel_aspect.filter(|aspect| !SQUARE.contains(aspect)) {
            header.push_variable("PIXASPECT", &format!("{aspect:.6}"));
        }
        let is_rgb = self.encoding != Encoding::Xyze;
        if let Some(primaries) = tags.primaries.filter(|_| is_rgb) {
            header.push_variable("PRIMARIES", &primaries.to_header_value());
        }
        if let Some(nits) = tags.nits {
            header.push_exposure(if is_rgb { WHITE_EFFICACY } else { 1.0 } * self.scale() / nits);
        }
        header.push_variable("FORMAT", self.encoding.name());
        for (name, text) in [("CAPDATE", &tags.date), ("OWNER", &tags.owner)] {
            if let Some(text) = text {
                header.push_variable(name, &format!(" {text}"));
            }
        }
        header
    }
}

/// The conversion of a TIFF's colours.
enum FromTiff {
    None,
    /// From red, green and blue to tristimulus values.
    ToXyz([[f32; 3]; 3]),
    /// From tristimulus values, without negative components.
    FromXyz(DMat3),
}

impl FromTiff {
    fn new(picture: &Tiff, encoding: Encoding) -> Result<FromTiff, PictureError> {
        let primaries = picture.tags.primaries.unwrap_or(RgbPrimaries::STANDARD);
        match (picture.colors, encoding) {
            (TiffColors::Rgb, Encoding::Xyze) => {
                Ok(FromTiff::ToXyz(rows_of(primaries.rgb_to_xyz().ok_or(impossible(0, &primaries))?)))
            }
            (TiffColors::Rgb, _) => Ok(FromTiff::None),
            (TiffColors::Xyz, Encoding::Xyze) => Ok(FromTiff::FromXyz(DMat3::IDENTITY)),
            (TiffColors::Xyz, _) => {
                let standard = &RgbPrimaries::STANDARD;
                Ok(FromTiff::FromXyz(standard.xyz_to_rgb().ok_or(impossible(0, standard))?))
            }
        }
    }
}

fn to_radiance(options: &Options, words: &Words<'_>) -> Outcome {
    let (path, target) = words.input_and_output()?;
    let mut bytes = Vec::new();
    let read = open(path)?.read_to_end(&mut bytes);
    read.map_err(|error| Failure::input(format!("{path}: {}", reason(&error))))?;
    let wrong = |error: PictureError| failed(path, error.into());
    let mut picture = read_tiff_pixels(&bytes).map_err(wrong)?;
    if picture.colors == TiffColors::Xyz || picture.components < 3 {
        picture.tags.primaries = None;
    }
    let table = GammaTable::new(options.gamma);
    let conversion = FromTiff::new(&picture, options.encoding).map_err(wrong)?;
    let header = options.header(words, &picture.tags);
    let length = picture.resolution.scanline_length();
    write_picture(target, &header, picture.resolution, |row, stored| {
        for column in 0..length {
            let start = (row * length + column) * picture.components;
            let pixel = match (&conversion, &picture.pixels) {
                (FromTiff::FromXyz(matrix), TiffPixels::Floats(floats)) => {
                    encode_rgbe(xyz_to_rgb(matrix, std::array::from_fn(|i| floats[start + i])))
                }
                (FromTiff::ToXyz(matrix), _) => {
                    encode_rgbe(transformed(matrix, decode_rgbe(options.pixel(&picture, start, &table))))
                }
                _ => options.pixel(&picture, start, &table),
            };
            stored.extend_from_slice(&shifted(pixel, options.stops));
        }
        Ok(())
    })
}
