//! `psign [-cb R G B] [-cf R G B] [-dr|-du|-dl|-dd] [-h N] [-a A] [-x N] [-y N] [-s S] [-f font]
//! [text …]`: text as a picture.

use super::files::output;
use crate::commands::words::Words;
use crate::disk::{Commands, DiskLoader};
use crate::failure::{Failure, Outcome};
use crate::input::read_standard_input;
use radsight_formats::Font;
use radsight_loader::{FileKind, Loader};
use radsight_picture::{Header, PictureWriter, Resolution};
use radsight_picture_ops::sign::{Sign, SignOptions, TextDirection, sign};

/// The default font.
const FONT: &str = "helvet.fnt";

/// Runs the program.
pub(super) fn run(mut words: Words<'_>) -> Outcome {
    let (options, font) = read_options(&mut words)?;
    let font = load_font(&font)?;
    let text = match words.rest() {
        [] => read_standard_input()?,
        words => words.join(" ").into_bytes(),
    };
    let text = text.strip_suffix(b"\n").unwrap_or(&text);
    let lines: Vec<&[u8]> = text.split(|byte| *byte == b'\n').collect();
    let Sign { columns, rows, stored } = sign(&font, &lines, &options)
        .ok_or_else(|| Failure::input("psign: the text is empty or too large, expected 1 to 32768 pixels"))?;
    let mut header = Header::new("RADIANCE");
    header.push_command(words.all());
    header.push_variable("FORMAT", "32-bit_rle_rgbe");
    let wrong = |error: radsight_picture::PictureError| super::files::failed("psign", error.into());
    let mut writer = PictureWriter::new(output(), &header, 3, Resolution::standard(columns, rows)).map_err(wrong)?;
    for scanline in stored.chunks_exact(4 * columns) {
        writer.write_stored(scanline).map_err(wrong)?;
    }
    writer.finish().map_err(wrong)
}

/// Loads a font from disk or from the built-in ones.
pub(super) fn load_font(name: &str) -> Result<Font, Failure> {
    let wrong = |error: String| Failure::input(format!("font \"{name}\": {error}"));
    let loaded = DiskLoader::new(Commands::Refused).load(name, FileKind::Font);
    let bytes = match (loaded, radsight_formats::library::file(name)) {
        (Ok(loaded), _) => loaded.bytes,
        (Err(_), Some(text)) => text.as_bytes().to_vec(),
        (Err(error), None) => return Err(Failure::input(format!("psign: {error}"))),
    };
    Font::read(&bytes).map_err(|error| wrong(error.to_string()))
}

/// The picture of a label for `pcompos` and `falsecolor`, in bytes.
pub(super) fn picture_of(text: &str, options: &SignOptions) -> Result<Vec<u8>, Failure> {
    let font = load_font(FONT)?;
    let drawn = sign(&font, &[text.as_bytes()], options);
    let Sign { columns, rows, stored } =
        drawn.ok_or_else(|| Failure::input(format!("the label \"{text}\" does not fit into a picture")))?;
    let mut header = Header::new("RADIANCE");
    header.push_variable("FORMAT", "32-bit_rle_rgbe");
    let mut bytes = Vec::new();
    let wrong = |error: radsight_picture::PictureError| super::files::failed("label", error.into());
    let mut writer = PictureWriter::new(&mut bytes, &header, 3, Resolution::standard(columns, rows)).map_err(wrong)?;
    for scanline in stored.chunks_exact(4 * columns) {
        writer.write_stored(scanline).map_err(wrong)?;
    }
    writer.finish().map_err(wrong)?;
    Ok(bytes)
}

fn read_options(words: &mut Words<'_>) -> Result<(SignOptions, String), Failure> {
    let mut options = SignOptions::default();
    let mut font = FONT.to_owned();
    while let Some(option) = words.option()? {
        match option {
            "-cb" => options.background = color(words, option)?,
            "-cf" => options.foreground = color(words, option)?,
            "-f" => font = words.value(option, "a font file")?.to_owned(),
            "-dr" => options.direction = TextDirection::Right,
            "-du" => options.direction = TextDirection::Up,
            "-dl" => options.direction = TextDirection::Left,
            "-dd" => options.direction = TextDirection::Down,
            "-x" => options.columns = words.integer(option)?.max(0) as usize,
            "-y" => options.rows = words.integer(option)?.max(0) as usize,
            "-h" => options.height = words.integer(option)?.max(0) as usize,
            "-a" => options.aspect = words.number(option)?,
            "-s" => options.spacing = words.number(option)?,
            _ => return Err(words.unknown(option)),
        }
    }
    Ok((options, font))
}

fn color(words: &mut Words<'_>, option: &str) -> Result<[f32; 3], Failure> {
    let mut color = [0.0; 3];
    for part in &mut color {
        *part = words.number(option)? as f32;
    }
    Ok(color)
}
