//! The brightness of a pixel.

use radsight_picture::Encoding;
use radsight_units::color::{BLUE, GREEN, RED, WHITE};

/// The weights of red, green and blue in the brightness. Their sum is 1.
///
/// They are the amounts of the three primaries in white, computed in the order of operations that
/// reproduces Radiance's last bit.
pub const WEIGHTS: [f64; 3] = {
    let determinant = RED[0] * (GREEN[1] - BLUE[1]) + GREEN[0] * (BLUE[1] - RED[1]) + BLUE[0] * (RED[1] - GREEN[1]);
    let red = (1.0 / WHITE[1])
        * (WHITE[0] * (GREEN[1] - BLUE[1]) - WHITE[1] * (GREEN[0] - BLUE[0]) + GREEN[0] * BLUE[1] - BLUE[0] * GREEN[1]);
    let green = (1.0 / WHITE[1])
        * (WHITE[0] * (BLUE[1] - RED[1]) - WHITE[1] * (BLUE[0] - RED[0]) - RED[0] * BLUE[1] + BLUE[0] * RED[1]);
    let blue = (1.0 / WHITE[1])
        * (WHITE[0] * (RED[1] - GREEN[1]) - WHITE[1] * (RED[0] - GREEN[0]) + RED[0] * GREEN[1] - GREEN[0] * RED[1]);
    [RED[1] * red / determinant, GREEN[1] * green / determinant, BLUE[1] * blue / determinant]
};

/// The brightness of red, green and blue. Green is added last, which determines the last bit.
#[must_use]
pub fn of_rgb(color: [f32; 3]) -> f64 {
    WEIGHTS[0] * f64::from(color[0]) + WEIGHTS[2] * f64::from(color[2]) + WEIGHTS[1] * f64::from(color[1])
}

/// Computes the brightness of pixels of an encoding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brightness {
    /// The components used as red, green and blue; all equal for Y alone.
    bands: [usize; 3],
    is_luminance: bool,
}

/// The wavelengths that represent red, green and blue, nm.
const PEAKS: [f32; 3] = [607.0, 553.0, 469.0];

impl Brightness {
    /// For pictures of an encoding with this many components.
    #[must_use]
    pub fn new(encoding: Encoding, components: usize) -> Brightness {
        match encoding {
            Encoding::Xyze => Brightness { bands: [0, 1, 2], is_luminance: true },
            Encoding::Spectral { splits } if components > 3 => {
                Brightness { bands: principal_bands(components, splits), is_luminance: false }
            }
            _ => Brightness { bands: [0, 1, 2], is_luminance: false },
        }
    }

    /// The brightness of one pixel's components.
    #[must_use]
    pub fn of(&self, pixel: &[f32]) -> f64 {
        if self.is_luminance {
            return f64::from(pixel[1]);
        }
        of_rgb(self.bands.map(|band| pixel[band]))
    }

    /// The components used as red, green and blue.
    #[must_use]
    pub fn bands(&self) -> [usize; 3] {
        self.bands
    }
}

/// The bands of a spectrum nearest to red, green and blue.
fn principal_bands(bands: usize, splits: [f32; 4]) -> [usize; 3] {
    let (longest, shortest) = (splits[0], splits[3]);
    if shortest >= PEAKS[2] || longest <= PEAKS[0] {
        return [0, bands / 3, bands * 2 / 3];
    }
    let middle = |band: usize| (band as f32 + 0.5) / bands as f32 * (shortest - longest) + longest;
    let distance = |band: usize, peak: f32| f64::from(middle(band) - peak).abs();
    PEAKS.map(|peak| {
        (0..bands)
            .rev()
            .fold(bands - 1, |best, band| if distance(band, peak) < distance(best, peak) { band } else { best })
    })
}

/// Assigns to each band of a spectrum the component of a colour that contains its centre.
#[must_use]
pub fn spread(color: [f32; 3], encoding: Encoding, components: usize) -> Vec<f32> {
    let Encoding::Spectral { splits } = encoding else { return color.to_vec() };
    if components == 3 {
        return color.to_vec();
    }
    let [longest, red_end, green_end, shortest] = [splits[0], 588.0, 480.0, splits[3]];
    let step = f64::from(shortest - longest) / components as f64;
    let first = f64::from(longest) + 0.5 * step;
    (0..components)
        .map(|band| {
            let middle = first + band as f64 * step;
            color[if middle >= f64::from(red_end) {
                0
            } else if middle >= f64::from(green_end) {
                1
            } else {
                2
            }]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_has_its_own_brightness() {
        assert!((WEIGHTS.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!((WEIGHTS[1] - 0.670_114_631).abs() < 1e-4);
    }

    #[test]
    fn the_principal_bands_are_the_nearest() {
        let encoding = Encoding::Spectral { splits: Encoding::USUAL_SPLITS };
        // Twenty bands of 20 nm: centres at 770, 750, …
        assert_eq!(Brightness::new(encoding, 20).bands(), [8, 11, 15]);
    }
}
