//! Time as a function of error.

/// The time to an error, and its origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TimeTo {
    /// Interpolated between two runs, or measured, s.
    Interpolated(f64),
    /// Even the cheapest run was more accurate: its time, s.
    AtMost(f64),
    /// No run was accurate enough.
    NotReached,
}

/// The Pareto-optimal runs of one kind: each more expensive one is more accurate than all cheaper
/// ones.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Curve {
    /// (error, time in s), time ascending and error descending.
    points: Vec<(f64, f64)>,
}

impl Curve {
    /// From (error, time in s) of runs in any order; non-positive values are skipped.
    pub(crate) fn new(runs: impl IntoIterator<Item = (f64, f64)>) -> Curve {
        let mut runs: Vec<(f64, f64)> = runs.into_iter().filter(|(error, time)| *error > 0.0 && *time > 0.0).collect();
        runs.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.total_cmp(&b.0)));
        let mut points: Vec<(f64, f64)> = Vec::new();
        for (error, time) in runs {
            if points.last().is_none_or(|last| error < last.0) {
                points.push((error, time));
            }
        }
        Curve { points }
    }

    /// The time to an error, by log-log linear interpolation between runs.
    pub(crate) fn time_to(&self, error: f64) -> TimeTo {
        let Some(next) = self.points.iter().position(|point| point.0 <= error) else { return TimeTo::NotReached };
        let (low_error, dear) = self.points[next];
        if low_error == error {
            return TimeTo::Interpolated(dear);
        }
        let Some((high_error, cheap)) = next.checked_sub(1).map(|before| self.points[before]) else {
            return TimeTo::AtMost(dear);
        };
        let share = (high_error / error).ln() / (high_error / low_error).ln();
        TimeTo::Interpolated((cheap.ln() + share * (dear / cheap).ln()).exp())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_is_interpolated_exactly() {
        // time = 2·error^-1.5
        let curve = Curve::new([0.1, 0.01, 0.001].map(|error: f64| (error, 2.0 * error.powf(-1.5))));
        for error in [0.07, 0.02, 0.003] {
            let TimeTo::Interpolated(time) = curve.time_to(error) else { panic!("{error} is within the curve") };
            assert!((time / (2.0 * error.powf(-1.5)) - 1.0).abs() < 1e-12, "{error}: {time}");
        }
        assert_eq!(curve.time_to(0.01), TimeTo::Interpolated(2.0 * 0.01f64.powf(-1.5)));
    }

    #[test]
    fn nothing_is_extrapolated_past_the_runs() {
        let curve = Curve::new([(0.01, 4.0), (0.02, 1.0)]);
        assert_eq!(curve.time_to(0.5), TimeTo::AtMost(1.0));
        assert_eq!(curve.time_to(0.009), TimeTo::NotReached);
        assert_eq!(Curve::new([]).time_to(0.1), TimeTo::NotReached);
    }

    #[test]
    fn a_run_that_does_not_pay_is_left_out() {
        let curve = Curve::new([(0.02, 2.0), (0.03, 3.0), (0.01, 4.0), (f64::NAN, 1.0), (0.0, 9.0)]);
        assert_eq!(curve, Curve::new([(0.02, 2.0), (0.01, 4.0)]));
    }
}
