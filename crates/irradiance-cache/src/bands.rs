//! Values by band.

/// The mean of the bands.
pub(crate) fn mean<const BANDS: usize>(bands: &[f64; BANDS]) -> f64 {
    bands.iter().sum::<f64>() / BANDS as f64
}
