//! The Perez sky model: clearness and brightness, luminous efficacies, relative luminance.
//!
//! R. Perez, P. Ineichen, R. Seals, J. Michalsky, R. Stewart, "Modeling daylight availability and
//! irradiance components from direct and global irradiance", Solar Energy 44 (5), 1990, table 4
//! (efficacies); R. Perez, R. Seals, J. Michalsky, "All-weather model for sky luminance
//! distribution", Solar Energy 50 (3), 1993, table 1 (luminance). In the formulas, Z is the sun's
//! zenith angle, ε the sky's clearness, Δ its brightness, ζ the zenith angle of a point and γ its
//! angle from the sun; radians.

use std::f64::consts::PI;

/// Extraterrestrial irradiance, W/m².
pub(crate) const SOLAR_CONSTANT: f64 = 1367.0;
/// The ranges of ε and Δ for which the model is valid.
const CLEARNESS: (f64, f64) = (1.0, 12.01);
const BRIGHTNESS: (f64, f64) = (0.01, 0.6);

/// Colour coefficients measured in Berlin (A. Diakite-Kortlever and M. Knoop), and those of the CIE
/// daylight locus.
#[rustfmt::skip]
pub(crate) const LOCUS_BERLIN: [f32; 11] = [
    -4.843e9, 2.5568e6, 0.24282e3, 0.23258, -4.843e9, 2.5568e6, 0.24282e3, 0.23258, -1.2848, 1.7519, -0.093786,
];
#[rustfmt::skip]
pub(crate) const LOCUS_CIE: [f32; 11] = [
    -4.607e9, 2.9678e6, 0.09911e3, 0.244063, -2.0064e9, 1.9018e6, 0.24748e3, 0.23704, -3.0, 2.87, -0.275,
];

/// Lower bounds of the eight classes of clearness.
const CLASSES: [f64; 8] = [1.0, 1.065, 1.230, 1.500, 1.950, 2.800, 4.500, 6.200];

/// For each class: a + b·W + c·cos Z + d·ln Δ, the luminous efficacy of diffuse light in lm/W; W is
/// precipitable water in cm.
#[rustfmt::skip]
const DIFFUSE_EFFICACY: [[f64; 4]; 8] = [
    [97.24, -0.46, 12.00, -8.91], [107.22, 1.15, 0.59, -3.95], [104.97, 2.96, -5.53, -8.77], [102.39, 5.59, -13.95, -13.90],
    [100.71, 5.94, -22.75, -23.74], [106.42, 3.83, -36.15, -28.83], [141.88, 1.90, -53.24, -14.03], [152.23, 0.35, -45.27, -7.98],
];
/// For each class: a + b·W + c·exp(5.73 Z − 5) + d·Δ, the luminous efficacy of direct light in
/// lm/W.
#[rustfmt::skip]
const DIRECT_EFFICACY: [[f64; 4]; 8] = [
    [57.20, -4.55, -2.98, 117.12], [98.99, -3.46, -1.21, 12.38], [109.83, -4.90, -1.71, -8.81], [110.34, -5.84, -1.99, -4.56],
    [106.36, -3.97, -1.75, -6.16], [107.19, -1.25, -1.51, -26.73], [105.75, 0.77, -1.26, -34.44], [101.18, 1.58, -1.10, -8.29],
];

