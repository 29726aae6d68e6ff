//! `pvalue`: prints a picture as numbers, and with `-r` converts numbers to a picture.
//!
//! `-o` undoes exposures, `-O` also converts XYZE to W/(sr·m²); `-h` no header, `-H` no resolution,
//! `-u` omits repeated pixels (with `-r`: no run-length encoding), `-d` no positions; `-da -di -db
//! -dw -dW -df -dF -dd -dD` number format (capitals swap bytes); `-b` brightness, `-pr -pg -pb` one
//! component, `-R` blue first, `-n` components as planes; `-g G` gamma, `-e E` exposure; with `-r`
//! also `-x N -y N` size, `-pXYZ` XYZE, `-p rx ry gx gy bx by wx wy` primaries, `-s N` bytes to
//! skip, and three files. `+` instead of `-` undoes an option.

mod reading;

use super::files::{failed, finish, open, open_twice, output, write_failed};
use crate::commands::words::Words;
use crate::failure::{Failure, Outcome};
use radsight_picture::{Encoding, Header, Orientation, PictureReader, Resolution, RgbPrimaries, WHITE_EFFICACY};
use radsight_picture_ops::brightness::Brightness;
use radsight_picture_ops::values::{ByteOrder, ComponentOrder, NumberForm, Part, ValueLayout};
use std::io::{Read, Seek, SeekFrom, Write};

/// The exposures to undo.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Original {
    No,
    Values,
    Watts,
}

/// The parsed options.
struct Options {
    layout: ValueLayout,
    /// Whether positions of pixels are omitted.
    data_only: bool,
    unique: bool,
    original: Original,
    header: bool,
    resolution: bool,
    interleaved: bool,
    reverse: bool,
    gamma: f64,
    exposure: [f32; 3],
    /// The exposure recorded in the header.
    recorded_exposure: f64,
    skip: u64,
    /// Size and order of the pixels, if `-x` and `-y` give them.
    size: Size,
    /// Custom primaries of the picture; `None` for XYZE.
    primaries: Option<RgbPrimaries>,
}

#[derive(Clone, Copy)]
struct Size {
    width: usize,
    height: usize,
    orientation: Orientation,
}

/// Runs the program.
pub(super) fn run(mut words: Words<'_>) -> Outcome {
    let options = Options::read(&mut words)?;
    if options.reverse { reading::run(options, &words) } else { print(options, &words) }
}

/// The sign before the name of an option.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sign {
    Minus,
    Plus,
}

/// An axis of a picture.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Axis {
    X,
    Y,
}

impl Options {
    fn read(words: &mut Words<'_>) -> Result<Options, Failure> {
        let layout = ValueLayout {
            form: NumberForm::Text,
            part: Part::All,
            order: ComponentOrder::Forward,
            bytes: ByteOrder::Native,
        };
        let mut options = Options {
            layout,
            data_only: false,
            unique: false,
            original: Original::No,
            header: true,
            resolution: true,
            interleaved: true,
            reverse: false,
            gamma: 1.0,
            exposure: [1.0; 3],
            recorded_exposure: 1.0,
            skip: 0,
            size: Size { width: 0, height: 0, orientation: Orientation::STANDARD },
            primaries: Some(RgbPrimaries::STANDARD),
        };
        while let Some(option) = words.next_if(|word| word.len() > 1 && word.starts_with(['-', '+'])) {
            words.meant(option)?;
            options.take(option, words)?;
        }
        Ok(options)
    }

