//! Rays towards the images of lights in plane mirrors.
//!
//! A plane mirror shows a light with its full radiance, a thousand times that of a sheet. For a
//! point on the pixel, the points of the pinhole that may see the image fill the overlap of the
//! pinhole, the image's ellipse and, for a ring, the mirror's outline. Most rays are aimed at these
//! overlaps, and of them only those that hit the mirror are traced. The other rays sample the whole
//! pinhole and leave out what the first ones trace. Among the aimed rays the radiance is nearly
//! constant, so that few of them suffice.

use crate::domain::Domain;
use crate::ellipse::Ellipse;
use glam::{DMat2, DVec2};
use radsight_sampling::choose;
use std::f64::consts::PI;

/// Fraction of the rays that are not aimed at images. A power of two: then the low-discrepancy
/// sequence divides the rays exactly.
const REST: f64 = 0.125;

/// Strips by which the area of an overlap is estimated.
const STRIPS: usize = 12;

/// An image that fills more than this fraction of the domain needs no stratum.
const MAX_FRACTION: f64 = 0.9;

/// A linear map may be wrong by this fraction of the radius of the light or the mirror.
const MAX_MISS: f64 = 0.1;

/// Minimum enlargement of an image, for rounding.
const MARGIN: f64 = 1e-4;

impl Domain {
    /// The direction of the strips across it, unit. With it the strips of a disk and a circle are
    /// tight.
    fn axis(self, center: DVec2) -> DVec2 {
        if self == Domain::Disk { center.normalize_or(DVec2::X) } else { DVec2::X }
    }

    /// The extent along the axis.
    fn extent(self) -> [f64; 2] {
        if self == Domain::Disk { [-1.0, 1.0] } else { [0.0, 1.0] }
    }

    /// The extent of the strip at a coordinate along the axis.
    fn strip(self, along: f64) -> [f64; 2] {
        match self {
            Domain::Disk => {
                let half = (1.0 - along * along).max(0.0).sqrt();
                [-half, half]
            }
            Domain::Square => [0.0, 1.0],
        }
    }
}

/// The images of each pixel.
#[derive(Debug, Default)]
pub(crate) struct PlaneImages {
    /// By pixel; empty if no pixel sees any.
    images: Vec<Vec<PlaneImage>>,
}

impl PlaneImages {
    pub(crate) fn new(images: Vec<Vec<PlaneImage>>) -> PlaneImages {
        PlaneImages { images: if images.iter().all(Vec::is_empty) { Vec::new() } else { images } }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.images.is_empty()
    }

    pub(crate) fn of_pixel(&self, pixel: usize) -> &[PlaneImage] {
        self.images.get(pixel).map_or(&[], Vec::as_slice)
    }

    pub(crate) fn sees_any(&self, pixel: usize) -> bool {
        !self.of_pixel(pixel).is_empty()
    }
}

/// The image of a light in one pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlaneImage {
    image: Ellipse,
    /// The outline of a mirror that is a ring, and its opening.
    outline: Option<Ellipse>,
    opening: Option<Ellipse>,
    /// Its index in the list of lights in plane mirrors.
    light: usize,
    /// Approximate area of the overlap with the domain, averaged over the pixel.
    area: f64,
}

impl PlaneImage {
    /// `None` for an image without area or one that fills the domain.
    pub(crate) fn new(image: Ellipse, light: usize, domain: Domain) -> Option<PlaneImage> {
        let is_small = PI * image.relative_area() <= MAX_FRACTION * domain.area();
        (image.is_finite() && is_small).then_some(PlaneImage { image, outline: None, opening: None, light, area: 0.0 })
    }

    /// Widened for an error of the linear map, in radii of the light; `None` if it is too large.
    pub(crate) fn widened(&self, miss: f64) -> Option<PlaneImage> {
        (miss <= MAX_MISS).then(|| PlaneImage { image: self.image.scaled(1.0 + MARGIN + 2.0 * miss), ..*self })
    }

    /// Clipped by the outline of a ring with an opening in outer radii. `misses` gives the error of
    /// the linear map at a point in the same unit, if it is known.
    pub(crate) fn clipped(
        &self,
        ring: Ellipse,
        opening: f64,
        misses: impl Fn(DVec2, DVec2, DVec2) -> Option<f64>,
    ) -> PlaneImage {
        if !ring.is_finite() {
            return *self;
        }
        let mut margin = MARGIN;
        for (fixed, at) in self.own_points() {
            match misses(fixed, at, ring.offset(fixed, at)) {
                Some(miss) if miss <= MAX_MISS => margin = margin.max(MARGIN + 2.0 * miss),
                _ => return *self,
            }
        }
        let opening = (opening > 2.0 * margin).then(|| ring.scaled(opening - margin));
        PlaneImage { outline: Some(ring.scaled(1.0 + margin)), opening, ..*self }
    }

