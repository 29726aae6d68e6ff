//! `pinterp`: synthesises a view from the pixels and distances of other pictures.
//!
//! Each pixel is a point of the scene. In the new view it covers the parallelogram between its own
//! position and those of its neighbours, if these are equally far away. Nearer points hide farther
//! ones. Uncovered pixels lie behind an edge and are filled from the farther side.

use radsight_picture::{Resolution, View, ViewKind};

/// Largest weight of a pixel, for a point seen from the same direction.
const MOST_WEIGHT: f64 = 1000.0;

/// Lengths below this are zero.
const TINY: f64 = 1e-6;

/// The direction along which distances of pixels are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distances {
    /// The ray of the pixel, as in `rpict -z`.
    Rays,
    /// The direction of the view, in perspective views (`-n`).
    ViewDirection,
}

/// Options of view interpolation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InterpolateOptions {
    /// Points whose relative distance difference is below this belong to one surface (`-t`).
    pub tolerance: f64,
    /// Whether pixels of one surface are averaged with weights by viewing direction (`-a`), or the
    /// first one is kept (`-q`).
    pub averages: bool,
    /// Whether pixels extend to their neighbours (`-ff`).
    pub fills_surfaces: bool,
    /// Whether holes are filled from their surroundings (`-fb`), and the largest distance in pixels
    /// (`-fs`); 0 for no limit.
    pub fills_holes: Option<usize>,
    /// Colour and distance of the remaining pixels (`-fc`, `-fz`).
    pub background: ([f32; 3], f32),
    /// The meaning of distances in input and output.
    pub distances: Distances,
}

impl Default for InterpolateOptions {
    /// The defaults of `pinterp` for one picture.
    fn default() -> Self {
        InterpolateOptions {
            tolerance: 0.02,
            averages: false,
            fills_surfaces: true,
            fills_holes: Some(0),
            background: ([0.0; 3], 0.0),
            distances: Distances::Rays,
        }
    }
}

/// The content of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filling {
    /// Colour, in the units of the pictures.
    pub color: [f32; 3],
    /// Distance along the ray, scene units.
    pub depth: f64,
}

/// Computes the content of the pixel at an image position.
type Find<'a> = &'a mut dyn FnMut([f64; 2]) -> Filling;

/// A view being synthesised. Rows are counted from the bottom.
#[derive(Clone, Debug)]
pub struct Interpolation {
    view: View,
    columns: usize,
    rows: usize,
    options: InterpolateOptions,
    sums: Vec<[f64; 3]>,
    weights: Vec<f64>,
    /// Distances along rays; zero for empty pixels.
    depths: Vec<f64>,
}

/// The image position of an input pixel in the new view, and its distance in the input.
#[derive(Clone, Copy)]
struct Position {
    x: i64,
    y: i64,
    depth: f64,
}

/// One side of a parallelogram: steps to the neighbour's position, and their number.
#[derive(Clone, Copy)]
struct Side {
    step: [i64; 2],
    count: i64,
}

impl Side {
    const SINGLE: Side = Side { step: [1, 1], count: 1 };

    fn at(&self, index: i64) -> [i64; 2] {
        self.step.map(|step| index * step / self.count)
    }
}

impl Interpolation {
    /// An empty view of this many columns and rows.
    #[must_use]
    pub fn new(view: View, [columns, rows]: [usize; 2], options: InterpolateOptions) -> Interpolation {
        let pixels = columns * rows;
        Interpolation {
            view,
            columns,
            rows,
            options,
            sums: vec![[0.0; 3]; pixels],
            weights: vec![0.0; pixels],
            depths: vec![0.0; pixels],
        }
    }

    /// Adds a picture: its pixels and their distances, scene units, in scanline order.
    pub fn add(&mut self, pixels: &[[f32; 3]], depths: &[f32], view: &View, resolution: &Resolution) {
        let length = resolution.scanline_length();
        let mut above: Vec<Option<Position>> = vec![None; length];
        let scanlines = pixels.chunks_exact(length).zip(depths.chunks_exact(length)).enumerate();
        for (scanline, (pixels, depths)) in scanlines {
            let mut beside = None;
            for position in (0..length).rev() {
                let image_position = resolution.location(position, scanline);
                let moved = self.moved(view, image_position, f64::from(depths[position]));
                if let Some((here, depth, weight)) = moved {
                    let sides = [beside, above[position]];
                    self.cover(here, sides, (pixels[position], depth, weight));
                }
                beside = moved.map(|(here, ..)| here);
                above[position] = beside;
            }
        }
    }

