//! Means of independent pictures, stored on disk.

use super::accuracy::Accuracy;
use super::program::read_picture;
use crate::error::BenchError;
use radsight_picture::{Image, write_pfm};
use std::fs;
use std::path::{Path, PathBuf};

/// Two sums of pictures, each of every other one.
pub(crate) struct Halves {
    /// Path of the files, without suffix.
    path: PathBuf,
    pub(crate) pictures: u32,
    pub(super) rays: [u64; 2],
    means: [Option<Image<f32>>; 2],
}

impl Halves {
    pub(crate) fn read(path: PathBuf) -> Halves {
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

    pub(crate) fn add(&mut self, picture: &Image<f32>, rays: u32) {
        let half = (self.pictures % 2) as usize;
        let share = f64::from(rays) / (self.rays[half] + u64::from(rays)) as f64;
        let mean = self.means[half].get_or_insert_with(|| picture.clone());
        blend(mean, picture, share);
        self.rays[half] += u64::from(rays);
        self.pictures += 1;
    }

    /// The mean of each half.
    pub(crate) fn means(&self) -> [Option<&Image<f32>>; 2] {
        [self.means[0].as_ref(), self.means[1].as_ref()]
    }

    /// `None` before there are two pictures.
    pub(super) fn noise(&self) -> Option<f64> {
        let [Some(first), Some(second)] = &self.means else { return None };
        // The two halves have the same number of rays within one picture, so the error of their
        // mean is half of their difference.
        Some(0.5 * Accuracy::new(first, second).error)
    }

    pub(crate) fn mean(&self) -> Result<Image<f32>, BenchError> {
        let [Some(first), Some(second)] = &self.means else {
            return Err(BenchError::Read {
                path: self.path.clone(),
                reason: "the time is too short for a reference".to_owned(),
            });
        };
        let share = self.rays[1] as f64 / (self.rays[0] + self.rays[1]) as f64;
        let mut mean = first.clone();
        blend(&mut mean, second, share);
        Ok(mean)
    }

    /// The errors of the mean, estimated from the halves.
    pub(super) fn errors(&self) -> Result<Image<f32>, BenchError> {
        let mut errors = self.mean()?;
        if let [Some(first), Some(second)] = &self.means {
            for (error, (first, second)) in errors.data_mut().iter_mut().zip(first.data().iter().zip(second.data())) {
                *error = 0.5 * (first - second).abs();
            }
        }
        Ok(errors)
    }

    pub(crate) fn write(&self) -> Result<(), BenchError> {
        for (half, mean) in self.means.iter().enumerate() {
            if let Some(Ok(bytes)) = mean.as_ref().map(write_pfm) {
                put(&half_path(&self.path, half), &bytes)?;
            }
        }
        let text = format!("{} {} {}\n", self.pictures, self.rays[0], self.rays[1]);
        put(&self.path.with_extension("txt"), text.as_bytes())
    }

    pub(super) fn read_check(&self) -> Option<String> {
        fs::read_to_string(self.path.with_extension("check")).ok()
    }

    pub(super) fn write_check(&self, check: &str) -> Result<(), BenchError> {
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

/// Interpolates each value of an image towards that of another.
fn blend(image: &mut Image<f32>, other: &Image<f32>, share: f64) {
    for (own, other) in image.data_mut().iter_mut().zip(other.data()) {
        *own = (f64::from(*own) + share * (f64::from(*other) - f64::from(*own))) as f32;
    }
}
