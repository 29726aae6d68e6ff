//! `falsecolor`: brightness as colour, contours and bands, with a legend.
//!
//! `-i picture` (else standard input), `-p picture` background of contours, `-ip picture` both;
//! `-cl` lines, `-cb` bands, `-cp` steps, `-c0` no colours; `-s TOP` (or `auto`), `-log DECADES`,
//! `-n DIVISIONS`, `-m MULTIPLIER`, `-l LABEL`, `-d DIGITS`, `-lw W -lh H` size of the legend,
//! `-pal def|spec|pm3d|hot|eco|tbo`, `-palettes` shows them, `-r -g -b` custom functions of `v`;
//! `-e` marks the darkest and the brightest pixel; `-odim COLUMNS ROWS` prints values on the
//! picture, or on its part `-orct LEFT LOWER RIGHT UPPER`. Pictures in XYZE and of spectra are
//! converted to RGBE, in which the result is written.

mod overlay;

use super::files::{Source, failed, open, open_twice, output};
use super::psign::picture_of;
use super::ra_xyze::as_rgbe;
use crate::commands::words::Words;
use crate::failure::{Failure, Outcome};
use overlay::Overlay;
use radsight_picture::{Encoding, Header, Picture, PictureReader, WHITE_EFFICACY, encode_rgbe, general, scientific};
use radsight_picture_ops::ToolError;
use radsight_picture_ops::brightness::of_rgb;
use radsight_picture_ops::compose::{Layer, compose};
use radsight_picture_ops::extrema::extrema;
use radsight_picture_ops::falsecolor::{Background, Coverage, OwnComponent, Palette, Scale, falsecolor};
use radsight_picture_ops::filter::{FilterOptions, Size, filter_one_pass};
use radsight_picture_ops::sign::SignOptions;
use std::fs::File;
use std::io::{Cursor, Seek};

/// Smallest readable legend; smaller ones are omitted.
const SMALLEST_LEGEND: [i64; 2] = [20, 40];
/// Height of letters at the extrema, pixels.
const MARK_HEIGHT: usize = 32;
/// Height divided by width of a letter, and number of letters across the legend.
const LETTER: f64 = 8.0 / 1.67;

struct Options {
    scale: Scale,
    automatic: bool,
    label: String,
    digits: i64,
    legend: [i64; 2],
    picture: String,
    background: Option<String>,
    marks_extrema: bool,
    overlay: Overlay,
    shows_palettes: bool,
}

/// Runs the program.
pub(super) fn run(mut words: Words<'_>) -> Outcome {
    let mut options = read_options(&mut words)?;
    if options.shows_palettes {
        return palettes(&words);
    }
    if options.automatic || options.marks_extrema || options.has_overlay() {
        return with_file(&words, &mut options);
    }
    let reader = as_rgbe(reader_of(open(&options.picture)?, &options.picture)?, &options.picture)?;
    finish(&words, &options, reader, Annotations::default())
}

/// All palettes, each with its name.
fn palettes(words: &Words<'_>) -> Outcome {
    const WIDTH: usize = 256;
    const HEIGHT: usize = 30;
    const LETTERS: usize = 20;
    let sign = SignOptions { foreground: [1.0; 3], background: [0.0; 3], height: LETTERS, ..SignOptions::default() };
    let (mut layers, mut above) = (Vec::new(), 0);
    for (name, palette) in Palette::ALL {
        let row = (0..WIDTH).flat_map(|x| {
            let color = palette.color(x as f64 / WIDTH as f64);
            encode_rgbe(color.map(|part| part.clamp(0.0, 1.0) as f32))
        });
        let row: Vec<u8> = row.collect();
        for picture in [picture_bytes(WIDTH, HEIGHT, &row.repeat(HEIGHT))?, picture_of(name, &sign)?] {
            let next = layer(picture, [0, above])?;
            above += next.size()[1];
            layers.push(next);
        }
    }
    let far = layers.iter().map(Layer::far_corner).fold([0, 0], |most, far| [most[0].max(far[0]), most[1].max(far[1])]);
    let mut header = Header::new("RADIANCE");
    header.push_command(words.all());
    header.push_variable("FORMAT", Encoding::Rgbe.name());
    let composed = compose(&mut layers, far.map(|pixels| pixels as usize), [0; 4], &header, output());
    composed.map_err(|error| failed("palettes", error))
}

