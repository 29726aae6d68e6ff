//! Parses IES LM-63 files.

use std::fmt::Write;

use super::number;
use crate::Error;
use crate::text::{Text, general, is_space};

const TINY: f64 = 1e-6;
const FOOT: f64 = 0.3048;

/// The numbers of a file, separated by white space or a comma.
#[derive(Default)]
pub(super) struct Words {
    words: Vec<String>,
    next: usize,
}

impl Words {
    pub(super) fn of(text: &str) -> Words {
        let mut words = Vec::new();
        let mut rest = text.trim_start_matches(is_space);
        while !rest.is_empty() {
            let end = rest.find(|character| is_space(character) || character == ',').unwrap_or(rest.len());
            words.push(rest[..end].to_owned());
            rest = rest[end..].trim_start_matches(is_space);
            rest = rest.strip_prefix(',').unwrap_or(rest).trim_start_matches(is_space);
        }
        Words { words, next: 0 }
    }

    fn word(&mut self, name: &str) -> Result<&str, String> {
        let word = self.words.get(self.next).ok_or_else(|| format!("the file ends before the {name}"))?;
        self.next += 1;
        Ok(word)
    }

    fn number(&mut self, name: &str) -> Result<f64, String> {
        number(self.word(name)?).map_err(|mistake| format!("{name}: {mistake}"))
    }

    /// Integers may have a decimal point, as in the format of 1986.
    fn count(&mut self, name: &str) -> Result<usize, String> {
        Ok(self.number(name)?.clamp(0.0, 1e9) as usize)
    }

    /// A list, which cannot be longer than the rest of the file.
    fn numbers(&mut self, count: usize, name: &str) -> Result<Vec<f64>, String> {
        let left = self.words.len() - self.next;
        if count > left {
            return Err(format!("{count} {name} are declared, but only {left} numbers follow"));
        }
        (0..count).map(|_| self.number(name)).collect()
    }
}

/// The part of the file before the numbers.
pub(super) struct Head {
    /// The year of the format.
    pub(super) version: u32,
    pub(super) lines: Vec<String>,
    /// Texts that may name a lamp, by precedence.
    pub(super) lamp_descriptions: Vec<String>,
    /// A file in Materials and Geometry Format.
    pub(super) geometry: Option<String>,
    /// `NONE`, `INCLUDE`, or a file.
    pub(super) tilt: String,
}

/// Reads up to the line `TILT=`; `words` gets the rest.
pub(super) fn read_head(text: &str, words: &mut Words) -> Result<Head, String> {
    let mut head =
        Head { version: 1986, lines: Vec::new(), lamp_descriptions: Vec::new(), geometry: None, tilt: String::new() };
    let mut rest = text;
    while !rest.is_empty() {
        let (line, behind) = rest.split_once('\n').unwrap_or((rest, ""));
        rest = behind;
        if let Some(tilt) = line.strip_prefix("TILT=") {
            head.tilt = tilt.split_whitespace().next().unwrap_or_default().to_owned();
            *words = Words::of(rest);
            return Ok(head);
        }
        let line = line.trim_end_matches(is_space);
        if line.is_empty() {
            continue;
        }
        if head.lines.is_empty() {
            head.version = version(line);
        }
        head.lines.push(line.to_owned());
        head.read_keyword(line);
    }
    Err("not in IES format: there is no line \"TILT=\"".to_owned())
}

fn version(line: &str) -> u32 {
    match line {
        "IESNA91" => 1991,
        "IESNA:LM-63-1995" => 1995,
        "IESNA:LM-63-2002" => 2002,
        "IES:LM-63-2019" => 2019,
        _ => 1986,
    }
}

impl Head {
    fn read_keyword(&mut self, line: &str) {
        if self.version == 1986 {
            self.lamp_descriptions.push(line.to_owned());
            return;
        }
        let line = line.trim_start_matches(is_space);
        let Some((keyword, value)) = line.strip_prefix('[').and_then(|line| line.split_once(']')) else { return };
        match keyword {
            "LAMP" | "LAMPCAT" => self.lamp_descriptions.push(value.to_owned()),
            "LUMINOUSGEOMETRY" => self.geometry = Some(value.trim().to_owned()),
            _ => {}
        }
    }
}

/// The dependence of the output on the luminaire's tilt.
pub(super) struct Tilt {
    /// 1 to 3: the mounting of the lamp.
    pub(super) mounting: u8,
    /// Tilt angles, degrees.
    angles: Vec<f64>,
    factors: Vec<f64>,
}

impl Tilt {
    pub(super) fn read(words: &mut Words) -> Result<Tilt, String> {
        let mounting = words.count("lamp to luminaire geometry")?;
        if !(1..=3).contains(&mounting) {
            return Err(format!("lamp to luminaire geometry is {mounting}, expected 1 to 3"));
        }
        let count = words.count("number of tilt angles")?;
        let angles = words.numbers(count, "tilt angles")?;
        let factors = words.numbers(count, "tilt factors")?;
        if angles.is_empty() {
            return Err("there are no tilt angles".to_owned());
        }
        Ok(Tilt { mounting: mounting as u8, angles, factors })
    }

