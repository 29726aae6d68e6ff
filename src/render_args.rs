//! Radiance's rendering options, which consist of one dash and two letters.
//!
//! Most options that control Radiance's approximations of direct light and highlights are accepted
//! and have no effect: radsight computes those integrals. `-dt` trades noise for time instead.

use crate::args::Reading;
use crate::disk::{Commands, DiskLoader};
use crate::failure::Failure;
use crate::switch::switched;
use crate::trust::{Existing, Origin};
use radsight_cal::{Definitions, Scope};
use radsight_diag::SourceMap;
use radsight_ir::Rgb;
use radsight_loader::{FileKind, Loader};
use radsight_render::{
    AmbientSurfaces, BackFaces, Caustics, DirectThreshold, Lights, PathLimit, Quantity, RenderOptions, Sampling,
};
use std::cmp::Ordering;

/// Options with one number that control approximations which radsight does not make.
const WITHOUT_EFFECT: [&str; 4] = ["-dj", "-dc", "-dp", "-ss"];

/// The weight of Radiance's ambient value: in radsight the value is used only where indirect light
/// is not computed.
const AMBIENT_WEIGHT: &str = "-aw";

/// Parses the number of highlight samples (`-ss`) at the front, for programs whose rays count by
/// themselves; returns the number of words it used. Other programs average many rays, each of which
/// needs one sample.
pub(crate) fn take_highlight_samples(words: &[String], options: &mut RenderOptions) -> Result<usize, Failure> {
    if words[0] != "-ss" {
        return Ok(0);
    }
    let expected = "a number of rays for each highlight, 0 or more";
    let samples: f64 = number(words, "-ss", expected)?;
    if !(samples >= 0.0 && samples.is_finite()) {
        return Err(Failure::usage(format!("option \"-ss\" with {samples}: expected {expected}")));
    }
    options.highlight_samples = samples;
    Ok(2)
}

/// Removes the rendering options from a command line and returns them with the rest.
///
/// Commands whose own arguments could look like such options do not use this.
pub(crate) fn take(words: &[String]) -> Result<(RenderOptions, Vec<String>), Failure> {
    let mut options = RenderOptions::default();
    let mut rest = Vec::new();
    let mut at = 0;
    while at < words.len() {
        let used = match words[at].as_str() {
            // Programs that parse options this way keep no irradiance cache in a file.
            "-af" => number::<String>(&words[at..], "-af", "a file").map(|_| 2)?,
            _ => take_one(&words[at..], &mut options)?,
        };
        if used == 0 {
            rest.push(words[at].clone());
        }
        at += used.max(1);
    }
    Ok((options, rest))
}

