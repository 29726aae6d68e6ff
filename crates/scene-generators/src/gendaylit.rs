//! `gendaylit month day hour [-y year] …` or `gendaylit -ang altitude azimuth …`: a Perez sky from
//! measured light.
//!
//! The light is given as `-P epsilon delta` (Perez clearness and brightness), `-W` direct normal
//! and diffuse horizontal irradiance in W/m², `-L` the same as illuminance in lux, `-G` direct
//! horizontal and diffuse horizontal irradiance, or `-E` global horizontal irradiance alone (Erbs
//! model). `-O` selects the output: 0 visible radiance in W/(sr·m²), 1 solar radiance, 2 luminance
//! in cd/m². `-C` adds colour; `-l` or `-CIE` select its locus. Other options are those of
//! `gensky`; `-i` minutes is the length of a time step, `-d` °C the dew point, `-w` suppresses
//! warnings.
//!
//! R. Perez, R. Seals, J. Michalsky, "All-weather model for sky luminance distribution", Solar
//! Energy 50 (3), 1993; efficacies from R. Perez et al., "Modeling daylight availability and
//! irradiance components", Solar Energy 44 (5), 1990; D. G. Erbs, S. A. Klein, J. A. Duffie, Solar
//! Energy 28 (4), 1982. If the sky cannot be computed, a black one is written with a warning, as in
//! the real program.

use std::f64::consts::PI;
use std::fmt::Write;

use crate::arguments::Arguments;
use crate::gensky::read_in_range;
use crate::number_text::leading_number;
use crate::perez::{self, Conditions};
use crate::sun::{CieSky, Moment, Site, direction, simple_declination, sky_normalization};
use crate::text::{Exponential, Text};
use crate::{Error, Invocation, Output};
use radsight_units::photometry::WHITE_EFFICACY;

const DEGREE: f64 = PI / 180.0;
/// Half of the sun's angular diameter, radians.
const HALF_SUN: f64 = 0.2665 * DEGREE;
/// Extraterrestrial illuminance, lux.
const SOLAR_CONSTANT_LUX: f64 = 127_500.0;
/// Dew point that corresponds to 2 cm of precipitable water, °C, with gendaylit's precision.
const DEFAULT_DEW_POINT: f64 = 10.97353115;

enum SunPosition {
    Angles { altitude: f64, azimuth: f64 },
    Time(Moment),
}

#[derive(Clone, Copy)]
enum Light {
    /// `-P`
    Perez { clearness: f64, brightness: f64 },
    /// `-W`
    Irradiance { direct_normal: f64, diffuse: f64 },
    /// `-L`
    Illuminance { direct_normal: f64, diffuse: f64 },
    /// `-G`
    Horizontal { direct: f64, diffuse: f64 },
    /// `-E`
    Global(f64),
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Unit {
    VisibleRadiance,
    SolarRadiance,
    Luminance,
}

struct Options {
    sun: SunPosition,
    site: Site,
    light: Light,
    unit: Unit,
    with_sun: bool,
    /// `-c` limits the solar altitude to above 87°.
    cloudy: bool,
    ground_reflectance: f64,
    /// Minutes; zero for an instant.
    time_step: f64,
    /// Precipitable water, cm.
    precipitable_water: f64,
    quiet: bool,
    coloured: bool,
    /// Eleven coefficients of the colour of an overcast sky.
    locus: [f32; 11],
}

/// Why a sky cannot be computed and is black.
struct Black(String);

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut text = Text::default();
    if invocation.argv.len() == 2 && invocation.argv[1] == "-defaults" {
        write_defaults(&mut text)?;
        return Ok(Output { standard_output: text.into_bytes(), ..Output::default() });
    }
    let mut arguments = Arguments::new(invocation.argv);
    let options = read(&mut arguments)?;
    text.plain_command_comment(invocation.argv)?;
    let mut warnings = Warnings { silent: options.quiet, messages: std::mem::take(&mut arguments.warnings) };
    write_sky(&options, &mut text, &mut warnings)?;
    Ok(Output { standard_output: text.into_bytes(), warnings: warnings.messages, ..Output::default() })
}

