//! Weather files: hourly sunlight and skylight. Reads the text of `epw2wea` (WEA) and EnergyPlus'
//! format (EPW).

use crate::number_text::leading_number;

/// A weather file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Weather {
    /// Degrees north, and degrees east of Greenwich.
    pub(crate) latitude: f64,
    pub(crate) longitude: f64,
    /// Hours by which the clock is ahead of Greenwich.
    pub(crate) time_zone: f64,
    pub(crate) quantity: Quantity,
    pub(crate) records: Vec<Record>,
}

/// The measured quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    /// W/m², direct light on a surface that faces the sun.
    NormalIrradiance,
    /// W/m², direct light on a horizontal surface.
    HorizontalIrradiance,
    /// lux, direct light on a surface that faces the sun.
    NormalIlluminance,
}

/// One time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Record {
    /// Month 1 to 12, and day 1 to 31.
    pub(crate) month: usize,
    pub(crate) day: i64,
    pub(crate) hour: f64,
    pub(crate) direct: f64,
    /// On a horizontal surface.
    pub(crate) diffuse: f64,
    /// Dew point, °C.
    pub(crate) dew_point: Option<f64>,
}

/// Header lines.
const WEA_HEADER: [&str; 5] = ["latitude", "longitude", "time_zone", "site_elevation", "weather_data_file_units"];
const EPW_HEADER_LINES: usize = 8;

/// Columns of an EPW record, and their values for missing data.
const DEW_POINT: (usize, f64) = (7, 99.9);
pub(crate) const DIRECT: (usize, f64) = (14, 9999.0);
pub(crate) const DIFFUSE: (usize, f64) = (15, 9999.0);
/// The mistake of such a record.
pub(crate) const MISSING: &str = "direct or diffuse irradiance is missing";

/// Largest light, W/m² or lux: more than the sun's surface emits. The limit keeps skies within
/// single precision.
const MOST_LIGHT: f64 = 1e12;

/// Days of each month in a leap year.
const DAYS: [i64; 12] = [31, 29, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];

impl Weather {
    /// Parses a file; the error contains the line.
    pub(crate) fn read(text: &str) -> Result<Weather, String> {
        let first = text.lines().next().unwrap_or_default().to_ascii_lowercase();
        let weather = if first.starts_with("place ") {
            read_wea(text)
        } else if first.starts_with("location,") {
            read_epw(text)
        } else {
            return Err("line 1: expected \"place\" or \"LOCATION,\"".to_owned());
        }?;
        let sane =
            weather.latitude.abs() <= 90.0 && weather.longitude.abs() <= 180.0 && weather.time_zone.abs() <= 14.0;
        if !sane {
            return Err(
                "the site is not on earth, expected a latitude within 90 and a longitude within 180 degrees".to_owned()
            );
        }
        if weather.records.is_empty() { Err("no record follows the header".to_owned()) } else { Ok(weather) }
    }
}

pub(crate) fn check_light(direct: f64, diffuse: f64) -> Result<(), String> {
    let light = direct.abs().max(diffuse.abs());
    if light <= MOST_LIGHT { Ok(()) } else { Err(format!("light of {light:e}, expected at most {MOST_LIGHT:e}")) }
}

fn read_wea(text: &str) -> Result<Weather, String> {
    let mut lines = text.lines().enumerate().skip(1);
    let mut header = [0.0; WEA_HEADER.len()];
    for (value, name) in header.iter_mut().zip(WEA_HEADER) {
        let (number, line) = lines.next().ok_or_else(|| format!("the header ends before \"{name}\""))?;
        let mut words = line.split_whitespace();
        let found = (words.next() == Some(name)).then(|| words.next().and_then(finite)).flatten();
        *value = found.ok_or_else(|| format!("line {}: expected \"{name}\" and a number", number + 1))?;
    }
    let [latitude, west, meridian_west, _, units] = header;
    let quantity = match units {
        1.0 => Quantity::NormalIrradiance,
        2.0 => Quantity::HorizontalIrradiance,
        3.0 => Quantity::NormalIlluminance,
        _ => return Err(format!("weather_data_file_units is {units}, expected 1, 2 or 3")),
    };
    let mut records = Vec::new();
    for (number, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let wrong = |what: &str| format!("line {}: {what}", number + 1);
        let numbers: Vec<f64> = line.split_whitespace().take(5).map_while(finite).collect();
        let [month, day, hour, direct, diffuse] = numbers[..] else {
            return Err(wrong("expected month, day, hour, direct and diffuse light"));
        };
        let date = date([month, day, hour]).map_err(|what| wrong(&what))?;
        check_light(direct, diffuse).map_err(|what| wrong(&what))?;
        records.push(Record { direct, diffuse, ..date });
    }
    Ok(Weather { latitude, longitude: -west, time_zone: -meridian_west / 15.0, quantity, records })
}