/// Parses one rendering option at the front; returns the number of words it used, 0 for another
/// option.
pub(crate) fn take_one(words: &[String], options: &mut RenderOptions) -> Result<usize, Failure> {
    let word = words[0].as_str();
    if let Some(visible) = switched(word, "-bv", options.back_faces == BackFaces::Visible) {
        options.back_faces = if visible { BackFaces::Visible } else { BackFaces::Invisible };
        return Ok(1);
    }
    if let Some(visible) = switched(word, "-dv", options.lights == Lights::Visible) {
        options.lights = if visible { Lights::Visible } else { Lights::Invisible };
        return Ok(1);
    }
    match word {
        "-ab" => {
            options.ambient_bounces = number(words, word, "a number of bounces, 0 or more")?;
            Ok(2)
        }
        "-aa" => {
            options.gathering.accuracy = number(words, word, "an error, 0 or more")?;
            Ok(2)
        }
        "-ar" => {
            options.gathering.resolution = number(words, word, "a resolution, 0 or more")?;
            Ok(2)
        }
        "-ad" => {
            options.gathering.divisions = number(words, word, "a number of rays, 0 or more")?;
            Ok(2)
        }
        "-as" => {
            options.gathering.super_samples = number(words, word, "a number of rays, 0 or more")?;
            Ok(2)
        }
        "-ds" => {
            options.source_sampling = number(words, word, "a ratio of size to distance, 0 or more")?;
            Ok(2)
        }
        "-dt" => {
            let expected = "a share of the light, 0 or more";
            let threshold: f64 = number(words, word, expected)?;
            options.direct_threshold = DirectThreshold::new(threshold)
                .ok_or_else(|| Failure::usage(format!("option \"-dt\" with {threshold}: expected {expected}")))?;
            Ok(2)
        }
        "-st" => {
            options.highlight_threshold = number(words, word, "a number from 0 to 1")?;
            Ok(2)
        }
        "--caustics" => {
            options.caustics = Caustics::Sampled;
            Ok(1)
        }
        "-dr" => {
            options.mirror_sources = number(words, word, "a depth of virtual sources, 0 or more")?;
            Ok(2)
        }
        "-cs" => {
            let [longest, .., shortest] = options.sampling.splits_nm();
            sampling(options, number(words, word, "a number of bands, 3 or more")?, [longest, shortest])
        }
        "-cw" => {
            let first = number(words, word, "two wavelengths in nm")?;
            let last = number(&words[1.min(words.len() - 1)..], word, "two wavelengths in nm")?;
            sampling(options, options.sampling.bands(), [first, last]).map(|used| used + 1)
        }
        "-av" => color(words, "three radiances", &mut options.ambient_value),
        "-me" => color(words, "three extinctions", &mut options.medium.extinction),
        "-ma" => color(words, "three albedos", &mut options.medium.albedo),
        "-mg" => {
            options.medium.eccentricity = number(words, word, "a number from 0 to 1")?;
            Ok(2)
        }
        "-ms" => {
            options.mist_sample_length = number(words, word, "a length")?;
            Ok(2)
        }
        "-lr" => {
            options.path_limit = path_limit(number(words, word, "a number of reflections")?);
            Ok(2)
        }
        "-lw" => {
            options.least_weight = number(words, word, "a weight, 0 or more")?;
            Ok(2)
        }
        "-ae" | "-ai" => {
            let name: String = number(words, word, "the name of a modifier")?;
            name_surfaces(options, if word == "-ai" { SurfaceList::Only } else { SurfaceList::Except }, name);
            Ok(2)
        }
        "-aE" | "-aI" => {
            let file: String = number(words, word, "a file of modifiers' names")?;
            for name in names_in_file(word, &file)? {
                name_surfaces(options, if word == "-aI" { SurfaceList::Only } else { SurfaceList::Except }, name);
            }
            Ok(2)
        }
        // The search radius of photon maps, without effect.
        "-am" => number::<f64>(words, word, "a number").map(|_| 2),
        "-ap" => Err(Failure::usage("option \"-ap\": photon maps are not supported")),
        _ if WITHOUT_EFFECT.contains(&word) || word == AMBIENT_WEIGHT => {
            let _: f64 = number(words, word, "a number")?;
            Ok(2)
        }
        "-u" | "-u+" | "-u-" | "-u1" | "-u0" => Ok(1),
        _ => Ok(0),
    }
}

/// Parses `-cs`; returns the number of words it used.
fn sampling(options: &mut RenderOptions, bands: usize, range_nm: [f64; 2]) -> Result<usize, Failure> {
    let [first, last] = range_nm;
    options.sampling = Sampling::new(bands, range_nm).ok_or_else(|| {
        let what = format!("{bands} bands from {first} to {last} nm");
        Failure::usage(format!("invalid sampling: {what}, expected 3 bands or more and a range of 50 nm or more"))
    })?;
    Ok(2)
}

fn path_limit(limit: i32) -> PathLimit {
    match limit.cmp(&0) {
        Ordering::Greater => PathLimit::Cut(limit.unsigned_abs()),
        Ordering::Equal => PathLimit::Roulette,
        Ordering::Less => PathLimit::RouletteUpTo(limit.unsigned_abs()),
    }
}

/// Three numbers after an option.
fn color(words: &[String], expected: &str, color: &mut Rgb) -> Result<usize, Failure> {
    for (band, value) in color.0.iter_mut().enumerate() {
        let given: f64 = number(&words[band.min(words.len() - 1)..], &words[0], expected)?;
        if !given.is_finite() || given < 0.0 {
            let option = &words[0];
            return Err(Failure::usage(format!("option \"{option}\" with {given}: expected {expected}, 0 or more")));
        }
        *value = given;
    }
    Ok(4)
}

/// A list of surfaces with diffuse interreflection (`-ai`) or without (`-ae`).
#[derive(Clone, Copy)]
enum SurfaceList {
    Only,
    Except,
}

/// Adds a name to those of `-ae` or `-ai`; as in Radiance, the first of the other kind starts a new
/// list.
fn name_surfaces(options: &mut RenderOptions, list: SurfaceList, name: String) {
    match (&mut options.ambient_surfaces, list) {
        (AmbientSurfaces::Only(names), SurfaceList::Only) => names.push(name),
        (AmbientSurfaces::Except(names), SurfaceList::Except) => names.push(name),
        (other, SurfaceList::Only) => *other = AmbientSurfaces::Only(vec![name]),
        (other, SurfaceList::Except) => *other = AmbientSurfaces::Except(vec![name]),
    }
}

