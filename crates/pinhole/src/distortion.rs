//! Calibrated cameras: camera matrix and distortion of OpenCV and ROS.
//!
//! The models of OpenCV's calib3d map the undistorted slopes (x, y) = (X/Z, Y/Z) of a chief ray to
//! a distorted point `((u − cx)/fx, (v − cy)/fy)`: `plumb_bob` and `rational` (Brown and Conrady;
//! with thin prism terms), and `fisheye` (Kannala and Brandt, PAMI 28(8), 2006). x points right, y
//! down, Z forwards; the centre of the first pixel is (0, 0). The view types of Radiance are models
//! without coefficients.

use crate::CameraError;
use std::f64::consts::FRAC_PI_2;

/// Number of iterations after which a point is assumed to have no ray.
const MAX_ITERATIONS: u32 = 40;
/// Accuracy of the slopes.
const PRECISION: f64 = 1e-12;
/// Radius below which a fisheye does not distort.
const LEAST_RADIUS: f64 = 1e-9;

/// A distortion model.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Distortion {
    /// `x_d = x (1+k1 r²+k2 r⁴+k3 r⁶)/(1+k4 r²+k5 r⁴+k6 r⁶) + 2 p1 xy + p2 (r²+2x²) + s1 r² + s2
    /// r⁴`, and y alike, in OpenCV's order k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4; trailing ones are 0
    /// (`plumb_bob`: five, `rational_polynomial`: eight).
    Rational([f64; 12]),
    /// `θ_d = θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸)`, with θ the angle to the axis. Without
    /// coefficients it is equidistant: Radiance's view type `-vta`.
    Fisheye([f64; 4]),
    /// `r_d = sin θ`: a hemispherical fisheye, `-vth`.
    Orthographic,
    /// `r_d = 2 tan(θ/2)`: a planisphere, `-vts`.
    Stereographic,
    /// `x_d = atan x`, `y_d = y/√(1+x²)`: a cylindrical panorama, `-vtc`.
    Cylindrical,
}

