//! One corner prism: the fraction of the light that it returns, and the directions.

use super::polygon::{Point, Polygon};
use crate::fresnel::fresnel_dielectric;
use glam::DVec3;

/// Number of pairs of opposite beams: three per prism, and two orientations of the prisms.
pub(super) const BEAMS: usize = 6;

/// A pair of returned beams: light in one order of faces, and in the opposite order.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Beam {
    /// Deviation of the first beam's direction from the direction to the lamp; the second beam has
    /// the opposite one.
    pub(super) deviation: DVec3,
    /// Fraction of the incident light in each of the two beams.
    pub(super) share: f64,
}

/// Surface of the prisms' faces.
#[derive(Clone, Copy, Debug)]
pub enum Faces {
    /// Against air: total or partial reflection.
    Bare,
    /// Coated with metal, of the same reflectance at every angle.
    Coated {
        /// Reflectance, 0…1.
        reflectance: f64,
    },
}

/// A corner prism with its apex at the origin and its triangular front in the plane z = 1.
#[derive(Clone, Debug)]
pub(super) struct CubeCorner {
    index: f64,
    faces: Faces,
    /// Unit normals into the prism for exact right angles; they lie along its edges.
    square: [DVec3; 3],
    /// Unit normals with the dihedral error.
    actual: [DVec3; 3],
    /// Corners of the front, counter-clockwise; corner k is the end of the edge along `square[k]`.
    front: [Point; 3],
    front_area: f64,
}

