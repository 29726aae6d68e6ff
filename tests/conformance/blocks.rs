//! Compares pictures by their means and by the distribution of differences over blocks of pixels.

use radsight_picture::Image;
use std::fmt;

/// A block agrees if it is within this relative difference of the reference.
const TOLERANCE: f64 = 0.05;

/// Or within this many standard errors of the reference's noise.
const STANDARD_ERRORS: f64 = 3.0;

/// Blocks darker than this, relative to the mean, are compared with it instead.
const DARK: f64 = 0.01;

/// The known noise of a reference.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Noise<'a> {
    /// Unknown: the residual of a plane fitted to each block is used.
    Unknown,
    /// The standard error of each value, independent of its neighbours'.
    OfValues(&'a Image<f32>),
    /// Other pictures from the same command.
    Repeats(&'a [Image<f32>]),
}

impl<'a> Noise<'a> {
    /// From these other pictures, if there are any.
    pub(crate) fn of(repeats: &'a [Image<f32>]) -> Self {
        if repeats.is_empty() { Noise::Unknown } else { Noise::Repeats(repeats) }
    }

    /// Relative standard deviation of the means of pictures from the same command: the noise of
    /// blocks does not include their common error.
    fn of_means(self, expected: &Image<f32>) -> f64 {
        let Noise::Repeats(repeats) = self else { return 0.0 };
        let means: Vec<f64> = repeats.iter().chain([expected]).map(mean).collect();
        let mean = means.iter().sum::<f64>() / means.len() as f64;
        let squares: f64 = means.iter().map(|value| (value - mean).powi(2)).sum();
        (squares / repeats.len().max(1) as f64).sqrt() / mean.max(f64::MIN_POSITIVE)
    }
}

/// A comparison.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Agreement {
    /// Ratio of the means, minus 1.
    pub(crate) mean: f64,
    /// Relative standard error of the reference's mean.
    pub(crate) mean_error: f64,
    /// Share of the blocks that agree within 5 %, 0 to 1.
    pub(crate) within: f64,
    /// Share of the blocks that agree within 5 % or the reference's noise, 0 to 1.
    pub(crate) blocks: f64,
    /// The 95th percentile of the relative differences of blocks.
    pub(crate) percentile_95: f64,
}

impl Agreement {
    /// Compares two pictures of the same size in blocks of `side` pixels.
    ///
    /// # Panics
    /// If the sizes differ.
    pub(crate) fn new(actual: &Image<f32>, expected: &Image<f32>, noise: Noise<'_>, side: usize) -> Agreement {
        let expected_mean = mean(expected);
        let mut differences = differences(actual, expected, noise, side);
        differences.sort_by(|one, two| one.share.total_cmp(&two.share));
        let count = differences.len();
        let share_of = |is_meant: fn(&Difference) -> bool| {
            differences.iter().filter(|difference| is_meant(difference)).count() as f64 / count as f64
        };
        let variance: f64 = differences.iter().map(|of| (of.error * of.block.count()).powi(2)).sum();
        let pixels = (expected.width() * expected.height()) as f64;
        Agreement {
            mean: if expected_mean > 0.0 { mean(actual) / expected_mean - 1.0 } else { mean(actual) },
            mean_error: (variance.sqrt() / pixels / expected_mean.max(f64::MIN_POSITIVE)).max(noise.of_means(expected)),
            within: share_of(|difference| difference.share <= TOLERANCE),
            blocks: share_of(|difference| difference.agrees),
            percentile_95: differences[(0.95 * (count - 1) as f64).ceil() as usize].share,
        }
    }

    /// The acceptance criterion: the mean within 1 % (or the reference's noise), and 95 % of the
    /// blocks.
    pub(crate) fn is_good(&self) -> bool {
        self.mean.abs() <= f64::max(0.01, STANDARD_ERRORS * self.mean_error) && self.blocks >= 0.95
    }
}

impl fmt::Display for Agreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "mean {:+7.2} % (±{:.2}), blocks {:5.1} %, 95th percentile {:6.2} %",
            100.0 * self.mean,
            100.0 * self.mean_error,
            100.0 * self.blocks,
            100.0 * self.percentile_95
        )
    }
}

/// The difference between a block of two pictures.
struct Difference {
    block: Block,
    /// Relative to the expected value.
    share: f64,
    /// Standard error of the expected value.
    error: f64,
    agrees: bool,
}

fn differences(actual: &Image<f32>, expected: &Image<f32>, noise: Noise<'_>, side: usize) -> Vec<Difference> {
    let size = (expected.width(), expected.height());
    assert_eq!((actual.width(), actual.height()), size, "the size of the picture");
    let floor = DARK * mean(expected);
    let difference = |block: Block| {
        let difference = (block.mean(actual) - block.mean(expected)).abs();
        let scale = block.mean(expected).max(floor);
        let error = match noise {
            Noise::Unknown => block.residual_error(expected),
            Noise::OfValues(errors) => block.combined_error(errors),
            Noise::Repeats(repeats) => scale * block.spread_around(expected, repeats, side),
        };
        let share = if difference == 0.0 { 0.0 } else { difference / scale };
        Difference { block, share, error, agrees: share <= TOLERANCE || difference <= STANDARD_ERRORS * error }
    };
    Block::all(size, side).map(difference).collect()
}

