//! Partition of the sphere into cells that are small around narrow lobes.

use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// Partition of the sphere of incident directions into cells, for one outgoing direction.
///
/// The surface plane and the plane through the normal perpendicular to the plane of incidence
/// divide the sphere into four quadrants. Each contains one direction about which lobes lie: retro,
/// mirror, straight-through, and its mirror image. Within a quadrant, rings are logarithmic in the
/// angle δ to that direction, and each ring has sectors in the azimuth ψ about it, clipped at the
/// quadrant's limits. Sectors are finer close to the plane of incidence: at grazing incidence a
/// lobe is 1/cos θ times narrower across that plane than along it.
#[derive(Clone, Debug)]
pub struct Partition {
    /// Angle of the outgoing direction to the normal (or its opposite), 0…π/2.
    polar: f64,
    sin: f64,
    cos: f64,
    /// Unit vector of the outgoing direction's azimuth.
    azimuth: (f64, f64),
    /// Ring k extends from edge k to edge k + 1.
    edges: Vec<f64>,
    /// Sector k extends from edge k to edge k + 1, as fractions of the range of ψ.
    sector_edges: Vec<f64>,
    /// Gauss–Legendre nodes and weights on (0, 1).
    nodes: Vec<(f64, f64)>,
}

/// Quadrants: retro and mirror above the surface, then below.
const QUADRANTS: usize = 4;
/// Left and right of the plane of incidence.
const SIDES: usize = 2;

/// How fine a [`Partition`] is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fineness {
    /// Outer radius of the innermost ring, radians.
    pub core: f64,
    /// Rings for each factor of ten in δ.
    pub rings_per_decade: usize,
    /// Width of the sectors next to the plane of incidence, as a fraction of a half ring.
    pub narrowest_sector: f64,
    /// Sectors for each factor of ten away from the plane of incidence.
    pub sectors_per_decade: usize,
    /// Gauss–Legendre nodes of a cell along δ and along ψ.
    pub nodes: usize,
}

impl Partition {
    /// Partition for an outgoing direction.
    #[must_use]
    pub fn new(outgoing: DVec3, fineness: Fineness) -> Self {
        let horizontal = outgoing.x.hypot(outgoing.y);
        let azimuth = if horizontal > 0.0 { (outgoing.x / horizontal, outgoing.y / horizontal) } else { (1.0, 0.0) };
        let polar = horizontal.atan2(outgoing.z.abs());
        let (sin, cos) = polar.sin_cos();
        let edges = logarithmic_edges(fineness.core, FRAC_PI_2, fineness.rings_per_decade);
        let half = logarithmic_edges(fineness.narrowest_sector, 0.5, fineness.sectors_per_decade);
        let other_half = half.iter().rev().skip(1).map(|edge| 1.0 - edge);
        let sector_edges = half.iter().copied().chain(other_half).collect();
        Partition { polar, sin, cos, azimuth, edges, sector_edges, nodes: gauss_legendre(fineness.nodes) }
    }

    /// Number of cells.
    #[must_use]
    pub fn cells(&self) -> usize {
        QUADRANTS * self.rings() * SIDES * self.sectors()
    }

    fn rings(&self) -> usize {
        self.edges.len() - 1
    }

    fn sectors(&self) -> usize {
        self.sector_edges.len() - 1
    }

    fn cell(&self, quadrant: usize, ring: usize, side: usize, sector: usize) -> usize {
        ((quadrant * self.rings() + ring) * SIDES + side) * self.sectors() + sector
    }

    /// Cell that contains a unit vector.
    #[must_use]
    pub fn cell_of(&self, direction: DVec3) -> usize {
        let x = direction.x * self.azimuth.0 + direction.y * self.azimuth.1;
        let y = direction.y * self.azimuth.0 - direction.x * self.azimuth.1;
        let quadrant = usize::from(x < 0.0) + 2 * usize::from(direction.z < 0.0);
        // In the first quadrant's frame: x towards the axis, z on its side.
        let here = DVec3::new(x.abs(), y, direction.z.abs());
        let axis = DVec3::new(self.sin, 0.0, self.cos);
        let delta = 2.0 * (here - axis).length().atan2((here + axis).length());
        let psi = y.abs().atan2(here.x * self.cos - here.z * self.sin);
        let ring = self.edges.partition_point(|&edge| edge <= delta).clamp(1, self.rings()) - 1;
        let (low, high) = self.psi_range(delta);
        let along = if high > low { (psi - low) / (high - low) } else { 0.0 };
        let sector = self.sector_edges.partition_point(|&edge| edge <= along).clamp(1, self.sectors()) - 1;
        self.cell(quadrant, ring, usize::from(y < 0.0), sector)
    }

