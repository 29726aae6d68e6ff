//! Sums over windows of a picture.

/// Summed-area table of pixels with several values each.
pub(crate) struct WindowSums<const N: usize> {
    /// Sums of all values left of and above each corner.
    corners: Vec<[f64; N]>,
    columns: usize,
}

impl<const N: usize> WindowSums<N> {
    pub(crate) fn new(values: impl ExactSizeIterator<Item = [f64; N]>, columns: usize) -> WindowSums<N> {
        let mut corners = vec![[0.0; N]; columns + 1];
        corners.reserve(values.len() + values.len() / columns.max(1));
        let mut of_row = [0.0; N];
        let mut column = 0;
        for value in values {
            if column == 0 {
                of_row = [0.0; N];
                corners.push(of_row);
            }
            let above = corners[corners.len() - columns - 1];
            of_row.iter_mut().zip(value).for_each(|(sum, value)| *sum += value);
            corners.push(std::array::from_fn(|index| above[index] + of_row[index]));
            column = if column + 1 == columns { 0 } else { column + 1 };
        }
        WindowSums { corners, columns }
    }

    /// Sums over the square of pixels within `reach` of a pixel, clipped to the picture, of values
    /// that are not negative.
    pub(crate) fn around(&self, pixel: usize, reach: usize) -> [f64; N] {
        self.signed_around(pixel, reach).map(|sum| sum.max(0.0))
    }

    /// The same of any values.
    pub(crate) fn signed_around(&self, pixel: usize, reach: usize) -> [f64; N] {
        let rows = self.corners.len() / (self.columns + 1) - 1;
        let near = |at: usize, count: usize| [at.saturating_sub(reach), (at + reach + 1).min(count)];
        let [left, right] = near(pixel % self.columns, self.columns);
        let [top, bottom] = near(pixel / self.columns, rows);
        let corner = |x: usize, y: usize| self.corners[y * (self.columns + 1) + x];
        let (first, last) = (corner(left, top), corner(right, bottom));
        let (beside, below) = (corner(right, top), corner(left, bottom));
        std::array::from_fn(|index| last[index] - below[index] - beside[index] + first[index])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn window_sums_are_clipped_to_the_picture() {
        let sums = WindowSums::new((0..12).map(|value| [1.0, f64::from(value)]), 4);
        assert_eq!(sums.around(0, 1), [4.0, 0.0 + 1.0 + 4.0 + 5.0]);
        assert_eq!(sums.around(5, 1), [9.0, [0, 1, 2, 4, 5, 6, 8, 9, 10].iter().sum::<i32>().into()]);
        assert_eq!(sums.around(11, 9), [12.0, 66.0]);
    }
}