    /// Position of a point relative to the light's centre, in radii of the light.
    pub(crate) fn offset(&self, fixed: DVec2, at: DVec2) -> DVec2 {
        self.image.offset(fixed, at)
    }

    fn contains(&self, fixed: DVec2, at: DVec2) -> bool {
        let is_within = |ellipse: &Ellipse| ellipse.contains(fixed, at);
        is_within(&self.image)
            && self.outline.as_ref().is_none_or(is_within)
            && !self.opening.as_ref().is_some_and(is_within)
    }

    /// With the area of its overlaps; `None` if there are none.
    pub(crate) fn overlapping(&self, domain: Domain) -> Option<PlaneImage> {
        let overlaps = grid_of_nine().map(|fixed| Overlap::new(self, domain, fixed.into()));
        let area = overlaps.map(|overlap| overlap.map_or(0.0, |overlap| overlap.area())).sum::<f64>() / 9.0;
        (area > 0.0).then_some(PlaneImage { area, ..*self })
    }

    /// Points of the overlap with the domain, each with its fixed point: where the image may be
    /// seen.
    pub(crate) fn overlap_points(&self, domain: Domain) -> impl Iterator<Item = (DVec2, DVec2)> {
        let image = *self;
        grid_of_nine().flat_map(move |fixed| {
            let fixed = DVec2::from(fixed);
            let overlap = Overlap::new(&image, domain, fixed);
            grid_of_nine().filter_map(move |u| Some((fixed, overlap.as_ref()?.point(u)?.0)))
        })
    }

    /// The middle of the image and points of its rim, each with its fixed point.
    pub(crate) fn own_points(&self) -> impl Iterator<Item = (DVec2, DVec2)> {
        let image = *self;
        [DVec2::ZERO, DVec2::ONE].into_iter().flat_map(move |fixed| {
            let offsets = [DVec2::ZERO, DVec2::X, DVec2::NEG_X, DVec2::Y, DVec2::NEG_Y];
            offsets.map(|offset| (fixed, image.image.point(fixed, offset)))
        })
    }
}

/// Points of the unit square, nearly to its rim.
fn grid_of_nine() -> impl Iterator<Item = [f64; 2]> {
    const INSIDE: [f64; 3] = [0.02, 0.5, 0.98];
    INSIDE.into_iter().flat_map(|x| INSIDE.map(|y| [x, y]))
}

/// An ellipse in coordinates along an axis and across.
#[derive(Clone, Copy)]
struct TurnedEllipse {
    center: DVec2,
    inverse: DMat2,
    /// Extent along the axis on each side of the centre.
    reach: f64,
}

impl TurnedEllipse {
    fn new(ellipse: &Ellipse, axis: DVec2, fixed: DVec2) -> TurnedEllipse {
        let turned = DMat2::from_cols(axis, axis.perp());
        TurnedEllipse {
            center: turned.transpose() * ellipse.center_at(fixed),
            inverse: ellipse.inverse_from(turned),
            reach: ellipse.extent(axis),
        }
    }

    /// The extent across at a coordinate along the axis; `None` outside.
    fn strip(&self, along: f64) -> Option<[f64; 2]> {
        // |x·a + y·b|² = 1 with x and y from the ellipse's centre.
        let (a, b) = (self.inverse.x_axis * (along - self.center.x), self.inverse.y_axis);
        let (square, half, rest) = (b.dot(b), a.dot(b), a.dot(a) - 1.0);
        let root = half * half - square * rest;
        (root > 0.0).then(|| [-root.sqrt(), root.sqrt()].map(|root| self.center.y + (root - half) / square))
    }
}

/// The overlap of an image with its mirror and the domain for one fixed point.
struct Overlap {
    domain: Domain,
    axis: DVec2,
    image: TurnedEllipse,
    outline: Option<TurnedEllipse>,
    opening: Option<TurnedEllipse>,
    /// Along the axis.
    start: f64,
    length: f64,
}

