//! Neighbours in a grid.

/// The indices of a cell of a grid and of its up to eight neighbours, in ascending order.
pub(crate) fn around(cell: usize, [columns, rows]: [usize; 2]) -> impl Iterator<Item = usize> {
    let near = |at: usize, count: usize| at.saturating_sub(1)..(at + 2).min(count);
    let (across, down) = (near(cell % columns, columns), near(cell / columns, rows));
    down.flat_map(move |row| across.clone().map(move |column| row * columns + column))
}

#[cfg(test)]
mod tests {
    use super::around;

    #[test]
    fn neighbours_lie_in_the_grid() {
        let found = |cell: usize| around(cell, [4, 3]).collect::<Vec<usize>>();
        assert_eq!(found(5), [0, 1, 2, 4, 5, 6, 8, 9, 10]);
        assert_eq!(found(3), [2, 3, 6, 7]);
        assert_eq!(found(8), [4, 5, 8, 9]);
        assert!(around(0, [1, 1]).eq([0]));
    }
}
