//! What pictures are compared with: many independent pictures without bias, averaged, kept on disk, and compared with real Radiance's.

use super::accuracy::{Accuracy, blocks};
use super::own::Own;
use super::program::read_picture;
use super::real::{Real, Traced, UNBIASED};
use super::scene::{Scene, words};
use crate::error::BenchError;
use radsight_picture::{Image, write_pfm};
use std::fs;
use std::path::{Path, PathBuf};

/// A converged picture.
#[derive(Debug)]
pub(crate) struct Reference {
    pub(crate) image: Image<f32>,
    /// Its own error, as half of the difference of two independent halves tells it.
    pub(crate) noise: f64,
    /// Rays a pixel.
    pub(crate) rays: u64,
    /// How real Radiance's picture without bias agrees with it.
    pub(crate) check: String,
}

/// When a reference is good enough.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wanted {
    /// Noise, as a share.
    pub(crate) noise: f64,
    /// Seconds of processor time that may be spent on each of reference and check.
    pub(crate) seconds: f64,
}

/// Rays a pixel of a picture that is averaged: more as long as pictures take less than [`SHORT`].
const FIRST_RAYS: u32 = 64;
const MOST_RAYS: u32 = 4096;
const SHORT: f64 = 5.0;

impl Reference {
    /// Reads what was made before, and goes on from there.
    pub(crate) fn make(
        scene: &Scene,
        own: &Own,
        real: Option<&Real<'_>>,
        wanted: Wanted,
        (folder, cache): (&Path, &Path),
    ) -> Result<Reference, BenchError> {
        let mut halves = Halves::read(cache.join(format!("{}-{:016x}", scene.name, scene.fingerprint()?)));
        let mut spent = 0.0;
        let mut rays = FIRST_RAYS;
        let is_noisy = |halves: &Halves| halves.noise().is_none_or(|noise| noise > wanted.noise);
        while halves.pictures < 2 || is_noisy(&halves) && spent < wanted.seconds {
            let (taken, picture) = own.unbiased(scene, rays, 1_000_000 + halves.pictures, folder)?;
            halves.add(&picture, rays);
            spent += taken.processor;
            if taken.processor < SHORT && rays < MOST_RAYS && halves.pictures.is_multiple_of(2) {
                rays *= 2;
            }
        }
        halves.write()?;
        let image = halves.mean()?;
        let check = match (real, halves.read_check()) {
            (_, Some(check)) => check,
            (None, None) => "not compared with real Radiance".to_owned(),
            (Some(real), None) => match compare(scene, &image, real, wanted.seconds, folder) {
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

/// Two sums of pictures, each of every other one.
struct Halves {
    /// Of the files, without their endings.
    path: PathBuf,
    pictures: u32,
    rays: [u64; 2],
    means: [Option<Image<f32>>; 2],
}

impl Halves {
    fn read(path: PathBuf) -> Halves {
        let text = fs::read_to_string(path.with_extension("txt")).unwrap_or_default();
        let numbers: Vec<u64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        let means = [0, 1].map(|half| read_picture(&half_path(&path, half)).ok());
        match (numbers[..].first_chunk::<3>(), &means) {
            (Some(&[pictures, first, second]), [Some(_), Some(_)]) => {
                Halves { path, pictures: pictures as u32, rays: [first, second], means }
            }
            _ => Halves { path, pictures: 0, rays: [0; 2], means: [None, None] },
        }
    }

    fn add(&mut self, picture: &Image<f32>, rays: u32) {
        let half = (self.pictures % 2) as usize;
        let share = f64::from(rays) / (self.rays[half] + u64::from(rays)) as f64;
        let mean = self.means[half].get_or_insert_with(|| picture.clone());
        blend(mean, picture, share);
        self.rays[half] += u64::from(rays);
        self.pictures += 1;
    }

    /// `None` before there are two pictures.
    fn noise(&self) -> Option<f64> {
        let [Some(first), Some(second)] = &self.means else { return None };
        // The two halves have the same number of rays within one picture, so the mean of both has half of their difference.
        Some(0.5 * Accuracy::new(first, second).error)
    }

    fn mean(&self) -> Result<Image<f32>, BenchError> {
        let [Some(first), Some(second)] = &self.means else {
            return Err(BenchError::Read { path: self.path.clone(), reason: "no time for a reference".to_owned() });
        };
        let share = self.rays[1] as f64 / (self.rays[0] + self.rays[1]) as f64;
        let mut mean = first.clone();
        blend(&mut mean, second, share);
        Ok(mean)
    }

    fn write(&self) -> Result<(), BenchError> {
        for (half, mean) in self.means.iter().enumerate() {
            if let Some(Ok(bytes)) = mean.as_ref().map(write_pfm) {
                put(&half_path(&self.path, half), &bytes)?;
            }
        }
        let text = format!("{} {} {}\n", self.pictures, self.rays[0], self.rays[1]);
        put(&self.path.with_extension("txt"), text.as_bytes())
    }

    fn read_check(&self) -> Option<String> {
        fs::read_to_string(self.path.with_extension("check")).ok()
    }

    fn write_check(&self, check: &str) -> Result<(), BenchError> {
        put(&self.path.with_extension("check"), check.as_bytes())
    }
}

fn half_path(path: &Path, half: usize) -> PathBuf {
    path.with_extension(format!("{half}.pfm"))
}

/// Writes a file whole.
pub(crate) fn put(path: &Path, bytes: &[u8]) -> Result<(), BenchError> {
    fs::write(path, bytes).map_err(|reason| BenchError::Write { path: path.to_owned(), reason })
}

/// Rays a pixel through real `rtrace` at first, to see how long they take, and at most.
const TRIAL: u32 = 2;
const MOST_TRACED: u32 = 2048;

/// Compares with real Radiance without bias, as exactly as the time allows.
fn compare(
    scene: &Scene,
    reference: &Image<f32>,
    real: &Real<'_>,
    seconds: f64,
    folder: &Path,
) -> Result<String, BenchError> {
    let options = words(UNBIASED);
    let trial = real.trace(scene, &options, TRIAL, folder)?;
    let affordable = (seconds / trial.taken.processor.max(1e-3)) as u32;
    let rays = TRIAL * affordable.clamp(1, MOST_TRACED / TRIAL);
    let traced = if rays > TRIAL { real.trace(scene, &options, rays, folder)? } else { trial };
    Ok(agreement(reference, &traced, rays))
}

/// Moves each value of an image towards that of another by a share of the way.
fn blend(image: &mut Image<f32>, other: &Image<f32>, share: f64) {
    for (own, other) in image.data_mut().iter_mut().zip(other.data()) {
        *own = (f64::from(*own) + share * (f64::from(*other) - f64::from(*own))) as f32;
    }
}

/// Blocks that agree within three standard errors, unless the difference is this share or less.
const CLOSE: f64 = 0.005;

fn agreement(reference: &Image<f32>, traced: &Traced, rays: u32) -> String {
    let (mut agreeing, mut count) = (0_u32, 0_u32);
    for block in blocks(reference) {
        for band in 0..3 {
            let [expected, actual] = [reference, &traced.mean].map(|image| block.mean(image, band));
            let standard_error = block.error_of_mean(&traced.error, band);
            let near = (actual - expected).abs() <= 3.0 * standard_error + CLOSE * expected;
            agreeing += u32::from(near);
            count += 1;
        }
    }
    let sum = |image: &Image<f32>| image.data().iter().map(|value| f64::from(*value)).sum::<f64>();
    let mean = sum(&traced.mean) / sum(reference) - 1.0;
    let variance: f64 = traced.error.data().iter().map(|error| f64::from(*error) * f64::from(*error)).sum();
    let mean_error = variance.sqrt() / sum(reference);
    let share = f64::from(agreeing) / f64::from(count);
    let agrees = mean.abs() <= 3.0 * mean_error + CLOSE && share >= 0.97;
    format!(
        "real rtrace without bias ({rays} rays a pixel) {}: mean {:+.2} % ± {:.2} %, {:.1} % of blocks within three standard errors",
        if agrees { "agrees" } else { "DIFFERS" },
        100.0 * mean,
        100.0 * mean_error,
        100.0 * share,
    )
}
