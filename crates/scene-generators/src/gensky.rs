//! `gensky month day hour [options]`, `gensky -ang altitude azimuth [options]`, `gensky -defaults`:
//! a CIE sky.
//!
//! Writes the sun (`solar`, a source of 0.5°) and the function `skyfunc`, the modifier of a sky
//! dome. The sky is clear (`+s`, `-s` without sun), intermediate (`+i`, `-i`), overcast (`-c`) or
//! uniform (`-u`). x points east, y north, z up. Angles are in degrees: `-a` latitude north, `-o`
//! longitude west, `-m` the standard meridian, unless the hour names a time zone. `-y` year, `-g`
//! ground reflectance, `-t` turbidity; `-b` zenith radiance in W/(sr·m²) or `-B` horizontal diffuse
//! irradiance in W/m²; `-r` solar radiance or `-R` horizontal direct irradiance.
//!
//! Sky luminance follows CIE S 003 (1996) and, for the intermediate sky, Matsuura (CIE 110, 1994),
//! with gensky's constants.

use std::f64::consts::PI;
use std::fmt::Write;

use crate::arguments::Arguments;
use crate::number_text::{leading_integer, leading_number};
use crate::sun::{CieSky, Moment, Site, direction, sky_normalization};
use crate::text::{Exponential, Text};
use crate::{Error, Invocation, Output};

const DEGREE: f64 = PI / 180.0;
/// Luminous efficacy of skylight and of sunlight, lm/W, by which Radiance converts luminance to
/// radiance.
const SKY_EFFICACY: f64 = 203.0;
const SUN_EFFICACY: f64 = 208.0;

/// Names of time zones, with their standard meridian in degrees west. The first match is used.
#[rustfmt::skip]
const TIME_ZONES: [(&str, f64); 31] = [
    ("YST", 135.0), ("YDT", 120.0), ("PST", 120.0), ("PDT", 105.0), ("MST", 105.0), ("MDT", 90.0), ("CST", 90.0),
    ("CDT", 75.0), ("EST", 75.0), ("EDT", 60.0), ("AST", 60.0), ("ADT", 45.0), ("NST", 52.5), ("NDT", 37.5),
    ("GMT", 0.0), ("BST", -15.0), ("CET", -15.0), ("CEST", -30.0), ("EET", -30.0), ("EEST", -45.0), ("AST", -45.0),
    ("ADT", -60.0), ("GST", -60.0), ("GDT", -75.0), ("IST", -82.5), ("IDT", -97.5), ("JST", -135.0), ("NDT", -150.0),
    ("NZST", -180.0), ("NZDT", -195.0), ("UTC", 0.0),
];

/// Numbered as in `skybright.cal`.
#[derive(Clone, Copy, PartialEq, Eq)]
enum SkyType {
    Clear = 1,
    Overcast = 2,
    Uniform = 3,
    Intermediate = 4,
}

impl SkyType {
    fn is_cloudy(self) -> bool {
        matches!(self, SkyType::Overcast | SkyType::Uniform)
    }
}

/// A brightness, given or to be computed.
#[derive(Clone, Copy)]
enum Brightness {
    Computed,
    Radiance(f64),
    Irradiance(f64),
}

enum SunPosition {
    Angles { altitude: f64, azimuth: f64 },
    Time(Moment),
}

struct Options {
    sun: SunPosition,
    site: Site,
    sky: SkyType,
    with_sun: bool,
    zenith: Brightness,
    solar: Brightness,
    turbidity: f64,
    ground_reflectance: f64,
}

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut text = Text::default();
    if invocation.argv.len() == 2 && invocation.argv[1] == "-defaults" {
        write_defaults(&mut text)?;
        return Ok(Output { standard_output: text.into_bytes(), ..Output::default() });
    }
    let mut arguments = Arguments::new(invocation.argv);
    let options = read(&mut arguments)?;
    text.command_comment(invocation.argv)?;
    write_sky(&options, &mut text, &mut arguments.warnings)?;
    Ok(Output { standard_output: text.into_bytes(), warnings: arguments.warnings, ..Output::default() })
}

