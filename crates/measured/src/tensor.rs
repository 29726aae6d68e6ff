//! Scattering from a tensor tree of luminances and, with colour, two trees of chromaticities.

use crate::color::{rgb_of_xyz, sharp_of_xyz, xyz_of_sharp, xyz_of_yuv};
use crate::resolution::{LEAST_TOTAL, Resolution, Way, luminance_worth_splitting};
use crate::slice::{Given, Held, Slices};
use crate::square::{disk_of_square, square_of_disk};
use crate::tree::{Point, Rank, Tree, isotropic_coordinate};
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Radiance subtracts nothing from trees whose minimum is this or more, 1/sr.
const MOST_SPLIT: f64 = 1.5 / PI;

/// Quadrature steps along each side of the disk, for the one integral without a slice.
const QUADRATURE_STEPS: u32 = 32;

#[derive(Debug)]
pub(crate) struct Tensor {
    /// Luminance without the Lambertian part.
    luminance: Tree,
    /// CIE u′ and v′.
    chromaticity: Option<[Tree; 2]>,
    /// Luminance of the Lambertian part, 1/sr.
    split_luminance: f64,
    forward: Slices,
    backward: OnceLock<Slices>,
}

impl Tensor {
    pub(crate) fn new(luminance: Tree, chromaticity: Option<[Tree; 2]>) -> Tensor {
        let forward = Slices::new(&luminance, Given::Incident);
        let backward = OnceLock::new();
        Tensor { luminance, chromaticity, split_luminance: 0.0, forward, backward }
    }

    /// Subtracts the constant part, and returns it as a reflectance in red, green and blue.
    pub(crate) fn split_diffuse(&mut self) -> [f64; 3] {
        let (luminance, color) = match &self.chromaticity {
            None => {
                let least = f64::from(self.luminance.least_value());
                (if least < MOST_SPLIT { least } else { 0.0 }, [least; 3])
            }
            Some(chromaticity) => {
                let xyz = xyz_of_sharp(self.least_sharp(chromaticity));
                (xyz[1], rgb_of_xyz(xyz).map(|band| band.max(0.0)))
            }
        };
        if !luminance_worth_splitting(luminance) {
            return [0.0; 3];
        }
        self.luminance.subtract(luminance as f32);
        self.split_luminance = luminance;
        color.map(|band| PI * band)
    }

    /// Minimum in each of the Sharp primaries, at the centres of the cells of all three trees.
    fn least_sharp(&self, chromaticity: &[Tree; 2]) -> [f64; 3] {
        let mut least = [f64::INFINITY; 3];
        for tree in [&self.luminance, &chromaticity[0], &chromaticity[1]] {
            tree.for_each_cell(&mut |cell| {
                if tree.is_used(&cell) {
                    let half = 0.5_f64.powi(cell.halvings as i32 + 1);
                    let sharp = sharp_of_xyz(self.xyz(chromaticity, &cell.corner.map(|least| least + half)));
                    least = std::array::from_fn(|band| least[band].min(sharp[band]));
                }
            });
        }
        least
    }

    fn xyz(&self, [u, v]: &[Tree; 2], point: &Point) -> [f64; 3] {
        let at = |tree: &Tree| f64::from(tree.leaf(point).value);
        xyz_of_yuv(at(&self.luminance) + self.split_luminance, at(u), at(v))
    }

    pub(crate) fn is_grey(&self) -> bool {
        self.chromaticity.is_none()
    }

    pub(crate) fn largest_total(&self) -> f64 {
        self.luminance.largest_total()
    }

    pub(crate) fn least_projected_solid_angle(&self) -> f64 {
        PI * 0.25_f64.powi(self.luminance.most_halvings() as i32)
    }

    pub(crate) fn value(&self, incident: [f64; 2], exit: [f64; 2]) -> f64 {
        f64::from(self.luminance.leaf(&self.luminance.point(incident, exit)).value)
    }

