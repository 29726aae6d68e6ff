//! Possible edges of a picture, found before lights are sampled.
//!
//! One ray through the centre of each pixel returns the surface that it hits and the lights that
//! reach it. An edge is where these differ between pixels, or where the radiance itself is sharp.
//! The extent of a light blurs the edge of its cone. The pinhole blurs all edges over the pixels
//! that its image covers, and an image at a distance at least as much as one at infinity. The width
//! of the blurred edge in pixels limits the stride of a lattice that resolves it.

use crate::Exposer;
use crate::film::UnblurredFilm;
use crate::lattice::Lattice;
use crate::mirrored_lights::PixelImages;
use crate::neighbourhood::around;
use crate::shared_film::KnownFilm;
use glam::DVec2;
use radsight_pinhole::{CameraRay, Rays};
use radsight_render::{Ray, SmoothView};
use rayon::prelude::*;
use std::ops::RangeInclusive;

/// Minimum number of lattice points across a blurred edge. Then no edge lies between them unseen,
/// and residuals show where a finer lattice is needed.
const POINTS_PER_EDGE: f64 = 2.0;

/// Width from which an edge is smooth within a pixel, pixels.
const WIDE_EDGE: f64 = 1.5;

/// Edges of a picture as summed-area tables, so that any rectangle is queried in one step.
#[derive(Debug)]
pub(crate) struct Edges {
    columns: usize,
    rows: usize,
    /// By level from 1: number of pixels left of and above each corner of pixels that see an edge
    /// which the level does not resolve.
    unresolved: Vec<Vec<u32>>,
    /// The same of the pixels that see edges other than those of cones.
    other: Vec<u32>,
    /// The number of pixels over which the pinhole blurs an edge to each side.
    blur: usize,
    has_pinhole: bool,
    /// By pixel: the width of its sharpest edge, pixels; infinite if there is none.
    widths: Vec<f64>,
    /// By pixel, whether it sees the outline of a surface.
    outlines: Vec<bool>,
}

/// By how much the edges near a cell are blurred.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EdgeBlurs {
    /// No edge.
    None,
    /// By the extent of a lamp or of the pinhole.
    One,
    /// By both.
    Two,
}

/// The film whose edges are found.
#[derive(Clone, Copy)]
pub(crate) struct SearchedFilm<'a> {
    pub(crate) exposer: &'a Exposer<'a>,
    /// The images that are exposed with the picture.
    pub(crate) images: Option<&'a PixelImages>,
    /// Whether each pixel may see a highlight that is narrower than a pixel; may be empty.
    pub(crate) highlights: &'a [bool],
    /// Instead of that of the picture.
    pub(crate) unblurred: Option<&'a UnblurredFilm>,
    /// What is known of it.
    pub(crate) known: Option<&'a KnownFilm<'a>>,
}

/// The edges of the pixels of a picture.
struct PixelEdges {
    /// The width of the sharpest edge at each pixel, pixels; infinite where there is none.
    widths: Vec<f64>,
    /// The number of pixels over which the pinhole blurs any edge, at the least.
    by_pinhole: f64,
    /// Whether each pixel sees the outline of a surface.
    outlines: Vec<bool>,
}

impl Edges {
    /// Finds the edges of a picture.
    pub(crate) fn find(film: SearchedFilm<'_>, lattice: &Lattice) -> Edges {
        let (rays, plan) = (film.exposer.rays, film.exposer.renderer.plan());
        let [columns, rows] = film.size();
        let PixelEdges { widths, by_pinhole, outlines } = PixelEdges::find(film);
        let distance = |pixel: usize| film.center_ray(pixel).and_then(|ray| plan.distance_behind_panes(&ray));
        let blur_at = |pixel: usize| {
            let near = [Some(pixel), Some(pixel + 1), Some(pixel + columns)].into_iter().flatten();
            let nearest = near.filter(|near| *near < columns * rows).filter_map(distance).fold(f64::INFINITY, f64::min);
            let [across, down] = blur(rays, pixel as u64, nearest);
            across.max(down)
        };
        let has_pinhole = by_pinhole > 0.0;
        let is_blurred = |pixel: &usize| has_pinhole && widths[*pixel].is_finite();
        let farthest = (0..widths.len()).into_par_iter().filter(is_blurred).map(blur_at).reduce(|| 0.0, f64::max);
        let blur = farthest.min((columns + rows) as f64).ceil() as usize;
        let other = summed(widths.iter().map(|width| *width <= by_pinhole), columns);
        let of_level = |level: u8| {
            let least = POINTS_PER_EDGE * Lattice::stride(level) as f64;
            summed(widths.iter().map(|width| *width < least), columns)
        };
        let unresolved = (1..lattice.finest()).map(of_level).collect();
        Edges { columns, rows, unresolved, other, blur, has_pinhole, widths, outlines }
    }