fn reader_of(source: Source, path: &str) -> Result<PictureReader<Source>, Failure> {
    PictureReader::new(source).map_err(|error| failed(path, error.into()))
}

/// Reads the statistics of the picture before it is coloured.
fn with_file(words: &Words<'_>, options: &mut Options) -> Outcome {
    let mut file = open_twice(&options.picture)?;
    let again = |file: &mut File| -> Result<PictureReader<Source>, Failure> {
        let path = options.picture.clone();
        let wrong = |error: std::io::Error| failed(&path, radsight_picture::PictureError::from(error).into());
        file.rewind().map_err(wrong)?;
        as_rgbe(reader_of(Box::new(file.try_clone().map_err(wrong)?), &path)?, &path)
    };
    if options.automatic {
        let top = automatic_top(again(&mut file)?, &options.picture)?;
        options.scale.top = options.scale.multiplier / WHITE_EFFICACY * top;
    }
    let mut annotations = Annotations { letter: MARK_HEIGHT, ..Annotations::default() };
    if options.has_overlay() {
        let (layers, letter) = options.overlay.layers(options, again(&mut file)?, options.legend[0])?;
        annotations.overlay.extend(layers);
        annotations.letter = letter;
    }
    if options.marks_extrema {
        let reader = again(&mut file)?;
        let scale = reader.header().radiance_scale().map_err(|error| failed(&options.picture, error.into()))?;
        for found in extrema(reader).map_err(|error| failed(&options.picture, error))? {
            // With the digits of pextrem.
            let printed = |i: usize| scientific(f64::from(found.color[i] * scale[i]), 2).parse().unwrap_or(0.0);
            let value = (printed(0) * 0.27 + printed(1) * 0.67 + printed(2) * 0.06) * options.scale.multiplier;
            annotations.marks.push(([found.position as i64, found.scanline as i64], options.shown(value)));
        }
    }
    let reader = again(&mut file)?;
    finish(words, options, reader, annotations)
}

/// A luminance near the largest, in cd/m², as `phisto` computes it: of the picture reduced to 128
/// pixels, the last bin but one of 777.
fn automatic_top(reader: PictureReader<Source>, path: &str) -> Result<f64, Failure> {
    const SIZE: usize = 128;
    const BINS: f64 = 777.0;
    let scale = reader.header().radiance_scale().map_err(|error| failed(path, error.into()))?;
    let filter = FilterOptions {
        columns: Size::Pixels(SIZE),
        rows: Size::Pixels(SIZE),
        aspect: Some(1.0),
        ..FilterOptions::default()
    };
    let mut small = Vec::new();
    filter_one_pass(reader, &filter, &["pfilt"], &mut small).map_err(|error| failed(path, error))?;
    let small = Picture::read(&small).map_err(|error| failed(path, error.into()))?.three_values();
    let values = small.data().as_chunks::<3>().0.iter();
    let values = values.map(|pixel| of_rgb(std::array::from_fn(|i| pixel[i] * scale[i]))).filter(|value| *value > 1e-7);
    let (low, high) = values.fold((f64::INFINITY, 0.0f64), |(low, high), value| (low.min(value), high.max(value)));
    if high <= 0.0 {
        return Err(Failure::input(format!("{path}: the picture is black, expected a scale with -s")));
    }
    let (low, high) = ((low * WHITE_EFFICACY).log10() - 0.01, (high * WHITE_EFFICACY).log10() + 0.01);
    let exponent = general(low + (BINS - 1.5) / BINS * (high - low), 6).parse().unwrap_or(high);
    Ok(10f64.powf(exponent))
}

/// Text printed on the colours.
#[derive(Default)]
struct Annotations {
    overlay: Vec<Layer<Source>>,
    /// Positions and values.
    marks: Vec<([i64; 2], String)>,
    /// Height of the letters of marks, pixels.
    letter: usize,
}