fn read(arguments: &mut Arguments<'_>) -> Result<Options, Error> {
    let (sun, zone) = read_sun(arguments)?;
    let mut options = Options {
        sun,
        site: Site::default(),
        sky: SkyType::Clear,
        with_sun: true,
        zenith: Brightness::Computed,
        solar: Brightness::Computed,
        turbidity: 2.45,
        ground_reflectance: 0.2,
    };
    while let Some(option) = arguments.last_signed_options()? {
        read_option(&mut options, arguments, option.name)?;
    }
    // A time zone has precedence over -m.
    options.site.meridian = zone.unwrap_or(options.site.meridian);
    warn(&options, &mut arguments.warnings);
    Ok(options)
}

fn read_option(options: &mut Options, arguments: &mut Arguments<'_>, name: &str) -> Result<(), Error> {
    match name {
        "+s" | "-s" => (options.sky, options.with_sun) = (SkyType::Clear, name == "+s"),
        "+i" | "-i" => (options.sky, options.with_sun) = (SkyType::Intermediate, name == "+i"),
        "-c" => options.sky = SkyType::Overcast,
        "-u" => options.sky = SkyType::Uniform,
        "-y" => {
            let year = arguments.integer("year (-y)")?;
            if let SunPosition::Time(moment) = &mut options.sun {
                moment.year = (year != 0).then_some(year.clamp(-100_000, 100_000));
            }
            if year != 0 && !(1950..=2050).contains(&year) {
                arguments.warnings.push("year should be in range 1950-2050".to_owned());
            }
        }
        "-r" => options.solar = Brightness::Radiance(arguments.number("solar radiance (-r)")?),
        "-R" => options.solar = Brightness::Irradiance(arguments.number("solar irradiance (-R)")?),
        "-b" => options.zenith = Brightness::Radiance(arguments.number("zenith radiance (-b)")?),
        "-B" => options.zenith = Brightness::Irradiance(arguments.number("diffuse irradiance (-B)")?),
        "-t" => options.turbidity = arguments.number("turbidity (-t)")?,
        "-g" => options.ground_reflectance = arguments.number("ground reflectance (-g)")?,
        "-a" => options.site.latitude = arguments.number("latitude (-a)")? * DEGREE,
        "-o" => options.site.longitude = arguments.number("longitude (-o)")? * DEGREE,
        "-m" => options.site.meridian = arguments.number("standard meridian (-m)")? * DEGREE,
        _ => return Err(arguments.unknown()),
    }
    Ok(())
}

fn warn(options: &Options, warnings: &mut Vec<String>) {
    let SunPosition::Time(moment) = &options.sun else { return };
    let away = options.site.longitude - options.site.meridian;
    if !moment.by_the_sun && away.abs() > 45.0 * DEGREE {
        warnings.push(format!("{:.1} hours btwn. standard meridian and longitude", away * 12.0 / PI));
    }
}

/// Parses the first three arguments, and returns the meridian if the hour names a time zone.
fn read_sun(arguments: &mut Arguments<'_>) -> Result<(SunPosition, Option<f64>), Error> {
    if arguments.peek() == Some("-ang") {
        arguments.word();
        let altitude = arguments.number("altitude")? * DEGREE;
        let azimuth = arguments.number("azimuth")? * DEGREE;
        return Ok((SunPosition::Angles { altitude, azimuth }, None));
    }
    let month = read_in_range(arguments, "month", 1..=12)? as usize;
    let day = read_in_range(arguments, "day", 1..=31)?;
    let position = arguments.position();
    let word = arguments.required("hour")?;
    let mistake = |expected: &str| arguments.mistake(position, format!("hour is \"{word}\", expected {expected}"));
    let Some((hour, tail)) = split_hour(word) else {
        return Err(mistake("a time such as 14:30, 14.5 or +14.5 (solar), and perhaps a time zone"));
    };
    let by_the_sun = word.starts_with('+');
    let zone = match tail {
        "" => None,
        _ if by_the_sun || !tail.starts_with(|first: char| first.is_ascii_alphabetic()) => {
            return Err(mistake("a time such as 14:30, 14.5 or +14.5 (solar), and perhaps a time zone"));
        }
        name => match TIME_ZONES.iter().find(|zone| zone.0.eq_ignore_ascii_case(name)) {
            Some(zone) => Some(zone.1 * DEGREE),
            None => {
                let known: Vec<&str> = TIME_ZONES.iter().map(|zone| zone.0).collect();
                return Err(mistake(&format!("one of the time zones {}", known.join(" "))));
            }
        },
    };
    Ok((SunPosition::Time(Moment { year: None, month, day, hour, by_the_sun }), zone))
}

