//! Pseudo-random numbers.

use glam::DVec3;

/// Pseudo-random numbers that are the same on every run.
///
/// ```
/// use radsight_test_support::Random;
/// assert_eq!(Random(7).number(), Random(7).number());
/// ```
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// In [0, 1). SplitMix64 (Steele, Lea and Flood, OOPSLA 2014).
    pub fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A unit vector, uniform over the sphere.
    pub fn direction(&mut self) -> DVec3 {
        let z = 2.0 * self.number() - 1.0;
        let (sine, cosine) = (std::f64::consts::TAU * self.number()).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        DVec3::new(radius * cosine, radius * sine, z)
    }
}
