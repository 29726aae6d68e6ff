//! Lights in interpolated pictures, drawn by the part of each pixel that they cover.
//!
//! A lamp of a few pixels is missed by most samples of a coarse grid, and few samples find the edge
//! of a larger one. Radiance's `rpict` draws small lights after the rest of the picture
//! (`drawsources`); this file does so for the edges of all. The outlines of emitters and of their
//! images are projected onto the film. In each pixel that an edge crosses, or that a narrow light
//! covers, rays to points of the outline find how much of the light is visible, and its radiance. A
//! pixel is the sum of the visible lights and of the rest, weighted by the areas that they cover.
//!
//! The samples of these pixels, from which the rest is interpolated, pass beside the outlines or
//! meet what hides the light, so that nothing counts twice. Whether an image is drawn is decided by
//! other rays than those that measure how much of it is visible: the same rays would draw what they
//! happen to meet in full, and leave what they miss to the samples, which meet it once more.

use crate::light_strata::{MIN_COVER, disjoint};
use crate::projection::{Cover, PixelSquare, Visit, images, projected, projected_hole, visit_touched};
use crate::section::{ConvexPolygon, Partition, Sections};
use crate::view_camera::{CameraRay, ViewCamera, traced};
use glam::DVec2;
use radsight_render::{LightImage, Lights, Ray, RayWorker, Renderer};
use radsight_sampling::{DimensionSet, RaySampler};
use rayon::prelude::*;
use std::collections::HashMap;
use std::ops::Range;

/// Lights are drawn if there are at most so many of them, and at most so many parts of pixels that
/// they cover: relative to the number of pixels, and in any picture. More are found by chance.
const MOST_LIGHTS: f64 = 0.25;
const FEW_LIGHTS: usize = 1 << 10;

/// Rays to points of a light in a pixel, powers of two: of an outline that the light fills, and of
/// one around a hole.
const RAYS: u64 = 4;
const RAYS_AROUND_A_HOLE: u64 = 16;

/// An image is drawn unless at least so many rays miss it, and `RAYS` in each pixel.
const LEAST_TRIALS: u64 = 32;

/// Ray numbers of a pixel, as a power of two, and their offset.
const NUMBERS_LOG2: u32 = 20;
const DRAWN: u64 = 1 << 63;
const TRIALS: u64 = DRAWN | 1 << 62;

/// How far points of an outline are moved towards its middle, as a fraction of the way: the corners
/// of a polygon around a circle stand out by .12 % of its radius. Outlines that are exact need no more
/// than a part of a pixel, against rounding; the middle of a wide light is hundreds of pixels away.
const INWARDS: f64 = 0.0013;
const INWARDS_OF_EXACT: f64 = 0.05;

/// The samples of a pixel pass beside lights unless they cover more than this fraction of it.
const MOST_COVERED: f64 = 0.995;

/// The drawn lights of a picture.
#[derive(Debug, Default)]
pub(crate) struct DrawnLights {
    /// With the number of each pixel.
    pixels: Vec<(usize, DrawnPixel)>,
    /// By the number of a pixel: one more than its index in `pixels`, or 0. Empty without lights.
    places: Vec<u32>,
}

/// The lights in a pixel.
#[derive(Debug)]
struct DrawnPixel {
    /// The sum of their radiances, weighted by the visible areas.
    light: [f64; 3],
    /// The visible area of all lights, as a fraction of the pixel.
    covered: f64,
    rest: Rest,
}

/// What a pixel shows besides lights.
#[derive(Debug)]
enum Rest {
    /// What lies outside the outlines.
    Beside(Partition),
    /// What hides the lights where their outlines cover all of the pixel: points that show it.
    Behind(Vec<[f64; 2]>),
    Nothing,
}

impl Rest {
    /// A point of the pixel that shows no light, for a point of the unit square.
    fn point(&self, [u, v]: [f64; 2]) -> Option<[f64; 2]> {
        match self {
            Rest::Beside(partition) => partition.outside([u, v]),
            Rest::Behind(points) => points.get((u * points.len() as f64) as usize).copied(),
            Rest::Nothing => None,
        }
    }
}

/// The part of a pixel that the outline of a light covers.
struct Piece {
    /// In the unit square of the pixel.
    outline: ConvexPolygon,
    /// The middle of the whole outline, in coordinates of the unit square.
    middle: DVec2,
    image: usize,
}