fn read(arguments: &mut Arguments<'_>) -> Result<Options, Error> {
    let sun = read_sun(arguments)?;
    let mut options = Options {
        sun,
        site: Site::default(),
        light: Light::Perez { clearness: 0.0, brightness: 0.0 },
        unit: Unit::VisibleRadiance,
        with_sun: true,
        cloudy: false,
        ground_reflectance: 0.2,
        time_step: 0.0,
        precipitable_water: (0.07 * DEFAULT_DEW_POINT - 0.075).exp(),
        quiet: false,
        coloured: false,
        locus: perez::LOCUS_BERLIN,
    };
    while let Some(option) = arguments.last_signed_options()? {
        match option.name {
            "-s" | "+s" => (options.cloudy, options.with_sun) = (false, option.name == "+s"),
            "-c" => (options.cloudy, options.with_sun) = (true, false),
            "-CIE" => options.locus = perez::LOCUS_CIE,
            "-C" => options.coloured = true,
            "-w" => options.quiet = true,
            name => read_value(&mut options, arguments, name)?,
        }
    }
    warn_about_meridian(&options, &mut arguments.warnings);
    Ok(options)
}

/// Parses an option with values.
fn read_value(options: &mut Options, arguments: &mut Arguments<'_>, name: &str) -> Result<(), Error> {
    match name {
        "-d" => {
            let dew_point = arguments.number("dew point (-d)")?;
            let dew_point = if (-40.0..=40.0).contains(&dew_point) { dew_point } else { DEFAULT_DEW_POINT };
            options.precipitable_water = (0.07 * dew_point - 0.075).exp();
        }
        "-y" => {
            let year = arguments.integer("year (-y)")?;
            if let SunPosition::Time(moment) = &mut options.sun {
                moment.year = (year != 0).then_some(year.clamp(-100_000, 100_000));
            }
        }
        "-l" => {
            let mut values = [0.0f32; 7];
            for value in &mut values {
                *value = arguments.number("colour locus (-l)")? as f32;
            }
            let [a, b, c, d, e, f, g] = values;
            options.locus = [a, b, c, d, a, b, c, d, e, f, g];
        }
        // Accepted for compatibility with gensky; without effect in the real program, too.
        "-R" | "-t" | "-b" => drop(arguments.number("value")?),
        "-g" => options.ground_reflectance = arguments.number("ground reflectance (-g)")?,
        "-a" => options.site.latitude = arguments.number("latitude (-a)")? * DEGREE,
        "-o" => options.site.longitude = arguments.number("longitude (-o)")? * DEGREE,
        "-m" => options.site.meridian = arguments.number("standard meridian (-m)")? * DEGREE,
        "-O" => {
            let position = arguments.position();
            options.unit = match arguments.number("output (-O)")? as i64 {
                0 => Unit::VisibleRadiance,
                1 => Unit::SolarRadiance,
                2 => Unit::Luminance,
                other => return Err(arguments.mistake(position, format!("output (-O) is {other}, expected 0, 1 or 2"))),
            };
        }
        "-P" => {
            let (clearness, brightness) = (arguments.number("clearness (-P)")?, arguments.number("brightness (-P)")?);
            options.light = Light::Perez { clearness, brightness };
        }
        "-W" => {
            let (direct_normal, diffuse) = (arguments.number("direct (-W)")?, arguments.number("diffuse (-W)")?);
            options.light = Light::Irradiance { direct_normal, diffuse };
        }
        "-L" => {
            let (direct_normal, diffuse) = (arguments.number("direct (-L)")?, arguments.number("diffuse (-L)")?);
            options.light = Light::Illuminance { direct_normal, diffuse };
        }
        "-G" => {
            let (direct, diffuse) = (arguments.number("direct (-G)")?, arguments.number("diffuse (-G)")?);
            options.light = Light::Horizontal { direct, diffuse };
        }
        "-E" => options.light = Light::Global(arguments.number("global irradiance (-E)")?),
        "-i" => {
            let position = arguments.position();
            options.time_step = f64::from(arguments.number("time interval (-i)")? as f32);
            if options.time_step < 0.0 {
                let step = options.time_step;
                return Err(arguments.mistake(
                    position,
                    format!("time interval (-i) is {step}, expected a number of minutes not below zero"),
                ));
            }
        }
        _ => return Err(arguments.unknown()),
    }
    Ok(())
}

