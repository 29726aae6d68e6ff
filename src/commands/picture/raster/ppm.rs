//! `ra_ppm [-r] [-a] [-b] [-s MAX] [-g GAMMA] [-e ±STOPS] [input [output]]`: portable pixmaps,
//! binary or text (`-a`), grey (`-b`), with 16 bits from `-s 256`; `-r` converts to Radiance.

use super::{Colors, Direction, GAMMA, Pixels, converted_header, open_picture, put_file, stops, write_picture};
use crate::commands::picture::files::{failed, open};
use crate::commands::words::Words;
use crate::failure::{Failure, Outcome, reason};
use radsight_picture::{Header, PictureError, Resolution, decode_rgbe, encode_rgbe};
use radsight_picture_ops::brightness::of_rgb;
use radsight_picture_ops::gamma::{GammaTable, shifted, with_grey};
use std::io::Read;

struct Options {
    direction: Direction,
    is_text: bool,
    colors: Colors,
    largest: u32,
    gamma: f64,
    stops: i32,
}

/// Runs the program.
pub(crate) fn run(mut words: Words<'_>) -> Outcome {
    let mut options = Options {
        direction: Direction::FromRadiance,
        is_text: false,
        colors: Colors::Color,
        largest: 255,
        gamma: GAMMA,
        stops: 0,
    };
    while let Some(option) = words.option()? {
        match option {
            "-s" => options.largest = words.integer(option)?.clamp(1, 0xffff) as u32,
            "-b" => options.colors = Colors::Grey,
            "-g" => options.gamma = words.number(option)?,
            "-e" => options.stops = stops(&mut words, option)?,
            "-a" => options.is_text = true,
            "-r" => options.direction = Direction::ToRadiance,
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
    let wrong = |error: PictureError| failed(path, error.into());
    let mut pixels = Pixels::standard(open_picture(path)?, options.stops, options.colors).map_err(wrong)?;
    let (columns, rows) = pixels.size();
    let kind = if options.colors == Colors::Grey { 2 } else { 3 } + if options.is_text { 0 } else { 3 };
    let table = GammaTable::new(options.gamma);
    put_file(target, |out| {
        let largest = options.largest;
        let mut bytes = format!("P{kind}\n{columns} {rows}\n{largest}\n").into_bytes();
        for _ in 0..rows {
            for pixel in pixels.next().map_err(wrong)? {
                let numbers = if largest > 255 { options.words(*pixel) } else { options.bytes(*pixel, &table) };
                let numbers = if options.colors == Colors::Grey { &numbers[1..2] } else { &numbers[..] };
                options.put(numbers, &mut bytes);
            }
            out.write_all(&bytes).map_err(|error| Failure::write(target, &error))?;
            bytes.clear();
        }
        out.write_all(&bytes).map_err(|error| Failure::write(target, &error))
    })
}

impl Options {
    fn bytes(&self, pixel: [u8; 4], table: &GammaTable) -> [u32; 3] {
        let pixel = if self.colors == Colors::Grey { with_grey(pixel) } else { pixel };
        table.to_bytes(pixel).map(u32::from)
    }

    fn words(&self, pixel: [u8; 4]) -> [u32; 3] {
        let mut value = decode_rgbe(pixel);
        if self.colors == Colors::Grey {
            value[1] = of_rgb(value) as f32;
        }
        value.map(|value| {
            let value = f64::from(value).powf(1.0 / self.gamma) as f32;
            match f64::from(value) {
                value if value >= 0.99999 => self.largest,
                value if value <= 0.0 => 0,
                value => (value * f64::from(self.largest + 1)) as u32,
            }
        })
    }

    fn put(&self, numbers: &[u32], bytes: &mut Vec<u8>) {
        if self.is_text {
            let text: Vec<String> = numbers.iter().map(u32::to_string).collect();
            bytes.extend_from_slice(text.join(" ").as_bytes());
            bytes.push(b'\n');
        } else if self.largest > 255 {
            bytes.extend(numbers.iter().flat_map(|number| (*number as u16).to_be_bytes()));
        } else {
            bytes.extend(numbers.iter().map(|number| *number as u8));
        }
    }
}

/// An input pixmap.
struct Pixmap {
    bytes: Vec<u8>,
    at: usize,
    is_text: bool,
    components: usize,
    largest: u32,
}

fn to_radiance(options: &Options, words: &Words<'_>) -> Outcome {
    let (path, target) = words.input_and_output()?;
    let mut bytes = Vec::new();
    let read = open(path)?.read_to_end(&mut bytes);
    read.map_err(|error| Failure::input(format!("{path}: {}", reason(&error))))?;
    let wrong = |expected: &str| Failure::input(format!("{path}: not a portable pixmap, expected {expected}"));
    let (components, is_text) = match bytes.get(..2) {
        Some(b"P2") => (1, true),
        Some(b"P3") => (3, true),
        Some(b"P5") => (1, false),
        Some(b"P6") => (3, false),
        _ => return Err(wrong("P2, P3, P5 or P6")),
    };
    let mut map = Pixmap { bytes, at: 2, is_text: true, components, largest: 0 };
    let number = |map: &mut Pixmap| map.number().ok_or_else(|| wrong("columns, rows and the largest value"));
    let (columns, rows) = (number(&mut map)? as usize, number(&mut map)? as usize);
    map.largest = number(&mut map)?.clamp(1, 0xffff);
    if !is_text {
        map.at += 1;
        map.is_text = false;
    }
    if columns == 0 || rows == 0 || columns.saturating_mul(rows) > map.bytes.len() {
        return Err(wrong("as many pixels as declared"));
    }
    let table = GammaTable::new(options.gamma);
    let header = converted_header(words, &Header::default());
    write_picture(target, &header, Resolution::standard(columns, rows), |_, stored| {
        for _ in 0..columns {
            let value = map.pixel().ok_or_else(|| wrong("as many pixels as declared"))?;
            stored.extend_from_slice(&options.pixel(value, map.largest, &table));
        }
        Ok(())
    })
}

impl Options {
    fn pixel(&self, value: [u32; 3], largest: u32, table: &GammaTable) -> [u8; 4] {
        if largest < 256 {
            let bytes = value.map(|value| if value >= largest { 255 } else { (value * 255 / largest) as u8 });
            return shifted(table.pixel(bytes), self.stops);
        }
        let scale = 2f64.powi(self.stops);
        encode_rgbe(value.map(|value| {
            let linear = ((f64::from(value) + 0.5) / f64::from(largest + 1)).powf(self.gamma) as f32;
            (f64::from(linear) * scale) as f32
        }))
    }
}

impl Pixmap {
    /// A number of the text; comments are skipped.
    fn number(&mut self) -> Option<u32> {
        loop {
            match self.bytes.get(self.at)? {
                b'#' => {
                    let line = self.bytes[self.at..].iter().position(|byte| *byte == b'\n')?;
                    self.at += line + 1;
                }
                byte if byte.is_ascii_whitespace() => self.at += 1,
                _ => break,
            }
        }
        let digits = self.bytes[self.at..].iter().take_while(|byte| byte.is_ascii_digit()).count();
        let text = std::str::from_utf8(&self.bytes[self.at..self.at + digits]).ok()?;
        self.at += digits;
        text.parse().ok()
    }

    fn sample(&mut self) -> Option<u32> {
        if self.is_text {
            return self.number();
        }
        let size = if self.largest > 255 { 2 } else { 1 };
        let bytes = self.bytes.get(self.at..self.at + size)?;
        self.at += size;
        Some(bytes.iter().fold(0, |number, byte| number << 8 | u32::from(*byte)))
    }

    fn pixel(&mut self) -> Option<[u32; 3]> {
        let first = self.sample()?;
        if self.components == 1 {
            return Some([first; 3]);
        }
        Some([first, self.sample()?, self.sample()?])
    }
}
