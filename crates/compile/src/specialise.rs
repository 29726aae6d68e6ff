//! Specialises a texture construction by its effect, not by its text.
//!
//! Radiance has no retroreflector. The paper makes one from a `texfunc` that turns the normal to
//! the viewer under a rough highlight: "in effect, the mirror direction is always back in the
//! direction of the viewer" (section 3.2). Whatever the expressions are, they have this effect if
//! the perturbed normal is the reversed ray direction for every ray.

use glam::DVec3;
use radsight_cal::Scratch;
use radsight_ir::Scene;
use radsight_texture::{Appearance, Step, SurfaceInteraction, TextureChain};
use std::f64::consts::TAU;

/// Number of test rays. A texture that differs on a set of positive measure is found almost surely.
const TRIALS: u32 = 64;

/// Largest distance of the perturbed normal from the viewer's direction.
const TOLERANCE: f64 = 1e-9;

/// Whether textures turn the normal to the viewer for every ray.
pub(crate) fn turns_the_normal_to_the_viewer(chain: &TextureChain) -> bool {
    let steps = chain.steps.iter().filter(|step| matches!(step, Step::Texture(_))).cloned().collect();
    let textures = TextureChain { steps, ..chain.clone() };
    let nowhere = Scene::default();
    let mut scratch = Scratch::default();
    (0..TRIALS).all(|trial| {
        let interaction = trial_interaction(trial);
        let Appearance { perturbation, .. } = textures.appearance::<1>(&nowhere, &interaction, &mut scratch);
        let turned = (interaction.normal + perturbation).normalize_or_zero();
        turned.distance(-interaction.direction) < TOLERANCE
    })
}

/// An interaction with direction, normal and point from a low-discrepancy sequence (an additive
/// recurrence, which never repeats).
fn trial_interaction(trial: u32) -> SurfaceInteraction {
    let coordinate = |index: u32| {
        let alpha = [0.754_877_666, 0.569_840_291, 0.430_159_709, 0.819_172_513, 0.671_043_607, 0.549_700_478];
        (f64::from(trial + 1) * alpha[(index % 6) as usize] + 0.5 + 0.137 * f64::from(index / 6)).fract()
    };
    let unit = |first: u32| {
        let z = 2.0 * coordinate(first) - 1.0;
        let (sin, cos) = (TAU * coordinate(first + 1)).sin_cos();
        let rim = (1.0 - z * z).sqrt();
        DVec3::new(rim * cos, rim * sin, z)
    };
    let direction = unit(0);
    let normal = unit(2);
    let cosine = -direction.dot(normal);
    let scale = 10f64.powf(4.0 * coordinate(6) - 2.0);
    SurfaceInteraction {
        direction,
        normal: if cosine < 0.0 { -normal } else { normal },
        point: DVec3::new(coordinate(4), coordinate(5), coordinate(7)) * scale,
        total_distance: scale * (1.0 + coordinate(8)),
        distance: scale * coordinate(8),
        cosine: cosine.abs(),
        behind: false,
        instance: None,
    }
}