/// Colours the picture and adds the legend.
fn finish(words: &Words<'_>, options: &Options, reader: PictureReader<Source>, annotations: Annotations) -> Outcome {
    let path = &options.picture;
    let mut format = Header::new("RADIANCE");
    format.push_variable("FORMAT", Encoding::Rgbe.name());
    let background = match &options.background {
        Some(other) if other == path => Background::Same,
        Some(other) => Background::Other(as_rgbe(reader_of(open(other)?, other)?, other)?),
        None if options.scale.coverage == Coverage::None => Background::Same,
        None => Background::Black,
    };
    let mut colored = Vec::new();
    let colors = falsecolor(reader, background, &options.scale, &format, &mut colored);
    colors.map_err(|error| match (&options.background, error) {
        (Some(other), ToolError::Input { error, .. }) => failed(other, error.into()),
        (Some(other), error @ ToolError::OtherSize { .. }) => failed(other, error),
        (_, error) => failed(path, error),
    })?;
    let mut layers = options.legend_layers()?;
    layers.push(layer(colored, [options.legend[0], 0])?);
    layers.extend(annotations.overlay);
    for ([x, y], value) in annotations.marks {
        let height = annotations.letter;
        let sign = SignOptions { spacing: -0.15, aspect: 2.0, height, ..SignOptions::default() };
        let mut mark = layer(picture_of(&value, &sign)?, [0, 0])?;
        let size = mark.size();
        mark.corner = [x + options.legend[0] - size[0] / 2, y - size[1] / 2];
        layers.push(mark);
    }
    let far = layers.iter().map(Layer::far_corner).fold([0, 0], |most, far| [most[0].max(far[0]), most[1].max(far[1])]);
    let mut header = Header::new("RADIANCE");
    header.push_command(words.all());
    header.push_variable("FORMAT", Encoding::Rgbe.name());
    let composed = compose(&mut layers, far.map(|pixels| pixels as usize), [0; 4], &header, output());
    composed.map_err(|error| match error {
        ToolError::Input { error, .. } => failed(path, error.into()),
        error => failed(path, error),
    })
}

fn layer(bytes: Vec<u8>, corner: [i64; 2]) -> Result<Layer<Source>, Failure> {
    let reader = reader_of(Box::new(Cursor::new(bytes)), "legend")?;
    Ok(Layer { reader, corner, above: None, below: None })
}

impl Options {
    /// A value of the scale, truncated to the requested number of decimals.
    fn shown(&self, value: f64) -> String {
        let text = general(value, 15);
        let Some(point) = text.find('.') else { return text };
        let decimals = text[point + 1..].chars().take_while(char::is_ascii_digit).count();
        let kept = if self.digits <= 0 { 0 } else { 1 + decimals.min(self.digits as usize) };
        format!("{}{}", &text[..point + kept], &text[point + 1 + decimals..])
    }

    /// Zero is labelled if colours cover the whole picture.
    fn shows_zero(&self) -> bool {
        self.scale.coverage == Coverage::All || self.scale.coverage == Coverage::None
    }

    /// The colours of the legend, and its text with a shadow.
    fn legend_layers(&self) -> Result<Vec<Layer<Source>>, Failure> {
        let [width, height] = self.legend;
        if width == 0 {
            return Ok(Vec::new());
        }
        let divisions = self.scale.divisions;
        let step = (height as f64 / divisions) as i64;
        let bottom = match self.shows_zero() {
            true => -((height as f64 / divisions / 2.0) as i64),
            false => -((height as f64 / divisions * 1.5) as i64),
        };
        let (shadow, text) = self.legend_text(step)?;
        let mut colors = layer(self.legend_colors(step)?, [0, bottom])?;
        colors.corner = [0, bottom];
        let mut shadow = layer(shadow, [2, -1])?;
        shadow.below = Some(0.1);
        let mut text = layer(text, [0, 0])?;
        text.above = Some(0.5);
        Ok(vec![colors, shadow, text])
    }

