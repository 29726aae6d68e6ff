//! Rotational and translational irradiance gradients (Ward and Heckbert 1992).
//!
//! When the point moves, the nearer of two neighbouring cells moves relative to the farther one.
//! The change of irradiance is the difference of their radiances times the speed of the edge
//! between them.

use crate::hemisphere::{GatheredRadiance, Hemisphere};
use crate::stored::store_fields;
use glam::DVec3;
use std::f64::consts::PI;

/// Gradients in the local frame, one per band; both lie in the tangent plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Gradients<const BANDS: usize> {
    /// Change per radian; its direction is the axis of rotation.
    pub(crate) rotation: [DVec3; BANDS],
    /// Change per unit length.
    pub(crate) translation: [DVec3; BANDS],
}

store_fields!(Gradients: rotation, translation);

impl<const BANDS: usize> Gradients<BANDS> {
    pub(crate) fn new(hemisphere: &Hemisphere, seen: &[GatheredRadiance<BANDS>]) -> Self {
        let mut gradients = Gradients { rotation: [DVec3::ZERO; BANDS], translation: [DVec3::ZERO; BANDS] };
        for azimuth in 0..hemisphere.azimuths {
            gradients.add_azimuth(hemisphere, seen, azimuth);
        }
        gradients
    }

    fn add_azimuth(&mut self, hemisphere: &Hemisphere, seen: &[GatheredRadiance<BANDS>], azimuth: usize) {
        let Hemisphere { rings, azimuths } = *hemisphere;
        let unit = |angle: f64| DVec3::new(angle.cos(), angle.sin(), 0.0);
        let step = 2.0 * PI / azimuths as f64;
        // Outwards through the centre of the cells; along the edge's motion when the point moves
        // across it.
        let outward = unit(step * (azimuth as f64 + 0.5));
        let turn_axis = unit(step * (azimuth as f64 + 0.5) + 0.5 * PI);
        let across = unit(step * azimuth as f64 + 0.5 * PI);
        let before = (azimuth + azimuths - 1) % azimuths;
        for ring in 0..rings {
            let here = &seen[ring * azimuths + azimuth];
            let center = ((ring as f64 + 0.5) / rings as f64).sqrt();
            let tangent = center / (1.0 - center * center).sqrt();
            let turn = turn_axis * (tangent * PI / (rings * azimuths) as f64);
            let (inner, outer) = (hemisphere.edge_sine(ring), hemisphere.edge_sine(ring + 1));
            let with_ungathered = &seen[ring * azimuths + before];
            let side = across * ((outer - inner) / here.distance.min(with_ungathered.distance));
            for band in 0..BANDS {
                self.rotation[band] += turn * here.radiance[band];
                self.translation[band] += side * (here.radiance[band] - with_ungathered.radiance[band]);
            }
            if ring > 0 {
                let below = &seen[(ring - 1) * azimuths + azimuth];
                let motion = step * inner * (1.0 - inner * inner) / here.distance.min(below.distance);
                for band in 0..BANDS {
                    let difference = here.radiance[band] - below.radiance[band];
                    self.translation[band] += outward * (motion * difference);
                }
            }
        }
    }
}
