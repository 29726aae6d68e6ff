//! The scattered transmission of Radiance's `trans` and `trans2`.
//!
//! The lobe is about the straight-through direction d (Ward, "Measuring and Modeling Anisotropic
//! Reflection", SIGGRAPH 1992, section 5, in the form of Radiance's reference). With h = i − d, and
//! h_x, h_y its components in the plane of the surface:
//!
//! `f = τ/(π α_x α_y) · exp(−|h|² (h_x²/α_x² + h_y²/α_y²)/(h_x² + h_y²)) / √(|cos θ_i| cos θ_o)`
//!
//! For α_x = α_y the exponent is `(2 − 2 i·d)/α²`: a von Mises–Fisher lobe. It is reciprocal if d
//! is the reversed outgoing direction.
//!
//! Near grazing, f transmits more light than it receives: up to ten times as much for α = 1. It is
//! therefore divided by the larger of [`grazing_gain`] at θ_i and at θ_o, which keeps it reciprocal.
//! With c = cos θ_o and C the positive part of the incident cosine of a sample of the normalised
//! lobe, the directional albedo of f is τ·E(√(C/c)) ≤ τ·√(P(C > 0)·E(C)/c), by the Cauchy–Schwarz
//! inequality. The angle off the axis is Gaussian, with standard deviation α/√2.
//! Anisotropic lobes keep the albedo of Radiance's formula below grazing, which is more or less than
//! τ by azimuth.

use crate::lobe::Lobe;
use crate::{Brdf, BrdfSample, Lobes};
use glam::DVec3;
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_2_PI, PI, TAU};

/// A Gaussian lobe of transmission through a thin sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussianTransmission<const BANDS: usize> {
    /// τ, in each band.
    pub transmittance: [f64; BANDS],
    /// α along x and y, radians about the axis, above zero.
    pub roughness: [f64; 2],
}

/// Lower limit of the outgoing cosine (Radiance's).
const LEAST_COSINE: f64 = 0.001;

/// Lower limit of the foreshortening cosine in azimuth sampling, which bounds the weights.
const LEAST_FORESHORTENING: f64 = 0.1;

/// Ratio of the cosine to the standard deviation of a lobe from which [`grazing_gain`] is one.
const LARGEST_GAINING_RATIO: f64 = 0.5;

/// Fraction of the samples of an anisotropic lobe that come from an isotropic lobe of the larger
/// width. Far off the axis, at grazing angles, azimuth sampling alone fits the lobe badly.
const ISOTROPIC_FRACTION: f64 = 0.2;

impl<const BANDS: usize> GaussianTransmission<BANDS> {
    /// `f·|cos θ_i|/τ` in 1/sr, and the density of [`Self::sample_about`] in 1/sr.
    ///
    /// `axis` is the unit direction d of the lobe's peak, with z < 0; `cosine` is that of the
    /// outgoing angle. Directions on the wrong side have neither value nor density: such a sample
    /// counts as absorbed.
    #[inline]
    #[must_use]
    pub fn shape(&self, axis: DVec3, cosine: f64, incident: DVec3) -> (f64, f64) {
        if incident.z >= 0.0 || axis.z >= 0.0 {
            return (0.0, 0.0);
        }
        let [x, y] = self.roughness;
        let off = incident - axis;
        let in_plane = off.x * off.x + off.y * off.y;
        let widths =
            if in_plane > f64::MIN_POSITIVE { ((off.x / x).powi(2) + (off.y / y).powi(2)) / in_plane } else { 0.0 };
        let value = (-off.length_squared() * widths).exp() / (PI * x * y);
        let least = cosine.min(-incident.z).max(LEAST_COSINE);
        let gain = grazing_gain(least / self.deviation_across(axis + incident));
        (value * (-incident.z / cosine.max(LEAST_COSINE)).sqrt() / gain, self.density(axis, incident))
    }

    /// Standard deviation of the lobe about an axis at grazing incidence, radians. There nearly all
    /// directions of the lobe differ from the axis across the plane of incidence, if they are
    /// projected onto the surface: that width applies.
    fn deviation_across(&self, axis: DVec3) -> f64 {
        let [x, y] = self.roughness;
        let length_squared = axis.x * axis.x + axis.y * axis.y;
        if x == y || length_squared < f64::MIN_POSITIVE {
            return x * FRAC_1_SQRT_2;
        }
        (0.5 * length_squared / ((axis.y / x).powi(2) + (axis.x / y).powi(2))).sqrt()
    }

    /// Samples an incident direction. It may lie on the wrong side, where the lobe is zero.
    #[inline]
    #[must_use]
    pub fn sample_about(&self, axis: DVec3, [u, v]: [f64; 2]) -> DVec3 {
        let [x, y] = self.roughness;
        if x != y {
            return match u < ISOTROPIC_FRACTION {
                true => self.isotropic().sample_about(axis, [u / ISOTROPIC_FRACTION, v]),
                false => self.sample_azimuth_first(axis, [(u - ISOTROPIC_FRACTION) / (1.0 - ISOTROPIC_FRACTION), v]),
            };
        }
        self.sample_azimuth_first(axis, [u, v])
    }

