//! Straight-line fits to points of known variance.

/// A fitted line, with the covariance of its coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line {
    pub(super) intercept: f64,
    pub(super) slope: f64,
    pub(super) slope_error: f64,
}

impl Line {
    pub(super) fn at(&self, x: f64) -> f64 {
        self.intercept + self.slope * x
    }
}

/// A point (x, y), with the variance of y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) variance: f64,
}

/// Weighted least squares. `None` if the points do not determine a line.
pub(super) fn fit(points: &[Point]) -> Option<Line> {
    let weight: f64 = points.iter().map(|point| point.variance.recip()).sum();
    let mean = |of: fn(&Point) -> f64| points.iter().map(|point| of(point) / point.variance).sum::<f64>() / weight;
    let (x, y) = (mean(|point| point.x), mean(|point| point.y));
    let (mut spread, mut together) = (0.0, 0.0);
    for point in points {
        spread += (point.x - x).powi(2) / point.variance;
        together += (point.x - x) * (point.y - y) / point.variance;
    }
    let slope = together / spread;
    let line = Line { intercept: y - slope * x, slope, slope_error: spread.recip().sqrt() };
    (spread > 0.0 && line.slope.is_finite() && line.slope_error.is_finite()).then_some(line)
}
