//! Images of lights in curved mirrors, behind a finite pinhole.
//!
//! Through each point of a pinhole an image appears at another point of the picture: at x + B·p
//! through the point p, in radii. What is seen of the light changes little with p. So a ray that shows
//! a place of the image tells the light of all rays to this place, and counts for all pixels of the
//! disk. An image behind a disk of fifty pixels needs about a fiftieth of the rays that these pixels
//! need by themselves.
//!
//! Which rays show an image is defined for the ray alone, so that the light of an image is neither
//! lost nor counted twice: the rest of the picture is exposed without the light of these rays.

use crate::Exposer;
use crate::curved_image::CurvedImage;
use crate::disk_overlap::{DiskOverlap, Parallelogram};
use crate::film::{FilmRay, UnblurredFilm};
use crate::image_region::ImageRegion;
use glam::{DMat2, DVec2, DVec3};
use radsight_pinhole::{CameraRay, Rays};
use std::ops::Range;

/// Parts of an image along each axis of a pixel: the light of a part is blurred as if it were all seen
/// at one point.
const PARTS_PER_PIXEL: f64 = 8.0;

/// Light that is seen within so many pixels of a point, standard deviation, is spread as if it were seen at
/// that point.
const POINT: f64 = 0.08;

/// The images that a film shows.
#[derive(Debug)]
pub(crate) struct FilmImages {
    images: Vec<FilmImage>,
    /// In the order of their images.
    parts: Vec<ImagePart>,
    /// By pixel of the film: the images that its rays may show.
    near: Vec<Vec<u32>>,
    /// Where others may be seen. Its index is that after the last image's.
    region: Option<ImageRegion>,
    /// How the light of a point of the film is spread.
    film_blur: ImageBlur,
    /// Whether dielectrics show some of the images of the region, others more dimly.
    divides_rays: bool,
}

/// An image on the film.
#[derive(Debug)]
struct FilmImage {
    curved: CurvedImage,
    /// The point of the picture at which its middle is seen through the middle of the pinhole, pixels
    /// from the left and the top.
    center: DVec2,
    blur: ImageBlur,
    /// From places in the light's plane, in radii of the light, to pixels.
    by_place: DMat2,
}

/// How the light of an image is spread over the picture.
#[derive(Clone, Copy, Debug)]
struct ImageBlur {
    /// Shift of the point of the picture at which a place is seen, per radius of the pinhole, pixels.
    by_pinhole: DMat2,
    inverse: DMat2,
}

/// A part of an image that is small on the picture.
#[derive(Clone, Debug)]
pub(crate) struct ImagePart {
    /// Index of the image.
    image: usize,
    /// Of the image's footprint.
    cells: Range<usize>,
    /// The point of the picture at which its middle is seen through the middle of the pinhole.
    pub(crate) center: DVec2,
    /// The light that it has by the image's cells, up to a factor that all have in common.
    pub(crate) expected: f64,
    /// Fraction of its light that falls on the picture.
    pub(crate) visible: f64,
    /// Sum over the pixels of the squared fractions of its light.
    pub(crate) squared_weights: f64,
}

/// What a ray shows of a part of an image.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PartRay {
    pub(crate) ray: CameraRay,
    /// The point of the picture at which its place is seen through the middle of the pinhole.
    pub(crate) center: DVec2,
    /// Sum over the pixels of radiance·cos⁴, per that of the ray.
    pub(crate) weight: f64,
}

impl ImagePart {
    /// Of an image, with some of its cells. The light that is expected is seen at `center`.
    fn new(
        (image, cells): (usize, Range<usize>),
        (center, expected): (DVec2, f64),
        rays: &Rays,
        blur: &ImageBlur,
    ) -> ImagePart {
        let [mut visible, mut squared_weights] = [0.0; 2];
        blur.for_each_pixel(rays, (center, DVec2::ZERO), |_, overlap| {
            visible += overlap.area;
            squared_weights += overlap.area * overlap.area;
        });
        ImagePart { image, cells, center, expected, visible, squared_weights }
    }
}

#[cfg(test)]
impl ImagePart {
    /// A part around a point of which nothing is known.
    pub(crate) fn unseen(center: DVec2) -> ImagePart {
        ImagePart { image: 0, cells: 0..1, center, expected: 1.0, visible: 1.0, squared_weights: 1.0 }
    }
}

