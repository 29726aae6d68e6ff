//! Random numbers of unit tests.

/// Numbers in [0, 1), the same on every run (a linear congruential generator).
pub(crate) fn numbers(seed: u32) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1_u32 << 24)
    }
}
