//! The sky in patches: the Perez model evaluated for each patch at one time.
//!
//! The first of Reinhart's patches is the ground; rows follow from the horizon up, each from north
//! to east.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::facets::dot;
use crate::perez::{Conditions, SOLAR_CONSTANT, air_mass, clearness, eccentricity, relative_luminance};
use crate::weather::Quantity;
use radsight_sky::SkyDivision;
use radsight_units::photometry::WHITE_EFFICACY;

/// Extraterrestrial illuminance, lux.
const SOLAR_CONSTANT_LUX: f64 = 127_500.0;
/// Upper limits of the model: clearness from irradiance, from illuminance; and brightness.
const MOST_CLEARNESS: [f64; 2] = [11.9, 12.0];
const BRIGHTNESS: (f64, f64) = (0.01, 0.6);
/// Smallest zenith angle of the sun in the model; the largest is that of the horizon.
const LEAST_ZENITH_ANGLE: f64 = 3.0 * PI / 180.0;
/// Convergence criterion, W/m², and largest number of iterations for the irradiance of an
/// illuminance.
const SETTLED: f64 = 10.0;
const MOST_TRIALS: usize = 5;

/// A division of the sky.
#[derive(Clone, Debug)]
pub(crate) struct SkyPatches {
    /// Altitude and azimuth (from north to east) of the centre, radians, and solid angle, sr; the
    /// ground first.
    patches: Vec<[f64; 3]>,
}

/// Measured light at one time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Light {
    pub(crate) quantity: Quantity,
    /// On a surface that faces the sun, and on a horizontal one.
    pub(crate) direct: f64,
    pub(crate) diffuse: f64,
    /// Precipitable water, cm.
    pub(crate) water: f64,
    /// Day of the year, from 1.
    pub(crate) day: f64,
    /// Solar altitude, radians.
    pub(crate) altitude: f64,
}

/// The derived sky.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sky {
    conditions: Conditions,
    sun_zenith: f64,
    /// Direct normal irradiance, W/m².
    direct_irradiance: f64,
    diffuse_irradiance: f64,
    /// Direct normal illuminance, lux.
    pub(crate) direct_illuminance: f64,
    pub(crate) diffuse_illuminance: f64,
}

impl SkyPatches {
    pub(crate) fn new(subdivision: usize) -> SkyPatches {
        let sky = SkyDivision::new(u32::try_from(subdivision).unwrap_or(u32::MAX));
        let row_height = sky.row_height();
        let mut patches = vec![[-FRAC_PI_2, 0.0, TAU]];
        for row in 0..sky.rows() {
            let count = sky.columns(row);
            let [low, high] = [row, row + 1].map(|row| (row_height * f64::from(row)).sin());
            let altitude = row_height * (f64::from(row) + 0.5);
            let solid_angle = TAU * (high - low) / count as f64;
            patches.extend((0..count).map(|column| [altitude, TAU * column as f64 / count as f64, solid_angle]));
        }
        patches.push([FRAC_PI_2, 0.0, TAU * (1.0 - (0.5 * row_height).cos())]);
        SkyPatches { patches }
    }

    /// The solid angle of a patch, sr; the ground is patch 0.
    pub(crate) fn solid_angle(&self, patch: usize) -> f64 {
        self.patches[patch][2]
    }

    /// Number of patches, including the ground.
    pub(crate) fn len(&self) -> usize {
        self.patches.len()
    }

    /// Relative luminance of each patch except the ground, scaled to a horizontal illuminance of 1.
    pub(crate) fn luminances(&self, sky: &Sky, azimuth: f64) -> Vec<f64> {
        let parameters = sky.conditions.parameters(sky.sun_zenith);
        let (sin_sun, cos_sun) = sky.sun_zenith.sin_cos();
        let luminance = |[altitude, patch_azimuth, _]: &[f64; 3]| {
            let (sin, cos) = altitude.sin_cos();
            let cosine = cos_sun * sin + sin_sun * cos * (patch_azimuth - azimuth).cos();
            let angle = cosine.clamp(-1.0, 1.0).acos();
            relative_luminance(parameters, FRAC_PI_2 - altitude, angle).max(0.0)
        };
        let sky = &self.patches[1..];
        let mut luminances: Vec<f64> = sky.iter().map(luminance).collect();
        let horizontal = |luminances: &[f64]| -> f64 {
            sky.iter()
                .zip(luminances)
                .map(|([altitude, _, solid_angle], value)| altitude.sin() * solid_angle * value)
                .sum()
        };
        let mut total = horizontal(&luminances);
        if total.is_nan() || total <= 1e-6 {
            luminances.fill(1.0);
            total = PI;
        }
        luminances.iter_mut().for_each(|value| *value /= total);
        luminances
    }

    /// The patches of the sky nearest to a direction, with the cosines of their angles to it if it
    /// is a unit vector.
    pub(crate) fn nearest(&self, direction: [f64; 3], count: usize) -> Vec<(f64, usize)> {
        let nearness = |(index, patch): (usize, &[f64; 3])| (dot(towards(patch[0], patch[1]), direction), index);
        let mut nearest: Vec<(f64, usize)> = self.patches.iter().enumerate().skip(1).map(nearness).collect();
        nearest.sort_by(|a, b| b.0.total_cmp(&a.0));
        nearest.truncate(count);
        nearest
    }

