//! Rotational and translational irradiance gradients (Ward and Heckbert 1992).
//!
//! When the normal turns, each ray keeps its radiance and changes its cosine.
//!
//! When the point moves, the nearer of two neighbouring cells moves relative to the farther one.
//! The change of irradiance is the difference of their radiances times the speed of the edge
//! between them.

use crate::bands::mean;
use crate::emitter::GatherHit;
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

/// The tangents of rays have a variance that diverges at the horizon. They are replaced by their
/// means over rings of about this many times as many cells as there are rays.
const CELLS_PER_RAY: usize = 64;

/// Maximum gradient by a single ray, relative to the irradiance from all: a rare bright ray near the
/// horizon is noise.
const MAX_GRADIENT_OF_A_RAY: f64 = 3.0;

/// The change of the irradiance per radian, in scene coordinates: a ray at the angle θ to the unit
/// normal changes its share by tan θ per radian towards it.
pub(crate) fn rotation<const BANDS: usize>(normal: DVec3, hits: &[GatherHit<BANDS>]) -> [DVec3; BANDS] {
    let tangents = Hemisphere::with_divisions(CELLS_PER_RAY * hits.len()).mean_tangents();
    let most = MAX_GRADIENT_OF_A_RAY * hits.iter().map(|hit| mean(&hit.irradiance)).sum::<f64>();
    let mut rotation = [DVec3::ZERO; BANDS];
    for hit in hits {
        let axis = normal.cross(hit.direction);
        let squared_sine = axis.length_squared();
        let share = mean(&hit.irradiance);
        if squared_sine == 0.0 || share <= 0.0 {
            continue;
        }
        let ring = ((squared_sine * tangents.len() as f64) as usize).min(tangents.len() - 1);
        let turn = axis * (tangents[ring].min(most / share) / squared_sine.sqrt());
        for (sum, irradiance) in rotation.iter_mut().zip(hit.irradiance) {
            *sum += turn * irradiance;
        }
    }
    rotation
}

impl<const BANDS: usize> Gradients<BANDS> {
    /// The translation; the rotation is 0.
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
        let across = unit(step * azimuth as f64 + 0.5 * PI);
        let before = (azimuth + azimuths - 1) % azimuths;
        for ring in 0..rings {
            let here = &seen[ring * azimuths + azimuth];
            let (inner, outer) = (hemisphere.edge_sine(ring), hemisphere.edge_sine(ring + 1));
            let with_ungathered = &seen[ring * azimuths + before];
            let side = across * ((outer - inner) / here.distance.min(with_ungathered.distance));
            for band in 0..BANDS {
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
