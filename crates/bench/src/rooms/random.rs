//! Pseudo-random numbers that are the same on every machine.

/// A sequence of pseudo-random numbers (SplitMix64, Steele, Lea and Flood 2014).
#[derive(Clone, Debug)]
pub(super) struct Random(u64);

impl Random {
    pub(super) fn new(seed: u64) -> Random {
        Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x726f_6f6d)
    }

    /// Uniform in 0…1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform between two numbers.
    pub(super) fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// Log-uniform between two numbers.
    pub(super) fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.next())
    }

    /// An integer from `low` to `high`, inclusive.
    pub(super) fn count(&mut self, low: usize, high: usize) -> usize {
        low + (self.next() * (high - low + 1) as f64) as usize
    }

    /// True with this probability.
    pub(super) fn is(&mut self, probability: f64) -> bool {
        self.next() < probability
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_cover_their_range_and_repeat_with_the_seed() {
        let draw = |seed| {
            let mut random = Random::new(seed);
            (0..4000).map(|_| random.uniform(2.0, 4.0)).collect::<Vec<f64>>()
        };
        let numbers = draw(7);
        let mean = numbers.iter().sum::<f64>() / 4000.0;
        assert!((mean - 3.0).abs() < 0.05 && numbers.iter().all(|number| (2.0..4.0).contains(number)), "{mean}");
        assert_eq!(draw(7), numbers);
        assert_ne!(draw(8), numbers);
        let mut random = Random::new(1);
        assert!((0..1000).map(|_| random.count(1, 3)).all(|count| (1..=3).contains(&count)));
    }
}
