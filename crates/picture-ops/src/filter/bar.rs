//! The input rows within the filter's support.

/// A ring buffer of rows. A row is available until a later one replaces it.
#[derive(Debug)]
pub(super) struct Bar {
    rows: Vec<Vec<f32>>,
    size: usize,
    length: usize,
}

impl Bar {
    /// A buffer for the rows up to `reach` away from a central one, `length` values each. Memory is
    /// allocated row by row.
    pub(super) fn new(reach: usize, length: usize) -> Bar {
        Bar { rows: Vec::new(), size: reach.saturating_mul(2).saturating_add(1), length }
    }

    /// The storage of a new row, which follows the last one.
    pub(super) fn next(&mut self, row: usize) -> &mut [f32] {
        let index = row % self.size;
        if index == self.rows.len() {
            self.rows.push(vec![0.0; self.length]);
        }
        &mut self.rows[index]
    }

    /// A row that was read.
    pub(super) fn row(&self, row: usize) -> &[f32] {
        &self.rows[row % self.size]
    }
}
