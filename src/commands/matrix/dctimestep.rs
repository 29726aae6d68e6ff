//! `dctimestep`: daylight coefficients times the skies of one or many time steps.
//!
//! `dctimestep [-h] [-n steps] [-i[fd]] [-o[fdc]] [-o files] [-x columns] [-y rows] coefficients
//! [sky]`, or `… view BSDF daylight [sky]`, which multiplies all four. Coefficients are a matrix,
//! or pictures numbered by their name (`dc%03d.hdr`), one per sky direction; the view may be
//! either, too. A sky has one column per time step, as written by `gendaymtx`; with `-n` it is text
//! without a header. `-o` with a number in the name (`%04d`) makes one file per time step. `-N -m`
//! have no effect.

use super::input::{format, read_bytes, read_factor, read_matrix, wrong};
use crate::clock::push_date;
use crate::commands::words::Words;
use crate::disk::Commands;
use crate::failure::{Failure, Outcome, say};
use crate::file_pattern::{holds_number, named};
use crate::input::use_default_threads;
use crate::output::{Output, write_file, write_standard_output};
use crate::trust::OutputName;
use radsight_matrix::{Matrix, MatrixError, Stored, Wanted, product_of_chain};
use radsight_picture::{Encoding, Header, Image, Picture, leading_number, put_scientific};

/// The command line.
struct Request {
    /// Number of time steps; 0 for the number in the header of the sky.
    steps: usize,
    sky_format: Option<Stored>,
    format: Stored,
    files: Option<OutputName>,
    /// Whether commands may run in place of files.
    commands: Commands,
    header: bool,
    /// Rows and columns of the output; 0 for its natural size.
    size: [usize; 2],
    sources: Vec<String>,
    command: Vec<String>,
}

/// Largest memory for the pictures of several time steps that are summed at once, bytes.
const MOST_BYTES: usize = 1 << 29;

/// Decimals of a number in text.
const DIGITS: usize = 6;

const PROGRAM: &str = "dctimestep";

/// Runs the program.
pub(super) fn run(mut words: Words<'_>) -> Outcome {
    use_default_threads()?;
    let request = Request::read(&mut words)?;
    let sources: Vec<&str> = request.sources.iter().map(String::as_str).collect();
    let (view, factors, sky_source) = match sources[..] {
        [view] => (view, None, "-"),
        [view, sky] => (view, None, sky),
        [view, bsdf, daylight] => (view, Some([bsdf, daylight]), "-"),
        [view, bsdf, daylight, sky, ..] => (view, Some([bsdf, daylight]), sky),
        [] => return Err(Failure::usage("dctimestep: no coefficients are given")),
    };
    let mut chain = vec![(sky_source, request.sky(sky_source)?)];
    for source in factors.into_iter().flatten().rev() {
        let factor = read_factor(PROGRAM, source, Wanted::Transmission, request.commands)?;
        chain.push((source, in_color(source, factor)?));
    }
    if holds_number(view) {
        return request.sum_pictures(view, &product(chain)?);
    }
    chain.push((view, color_matrix(view, request.commands)?));
    request.write(product(chain)?)
}

/// The product of matrices that stand from the right to the left.
fn product(mut chain: Vec<(&str, Matrix)>) -> Result<Matrix, Failure> {
    chain.reverse();
    let (sources, matrices): (Vec<&str>, Vec<Matrix>) = chain.into_iter().unzip();
    product_of_chain(matrices).map_err(|(right, error)| wrong(PROGRAM, sources[right - 1], &error))
}

fn color_matrix(source: &str, commands: Commands) -> Result<Matrix, Failure> {
    in_color(source, read_matrix(PROGRAM, source, commands)?)
}

fn in_color(source: &str, matrix: Matrix) -> Result<Matrix, Failure> {
    match matrix.components() {
        3 => Ok(matrix),
        found => Err(wrong(PROGRAM, source, &MatrixError::Components { found, expected: 3 })),
    }
}

impl Request {
    fn read(words: &mut Words<'_>) -> Result<Request, Failure> {
        let mut request = Request {
            steps: 0,
            sky_format: None,
            format: Stored::Ascii,
            files: None,
            commands: words.commands(),
            header: true,
            size: [0, 0],
            sources: Vec::new(),
            command: words.all().into_iter().map(str::to_owned).collect(),
        };
        while let Some(option) = words.option()? {
            let count = |words: &mut Words<'_>| Ok::<usize, Failure>(words.integer(option)?.max(0) as usize);
            match option {
                "-n" => request.steps = count(words)?,
                "-N" | "-m" => drop(words.number(option)?),
                "-h" => request.header = !request.header,
                "-o" => request.files = Some(words.output_value(option, "a file")?),
                "-x" => request.size[1] = count(words)?,
                "-y" => request.size[0] = count(words)?,
                "-ia" | "-if" | "-id" => request.sky_format = format(&option[2..]),
                "-oa" | "-of" | "-od" | "-oc" => request.format = format(&option[2..]).unwrap_or(request.format),
                _ => return Err(words.unknown(option)),
            }
        }
        request.sources = words.rest().to_vec();
        match &request.sources[..] {
            [_, _, _, _, fifth, ..] => Err(words.too_many(fifth)),
            _ => Ok(request),
        }
    }

