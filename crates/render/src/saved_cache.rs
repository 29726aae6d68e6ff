//! Saves and loads the irradiance cache as bytes.
//!
//! The bytes begin with everything on which the irradiance depends: an identifier of the scene
//! given by the caller, and the options that affect the expected value. A cache of another scene or
//! other options is refused. Options that affect only the accuracy (`-ad`, `-as`, `-aa`, `-ar`,
//! `-lw` and similar) may differ, as in Radiance.

use crate::cache_prepass::GatheredIrradiance;
use crate::checksum::checksum;
use radsight_compile::{RenderOptions, RenderPlan};
use radsight_irradiance_cache::{Stored, StoredBytes};
use std::fmt;

/// First bytes, with the version of the format.
const MAGIC: &[u8] = b"radsight irradiance cache 2\n";

/// Why a saved irradiance cache cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CacheError {
    /// The bytes are not an irradiance cache, or one of another version.
    Unknown,
    /// The bytes are truncated or changed.
    Damaged,
    /// The cache belongs to another scene.
    OtherScene,
    /// The cache was made with another option.
    OtherOptions {
        /// The option in the cache.
        saved: String,
        /// The option here.
        here: String,
    },
}

impl fmt::Display for CacheError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CacheError::Unknown => formatter.write_str("it is not an irradiance cache of this version of radsight"),
            CacheError::Damaged => formatter.write_str("it is cut short or damaged"),
            CacheError::OtherScene => formatter.write_str("it was made of another scene"),
            CacheError::OtherOptions { saved, here } => {
                write!(formatter, "it was made with \"{saved}\", expected \"{here}\"")
            }
        }
    }
}

impl std::error::Error for CacheError {}

/// The bytes of gathered irradiance.
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

/// Loads a saved cache, and keeps irradiance gathered here since the last save or load where no
/// loaded record reaches. Returns the resulting number of records.
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
    // Equal scenes and options have equal numbers of bands.
    if u32::restore(&mut stored) != Some(BANDS as u32) {
        return Err(CacheError::Damaged);
    }
    let mut loaded = GatheredIrradiance::restored(plan, &mut stored).ok_or(CacheError::Damaged)?;
    if !stored.is_empty() {
        return Err(CacheError::Damaged);
    }
    if let Some(own) = gathered.take() {
        loaded.merge(plan, own);
    }
    let records = loaded.len();
    *gathered = Some(loaded);
    Ok(records)
}

/// The options that affect the expected value, one per line.
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

/// The first option that differs.
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
        // Options that affect only the accuracy may differ.
        let mut finer = options.clone();
        finer.gathering.divisions *= 2;
        finer.seed += 1;
        assert_eq!(settings(&finer), settings(&options));
    }
}
