//! Numbers of rays, for the renderer's random numbers.

use super::{ParameterStep, RANDOMISATIONS};
use radsight_adaptive::ray_number;

/// Number of terms of a pixel, each with samples of its own.
pub(super) const TERMS: usize = 4;

/// Maximum number of passes over a film.
pub(super) const MAX_FILM_PASSES: usize = 24;

/// Sequences of each pixel: outlines, and for each randomisation one of each term.
const PIXEL_SEQUENCES: u64 = 1 + (TERMS as u64) * RANDOMISATIONS as u64;

/// The same with those of passes over a film, and of the error of the step there.
const SEQUENCES: u64 = PIXEL_SEQUENCES + (MAX_FILM_PASSES as u64 + 1) * RANDOMISATIONS as u64;

impl ParameterStep<'_> {
    /// The number of a sample's ray, for the renderer's random numbers.
    pub(super) fn index(&self, sequence: u64, pixel: u64, sample: u32) -> u64 {
        let cells = self.center.rays.camera().pixel_count();
        let block = (u64::from(self.stream) * SEQUENCES + sequence) * cells + pixel;
        ray_number(block, sample)
    }

    /// The same for a sequence of the passes over a film.
    pub(super) fn index_of_pass(&self, sequence: u64, stratum: u64, sample: u32) -> u64 {
        self.index(PIXEL_SEQUENCES + sequence, stratum, sample)
    }
}