fn read_sun(arguments: &mut Arguments<'_>) -> Result<SunPosition, Error> {
    if arguments.peek() == Some("-ang") {
        arguments.word();
        let altitude = arguments.number("altitude")? * DEGREE;
        let azimuth = arguments.number("azimuth")? * DEGREE;
        return Ok(SunPosition::Angles { altitude, azimuth });
    }
    let month = read_in_range(arguments, "month", 1..=12)? as usize;
    let day = read_in_range(arguments, "day", 1..=31)?;
    let position = arguments.position();
    let word = arguments.required("hour")?;
    match leading_number(word) {
        Some((hour, _)) if (0.0..24.0).contains(&hour) => {
            Ok(SunPosition::Time(Moment { year: None, month, day, hour, by_the_sun: word.starts_with('+') }))
        }
        _ => Err(arguments.mistake(position, format!("hour is \"{word}\", expected a number from 0 to below 24"))),
    }
}

fn warn_about_meridian(options: &Options, warnings: &mut Vec<String>) {
    let SunPosition::Time(moment) = &options.sun else { return };
    let away = options.site.longitude - options.site.meridian;
    if !moment.by_the_sun && away.abs() > 45.0 * DEGREE {
        warnings.push(format!("{:.1} hours btwn. standard meridian and longitude", away * 12.0 / PI));
    }
}

/// Collects warnings unless `-w` suppresses them.
struct Warnings {
    silent: bool,
    messages: Vec<String>,
}

impl Warnings {
    fn push(&mut self, message: impl Into<String>) {
        if !self.silent {
            self.messages.push(message.into());
        }
    }
}

/// The sun's position; angles in radians.
struct Sun {
    /// Hours; zero if the sun is given by angles.
    solar_time: f64,
    altitude: f64,
    azimuth: f64,
    /// Day of the year; zero if the sun is given by angles.
    day: f64,
    below_horizon: bool,
}

fn write_sky(options: &Options, text: &mut Text, warnings: &mut Warnings) -> Result<(), Error> {
    let mut sun = find_sun(options, warnings);
    if !sun.below_horizon {
        if !options.cloudy && sun.altitude > 87.0 * DEGREE {
            warnings.push("sun too close to zenith, reducing altitude to 87 degrees");
            sun.altitude = 87.0 * DEGREE;
        }
        let mut light = LightOfSky::new(options, &sun);
        match light.compute(text, warnings)? {
            Ok(computed) => return write_computed(options, &sun, &computed, text, warnings),
            Err(Black(reason)) => warnings.push(format!("{reason}, printing error sky")),
        }
    }
    let [x, y, z] = direction(sun.altitude, sun.azimuth);
    write_head(&sun, text)?;
    write!(text, "\nvoid brightfunc skyfunc\n2 skybright perezlum.cal\n0\n")?;
    Ok(writeln!(text, "10 0.00 0.00  0.000 0.000 0.000 0.000 0.000  {x:.6} {y:.6} {z:.6} ")?)
}

fn write_head(sun: &Sun, text: &mut Text) -> Result<(), Error> {
    writeln!(text, "# Local solar time: {:.2}", sun.solar_time)?;
    let (altitude, azimuth) = (sun.altitude / DEGREE, sun.azimuth / DEGREE);
    Ok(writeln!(text, "# Solar altitude and azimuth: {altitude:.1} {azimuth:.1}")?)
}

