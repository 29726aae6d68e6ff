//! RGL's adaptive tables: Dupuy and Jakob, 2018, section 3.

use crate::tensor_file::{self, Field};
use crate::warp::{Grids, Mix, Warp};
use radsight_brdf_sdk::{Band, DVec3, rgb_of_band, sample_band};
use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, PI, TAU};

/// A measured material.
#[derive(Debug)]
pub(crate) struct Measurement {
    /// Azimuths and polar angles of the measured directions, radians, ascending.
    phi: Vec<f64>,
    theta: Vec<f64>,
    isotropic: bool,
    /// 2 or 4 if the material is symmetric and only a half or a quarter of the azimuths was
    /// measured.
    symmetry: f64,
    /// Distribution of normals D, and σ, the projected area of the visible facets.
    facets: Grids,
    projected_area: Grids,
    /// Samples facet normals visible from the outgoing direction …
    visible: Warp,
    /// … from points sampled by the luminance that they reflect.
    luminance: Warp,
    /// The remaining factor of f after the facets, for each band.
    bands: Vec<Grids>,
}

impl Measurement {
    /// Reads a file.
    pub(crate) fn read(bytes: &[u8], bands: &[Band], factor: f64) -> Result<Self, String> {
        let fields = tensor_file::read(bytes)?;
        let axis = |name: &str| -> Result<Vec<f64>, String> {
            let field = find(&fields, name, 1)?;
            let numbers: Vec<f64> = field.numbers.iter().map(|&number| f64::from(number)).collect();
            let rising = numbers.windows(2).all(|pair| pair[0] < pair[1]) && numbers.iter().all(|x| x.is_finite());
            (rising && !numbers.is_empty())
                .then_some(numbers)
                .ok_or_else(|| format!("the numbers of \"{name}\" do not rise"))
        };
        let (phi, theta) = (axis("phi_i")?, axis("theta_i")?);
        let directions = phi.len() * theta.len();
        let flat = |name: &str| grids(find(&fields, name, 2)?, 1, 0);
        let by_direction = |name: &str| grids(find(&fields, name, 4)?, directions, 2);
        let isotropic = phi.len() <= 2;
        let range = phi[phi.len() - 1] - phi[0];
        Ok(Measurement {
            isotropic,
            symmetry: if isotropic { 1.0 } else { (TAU / range).round() },
            facets: flat("ndf")?,
            projected_area: flat("sigma")?,
            visible: Warp::new(by_direction("vndf")?),
            luminance: Warp::new(by_direction("luminance")?),
            bands: read_bands(&fields, directions, bands, factor)?,
            phi,
            theta,
        })
    }

    /// Values, and the density of [`Measurement::sample_direction`].
    pub(crate) fn eval_pdf(&self, outgoing: DVec3, incident: DVec3, values: &mut [f64]) -> f64 {
        if outgoing.z <= 0.0 || incident.z <= 0.0 {
            values.fill(0.0);
            return 0.0;
        }
        let (outgoing, flip) = self.fold(outgoing);
        let incident = DVec3::new(incident.x * flip.0, incident.y * flip.1, incident.z);
        let sum = outgoing + incident;
        let half = sum.normalize();
        let (theta_o, phi_o) = angles(outgoing);
        let (theta_h, phi_h) = angles(half);
        let mix = self.mix(theta_o, phi_o);
        let turn = if self.isotropic { phi_h - phi_o } else { phi_h };
        let (x, y) = (theta_to_unit(theta_h), phi_to_unit(turn).rem_euclid(1.0));
        let (point, visible) = self.visible.invert(&mix, x, y);
        let area = self.projected_area.at(&ONLY, theta_to_unit(theta_o), phi_to_unit(phi_o));
        let facets = if area > 0.0 { self.facets.at(&ONLY, x, y) / (4.0 * area * incident.z) } else { 0.0 };
        for (value, band) in values.iter_mut().zip(&self.bands) {
            *value = facets * band.at(&mix, point.0, point.1);
        }
        let luminance = self.luminance.invert(&mix, point.0, point.1).1;
        // θ = π/2 x², φ = 2π y − π: a solid angle is 2π² x sin θ times the area of the unit square;
        // reflection adds 4 h·o = 2 |o + i|.
        let jacobian = 2.0 * PI * PI * x * half.x.hypot(half.y) * 2.0 * sum.length();
        visible * luminance / jacobian.max(1e-12)
    }

    pub(crate) fn sample_direction(&self, outgoing: DVec3, u: [f64; 3]) -> Option<DVec3> {
        if outgoing.z <= 0.0 {
            return None;
        }
        let (outgoing, flip) = self.fold(outgoing);
        let (theta_o, phi_o) = angles(outgoing);
        let mix = self.mix(theta_o, phi_o);
        let (x, y) = self.visible.sample(&mix, self.luminance.sample(&mix, (u[0], u[1])));
        let theta = FRAC_PI_2 * x * x;
        let phi = (2.0 * y - 1.0) * PI + if self.isotropic { phi_o } else { 0.0 };
        let half = DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
        let incident = (half * (2.0 * half.dot(outgoing)) - outgoing).normalize();
        Some(DVec3::new(incident.x * flip.0, incident.y * flip.1, incident.z))
    }

