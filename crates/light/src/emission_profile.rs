//! Emission profiles of large lamps with a narrow measured distribution.
//!
//! A point near such a lamp gets most of its light from the small part of the lamp that emits
//! towards it. Sampling by area seldom finds that part, so half of the samples follow the
//! distribution instead: it is tabulated at the lamp's centre, a direction is sampled from the
//! table, and the direction gives the point on the lamp. Both techniques form one mixture density,
//! so the table may be inexact where the distribution varies over the lamp.

use crate::form::LightForm;
use glam::DVec3;

/// Cells of the table along each axis; about 1.8° near the normal.
const CELLS: usize = 64;

/// Smallest cosine to the normal in the conversion from direction to area.
const GRAZING: f64 = 0.05;

/// A distribution is narrow if the mean of its square exceeds the square of its mean by this
/// factor.
const NARROW: f64 = 4.0;

/// A distribution is wide if a coarse table gives a smaller factor.
const SURELY_WIDE: f64 = 2.0;

/// A light is near if the sine of its bounding sphere's half angle exceeds this.
const NEAR: f64 = 0.1;

/// Fraction of the samples on a near light that follow the profile.
const BY_DIRECTION: f64 = 0.5;

/// Directions out of a flat light, sampled in proportion to its radiance. A direction is addressed
/// by its projection onto the light's plane: the unit circle, in a square of cells.
#[derive(Clone, Debug)]
pub struct EmissionProfile {
    /// Orthonormal: two vectors in the light's plane, and its normal.
    frame: [DVec3; 3],
    /// Cumulative probability of the rows of cells, and of the cells within each row.
    rows: Vec<f32>,
    columns: Vec<f32>,
}

/// A sampled direction out of a light.
#[derive(Clone, Copy, Debug)]
pub struct ProfileSample {
    /// Unit vector away from the light.
    pub direction: DVec3,
    /// Density, 1/sr.
    pub pdf: f64,
}

impl EmissionProfile {
    /// Profile of a light with a narrow distribution; none if it is wide. `radiance` gives the
    /// radiance that leaves in a unit direction.
    pub fn new(form: &LightForm, mut radiance: impl FnMut(DVec3) -> f64) -> Option<EmissionProfile> {
        let (normal, _) = form.plane()?;
        let (x, y) = normal.any_orthonormal_pair();
        let mut at_corner = |index: usize| {
            let [a, b] = [index % (CELLS + 1), index / (CELLS + 1)].map(|step| 2.0 * step as f64 / CELLS as f64 - 1.0);
            let cosine = (1.0 - a * a - b * b).max(0.0).sqrt();
            if cosine > 0.0 { [radiance(x * a + y * b + normal * cosine).max(0.0), cosine] } else { [0.0; 2] }
        };
        let corners = 0..(CELLS + 1) * (CELLS + 1);
        // Most distributions are wide, and a coarse table shows that of them.
        let is_coarse = |corner: &usize| [corner % (CELLS + 1), corner / (CELLS + 1)].iter().all(|step| step % 2 == 0);
        let coarse: Vec<[f64; 2]> = corners.clone().filter(is_coarse).map(&mut at_corner).collect();
        if narrowness(&coarse).is_some_and(|narrowness| narrowness < SURELY_WIDE) {
            return None;
        }
        let corners: Vec<[f64; 2]> = corners.map(&mut at_corner).collect();
        let is_narrow = narrowness(&corners).is_some_and(|narrowness| narrowness > NARROW);
        is_narrow.then(|| EmissionProfile::of_corners([x, y, normal], &corners))
    }

    fn of_corners(frame: [DVec3; 3], corners: &[[f64; 2]]) -> EmissionProfile {
        let weight = |[radiance, cosine]: [f64; 2]| radiance / cosine.max(GRAZING);
        let (mut rows, mut columns) = (Vec::with_capacity(CELLS), Vec::with_capacity(CELLS * CELLS));
        for row in 0..CELLS {
            let of_cell = |column| {
                let first = row * (CELLS + 1) + column;
                [first, first + 1, first + CELLS + 1, first + CELLS + 2]
                    .map(|corner| weight(corners[corner]))
                    .iter()
                    .sum()
            };
            let weights: Vec<f64> = (0..CELLS).map(of_cell).collect();
            columns.extend(cumulative(&weights));
            rows.push(weights.iter().sum());
        }
        EmissionProfile { frame, rows: cumulative(&rows).collect(), columns }
    }

    /// Probability of sampling by direction, for a receiver at this distance from the centre of a
    /// light of this radius.
    pub fn chance(distance: f64, radius: f64) -> f64 {
        if radius > NEAR * distance { BY_DIRECTION } else { 0.0 }
    }