    /// Range of ψ ≥ 0 within the quadrant, at the angle δ from its axis.
    ///
    /// With the axis (sin θ, 0, cos θ), z ≥ 0 is cos ψ ≤ cot δ cot θ, and x ≥ 0 is cos ψ ≥ −cot δ
    /// tan θ.
    fn psi_range(&self, delta: f64) -> (f64, f64) {
        let cot = 1.0 / delta.tan();
        let largest = (cot * self.cos / self.sin).clamp(-1.0, 1.0);
        let smallest = (-cot * self.sin / self.cos).max(-1.0).min(largest);
        (largest.acos(), smallest.acos())
    }

    /// Calls `visit(cell, directions, solid_angles)` for each cell, with quadrature points and
    /// their weights in sr. The weights of all cells add up to the sphere.
    pub fn visit(&self, hemispheres: Hemispheres, mut visit: impl FnMut(usize, &[DVec3], &[f64])) {
        let quadrants = match hemispheres {
            Hemispheres::Upper => 0..2,
            Hemispheres::Both => 0..QUADRANTS,
        };
        let (mut directions, mut weights) = (Vec::new(), Vec::new());
        for quadrant in quadrants {
            for ring in 0..self.rings() {
                let deltas = self.ring_nodes(ring, &self.nodes);
                for side in 0..SIDES {
                    for sector in 0..self.sectors() {
                        directions.clear();
                        weights.clear();
                        let shares = self.sector_nodes(sector, &self.nodes);
                        self.fill(&deltas, &shares, quadrant, side, &mut directions, &mut weights);
                        visit(self.cell(quadrant, ring, side, sector), &directions, &weights);
                    }
                }
            }
        }
    }

    /// Calls `visit(directions, solid_angles)` for parts of one cell, on a grid that is
    /// `refinement` times finer in both directions.
    pub fn visit_cell(&self, cell: usize, refinement: usize, mut visit: impl FnMut(&[DVec3], &[f64])) {
        let (rest, sector) = (cell / self.sectors(), cell % self.sectors());
        let (rest, side) = (rest / SIDES, rest % SIDES);
        let (quadrant, ring) = (rest / self.rings(), rest % self.rings());
        let parts = refinement as f64;
        let part = |part: usize| self.nodes.iter().map(move |(s, weight)| ((part as f64 + s) / parts, weight / parts));
        let fine: Vec<(f64, f64)> = (0..refinement).flat_map(part).collect();
        let shares = self.sector_nodes(sector, &fine);
        let (mut directions, mut weights) = (Vec::new(), Vec::new());
        for delta in self.ring_nodes(ring, &fine) {
            directions.clear();
            weights.clear();
            self.fill(&[delta], &shares, quadrant, side, &mut directions, &mut weights);
            visit(&directions, &weights);
        }
    }

    /// Values of δ in a ring, with weights that include sin δ. Intervals end where a limit of the
    /// quadrant begins to clip the ring, since the range of ψ has a square root there.
    fn ring_nodes(&self, ring: usize, on_unit: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let (first, last) = (self.edges[ring], self.edges[ring + 1]);
        let mut kinks = [self.polar, FRAC_PI_2 - self.polar];
        kinks.sort_by(f64::total_cmp);
        let mut stops = vec![first];
        stops.extend(kinks.into_iter().filter(|&kink| kink > first && kink < last));
        stops.push(last);
        let mut nodes = Vec::new();
        for interval in stops.windows(2) {
            let (low, high) = (interval[0], interval[1]);
            for &(s, weight) in on_unit {
                let (delta, slope) = if low == 0.0 {
                    (high * s.sqrt(), high / (2.0 * s.sqrt()))
                } else if kinks.contains(&low) {
                    (low + (high - low) * s * s, 2.0 * (high - low) * s)
                } else {
                    let delta = low * (high / low).powf(s);
                    (delta, delta * (high / low).ln())
                };
                nodes.push((delta, weight * slope * delta.sin()));
            }
        }
        nodes
    }

    /// Fractions of the range of ψ in a sector, with weights; logarithmic in the distance to the
    /// nearer end.
    fn sector_nodes(&self, sector: usize, on_unit: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let (first, last) = (self.sector_edges[sector], self.sector_edges[sector + 1]);
        let mirrored = first >= 0.5;
        let (near, far) = if mirrored { (1.0 - last, 1.0 - first) } else { (first, last) };
        let place = |&(s, weight): &(f64, f64)| {
            let (distance, slope) = if near < 1e-12 {
                (far * s, far)
            } else {
                let distance = near * (far / near).powf(s);
                (distance, distance * (far / near).ln())
            };
            (if mirrored { 1.0 - distance } else { distance }, weight * slope)
        };
        on_unit.iter().map(place).collect()
    }