    /// The lobe with the larger width for both axes.
    fn isotropic(&self) -> GaussianTransmission<BANDS> {
        let widest = self.roughness[0].max(self.roughness[1]);
        GaussianTransmission { roughness: [widest; 2], ..*self }
    }

    fn sample_azimuth_first(&self, axis: DVec3, [u, v]: [f64; 2]) -> DVec3 {
        let about = Azimuths::new(self, axis);
        let [x, y] = self.roughness;
        let (sin, cos) = (TAU * v).sin_cos();
        // In the plane of the surface the azimuth is that of a Gaussian with these widths.
        let across = DVec3::new(x * cos, y * sin, 0.0);
        let (a, b) = (across.dot(about.inward) / about.foreshortening, across.dot(about.level));
        let scale = a.hypot(b).recip();
        let (a, b) = (a * scale, b * scale);
        let width = about.width(self, a, b);
        // |h|² = 2 − 2 cos of the angle off the axis, exponentially distributed and at most 4.
        let squared = -(u * (-4.0 * width).exp_m1()).ln_1p() / width;
        let sine = (squared * (1.0 - 0.25 * squared)).max(0.0).sqrt();
        (axis * (1.0 - 0.5 * squared) + (about.upright * a + about.level * b) * sine).normalize()
    }

    /// Density of [`Self::sample_about`], 1/sr.
    fn density(&self, axis: DVec3, incident: DVec3) -> f64 {
        let density = self.azimuth_first_density(axis, incident);
        if self.roughness[0] == self.roughness[1] {
            return density;
        }
        ISOTROPIC_FRACTION * self.isotropic().azimuth_first_density(axis, incident)
            + (1.0 - ISOTROPIC_FRACTION) * density
    }

    /// The density by |h|² and azimuth about the axis is half of the density by solid angle.
    fn azimuth_first_density(&self, axis: DVec3, incident: DVec3) -> f64 {
        let about = Azimuths::new(self, axis);
        let (a, b) = (incident.dot(about.upright), incident.dot(about.level));
        let scale = a.hypot(b);
        let (a, b) = if scale > 0.0 { (a / scale, b / scale) } else { (1.0, 0.0) };
        let width = about.width(self, a, b);
        let c = about.foreshortening;
        // Density of the azimuth in the plane, 1/(2π α_x α_y · width), and its Jacobian to the
        // azimuth about the axis.
        let azimuth = c / (c * c * a * a + b * b) / (TAU * self.roughness[0] * self.roughness[1] * width);
        let squared = incident.distance_squared(axis);
        2.0 * azimuth * width * (-width * squared).exp() / -(-4.0 * width).exp_m1()
    }
}

/// Upper bound of the gain of a lobe at grazing incidence, at least one.
///
/// `ratio` is z = c/σ, the cosine over the lobe's standard deviation in radians, above zero. The
/// bound is √(P·E/z). P ≈ ½(1 + z/√(z² + π/2)) approximates the probability that a standard normal
/// variable shifted by z is positive, and E = ½(z + √(z² + 2/π)) bounds the mean of its positive
/// part. Both are exact at z = 0.
fn grazing_gain(ratio: f64) -> f64 {
    if ratio >= LARGEST_GAINING_RATIO {
        return 1.0;
    }
    let square = ratio * ratio;
    let transmitted = 0.5 * (1.0 + ratio / (square + 0.5 * PI).sqrt());
    let mean_cosine = 0.5 * (ratio + (square + FRAC_2_PI).sqrt());
    (transmitted * mean_cosine / ratio).sqrt().max(1.0)
}

/// Mapping between azimuths about the axis and azimuths in the plane of the surface.
struct Azimuths {
    /// Unit vector in the plane of the surface, perpendicular to the axis.
    level: DVec3,
    /// Unit vector perpendicular to the axis and to `level`.
    upright: DVec3,
    /// Unit vector of `upright`'s projection onto the plane.
    inward: DVec3,
    /// Length of that projection.
    foreshortening: f64,
}

impl Azimuths {
    fn new<const BANDS: usize>(lobe: &GaussianTransmission<BANDS>, axis: DVec3) -> Azimuths {
        let level = DVec3::new(-axis.y, axis.x, 0.0).try_normalize().unwrap_or(DVec3::Y);
        let inward = DVec3::new(level.y, -level.x, 0.0);
        let upright = level.cross(axis);
        let upright = if upright.dot(inward) < 0.0 { -upright } else { upright };
        let round = lobe.roughness[0] == lobe.roughness[1];
        let foreshortening = if round { 1.0 } else { axis.z.abs().max(LEAST_FORESHORTENING) };
        Azimuths { level, upright, inward, foreshortening }
    }

