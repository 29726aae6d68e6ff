//! The common background of many pictures of nearly the same scene.
//!
//! A part on a large sheet changes the pixels that see the part, its shadow or its reflected light,
//! and no others. The scene without parts is exposed once, and the bounds of the light paths of
//! each pixel are stored. A picture with parts then copies the samples of every pixel whose paths
//! miss the parts, and exposes the rest. Where pixels are interpolated or share rays, it copies those
//! of the lattice.

use crate::checkpoint::{AdaptiveState, Checkpoint, State};
use crate::film::UnblurredFilm;
use crate::neighbourhood::around;
use crate::region::{LitRegion, Region};
use crate::shared_film::{FilmRecord, KnownFilm, SharedFilm};
use crate::sums::Pixel;
use crate::{Exposer, Exposure, Progress};
use radsight_adaptive::{ErrorTarget, ray_number};
use radsight_pinhole::Rays;
use radsight_render::{Ray, Renderer};
use radsight_sampling::{DimensionSet, RaySampler};
use rayon::prelude::*;

/// Rays traced per pixel to find its light paths. The paths of neighbouring pixels count as well,
/// so each pixel has nine times as many.
const PATHS_PER_PIXEL: u32 = 2;

/// The exposed scene without its moving parts.
#[derive(Clone, Debug)]
pub struct Background {
    /// The samples of the picture.
    pixels: Vec<Pixel>,
    /// Of its film; empty if it was not interpolated.
    record: FilmRecord,
    /// For each pixel of the recorded film, or else of the picture, in scanline order.
    path_bounds: Vec<PathBounds>,
}

/// Where the parts of a picture are.
#[derive(Clone, Copy, Debug)]
pub struct PlacedParts<'a> {
    /// Boxes around them.
    pub parts: &'a [Region],
    /// The images of lights in their mirrors.
    pub virtual_sources: &'a [LitRegion],
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
        let recorded = SharedFilm::Recorded(Box::default());
        let (exposure, record) = exposer.shared_to_error(target, AdaptiveState::default(), recorded, progress);
        let Checkpoint(State::Adaptive { state, .. }) = exposure.checkpoint else { return None };
        if exposure.is_partial || progress.stops() {
            return None;
        }
        let film = record.film.as_deref();
        let columns = film.map_or(exposer.rays.camera().columns() as usize, |film| film.size()[0]);
        let path_bounds = with_neighbours(&path_bounds((exposer.rays, film), ray_tree, within), columns);
        Some(Background { pixels: state.pixels, record, path_bounds })
    }

    /// Exposes the scene with its parts to a relative error, as [`Exposer::to_error`] does. Pixels
    /// that the parts do not affect have the samples of the background.
    #[must_use]
    pub fn expose_with_parts(
        &self,
        exposer: &Exposer<'_>,
        placed: PlacedParts<'_>,
        target: ErrorTarget,
        progress: &dyn Progress,
    ) -> Exposure {
        let is_affected: Vec<bool> = self.path_bounds.iter().map(|bounds| placed.affect(bounds)).collect();
        let film = self.record.film.as_ref();
        let is_picture_affected = film.map_or_else(|| is_affected.clone(), |film| film.blurred_marks(&is_affected));
        let (record, picture) = (&self.record, &self.pixels[..]);
        let known = KnownFilm { record, picture, is_affected, is_picture_affected };
        exposer.shared_to_error(target, AdaptiveState::default(), SharedFilm::Known(known), progress).0
    }
}

impl PlacedParts<'_> {
    /// Whether light along these paths may meet the parts.
    fn affect(&self, bounds: &PathBounds) -> bool {
        let is_met = self.parts.iter().any(|part| part.meets(&bounds.crossed));
        let is_lit = |sphere| self.virtual_sources.iter().any(|source| source.reaches(sphere));
        is_met || bounds.lit.sphere().is_some_and(is_lit)
    }
}

/// Traces some rays of each pixel, of a film or of the picture, and bounds their paths.
fn path_bounds((rays, film): (&Rays, Option<&UnblurredFilm>), ray_tree: &Renderer, within: &Region) -> Vec<PathBounds> {
    let count = film.map_or(rays.camera().pixel_count() as usize, UnblurredFilm::pixel_count);
    (0..count)
        .into_par_iter()
        .with_min_len(32)
        .map_init(
            || ray_tree.worker(),
            |worker, pixel| {
                let (number, mut bounds) = (pixel as u64, PathBounds::NONE);
                for sample in 0..PATHS_PER_PIXEL {
                    let index = ray_number(number, sample);
                    let u = RaySampler::new(rays.seed(), index).take(DimensionSet::CAMERA);
                    let ray = match film {
                        Some(film) => film.sampled_ray(rays, pixel, u).map(|on_film| on_film.ray),
                        None => Some(rays.ray(number, u)),
                    };
                    let Some(ray) = ray.and_then(|ray| Ray::new(ray.origin, ray.direction)) else { continue };
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
