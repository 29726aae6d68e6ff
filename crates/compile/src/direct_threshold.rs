//! How exactly shadows of weak lights are tested.

/// Threshold of direct light (`-dt`): scales the share of a point's light below which a light is
/// tested only with a probability.
///
/// 0 tests each light sample. A larger threshold tests fewer and gives more noise; the mean stays
/// the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectThreshold(f64);

impl DirectThreshold {
    /// The threshold of Radiance's `rpict`.
    pub const DEFAULT: DirectThreshold = DirectThreshold(0.05);

    /// The threshold with which each light is tested.
    pub const EXACT: DirectThreshold = DirectThreshold(0.0);

    /// `None` unless the threshold is finite and not negative.
    #[must_use]
    pub fn new(threshold: f64) -> Option<DirectThreshold> {
        (threshold >= 0.0 && threshold.is_finite()).then_some(DirectThreshold(threshold))
    }

    /// The threshold over the default one.
    #[must_use]
    pub fn relative(self) -> f64 {
        self.0 / DirectThreshold::DEFAULT.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_are_finite_and_not_negative() {
        assert_eq!(DirectThreshold::new(0.05), Some(DirectThreshold::DEFAULT));
        assert!(DirectThreshold::new(0.0).is_some());
        assert!([-0.1, f64::NAN, f64::INFINITY].iter().all(|threshold| DirectThreshold::new(*threshold).is_none()));
    }

    #[test]
    fn the_default_threshold_scales_nothing() {
        assert_eq!(DirectThreshold::DEFAULT.relative(), 1.0);
    }
}
