//! `pcomb`: combines pictures by functions of their pixels.

use crate::ToolError;
use crate::brightness::of_rgb;
use radsight_cal::{Environment, Host, Slot};
use radsight_diag::SourceMap;
use radsight_picture::{Encoding, PictureError, PictureReader, View, ViewOptions, WHITE_EFFICACY};
use std::collections::VecDeque;
use std::f64::consts::PI;
use std::io::Read;

/// Rows above the current one that expressions can access.
const ROWS_ABOVE: usize = 62;
/// Rows below the current one that expressions can access.
const ROWS_BELOW: usize = 64;

/// Functions available to expressions, in the order of their numbers.
const FUNCTIONS: [&str; 17] =
    ["ri", "gi", "bi", "li", "re", "ge", "be", "le", "pa", "Ox", "Oy", "Oz", "Dx", "Dy", "Dz", "T", "S"];

/// One of the combined pictures.
pub struct CombineInput<R> {
    reader: PictureReader<R>,
    factors: [f32; 3],
    exposures: Exposures,
    exposure: [f32; 3],
    pixel_aspect: f64,
    view: Option<View>,
    /// The accessible rows, from the top.
    rows: VecDeque<Vec<[f32; 3]>>,
}

/// Whether exposures are undone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exposures {
    /// Pixels are used as stored.
    AsStored,
    /// Pixels are divided by all `EXPOSURE` and `COLORCORR` of the header.
    Undone,
}

impl<R: Read> CombineInput<R> {
    /// Takes a picture or a float matrix. `factors` multiply its components.
    ///
    /// # Errors
    /// When it is spectral, or an exposure in its header is invalid.
    pub fn new(
        reader: PictureReader<R>,
        factors: [f32; 3],
        exposures: Exposures,
    ) -> Result<CombineInput<R>, ToolError> {
        if reader.components() > 3 {
            let what = format!("{} components", reader.components());
            return Err(
                PictureError::Unsupported { format: "a spectral picture", what, expected: "RGBE or XYZE" }.into()
            );
        }
        let header = reader.header();
        let correction = header.color_correction()?;
        let exposure = header.exposure()?;
        let (factors, exposure) = match exposures {
            Exposures::Undone => {
                let scale = header.radiance_scale()?;
                (std::array::from_fn(|i| factors[i] * scale[i]), [1.0; 3])
            }
            Exposures::AsStored => (factors, correction.map(|part| (part * exposure) as f32)),
        };
        let view = ViewOptions::from_header(header).ok().flatten().and_then(|options| View::new(options).ok());
        let pixel_aspect = header.pixel_aspect()?;
        Ok(CombineInput { factors, exposures, exposure, pixel_aspect, view, rows: VecDeque::new(), reader })
    }

    /// The picture.
    pub fn reader(&self) -> &PictureReader<R> {
        &self.reader
    }

    /// Whether its exposures are undone.
    pub fn exposures(&self) -> Exposures {
        self.exposures
    }

    /// Its view, if its header has a valid one.
    pub fn view(&self) -> Option<&View> {
        self.view.as_ref()
    }

    fn read_row(&mut self) -> Result<(), PictureError> {
        let mut row = if self.rows.len() > ROWS_ABOVE + ROWS_BELOW { self.rows.pop_front() } else { None }
            .unwrap_or_else(|| vec![[0.0; 3]; self.reader.resolution().scanline_length()]);
        self.reader.read_three(&mut row)?;
        for pixel in &mut row {
            *pixel = std::array::from_fn(|i| pixel[i] * self.factors[i]);
        }
        self.rows.push_back(row);
        Ok(())
    }
}

/// The defined output components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Defined {
    /// `lo` is defined: one value per pixel.
    Grey,
    /// `ro`, `go`, `bo`: three values per pixel. An undefined component is the sum of the inputs.
    Color,
}

/// Pictures of one size and the functions that combine them.
pub struct Combination<R> {
    inputs: Vec<CombineInput<R>>,
    environment: Environment,
    is_luminance: bool,
    /// Pixels per scanline and number of scanlines of the inputs.
    in_size: [usize; 2],
    /// The same for the output.
    size: [usize; 2],
    /// The variables of the position, if definitions mention them.
    x: Option<Slot>,
    y: Option<Slot>,
    /// Number of input rows read.
    rows_read: usize,
    defined: Defined,
    /// Which components have a definition.
    has_definition: [bool; 3],
    /// Mathematical errors so far, without duplicates.
    warnings: Vec<String>,
}

/// The pixel being computed.
struct Site<'a, R> {
    inputs: &'a [CombineInput<R>],
    is_luminance: bool,
    column: usize,
    /// Row from the top.
    row: usize,
    columns: usize,
    rows: usize,
    /// The first accessible row, from the top.
    first_row: usize,
}

