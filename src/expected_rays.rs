//! The expected number of camera rays of a picture, from which the plan chooses the builder of
//! hierarchies.

/// Assumed relative noise of a single ray, before the scene is known.
const NOISE_OF_A_RAY: f64 = 0.5;

/// Least number of rays of a pixel with a requested error.
const FEWEST: f64 = 4.0;

/// Largest expected number, so that the hierarchy pays even if the picture ends early.
const MOST: f64 = 1024.0;

/// Expected rays for this number of pixels and this requested relative error.
pub(crate) fn to_error(pixels: u64, error: f64) -> f64 {
    pixels as f64 * (NOISE_OF_A_RAY / error).powi(2).clamp(FEWEST, MOST)
}
