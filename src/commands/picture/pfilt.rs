//! `pfilt`: exposure, size, star patterns.
//!
//! `-1` one pass, `-2` two passes (the default: the mean brightness becomes ½); `-x N`, `-x /R`,
//! `-y N`, `-y /R` size; `-p A` pixel aspect, `-c` does not record it; `-e E` exposure (a factor,
//! or stops with a sign), `-er -eg -eb` of one component; `-b` box filter, `-r R` Gaussian of
//! radius R output pixels, `-m F` the same with a contribution of at most F from one input pixel;
//! `-n N -s S` stars with N points and spread S, `-h L` threshold of hot pixels, `-a` includes hot
//! pixels in the average; `-t LAMP` balances the light of a lamp to white, by the table `-f FILE`.

use super::files::{failed, open, open_twice, output};
use crate::commands::words::Words;
use crate::disk::{Commands, DiskLoader};
use crate::failure::{Failure, Outcome, say};
use crate::input::use_default_threads;
use radsight_loader::{FileKind, Loader};
use radsight_picture::PictureReader;
use radsight_picture_ops::filter::{
    AspectRecord, FilterOptions, HotPixels, Kernel, Size, filter, filter_one_pass, measure,
};
use radsight_scene_generators::lamp_color;
use std::io::Seek;

/// Default radius for `-m`, output pixels.
const RADIUS_OF_THRESHOLD: f64 = 0.6;
/// Smaller radii and fractions are zero.
const TINY: f64 = 1e-6;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Passes {
    One,
    Two,
}

/// Runs the program.
pub(super) fn run(mut words: Words<'_>) -> Outcome {
    let (options, passes) = read_options(&mut words)?;
    let path = words.one_file()?;
    let command = words.taken();
    use_default_threads()?;
    if passes == Passes::One {
        let reader = PictureReader::new(open(path)?).map_err(|error| failed(path, error.into()))?;
        return filter_one_pass(reader, &options, &command, output()).map_err(|error| failed(path, error));
    }
    let mut file = open_twice(path)?;
    let reader = PictureReader::new(&file).map_err(|error| failed(path, error.into()))?;
    let measured = measure(reader, &options).map_err(|error| failed(path, error))?;
    if let Some(percent) = measured.partial() {
        say(&format!("pfilt: warning - partial frame ({percent}%)\n"));
    }
    file.rewind().map_err(|error| failed(path, radsight_picture::PictureError::from(error).into()))?;
    let reader = PictureReader::new(&file).map_err(|error| failed(path, error.into()))?;
    filter(reader, &options, &measured, &command, output()).map_err(|error| failed(path, error))?;
    match measured.partial() {
        Some(_) => Err(Failure::input(format!("{path}: the picture was not complete"))),
        None => Ok(()),
    }
}

fn read_options(words: &mut Words<'_>) -> Result<(FilterOptions, Passes), Failure> {
    let mut options = FilterOptions::default();
    let mut passes = Passes::Two;
    let (mut radius, mut fraction) = (0.0, 0.0);
    let (mut lamp, mut table) = (None, None);
    while let Some(option) = words.option()? {
        match option {
            "-x" => options.columns = size(words, option)?,
            "-y" => options.rows = size(words, option)?,
            "-c" => {
                options.aspect_record = match options.aspect_record {
                    AspectRecord::Written => AspectRecord::LeftOut,
                    AspectRecord::LeftOut => AspectRecord::Written,
                }
            }
            "-p" => options.aspect = Some(words.number(option)?).filter(|aspect| *aspect > 0.01),
            "-e" | "-er" | "-eg" | "-eb" => expose(words, option, &mut options.exposure)?,
            "-1" => passes = Passes::One,
            "-2" => passes = Passes::Two,
            "-n" => options.star_lines = (words.integer(option)? / 2).max(0) as usize,
            "-s" => options.star_spread = words.number(option)?,
            "-a" => {
                options.hot_pixels = match options.hot_pixels {
                    HotPixels::LeftOut => HotPixels::Averaged,
                    HotPixels::Averaged => HotPixels::LeftOut,
                }
            }
            "-h" => options.hot_level = words.number(option)?,
            "-r" => radius = words.number(option)?,
            "-m" => {
                fraction = words.number(option)?;
                if radius <= TINY {
                    radius = RADIUS_OF_THRESHOLD;
                }
            }
            "-b" => (radius, fraction) = (0.0, 0.0),
            "-t" => lamp = Some(words.value(option, "the description of a lamp")?),
            "-f" => table = Some(words.value(option, "a table of lamps")?),
            _ => return Err(words.unknown(option)),
        }
    }
    if let Some(lamp) = lamp {
        balance(lamp, table, &mut options.exposure)?;
    }
    options.kernel = if radius <= TINY {
        Kernel::Box
    } else if fraction <= TINY {
        Kernel::Gaussian { radius }
    } else {
        Kernel::Threshold { radius, fraction }
    };
    Ok((options, passes))
}

/// Balances the light of a lamp to white.
fn balance(lamp: &str, table: Option<&str>, exposure: &mut [f32; 3]) -> Outcome {
    const DARK: f64 = 1e-4;
    let name = table.unwrap_or("lamp.tab");
    let text = match DiskLoader::new(Commands::Refused).load(name, FileKind::Other) {
        Ok(loaded) => Some(String::from_utf8_lossy(&loaded.bytes).into_owned()),
        Err(_) if table.is_none() => None,
        Err(error) => return Err(Failure::input(format!("pfilt: {error}"))),
    };
    let color = lamp_color(text.as_deref(), lamp).map_err(|error| Failure::input(format!("{name}: {error}")))?;
    let color = color.ok_or_else(|| Failure::input(format!("pfilt: no lamp is \"{lamp}\" in {name}")))?;
    for (part, lamp) in exposure.iter_mut().zip(color).filter(|(_, lamp)| *lamp > DARK) {
        *part = (f64::from(*part) / f64::from(lamp as f32)) as f32;
    }
    Ok(())
}

/// A number of pixels, or after a slash the number of input pixels per output pixel.
fn size(words: &mut Words<'_>, option: &str) -> Result<Size, Failure> {
    let word = words.value(option, "a number of pixels or /ratio")?;
    match word.strip_prefix('/') {
        Some(ratio) => {
            let ratio = words.number_in(ratio, option)?;
            if ratio <= 0.0 {
                return Err(Failure::usage(format!(
                    "pfilt: option \"{option}\" is followed by \"{word}\", expected a ratio above 0"
                )));
            }
            Ok(Size::Scale(1.0 / ratio))
        }
        None => match words.number_in(word, option)? as i64 {
            pixels if pixels > 0 => Ok(Size::Pixels(pixels as usize)),
            _ => Ok(Size::Scale(1.0)),
        },
    }
}

fn expose(words: &mut Words<'_>, option: &str, exposure: &mut [f32; 3]) -> Outcome {
    let word = words.value(option, "an exposure")?;
    let number = words.number_in(word, option)?;
    let factor = if word.starts_with(['+', '-']) { 2f64.powf(number) } else { number };
    if !(1e-20..=1e20).contains(&factor) {
        return Err(Failure::usage(format!(
            "pfilt: option \"{option}\" is followed by \"{word}\", expected 1e-20 to 1e20"
        )));
    }
    let parts = match option {
        "-er" => 0..1,
        "-eg" => 1..2,
        "-eb" => 2..3,
        _ => 0..3,
    };
    exposure[parts].iter_mut().for_each(|part| *part = (f64::from(*part) * factor) as f32);
    Ok(())
}
