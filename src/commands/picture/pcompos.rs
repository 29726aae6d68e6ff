//! `pcompos`: composes pictures side by side and on top of each other.
//!
//! `pcompos [-h] [-x N] [-y N] [-b R G B] [-lh H] [-la] [ [-t L] [+t L] [=SS] [-l label] picture x
//! y ] …`, or with `-a N` in N columns without positions (`-s N` pixels apart, starting at `-o X
//! Y`; a negative N fills rows from the top). `=SS` gives the anchor of x and y for each axis: `-`
//! the lower side, `+` the upper side, `0` the centre; `-t` shows brighter pixels, `+t` darker
//! ones. A picture that begins with `!` is a command.

use super::files::{History, Source, dated_header, failed, open_any, output};
use super::psign::picture_of;
use crate::commands::words::Words;
use crate::failure::{Failure, Outcome};
use radsight_picture::{Header, PictureReader, encode_rgbe};
use radsight_picture_ops::ToolError;
use radsight_picture_ops::compose::{Layer, compose};
use radsight_picture_ops::sign::SignOptions;
use std::io::Cursor;

/// Longest label, bytes.
const LONGEST_LABEL: usize = 90;

struct Options {
    size: [i64; 2],
    background: [u8; 4],
    /// Number of pictures per row; below 0 rows are filled from the top; 0 for given positions.
    columns: i64,
    spacing: i64,
    origin: [i64; 2],
    labels_all: bool,
    label_height: usize,
    history: History,
}

/// The position of the next picture.
struct NextPosition {
    at: [i64; 2],
    column: i64,
}

/// Layers with the names of their pictures.
#[derive(Default)]
struct Composition {
    layers: Vec<Layer<Source>>,
    names: Vec<String>,
    /// Exposure of the pictures, as long as they agree.
    exposure: Option<f64>,
    format: Option<String>,
}

/// Runs the program.
pub(super) fn run(mut words: Words<'_>) -> Outcome {
    let options = read_options(&mut words)?;
    let mut header = dated_header();
    let mut composition = Composition::default();
    let mut cursor = NextPosition { at: options.origin, column: 0 };
    while !words.rest().is_empty() {
        composition.add(&mut words, &options, &mut cursor, &mut header)?;
    }
    let Composition { mut layers, names, exposure, format } = composition;
    let far = layers.iter().map(Layer::far_corner).fold([0, 0], |most, far| [most[0].max(far[0]), most[1].max(far[1])]);
    let size = [0, 1].map(|i| if options.size[i] > 0 { options.size[i] } else { far[i] });
    if options.columns < 0 {
        let top = far[1].max(size[1]);
        for layer in &mut layers {
            layer.corner[1] = top - layer.size()[1] - layer.corner[1];
        }
    }
    header.push_command(words.all());
    if let Some(exposure) = exposure {
        header.push_exposure(exposure);
    }
    if let Some(format) = format {
        header.push_variable("FORMAT", &format);
    }
    if size.iter().any(|pixels| *pixels <= 0) {
        return Err(Failure::usage("pcompos: the size of the picture is not known, expected -x and -y or pictures"));
    }
    let composed = compose(&mut layers, size.map(|pixels| pixels as usize), options.background, &header, output());
    composed.map_err(|error| match error {
        ToolError::Input { index, error } => failed(&names[index], error.into()),
        error => failed("pcompos", error),
    })
}

fn read_options(words: &mut Words<'_>) -> Result<Options, Failure> {
    let mut options = Options {
        size: [0; 2],
        background: [0; 4],
        columns: 0,
        spacing: 0,
        origin: [0; 2],
        labels_all: false,
        label_height: 24,
        history: History::Copied,
    };
    let begins_files = |word: &str| word == "-l" || word.starts_with("-t");
    while let Some(option) = words.next_if(|word| word.len() > 1 && word.starts_with('-') && !begins_files(word)) {
        match words.meant(option)? {
            "-h" => options.history = options.history.other(),
            "-x" => options.size[0] = pixels(words, option)?,
            "-y" => options.size[1] = pixels(words, option)?,
            "-b" => {
                let mut color = [0.0; 3];
                for part in &mut color {
                    *part = words.number(option)? as f32;
                }
                options.background = encode_rgbe(color);
            }
            "-a" => options.columns = pixels(words, option)?,
            "-s" => options.spacing = pixels(words, option)?,
            "-o" => options.origin = [pixels(words, option)?, pixels(words, option)?],
            "-la" => options.labels_all = true,
            "-lh" => options.label_height = words.integer(option)?.max(1) as usize,
            _ => return Err(words.unknown(option)),
        }
    }
    Ok(options)
}

/// The options before a picture.
#[derive(Default)]
struct PictureOptions {
    above: Option<f64>,
    below: Option<f64>,
    label: Option<String>,
    /// For each axis, the part of the size that is subtracted from the position: none, half, all.
    anchor: [char; 2],
}

