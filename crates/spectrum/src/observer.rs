//! The CIE 1931 2° standard observer.

use std::sync::LazyLock;

/// First wavelength of [`MATCHING`], nm.
const FIRST_NM: usize = 360;
/// Step of [`MATCHING`], nm.
const STEP_NM: usize = 5;

/// Number of wavelengths, in whole nm from [`FIRST_NM`].
const WAVELENGTHS: usize = (MATCHING.len() - 1) * STEP_NM + 1;

/// Shift of the observer's curves towards the infrared, nm. In Radiance's sums the wavelength that
/// ends a band, and one more, count to the band below.
const SHIFT_NM: usize = 1;

/// Cumulative X, Y and Z of an equal-energy spectrum up to each whole wavelength, normalised to 1.
static CUMULATIVE: LazyLock<Vec<[f64; 3]>> = LazyLock::new(|| {
    let mut sum = [0.0; 3];
    let mut sums: Vec<[f64; 3]> = (0..WAVELENGTHS)
        .map(|index| {
            sum = std::array::from_fn(|i| sum[i] + matching(index)[i]);
            sum
        })
        .collect();
    sums.iter_mut().for_each(|row| *row = std::array::from_fn(|i| row[i] / sum[i]));
    sums
});

/// The colour matching functions at a whole wavelength, by the cubic through the four nearest table
/// points (Lagrange interpolation, as CIE 15:2018, 7.2.1 recommends).
fn matching(index: usize) -> [f64; 3] {
    let first = (index / STEP_NM).clamp(1, MATCHING.len() - 3) - 1;
    let x = index as f64 / STEP_NM as f64 - first as f64;
    let weight = |point: usize| -> f64 {
        (0..4).filter(|other| *other != point).map(|other| (x - other as f64) / (point as f64 - other as f64)).product()
    };
    let value = |component: usize| (0..4).map(|point| weight(point) * MATCHING[first + point][component]).sum::<f64>();
    std::array::from_fn(|component| value(component).max(0.0))
}

/// X, Y and Z of light that is 1 up to a wavelength in nm and 0 beyond, where equal-energy light
/// has 1, 1, 1. Counts whole nanometres, as Radiance does.
pub(crate) fn cumulative(wavelength_nm: f64) -> [f64; 3] {
    let index = wavelength_nm.max(0.0) as usize + SHIFT_NM;
    match index.checked_sub(FIRST_NM) {
        Some(index) => CUMULATIVE[index.min(WAVELENGTHS - 1)],
        None => [0.0; 3],
    }
}

/// x̄, ȳ and z̄ of the CIE 1931 2° standard observer in steps of 5 nm (CIE 15:2018, table T.4;
/// ISO/CIE 11664-1).
#[rustfmt::skip]
const MATCHING: [[f64; 3]; 95] = [
    [0.0001299, 3.917e-6, 0.0006061], [0.0002321, 6.965e-6, 0.001086], [0.0004149, 1.239e-5, 0.001946],
    [0.0007416, 2.202e-5, 0.003486], [0.001368, 3.9e-5, 0.00645], [0.002236, 6.4e-5, 0.01055],
    [0.004243, 0.00012, 0.02005], [0.00765, 0.000217, 0.03621], [0.01431, 0.000396, 0.06785],
    [0.02319, 0.00064, 0.1102], [0.04351, 0.00121, 0.2074], [0.07763, 0.00218, 0.3713],
    [0.13438, 0.004, 0.6456], [0.21477, 0.0073, 1.03905], [0.2839, 0.0116, 1.3856],
    [0.3285, 0.01684, 1.62296], [0.34828, 0.023, 1.74706], [0.34806, 0.0298, 1.7826],
    [0.3362, 0.038, 1.77211], [0.3187, 0.048, 1.7441], [0.2908, 0.06, 1.6692],
    [0.2511, 0.0739, 1.5281], [0.19536, 0.09098, 1.28764], [0.1421, 0.1126, 1.0419],
    [0.09564, 0.13902, 0.81295], [0.05795, 0.1693, 0.6162], [0.03201, 0.20802, 0.46518],
    [0.0147, 0.2586, 0.3533], [0.0049, 0.323, 0.272], [0.0024, 0.4073, 0.2123],
    [0.0093, 0.503, 0.1582], [0.0291, 0.6082, 0.1117], [0.06327, 0.71, 0.07825],
    [0.1096, 0.7932, 0.05725], [0.1655, 0.862, 0.04216], [0.22575, 0.91485, 0.02984],
    [0.2904, 0.954, 0.0203], [0.3597, 0.9803, 0.0134], [0.43345, 0.99495, 0.00875],
    [0.51205, 1.0, 0.00575], [0.5945, 0.995, 0.0039], [0.6784, 0.9786, 0.00275],
    [0.7621, 0.952, 0.0021], [0.8425, 0.9154, 0.0018], [0.9163, 0.87, 0.00165],
    [0.9786, 0.8163, 0.0014], [1.0263, 0.757, 0.0011], [1.0567, 0.6949, 0.001],
    [1.0622, 0.631, 0.0008], [1.0456, 0.5668, 0.0006], [1.0026, 0.503, 0.00034],
    [0.9384, 0.4412, 0.00024], [0.85445, 0.381, 0.00019], [0.7514, 0.321, 0.0001],
    [0.6424, 0.265, 5e-5], [0.5419, 0.217, 3e-5], [0.4479, 0.175, 2e-5],
    [0.3608, 0.1382, 1e-5], [0.2835, 0.107, 0.0], [0.2187, 0.0816, 0.0],
    [0.1649, 0.061, 0.0], [0.1212, 0.04458, 0.0], [0.0874, 0.032, 0.0],
    [0.0636, 0.0232, 0.0], [0.04677, 0.017, 0.0], [0.0329, 0.01192, 0.0],
    [0.0227, 0.00821, 0.0], [0.01584, 0.005723, 0.0], [0.0113592, 0.004102, 0.0],
    [0.00811092, 0.002929, 0.0], [0.00579035, 0.002091, 0.0], [0.00410946, 0.001484, 0.0],
    [0.00289933, 0.001047, 0.0], [0.00204919, 0.00074, 0.0], [0.00143997, 0.00052, 0.0],
    [0.000999949, 0.0003611, 0.0], [0.000690079, 0.0002492, 0.0], [0.000476021, 0.0001719, 0.0],
    [0.000332301, 0.00012, 0.0], [0.000234826, 8.48e-5, 0.0], [0.00016615, 6e-5, 0.0],
    [0.000117413, 4.24e-5, 0.0], [8.30753e-5, 3e-5, 0.0], [5.87065e-5, 2.12e-5, 0.0],
    [4.15099e-5, 1.499e-5, 0.0], [2.93533e-5, 1.06e-5, 0.0], [2.06738e-5, 7.4657e-6, 0.0],
    [1.45598e-5, 5.2578e-6, 0.0], [1.0254e-5, 3.7029e-6, 0.0], [7.22146e-6, 2.6078e-6, 0.0],
    [5.08587e-6, 1.8366e-6, 0.0], [3.58165e-6, 1.2934e-6, 0.0], [2.52252e-6, 9.1093e-7, 0.0],
    [1.77651e-6, 6.4153e-7, 0.0], [1.25114e-6, 4.5181e-7, 0.0],
];
