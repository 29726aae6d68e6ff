//! Random numbers that are the same on every machine.

/// A sequence of random numbers (SplitMix64, Steele, Lea and Flood 2014).
#[derive(Clone, Debug)]
pub(super) struct Chance(u64);

impl Chance {
    pub(super) fn new(seed: u64) -> Chance {
        Chance(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x726f_6f6d)
    }

    /// Evenly distributed in 0…1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Evenly distributed between two numbers.
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// The logarithm of which is evenly distributed between those of two numbers.
    pub(super) fn scaled(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.next())
    }

    /// A whole number from `low` to `high`, both among them.
    pub(super) fn count(&mut self, low: usize, high: usize) -> usize {
        low + (self.next() * (high - low + 1) as f64) as usize
    }

    /// Whether something is so that is so with this probability.
    pub(super) fn is(&mut self, probability: f64) -> bool {
        self.next() < probability
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_spread_over_their_range_and_repeat_with_the_seed() {
        let draw = |seed| {
            let mut chance = Chance::new(seed);
            (0..4000).map(|_| chance.between(2.0, 4.0)).collect::<Vec<f64>>()
        };
        let numbers = draw(7);
        let mean = numbers.iter().sum::<f64>() / 4000.0;
        assert!((mean - 3.0).abs() < 0.05 && numbers.iter().all(|number| (2.0..4.0).contains(number)), "{mean}");
        assert_eq!(draw(7), numbers);
        assert_ne!(draw(8), numbers);
        let mut chance = Chance::new(1);
        assert!((0..1000).map(|_| chance.count(1, 3)).all(|count| (1..=3).contains(&count)));
    }
}
