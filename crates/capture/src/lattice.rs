//! Nested lattices of pixels, and interpolation from each level to the next.
//!
//! Along each axis a level has the coordinates of the previous level and the midpoints between
//! them; the last level has all pixels. The cells of the picture lie between the coordinates of
//! level 1. Level 0 has every second of these coordinates: how well it predicts level 1 shows how
//! well a level is interpolated from the previous one.

/// Distance between the coordinates of level 1, pixels.
pub(crate) const STRIDE: u32 = 8;

/// Least number of pixels along each side of a picture that is interpolated, and of a film. Pixels of a film
/// share their rays even if none is interpolated.
pub(crate) const LEAST_SIDE: u32 = 4 * STRIDE;
pub(crate) const LEAST_FILM_SIDE: u32 = 2 * STRIDE;

/// Points of the previous level that interpolate a point along one axis: Lagrange's cubic
/// polynomial.
const POINTS: usize = 4;

/// The interpolation of a coordinate from the previous level.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Stencil {
    at: [usize; POINTS],
    weights: [f64; POINTS],
    count: usize,
}

impl Stencil {
    /// From sorted coordinates.
    fn new(coordinates: &[u32], at: u32) -> Stencil {
        let next = coordinates.partition_point(|coordinate| *coordinate < at);
        if coordinates.get(next) == Some(&at) {
            let mut own = Stencil { count: 1, ..Stencil::default() };
            (own.at[0], own.weights[0]) = (at as usize, 1.0);
            return own;
        }
        let count = coordinates.len().min(POINTS);
        let first = next.saturating_sub(count / 2).min(coordinates.len() - count);
        let near = &coordinates[first..first + count];
        let mut stencil = Stencil { count, ..Stencil::default() };
        for (index, own) in near.iter().enumerate() {
            let others = near.iter().filter(|other| *other != own);
            let factor = |other: &u32| (f64::from(at) - f64::from(*other)) / (f64::from(*own) - f64::from(*other));
            stencil.at[index] = *own as usize;
            stencil.weights[index] = others.map(factor).product();
        }
        stencil
    }

    fn terms(&self) -> impl Iterator<Item = (usize, f64)> {
        self.at.into_iter().zip(self.weights).take(self.count)
    }
}

/// The levels along one axis.
#[derive(Clone, Debug)]
struct AxisLevels {
    /// By level, sorted.
    coordinates: Vec<Vec<u32>>,
    /// The first level, from 1, that contains each pixel.
    ranks: Vec<u8>,
    /// By level and pixel, from the previous level. Empty for level 0 and for pixels that are not
    /// on a level.
    stencils: Vec<Vec<Stencil>>,
}

impl AxisLevels {
    fn new(count: u32, offset: u32, depth: usize) -> AxisLevels {
        let last = count - 1;
        let mut level: Vec<u32> = vec![0];
        level.extend((offset..).step_by(STRIDE as usize).take_while(|at| at + STRIDE / 2 <= last));
        level.push(last);
        let mut ends: Vec<u32> = level.iter().copied().step_by(2).collect();
        if ends.last() != Some(&last) {
            ends.push(last);
        }
        let mut coordinates = vec![ends, level];
        while coordinates.len() < depth {
            let before = &coordinates[coordinates.len() - 1];
            let mut finer: Vec<u32> = before.windows(2).flat_map(|pair| [pair[0], pair[0].midpoint(pair[1])]).collect();
            finer.push(last);
            finer.dedup();
            coordinates.push(finer);
        }
        let mut ranks = vec![u8::MAX; count as usize];
        for (level, coordinates) in coordinates.iter().enumerate().skip(1).rev() {
            coordinates.iter().for_each(|at| ranks[*at as usize] = level as u8);
        }
        let stencils = (0..coordinates.len()).map(|level| {
            let mut stencils = vec![Stencil::default(); count as usize];
            if level > 0 {
                for at in &coordinates[level] {
                    stencils[*at as usize] = Stencil::new(&coordinates[level - 1], *at);
                }
            }
            if level == 1 {
                predict_last_inner(&mut stencils, &coordinates[1]);
            }
            stencils
        });
        AxisLevels { stencils: stencils.collect(), coordinates, ranks }
    }