    fn legend_colors(&self, step: i64) -> Result<Vec<u8>, Failure> {
        let divisions = self.scale.divisions;
        let stretch = 1.0 + 1.5 / divisions;
        let height = (step as f64 * divisions * stretch) as usize;
        let place = |row: f64| (row + 0.5 - step as f64) / (height as f64 / stretch);
        let mut pixels = Vec::new();
        for row in (0..height).rev() {
            let y = row as f64;
            let here = place(y);
            let color = self.scale.color(here, [here, here, place(y + 1.0), place(y - 1.0)]);
            let pixel = encode_rgbe(color.unwrap_or([0.0; 3]));
            (0..self.legend[0]).for_each(|_| pixels.extend_from_slice(&pixel));
        }
        picture_bytes(self.legend[0] as usize, height, &pixels)
    }

    /// The text of the legend, and its inverse for the shadow.
    fn legend_text(&self, step: i64) -> Result<(Vec<u8>, Vec<u8>), Failure> {
        let lines = self.scale.divisions as i64 + i64::from(self.shows_zero());
        let letter = step.min((self.legend[0] as f64 / LETTER) as i64).max(1) as usize;
        let sign = legend_sign(letter);
        let place = |line: i64| (step as f64 * line as f64 + step as f64 * 0.5) as i64;
        let mut texts = vec![(self.label.clone(), place(lines))];
        for line in 0..lines {
            let part = (self.scale.divisions - line as f64) / self.scale.divisions;
            let factor = match self.scale.decades > 0.0 {
                true => 10f64.powf((part - 1.0) * self.scale.decades),
                false => part,
            };
            texts.push((self.shown(self.scale.top * factor), place(lines - line - 1)));
        }
        let mut layers = Vec::new();
        for (text, y) in texts {
            let mut label = layer(picture_of(&text, &sign)?, [0, 0])?;
            label.corner[1] = y - label.size()[1] / 2;
            layers.push(label);
        }
        let far =
            layers.iter().map(Layer::far_corner).fold([1, 1], |most, far| [most[0].max(far[0]), most[1].max(far[1])]);
        let mut header = Header::new("RADIANCE");
        header.push_variable("FORMAT", Encoding::Rgbe.name());
        let mut text = Vec::new();
        let composed = compose(&mut layers, far.map(|pixels| pixels as usize), [0; 4], &header, &mut text);
        composed.map_err(|error| failed("legend", error))?;
        Ok((inverted(&text)?, text))
    }

    fn has_overlay(&self) -> bool {
        self.overlay.counts.iter().all(|count| *count > 0)
    }
}

/// White letters on black.
fn legend_sign(height: usize) -> SignOptions {
    SignOptions { spacing: -0.15, foreground: [1.0; 3], background: [0.0; 3], height, ..SignOptions::default() }
}

/// The shadow of a text.
fn inverted(text: &[u8]) -> Result<Vec<u8>, Failure> {
    let read = Picture::read(text).map_err(|error| failed("legend", error.into()))?;
    let values = read.values();
    let inverted = values.data().as_chunks::<3>().0.iter().flat_map(|pixel| encode_rgbe([1.0 - pixel[1]; 3]));
    let inverted: Vec<u8> = inverted.collect();
    picture_bytes(read.width(), read.height(), &inverted)
}

fn picture_bytes(columns: usize, rows: usize, stored: &[u8]) -> Result<Vec<u8>, Failure> {
    use radsight_picture::{PictureWriter, Resolution};
    let wrong = |error: radsight_picture::PictureError| failed("legend", error.into());
    let mut bytes = Vec::new();
    let header = Header::new("RADIANCE");
    let mut writer = PictureWriter::new(&mut bytes, &header, 3, Resolution::standard(columns, rows)).map_err(wrong)?;
    for row in stored.chunks_exact(4 * columns) {
        writer.write_stored(row).map_err(wrong)?;
    }
    writer.finish().map_err(wrong)?;
    Ok(bytes)
}

