//! `vwrays`: generates the rays of a view's pixels, for `rtrace`.

use crate::failure::{Failure, Outcome};
use crate::input::read_file;
use crate::option_table::{check_words, options_of, parse_option};
use crate::output::{StandardOutput, standard_output, write_standard_output};
use crate::render_args::number;
use crate::view_args::{self, ViewOrigin};
use glam::DVec3;
use radsight_film::{CameraRay, ViewCamera};
use radsight_picture::{Header, Resolution, View, ViewOptions, put_scientific};
use radsight_pinhole::stream::NumberFormat;
use radsight_sampling::RaySampler;
use std::io::{self, BufRead, BufWriter, Write};

/// Decimals of a number in text.
const DIGITS: usize = 5;

/// Longest pixel coordinate in text, bytes.
const LONGEST_LINE: usize = 4096;

/// The parsed options.
#[derive(Debug)]
struct Options {
    view: ViewOptions,
    view_origin: ViewOrigin,
    size: [usize; 2],
    pixel_aspect: f64,
    jitter: f64,
    aperture: f64,
    repeats: u64,
    seed: u64,
    format: NumberFormat,
    pixels_from_input: bool,
    only_dimensions: bool,
    flush: bool,
    picture: Option<String>,
    depths: Option<String>,
}

/// Runs the program.
pub(crate) fn run(words: &[String]) -> Outcome {
    let mut options = Options::parse(words)?;
    let resolution = options.picture_resolution()?;
    let view = view_args::checked(options.view, &options.view_origin)?;
    let resolution = resolution.unwrap_or_else(|| {
        let (columns, rows) = view.fit(options.size[0], options.size[1], options.pixel_aspect);
        Resolution::standard(columns, rows)
    });
    let (columns, rows) = (resolution.width, resolution.height);
    if options.only_dimensions {
        let limit = if view.options().aft > 1e-6 { " -ld+" } else { "" };
        return write_standard_output(format!("-x {columns} -y {rows}{limit}\n").as_bytes());
    }
    let mut rays = Rays::new(view, resolution, options)?;
    if rays.options.pixels_from_input { rays.of_input() } else { rays.of_picture() }
}

impl Options {
    fn parse(words: &[String]) -> Result<Options, Failure> {
        let mut options = Options {
            view: ViewOptions::default(),
            view_origin: ViewOrigin::default(),
            size: [512, 512],
            pixel_aspect: 1.0,
            jitter: 0.0,
            aperture: 0.0,
            repeats: 1,
            seed: 0,
            format: NumberFormat::Ascii,
            pixels_from_input: false,
            only_dimensions: false,
            flush: false,
            picture: None,
            depths: None,
        };
        if words.is_empty() {
            return Err(Failure::usage("vwrays: no view is given, expected view options or a picture"));
        }
        let program = options_of("vwrays");
        let mut at = 0;
        while at < words.len() && words[at].starts_with('-') {
            let found = parse_option(program, &words[at])?;
            let used = options.take(&words[at..])?;
            check_words(program, &found, &words[at], used)?;
            at += used;
        }
        let mut files = words[at..].iter().cloned();
        (options.picture, options.depths) = (files.next(), files.next());
        match files.next() {
            Some(file) => Err(Failure::usage(format!(
                "vwrays: unexpected argument \"{file}\", expected a picture and its depths"
            ))),
            None => Ok(options),
        }
    }