impl FilmImages {
    /// Those of known images.
    pub(crate) fn new(exposer: &Exposer<'_>, film: &UnblurredFilm, curved: &[CurvedImage]) -> FilmImages {
        let rays = exposer.rays;
        let near = vec![Vec::new(); film.pixel_count()];
        let film_blur = ImageBlur::of_film(film);
        let divides_rays = exposer.renderer.plan().divides_rays;
        let (images, parts) = (Vec::new(), Vec::new());
        let mut found = FilmImages { images, parts, near, region: None, film_blur, divides_rays };
        for image in curved.iter().filter_map(|curved| FilmImage::new(rays, curved)) {
            found.add(rays, film, image);
        }
        found
    }

    /// Whether the film shows no image.
    pub(crate) fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    /// Adds the region of other images.
    pub(crate) fn add_region(&mut self, rays: &Rays, film: &UnblurredFilm, region: ImageRegion) {
        let image = self.images.len();
        for (index, (pixel, expected)) in region.pixels().enumerate() {
            let cells = index..index + 1;
            let center = film.picture_point(film.corner(pixel) + 0.5);
            self.parts.push(ImagePart::new((image, cells), (center, expected), rays, &self.film_blur));
        }
        self.region = Some(region);
    }

    /// [`ImageRegion::variance`]; 0 without a region.
    pub(crate) fn region_variance(&self) -> f64 {
        self.region.as_ref().map_or(0.0, ImageRegion::variance)
    }

    /// Whether a part is one of the region where images are not known.
    pub(crate) fn is_in_region(&self, part: &ImagePart) -> bool {
        part.image == self.images.len()
    }

    /// Whether a part may show images of which some are much dimmer than expected, or much brighter.
    pub(crate) fn is_uneven(&self, part: &ImagePart) -> bool {
        self.divides_rays && self.is_in_region(part)
    }

    /// Adds an image if the picture shows any of it.
    fn add(&mut self, rays: &Rays, film: &UnblurredFilm, mut image: FilmImage) {
        let (footprint, ranges) = image.curved.footprint.in_parts(|place| image.square_of(place));
        let light = image.curved.light();
        let index = self.images.len();
        let part = |cells: Range<usize>| {
            let center = image.center + image.by_place * footprint.middle(cells.clone());
            let expected = light * footprint.probability(cells.clone());
            let part = ImagePart::new((index, cells), (center, expected), rays, &image.blur);
            (part.visible > 0.0).then_some(part)
        };
        let parts: Vec<ImagePart> = ranges.into_iter().filter_map(part).collect();
        if parts.is_empty() {
            return;
        }
        self.parts.extend(parts);
        image.curved.footprint = footprint;
        for pixel in film.pixels_around(image.center, image.reach(film)) {
            self.near[pixel].push(index as u32);
        }
        self.images.push(image);
    }

    pub(crate) fn parts(&self) -> &[ImagePart] {
        &self.parts
    }

    /// Whether a ray of a pixel of the film shows an image.
    pub(crate) fn are_shown_by(&self, rays: &Rays, seen: &FilmRay) -> bool {
        self.image_of(rays, seen).is_some()
    }

    /// Whether a ray shows a place of a known image of a light, by a chain, or near it.
    pub(crate) fn is_known(&self, seen: &FilmRay, (light, chain): (usize, u32)) -> bool {
        let is_same = |image: &FilmImage| (image.curved.light, image.curved.chain) == (light, chain);
        self.near(seen.pixel).any(|(_, image)| is_same(image) && image.density(&seen.ray) > 0.0)
    }

    /// Whether a ray shows the light of a known image.
    pub(crate) fn shows_light(&self, seen: &FilmRay) -> bool {
        self.near(seen.pixel).any(|(_, image)| image.shows_light(&seen.ray))
    }

    /// The images that rays of a pixel of the film may show, with their indices.
    fn near(&self, pixel: usize) -> impl Iterator<Item = (usize, &FilmImage)> {
        self.near[pixel].iter().map(|image| (*image as usize, &self.images[*image as usize]))
    }

