//! The measurement series, reduced to statistics.

use super::error::CharacterisationError;

/// A sensor under uniform illumination.
pub trait Device {
    /// Number of columns and rows.
    fn pixels(&self) -> [u32; 2];

    /// Exposure time of the illuminated pictures, seconds.
    fn exposure_s(&self) -> f64;

    /// Largest possible grey value.
    fn largest_grey(&self) -> u16;

    /// A picture with a mean number of photons per pixel, exposed for a time in seconds. Each seed
    /// gives another picture.
    fn picture(&self, photons: f64, exposure_s: f64, seed: u64) -> Vec<u16>;
}

/// Extent of a measurement series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Series {
    /// Number of illumination steps from dark to saturation, with two pictures each; the standard
    /// requires at least 50.
    pub steps: u32,
    /// Number of pictures in each stack for the spatial non-uniformity.
    pub stack: u32,
}

impl Default for Series {
    fn default() -> Self {
        Series { steps: 50, stack: 100 }
    }
}

/// Statistics of two illuminated pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightStep {
    /// Mean photons per pixel.
    pub photons: f64,
    /// μ_y, mean grey value.
    pub mean: f64,
    /// Temporal variance σ_y², grey values squared.
    pub variance: f64,
    /// Fraction of pixels at the largest grey value.
    pub at_the_largest_grey: f64,
}

/// Statistics of two dark pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DarkStep {
    /// Exposure time, seconds.
    pub exposure_s: f64,
    /// Mean grey value μ_y.dark.
    pub mean: f64,
    /// Temporal variance, grey values squared.
    pub variance: f64,
}

/// Statistics of several pictures of the same illumination, by pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Stack {
    /// Number of pictures.
    pub pictures: u32,
    /// Mean grey value of each pixel.
    pub means: Vec<f64>,
    /// Temporal variance, averaged over the pixels.
    pub variance: f64,
    /// Fraction of all grey values that are 0, where the noise is clipped.
    pub at_zero: f64,
}

impl Stack {
    /// Mean grey value over all pixels.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.means.iter().sum::<f64>() / self.means.len() as f64
    }
}

/// Statistics of a measurement series.
#[derive(Clone, Debug, PartialEq)]
pub struct PhotonTransfer {
    /// Number of columns and rows.
    pub pixels: [u32; 2],
    /// Exposure time of the illuminated pictures, seconds.
    pub exposure_s: f64,
    /// Illumination steps, ascending; the last ones are saturated.
    pub light: Vec<LightStep>,
    /// Dark steps, by ascending exposure time.
    pub dark_times: Vec<DarkStep>,
    /// Dark stack, at the exposure time of the illuminated pictures.
    pub dark: Stack,
    /// Stack at half of saturation.
    pub half: Stack,
}

/// Photons per pixel at which the search for saturation begins.
const FIRST_PHOTONS: f64 = 16.0;
/// Maximum number of doublings in that search.
const MOST_DOUBLINGS: u32 = 60;
/// Number of steps beyond saturation, which determine the plateau.
const PLATEAU_STEPS: u32 = 4;
/// Number of exposure times in the dark.
const DARK_TIMES: u32 = 6;
/// Longest exposure time in the dark, relative to that of the illuminated pictures.
const LONGEST_DARK_TIME: f64 = 1e4;

/// Measures the series.
///
/// # Errors
/// If the device has too few pixels or does not saturate.
pub fn measure(device: &dyn Device, series: &Series, seed: u64) -> Result<PhotonTransfer, CharacterisationError> {
    let pixels = device.pixels();
    if pixels.iter().any(|&count| count < 8) || series.steps < 8 || series.stack < 4 {
        return Err(CharacterisationError::TooLittle { columns: pixels[0], rows: pixels[1] });
    }
    let mut camera = Shooting { device, exposure_s: device.exposure_s(), seed, picture: 0 };
    let dark = camera.stack(0.0, series.stack);
    let saturation = camera.find_saturation(&dark)?;
    let of_step = |step: u32| f64::from(step) / f64::from(series.steps) * saturation;
    let plateau = (1..=PLATEAU_STEPS).map(|step| (1.5 + 0.25 * f64::from(step)) * saturation);
    let photons: Vec<f64> = (1..=series.steps).map(of_step).chain(plateau).collect();
    let light = photons.into_iter().map(|photons| camera.light_step(photons)).collect();
    let half = camera.stack(0.5 * saturation, series.stack);
    let dark_times = camera.dark_times(&dark);
    Ok(PhotonTransfer { pixels, exposure_s: camera.exposure_s, light, dark_times, dark, half })
}

/// Takes pictures, each with its own seed.
struct Shooting<'a> {
    device: &'a dyn Device,
    exposure_s: f64,
    seed: u64,
    picture: u64,
}

