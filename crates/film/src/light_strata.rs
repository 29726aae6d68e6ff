//! Rays of a pixel that are aimed at the lights that it may see.
//!
//! A lamp, or its reflection in a mirror or pane, that covers a hundredth of a pixel is missed by
//! most first samples, and then no estimate of the error knows of it. So the outlines of all lights
//! are projected onto the film ([`LightImage`]). A pixel that is partly covered is divided into what
//! the outlines cover and the rest; both are sampled, weighted by their areas. The mean is unbiased,
//! whatever an outline leaves out and whatever hides the light, and edges of lights cause no noise.
//! Pixels that no edge of a visible light crosses are sampled as before.

use crate::section::{ConvexPolygon, Partition};
use crate::view_camera::ViewCamera;
use glam::{DVec2, DVec3};
use radsight_picture::ViewKind;
use radsight_render::{LightImage, Ray, RenderPlan, Viewpoint};
use rayon::prelude::*;
use std::collections::HashMap;
use std::ops::Range;

/// Lights that cover more of a pixel than this are found by its first samples.
const MAX_COVER: f64 = 0.9;

/// A light that covers less than this of a pixel counts as nothing.
const MIN_COVER: f64 = 1e-9;

/// Outlines of a pixel beyond this number become one.
const MAX_OUTLINES: usize = 8;

/// Overlapping outlines are joined if they share more than this fraction of the pixel.
const MIN_OVERLAP: f64 = 1e-12;

/// Parts into which connections of corners are divided where the projection curves them, and the
/// number of corners up to which all are connected.
const PARTS: usize = 8;
const FEW_CORNERS: usize = 8;

/// Nearest depth of an outline in a perspective view, relative to its farthest.
const MIN_DEPTH: f64 = 1e-3;

/// Rays along each side of an outline that test whether a light is visible in a pixel.
const TESTS: usize = 3;

/// The pixels that lights cover partly.
#[derive(Debug, Default)]
pub(crate) struct LightStrata {
    partitions: HashMap<usize, Partition>,
}

impl LightStrata {
    /// Finds them in a part of a film, by columns and rows. There are none without `-pj`, with an
    /// aperture, and in motion.
    pub(crate) fn find(plan: &RenderPlan, camera: &ViewCamera, part: (Range<usize>, Range<usize>)) -> LightStrata {
        if camera.jitter <= 0.0 || camera.aperture > 0.0 || camera.motion.is_some() {
            return LightStrata::default();
        }
        let view = camera.view();
        let from = match view.options().kind {
            ViewKind::Parallel => Viewpoint::Direction(view.direction()),
            _ => Viewpoint::Point(view.options().point),
        };
        let images = LightImage::all(plan, from);
        let search = Search { plan, camera, columns: part.0, rows: part.1 };
        let found: Vec<Vec<(usize, ConvexPolygon)>> =
            images.par_iter().with_min_len(64).map(|image| search.covered(image)).collect();
        let mut by_pixel: HashMap<usize, Vec<(usize, ConvexPolygon)>> = HashMap::new();
        for (image, pixels) in found.into_iter().enumerate() {
            for (pixel, polygon) in pixels {
                by_pixel.entry(pixel).or_default().push((image, polygon));
            }
        }
        let partition = |(pixel, outlines): (usize, Vec<(usize, ConvexPolygon)>)| {
            let is_seen = |(image, outline): &(usize, ConvexPolygon)| search.sees(&images[*image], pixel, outline);
            let seen = outlines.into_iter().filter(is_seen).map(|(_, outline)| outline).collect();
            let partition = Partition::new(&disjoint(seen)?)?;
            Some((pixel, partition))
        };
        let partitions = by_pixel.into_par_iter().filter_map(partition).collect();
        LightStrata { partitions }
    }

    /// The same for a fixed number of samples per pixel. A single one belongs to one stratum only,
    /// so it is better without.
    pub(crate) fn for_samples(
        samples: u32,
        plan: &RenderPlan,
        camera: &ViewCamera,
        part: (Range<usize>, Range<usize>),
    ) -> LightStrata {
        if samples > 1 { LightStrata::find(plan, camera, part) } else { LightStrata::default() }
    }