    /// The image of which a ray shows a place: the one with the highest density of rays there.
    fn image_of(&self, rays: &Rays, FilmRay { ray, pixel, point, .. }: &FilmRay) -> Option<usize> {
        let with_density = self.near(*pixel).map(|(index, image)| (index, image.density(ray)));
        let in_region = self.region.as_ref().map(|region| {
            let by_pixel = region.density(*pixel, *point);
            (self.images.len(), by_pixel * rays.camera().pixels_per_solid_angle(ray.direction))
        });
        let shown = with_density.chain(in_region).filter(|(_, density)| *density > 0.0);
        shown.reduce(|best, next| if next.1 > best.1 { next } else { best }).map(|(image, _)| image)
    }

    /// The ray to a part of an image for a point of the unit square, through a point of the pinhole;
    /// `None` if it shows another image.
    pub(crate) fn ray(
        &self,
        (rays, film): (&Rays, &UnblurredFilm),
        part: usize,
        u: [f64; 2],
        on_pinhole: DVec2,
    ) -> Option<PartRay> {
        let part = &self.parts[part];
        if self.is_in_region(part) {
            return self.ray_in_region((rays, film), part, u, on_pinhole);
        }
        let FilmImage { curved, blur, .. } = &self.images[part.image];
        let place = curved.footprint.sample_cells(part.cells.clone(), u);
        let density = curved.footprint.in_cells(place) / curved.footprint.probability(part.cells.clone());
        if density <= 0.0 {
            // On the side of a cell, by rounding.
            return None;
        }
        let origin = rays.ray_through(0, [0.5; 2], on_pinhole.into())?.origin;
        let direction = curved.direction_to(place, origin);
        let at = rays.picture_point(direction, on_pinhole.into())?;
        let ray = rays.ray_through(0, at, on_pinhole.into())?;
        let at = DVec2::from(at);
        let (point, pixel) = film.seen_from(at, on_pinhole)?;
        if self.image_of(rays, &FilmRay { ray, pixel, point, passage: None }) != Some(part.image) {
            return None;
        }
        let weight = curved.solid_angle(direction) * rays.camera().pixels_per_solid_angle(direction) / density;
        Some(PartRay { ray, center: at - blur.by_pinhole * on_pinhole, weight })
    }

    /// The same in the region.
    fn ray_in_region(
        &self,
        (rays, film): (&Rays, &UnblurredFilm),
        part: &ImagePart,
        u: [f64; 2],
        on_pinhole: DVec2,
    ) -> Option<PartRay> {
        let (point, density) = self.region.as_ref()?.sample(part.cells.start, u);
        let seen = film.ray_to_point(rays, point, on_pinhole)?;
        if self.image_of(rays, &seen) != Some(part.image) {
            return None;
        }
        Some(PartRay { ray: seen.ray, center: film.picture_point(point), weight: density.recip() })
    }

    /// The pixels of the picture over which the light of a part is spread that is seen at some points through
    /// the middle of the pinhole, each with the points of the pinhole through which it is seen there. The
    /// points are given by their mean and standard deviation.
    pub(crate) fn for_each_pixel(
        &self,
        rays: &Rays,
        (part, seen_at): (usize, (DVec2, DVec2)),
        of_pixel: impl FnMut(usize, DiskOverlap),
    ) {
        let blur = self.images.get(self.parts[part].image).map_or(&self.film_blur, |image| &image.blur);
        blur.for_each_pixel(rays, seen_at, of_pixel);
    }

    /// The parts of each image.
    pub(crate) fn by_image(&self) -> impl Iterator<Item = Range<usize>> {
        let start = |image: usize| self.parts.partition_point(move |part| part.image < image);
        (0..=self.images.len()).map(move |image| start(image)..start(image + 1))
    }
}

impl FilmImage {
    /// `None` where the map to the picture is singular.
    fn new(rays: &Rays, curved: &CurvedImage) -> Option<FilmImage> {
        let at = |place: DVec2, on_pinhole: DVec2| {
            let origin: DVec3 = rays.ray_through(0, [0.5; 2], on_pinhole.into())?.origin;
            rays.picture_point(curved.direction_to(place, origin), on_pinhole.into()).map(DVec2::from)
        };
        let across = |of_side: &dyn Fn(DVec2) -> Option<DVec2>| {
            let [x, y] = [DVec2::X, DVec2::Y].map(|side| Some(0.5 * (of_side(side)? - of_side(-side)?)));
            Some(DMat2::from_cols(x?, y?))
        };
        let by_place = across(&|place| at(place, DVec2::ZERO))?;
        let by_pinhole = across(&|on_pinhole| at(DVec2::ZERO, on_pinhole))?;
        let (center, blur) = (at(DVec2::ZERO, DVec2::ZERO)?, ImageBlur::new(by_pinhole));
        let is_regular = blur.inverse.is_finite() && center.is_finite() && by_place.is_finite();
        is_regular.then(|| FilmImage { curved: curved.clone(), center, blur, by_place })
    }

