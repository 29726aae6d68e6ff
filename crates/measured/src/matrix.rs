//! Scattering as a matrix between two angle bases.

use crate::basis::AngleBasis;
use crate::color::{rgb_of_xyz, sharp_of_xyz, xyz_of_sharp};
use crate::resolution::{LEAST_TOTAL, Resolution, Way, luminance_worth_splitting};
use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

/// Values of a scattering function between the patches of angle bases.
#[derive(Clone, Debug, PartialEq)]
pub struct Patches {
    /// Number of outgoing patches.
    pub rows: usize,
    /// Number of incident patches.
    pub columns: usize,
    /// Red, green and blue by rows: value times projected solid angle of the incident patch.
    pub values: Vec<[f64; 3]>,
}

impl Patches {
    /// A Lambertian surface between the patches of Klems' full basis, by its reflectance or
    /// transmittance.
    #[must_use]
    pub fn lambertian(diffuse: [f64; 3]) -> Patches {
        let basis = &AngleBasis::known()[0];
        let count = basis.len();
        let row = (0..count).map(|patch| diffuse.map(|band| band / PI * basis.projected_solid_angle(patch)));
        let row: Vec<[f64; 3]> = row.collect();
        Patches { rows: count, columns: count, values: row.repeat(count) }
    }
}

/// A value for each pair of an incident and an exit patch.
#[derive(Debug)]
pub(crate) struct Matrix {
    incident: Arc<AngleBasis>,
    exit: Arc<AngleBasis>,
    /// Luminance without the Lambertian part, 1/sr; the incident patch varies fastest.
    values: Vec<f32>,
    /// Red, green and blue with the Lambertian part; none if all is grey.
    colors: Option<Vec<[f32; 3]>>,
    /// Cumulative sums of value times projected solid angle: one row per patch of the given
    /// direction, over the patches of the sampled one.
    forward: OnceLock<Vec<f64>>,
    backward: OnceLock<Vec<f64>>,
}

impl Matrix {
    /// A matrix of luminances, and of CIE X and Z if the file has colour, all in the order of
    /// `values`.
    pub(crate) fn new(
        incident: Arc<AngleBasis>,
        exit: Arc<AngleBasis>,
        values: Vec<f32>,
        x_and_z: Option<&[Vec<f32>; 2]>,
    ) -> Matrix {
        let xyz = |at: usize, [x, z]: &[Vec<f32>; 2]| [x[at], values[at], z[at]].map(f64::from);
        let colors = x_and_z
            .map(|x_and_z| (0..values.len()).map(|at| rgb_of_xyz(xyz(at, x_and_z)).map(|band| band as f32)).collect());
        Matrix { incident, exit, values, colors, forward: OnceLock::new(), backward: OnceLock::new() }
    }

    /// Subtracts the constant part, and returns it as a reflectance in red, green and blue.
    ///
    /// With colour, the minimum is taken in each of the Sharp primaries.
    pub(crate) fn split_diffuse(&mut self, x_and_z: Option<[Vec<f32>; 2]>) -> [f64; 3] {
        let Some([x, z]) = x_and_z else {
            let least = self.values.iter().copied().fold(f32::INFINITY, f32::min);
            if !luminance_worth_splitting(f64::from(least)) {
                return [0.0; 3];
            }
            self.values.iter_mut().for_each(|value| *value -= least);
            return [PI * f64::from(least); 3];
        };
        let mut least = [f64::INFINITY; 3];
        for ((x, y), z) in x.iter().zip(&self.values).zip(&z) {
            let sharp = sharp_of_xyz([*x, *y, *z].map(f64::from));
            least = std::array::from_fn(|band| least[band].min(sharp[band]));
        }
        let xyz = xyz_of_sharp(least);
        if !luminance_worth_splitting(xyz[1]) {
            return [0.0; 3];
        }
        let rgb = rgb_of_xyz(xyz);
        self.values.iter_mut().for_each(|value| *value = (*value - xyz[1] as f32).max(0.0));
        rgb.map(|band| PI * band.max(0.0))
    }

    pub(crate) fn is_grey(&self) -> bool {
        self.colors.is_none()
    }

    /// Values of all pairs of patches with a Lambertian part (1/sr), times the projected solid
    /// angle of the incident patch. For the reciprocal direction of light, each patch is that of
    /// the opposite direction.
    pub(crate) fn patches(&self, way: Way, lambertian: [f64; 3]) -> Patches {
        let opposite = |from: &AngleBasis, to: &AngleBasis| -> Vec<usize> {
            let middle = |patch| from.point(patch, [0.5, 0.5]).map(|coordinate| -coordinate);
            (0..from.len()).map(|patch| to.patch(middle(patch)).unwrap_or(0)).collect()
        };
        let value = |exit: usize, incident: usize| -> [f64; 3] {
            let at = exit * self.incident.len() + incident;
            match &self.colors {
                Some(colors) => colors[at].map(|band| f64::from(band).max(0.0)),
                None => lambertian.map(|band| band + f64::from(self.values[at]).max(0.0)),
            }
        };
        let scaled = |value: [f64; 3], size: f64| value.map(|band| band * size);
        let mut values = Vec::with_capacity(self.values.len());
        let (rows, columns) = match way {
            Way::Forward => (self.exit.len(), self.incident.len()),
            Way::Backward => (self.incident.len(), self.exit.len()),
        };
        let exit_of = opposite(&self.incident, &self.exit);
        let incident_of = opposite(&self.exit, &self.incident);
        for row in 0..rows {
            for column in 0..columns {
                values.push(match way {
                    Way::Forward => scaled(value(row, column), self.incident.projected_solid_angle(column)),
                    Way::Backward => {
                        let exit = exit_of.get(column).copied().unwrap_or(column).min(self.exit.len() - 1);
                        let incident = incident_of.get(row).copied().unwrap_or(row).min(self.incident.len() - 1);
                        scaled(value(exit, incident), self.exit.projected_solid_angle(exit))
                    }
                });
            }
        }
        Patches { rows, columns, values }
    }

