//! Where a large light shines brightest: lamps whose measured beam is narrow.
//!
//! A point near such a lamp gets most of its light from the small part of it whose beam comes its way. A place that is drawn by area alone seldom
//! finds that part, so half of the places are drawn by direction: the pattern of the light's middle is tabulated, and from a direction follows the
//! place. Both ways are mixed, so that the table need not be right where the pattern depends on the place too.

use crate::form::LightForm;
use glam::DVec3;

/// Cells of the table along each axis: 1.8° around the normal.
const CELLS: usize = 64;

/// Below this cosine to the normal a direction counts as at it.
const GRAZING: f64 = 0.05;

/// A pattern is narrow where the mean of its square is so many times the square of its mean.
const NARROW: f64 = 4.0;

/// A light is near where its bounding sphere is seen under a larger sine than this.
const NEAR: f64 = 0.1;

/// Of places on a light that is near.
const BY_DIRECTION: f64 = 0.5;

/// Directions out of a flat light, drawn by its radiance there. They are told by their projection on the light's plane, a square around the unit circle in cells.
#[derive(Clone, Debug)]
pub struct EmissionProfile {
    /// Unit: two in the light's plane, and its normal.
    frame: [DVec3; 3],
    /// The chance of each row of cells, and within each row of each cell, summed up.
    rows: Vec<f64>,
    columns: Vec<f64>,
}

impl EmissionProfile {
    /// Of a light that shines in a narrow beam; `radiance` is what it shows in a unit direction away from it.
    pub fn new(form: &LightForm, mut radiance: impl FnMut(DVec3) -> f64) -> Option<EmissionProfile> {
        let (normal, _) = form.plane()?;
        let (x, y) = normal.any_orthonormal_pair();
        let mut at_corner = |index: usize| {
            let [a, b] = [index % (CELLS + 1), index / (CELLS + 1)].map(|step| 2.0 * step as f64 / CELLS as f64 - 1.0);
            let cosine = (1.0 - a * a - b * b).max(0.0).sqrt();
            if cosine > 0.0 { [radiance(x * a + y * b + normal * cosine).max(0.0), cosine] } else { [0.0; 2] }
        };
        let corners: Vec<[f64; 2]> = (0..(CELLS + 1) * (CELLS + 1)).map(&mut at_corner).collect();
        let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
        for [radiance, _] in corners.iter().filter(|[_, cosine]| *cosine > 0.0) {
            sum += radiance;
            squares += radiance * radiance;
            count += 1.0;
        }
        let is_narrow = sum > 0.0 && squares.is_finite() && squares * count > NARROW * sum * sum;
        is_narrow.then(|| EmissionProfile::of_corners([x, y, normal], &corners))
    }

    fn of_corners(frame: [DVec3; 3], corners: &[[f64; 2]]) -> EmissionProfile {
        let weight = |[radiance, cosine]: [f64; 2]| radiance / cosine.max(GRAZING);
        let (mut rows, mut columns, mut total) = (Vec::with_capacity(CELLS), Vec::with_capacity(CELLS * CELLS), 0.0);
        for row in 0..CELLS {
            let mut sum = 0.0;
            for column in 0..CELLS {
                let first = row * (CELLS + 1) + column;
                sum += [first, first + 1, first + CELLS + 1, first + CELLS + 2]
                    .map(|corner| weight(corners[corner]))
                    .iter()
                    .sum::<f64>();
                columns.push(sum);
            }
            if sum > 0.0 {
                columns[row * CELLS..].iter_mut().for_each(|share| *share /= sum);
            }
            total += sum;
            rows.push(total);
        }
        rows.iter_mut().for_each(|share| *share /= total);
        EmissionProfile { frame, rows, columns }
    }

    /// How often a place is drawn by direction for a receiver so far from the middle of a light of this radius.
    pub fn chance(distance: f64, radius: f64) -> f64 {
        if radius > NEAR * distance { BY_DIRECTION } else { 0.0 }
    }

    /// A unit direction away from the light, from a point of the unit square.
    pub fn draw(&self, [u, v]: [f64; 2]) -> Option<DVec3> {
        let (row, b) = drawn(&self.rows, v);
        let (column, a) = drawn(&self.columns[row * CELLS..][..CELLS], u);
        let [a, b] = [column as f64 + a, row as f64 + b].map(|step| 2.0 * step / CELLS as f64 - 1.0);
        let squared = 1.0 - a * a - b * b;
        let [x, y, normal] = self.frame;
        (squared > 0.0).then(|| x * a + y * b + normal * squared.sqrt())
    }

    /// The density of [`EmissionProfile::draw`], 1/sr.
    pub fn pdf(&self, direction: DVec3) -> f64 {
        let [a, b, cosine] = self.frame.map(|axis| axis.dot(direction));
        if cosine <= 0.0 {
            return 0.0;
        }
        let [column, row] = [a, b].map(|at| ((0.5 * (at + 1.0) * CELLS as f64) as usize).min(CELLS - 1));
        let chance = share(&self.rows, row) * share(&self.columns[row * CELLS..][..CELLS], column);
        // A piece of the plane is seen from the middle of the sphere over it as so much larger a solid angle.
        chance * (0.25 * (CELLS * CELLS) as f64) * cosine
    }
}

/// Which of the cells of a cumulative distribution, and where in it.
fn drawn(cumulative: &[f64], u: f64) -> (usize, f64) {
    let index = cumulative.partition_point(|sum| *sum <= u).min(cumulative.len() - 1);
    let before = if index == 0 { 0.0 } else { cumulative[index - 1] };
    let width = cumulative[index] - before;
    (index, if width > 0.0 { ((u - before) / width).clamp(0.0, 1.0) } else { 0.5 })
}

fn share(cumulative: &[f64], index: usize) -> f64 {
    cumulative[index] - if index == 0 { 0.0 } else { cumulative[index - 1] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const UP: DVec3 = DVec3::Z;

    fn square() -> LightForm {
        LightForm::Parallelogram { corner: DVec3::ZERO, x: DVec3::X, y: DVec3::Y, normal: UP, area: 1.0 }
    }

    fn narrow(direction: DVec3) -> f64 {
        0.01 + (-200.0 * direction.distance_squared(DVec3::new(0.6, 0.0, 0.8))).exp()
    }

    #[test]
    fn a_wide_pattern_makes_no_beam() {
        assert!(EmissionProfile::new(&square(), |direction| direction.z).is_none());
        assert!(EmissionProfile::new(&square(), |_| 0.0).is_none());
    }

    #[test]
    fn directions_are_drawn_with_the_density_that_is_told() {
        let profile = EmissionProfile::new(&square(), narrow).expect("the pattern is narrow");
        let (mut mean, mut near, side) = (0.0, 0, 512);
        for index in 0..side * side {
            let u = [index % side, index / side].map(|step| (step as f64 + 0.5) / side as f64);
            let Some(direction) = profile.draw(u) else { continue };
            // The mean of a function over its density is its integral: the solid angle of the hemisphere's upper half, π.
            mean += if direction.z > 0.5 { 1.0 / profile.pdf(direction) } else { 0.0 } / (side * side) as f64;
            near += usize::from(direction.distance(DVec3::new(0.6, 0.0, 0.8)) < 0.2);
        }
        assert!((mean / PI - 1.0).abs() < 0.01, "{mean}");
        assert!(near > side * side / 5, "{near}");
    }
}