fn read_options(words: &mut Words<'_>) -> Result<Options, Failure> {
    let scale = Scale {
        top: 1000.0,
        multiplier: WHITE_EFFICACY,
        decades: 0.0,
        divisions: 8.0,
        coverage: Coverage::All,
        palette: Palette::Default,
        own: Default::default(),
    };
    let mut options = Options {
        scale,
        automatic: false,
        label: "cd/m2".to_owned(),
        digits: 3,
        legend: [100, 200],
        picture: "-".to_owned(),
        background: None,
        marks_extrema: false,
        overlay: Overlay { counts: [0, 0], part: None },
        shows_palettes: false,
    };
    while let Some(option) = words.option()? {
        options.take(option, words)?;
    }
    if let [word, ..] = words.rest() {
        return Err(words.unknown(word));
    }
    if options.legend[0] <= SMALLEST_LEGEND[0] || options.legend[1] <= SMALLEST_LEGEND[1] {
        options.legend = [0, 0];
    }
    Ok(options)
}

impl Options {
    fn take(&mut self, option: &str, words: &mut Words<'_>) -> Outcome {
        const WIDEST: i64 = 1 << 14;
        const MOST_DIVISIONS: i64 = 1000;
        match option {
            "-lw" => self.legend[0] = words.integer(option)?.clamp(0, WIDEST),
            "-lh" => self.legend[1] = words.integer(option)?.clamp(0, WIDEST),
            "-m" => self.scale.multiplier = words.number(option)?,
            "-s" => {
                let word = words.value(option, "the top of the scale, or auto")?;
                self.automatic = word.to_ascii_lowercase().contains('a');
                if !self.automatic {
                    self.scale.top = words.number_in(word, option)?;
                }
            }
            "-d" => self.digits = words.integer(option)?,
            "-l" => self.label = words.value(option, "a label")?.to_owned(),
            "-log" => self.scale.decades = words.number(option)?,
            "-pal" => {
                let name = words.value(option, "a palette")?;
                let found = Palette::ALL.iter().find(|(known, _)| *known == name);
                let unknown = || {
                    let expected = "def, spec, pm3d, hot, eco or tbo";
                    Failure::usage(format!("falsecolor: option \"-pal {name}\" is unknown, expected {expected}"))
                };
                self.scale.palette = found.ok_or_else(unknown)?.1;
                self.scale.own = Default::default();
            }
            "-i" => self.picture = words.value(option, "a picture")?.to_owned(),
            "-p" => self.background = Some(words.value(option, "a picture")?.to_owned()),
            "-ip" | "-pi" => {
                self.picture = words.value(option, "a picture")?.to_owned();
                self.background = Some(self.picture.clone());
            }
            "-n" => self.scale.divisions = words.integer(option)?.clamp(1, MOST_DIVISIONS) as f64,
            "-cl" => self.scale.coverage = Coverage::Lines,
            "-cb" => self.scale.coverage = Coverage::Bands,
            "-cp" => self.scale.coverage = Coverage::Posterized,
            "-c0" => (self.scale.coverage, self.legend) = (Coverage::None, [0, 0]),
            "-e" => self.marks_extrema = true,
            "-r" | "-g" | "-b" => {
                let text = words.value(option, "an expression of v")?;
                let wrong = |error| Failure::usage(format!("falsecolor: option \"{option}\" with \"{text}\": {error}"));
                let component = OwnComponent::read(text).map_err(wrong)?;
                self.scale.own["-r-g-b".find(option).unwrap_or(0) / 2] = Some(component);
            }
            "-palettes" => self.shows_palettes = true,
            "-odim" => {
                const MOST_VALUES: i64 = 1000;
                for count in &mut self.overlay.counts {
                    *count = words.integer(option)?.clamp(0, MOST_VALUES) as usize;
                }
            }
            "-orct" => {
                let mut part = [0; 4];
                for border in &mut part {
                    *border = words.integer(option)?;
                }
                self.overlay.part = Some(part);
            }
            _ if option.starts_with("-spec") => {
                return Err(Failure::usage("falsecolor: option \"-spec\" is not supported, expected -pal spec"));
            }
            _ => return Err(words.unknown(option)),
        }
        Ok(())
    }
}
