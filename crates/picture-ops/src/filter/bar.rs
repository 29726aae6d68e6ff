//! The input rows that the filter can see.

/// A ring of rows. A row is found by its number as long as no later one has taken its place.
#[derive(Debug)]
pub(super) struct Bar {
    rows: Vec<Vec<f32>>,
    size: usize,
    length: usize,
}

impl Bar {
    /// Holds the rows up to `reach` away from a middle one, `length` values each. Memory is taken with the rows.
    pub(super) fn new(reach: usize, length: usize) -> Bar {
        Bar { rows: Vec::new(), size: reach.saturating_mul(2).saturating_add(1), length }
    }

    /// The place of a new row, whose number follows that of the last one.
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
