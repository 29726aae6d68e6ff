//! Rays to the images of lights in curved mirrors.
//!
//! A ball shows each LED as a point a thousand times as bright as the sheet and a millionth of a pixel in size. Rays that are spread evenly over
//! pixel and hole meet it by chance only. Where such an image is found, some of the pixel's rays go there: for a place on the pixel the
//! points of the hole from which the image is seen fill an ellipse, known by the linear map from the hole to the light. The rays of a pixel
//! are then drawn from a mixture of densities and divided by it, so that the mean stays what it was (Owen and Zhou 2000).

use glam::{DMat2, DVec2, DVec3};
use radsight_pinhole::{CameraRay, Hole, Rays};
use radsight_render::{MirroredLight, Ray, RayWorker, Renderer};
use radsight_sampling::{choose, unit_disk};
use rayon::prelude::*;
use std::f64::consts::FRAC_1_PI;

/// This share of a pixel's rays goes to the images that it shows.
const SHARE: f64 = 0.5;

/// Ellipses from which an image's rays are drawn, each with its size in that of the linear map and its share of the rays. The map of a smoothed
/// mesh differs from facet to facet, so that some of the light comes from beside the first.
const ELLIPSES: [(f64, f64); 2] = [(1.03, 0.8), (4.0, 0.2)];

/// Steps of derivatives, in radii of the hole and in pixels.
const STEP: f64 = 1e-4;

/// Newton's method takes no more steps, and ends within this share of a light's radius from its middle.
const MOST_STEPS: u32 = 8;
const MET: f64 = 0.02;

/// Where it does not end, as between the facets of a mesh, so near is near enough.
const FARTHEST_MISS: f64 = 1.5;

/// Places farther out than this, in radii of the hole or in pixels, belong to other pixels.
const FARTHEST: f64 = 3.0;

/// The images that each pixel shows.
#[derive(Debug)]
pub(crate) struct PixelImages {
    hole: Hole,
    /// By pixel; empty where no pixel shows any.
    images: Vec<Vec<PixelImage>>,
}

/// The image of a light as a pixel shows it: an ellipse on the hole, or on the pixel itself where the hole is a point.
#[derive(Clone, Copy, Debug)]
struct PixelImage {
    /// For the pixel's middle.
    center: DVec2,
    /// How the centre moves with the place on the pixel.
    slope: DMat2,
    /// From the unit disk.
    map: DMat2,
    inverse: DMat2,
    /// Share of the draws.
    chance: f64,
    /// Density of all draws in it as a multiple of even ones.
    density: f64,
}

/// What the linear map makes of a light.
struct Ellipse {
    center: DVec2,
    slope: DMat2,
    map: DMat2,
}

impl Ellipse {
    /// The images from which its share of the rays is drawn.
    fn images(&self, hole: Hole, share: f64) -> [PixelImage; ELLIPSES.len()] {
        // Even draws have density 1 on the pixel, 1/π on the disk.
        let unit = if hole == Hole::Point { FRAC_1_PI } else { 1.0 };
        ELLIPSES.map(|(size, part)| {
            let (map, chance) = (self.map * size, share * part);
            let density = chance * unit / map.determinant().abs();
            PixelImage { center: self.center, slope: self.slope, map, inverse: map.inverse(), chance, density }
        })
    }
}

impl PixelImage {
    fn center_at(&self, place: DVec2) -> DVec2 {
        self.center + self.slope * (place - 0.5)
    }
}

impl PixelImages {
    /// Whether no pixel shows any.
    pub(crate) fn is_empty(&self) -> bool {
        self.images.is_empty()
    }

    /// Whether a pixel shows any.
    pub(crate) fn shows_any(&self, pixel: usize) -> bool {
        self.images.get(pixel).is_some_and(|images| !images.is_empty())
    }

