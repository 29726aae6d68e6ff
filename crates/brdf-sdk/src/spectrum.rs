//! Conversion of measured colours and spectra to the bands of a rendering.

use radsight_brdf_abi::Band;

/// Component of RGB data for a band: red (0), green (1) or blue (2). With three bands each has its
/// own component; otherwise the band's centre decides, with the limits of Radiance 6.
#[must_use]
pub fn rgb_of_band(bands: &[Band], band: usize) -> usize {
    const RED_FROM_M: f64 = 588e-9;
    const GREEN_FROM_M: f64 = 480e-9;
    match bands[band].centre_m {
        _ if bands.len() == 3 => band,
        centre if centre >= RED_FROM_M => 0,
        centre if centre >= GREEN_FROM_M => 1,
        _ => 2,
    }
}

/// Wavelengths (metres) that represent a band: its centre if it is narrower than 10 nm, otherwise
/// the centres of 8 equal parts.
#[must_use]
pub fn sample_band(band: &Band) -> Vec<f64> {
    const NARROW_M: f64 = 10e-9;
    const PARTS: u32 = 8;
    let width = band.high_m - band.low_m;
    if width < NARROW_M {
        return vec![band.centre_m];
    }
    (0..PARTS).map(|part| band.low_m + width * (f64::from(part) + 0.5) / f64::from(PARTS)).collect()
}