impl DrawnLights {
    /// Finds the lights of a picture. Those whose images are at most `widest` pixels wide may be
    /// missed by all samples, and are drawn inside as well. There are none with an aperture, in
    /// motion, and where lights are invisible.
    pub(crate) fn find(renderer: &Renderer, camera: &ViewCamera, widest: f64) -> DrawnLights {
        let plan = renderer.plan();
        if camera.is_blurred() || plan.lights_seen() == Lights::Invisible {
            return DrawnLights::default();
        }
        let most = FEW_LIGHTS.max((MOST_LIGHTS * (camera.columns() * camera.rows()) as f64) as usize);
        let images = images(plan, camera, most);
        let pieces: Vec<Vec<(usize, Piece)>> = (images.par_iter().enumerate().with_min_len(64))
            .map(|(index, image)| pieces(camera, index, image, widest))
            .collect();
        if pieces.iter().map(Vec::len).sum::<usize>() > most {
            return DrawnLights::default();
        }
        let camera = &camera.whole_pixels();
        let search = Search { renderer, camera, images: &images };
        let seen: Vec<Vec<(usize, Piece)>> = pieces.into_par_iter().filter(|pieces| search.sees_any(pieces)).collect();
        let mut by_pixel: HashMap<usize, Vec<Piece>> = HashMap::new();
        for (pixel, piece) in seen.into_iter().flatten() {
            by_pixel.entry(pixel).or_default().push(piece);
        }
        let drawn = |worker: &mut RayWorker<'_>, (pixel, pieces): (usize, Vec<Piece>)| {
            (pixel, search.drawn(worker, pixel, &pieces))
        };
        let pixels = by_pixel.into_par_iter().map_init(|| renderer.worker(), drawn).collect();
        DrawnLights::of_pixels(pixels, camera.columns() * camera.rows())
    }

    /// The lights of some pixels of a picture of `count`.
    fn of_pixels(pixels: Vec<(usize, DrawnPixel)>, count: usize) -> DrawnLights {
        let mut places = vec![0; if pixels.is_empty() { 0 } else { count }];
        for (place, (pixel, _)) in pixels.iter().enumerate() {
            places[*pixel] = place as u32 + 1;
        }
        DrawnLights { pixels, places }
    }

    /// The ray of a sample of a pixel.
    pub(crate) fn ray_beside(
        &self,
        camera: &ViewCamera,
        column: usize,
        row: usize,
        sampler: &RaySampler,
    ) -> Option<CameraRay> {
        let Some(drawn) = self.of(camera, column, row) else { return camera.ray(column, row, sampler) };
        let [x, y, ..] = sampler.take(DimensionSet::CAMERA);
        let Some(at) = drawn.rest.point([x, y]) else { return camera.ray(column, row, sampler) };
        camera.whole_pixels().still_ray(column, row, at)
    }

    /// The ray through the middle of a pixel, or of what lights leave of it.
    pub(crate) fn central_ray_beside(&self, camera: &ViewCamera, column: usize, row: usize) -> Option<CameraRay> {
        let at = self.of(camera, column, row).and_then(|drawn| drawn.rest.point([0.5, 0.5]));
        let Some(at) = at else { return camera.central_ray(column, row) };
        camera.whole_pixels().still_ray(column, row, at)
    }

    /// Whether lights cover all of a pixel.
    pub(crate) fn cover(&self, camera: &ViewCamera, column: usize, row: usize) -> bool {
        self.of(camera, column, row).is_some_and(|drawn| matches!(drawn.rest, Rest::Nothing))
    }

    /// Whether any are drawn in a pixel.
    pub(crate) fn are_in(&self, camera: &ViewCamera, column: usize, row: usize) -> bool {
        self.of(camera, column, row).is_some()
    }

    fn of(&self, camera: &ViewCamera, column: usize, row: usize) -> Option<&DrawnPixel> {
        let place = *self.places.get(row * camera.columns() + column)?;
        self.pixels.get((place as usize).checked_sub(1)?).map(|(_, drawn)| drawn)
    }

    /// Adds the lights to the pixels of some rows.
    pub(crate) fn draw(&self, pixels: &mut [[f32; 3]], camera: &ViewCamera, rows: &Range<usize>) {
        let first = rows.start * camera.columns();
        for (pixel, drawn) in &self.pixels {
            let value = pixel.checked_sub(first).and_then(|index| pixels.get_mut(index));
            if let Some(value) = value {
                let share = (1.0 - drawn.covered).max(0.0);
                *value = std::array::from_fn(|band| (share * f64::from(value[band]) + drawn.light[band]) as f32);
            }
        }
    }
}

/// The pixels that an image covers, or partly covers if it is wide. Pixels in its hole are left out.
fn pieces(camera: &ViewCamera, index: usize, image: &LightImage, widest: f64) -> Vec<(usize, Piece)> {
    let Some(outline) = projected(camera, image) else { return Vec::new() };
    let hole = projected_hole(camera, image).unwrap_or_default();
    let [low, high] = outline.bounds();
    let band = if hole.corners().is_empty() { outline.width() } else { 0.5 * (outline.width() - hole.width()) };
    let is_narrow = band <= widest || outline.width() <= widest;
    let mut found = Vec::new();
    let visit = |column: usize, row: usize| {
        let square = PixelSquare::new(column, row, 1.0);
        if square.is_within(&hole) {
            return Visit::SkipRow;
        }
        let part = match square.cover(&outline) {
            Cover::Nothing => return Visit::GoOn,
            Cover::Part(part) => part,
            Cover::All if is_narrow => ConvexPolygon::square(),
            Cover::All => return Visit::SkipRow,
        };
        if part.area() > MIN_COVER {
            let piece = Piece { outline: part, middle: square.upright(0.5 * (low + high)), image: index };
            found.push((row * camera.columns() + column, piece));
        }
        Visit::GoOn
    };
    visit_touched(&outline, (0..camera.columns(), 0..camera.rows()), visit);
    found
}