    /// Looks for the images that the pixels of a camera show.
    pub(crate) fn find(renderer: &Renderer, rays: &Rays) -> PixelImages {
        let hole = rays.hole();
        let none = PixelImages { hole, images: Vec::new() };
        let camera = rays.camera();
        if hole == Hole::Pattern {
            return none;
        }
        let found = renderer.worker().mirrored_lights(camera.position_m() / camera.scene_unit_m());
        if found.is_empty() {
            return none;
        }
        let images: Vec<Vec<PixelImage>> = (0..camera.pixel_count() as usize)
            .into_par_iter()
            .with_min_len(64)
            .map_init(
                || renderer.worker(),
                |worker, pixel| {
                    let pixel = pixel as u64;
                    let cone = PixelCone::new(rays, pixel);
                    let images = found.iter().filter(|image| cone.as_ref().is_some_and(|cone| cone.holds(image)));
                    let search = &mut Search { worker, rays, pixel };
                    let ellipses: Vec<_> = images.filter_map(|image| search.image(image)).collect();
                    let share = (ellipses.len() as f64).recip();
                    let images = ellipses.into_iter().flat_map(|ellipse| ellipse.images(hole, share));
                    images.filter(|image| image.density.is_finite()).collect()
                },
            )
            .collect();
        PixelImages { hole, images }
    }

    /// The ray of a pixel for a point of the unit cube, and its weight; `None` where it would miss the hole or the pixel.
    #[inline]
    pub(crate) fn ray(&self, rays: &Rays, pixel: usize, u: [f64; 4]) -> Option<(CameraRay, f64)> {
        match self.images.get(pixel) {
            Some(images) if !images.is_empty() => self.mixed_ray(rays, (pixel, images), u),
            _ => Some((rays.ray(pixel as u64, u), 1.0)),
        }
    }

    fn mixed_ray(&self, rays: &Rays, (pixel, images): (usize, &[PixelImage]), u: [f64; 4]) -> Option<(CameraRay, f64)> {
        // With a hole that is a point the place on the pixel is what is drawn from the image.
        let is_point = self.hole == Hole::Point;
        let [fixed, drawn] = if is_point { [[u[2], u[3]], [u[0], u[1]]] } else { [[u[0], u[1]], [u[2], u[3]]] };
        let fixed = DVec2::from(fixed);
        let at = if drawn[0] < SHARE {
            let (chosen, u) = choose(images.iter().map(|image| image.chance), drawn[0] / SHARE)?;
            let image = &images[chosen];
            let at = DVec2::from(unit_disk(u, drawn[1]));
            image.center_at(fixed) + image.map * at
        } else {
            let even = [(drawn[0] - SHARE) / (1.0 - SHARE), drawn[1]];
            if is_point { DVec2::from(even) } else { DVec2::from(unit_disk(even[0], even[1])) }
        };
        let is_inside = if is_point {
            at.cmpge(DVec2::ZERO).all() && at.cmplt(DVec2::ONE).all()
        } else {
            at.length_squared() <= 1.0
        };
        if !is_inside {
            return None;
        }
        let density = |image: &PixelImage| {
            let place = image.inverse * (at - image.center_at(fixed));
            if place.length_squared() <= 1.0 { image.density } else { 0.0 }
        };
        let mixed = (1.0 - SHARE) + SHARE * images.iter().map(density).sum::<f64>();
        let (place, on_hole) = if is_point { (at, DVec2::ZERO) } else { (fixed, at) };
        let ray = rays.ray_through(pixel as u64, place.into(), on_hole.into())?;
        Some((ray, mixed.recip()))
    }
}

/// About where the rays of a pixel go.
struct PixelCone {
    /// Unit.
    middle: DVec3,
    /// Squared chord from it within which images are looked for.
    reach: f64,
}

impl PixelCone {
    fn new(rays: &Rays, pixel: u64) -> Option<PixelCone> {
        let direction =
            |place: [f64; 2], on_hole: [f64; 2]| rays.ray_through(pixel, place, on_hole).map(|ray| ray.direction);
        let middle = direction([0.5; 2], [0.0; 2])?;
        let across = |place, on_hole| direction(place, on_hole).map_or(0.0, |direction| direction.distance(middle));
        let widest = across([0.0; 2], [0.0; 2]).max(across([1.0; 2], [0.0; 2])) + across([0.5; 2], [1.0, 0.0]);
        // No pixel and no hole is wider.
        Some(PixelCone { middle, reach: (2.0 * widest).powi(2).min(0.25) })
    }

