//! Mean and deviation of the same sensors over several runs.

/// Statistics of a row of sensors over several runs.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Spread {
    /// Of each sensor.
    means: Vec<f64>,
    /// Of a single run of each sensor, in the unit of the mean.
    deviations: Vec<f64>,
    runs: usize,
}

impl Spread {
    /// `runs` hold one value per sensor each; `None` if there are fewer than two or their lengths
    /// differ.
    pub(super) fn new(runs: &[Vec<f64>]) -> Option<Spread> {
        let sensors = runs.first()?.len();
        if runs.len() < 2 || runs.iter().any(|run| run.len() != sensors) {
            return None;
        }
        let count = runs.len() as f64;
        let of = |sensor: usize| runs.iter().map(move |run| run[sensor]);
        let means: Vec<f64> = (0..sensors).map(|sensor| of(sensor).sum::<f64>() / count).collect();
        let deviation = |sensor: usize| {
            (of(sensor).map(|value| (value - means[sensor]).powi(2)).sum::<f64>() / (count - 1.0)).sqrt()
        };
        Some(Spread { deviations: (0..sensors).map(deviation).collect(), means, runs: runs.len() })
    }

    /// The relative deviation of one sensor in one run: rms over the sensors.
    pub(super) fn deviation(&self) -> f64 {
        let squares = self.deviations.iter().zip(&self.means).map(|(deviation, mean)| (deviation / mean).powi(2));
        (squares.sum::<f64>() / self.means.len() as f64).sqrt()
    }

    /// The mean deviation of the sensors from a truth, relative to it, and its standard error; both
    /// include the truth's noise.
    pub(super) fn excess(&self, truth: &Spread) -> [f64; 2] {
        let count = self.means.len() as f64;
        let shares = self.means.iter().zip(&truth.means).map(|(mean, truth)| mean / truth - 1.0);
        let squares: f64 = [self, truth]
            .iter()
            .flat_map(|spread| {
                let runs = spread.runs as f64;
                spread.deviations.iter().zip(&truth.means).map(move |(own, truth)| (own / truth).powi(2) / runs)
            })
            .sum();
        [shares.sum::<f64>() / count, squares.sqrt() / count]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviations_are_of_single_runs_and_excesses_of_the_mean() {
        let spread = Spread::new(&[vec![9.0, 90.0], vec![11.0, 110.0]]).unwrap();
        assert!((spread.deviation() - 2f64.sqrt() / 10.0).abs() < 1e-12);
        let exact = Spread::new(&[vec![8.0, 80.0], vec![8.0, 80.0]]).unwrap();
        let [excess, uncertainty] = spread.excess(&exact);
        assert!((excess - 0.25).abs() < 1e-12);
        // Two sensors of two runs each, with a deviation of √2/8.
        assert!((uncertainty - (2.0 * (2.0 / 64.0) / 2.0_f64).sqrt() / 2.0).abs() < 1e-12);
    }

    #[test]
    fn one_run_has_no_deviation() {
        assert_eq!(Spread::new(&[vec![1.0]]), None);
        assert_eq!(Spread::new(&[vec![1.0], vec![1.0, 2.0]]), None);
    }
}
