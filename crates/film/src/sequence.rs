//! How the rays of pixels are numbered.

/// Bits of a ray's number that tell the samples of a pixel.
pub(crate) const SEQUENCE_LOG2: u32 = 16;

/// No pixel gets more samples: what one scramble of the sequence holds.
pub const MAX_SAMPLES: u32 = 1 << SEQUENCE_LOG2;