/// The sun's position. Within half a time step of sunrise or sunset, that of the middle of the
/// sunlit part of the step.
fn find_sun(options: &Options, warnings: &mut Warnings) -> Sun {
    let (site, moment) = match &options.sun {
        SunPosition::Angles { altitude, azimuth } => {
            return Sun { solar_time: 0.0, altitude: *altitude, azimuth: *azimuth, day: 0.0, below_horizon: false };
        }
        SunPosition::Time(moment) => (&options.site, moment),
    };
    let mut sun = moment.sun(site);
    let half_day = half_day(moment.day_of_year() as f64, site.latitude);
    let (rise, set) = (12.0 - half_day, 12.0 + half_day);
    let half_step = options.time_step / 120.0;
    let (month, day, hour) = (moment.month, moment.day, moment.hour);
    if half_step > 0.0 {
        let corrected = format!("solar position corrected at time step {month} {day} {hour:.3}");
        if (rise - sun.solar_time).abs() <= half_step {
            sun.solar_time = (sun.solar_time + half_step + rise) / 2.0;
            warnings.push(corrected.clone());
        }
        if (set - sun.solar_time).abs() < half_step {
            sun.solar_time = (sun.solar_time - half_step + set) / 2.0;
            warnings.push(corrected);
        }
    }
    let below_horizon = sun.solar_time < rise - half_step || sun.solar_time > set + half_step;
    if below_horizon && half_step > 0.0 {
        warnings.push(format!("sun position too low, printing error sky at {month} {day} {hour:.3}"));
    } else if below_horizon {
        warnings.push(format!("sun altitude below zero at time step {month} {day} {hour:.2}, printing error sky"));
    }
    let (altitude, azimuth) = (sun.altitude(site), sun.azimuth(site));
    Sun { solar_time: sun.solar_time, altitude, azimuth, day: moment.day_of_year() as f64, below_horizon }
}

/// Hours from sunrise to noon; NaN if the sun does not rise or set.
fn half_day(day: f64, latitude: f64) -> f64 {
    let cosine = -(latitude.tan() * simple_declination(day).tan()) as f32;
    let sine = f64::from(1.0 - cosine * cosine).sqrt();
    (PI / 2.0 - f64::from(cosine).atan2(sine)) / (15.0 * DEGREE)
}

/// Derives the sky model's input from the given quantities.
struct LightOfSky<'a> {
    options: &'a Options,
    altitude: f64,
    /// Radians, at most π/2 after the air mass was computed.
    sun_zenith: f64,
    day: f64,
    conditions: Conditions,
    /// Direct normal and diffuse horizontal, W/m².
    direct_irradiance: f64,
    diffuse_irradiance: f64,
    /// Direct normal and diffuse horizontal, lux.
    direct_illuminance: f64,
    diffuse_illuminance: f64,
}

/// The computed sky.
struct Computed {
    conditions: Conditions,
    parameters: [f64; 5],
    /// Radiance (or luminance) for a relative luminance of 1.
    diffuse: f64,
    ground: f64,
    solar: f64,
}

impl<'a> LightOfSky<'a> {
    fn new(options: &'a Options, sun: &Sun) -> Self {
        LightOfSky {
            options,
            altitude: sun.altitude,
            sun_zenith: PI / 2.0 - sun.altitude,
            day: sun.day,
            conditions: Conditions { clearness: 0.0, brightness: 0.0 },
            direct_irradiance: 0.0,
            diffuse_irradiance: 0.0,
            direct_illuminance: 0.0,
            diffuse_illuminance: 0.0,
        }
    }

    fn compute(&mut self, text: &mut Text, warnings: &mut Warnings) -> Result<Result<Computed, Black>, Error> {
        if let Light::Global(global) = self.options.light {
            self.split_global(global, text, warnings)?;
        }
        Ok(self.take_light(warnings).and_then(|()| self.finish()))
    }