    /// The sky: one column per time step.
    fn sky(&self, source: &str) -> Result<Matrix, Failure> {
        let bytes = read_bytes(source, self.commands)?;
        let is_text = self.sky_format.is_none_or(|format| format == Stored::Ascii);
        if self.steps > 0 && is_text {
            return self.sky_of_text(source, &bytes);
        }
        let sky = Matrix::read(&bytes).map_err(|error| wrong(PROGRAM, source, &error))?;
        if let Some(expected) = self.sky_format.filter(|expected| *expected != sky.stored) {
            let found = sky.stored;
            return Err(Failure::input(
                format!("{PROGRAM}: {source}: the format is {found:?}, expected {expected:?}").to_lowercase(),
            ));
        }
        if self.steps > 0 && self.steps != sky.columns() {
            let (found, expected) = (sky.size(), [sky.rows(), self.steps]);
            return Err(wrong(PROGRAM, source, &MatrixError::Size { found, expected }));
        }
        in_color(source, sky)
    }

    fn sky_of_text(&self, source: &str, bytes: &[u8]) -> Result<Matrix, Failure> {
        let mut values = Vec::new();
        for word in bytes.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()) {
            let (value, used) = leading_number(word);
            if used != word.len() {
                let (word, number) = (String::from_utf8_lossy(word).into_owned(), values.len() + 1);
                return Err(Failure::input(format!(
                    "{PROGRAM}: {source}: \"{word}\" is not a number, expected number {number} of the sky"
                )));
            }
            values.push(value as f32);
        }
        let row = 3 * self.steps;
        if values.is_empty() || values.len() % row != 0 {
            let found = values.len();
            return Err(Failure::input(format!(
                "{PROGRAM}: {source}: {found} numbers, expected a multiple of {row} for {} time steps in colour",
                self.steps
            )));
        }
        let rows = values.len() / row;
        Matrix::new([rows, self.steps], 3, values).map_err(|error| wrong(PROGRAM, source, &error))
    }

    /// The start of a header.
    fn begin(&self, frame: Option<usize>) -> Header {
        let mut header = Header::new("RADIANCE");
        header.push_command(self.command.iter().map(String::as_str));
        push_date(&mut header);
        if let Some(frame) = frame {
            header.push_variable("FRAME", &frame.to_string());
        }
        header
    }

    /// The file of a time step; `None` if all are written to one.
    fn file(&self, step: usize) -> Option<OutputName> {
        let files = self.files.as_ref().filter(|files| holds_number(files))?;
        Some(
            files
                .numbered(|files| named(PROGRAM, files, "", step).map_or_else(|_| files.to_owned(), |(name, ..)| name)),
        )
    }

    fn write(&self, result: Matrix) -> Outcome {
        if self.file(0).is_none() {
            let bytes = self.encoded(result, None)?;
            return match &self.files {
                Some(file) => write_file(file, &bytes),
                None => write_standard_output(&bytes),
            };
        }
        let frame = |step| (result.columns() > 1).then_some(step);
        for step in 0..result.columns() {
            let Some(file) = self.file(step) else { continue };
            write_file(&file, &self.encoded(result.column(step), frame(step))?)?;
        }
        Ok(())
    }

    fn encoded(&self, matrix: Matrix, frame: Option<usize>) -> Result<Vec<u8>, Failure> {
        let failed = |error| wrong(PROGRAM, "the result", &error);
        let matrix = matrix.arranged(self.size).map_err(failed)?;
        let bytes = matrix.write(&self.begin(frame), self.format).map_err(failed)?;
        let start = if self.header && self.format != Stored::Ascii { 0 } else { header_length(&bytes) };
        if self.format != Stored::Ascii {
            return Ok(bytes[start..].to_vec());
        }
        let mut text = if self.header { bytes[..start].to_vec() } else { Vec::new() };
        for row in matrix.values().chunks_exact(3 * matrix.columns()) {
            for value in row.chunks_exact(3) {
                for (band, end) in value.iter().zip(b"  \t") {
                    put_scientific(f64::from(*band), DIGITS, &mut text);
                    text.push(*end);
                }
            }
            // No tab follows the last element.
            text.pop();
            text.push(b'\n');
        }
        Ok(text)
    }

    /// The pictures of all directions, weighted by the sky, for each time step.
    fn sum_pictures(&self, pattern: &str, sky: &Matrix) -> Outcome {
        if self.format != Stored::Rgbe {
            say("dctimestep: warning - pictures are written (-oc)\n");
        }
        let first = read_picture(pattern, 0, self.commands)?;
        let picture_bytes = 24 * first.values().width() * first.values().height();
        let at_a_time = (MOST_BYTES / picture_bytes.max(1)).max(1);
        let single = self.files.clone().unwrap_or_else(OutputName::standard_output);
        let mut single_output = if self.file(0).is_none() { Some(Output::create(&single)?) } else { None };
        for start in (0..sky.columns()).step_by(at_a_time) {
            let steps = start..(start + at_a_time).min(sky.columns());
            let sums = sums((pattern, self.commands), sky, steps.clone(), &first)?;
            for (step, sum) in steps.zip(sums) {
                let header = match single_output {
                    Some(_) if step > 0 => frame_header(step),
                    _ => self.begin((sky.columns() > 1).then_some(step)),
                };
                let bytes = picture(&first, sum, header)?;
                match (&mut single_output, self.file(step)) {
                    (Some(output), _) => output.put(&bytes)?,
                    (None, Some(file)) => write_file(&file, &bytes)?,
                    (None, None) => {}
                }
            }
        }
        single_output.map_or(Ok(()), Output::commit)
    }
}