impl PictureOptions {
    fn read(words: &mut Words<'_>) -> Result<PictureOptions, Failure> {
        let mut placing = PictureOptions { anchor: ['-', '-'], ..PictureOptions::default() };
        while let Some(word) = words.next_if(|word| word.len() > 1 && word.starts_with(['-', '+', '='])) {
            match words.meant(word)? {
                "-l" => placing.label = Some(words.value(word, "a label")?.to_owned()),
                _ if word.starts_with("-t") => placing.above = Some(words.number(word)?),
                _ if word.starts_with("+t") => placing.below = Some(words.number(word)?),
                _ => {
                    let signs: Vec<char> = word.chars().collect();
                    match signs[..] {
                        ['=', x @ ('-' | '+' | '0'), y @ ('-' | '+' | '0')] => placing.anchor = [x, y],
                        _ => return Err(words.unknown(word)),
                    }
                }
            }
        }
        Ok(placing)
    }
}

/// The number of pixels or pictures after an option.
fn pixels(words: &mut Words<'_>, option: &str) -> Result<i64, Failure> {
    let number = words.integer(option)?;
    within_range(number)
        .ok_or_else(|| Failure::usage(format!("pcompos: option \"{option}\" is followed by {number}, {IN_RANGE}")))
}

/// The largest number of pixels from the origin to either side, as in Radiance.
const FARTHEST: i64 = i32::MAX as i64;
const IN_RANGE: &str = "expected a number of pixels from -2147483647 to 2147483647";

fn within_range(number: i64) -> Option<i64> {
    (-FARTHEST..=FARTHEST).contains(&number).then_some(number)
}

/// One of the two numbers after a picture.
fn position(words: &mut Words<'_>, picture: &str) -> Result<i64, Failure> {
    let next = words.next_if(|_| true);
    let number = next.and_then(|word| words.number_in(word, picture).ok());
    let found = next.map_or("the end of the command line".to_owned(), |word| format!("\"{word}\""));
    let message = format!("pcompos: picture \"{picture}\" is followed by {found}, expected its position: x and y");
    let number = number.ok_or_else(|| Failure::usage(message))? as i64;
    within_range(number)
        .ok_or_else(|| Failure::usage(format!("pcompos: picture \"{picture}\" is followed by {found}, {IN_RANGE}")))
}

impl Composition {
    /// Adds a picture with its options.
    fn add(
        &mut self,
        words: &mut Words<'_>,
        options: &Options,
        cursor: &mut NextPosition,
        header: &mut Header,
    ) -> Outcome {
        let placing = PictureOptions::read(words)?;
        let path = words.value("a placement", "a picture")?;
        let reader =
            PictureReader::new(open_any(path, words.commands())?).map_err(|error| failed(path, error.into()))?;
        self.note(&reader, path)?;
        let mut nested = reader.header().clone();
        nested.remove("FORMAT");
        options.history.push(header, path, &nested);
        let mut layer = Layer { reader, corner: [0; 2], above: placing.above, below: placing.below };
        let size = layer.size();
        if options.columns == 0 {
            for ((corner, size), anchor) in layer.corner.iter_mut().zip(size).zip(placing.anchor) {
                let taken = match anchor {
                    '+' => size,
                    '0' => size / 2,
                    _ => 0,
                };
                *corner = position(words, path)? - taken;
            }
        } else {
            if cursor.column >= options.columns.abs() {
                let top = self.layers.iter().map(|layer| layer.far_corner()[1]).fold(0, i64::max);
                *cursor = NextPosition { at: [options.origin[0], top + options.spacing], column: 0 };
            }
            layer.corner = cursor.at;
            cursor.at[0] += size[0] + options.spacing;
            cursor.column += 1;
        }
        let corner = layer.corner;
        self.layers.push(layer);
        self.names.push(path.to_owned());
        let label = placing.label.or_else(|| options.labels_all.then(|| path.to_owned()));
        match label {
            Some(label) => self.add_label(&label, corner, size, options),
            None => Ok(()),
        }
    }

    /// Records the exposure and the format of a picture.
    fn note(&mut self, reader: &PictureReader<Source>, path: &str) -> Outcome {
        let exposure = reader.header().exposure().map_err(|error| failed(path, error.into()))?;
        self.exposure = match self.exposure {
            _ if self.layers.is_empty() => Some(exposure),
            Some(common) if (exposure / common - 1.0).abs() <= 0.02 => Some(common),
            _ => None,
        };
        if let Some(format) = reader.header().format() {
            match &self.format {
                Some(known) if *known != format => {
                    let message = format!(
                        "pcompos: {path}: its format is \"{format}\", expected \"{known}\" as in the pictures before"
                    );
                    return Err(Failure::input(message));
                }
                _ => self.format = Some(format.into_owned()),
            }
        }
        Ok(())
    }

    /// Adds a label at the upper left corner of a picture.
    fn add_label(&mut self, label: &str, corner: [i64; 2], size: [i64; 2], options: &Options) -> Outcome {
        let shown: String = label.chars().take(LONGEST_LABEL).collect();
        let sign = SignOptions {
            spacing: -0.15,
            aspect: 2.0,
            columns: size[0].max(0) as usize,
            rows: options.label_height,
            ..SignOptions::default()
        };
        let bytes = picture_of(&shown, &sign)?;
        let source: Source = Box::new(Cursor::new(bytes));
        let reader = PictureReader::new(source).map_err(|error| failed(label, error.into()))?;
        let mut layer = Layer { reader, corner, above: None, below: None };
        layer.corner[1] += size[1] - layer.size()[1];
        self.layers.push(layer);
        self.names.push(label.to_owned());
        Ok(())
    }
}
