//! Two independent pictures of a room by independent paths, stored on disk.

use crate::error::BenchError;
use crate::race::{put, read_picture};
use crate::radsight::Radsight;
use crate::taken::{Taken, taken};
use radsight_picture::{Image, write_pfm};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Rays per pixel of the first pictures, and their maximum.
const FIRST_RAYS: u32 = 256;
const MAX_RAYS: u32 = 16_384;

/// If a pair of pictures takes less than this fraction of the remaining time, the next has twice as
/// many rays.
const TIME_FRACTION: f64 = 0.2;

/// First seed of references, so that they share no random numbers with measured pictures.
const FIRST_SEED: u32 = 1_000_000;

/// Two sums of pictures, each of every other one.
#[derive(Debug)]
pub(super) struct Reference {
    path: PathBuf,
    pictures: u32,
    /// Rays per pixel of each half.
    rays: u64,
    halves: Vec<Image<f32>>,
}

impl Reference {
    /// Reads a stored reference.
    pub(super) fn read(path: PathBuf) -> Reference {
        let text = fs::read_to_string(path.with_extension("txt")).unwrap_or_default();
        let numbers: Vec<u64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        let halves: Vec<Image<f32>> =
            [0, 1].iter().filter_map(|half| read_picture(&half_path(&path, *half)).ok()).collect();
        match numbers[..] {
            [pictures, rays] if halves.len() == 2 => Reference { path, pictures: pictures as u32, rays, halves },
            _ => Reference { path, pictures: 0, rays: 0, halves: Vec::new() },
        }
    }

    /// The two independent pictures.
    pub(super) fn halves(&self) -> Option<[&Image<f32>; 2]> {
        match &self.halves[..] {
            [first, second] => Some([first, second]),
            _ => None,
        }
    }

    /// Adds pictures for some seconds of processor time, or until the reference is sufficient.
    pub(super) fn improve(
        &mut self,
        command: &dyn Fn(&Radsight) -> Command,
        seconds: f64,
        folder: &Path,
        is_good: &dyn Fn([&Image<f32>; 2]) -> bool,
    ) -> Result<(), BenchError> {
        let (mut spent, mut rays) = (0.0, FIRST_RAYS);
        while spent < seconds && !self.halves().is_some_and(is_good) {
            let before = spent;
            for half in 0..2 {
                let (took, picture) = render(command, rays, FIRST_SEED + self.pictures, folder)?;
                spent += took.processor;
                self.pictures += 1;
                match self.halves.get_mut(half) {
                    Some(mean) => blend(mean, &picture, f64::from(rays) / (self.rays + u64::from(rays)) as f64),
                    None => self.halves.push(picture),
                }
            }
            self.rays += u64::from(rays);
            if spent - before < TIME_FRACTION * (seconds - spent) {
                rays = (2 * rays).min(MAX_RAYS);
            }
            self.write()?;
        }
        Ok(())
    }

    fn write(&self) -> Result<(), BenchError> {
        for (half, mean) in self.halves.iter().enumerate() {
            if let Ok(bytes) = write_pfm(mean) {
                put(&half_path(&self.path, half), &bytes)?;
            }
        }
        put(&self.path.with_extension("txt"), format!("{} {}\n", self.pictures, self.rays).as_bytes())
    }
}

fn half_path(path: &Path, half: usize) -> PathBuf {
    path.with_extension(format!("{half}.pfm"))
}

fn render(
    command: &dyn Fn(&Radsight) -> Command,
    rays: u32,
    seed: u32,
    folder: &Path,
) -> Result<(Taken, Image<f32>), BenchError> {
    let output = folder.join("reference.floats");
    let mut command = command(&Radsight::find());
    command.args(["-aa", "0", "--samples", &rays.to_string(), "--seed", &seed.to_string(), "room.rad"]);
    let took = taken(&mut command, folder, None, Some(&output))?;
    Ok((took, read_picture(&output)?))
}

/// Interpolates each value of an image towards that of another.
fn blend(image: &mut Image<f32>, other: &Image<f32>, share: f64) {
    for (own, other) in image.data_mut().iter_mut().zip(other.data()) {
        *own = (f64::from(*own) + share * (f64::from(*other) - f64::from(*own))) as f32;
    }
}