impl Overlap {
    /// `None` where they do not overlap.
    fn new(image: &PlaneImage, domain: Domain, fixed: DVec2) -> Option<Overlap> {
        let axis = domain.axis(image.image.center_at(fixed));
        let turned = |ellipse: &Ellipse| TurnedEllipse::new(ellipse, axis, fixed);
        let (opening, outline) = (image.opening.as_ref().map(turned), image.outline.as_ref().map(turned));
        let image = turned(&image.image);
        let [mut start, mut end] = domain.extent();
        for ellipse in [Some(&image), outline.as_ref()].into_iter().flatten() {
            start = start.max(ellipse.center.x - ellipse.reach);
            end = end.min(ellipse.center.x + ellipse.reach);
        }
        (start < end).then_some(Overlap { domain, axis, image, outline, opening, start, length: end - start })
    }

    /// The extent of the strip at a coordinate along the axis, in two parts where the opening
    /// divides it. A part may be empty.
    fn strip(&self, along: f64) -> [[f64; 2]; 2] {
        const EMPTY: [f64; 2] = [0.0; 2];
        let [mut low, mut high] = self.domain.strip(along);
        for ellipse in [Some(&self.image), self.outline.as_ref()].into_iter().flatten() {
            let Some(strip) = ellipse.strip(along) else { return [EMPTY; 2] };
            (low, high) = (low.max(strip[0]), high.min(strip[1]));
        }
        if low >= high {
            return [EMPTY; 2];
        }
        match self.opening.as_ref().and_then(|opening| opening.strip(along)) {
            Some([first, last]) => [[low, high.min(first).max(low)], [low.max(last).min(high), high]],
            None => [[low, high], EMPTY],
        }
    }

    /// Approximate area.
    fn area(&self) -> f64 {
        let width = self.length / STRIPS as f64;
        let strip = |strip: usize| self.strip(self.start + (strip as f64 + 0.5) * width);
        (0..STRIPS).flat_map(strip).map(|[low, high]| (high - low) * width).sum()
    }

    /// A point of the overlap and its inverse density by area.
    fn point(&self, u: [f64; 2]) -> Option<(DVec2, f64)> {
        let along = self.start + self.length * u[0];
        let [first, second] = self.strip(along);
        let [near, far] = [first, second].map(|[low, high]| high - low);
        let place = u[1] * (near + far);
        let across = if place < near { first[0] + place } else { second[0] + (place - near) };
        let point = self.axis * along + self.axis.perp() * across;
        (near + far > 0.0).then_some((point, self.length * (near + far)))
    }
}

