//! MERL's tables.

use radsight_brdf_sdk::{Band, DVec3, angle_between, cosine_hemisphere, cosine_pdf, rgb_of_band};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const THETA_HALF: usize = 90;
const THETA_DIFFERENCE: usize = 90;
const PHI_DIFFERENCE: usize = 180;
const CELLS: usize = THETA_HALF * THETA_DIFFERENCE * PHI_DIFFERENCE;
/// Factors of the stored red, green and blue.
const SCALES: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];
/// Fraction of the samples that follow the measured distribution of half vectors; the others follow
/// the cosine.
const HALF_VECTOR_SHARE: f64 = 0.7;

/// A measured material.
pub(crate) struct Measurement {
    /// f in 1/sr for each band and cell.
    bands: Vec<Vec<f32>>,
    /// Mean f of all bands at each θ_h, normalised to a density of half vectors.
    half_density: Vec<f64>,
    /// Cumulative probability of θ_h at the end of each cell.
    half_cumulative: Vec<f64>,
}

/// Rusinkiewicz's coordinates.
struct Coordinates {
    theta_half: f64,
    theta_difference: f64,
    phi_difference: f64,
}

impl Measurement {
    /// Reads a file.
    pub(crate) fn read(bytes: &[u8], bands: &[Band], factor: f64) -> Result<Self, String> {
        const HEADER: usize = 12;
        let size = |k: usize| bytes.get(4 * k..4 * k + 4).and_then(|b| b.try_into().ok()).map(i32::from_le_bytes);
        let expected = [THETA_HALF, THETA_DIFFERENCE, PHI_DIFFERENCE].map(|n| i32::try_from(n).ok());
        if [size(0), size(1), size(2)] != expected {
            return Err("it is no MERL file: it does not begin with 90, 90, 180".to_owned());
        }
        let needed = HEADER + 3 * CELLS * 8;
        if bytes.len() < needed {
            return Err(format!("it has {} bytes, expected {needed}", bytes.len()));
        }
        let channel = |channel: usize| -> Vec<f32> {
            let scale = SCALES[channel] * factor;
            let numbers = bytes[HEADER + channel * CELLS * 8..][..CELLS * 8].chunks_exact(8);
            // Missing measurements are negative.
            numbers
                .map(|b| (f64::from_le_bytes(b.try_into().unwrap_or_default()) * scale).clamp(0.0, 1e9) as f32)
                .collect()
        };
        let bands = (0..bands.len()).map(|band| channel(rgb_of_band(bands, band))).collect();
        Ok(Measurement::with_density(bands))
    }

    fn with_density(bands: Vec<Vec<f32>>) -> Self {
        let mean = |row: usize| -> f64 {
            // Values at grazing angles are unreliable, and contribute little.
            let cells = row * THETA_DIFFERENCE * PHI_DIFFERENCE..(row * THETA_DIFFERENCE + 80) * PHI_DIFFERENCE;
            let count = cells.len() * bands.len();
            bands.iter().flat_map(|band| &band[cells.clone()]).map(|&value| f64::from(value)).sum::<f64>()
                / count as f64
        };
        let mut half_density: Vec<f64> = (0..THETA_HALF).map(mean).collect();
        if half_density.iter().sum::<f64>() <= 0.0 {
            half_density.fill(1.0);
        }
        // ∫ cos θ dω over a ring is π (sin² θ₂ − sin² θ₁).
        let rings: Vec<f64> = (0..THETA_HALF).map(|row| PI * (sine_squared(row + 1) - sine_squared(row))).collect();
        let total: f64 = half_density.iter().zip(&rings).map(|(density, ring)| density * ring).sum();
        half_density.iter_mut().for_each(|density| *density /= total);
        let mut sum = 0.0;
        let half_cumulative = half_density
            .iter()
            .zip(&rings)
            .map(|(density, ring)| {
                sum += density * ring;
                sum
            })
            .collect();
        Measurement { bands, half_density, half_cumulative }
    }

    pub(crate) fn value(&self, outgoing: DVec3, incident: DVec3, values: &mut [f64]) {
        if outgoing.z <= 0.0 || incident.z <= 0.0 {
            return values.fill(0.0);
        }
        let corners = corners(&coordinates(outgoing, incident));
        for (value, band) in values.iter_mut().zip(&self.bands) {
            *value = corners.iter().map(|&(cell, share)| share * f64::from(band[cell])).sum();
        }
    }

