//! References: averages of many independent unbiased pictures, stored on disk, and compared with
//! real Radiance.

use super::accuracy::{BLOCK, Block, blocks, sum};
use super::halves::Halves;
use super::own::Own;
use super::real::{Real, Traced, UNBIASED};
use super::scene::{Scene, words};
use crate::error::BenchError;
use radsight_picture::Image;
use std::path::Path;

/// A converged picture.
#[derive(Debug)]
pub(crate) struct Reference {
    pub(crate) image: Image<f32>,
    /// Its own error, estimated as half of the difference of two independent halves.
    pub(crate) noise: f64,
    /// Rays a pixel.
    pub(crate) rays: u64,
    /// Agreement of real Radiance's unbiased picture.
    pub(crate) check: String,
}

/// The stopping criterion of a reference.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Criterion {
    /// Relative noise.
    pub(crate) noise: f64,
    /// Processor time for each of reference and check, seconds.
    pub(crate) seconds: f64,
}

/// Rays per pixel of one averaged picture; more as long as a picture takes less than [`SHORT`].
const FIRST_RAYS: u32 = 64;
const MAX_RAYS: u32 = 4096;
const SHORT: f64 = 5.0;

impl Reference {
    /// Reads the stored reference and continues from it.
    pub(crate) fn make(
        scene: &Scene,
        own: &Own,
        real: Option<&Real<'_>>,
        criterion: Criterion,
        (folder, cache): (&Path, &Path),
    ) -> Result<Reference, BenchError> {
        let mut halves = Halves::read(cache.join(format!("{}-{:016x}", scene.name, scene.fingerprint()?)));
        let mut spent = 0.0;
        let mut rays = FIRST_RAYS;
        let is_noisy = |halves: &Halves| halves.noise().is_none_or(|noise| noise > criterion.noise);
        while halves.pictures < 2 || is_noisy(&halves) && spent < criterion.seconds {
            let (taken, picture) = own.unbiased(scene, rays, 1_000_000 + halves.pictures, folder)?;
            halves.add(&picture, rays);
            spent += taken.processor;
            if taken.processor < SHORT && rays < MAX_RAYS && halves.pictures.is_multiple_of(2) {
                rays *= 2;
            }
        }
        halves.write()?;
        let image = halves.mean()?;
        let check = match (real, halves.read_check()) {
            (_, Some(check)) => check,
            (None, None) => "not compared with real Radiance".to_owned(),
            (Some(real), None) => match compare(scene, &image, &halves.errors()?, real, criterion.seconds, folder) {
                Ok(check) => {
                    halves.write_check(&check)?;
                    check
                }
                Err(reason) => format!("not compared with real Radiance: {reason}"),
            },
        };
        Ok(Reference { image, noise: halves.noise().unwrap_or(f64::NAN), rays: halves.rays[0] + halves.rays[1], check })
    }
}

/// Initial rays per pixel through real `rtrace`, to measure their time, and the largest number.
const TRIAL: u32 = 2;
const MAX_TRACED: u32 = 2048;

/// Compares with unbiased real Radiance, as accurately as the time permits.
fn compare(
    scene: &Scene,
    reference: &Image<f32>,
    noise: &Image<f32>,
    real: &Real<'_>,
    seconds: f64,
    folder: &Path,
) -> Result<String, BenchError> {
    let options = words(UNBIASED);
    let trial = real.trace(scene, &options, TRIAL, folder)?;
    let affordable = (seconds / trial.taken.processor.max(1e-3)) as u32;
    let rays = TRIAL * affordable.clamp(1, MAX_TRACED / TRIAL);
    let traced = if rays > TRIAL { real.trace(scene, &options, rays, folder)? } else { trial };
    Ok(agreement(reference, noise, &traced, rays))
}

/// Blocks agree within three standard errors, or within this relative difference.
const TOLERANCE: f64 = 0.005;

/// Number of blocks that agree. Rare bright rays fall into some blocks and not into others, so the
/// variance of a block is that of its neighbourhood.
fn agreement(reference: &Image<f32>, noise: &Image<f32>, traced: &Traced, rays: u32) -> String {
    let columns = reference.width().div_ceil(BLOCK);
    let (mut agreeing, mut count) = (0_u32, 0_u32);
    for band in 0..3 {
        let variance =
            |block: Block| block.error_of_mean(&traced.error, band).powi(2) + block.error_of_mean(noise, band).powi(2);
        let variances: Vec<f64> = blocks(reference).map(variance).collect();
        for (block, variance) in blocks(reference).zip(of_neighbours(&variances, columns)) {
            let [expected, actual] = [reference, &traced.mean].map(|image| block.mean(image, band));
            let near = (actual - expected).abs() <= 3.0 * variance.sqrt() + TOLERANCE * expected;
            agreeing += u32::from(near);
            count += 1;
        }
    }
    let squares = |image: &Image<f32>| image.data().iter().map(|value| f64::from(*value).powi(2)).sum::<f64>();
    let mean = sum(&traced.mean) / sum(reference) - 1.0;
    let mean_error = (squares(&traced.error) + squares(noise)).sqrt() / sum(reference);
    let share = f64::from(agreeing) / f64::from(count);
    let agrees = mean.abs() <= 3.0 * mean_error + TOLERANCE && share >= 0.97;
    format!(
        "real rtrace without bias ({rays} rays a pixel) {}: mean {:+.2} % ± {:.2} %, {:.1} % of blocks within three standard errors",
        if agrees { "agrees" } else { "DIFFERS" },
        100.0 * mean,
        100.0 * mean_error,
        100.0 * share,
    )
}

/// The means of each value and its up to eight neighbours in a table with this many columns.
fn of_neighbours(values: &[f64], columns: usize) -> Vec<f64> {
    let rows = values.len() / columns;
    (0..values.len())
        .map(|at| {
            let near = |middle: usize, end: usize| middle.saturating_sub(1)..(middle + 2).min(end);
            let cells =
                near(at / columns, rows).flat_map(|y| near(at % columns, columns).map(move |x| y * columns + x));
            let (sum, count) = cells.fold((0.0, 0.0), |(sum, count), cell| (sum + values[cell], count + 1.0));
            sum / count
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::of_neighbours;

    #[test]
    fn the_mean_of_neighbours_stays_within_the_table() {
        assert_eq!(of_neighbours(&[9.0, 0.0, 0.0, 0.0, 0.0, 0.0], 3), [2.25, 1.5, 0.0, 2.25, 1.5, 0.0]);
    }
}
