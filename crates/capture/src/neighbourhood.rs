//! Neighbours in a grid.

use glam::DVec2;

/// The indices of a cell of a grid and of its up to eight neighbours, in ascending order.
pub(crate) fn around(cell: usize, [columns, rows]: [usize; 2]) -> impl Iterator<Item = usize> {
    let near = |at: usize, count: usize| at.saturating_sub(1)..(at + 2).min(count);
    let (across, down) = (near(cell % columns, columns), near(cell / columns, rows));
    down.flat_map(move |row| across.clone().map(move |column| row * columns + column))
}

/// Means over the square of pixels within `reach` of each pixel, clipped to the picture.
pub(crate) fn window_means(values: &[f64], columns: usize, reach: usize) -> Vec<f64> {
    let rows = values.len() / columns.max(1);
    let along = |count: usize, at: &dyn Fn(usize) -> f64| -> Vec<f64> {
        let window = |index: usize| index.saturating_sub(reach)..(index + reach + 1).min(count);
        (0..count).map(|index| window(index).map(at).sum::<f64>() / window(index).len() as f64).collect()
    };
    let in_rows: Vec<f64> =
        values.chunks(columns.max(1)).flat_map(|row| along(row.len(), &|column| row[column])).collect();
    let mut means = vec![0.0; values.len()];
    for column in 0..columns {
        let of_column = along(rows, &|row| in_rows[row * columns + column]);
        of_column.into_iter().enumerate().for_each(|(row, mean)| means[row * columns + column] = mean);
    }
    means
}

/// The difference between neighbouring pixels along columns and rows.
pub(crate) fn slope(values: &[f64], columns: usize, pixel: usize) -> DVec2 {
    let along = |at: usize, count: usize, step: usize| {
        let [before, after] = [at.min(1), (count - 1 - at).min(1)];
        let difference = values[pixel + after * step] - values[pixel - before * step];
        difference / (before + after).max(1) as f64
    };
    DVec2::new(along(pixel % columns, columns, 1), along(pixel / columns, values.len() / columns, columns))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_lie_in_the_grid() {
        let found = |cell: usize| around(cell, [4, 3]).collect::<Vec<usize>>();
        assert_eq!(found(5), [0, 1, 2, 4, 5, 6, 8, 9, 10]);
        assert_eq!(found(3), [2, 3, 6, 7]);
        assert_eq!(found(8), [4, 5, 8, 9]);
        assert!(around(0, [1, 1]).eq([0]));
    }

    #[test]
    fn slopes_are_exact_for_linear_functions_up_to_the_border() {
        let values: Vec<f64> = (0..12).map(|pixel| 2.0 * f64::from(pixel % 4) - 3.0 * f64::from(pixel / 4)).collect();
        assert!((0..12).all(|pixel| slope(&values, 4, pixel) == DVec2::new(2.0, -3.0)));
    }
}