/// Parses an integer in a range.
pub(crate) fn read_in_range(
    arguments: &mut Arguments<'_>,
    name: &str,
    range: std::ops::RangeInclusive<i64>,
) -> Result<i64, Error> {
    let position = arguments.position();
    let value = arguments.integer(name)?;
    if range.contains(&value) {
        return Ok(value);
    }
    Err(arguments.mistake(position, format!("{name} is {value}, expected {} to {}", range.start(), range.end())))
}

/// Parses an hour as `H`, `H.h` or `H:M`, optionally after a plus. Also returns the rest.
fn split_hour(word: &str) -> Option<(f64, &str)> {
    let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    let unsigned = word.strip_prefix('+').unwrap_or(word);
    let after_hours = &unsigned[digits(unsigned)..];
    if let Some(minutes) = after_hours.strip_prefix(':') {
        let hours = leading_integer(unsigned).map_or(0, |(hours, _)| hours) as f64;
        let length = digits(minutes);
        let minutes_value = leading_integer(&minutes[..length]).map_or(0, |(value, _)| value) as f64;
        return Some((hours + minutes_value / 60.0, &minutes[length..]));
    }
    let tail = after_hours.strip_prefix('.').unwrap_or(after_hours);
    let tail = &tail[digits(tail)..];
    let number = &unsigned[..unsigned.len() - tail.len()];
    let (hour, _) = leading_number(number)?;
    hour.is_finite().then_some((hour, tail))
}

/// The parameters of the sky functions.
struct Sky {
    sun_direction: [f64; 3],
    zenith: f64,
    ground: f64,
    /// Formula luminance at the zenith, the divisor for clear and intermediate skies.
    denominator: f64,
    /// Radiance of the sun's disk, if it is written.
    solar: Option<f64>,
}

fn write_sky(options: &Options, text: &mut Text, warnings: &mut Vec<String>) -> Result<(), Error> {
    let (mut altitude, azimuth) = match &options.sun {
        SunPosition::Angles { altitude, azimuth } => (*altitude, *azimuth),
        SunPosition::Time(moment) => {
            let sun = moment.sun(&options.site);
            let (altitude, azimuth) = (sun.altitude(&options.site), sun.azimuth(&options.site));
            writeln!(text, "# Local solar time: {:.2}", sun.solar_time)?;
            writeln!(text, "# Solar altitude and azimuth: {:.1} {:.1}", altitude / DEGREE, azimuth / DEGREE)?;
            (altitude, azimuth)
        }
    };
    if !options.sky.is_cloudy() && altitude > 87.0 * DEGREE {
        let warning = "sun too close to zenith, reducing altitude to 87 degrees";
        warnings.push(warning.to_owned());
        writeln!(text, "# warning - {warning}")?;
        altitude = 87.0 * DEGREE;
    }
    let sky = compute(options, altitude, azimuth, text)?;
    if let Some(solar) = sky.solar {
        let [x, y, z] = sky.sun_direction;
        let radiance = Exponential(solar, 3);
        write!(text, "\nvoid light solar\n0\n0\n3 {radiance} {radiance} {radiance}\n")?;
        write!(text, "\nsolar source sun\n0\n0\n4 {x:.6} {y:.6} {z:.6} 0.5\n")?;
    }
    write!(text, "\nvoid brightfunc skyfunc\n2 skybr skybright.cal\n0\n")?;
    let (kind, zenith, ground) = (options.sky as u8, Exponential(sky.zenith, 3), Exponential(sky.ground, 3));
    if options.sky.is_cloudy() {
        writeln!(text, "3 {kind} {zenith} {ground}")?;
    } else {
        let ([x, y, z], denominator) = (sky.sun_direction, Exponential(sky.denominator, 3));
        writeln!(text, "7 {kind} {zenith} {ground} {denominator} {x:.6} {y:.6} {z:.6}")?;
    }
    Ok(())
}