fn read_epw(text: &str) -> Result<Weather, String> {
    let mut lines = text.lines().enumerate();
    let mut place: [f64; 3] = [0.0; 3];
    let mut an_hour = 1.0;
    for (number, line) in lines.by_ref().take(EPW_HEADER_LINES) {
        let fields = fields(line);
        let field = |index: usize| fields.get(index).copied().and_then(finite);
        let wrong = |what: &str| format!("line {}: expected {what}", number + 1);
        match number {
            0 => {
                for (value, index) in place.iter_mut().zip(6..) {
                    *value = field(index).ok_or_else(|| wrong("latitude, longitude and time zone"))?;
                }
            }
            7 if fields[0].eq_ignore_ascii_case("DATA PERIODS") => {
                let found = field(2).filter(|records| *records >= 1.0);
                an_hour = found.ok_or_else(|| wrong("the number of records per hour"))?;
            }
            7 => return Err(wrong("\"DATA PERIODS\"")),
            _ => {}
        }
    }
    let mut records = Vec::new();
    for (number, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let fields = fields(line);
        let field = |index: usize| fields.get(index).copied().and_then(finite);
        let measured = |(index, missing): (usize, f64)| field(index).filter(|value| *value != missing);
        let wrong = |what: &str| format!("line {}: {what}", number + 1);
        let [Some(month), Some(day), Some(hour), Some(minute)] = [1, 2, 3, 4].map(field) else {
            return Err(wrong("expected year, month, day, hour and minute"));
        };
        whole_numbers([("hour", hour), ("minute", minute)]).map_err(|what| wrong(&what))?;
        let within = if an_hour == 1.0 { 0.5 } else { minute / 60.0 };
        let date = date([month, day, hour - 1.0 + within]).map_err(|what| wrong(&what))?;
        let (Some(direct), Some(diffuse)) = (measured(DIRECT), measured(DIFFUSE)) else {
            return Err(wrong(MISSING));
        };
        check_light(direct, diffuse).map_err(|what| wrong(&what))?;
        records.push(Record { direct, diffuse, dew_point: measured(DEW_POINT), ..date });
    }
    let [latitude, longitude, time_zone] = place;
    Ok(Weather { latitude, longitude, time_zone, quantity: Quantity::NormalIrradiance, records })
}

/// The number at the start of a field.
fn finite(text: &str) -> Option<f64> {
    leading_number(text.trim()).map(|(value, _)| value).filter(|value| value.is_finite())
}

/// The fields of a line of an EPW file. Commas between quotation marks are part of their field.
pub(crate) fn fields(line: &str) -> Vec<&str> {
    let (mut found, mut rest) = (Vec::new(), Some(line));
    while let Some(text) = rest {
        let (field, after) = quoted_field(text).unwrap_or_else(|| match text.split_once(',') {
            Some((field, after)) => (field, Some(after)),
            None => (text, None),
        });
        found.push(field);
        rest = after;
    }
    found
}

/// The text of a quoted field, and what follows its comma; `None` if it is not quoted as a whole.
fn quoted_field(text: &str) -> Option<(&str, Option<&str>)> {
    let (field, after) = text.trim_start().strip_prefix('"')?.split_once('"')?;
    let after = after.trim_start();
    match after.strip_prefix(',') {
        Some(after) => Some((field, Some(after))),
        None => after.is_empty().then_some((field, None)),
    }
}