    /// The point of a pixel for a point of the unit square, and its weight.
    #[inline]
    pub(crate) fn place(&self, pixel: usize, u: [f64; 2]) -> ([f64; 2], f64) {
        if self.partitions.is_empty() {
            return (u, 1.0);
        }
        self.partitions.get(&pixel).and_then(|partition| partition.point(u)).unwrap_or((u, 1.0))
    }
}

/// Joins outlines that overlap, or are too many; `None` if they cover nearly the whole pixel.
fn disjoint(mut outlines: Vec<ConvexPolygon>) -> Option<Vec<ConvexPolygon>> {
    let join = |outlines: &[&ConvexPolygon]| {
        ConvexPolygon::hull(outlines.iter().flat_map(|outline| outline.corners()).copied().collect())
    };
    if outlines.len() > MAX_OUTLINES {
        outlines = vec![join(&outlines.iter().collect::<Vec<_>>())];
    }
    'again: loop {
        for second in 1..outlines.len() {
            for first in 0..second {
                if outlines[first].clipped(&outlines[second]).area() > MIN_OVERLAP {
                    let other = outlines.swap_remove(second);
                    outlines[first] = join(&[&outlines[first], &other]);
                    continue 'again;
                }
            }
        }
        break;
    }
    let area: f64 = outlines.iter().map(ConvexPolygon::area).sum();
    (MIN_COVER..MAX_COVER).contains(&area).then_some(outlines)
}

/// How much of a pixel an outline covers.
enum Cover {
    Nothing,
    Part(ConvexPolygon),
    All,
}

struct Search<'s> {
    plan: &'s RenderPlan,
    camera: &'s ViewCamera,
    columns: Range<usize>,
    rows: Range<usize>,
}

/// The corners of an outline in space.
#[derive(Clone, Copy, Debug)]
enum Corners<'a> {
    Positions(&'a [DVec3]),
    /// Unit directions from the eye.
    Directions(&'a [DVec3]),
}

impl Corners<'_> {
    fn of(image: &LightImage) -> Corners<'_> {
        if image.is_distant { Corners::Directions(&image.outline) } else { Corners::Positions(&image.outline) }
    }
}

