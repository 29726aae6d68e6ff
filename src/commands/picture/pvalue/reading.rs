//! `pvalue -r`: converts numbers to a picture.

use super::{Options, Original, power, skip};
use crate::commands::picture::files::{Source, failed, open, output, read_header};
use crate::commands::words::Words;
use crate::failure::{Failure, Outcome, reason};
use radsight_picture::{Header, PictureError, PictureWriter, Resolution, RgbPrimaries, WHITE_EFFICACY, encode_rgbe};
use radsight_picture_ops::values::{ByteOrder, NumberForm, Part};
use radsight_scene_generators::source_name;
use std::io::{BufRead, BufReader, Read};

/// Longest word of a number or line of a resolution, bytes.
const LONGEST_WORD: usize = 400;

/// A source of numbers.
struct Numbers {
    name: String,
    reader: BufReader<Source>,
}

/// Runs the program.
pub(super) fn run(mut options: Options, words: &Words<'_>) -> Outcome {
    let mut inputs = open_inputs(&options, words)?;
    let header = if options.header { read_headers(&mut options, &mut inputs)? } else { Header::new("RADIANCE") };
    let resolution = read_resolution(&options, &mut inputs)?;
    let header = output_header(&mut options, header, words)?;
    if !options.interleaved && inputs.len() == 3 && words.rest().len() == 1 {
        let size = options.layout.form.size().ok_or_else(|| {
            Failure::input("pvalue: numbers as text must be interleaved, expected binary ones with -n")
        })?;
        let plane = (size * resolution.width * resolution.height) as u64;
        skip(&mut inputs[1].reader, plane)?;
        skip(&mut inputs[2].reader, 2 * plane)?;
    }
    write(&options, inputs, &header, resolution)
}

fn open_inputs(options: &Options, words: &Words<'_>) -> Result<Vec<Numbers>, Failure> {
    let single = options.layout.part == Part::Brightness;
    let files = match words.rest() {
        [] => vec!["-"],
        [file] if !options.interleaved && !single => vec![file.as_str(); 3],
        [file] => vec![file.as_str()],
        [red, green, blue] if !single => vec![red.as_str(), green, blue],
        [_, second, ..] => return Err(words.too_many(second)),
    };
    if files[0] == "-" && !options.interleaved && !single {
        return Err(Failure::usage("pvalue: components one after another need a file, expected its name after -n"));
    }
    let opened = files.into_iter().map(|path| {
        let mut reader = BufReader::with_capacity(1 << 17, open(path)?);
        skip(&mut reader, options.skip)?;
        Ok(Numbers { name: path.to_owned(), reader })
    });
    opened.collect()
}

/// Reads the headers of all inputs; the first one applies.
fn read_headers(options: &mut Options, inputs: &mut [Numbers]) -> Result<Header, Failure> {
    let mut headers = Vec::new();
    for input in inputs {
        headers.push(input.read_header()?);
    }
    let header = headers.swap_remove(0);
    let wrong = |error: PictureError| Failure::input(format!("pvalue: {error}"));
    if let Some(format) = header.format() {
        let single = if options.layout.part == Part::All { Part::All } else { Part::Brightness };
        if options.layout.form == NumberForm::Text {
            options.layout.form = match format.as_ref() {
                "ascii" => NumberForm::Text,
                "float" => NumberForm::Float,
                "double" => NumberForm::Double,
                "byte" => NumberForm::Byte,
                "16-bit" => NumberForm::Word,
                other => {
                    return Err(Failure::input(format!(
                        "pvalue: the input's format is \"{other}\", expected ascii, float, double, byte or 16-bit"
                    )));
                }
            };
        } else if options.layout.form.format_name(single) != format {
            let expected = options.layout.form.format_name(single);
            return Err(Failure::input(format!("pvalue: the input's format is \"{format}\", expected \"{expected}\"")));
        }
    }
    if let Some(rows) = header.count("NROWS").map_err(wrong)? {
        options.size.height = rows;
    }
    if let Some(columns) = header.count("NCOLS").map_err(wrong)? {
        options.size.width = columns;
    }
    if let Some(big) = header.is_big_endian() {
        options.layout.bytes = if big == cfg!(target_endian = "big") { ByteOrder::Native } else { ByteOrder::Swapped };
    }
    let components = header.components().map_err(wrong)?;
    options.data_only |= components.is_some();
    options.resolution &= options.size.width == 0 || options.size.height == 0;
    match (components.unwrap_or(3), options.layout.part) {
        (1, Part::All) => options.layout.part = Part::Brightness,
        (1, _) | (3, Part::All) => {}
        (3, _) => return Err(Failure::input("pvalue: the input has 3 components, expected 1 with -b or -p")),
        (other, _) => return Err(Failure::input(format!("pvalue: the input has {other} components, expected 1 or 3"))),
    }
    options.history(&header)
}

fn read_resolution(options: &Options, inputs: &mut [Numbers]) -> Result<Resolution, Failure> {
    if options.resolution {
        let found: Vec<Resolution> = inputs.iter_mut().map(Numbers::read_resolution).collect::<Result<_, _>>()?;
        if found.iter().any(|other| *other != found[0]) {
            return Err(Failure::input("pvalue: the three files have different sizes"));
        }
        return Ok(found[0]);
    }
    let super::Size { width, height, orientation } = options.size;
    if width == 0 || height == 0 {
        return Err(Failure::usage("pvalue: the size of the picture is not known, expected -y rows +x columns"));
    }
    Ok(Resolution { width, height, orientation })
}

