//! `gendaymtx [-v] [-h] [-A] [-d|-s|-n] [-u] [-D file [-M file]] [-r degrees] [-m N] [-g r g b] [-c
//! r g b] [-o{f|d|a}] [-O{0|1}] [-5 degrees] [-i minutes] [weather]`: the sky at each time step of
//! a weather file, as a matrix of patches by time steps.
//!
//! Patches are Reinhart's, N by N for each Tregenza patch (`-m`); the first patch is the ground.
//! `-d` writes the sun alone, `-s` the sky alone, `-u` omits the night, `-A` averages all time
//! steps. `-D` writes each sun as a light source and `-M` their modifiers' names to a file; `-n`
//! writes no matrix. `-O1` writes solar instead of visible radiation. `-5` puts the sun into one
//! patch, as a disk of this diameter in degrees.
//!
//! C. F. Reinhart and O. Walkenhorst, Energy and Buildings 33 (7), 2001 (patches). The sky model is
//! [`crate::perez`].

use std::f64::consts::PI;
use std::fmt::Write;

use crate::arguments::Arguments;
use crate::sky_patches::{Light, Sky, SkyPatches, towards};
use crate::sun::{Site, Sun, day_of_year, simple_declination, simple_time_adjustment};
use crate::text::{Exponential, MAX_OUTPUT_BYTES, Quoted, Text};
use crate::weather::{Quantity, Record, Weather};
use crate::{Error, Invocation, Output, source_name};
use radsight_loader::FileKind;
use radsight_units::color::LUMINANCE_WEIGHTS;
use radsight_units::number::put_general;
use radsight_units::photometry::WHITE_EFFICACY;

/// The sun's angular diameter, degrees.
const SUN_DEGREES: f64 = 0.533;
/// Number of patches over which the sun is distributed.
const SUN_PATCHES: usize = 4;
/// Dew point if none is measured, °C.
const DEW_POINT: f64 = 11.0;
/// Less light than this, in the unit of the file, is night; darker colours are black.
const NIGHT: f64 = 1e-4;
/// Largest subdivision; a finer one would exceed a million patches per time step.
const FINEST: usize = 90;

/// Number format of the output.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Format {
    Ascii,
    Float,
    Double,
}

/// Content of the matrix.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Matrix {
    /// One column per time step.
    Moments,
    /// The mean of all time steps.
    Mean,
    /// No matrix.
    Nothing,
}

struct Options<'a> {
    ground: [f64; 3],
    sky: [f64; 3],
    sun: [f64; 3],
    has_header: bool,
    format: Format,
    is_solar: bool,
    subdivision: usize,
    matrix: Matrix,
    /// Files for suns and for their modifiers' names; `-` for standard output.
    suns: Option<&'a str>,
    modifiers: Option<&'a str>,
    by_day_only: bool,
    /// Radians.
    rotation: f64,
    /// Solid angle of the sun's disk, if it is put into one patch.
    disk: Option<f64>,
    /// Minutes; 0 for instants.
    interval: f64,
    /// A file, or `-`.
    weather: &'a str,
}

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let options = Options::read(&mut arguments)?;
    let bytes = invocation.input(options.weather, FileKind::Input)?;
    let weather = Weather::read(&String::from_utf8_lossy(&bytes)).map_err(|mistake| Error::Input {
        program: "gendaymtx".to_owned(),
        source_name: source_name(options.weather).to_owned(),
        mistake,
    })?;
    let mut year = Year::new(&options, &weather)?;
    year.step_through(&weather)?;
    if year.moments == 0 {
        return Err(arguments.impossible("the weather file has no time step by day"));
    }
    year.output(&weather, invocation.argv)
}