    fn take(&mut self, option: &str, words: &mut Words<'_>) -> Outcome {
        let sign = if option.starts_with('-') { Sign::Minus } else { Sign::Plus };
        let on = sign == Sign::Minus;
        match &option[1..] {
            "h" => self.header = !on,
            "H" => self.resolution = !on,
            "s" => self.skip = words.integer(option)?.max(0) as u64,
            "u" => self.unique = on,
            "o" => self.original = if on { Original::Values } else { Original::No },
            "O" => self.original = if on { Original::Watts } else { Original::No },
            "g" => {
                let gamma = words.number(option)?;
                self.gamma = if on { gamma } else { 1.0 / gamma };
            }
            "e" => {
                let word = words.value(option, "an exposure")?;
                let number = words.number_in(word, option)?;
                let factor = if word.starts_with(['+', '-']) { 2f64.powf(number) } else { number };
                if on {
                    self.recorded_exposure *= factor;
                }
                self.expose(factor);
            }
            "R" => self.layout.order = if on { ComponentOrder::Backward } else { ComponentOrder::Forward },
            "r" => self.reverse = on,
            "n" => self.interleaved = !on,
            "b" => self.layout.part = if on { Part::Brightness } else { Part::All },
            "p" => self.primaries = Some(words.primaries(option)?),
            name if name.starts_with("pr") || name.starts_with("pR") => self.layout.part = Part::Component(0),
            name if name.starts_with("pg") || name.starts_with("pG") => self.layout.part = Part::Component(1),
            name if name.starts_with("pb") || name.starts_with("pB") => self.layout.part = Part::Component(2),
            name if name.starts_with(['x', 'X', 'y', 'Y']) => {
                let axis = if name.starts_with(['x', 'X']) { Axis::X } else { Axis::Y };
                self.take_size(axis, sign, words.integer(option)?.max(0) as usize);
            }
            name if name.starts_with("px") || name.starts_with("pX") => self.primaries = None,
            name if name.starts_with('d') => self.take_form(name, sign).ok_or_else(|| words.unknown(option))?,
            _ => return Err(words.unknown(option)),
        }
        Ok(())
    }

    fn take_form(&mut self, name: &str, sign: Sign) -> Option<()> {
        self.data_only = sign == Sign::Minus;
        self.layout.form = match name {
            "d" | "da" => NumberForm::Text,
            "di" => NumberForm::Integer,
            "db" => NumberForm::Byte,
            "dw" | "dW" => NumberForm::Word,
            "df" | "dF" => NumberForm::Float,
            "dd" | "dD" => NumberForm::Double,
            _ => return None,
        };
        if name.ends_with(['W', 'F', 'D']) {
            self.layout.bytes = ByteOrder::Swapped;
        }
        self.data_only |= self.layout.form.size().is_some();
        Some(())
    }

    /// The axis whose size is given first is the one from scanline to scanline.
    fn take_size(&mut self, axis: Axis, sign: Sign, pixels: usize) {
        self.resolution = false;
        let size = &mut self.size;
        let falls = sign == Sign::Minus;
        if axis == Axis::X {
            size.orientation.x_falls = falls;
            size.orientation.scanlines_are_rows &= size.height > 0;
            size.width = pixels;
        } else {
            size.orientation.y_falls = falls;
            size.orientation.scanlines_are_rows |= size.width == 0;
            size.height = pixels;
        }
    }

    fn expose(&mut self, factor: f64) {
        self.exposure = self.exposure.map(|part| (f64::from(part) * factor) as f32);
    }

    /// Reads the exposures from the header, if they are undone; returns the header without lines
    /// that do not apply to the output.
    fn history(&mut self, header: &Header) -> Result<Header, Failure> {
        let mut history = header.history();
        if self.original != Original::No {
            let scale = header.radiance_scale().map_err(|error| Failure::input(error.to_string()))?;
            self.exposure = std::array::from_fn(|i| self.exposure[i] * scale[i]);
            history.remove("EXPOSURE");
            history.remove("COLORCORR");
        }
        Ok(history)
    }

    /// The factor of each component, if not all are 1.
    fn factors(&self) -> Option<[f32; 3]> {
        (self.exposure != [1.0; 3]).then_some(self.exposure)
    }

    /// The exponent of the gamma, if it is not 1.
    fn changed_gamma(&self) -> Option<f64> {
        (!(0.95..=1.05).contains(&self.gamma)).then_some(self.gamma)
    }

    fn push_recorded_exposure(&self, header: &mut Header) {
        if !(0.99..=1.01).contains(&self.recorded_exposure) {
            header.push_exposure(self.recorded_exposure);
        }
    }
}

fn power(pixel: [f32; 3], exponent: f64) -> [f32; 3] {
    pixel.map(|value| f64::from(value).powf(exponent) as f32)
}