impl Distortion {
    /// The distorted point of slopes (x, y).
    #[must_use]
    pub fn distort(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        match self {
            Distortion::Rational([k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4]) => {
                let r2 = x * x + y * y;
                let radial = (1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1.0 + r2 * (k4 + r2 * (k5 + r2 * k6)));
                [
                    x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x) + r2 * (s1 + r2 * s2),
                    y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y + r2 * (s3 + r2 * s4),
                ]
            }
            Distortion::Fisheye([k1, k2, k3, k4]) => {
                let r = x.hypot(y);
                let theta = r.atan();
                let t2 = theta * theta;
                let distorted = theta * (1.0 + t2 * (k1 + t2 * (k2 + t2 * (k3 + t2 * k4))));
                let scale = if r > LEAST_RADIUS { distorted / r } else { 1.0 };
                [x * scale, y * scale]
            }
            Distortion::Orthographic => {
                let scale = (1.0 + x * x + y * y).sqrt().recip();
                [x * scale, y * scale]
            }
            Distortion::Stereographic => {
                let scale = 2.0 / (1.0 + (1.0 + x * x + y * y).sqrt());
                [x * scale, y * scale]
            }
            Distortion::Cylindrical => [x.atan(), y / (1.0 + x * x).sqrt()],
        }
    }

    /// The inverse of a model that has one in closed form, as [`Distortion::undistort`]; the outer
    /// `None` stands for other models.
    fn closed_form(&self, [x, y]: [f64; 2]) -> Option<Option<([f64; 2], f64)>> {
        let square = x * x + y * y;
        Some(match self {
            Distortion::Rational(coefficients) if *coefficients == [0.0; 12] => Some(([x, y], 1.0)),
            // r = tan r_d.
            Distortion::Fisheye(coefficients) if *coefficients == [0.0; 4] => {
                let angle = square.sqrt();
                (angle < FRAC_PI_2).then(|| {
                    let slope = angle.tan();
                    let scale = if angle > 0.0 { slope / angle } else { 1.0 };
                    ([x * scale, y * scale], scale * (1.0 + slope * slope))
                })
            }
            Distortion::Rational(_) | Distortion::Fisheye(_) => return None,
            // r = r_d/√(1−r_d²); the ratio of areas is (r/r_d)·dr/dr_d.
            Distortion::Orthographic => (square < 1.0).then(|| {
                let scale = (1.0 - square).sqrt().recip();
                ([x * scale, y * scale], scale.powi(4))
            }),
            // r = 4 r_d/(4−r_d²).
            Distortion::Stereographic => (square < 4.0).then(|| {
                let scale = 4.0 / (4.0 - square);
                ([x * scale, y * scale], 0.25 * scale.powi(3) * (4.0 + square))
            }),
            Distortion::Cylindrical => (x.abs() < FRAC_PI_2).then(|| {
                let scale = x.cos().recip();
                ([x.tan(), y * scale], scale.powi(3))
            }),
        })
    }

    /// The slopes of a distorted point, and the ratio of undistorted to distorted area there.
    /// `None` outside the region around the picture's centre where the model is invertible.
    #[must_use]
    pub fn undistort(&self, place: [f64; 2]) -> Option<([f64; 2], f64)> {
        if let Some(inverse) = self.closed_form(place) {
            return inverse;
        }
        // Continuation from the centre outwards: each step starts at the previous solution, so no
        // other branch is reached.
        let steps = 1 + (4.0 * place[0].hypot(place[1])) as u32;
        let mut slopes = [0.0, 0.0];
        for step in 1..=steps.min(64) {
            let share = f64::from(step) / f64::from(steps.min(64));
            slopes = self.solve(place.map(|at| at * share), slopes)?;
        }
        let [[a, b], [c, d]] = self.derivatives(slopes)?;
        let determinant = a * d - b * c;
        (determinant > 0.0).then(|| (slopes, determinant.recip()))
    }

    /// Newton's method.
    fn solve(&self, place: [f64; 2], start: [f64; 2]) -> Option<[f64; 2]> {
        let [mut x, mut y] = start;
        for _ in 0..MAX_ITERATIONS {
            let [fx, fy] = self.distort([x, y]);
            let (dx, dy) = (place[0] - fx, place[1] - fy);
            if dx.hypot(dy) < PRECISION * (1.0 + place[0].hypot(place[1])) {
                return Some([x, y]);
            }
            let [[a, b], [c, d]] = self.derivatives([x, y])?;
            let determinant = a * d - b * c;
            if determinant.is_nan() || determinant <= 0.0 {
                return None;
            }
            x += (d * dx - b * dy) / determinant;
            y += (a * dy - c * dx) / determinant;
        }
        None
    }

    /// Derivatives of the distorted point by the slopes, a row for each of its coordinates. `None` for
    /// the models with a closed form, which need none.
    fn derivatives(&self, slopes: [f64; 2]) -> Option<[[f64; 2]; 2]> {
        match self {
            Distortion::Rational(coefficients) => Some(rational_derivatives(coefficients, slopes)),
            Distortion::Fisheye(coefficients) => Some(fisheye_derivatives(coefficients, slopes)),
            Distortion::Orthographic | Distortion::Stereographic | Distortion::Cylindrical => None,
        }
    }
}

fn rational_derivatives(coefficients: &[f64; 12], [x, y]: [f64; 2]) -> [[f64; 2]; 2] {
    let [k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4] = coefficients;
    let r2 = x * x + y * y;
    let below = 1.0 + r2 * (k4 + r2 * (k5 + r2 * k6));
    let radial = (1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))) / below;
    // Of the radial factor by r².
    let slope = (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3) - radial * (k4 + r2 * (2.0 * k5 + r2 * 3.0 * k6))) / below;
    let [prism_x, prism_y] = [s1 + 2.0 * s2 * r2, s3 + 2.0 * s4 * r2];
    let across = 2.0 * (x * y * slope + p1 * x + p2 * y);
    [
        [radial + 2.0 * (x * x * slope + p1 * y + 3.0 * p2 * x + x * prism_x), across + 2.0 * y * prism_x],
        [across + 2.0 * x * prism_y, radial + 2.0 * (y * y * slope + 3.0 * p1 * y + p2 * x + y * prism_y)],
    ]
}

