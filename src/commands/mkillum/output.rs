//! The output: scene text and its data files.

use super::parameters::{Becomes, Colors, Parameters};
use crate::failure::{Failure, Outcome};
use crate::output::{replace_file, write_file};
use crate::trust::{Existing, OutputName, Refusal, Trust};
use radsight_flux::IllumSurface;
use radsight_picture::scientific;
use radsight_picture_ops::brightness::of_rgb;
use radsight_scene_generators::padded;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;

/// Numbers per line of a data file.
const NUMBERS_IN_LINE: usize = 5;

/// Largest number of data files with one name.
const MOST_FILES: u32 = 1 << 20;

/// A text that becomes a file.
#[derive(Debug)]
pub(super) struct Output<'a> {
    trust: &'a Trust,
    /// `-` for standard output.
    target: OutputName,
    text: String,
    /// Data files of the text, which are written after it: a text that cannot be written leaves none.
    data: Vec<(OutputName, String)>,
    /// The command, as the first comment.
    header: String,
    has_header: bool,
}

/// A primitive to be written.
#[derive(Clone, Debug)]
pub(super) struct Written {
    pub(super) kind: &'static str,
    pub(super) is_surface: bool,
    pub(super) name: String,
    pub(super) strings: Vec<String>,
    pub(super) integers: Vec<i64>,
    pub(super) reals: Vec<f64>,
}