impl Search<'_> {
    /// The pixels that an image covers partly, with the covered part of the unit square over which
    /// the rays of the pixel are distributed.
    fn covered(&self, image: &LightImage) -> Vec<(usize, ConvexPolygon)> {
        let Some(mut outline) = self.projected(Corners::of(image)) else { return Vec::new() };
        if !image.frame.is_empty() {
            let Some(frame) = self.projected(Corners::Positions(&image.frame)) else { return Vec::new() };
            outline = outline.clipped(&frame);
        }
        let (low, high) = outline
            .corners()
            .iter()
            .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), at| (low.min(*at), high.max(*at)));
        let range = |low: f64, high: f64, of: &Range<usize>| {
            (low.floor().max(of.start as f64) as usize)..(high.ceil().max(0.0).min(of.end as f64) as usize)
        };
        let (columns, rows) = (range(low.x, high.x, &self.columns), range(low.y, high.y, &self.rows));
        let mut pixels = Vec::new();
        for row in rows {
            let mut visit = |column: usize| match self.part_of(&outline, column, row) {
                Cover::All => false,
                Cover::Part(part) => {
                    pixels.push((row * self.camera.columns() + column, part));
                    true
                }
                Cover::Nothing => true,
            };
            // Those that are covered entirely lie between the others.
            if let Some(first) = columns.clone().find(|column| !visit(*column)) {
                let _ = (first..columns.end).rev().all(visit);
            }
        }
        pixels
    }

    /// The part of a pixel's unit square that an outline covers.
    fn part_of(&self, outline: &ConvexPolygon, column: usize, row: usize) -> Cover {
        let corner = DVec2::new(column as f64, row as f64) + 0.5 - 0.5 * self.camera.jitter;
        let square = ConvexPolygon::square().map(|at| corner + at * self.camera.jitter);
        if outline.holds(&square) {
            return Cover::All;
        }
        // From the top row down to upwards in the pixel.
        let upright = |at: DVec2| {
            let at = (at - corner) / self.camera.jitter;
            DVec2::new(at.x, 1.0 - at.y)
        };
        let part = outline.clipped(&square);
        if part.area() > 0.0 {
            Cover::Part(ConvexPolygon::hull(part.map(upright).corners().to_vec()))
        } else {
            Cover::Nothing
        }
    }

    /// The convex hull of projected points, in columns and rows from the upper left corner.
    fn projected(&self, corners: Corners<'_>) -> Option<ConvexPolygon> {
        let view = self.camera.view();
        let options = view.options();
        // The distance of a direction does not matter, except for rounding.
        let (mut points, scale): (Vec<DVec3>, f64) = match corners {
            Corners::Positions(points) => (points.iter().map(|at| *at - options.point).collect(), 1.0),
            Corners::Directions(directions) => (directions.to_vec(), 1.0 + options.fore),
        };
        match options.kind {
            ViewKind::Perspective => points = before_the_eye(&points, view.direction()),
            ViewKind::Parallel => {}
            _ => points.extend(connections(&points)),
        }
        let size = DVec2::new(self.camera.columns() as f64, self.camera.rows() as f64);
        let place = |at: &DVec3| {
            // A hemispherical view would show what lies behind it before it.
            let location = view.locate(options.point + *at * scale).filter(|location| location.distance > 0.0)?;
            Some(DVec2::new(location.x, 1.0 - location.y) * size).filter(|place| place.is_finite())
        };
        Some(ConvexPolygon::hull(points.iter().map(place).collect::<Option<Vec<DVec2>>>()?))
    }

    /// Whether some points of an outline in a pixel may show the light.
    fn sees(&self, image: &LightImage, pixel: usize, outline: &ConvexPolygon) -> bool {
        let Some(inside) = Partition::new(std::slice::from_ref(outline)) else { return false };
        let (column, row) = (pixel % self.camera.columns(), pixel / self.camera.columns());
        (0..TESTS * TESTS).any(|test| {
            let u = [test % TESTS, test / TESTS].map(|index| (index as f64 + 0.5) / TESTS as f64);
            let ray = inside.inside(u).and_then(|at| self.camera.still_ray(column, row, at));
            ray.and_then(|ray| Ray::new(ray.origin, ray.direction))
                .is_some_and(|ray| image.may_be_seen_by(self.plan, &ray))
        })
    }
}

/// The points before the eye, and where connections to the others cross a plane near it; places
/// from the eye.
fn before_the_eye(points: &[DVec3], direction: DVec3) -> Vec<DVec3> {
    let depth = |at: &DVec3| at.dot(direction);
    let nearest = MIN_DEPTH * points.iter().map(depth).fold(0.0, f64::max);
    let (before, behind): (Vec<DVec3>, Vec<DVec3>) = points.iter().partition(|at| depth(at) > nearest);
    let crossing = |before: &DVec3, behind: &DVec3| {
        let [far, near] = [before, behind].map(|at| depth(at) - nearest);
        before.lerp(*behind, far / (far - near))
    };
    let crossings = before.iter().flat_map(|before| behind.iter().map(move |behind| crossing(before, behind)));
    let crossings: Vec<DVec3> = crossings.collect();
    before.into_iter().chain(crossings).collect()
}

/// Points on the connections of a few points.
fn connections(points: &[DVec3]) -> Vec<DVec3> {
    if points.len() > FEW_CORNERS {
        return Vec::new();
    }
    let pairs = (0..points.len()).flat_map(|second| (0..second).map(move |first| (first, second)));
    let parts = |(first, second): (usize, usize)| {
        (1..PARTS).map(move |part| points[first].lerp(points[second], part as f64 / PARTS as f64))
    };
    pairs.flat_map(parts).collect()
}