/// A point of the domain with its weight: aimed at an image, or by `rest`. `hits` tells whether the
/// ray of a point first hits the mirror of this light. `None` where `rest` has no point, and where
/// the light belongs to another stratum.
pub(crate) fn stratified(
    images: &[PlaneImage],
    domain: Domain,
    (fixed, drawn): (DVec2, [f64; 2]),
    hits: impl Fn(DVec2, usize) -> bool,
    rest: impl FnOnce([f64; 2]) -> Option<(DVec2, f64)>,
) -> Option<(DVec2, f64)> {
    let is_seen = |image: &PlaneImage, at| image.contains(fixed, at) && hits(at, image.light);
    if drawn[0] < REST {
        let (at, weight) = rest([drawn[0] / REST, drawn[1]])?;
        let is_aimed_at = images.iter().any(|image| is_seen(image, at));
        return (!is_aimed_at).then_some((at, weight / REST));
    }
    let total: f64 = images.iter().map(|image| image.area).sum();
    let shares = images.iter().map(|image| image.area / total);
    let (chosen, u) = choose(shares, (drawn[0] - REST) / (1.0 - REST))?;
    let image = &images[chosen];
    let (at, inverse_density) = Overlap::new(image, domain, fixed)?.point([u, drawn[1]])?;
    // Where images overlap, the point belongs to the first.
    let is_taken = || images[..chosen].iter().any(|image| is_seen(image, at));
    let weight = inverse_density / domain.area() * total / (image.area * (1.0 - REST));
    (hits(at, image.light) && !is_taken()).then_some((at, weight))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ellipse(center: [f64; 2], map: [f64; 4]) -> Ellipse {
        Ellipse::new(center.into(), DMat2::ZERO, DMat2::from_cols_array(&map))
    }

    /// An image in a ring.
    fn ringed(center: [f64; 2], map: [f64; 4], ring: [f64; 2]) -> PlaneImage {
        image(center, map).clipped(ellipse(ring, [0.9, 0.0, 0.1, 0.8]), 0.5, |_, _, _| Some(0.0))
    }

    fn image(center: [f64; 2], map: [f64; 4]) -> PlaneImage {
        PlaneImage::new(ellipse(center, map), 0, Domain::Disk).expect("an ellipse")
    }

    /// A mirror that ends within the images.
    fn hits(at: DVec2, _: usize) -> bool {
        at.x + at.y < 0.7
    }

    /// Points of a grid over the unit square.
    fn grid() -> impl Iterator<Item = [f64; 2]> {
        let side = 1024;
        let at = move |index: i32| (f64::from(index) + 0.5) / f64::from(side);
        (0..side * side).map(move |index| [at(index % side), at(index / side)])
    }

    /// The mean of a function over the domain by strata.
    fn mean_by_strata(images: &[PlaneImage], domain: Domain, value: impl Fn(DVec2) -> f64) -> f64 {
        let uniform = |u| Some((domain.uniform(u), 1.0));
        let light = |u| stratified(images, domain, (DVec2::splat(0.5), u), hits, uniform);
        grid().filter_map(light).map(|(at, weight)| weight * value(at)).sum::<f64>() / grid().count() as f64
    }

    /// The same by a grid of squares, not by the map to the disk.
    fn mean_by_grid(domain: Domain, value: impl Fn(DVec2) -> f64) -> f64 {
        let points: Vec<DVec2> = match domain {
            Domain::Disk => grid().map(|u| 2.0 * DVec2::from(u) - 1.0).filter(|at| domain.contains(*at)).collect(),
            Domain::Square => grid().map(DVec2::from).collect(),
        };
        points.iter().map(|at| value(*at)).sum::<f64>() / points.len() as f64
    }

    #[test]
    fn strata_integrate_any_function_over_the_domain() {
        let round = [0.35, 0.0, 0.0, 0.35];
        let oblique = [0.4, 0.1, -0.05, 0.2];
        let cases = [
            vec![image([0.0, 0.0], round)],
            vec![image([0.9, 0.3], round)],
            vec![image([-0.8, 0.1], oblique), image([0.3, 0.2], round)],
            vec![image([0.1, 0.1], oblique), image([0.3, 0.2], round), image([5.0, 0.0], round)],
            vec![ringed([0.1, 0.1], oblique, [0.5, 0.1]), ringed([0.3, 0.2], round, [0.4, 0.3])],
            vec![ringed([0.1, 0.1], oblique, [0.9, -0.7])],
        ];
        for images in &cases {
            for domain in [Domain::Disk, Domain::Square] {
                let images = &images.iter().filter_map(|image| image.overlapping(domain)).collect::<Vec<_>>();
                let smooth = |at: DVec2| 1.0 + at.x + 0.3 * at.y * at.y;
                let seen = |at: DVec2| {
                    let is_seen = images.iter().any(|image| image.contains(DVec2::splat(0.5), at));
                    let is_seen = is_seen && hits(at, 0);
                    smooth(at) * if is_seen { 1000.0 } else { 1.0 }
                };
                let [a, b] = [mean_by_strata(images, domain, seen), mean_by_grid(domain, seen)];
                assert!((a / b - 1.0).abs() < 2e-3, "{a} for {b}: {domain:?} {images:?}");
            }
        }
    }

    #[test]
    fn the_light_of_an_image_hardly_varies() {
        let image = image([0.6, 0.5], [0.35, 0.0, 0.0, 0.35]);
        let images = [image.overlapping(Domain::Disk).expect("an overlap")];
        let fixed = DVec2::splat(0.5);
        let uniform = |u| Some((Domain::Disk.uniform(u), 1.0));
        let light = |u| {
            let seen = stratified(&images, Domain::Disk, (fixed, u), |_, _| true, uniform);
            seen.map_or(0.0, |(at, weight)| if images[0].contains(fixed, at) { weight } else { 0.0 })
        };
        let (sum, squares) = grid().map(light).fold((0.0, 0.0), |(sum, squares), l| (sum + l, squares + l * l));
        let count = grid().count() as f64;
        let relative = (squares * count / (sum * sum) - 1.0).sqrt();
        // Uniform sampling: √((1−p)/p) ≈ 3 for a tenth of the pinhole.
        assert!(relative < 0.6, "{relative}");
    }
}
