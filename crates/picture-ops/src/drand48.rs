//! The generator of random numbers that Radiance's picture programs use, so that what they draw is drawn here too.

/// The 48-bit congruential generator of C's `drand48`, from the state of a program that never seeds it.
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

    /// A whole number of 31 bits, as `lrand48` gives it.
    pub(crate) fn next_integer(&mut self) -> u64 {
        self.advance() >> 17
    }

    /// A number from 0, below 1.
    pub(crate) fn next_fraction(&mut self) -> f64 {
        self.advance() as f64 / (1u64 << BITS) as f64
    }
}