/// Prepares an environment for the definitions of `pcomb`: its constants and functions. Call it
/// before reading definitions.
pub fn prepare<R: Read>(environment: &mut Environment, inputs: &[CombineInput<R>]) {
    let [columns, rows] = in_size(inputs);
    let is_luminance = encoding(inputs) == Encoding::Xyze;
    for (name, value) in [
        ("PI", PI),
        ("nfiles", inputs.len() as f64),
        ("xmax", columns as f64),
        ("ymax", rows as f64),
        ("WE", if is_luminance { 1.0 } else { WHITE_EFFICACY }),
    ] {
        environment.set_constant(name, value);
    }
    environment.set_variable("xres", columns as f64);
    environment.set_variable("yres", rows as f64);
    for name in FUNCTIONS {
        environment.offer_function(name, 1);
    }
}

/// The encoding of the output: that of the first picture.
pub fn encoding<R: Read>(inputs: &[CombineInput<R>]) -> Encoding {
    inputs.first().map_or(Encoding::Rgbe, |input| input.reader.encoding())
}

fn in_size<R: Read>(inputs: &[CombineInput<R>]) -> [usize; 2] {
    inputs.first().map_or([0, 0], |input| {
        let resolution = input.reader.resolution();
        [resolution.scanline_length(), resolution.scanlines()]
    })
}

impl<R: Read> Combination<R> {
    /// Combines pictures and definitions. `size` is that of the output: pixels per scanline and
    /// scanlines.
    ///
    /// # Errors
    /// When the pictures have different sizes.
    pub fn new(
        inputs: Vec<CombineInput<R>>,
        mut environment: Environment,
        size: [usize; 2],
    ) -> Result<Combination<R>, ToolError> {
        let expected = in_size(&inputs);
        for (index, input) in inputs.iter().enumerate() {
            let resolution = input.reader.resolution();
            let found = [resolution.scanline_length(), resolution.scanlines()];
            if found != expected {
                return Err(ToolError::OtherSize { index, found, expected });
            }
        }
        let is_luminance = encoding(&inputs) == Encoding::Xyze;
        let defined = if environment.is_variable("lo") { Defined::Grey } else { Defined::Color };
        let [x, y] = ["x", "y"].map(|name| environment.slot_if_needed(name));
        let names: &[&str] = if defined == Defined::Grey { &["lo"] } else { &["ro", "go", "bo"] };
        let mut has_definition = [false; 3];
        for (index, name) in names.iter().enumerate() {
            has_definition[index] = environment.is_variable(name);
            if has_definition[index] {
                let text = format!("${}={name}", index + 1);
                let source = SourceMap::default().add("pcomb", text.as_bytes(), None);
                environment.define(source, text.as_bytes()).map_err(ToolError::Definition)?;
            }
        }
        Ok(Combination {
            inputs,
            environment,
            is_luminance,
            in_size: expected,
            size,
            x,
            y,
            rows_read: 0,
            defined,
            has_definition,
            warnings: Vec::new(),
        })
    }

    /// The encoding of the output: that of the first picture.
    pub fn encoding(&self) -> Encoding {
        encoding(&self.inputs)
    }

    /// The distinct mathematical errors of the rows so far, such as a picture that is not there.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The defined output components.
    pub fn defined(&self) -> Defined {
        self.defined
    }

    /// Computes a row of the output, counted from the top: three values per pixel, all equal for
    /// grey.
    ///
    /// # Errors
    /// When a picture cannot be read, or a definition cannot be evaluated.
    pub fn row(&mut self, row: usize, values: &mut [[f32; 3]]) -> Result<(), ToolError> {
        let [columns, rows] = self.in_size;
        let from_bottom = self.size[1] - 1 - row;
        // The input row at the centre, counted from the bottom, truncated to an integer.
        let in_from_bottom = ((from_bottom as f64 + 0.5) * rows as f64 / self.size[1] as f64) as usize;
        let in_row = rows.saturating_sub(1).saturating_sub(in_from_bottom);
        self.read_to(in_row)?;
        if let Some(y) = self.y {
            self.environment.set(y, from_bottom as f64);
        }
        for (position, value) in values.iter_mut().enumerate() {
            let column = ((position as f64 + 0.5) * columns as f64 / self.size[0] as f64) as usize;
            if let Some(x) = self.x {
                self.environment.set(x, position as f64);
            }
            *value = self.pixel(column, in_row)?;
        }
        Ok(())
    }

    /// Reads the rows that are accessible from a row.
    fn read_to(&mut self, in_row: usize) -> Result<(), ToolError> {
        let last = (in_row + ROWS_BELOW + 1).min(self.in_size[1]);
        while self.rows_read < last {
            for (index, input) in self.inputs.iter_mut().enumerate() {
                input.read_row().map_err(|error| ToolError::Input { index, error })?;
            }
            self.rows_read += 1;
        }
        Ok(())
    }