    fn take(&mut self, words: &[String]) -> Result<usize, Failure> {
        let used = view_args::take_one(words, &mut self.view, &mut self.view_origin)?;
        if used > 0 {
            return Ok(used);
        }
        let word = words[0].as_str();
        match word {
            "-fa" => self.format = NumberFormat::Ascii,
            "-ff" => self.format = NumberFormat::Float,
            "-fd" => self.format = NumberFormat::Double,
            "-d" => self.only_dimensions = true,
            "-i" => self.pixels_from_input = true,
            "-u" => self.flush = true,
            "-x" | "-y" => {
                self.size[usize::from(word == "-y")] = match number(words, word, "a number of pixels")? {
                    0 => return Err(Failure::usage(format!("option \"{word}\" is 0, expected at least 1"))),
                    size => size,
                };
                return Ok(2);
            }
            "-c" | "-pa" | "-pj" | "-pd" | "--seed" => {
                match word {
                    "-c" => self.repeats = number::<i64>(words, word, "a number of rays")?.max(1).unsigned_abs(),
                    "-pa" => self.pixel_aspect = number(words, word, "the height over the width of a pixel")?,
                    "-pj" => self.jitter = number(words, word, "a share of a pixel")?,
                    "-pd" => self.aperture = number(words, word, "the diameter of the aperture")?,
                    _ => self.seed = number(words, word, "a whole number")?,
                }
                return Ok(2);
            }
            _ => return Ok(0),
        }
        Ok(1)
    }

    /// View and size of the picture, if one is given.
    fn picture_resolution(&mut self) -> Result<Option<Resolution>, Failure> {
        let Some(path) = &self.picture else { return Ok(None) };
        let bytes = read_file(path, "picture")?;
        let wrong = |error: &dyn std::fmt::Display| Failure::input(format!("picture \"{path}\": {error}"));
        let (_, start) = Header::read(&bytes).map_err(|error| wrong(&error))?;
        let (resolution, _) = Resolution::read(&bytes, start).map_err(|error| wrong(&error))?;
        self.view.apply_file(&bytes).map_err(|error| wrong(&error))?;
        self.view_origin = ViewOrigin::input(format!("picture \"{path}\""));
        Ok(Some(resolution))
    }
}

/// Generates and writes the rays of pixels.
struct Rays {
    options: Options,
    lens: ViewCamera,
    resolution: Resolution,
    /// Distances in scanline order of the picture.
    depths: Option<Vec<f32>>,
    out: BufWriter<StandardOutput>,
    record: Vec<u8>,
    /// Number of pixels requested so far.
    pixel: u64,
}

impl Rays {
    fn new(view: View, resolution: Resolution, options: Options) -> Result<Rays, Failure> {
        let mut lens = ViewCamera::new(view, resolution.width, resolution.height);
        (lens.jitter, lens.aperture) = (options.jitter, options.aperture);
        let depths = match &options.depths {
            Some(path) => Some(read_depths(path, &resolution)?),
            None => None,
        };
        let out = BufWriter::with_capacity(1 << 16, standard_output());
        Ok(Rays { options, lens, resolution, depths, out, record: Vec::new(), pixel: 0 })
    }

    /// The rays of all pixels, in the order of the picture.
    fn of_picture(&mut self) -> Outcome {
        for scanline in 0..self.resolution.scanlines() {
            for position in 0..self.resolution.scanline_length() {
                let depth = scanline * self.resolution.scanline_length() + position;
                self.write_pixel(self.resolution.location(position, scanline), depth)?;
            }
        }
        self.flush()
    }

    /// The rays of pixels whose coordinates, from the lower left, are read from standard input.
    fn of_input(&mut self) -> Outcome {
        let mut input = io::stdin().lock();
        let mut words = Vec::new();
        let mut line = String::new();
        loop {
            line.clear();
            let read = io::Read::take(&mut input, LONGEST_LINE as u64).read_line(&mut line);
            match read {
                Ok(0) if words.is_empty() => return self.flush(),
                Ok(length) if length > 0 && length < LONGEST_LINE => {}
                _ => return Err(Failure::input("vwrays: standard input: expected pairs of pixel coordinates")),
            }
            words.extend(line.split_whitespace().map(str::to_owned));
            for pair in words.chunks_exact(2) {
                let [x, y] = [coordinate(&pair[0])?, coordinate(&pair[1])?];
                let place = [(x + 0.5) / self.resolution.width as f64, (y + 0.5) / self.resolution.height as f64];
                let depth = match self.depths {
                    Some(_) => self.depth_index(x, y)?,
                    None => 0,
                };
                self.write_pixel(place, depth)?;
            }
            words.drain(..words.len() / 2 * 2);
            if self.options.flush {
                self.flush()?;
            }
        }
    }

