//! Lights in interpolated pictures, drawn by the part of each pixel that they cover.
//!
//! A lamp of a few pixels is missed by most samples of a coarse grid, and few samples find the edge
//! of a larger one. Radiance's `rpict` draws small lights after the rest of the picture
//! (`drawsources`); this file does so for the edges of all. The outlines of emitters and of their
//! images are projected onto the film. In each pixel that an edge crosses, or that a narrow light
//! covers, rays to points of the outline find how much of the light is visible, and its radiance. A
//! pixel is the sum of the visible lights and of the rest, weighted by the areas that they cover.
//!
//! The samples of these pixels, from which the rest is interpolated, pass beside the outlines, so
//! that nothing counts twice.

use crate::light_strata::disjoint;
use crate::projection::{Cover, PixelSquare, Visit, images, projected, visit_touched};
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

/// Rays to points of a light in a pixel, a power of two.
const RAYS: u64 = 4;

/// Ray numbers of a pixel, as a power of two, and their offset.
const NUMBERS_LOG2: u32 = 20;
const DRAWN: u64 = 1 << 63;

/// How far points of an outline are moved towards its middle, as a fraction of the way: the corners
/// of a polygon around a circle do not belong to the light. Outlines that are exact need no more
/// than a part of a pixel, against rounding; the middle of a wide light is hundreds of pixels away.
const INWARDS: f64 = 0.01;
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
    /// The pixel without the outlines; `None` if hardly anything is left.
    rest: Option<Partition>,
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
        let mut by_pixel: HashMap<usize, Vec<Piece>> = HashMap::new();
        for (pixel, piece) in pieces.into_iter().flatten() {
            by_pixel.entry(pixel).or_default().push(piece);
        }
        let camera = &whole_pixels(camera);
        let drawn = |worker: &mut RayWorker<'_>, (pixel, pieces)| {
            let search = Search { renderer, camera, images: &images, pixel };
            Some((pixel, search.drawn(worker, pieces)?))
        };
        let pixels = by_pixel.into_par_iter().map_init(|| renderer.worker(), drawn).flatten_iter().collect();
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
        let drawn = self.of(camera, column, row);
        let Some(rest) = drawn.and_then(|drawn| drawn.rest.as_ref()) else { return camera.ray(column, row, sampler) };
        let [x, y, ..] = sampler.take(DimensionSet::CAMERA);
        whole_pixels(camera).still_ray(column, row, rest.outside([x, y])?)
    }

    /// The ray through the middle of a pixel, or of what lights leave of it.
    pub(crate) fn central_ray_beside(&self, camera: &ViewCamera, column: usize, row: usize) -> Option<CameraRay> {
        let rest = self.of(camera, column, row).and_then(|drawn| drawn.rest.as_ref());
        let Some(rest) = rest else { return camera.central_ray(column, row) };
        whole_pixels(camera).still_ray(column, row, rest.outside([0.5, 0.5])?)
    }

    /// Whether lights cover all of a pixel.
    pub(crate) fn cover(&self, camera: &ViewCamera, column: usize, row: usize) -> bool {
        self.of(camera, column, row).is_some_and(|drawn| drawn.rest.is_none())
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

/// The same camera with rays over whole pixels, as lights are drawn.
fn whole_pixels(camera: &ViewCamera) -> ViewCamera {
    let mut camera = *camera;
    camera.jitter = 1.0;
    camera
}

/// The pixels that an image covers, or partly covers if it is wide.
fn pieces(camera: &ViewCamera, index: usize, image: &LightImage, widest: f64) -> Vec<(usize, Piece)> {
    let Some(outline) = projected(camera, image) else { return Vec::new() };
    let [low, high] = outline.bounds();
    let is_narrow = outline.width() <= widest;
    let mut found = Vec::new();
    let visit = |column: usize, row: usize| {
        let square = PixelSquare::new(column, row, 1.0);
        let part = match square.cover(&outline) {
            Cover::Nothing => return Visit::GoOn,
            Cover::Part(part) => part,
            Cover::All if is_narrow => ConvexPolygon::square(),
            Cover::All => return Visit::SkipRow,
        };
        let piece = Piece { outline: part, middle: square.upright(0.5 * (low + high)), image: index };
        found.push((row * camera.columns() + column, piece));
        Visit::GoOn
    };
    visit_touched(&outline, (0..camera.columns(), 0..camera.rows()), visit);
    found
}

/// The search for visible lights in a pixel.
struct Search<'s> {
    renderer: &'s Renderer,
    /// With rays over whole pixels.
    camera: &'s ViewCamera,
    images: &'s [LightImage],
    pixel: usize,
}

impl Search<'_> {
    /// `None` if no light is visible.
    fn drawn(&self, worker: &mut RayWorker<'_>, pieces: Vec<Piece>) -> Option<DrawnPixel> {
        let (mut light, mut covered) = ([0.0; 3], 0.0);
        let mut visible = Vec::new();
        for (number, piece) in pieces.into_iter().enumerate() {
            let Some((radiance, share)) = self.seen(worker, number as u64, &piece) else { continue };
            let share = share * piece.outline.area() * self.images[piece.image].share_of_outline;
            light = std::array::from_fn(|band| light[band] + share * radiance[band]);
            covered += share;
            visible.push(piece.outline);
        }
        let rest = disjoint(visible, MOST_COVERED).and_then(|outlines| Partition::new(&outlines));
        (covered > 0.0).then_some(DrawnPixel { light, covered, rest })
    }

    /// The radiance of the light of a piece, and the share of the piece in which it is visible;
    /// `None` if it is hidden.
    fn seen(&self, worker: &mut RayWorker<'_>, number: u64, piece: &Piece) -> Option<([f64; 3], f64)> {
        let sections = Sections::new(&piece.outline);
        let index = |ray| DRAWN | (self.pixel as u64) << NUMBERS_LOG2 | (number * RAYS + ray);
        let to_light = |ray| self.ray_to_light(index(ray), piece, &sections).map(|found| (index(ray), found));
        let visible: Vec<(u64, CameraRay)> = (0..RAYS).filter_map(to_light).collect();
        let (index, ray) = visible.first()?;
        let radiance = traced(worker, *index, ray)?.value;
        Some((radiance, visible.len() as f64 / RAYS as f64))
    }

    /// A ray to a point of the light of a piece; `None` if something hides it there.
    fn ray_to_light(&self, index: u64, piece: &Piece, sections: &Sections) -> Option<CameraRay> {
        let plan = self.renderer.plan();
        let [u, v, ..] = RaySampler::new(plan.seed(), index).take(DimensionSet::CAMERA);
        let at = DVec2::from(sections.point([u, v])?);
        let is_exact = self.images[piece.image].share_of_outline == 1.0;
        let most = if is_exact { INWARDS_OF_EXACT / at.distance(piece.middle) } else { INWARDS };
        let at = at.lerp(piece.middle, most.min(INWARDS));
        let (column, row) = (self.pixel % self.camera.columns(), self.pixel / self.camera.columns());
        let camera_ray = self.camera.still_ray(column, row, at.into())?;
        let ray = Ray::new(camera_ray.origin, camera_ray.direction)?;
        self.images[piece.image].may_be_seen_by(plan, &ray).then_some(camera_ray)
    }
}
