//! Rays of a pixel that are aimed at the lights that it may see.
//!
//! A lamp, or its reflection in a mirror or pane, that covers a hundredth of a pixel is missed by
//! most first samples, and then no estimate of the error knows of it. So the outlines of all lights
//! are projected onto the film ([`LightImage`]). A pixel that is partly covered is divided into what
//! the outlines cover and the rest; both are sampled, weighted by their areas. The mean is unbiased,
//! whatever an outline leaves out and whatever hides the light, and edges of lights cause no noise.
//! Pixels that no edge of a visible light crosses are sampled as before.

use crate::projection::{Cover, PixelSquare, Visit, images, projected, visit_touched};
use crate::section::{ConvexPolygon, Partition};
use crate::view_camera::ViewCamera;
use radsight_render::{LightImage, Ray, RenderPlan};
use rayon::prelude::*;
use std::collections::HashMap;
use std::ops::Range;

/// Maximum number of emitters that a picture shows.
const MAX_EMITTERS: usize = 1 << 16;

/// Lights that cover more of a pixel than this are found by its first samples.
const MAX_COVER: f64 = 0.9;

/// A light that covers less than this of a pixel counts as nothing.
pub(crate) const MIN_COVER: f64 = 1e-9;

/// Outlines of a pixel beyond this number become one.
const MAX_OUTLINES: usize = 8;

/// Overlapping outlines are joined if they share more than this fraction of the pixel.
const MIN_OVERLAP: f64 = 1e-12;

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
        if camera.jitter <= 0.0 || camera.is_blurred() {
            return LightStrata::default();
        }
        let images = images(plan, camera, MAX_EMITTERS);
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
            let partition = Partition::new(&disjoint(seen, MAX_COVER)?)?;
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

/// Joins outlines that overlap, or are too many; `None` if they cover more than a fraction of the
/// pixel.
pub(crate) fn disjoint(mut outlines: Vec<ConvexPolygon>, most: f64) -> Option<Vec<ConvexPolygon>> {
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
    (MIN_COVER..most).contains(&area).then_some(outlines)
}

struct Search<'s> {
    plan: &'s RenderPlan,
    camera: &'s ViewCamera,
    columns: Range<usize>,
    rows: Range<usize>,
}

impl Search<'_> {
    /// The pixels that an image covers partly, with the covered part of the unit square over which
    /// the rays of the pixel are distributed.
    fn covered(&self, image: &LightImage) -> Vec<(usize, ConvexPolygon)> {
        let Some(outline) = projected(self.camera, image) else { return Vec::new() };
        let mut pixels = Vec::new();
        let visit = |column: usize, row: usize| match PixelSquare::new(column, row, self.camera.jitter).cover(&outline)
        {
            Cover::All => Visit::SkipRow,
            Cover::Part(part) => {
                pixels.push((row * self.camera.columns() + column, part));
                Visit::GoOn
            }
            Cover::Nothing => Visit::GoOn,
        };
        visit_touched(&outline, (self.columns.clone(), self.rows.clone()), visit);
        pixels
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