    /// The square of the picture in which a place is seen through the middle of the pinhole.
    fn square_of(&self, place: DVec2) -> [i32; 2] {
        ((self.center + self.by_place * place) * PARTS_PER_PIXEL).floor().as_ivec2().into()
    }

    /// Density of rays to the place that a ray shows, per solid angle. 0 outside of the cells.
    fn density(&self, ray: &CameraRay) -> f64 {
        let density = self.curved.footprint.in_cells(self.curved.place(ray.origin, ray.direction));
        if density > 0.0 { density / self.curved.solid_angle(ray.direction) } else { 0.0 }
    }

    /// Whether a ray shows a place with light.
    fn shows_light(&self, ray: &CameraRay) -> bool {
        self.curved.footprint.is_near_light(self.curved.place(ray.origin, ray.direction))
    }

    /// The farthest point of the film from the middle at which the image is seen, pixels along each
    /// axis.
    fn reach(&self, film: &UnblurredFilm) -> DVec2 {
        // At the depth of the film the image would not move on it.
        let by_depth = self.blur.by_pinhole + DMat2::from_diagonal(film.shift());
        self.curved.footprint.reach() * extent(self.by_place) + extent(by_depth) + 1.0
    }
}

/// Extent of the image of the unit disk by a map, on each side of its centre along both axes.
fn extent(map: DMat2) -> DVec2 {
    DVec2::new(map.row(0).length(), map.row(1).length())
}

impl ImageBlur {
    fn new(by_pinhole: DMat2) -> ImageBlur {
        ImageBlur { by_pinhole, inverse: by_pinhole.inverse() }
    }

    /// Of what is at the depth of the film: a point of it is seen through p at x − S·p.
    fn of_film(film: &UnblurredFilm) -> ImageBlur {
        ImageBlur::new(DMat2::from_diagonal(-film.shift()))
    }

    fn for_each_pixel(
        &self,
        rays: &Rays,
        (center, deviation): (DVec2, DVec2),
        mut of_pixel: impl FnMut(usize, DiskOverlap),
    ) {
        let camera = rays.camera();
        let [columns, rows] = [camera.columns(), camera.rows()].map(|count| count as usize);
        let extent = extent(self.by_pinhole) + deviation;
        let is_point = deviation.max_element() < POINT;
        let pixels = |at: f64, extent: f64, count: usize| {
            // Negative numbers become 0.
            ((at - extent).floor() as usize)..((at + extent).ceil() as usize).min(count)
        };
        let pixel_on_pinhole = Parallelogram::new(self.inverse);
        for row in pixels(center.y, extent.y, rows) {
            for column in pixels(center.x, extent.x, columns) {
                let middle = DVec2::new(column as f64, row as f64) + 0.5 - center;
                let overlap_at = |at: DVec2| pixel_on_pinhole.overlap(self.inverse * at);
                let overlap = if is_point {
                    overlap_at(middle)
                } else {
                    // Four points with this mean and deviation.
                    let around = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].map(DVec2::from);
                    DiskOverlap::mean(around.map(|side| overlap_at(middle + side * deviation)))
                };
                if overlap.area > 0.0 {
                    of_pixel(row * columns + column, overlap);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::tests::film;

    #[test]
    fn a_point_of_the_film_is_seen_where_its_blur_says() {
        let film = film([3.7, 3.2], [9, 7]);
        let (blur, at) = (ImageBlur::of_film(&film), DVec2::new(4.2, 3.1));
        for on_pinhole in [DVec2::ZERO, DVec2::X, DVec2::new(-0.3, 0.6)] {
            let (point, _) = film.seen_from(at + blur.by_pinhole * on_pinhole, on_pinhole).expect("it is on the film");
            assert!(film.picture_point(point).distance(at) < 1e-12, "{point}");
        }
    }
}