    /// Number of levels until all pixels are on one.
    fn depth(count: u32, offset: u32) -> usize {
        let mut depth = 3;
        while AxisLevels::new(count, offset, depth).coordinates[depth - 1].len() < count as usize {
            depth += 1;
        }
        depth
    }

    fn cells(&self) -> usize {
        self.coordinates[1].len() - 1
    }

    /// The first and last pixel of a cell; neighbouring cells share them.
    fn cell(&self, cell: usize) -> std::ops::RangeInclusive<usize> {
        self.coordinates[1][cell] as usize..=self.coordinates[1][cell + 1] as usize
    }
}

/// With an even number of coordinates, level 0 has the last two of them. Predicts the last but one from
/// those of the other parity, so that no cell is without a prediction along an axis.
fn predict_last_inner(stencils: &mut [Stencil], coordinates: &[u32]) {
    if let [.., inner, _] = coordinates
        && coordinates.len().is_multiple_of(2)
    {
        let others: Vec<u32> = coordinates.iter().copied().skip(1).step_by(2).collect();
        stencils[*inner as usize] = Stencil::new(&others, *inner);
    }
}

/// The lattices of a picture.
#[derive(Clone, Debug)]
pub(crate) struct Lattice {
    x: AxisLevels,
    y: AxisLevels,
    /// Number of levels; the last has all pixels.
    depth: usize,
}

impl Lattice {
    /// `offset`, from 0 to 1 each, places the first inner coordinates of level 1 in their range.
    /// `None` if a side has fewer than `least` pixels.
    pub(crate) fn new([columns, rows]: [u32; 2], least: u32, offset: [f64; 2]) -> Option<Lattice> {
        if columns.min(rows) < least {
            return None;
        }
        let [x, y] = offset.map(|share| STRIDE / 2 + (share * f64::from(STRIDE)) as u32);
        let depth = AxisLevels::depth(columns, x).max(AxisLevels::depth(rows, y));
        Some(Lattice { x: AxisLevels::new(columns, x, depth), y: AxisLevels::new(rows, y, depth), depth })
    }

    pub(crate) fn columns(&self) -> usize {
        self.x.ranks.len()
    }

    pub(crate) fn pixel_count(&self) -> usize {
        self.columns() * self.y.ranks.len()
    }

    /// The level with all pixels.
    pub(crate) fn finest(&self) -> u8 {
        (self.depth - 1) as u8
    }

    /// Approximate distance between the points of a level, pixels.
    pub(crate) fn stride(level: u8) -> usize {
        (STRIDE as usize >> (level - 1)).max(1)
    }

    /// Columns and rows of cells.
    pub(crate) fn cells(&self) -> [usize; 2] {
        [self.x.cells(), self.y.cells()]
    }

    /// Columns and rows of pixels of a cell, both ends included.
    pub(crate) fn cell(&self, cell: usize) -> [std::ops::RangeInclusive<usize>; 2] {
        [self.x.cell(cell % self.x.cells()), self.y.cell(cell / self.x.cells())]
    }

    /// An upper limit of the distance from a cell to the points from which a level is interpolated
    /// there, pixels. Near the border of the picture they are on one side, and unevenly spaced.
    pub(crate) fn support(&self, cell: usize, level: u8) -> usize {
        let from_border = |at: usize, count: usize| at.min(count - 1 - at);
        let across = self.x.cells();
        let cells = from_border(cell % across, across).min(from_border(cell / across, self.y.cells()));
        let stride = Lattice::stride(level);
        match cells {
            0 => 2 * stride,
            1 => stride + stride / 2,
            _ => stride,
        }
    }

    /// The pixels of a cell, each with the first level that contains it.
    pub(crate) fn pixels(&self, cell: usize) -> impl Iterator<Item = (usize, u8)> {
        let [columns, rows] = self.cell(cell);
        let of_row = move |y: usize| {
            let of_pixel = move |x: usize| (y * self.columns() + x, self.x.ranks[x].max(self.y.ranks[y]));
            columns.clone().map(of_pixel)
        };
        rows.flat_map(of_row)
    }

