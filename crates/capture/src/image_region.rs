//! A part of a film that may show images of lights which are not known one by one, as a density of
//! rays over it.
//!
//! The density is constant over the squares of quadtrees, one for each pixel. Any point of the region
//! has a density, so no light is lost where the search ([`region_search`](crate::region_search)) saw
//! none.

use glam::{DVec2, UVec2};
use rustc_hash::FxHashMap;

/// Squares are divided this many times at the most.
pub(crate) const MAX_LEVEL: u32 = 9;

/// Fraction of the rays that are even over the region.
const EVEN_FRACTION: f64 = 0.1;

/// A density of rays over a part of a film.
#[derive(Debug)]
pub(crate) struct ImageRegion {
    /// Those of whole pixels come first.
    squares: Vec<RegionSquare>,
    /// Index of each of its pixels on the film, in the order of their squares.
    pixels: Vec<usize>,
    /// By pixel of the film, its square.
    by_pixel: FxHashMap<usize, usize>,
    /// Of the film.
    columns: usize,
    /// The variance that the light of a ray may have, relative to the square of what is expected of its
    /// pixel.
    variance: f64,
}

/// A square of the film.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RegionSquare {
    /// The corner on the left and above, in sides of the smallest squares.
    pub(crate) corner: UVec2,
    /// Number of divisions.
    pub(crate) level: u32,
    /// Estimated fraction of its points that show a light.
    pub(crate) lit: f64,
    /// Index of the first of its four quarters, row by row.
    pub(crate) quarters: Option<usize>,
    /// Root mean square of the light over its area, by the estimated fractions.
    expected: f64,
    /// The probability of its rays.
    probability: f64,
}

impl RegionSquare {
    pub(crate) fn new(corner: UVec2, level: u32, lit: f64) -> RegionSquare {
        RegionSquare { corner, level, lit, quarters: None, expected: 0.0, probability: 0.0 }
    }

    /// Side of the squares of a level, pixels.
    pub(crate) fn side(level: u32) -> f64 {
        f64::from(1 << level).recip()
    }

    pub(crate) fn area(&self) -> f64 {
        RegionSquare::side(self.level).powi(2)
    }

    /// The root mean square of a light of radiance 1 in the lit fraction, times the area. Rays in
    /// proportion to it have the least variance.
    pub(crate) fn rms_light(&self) -> f64 {
        self.area() * self.lit.sqrt()
    }
}

impl ImageRegion {
    /// From its pixels on a film with so many columns, and their squares, those of whole pixels
    /// first. `None` where nothing is lit. `variance` is that of [`ImageRegion::variance`].
    pub(crate) fn new(
        squares: Vec<RegionSquare>,
        pixels: Vec<usize>,
        columns: usize,
        variance: f64,
    ) -> Option<ImageRegion> {
        let leaves = squares.iter().filter(|square| square.quarters.is_none());
        let total: f64 = leaves.map(RegionSquare::rms_light).sum();
        let even = EVEN_FRACTION / pixels.len() as f64;
        let by_pixel = pixels.iter().enumerate().map(|(square, pixel)| (*pixel, square)).collect();
        let mut region = ImageRegion { squares, pixels, by_pixel, columns, variance };
        // Quarters follow their squares.
        for index in (0..region.squares.len()).rev() {
            let square = region.squares[index];
            let quarters = square.quarters.map(|first| &region.squares[first..first + 4]);
            let (expected, probability) = match quarters {
                None => {
                    let expected = square.rms_light();
                    (expected, (1.0 - EVEN_FRACTION) * expected / total + even * square.area())
                }
                Some(quarters) => (
                    quarters.iter().map(|quarter| quarter.expected).sum(),
                    quarters.iter().map(|quarter| quarter.probability).sum(),
                ),
            };
            region.squares[index] = RegionSquare { expected, probability, ..square };
        }
        (total > 0.0).then_some(region)
    }

    /// The variance that the light of a ray may have, relative to the square of what is expected of its
    /// pixel.
    pub(crate) fn variance(&self) -> f64 {
        self.variance
    }

    /// Its pixels on the film, each with the rms of a light of radiance 1 over the squares in it.
    pub(crate) fn pixels(&self) -> impl Iterator<Item = (usize, f64)> {
        self.pixels.iter().zip(&self.squares).map(|(pixel, square)| (*pixel, square.expected))
    }

    /// The density of rays at a point of a pixel of the film, per area of a pixel. 0 outside of the
    /// region.
    pub(crate) fn density(&self, pixel: usize, point: DVec2) -> f64 {
        let Some(root) = self.by_pixel.get(&pixel) else { return 0.0 };
        let mut square = &self.squares[*root];
        let mut at = point - self.corner_of(pixel);
        while let Some(first) = square.quarters {
            at *= 2.0;
            let [x, y] = [at.x, at.y].map(|at| usize::from(at >= 1.0));
            at -= DVec2::new(x as f64, y as f64);
            square = &self.squares[first + 2 * y + x];
        }
        square.probability / square.area()
    }