    /// `cos²/α_x² + sin²/α_y²` of the azimuth in the plane that corresponds to the direction
    /// `(a, b)` about the axis.
    fn width<const BANDS: usize>(&self, lobe: &GaussianTransmission<BANDS>, a: f64, b: f64) -> f64 {
        let in_plane = self.inward * (a * self.foreshortening) + self.level * b;
        let [x, y] = lobe.roughness;
        ((in_plane.x / x).powi(2) + (in_plane.y / y).powi(2)) / in_plane.length_squared()
    }
}

impl<const BANDS: usize> Lobe<BANDS> for GaussianTransmission<BANDS> {
    fn scale(&self) -> &[f64; BANDS] {
        &self.transmittance
    }

    fn shape(&self, outgoing: DVec3, incident: DVec3) -> (f64, f64) {
        let (weighted, density) = GaussianTransmission::shape(self, -outgoing, outgoing.z, incident);
        (if weighted > 0.0 { weighted / -incident.z } else { 0.0 }, density)
    }
}

impl<const BANDS: usize> Brdf for GaussianTransmission<BANDS> {
    fn lobes(&self) -> Lobes {
        Lobes { glossy: true, transmission: true, ..Lobes::default() }
    }

    fn eval_pdf(&self, outgoing: DVec3, incident: &[DVec3], values: &mut [f64], pdfs: &mut [f64]) {
        self.eval_lobe(outgoing, incident, values, pdfs);
    }

    fn sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> Option<BrdfSample> {
        let incident = self.sample_about(-outgoing, [u[0], u[1]]);
        self.weigh(outgoing, incident, weights)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    /// The mean weight of samples on a grid: the directional albedo for τ = 1.
    fn albedo(roughness: [f64; 2], degrees: f64, azimuth: f64) -> f64 {
        let lobe = GaussianTransmission { transmittance: [1.0], roughness };
        let (sin, cos) = degrees.to_radians().sin_cos();
        let outgoing = DVec3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos);
        let side: u32 = 128;
        let mut sum = 0.0;
        for at in 0..side * side {
            let [u, v] = [at / side, at % side].map(|at| (f64::from(at) + 0.5) / f64::from(side));
            let mut weight = [0.0];
            sum += lobe.sample(outgoing, [u, v, 0.5], &mut weight).map_or(0.0, |_| weight[0]);
        }
        sum / f64::from(side * side)
    }

    #[test]
    fn no_isotropic_roughness_gains_energy_at_any_angle() {
        for roughness in [0.001, 0.05, 0.2, 0.5, 1.0] {
            for degrees in [0.0, 45.0, 80.0, 85.0, 88.0, 89.0, 89.9, 89.9999] {
                let found = albedo([roughness; 2], degrees, 0.8);
                assert!(found <= 1.002, "roughness {roughness} at {degrees}°: {found}");
            }
        }
    }

    /// The anisotropic formula itself has this albedo for narrow lobes, more or less than one by
    /// azimuth: c α_x + α_y over c α_y + α_x, where x points along the plane of incidence.
    #[test]
    fn anisotropic_lobes_have_the_albedo_of_the_formula() {
        for (roughness, azimuth) in [([0.01, 0.03], 0.0), ([0.03, 0.01], 0.0), ([0.01, 0.03], FRAC_PI_2)] {
            let [along, across] = if azimuth == 0.0 { roughness } else { [roughness[1], roughness[0]] };
            for degrees in [0.0_f64, 30.0, 60.0] {
                let c = degrees.to_radians().cos();
                let expected = (c * along + across) / (c * across + along);
                let found = albedo(roughness, degrees, azimuth);
                assert!((found / expected - 1.0).abs() < 0.01, "{roughness:?} at {degrees}°: {found}, not {expected}");
            }
        }
    }

    #[test]
    fn the_bound_changes_only_grazing_directions() {
        assert!((albedo([0.2; 2], 60.0, 0.0) - 0.981).abs() < 0.003, "the value of the unbounded formula");
        assert_eq!(grazing_gain(LARGEST_GAINING_RATIO), 1.0);
        assert!((grazing_gain(LARGEST_GAINING_RATIO * (1.0 - 1e-9)) - 1.0).abs() < 1e-9, "continuous");
    }

    #[test]
    fn transmission_is_the_same_from_both_sides() {
        let lobe = GaussianTransmission { transmittance: [0.7], roughness: [0.1, 0.3] };
        let value = |outgoing: DVec3, incident: DVec3| {
            let (mut value, mut density) = ([0.0], [0.0]);
            lobe.eval_pdf(outgoing, &[incident], &mut value, &mut density);
            value[0]
        };
        for step in 0..100 {
            let at = f64::from(step);
            let outgoing = DVec3::new((at * 0.7).sin(), (at * 1.3).cos(), 0.4).normalize();
            let incident = (-outgoing + DVec3::new(at.cos(), (at * 2.1).sin(), 0.0) * 0.2).normalize();
            // From the other side the surface is the same, rotated about its x axis.
            let turned = |v: DVec3| DVec3::new(v.x, -v.y, -v.z);
            let (there, back) = (value(outgoing, incident), value(turned(incident), turned(outgoing)));
            assert!((there - back).abs() <= 1e-9 * there, "{there} {back}");
        }
    }
}
