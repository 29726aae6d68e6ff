//! Piecewise bilinear functions on the unit square, and sampling with such densities.

/// Functions on the unit square, one per parameter:
/// `numbers[(parameter · rows + row) · columns + column]`, with x along a row.
#[derive(Clone, Debug)]
pub(crate) struct Grids {
    numbers: Vec<f32>,
    rows: usize,
    columns: usize,
}

/// Parameters with weights, for interpolation.
pub(crate) type Mix = [(usize, f64); 4];

/// Interval of a coordinate, and the weight of its upper end.
fn place(coordinate: f64, points: usize) -> (usize, f64) {
    let at = coordinate.clamp(0.0, 1.0) * (points - 1) as f64;
    let interval = (at as usize).min(points - 2);
    (interval, at - interval as f64)
}

impl Grids {
    /// Grids; `None` unless there are at least two points in each dimension and the numbers fill
    /// the grids.
    pub(crate) fn new(numbers: Vec<f32>, parameters: usize, rows: usize, columns: usize) -> Option<Self> {
        let fits = rows >= 2 && columns >= 2 && parameters.checked_mul(rows)?.checked_mul(columns)? == numbers.len();
        // Not-a-number and negative numbers count as zero.
        let sound = |number: f32| if number.is_finite() { number.max(0.0) } else { 0.0 };
        fits.then(|| Grids { numbers: numbers.into_iter().map(sound).collect(), rows, columns })
    }

    fn number(&self, mix: &Mix, row: usize, column: usize) -> f64 {
        let at = |parameter: usize| f64::from(self.numbers[(parameter * self.rows + row) * self.columns + column]);
        mix.iter().filter(|(_, share)| *share > 0.0).map(|&(parameter, share)| share * at(parameter)).sum()
    }

    /// The value at (x, y).
    pub(crate) fn at(&self, mix: &Mix, x: f64, y: f64) -> f64 {
        let ((column, s), (row, t)) = (place(x, self.columns), place(y, self.rows));
        let along = |row: usize| (1.0 - s) * self.number(mix, row, column) + s * self.number(mix, row, column + 1);
        (1.0 - t) * along(row) + t * along(row + 1)
    }
}

/// Samples points of the unit square with the density of a grid, normalised for each parameter.
#[derive(Clone, Debug)]
pub(crate) struct Warp {
    density: Grids,
    /// Integral of the density along each row up to each column.
    along_rows: Vec<f32>,
    /// Integral of the density up to each row.
    up_to_row: Vec<f32>,
}

impl Warp {
    pub(crate) fn new(mut density: Grids) -> Self {
        let Grids { rows, columns, .. } = density;
        let parameters = density.numbers.len() / (rows * columns);
        let (width, height) = (1.0 / (columns - 1) as f64, 1.0 / (rows - 1) as f64);
        let (mut along_rows, mut up_to_row) = (Vec::new(), Vec::new());
        for grid in density.numbers.chunks_exact_mut(rows * columns) {
            // A grid of zeros becomes uniform.
            if grid.iter().all(|&number| number <= 0.0) {
                grid.fill(1.0);
            }
            let sums: Vec<Vec<f64>> = grid.chunks_exact(columns).map(|row| cumulative(row, width)).collect();
            let totals: Vec<f32> = sums.iter().map(|sums| sums[columns - 1] as f32).collect();
            let up = cumulative(&totals, height);
            let scale = 1.0 / up[rows - 1];
            grid.iter_mut().for_each(|number| *number = (f64::from(*number) * scale) as f32);
            along_rows.extend(sums.iter().flatten().map(|&sum| (sum * scale) as f32));
            up_to_row.extend(up.iter().map(|&sum| (sum * scale) as f32));
        }
        debug_assert_eq!(up_to_row.len(), parameters * rows);
        Warp { density, along_rows, up_to_row }
    }

    /// Integral along a row up to a column.
    fn along(&self, mix: &Mix, row: usize, column: usize) -> f64 {
        let Grids { rows, columns, .. } = self.density;
        mix.iter().map(|&(p, share)| share * f64::from(self.along_rows[(p * rows + row) * columns + column])).sum()
    }

    fn up_to(&self, mix: &Mix, row: usize) -> f64 {
        mix.iter().map(|&(p, share)| share * f64::from(self.up_to_row[p * self.density.rows + row])).sum()
    }