    /// Index of a pixel's distance.
    fn depth_index(&self, x: f64, y: f64) -> Result<usize, Failure> {
        let (width, height) = (self.resolution.width, self.resolution.height);
        let is_inside = (0.0..width as f64).contains(&(x + 0.5)) && (0.0..height as f64).contains(&(y + 0.5));
        if !is_inside {
            return Err(Failure::input(format!("vwrays: pixel {x} {y} is outside of the picture")));
        }
        let [from_left, from_bottom] = [(x + 0.5) as usize, (y + 0.5) as usize];
        let orientation = self.resolution.orientation;
        let x = if orientation.x_falls { width - 1 - from_left } else { from_left };
        let y = if orientation.y_falls { height - 1 - from_bottom } else { from_bottom };
        Ok(if orientation.scanlines_are_rows { y * width + x } else { x * height + y })
    }

    fn write_pixel(&mut self, place: [f64; 2], depth: usize) -> Outcome {
        for repeat in 0..self.options.repeats {
            let number = self.pixel.wrapping_mul(self.options.repeats).wrapping_add(repeat);
            let ray = self.lens.ray_near(place, &RaySampler::new(self.options.seed, number));
            let depth = self.depths.as_ref().map(|depths| f64::from(depths[depth]));
            let [origin, mut direction] = record(ray, depth);
            if depth.is_some() && self.options.pixels_from_input {
                direction = direction.normalize_or_zero();
            }
            let numbers = [origin.x, origin.y, origin.z, direction.x, direction.y, direction.z];
            self.record.clear();
            if self.options.format == NumberFormat::Ascii {
                for (number, end) in numbers.iter().zip(b"     \n") {
                    put_scientific(*number, DIGITS, &mut self.record);
                    self.record.push(*end);
                }
            } else {
                self.options.format.encode(&numbers, &mut self.record);
            }
            self.out.write_all(&self.record).map_err(|error| Failure::write("standard output", &error))?;
        }
        self.pixel += 1;
        Ok(())
    }

    fn flush(&mut self) -> Outcome {
        self.out.flush().map_err(|error| Failure::write("standard output", &error))
    }
}

/// The record of a ray. With a depth, it is the ray back from the visible point; with an aft
/// clipping plane, the direction has the length to the plane; zeros outside the projection.
fn record(ray: Option<CameraRay>, depth: Option<f64>) -> [DVec3; 2] {
    let Some(CameraRay { origin, direction, length }) = ray else { return [DVec3::ZERO; 2] };
    match (depth, length) {
        (Some(depth), _) => [origin + direction * depth, -direction * depth],
        (None, Some(length)) => [origin, direction * length],
        (None, None) => [origin, direction],
    }
}

fn coordinate(word: &str) -> Result<f64, Failure> {
    match word.parse() {
        Ok(value) if f64::is_finite(value) => Ok(value),
        _ => Err(Failure::input(format!("vwrays: standard input: \"{word}\" is not a pixel coordinate"))),
    }
}

fn read_depths(path: &str, resolution: &Resolution) -> Result<Vec<f32>, Failure> {
    let bytes = read_file(path, "depths")?;
    let expected = resolution.width.saturating_mul(resolution.height).saturating_mul(size_of::<f32>());
    if bytes.len() != expected {
        let found = bytes.len();
        return Err(Failure::input(format!(
            "depths \"{path}\": {found} bytes, expected {expected} (raw native floats)"
        )));
    }
    Ok(bytes.as_chunks::<4>().0.iter().map(|bytes| f32::from_ne_bytes(*bytes)).collect())
}
