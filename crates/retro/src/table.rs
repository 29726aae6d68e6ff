//! `table`: measured coefficients of retroreflection, as in data sheets and ASTM D4956.
//!
//! R_A is given on a grid of observation, entrance and rotation angles. Between grid points
//! `ln R_A` is linear in each angle. Below the smallest observation angle R_A is constant; above
//! the largest it falls as in the last interval, and by at least a half per width of that interval.
//! Entrance angles are taken without their sign; above the largest R_A falls linearly to zero at
//! 90°. Rotation angles are periodic in 360°.
//!
//! `f = R_A/(cos β · cos ν)`. Measured data are not made reciprocal.

use crate::coefficient::Geometry;
use crate::radial::{RadialDensity, logarithmic_angles};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A row of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Measurement geometry.
    pub geometry: Geometry,
    /// R_A, cd/(lx m²).
    pub coefficient: f64,
}

/// Why rows do not form a table.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum TableError {
    /// There are no rows.
    Empty,
    /// An angle or a coefficient is out of range: index of the row, and what was expected.
    Row(usize, &'static str),
    /// Two rows have the same angles; their indices.
    Twice(usize, usize),
    /// A combination of angles is missing.
    Missing(Geometry),
    /// Every coefficient is zero.
    Black,
}

impl std::fmt::Display for TableError {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            TableError::Empty => write!(out, "the table has no rows"),
            TableError::Row(row, expected) => write!(out, "row {} of the table: expected {expected}", row + 1),
            TableError::Twice(first, second) => {
                write!(out, "rows {} and {} of the table have the same angles", first + 1, second + 1)
            }
            TableError::Missing(at) => write!(
                out,
                "the table has no row at observation {:.6}°, entrance {:.6}°, rotation {:.6}°: every combination of its angles is needed",
                at.observation.to_degrees(),
                at.entrance.to_degrees(),
                at.rotation.to_degrees()
            ),
            TableError::Black => write!(out, "every coefficient of the table is zero"),
        }
    }
}

impl std::error::Error for TableError {}

/// A complete table.
#[derive(Clone, Debug)]
pub struct RetroTable {
    /// Observation angles, ascending, radians.
    observations: Vec<f64>,
    /// Entrance angles, ascending, without sign, radians.
    entrances: Vec<f64>,
    /// Rotation angles, ascending, 0…2π.
    rotations: Vec<f64>,
    /// `ln R_A`; the observation angle varies fastest, then the entrance angle.
    logarithms: Vec<f64>,
    /// Sampling density for each entrance angle, over all rotations.
    densities: Vec<RadialDensity>,
}

/// Angles closer than this are equal, radians.
const SAME: f64 = 1e-9;
/// Substitute for `ln R_A` of zero.
const DARK: f64 = -60.0;

impl RetroTable {
    /// Makes a table of rows.
    ///
    /// # Errors
    /// If the rows are not a full grid, or out of range: observation 0…90°, entrance −89…89°, R_A
    /// 0…1e6.
    pub fn new(rows: &[Row]) -> Result<RetroTable, TableError> {
        check_rows(rows)?;
        let axis = |angle: fn(&Geometry) -> f64| {
            let mut angles: Vec<f64> = rows.iter().map(|row| angle(&row.geometry)).collect();
            angles.sort_by(f64::total_cmp);
            angles.dedup_by(|a, b| (*a - *b).abs() < SAME);
            angles
        };
        let (observations, entrances) = (axis(|at| at.observation), axis(|at| at.entrance.abs()));
        let rotations = axis(|at| at.rotation.rem_euclid(TAU));
        let mut found: Vec<Option<usize>> = vec![None; observations.len() * entrances.len() * rotations.len()];
        for (index, row) in rows.iter().enumerate() {
            let at = row.geometry;
            let place =
                |axis: &[f64], angle: f64| axis.iter().position(|knot| (knot - angle).abs() < SAME).unwrap_or(0);
            let slot = (place(&rotations, at.rotation.rem_euclid(TAU)) * entrances.len()
                + place(&entrances, at.entrance.abs()))
                * observations.len()
                + place(&observations, at.observation);
            if let Some(first) = found[slot].replace(index) {
                return Err(TableError::Twice(first, index));
            }
        }
        let mut logarithms = Vec::with_capacity(found.len());
        for (slot, row) in found.iter().enumerate() {
            let (grid, observation) = (slot / observations.len(), slot % observations.len());
            let at = Geometry {
                observation: observations[observation],
                entrance: entrances[grid % entrances.len()],
                rotation: rotations[grid / entrances.len()],
            };
            let row = row.ok_or(TableError::Missing(at))?;
            logarithms.push(rows[row].coefficient.ln().max(DARK));
        }
        let mut table = RetroTable { observations, entrances, rotations, logarithms, densities: Vec::new() };
        table.densities = table.entrances.iter().map(|entrance| table.density_at(*entrance)).collect();
        Ok(table)
    }