    /// The image position of a pixel in the new view, its distance there and its weight.
    fn moved(&self, view: &View, image_position: [f64; 2], depth: f64) -> Option<(Position, f64, f64)> {
        if depth.is_nan() || depth <= 0.0 {
            return None;
        }
        let ray = view.ray(image_position)?;
        let mut along = depth;
        if self.options.distances == Distances::ViewDirection && view.options().kind == ViewKind::Perspective {
            along /= view.direction().dot(ray.direction);
        }
        let point = ray.origin + ray.direction * along;
        // What lies beyond the aft plane is clipped at last: until then it is no hole to be filled.
        let found = self.view.locate(point).filter(|found| found.is_inside() && found.distance > 0.0)?;
        let x = (found.x * self.columns as f64) as i64;
        let y = (found.y * self.rows as f64) as i64;
        let weight =
            if self.options.averages { self.weight(point - self.view.options().point, ray.direction) } else { 1.0 };
        Some((Position { x, y, depth }, found.distance, weight))
    }

    /// The reciprocal of the sine of the angle between the old and the new viewing direction.
    fn weight(&self, from_eye: glam::DVec3, direction: glam::DVec3) -> f64 {
        let seen = match self.view.options().kind {
            ViewKind::Parallel => self.view.direction(),
            _ => from_eye.normalize_or_zero(),
        };
        let squared_sine = 1.0 - seen.dot(direction).powi(2);
        if squared_sine <= MOST_WEIGHT.powi(-2) { MOST_WEIGHT } else { squared_sine.sqrt().recip() }
    }

    /// Fills the parallelogram between a pixel and two neighbours.
    fn cover(
        &mut self,
        here: Position,
        [beside, above]: [Option<Position>; 2],
        (color, depth, weight): ([f32; 3], f64, f64),
    ) {
        let threshold = 2.0 * self.options.tolerance * here.depth;
        let reaches = |other: &Position| self.options.fills_surfaces && (other.depth - here.depth).abs() <= threshold;
        let step = |other: Position| [other.x - here.x, other.y - here.y];
        let (first, along_y) = match beside.filter(reaches).map(step) {
            Some(step) if step[1].abs() > step[0].abs() => (Side { step, count: step[1].abs() }, Some(true)),
            Some(step) => (Side { step, count: step[0].abs().max(1) }, Some(false)),
            None => (Side::SINGLE, None),
        };
        let second = match above.filter(reaches).map(step) {
            Some(step) => {
                // Steps across the first side; along both if there is none.
                let count = match along_y {
                    Some(true) => step[0].abs(),
                    Some(false) => step[1].abs(),
                    None => step[0].abs().max(step[1].abs()),
                };
                Side { step, count: count.max(1) }
            }
            None => Side::SINGLE,
        };
        let most = [self.columns as i64, self.rows as i64];
        for index in (0..first.count).rev() {
            let start = first.at(index);
            for index in (0..second.count).rev() {
                let across = second.at(index);
                let [x, y] = [here.x + start[0] + across[0], here.y + start[1] + across[1]];
                if (0..most[0]).contains(&x) && (0..most[1]).contains(&y) {
                    self.put(y as usize * self.columns + x as usize, (color, depth, weight));
                }
            }
        }
    }

    fn put(&mut self, at: usize, (color, depth, weight): ([f32; 3], f64, f64)) {
        let (old, tolerance) = (self.depths[at], self.options.tolerance * self.depths[at]);
        if old <= 0.0 || old - depth > tolerance {
            self.sums[at] = color.map(|band| f64::from(band) * weight);
            self.weights[at] = weight;
            self.depths[at] = depth;
        } else if self.options.averages && depth - old <= tolerance {
            (0..3).for_each(|band| self.sums[at][band] += f64::from(color[band]) * weight);
            self.weights[at] += weight;
        }
    }

    /// Fills uncovered pixels, and clips at the aft plane.
    pub fn finish(&mut self) {
        if let Some(reach) = self.options.fills_holes {
            self.fill_holes(reach, None);
        }
        let (color, depth) = self.options.background;
        let background = Filling { color, depth: f64::from(depth) };
        self.fill_rest(|_| background);
    }

    /// Fills uncovered pixels, either from their surroundings or by `find` at their image position
    /// (`-fr`), and clips at the aft plane.
    pub fn finish_with(&mut self, mut find: impl FnMut([f64; 2]) -> Filling) {
        if let Some(reach) = self.options.fills_holes {
            self.fill_holes(reach, Some(&mut find));
        }
        self.fill_rest(find);
    }