    /// A point of the film in one of the region's pixels for a point of the unit square, and its density
    /// relative to the probability of the pixel.
    pub(crate) fn sample(&self, index: usize, [mut x, mut y]: [f64; 2]) -> (DVec2, f64) {
        let root = &self.squares[index];
        let mut square = root;
        let mut corner = self.corner_of(self.pixels[index]);
        while let Some(first) = square.quarters {
            let probability = |quarter: usize| self.squares[first + quarter].probability;
            let row = 2 * choose_half(&mut y, (probability(0) + probability(1)) / square.probability);
            let column = choose_half(&mut x, probability(row) / (probability(row) + probability(row + 1)));
            square = &self.squares[first + row + column];
            corner += RegionSquare::side(square.level) * DVec2::new(column as f64, 0.5 * row as f64);
        }
        let density = square.probability / square.area() / root.probability;
        (corner + RegionSquare::side(square.level) * DVec2::new(x, y), density)
    }

    fn corner_of(&self, pixel: usize) -> DVec2 {
        DVec2::new((pixel % self.columns) as f64, (pixel / self.columns) as f64)
    }
}

/// Chooses one of two halves, with a probability of the first, and stretches the number over it.
fn choose_half(u: &mut f64, first: f64) -> usize {
    let (half, stretched) = if *u < first { (0, *u / first) } else { (1, (*u - first) / (1.0 - first)) };
    *u = stretched.clamp(0.0, 1.0 - f64::EPSILON);
    half
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two pixels of a film of three columns, one of them divided twice.
    fn region() -> ImageRegion {
        let unit = 1 << MAX_LEVEL;
        let square = |x: u32, y: u32, level: u32, lit: f64| RegionSquare::new(UVec2::new(x, y), level, lit);
        let mut squares = vec![square(unit, 0, 0, 0.0), square(0, unit, 0, 0.0)];
        squares[0].quarters = Some(2);
        let quarters = |x: u32, y: u32, level: u32, lit: [f64; 4]| {
            let side = unit >> level;
            [[0, 0], [1, 0], [0, 1], [1, 1]]
                .iter()
                .zip(lit)
                .map(move |([column, row], lit)| square(x + side * column, y + side * row, level, lit))
                .collect::<Vec<_>>()
        };
        squares.extend(quarters(unit, 0, 1, [0.0, 0.2, 0.0, 0.01]));
        squares[3].quarters = Some(6);
        squares.extend(quarters(unit + unit / 2, 0, 2, [0.9, 0.0, 0.3, 0.05]));
        ImageRegion::new(squares, vec![1, 3], 3, 0.0).expect("a part is lit")
    }

    /// Evenly distributed points of the unit square.
    fn points(count: u32) -> impl Iterator<Item = [f64; 2]> {
        (0..count).map(move |index| {
            [(f64::from(index) + 0.5) / f64::from(count), (f64::from(index) * 0.618_033_988_749_894_9).fract()]
        })
    }

    #[test]
    fn points_have_the_density_that_is_claimed() {
        let region = region();
        for (index, pixel) in [1, 3].into_iter().enumerate() {
            let probability = region.squares[index].probability;
            let (count, mut area) = (20_000, 0.0);
            for u in points(count) {
                let (point, density) = region.sample(index, u);
                assert!((density * probability / region.density(pixel, point) - 1.0).abs() < 1e-12, "{point}");
                area += (point.y - region.corner_of(pixel).y) / density / f64::from(count);
            }
            // ∫ y over a pixel.
            assert!((area - 0.5).abs() < 0.01, "{area}");
        }
    }

    #[test]
    fn the_density_is_a_probability_over_the_region() {
        let region = region();
        let sum: f64 = region.squares[..2].iter().map(|square| square.probability).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
        // The smallest squares are quarters of a pixel.
        let mean = |pixel: usize| {
            let at = |place: u32| DVec2::new(f64::from(place % 4) + 0.5, f64::from(place / 4) + 0.5) / 4.0;
            (0..16).map(|place| region.density(pixel, region.corner_of(pixel) + at(place))).sum::<f64>() / 16.0
        };
        assert!((mean(1) + mean(3) - 1.0).abs() < 1e-12);
        assert!(mean(3) > 0.04 && region.density(2, DVec2::new(2.5, 0.5)) == 0.0);
    }

    #[test]
    fn a_region_without_light_is_none() {
        assert!(ImageRegion::new(vec![RegionSquare::new(UVec2::ZERO, 0, 0.0)], vec![0], 1, 0.0).is_none());
    }
}
