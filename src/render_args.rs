//! Radiance's options of rendering, which begin with one dash and two letters.
//!
//! The options with which Radiance steers its approximations of direct light and highlights are accepted and change nothing:
//! radsight computes those integrals.

use crate::args::Reading;
use crate::failure::Failure;
use crate::switch::switched;
use radsight_render::{BackFaces, RenderOptions};

/// Options with one number that steer approximations which radsight does not make.
const WITHOUT_EFFECT: [&str; 9] = ["-ds", "-dj", "-dt", "-dc", "-dp", "-ss", "-st", "-lr", "-lw"];

/// Ambient options with one number that steer Radiance's interpolation of indirect light.
const AMBIENT_WITHOUT_EFFECT: [&str; 5] = ["-aa", "-ar", "-ad", "-as", "-aw"];

/// Options of Radiance's that nothing here does, unless their numbers are all zero.
const ONLY_ZERO: [(&str, usize, &str); 6] = [
    ("-av", 3, "a constant ambient light"),
    ("-me", 3, "a medium around everything"),
    ("-ma", 3, "a medium around everything"),
    ("-mg", 1, "a medium around everything"),
    ("-ms", 1, ""),
    ("-am", 1, "a photon map"),
];

/// Takes the options of rendering out of a command line and gives them with what is left.
///
/// Commands whose own arguments could look like such options do not come here.
pub(crate) fn take(words: &[String]) -> Result<(RenderOptions, Vec<String>), Failure> {
    let mut options = RenderOptions::default();
    let mut rest = Vec::new();
    let mut at = 0;
    while at < words.len() {
        let used = take_one(&words[at..], &mut options)?;
        if used == 0 {
            rest.push(words[at].clone());
        }
        at += used.max(1);
    }
    Ok((options, rest))
}

/// Takes one option of rendering from the front; gives how many words it used, 0 for something else.
pub(crate) fn take_one(words: &[String], options: &mut RenderOptions) -> Result<usize, Failure> {
    let word = words[0].as_str();
    if let Some(visible) = switched(word, "-bv", options.back_faces == BackFaces::Visible) {
        options.back_faces = if visible { BackFaces::Visible } else { BackFaces::Invisible };
        return Ok(1);
    }
    match word {
        "-ab" => {
            options.ambient_bounces = number(words, word, "a number of bounces, 0 or more")?;
            Ok(2)
        }
        "-dr" => {
            options.mirror_relays = number(words, word, "a number of relays, 0 or more")?;
            Ok(2)
        }
        "-af" => number::<String>(words, word, "a file for ambient values").map(|_| 2),
        _ if WITHOUT_EFFECT.contains(&word) || AMBIENT_WITHOUT_EFFECT.contains(&word) => {
            let _: f64 = number(words, word, "a number")?;
            Ok(2)
        }
        "-dv+" | "-dv1" | "-u" | "-u+" | "-u-" | "-u1" | "-u0" => Ok(1),
        _ => match ONLY_ZERO.iter().find(|(name, ..)| *name == word) {
            Some((_, count, what)) => only_zero(words, *count, what),
            None => Ok(0),
        },
    }
}

fn only_zero(words: &[String], count: usize, what: &str) -> Result<usize, Failure> {
    for offset in 0..count {
        let value: f64 = number(&words[offset.min(words.len() - 1)..], &words[0], "a number")?;
        if value != 0.0 && !what.is_empty() {
            return Err(Failure::usage(format!("option \"{}\" with {value}: {what} is not supported", words[0])));
        }
    }
    Ok(1 + count)
}

/// Takes one option of ours that Radiance's programs do not have: how scenes are read, and the seed.
pub(crate) fn take_own(words: &[String], reading: &mut Reading, options: &mut RenderOptions) -> Result<usize, Failure> {
    let word = words[0].as_str();
    match word {
        "--seed" => options.seed = number(words, word, "a whole number")?,
        "--allow-commands" => reading.allow_commands = true,
        "--strict" => reading.strict = true,
        "--brdf" => reading.brdf.push(number(words, word, "a value")?),
        "--plugin-path" => reading.plugin_path.push(number(words, word, "a folder")?),
        _ => return Ok(0),
    }
    Ok(if matches!(word, "--allow-commands" | "--strict") { 1 } else { 2 })
}

/// The number after an option.
pub(crate) fn number<T: std::str::FromStr>(words: &[String], option: &str, expected: &str) -> Result<T, Failure> {
    let Some(text) = words.get(1) else {
        return Err(Failure::usage(format!("option \"{option}\" ends the command line, expected {expected} after it")));
    };
    text.parse()
        .map_err(|_| Failure::usage(format!("option \"{option}\" is followed by \"{text}\", expected {expected}")))
}