    /// Fills the remaining pixels, and clips.
    fn fill_rest(&mut self, mut filling: impl FnMut([f64; 2]) -> Filling) {
        for at in 0..self.depths.len() {
            if self.depths[at] <= 0.0 {
                self.fill(at, filling(self.image_position(at)));
            }
        }
        self.clip();
    }

    /// The image positions of uncovered pixels: from 0 to 1 from left to right and from the bottom
    /// up.
    #[must_use]
    pub fn holes(&self) -> Vec<[f64; 2]> {
        let holes = (0..self.depths.len()).filter(|at| self.depths[*at] <= 0.0);
        holes.map(|at| self.image_position(at)).collect()
    }

    fn fill(&mut self, at: usize, filling: Filling) {
        self.sums[at] = filling.color.map(f64::from);
        self.weights[at] = 1.0;
        self.depths[at] = filling.depth;
    }

    fn clip(&mut self) {
        for at in 0..self.depths.len() {
            let beyond = self.aft_distance(at).is_some_and(|aft| self.depths[at] > aft);
            if beyond {
                (self.sums[at], self.weights[at], self.depths[at]) = ([0.0; 3], 1.0, 0.0);
            }
        }
    }

    /// Distance of the aft clipping plane along the ray of a pixel.
    fn aft_distance(&self, at: usize) -> Option<f64> {
        let options = self.view.options();
        if options.aft <= TINY {
            return None;
        }
        self.view.ray(self.image_position(at))?.length
    }

    fn image_position(&self, at: usize) -> [f64; 2] {
        let (x, y) = (at % self.columns, at / self.columns);
        [(x as f64 + 0.5) / self.columns as f64, (y as f64 + 0.5) / self.rows as f64]
    }

    /// Copies to each hole the farther of its neighbours in its column or row, adjacent ones first.
    /// A hole too far from both is filled by `find`, if given, and is background for the next hole
    /// then.
    fn fill_holes(&mut self, reach: usize, mut find: Option<Find<'_>>) {
        // The background of each column; `None` until a hole requests it.
        let mut below: Vec<Option<Option<usize>>> = vec![None; self.columns];
        for y in 0..self.rows {
            let mut beside: Option<Option<usize>> = None;
            for (x, below) in below.iter_mut().enumerate() {
                let at = y * self.columns + x;
                if self.depths[at] > 0.0 {
                    (*below, beside) = (None, None);
                    continue;
                }
                let column = *below.get_or_insert_with(|| {
                    let next = (y + 1..self.rows).find(|row| self.depths[row * self.columns + x] > 0.0);
                    self.farther(y.checked_sub(1), next, |row| row * self.columns + x)
                });
                let row = *beside.get_or_insert_with(|| {
                    let next = (x + 1..self.columns).find(|column| self.depths[y * self.columns + column] > 0.0);
                    self.farther(x.checked_sub(1), next, |column| y * self.columns + column)
                });
                match self.background_of([x, y], [column, row], reach) {
                    Some(source) => {
                        self.sums[at] = self.sums[source];
                        self.weights[at] = self.weights[source];
                        self.depths[at] = self.depths[source];
                    }
                    None => {
                        if let Some(find) = &mut find {
                            self.fill(at, find(self.image_position(at)));
                            (*below, beside) = (Some(Some(y)), Some(Some(x)));
                        }
                    }
                }
            }
        }
    }

    /// The pixel from which a hole is filled, among those in its column and row.
    fn background_of(&self, [x, y]: [usize; 2], [column, row]: [Option<usize>; 2], reach: usize) -> Option<usize> {
        let by_row = match (column, row) {
            (None, None) => return None,
            (Some(_), None) => false,
            (None, Some(_)) => true,
            (Some(column), Some(row)) => {
                let is_farther = self.depths[column * self.columns + x] < self.depths[y * self.columns + row];
                row.abs_diff(x) <= 1 || (column.abs_diff(y) > 1 && is_farther)
            }
        };
        let (source, away) = match (by_row, column, row) {
            (true, _, Some(row)) => (y * self.columns + row, row.abs_diff(x) + 1),
            (_, Some(column), _) => (column * self.columns + x, column.abs_diff(y)),
            _ => return None,
        };
        (reach == 0 || away <= reach).then_some(source)
    }

