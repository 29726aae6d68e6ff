//! The mean over boxes of pixels.

use super::{Bar, Resampling};

/// The mean of the input pixels in an output pixel. `N` is the number of components, or 0 if only
/// `sums` knows it.
pub(super) fn put_box<const N: usize>(row: usize, column: usize, resampling: &Resampling, bar: &Bar, sums: &mut [f32]) {
    let components = if N == 0 { sums.len() } else { N };
    let sums = &mut sums[..components];
    let columns = resampling.inside(resampling.box_columns(column));
    let mut count = 0u32;
    sums.fill(0.0);
    for y in resampling.box_rows(row) {
        let scanline = bar.row(y);
        for x in columns.clone() {
            count += 1;
            let pixel = &scanline[resampling.wrapped(x) * components..][..components];
            sums.iter_mut().zip(pixel).for_each(|(sum, value)| *sum += value);
        }
    }
    if count > 1 {
        let scale = (1.0 / f64::from(count)) as f32;
        sums.iter_mut().for_each(|sum| *sum *= scale);
    }
}