impl<'a> Options<'a> {
    fn read(arguments: &mut Arguments<'a>) -> Result<Options<'a>, Error> {
        let mut options = Options {
            ground: [0.2; 3],
            sky: [0.96, 1.004, 1.118],
            sun: [1.0; 3],
            has_header: true,
            format: Format::Ascii,
            is_solar: false,
            subdivision: 1,
            matrix: Matrix::Moments,
            suns: None,
            modifiers: None,
            by_day_only: false,
            rotation: 0.0,
            disk: None,
            interval: 0.0,
            weather: "-",
        };
        while let Some(option) = arguments.option_before_files()? {
            match option.name {
                "-v" => {}
                "-h" => options.has_header = false,
                "-oa" => options.format = Format::Ascii,
                "-of" => options.format = Format::Float,
                "-od" => options.format = Format::Double,
                "-O0" => options.is_solar = false,
                "-O1" => options.is_solar = true,
                "-A" => options.matrix = Matrix::Mean,
                "-d" => options.leave_out_sky(),
                "-s" => options.sun = [0.0; 3],
                "-u" => options.by_day_only = true,
                "-g" => options.ground = arguments.vector("ground reflectance (-g)")?,
                "-c" => options.sky = arguments.vector("colour of the sky (-c)")?,
                "-n" => options.leave_out_matrix(),
                "-D" => {
                    options.suns = Some(arguments.required("file of suns (-D)")?);
                    if options.suns == Some("-") {
                        options.leave_out_matrix();
                    }
                }
                "-M" => options.modifiers = Some(arguments.required("file of modifiers (-M)")?),
                "-r" => options.rotation = arguments.number("rotation in degrees (-r)")?.to_radians(),
                "-i" => options.interval = arguments.number("interval in minutes (-i)")?,
                "-5" => {
                    let radius = 0.5 * arguments.positive("diameter of the sun in degrees (-5)")?.to_radians();
                    options.disk = Some(PI * radius * radius);
                }
                "-m" => {
                    let position = arguments.position();
                    options.subdivision = arguments.count("subdivision (-m)")?;
                    if !(1..=FINEST).contains(&options.subdivision) {
                        return Err(arguments.mistake(
                            position,
                            format!("subdivision (-m) is {}, expected 1 to {FINEST}", options.subdivision),
                        ));
                    }
                }
                _ => return Err(arguments.unknown()),
            }
        }
        options.weather = arguments.word().unwrap_or(options.weather);
        if arguments.peek().is_some() {
            return Err(arguments.unknown());
        }
        Ok(options)
    }

    fn leave_out_sky(&mut self) {
        (self.sky, self.ground) = ([0.0; 3], [0.0; 3]);
    }

    fn leave_out_matrix(&mut self) {
        self.matrix = Matrix::Nothing;
        self.leave_out_sky();
    }
}

/// The matrix, built time step by time step.
struct Year<'o> {
    options: &'o Options<'o>,
    patches: SkyPatches,
    site: Site,
    /// Red, green and blue of each patch, time step by time step.
    values: Vec<f32>,
    moments: usize,
    suns: Text,
    modifiers: Text,
    warnings: Vec<String>,
    /// Number of leap days so far.
    leap_days: i64,
    /// Dew points of the two previous records.
    dew_points: Option<[f64; 2]>,
    dew_point: f64,
}

