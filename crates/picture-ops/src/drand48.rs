//! The random number generator of Radiance's picture programs, so that samples are the same.

/// The 48-bit congruential generator of C's `drand48` in its initial state, as in a program that
/// never seeds it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Drand48 {
    state: u64,
}

const BITS: u32 = 48;

impl Drand48 {
    fn advance(&mut self) -> u64 {
        self.state = (self.state.wrapping_mul(0x5_deec_e66d) + 0xb) & ((1 << BITS) - 1);
        self.state
    }

    /// A 31-bit integer, as from `lrand48`.
    pub(crate) fn next_integer(&mut self) -> u64 {
        self.advance() >> 17
    }

    /// A number in [0, 1).
    pub(crate) fn next_fraction(&mut self) -> f64 {
        self.advance() as f64 / (1u64 << BITS) as f64
    }
}