/// Computes the sky from `altitude` and `azimuth` in radians. Writes the comment about the ground.
fn compute(options: &Options, altitude: f64, azimuth: f64, text: &mut Text) -> Result<Sky, Error> {
    let sun_direction = direction(altitude, azimuth);
    let up = sun_direction[2];
    let zenith_angle = PI / 2.0 - altitude;
    let denominator = match options.sky {
        SkyType::Clear => 0.274 * (0.91 + 10.0 * (-3.0 * zenith_angle).exp() + 0.45 * up * up),
        SkyType::Intermediate => {
            (2.739 + 0.9891 * (0.3119 + 2.6 * altitude).sin()) * (-zenith_angle * (0.4441 + 1.48 * altitude)).exp()
        }
        SkyType::Overcast | SkyType::Uniform => 0.0,
    };
    let mean_over_zenith = match options.sky {
        SkyType::Uniform => 1.0,
        SkyType::Overcast => 0.777_778,
        _ => {
            let sky = if options.sky == SkyType::Intermediate { CieSky::Intermediate } else { CieSky::Clear };
            sky_normalization(altitude, sky) / denominator / PI
        }
    };
    let zenith = match options.zenith {
        Brightness::Radiance(radiance) => radiance,
        Brightness::Irradiance(irradiance) => irradiance / (mean_over_zenith * PI),
        Brightness::Computed => default_zenith(options, altitude, up),
    };
    let mut ground = zenith * mean_over_zenith;
    writeln!(text, "# Ground ambient level: {ground:.1}")?;
    let sun_is_up = !options.sky.is_cloudy() && up > 0.0;
    let solar = match options.solar {
        _ if !sun_is_up => None,
        Brightness::Radiance(radiance) if radiance > 0.0 => Some(radiance),
        // 5.98e-5 sr is the solid angle of a disk of 0.5°.
        Brightness::Irradiance(irradiance) if irradiance > 0.0 => Some(irradiance / (5.98e-5 * up)),
        Brightness::Computed => {
            let radiance = 1.5e9 / SUN_EFFICACY * (1.147 - 0.147 / up.max(0.16));
            Some(if options.sky == SkyType::Intermediate { radiance * 0.15 } else { radiance })
        }
        _ => None,
    };
    if let Some(radiance) = solar {
        ground += 6e-5 / PI * radiance * up;
    }
    ground *= options.ground_reflectance;
    let solar = solar.filter(|_| options.with_sun);
    Ok(Sky { sun_direction, zenith, ground, denominator, solar })
}

/// Zenith radiance from turbidity and solar altitude, W/(sr·m²).
fn default_zenith(options: &Options, altitude: f64, up: f64) -> f64 {
    let cloudy = 8.6 * up + 0.123;
    let clear = || (1.376 * options.turbidity - 1.81) * altitude.tan() + 0.38;
    let kilo_candela = match options.sky {
        SkyType::Overcast | SkyType::Uniform => cloudy,
        SkyType::Clear => clear(),
        SkyType::Intermediate => (clear() + cloudy) / 2.0,
    };
    if kilo_candela < 0.0 { 0.0 } else { kilo_candela * 1000.0 / SKY_EFFICACY }
}

fn write_defaults(text: &mut Text) -> Result<(), Error> {
    let site = Site::default();
    writeln!(text, "+s\t\t\t\t# Sunny sky with sun")?;
    writeln!(text, "-g {:.6}\t\t\t# Ground plane reflectance", 0.2)?;
    writeln!(text, "-t {:.6}\t\t\t# Atmospheric turbidity", 2.45)?;
    writeln!(text, "-a {:.6}\t\t\t# Site latitude (degrees)", site.latitude / DEGREE)?;
    writeln!(text, "-o {:.6}\t\t\t# Site longitude (degrees)", site.longitude / DEGREE)?;
    Ok(writeln!(text, "-m {:.6}\t\t\t# Standard meridian (degrees)", site.meridian / DEGREE)?)
}