    /// The direction, mirrored into the measured range of azimuths, and the signs of the mirroring.
    fn fold(&self, outgoing: DVec3) -> (DVec3, (f64, f64)) {
        if self.symmetry < 2.0 {
            return (outgoing, (1.0, 1.0));
        }
        // The measured range has negative y, and negative x if it is a quarter.
        let sign = |coordinate: f64| if coordinate > 0.0 { -1.0 } else { 1.0 };
        let y = sign(outgoing.y);
        let x = if self.symmetry >= 4.0 { sign(outgoing.x) } else { y };
        (DVec3::new(outgoing.x * x, outgoing.y * y, outgoing.z), (x, y))
    }

    fn mix(&self, theta: f64, phi: f64) -> Mix {
        let ((p, p_next, p_share), (t, t_next, t_share)) = (neighbours(&self.phi, phi), neighbours(&self.theta, theta));
        let index = |p: usize, t: usize| p * self.theta.len() + t;
        [
            (index(p, t), (1.0 - p_share) * (1.0 - t_share)),
            (index(p, t_next), (1.0 - p_share) * t_share),
            (index(p_next, t), p_share * (1.0 - t_share)),
            (index(p_next, t_next), p_share * t_share),
        ]
    }
}

/// For grids without parameters.
const ONLY: Mix = [(0, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)];

fn find<'a>(fields: &'a [Field], name: &str, dimensions: usize) -> Result<&'a Field, String> {
    let field = fields.iter().find(|field| field.name == name).ok_or_else(|| format!("it has no field \"{name}\""))?;
    if field.shape.len() == dimensions {
        Ok(field)
    } else {
        Err(format!("field \"{name}\" has {} dimensions, expected {dimensions}", field.shape.len()))
    }
}

/// The field as grids over its last two dimensions; the dimensions before `skip` must multiply to
/// `parameters`.
fn grids(field: &Field, parameters: usize, skip: usize) -> Result<Grids, String> {
    let (rows, columns) = (field.shape[skip], field.shape[skip + 1]);
    Grids::new(field.numbers.clone(), parameters, rows, columns)
        .ok_or_else(|| format!("field \"{}\" has the sizes {:?}, which do not fit the others", field.name, field.shape))
}

fn read_bands(fields: &[Field], directions: usize, bands: &[Band], factor: f64) -> Result<Vec<Grids>, String> {
    let spectral = fields.iter().any(|field| field.name == "spectra");
    let field = find(fields, if spectral { "spectra" } else { "rgb" }, 5)?;
    let [_, _, channels, rows, columns] = field.shape[..] else { return Err("it has no values".to_owned()) };
    let grid = rows * columns;
    if field.numbers.len() != directions.saturating_mul(channels).saturating_mul(grid) || (!spectral && channels != 3) {
        return Err(format!("field \"{}\" has the sizes {:?}, which do not fit the others", field.name, field.shape));
    }
    let wavelengths = if spectral { find(fields, "wavelengths", 1)?.numbers.clone() } else { Vec::new() };
    if spectral && (wavelengths.len() != channels || channels == 0) {
        return Err("there are not as many wavelengths as spectra".to_owned());
    }
    let band_grids = |band: usize| {
        let shares =
            if spectral { channel_shares(&wavelengths, &bands[band]) } else { vec![(rgb_of_band(bands, band), 1.0)] };
        let mut numbers = vec![0.0f32; directions * grid];
        for (direction, numbers) in numbers.chunks_exact_mut(grid).enumerate() {
            for &(channel, share) in &shares {
                let from = &field.numbers[(direction * channels + channel) * grid..][..grid];
                // Negative values come from colours outside the RGB gamut.
                let add = |(to, from): (&mut f32, &f32)| *to += (f64::from(from.max(0.0)) * share * factor) as f32;
                numbers.iter_mut().zip(from).for_each(add);
            }
        }
        Grids::new(numbers, directions, rows, columns).ok_or_else(|| "its grids are too small".to_owned())
    };
    (0..bands.len()).map(band_grids).collect()
}

/// The measured wavelengths (nanometres) that contribute to a band, and their weights.
fn channel_shares(wavelengths: &[f32], band: &Band) -> Vec<(usize, f64)> {
    let axis: Vec<f64> = wavelengths.iter().map(|&wavelength| f64::from(wavelength) * 1e-9).collect();
    let parts = sample_band(band);
    let mut shares = vec![0.0; axis.len()];
    for part in &parts {
        let (low, high, share) = neighbours(&axis, *part);
        shares[low] += (1.0 - share) / parts.len() as f64;
        shares[high] += share / parts.len() as f64;
    }
    shares.into_iter().enumerate().filter(|(_, share)| *share > 0.0).collect()
}

/// The two points of an ascending axis around a value, and the weight of the second; constant
/// outside the axis.
fn neighbours(axis: &[f64], place: f64) -> (usize, usize, f64) {
    let above = axis.partition_point(|&point| point <= place).clamp(1, axis.len().max(2) - 1).min(axis.len() - 1);
    let below = above.saturating_sub(1);
    if above == below {
        return (below, above, 0.0);
    }
    (below, above, ((place - axis[below]) / (axis[above] - axis[below])).clamp(0.0, 1.0))
}

/// Polar angle and azimuth.
fn angles(direction: DVec3) -> (f64, f64) {
    (direction.x.hypot(direction.y).atan2(direction.z), direction.y.atan2(direction.x))
}

fn theta_to_unit(theta: f64) -> f64 {
    (theta * FRAC_2_PI).sqrt()
}

fn phi_to_unit(phi: f64) -> f64 {
    phi / TAU + 0.5
}

#[cfg(test)]
#[path = "rgl_tests.rs"]
mod tests;
