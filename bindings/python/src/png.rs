//! Pictures as notebooks show them.

/// This share of the pixels is shown darker than white.
const SHOWN: f64 = 0.98;

/// Bytes of a PNG of 8 bits: radiances scaled so that few pixels are white, with a gamma of 2.2.
pub(crate) fn of_radiance(columns: usize, pixels: &[[f32; 3]]) -> Option<Vec<u8>> {
    let mut brightness: Vec<f32> = pixels.iter().map(|pixel| pixel.iter().sum::<f32>() / 3.0).collect();
    if brightness.is_empty() {
        return None;
    }
    let place = ((brightness.len() - 1) as f64 * SHOWN) as usize;
    let white = brightness.select_nth_unstable_by(place, f32::total_cmp).1.max(f32::MIN_POSITIVE);
    let shown = |value: f32| (255.0 * (value / white).clamp(0.0, 1.0).powf(1.0 / 2.2) + 0.5) as u8;
    radsight::png_rgb8(columns, pixels.iter().flatten().map(|value| shown(*value)).collect())
}
