//! Reflection that is a smooth function of the direction of light, for many directions at one point.

use crate::bsdf::{Bsdf, FresnelCoat, Highlight};
use glam::DVec3;
use std::f64::consts::{FRAC_1_PI, PI};

/// Diffuse reflection, with or without the Gaussian retroreflecting lobe. Its values are those of
/// [`Bsdf::eval`], for a fraction of the time.
#[derive(Clone, Copy, Debug)]
pub struct SmoothLobe<const BANDS: usize> {
    outgoing: DVec3,
    normal: DVec3,
    diffuse_normal: DVec3,
    /// Diffuse reflectance / π.
    diffuse: [f64; BANDS],
    /// The lobe at its peak, times the cosine: ρ_s/(4πα²), 1/sr.
    peak: [f64; BANDS],
    /// 1/(4α²), 1/rad².
    curvature: f64,
}

/// Squared length of the chord up to which a series gives the squared angle, to 2·10⁻¹³ of it.
const SHORT_CHORD: f64 = 0.02;

impl<const BANDS: usize> Bsdf<'_, BANDS> {
    /// The reflection, if nothing else than its smooth lobe scatters light.
    #[inline]
    #[must_use]
    pub fn smooth_lobe(&self) -> Option<SmoothLobe<BANDS>> {
        if self.coat != FresnelCoat::None || self.transmission.is_some() {
            return None;
        }
        let (peak, curvature) = match &self.highlight {
            Highlight::None => ([0.0; BANDS], 0.0),
            Highlight::Retro(retro) => {
                let curvature = (4.0 * retro.spread * retro.spread).recip();
                (retro.reflectance.map(|band| band * curvature / PI), curvature)
            }
            _ => return None,
        };
        Some(SmoothLobe {
            outgoing: self.outgoing,
            normal: self.normal,
            diffuse_normal: self.diffuse_normal,
            diffuse: self.diffuse.map(|band| band * FRAC_1_PI),
            peak,
            curvature,
        })
    }
}

impl<const BANDS: usize> SmoothLobe<BANDS> {
    /// BRDF times the cosine of incidence, for a unit direction towards the light, 1/sr.
    #[inline]
    #[must_use]
    pub fn value(&self, incident: DVec3) -> [f64; BANDS] {
        let diffuse = self.diffuse_normal.dot(incident).max(0.0);
        let is_lit = self.curvature > 0.0 && self.normal.dot(incident) > 0.0;
        let lobe = if is_lit { (-self.curvature * self.squared_angle(incident)).exp() } else { 0.0 };
        std::array::from_fn(|band| self.diffuse[band] * diffuse + self.peak[band] * lobe)
    }

    /// Of the angle between the light and the viewer, rad²: 4·asin²(c/2) for a chord c.
    #[inline]
    fn squared_angle(&self, incident: DVec3) -> f64 {
        let chord = self.outgoing.distance_squared(incident);
        if chord < SHORT_CHORD {
            // 2·Σ c²ⁿ/(n²·(2n choose n)).
            chord * (1.0 + chord * (1.0 / 12.0 + chord * (1.0 / 90.0 + chord * (1.0 / 560.0 + chord / 3150.0))))
        } else {
            let angle = 2.0 * (0.5 * chord.sqrt()).min(1.0).asin();
            angle * angle
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Frame;
    use crate::sample::PdfRequest;
    use crate::specular_threshold::BelowThreshold;
    use radsight_retro::Paper1991;

    #[test]
    fn values_are_those_of_the_whole_bsdf() {
        let normal = DVec3::new(0.1, -0.2, 1.0).normalize();
        let outgoing = DVec3::new(0.3, 0.2, 1.0).normalize();
        for spread in [1e-4, 3e-3, 0.02, 0.5, 2.0] {
            let bsdf = Bsdf {
                outgoing,
                normal,
                frame: Frame::new(normal),
                diffuse_normal: DVec3::new(0.0, 0.1, 1.0).normalize(),
                diffuse: [0.2, 0.4],
                coat: FresnelCoat::None,
                highlight: Highlight::Retro(Paper1991 { reflectance: [0.5, 0.1], spread }),
                below_threshold: BelowThreshold::NOTHING,
                mirror: [0.0; 2],
                transmission: None,
            };
            let lobe = bsdf.smooth_lobe().expect("nothing else scatters");
            let (x, y) = outgoing.any_orthonormal_pair();
            for step in 0..400 {
                // From the peak to beyond the horizon.
                let (angle, azimuth) = (f64::from(step) / 130.0 * (4.0 * spread).min(1.0), f64::from(step));
                let aside = (x * azimuth.cos() + y * azimuth.sin()) * angle.sin();
                let incident = (outgoing * angle.cos() + aside).normalize();
                let whole = bsdf.eval(incident, 1.0, PdfRequest::Unused, &mut Default::default());
                for (band, value) in lobe.value(incident).into_iter().enumerate() {
                    let expected = whole.diffuse[band] + whole.highlight[band];
                    assert!((value - expected).abs() <= 1e-11 * expected, "{value} for {expected} at {angle} rad");
                }
            }
        }
    }
}