    /// R_A in cd/(lx m²).
    #[must_use]
    pub fn coefficient(&self, at: Geometry) -> f64 {
        let entrance = at.entrance.abs();
        let last = self.entrances[self.entrances.len() - 1];
        let (first_entrance, entrance_share) = cell(&self.entrances, entrance.min(last));
        let (first_rotation, next_rotation, rotation_share) = self.rotation_cell(at.rotation.rem_euclid(TAU));
        let mut logarithm = 0.0;
        for (rotation, weight) in [(first_rotation, 1.0 - rotation_share), (next_rotation, rotation_share)] {
            for (entrance, share) in [(first_entrance, 1.0 - entrance_share), (first_entrance + 1, entrance_share)] {
                if weight * share > 0.0 {
                    logarithm += weight * share * self.along_observation(rotation, entrance, at.observation);
                }
            }
        }
        let falloff = if entrance > last { ((FRAC_PI_2 - entrance) / (FRAC_PI_2 - last)).max(0.0) } else { 1.0 };
        if logarithm <= 0.5 * DARK { 0.0 } else { falloff * logarithm.exp() }
    }

    /// f, 1/sr. Zero if a direction is below the surface.
    #[must_use]
    pub fn value(&self, outgoing: DVec3, incident: DVec3) -> f64 {
        let cosines = outgoing.z * incident.z;
        if outgoing.z <= 0.0 || incident.z <= 0.0 {
            return 0.0;
        }
        let across = incident - outgoing;
        let geometry = Geometry {
            observation: crate::observation_angle(outgoing, incident),
            entrance: incident.x.hypot(incident.y).atan2(incident.z),
            rotation: if self.rotations.len() > 1 { (-across.y).atan2(across.x) } else { 0.0 },
        };
        self.coefficient(geometry) / cosines
    }

    /// Density of [`RetroTable::sample`], 1/sr.
    #[must_use]
    pub fn pdf(&self, outgoing: DVec3, incident: DVec3) -> f64 {
        self.density_of(outgoing).at_chord(outgoing.distance_squared(incident))
    }

    /// Samples an incident direction; it may be below the horizon.
    #[must_use]
    pub fn sample(&self, outgoing: DVec3, u: [f64; 2]) -> DVec3 {
        self.density_of(outgoing).sample(outgoing, u)
    }

    /// Fraction of the light from this entrance angle (radians) that is returned to all observers:
    /// `∫ R_A/cos β dω`. The measured plane of observation represents all others.
    #[must_use]
    pub fn albedo(&self, entrance: f64) -> f64 {
        let angles = logarithmic_angles(1e-5, 200, &[]);
        let mean = |observation: f64| {
            let all = self
                .rotations
                .iter()
                .map(|rotation| self.coefficient(Geometry { observation, entrance, rotation: *rotation }));
            all.sum::<f64>() / self.rotations.len() as f64
        };
        let ring = |pair: &[f64]| {
            let middle = 0.5 * (pair[0] + pair[1]);
            TAU * middle.sin() * (pair[1] - pair[0]) * mean(middle)
        };
        angles.windows(2).filter(|pair| pair[1] < FRAC_PI_2).map(ring).sum::<f64>() / entrance.cos()
    }

