//! How the radiance of a film's pixels depends on the point of the pinhole.

use crate::film::UnblurredFilm;
use crate::lattice::Lattice;
use crate::window_sums::WindowSums;
use glam::DVec2;

/// Relative derivatives of the radiance of each film pixel by the point of the pinhole, per radius
/// along (right, up).
#[derive(Debug)]
pub(crate) struct PinholeDerivatives(pub(crate) [Vec<f64>; 2]);

/// Maximum relative derivative of a smooth function, per radius of the pinhole: the lobe of sheeting
/// has 0.3 at most.
const STEEPEST: f64 = 0.5;

/// Maximum difference between the sums over the points of both axes, relative to the sum over all.
const MOST_UNEVEN: f64 = 0.05;

/// Squared noise of a derivative, relative to its square, from which nothing is known of it: half of
/// it.
const NOISE_RATIO: f64 = 2.0;

/// The fraction of a derivative that is kept, by its square and its squared noise: an estimate within
/// its noise is shrunk (James and Stein 1961).
pub(crate) fn kept_fraction(squared: f64, squared_noise: f64) -> f64 {
    let kept = 1.0 - NOISE_RATIO * squared_noise / squared;
    if kept > 0.0 { kept } else { 0.0 }
}

/// The radiance of a film pixel through four points of the pinhole.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PinholeProbe {
    /// Sum over the four points.
    sum: f64,
    /// Sums over the two points of each axis, weighted by their positions.
    moments: [f64; 2],
    /// By how much the sum over the points of the first axis exceeds that of the second.
    unevenness: f64,
}

impl PinholeProbe {
    /// Distance of the four points from the centre, radii. A function of the third degree then has
    /// the same first moment over the disk as these points.
    const DISTANCE: f64 = std::f64::consts::FRAC_1_SQRT_2;

    /// From the radiance through a point of the pinhole.
    pub(crate) fn new(mut radiance: impl FnMut(DVec2) -> f64) -> PinholeProbe {
        let mut probe = PinholeProbe::default();
        for (axis, moment) in [DVec2::X, DVec2::Y].into_iter().zip(&mut probe.moments) {
            let [low, high] = [-Self::DISTANCE, Self::DISTANCE].map(|at| radiance(axis * at));
            *moment = Self::DISTANCE * (high - low);
            probe.sum += low + high;
            probe.unevenness = low + high - probe.unevenness;
        }
        probe
    }

    /// Nothing, if the values are not those of a smooth function, but those of different surfaces, to which
    /// scattered rays went or between which an edge passes through the middle of the pixel: their differences
    /// would be taken for derivatives of all pixels around this one.
    pub(crate) fn smooth(self) -> PinholeProbe {
        if self.is_smooth() { self } else { PinholeProbe::default() }
    }

    /// The mean with another probe of the same pixel, whose rays have other random numbers. As far as the
    /// probes differ, their derivatives are noise.
    pub(crate) fn smooth_with(self, other: impl FnOnce() -> PinholeProbe) -> PinholeProbe {
        if !self.is_smooth() {
            return PinholeProbe::default();
        }
        let other = other();
        if !other.is_smooth() {
            return PinholeProbe::default();
        }
        let [mean, half_difference] = [1.0, -1.0].map(|sign| PinholeProbe {
            sum: 0.5 * (self.sum + sign * other.sum),
            moments: [0, 1].map(|axis| 0.5 * (self.moments[axis] + sign * other.moments[axis])),
            unevenness: 0.5 * (self.unevenness + sign * other.unevenness),
        });
        let squared = |probe: &PinholeProbe| probe.moments.iter().map(|moment| moment * moment).sum::<f64>();
        let kept = kept_fraction(squared(&mean), squared(&half_difference));
        PinholeProbe { moments: mean.moments.map(|moment| kept * moment), ..mean }
    }

