//! Radiance of emitters.

use crate::shader::{Emitter, Shader};
use radsight_cal::Scratch;
use radsight_ir::Scene;
use radsight_texture::{SurfaceInteraction, bands, luminance, product};

/// Radiance that an emitter sends back along the ray, W/(sr·m²).
pub fn emission<const BANDS: usize>(
    scene: &Scene,
    shader: &Shader,
    emitter: &Emitter,
    interaction: &SurfaceInteraction,
    scratch: &mut Scratch,
) -> [f64; BANDS] {
    if let Some((cos_half_angle, axis)) = emitter.cone
        && -interaction.direction.dot(axis) < cos_half_angle
    {
        return [0.0; BANDS];
    }
    let own = bands(emitter.radiance);
    if shader.textures.steps.is_empty() {
        return own;
    }
    product(own, shader.appearance::<BANDS>(scene, interaction, scratch).color)
}

/// Radiance of an emitter that sends the same in all directions; `None` for others.
#[inline]
pub fn uniform_emission<const BANDS: usize>(shader: &Shader, emitter: &Emitter) -> Option<[f64; BANDS]> {
    (emitter.cone.is_none() && shader.textures.steps.is_empty()).then(|| bands(emitter.radiance))
}

/// Radiance of a light where light sampling evaluates it: a negative value counts as zero. A
/// pattern may be negative beyond the ends of its table. View rays still see the negative value, as
/// in Radiance.
pub fn given<const BANDS: usize>(emission: [f64; BANDS]) -> [f64; BANDS] {
    if luminance(&emission) > 0.0 { emission } else { [0.0; BANDS] }
}