impl<'o> Year<'o> {
    fn new(options: &'o Options<'o>, weather: &Weather) -> Result<Year<'o>, Error> {
        let patches = SkyPatches::new(options.subdivision);
        let columns = if options.matrix == Matrix::Moments { weather.records.len() } else { 1 };
        // A text number has about as many bytes as double precision.
        let number = if options.format == Format::Float { size_of::<f32>() } else { size_of::<f64>() };
        if columns.saturating_mul(patches.len() * 3 * number) > MAX_OUTPUT_BYTES {
            return Err(Error::OutputTooLarge { limit_bytes: MAX_OUTPUT_BYTES });
        }
        let mut warnings = Vec::new();
        if options.modifiers.is_some() && options.suns.is_none() {
            warnings.push("-M output will be empty without -D".to_owned());
        }
        Ok(Year {
            options,
            patches,
            site: Site {
                latitude: weather.latitude.to_radians(),
                longitude: -weather.longitude.to_radians(),
                meridian: (-15.0 * weather.time_zone).to_radians(),
            },
            values: Vec::new(),
            moments: 0,
            suns: Text::default(),
            modifiers: Text::default(),
            warnings,
            leap_days: 0,
            dew_points: None,
            dew_point: DEW_POINT,
        })
    }

    fn step_through(&mut self, weather: &Weather) -> Result<(), Error> {
        for record in &weather.records {
            self.note_dew_point(record.dew_point);
            let is_leap_day = record.month == 2 && record.day == 29;
            if is_leap_day {
                self.leap_days = 1;
            }
            let day = day_of_year(record.month, record.day) + if is_leap_day { 0 } else { self.leap_days };
            self.step(weather.quantity, record, day)?;
        }
        Ok(())
    }

    /// Updates the mean dew point of three records.
    fn note_dew_point(&mut self, measured: Option<f64>) {
        self.dew_points = measured.map(|now| {
            let [first, second] = self.dew_points.unwrap_or([now; 2]);
            self.dew_point = (first + second + now) / 3.0;
            [second, now]
        });
    }

    fn step(&mut self, quantity: Quantity, record: &Record, day: i64) -> Result<(), Error> {
        let sun = self.sun(record, day);
        let altitude = sun.altitude(&self.site);
        let azimuth = sun.azimuth(&self.site) + PI - self.options.rotation;
        let radius = (0.5 * SUN_DEGREES).to_radians();
        let is_up = altitude > -radius;
        if self.options.by_day_only && !is_up {
            return Ok(());
        }
        self.moments += 1;
        let mut column = vec![0.0; if self.options.matrix == Matrix::Nothing { 0 } else { 3 * self.patches.len() }];
        let minute = 24 * 60 * (day - 1) + (record.hour * 60.0 + 0.5) as i64;
        if record.direct + record.diffuse <= NIGHT {
            if is_up {
                self.write_sun(minute, (altitude, azimuth), 0.0)?;
            }
            self.keep(column);
            return Ok(());
        }
        let limit = if quantity == Quantity::NormalIlluminance { 20.0 * WHITE_EFFICACY } else { 20.0 };
        if !is_up && record.direct > limit {
            let Record { month, day, hour, .. } = record;
            self.warnings.push(format!("unusually bright at {hour:.1} on {month}-{day}"));
        }
        let is_level = quantity == Quantity::HorizontalIrradiance && altitude > 1e-6;
        let direct = if is_level { record.direct / altitude.sin() } else { record.direct };
        let water = (0.07 * self.dew_point - 0.075).exp();
        let sky = Sky::new(&Light { quantity, direct, diffuse: record.diffuse, water, day: day as f64, altitude });
        let sky = if self.options.is_solar { sky.solar() } else { sky };
        if is_up {
            let radiance = sky.direct_illuminance / (WHITE_EFFICACY * PI * radius * radius);
            self.write_sun(minute, (altitude, azimuth), radiance)?;
        }
        if self.options.matrix != Matrix::Nothing {
            self.fill(&mut column, &sky, (altitude, azimuth));
        }
        self.keep(column);
        Ok(())
    }

    /// The sun's position; the middle of the sunlit part of an interval in which it rises or sets.
    fn sun(&self, record: &Record, day: i64) -> Sun {
        let declination = simple_declination(day as f64);
        let mut solar_time = record.hour + simple_time_adjustment(day as f64, &self.site);
        let half = self.options.interval / 120.0;
        if self.options.interval > 0.0 {
            // The effect of leap days on the sun's position is negligible.
            let known = simple_declination(day_of_year(record.month, record.day) as f64);
            let tangent = -(self.site.latitude.tan() * known.tan());
            let half_day = (PI / 2.0 - tangent.atan2((1.0 - tangent * tangent).sqrt())) * 12.0 / PI;
            let (rise, set) = (12.0 - half_day, 12.0 + half_day);
            if (rise - solar_time).abs() <= half {
                solar_time = 0.5 * (solar_time + half + rise);
            } else if (set - solar_time).abs() < half {
                solar_time = 0.5 * (solar_time - half + set);
            }
        }
        Sun { declination, solar_time }
    }

    /// Adds the radiances of ground and sky, and the sun's on the patches around it, W/(sr·m²).
    fn fill(&self, column: &mut [f32], sky: &Sky, sun: (f64, f64)) {
        let options = self.options;
        let [red, green, blue] = LUMINANCE_WEIGHTS;
        let is_black = |color: &[f64; 3]| red * color[0] + green * color[1] + blue * color[2] <= NIGHT;
        let level_sun = sky.direct_illuminance * sun.0.sin().max(0.0);
        let ground = (sky.diffuse_illuminance + level_sun) / (PI * WHITE_EFFICACY);
        let mut add = |patch: usize, radiance: f64, color: &[f64; 3]| {
            for (value, band) in column[3 * patch..].iter_mut().zip(color) {
                *value += (radiance * band) as f32;
            }
        };
        add(0, ground, &options.ground);
        if !is_black(&options.sky) {
            let scale = sky.diffuse_illuminance / WHITE_EFFICACY;
            for (patch, luminance) in self.patches.luminances(sky, sun.1).iter().enumerate() {
                add(patch + 1, scale * luminance, &options.sky);
            }
        }
        if sky.direct_illuminance > NIGHT && !is_black(&options.sun) {
            let count = if options.disk.is_some() { 1 } else { SUN_PATCHES };
            for (patch, radiance) in self.patches.around_sun(sun, count, options.disk) {
                add(patch, radiance * sky.direct_illuminance / WHITE_EFFICACY, &options.sun);
            }
        }
    }

    fn keep(&mut self, column: Vec<f32>) {
        if self.options.matrix == Matrix::Mean && !self.values.is_empty() {
            self.values.iter_mut().zip(column).for_each(|(sum, value)| *sum += value);
        } else {
            self.values.extend(column);
        }
    }

    fn write_sun(&mut self, minute: i64, (altitude, azimuth): (f64, f64), radiance: f64) -> Result<(), Error> {
        if self.options.suns.is_none() {
            return Ok(());
        }
        let [r, g, b] = self.options.sun.map(|band| Exponential(radiance * band, 3));
        let [x, y, z] = towards(altitude, azimuth);
        write!(self.suns, "\nvoid light solar{minute}\n0\n0\n3 {r} {g} {b}\n")?;
        write!(self.suns, "\nsolar{minute} source sun{minute}\n0\n0\n4 {x:.6} {y:.6} {z:.6} {SUN_DEGREES:.4}\n")?;
        if self.options.modifiers.is_some() {
            writeln!(self.modifiers, "solar{minute}")?;
        }
        Ok(())
    }

    fn output(mut self, weather: &Weather, argv: &[String]) -> Result<Output, Error> {
        let mut output = Output { warnings: std::mem::take(&mut self.warnings), ..Output::default() };
        if self.options.matrix != Matrix::Nothing {
            output.standard_output = self.matrix(weather, argv)?;
        }
        if let Some(path) = self.options.modifiers {
            output.files.push((path.to_owned(), self.modifiers.into_bytes()));
        }
        match self.options.suns {
            Some("-") => output.standard_output = self.suns.into_bytes(),
            Some(path) => output.files.push((path.to_owned(), self.suns.into_bytes())),
            None => {}
        }
        Ok(output)
    }

    fn matrix(&self, weather: &Weather, argv: &[String]) -> Result<Vec<u8>, Error> {
        let (rows, options) = (self.patches.len(), self.options);
        let columns = self.values.len() / (3 * rows);
        let mut header = Text::default();
        if options.has_header {
            writeln!(header, "#?RADIANCE\n{}", command_line(argv))?;
            writeln!(header, "LATLONG= {:.8} {:.8}", weather.latitude, weather.longitude)?;
            writeln!(header, "NROWS={rows}\nNCOLS={columns}")?;
            if options.matrix == Matrix::Mean {
                writeln!(header, "NAVERAGED={}", self.moments)?;
            }
            writeln!(header, "NCOMP=3")?;
            let is_big = if cfg!(target_endian = "big") { 1 } else { 0 };
            match options.format {
                Format::Ascii => writeln!(header, "FORMAT=ascii\n")?,
                Format::Float => writeln!(header, "BigEndian={is_big}\nFORMAT=float\n")?,
                Format::Double => writeln!(header, "BigEndian={is_big}\nFORMAT=double\n")?,
            }
        }
        let mut bytes = header.into_bytes();
        let count = if options.matrix == Matrix::Mean { self.moments as f32 } else { 1.0 };
        for row in 0..rows {
            for column in 0..columns {
                let values = &self.values[3 * (column * rows + row)..][..3];
                put([values[0], values[1], values[2]].map(|value| value / count), options.format, &mut bytes);
            }
            if options.format == Format::Ascii && columns > 1 {
                bytes.push(b'\n');
            }
        }
        Ok(bytes)
    }
}

/// The command line for a header.
fn command_line(argv: &[String]) -> String {
    let words = argv.iter().map(|word| Quoted(&word.replace(['\n', '\r'], " ")).to_string());
    words.collect::<Vec<_>>().join(" ")
}

fn put(values: [f32; 3], format: Format, bytes: &mut Vec<u8>) {
    match format {
        Format::Ascii => {
            for (value, end) in values.into_iter().zip(b"  \n") {
                put_general(f64::from(value), 3, bytes);
                bytes.push(*end);
            }
        }
        Format::Float => bytes.extend(values.iter().flat_map(|value| value.to_ne_bytes())),
        Format::Double => bytes.extend(values.iter().flat_map(|value| f64::from(*value).to_ne_bytes())),
    }
}
