//! The truth of a picture: the mean of pictures by real Radiance without interpolation, stored on
//! disk in two halves.

use super::calls::Call;
use super::nearness::near;
use super::rpict;
use crate::error::BenchError;
use crate::race::{Halves, read_picture};
use crate::radiance::Radiance;
use radsight_picture::Image;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Nothing interpolated, estimated or cut off; each pixel sampled anywhere, and lights as well.
/// Random numbers start from the second. What light is computed stays as it was asked for: `-ab`,
/// `-av`, and `-st`, below which no program samples reflections.
const UNBIASED: &str = "-u+ -aa 0 -as 0 -ps 1 -pj 1 -pt 0 -dt 0 -dc 1 -dj 1 -lr -16 -lw 1e-6 -pa 0 -t 0";

/// Rays of a hemisphere and of a rough reflection. Many pixels with few rays are better than few
/// with many.
const RAYS: &str = "-ad 32 -ss 1";

/// Pixels along each side of one that is averaged: doubled as long as a picture takes less than
/// [`SHORT`] s.
const MAX_SIDE: usize = 8;
const SHORT: f64 = 2.0;

/// Runs that start in the same second have the same random numbers.
const SECOND: Duration = Duration::from_millis(1010);

/// When a truth is sufficient.
#[derive(Clone, Copy, Debug)]
pub(super) struct Criterion {
    /// Rms of its own error in blocks.
    pub(super) noise: f64,
    /// Processor time, seconds.
    pub(super) seconds: f64,
}

/// A mean of independent pictures.
#[derive(Debug)]
pub(super) struct Truth {
    pub(super) image: Image<f32>,
    /// Rms of its own error in blocks.
    pub(super) noise: f64,
}

impl Truth {
    /// Reads the stored truth and continues from it, at `path` without a suffix. Pictures have the
    /// size of `example`.
    pub(super) fn make(
        call: &Call,
        example: &Image<f32>,
        radiance: &Radiance,
        criterion: Criterion,
        path: &Path,
    ) -> Result<Truth, BenchError> {
        let mut halves = Halves::read(path.to_owned());
        let (mut spent, mut side) = (0.0, 1);
        while halves.pictures < 2 || spent < criterion.seconds && noise(&halves) > criterion.noise {
            let start = Instant::now();
            let output = path.with_extension("part.hdr");
            let words = words(&call.words, [side * example.width(), side * example.height()]);
            let took = rpict(radiance.command("rpict").args(words), call, radiance, &output)?;
            halves.add(&shrunk(&read_picture(&output)?, side)?, (side * side) as u32);
            spent += took.processor;
            if took.processor < SHORT && side < MAX_SIDE && halves.pictures.is_multiple_of(2) {
                side *= 2;
            }
            sleep(SECOND.saturating_sub(start.elapsed()));
        }
        halves.write()?;
        Ok(Truth { image: halves.mean()?, noise: noise(&halves) })
    }
}

/// The path of the truth of a call, which changes with its words.
pub(super) fn path(folder: &Path, index: usize, call: &Call) -> PathBuf {
    let words = words(&call.words, [0, 0]);
    // The octree's path is not a setting.
    let words = words.split_last().map_or(&[][..], |(_, options)| options).join(" ");
    let key = words
        .bytes()
        .fold(0xcbf2_9ce4_8422_2325_u64, |key, byte| (key ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3));
    folder.join(format!("{index}-truth-{key:016x}"))
}

/// Half of the halves' difference; infinite before there are two.
fn noise(halves: &Halves) -> f64 {
    let [Some(first), Some(second)] = halves.means() else { return f64::INFINITY };
    0.5 * near(first, second).error
}

/// The words of an unbiased picture of a size.
fn words(words: &[String], [columns, rows]: [usize; 2]) -> Vec<String> {
    let Some((octree, options)) = words.split_last() else { return Vec::new() };
    let size = ["-x".to_owned(), columns.to_string(), "-y".to_owned(), rows.to_string()];
    let further = UNBIASED.split(' ').chain(RAYS.split(' ')).map(str::to_owned);
    options.iter().cloned().chain(further).chain(size).chain([octree.clone()]).collect()
}

/// The means of squares of pixels.
fn shrunk(image: &Image<f32>, side: usize) -> Result<Image<f32>, BenchError> {
    let (columns, rows, components) = (image.width() / side, image.height() / side, image.components());
    let mean = |x: usize, y: usize, component: usize| {
        let pixel = |at: usize| image.pixel(x * side + at % side, y * side + at / side)[component];
        ((0..side * side).map(|at| f64::from(pixel(at))).sum::<f64>() / (side * side) as f64) as f32
    };
    let values = (0..columns * rows * components)
        .map(|at| mean(at / components % columns, at / components / columns, at % components))
        .collect();
    Image::new(columns, rows, components, values)
        .map_err(|error| BenchError::Read { path: PathBuf::from("rpict"), reason: error.to_string() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_truth_keeps_the_octree_last() {
        let call = ["-ab", "1", "a.oct"].map(str::to_owned);
        let truth = words(&call, [16, 8]);
        assert_eq!((truth.first().unwrap().as_str(), truth.last().unwrap().as_str()), ("-ab", "a.oct"));
        assert!(truth.ends_with(&["-x", "16", "-y", "8", "a.oct"].map(str::to_owned)));
    }

    #[test]
    fn pixels_are_averaged_in_squares() {
        let image = Image::new(4, 2, 1, vec![1.0, 3.0, 10.0, 30.0, 5.0, 7.0, 50.0, 70.0]).unwrap();
        assert_eq!(shrunk(&image, 2).unwrap().data(), [4.0, 40.0]);
    }
}