    /// Maps a uniform point of the unit square to a sample.
    pub(crate) fn sample(&self, mix: &Mix, u: (f64, f64)) -> (f64, f64) {
        let Grids { rows, columns, .. } = self.density;
        let target = u.1 * self.up_to(mix, rows - 1);
        let row = last_at_most(rows - 1, |row| self.up_to(mix, row) <= target);
        let (low, high) = (self.along(mix, row, columns - 1), self.along(mix, row + 1, columns - 1));
        let t = invert_trapezoid(low, high, (target - self.up_to(mix, row)) * (rows - 1) as f64);
        let blend = |column: usize| (1.0 - t) * self.along(mix, row, column) + t * self.along(mix, row + 1, column);
        let target = u.0 * blend(columns - 1);
        let column = last_at_most(columns - 1, |column| blend(column) <= target);
        let at = |column: usize| {
            (1.0 - t) * self.density.number(mix, row, column) + t * self.density.number(mix, row + 1, column)
        };
        let s = invert_trapezoid(at(column), at(column + 1), (target - blend(column)) * (columns - 1) as f64);
        ((column as f64 + s) / (columns - 1) as f64, (row as f64 + t) / (rows - 1) as f64)
    }

    /// Inverse of [`Warp::sample`]: the uniform point of (x, y), and the density there.
    pub(crate) fn invert(&self, mix: &Mix, x: f64, y: f64) -> ((f64, f64), f64) {
        let Grids { rows, columns, .. } = self.density;
        let ((column, s), (row, t)) = (place(x, columns), place(y, rows));
        let blend = |column: usize| (1.0 - t) * self.along(mix, row, column) + t * self.along(mix, row + 1, column);
        let at = |column: usize| {
            (1.0 - t) * self.density.number(mix, row, column) + t * self.density.number(mix, row + 1, column)
        };
        let (left, right) = (at(column), at(column + 1));
        let u0 = (blend(column) + trapezoid(left, right, s) / (columns - 1) as f64) / blend(columns - 1);
        let (low, high) = (self.along(mix, row, columns - 1), self.along(mix, row + 1, columns - 1));
        let u1 = (self.up_to(mix, row) + trapezoid(low, high, t) / (rows - 1) as f64) / self.up_to(mix, rows - 1);
        ((u0, u1), ((1.0 - s) * left + s * right) / self.up_to(mix, rows - 1))
    }
}

/// Cumulative integral of a function that is linear between points.
fn cumulative(numbers: &[f32], spacing: f64) -> Vec<f64> {
    let mut sum = 0.0;
    let steps = numbers.windows(2).map(|pair| 0.5 * spacing * (f64::from(pair[0]) + f64::from(pair[1])));
    std::iter::once(0.0)
        .chain(steps.map(|step| {
            sum += step;
            sum
        }))
        .collect()
}

/// The last of the first `count` indices for which a monotonic condition holds; 0 if there is none.
fn last_at_most(count: usize, holds: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (0, count);
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if holds(middle) { low = middle } else { high = middle }
    }
    low
}

/// `∫₀ˢ` of the line from `first` at 0 to `last` at 1.
fn trapezoid(first: f64, last: f64, s: f64) -> f64 {
    s * (first + 0.5 * s * (last - first))
}

/// Inverse of [`trapezoid`]: the s for an area.
fn invert_trapezoid(first: f64, last: f64, area: f64) -> f64 {
    let root = (first * first + 2.0 * (last - first) * area).max(0.0).sqrt();
    if first + root > 0.0 { (2.0 * area / (first + root)).clamp(0.0, 1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn warp() -> Warp {
        let (rows, columns) = (5, 7);
        let number = |k: usize| ((k * 37 % 11) as f32) * 0.3 + if k.is_multiple_of(5) { 0.0 } else { 0.2 };
        let numbers = (0..2 * rows * columns).map(number).collect();
        Warp::new(Grids::new(numbers, 2, rows, columns).unwrap())
    }

    const MIX: Mix = [(0, 0.3), (1, 0.7), (0, 0.0), (0, 0.0)];

    #[test]
    fn inverting_a_sample_gives_the_random_numbers_back() {
        let warp = warp();
        for k in 0..1000 {
            let u = (f64::from(k % 31) / 31.0, f64::from(k % 32) / 32.0);
            let (x, y) = warp.sample(&MIX, u);
            let (back, density) = warp.invert(&MIX, x, y);
            assert!((back.0 - u.0).abs() < 1e-5 && (back.1 - u.1).abs() < 1e-5, "{u:?} → {x}, {y} → {back:?}");
            assert!(density >= 0.0);
        }
    }

    #[test]
    fn the_density_integrates_to_one() {
        let warp = warp();
        let n = 600;
        let at = |k: i32| (f64::from(k) + 0.5) / f64::from(n);
        let sum: f64 = (0..n * n).map(|k| warp.invert(&MIX, at(k % n), at(k / n)).1).sum();
        assert!((sum / f64::from(n * n) - 1.0).abs() < 1e-4, "{sum}");
    }
}
