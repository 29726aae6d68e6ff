//! Pictures for inspection: expected | difference | actual.

use radsight_picture::{Image, write_png_rgb8};
use std::fs;
use std::path::{Path, PathBuf};

/// Writes expected | difference | actual and prints the path. Red in the middle is too bright, blue
/// too dark; full colour is 20 %.
pub(crate) fn write(folder: &Path, name: &str, actual: &Image<f32>, expected: &Image<f32>) -> PathBuf {
    fs::create_dir_all(folder).expect("a folder for pictures");
    let (width, height) = (expected.width(), expected.height());
    let white = white(expected);
    let mut panels = Image::filled(3 * width, height, 3, 0u8).expect("a picture of three");
    for y in 0..height {
        for x in 0..width {
            let [right, found] = [expected, actual].map(|image| three(image.pixel(x, y)));
            panels.pixel_mut(x, y).copy_from_slice(&right.map(|value| tone(value / white)));
            panels.pixel_mut(width + x, y).copy_from_slice(&difference(right, found, 0.02 * white));
            panels.pixel_mut(2 * width + x, y).copy_from_slice(&found.map(|value| tone(value / white)));
        }
    }
    let path = folder.join(format!("{name}.png"));
    fs::write(&path, write_png_rgb8(&panels, None).expect("a PNG")).expect("the picture is written");
    path
}

fn three(pixel: &[f32]) -> [f64; 3] {
    [0, 1, 2].map(|band| f64::from(pixel[band.min(pixel.len() - 1)]))
}

/// Four times the median, or the largest value if most pixels are black.
fn white(image: &Image<f32>) -> f64 {
    let mut values: Vec<f32> = image.data().to_vec();
    values.sort_by(f32::total_cmp);
    let median = f64::from(values[values.len() / 2]);
    let largest = f64::from(values[values.len() - 1]).max(f64::MIN_POSITIVE);
    if median > 0.0 { (4.0 * median).min(largest) } else { largest }
}

fn tone(value: f64) -> u8 {
    (255.0 * value.clamp(0.0, 1.0).powf(1.0 / 2.2)).round() as u8
}

fn difference(expected: [f64; 3], actual: [f64; 3], floor: f64) -> [u8; 3] {
    let [expected, actual] = [expected, actual].map(|pixel| pixel.iter().sum::<f64>() / 3.0);
    let share = ((actual - expected) / expected.max(floor) / 0.2).clamp(-1.0, 1.0);
    let away = (255.0 * (1.0 - share.abs())) as u8;
    if share > 0.0 { [255, away, away] } else { [away, away, 255] }
}