impl<'a> Output<'a> {
    pub(super) fn new(command: &[String], trust: &'a Trust) -> Output<'a> {
        let header = format!("# {}\n#@mkillum !\n", command.join(" "));
        let target = OutputName::standard_output();
        Output { trust, target, text: String::new(), data: Vec::new(), header, has_header: false }
    }

    /// Continues in another file.
    pub(super) fn go_to(&mut self, file: OutputName) -> Outcome {
        self.finish()?;
        self.target = file;
        self.has_header = false;
        Ok(())
    }

    /// Writes the pending text and its data files; standard output stays empty if everything went to
    /// files.
    pub(super) fn finish(&mut self) -> Outcome {
        let text = std::mem::take(&mut self.text);
        if !(text.is_empty() && &*self.target == "-") {
            write_file(&self.target, text.as_bytes())?;
        }
        // A scene may use the data that `f=` replaces.
        self.data.drain(..).try_for_each(|(file, data)| replace_file(&file, data.as_bytes()))
    }

    pub(super) fn line(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    pub(super) fn put_header(&mut self) {
        if !self.has_header {
            self.text.push_str(&self.header);
            self.has_header = true;
        }
    }

    pub(super) fn alias(&mut self, [modifier, name, target]: [&str; 3]) {
        self.text.push_str(&format!("\n{} alias {}\t{}\n", word(modifier), word(name), word(target)));
    }

    /// Writes a primitive; empty ones are omitted.
    pub(super) fn primitive(&mut self, modifier: &str, primitive: &Written) {
        if primitive.is_surface && modifier == "void" {
            return;
        }
        let Written { kind, name, strings, integers, reals, .. } = primitive;
        let mut text = format!("\n{} {kind} {}\n{}", word(modifier), word(name), strings.len());
        strings.iter().for_each(|string| text.extend([" ", &word(string)]));
        text.push_str(&format!("\n{}", integers.len()));
        integers.iter().for_each(|integer| text.push_str(&format!(" {integer}")));
        text.push_str(&format!("\n{}", reals.len()));
        for (place, real) in reals.iter().enumerate() {
            text.push_str(if place % 3 == 0 { "\n " } else { " " });
            text.push_str(&padded(*real, 18, 12).to_string());
        }
        self.line(&text);
    }

    /// Writes a surface as a light: its pattern with data files, its material and the surface.
    /// `means` are the radiances of its directions.
    pub(super) fn light(
        &mut self,
        parameters: &mut Parameters,
        (modifier, primitive): (&str, &Written),
        surface: &IllumSurface,
        means: &[[f64; 3]],
    ) -> Outcome {
        let mean = mean(means);
        let pattern = if parameters.density > 0 {
            self.pattern(parameters, surface, means, mean)?;
            format!("{}.dist", parameters.material)
        } else {
            "void".to_owned()
        };
        let color = if parameters.colors == Colors::Nothing { [brightness(mean); 3] } else { mean };
        let (kind, substitute) = match parameters.becomes {
            Becomes::Light => ("light", None),
            Becomes::Illum => ("illum", Some(modifier).filter(|modifier| *modifier != "void")),
        };
        let substitute = substitute.map_or_else(|| "0".to_owned(), |name| format!("1 {}", word(name)));
        let material = &parameters.material;
        let [red, green, blue] = color;
        self.line(&format!("\n{pattern} {kind} {material}\n{substitute}\n0\n3 {red:.6} {green:.6} {blue:.6}"));
        self.primitive(&parameters.material, primitive);
        Ok(())
    }

    fn pattern(
        &mut self,
        parameters: &mut Parameters,
        surface: &IllumSurface,
        means: &[[f64; 3]],
        mean: [f64; 3],
    ) -> Outcome {
        let (material, colors) = (&parameters.material, parameters.colors);
        let (trust, pending) = (self.trust, &mut self.data);
        let mut text = match colors {
            Colors::Spread => format!("\nvoid colordata {material}.dist\n9 red green blue"),
            _ => format!("\nvoid brightdata {material}.dist\n5 noneg"),
        };
        let share = |value: f64, mean: f64| if mean > 0.0 { value / mean } else { 0.0 };
        let mut put = |letter: &str, value: &dyn Fn([f64; 3]) -> f64| -> Outcome {
            let file = data_file(parameters, letter, trust, pending)?;
            let values: Vec<f64> = means.iter().map(|radiance| share(value(*radiance), value(mean))).collect();
            text.extend([" ", &word(&file)]);
            pending.push((file, data(surface, &values)));
            Ok(())
        };
        if colors == Colors::Spread {
            put("R", &|color| color[0])?;
            put("G", &|color| color[1])?;
            put("B", &|color| color[2])?;
        } else {
            put("", &brightness)?;
        }
        text.push_str("\n\tillum.cal ");
        match surface.axes() {
            Some(axes) => {
                text.push_str("il_alth il_azih\n0\n9");
                for axis in axes {
                    text.push_str(&format!("\n\t{:.6}\t{:.6}\t{:.6}", axis.x, axis.y, axis.z));
                }
            }
            None => text.push_str("il_alt il_azi\n0\n0"),
        }
        parameters.data_number += 1;
        self.line(&text);
        Ok(())
    }
}

/// The mean of all directions.
pub(super) fn mean(means: &[[f64; 3]]) -> [f64; 3] {
    std::array::from_fn(|band| means.iter().map(|color| color[band]).sum::<f64>() / means.len().max(1) as f64)
}

pub(super) fn brightness(color: [f64; 3]) -> f64 {
    of_rgb(color.map(|part| part as f32))
}

/// The name of the next data file: a new file, unless it may be replaced.
fn data_file(
    parameters: &mut Parameters,
    letter: &str,
    trust: &Trust,
    pending: &[(OutputName, String)],
) -> Result<OutputName, Failure> {
    loop {
        let number = match parameters.data_number {
            0 => String::new(),
            number => number.to_string(),
        };
        let file = data_file_name(&parameters.data_file, letter, &number);
        let exists = fs::symlink_metadata(&file).is_ok() || pending.iter().any(|(name, _)| **name == *file);
        if parameters.replaces_data || !exists {
            return Ok(trust.output_of_file(&file, Existing::IllumData)?);
        }
        parameters.data_number += 1;
        if parameters.data_number > MOST_FILES {
            return Err(Failure::fault(format!(
                "mkillum: \"{file}\" and all lower numbers exist, expected another data file name"
            )));
        }
    }
}

fn data_file_name(name: &str, letter: &str, number: &str) -> String {
    format!("{name}{letter}{number}.dat")
}

/// Checks the data files that a comment names (`f=`, `m=`) before rays are traced for them.
pub(super) fn check_data_files(trust: &Trust, name: &str) -> Result<(), Refusal> {
    let files = ["", "R", "G", "B"].map(|letter| data_file_name(name, letter, ""));
    // Whether existing files may be replaced is decided when they are written.
    files.iter().try_for_each(|file| trust.output_of_file(file, Existing::Replaced).map(drop))
}

/// The file for scene text that a comment names (`o=`); `-` is standard output.
pub(super) fn scene_file(trust: &Trust, name: &str) -> Result<OutputName, Refusal> {
    if name == "-" { Ok(OutputName::standard_output()) } else { trust.output_of_file(name, Existing::IllumScene) }
}

/// A data file of two dimensions.
fn data(surface: &IllumSurface, values: &[f64]) -> String {
    let ([first, last], table) = (surface.row_ends(), surface.table(values));
    let columns = table.first().map_or(0, Vec::len);
    let mut text = format!("2\n{first:.6} {last:.6} {}\n{:.6} {TAU:.6} {columns}\n", table.len(), 0.0);
    for (place, value) in table.iter().flatten().enumerate() {
        if place % NUMBERS_IN_LINE == 0 {
            text.push('\n');
        }
        let _ = write!(text, " {:>12}", scientific(*value, 6));
    }
    text.push('\n');
    text
}

/// A word quoted for scene text.
fn word(text: &str) -> String {
    if !text.is_empty() && !text.contains(|sign: char| sign.is_whitespace() || sign == '"' || sign == '\'') {
        return text.to_owned();
    }
    let quote = if text.contains('"') { '\'' } else { '"' };
    format!("{quote}{text}{quote}")
}