/// The time step of a month, a day and an hour, without light.
pub(crate) fn date([month, day, hour]: [f64; 3]) -> Result<Record, String> {
    whole_numbers([("month", month), ("day", day)])?;
    let nowhere = || format!("there is no hour {hour} of day {day} in month {month}");
    let month_index = if (1.0..=12.0).contains(&month) { month as usize - 1 } else { return Err(nowhere()) };
    let exists = day >= 1.0 && day as i64 <= DAYS[month_index] && (0.0..=24.0).contains(&hour);
    let date = Record { month: month_index + 1, day: day as i64, hour, direct: 0.0, diffuse: 0.0, dew_point: None };
    if exists { Ok(date) } else { Err(nowhere()) }
}

fn whole_numbers(numbers: [(&str, f64); 2]) -> Result<(), String> {
    match numbers.into_iter().find(|(_, value)| value.fract() != 0.0) {
        Some((name, value)) => Err(format!("the {name} is {value}, expected a whole number")),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_formats_are_read() {
        let wea = "place A_B\nlatitude 37.42\nlongitude 122.05\ntime_zone 120\nsite_elevation 12.0\n\
                   weather_data_file_units 1\n3 21 5.500 1.5 2\n";
        let weather = Weather::read(wea).unwrap();
        assert_eq!((weather.longitude, weather.time_zone, weather.records.len()), (-122.05, -8.0, 1));
        let header = "LOCATION,a,b,c,d,e,37.42,-122.05,-8.0,12.0\n".to_owned() + &"x\n".repeat(6);
        let epw =
            format!("{header}DATA PERIODS,1,1,Data,Sunday,1/1,12/31\n1990,3,21,6,60,?9,20,11.5,1,1,1,1,1,99,1.5,2,0\n");
        let other = Weather::read(&epw).unwrap();
        assert_eq!(other.records, [Record { dew_point: Some(11.5), ..weather.records[0] }]);
    }

    #[test]
    fn quoted_fields_hold_commas() {
        for (line, expected) in [
            ("a,\"b, c\" ,d", &["a", "b, c", "d"][..]),
            ("\"a,b\"", &["a,b"]),
            ("a \"b, c\",\"", &["a \"b", " c\"", "\""]),
            ("\"a\"b,c,", &["\"a\"b", "c", ""]),
            ("", &[""]),
        ] {
            assert_eq!(fields(line), expected, "{line}");
        }
    }

    #[test]
    fn mistakes_have_their_line() {
        let wea = "place A_B\nlatitude 37.42\nlongitude 122.05\ntime_zone 120\nsite_elevation 12.0\nweather_data_file_units 1\n";
        for (text, message) in [
            (String::new(), "line 1: expected"),
            ("place x\nlatitude north\n".to_owned(), "line 2: expected \"latitude\" and a number"),
            ("place x\n".to_owned(), "the header ends before \"latitude\""),
            (wea.to_owned(), "no record follows the header"),
            (format!("{wea}13 1 1 1 1\n"), "line 7: there is no hour 1 of day 1 in month 13"),
            (format!("{wea}1 1 1 1e40 1\n"), "line 7: light of 1e40, expected at most 1e12"),
            (format!("{wea}2 29 1 1 1\n2 30 1 1 1\n"), "line 8: there is no hour 1 of day 30 in month 2"),
            (format!("{wea}3.5 21 12.5 600 100\n"), "line 7: the month is 3.5, expected a whole number"),
            (format!("{wea}3 21.7 12.5 600 100\n"), "line 7: the day is 21.7, expected a whole number"),
            (format!("{wea}3 21 24.5 600 100\n"), "line 7: there is no hour 24.5 of day 21 in month 3"),
            (format!("{wea}1 1 1 1\n"), "line 7: expected month"),
            (wea.replace("units 1", "units 7"), "expected 1, 2 or 3"),
            (format!("{}1 1 1 1 1\n", wea.replace("37.42", "99")), "not on earth"),
        ] {
            let error = Weather::read(&text).unwrap_err();
            assert!(error.contains(message), "{error}");
        }
    }
}