    /// Red, green and blue with the Lambertian part; none if all is grey.
    pub(crate) fn whole_color(&self, incident: [f64; 2], exit: [f64; 2]) -> Option<[f64; 3]> {
        let chromaticity = self.chromaticity.as_ref()?;
        let xyz = self.xyz(chromaticity, &self.luminance.point(incident, exit));
        Some(rgb_of_xyz(xyz).map(|band| band.max(0.0)))
    }

    pub(crate) fn cell(&self, incident: [f64; 2], exit: [f64; 2]) -> Option<usize> {
        Some(self.luminance.leaf(&self.luminance.point(incident, exit)).index as usize)
    }

    pub(crate) fn projected_solid_angle(&self, incident: [f64; 2], exit: [f64; 2]) -> Option<f64> {
        let leaf = self.luminance.leaf(&self.luminance.point(incident, exit));
        Some(PI * 0.25_f64.powi(leaf.halvings as i32))
    }

    pub(crate) fn resolution(&self, way: Way, given: [f64; 2]) -> Option<Resolution> {
        let Some((slice, halvings)) = self.slice(way, given) else {
            let least = self.least_projected_solid_angle();
            return Some(Resolution { least, largest: least });
        };
        let least = PI * 0.25_f64.powi(halvings as i32);
        Some(Resolution { least, largest: slice.largest_cell().max(least) })
    }

    /// Scattered fraction of light for one given direction.
    pub(crate) fn total(&self, way: Way, given: [f64; 2]) -> f64 {
        if let Some((slice, _)) = self.slice(way, given) {
            return slice.total();
        }
        // Midpoints of a uniform grid over the projected hemisphere.
        let step = 1.0 / f64::from(QUADRATURE_STEPS);
        let center = |steps: u32| (f64::from(steps) + 0.5) * step;
        let points = (0..QUADRATURE_STEPS).flat_map(|i| (0..QUADRATURE_STEPS).map(move |j| [center(i), center(j)]));
        PI * step * step * points.map(|point| self.value(disk_of_square(point), given)).sum::<f64>()
    }

    /// Samples the other direction, in proportion to value times projected solid angle.
    ///
    /// If the exit direction of an isotropic tree is given, sampling is uniform: the tree has no
    /// slice for it.
    pub(crate) fn sample(&self, way: Way, given: [f64; 2], u: [f64; 2]) -> Option<[f64; 2]> {
        let Some((slice, _)) = self.slice(way, given) else { return Some(disk_of_square(u)) };
        if slice.total() <= LEAST_TOTAL {
            return None;
        }
        let point = slice.sample(u)?;
        if self.luminance.rank == Rank::Anisotropic {
            return Some(point);
        }
        let [x, y] = given;
        let sine = x.hypot(y);
        let (cosine_turn, sine_turn) = if sine > 0.0 { (x / sine, y / sine) } else { (1.0, 0.0) };
        Some([cosine_turn * point[0] - sine_turn * point[1], sine_turn * point[0] + cosine_turn * point[1]])
    }

    /// Sampling density per projected solid angle of a direction with this value, 1/sr.
    pub(crate) fn density(&self, way: Way, given: [f64; 2], value: f64) -> f64 {
        match self.slice(way, given) {
            None => 1.0 / PI,
            Some((slice, _)) if slice.total() > 0.0 => value / slice.total(),
            Some(_) => 0.0,
        }
    }

    /// Slice of the other direction, and the number of halvings of the given one's cell; none if
    /// the exit direction of an isotropic tree is given.
    fn slice(&self, way: Way, given: [f64; 2]) -> Option<(Held<'_>, u32)> {
        match (self.luminance.rank, way) {
            (Rank::Isotropic, Way::Forward) => {
                let coordinate = isotropic_coordinate(given[0].hypot(given[1]));
                Some(self.forward.at(&self.luminance, [coordinate, 0.0]))
            }
            (Rank::Isotropic, Way::Backward) => None,
            (Rank::Anisotropic, Way::Forward) => Some(self.forward.at(&self.luminance, square_of_disk(given))),
            (Rank::Anisotropic, Way::Backward) => {
                let slices = self.backward.get_or_init(|| Slices::new(&self.luminance, Given::Exit));
                Some(slices.at(&self.luminance, square_of_disk(given)))
            }
        }
    }
}