/// For each class, the five luminance parameters a to e, each from four numbers.
#[rustfmt::skip]
const LUMINANCE: [[[f32; 4]; 5]; 8] = [
    [[1.3525, -0.2576, -0.2690, -1.4366], [-0.7670, 0.0007, 1.2734, -0.1233], [2.8000, 0.6004, 1.2375, 1.000], [1.8734, 0.6297, 0.9738, 0.2809], [0.0356, -0.1246, -0.5718, 0.9938]],
    [[-1.2219, -0.7730, 1.4148, 1.1016], [-0.2054, 0.0367, -3.9128, 0.9156], [6.9750, 0.1774, 6.4477, -0.1239], [-1.5798, -0.5081, -1.7812, 0.1080], [0.2624, 0.0672, -0.2190, -0.4285]],
    [[-1.1000, -0.2515, 0.8952, 0.0156], [0.2782, -0.1812, -4.5000, 1.1766], [24.7219, -13.0812, -37.7000, 34.8438], [-5.0000, 1.5218, 3.9229, -2.6204], [-0.0156, 0.1597, 0.4199, -0.5562]],
    [[-0.5484, -0.6654, -0.2672, 0.7117], [0.7234, -0.6219, -5.6812, 2.6297], [33.3389, -18.3000, -62.2500, 52.0781], [-3.5000, 0.0016, 1.1477, 0.1062], [0.4659, -0.3296, -0.0876, -0.0329]],
    [[-0.6000, -0.3566, -2.5000, 2.3250], [0.2937, 0.0496, -5.6812, 1.8415], [21.0000, -4.7656, -21.5906, 7.2492], [-3.5000, -0.1554, 1.4062, 0.3988], [0.0032, 0.0766, -0.0656, -0.1294]],
    [[-1.0156, -0.3670, 1.0078, 1.4051], [0.2875, -0.5328, -3.8500, 3.3750], [14.0000, -0.9999, -7.1406, 7.5469], [-3.4000, -0.1078, -1.0750, 1.5702], [-0.0672, 0.4016, 0.3017, -0.4844]],
    [[-1.0000, 0.0211, 0.5025, -0.5119], [-0.3000, 0.1922, 0.7023, -1.6317], [19.0000, -5.0000, 1.2438, -1.9094], [-4.0000, 0.0250, 0.3844, 0.2656], [1.0468, -0.3788, -2.4517, 1.4656]],
    [[-1.0500, 0.0289, 0.4260, 0.3590], [-0.3250, 0.1156, 0.7781, 0.0025], [31.0625, -14.5000, -46.1148, 55.3750], [-7.2312, 0.4050, 13.3500, 0.6234], [1.5000, -0.6426, 1.8564, 0.5636]],
];

/// Rings of sky points for the integration over the sky: zenith angle in degrees, and number of
/// points.
const SKY_POINTS: [(f64, usize); 8] =
    [(84.0, 30), (72.0, 30), (60.0, 24), (48.0, 24), (36.0, 18), (24.0, 12), (12.0, 6), (0.0, 1)];

/// Clearness and brightness of the sky.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Conditions {
    pub(crate) clearness: f64,
    pub(crate) brightness: f64,
}

impl Conditions {
    /// Both clamped to the range of the model.
    pub(crate) fn limited(self) -> Conditions {
        let Conditions { clearness, brightness } = self;
        let clearness = if clearness > CLEARNESS.1 { CLEARNESS.1 - 0.001 } else { clearness.max(CLEARNESS.0) };
        Conditions { clearness, brightness: brightness.clamp(BRIGHTNESS.0, BRIGHTNESS.1) }
    }

    /// Whether the clearness is within the range of the model.
    pub(crate) fn in_range(self) -> bool {
        self.clearness >= CLEARNESS.0 && self.clearness < CLEARNESS.1
    }

    fn class(self) -> usize {
        CLASSES.iter().rposition(|lower| self.clearness >= *lower).unwrap_or(0)
    }

    /// Lumens per watt of diffuse horizontal light; `sun_zenith` in radians, `water` in cm.
    pub(crate) fn diffuse_efficacy(self, sun_zenith: f64, water: f64) -> f64 {
        let [a, b, c, d] = DIFFUSE_EFFICACY[self.class()];
        a + b * water + c * sun_zenith.cos() + d * self.brightness.ln()
    }

    /// Lumens per watt of direct normal light; `sun_zenith` in radians, `water` in cm.
    pub(crate) fn direct_efficacy(self, sun_zenith: f64, water: f64) -> f64 {
        let [a, b, c, d] = DIRECT_EFFICACY[self.class()];
        (a + b * water + c * (5.73 * sun_zenith - 5.0).exp() + d * self.brightness).max(0.0)
    }