/// The blocks of `side` pixels in which two pictures of the same size do not agree.
///
/// # Panics
/// If the sizes differ.
pub(crate) fn outside(actual: &Image<f32>, expected: &Image<f32>, noise: Noise<'_>, side: usize) -> Vec<Block> {
    let differences = differences(actual, expected, noise, side);
    differences.into_iter().filter(|difference| !difference.agrees).map(|difference| difference.block).collect()
}

/// Whether a value is within the tolerance of a reference with a standard error.
pub(crate) fn is_near(actual: f64, expected: f64, error: f64) -> bool {
    (actual - expected).abs() <= f64::max(TOLERANCE * expected, STANDARD_ERRORS * error)
}

fn mean(image: &Image<f32>) -> f64 {
    image.data().iter().map(|value| f64::from(*value)).sum::<f64>() / image.data().len() as f64
}

/// Pixels from `left`, `top` to before `right`, `bottom`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Block {
    pub(crate) left: usize,
    pub(crate) top: usize,
    right: usize,
    bottom: usize,
}

impl Block {
    /// The block of `side` pixels at a position, clipped at the picture's edges.
    pub(crate) fn new((left, top): (usize, usize), size: (usize, usize), side: usize) -> Block {
        Block { left, top, right: (left + side).min(size.0), bottom: (top + side).min(size.1) }
    }

    pub(crate) fn all(size: (usize, usize), side: usize) -> impl Iterator<Item = Block> {
        let row = move |top| (0..size.0).step_by(side).map(move |left| Block::new((left, top), size, side));
        (0..size.1).step_by(side).flat_map(row)
    }

    /// Relative standard deviation of the block's mean among pictures from the same command. The
    /// pictures are few, so the variances of the neighbouring blocks are included.
    fn spread_around(self, expected: &Image<f32>, repeats: &[Image<f32>], side: usize) -> f64 {
        let size = (expected.width(), expected.height());
        let floor = (DARK * mean(expected)).max(f64::MIN_POSITIVE);
        let near = |at: usize, end: usize| (at.saturating_sub(side)..end.min(at + side + 1)).step_by(side);
        let (mut sum, mut count) = (0.0, 0);
        for corner in near(self.top, size.1).flat_map(|top| near(self.left, size.0).map(move |left| (left, top))) {
            let block = Block::new(corner, size, side);
            let means: Vec<f64> = repeats.iter().chain([expected]).map(|image| block.mean(image)).collect();
            let mean = means.iter().sum::<f64>() / means.len() as f64;
            sum += means.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / mean.max(floor).powi(2);
            count += repeats.len();
        }
        (sum / count as f64).sqrt()
    }

    fn count(&self) -> f64 {
        ((self.right - self.left) * (self.bottom - self.top)) as f64
    }

    /// The mean over the bands of each pixel, with its position.
    fn pixels<'a>(&'a self, image: &'a Image<f32>) -> impl Iterator<Item = (f64, f64, f64)> + 'a {
        (self.top..self.bottom).flat_map(move |y| {
            (self.left..self.right).map(move |x| {
                let pixel = image.pixel(x, y);
                let sum: f64 = pixel.iter().map(|value| f64::from(*value)).sum();
                (x as f64, y as f64, sum / pixel.len() as f64)
            })
        })
    }

    pub(crate) fn mean(&self, image: &Image<f32>) -> f64 {
        self.pixels(image).map(|(_, _, value)| value).sum::<f64>() / self.count()
    }

    /// Standard error of the block's mean from those of its pixels.
    fn combined_error(&self, noise: &Image<f32>) -> f64 {
        self.pixels(noise).map(|(_, _, error)| error * error).sum::<f64>().sqrt() / self.count()
    }

    /// Standard error of the block's mean, if the residual of the plane were pure noise.
    fn residual_error(&self, image: &Image<f32>) -> f64 {
        let count = self.count();
        if count < 4.0 {
            return 0.0;
        }
        let center_x = 0.5 * (self.left + self.right - 1) as f64;
        let center_y = 0.5 * (self.top + self.bottom - 1) as f64;
        let mean = self.mean(image);
        let [mut xx, mut yy, mut xv, mut yv] = [0.0; 4];
        for (x, y, value) in self.pixels(image) {
            let (x, y) = (x - center_x, y - center_y);
            xx += x * x;
            yy += y * y;
            xv += x * value;
            yv += y * value;
        }
        let slope = |product: f64, square: f64| if square > 0.0 { product / square } else { 0.0 };
        let (slope_x, slope_y) = (slope(xv, xx), slope(yv, yy));
        let left_over: f64 = self
            .pixels(image)
            .map(|(x, y, value)| (value - mean - slope_x * (x - center_x) - slope_y * (y - center_y)).powi(2))
            .sum();
        (left_over / (count - 3.0) / count).sqrt()
    }
}
