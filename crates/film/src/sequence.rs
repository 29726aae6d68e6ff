//! How the rays of pixels are numbered.

/// Number of bits of a ray's number that count the samples of a pixel.
pub(crate) const SEQUENCE_LOG2: u32 = 16;

/// Maximum number of samples of a pixel: the length of one scrambled sequence.
pub const MAX_SAMPLES: u32 = 1 << SEQUENCE_LOG2;