impl Shooting<'_> {
    fn shoot(&mut self, photons: f64, exposure_s: f64) -> Vec<u16> {
        self.picture += 1;
        // Seeds are far apart, so that pictures of different series differ.
        let seed = self.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(self.picture);
        self.device.picture(photons, exposure_s, seed)
    }

    fn light_step(&mut self, photons: f64) -> LightStep {
        let [first, second] = [(); 2].map(|()| self.shoot(photons, self.exposure_s));
        let largest = self.device.largest_grey();
        let full = first.iter().chain(&second).filter(|&&grey| grey == largest).count();
        let (mean, variance) = pair_statistics(&first, &second);
        LightStep { photons, mean, variance, at_the_largest_grey: full as f64 / (2 * first.len()) as f64 }
    }

    /// Photons at which the mean grey value is within 1 % of its maximum.
    fn find_saturation(&mut self, dark: &Stack) -> Result<f64, CharacterisationError> {
        let dark = dark.mean();
        let mut photons = FIRST_PHOTONS;
        let mut mean = mean_of(&self.shoot(photons, self.exposure_s));
        for _ in 0..MOST_DOUBLINGS {
            let next = mean_of(&self.shoot(2.0 * photons, self.exposure_s));
            // Without any signal yet the sensor cannot be saturated.
            if mean - dark > 8.0 && next - mean < 0.01 * (mean - dark) {
                return Ok(self.knee(photons, next - dark, dark));
            }
            (photons, mean) = (2.0 * photons, next);
        }
        Err(CharacterisationError::NoSaturation { photons })
    }

    /// Photons at the intersection of the linear response with the plateau, which is `rise` above
    /// the dark level; at `saturated` photons the sensor is saturated.
    fn knee(&mut self, saturated: f64, rise: f64, dark: f64) -> f64 {
        let mut photons = saturated;
        let mut mean = mean_of(&self.shoot(photons, self.exposure_s));
        while mean - dark > 0.5 * rise {
            photons *= 0.5;
            mean = mean_of(&self.shoot(photons, self.exposure_s));
        }
        photons * rise / (mean - dark)
    }

    fn dark_times(&mut self, dark: &Stack) -> Vec<DarkStep> {
        let (own, base, noise) = (self.exposure_s, dark.mean(), dark.variance.sqrt());
        let mut longest = 8.0 * own;
        while longest < LONGEST_DARK_TIME * own && mean_of(&self.shoot(0.0, longest)) - base < 4.0 * noise {
            longest *= 4.0;
        }
        let times = (1..=DARK_TIMES).map(|step| longest * f64::from(step) / f64::from(DARK_TIMES));
        times.map(|exposure_s| self.dark_step(exposure_s)).collect()
    }

    fn dark_step(&mut self, exposure_s: f64) -> DarkStep {
        let [first, second] = [(); 2].map(|()| self.shoot(0.0, exposure_s));
        let (mean, variance) = pair_statistics(&first, &second);
        DarkStep { exposure_s, mean, variance }
    }

    fn stack(&mut self, photons: f64, pictures: u32) -> Stack {
        let [columns, rows] = self.device.pixels();
        let count = columns as usize * rows as usize;
        let (mut sums, mut squares) = (vec![0.0; count], vec![0.0; count]);
        let mut zeros = 0;
        for _ in 0..pictures {
            let picture = self.shoot(photons, self.exposure_s);
            zeros += picture.iter().filter(|&&grey| grey == 0).count();
            for ((sum, square), grey) in sums.iter_mut().zip(&mut squares).zip(picture) {
                *sum += f64::from(grey);
                *square += f64::from(grey).powi(2);
            }
        }
        let number = f64::from(pictures);
        let spread = |(sum, square): (&f64, &f64)| (square - sum * sum / number) / (number - 1.0);
        let variance = sums.iter().zip(&squares).map(spread).sum::<f64>() / count as f64;
        sums.iter_mut().for_each(|sum| *sum /= number);
        Stack { pictures, means: sums, variance, at_zero: zeros as f64 / (number * count as f64) }
    }
}

fn mean_of(picture: &[u16]) -> f64 {
    picture.iter().map(|&grey| f64::from(grey)).sum::<f64>() / picture.len().max(1) as f64
}

/// Mean and temporal variance of two pictures: half the variance of their difference, in which
/// spatial differences cancel.
fn pair_statistics(first: &[u16], second: &[u16]) -> (f64, f64) {
    let count = first.len() as f64;
    let difference = |(a, b): (&u16, &u16)| f64::from(*a) - f64::from(*b);
    let mean_difference = first.iter().zip(second).map(difference).sum::<f64>() / count;
    let squares: f64 = first.iter().zip(second).map(|pair| (difference(pair) - mean_difference).powi(2)).sum();
    (0.5 * (mean_of(first) + mean_of(second)), 0.5 * squares / (count - 1.0))
}
