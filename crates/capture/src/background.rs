//! What many pictures of nearly one scene have in common.
//!
//! A part on a large sheet changes the pixels that see it, its shadow or its light, and no others. The scene without the parts is exposed
//! once, and with it is found by which ways the light of each pixel came. A picture with parts then takes over every pixel whose ways pass
//! beside them, with its samples, and exposes the rest.

use crate::adaptive::{Pixel, SEQUENCE_LOG2};
use crate::checkpoint::{AdaptiveState, Checkpoint, State};
use crate::region::{LitRegion, Region};
use crate::{Exposer, Progress};
use radsight_pinhole::Rays;
use radsight_render::{Ray, Renderer};
use radsight_sampling::{DimensionSet, RaySampler};
use rayon::prelude::*;

/// Rays of each pixel whose ways are looked at. A pixel's neighbours count as well, so that nine times as many stand for it.
const WAYS_A_PIXEL: u64 = 4;

/// A scene without its moving parts, exposed.
#[derive(Clone, Debug)]
pub struct Background {
    state: AdaptiveState,
    /// For each pixel in scanline order.
    ways: Vec<Ways>,
}

/// Where the light of one pixel came along.
#[derive(Clone, Copy, Debug)]
struct Ways {
    /// What its rays crossed of where parts may be.
    crossed: Region,
    /// The points from which it looked for lights.
    lit: Region,
}

impl Ways {
    const NONE: Ways = Ways { crossed: Region::EMPTY, lit: Region::EMPTY };

    fn united(self, other: &Ways) -> Ways {
        Ways { crossed: self.crossed.united(&other.crossed), lit: self.lit.united(&other.lit) }
    }
}

impl Background {
    /// Exposes a scene without its parts to a relative error, as [`Exposer::to_error`] does. `told` answers the same rays by all the rays that
    /// come of them ([`RayTreeOutput::AllAndLit`](radsight_render::RayTreeOutput)); `within` is where parts will be.
    ///
    /// `None` where the work was stopped.
    #[must_use]
    pub fn expose(
        exposer: &Exposer<'_>,
        told: &Renderer,
        within: &Region,
        error: f64,
        progress: &dyn Progress,
    ) -> Option<Background> {
        let exposure = exposer.to_error(error, None, progress);
        let Checkpoint(State::Adaptive(state)) = exposure.checkpoint else { return None };
        if exposure.is_partial || progress.stops() {
            return None;
        }
        let ways = with_neighbours(&ways(exposer.rays, told, within), exposer.rays.camera().columns() as usize);
        Some(Background { state, ways })
    }

    /// From where a picture goes on that has parts in these regions, and lights relayed by their mirrors.
    #[must_use]
    pub fn with_parts(&self, parts: &[Region], relayed: &[LitRegion]) -> Checkpoint {
        let mut state = AdaptiveState { passes: 0, pending: Vec::new(), ..self.state.clone() };
        for (pixel, ways) in state.pixels.iter_mut().zip(&self.ways) {
            let is_met = parts.iter().any(|part| part.meets(&ways.crossed));
            if is_met || relayed.iter().any(|light| light.reaches(&ways.lit)) {
                *pixel = Pixel::default();
            }
        }
        Checkpoint(State::Adaptive(state))
    }
}

impl Checkpoint {
    /// How many pixels have no samples yet.
    #[must_use]
    pub fn unexposed_pixels(&self) -> usize {
        match &self.0 {
            State::Fixed(state) => state.values.iter().filter(|value| value.is_none()).count(),
            State::Adaptive(state) => state.pixels.iter().filter(|pixel| pixel.samples == 0).count(),
        }
    }
}

/// Follows some rays of each pixel.
fn ways(rays: &Rays, told: &Renderer, within: &Region) -> Vec<Ways> {
    (0..rays.camera().pixel_count() as usize)
        .into_par_iter()
        .with_min_len(32)
        .map_init(
            || told.worker(),
            |worker, pixel| {
                let (pixel, mut ways) = (pixel as u64, Ways::NONE);
                for sample in 0..WAYS_A_PIXEL {
                    let index = (pixel << SEQUENCE_LOG2) | sample;
                    let u = RaySampler::new(rays.seed(), index).take(DimensionSet::CAMERA);
                    let ray = rays.ray(pixel, u);
                    let Some(ray) = Ray::new(ray.origin, ray.direction) else { continue };
                    let (_, tree) = worker.tree(index, &ray);
                    let mut below = 0;
                    for told in tree {
                        let distance = told.hit.map_or(f64::INFINITY, |hit| hit.distance);
                        ways.crossed.add_segment(&told.ray, distance, within);
                        // What came of a ray stands before it. The camera's own ray ends where lights are looked for even if none came.
                        if (below > told.depth || told.depth == 0) && distance.is_finite() {
                            ways.lit.add(told.ray.at(distance));
                        }
                        below = told.depth;
                    }
                }
                ways
            },
        )
        .collect()
}

/// Each pixel's ways with those of the eight around it: what lies between the rays of a pixel lies between those of its neighbours.
fn with_neighbours(ways: &[Ways], columns: usize) -> Vec<Ways> {
    let near = |count: usize, index: usize| index.saturating_sub(1)..(index + 2).min(count);
    let rows = ways.len() / columns.max(1);
    let of_pixel = |pixel: usize| {
        let (row, column) = (pixel / columns, pixel % columns);
        let around = near(rows, row).flat_map(|row| near(columns, column).map(move |column| row * columns + column));
        around.fold(Ways::NONE, |united, pixel| united.united(&ways[pixel]))
    };
    (0..ways.len()).map(of_pixel).collect()
}
