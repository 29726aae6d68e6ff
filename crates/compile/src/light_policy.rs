//! Number of lights sampled at a point.

use crate::direct_threshold::DirectThreshold;
use crate::options::{LightDivision, Quantity, RenderOptions, Uncached};
use radsight_light::{Light, LightTree};

/// Up to `all` lights every light is sampled; of more, `draws` are selected.
#[derive(Clone, Copy, Debug)]
struct LightSelectionPolicy {
    all: usize,
    draws: u32,
}

/// Policy at points seen from the eye, and on paths that were scattered before. Many such points
/// share a pixel. With 16 to 100,000 lights these numbers gave about the least error for the time.
const SELECTION: [LightSelectionPolicy; 2] =
    [LightSelectionPolicy { all: 24, draws: 8 }, LightSelectionPolicy { all: 12, draws: 4 }];

/// Policy at the first surface of a ray whose value counts by itself: no pixel averages its
/// selections.
const SPLIT_SELECTION: LightSelectionPolicy = LightSelectionPolicy { all: 128, draws: 64 };

/// Policy if pixels have few rays, and so each ray's noise shows. Shadow rays are then selected by what
/// samples would contribute, which knows more than the light tree: how lights shine in a direction, and
/// where their images in mirrors are visible. Of more lights, the tree selects some, in inverse
/// proportion to the threshold of direct light (`-dt`); this is its number for the default threshold.
const FEW_RAYS_SELECTION: LightSelectionPolicy = LightSelectionPolicy { all: 2048, draws: 32 };

/// The limits of that number.
const DRAWS_BY_THRESHOLD: [f64; 2] = [8.0, 1024.0];

/// Number of virtual images that count as one light: most images are invisible from most points.
const IMAGES_FOR_ONE: usize = 3;

/// Up to this number of lights, every light is sampled.
pub(crate) const ALWAYS_ALL: usize = SELECTION[1].all;

/// Number of lights selected at a point seen from the eye, and on a path that was scattered before.
/// Zero means that every light is sampled: if there are few, or if each light's contribution is
/// reported.
pub(crate) fn light_draws(lights: &[Light], tree: Option<&LightTree>, options: &RenderOptions) -> [u32; 2] {
    let real = lights.partition_point(|light| light.virtual_sources.is_empty());
    let like_lights = real + (lights.len() - real) / IMAGES_FOR_ONE;
    let samples_all = tree.is_none() || !options.tracked_modifiers.is_empty() || options.ray_tree.is_some();
    let first = match options.light_division {
        _ if splits_first(options) => SPLIT_SELECTION,
        LightDivision::BySize(_) | LightDivision::Shared(_) => {
            let draws = f64::from(FEW_RAYS_SELECTION.draws) / options.direct_threshold.relative();
            let [fewest, most] = DRAWS_BY_THRESHOLD;
            LightSelectionPolicy { draws: draws.clamp(fewest, most) as u32, ..FEW_RAYS_SELECTION }
        }
        LightDivision::Whole => SELECTION[0],
    };
    let first = if tests_all(options) { LightSelectionPolicy { all: usize::MAX, ..first } } else { first };
    [first, SELECTION[1]]
        .map(|LightSelectionPolicy { all, draws }| if samples_all || like_lights <= all { 0 } else { draws })
}

/// Whether all lights are requested at the first surface (`-dt 0`) of rays of which a pixel has few.
fn tests_all(options: &RenderOptions) -> bool {
    let has_few_rays = splits_first(options) || !matches!(options.light_division, LightDivision::Whole);
    has_few_rays && options.direct_threshold == DirectThreshold::EXACT
}

/// Whether the first surface's selections are final, because no other rays average them: at
/// sensors, and where the ray splits.
fn splits_first(options: &RenderOptions) -> bool {
    let is_sensor = options.quantity != Quantity::Radiance;
    let splits = options.ambient_bounces > 0 && options.gathering.accuracy == 0.0;
    options.gathering.uncached == Uncached::Split && (is_sensor || splits)
}