    fn density_of(&self, outgoing: DVec3) -> &RadialDensity {
        let entrance = outgoing.x.hypot(outgoing.y).atan2(outgoing.z);
        let off = |knot: &f64| (knot - entrance).abs();
        let nearest =
            (0..self.entrances.len()).min_by(|a, b| off(&self.entrances[*a]).total_cmp(&off(&self.entrances[*b])));
        &self.densities[nearest.unwrap_or(0)]
    }

    /// Density over all rotations; constant if the table is zero at this angle.
    fn density_at(&self, entrance: f64) -> RadialDensity {
        let jumps: Vec<f64> = self.observations.iter().copied().filter(|angle| *angle > 0.0 && *angle < PI).collect();
        let angles = logarithmic_angles(2e-5, 60, &jumps);
        let shape = |observation: f64| {
            let all = self
                .rotations
                .iter()
                .map(|rotation| self.coefficient(Geometry { observation, entrance, rotation: *rotation }));
            all.sum::<f64>()
        };
        // The density is positive everywhere, since samples at other entrance angles than the row's
        // must find light too.
        let peak = angles.iter().map(|angle| shape(*angle)).fold(1e-30, f64::max);
        RadialDensity::new(&angles, |observation| shape(observation) + 1e-6 * peak)
    }

    fn along_observation(&self, rotation: usize, entrance: usize, observation: f64) -> f64 {
        let count = self.observations.len();
        let first = (rotation * self.entrances.len() + entrance) * count;
        let row = &self.logarithms[first..first + count];
        let last = self.observations[count - 1];
        if observation <= last {
            let (knot, share) = cell(&self.observations, observation);
            return if share > 0.0 { row[knot] + share * (row[knot + 1] - row[knot]) } else { row[knot] };
        }
        // A table with a single observation angle falls by a half per such angle.
        let width = if count > 1 { last - self.observations[count - 2] } else { last.max(1e-4) };
        let slope = if count > 1 { (row[count - 1] - row[count - 2]) / width } else { f64::NEG_INFINITY };
        let slowest = -std::f64::consts::LN_2 / width;
        let slope = if slope.is_finite() { slope.min(slowest) } else { slowest };
        (row[count - 1] + slope * (observation - last)).max(DARK)
    }

    /// The knots around a rotation angle, periodic, and the weight of the second.
    fn rotation_cell(&self, rotation: f64) -> (usize, usize, f64) {
        let count = self.rotations.len();
        let after = self.rotations.partition_point(|knot| *knot <= rotation);
        let (low, high) = ((after + count - 1) % count, after % count);
        let width = (self.rotations[high] - self.rotations[low]).rem_euclid(TAU);
        let share = if width > 0.0 { (rotation - self.rotations[low]).rem_euclid(TAU) / width } else { 0.0 };
        (low, high, share)
    }
}

/// The knot before `at`, and the weight of the one after it. Below the first knot: the first alone.
fn cell(axis: &[f64], at: f64) -> (usize, f64) {
    let after = axis.partition_point(|knot| *knot <= at);
    match after {
        0 => (0, 0.0),
        _ if after == axis.len() => (after - 1, 0.0),
        _ => (after - 1, (at - axis[after - 1]) / (axis[after] - axis[after - 1])),
    }
}