fn fisheye_derivatives([k1, k2, k3, k4]: &[f64; 4], [x, y]: [f64; 2]) -> [[f64; 2]; 2] {
    let r = x.hypot(y);
    if r <= LEAST_RADIUS {
        return [[1.0, 0.0], [0.0, 1.0]];
    }
    let theta = r.atan();
    let t2 = theta * theta;
    let across_radius = theta * (1.0 + t2 * (k1 + t2 * (k2 + t2 * (k3 + t2 * k4)))) / r;
    let by_angle = 1.0 + t2 * (3.0 * k1 + t2 * (5.0 * k2 + t2 * (7.0 * k3 + t2 * 9.0 * k4)));
    let excess = by_angle / (1.0 + r * r) - across_radius;
    let [cos, sin] = [x / r, y / r];
    let mixed = excess * cos * sin;
    [[across_radius + excess * cos * cos, mixed], [mixed, across_radius + excess * sin * sin]]
}

/// A calibrated camera: maps points of the picture to slopes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraMatrix {
    /// fx and fy, focal lengths in pixels.
    pub focal: [f64; 2],
    /// cx and cy: the principal point, pixels from the centre of the first pixel.
    pub center: [f64; 2],
    /// The distortion model.
    pub distortion: Distortion,
}

impl CameraMatrix {
    /// Checks the numbers.
    ///
    /// # Errors
    /// If a focal length is not positive, or a number is not finite.
    pub fn checked(self) -> Result<Self, CameraError> {
        for value in self.focal {
            if !(value.is_finite() && value > 0.0) {
                return Err(CameraError::NotPositive { quantity: "focal distance in pixels", value });
            }
        }
        let coefficients: &[f64] = match &self.distortion {
            Distortion::Rational(all) => all,
            Distortion::Fisheye(all) => all,
            Distortion::Orthographic | Distortion::Stereographic | Distortion::Cylindrical => &[],
        };
        if !self.center.iter().chain(coefficients).all(|value| value.is_finite()) {
            return Err(CameraError::NotFinite { quantity: "the camera matrix" });
        }
        Ok(self)
    }

