//! Compares pictures by statistics, and writes both for inspection if they differ.

// Each test file is a program of its own and uses a part of this.
#![allow(dead_code)]

use radsight_picture::{Image, read_image, read_png, write_png_grey8};
use std::fs;
use std::path::{Path, PathBuf};

/// Reads an exposure in J/m² from a file's bytes.
pub(crate) fn exposure(bytes: &[u8]) -> Image<f32> {
    read_image(bytes).expect("a picture of exposure").image
}

/// Reads an exposure file, J/m².
pub(crate) fn exposure_file(path: &Path) -> Image<f32> {
    exposure(&fs::read(path).expect("the file is read"))
}

/// The grey values of a PNG of up to 16 bits.
pub(crate) fn greys(bytes: &[u8]) -> Image<u16> {
    read_png(bytes).expect("a PNG").values
}

/// Eq. 5 of the paper with its K, γ, G₀, G_max and E in µJ/cm², from J/m².
pub(crate) fn paper_grey(exposure: f32) -> u16 {
    (33844.0 * (100.0 * f64::from(exposure)).powf(0.85) + 12.0).min(161.0).round() as u16
}

/// The difference between a picture and the correct one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Difference {
    /// Rms difference, relative to the mean of the correct picture.
    pub(crate) rms: f64,
    /// The same without the worst thousandth of the pixels.
    pub(crate) rms_of_most: f64,
    /// Ratio of the means, minus 1.
    pub(crate) mean: f64,
}

impl Difference {
    pub(crate) fn new(actual: &Image<f32>, expected: &Image<f32>) -> Difference {
        assert_eq!((actual.width(), actual.height()), (expected.width(), expected.height()));
        let count = expected.data().len();
        let mean = |image: &Image<f32>| image.data().iter().map(|v| f64::from(*v)).sum::<f64>() / count as f64;
        let pairs = actual.data().iter().zip(expected.data());
        let mut squares: Vec<f64> = pairs.map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2)).collect();
        squares.sort_by(f64::total_cmp);
        let rms = |part: &[f64]| (part.iter().sum::<f64>() / count as f64).sqrt() / mean(expected);
        Difference {
            rms: rms(&squares),
            rms_of_most: rms(&squares[..count - count / 1000]),
            mean: mean(actual) / mean(expected) - 1.0,
        }
    }
}

/// Writes expected | difference | actual as one grey picture and prints the path.
pub(crate) fn show(name: &str, actual: &Image<f32>, expected: &Image<f32>) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("test-failures");
    fs::create_dir_all(&folder).expect("a folder for pictures");
    let (width, height) = (expected.width(), expected.height());
    let mut panels = Image::filled(3 * width, height, 1, 0u8).expect("a picture of three");
    for y in 0..height {
        for x in 0..width {
            let [expected, actual] = [expected, actual].map(|image| i32::from(paper_grey(image.pixel(x, y)[0])));
            let difference = 128 + 16 * (actual - expected);
            for (panel, grey) in [expected, difference, actual].into_iter().enumerate() {
                panels.pixel_mut(panel * width + x, y)[0] = grey.clamp(0, 255) as u8;
            }
        }
    }
    let path = folder.join(format!("{name}.png"));
    fs::write(&path, write_png_grey8(&panels, None).expect("a PNG")).expect("the picture is written");
    path
}