    /// Computes irradiance, illuminance and conditions from the given quantities.
    fn take_light(&mut self, warnings: &mut Warnings) -> Result<(), Black> {
        match self.options.light {
            Light::Perez { clearness, brightness } => {
                self.conditions = Conditions { clearness, brightness }.limited();
                let outside = perez::SOLAR_CONSTANT * perez::eccentricity(self.day);
                self.diffuse_irradiance = self.conditions.brightness / self.air_mass(warnings) * outside;
                let clearness = self.conditions.clearness;
                self.direct_irradiance = perez::direct_irradiance(clearness, self.diffuse_irradiance, self.sun_zenith);
                self.check_irradiance(warnings)?;
                return self.illuminance(warnings);
            }
            Light::Illuminance { direct_normal, diffuse } => {
                (self.direct_illuminance, self.diffuse_illuminance) = (direct_normal, diffuse);
                self.check_illuminance(warnings)?;
                return self.irradiance_from_illuminance(warnings);
            }
            Light::Irradiance { direct_normal, diffuse } => {
                (self.direct_irradiance, self.diffuse_irradiance) = (direct_normal, diffuse);
            }
            Light::Horizontal { .. } if self.altitude <= 0.0 => {
                warnings.push("sun altitude < 0, proceed with irradiance values of zero");
            }
            Light::Horizontal { direct, diffuse } => {
                (self.direct_irradiance, self.diffuse_irradiance) = (direct / self.altitude.sin(), diffuse);
            }
            Light::Global(_) => {}
        }
        self.check_irradiance(warnings)?;
        self.find_conditions(warnings);
        self.illuminance(warnings)
    }

    /// Splits global irradiance into direct and diffuse parts (Erbs model).
    fn split_global(&mut self, global: f64, text: &mut Text, warnings: &mut Warnings) -> Result<(), Error> {
        if self.altitude <= 0.0 {
            if global > 50.0 {
                warnings.push("global irradiance higher than 50 W/m^2 while the sun altitude is lower than zero");
            }
            return Ok(());
        }
        let outside = perez::SOLAR_CONSTANT * perez::eccentricity(self.day) * self.altitude.sin();
        let global = if global > outside {
            warnings.push("global irradiance is higher than the time-dependent solar constant s0");
            outside * 0.999
        } else {
            global
        };
        // The clearness index, and the diffuse fraction of the global irradiance as a function of
        // it.
        let k = global / outside;
        let diffuse_part = if k <= 0.22 {
            1.0 - 0.09 * k
        } else if k <= 0.8 {
            0.9511 - 0.1604 * k + 4.388 * k.powi(2) - 16.638 * k.powi(3) + 12.336 * k.powi(4)
        } else {
            0.165
        };
        self.diffuse_irradiance = global * diffuse_part;
        let direct = global - self.diffuse_irradiance;
        let diffuse = self.diffuse_irradiance;
        writeln!(text, "# erbs_s0, erbs_kt, irr_dir_h, irr_diff: {outside:.3} {k:.3} {direct:.3} {diffuse:.3}")?;
        writeln!(text, "# WARNING: the -E option is only recommended for a rough estimation!")?;
        self.direct_irradiance = direct / self.altitude.sin();
        Ok(())
    }

    fn air_mass(&mut self, warnings: &mut Warnings) -> f64 {
        if self.sun_zenith > PI / 2.0 {
            warnings.push("air mass has reached the maximal value");
            self.sun_zenith = PI / 2.0;
        }
        perez::air_mass(self.sun_zenith / DEGREE)
    }

    /// Computes clearness and brightness from the irradiance.
    fn find_conditions(&mut self, warnings: &mut Warnings) {
        let outside = perez::SOLAR_CONSTANT * perez::eccentricity(self.day);
        let brightness = self.diffuse_irradiance * self.air_mass(warnings) / outside;
        let clearness = perez::clearness(self.direct_irradiance, self.diffuse_irradiance, self.sun_zenith);
        self.conditions = Conditions { clearness, brightness }.limited();
    }

    /// Computes illuminance from irradiance, if the output needs it.
    fn illuminance(&mut self, warnings: &mut Warnings) -> Result<(), Black> {
        if self.options.unit == Unit::SolarRadiance {
            return Ok(());
        }
        self.diffuse_illuminance = self.diffuse_irradiance * self.diffuse_efficacy()?;
        self.direct_illuminance = self.direct_irradiance * self.direct_efficacy();
        self.check_illuminance(warnings)
    }

    fn diffuse_efficacy(&mut self) -> Result<f64, Black> {
        self.conditions = self.conditions.limited();
        if !self.conditions.in_range() {
            return Err(Black(format!("sky clearness (= {:.3}) too high", self.conditions.clearness)));
        }
        Ok(self.conditions.diffuse_efficacy(self.sun_zenith, self.options.precipitable_water))
    }