    pub(crate) fn pdf(&self, outgoing: DVec3, incident: DVec3) -> f64 {
        if outgoing.z <= 0.0 || incident.z <= 0.0 {
            return 0.0;
        }
        let sum = outgoing + incident;
        let half = sum.normalize();
        let theta_half = half.x.hypot(half.y).atan2(half.z);
        let row = (half_row(theta_half) as usize).min(THETA_HALF - 1);
        // For unit vectors h·o = |o + i|/2.
        let half_pdf = self.half_density[row] * half.z / (2.0 * sum.length());
        HALF_VECTOR_SHARE * half_pdf + (1.0 - HALF_VECTOR_SHARE) * cosine_pdf(incident)
    }

    pub(crate) fn sample_direction(&self, outgoing: DVec3, u: [f64; 3]) -> Option<DVec3> {
        if outgoing.z <= 0.0 {
            return None;
        }
        if u[2] >= HALF_VECTOR_SHARE {
            return Some(cosine_hemisphere(u[0], u[1]));
        }
        let row = self.half_cumulative.partition_point(|&sum| sum <= u[0]).min(THETA_HALF - 1);
        let below = if row == 0 { 0.0 } else { self.half_cumulative[row - 1] };
        let share = ((u[0] - below) / (self.half_cumulative[row] - below)).clamp(0.0, 1.0);
        let (low, high) = (sine_squared(row), sine_squared(row + 1));
        let sine_squared = low + share * (high - low);
        let (sin, cos) = (TAU * u[1]).sin_cos();
        let sine = sine_squared.sqrt();
        let half = DVec3::new(sine * cos, sine * sin, (1.0 - sine_squared).max(0.0).sqrt());
        Some((half * (2.0 * half.dot(outgoing)) - outgoing).normalize())
    }
}

/// sin² of θ_h where a row of cells begins.
fn sine_squared(row: usize) -> f64 {
    let share = row as f64 / THETA_HALF as f64;
    (FRAC_PI_2 * share * share).sin().powi(2)
}

/// Fractional row of θ_h.
fn half_row(theta_half: f64) -> f64 {
    THETA_HALF as f64 * (theta_half / FRAC_PI_2).max(0.0).sqrt()
}

fn coordinates(outgoing: DVec3, incident: DVec3) -> Coordinates {
    let half = (outgoing + incident).normalize();
    let sine = half.x.hypot(half.y);
    let (cos_phi, sin_phi) = if sine > 0.0 { (half.x / sine, half.y / sine) } else { (1.0, 0.0) };
    // The incident direction, rotated so that the half vector is the normal: about z, then about y.
    let (x, y) = (incident.x * cos_phi + incident.y * sin_phi, incident.y * cos_phi - incident.x * sin_phi);
    let difference_x = x * half.z - incident.z * sine;
    Coordinates {
        theta_half: sine.atan2(half.z),
        theta_difference: 0.5 * angle_between(outgoing, incident),
        phi_difference: y.atan2(difference_x).rem_euclid(PI),
    }
}

