//! The range of a colour scale.

/// The share of values that may lie outside either end of a scale.
const OUTLIERS: f64 = 0.002;

/// A scale whose ends differ by more than this factor is logarithmic.
const LOGARITHMIC_FROM: f64 = 50.0;

/// Largest number of decades of a logarithmic scale.
const MOST_DECADES: f64 = 6.0;

/// Approximate number of labels.
const LABELS: f64 = 5.0;

/// The range of a scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) spacing: Spacing,
}

/// The mapping of values to positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Spacing {
    Linear,
    Logarithmic,
}

impl Scale {
    /// A scale for nearly all of these values. Non-finite values are ignored.
    pub(crate) fn of(values: impl Iterator<Item = f32>) -> Scale {
        let mut values: Vec<f32> = values.filter(|value| value.is_finite()).collect();
        if values.is_empty() {
            return Scale { low: 0.0, high: 1.0, spacing: Spacing::Linear };
        }
        let high = quantile(&mut values, 1.0 - OUTLIERS);
        let low = quantile(&mut values, OUTLIERS);
        let mut positive: Vec<f32> = values.iter().copied().filter(|value| *value > 0.0).collect();
        let darkest = if positive.is_empty() { 0.0 } else { quantile(&mut positive, OUTLIERS) };
        if low >= 0.0 && darkest > 0.0 && high / darkest > LOGARITHMIC_FROM {
            let low = darkest.max(high * 10f64.powf(-MOST_DECADES));
            return Scale { low, high, spacing: Spacing::Logarithmic };
        }
        // A scale of non-negative values starts at zero, and its ends differ.
        let low = if low >= 0.0 && low < 0.5 * high { 0.0 } else { low };
        let high = if high > low { high } else { low + low.abs().max(f64::from(f32::MIN_POSITIVE)) };
        Scale { low, high, spacing: Spacing::Linear }
    }

    /// The position of a value, 0 at the low end and 1 at the high one; NaN for NaN.
    pub(crate) fn place(&self, value: f64) -> f64 {
        match self.spacing {
            Spacing::Linear => (value - self.low) / (self.high - self.low),
            // Values of 0 or less lie below the low end.
            Spacing::Logarithmic if value <= 0.0 => f64::NEG_INFINITY,
            Spacing::Logarithmic => (value / self.low).ln() / (self.high / self.low).ln(),
        }
    }

    /// Round values to label.
    pub(crate) fn ticks(&self) -> Vec<f64> {
        match self.spacing {
            Spacing::Linear => {
                let step = round_step((self.high - self.low) / LABELS);
                let first = (self.low / step - 1e-9).ceil() as i64;
                let last = (self.high / step + 1e-9).floor() as i64;
                (first..=last.min(first + 20)).map(|i| i as f64 * step).collect()
            }
            Spacing::Logarithmic => {
                let [first, last] = [self.low, self.high].map(|end| end.log10().floor() as i32);
                let factors: &[f64] = if last - first < 3 { &[1.0, 2.0, 5.0] } else { &[1.0] };
                let all = (first..=last).flat_map(|power| factors.iter().map(move |f| f * 10f64.powi(power)));
                all.filter(|tick| (-1e-9..=1.0 + 1e-9).contains(&self.place(*tick))).collect()
            }
        }
    }
}

/// 1, 2 or 5 times a power of ten, at least the step.
fn round_step(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    let factor = [1.0, 2.0, 5.0].into_iter().find(|factor| factor * power >= step).unwrap_or(10.0);
    factor * power
}

/// The value below which this share of the values lies; `values` is not empty.
pub(crate) fn quantile(values: &mut [f32], part: f64) -> f64 {
    let place = ((values.len() - 1) as f64 * part).round() as usize;
    f64::from(*values.select_nth_unstable_by(place, f32::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_extreme_values_do_not_stretch_a_scale() {
        let scale = Scale::of((0..10_000).map(|i| if i < 10 { 1e9 } else { 1.0 + i as f32 * 1e-4 }));
        assert!(scale.high < 2.1 && scale.low >= 0.0, "{scale:?}");
        assert_eq!(scale.spacing, Spacing::Linear);
    }

    #[test]
    fn many_decades_are_logarithmic_and_zero_is_below() {
        let scale = Scale::of((0..1000).map(|i| if i < 100 { 0.0 } else { 10f32.powf(i as f32 / 250.0) }));
        assert_eq!(scale.spacing, Spacing::Logarithmic);
        assert!(scale.place(0.0) < 0.0 && (scale.place(scale.high) - 1.0).abs() < 1e-12);
        assert!(scale.ticks().contains(&100.0));
    }

    #[test]
    fn equal_or_missing_values_have_a_scale_too() {
        for values in [vec![], vec![0.0; 4], vec![3.5; 4], vec![-2.0; 4], vec![f32::NAN, f32::INFINITY]] {
            let scale = Scale::of(values.iter().copied());
            assert!(scale.high > scale.low && scale.ticks().len() <= 21, "{scale:?}");
        }
    }

    #[test]
    fn labels_are_round_and_inside() {
        let scale = Scale { low: -0.3, high: 1.1, spacing: Spacing::Linear };
        let shown: Vec<f64> = scale.ticks().iter().map(|tick| (tick * 10.0).round() / 10.0).collect();
        assert_eq!(shown, [0.0, 0.5, 1.0]);
    }
}