/// The search for visible lights.
struct Search<'s> {
    renderer: &'s Renderer,
    /// With rays over whole pixels.
    camera: &'s ViewCamera,
    images: &'s [LightImage],
}

/// A point of the outline of a piece, and whether the light is visible there.
struct Trial {
    /// The number of the ray.
    index: u64,
    /// In the unit square of the pixel.
    at: DVec2,
    ray: Ray,
    camera_ray: CameraRay,
    shows_light: bool,
}

impl Search<'_> {
    /// Whether some rays to the pieces of an image, with their pixels, meet it.
    fn sees_any(&self, pieces: &[(usize, Piece)]) -> bool {
        let rays = RAYS.max(LEAST_TRIALS.div_ceil(pieces.len().max(1) as u64)).next_power_of_two();
        pieces.iter().any(|(pixel, piece)| {
            let first = TRIALS | (*pixel as u64) << NUMBERS_LOG2;
            self.trials(first..first + rays, *pixel, piece).any(|trial| trial.shows_light)
        })
    }

    /// The lights in a pixel, by other rays than those that saw their images.
    fn drawn(&self, worker: &mut RayWorker<'_>, pixel: usize, pieces: &[Piece]) -> DrawnPixel {
        let (mut light, mut covered) = ([0.0; 3], 0.0);
        let mut hidden = Vec::new();
        for (number, piece) in pieces.iter().enumerate() {
            let image = &self.images[piece.image];
            let rays = if image.hole.is_empty() { RAYS } else { RAYS_AROUND_A_HOLE };
            let first = DRAWN | (pixel as u64) << NUMBERS_LOG2 | (number as u64 * RAYS_AROUND_A_HOLE);
            let (visible, others): (Vec<Trial>, Vec<Trial>) =
                self.trials(first..first + rays, pixel, piece).partition(|trial| trial.shows_light);
            hidden.extend(others);
            let radiance = visible.iter().find_map(|trial| traced(worker, trial.index, &trial.camera_ray));
            let Some(radiance) = radiance else { continue };
            let share = visible.len() as f64 / rays as f64 * piece.outline.area() * image.share_of_outline;
            light = std::array::from_fn(|band| light[band] + share * radiance.value[band]);
            covered += share;
        }
        DrawnPixel { light, covered, rest: self.rest(pieces, &hidden) }
    }

    /// What a pixel shows besides the lights of its pieces; `hidden` shows none of one of them.
    fn rest(&self, pieces: &[Piece], hidden: &[Trial]) -> Rest {
        let outlines = pieces.iter().map(|piece| piece.outline.clone()).collect();
        if let Some(partition) = disjoint(outlines, MOST_COVERED).and_then(|outlines| Partition::new(&outlines)) {
            return Rest::Beside(partition);
        }
        let shows_other = |trial: &Trial| {
            let sees = |piece: &Piece| self.images[piece.image].may_be_seen_by(self.renderer.plan(), &trial.ray);
            pieces.len() > 1 && pieces.iter().any(sees)
        };
        let points: Vec<[f64; 2]> =
            hidden.iter().filter(|trial| !shows_other(trial)).map(|trial| trial.at.into()).collect();
        if points.is_empty() { Rest::Nothing } else { Rest::Behind(points) }
    }

    /// Rays to points of a piece, by their numbers.
    fn trials<'t>(
        &'t self,
        numbers: Range<u64>,
        pixel: usize,
        piece: &'t Piece,
    ) -> impl Iterator<Item = Trial> + use<'t> {
        let sections = Sections::new(&piece.outline);
        numbers.filter_map(move |index| self.trial(index, pixel, piece, &sections))
    }

    fn trial(&self, index: u64, pixel: usize, piece: &Piece, sections: &Sections) -> Option<Trial> {
        let (plan, image) = (self.renderer.plan(), &self.images[piece.image]);
        let [u, v, ..] = RaySampler::new(plan.seed(), index).take(DimensionSet::CAMERA);
        let at = DVec2::from(sections.point([u, v])?);
        let inwards = if !image.hole.is_empty() {
            0.0
        } else if image.share_of_outline == 1.0 {
            INWARDS_OF_EXACT / at.distance(piece.middle)
        } else {
            INWARDS
        };
        let at = at.lerp(piece.middle, inwards.min(INWARDS));
        let (column, row) = (pixel % self.camera.columns(), pixel / self.camera.columns());
        let camera_ray = self.camera.still_ray(column, row, at.into())?;
        let ray = Ray::new(camera_ray.origin, camera_ray.direction)?;
        let shows_light = image.may_be_seen_by(plan, &ray);
        Some(Trial { index, at, ray, camera_ray, shows_light })
    }
}
