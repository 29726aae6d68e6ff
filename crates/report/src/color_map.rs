//! The false colour map viridis: perceptually uniform in lightness and readable for colour-blind
//! people.
//!
//! Source: S. van der Walt and N. Smith, "A Better Default Colormap for Matplotlib", SciPy 2015;
//! the table is in the public domain (CC0). Colours between its nine entries are interpolated
//! linearly.

/// sRGB at multiples of 1/8.
pub(crate) const VIRIDIS: [[u8; 3]; 9] = [
    [0x44, 0x01, 0x54],
    [0x47, 0x2d, 0x7b],
    [0x3b, 0x52, 0x8b],
    [0x2c, 0x72, 0x8e],
    [0x21, 0x91, 0x8c],
    [0x28, 0xae, 0x80],
    [0x5e, 0xc9, 0x62],
    [0xad, 0xdc, 0x30],
    [0xfd, 0xe7, 0x25],
];

/// The colour of undefined values.
pub(crate) const NO_VALUE: [u8; 3] = [0xff, 0x00, 0xff];

/// The sRGB colour at a position from 0 to 1; NaN has a colour outside viridis.
#[must_use]
pub fn viridis(place: f64) -> [u8; 3] {
    if place.is_nan() {
        return NO_VALUE;
    }
    let last = VIRIDIS.len() - 1;
    let along = place.clamp(0.0, 1.0) * last as f64;
    let index = (along as usize).min(last - 1);
    let part = along - index as f64;
    std::array::from_fn(|i| {
        let [from, to] = [VIRIDIS[index][i], VIRIDIS[index + 1][i]].map(f64::from);
        (from + part * (to - from)).round() as u8
    })
}

/// The grey at a position from 0 to 1, as stored.
pub(crate) fn grey(place: f64) -> [u8; 3] {
    if place.is_nan() { NO_VALUE } else { [(255.0 * place.clamp(0.0, 1.0)).round() as u8; 3] }
}

/// sRGB's transfer curve (IEC 61966-2-1): linear light, 1 for white, to 0 to 255.
pub(crate) fn srgb(linear: f64) -> u8 {
    let linear = linear.clamp(0.0, 1.0);
    let encoded = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (255.0 * encoded).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lightness_grows_along_the_map() {
        let luminance = |place: f64| {
            let linear = |component: u8| {
                let value = f64::from(component) / 255.0;
                if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
            };
            let [red, green, blue] = viridis(place).map(linear);
            0.2126 * red + 0.7152 * green + 0.0722 * blue
        };
        assert!((0..100).all(|i| luminance(f64::from(i) / 100.0) < luminance(f64::from(i + 1) / 100.0)));
        assert_eq!(viridis(f64::NAN), NO_VALUE);
    }

    #[test]
    fn middle_grey_is_where_srgb_has_it() {
        assert_eq!([0.0, 0.215_860_5, 1.0, 7.0].map(srgb), [0, 128, 255, 255]);
    }
}