    /// The farther of the pixels before and after a hole.
    fn farther(&self, before: Option<usize>, next: Option<usize>, at: impl Fn(usize) -> usize) -> Option<usize> {
        match (before, next) {
            (Some(before), Some(next)) if self.depths[at(before)] < self.depths[at(next)] => Some(next),
            (None, Some(next)) => Some(next),
            (before, _) => before,
        }
    }

    /// The picture, its rows from the top.
    #[must_use]
    pub fn pixels(&self) -> Vec<[f32; 3]> {
        let value = |at: usize| self.sums[at].map(|sum| (sum / self.weights[at].max(f64::MIN_POSITIVE)) as f32);
        self.in_picture_order().map(value).collect()
    }

    /// The distances, their rows from the top.
    #[must_use]
    pub fn depths(&self) -> Vec<f32> {
        let is_along_view =
            self.options.distances == Distances::ViewDirection && self.view.options().kind == ViewKind::Perspective;
        let value = |at: usize| {
            let cosine =
                self.view.ray(self.image_position(at)).map_or(1.0, |ray| ray.direction.dot(self.view.direction()));
            (self.depths[at] * if is_along_view { cosine } else { 1.0 }) as f32
        };
        self.in_picture_order().map(value).collect()
    }

    fn in_picture_order(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.rows).rev().flat_map(|row| row * self.columns..(row + 1) * self.columns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use radsight_picture::ViewOptions;

    fn view(x: f64) -> View {
        View::new(ViewOptions { point: DVec3::new(x, 0.0, 0.0), ..ViewOptions::default() }).unwrap()
    }

    /// A wall 4 units away whose colour is its position.
    fn wall(view: &View, resolution: &Resolution) -> (Vec<[f32; 3]>, Vec<f32>) {
        let pixels = (0..resolution.height).flat_map(|y| (0..resolution.width).map(move |x| (x, y)));
        pixels
            .map(|(x, y)| {
                let ray = view.ray(resolution.location(x, y)).unwrap();
                let depth = 4.0 / ray.direction.y;
                let point = ray.origin + ray.direction * depth;
                ([point.x as f32 + 9.0, point.z as f32 + 9.0, 1.0], depth as f32)
            })
            .unzip()
    }

    #[test]
    fn a_wall_is_seen_as_from_the_new_viewpoint() {
        let resolution = Resolution::standard(60, 60);
        for averages in [false, true] {
            let mut made = Interpolation::new(
                view(0.1),
                [60, 60],
                InterpolateOptions { averages, ..InterpolateOptions::default() },
            );
            for x in [0.0, 0.2] {
                let (pixels, depths) = wall(&view(x), &resolution);
                made.add(&pixels, &depths, &view(x), &resolution);
            }
            made.finish();
            let (expected, expected_depths) = wall(&view(0.1), &resolution);
            for (at, (found, expected)) in made.pixels().iter().zip(&expected).enumerate() {
                // Two pixels of the wall are 0.11 units.
                assert!(
                    (0..3).all(|i| (found[i] - expected[i]).abs() < 0.12),
                    "{at}: {found:?}, expected {expected:?}"
                );
            }
            for (found, expected) in made.depths().iter().zip(&expected_depths) {
                assert!((found / expected - 1.0).abs() < 0.02);
            }
        }
    }

    #[test]
    fn what_is_near_hides_what_is_far_and_holes_show_what_is_behind() {
        let resolution = Resolution::standard(40, 1);
        let seen = view(0.0);
        // A post in the middle, in front of a wall.
        let near = |x: usize| (15..25).contains(&x);
        let pixels: Vec<[f32; 3]> = (0..40).map(|x| if near(x) { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] }).collect();
        let depths: Vec<f32> = (0..40).map(|x| if near(x) { 1.0 } else { 5.0 }).collect();
        let mut made = Interpolation::new(view(0.1), [40, 1], InterpolateOptions::default());
        made.add(&pixels, &depths, &seen, &resolution);
        made.finish();
        let found = made.pixels();
        let red = found.iter().filter(|pixel| pixel[0] == 1.0).count();
        assert!((9..=11).contains(&red), "{red} pixels of the post");
        assert!(found[..38].iter().all(|pixel| pixel[0] + pixel[1] == 1.0), "{found:?}");
        let first = found.iter().position(|pixel| pixel[0] == 1.0);
        assert!(first.is_some_and(|first| (9..14).contains(&first)), "the post has moved to the left: {first:?}");
    }
}
