//! Two independent pictures of a room by single paths, kept on disk.

use crate::error::BenchError;
use crate::race::{put, read_picture};
use crate::radsight::Radsight;
use crate::taken::{Taken, taken};
use radsight_picture::{Image, write_pfm};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Rays a pixel of the first pictures, and the most of one.
const FIRST_RAYS: u32 = 256;
const MOST_RAYS: u32 = 16_384;

/// A pair of pictures that takes less than this share of the time that is left may be followed by one of twice as many rays.
const SHARE: f64 = 0.2;

/// The seeds of references begin here, so that no picture that is judged shares its random numbers with them.
const FIRST_SEED: u32 = 1_000_000;

/// Sums of pictures, every other one in each.
#[derive(Debug)]
pub(super) struct Reference {
    path: PathBuf,
    pictures: u32,
    /// Rays a pixel of each half.
    rays: u64,
    halves: Vec<Image<f32>>,
}

impl Reference {
    /// Reads what was made before.
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

    /// Goes on for some seconds of processor time, or until it is good enough.
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
            if spent - before < SHARE * (seconds - spent) {
                rays = (2 * rays).min(MOST_RAYS);
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

/// Moves each value of an image towards that of another by a share of the way.
fn blend(image: &mut Image<f32>, other: &Image<f32>, share: f64) {
    for (own, other) in image.data_mut().iter_mut().zip(other.data()) {
        *own = (f64::from(*own) + share * (f64::from(*other) - f64::from(*own))) as f32;
    }
}