    fn fill(
        &self,
        deltas: &[(f64, f64)],
        shares: &[(f64, f64)],
        quadrant: usize,
        side: usize,
        directions: &mut Vec<DVec3>,
        weights: &mut Vec<f64>,
    ) {
        let (x_sign, z_sign) = ([1.0, -1.0][quadrant % 2], [1.0, -1.0][quadrant / 2]);
        let y_sign = [1.0, -1.0][side];
        for &(delta, delta_weight) in deltas {
            let (low, high) = self.psi_range(delta);
            let width = high - low;
            let (sin_delta, cos_delta) = delta.sin_cos();
            for &(share, weight) in shares {
                let (sin_psi, cos_psi) = (low + width * share).sin_cos();
                let x = x_sign * (cos_delta * self.sin + sin_delta * cos_psi * self.cos).max(0.0);
                let y = y_sign * sin_delta * sin_psi;
                let z = z_sign * (cos_delta * self.cos - sin_delta * cos_psi * self.sin).max(0.0);
                let (cos_azimuth, sin_azimuth) = self.azimuth;
                directions.push(DVec3::new(x * cos_azimuth - y * sin_azimuth, x * sin_azimuth + y * cos_azimuth, z));
                weights.push(delta_weight * weight * width);
            }
        }
    }
}

/// Integration domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hemispheres {
    /// The upper hemisphere, z ≥ 0.
    Upper,
    /// The sphere.
    Both,
}

/// Zero, `first`, and further edges in geometric progression to `last`.
fn logarithmic_edges(first: f64, last: f64, per_decade: usize) -> Vec<f64> {
    let intervals = ((last / first).log10() * per_decade as f64).ceil().max(1.0) as usize;
    // The power may round to a value above the last edge.
    let edge = |index: usize| (first * (last / first).powf(index as f64 / intervals as f64)).min(last);
    std::iter::once(0.0).chain((0..=intervals).map(edge)).collect()
}

/// Nodes and weights of Gauss and Legendre on (0, 1): roots of the Legendre polynomial by Newton's
/// method.
fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    (0..count)
        .map(|index| {
            let mut x = (PI * (index as f64 + 0.75) / (n + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..20 {
                let (mut before, mut here) = (1.0, x);
                for k in 2..=count {
                    let k = k as f64;
                    (before, here) = (here, ((2.0 * k - 1.0) * x * here - (k - 1.0) * before) / k);
                }
                slope = n * (x * here - before) / (x * x - 1.0);
                x -= here / slope;
            }
            (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const FINENESS: Fineness =
        Fineness { core: 1e-6, rings_per_decade: 4, narrowest_sector: 1e-3, sectors_per_decade: 2, nodes: 6 };

    fn at(degrees: f64) -> DVec3 {
        let polar = degrees.to_radians();
        DVec3::new(polar.sin() * 0.6, polar.sin() * 0.8, polar.cos())
    }

    #[test]
    fn the_cells_cover_the_sphere_and_integrate_the_cosine() {
        for degrees in [0.0, 1e-3, 20.0, 45.0, 70.0, 89.0, 89.9, 90.0] {
            let partition = Partition::new(at(degrees), FINENESS);
            let (mut sphere, mut cosine) = (0.0, 0.0);
            partition.visit(Hemispheres::Both, |_, directions, weights| {
                for (direction, weight) in directions.iter().zip(weights) {
                    sphere += weight;
                    cosine += weight * direction.z.max(0.0) / PI;
                }
            });
            assert!((sphere / (4.0 * PI) - 1.0).abs() < 1e-6, "{degrees}°: sphere {sphere}");
            assert!((cosine - 1.0).abs() < 1e-6, "{degrees}°: cosine {cosine}");
        }
    }

    #[test]
    fn each_quadrature_point_lies_in_its_cell() {
        for degrees in [0.0, 20.0, 45.0, 89.9] {
            let partition = Partition::new(at(degrees), FINENESS);
            let (mut wrong, mut all) = (0, 0);
            partition.visit(Hemispheres::Both, |cell, directions, _| {
                all += directions.len();
                wrong += directions.iter().filter(|direction| partition.cell_of(**direction) != cell).count();
            });
            // Rounding may move a point across an edge of the smallest rings.
            assert!(wrong * 1000 <= all, "{degrees}°: {wrong} of {all}");
        }
    }
}