    /// For each pixel the finest level of the cells that have it as a lattice point; 0 where it is
    /// none.
    pub(crate) fn nodes(&self, levels: &[u8]) -> Vec<u8> {
        let mut nodes = vec![0; self.pixel_count()];
        for (cell, level) in levels.iter().enumerate() {
            for (pixel, _) in self.pixels(cell).filter(|(_, rank)| rank <= level) {
                nodes[pixel] = nodes[pixel].max(*level);
            }
        }
        nodes
    }

    /// Interpolates all pixels that are not nodes, each level from the previous one. `of_weight` is
    /// applied to every weight.
    pub(crate) fn fill(&self, values: &mut [f64], nodes: &[u8], of_weight: impl Fn(f64) -> f64) {
        let columns = self.columns();
        for level in 2..self.depth {
            let stencils = &self.x.stencils[level];
            for y in self.y.coordinates[level - 1].iter().map(|y| *y as usize * columns) {
                for x in self.x.coordinates[level].iter().map(|x| *x as usize) {
                    if nodes[y + x] == 0 && stencils[x].count > 1 {
                        values[y + x] =
                            stencils[x].terms().map(|(at, weight)| of_weight(weight) * values[y + at]).sum();
                    }
                }
            }
            let stencils = &self.y.stencils[level];
            for y in self.y.coordinates[level].iter().map(|y| *y as usize).filter(|y| stencils[*y].count > 1) {
                for x in self.x.coordinates[level].iter().map(|x| *x as usize) {
                    if nodes[y * columns + x] == 0 {
                        let term = |(at, weight)| of_weight(weight) * values[at * columns + x];
                        values[y * columns + x] = stencils[y].terms().map(term).sum();
                    }
                }
            }
        }
    }

    /// The sum of squared weights times values of the points of a cell's level outside the cell, from which
    /// pixels of the next level are interpolated: the mean over these pixels.
    pub(crate) fn weighted_outside(&self, (cell, level): (usize, u8), values: &[f64]) -> f64 {
        let next = usize::from(level) + 1;
        if next >= self.depth {
            return 0.0;
        }
        let [columns, rows] = self.cell(cell);
        let (mut sum, mut count) = (0.0, 0.0);
        for (pixel, _) in self.pixels(cell).filter(|(_, rank)| usize::from(*rank) == next) {
            let (across, down) =
                (&self.x.stencils[next][pixel % self.columns()], &self.y.stencils[next][pixel / self.columns()]);
            for (y, by_row) in down.terms() {
                let is_counted = |x: &usize| {
                    !(columns.contains(x) && rows.contains(&y)) && self.x.ranks[*x].max(self.y.ranks[y]) == level
                };
                for (x, by_column) in across.terms().filter(|(x, _)| is_counted(x)) {
                    sum += (by_row * by_column).powi(2) * values[y * self.columns() + x];
                }
            }
            count += 1.0;
        }
        sum / f64::max(count, 1.0)
    }

