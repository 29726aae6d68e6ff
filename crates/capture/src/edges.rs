//! Possible edges of a picture, found before lights are sampled.
//!
//! One ray through the centre of each pixel returns the surface that it hits and the lights that
//! reach it. An edge is where these differ between pixels, or where the radiance itself is sharp.
//! The pinhole blurs an edge over the pixels that its image covers there.

use crate::Exposer;
use crate::lattice::Lattice;
use crate::mirrored_lights::PixelImages;
use radsight_pinhole::{CameraRay, Rays};
use radsight_render::{Ray, SmoothView};
use rayon::prelude::*;
use std::ops::RangeInclusive;

/// Edges of a picture as a summed-area table, so that any rectangle is queried in one step.
#[derive(Debug)]
pub(crate) struct Edges {
    columns: usize,
    rows: usize,
    /// Number of edges left of and above each corner of pixels.
    sums: Vec<u32>,
    /// The number of pixels over which the pinhole blurs an edge.
    blur: usize,
}

impl Edges {
    /// Finds the edges of a picture.
    pub(crate) fn find(exposer: &Exposer<'_>, images: &PixelImages) -> Edges {
        let (plan, rays) = (exposer.renderer.plan(), exposer.rays);
        let (columns, rows) = (rays.camera().columns() as usize, rays.camera().rows() as usize);
        let views: Vec<Option<SmoothView>> = (0..columns * rows)
            .into_par_iter()
            .with_min_len(64)
            .map(|pixel| center_ray(rays, pixel).and_then(|ray| plan.smooth_view(&ray)))
            .collect();
        let is_edge = |pixel: usize| {
            let differs = |other: usize| views.get(other).is_some_and(|other| !are_alike(&views[pixel], other));
            let is_last = (pixel + 1).is_multiple_of(columns);
            images.sees_any(pixel)
                || views[pixel].is_none()
                || (!is_last && differs(pixel + 1))
                || differs(pixel + columns)
        };
        let edges: Vec<bool> = (0..columns * rows).map(is_edge).collect();
        let blur_at = |pixel: usize| {
            let distance = |pixel: usize| center_ray(rays, pixel).and_then(|ray| plan.distance(&ray));
            let near = [Some(pixel), Some(pixel + 1), Some(pixel + columns)].into_iter().flatten();
            let nearest = near.filter(|near| *near < columns * rows).filter_map(distance).fold(f64::INFINITY, f64::min);
            blur(rays, pixel as u64, nearest)
        };
        let farthest =
            (0..edges.len()).into_par_iter().filter(|pixel| edges[*pixel]).map(blur_at).reduce(|| 0.0, f64::max);
        let blur = farthest.min((columns + rows) as f64).ceil() as usize;
        Edges { columns, rows, sums: summed(&edges, columns), blur }
    }

    /// The coarsest level at which no point of a cell's interpolation is near an edge; the finest
    /// level if there is none.
    pub(crate) fn level(&self, lattice: &Lattice, cell: usize) -> u8 {
        let [columns, rows] = lattice.cell(cell);
        let is_clear = |level: &u8| {
            let margin = self.blur + 1 + Lattice::stride(*level);
            !self.any(&columns, &rows, margin)
        };
        (1..lattice.finest()).find(is_clear).unwrap_or(lattice.finest())
    }

    fn any(&self, columns: &RangeInclusive<usize>, rows: &RangeInclusive<usize>, margin: usize) -> bool {
        let grown = |range: &RangeInclusive<usize>, count: usize| {
            [range.start().saturating_sub(margin), (range.end() + margin + 1).min(count)]
        };
        let ([left, right], [top, bottom]) = (grown(columns, self.columns), grown(rows, self.rows));
        let sum = |x: usize, y: usize| self.sums[y * (self.columns + 1) + x];
        sum(right, bottom) + sum(left, top) > sum(left, bottom) + sum(right, top)
    }
}

fn center_ray(rays: &Rays, pixel: usize) -> Option<Ray> {
    let ray = rays.ray_through(pixel as u64, [0.5; 2], [0.0; 2])?;
    Ray::new(ray.origin, ray.direction)
}

fn are_alike(a: &Option<SmoothView>, b: &Option<SmoothView>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => a.joins(b),
        _ => false,
    }
}

/// Number of pixels over which the pinhole blurs an object at a distance.
fn blur(rays: &Rays, pixel: u64, distance: f64) -> f64 {
    let through = |place, on_pinhole| rays.ray_through(pixel, place, on_pinhole);
    let (Some(middle), Some(rim), Some(beside)) =
        (through([0.5; 2], [0.0; 2]), through([0.5; 2], [1.0, 0.0]), through([1.5, 0.5], [0.0; 2]))
    else {
        return 0.0;
    };
    let apart = |other: &CameraRay| {
        let by_direction = other.direction - middle.direction;
        if distance.is_finite() {
            (other.origin - middle.origin + by_direction * distance).length()
        } else {
            by_direction.length()
        }
    };
    let blur = apart(&rim) / apart(&beside);
    if blur.is_finite() { blur } else { 0.0 }
}

/// The number of edges left of and above each corner.
fn summed(edges: &[bool], columns: usize) -> Vec<u32> {
    let mut sums = vec![0; columns + 1];
    for row in edges.chunks(columns) {
        let above = sums.len() - columns - 1;
        let mut of_row = 0;
        sums.push(0);
        for (x, edge) in row.iter().enumerate() {
            of_row += u32::from(*edge);
            sums.push(sums[above + x + 1] + of_row);
        }
    }
    sums
}
