//! Confidence intervals.

/// Confidence level of every interval in this crate.
pub const CONFIDENCE: f64 = 0.99;

/// Standard normal quantile of (1 + [`CONFIDENCE`])/2.
pub(crate) const NORMAL_QUANTILE: f64 = 2.575_829_303_548_901;

/// A value with its 99 % confidence interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Best value.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl Estimate {
    /// Interval from a standard error, for a normal distribution.
    #[must_use]
    pub fn normal(value: f64, standard_error: f64) -> Estimate {
        let half = NORMAL_QUANTILE * standard_error;
        Estimate { value, low: value - half, high: value + half }
    }

    /// Interval from a standard error that was estimated with `degrees` degrees of freedom.
    #[must_use]
    pub fn student(value: f64, standard_error: f64, degrees: f64) -> Estimate {
        let half = student_quantile(degrees) * standard_error;
        Estimate { value, low: value - half, high: value + half }
    }

    /// Interval of a standard deviation whose square is `scale·(mean_square − excess)`, where
    /// `mean_square` is chi-squared with `degrees` degrees of freedom and `excess` is known much
    /// more precisely. Clamped at 0.
    #[must_use]
    pub fn deviation(mean_square: f64, degrees: f64, excess: f64, scale: f64) -> Estimate {
        let root = |square: f64| (scale * (square - excess)).max(0.0).sqrt();
        Estimate {
            value: root(mean_square),
            low: root(mean_square * degrees / chi_squared_quantile(degrees, NORMAL_QUANTILE)),
            high: root(mean_square * degrees / chi_squared_quantile(degrees, -NORMAL_QUANTILE)),
        }
    }

    /// Whether the interval contains a value.
    #[must_use]
    pub fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// The same in another unit.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Estimate {
        Estimate { value: self.value * factor, low: self.low * factor, high: self.high * factor }
    }

    /// The same in another unit, for a conversion factor with a relative standard error of its own.
    #[must_use]
    pub(crate) fn scaled_by(&self, factor: f64, relative_error: f64) -> Estimate {
        let scaled = self.scaled(factor);
        let further = NORMAL_QUANTILE * relative_error * scaled.value;
        let low = scaled.value - (scaled.value - scaled.low).hypot(further);
        Estimate {
            value: scaled.value,
            // An interval that cannot be negative stays non-negative.
            low: if self.low >= 0.0 { low.max(0.0) } else { low },
            high: scaled.value + (scaled.high - scaled.value).hypot(further),
        }
    }
}

/// Quantile of the chi-squared distribution at the normal quantile `z` (Wilson and Hilferty, PNAS
/// 17, 1931).
fn chi_squared_quantile(degrees: f64, z: f64) -> f64 {
    let part = 2.0 / (9.0 * degrees);
    degrees * (1.0 - part + z * part.sqrt()).max(0.05).powi(3)
}

/// Quantile of Student's distribution (Cornish-Fisher expansion, Abramowitz and Stegun 26.7.5).
fn student_quantile(degrees: f64) -> f64 {
    let z = NORMAL_QUANTILE;
    let (z3, z5, z7) = (z.powi(3), z.powi(5), z.powi(7));
    z + (z3 + z) / (4.0 * degrees)
        + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * degrees.powi(2))
        + (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * z) / (384.0 * degrees.powi(3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_tables() {
        // Abramowitz and Stegun, tables 26.8 and 26.10.
        assert!((chi_squared_quantile(30.0, NORMAL_QUANTILE) / 53.672 - 1.0).abs() < 2e-3);
        assert!((chi_squared_quantile(30.0, -NORMAL_QUANTILE) / 13.787 - 1.0).abs() < 5e-3);
        assert!((student_quantile(10.0) - 3.169).abs() < 2e-3);
        assert!((student_quantile(1e9) - NORMAL_QUANTILE).abs() < 1e-6);
    }
}
