//! Reflection that is a smooth function of the direction of light, for many directions at one point.

use crate::bsdf::{Bsdf, FresnelCoat, Highlight};
use crate::lobe_moments::{LobeShape, MomentSum};
use glam::DVec3;
use radsight_light::{DiskFrame, DiskNodes};
use std::f64::consts::{FRAC_1_PI, PI};

/// Diffuse reflection, with or without the Gaussian retroreflecting lobe. Its values are those of
/// [`Bsdf::eval`], for a fraction of the time.
#[derive(Clone, Copy, Debug)]
pub struct SmoothLobe<const BANDS: usize> {
    shape: LobeShape,
    /// Diffuse reflectance / π.
    diffuse: [f64; BANDS],
    /// The lobe at its peak, times the cosine: ρ_s/(4πα²), 1/sr.
    peak: [f64; BANDS],
}

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
            shape: LobeShape {
                outgoing: self.outgoing,
                normal: self.normal,
                diffuse_normal: self.diffuse_normal,
                curvature,
            },
            diffuse: self.diffuse.map(|band| band * FRAC_1_PI),
            peak,
        })
    }
}

impl<const BANDS: usize> SmoothLobe<BANDS> {
    /// BRDF times the cosine of incidence, for a unit direction towards the light, 1/sr.
    #[inline]
    #[must_use]
    pub fn value(&self, incident: DVec3) -> [f64; BANDS] {
        let [diffuse, lobe] = self.shape.at(incident);
        std::array::from_fn(|band| self.diffuse[band] * diffuse + self.peak[band] * lobe)
    }

    /// Radiance scattered to the viewer from the nodes of a disk light. Its radiance is a linear
    /// function of the coordinates in its plane relative to its radius: the value at the centre, and
    /// both slopes. `focal` is the focal distance of a spotlight, and 0 for other lights.
    #[inline]
    #[must_use]
    pub fn scattered(
        &self,
        (nodes, disk): (&DiskNodes, DiskFrame),
        focal: f64,
        radiance: [[f64; BANDS]; 3],
    ) -> [f64; BANDS] {
        let sum = MomentSum { nodes: nodes.groups(), disk, focal: focal.max(0.0), shape: self.shape };
        let moments = sum.moments();
        std::array::from_fn(|band| {
            let of = |integrals: [f64; 3]| (0..3).map(|term| radiance[term][band] * integrals[term]).sum::<f64>();
            self.diffuse[band] * of(moments.diffuse) + self.peak[band] * of(moments.lobe)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Frame;
    use crate::sample::PdfRequest;
    use crate::specular_threshold::BelowThreshold;
    use radsight_retro::Paper1991;

    const NORMAL: DVec3 = DVec3::new(0.0, 0.6, 0.8);

    fn sheet(spread: f64) -> Bsdf<'static, 2> {
        Bsdf {
            outgoing: DVec3::new(0.3, 0.2, 1.0).normalize(),
            normal: NORMAL,
            frame: Frame::new(NORMAL),
            diffuse_normal: DVec3::new(0.0, 0.1, 1.0).normalize(),
            diffuse: [0.2, 0.4],
            coat: FresnelCoat::None,
            highlight: Highlight::Retro(Paper1991 { reflectance: [0.5, 0.1], spread }),
            below_threshold: BelowThreshold::NOTHING,
            mirror: [0.0; 2],
            transmission: None,
            indirect_ignores_texture: false,
        }
    }

    #[test]
    fn values_are_those_of_the_whole_bsdf() {
        for spread in [1e-4, 3e-3, 0.02, 0.5, 2.0] {
            let bsdf = sheet(spread);
            let lobe = bsdf.smooth_lobe().expect("nothing else scatters");
            let (x, y) = bsdf.outgoing.any_orthonormal_pair();
            for step in 0..400 {
                // From the peak to beyond the horizon.
                let (angle, azimuth) = (f64::from(step) / 130.0 * (4.0 * spread).min(1.0), f64::from(step));
                let aside = (x * azimuth.cos() + y * azimuth.sin()) * angle.sin();
                let incident = (bsdf.outgoing * angle.cos() + aside).normalize();
                let whole = bsdf.eval(incident, 1.0, PdfRequest::Unused, &mut Default::default());
                for (band, value) in lobe.value(incident).into_iter().enumerate() {
                    let expected = whole.diffuse[band] + whole.highlight[band];
                    assert!((value - expected).abs() <= 1e-11 * expected, "{value} for {expected} at {angle} rad");
                }
            }
        }
    }

    #[test]
    fn a_disk_scatters_the_sum_over_its_nodes() {
        let radiance = [[1.0, 2.0], [0.3, -0.5], [-0.2, 0.4]];
        for (spread, radius, focal) in [(3e-3, 0.01, 0.0), (0.05, 0.02, 3.0), (0.5, 0.6, 0.0), (2.0, 1.5, 0.2)] {
            let bsdf = sheet(spread);
            let lobe = bsdf.smooth_lobe().expect("nothing else scatters");
            // Tilted, and partly below the horizon if it is large.
            let (along, across) = DVec3::new(0.1, 0.4, -1.0).normalize().any_orthonormal_pair();
            let (center, normal) = (2.0 * bsdf.outgoing + DVec3::new(0.0, radius, 0.0), across.cross(along));
            let normal = if normal.dot(center) < 0.0 { normal } else { -normal };
            let (mut nodes, mut expected) = (DiskNodes::default(), [0.0; 2]);
            for node in 0..10 {
                let (x, y) = (f64::from(node * 7 % 10) / 5.0 - 0.9, f64::from(node * 3 % 10) / 5.0 - 0.9);
                let area = 0.1 + f64::from(node);
                nodes.push(x * radius, y * radius, area);
                let offset = center + radius * (x * along + y * across);
                let (distance, direction) = (offset.length(), offset.normalize());
                let focus = (distance / (distance + focal)).powi(2);
                let share = area * focus * (-direction.dot(normal)).max(0.0) / (distance * distance);
                for (band, value) in lobe.value(direction).into_iter().enumerate() {
                    expected[band] +=
                        share * value * (radiance[0][band] + x * radiance[1][band] + y * radiance[2][band]);
                }
            }
            let disk = DiskFrame { center, axes: [along, across], normal, radius };
            let scattered = lobe.scattered((&nodes, disk), focal, radiance);
            for (value, expected) in scattered.into_iter().zip(expected) {
                assert!((value / expected - 1.0).abs() < 1e-11, "{value} for {expected}, spread {spread}");
            }
        }
    }
}