    /// The slopes (right, up) of a point of the picture (pixels from its left and top edge), and
    /// the ratio of their area to that of the picture in units of the focal lengths.
    #[must_use]
    pub fn slopes(&self, [column, row]: [f64; 2]) -> Option<([f64; 2], f64)> {
        let place = [(column - 0.5 - self.center[0]) / self.focal[0], (row - 0.5 - self.center[1]) / self.focal[1]];
        let ([x, y], area_ratio) = self.distortion.undistort(place)?;
        Some(([x, -y], area_ratio))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MODELS: [Distortion; 8] = [
        Distortion::Rational([0.0; 12]),
        Distortion::Rational([-0.28, 0.09, 1e-3, -7e-4, -0.012, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        Distortion::Rational([0.5, 0.1, 1e-4, 2e-4, 0.01, 0.8, 0.3, 0.05, 1e-3, 2e-4, -1e-3, 1e-4]),
        Distortion::Fisheye([-0.01, 0.02, -0.005, 0.001]),
        Distortion::Fisheye([0.0; 4]),
        Distortion::Orthographic,
        Distortion::Stereographic,
        Distortion::Cylindrical,
    ];

    #[test]
    fn distortion_and_its_inverse_cancel() {
        for model in MODELS {
            for k in 0..400 {
                let (x, y) = (f64::from(k % 20) * 0.06 - 0.6, f64::from(k / 20) * 0.05 - 0.5);
                let (found, area_ratio) = model.undistort(model.distort([x, y])).unwrap();
                assert!((found[0] - x).abs() < 1e-9 && (found[1] - y).abs() < 1e-9, "{model:?} at {x} {y}: {found:?}");
                assert!(area_ratio > 0.0);
            }
        }
    }

    #[test]
    fn a_fisheye_sees_far_to_the_side() {
        let model = Distortion::Fisheye([0.0; 4]);
        // 80 degrees from the axis is imaged at its own angle.
        let angle = 80f64.to_radians();
        let (slopes, _) = model.undistort([angle, 0.0]).unwrap();
        assert!((slopes[0] / angle.tan() - 1.0).abs() < 1e-9);
        assert_eq!(model.undistort([1.6, 0.0]), None, "more than 90 degrees");
    }

    #[test]
    fn view_types_image_angles_as_in_radiance() {
        let angle = 80f64.to_radians();
        for (model, radius) in [
            (Distortion::Orthographic, angle.sin()),
            (Distortion::Stereographic, 2.0 * (0.5 * angle).tan()),
            (Distortion::Cylindrical, angle),
        ] {
            let (slopes, _) = model.undistort([radius, 0.0]).unwrap();
            assert!((slopes[0] / angle.tan() - 1.0).abs() < 1e-9, "{model:?}: {slopes:?}");
            assert_eq!(model.undistort([2.0, 0.0]), None, "{model:?}: 90 degrees and more");
        }
        // A point of a cylinder is as high as above the horizontal distance.
        let (slopes, _) = Distortion::Cylindrical.undistort([angle, 0.5]).unwrap();
        assert!((slopes[1] * angle.cos() - 0.5).abs() < 1e-12);
    }

    #[test]
    fn derivatives_are_those_of_the_distorted_point() {
        let step = 1e-6;
        for model in &MODELS[..5] {
            for slopes in [[0.0, 0.0], [1e-4, -2e-4], [0.3, -0.2], [-0.6, 0.5], [0.0, 0.7]] {
                let found = model.derivatives(slopes).unwrap();
                for axis in 0..2 {
                    let [high, low] = [step, -step].map(|by| {
                        let mut moved = slopes;
                        moved[axis] += by;
                        model.distort(moved)
                    });
                    for coordinate in 0..2 {
                        let expected = (high[coordinate] - low[coordinate]) / (2.0 * step);
                        let value = found[coordinate][axis];
                        assert!((value - expected).abs() < 1e-8, "{model:?} at {slopes:?}: {value}, {expected}");
                    }
                }
            }
        }
        assert!(MODELS[5..].iter().all(|model| model.derivatives([0.3, 0.2]).is_none()));
    }

    #[test]
    fn models_without_coefficients_have_their_inverse_in_closed_form() {
        for model in [Distortion::Fisheye([0.0; 4]), Distortion::Rational([0.0; 12])] {
            for slopes in [[0.0, 0.0], [1e-12, 0.0], [0.3, -0.2], [-2.0, 5.0]] {
                let (found, _) = model.closed_form(model.distort(slopes)).flatten().unwrap();
                assert!((found[0] - slopes[0]).abs() < 1e-13 && (found[1] - slopes[1]).abs() < 1e-13, "{found:?}");
            }
        }
        // Areas are r dr dφ before and r_d dr_d dφ after.
        let (_, area_ratio) = Distortion::Fisheye([0.0; 4]).undistort([1.2, 0.0]).unwrap();
        let expected = 1.2f64.tan() / (1.2 * 1.2f64.cos().powi(2));
        assert!((area_ratio / expected - 1.0).abs() < 1e-12, "{area_ratio} {expected}");
    }

    #[test]
    fn points_beyond_the_fold_have_no_ray() {
        // x − 0.5 x³ is largest at √(2/3), where it is 0.544.
        let model = Distortion::Rational([-0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert!(model.undistort([0.53, 0.0]).is_some());
        assert_eq!(model.undistort([0.56, 0.0]), None);
    }

    #[test]
    fn the_growth_of_area_is_that_of_a_small_square() {
        for model in MODELS {
            let place = model.distort([0.3, -0.2]);
            let (_, area_ratio) = model.undistort(place).unwrap();
            let corner = |dx: f64, dy: f64| model.undistort([place[0] + dx, place[1] + dy]).unwrap().0;
            let (o, a, b) = (corner(0.0, 0.0), corner(1e-5, 0.0), corner(0.0, 1e-5));
            let area = ((a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])) / 1e-10;
            assert!((area / area_ratio - 1.0).abs() < 1e-3, "{model:?}: {area} {area_ratio}");
        }
    }
}
