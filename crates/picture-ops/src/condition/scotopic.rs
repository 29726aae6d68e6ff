//! Mesopic colours, which lose saturation where rods dominate.

use super::luminance::{Luminance, SCOTOPIC_WHITE};
use super::{MESOPIC, TINY};

/// The share of cones in vision at a luminance in cd/m²; the rest is the share of rods.
pub(crate) fn cones(luminance: f64) -> f64 {
    ((luminance - MESOPIC[0]) / (MESOPIC[1] - MESOPIC[0])).clamp(0.0, 1.0)
}

/// Mixes a colour with the grey that rods see, by its luminance.
pub(super) fn fade(pixel: &mut [f32; 3], luminance: &Luminance) {
    let world = luminance.of(*pixel);
    let color = cones(world);
    if color >= 1.0 - TINY {
        return;
    }
    let rods = luminance.scotopic(*pixel) * luminance.exposure / SCOTOPIC_WHITE / luminance.efficacy();
    let grey = ((1.0 - color) * rods) as f32;
    *pixel = pixel.map(|value| if color <= TINY { grey } else { (f64::from(value) * color) as f32 + grey });
}