    /// Maps a point of the unit square to a direction away from the light.
    pub fn sample(&self, [u, v]: [f64; 2]) -> Option<ProfileSample> {
        let row = SampledCell::new(&self.rows, v);
        let column = SampledCell::new(&self.columns[row.index * CELLS..][..CELLS], u);
        let [a, b] = [&column, &row].map(|cell| 2.0 * (cell.index as f64 + cell.within) / CELLS as f64 - 1.0);
        let squared = 1.0 - a * a - b * b;
        let [x, y, normal] = self.frame;
        (squared > 0.0).then(|| {
            let cosine = squared.sqrt();
            let direction = x * a + y * b + normal * cosine;
            ProfileSample { direction, pdf: density(row.probability * column.probability, cosine) }
        })
    }

    /// Density of [`EmissionProfile::sample`], 1/sr.
    pub fn pdf(&self, direction: DVec3) -> f64 {
        let [a, b, cosine] = self.frame.map(|axis| axis.dot(direction));
        if cosine <= 0.0 {
            return 0.0;
        }
        let [column, row] = [a, b].map(|at| ((0.5 * (at + 1.0) * CELLS as f64) as usize).min(CELLS - 1));
        density(probability(&self.rows, row) * probability(&self.columns[row * CELLS..][..CELLS], column), cosine)
    }
}

/// Density of the directions of a cell, 1/sr: its probability over its solid angle, which is its area
/// over the cosine.
fn density(probability: f64, cosine: f64) -> f64 {
    probability * (0.25 * (CELLS * CELLS) as f64) * cosine
}

/// The mean of the square of the radiance relative to the square of its mean, over directions out of
/// the light; `None` if it is dark.
fn narrowness(corners: &[[f64; 2]]) -> Option<f64> {
    let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
    for [radiance, _] in corners.iter().filter(|[_, cosine]| *cosine > 0.0) {
        sum += radiance;
        squares += radiance * radiance;
        count += 1.0;
    }
    (sum > 0.0 && squares.is_finite()).then(|| squares * count / (sum * sum))
}

/// Cumulative probabilities in proportion to these weights; zero if all weights are.
fn cumulative(weights: &[f64]) -> impl Iterator<Item = f32> {
    let total: f64 = weights.iter().sum();
    weights.iter().scan(0.0, move |sum, weight| {
        *sum += weight;
        Some(if total > 0.0 { (*sum / total) as f32 } else { 0.0 })
    })
}

/// A cell that is sampled from a cumulative distribution.
struct SampledCell {
    index: usize,
    /// Position within the cell, 0…1.
    within: f64,
    probability: f64,
}

impl SampledCell {
    fn new(cumulative: &[f32], u: f64) -> SampledCell {
        let index = cumulative.partition_point(|sum| f64::from(*sum) <= u).min(cumulative.len() - 1);
        let [before, after] = limits(cumulative, index);
        let probability = after - before;
        let within = if probability > 0.0 { ((u - before) / probability).clamp(0.0, 1.0) } else { 0.5 };
        SampledCell { index, within, probability }
    }
}

fn probability(cumulative: &[f32], index: usize) -> f64 {
    let [before, after] = limits(cumulative, index);
    after - before
}

/// The cumulative probabilities at the start and at the end of a cell.
fn limits(cumulative: &[f32], index: usize) -> [f64; 2] {
    [if index == 0 { 0.0 } else { f64::from(cumulative[index - 1]) }, f64::from(cumulative[index])]
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
    fn a_wide_distribution_has_no_profile() {
        assert!(EmissionProfile::new(&square(), |direction| direction.z).is_none());
        assert!(EmissionProfile::new(&square(), |_| 0.0).is_none());
    }

    #[test]
    fn a_beam_of_five_degrees_has_a_profile() {
        let beam = |axis: DVec3| move |out: DVec3| f64::from(u8::from(out.dot(axis) > 2.5_f64.to_radians().cos()));
        for turn in 0..16 {
            let (sine, cosine) = (0.1 * f64::from(turn)).sin_cos();
            let axis = DVec3::new(0.6 * cosine, 0.6 * sine, 0.8);
            assert!(EmissionProfile::new(&square(), beam(axis)).is_some(), "{axis}");
        }
    }

    #[test]
    fn directions_are_sampled_with_the_density_of_pdf() {
        let profile = EmissionProfile::new(&square(), narrow).expect("the pattern is narrow");
        let (mut mean, mut near, side) = (0.0, 0, 512);
        for index in 0..side * side {
            let u = [index % side, index / side].map(|step| (step as f64 + 0.5) / side as f64);
            let Some(ProfileSample { direction, pdf }) = profile.sample(u) else { continue };
            assert!((pdf / profile.pdf(direction) - 1.0).abs() < 1e-9);
            // The mean of 1/pdf over samples is the solid angle: here the part of the hemisphere
            // above z = 0.5, π.
            mean += if direction.z > 0.5 { 1.0 / profile.pdf(direction) } else { 0.0 } / (side * side) as f64;
            near += usize::from(direction.distance(DVec3::new(0.6, 0.0, 0.8)) < 0.2);
        }
        assert!((mean / PI - 1.0).abs() < 0.01, "{mean}");
        assert!(near > side * side / 5, "{near}");
    }
}