/// The eight cells around a point, and their weights.
fn corners(coordinates: &Coordinates) -> [(usize, f64); 8] {
    let clamped = |place: f64, count: usize| {
        let place = (place - 0.5).clamp(0.0, count as f64 - 1.0);
        let low = (place as usize).min(count - 2);
        (low, low + 1, place - low as f64)
    };
    let (half, half_next, half_share) = clamped(half_row(coordinates.theta_half), THETA_HALF);
    let (difference, difference_next, difference_share) =
        clamped(coordinates.theta_difference / FRAC_PI_2 * THETA_DIFFERENCE as f64, THETA_DIFFERENCE);
    // φ_d has the period π.
    let place = coordinates.phi_difference / PI * PHI_DIFFERENCE as f64 - 0.5;
    let phi = (place.floor().rem_euclid(PHI_DIFFERENCE as f64) as usize).min(PHI_DIFFERENCE - 1);
    let (phi_next, phi_share) = ((phi + 1) % PHI_DIFFERENCE, place - place.floor());
    let mut all = [(0, 0.0); 8];
    let mut index = 0;
    for (row, row_share) in [(half, 1.0 - half_share), (half_next, half_share)] {
        for (column, column_share) in [(difference, 1.0 - difference_share), (difference_next, difference_share)] {
            for (turn, turn_share) in [(phi, 1.0 - phi_share), (phi_next, phi_share)] {
                all[index] =
                    ((row * THETA_DIFFERENCE + column) * PHI_DIFFERENCE + turn, row_share * column_share * turn_share);
                index += 1;
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: [Band; 1] = [Band { centre_m: 650e-9, low_m: 640e-9, high_m: 660e-9 }];

    /// A file with the values `f(θ_h, θ_d, φ_d)` at the centres of the cells.
    fn file(f: impl Fn(f64, f64, f64) -> f64) -> Vec<u8> {
        let mut bytes: Vec<u8> = [90i32, 90, 180].into_iter().flat_map(i32::to_le_bytes).collect();
        for scale in SCALES {
            for cell in 0..CELLS {
                let (phi, rest) = (cell % PHI_DIFFERENCE, cell / PHI_DIFFERENCE);
                let (difference, half) = (rest % THETA_DIFFERENCE, rest / THETA_DIFFERENCE);
                let share = (half as f64 + 0.5) / 90.0;
                let value = f(
                    FRAC_PI_2 * share * share,
                    FRAC_PI_2 * (difference as f64 + 0.5) / 90.0,
                    PI * (phi as f64 + 0.5) / 180.0,
                );
                bytes.extend((value / scale).to_le_bytes());
            }
        }
        bytes
    }

    fn at(measurement: &Measurement, outgoing: DVec3, incident: DVec3) -> f64 {
        let mut value = [0.0];
        measurement.value(outgoing, incident, &mut value);
        value[0]
    }

    #[test]
    fn a_tabulated_function_comes_back() {
        let function =
            |half: f64, difference: f64, phi: f64| (-half * half / 0.1).exp() + difference * (2.0 + (2.0 * phi).sin());
        let measurement = Measurement::read(&file(function), &RED, 1.0).unwrap();
        for (outgoing, incident) in [
            (DVec3::new(0.3, 0.1, 0.9), DVec3::new(-0.2, 0.2, 0.8)),
            (DVec3::new(0.5, -0.6, 0.5), DVec3::new(0.4, 0.7, 0.3)),
        ] {
            let (outgoing, incident) = (outgoing.normalize(), incident.normalize());
            let c = coordinates(outgoing, incident);
            let right = function(c.theta_half, c.theta_difference, c.phi_difference);
            let found = at(&measurement, outgoing, incident);
            assert!((found / right - 1.0).abs() < 2e-3, "{found}, expected {right}");
            assert!((at(&measurement, incident, outgoing) - found).abs() < 1e-9 * found);
        }
    }

    /// Coordinates by rotation of vectors, as Rusinkiewicz defines them.
    #[test]
    fn coordinates_are_those_of_the_rotated_frame() {
        let half = DVec3::new(0.3, 0.4, (1.0f64 - 0.25).sqrt());
        let (theta, phi) = (0.5f64.asin(), 0.4f64.atan2(0.3));
        let (theta_d, phi_d) = (0.7f64, 1.1f64);
        let local = DVec3::new(theta_d.sin() * phi_d.cos(), theta_d.sin() * phi_d.sin(), theta_d.cos());
        let turn = glam_rotation(phi, theta);
        let incident = turn(local);
        let outgoing = half * (2.0 * half.dot(incident)) - incident;
        let found = coordinates(outgoing, incident);
        assert!((found.theta_half - theta).abs() < 1e-12);
        assert!((found.theta_difference - theta_d).abs() < 1e-12);
        assert!((found.phi_difference - phi_d).abs() < 1e-12);
    }

    /// Rotation about y by θ, then about z by φ.
    fn glam_rotation(phi: f64, theta: f64) -> impl Fn(DVec3) -> DVec3 {
        move |v| {
            let x = v.x * theta.cos() + v.z * theta.sin();
            let z = v.z * theta.cos() - v.x * theta.sin();
            DVec3::new(x * phi.cos() - v.y * phi.sin(), x * phi.sin() + v.y * phi.cos(), z)
        }
    }

    #[test]
    fn other_files_are_refused() {
        assert_eq!(
            Measurement::read(b"", &RED, 1.0).err().unwrap(),
            "it is no MERL file: it does not begin with 90, 90, 180"
        );
        let short: Vec<u8> = [90i32, 90, 180].into_iter().flat_map(i32::to_le_bytes).collect();
        assert_eq!(Measurement::read(&short, &RED, 1.0).err().unwrap(), "it has 12 bytes, expected 34992012");
    }
}