/// The words of a file in `RAYPATH`.
pub(crate) fn names_in_file(option: &str, file: &str) -> Result<Vec<String>, Failure> {
    let loaded = DiskLoader::new(Commands::Refused).load(file, FileKind::Other);
    let loaded = loaded.map_err(|error| Failure::input(format!("option \"{option}\": {error}")))?;
    Ok(names_in(&loaded.bytes))
}

/// Names of modifiers in a text, optionally quoted.
pub(crate) fn names_in(text: &[u8]) -> Vec<String> {
    let text = String::from_utf8_lossy(text);
    text.split_whitespace().map(|name| name.trim_matches(['"', '\'']).to_owned()).collect()
}

/// Parses `-i` at the front: whether irradiance of surfaces is requested; returns the number of
/// words it used.
pub(crate) fn take_irradiance(words: &[String], options: &mut RenderOptions) -> usize {
    let Some(on) = switched(&words[0], "-i", options.quantity == Quantity::SurfaceIrradiance) else { return 0 };
    options.quantity = if on { Quantity::SurfaceIrradiance } else { Quantity::Radiance };
    1
}

/// Parses one option that Radiance's programs do not have: reading of scenes, permissions, and the
/// seed.
pub(crate) fn take_own(words: &[String], reading: &mut Reading, options: &mut RenderOptions) -> Result<usize, Failure> {
    let before = reading.plugin_guard.clone();
    let used = reading.plugin_guard.take(words)?;
    if used > 0 {
        if reading.trust.word_origin() == Origin::File && reading.plugin_guard.allows_more_than(&before) {
            return Err(Failure::input(format!(
                "option \"{}\" comes from a file and is refused\nhint: only the command line may raise limits of plugins",
                words[..used].join(" ")
            )));
        }
        return Ok(used);
    }
    let word = words[0].as_str();
    match word {
        "-af" => {
            let name: String = number(words, word, "a file for the irradiance cache")?;
            // As in Radiance, an empty name means no file.
            reading.ambient_file = match name.is_empty() {
                true => None,
                false => Some(reading.trust.output(&name, Existing::AmbientValues)?),
            };
        }
        "--seed" => options.seed = number(words, word, "a whole number")?,
        "--strict" => {
            reading.strict = true;
            return Ok(1);
        }
        _ => return reading.trust.take(words),
    }
    Ok(2)
}

/// Parses one option with definitions for all functions of the scene: `-f FILE`, or `-e TEXT` if
/// the text is a definition.
pub(crate) fn take_definition(words: &[String], reading: &mut Reading) -> Result<usize, Failure> {
    let word = words[0].as_str();
    let (name, text) = match (word, words.get(1)) {
        ("-f", _) => {
            let file: String = number(words, word, "a file of functions")?;
            let loaded = DiskLoader::new(Commands::Refused).load(&file, FileKind::Function);
            let loaded = loaded.map_err(|error| Failure::input(format!("option \"-f\": {error}")))?;
            (loaded.path, loaded.bytes)
        }
        ("-e", Some(text)) if text.contains(['=', ':']) => ("option -e".to_owned(), text.clone().into_bytes()),
        _ => return Ok(0),
    };
    let mut sources = SourceMap::default();
    let source = sources.add(name.as_str(), &text[..], None);
    let read = Definitions::with_initial_library().load(source, &text, &Scope::global());
    read.map_err(|mistakes| Failure::diagnostics(&mistakes, &sources))?;
    reading.definitions.push((name, text.into()));
    Ok(2)
}

/// The number after an option.
pub(crate) fn number<T: std::str::FromStr>(words: &[String], option: &str, expected: &str) -> Result<T, Failure> {
    let Some(text) = words.get(1) else {
        return Err(Failure::usage(format!("option \"{option}\" ends the command line, expected {expected} after it")));
    };
    let wrong = || Failure::usage(format!("option \"{option}\" is followed by \"{text}\", expected {expected}"));
    if is_no_digits(text) { Err(wrong()) } else { text.parse().map_err(|_| wrong()) }
}

/// Whether a word is the name of a number, such as "nan" or "-inf", which Radiance does not read.
fn is_no_digits(word: &str) -> bool {
    let name = word.trim_start_matches(['+', '-']);
    ["nan", "inf"].iter().any(|start| name.get(..3).is_some_and(|first| first.eq_ignore_ascii_case(start)))
}
