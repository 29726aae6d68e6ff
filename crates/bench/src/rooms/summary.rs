//! The summary of all rooms, by requested error.
//!
//! The squared error of a room is known without bias, but with noise. A room counts as reached or
//! exceeded if its interval says so; otherwise it is undecided. Undecided rooms count on both sides
//! of the bounds of the fraction of rooms. The mean squared error includes all rooms.

use super::Row;
use super::comparison::CONFIDENCE;
use super::real_radiance::TimeRatio;

/// The position of an error relative to the requested one, with 95 % confidence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    AtOrBelow,
    Above,
    /// The references are too noisy to decide.
    Undecided,
}

/// For each requested error, and for all: how many rooms reached it, the error of the others, and
/// whether reported errors are true.
pub(super) fn summary(rows: &[Row], errors: &[f64]) -> String {
    let of_error = |error: &f64| {
        let rows: Vec<&Row> = rows.iter().filter(|row| row.requested == *error).collect();
        of_rows(&format!("requested {} %", 100.0 * error), &rows)
    };
    let all: Vec<&Row> = rows.iter().collect();
    errors.iter().map(of_error).collect::<String>() + &of_rows("all", &all)
}

fn of_rows(name: &str, rows: &[&Row]) -> String {
    let count = |verdict: Verdict| rows.iter().filter(|row| row.verdict() == verdict).count();
    let [below, above, open] = [Verdict::AtOrBelow, Verdict::Above, Verdict::Undecided].map(count);
    let [low, _] = wilson(below as f64, rows.len());
    let [_, high] = wilson((below + open) as f64, rows.len());
    let silent = rows.iter().filter(|row| row.verdict() == Verdict::Above && row.stopped.is_empty()).count();
    let agreeing = rows.iter().filter(|row| row.agrees()).count();
    let relative = |row: &&Row, squared: f64| squared / row.requested.powi(2);
    let found: Vec<f64> = rows.iter().map(|row| relative(row, row.found.pixels.value)).collect();
    let reported: Vec<f64> =
        rows.iter().map(|row| row.reported.map_or(0.0, |[error, _]| relative(row, error * error))).collect();
    let [mean, deviation] = ratio_of_means(&found, &vec![1.0; found.len()]).map(|number| 100.0 * number);
    let [calibration, uncertainty] = ratio_of_means(&reported, &found);
    let ratios = quantiles(found.iter().map(|squared| squared.max(0.0).sqrt()).collect());
    let seconds = quantiles(rows.iter().map(|row| row.seconds).collect());
    let times: Vec<f64> = rows.iter().filter_map(|row| row.real).map(TimeRatio::value).collect();
    let unreached = rows.iter().filter(|row| matches!(row.real, Some(TimeRatio::MoreThan(_)))).count();
    let beside = if times.is_empty() {
        String::new()
    } else {
        let count = times.len();
        let [least, median, _, most] = quantiles(times);
        format!(
            "  real Radiance takes: least {least:.2}, median {median:.1}, most {most:.1} times as long in {count} pictures; in \
             {unreached} it does not come there, and this is the dearest that was tried\n"
        )
    };
    format!(
        "{name}: {below} of {} rooms surely at or below, {above} surely above ({silent} of them without a word), {open} open: \
         {:.0} to {:.0} % of rooms\n  error over the requested one: least {:.2}, median {:.2}, 90 % {:.2}, most {:.2}; \
         mean square {mean:.0} ± {deviation:.0} % of the requested one's\n  reported square over the true one: \
         {calibration:.2} ± {uncertainty:.2}; {agreeing} reported what is there\n  \
         processor time: least {:.2}, median {:.2}, 90 % {:.2}, most {:.2} s\n{beside}",
        rows.len(),
        100.0 * low,
        100.0 * high,
        ratios[0],
        ratios[1],
        ratios[2],
        ratios[3],
        seconds[0],
        seconds[1],
        seconds[2],
        seconds[3],
    )
}

/// The 95 % confidence interval of a fraction of which `found` of `count` were found (Wilson 1927).
pub(super) fn wilson(found: f64, count: usize) -> [f64; 2] {
    let count = count as f64;
    if count < 1.0 {
        return [0.0, 1.0];
    }
    let (share, squared) = (found / count, CONFIDENCE * CONFIDENCE);
    let middle = (share + 0.5 * squared / count) / (1.0 + squared / count);
    let half = (CONFIDENCE / (1.0 + squared / count))
        * (share * (1.0 - share) / count + 0.25 * squared / (count * count)).sqrt();
    [(middle - half).max(0.0), (middle + half).min(1.0)]
}

/// The ratio of two means over the same rooms, and the half width of its 95 % confidence interval;
/// NaN if the second is 0.
fn ratio_of_means(above: &[f64], below: &[f64]) -> [f64; 2] {
    let whole: f64 = below.iter().sum();
    let ratio = above.iter().sum::<f64>() / whole;
    let squares: f64 = above.iter().zip(below).map(|(above, below)| (above - ratio * below).powi(2)).sum();
    let count = above.len() as f64;
    let few = (count / (count - 1.0).max(1.0)).sqrt();
    [ratio, CONFIDENCE * few * squares.sqrt() / whole.abs()]
}

/// Minimum, median, 90th percentile and maximum.
pub(super) fn quantiles(mut values: Vec<f64>) -> [f64; 4] {
    values.sort_by(f64::total_cmp);
    let last = values.len().saturating_sub(1);
    [0.0, 0.5, 0.9, 1.0].map(|share| values.get((share * last as f64).ceil() as usize).copied().unwrap_or(f64::NAN))
}

#[cfg(test)]
mod tests {
    use super::super::random::Random;
    use super::*;

    #[test]
    fn a_wilson_interval_contains_the_fraction_and_stays_in_range() {
        let mut random = Random::new(1);
        let held = (0..1000)
            .filter(|_| {
                let found = (0..40).filter(|_| random.is(0.9)).count();
                let [low, high] = wilson(found as f64, 40);
                low <= 0.9 && 0.9 <= high
            })
            .count();
        assert!((930..=980).contains(&held), "{held} of 1000");
        let [low, high] = wilson(20.0, 20);
        assert!(low > 0.8 && (high - 1.0).abs() < 1e-12, "{low} to {high}");
        assert_eq!(wilson(0.0, 0), [0.0, 1.0]);
    }

    #[test]
    fn the_interval_of_a_ratio_of_means_contains_the_true_ratio() {
        let mut random = Random::new(2);
        let held = (0..500)
            .filter(|_| {
                let below: Vec<f64> = (0..30).map(|_| random.uniform(0.2, 1.8)).collect();
                let above: Vec<f64> = below.iter().map(|below| 0.8 * below + random.uniform(-0.5, 0.5)).collect();
                let [ratio, half] = ratio_of_means(&above, &below);
                (ratio - 0.8).abs() <= half
            })
            .count();
        assert!((450..=490).contains(&held), "{held} of 500");
    }

    #[test]
    fn quantiles_are_given_values() {
        assert_eq!(quantiles((1..=11).rev().map(f64::from).collect()), [1.0, 6.0, 10.0, 11.0]);
        assert!(quantiles(Vec::new())[0].is_nan());
    }
}
