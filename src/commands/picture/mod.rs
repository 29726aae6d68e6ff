//! Radiance's picture programs.

mod falsecolor;
mod files;
mod getinfo;
mod packing;
mod pcomb;
mod pcompos;
mod pcond;
mod pextrem;
mod pfilt;
mod pinterp;
mod psign;
mod pturn;
mod pvalue;
mod ra_rgbe;
mod ra_xyze;
mod raster;
mod three_values;

use super::words::Words;
use crate::failure::Outcome;
use crate::trust::Trust;

/// The function that runs a program.
type Program = fn(Words<'_>) -> Outcome;

/// The programs by their names.
const PROGRAMS: &[(&str, Program)] = &[
    ("falsecolor", falsecolor::run),
    ("getinfo", getinfo::run),
    ("pcomb", pcomb::run),
    ("pcompos", pcompos::run),
    ("pcond", pcond::run),
    ("pextrem", pextrem::run),
    ("pfilt", pfilt::run),
    ("pflip", pturn::flip),
    ("pinterp", pinterp::run),
    ("protate", pturn::rotate),
    ("psign", psign::run),
    ("pvalue", pvalue::run),
    ("ra_bmp", raster::ra_bmp),
    ("ra_png", raster::ra_png),
    ("ra_ppm", raster::ra_ppm),
    ("ra_rgbe", ra_rgbe::run),
    ("ra_tiff", raster::ra_tiff),
    ("ra_xyze", ra_xyze::run),
];

/// Runs a program if it is one of these; `words[0]` is its name.
pub(crate) fn run(words: &[String], trust: &Trust) -> Option<Outcome> {
    let name = words.first()?;
    let (_, program) = PROGRAMS.iter().find(|(known, _)| known == name)?;
    Some(program(Words::new(words, trust)))
}
