//! Radiance's options of rendering, which begin with one dash and two letters.
//!
//! The options with which Radiance steers its approximations of direct light and highlights are accepted and change nothing:
//! radsight computes those integrals.

use crate::failure::Failure;
use radsight_render::{BackFaces, RenderOptions};

/// Options with one number that steer approximations which radsight does not make.
const WITHOUT_EFFECT: [&str; 9] = ["-ds", "-dj", "-dt", "-dc", "-dp", "-ss", "-st", "-lr", "-lw"];

/// Ambient options with one number that steer Radiance's interpolation of indirect light.
const AMBIENT_WITHOUT_EFFECT: [&str; 4] = ["-aa", "-ar", "-ad", "-as"];

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
    match word {
        "-ab" => {
            options.ambient_bounces = number(words, word, "a number of bounces, 0 or more")?;
            Ok(2)
        }
        "-dr" => {
            options.mirror_relays = number(words, word, "a number of relays, 0 or more")?;
            Ok(2)
        }
        "-bv" | "-bv+" | "-bv-" => {
            options.back_faces = if word == "-bv-" { BackFaces::Invisible } else { BackFaces::Visible };
            Ok(1)
        }
        "-av" => {
            for offset in 1..=3 {
                let value: f64 = number(&words[offset.min(words.len()) - 1..], word, "three radiances")?;
                if value != 0.0 {
                    return Err(Failure::usage(format!(
                        "option \"-av\" with {value}: a constant ambient light is not supported"
                    )));
                }
            }
            Ok(4)
        }
        _ if WITHOUT_EFFECT.contains(&word) || AMBIENT_WITHOUT_EFFECT.contains(&word) => {
            let _: f64 = number(words, word, "a number")?;
            Ok(2)
        }
        "-dv" | "-dv+" => Ok(1),
        _ => Ok(0),
    }
}

/// The number after an option.
pub(crate) fn number<T: std::str::FromStr>(words: &[String], option: &str, expected: &str) -> Result<T, Failure> {
    let Some(text) = words.get(1) else {
        return Err(Failure::usage(format!("option \"{option}\" ends the command line, expected {expected} after it")));
    };
    text.parse()
        .map_err(|_| Failure::usage(format!("option \"{option}\" is followed by \"{text}\", expected {expected}")))
}
