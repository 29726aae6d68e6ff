//! `epw2wea [-a] WEATHER.epw [WEATHER.wea]`: converts EnergyPlus weather files to Radiance's
//! format; `-a` adds the optical depth of aerosols and the cloud cover.

use crate::arguments::Arguments;
use crate::number_text::{leading_integer, leading_number};
use crate::text::{Text, general};
use crate::weather;
use crate::{Error, Invocation, Output};
use radsight_loader::FileKind;

/// Number of header lines; the last one holds the number of records per hour.
const HEADER_LINES: usize = 8;

/// Columns of a record.
const MONTH: usize = 1;
const DAY: usize = 2;
const HOUR: usize = 3;
const MINUTE: usize = 4;
const TENTHS_COVERED: usize = 22;
const AEROSOL_DEPTH: usize = 29;

/// The output of each record.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Columns {
    Light,
    /// Also aerosol optical depth and cloud cover.
    LightAndAir,
}

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let mut columns = Columns::Light;
    while let Some(option) = arguments.option_before_files()? {
        match option.name {
            "-a" => {
                columns = match columns {
                    Columns::Light => Columns::LightAndAir,
                    Columns::LightAndAir => Columns::Light,
                }
            }
            _ => return Err(arguments.unknown()),
        }
    }
    let input = arguments.required("file-name.epw")?;
    let output = arguments.word();
    if arguments.word().is_some() {
        return Err(arguments.unknown());
    }
    let bytes = invocation.input(input, FileKind::Input)?;
    let wrong = |(line, mistake): (usize, String)| Error::Input {
        program: arguments.program().to_owned(),
        source_name: input.to_owned(),
        mistake: format!("line {line}: {mistake}"),
    };
    let mut text = Text::default();
    // Town names may have any encoding; numbers are ASCII in all of them.
    let lines = String::from_utf8_lossy(&bytes);
    let mut lines = lines.lines().enumerate().map(|(number, line)| (number + 1, line.trim_end()));
    let header: Vec<(usize, &str)> = lines.by_ref().take(HEADER_LINES).collect();
    text.push_bytes(header_text(&header).map_err(wrong)?.as_bytes())?;
    let in_an_hour = records_in_an_hour(&header).map_err(wrong)?;
    for (number, line) in lines.filter(|(_, line)| !line.is_empty()) {
        let record = Record { number, fields: weather::fields(line) };
        text.push_bytes(record.text(in_an_hour, columns).map_err(wrong)?.as_bytes())?;
    }
    let text = text.into_bytes();
    let (standard_output, files) = match output {
        Some(name) => (Vec::new(), vec![(name.to_owned(), text)]),
        None => (text, Vec::new()),
    };
    Ok(Output { standard_output, warnings: arguments.warnings, files, ..Output::default() })
}

/// A value, or a mistake with its line.
type Found<T> = Result<T, (usize, String)>;

fn header_text(header: &[(usize, &str)]) -> Found<String> {
    let fields: Vec<&str> = header.first().map_or(Vec::new(), |(_, line)| weather::fields(line));
    let [name, city, _, country, _, _, latitude, longitude, time_zone, elevation, ..] = fields[..] else {
        return Err((1, "expected the fields after \"LOCATION\" in an EPW file".to_owned()));
    };
    if name != "LOCATION" {
        return Err((1, "expected \"LOCATION\" at the start of an EPW file".to_owned()));
    }
    let number = |field: &str| leading_number(field).map(|(number, _)| number);
    let [Some(_), Some(east), Some(hours), Some(_)] = [latitude, longitude, time_zone, elevation].map(number) else {
        return Err((1, "expected numbers for latitude, longitude, time zone and elevation".to_owned()));
    };
    let (west, meridian, height) = (-east, general(-15.0 * hours, 6), elevation.trim());
    Ok(format!(
        "place {city}_{country}\nlatitude {latitude}\nlongitude {west:.6}\ntime_zone {meridian}\nsite_elevation {height}\nweather_data_file_units 1\n"
    ))
}

fn records_in_an_hour(header: &[(usize, &str)]) -> Found<i64> {
    let wrong = || (HEADER_LINES, "expected \"DATA PERIODS\" and the number of records per hour".to_owned());
    let (_, line) = header.get(HEADER_LINES - 1).ok_or_else(wrong)?;
    let found = line.split(',').nth(2).and_then(leading_integer);
    found.map(|(count, _)| count).filter(|count| line.starts_with("DATA PERIODS") && *count > 0).ok_or_else(wrong)
}

struct Record<'a> {
    number: usize,
    fields: Vec<&'a str>,
}

impl Record<'_> {
    fn text(&self, in_an_hour: i64, columns: Columns) -> Found<String> {
        let wrong = |mistake: String| (self.number, mistake);
        let measured = |(column, missing): (usize, f64)| self.field(column).map(|value| (value, value == missing));
        let ([Some(month), Some(day), Some(hour), Some(minute)], [Some(direct), Some(diffuse)]) = (
            [MONTH, DAY, HOUR, MINUTE].map(|column| self.field(column)),
            [weather::DIRECT, weather::DIFFUSE].map(measured),
        ) else {
            return Err(wrong("expected a date, an hour, and direct and diffuse irradiance".to_owned()));
        };
        // A record belongs to the hour before its time, and its light is the mean over that hour.
        let time = if in_an_hour == 1 { hour - 0.5 } else { hour - 1.0 + minute / 60.0 };
        weather::date([month, day, time]).map_err(wrong)?;
        let ((direct, false), (diffuse, false)) = (direct, diffuse) else {
            return Err(wrong(weather::MISSING.to_owned()));
        };
        weather::check_light(direct, diffuse).map_err(wrong)?;
        let air = match [AEROSOL_DEPTH, TENTHS_COVERED].map(|column| self.field(column)) {
            _ if columns == Columns::Light => String::new(),
            [Some(depth), Some(tenths)] => format!(" {depth:.3} {:.1}", tenths / 10.0),
            _ => return Err(wrong("expected cloud cover and aerosol optical depth (-a)".to_owned())),
        };
        Ok(format!("{month:.0} {day:.0} {time:.3} {direct:.0} {diffuse:.0}{air}\n"))
    }

    fn field(&self, column: usize) -> Option<f64> {
        self.fields.get(column).and_then(|field| leading_number(field)).map(|(number, _)| number)
    }
}
