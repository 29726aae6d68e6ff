//! The inner loop of products.

use crate::Matrix;

/// Columns of a product that are summed together, so that the sums stay in the fastest cache.
const TILE_COLUMNS: usize = 128;

/// Values that are summed by one step of vector instructions: whole elements of 1, 2, 3, 4, 6 or 12
/// components.
const LANES: usize = 12;

/// Memory for the sums of some rows and columns of a product.
#[derive(Default)]
pub(crate) struct Tile {
    /// Sums by rows.
    sums: Vec<f64>,
    /// Values of a row on the right, converted once for all rows on the left.
    values: Vec<f64>,
}

impl Tile {
    /// Computes the rows of a product from `first_row` on that `product` holds.
    pub(crate) fn multiply(&mut self, left: &Matrix, right: &Matrix, first_row: usize, product: &mut [f32]) {
        let length = right.columns() * right.components();
        let tile = TILE_COLUMNS * right.components();
        for start in (0..length).step_by(tile) {
            let columns = start..(start + tile).min(length);
            self.add(left, right, first_row..first_row + product.len() / length, columns.clone());
            for (row, sums) in product.chunks_exact_mut(length).zip(self.sums.chunks_exact(columns.len())) {
                row[columns.clone()].iter_mut().zip(sums).for_each(|(value, sum)| *value = *sum as f32);
            }
        }
    }

    /// Sums the values of some rows and columns. Zeros on the left are skipped: most directions
    /// see no window.
    fn add(&mut self, left: &Matrix, right: &Matrix, rows: std::ops::Range<usize>, columns: std::ops::Range<usize>) {
        let components = left.components();
        self.sums.clear();
        self.sums.resize(rows.len() * columns.len(), 0.0);
        for middle in 0..left.columns() {
            let factors = |row: usize| &left.row(row)[middle * components..][..components];
            let is_dark = |row: usize| factors(row).iter().all(|factor| *factor == 0.0);
            if rows.clone().all(is_dark) {
                continue;
            }
            self.values.clear();
            self.values.extend(right.row(middle)[columns.clone()].iter().map(|value| f64::from(*value)));
            for (row, sums) in rows.clone().zip(self.sums.chunks_exact_mut(columns.len())) {
                if !is_dark(row) {
                    add_products(sums, &self.values, factors(row));
                }
            }
        }
    }
}

/// Adds values times the factors of their components.
fn add_products(sums: &mut [f64], values: &[f64], factors: &[f32]) {
    if !LANES.is_multiple_of(factors.len()) {
        for (sums, values) in sums.chunks_exact_mut(factors.len()).zip(values.chunks_exact(factors.len())) {
            for ((sum, value), factor) in sums.iter_mut().zip(values).zip(factors) {
                *sum += f64::from(*factor) * value;
            }
        }
        return;
    }
    let factors: [f64; LANES] = std::array::from_fn(|lane| f64::from(factors[lane % factors.len()]));
    let (sums, sums_left) = sums.as_chunks_mut::<LANES>();
    let (values, values_left) = values.as_chunks::<LANES>();
    for (sums, values) in sums.iter_mut().zip(values) {
        for lane in 0..LANES {
            sums[lane] += factors[lane] * values[lane];
        }
    }
    for ((sum, value), factor) in sums_left.iter_mut().zip(values_left).zip(&factors) {
        *sum += factor * value;
    }
}