    pub(super) fn last_angle(&self) -> f64 {
        self.angles[self.angles.len() - 1]
    }

    pub(super) fn data_file(&self) -> Result<Vec<u8>, Error> {
        write_data(&[&self.angles], &self.factors, 1.0)
    }
}

/// The coordinate system of the measurement.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Photometry {
    B,
    C,
}

/// The numbers of a luminaire; angles in degrees, lengths in metres.
pub(super) struct Luminaire {
    pub(super) version: u32,
    pub(super) photometry: Photometry,
    /// Multiplier of the candela values: the file's own and the ballast factor.
    pub(super) multiplier: f64,
    pub(super) ballast_factor: f64,
    pub(super) watts: f64,
    /// Size of the luminous opening; signs encode its shape.
    pub(super) width: f64,
    pub(super) length: f64,
    pub(super) height: f64,
    pub(super) vertical: Vec<f64>,
    pub(super) horizontal: Vec<f64>,
    /// All vertical angles for each horizontal angle.
    candela: Vec<f64>,
}

impl Luminaire {
    pub(super) fn read(words: &mut Words, version: u32) -> Result<Luminaire, String> {
        words.number("number of lamps")?;
        words.number("lumens")?;
        let multiplier = words.number("candela multiplier")?;
        let vertical_count = words.count("number of vertical angles")?;
        let horizontal_count = words.count("number of horizontal angles")?;
        let photometry = match words.count("photometric type")? {
            1 => Photometry::C,
            2 => Photometry::B,
            other => return Err(format!("photometric type {other} is not supported, expected 1 (C) or 2 (B)")),
        };
        let unit = if words.count("unit type")? == 1 { FOOT } else { 1.0 };
        let [width, length, height] = [words.number("width")?, words.number("length")?, words.number("height")?];
        let ballast = words.number("ballast factor")?;
        let photometric = words.number("ballast-lamp photometric factor")?;
        let watts = words.number("input watts")?;
        if vertical_count < 2 || horizontal_count < 1 {
            return Err(format!("{vertical_count} vertical and {horizontal_count} horizontal angles are too few"));
        }
        let vertical = words.numbers(vertical_count, "vertical angles")?;
        let horizontal = words.numbers(horizontal_count, "horizontal angles")?;
        let candela = words.numbers(vertical_count.saturating_mul(horizontal_count), "candela values")?;
        // Since 1995 the photometric factor has other uses.
        let ballast_factor = if version >= 1995 { ballast } else { ballast * photometric };
        Ok(Luminaire {
            version,
            photometry,
            multiplier: multiplier * ballast_factor,
            ballast_factor,
            watts,
            width: width * unit,
            length: length * unit,
            height: height * unit,
            vertical,
            horizontal,
            candela,
        })
    }

    pub(super) fn last_vertical(&self) -> f64 {
        self.vertical[self.vertical.len() - 1]
    }

    pub(super) fn last_horizontal(&self) -> f64 {
        self.horizontal[self.horizontal.len() - 1]
    }

    /// The data file: candela divided by lumens per watt.
    pub(super) fn data_file(&self, efficacy: f64) -> Result<Vec<u8>, Error> {
        write_data(&[&self.horizontal, &self.vertical], &self.candela, 1.0 / efficacy)
    }
}

/// A Radiance data file; axes with one value are omitted.
fn write_data(axes: &[&[f64]], values: &[f64], multiplier: f64) -> Result<Vec<u8>, Error> {
    let mut text = Text::default();
    let axes: Vec<&[f64]> = axes.iter().copied().filter(|axis| axis.len() > 1).collect();
    writeln!(text, "{}", axes.len())?;
    for axis in &axes {
        let count = axis.len();
        let is_even = axis.windows(3).all(|part| ((part[1] - part[0]) - (part[2] - part[1])).abs() <= TINY);
        if is_even {
            writeln!(text, "{} {} {count}", general(axis[0], 6), general(axis[count - 1], 6))?;
        } else {
            write!(text, "0 0 {count}")?;
            write_in_fours(&mut text, axis)?;
        }
    }
    let scaled: Vec<f64> = values.iter().map(|value| value * multiplier).collect();
    write_in_fours(&mut text, &scaled)?;
    Ok(text.into_bytes())
}

fn write_in_fours(text: &mut Text, values: &[f64]) -> Result<(), Error> {
    for (index, value) in values.iter().enumerate() {
        if index % 4 == 0 {
            writeln!(text)?;
        }
        write!(text, "\t{}", general(*value, 6))?;
    }
    Ok(writeln!(text)?)
}
