//! How many lights are sampled at a point.

use crate::options::{LightDivision, Quantity, RenderOptions, Uncached};
use radsight_light::Light;

/// Up to so many lights each one is sampled at every point; of more, so many are drawn.
#[derive(Clone, Copy, Debug)]
struct LightSelectionPolicy {
    all: usize,
    draws: u32,
}

/// Where a path is seen from the eye, and where it was scattered before: many such places share a pixel. From 16 to 100,000 lights so many draws gave
/// about the least error for the time.
const SELECTION: [LightSelectionPolicy; 2] =
    [LightSelectionPolicy { all: 24, draws: 8 }, LightSelectionPolicy { all: 12, draws: 4 }];

/// Where a ray that counts by itself meets its first surface: no pixel averages what is drawn
/// there.
const SPLIT_SELECTION: LightSelectionPolicy = LightSelectionPolicy { all: 128, draws: 64 };

/// Where a pixel has few rays.
const DIVIDED_SELECTION: LightSelectionPolicy = LightSelectionPolicy { all: 32, draws: 32 };

/// So many images of lights count as one light: from most places most of them are not seen.
const IMAGES_FOR_ONE: usize = 3;

/// With no more lights than this there is never a choice.
pub(crate) const ALWAYS_ALL: usize = SELECTION[1].all;

/// How many lights are drawn at a point that is seen from the eye, and at one on a path that was scattered before; 0 where each is sampled: where few
/// are, and where it is asked what each of them gives.
pub(crate) fn light_draws(lights: &[Light], has_tree: bool, options: &RenderOptions) -> [u32; 2] {
    let real = lights.partition_point(|light| light.virtual_sources.is_empty());
    let like_lights = real + (lights.len() - real) / IMAGES_FOR_ONE;
    let samples_all = !has_tree || !options.tracked_modifiers.is_empty() || options.ray_tree.is_some();
    let first = match options.light_division {
        _ if splits_first(options) => SPLIT_SELECTION,
        LightDivision::BySize => DIVIDED_SELECTION,
        LightDivision::Whole => SELECTION[0],
    };
    [first, SELECTION[1]]
        .map(|LightSelectionPolicy { all, draws }| if samples_all || like_lights <= all { 0 } else { draws })
}

/// Whether no others are drawn in the place of what is drawn where a ray meets its first surface:
/// at sensors, and where it splits.
fn splits_first(options: &RenderOptions) -> bool {
    let is_sensor = options.quantity != Quantity::Radiance;
    let splits = options.ambient_bounces > 0 && options.gathering.accuracy == 0.0;
    options.gathering.uncached == Uncached::Split && (is_sensor || splits)
}