/// Prints a picture as numbers.
fn print(mut options: Options, words: &Words<'_>) -> Outcome {
    let path = words.one_file()?;
    if options.layout.part != Part::All || options.interleaved {
        let mut source = open(path)?;
        skip(&mut source, options.skip)?;
        let reader = PictureReader::new(source).map_err(|error| failed(path, error.into()))?;
        let mut out = output();
        print_header(&mut options, &reader, words, &mut out)?;
        print_pixels(&options, reader, path, &mut out)?;
        return finish(out);
    }
    let mut file = open_twice(path)?;
    let mut out = output();
    for component in 0..3 {
        file.seek(SeekFrom::Start(options.skip)).map_err(|error| write_failed(&error))?;
        let reader = PictureReader::new(&file).map_err(|error| failed(path, error.into()))?;
        if component == 0 {
            print_header(&mut options, &reader, words, &mut out)?;
        }
        options.layout.part = Part::Component(component);
        print_pixels(&options, reader, path, &mut out)?;
    }
    finish(out)
}

fn skip(source: &mut impl Read, count: u64) -> Outcome {
    let skipped = std::io::copy(&mut source.by_ref().take(count), &mut std::io::sink());
    match skipped {
        Ok(skipped) if skipped == count => Ok(()),
        _ => Err(Failure::input(format!("pvalue: the input ends before {count} bytes are skipped"))),
    }
}

fn print_header<R: Read>(
    options: &mut Options,
    reader: &PictureReader<R>,
    words: &Words<'_>,
    out: &mut impl Write,
) -> Outcome {
    let mut header = options.history(reader.header())?;
    let layout = options.layout;
    if options.original == Original::Watts && reader.encoding() == Encoding::Xyze {
        options.expose(1.0 / WHITE_EFFICACY);
    }
    let resolution = reader.resolution();
    if options.header {
        header.push_command(words.taken());
        if options.data_only {
            header.push_variable("NCOMP", &layout.numbers().to_string());
            if !options.resolution && !options.unique {
                header.push_variable("NCOLS", &resolution.scanline_length().to_string());
                header.push_variable("NROWS", &resolution.scanlines().to_string());
            }
        }
        options.push_recorded_exposure(&mut header);
        let is_big = cfg!(target_endian = "big") != (layout.bytes == ByteOrder::Swapped);
        if layout.bytes == ByteOrder::Swapped
            || matches!(layout.form, NumberForm::Word | NumberForm::Float | NumberForm::Double)
        {
            header.push_variable("BigEndian", if is_big { "1" } else { "0" });
        }
        let format = match layout.form {
            // Only text has a format with positions.
            form if options.data_only => form.format_name(layout.part),
            _ => "ascii",
        };
        header.push_variable("FORMAT", format);
        out.write_all(&header.to_bytes()).map_err(|error| write_failed(&error))?;
    }
    if options.resolution {
        writeln!(out, "{resolution}").map_err(|error| write_failed(&error))?;
    }
    Ok(())
}

fn print_pixels<R: Read>(options: &Options, mut reader: PictureReader<R>, path: &str, out: &mut impl Write) -> Outcome {
    let resolution = reader.resolution();
    let brightness = match reader.encoding() {
        Encoding::Xyze => Brightness::new(Encoding::Xyze, 3),
        _ => Brightness::new(Encoding::Rgbe, 3),
    };
    let (factors, gamma) = (options.factors(), options.changed_gamma());
    let mut pixels = vec![[0.0f32; 3]; resolution.scanline_length()];
    let (mut last, mut bytes) = ([0.0f32; 3], Vec::new());
    for scanline in 0..resolution.scanlines() {
        reader.read_three(&mut pixels).map_err(|error| failed(path, error.into()))?;
        bytes.clear();
        for (position, pixel) in pixels.iter().enumerate() {
            let mut pixel = *pixel;
            if options.unique {
                if pixel == last {
                    continue;
                }
                last = pixel;
            }
            if let Some(factors) = factors {
                pixel = std::array::from_fn(|i| pixel[i] * factors[i]);
            }
            if let Some(gamma) = gamma {
                pixel = power(pixel, 1.0 / gamma);
            }
            if !options.data_only {
                put_position(&resolution, position, scanline, &mut bytes);
            }
            options.layout.put(pixel, &brightness, &mut bytes);
        }
        out.write_all(&bytes).map_err(|error| write_failed(&error))?;
    }
    Ok(())
}

/// Column from the left and row from the bottom.
fn put_position(resolution: &Resolution, position: usize, scanline: usize, bytes: &mut Vec<u8>) {
    let [x, y] = resolution.location(position, scanline);
    let (column, row) = ((x * resolution.width as f64) as usize, (y * resolution.height as f64) as usize);
    let _ = write!(bytes, "{column:7} {row:7} ");
}
