//! Rays towards the images of lights in plane mirrors.
//!
//! A plane mirror shows a light with its full radiance, a thousand times that of a sheet. For a
//! point on the pixel, the points of the pinhole that may see the image fill the overlap of the
//! pinhole, the image's ellipse and, for a ring, the mirror's outline. Most rays are aimed at these
//! overlaps, and of them only those that hit the mirror are traced. The other rays sample the whole
//! pinhole and leave out what the first ones trace. The points on the pixel are drawn in proportion
//! to the area of the overlaps, and the points of an overlap uniformly. So among the aimed rays both
//! the radiance and the weight are nearly constant, and few of them suffice.

use crate::domain::Domain;
use crate::ellipse::Ellipse;
use crate::piecewise_linear::sample_linear;
use glam::{DMat2, DVec2};
use radsight_sampling::choose;
use std::f64::consts::PI;

/// Fraction of the rays that are not aimed at images. A power of two: then the low-discrepancy
/// sequence divides the rays exactly.
const REST: f64 = 0.125;

/// Strips into which an overlap is divided.
const STRIPS: usize = 8;

/// Points along each side of the pixel for the density of points on it.
const GRID_SIDE: usize = 5;

/// Positions along an overlap keep this distance from its ends, where the derivative is infinite.
const END: f64 = 1e-12;

/// Smallest density of strips, so that none is zero.
const LEAST_AREA: f64 = 1e-100;

/// Density where there is no area, relative to the mean: there may be some beside the points where
/// it is evaluated.
const FLOOR: f64 = 0.02;

/// An image that fills more than this fraction of the domain needs no stratum.
const MAX_FRACTION: f64 = 0.9;

/// A linear map may be wrong by this fraction of the radius of the light or the mirror.
const MAX_MISS: f64 = 0.1;

/// Minimum enlargement of an image, for rounding. Rays in the margin show no light: at 1e-4 they would
/// contribute most of the variance.
const MARGIN: f64 = 1e-7;

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
    strata: Vec<Option<Box<PlaneStrata>>>,
}

/// The images that one pixel sees, with the density of rays aimed at them.
#[derive(Clone, Debug)]
pub(crate) struct PlaneStrata {
    images: Vec<PlaneImage>,
    domain: Domain,
    /// The overlaps of each image with the domain, and their sum.
    areas: Vec<AreaGrid>,
    total: AreaGrid,
}

/// Approximate areas of an image's overlap with the domain, for a grid of fixed points, row by row.
/// Bilinear between them.
#[derive(Clone, Copy, Debug, Default)]
struct AreaGrid([[f64; GRID_SIDE]; GRID_SIDE]);

impl PlaneImages {
    /// By pixel.
    pub(crate) fn new(strata: Vec<Option<Box<PlaneStrata>>>) -> PlaneImages {
        PlaneImages { strata: if strata.iter().all(Option::is_none) { Vec::new() } else { strata } }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.strata.is_empty()
    }

    /// `None` where a pixel sees no image.
    pub(crate) fn of_pixel(&self, pixel: usize) -> Option<&PlaneStrata> {
        self.strata.get(pixel)?.as_deref()
    }

    pub(crate) fn sees_any(&self, pixel: usize) -> bool {
        self.of_pixel(pixel).is_some()
    }
}

/// A point of the domain and its fixed point, with a weight.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WeightedPoint {
    pub(crate) fixed: DVec2,
    pub(crate) at: DVec2,
    pub(crate) weight: f64,
}

impl PlaneStrata {
    /// Of the images that overlap the domain; `None` without any.
    pub(crate) fn new(images: impl Iterator<Item = PlaneImage>, domain: Domain) -> Option<PlaneStrata> {
        let of_image = |image: PlaneImage| Some((image, AreaGrid::new(&image, domain)?));
        let (images, areas): (Vec<PlaneImage>, Vec<AreaGrid>) = images.filter_map(of_image).unzip();
        let total = AreaGrid::total(&areas);
        (!images.is_empty()).then_some(PlaneStrata { images, domain, areas, total })
    }

