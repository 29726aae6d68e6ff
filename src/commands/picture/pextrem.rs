//! `pextrem [-o|-O] [picture]`: the darkest and the brightest pixel. `-o` undoes exposures, `-O`
//! also converts XYZE to W/(sr·m²).

use super::files::{failed, finish, open_picture, output, write_failed};
use crate::commands::words::Words;
use crate::failure::Outcome;
use radsight_picture::{Encoding, WHITE_EFFICACY, scientific};
use radsight_picture_ops::extrema::extrema;
use std::io::Write;

/// Runs the program.
pub(super) fn run(mut words: Words<'_>) -> Outcome {
    let (mut original, mut watts) = (false, false);
    while let Some(option) = words.option()? {
        match option {
            "-o" => (original, watts) = (true, false),
            "-O" => (original, watts) = (true, true),
            _ => return Err(words.unknown(option)),
        }
    }
    let path = words.one_file()?;
    let reader = open_picture(path)?;
    let mut scale = [1.0f32; 3];
    if original {
        scale = reader.header().radiance_scale().map_err(|error| failed(path, error.into()))?;
    }
    if watts && reader.encoding() == Encoding::Xyze {
        scale = scale.map(|part| part / WHITE_EFFICACY as f32);
    }
    let found = extrema(reader).map_err(|error| failed(path, error))?;
    let mut out = output();
    for extremum in found {
        let number = |i: usize| scientific(f64::from(extremum.color[i] * scale[i]), 2);
        let written =
            writeln!(out, "{} {}\t{} {} {}", extremum.position, extremum.scanline, number(0), number(1), number(2));
        written.map_err(|error| write_failed(&error))?;
    }
    finish(out)
}
