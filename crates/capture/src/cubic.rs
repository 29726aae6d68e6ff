//! Cubic interpolation between the points of a grid.

/// Points around a place from which a function is interpolated, along each axis.
pub(crate) const INTERPOLATED: usize = 4;

/// Weights of the four integers around a place: Lagrange's cubic polynomial.
pub(crate) fn cubic_weights(at: f64) -> [f64; INTERPOLATED] {
    let t = at - at.floor();
    [
        -t * (t - 1.0) * (t - 2.0) / 6.0,
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
        (t + 1.0) * t * (t - 1.0) / 6.0,
    ]
}
