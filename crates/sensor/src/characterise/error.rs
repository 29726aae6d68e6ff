//! Why a characterisation is impossible.

/// Why a characterisation is impossible.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CharacterisationError {
    /// There are too few pixels or pictures for statistics.
    #[error("{columns} x {rows} pixels: expected at least 8 x 8, 8 steps and stacks of 4 pictures")]
    TooLittle {
        /// Number of columns.
        columns: u32,
        /// Number of rows.
        rows: u32,
    },
    /// The sensor does not saturate: the grey level keeps rising, or does not rise at all.
    #[error("the sensor does not saturate with {photons:e} photons per pixel")]
    NoSaturation {
        /// Largest number of photons that was tried.
        photons: f64,
    },
    /// The grey level does not rise with light, or does not fluctuate.
    #[error("the temporal variance does not rise with the mean, expected photon noise")]
    NoPhotonNoise,
}