    /// The patches nearest to the sun, and the radiance that an irradiance of 1 adds to each:
    /// distributed by proximity, over their own solid angle or a given one.
    pub(crate) fn around_sun(
        &self,
        (altitude, azimuth): (f64, f64),
        count: usize,
        solid_angle: Option<f64>,
    ) -> Vec<(usize, f64)> {
        let nearest = self.nearest(towards(altitude, azimuth), count);
        // As in Radiance, so that a patch that contains the sun does not get all of it.
        let weight = |cosine: f64| 1.0 / (1.002 - cosine);
        let total: f64 = nearest.iter().map(|(cosine, _)| weight(*cosine)).sum();
        let share = |(cosine, index): (f64, usize)| {
            (index, weight(cosine) / (total * solid_angle.unwrap_or(self.patches[index][2])))
        };
        nearest.into_iter().map(share).collect()
    }
}

impl Sky {
    pub(crate) fn new(light: &Light) -> Sky {
        let sun_zenith = (FRAC_PI_2 - light.altitude).clamp(LEAST_ZENITH_ANGLE, FRAC_PI_2);
        let Light { direct, diffuse, .. } = *light;
        let sky = |direct_irradiance, diffuse_irradiance, most| Sky {
            conditions: conditions(light, sun_zenith, [direct_irradiance, diffuse_irradiance], most),
            sun_zenith,
            direct_irradiance,
            diffuse_irradiance,
            direct_illuminance: direct,
            diffuse_illuminance: diffuse,
        };
        if light.quantity != Quantity::NormalIlluminance {
            let sky = sky(direct, diffuse, MOST_CLEARNESS[0]);
            let [direct_efficacy, diffuse_efficacy] = sky.efficacies(light.water);
            return Sky {
                direct_illuminance: direct * direct_efficacy,
                diffuse_illuminance: diffuse * diffuse_efficacy,
                ..sky
            };
        }
        // The efficacies depend on the unknown.
        let scale = SOLAR_CONSTANT / SOLAR_CONSTANT_LUX;
        let mut found = sky(direct * scale, diffuse * scale, MOST_CLEARNESS[1]);
        let mut before = [0.1; 2];
        for _ in 0..MOST_TRIALS {
            let changes = [found.direct_irradiance - before[0], found.diffuse_irradiance - before[1]];
            if changes.iter().all(|change| change.abs() <= SETTLED) {
                break;
            }
            before = [found.direct_irradiance, found.diffuse_irradiance];
            let [direct_efficacy, diffuse_efficacy] = found.efficacies(light.water);
            let direct = if direct_efficacy > 0.1 { direct / direct_efficacy } else { direct_efficacy };
            found = sky(direct, diffuse / diffuse_efficacy, MOST_CLEARNESS[1]);
        }
        found
    }

    /// Lumens per watt of direct and of diffuse light.
    fn efficacies(&self, water: f64) -> [f64; 2] {
        let Sky { conditions, sun_zenith, .. } = self;
        [conditions.direct_efficacy(*sun_zenith, water), conditions.diffuse_efficacy(*sun_zenith, water)]
    }

    /// The same sky with solar instead of visible radiation.
    pub(crate) fn solar(self) -> Sky {
        Sky {
            direct_illuminance: self.direct_irradiance * WHITE_EFFICACY,
            diffuse_illuminance: self.diffuse_irradiance * WHITE_EFFICACY,
            ..self
        }
    }
}

/// The unit direction of an altitude and an azimuth from north to east: components east, north and
/// up.
pub(crate) fn towards(altitude: f64, azimuth: f64) -> [f64; 3] {
    [altitude.cos() * azimuth.sin(), altitude.cos() * azimuth.cos(), altitude.sin()]
}

fn conditions(light: &Light, sun_zenith: f64, [direct, diffuse]: [f64; 2], most: f64) -> Conditions {
    let brightness = diffuse * air_mass(sun_zenith.to_degrees()) / (SOLAR_CONSTANT * eccentricity(light.day));
    let clearness = clearness(direct, diffuse, sun_zenith);
    let clearness = if clearness.is_nan() { 1.0 } else { clearness.clamp(1.0, most) };
    Conditions { clearness, brightness: brightness.clamp(BRIGHTNESS.0, BRIGHTNESS.1) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patches_cover_the_sky() {
        for (subdivision, count) in [(1, 146), (2, 578), (4, 2306)] {
            let patches = SkyPatches::new(subdivision);
            let total: f64 = patches.patches.iter().map(|patch| patch[2]).sum();
            assert_eq!(patches.len(), count);
            assert!((total - 2.0 * TAU).abs() < 1e-12, "{total}");
        }
    }

    #[test]
    fn the_sun_is_in_the_patches_around_it() {
        let patches = SkyPatches::new(1);
        let around = patches.around_sun((0.1, 96_f64.to_radians()), 4, None);
        assert_eq!(around[0].0, 9);
        let irradiance: f64 = around.iter().map(|(index, radiance)| radiance * patches.patches[*index][2]).sum();
        assert!((irradiance - 1.0).abs() < 1e-12);
    }
}