/// The header of a picture that follows others in the same file: Radiance's programs write its
/// number alone.
fn frame_header(frame: usize) -> Header {
    let mut header = Header::default();
    header.push_variable("FRAME", &frame.to_string());
    header
}

/// The bytes of a picture with the size and the encoding of another one.
fn picture(like: &Picture, values: Vec<f64>, header: Header) -> Result<Vec<u8>, Failure> {
    let failed = |error| wrong(PROGRAM, "the result", &MatrixError::Picture(error));
    let size = like.values();
    let values = values.into_iter().map(|value| value as f32).collect();
    let image = Image::new(size.width(), size.height(), 3, values).map_err(failed)?;
    let picture = match like.encoding() {
        Encoding::Xyze => Picture::from_xyz(header, &image),
        _ => Picture::from_rgb(header, &image),
    };
    Ok(picture.map_err(failed)?.to_bytes())
}

/// Offset of the data.
fn header_length(bytes: &[u8]) -> usize {
    Header::read(bytes).map_or(0, |(_, length)| length)
}

fn read_picture(pattern: &str, number: usize, commands: Commands) -> Result<Picture, Failure> {
    let (name, _, _) = named(PROGRAM, pattern, "", number)?;
    let failed = |error| wrong(PROGRAM, &name, &MatrixError::Picture(error));
    let picture = Picture::read(&read_bytes(&name, commands)?).map_err(failed)?;
    match picture.components() {
        3 => Ok(picture),
        found => Err(wrong(PROGRAM, &name, &MatrixError::Components { found, expected: 3 })),
    }
}

/// The sums for some time steps. A picture is read once for all of them, and skipped if the sky is
/// dark in all.
fn sums(
    (pattern, commands): (&str, Commands),
    sky: &Matrix,
    steps: std::ops::Range<usize>,
    first: &Picture,
) -> Result<Vec<Vec<f64>>, Failure> {
    let expected = [first.values().height(), first.values().width()];
    let mut sums = vec![vec![0.0; 3 * expected[0] * expected[1]]; steps.len()];
    for direction in 0..sky.rows() {
        let of_step = |step: usize| &sky.values()[3 * (direction * sky.columns() + step)..][..3];
        if steps.clone().all(|step| of_step(step).iter().all(|band| *band == 0.0)) {
            continue;
        }
        let picture = read_picture(pattern, direction, commands)?;
        let failed = |error| wrong(PROGRAM, &format!("picture {direction}"), &error);
        let values = picture.values();
        let found = [values.height(), values.width()];
        if found != expected || picture.encoding() != first.encoding() {
            return Err(failed(MatrixError::Size { found, expected }));
        }
        for (step, sums) in steps.clone().zip(&mut sums) {
            let factors = of_step(step);
            for (sum, value) in sums.chunks_exact_mut(3).zip(values.pixels()) {
                (0..3).for_each(|band| sum[band] += f64::from(value[band]) * f64::from(factors[band]));
            }
        }
    }
    Ok(sums)
}