    fn direct_efficacy(&self) -> f64 {
        self.conditions.direct_efficacy(self.sun_zenith, self.options.precipitable_water)
    }

    /// Computes irradiance and conditions that match the illuminance, by iteration.
    fn irradiance_from_illuminance(&mut self, warnings: &mut Warnings) -> Result<(), Black> {
        let first_guess = perez::SOLAR_CONSTANT / SOLAR_CONSTANT_LUX;
        self.diffuse_irradiance = self.diffuse_illuminance * first_guess;
        self.direct_irradiance = self.direct_illuminance * first_guess;
        let clearness = perez::clearness(self.direct_irradiance, self.diffuse_irradiance, self.sun_zenith);
        self.find_conditions(warnings);
        // The clearness of the first estimate is computed before the sun is raised to the horizon.
        self.conditions = Conditions { clearness, ..self.conditions }.limited();
        // gendaylit's stopping criterion is never met, so the number of iterations is fixed.
        for _ in 0..9 {
            self.diffuse_irradiance = self.diffuse_illuminance / self.diffuse_efficacy()?;
            let efficacy = self.direct_efficacy();
            self.direct_irradiance = if efficacy < 0.1 { 0.0 } else { self.direct_illuminance / efficacy };
            self.find_conditions(warnings);
        }
        Ok(())
    }

    fn check_irradiance(&mut self, warnings: &mut Warnings) -> Result<(), Black> {
        let (direct, diffuse) = (&mut self.direct_irradiance, &mut self.diffuse_irradiance);
        check("irradiance", direct, diffuse, perez::SOLAR_CONSTANT, self.altitude, warnings)
    }

    fn check_illuminance(&mut self, warnings: &mut Warnings) -> Result<(), Black> {
        let (direct, diffuse) = (&mut self.direct_illuminance, &mut self.diffuse_illuminance);
        check("illuminance", direct, diffuse, SOLAR_CONSTANT_LUX, self.altitude, warnings)
    }

    fn finish(&mut self) -> Result<Computed, Black> {
        let Options { unit, with_sun, ground_reflectance, .. } = self.options;
        let Conditions { clearness, .. } = self.conditions;
        if !self.conditions.in_range() {
            return Err(Black("sky clearness cannot be computed".to_owned()));
        }
        let parameters = self.conditions.parameters(self.sun_zenith);
        let integral = perez::horizontal_integral(parameters, self.sun_zenith);
        let solid_angle = 2.0 * PI * (1.0 - HALF_SUN.cos());
        let (diffuse, solar) = match unit {
            Unit::VisibleRadiance => (
                self.diffuse_illuminance / integral / WHITE_EFFICACY,
                self.direct_illuminance / solid_angle / WHITE_EFFICACY,
            ),
            Unit::SolarRadiance => (self.diffuse_irradiance / integral, self.direct_irradiance / solid_angle),
            Unit::Luminance => (self.diffuse_illuminance / integral, self.direct_illuminance / solid_angle),
        };
        let zenith = diffuse * perez::relative_luminance(parameters, 0.0, self.sun_zenith);
        let mut ground = zenith * self.mean_over_zenith();
        if *with_sun && clearness > 1.0 {
            ground += 6.8e-5 / PI * solar * self.altitude.sin();
        }
        ground *= ground_reflectance;
        if parameters[1] > 0.0 {
            return Err(Black(format!("positive Perez parameter B (= {:.6})", parameters[1])));
        }
        Ok(Computed { conditions: self.conditions, parameters, diffuse, ground, solar })
    }

    /// Mean horizontal radiance divided by zenith radiance of the CIE sky nearest to the clearness.
    fn mean_over_zenith(&self) -> f64 {
        let (altitude, clearness) = (self.altitude, self.conditions.clearness);
        let (up, zenith) = (altitude.sin(), PI / 2.0 - altitude);
        if clearness == 1.0 {
            return 0.777_778;
        }
        let denominator = if clearness >= 6.0 {
            0.274 * (0.91 + 10.0 * (-3.0 * zenith).exp() + 0.45 * up * up)
        } else {
            (2.739 + 0.9891 * (0.3119 + 2.6 * altitude).sin()) * (-zenith * (0.4441 + 1.48 * altitude)).exp()
        };
        let sky = if clearness < 6.0 { CieSky::Intermediate } else { CieSky::Clear };
        sky_normalization(altitude, sky) / denominator / PI
    }
}