    /// The width of the sharpest edge of each pixel, and whether it sees the outline of a surface.
    pub(crate) fn into_widths_and_outlines(self) -> (Vec<f64>, Vec<bool>) {
        (self.widths, self.outlines)
    }

    /// Whether radiance is smooth within each pixel of a point pinhole.
    pub(crate) fn are_wider_than_pixels(&self) -> bool {
        !self.has_pinhole && self.widths.iter().all(|width| *width >= WIDE_EDGE)
    }

    /// The coarsest level that resolves all edges near a cell's interpolation.
    pub(crate) fn level(&self, lattice: &Lattice, cell: usize) -> u8 {
        let is_resolved = |level: &u8| {
            !self.any(&self.unresolved[usize::from(*level) - 1], lattice.cell(cell), self.margin(lattice, cell, *level))
        };
        (1..lattice.finest()).find(is_resolved).unwrap_or(lattice.finest())
    }

    /// By how much the edges near a cell's interpolation at a level are blurred.
    pub(crate) fn blurs(&self, lattice: &Lattice, cell: usize, level: u8) -> EdgeBlurs {
        let is_near = |sums: &[u32]| self.any(sums, lattice.cell(cell), self.margin(lattice, cell, level));
        match &self.unresolved[..] {
            [coarsest, ..] if !is_near(coarsest) => EdgeBlurs::None,
            _ if self.has_pinhole && !is_near(&self.other) => EdgeBlurs::Two,
            _ => EdgeBlurs::One,
        }
    }

    /// Distance from a cell within which edges matter at a level, pixels.
    fn margin(&self, lattice: &Lattice, cell: usize, level: u8) -> usize {
        self.blur + 1 + lattice.support(cell, level)
    }

    fn any(&self, sums: &[u32], [columns, rows]: [RangeInclusive<usize>; 2], margin: usize) -> bool {
        let grown = |range: &RangeInclusive<usize>, count: usize| {
            [range.start().saturating_sub(margin), (range.end() + margin + 1).min(count)]
        };
        let ([left, right], [top, bottom]) = (grown(&columns, self.columns), grown(&rows, self.rows));
        let sum = |x: usize, y: usize| sums[y * (self.columns + 1) + x];
        sum(right, bottom) + sum(left, top) > sum(left, bottom) + sum(right, top)
    }
}

impl SearchedFilm<'_> {
    /// Columns and rows.
    pub(crate) fn size(&self) -> [usize; 2] {
        let camera = self.exposer.rays.camera();
        self.unblurred.map_or([camera.columns(), camera.rows()].map(|count| count as usize), UnblurredFilm::size)
    }

    /// The ray through the centres of a pixel and of the pinhole.
    fn center_ray(&self, pixel: usize) -> Option<Ray> {
        self.ray_through(pixel, [0.5; 2])
    }

    /// The ray through a place of a pixel and the centre of the pinhole.
    fn ray_through(&self, pixel: usize, place: [f64; 2]) -> Option<Ray> {
        let rays = self.exposer.rays;
        let ray = match self.unblurred {
            Some(film) => film.ray(rays, pixel, place, DVec2::ZERO).map(|on_film| on_film.ray),
            None => rays.ray_through(pixel as u64, place, [0.0; 2]),
        }?;
        Ray::new(ray.origin, ray.direction)
    }

    /// Number of pixels over which the pinhole blurs any edge, at the least.
    fn least_blur(&self) -> f64 {
        let [columns, rows] = self.size();
        // At the middle of the picture pixels are farthest apart by direction.
        let middle = ((columns * rows + columns) / 2).min(columns * rows - 1);
        let by_pinhole = || blur(self.exposer.rays, middle as u64, f64::INFINITY);
        let [across, down] = self.unblurred.map_or_else(by_pinhole, |_| [0.0; 2]);
        2.0 * across.min(down)
    }
}

impl PixelEdges {
    fn find(film: SearchedFilm<'_>) -> PixelEdges {
        let [columns, _] = film.size();
        let known = |pixel: usize| film.known.and_then(|known| known.edge_width(pixel, columns));
        let views = views(film, known);
        let by_pinhole = film.least_blur();
        let width = |pixel: usize| {
            if let Some(width) = known(pixel) {
                return width;
            }
            let differs = |other: usize| views.get(other).is_some_and(|other| !are_alike(&views[pixel], other));
            let is_last = (pixel + 1).is_multiple_of(columns);
            match &views[pixel] {
                _ if film.highlights.get(pixel) == Some(&true) => 0.0,
                _ if film.images.is_some_and(|images| images.sees_any(pixel)) => 0.0,
                Some(view) if !(differs(pixel + columns) || !is_last && differs(pixel + 1)) => {
                    view.edge_width() + by_pinhole
                }
                _ => by_pinhole,
            }
        };
        let outlines = outlines(film, &views);
        PixelEdges { widths: (0..views.len()).map(width).collect(), by_pinhole, outlines }
    }
}

