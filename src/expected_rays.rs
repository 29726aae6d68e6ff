//! How many camera rays a picture takes, about, before the first is traced: the plan chooses
//! hierarchies by it.

/// The noise of a single ray, as a share, that is assumed before anything is known of a scene.
const NOISE_OF_A_RAY: f64 = 0.5;

/// Rays of a pixel whose error is asked for.
const FEWEST: f64 = 4.0;

/// More are never expected: what is expected is to be worth it if the picture is done sooner.
const MOST: f64 = 1024.0;

/// For so many pixels whose error is asked for, as a share.
pub(crate) fn to_error(pixels: u64, error: f64) -> f64 {
    pixels as f64 * (NOISE_OF_A_RAY / error).powi(2).clamp(FEWEST, MOST)
}
