//! A colour warp: pairs of colours before and after, as in `pcond -m`.

use radsight_picture::leading_number;
use std::sync::OnceLock;

/// Pairs of colours. Shifts between them are interpolated with inverse squared distances as
/// weights.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorWarp {
    from: Vec<[f32; 3]>,
    shifts: Vec<[f32; 3]>,
    /// The smallest and the largest squared distance between points.
    apart: [f64; 2],
}

/// Points closer than this coincide.
const NEAR: f64 = 1e-5;

/// Largest number of grid steps along a side.
const MOST_STEPS: f64 = 62.0;

/// Largest number of points: each is compared with all others.
const MOST_POINTS: usize = 1 << 14;

/// Margin of the grid around its points, in units of the smallest distance.
const MARGIN: f32 = 0.501;

impl ColorWarp {
    /// Parses six numbers for each colour: red, green and blue before and after. As in Radiance,
    /// parsing stops at the first word that is not a number.
    ///
    /// # Errors
    /// The missing data.
    pub fn read(text: &str) -> Result<ColorWarp, &'static str> {
        let numbers = text.split_whitespace().map_while(|word| match leading_number(word.as_bytes()) {
            (number, used) if used == word.len() => Some(number as f32),
            _ => None,
        });
        let numbers: Vec<f32> = numbers.collect();
        let mut warp = ColorWarp { from: Vec::new(), shifts: Vec::new(), apart: [1e10, 0.0] };
        for [from @ .., a, b, c] in numbers.as_chunks::<6>().0 {
            if warp.from.len() == MOST_POINTS {
                return Err("at most 16384 colours");
            }
            warp.add(*from, [*a, *b, *c]);
        }
        // If all points coincide, there are no shifts between them.
        match warp.from.len() {
            0 | 1 => Err("two colours or more, with six numbers for each"),
            _ if warp.apart[1] < NEAR => Err("colours that are not all the same"),
            _ => Ok(warp),
        }
    }

    fn add(&mut self, from: [f32; 3], to: [f32; 3]) {
        let [mut least, mut most] = self.apart;
        for other in self.from.iter().rev() {
            let squared = squared_distance(from, *other);
            if squared < NEAR * NEAR {
                return;
            }
            (least, most) = (least.min(squared), most.max(squared));
        }
        self.apart = [least, most];
        self.from.push(from);
        self.shifts.push(std::array::from_fn(|i| to[i] - from[i]));
    }

    /// The shift of a colour.
    fn shift(&self, color: [f32; 3]) -> [f32; 3] {
        let (mut sum, mut weights) = ([0.0f32; 3], 0.0);
        for (from, shift) in self.from.iter().zip(&self.shifts).rev() {
            let weight = 1.0 / squared_distance(color, *from).max(NEAR * NEAR);
            for (sum, shift) in sum.iter_mut().zip(shift) {
                *sum = (f64::from(*sum) + weight * f64::from(*shift)) as f32;
            }
            weights += weight;
        }
        sum.map(|sum| (f64::from(sum) / weights) as f32)
    }
}

fn squared_distance(a: [f32; 3], b: [f32; 3]) -> f64 {
    (0..3).map(|i| f64::from(a[i] - b[i])).map(|apart| apart * apart).sum()
}

/// A grid over the colours of a warp, with interpolated shifts.
#[derive(Clone, Debug)]
pub(super) struct WarpGrid {
    warp: ColorWarp,
    low: [f32; 3],
    step: [f32; 3],
    steps: [usize; 3],
    /// The shifts at grid points, computed on demand.
    shifts: Vec<OnceLock<[f32; 3]>>,
}

impl WarpGrid {
    pub(super) fn new(warp: &ColorWarp) -> WarpGrid {
        let distance = warp.apart[0].sqrt() as f32;
        let end =
            |i: usize, pick: fn(f32, f32) -> f32| warp.from.iter().map(|from| from[i]).fold(warp.from[0][i], pick);
        let low = std::array::from_fn(|i| end(i, f32::min) - MARGIN * distance);
        let size: [f32; 3] = std::array::from_fn(|i| end(i, f32::max) + MARGIN * distance - low[i]);
        let steps = size.map(|size| f64::from((size / distance + 0.5).floor()).clamp(1.0, MOST_STEPS) as usize);
        let step = std::array::from_fn(|i| size[i] / steps[i] as f32);
        let points = steps.iter().map(|count| count + 1).product();
        WarpGrid { warp: warp.clone(), low, step, steps, shifts: vec![OnceLock::new(); points] }
    }

    fn shift_at(&self, [x, y, z]: [usize; 3]) -> [f32; 3] {
        let position = (z * (self.steps[1] + 1) + y) * (self.steps[0] + 1) + x;
        let at = [x, y, z];
        let color = || std::array::from_fn(|i| self.low[i] + at[i] as f32 * self.step[i]);
        *self.shifts[position].get_or_init(|| self.warp.shift(color()))
    }

    /// The warped colour; beyond the grid its border values are used.
    pub(super) fn apply(&self, color: [f32; 3]) -> [f32; 3] {
        let (mut cell, mut rest) = ([0; 3], [0.0; 3]);
        for i in 0..3 {
            let position = f64::from((color[i] - self.low[i]) / self.step[i]);
            cell[i] = (position.max(0.0) as usize).min(self.steps[i] - 1);
            rest[i] = position - cell[i] as f64;
        }
        let mix = |from: [f32; 3], to: [f32; 3], part: f64| -> [f32; 3] {
            std::array::from_fn(|i| ((1.0 - part) * f64::from(from[i]) + part * f64::from(to[i])) as f32)
        };
        let corner = |x: usize, y: usize, z: usize| self.shift_at([cell[0] + x, cell[1] + y, cell[2] + z]);
        let edge = |y: usize, z: usize| mix(corner(0, y, z), corner(1, y, z), rest[0]);
        let side = |z: usize| mix(edge(0, z), edge(1, z), rest[1]);
        let shift = mix(side(0), side(1), rest[2]);
        std::array::from_fn(|i| color[i] + shift[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_points_of_a_map_are_met() {
        let warp = ColorWarp::read("0 0 0 .1 0 0\n1 0 0 1 .2 0\n0 1 0 0 1 .3\n0 0 1 0 0 1\n1 1 1 1 1 1").unwrap();
        assert_eq!(warp.shift([0.0; 3]).map(|shift| (shift * 1e4).round()), [1e3, 0.0, 0.0]);
        let grid = WarpGrid::new(&warp);
        assert_eq!(grid.steps, [2; 3]);
        let middle = grid.apply([0.5; 3]);
        assert!(middle.iter().zip([0.5; 3]).all(|(a, b)| (a - b).abs() < 0.15), "{middle:?}");
        assert!(grid.apply([9.0, -9.0, f32::MAX]).iter().all(|value| !value.is_nan()));
    }

    #[test]
    fn invalid_warps_are_reported() {
        for text in ["", "1 2 3 4 5 6", "1 2 3 4 5 6 1 2 3 4 5 6", "x", "0 0 0 0 0 0 1 1"] {
            assert_eq!(ColorWarp::read(text).unwrap_err(), "two colours or more, with six numbers for each", "{text}");
        }
    }
}