    /// The parameters a to e for a sun at the zenith angle `sun_zenith`, radians.
    pub(crate) fn parameters(self, sun_zenith: f64) -> [f64; 5] {
        // gendaylit compares the clearness in single precision, which matters at the lower bound of
        // a class.
        let class = Conditions { clearness: f64::from(self.clearness as f32), ..self }.class();
        let delta =
            if self.clearness > 1.065 && self.clearness < 2.8 { self.brightness.max(0.2) } else { self.brightness };
        let z = sun_zenith;
        let rows = LUMINANCE[class].map(|row| row.map(f64::from));
        let linear = |[x0, x1, x2, x3]: [f64; 4]| x0 + x1 * z + delta * (x2 + x3 * z);
        let mut parameters = rows.map(linear);
        if class == 0 {
            let ([c0, c1, c2, c3], [d0, d1, d2, d3]) = (rows[2], rows[3]);
            parameters[2] = (delta * (c0 + c1 * z)).powf(c2).exp() - c3;
            parameters[3] = -(delta * (d0 + d1 * z)).exp() + d2 + delta * d3;
        }
        parameters
    }
}

/// Relative luminance: (1 + a exp(b / cos ζ)) (1 + c exp(d γ) + e cos² γ).
pub(crate) fn relative_luminance([a, b, c, d, e]: [f64; 5], point_zenith: f64, sun_angle: f64) -> f64 {
    let cosine = sun_angle.cos();
    (1.0 + a * (b / point_zenith.cos()).exp()) * (1.0 + c * (d * sun_angle).exp() + e * cosine * cosine)
}

/// The horizontal illuminance of the relative luminance, integrated over the 145 points.
pub(crate) fn horizontal_integral(parameters: [f64; 5], sun_zenith: f64) -> f64 {
    let mut sum = 0.0;
    for (zenith, count) in SKY_POINTS {
        let zenith = zenith.to_radians();
        for index in 0..count {
            let azimuth = (index as f64 * 360.0 / count as f64).to_radians();
            let cosine = sun_zenith.cos() * zenith.cos() + sun_zenith.sin() * zenith.sin() * azimuth.cos();
            let luminance = relative_luminance(parameters, zenith, cosine.min(1.0).acos());
            sum += f64::from(luminance as f32) * zenith.cos();
        }
    }
    sum * (2.0 * PI / 145.0)
}

/// 1 + 1.041 Z³, `sun_zenith` in radians.
fn zenith_term(sun_zenith: f64) -> f64 {
    1.0 + 1.041 * sun_zenith * sun_zenith * sun_zenith
}

/// ε from direct normal and diffuse horizontal irradiance.
pub(crate) fn clearness(direct: f64, diffuse: f64, sun_zenith: f64) -> f64 {
    let term = zenith_term(sun_zenith);
    ((diffuse + direct) / diffuse + (term - 1.0)) / term
}

/// Direct normal irradiance from ε and the diffuse horizontal one.
pub(crate) fn direct_irradiance(clearness: f64, diffuse: f64, sun_zenith: f64) -> f64 {
    diffuse * (clearness - 1.0) * zenith_term(sun_zenith)
}

/// Ratio of the sun's irradiance to its yearly mean, by the earth's distance (J. W. Spencer, 1971);
/// `day` counts from 1.
pub(crate) fn eccentricity(day: f64) -> f64 {
    let angle = 2.0 * PI * (day - 1.0) / 365.0;
    1.00011
        + 0.034221 * angle.cos()
        + 0.00128 * angle.sin()
        + 0.000719 * (2.0 * angle).cos()
        + 0.000077 * (2.0 * angle).sin()
}

/// Relative air mass (F. Kasten, 1966); `zenith_degrees` at most 90.
pub(crate) fn air_mass(zenith_degrees: f64) -> f64 {
    1.0 / (zenith_degrees.to_radians().cos() + 0.15 * ((93.885 - zenith_degrees).ln() * -1.253).exp())
}