    /// Largest scattered fraction of light over all incident directions.
    pub(crate) fn largest_total(&self) -> f64 {
        let count = self.exit.len();
        let rows = self.cumulative(Way::Forward).chunks(count + 1);
        rows.map(|row| row[count]).fold(0.0, f64::max)
    }

    pub(crate) fn least_projected_solid_angle(&self) -> f64 {
        let least = |basis: &AngleBasis| (0..basis.len()).map(|at| basis.projected_solid_angle(at)).fold(PI, f64::min);
        least(&self.incident).min(least(&self.exit))
    }

    /// Luminance, 1/sr.
    pub(crate) fn value(&self, incident: [f64; 2], exit: [f64; 2]) -> f64 {
        self.pair(incident, exit).map_or(0.0, |at| f64::from(self.values[at]))
    }

    /// Red, green and blue with the Lambertian part; none if all is grey.
    pub(crate) fn whole_color(&self, incident: [f64; 2], exit: [f64; 2]) -> Option<[f64; 3]> {
        let colors = self.colors.as_ref()?;
        Some(self.pair(incident, exit).map_or([0.0; 3], |at| colors[at].map(|band| f64::from(band).max(0.0))))
    }

    /// Index of the cell of a pair of directions; the value is constant in a cell.
    pub(crate) fn cell(&self, incident: [f64; 2], exit: [f64; 2]) -> Option<usize> {
        self.pair(incident, exit)
    }

    /// Projected solid angle of the smaller of the two patches.
    pub(crate) fn projected_solid_angle(&self, incident: [f64; 2], exit: [f64; 2]) -> Option<f64> {
        let incident = self.incident.projected_solid_angle(self.incident.patch(incident)?);
        let exit = self.exit.projected_solid_angle(self.exit.patch(exit)?);
        Some(incident.min(exit))
    }

    pub(crate) fn resolution(&self, way: Way, given: [f64; 2]) -> Option<Resolution> {
        let (basis, _) = self.bases(way);
        let size = basis.projected_solid_angle(basis.patch(given)?);
        Some(Resolution { least: size, largest: size })
    }

    /// Scattered fraction of light for one given direction.
    pub(crate) fn total(&self, way: Way, given: [f64; 2]) -> f64 {
        self.row(way, given).map_or(0.0, |row| row[row.len() - 1])
    }

    /// Samples the other direction, in proportion to value times projected solid angle.
    pub(crate) fn sample(&self, way: Way, given: [f64; 2], [u, v]: [f64; 2]) -> Option<[f64; 2]> {
        let row = self.row(way, given).filter(|row| row[row.len() - 1] > LEAST_TOTAL)?;
        let target = u * row[row.len() - 1];
        let patch = row.partition_point(|sum| *sum <= target).clamp(1, row.len() - 1) - 1;
        let inside = (target - row[patch]) / (row[patch + 1] - row[patch]).max(f64::MIN_POSITIVE);
        let (_, sampled) = self.bases(way);
        Some(sampled.point(patch, [inside.clamp(0.0, 1.0), v]))
    }

    fn pair(&self, incident: [f64; 2], exit: [f64; 2]) -> Option<usize> {
        Some(self.exit.patch(exit)? * self.incident.len() + self.incident.patch(incident)?)
    }

    /// Bases of the given and of the sampled direction.
    fn bases(&self, way: Way) -> (&AngleBasis, &AngleBasis) {
        match way {
            Way::Forward => (&self.incident, &self.exit),
            Way::Backward => (&self.exit, &self.incident),
        }
    }

    fn row(&self, way: Way, given: [f64; 2]) -> Option<&[f64]> {
        let (basis, sampled) = self.bases(way);
        let (patch, width) = (basis.patch(given)?, sampled.len() + 1);
        self.cumulative(way).get(patch * width..(patch + 1) * width)
    }

    fn cumulative(&self, way: Way) -> &[f64] {
        let (given, sampled) = self.bases(way);
        let columns = self.incident.len();
        let table = match way {
            Way::Forward => &self.forward,
            Way::Backward => &self.backward,
        };
        table.get_or_init(|| {
            let sizes: Vec<f64> = (0..sampled.len()).map(|patch| sampled.projected_solid_angle(patch)).collect();
            let mut sums = Vec::with_capacity(given.len() * (sampled.len() + 1));
            for patch in 0..given.len() {
                let mut sum = 0.0;
                sums.push(sum);
                for (other, size) in sizes.iter().enumerate() {
                    let (row, column) = if way == Way::Forward { (other, patch) } else { (patch, other) };
                    sum += f64::from(self.values[row * columns + column]) * size;
                    sums.push(sum);
                }
            }
            sums
        })
    }
}