    fn holds(&self, image: &MirroredLight) -> bool {
        self.middle.distance_squared(image.direction()) <= self.reach
    }
}

/// Looks for an image in one pixel.
struct Search<'s, 'r> {
    worker: &'s mut RayWorker<'r>,
    rays: &'s Rays,
    pixel: u64,
}

impl Search<'_, '_> {
    /// Where the ray through a place and a point of the hole passes the light, in its radii.
    fn passing(&mut self, image: &MirroredLight, place: DVec2, on_hole: DVec2) -> Option<DVec2> {
        let ray = self.rays.ray_through(self.pixel, place.into(), on_hole.into())?;
        self.worker.offset_from(image, &Ray::new(ray.origin, ray.direction)?)
    }

    /// The point of the hole whose ray has the image's direction, as far as the hole is small.
    fn start(&self, image: &MirroredLight) -> Option<DVec2> {
        let is_point = self.rays.hole() == Hole::Point;
        let middle = if is_point { DVec2::splat(0.5) } else { DVec2::ZERO };
        let direction = |at: DVec2| {
            let (place, on_hole) = if is_point { (at, DVec2::ZERO) } else { (DVec2::splat(0.5), at) };
            self.rays.ray_through(self.pixel, place.into(), on_hole.into()).map(|ray| ray.direction)
        };
        let own = direction(middle)?;
        let [x, y] = [direction(middle + DVec2::X)? - own, direction(middle + DVec2::Y)? - own];
        let off = image.direction() - own;
        // Least squares in the plane of the two.
        let normal = DMat2::from_cols_array(&[x.dot(x), x.dot(y), x.dot(y), y.dot(y)]);
        let at = middle + normal.inverse() * DVec2::new(x.dot(off), y.dot(off));
        (at.is_finite() && at.length() <= FARTHEST).then_some(at)
    }

    /// The image as the pixel shows it; `None` where it does not.
    fn image(&mut self, image: &MirroredLight) -> Option<Ellipse> {
        let is_point = self.rays.hole() == Hole::Point;
        let middle = DVec2::splat(0.5);
        let pass = |search: &mut Self, at: DVec2, place: DVec2| {
            if is_point { search.passing(image, at, DVec2::ZERO) } else { search.passing(image, place, at) }
        };
        let mut at = self.start(image)?;
        let mut best: Option<(f64, Ellipse)> = None;
        for _ in 0..MOST_STEPS {
            let Some(passed) = pass(self, at, middle) else { break };
            let sides = [DVec2::X, DVec2::Y].map(|side| pass(self, at + side * STEP, middle));
            let [Some(a), Some(b)] = sides else { break };
            let map = DMat2::from_cols((a - passed) / STEP, (b - passed) / STEP).inverse();
            let center = at - map * passed;
            if !center.is_finite() || center.length() > FARTHEST {
                break;
            }
            let miss = passed.length();
            if best.as_ref().is_none_or(|(least, _)| miss < *least) {
                let slope = self.slope(at, middle, (passed, map), &pass);
                best = slope.map(|slope| (miss, Ellipse { center, slope, map })).or(best);
            }
            if miss <= MET {
                break;
            }
            at = center;
        }
        best.filter(|(miss, _)| *miss <= FARTHEST_MISS).map(|(_, ellipse)| ellipse)
    }

    /// How the centre of an ellipse moves with the place on the pixel.
    fn slope(
        &mut self,
        at: DVec2,
        middle: DVec2,
        (passed, map): (DVec2, DMat2),
        pass: &impl Fn(&mut Self, DVec2, DVec2) -> Option<DVec2>,
    ) -> Option<DMat2> {
        if self.rays.hole() == Hole::Point {
            return Some(DMat2::ZERO);
        }
        let [x, y] = [DVec2::X, DVec2::Y].map(|side| pass(self, at, middle + side * STEP));
        Some(map * DMat2::from_cols((passed - x?) / STEP, (passed - y?) / STEP))
    }
}