    /// A point of the domain and a fixed point for two points of unit squares: aimed at an image, or
    /// by `rest`. `hits` tells whether the ray of a point first hits the mirror of this light. `None`
    /// where `rest` has no point, and where the light belongs to another stratum.
    pub(crate) fn sample(
        &self,
        (fixed, drawn): (DVec2, [f64; 2]),
        hits: impl Fn(DVec2, DVec2, usize) -> bool,
        rest: impl FnOnce([f64; 2]) -> Option<WeightedPoint>,
    ) -> Option<WeightedPoint> {
        let is_seen = |image: &PlaneImage, fixed, at| image.contains(fixed, at) && hits(fixed, at, image.light);
        if drawn[0] < REST {
            let WeightedPoint { fixed, at, weight } = rest([drawn[0] / REST, drawn[1]])?;
            let is_aimed_at = self.images.iter().any(|image| is_seen(image, fixed, at));
            return (!is_aimed_at).then_some(WeightedPoint { fixed, at, weight: weight / REST });
        }
        let (fixed, pdf) = self.total.sample(fixed)?;
        let total = self.total.at(fixed);
        let share = |areas: &AreaGrid| areas.at(fixed) / total;
        let (chosen, u) = choose(self.areas.iter().map(share), (drawn[0] - REST) / (1.0 - REST))?;
        let image = &self.images[chosen];
        let (at, inverse_density) = Overlap::new(image, self.domain, fixed)?.point([u, drawn[1]])?;
        // Where images overlap, the point belongs to the first.
        let is_taken = || self.images[..chosen].iter().any(|image| is_seen(image, fixed, at));
        let weight = inverse_density / (self.domain.area() * pdf * share(&self.areas[chosen]) * (1.0 - REST));
        (hits(fixed, at, image.light) && !is_taken()).then_some(WeightedPoint { fixed, at, weight })
    }
}

impl AreaGrid {
    /// `None` where they do not overlap.
    fn new(image: &PlaneImage, domain: Domain) -> Option<AreaGrid> {
        let at = |index: usize| index as f64 / (GRID_SIDE - 1) as f64;
        let area = |fixed: DVec2| Overlap::new(image, domain, fixed).map_or(0.0, |overlap| overlap.area());
        let of_row = |y: usize| std::array::from_fn(|x| area(DVec2::new(at(x), at(y))));
        let mut areas: [[f64; GRID_SIDE]; GRID_SIDE] = std::array::from_fn(of_row);
        let floor = FLOOR * areas.iter().flatten().sum::<f64>() / (GRID_SIDE * GRID_SIDE) as f64;
        areas.iter_mut().flatten().for_each(|area| *area = area.max(floor));
        (floor > 0.0).then_some(AreaGrid(areas))
    }

    fn total(grids: &[AreaGrid]) -> AreaGrid {
        let mut total = AreaGrid::default();
        for grid in grids {
            let of_grid = grid.0.iter().flatten();
            total.0.iter_mut().flatten().zip(of_grid).for_each(|(sum, area)| *sum += area);
        }
        total
    }

    /// A fixed point in proportion to the area, for a point of the unit square, and its pdf.
    fn sample(&self, u: DVec2) -> Option<(DVec2, f64)> {
        let (down, pdf_down) = sample_linear(&self.0.map(|row| integral(&row)), u.y)?;
        let (along, pdf_along) = sample_linear(&self.row_at(down), u.x)?;
        Some((DVec2::new(along, down), pdf_down * pdf_along))
    }

    fn at(&self, fixed: DVec2) -> f64 {
        let (column, share) = AreaGrid::place(fixed.x);
        let row = self.row_at(fixed.y);
        row[column] + share * (row[column + 1] - row[column])
    }

    /// The interpolated row at a position from 0 to 1.
    fn row_at(&self, position: f64) -> [f64; GRID_SIDE] {
        let (row, share) = AreaGrid::place(position);
        let [above, below] = [&self.0[row], &self.0[row + 1]];
        std::array::from_fn(|column| above[column] + share * (below[column] - above[column]))
    }