    /// The interpolation of a pixel from the level before its own. Pixels of level 1 use level 0;
    /// `None` for pixels of level 0.
    pub(crate) fn predicted(&self, pixel: usize, values: &[f64], of_weight: impl Fn(f64) -> f64) -> Option<f64> {
        let (x, y) = (pixel % self.columns(), pixel / self.columns());
        let level = usize::from(self.x.ranks[x].max(self.y.ranks[y]));
        let (across, down) = (&self.x.stencils[level][x], &self.y.stencils[level][y]);
        if across.count <= 1 && down.count <= 1 {
            return None;
        }
        let of_row = |(row, weight): (usize, f64)| {
            let term = |(at, weight)| of_weight(weight) * values[row * self.columns() + at];
            of_weight(weight) * across.terms().map(term).sum::<f64>()
        };
        Some(down.terms().map(of_row).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cubic(pixel: usize, columns: usize) -> f64 {
        let (x, y) = ((pixel % columns) as f64 * 0.1, (pixel / columns) as f64 * 0.1);
        1.0 + x - 0.3 * y * y + 0.02 * x * x * x * y - 0.01 * y * y * y
    }

    #[test]
    fn the_finest_level_has_every_pixel() {
        for (columns, rows, offset) in
            [(192, 165, [0.0, 0.99]), (32, 47, [0.5, 0.2]), (33, 64, [0.99, 0.0]), (16, 17, [0.99, 0.0])]
        {
            let lattice = Lattice::new([columns, rows], LEAST_FILM_SIDE, offset).expect("the picture is large enough");
            let cells = lattice.cells()[0] * lattice.cells()[1];
            let nodes = lattice.nodes(&vec![lattice.finest(); cells]);
            assert!(nodes.iter().all(|level| *level == lattice.finest()));
        }
        assert!(Lattice::new([192, 31], LEAST_SIDE, [0.0; 2]).is_none());
    }

    #[test]
    fn every_cell_has_points_that_are_predicted_along_each_axis() {
        for count in 61..61 + 2 * STRIDE {
            let lattice = Lattice::new([count, 64], LEAST_SIDE, [0.3, 0.7]).expect("the picture is large enough");
            for cell in 0..lattice.x.cells() {
                let ends = lattice.x.cell(cell);
                let is_predicted = |at: &usize| lattice.x.stencils[1][*at].count > 1;
                assert!([ends.start(), ends.end()].into_iter().any(is_predicted), "cell {cell} of {count} pixels");
            }
        }
    }

    /// Beside the border a point two cells away has a third of a weight.
    #[test]
    fn points_outside_a_cell_count_by_their_squared_weights() {
        let lattice = Lattice::new([64; 2], LEAST_SIDE, [0.5; 2]).expect("the picture is large enough");
        let across = lattice.cells()[0];
        let of = |point: [usize; 2], cell: usize| {
            let mut values = vec![0.0; lattice.pixel_count()];
            let [x, y] = point.map(|index| lattice.x.coordinates[1][index] as usize);
            values[y * 64 + x] = 1.0;
            lattice.weighted_outside((cell, 1), &values)
        };
        assert!(of([2, 0], 0) > 0.02, "{}", of([2, 0], 0));
        assert!(of([3, 0], 0) > 0.0);
        assert_eq!([of([1, 0], 0), of([4, 0], 0)], [0.0; 2]);
        // Within the picture a cell reaches one cell farther.
        let inner = 2 * across + 2;
        assert!(of([4, 2], inner) > 0.0 && of([4, 2], inner) < of([2, 0], 0));
        assert_eq!(of([5, 2], inner), 0.0);
    }

    #[test]
    fn cubic_polynomials_are_interpolated_exactly() {
        let lattice = Lattice::new([61, 50], LEAST_SIDE, [0.3, 0.7]).expect("the picture is large enough");
        let [across, down] = lattice.cells();
        let mut levels = vec![1; across * down];
        (levels[across + 1], levels[across + 2], levels[5]) = (lattice.finest(), 2, 3);
        let nodes = lattice.nodes(&levels);
        let truth: Vec<f64> = (0..lattice.pixel_count()).map(|pixel| cubic(pixel, 61)).collect();
        let mut values: Vec<f64> =
            truth.iter().zip(&nodes).map(|(value, node)| if *node > 0 { *value } else { f64::NAN }).collect();
        lattice.fill(&mut values, &nodes, |weight| weight);
        for (pixel, value) in values.iter().enumerate() {
            assert!((value - truth[pixel]).abs() < 1e-9, "{pixel}: {value} for {}", truth[pixel]);
            let predicted = lattice.predicted(pixel, &values, |weight| weight);
            assert!(predicted.is_none_or(|predicted| (predicted - truth[pixel]).abs() < 1e-9));
        }
        assert!(nodes.iter().filter(|level| **level > 0).count() < lattice.pixel_count() / 5);
    }
}
