//! The irradiance cache as bytes: saved for other runs, and taken over from them.
//!
//! The bytes begin with what the irradiance depends on: the scene, by a number that the caller makes of it, and the options that decide
//! which light is counted. A cache of another scene or other options is refused. Options that decide how well it is found (`-ad`, `-as`,
//! `-aa`, `-ar`, `-lw` and their kin) may differ, as in Radiance: what is cached is as good as it was made.

use crate::cache_prepass::GatheredIrradiance;
use crate::checksum::checksum;
use radsight_compile::{RenderOptions, RenderPlan};
use radsight_irradiance_cache::{Stored, StoredBytes};
use std::fmt;

/// What the bytes begin with; the number changes with what follows.
const MAGIC: &[u8] = b"radsight irradiance cache 1\n";

/// Why a saved irradiance cache cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CacheError {
    /// The bytes are none of an irradiance cache, or of one of another version.
    Unknown,
    /// They are cut short or changed.
    Damaged,
    /// It was made of another scene.
    OtherScene,
    /// It was made with another option.
    OtherOptions {
        /// As it was.
        saved: String,
        /// As it is here.
        here: String,
    },
}

impl fmt::Display for CacheError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CacheError::Unknown => formatter.write_str("it is no irradiance cache of this version of radsight"),
            CacheError::Damaged => formatter.write_str("it is cut short or damaged"),
            CacheError::OtherScene => formatter.write_str("it was made of another scene"),
            CacheError::OtherOptions { saved, here } => {
                write!(formatter, "it was made with \"{saved}\", expected \"{here}\"")
            }
        }
    }
}

impl std::error::Error for CacheError {}

/// The bytes of what was gathered.
pub(crate) fn save<const BANDS: usize>(
    plan: &RenderPlan,
    gathered: &mut Option<GatheredIrradiance<BANDS>>,
    scene: u64,
) -> Option<Vec<u8>> {
    let gathered = gathered.as_mut()?;
    let mut bytes = MAGIC.to_vec();
    scene.store(&mut bytes);
    let settings = settings(&plan.options);
    (settings.len() as u64).store(&mut bytes);
    bytes.extend_from_slice(settings.as_bytes());
    (BANDS as u32).store(&mut bytes);
    gathered.save(&mut bytes);
    checksum(&bytes).store(&mut bytes);
    Some(bytes)
}

/// Takes over what was saved, and keeps what was gathered here since this was last saved or loaded where it has nothing. Says how many records
/// there are then.
pub(crate) fn load<const BANDS: usize>(
    plan: &RenderPlan,
    gathered: &mut Option<GatheredIrradiance<BANDS>>,
    bytes: &[u8],
    scene: u64,
) -> Result<usize, CacheError> {
    let body = bytes.strip_prefix(MAGIC).ok_or(CacheError::Unknown)?;
    let (_, sum) = bytes.split_last_chunk::<8>().ok_or(CacheError::Damaged)?;
    if u64::from_le_bytes(*sum) != checksum(&bytes[..bytes.len() - sum.len()]) {
        return Err(CacheError::Damaged);
    }
    let mut stored = StoredBytes::new(&body[..body.len() - sum.len()]);
    let saved_scene = u64::restore(&mut stored).ok_or(CacheError::Damaged)?;
    let length = u64::restore(&mut stored).and_then(|length| usize::try_from(length).ok());
    let saved = length.and_then(|length| stored.take(length)).ok_or(CacheError::Damaged)?;
    check_settings(&String::from_utf8_lossy(saved), &settings(&plan.options))?;
    if saved_scene != scene {
        return Err(CacheError::OtherScene);
    }
    // The same scene and options have as many bands.
    if u32::restore(&mut stored) != Some(BANDS as u32) {
        return Err(CacheError::Damaged);
    }
    let mut loaded = GatheredIrradiance::restored(plan, &mut stored).ok_or(CacheError::Damaged)?;
    if !stored.is_empty() {
        return Err(CacheError::Damaged);
    }
    if let Some(own) = gathered.take() {
        loaded.take_over(own);
    }
    let records = loaded.len();
    *gathered = Some(loaded);
    Ok(records)
}

/// The options that decide which light is counted, one a line.
fn settings(options: &RenderOptions) -> String {
    let RenderOptions { ambient_value, medium, sampling, .. } = options;
    let color = |color: radsight_ir::Rgb| color.0.map(|band| band.to_string()).join(" ");
    let splits = sampling.splits_nm().map(|split| split.to_string()).join(" ");
    [
        format!("-ab {}", options.ambient_bounces),
        format!("-av {}", color(*ambient_value)),
        format!("-me {}", color(medium.extinction)),
        format!("-ma {}", color(medium.albedo)),
        format!("-mg {}", medium.eccentricity),
        format!("-ae/-ai {:?}", options.ambient_surfaces),
        format!("-bv {:?}", options.back_faces),
        format!("-dv {:?}", options.lights),
        format!("-cs {} -cw {splits}", sampling.bands()),
    ]
    .join("\n")
}

/// Tells the first option that differs.
fn check_settings(saved: &str, here: &str) -> Result<(), CacheError> {
    let mut lines = saved.lines().zip(here.lines());
    match lines.find(|(saved, here)| saved != here) {
        Some((saved, here)) => Err(CacheError::OtherOptions { saved: saved.to_owned(), here: here.to_owned() }),
        None if saved == here => Ok(()),
        None => Err(CacheError::Damaged),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_option_that_differs_is_told() {
        let options = RenderOptions { ambient_bounces: 2, ..RenderOptions::default() };
        let other = RenderOptions { ambient_bounces: 3, ..RenderOptions::default() };
        let error = check_settings(&settings(&options), &settings(&other)).unwrap_err();
        assert_eq!(error.to_string(), "it was made with \"-ab 2\", expected \"-ab 3\"");
        assert_eq!(check_settings(&settings(&options), &settings(&options)), Ok(()));
        // What decides how well irradiance is found may differ.
        let mut finer = options.clone();
        finer.gathering.divisions *= 2;
        finer.seed += 1;
        assert_eq!(settings(&finer), settings(&options));
    }
}