    /// The interval of the grid that contains a position, and the share of it before the position.
    fn place(position: f64) -> (usize, f64) {
        let scaled = position * (GRID_SIDE - 1) as f64;
        let first = (scaled as usize).min(GRID_SIDE - 2);
        (first, scaled - first as f64)
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
}

impl PlaneImage {
    /// `None` for an image without area or one that fills the domain.
    pub(crate) fn new(image: Ellipse, light: usize, domain: Domain) -> Option<PlaneImage> {
        let is_small = PI * image.relative_area() <= MAX_FRACTION * domain.area();
        (image.is_finite() && is_small).then_some(PlaneImage { image, outline: None, opening: None, light })
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

    /// The coordinate along the axis at a position above 0 and below 1, and its derivative. The
    /// distance from an end is a power of 2/3, so the area per position is nearly constant where the
    /// overlap is round.
    fn along(&self, position: f64) -> (f64, f64) {
        let from_end = 2.0 * position.min(1.0 - position);
        let root = from_end.cbrt();
        let along = 0.5 * root * root;
        let along = if position < 0.5 { along } else { 1.0 - along };
        (self.start + self.length * along, self.length * 2.0 / 3.0 / root)
    }

    /// The area per position at a position.
    fn area_at(&self, position: f64) -> f64 {
        let (along, slope) = self.along(position);
        slope * self.strip(along).iter().map(|[low, high]| high - low).sum::<f64>()
    }

    /// The same between the strips; at the ends that of a line through the two nearest points.
    fn strip_areas(&self) -> [f64; STRIPS + 1] {
        let mut areas = [0.0; STRIPS + 1];
        (1..STRIPS).for_each(|strip| areas[strip] = self.area_at(strip as f64 / STRIPS as f64));
        let half = 0.5 / STRIPS as f64;
        areas[0] = (2.0 * self.area_at(half) - areas[1]).max(0.0);
        areas[STRIPS] = (2.0 * self.area_at(1.0 - half) - areas[STRIPS - 1]).max(0.0);
        areas
    }

    /// Approximate area.
    fn area(&self) -> f64 {
        integral(&self.strip_areas())
    }

    /// A point of the overlap and its inverse density by area, which is nearly the area.
    fn point(&self, u: [f64; 2]) -> Option<(DVec2, f64)> {
        let mut areas = self.strip_areas();
        let floor = (FLOOR * integral(&areas)).max(LEAST_AREA);
        areas.iter_mut().for_each(|area| *area = area.max(floor));
        let (position, pdf) = sample_linear(&areas, u[0])?;
        let position = position.clamp(END, 1.0 - END);
        let (along, slope) = self.along(position);
        let [first, second] = self.strip(along);
        let [near, far] = [first, second].map(|[low, high]| high - low);
        let place = u[1] * (near + far);
        let across = if place < near { first[0] + place } else { second[0] + (place - near) };
        let point = self.axis * along + self.axis.perp() * across;
        (near + far > 0.0).then_some((point, slope * (near + far) / pdf))
    }
}

/// The integral over the unit interval of values at equidistant points, by the trapezoidal rule.
fn integral(values: &[f64]) -> f64 {
    let ends = 0.5 * (values[0] + values[values.len() - 1]);
    (values.iter().sum::<f64>() - ends) / (values.len() - 1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ellipse(center: [f64; 2], map: [f64; 4]) -> Ellipse {
        Ellipse::new(center.into(), DMat2::ZERO, DMat2::from_cols_array(&map))
    }

    /// An image that moves with the fixed point, with its centre for the middle of the pixel.
    fn moving(center: [f64; 2], map: [f64; 4]) -> PlaneImage {
        let slope = DMat2::from_cols_array(&[0.3, 0.0, 0.05, 0.35]);
        let origin = DVec2::from(center) - slope * Domain::MIDDLE_OF_PIXEL;
        let ellipse = Ellipse::new(origin, slope, DMat2::from_cols_array(&map));
        PlaneImage::new(ellipse, 0, Domain::Disk).expect("an ellipse")
    }

    /// An image in a ring.
    fn ringed(center: [f64; 2], map: [f64; 4], ring: [f64; 2]) -> PlaneImage {
        image(center, map).clipped(ellipse(ring, [0.9, 0.0, 0.1, 0.8]), 0.5, |_, _, _| Some(0.0))
    }

    fn image(center: [f64; 2], map: [f64; 4]) -> PlaneImage {
        PlaneImage::new(ellipse(center, map), 0, Domain::Disk).expect("an ellipse")
    }

    /// A mirror that ends within the images.
    fn hits(_: DVec2, at: DVec2, _: usize) -> bool {
        at.x + at.y < 0.7
    }

    const COUNT: u32 = 1 << 19;

    /// Evenly distributed points of the unit cube: multiples of powers of the root of x⁵ = x + 1.
    fn points() -> impl Iterator<Item = (DVec2, [f64; 2])> {
        const ROOT: f64 = 1.167_303_978_261_418_7;
        let at = |index: u32, axis: i32| (0.5 + f64::from(index) * ROOT.powi(-axis)).fract();
        (0..COUNT).map(move |index| (DVec2::new(at(index, 1), at(index, 2)), [at(index, 3), at(index, 4)]))
    }

    /// The mean of a function of the fixed point and the domain by strata.
    fn mean_by_strata(strata: &PlaneStrata, value: impl Fn(DVec2, DVec2) -> f64) -> f64 {
        let light = |(fixed, u)| {
            let uniform = |u| Some(WeightedPoint { fixed, at: strata.domain.uniform(u), weight: 1.0 });
            strata.sample((fixed, u), hits, uniform)
        };
        let sum: f64 = points().filter_map(light).map(|point| point.weight * value(point.fixed, point.at)).sum();
        sum / f64::from(COUNT)
    }

    /// The same without strata, and not by the map to the disk.
    fn mean_by_points(domain: Domain, value: impl Fn(DVec2, DVec2) -> f64) -> f64 {
        let place = |at: [f64; 2]| if domain == Domain::Disk { 2.0 * DVec2::from(at) - 1.0 } else { at.into() };
        let inside = points().map(|(fixed, at)| (fixed, place(at))).filter(|(_, at)| domain.contains(*at));
        let (sum, count) = inside.fold((0.0, 0.0), |(sum, count), (fixed, at)| (sum + value(fixed, at), count + 1.0));
        sum / count
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
            vec![ringed([0.1, 0.1], oblique, [0.7, -0.5])],
            vec![moving([1.3, 0.2], round), moving([0.1, -0.9], oblique)],
        ];
        for images in &cases {
            for domain in [Domain::Disk, Domain::Square] {
                let strata = PlaneStrata::new(images.iter().copied(), domain).expect("an overlap");
                let smooth = |at: DVec2| 1.0 + at.x + 0.3 * at.y * at.y;
                let seen = |fixed: DVec2, at: DVec2| {
                    let is_seen = strata.images.iter().any(|image| image.contains(fixed, at));
                    smooth(at) * if is_seen && hits(fixed, at, 0) { 1000.0 } else { 1.0 }
                };
                let [a, b] = [mean_by_strata(&strata, seen), mean_by_points(domain, seen)];
                assert!((a / b - 1.0).abs() < 2e-3, "{a} for {b}: {domain:?} {images:?}");
            }
        }
    }

    #[test]
    fn the_light_of_an_image_hardly_varies() {
        let round = [0.35, 0.0, 0.0, 0.35];
        for (image, largest) in [(image([0.6, 0.5], round), 0.05), (moving([0.9, 0.6], round), 0.1)] {
            let strata = PlaneStrata::new([image].into_iter(), Domain::Disk).expect("an overlap");
            let light = |u| strata.sample(u, |_, _, _| true, |_| None).map_or(0.0, |point| point.weight);
            let aimed = points().filter(|(_, drawn)| drawn[0] >= REST).map(light);
            let sums =
                |[count, sum, squares]: [f64; 3], light: f64| [count + 1.0, sum + light, squares + light * light];
            let [count, sum, squares] = aimed.fold([0.0; 3], sums);
            let relative = (squares * count / (sum * sum) - 1.0).sqrt();
            assert!(relative < largest, "{relative}");
        }
    }
}