/// Checks measured light: negative values become zero; no light by day and more than the sun's
/// light are errors.
fn check(
    what: &str,
    direct: &mut f64,
    diffuse: &mut f64,
    solar_constant: f64,
    altitude: f64,
    warnings: &mut Warnings,
) -> Result<(), Black> {
    for (part, value) in [("direct", &mut *direct), ("diffuse", &mut *diffuse)] {
        if *value < 0.0 {
            warnings.push(format!("{part} {what} < 0. Using 0.0"));
            *value = 0.0;
        }
    }
    if *direct + *diffuse == 0.0 && altitude > 0.0 {
        return Err(Black(format!("zero {what} at sun altitude > 0")));
    }
    if *direct > solar_constant {
        return Err(Black(format!("direct {what} exceeds solar constant")));
    }
    Ok(())
}

fn write_computed(
    options: &Options,
    sun: &Sun,
    computed: &Computed,
    text: &mut Text,
    warnings: &mut Warnings,
) -> Result<(), Error> {
    let Conditions { clearness, brightness } = computed.conditions;
    write_head(sun, text)?;
    let water = options.precipitable_water;
    writeln!(
        text,
        "# epsilon, delta, atmospheric precipitable water content : {clearness:.4} {brightness:.4} {water:.4} "
    )?;
    let [x, y, z] = direction(sun.altitude, sun.azimuth);
    if options.with_sun {
        write!(text, "\nvoid light solar\n0\n0\n")?;
        let solar = Exponential(computed.solar, 3);
        match clearness > 1.0 {
            true => writeln!(text, "3 {solar} {solar} {solar}")?,
            false => writeln!(text, "3 0.0 0.0 0.0")?,
        }
        write!(text, "\nsolar source sun\n0\n0\n4 {x:.6} {y:.6} {z:.6} {:.6}\n", 2.0 * HALF_SUN / DEGREE)?;
    }
    let coloured = options.coloured && !(1.065 < clearness && clearness < 4.5);
    if options.coloured && !coloured {
        warnings.messages.push(format!(
            "no colour is written: the colour model does not cover intermediate skies (clearness {clearness:.6})"
        ));
    }
    let (diffuse, ground) = (Exponential(computed.diffuse, 3), Exponential(computed.ground, 3));
    let [a, b, c, d, e] = computed.parameters;
    if !coloured {
        write!(text, "\nvoid brightfunc skyfunc\n2 skybright perezlum.cal\n0\n")?;
        return Ok(writeln!(text, "10 {diffuse} {ground} {a:.6} {b:.6} {c:.6} {d:.6} {e:.6} {x:.6} {y:.6} {z:.6} ")?);
    }
    write!(text, "\nvoid colorfunc skyfunc\n4 skybright_r skybright_g skybright_b perezlum_c.cal\n0\n")?;
    write!(text, "22 {diffuse} {ground} {a:.6} {b:.6} {c:.6} {d:.6} {e:.6} {x:.6} {y:.6} {z:.6} {clearness:.6}")?;
    for value in options.locus {
        write!(text, " {:.6}", f64::from(value))?;
    }
    Ok(writeln!(text)?)
}

fn write_defaults(text: &mut Text) -> Result<(), Error> {
    let site = Site::default();
    writeln!(text, "-g {:.6}\t\t\t# Ground plane reflectance", 0.2)?;
    writeln!(text, "-t {:.6}\t\t\t# Atmospheric betaturbidity", 0.1)?;
    writeln!(text, "-a {:.6}\t\t\t# Site latitude (degrees)", site.latitude / DEGREE)?;
    writeln!(text, "-o {:.6}\t\t\t# Site longitude (degrees)", site.longitude / DEGREE)?;
    Ok(writeln!(text, "-m {:.6}\t\t\t# Standard meridian (degrees)", site.meridian / DEGREE)?)
}