fn check_rows(rows: &[Row]) -> Result<(), TableError> {
    if rows.is_empty() {
        return Err(TableError::Empty);
    }
    for (index, Row { geometry, coefficient }) in rows.iter().enumerate() {
        if !(0.0..=FRAC_PI_2).contains(&geometry.observation) {
            return Err(TableError::Row(index, "an observation angle of 0…90°"));
        }
        let steepest = 89f64.to_radians() + SAME;
        if !(-steepest..=steepest).contains(&geometry.entrance) {
            return Err(TableError::Row(index, "an entrance angle of −89…89°"));
        }
        if !geometry.rotation.is_finite() {
            return Err(TableError::Row(index, "a finite rotation angle"));
        }
        if !(0.0..=1e6).contains(coefficient) {
            return Err(TableError::Row(index, "a coefficient of 0…1e6 cd/(lx m²)"));
        }
    }
    if rows.iter().all(|row| row.coefficient == 0.0) {
        return Err(TableError::Black);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Typical values of white 3M Diamond Grade conspicuity markings, series 983 (product bulletin
    /// 983, June 2009).
    pub(crate) const SERIES_983: [(f64, f64, f64); 6] = [
        (0.2, -4.0, 800.0),
        (0.2, 30.0, 550.0),
        (0.2, 45.0, 345.0),
        (0.5, -4.0, 460.0),
        (0.5, 30.0, 215.0),
        (0.5, 45.0, 85.0),
    ];

    fn rows(numbers: &[(f64, f64, f64)]) -> Vec<Row> {
        let row = |&(observation, entrance, coefficient): &(f64, f64, f64)| Row {
            geometry: Geometry::from_degrees(observation, entrance, 0.0),
            coefficient,
        };
        numbers.iter().map(row).collect()
    }

    #[test]
    fn the_brdf_of_a_table_returns_its_rows() {
        let rows = rows(&SERIES_983);
        let table = RetroTable::new(&rows).unwrap();
        for row in &rows {
            let (observer, light) = row.geometry.directions();
            let back = row.geometry.coefficient(table.value(observer, light));
            assert!((back / row.coefficient - 1.0).abs() < 1e-6, "{row:?}: {back}");
        }
    }

    #[test]
    fn the_pattern_rotates_with_the_sample() {
        let at = |rotation: f64, coefficient: f64| Row {
            geometry: Geometry::from_degrees(0.2, 20.0, rotation),
            coefficient,
        };
        let rows = [at(0.0, 100.0), at(90.0, 400.0)];
        let table = RetroTable::new(&rows).unwrap();
        for row in rows {
            let (observer, light) = row.geometry.directions();
            let back = row.geometry.coefficient(table.value(observer, light));
            assert!((back / row.coefficient - 1.0).abs() < 1e-6, "{row:?}: {back}");
        }
        let between = table.coefficient(Geometry::from_degrees(0.2, 20.0, 45.0));
        assert!((between - 200.0).abs() < 1e-9, "{between}");
    }

    #[test]
    fn a_missing_combination_of_angles_is_reported() {
        let error = RetroTable::new(&rows(&SERIES_983[..5])).unwrap_err();
        assert!(error.to_string().contains("observation 0.500000°, entrance 45.000000°"), "{error}");
        let twice = RetroTable::new(&rows(&[SERIES_983[0], SERIES_983[0]])).unwrap_err();
        assert_eq!(twice, TableError::Twice(0, 1));
        assert_eq!(RetroTable::new(&[]).unwrap_err(), TableError::Empty);
        assert!(matches!(RetroTable::new(&rows(&[(0.2, 95.0, 1.0)])).unwrap_err(), TableError::Row(0, _)));
    }

    #[test]
    fn a_table_falls_outside_its_range() {
        let table = RetroTable::new(&rows(&SERIES_983)).unwrap();
        let at = |observation, entrance| table.coefficient(Geometry::from_degrees(observation, entrance, 0.0));
        assert_eq!(at(0.0, -4.0), at(0.2, -4.0));
        assert!(at(0.8, 0.0) <= at(0.5, 0.0) / 2.0 * (1.0 + 1e-12));
        assert!((at(0.2, 67.5) / 345.0 - 0.5).abs() < 1e-9);
    }
}