    fn pixel(&mut self, column: usize, row: usize) -> Result<[f32; 3], ToolError> {
        let held = self.inputs.first().map_or(0, |input| input.rows.len());
        let site = Site {
            inputs: &self.inputs,
            is_luminance: self.is_luminance,
            column,
            row,
            columns: self.in_size[0],
            rows: self.in_size[1],
            first_row: self.rows_read - held,
        };
        let outputs = self.environment.eval_outputs(&site).map_err(ToolError::Definition)?;
        let mut found = outputs.iter().map(|(_, value)| *value);
        let mut value = [0.0f64; 3];
        if self.defined == Defined::Grey {
            value = [found.next().unwrap_or(0.0); 3];
        } else {
            for (component, value) in value.iter_mut().enumerate() {
                *value = match self.has_definition[component] {
                    true => found.next().unwrap_or(0.0),
                    false => site.inputs.iter().map(|input| f64::from(site.here(input)[component])).sum(),
                };
            }
        }
        self.environment.list_warnings(&mut self.warnings);
        Ok(value.map(|value| value as f32))
    }
}

impl<R> Site<'_, R> {
    fn at(&self, input: &CombineInput<R>, column: usize, row: usize) -> [f32; 3] {
        row.checked_sub(self.first_row).and_then(|index| input.rows.get(index)).map_or([0.0; 3], |row| row[column])
    }

    fn here(&self, input: &CombineInput<R>) -> [f32; 3] {
        self.at(input, self.column, self.row)
    }

    fn brightness(&self, color: [f32; 3]) -> f64 {
        if self.is_luminance { f64::from(color[1]) } else { of_rgb(color) }
    }

    /// The colour at an offset, clamped to the picture and the accessible rows.
    fn color(&self, input: &CombineInput<R>, arguments: &[f64]) -> [f32; 3] {
        let rounded = |index: usize| arguments.get(index).map_or(0, |value| (value + 0.5f64.copysign(*value)) as isize);
        let column = (self.column as isize).saturating_add(rounded(1)).clamp(0, self.columns as isize - 1);
        // Offsets count upwards, rows downwards.
        let up = rounded(2).clamp(-(ROWS_BELOW as isize), ROWS_ABOVE as isize);
        let row = (self.row as isize).saturating_sub(up).clamp(0, self.rows as isize - 1);
        self.at(input, column as usize, row as usize)
    }

    /// Origin, direction and length of a pixel's ray at an offset in pixels; `None` if there is
    /// none.
    fn ray(&self, input: &CombineInput<R>, right: f64, up: f64) -> Option<([f64; 3], [f64; 3], f64)> {
        let view = input.view.as_ref()?;
        let resolution = input.reader.resolution();
        let [x, y] = resolution.location(self.column, self.row);
        let image_position = [x + right / resolution.width as f64, y + up / resolution.height as f64];
        let ray = view.ray(image_position)?;
        Some((ray.origin.to_array(), ray.direction.to_array(), ray.length.unwrap_or(0.0)))
    }

    /// The solid angle of a pixel, sr: the area of the parallelogram spanned by the directions of
    /// its neighbours.
    fn pixel_size(&self, input: &CombineInput<R>) -> f64 {
        let orientation = input.reader.resolution().orientation;
        let step = |falls: bool| if falls { -1.0 } else { 1.0 };
        let offsets = [(0.0, 0.0), (step(orientation.x_falls), 0.0), (0.0, step(orientation.y_falls))];
        let directions = offsets.map(|(right, up)| self.ray(input, right, up).map(|ray| ray.1));
        let [Some(middle), Some(beside), Some(next)] = directions else { return 0.0 };
        let difference = |a: [f64; 3]| -> [f64; 3] { std::array::from_fn(|i| a[i] - middle[i]) };
        let ([a, b, c], [d, e, f]) = (difference(beside), difference(next));
        let cross = [b * f - c * e, c * d - a * f, a * e - b * d];
        cross.iter().map(|value| value * value).sum::<f64>().sqrt()
    }
}

impl<R> Host for Site<'_, R> {
    fn channel(&self, _channel: u32) -> f64 {
        0.0
    }

    fn call(&self, function: u32, arguments: &[f64]) -> f64 {
        let number = arguments.first().copied().unwrap_or(0.0);
        let count = self.inputs.len() as f64;
        if !(number > -0.5 && number < count + 0.5) {
            // A domain error: the value becomes 0, with a warning.
            return f64::NAN;
        }
        if number < 0.5 {
            return count;
        }
        let input = &self.inputs[(number - 0.5) as usize];
        let ray = |part: usize| match self.ray(input, 0.0, 0.0) {
            None if part == 6 => -1.0,
            None => 0.0,
            Some((_, _, length)) if part == 6 => length,
            Some((origin, direction, _)) => {
                if part < 3 {
                    origin[part]
                } else {
                    direction[part - 3]
                }
            }
        };
        match function {
            0..=2 => f64::from(self.color(input, arguments)[function as usize]),
            3 => self.brightness(self.color(input, arguments)),
            4..=6 => f64::from(input.exposure[function as usize - 4]),
            7 => self.brightness(input.exposure),
            8 => input.pixel_aspect,
            9..=15 => ray(function as usize - 9),
            _ if input.view.is_some_and(|view| view.options().kind == radsight_picture::ViewKind::Parallel) => 0.0,
            _ => self.pixel_size(input),
        }
    }
}
