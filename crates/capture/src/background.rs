//! The common background of many pictures of nearly the same scene.
//!
//! A part on a large sheet changes the pixels that see the part, its shadow or its reflected light,
//! and no others. The scene without parts is exposed once, and the bounds of the light paths of
//! each pixel are stored. A picture with parts then copies the samples of every pixel whose paths
//! miss the parts, and exposes the rest.

use crate::adaptive::Pixel;
use crate::checkpoint::{AdaptiveState, Checkpoint, State};
use crate::neighbourhood::around;
use crate::region::{LitRegion, Region};
use crate::{Exposer, Progress};
use radsight_adaptive::{ErrorTarget, ray_number};
use radsight_pinhole::Rays;
use radsight_render::{Ray, Renderer};
use radsight_sampling::{DimensionSet, RaySampler};
use rayon::prelude::*;

/// Rays traced per pixel to find its light paths. The paths of neighbouring pixels count as well,
/// so each pixel has nine times as many.
const PATHS_PER_PIXEL: u32 = 4;

/// The exposed scene without its moving parts.
#[derive(Clone, Debug)]
pub struct Background {
    state: AdaptiveState,
    /// Number of separate bands.
    bands: usize,
    /// For each pixel in scanline order.
    path_bounds: Vec<PathBounds>,
}

/// Bounds of the light paths of one pixel.
#[derive(Clone, Copy, Debug)]
struct PathBounds {
    /// Where its rays crossed the region of the parts.
    crossed: Region,
    /// The points from which lights were sampled.
    lit: Region,
}

impl PathBounds {
    const NONE: PathBounds = PathBounds { crossed: Region::EMPTY, lit: Region::EMPTY };

    fn union(self, other: &PathBounds) -> PathBounds {
        PathBounds { crossed: self.crossed.union(&other.crossed), lit: self.lit.union(&other.lit) }
    }
}

impl Background {
    /// Exposes a scene without its parts to a relative error, as [`Exposer::to_error`] does.
    /// `ray_tree` is a renderer of the same scene that returns all rays of a tree
    /// ([`RayTreeOutput::AllAndLit`](radsight_render::RayTreeOutput)). `within` contains all
    /// possible positions of parts.
    ///
    /// `None` if the work was stopped.
    #[must_use]
    pub fn expose(
        exposer: &Exposer<'_>,
        ray_tree: &Renderer,
        within: &Region,
        target: ErrorTarget,
        progress: &dyn Progress,
    ) -> Option<Background> {
        let exposure = exposer.to_error(target, None, progress);
        let Checkpoint(State::Adaptive { state, bands }) = exposure.checkpoint else { return None };
        if exposure.is_partial || progress.stops() {
            return None;
        }
        let path_bounds =
            with_neighbours(&path_bounds(exposer.rays, ray_tree, within), exposer.rays.camera().columns() as usize);
        Some(Background { state, bands, path_bounds })
    }

    /// The state from which a picture with parts in these regions starts. `virtual_sources` are
    /// the images of lights in their mirrors.
    #[must_use]
    pub fn with_parts(&self, parts: &[Region], virtual_sources: &[LitRegion]) -> Checkpoint {
        let mut state = AdaptiveState { passes: 0, pending: Vec::new(), ..self.state.clone() };
        for (pixel, bounds) in state.pixels.iter_mut().zip(&self.path_bounds) {
            let is_met = parts.iter().any(|part| part.meets(&bounds.crossed));
            if is_met || virtual_sources.iter().any(|source| source.reaches(&bounds.lit)) {
                *pixel = Pixel::default();
            }
        }
        Checkpoint(State::Adaptive { state, bands: self.bands })
    }
}

impl Checkpoint {
    /// Number of pixels without samples.
    #[must_use]
    pub fn unexposed_pixels(&self) -> usize {
        match &self.0 {
            State::Fixed(state) => state.values.iter().filter(|value| value.is_none()).count(),
            State::Adaptive { state, .. } => state.pixels.iter().filter(|pixel| pixel.samples == 0).count(),
        }
    }
}

/// Traces some rays of each pixel and bounds their paths.
fn path_bounds(rays: &Rays, ray_tree: &Renderer, within: &Region) -> Vec<PathBounds> {
    (0..rays.camera().pixel_count() as usize)
        .into_par_iter()
        .with_min_len(32)
        .map_init(
            || ray_tree.worker(),
            |worker, pixel| {
                let (pixel, mut bounds) = (pixel as u64, PathBounds::NONE);
                for sample in 0..PATHS_PER_PIXEL {
                    let index = ray_number(pixel, sample);
                    let u = RaySampler::new(rays.seed(), index).take(DimensionSet::CAMERA);
                    let ray = rays.ray(pixel, u);
                    let Some(ray) = Ray::new(ray.origin, ray.direction) else { continue };
                    let (_, tree) = worker.tree(index, &ray);
                    let mut below = 0;
                    for node in tree {
                        let distance = node.hit.map_or(f64::INFINITY, |hit| hit.distance);
                        bounds.crossed.add_segment(&node.ray, distance, within);
                        // The children of a ray are listed before it. Lights are sampled at the end
                        // of the camera ray, even if none contributes.
                        if (below > node.depth || node.depth == 0) && distance.is_finite() {
                            bounds.lit.add(node.ray.at(distance));
                        }
                        below = node.depth;
                    }
                }
                bounds
            },
        )
        .collect()
}

/// Unites the bounds of each pixel with those of its eight neighbours: what lies between the rays
/// of a pixel lies between the rays of its neighbours.
fn with_neighbours(path_bounds: &[PathBounds], columns: usize) -> Vec<PathBounds> {
    let size = [columns, path_bounds.len() / columns.max(1)];
    let of_pixel = |pixel: usize| around(pixel, size).fold(PathBounds::NONE, |sum, near| sum.union(&path_bounds[near]));
    (0..path_bounds.len()).map(of_pixel).collect()
}