impl CubeCorner {
    /// A prism of index `index` with dihedral angles of 90° plus `dihedral_error` radians.
    pub(super) fn new(index: f64, dihedral_error: f64, faces: Faces) -> Self {
        let square = [90f64, 210.0, 330.0].map(|degrees| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            DVec3::new((2.0f64 / 3.0).sqrt() * cos, (2.0f64 / 3.0).sqrt() * sin, (1.0f64 / 3.0).sqrt())
        });
        // Normals tilted towards the axis by c have the product 2c/√3 = sin ε, and the faces the
        // angle 90° + ε.
        let lean = 0.5 * 3f64.sqrt() * dihedral_error.sin();
        let actual = square.map(|normal| (normal + DVec3::Z * lean).normalize());
        let front = square.map(|edge| (edge.x / edge.z, edge.y / edge.z));
        CubeCorner { index, faces, square, actual, front, front_area: Polygon::triangle(front).area() }
    }

    /// Returned beams for light from the unit direction `direction` (z > 0), with half of the
    /// prisms rotated by 180°.
    pub(super) fn beams(&self, direction: DVec3) -> [Beam; BEAMS] {
        let turned = DVec3::new(-direction.x, -direction.y, direction.z);
        let (upright, mut other) = (self.beams_of_one(direction), self.beams_of_one(turned));
        for beam in &mut other {
            (beam.deviation.x, beam.deviation.y) = (-beam.deviation.x, -beam.deviation.y);
        }
        std::array::from_fn(|index| {
            let beam = if index < 3 { upright[index] } else { other[index - 3] };
            Beam { share: 0.5 * beam.share, ..beam }
        })
    }

    fn beams_of_one(&self, direction: DVec3) -> [Beam; 3] {
        let inside = self.refract_in(direction);
        let strength = self.strength(direction, inside);
        std::array::from_fn(|first| {
            let last = (first + 1) % 3;
            let middle = 3 - first - last;
            let there = self.returned(inside, [first, middle, last]);
            let back = self.returned(inside, [last, middle, first]);
            match (there, back) {
                (Some(there), Some(back)) => {
                    let share = if strength > 0.0 { strength * self.area_share(inside, first, last) } else { 0.0 };
                    Beam { deviation: (there - back) * 0.5, share }
                }
                // Total reflection at the front: no beam leaves.
                _ => Beam::default(),
            }
        })
    }

    /// Unit direction of the light inside the prism, downwards.
    fn refract_in(&self, direction: DVec3) -> DVec3 {
        let (x, y) = (-direction.x / self.index, -direction.y / self.index);
        DVec3::new(x, y, -(1.0 - x * x - y * y).max(0.0).sqrt())
    }

    /// Direction in which light leaves after three faces.
    fn returned(&self, inside: DVec3, order: [usize; 3]) -> Option<DVec3> {
        let reflect = |light: DVec3, face: usize| {
            let normal = self.actual[face];
            light - normal * (2.0 * light.dot(normal))
        };
        let light = order.into_iter().fold(inside, reflect);
        let (x, y) = (light.x * self.index, light.y * self.index);
        let height_squared = 1.0 - x * x - y * y;
        (height_squared > 0.0 && light.z > 0.0).then(|| DVec3::new(x, y, height_squared.sqrt()))
    }

    /// Transmittance of the front, three faces and the front again. Zero if a face is hit from
    /// behind.
    fn strength(&self, direction: DVec3, inside: DVec3) -> f64 {
        let passage = 1.0 - fresnel_dielectric(direction.z, self.index);
        self.square.iter().fold(passage * passage, |strength, normal| {
            let cosine = -inside.dot(*normal);
            let reflectance = match self.faces {
                _ if cosine <= 0.0 => 0.0,
                Faces::Bare => fresnel_dielectric(cosine, 1.0 / self.index),
                Faces::Coated { reflectance } => reflectance,
            };
            strength * reflectance
        })
    }

    /// Fraction of the front through which rays enter that hit the face `first` first and the face
    /// `last` last, and leave through the front. A ray leaves at the image of its entry point in
    /// the apex, as seen through the front.
    fn area_share(&self, inside: DVec3, first: usize, last: usize) -> f64 {
        let corner = (inside.x / inside.z, inside.y / inside.z);
        let mut region = Polygon::triangle(self.front);
        for k in 0..3 {
            let (from, to) = (self.front[k], self.front[(k + 1) % 3]);
            let image = (2.0 * corner.0 - from.0, 2.0 * corner.1 - from.1);
            region = region.left_of(image, (from.0 - to.0, from.1 - to.1));
        }
        let towards = |vertex: usize| {
            let end = self.front[vertex % 3];
            (end.0 - corner.0, end.1 - corner.1)
        };
        let opposite = |vector: Point| (-vector.0, -vector.1);
        // Face k is seen between the edges k + 1 and k + 2, its image on the opposite side of the
        // corner.
        region = region.left_of(corner, towards(first + 1)).left_of(corner, opposite(towards(first + 2)));
        region = region.left_of(corner, opposite(towards(last + 1))).left_of(corner, towards(last + 2));
        region.area() / self.front_area
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn total(corner: &CubeCorner, direction: DVec3) -> f64 {
        corner.beams(direction).iter().map(|beam| 2.0 * beam.share).sum()
    }

    /// At normal incidence the active area of a triangular corner is a hexagon of two thirds
    /// (Eckhardt, 1971).
    #[test]
    fn two_thirds_of_the_light_are_returned_at_normal_incidence() {
        let found = total(&CubeCorner::new(1.5, 0.0, Faces::Bare), DVec3::Z);
        assert!((found - 2.0 / 3.0 * 0.96 * 0.96).abs() < 1e-12, "{found}");
    }

    /// Yoder, "Study of Light Deviation Errors in Triple Mirrors and Tetrahedral Prisms", JOSA
    /// 48(7), 1958: 3.27 n ε.
    #[test]
    fn a_dihedral_error_splits_the_light_into_six_spots_at_yoders_angle() {
        let (index, error) = (1.5, 1e-5);
        let corner = CubeCorner::new(index, error, Faces::Bare);
        let mut azimuths = Vec::new();
        for beam in corner.beams(DVec3::Z).iter().take(3) {
            let angle = beam.deviation.length();
            assert!((angle / (4.0 * (2.0f64 / 3.0).sqrt() * index * error) - 1.0).abs() < 1e-3, "{angle}");
            azimuths.push((beam.deviation.y.atan2(beam.deviation.x).to_degrees() + 30.0).rem_euclid(60.0));
        }
        assert!(azimuths.iter().all(|azimuth| (azimuth - azimuths[0]).abs() < 1e-3), "{azimuths:?}");
    }

    #[test]
    fn a_square_corner_returns_light_exactly() {
        let corner = CubeCorner::new(1.586, 0.0, Faces::Bare);
        for beam in corner.beams(DVec3::new(0.3, 0.2, 0.87).normalize()) {
            assert!(beam.deviation.length() < 1e-12, "{beam:?}");
        }
    }

    /// Rays traced through the front give the same fraction.
    #[test]
    fn areas_agree_with_traced_rays() {
        let corner = CubeCorner::new(1.5, 0.0, Faces::Coated { reflectance: 1.0 });
        for direction in [DVec3::Z, DVec3::new(0.2, 0.3, 1.0), DVec3::new(-0.5, 0.1, 1.0), DVec3::new(0.1, -0.9, 1.0)] {
            let direction = direction.normalize();
            let inside = corner.refract_in(direction);
            let found: f64 = (0..3).map(|first| 2.0 * corner.area_share(inside, first, (first + 1) % 3)).sum();
            let traced = traced_share(&corner, inside);
            assert!((found - traced).abs() < 0.01, "{direction}: {found} by areas, {traced} by rays");
        }
    }

    fn traced_share(corner: &CubeCorner, inside: DVec3) -> f64 {
        let [a, b, c] = corner.front;
        let steps = 300;
        let (mut returned, mut all) = (0, 0);
        for row in 0..steps {
            for column in 0..steps - row {
                let (s, t) = ((f64::from(row) + 0.3) / f64::from(steps), (f64::from(column) + 0.3) / f64::from(steps));
                let point = (a.0 + s * (b.0 - a.0) + t * (c.0 - a.0), a.1 + s * (b.1 - a.1) + t * (c.1 - a.1));
                all += 1;
                returned += i32::from(trace(corner, DVec3::new(point.0, point.1, 1.0), inside));
            }
        }
        f64::from(returned) / f64::from(all)
    }

    /// Traces a ray until it leaves through the front plane; whether it hit all three faces and
    /// left inside the triangle.
    fn trace(corner: &CubeCorner, mut point: DVec3, mut light: DVec3) -> bool {
        let mut hit = [false; 3];
        for _ in 0..4 {
            let distance = |face: usize| {
                let towards = -light.dot(corner.square[face]);
                if towards > 1e-12 { point.dot(corner.square[face]) / towards } else { f64::INFINITY }
            };
            let face = (0..3).min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap();
            let to_front = if light.z > 0.0 { (1.0 - point.z) / light.z } else { f64::INFINITY };
            if distance(face) > to_front {
                let exit = point + light * to_front;
                let inside = corner.square.iter().all(|normal| exit.dot(*normal) >= 0.0);
                return inside && hit == [true; 3];
            }
            point += light * distance(face);
            light -= corner.square[face] * (2.0 * light.dot(corner.square[face]));
            hit[face] = true;
        }
        false
    }
}
