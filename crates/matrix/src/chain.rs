//! Products of several matrices.

use crate::{Matrix, MatrixError};

/// Multiplies a chain of matrices in the order with the fewest multiplications: Cormen et al.,
/// *Introduction to Algorithms*, "Matrix-chain multiplication". Three sensors times a year of skies
/// are cheap from the left, a picture times one sky is cheap from the right.
///
/// # Errors
/// The index of the first matrix that does not match the one before it, and the error of their
/// product.
///
/// # Panics
/// If there is no matrix.
pub fn product_of_chain(chain: Vec<Matrix>) -> Result<Matrix, (usize, MatrixError)> {
    for (index, pair) in chain.windows(2).enumerate() {
        pair[0].check_product(&pair[1]).map_err(|error| (index + 1, error))?;
    }
    let sizes: Vec<usize> = chain.iter().map(Matrix::rows).chain(chain.last().map(Matrix::columns)).collect();
    let order = Order::of_sizes(&sizes);
    let mut left_to_multiply: Vec<Option<Matrix>> = chain.into_iter().map(Some).collect();
    order.multiply(&mut left_to_multiply, 0, sizes.len() - 2)
}

/// For each part of a chain, the matrix before which its last product divides it.
struct Order {
    last_products: Vec<Vec<usize>>,
}

impl Order {
    /// The cheapest order, where matrix `i` has `sizes[i]` rows and `sizes[i + 1]` columns.
    fn of_sizes(sizes: &[usize]) -> Order {
        let count = sizes.len() - 1;
        let mut costs = vec![vec![0.0; count]; count];
        let mut last_products = vec![vec![0; count]; count];
        for length in 2..=count {
            for first in 0..=count - length {
                let last = first + length - 1;
                let cost = |middle: usize| {
                    let product = [sizes[first], sizes[middle], sizes[last + 1]].map(|size| size as f64);
                    costs[first][middle - 1] + costs[middle][last] + product.iter().product::<f64>()
                };
                let best = (first + 1..=last).map(|middle| (cost(middle), middle));
                let Some((cost, middle)) = best.min_by(|one, other| one.0.total_cmp(&other.0)) else { continue };
                costs[first][last] = cost;
                last_products[first][last] = middle;
            }
        }
        Order { last_products }
    }

    /// The product of the matrices from `first` to `last`, which are taken out of the chain.
    fn multiply(
        &self,
        chain: &mut [Option<Matrix>],
        first: usize,
        last: usize,
    ) -> Result<Matrix, (usize, MatrixError)> {
        if first == last {
            return Ok(chain[first].take().expect("each matrix is a factor once"));
        }
        let middle = self.last_products[first][last];
        let left = self.multiply(chain, first, middle - 1)?;
        let right = self.multiply(chain, middle, last)?;
        left.times(&right).map_err(|error| (middle, error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cheapest_order_is_that_of_the_textbook() {
        // Cormen et al., figure 15.5: ((A1 (A2 A3)) ((A4 A5) A6)), 15,125 multiplications.
        let order = Order::of_sizes(&[30, 35, 15, 5, 10, 20, 25]).last_products;
        assert_eq!([order[0][5], order[0][2], order[3][5]], [3, 1, 5]);
    }

    #[test]
    fn few_sensors_are_multiplied_from_the_left_and_one_sky_from_the_right() {
        assert_eq!(Order::of_sizes(&[6, 145, 145, 146, 8760]).last_products[0][3], 3);
        assert_eq!(Order::of_sizes(&[10_000, 145, 145, 146, 1]).last_products[0][3], 1);
    }

    #[test]
    fn a_chain_is_the_product_from_the_left() {
        let matrix = |size: [usize; 2], start: usize| {
            let values = (start..start + 3 * size[0] * size[1]).map(|value| (value % 7) as f32).collect();
            Matrix::new(size, 3, values).unwrap()
        };
        let chain = [[2, 3], [3, 4], [4, 1], [1, 5]].iter().enumerate().map(|(at, size)| matrix(*size, at));
        let chain: Vec<Matrix> = chain.collect();
        let expected = chain[1..].iter().fold(chain[0].clone(), |left, right| left.times(right).unwrap());
        assert_eq!(product_of_chain(chain.clone()).unwrap(), expected);
        assert_eq!(product_of_chain(chain[..1].to_vec()).unwrap(), chain[0]);
        let wrong = vec![chain[0].clone(), chain[1].clone(), chain[1].clone(), chain[0].clone()];
        assert!(matches!(product_of_chain(wrong), Err((2, MatrixError::Product { .. }))));
    }
}