/// The views of all pixels whose edges are not known, and of those beside and below them.
fn views(film: SearchedFilm<'_>, known: impl Fn(usize) -> Option<f64> + Sync) -> Vec<Option<SmoothView>> {
    let plan = film.exposer.renderer.plan();
    let [columns, rows] = film.size();
    let pixels = columns * rows;
    let centers: Vec<Option<Ray>> =
        (0..pixels).into_par_iter().with_min_len(64).map(|pixel| film.center_ray(pixel)).collect();
    // The distance to the next pixel, which is on the other side in the last column and row.
    let spacing = |pixel: usize, ray: &Ray| {
        let beside = if (pixel + 1).is_multiple_of(columns) { pixel.wrapping_sub(1) } else { pixel + 1 };
        let below = if pixel + columns < pixels { pixel + columns } else { pixel.wrapping_sub(columns) };
        let near = [beside, below].into_iter().filter_map(|near| centers.get(near).copied().flatten());
        near.map(|near| near.direction.distance(ray.direction)).fold(0.0, f64::max)
    };
    let is_needed = |pixel: usize| {
        let above = [Some(pixel), pixel.checked_sub(1), pixel.checked_sub(columns)];
        film.known.is_none() || above.into_iter().flatten().any(|pixel| known(pixel).is_none())
    };
    let seen = |pixel: usize| centers[pixel].and_then(|ray| plan.smooth_view(&ray, spacing(pixel, &ray)));
    let view = |pixel: usize| if is_needed(pixel) { seen(pixel) } else { None };
    (0..pixels).into_par_iter().with_min_len(64).map(view).collect()
}

/// Whether each pixel sees the outline of a surface: rays through its corners and its centre, and the
/// centre of the pinhole, hit different ones. Only pixels whose view differs from one beside them
/// are tested.
fn outlines(film: SearchedFilm<'_>, views: &[Option<SmoothView>]) -> Vec<bool> {
    let plan = film.exposer.renderer.plan();
    let [columns, rows] = film.size();
    let surface = |pixel: usize, place: [f64; 2]| plan.outlined_surface(&film.ray_through(pixel, place)?);
    let sees = |pixel: usize| {
        if let Some(sees) = film.known.and_then(|known| known.sees_outline(pixel)) {
            return sees;
        }
        if around(pixel, [columns, rows]).all(|other| are_alike(&views[pixel], &views[other])) {
            return false;
        }
        let middle = surface(pixel, [0.5; 2]);
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        corners.into_iter().any(|place| surface(pixel, place) != middle)
    };
    (0..columns * rows).into_par_iter().with_min_len(256).map(sees).collect()
}

fn are_alike(a: &Option<SmoothView>, b: &Option<SmoothView>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => a.joins(b),
        _ => false,
    }
}

/// Number of pixels, across and down, over which the pinhole blurs a point at a distance to each
/// side.
fn blur(rays: &Rays, pixel: u64, distance: f64) -> [f64; 2] {
    let through = |place, on_pinhole| rays.ray_through(pixel, place, on_pinhole);
    let Some(middle) = through([0.5; 2], [0.0; 2]) else { return [0.0; 2] };
    let apart = |other: &CameraRay| {
        let by_direction = other.direction - middle.direction;
        if distance.is_finite() {
            (other.origin - middle.origin + by_direction * distance).length()
        } else {
            by_direction.length()
        }
    };
    [([1.5, 0.5], [1.0, 0.0]), ([0.5, 1.5], [0.0, 1.0])].map(|(beside, rim)| {
        let (Some(rim), Some(beside)) = (through([0.5; 2], rim), through(beside, [0.0; 2])) else { return 0.0 };
        let blur = apart(&rim) / apart(&beside);
        if blur.is_finite() { blur } else { 0.0 }
    })
}

/// The number of marked pixels left of and above each corner.
fn summed(marked: impl Iterator<Item = bool>, columns: usize) -> Vec<u32> {
    let mut sums = vec![0; columns + 1];
    let mut of_row = 0;
    for (pixel, is_marked) in marked.enumerate() {
        if pixel.is_multiple_of(columns) {
            of_row = 0;
            sums.push(0);
        }
        of_row += u32::from(is_marked);
        sums.push(sums[sums.len() - columns - 1] + of_row);
    }
    sums
}