fn output_header(options: &mut Options, mut header: Header, words: &Words<'_>) -> Result<Header, Failure> {
    header.push_command(words.taken());
    options.push_recorded_exposure(&mut header);
    match options.primaries {
        Some(primaries) => {
            if primaries != RgbPrimaries::STANDARD {
                header.push_variable("PRIMARIES", &primaries.to_header_value());
            }
            header.push_variable("FORMAT", "32-bit_rle_rgbe");
        }
        None => {
            if options.original == Original::Watts {
                options.expose(WHITE_EFFICACY);
            }
            header.push_variable("FORMAT", "32-bit_rle_xyze");
        }
    }
    Ok(header)
}

fn write(options: &Options, mut inputs: Vec<Numbers>, header: &Header, resolution: Resolution) -> Outcome {
    let name = inputs[0].name.clone();
    let wrong = |error: PictureError| failed(&name, error.into());
    let (factors, gamma) = (options.factors(), options.changed_gamma());
    let mut writer = PictureWriter::new(output(), header, 3, resolution).map_err(wrong)?;
    let (mut pixels, mut stored) = (Vec::new(), Vec::new());
    for _ in 0..resolution.scanlines() {
        pixels.clear();
        for _ in 0..resolution.scanline_length() {
            let mut pixel = read_pixel(options, &mut inputs)?;
            if let Some(gamma) = gamma {
                pixel = power(pixel, gamma);
            }
            if let Some(factors) = factors {
                pixel = std::array::from_fn(|i| pixel[i] * factors[i]);
            }
            pixels.push(pixel);
        }
        if options.unique {
            stored.clear();
            stored.extend(pixels.iter().flat_map(|pixel| encode_rgbe(*pixel)));
            writer.write_flat(&stored).map_err(wrong)?;
        } else {
            writer.write_values(pixels.as_flattened()).map_err(wrong)?;
        }
    }
    writer.finish().map_err(wrong)
}

fn read_pixel(options: &Options, inputs: &mut [Numbers]) -> Result<[f32; 3], Failure> {
    if !options.data_only {
        for input in inputs.iter_mut() {
            input.skip_position()?;
        }
    }
    if options.layout.part != Part::All {
        let grey = inputs[0].next(options)?;
        return Ok([grey as f32; 3]);
    }
    let count = inputs.len();
    let mut numbers = [0.0; 3];
    for (index, number) in numbers.iter_mut().enumerate() {
        *number = inputs[index % count].next(options)?;
    }
    Ok(options.layout.pixel(numbers))
}

impl Numbers {
    fn wrong(&self, words: &str) -> Failure {
        Failure::input(format!("pvalue: {}: {words}", source_name(&self.name)))
    }

    fn read_header(&mut self) -> Result<Header, Failure> {
        read_header(&mut self.reader).map_err(|words| self.wrong(&words))
    }

    fn read_resolution(&mut self) -> Result<Resolution, Failure> {
        let mut line = Vec::new();
        let read = self.reader.by_ref().take(LONGEST_WORD as u64).read_until(b'\n', &mut line);
        read.map_err(|error| self.wrong(&reason(&error)))?;
        Resolution::read(&line, 0).map(|(found, _)| found).map_err(|error| self.wrong(&error.to_string()))
    }

    fn next(&mut self, options: &Options) -> Result<f64, Failure> {
        let mut binary = [0; 8];
        let number = match options.layout.form.size() {
            Some(size) => {
                let bytes = &mut binary[..size];
                self.reader.read_exact(bytes).map_err(|_| self.wrong("the numbers end, expected more pixels"))?;
                options.layout.number(bytes)
            }
            None => options.layout.number(&self.word()?),
        };
        number.map_err(|error| self.wrong(&format!("{error}, expected a pixel value")))
    }

    fn skip_position(&mut self) -> Outcome {
        self.word()?;
        self.word().map(|_| ())
    }

    /// The next word of a text.
    fn word(&mut self) -> Result<Vec<u8>, Failure> {
        let mut word = Vec::new();
        loop {
            let held = self.reader.fill_buf().map_err(|error| reason(&error));
            let held = match held {
                Ok(held) => held,
                Err(words) => return Err(self.wrong(&words)),
            };
            let blank = |byte: &u8| byte.is_ascii_whitespace() || *byte == 0x0b;
            let start = if word.is_empty() { held.iter().take_while(|byte| blank(byte)).count() } else { 0 };
            let length = held[start..].iter().take_while(|byte| !blank(byte)).count();
            word.extend_from_slice(&held[start..start + length.min(LONGEST_WORD + 1)]);
            let (ends, ended) = (start + length < held.len(), held.is_empty());
            self.reader.consume(start + length);
            if word.len() > LONGEST_WORD || (ended && word.is_empty()) {
                return Err(self.wrong("the numbers end, expected more pixels"));
            }
            if !word.is_empty() && (ends || ended) {
                return Ok(word);
            }
        }
    }
}