    fn is_smooth(&self) -> bool {
        let most = STEEPEST * 0.25 * self.sum;
        self.unevenness.abs() <= MOST_UNEVEN * self.sum && self.moments.iter().all(|m| m.abs() <= most)
    }
}

impl PinholeDerivatives {
    /// From the probes of the nodes of a lattice, each with its index. Where no light arrives, the
    /// probes within `reach` pixels decide.
    pub(crate) fn new(
        film: &UnblurredFilm,
        (lattice, nodes): (&Lattice, &[u8]),
        probes: &[(usize, PinholeProbe)],
        reach: usize,
    ) -> PinholeDerivatives {
        let pooled = |of_probe: &dyn Fn(&PinholeProbe) -> f64| {
            let mut values = vec![0.0; film.pixel_count()];
            probes.iter().for_each(|(pixel, probe)| values[*pixel] = of_probe(probe));
            let sums = WindowSums::new(values.into_iter().map(|value| [value]), film.size()[0]);
            move |pixel| POOLED_WEIGHT * sums.signed_around(pixel, reach)[0]
        };
        let sum = pooled(&|probe| probe.sum);
        PinholeDerivatives([0, 1].map(|axis| {
            let moment = pooled(&|probe| probe.moments[axis]);
            let mut slopes = vec![0.0; film.pixel_count()];
            for (pixel, probe) in probes {
                // A slope g per radius has the moment 2·d²·g = g, and the sum of four points 4.
                let slope = 4.0 * (probe.moments[axis] + moment(*pixel)) / (probe.sum + sum(*pixel));
                slopes[*pixel] = if slope.is_finite() { slope } else { 0.0 };
            }
            lattice.fill(&mut slopes, nodes, |weight| weight);
            slopes
        }))
    }
}

/// Weight of the probes around a probe relative to its own.
const POOLED_WEIGHT: f64 = 0.01;

#[cfg(test)]
mod tests {
    use super::*;

    impl PinholeDerivatives {
        pub(crate) fn zero(film: &UnblurredFilm) -> PinholeDerivatives {
            PinholeDerivatives([(); 2].map(|()| vec![0.0; film.pixel_count()]))
        }
    }

    #[test]
    fn values_of_scattered_rays_are_no_derivatives() {
        let of = |values: [f64; 4]| {
            let mut values = values.into_iter();
            let probe = PinholeProbe::new(|_| values.next().expect("four points"));
            probe.smooth_with(|| probe).sum
        };
        assert_eq!(of([1.0, 1.1, 0.98, 1.12]), 4.2);
        // One ray is bright, two are, or nothing is seen along one axis.
        for values in [[1.0, 9.0, 1.0, 1.0], [9.0, 1.0, 1.0, 9.0], [1.0, 1.0, 0.0, 0.0]] {
            assert_eq!(of(values), 0.0, "{values:?}");
        }
    }

    #[test]
    fn derivatives_on_which_two_probes_disagree_are_noise() {
        let of = |slope: f64| PinholeProbe::new(|p| 1.0 + slope * p.x);
        let kept = |first: f64, second: f64| of(first).smooth_with(|| of(second)).moments[0];
        assert!((kept(0.2, 0.2) - 0.2).abs() < 1e-12);
        assert!(kept(0.2, 0.19) > 0.19);
        assert_eq!([kept(0.2, 0.0), kept(0.2, -0.1)], [0.0; 2]);
    }

    #[test]
    fn probes_find_the_derivatives() {
        let probe = PinholeProbe::new(|p| 2.0 * (1.0 + 0.1 * p.x - 0.3 * p.y + 0.2 * p.x * p.x));
        let slopes = probe.moments.map(|moment| 4.0 * moment / probe.sum);
        // The sum has the quadratic term as well.
        let mean = 1.0 + 0.2 * 0.5 * PinholeProbe::DISTANCE.powi(2);
        assert!((slopes[0] * mean - 0.1).abs() < 1e-12 && (slopes[1] * mean + 0.3).abs() < 1e-12, "{slopes:?}");
    }
}
