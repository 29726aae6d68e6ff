//! Interpolated pictures: `rpict -ps -pt`.
//!
//! Pixels on a square grid are sampled first. A cell of the grid is interpolated if its corners see
//! the same surfaces, are nearly coplanar, and differ by no more than the allowed contrast or their
//! noise. Otherwise it is divided into four, down to single pixels. Probe rays that only find the
//! first surface detect silhouettes between the corners. Samples that agree within their noise are
//! averaged with their neighbours before interpolation. Edges of lights are drawn afterwards
//! (`drawn_lights.rs`).
//!
//! The scheme is that of Radiance's `rpict` (Ward 1994), with the surface and noise tests of
//! edge-aware reconstruction (Bala, Walter and Greenberg 2003; Rousselle, Manzi and Zwicker 2013).

use crate::drawn_lights::DrawnLights;
use crate::glint_lights::GlintLights;
use crate::grid::{Cell, INDEX_LOG2, Pixel, first_pixels, numbered};
use crate::pixel_sample::{RayValue, SEVERAL, Sample, Samples, Surface, Tally, mean};
use crate::view_camera::{CameraRay, ViewCamera};
use radsight_render::{DirectRecord, NearRecord, Ray, RayWorker, Renderer};
use radsight_sampling::RaySampler;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// How a picture is interpolated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interpolation {
    /// Spacing of the coarsest grid in pixels (`-ps`), at least 1.
    pub spacing: f64,
    /// The largest relative difference between corners that is interpolated (`-pt`).
    pub contrast: f64,
}

/// Maximum width of a cell in pixels, and minimum number of cells across a picture.
const MAX_CELL_WIDTH: usize = 16;
const MIN_CELLS: usize = 8;

/// Rays per pixel, initial and maximum: where samples are noisy, on coarse grids and on finer ones,
/// and where they are not.
const COARSE_RAYS: (u32, u32) = (2, 4);
const NOISY_RAYS: (u32, u32) = (2, 2);
const SMOOTH_RAYS: (u32, u32) = (1, 1);

/// The least spacing of a coarse grid, pixels.
const COARSE_SPACING: usize = 4;

/// Rays that find the surfaces in a silhouette pixel with a single ray, besides that, and the offset
/// of their ray numbers. Twice as many do not bring more blocks of 8 × 8 pixels near to the truth.
/// Small pictures, where they cost little beside the start of the program, have more: as many in all
/// as a picture of so many pixels.
const SILHOUETTE_PROBES: u32 = 2;
const MAX_SILHOUETTE_PROBES: u32 = 16;
const MANY_PIXELS: usize = 1 << 15;
pub(crate) const PROBES: u64 = 1 << (46 + INDEX_LOG2);

/// Pixels darker than this fraction of the typical value need no more accuracy.
const DARK_FRACTION: f64 = 0.03;

/// Factor by which the filter reduces noise.
pub(crate) const NOISE_REDUCTION: f64 = 3.0;

/// Where direct light is recorded, the first grid is sampled in grids of up to twice so many times
/// its spacing, as a power of two: each profits from what the rays of the one before recorded.
const DOUBLINGS: usize = 2;

/// Rays of different streams have independent numbers. A grid's stream is its spacing; those of the
/// first grids with a larger spacing end here.
const STREAMS: usize = 32;

/// The stream of the further rays of the finest pixels.
pub(crate) const SPARE_STREAM: usize = STREAMS - 1 - DOUBLINGS;

/// Number of pixels at the corners of the four parts of a cell that are not corners of the cell.
const PIXELS_OF_PARTS: usize = 5;

/// Number of pixels that are traced together, enough for many threads.
const TRACED_TOGETHER: usize = 1 << 12;

/// Minimum weight of the records at a corner of a cell: others may lie on another surface.
const LEAST_SHARE: f64 = 0.01;

/// Samples of a block of rows, and of the adjacent rows that its interpolation needs.
#[derive(Debug)]
pub(crate) struct Block<'b> {
    pub(crate) renderer: &'b Renderer,
    pub(crate) camera: &'b ViewCamera,
    pub(crate) lights: &'b DrawnLights,
    pub(crate) glint_lights: &'b GlintLights,
    pub(crate) interpolation: Interpolation,
    /// Differences below this are invisible.
    pub(crate) darkness: f64,
    pub(crate) first_row: usize,
    pub(crate) rows: usize,
    /// The requested rows, from `first_row` on.
    wanted: Range<usize>,
    pub(crate) samples: Samples,
    /// The spacing of the grid on which each pixel was sampled; 0 for none.
    pub(crate) spacing: Vec<u8>,
    /// Direct light of the sampled pixels of the grids that may be divided; empty if it is not
    /// recorded.
    records: Vec<Option<Arc<DirectRecord>>>,
    /// The pixels of the finest grid.
    pub(crate) finest: Vec<Wanted>,
    /// Rays cast for all pixels, and for those of the finest grid alone.
    pub(crate) casts: u64,
    pub(crate) casts_of_finest: u64,
}

/// A pixel to be sampled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wanted {
    pub(crate) pixel: Pixel,
    noise: Noise,
    /// A cell around it whose corners are sampled; `None` on the coarsest grid.
    cell: Option<Cell>,
}

/// The value of a sampled pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PixelMean {
    pub(crate) mean: [f64; 3],
    /// Number of rays and probes.
    pub(crate) rays: u32,
}

/// The pixels of a block of rows.
pub(crate) fn block(
    renderer: &Renderer,
    camera: &ViewCamera,
    (lights, glint_lights): (&DrawnLights, &GlintLights),
    interpolation: Interpolation,
    rows: &Range<usize>,
) -> Vec<[f32; 3]> {
    let spacing = interpolation.grid(camera.columns().min(camera.rows()));
    // Whole cells, and one more on either side for the filter.
    let first_row = (rows.start / spacing).saturating_sub(1) * spacing;
    let last_row = (rows.end.div_ceil(spacing) * spacing + spacing).min(camera.rows() - 1);
    let count = last_row + 1 - first_row;
    let mut block = Block {
        renderer,
        camera,
        lights,
        glint_lights,
        interpolation,
        darkness: 0.0,
        first_row,
        rows: count,
        wanted: rows.start - first_row..rows.end - first_row,
        samples: Samples::new(count * camera.columns()),
        spacing: vec![0; count * camera.columns()],
        records: Vec::new(),
        finest: Vec::new(),
        casts: 0,
        casts_of_finest: 0,
    };
    if spacing > 1 && renderer.records_direct_light() {
        block.records = vec![None; count * camera.columns()];
    }
    let smooth = block.sample(spacing);
    let mut pixels = block.interpolated(&smooth);
    let columns = camera.columns();
    pixels.truncate((rows.end - first_row) * columns);
    pixels.drain(..(rows.start - first_row) * columns);
    lights.draw(&mut pixels, camera, rows);
    pixels
}

impl Interpolation {
    /// Maximum number of rays of a pixel of the coarsest grid.
    #[must_use]
    pub fn most_rays(&self) -> u32 {
        let noise = if self.spacing as usize >= COARSE_SPACING { Noise::High } else { Noise::Low };
        rays_of(self.spacing as usize, noise).1
    }

    /// The largest width of a light that is drawn, pixels.
    pub(crate) fn widest_drawn_light(&self, camera: &ViewCamera) -> f64 {
        self.grid(camera.columns().min(camera.rows())) as f64
    }

    /// The spacing of the coarsest grid for a picture whose shorter side has `side` pixels, a power
    /// of two.
    fn grid(&self, side: usize) -> usize {
        let spacing = self.spacing.clamp(1.0, MAX_CELL_WIDTH as f64) as usize;
        1 << spacing.min(side / MIN_CELLS).max(1).ilog2()
    }
}

/// The noise of the light at the corners of a cell; high noise precedes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Noise {
    High,
    Low,
}

/// Number of rays of a pixel of a grid, initial and maximum.
fn rays_of(spacing: usize, noise: Noise) -> (u32, u32) {
    match (spacing, noise) {
        (COARSE_SPACING.., Noise::High) => COARSE_RAYS,
        (_, Noise::High) => NOISY_RAYS,
        (_, Noise::Low) => SMOOTH_RAYS,
    }
}

impl Block<'_> {
    pub(crate) fn at(&self, (column, row): (usize, usize)) -> usize {
        row * self.camera.columns() + column
    }

    /// The pixel with a number.
    pub(crate) fn pixel(&self, at: usize) -> Pixel {
        (at % self.camera.columns(), at / self.camera.columns())
    }

    pub(crate) fn sampled(&self, pixel: (usize, usize)) -> Option<&Sample> {
        self.samples.get(self.at(pixel))
    }

    /// Samples the block and returns the cells to interpolate.
    fn sample(&mut self, spacing: usize) -> Vec<Cell> {
        let steps = |count: usize| -> Vec<usize> {
            let mut steps: Vec<usize> = (0..count).step_by(spacing).collect();
            if steps.last().is_some_and(|last| *last + 1 < count) {
                steps.push(count - 1);
            }
            steps
        };
        let (columns, rows) = (steps(self.camera.columns()), steps(self.rows));
        let doublings = if self.records.is_empty() { 0 } else { DOUBLINGS };
        let first: Vec<(Vec<Wanted>, usize)> = (0..=doublings)
            .rev()
            .map(|doubling| {
                let stream = if doubling == 0 { spacing } else { STREAMS - doubling };
                let pixels = first_pixels([&columns, &rows], 1 << doubling, 1 << doublings);
                let wanted = |(pixel, cell)| Wanted { pixel, noise: Noise::Low, cell };
                (pixels.into_iter().map(wanted).collect(), stream)
            })
            .collect();
        for (wanted, stream) in &first {
            self.trace(wanted, (spacing, *stream));
        }
        self.darkness = self.interpolation.contrast * self.typical_darkness();
        if spacing >= COARSE_SPACING {
            let is_noisy = self.noisy_samples([&columns, &rows]);
            for (wanted, stream) in &first {
                let noisy = wanted.iter().filter(|wanted| is_noisy[self.at(wanted.pixel)]);
                let noisy: Vec<Wanted> = noisy.map(|wanted| Wanted { noise: Noise::High, ..*wanted }).collect();
                self.trace(&noisy, (spacing, *stream));
            }
        }
        let pairs = |steps: &[usize]| -> Vec<(usize, usize)> {
            if steps.len() < 2 { vec![(0, 0)] } else { steps.windows(2).map(|pair| (pair[0], pair[1])).collect() }
        };
        let mut cells: Vec<Cell> = Vec::with_capacity(columns.len() * rows.len());
        for (top, bottom) in pairs(&rows) {
            // Outside the requested rows only the first samples are needed, for the filter.
            if top < self.wanted.end && bottom >= self.wanted.start {
                let of_row = pairs(&columns).into_iter().map(|(left, right)| Cell { left, right, top, bottom });
                cells.extend(of_row.filter(Cell::is_divisible));
            }
        }
        let mut smooth = Vec::with_capacity(cells.len());
        let mut finer = spacing;
        while !cells.is_empty() {
            let mut is_smooth: Vec<bool> = cells.par_iter().with_min_len(64).map(|cell| self.is_smooth(cell)).collect();
            self.spread_noise(&cells, &mut is_smooth);
            let mut divided = Vec::new();
            for (cell, is_smooth) in cells.into_iter().zip(is_smooth) {
                if is_smooth {
                    smooth.push(cell);
                } else if cell.is_divisible() {
                    divided.push(cell);
                }
            }
            finer = (finer / 2).max(1);
            let wanted = self.pixels_of_parts(&divided);
            self.trace(&wanted, (finer, finer));
            cells = divided.iter().flat_map(Cell::divided).filter(Cell::is_divisible).collect();
        }
        smooth
    }

    /// The pixels to be sampled at the corners of the parts of cells, each once.
    fn pixels_of_parts(&self, cells: &[Cell]) -> Vec<Wanted> {
        // A buffer that grows is copied.
        let mut wanted: Vec<Wanted> = Vec::with_capacity(PIXELS_OF_PARTS * cells.len());
        // By pixel: one more than its index in `wanted`, or 0.
        let mut places = vec![0_u32; self.samples.pixels()];
        for cell in cells {
            let [columns, rows] = cell.parts();
            let noise = if self.is_noisy(cell) { Noise::High } else { Noise::Low };
            for pixel in rows.flat_map(|row| columns.clone().map(move |column| (column, row))) {
                let at = self.at(pixel);
                if self.samples.index(at).is_some() {
                    continue;
                }
                let of_cell = Wanted { pixel, noise, cell: Some(*cell) };
                match (places[at] as usize).checked_sub(1) {
                    // A pixel between cells counts as noisy if one of them is.
                    Some(place) if noise < wanted[place].noise => wanted[place] = of_cell,
                    Some(_) => {}
                    None => {
                        wanted.push(of_cell);
                        places[at] = wanted.len() as u32;
                    }
                }
            }
        }
        wanted
    }

    /// What counts as dark, relative to the median of the samples so far that are not black.
    pub(crate) fn typical_darkness(&self) -> f64 {
        let mut values: Vec<f64> =
            self.samples.iter().map(|sample| mean(&sample.value)).filter(|value| *value > 0.0).collect();
        let center = values.len() / 2;
        let typical = if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(center, f64::total_cmp).1 };
        DARK_FRACTION * typical
    }

    /// Whether the light on the surfaces at the corners of a cell is noisy.
    fn is_noisy(&self, cell: &Cell) -> bool {
        cell.corners().into_iter().filter_map(|corner| self.sampled(corner)).any(|sample| {
            sample.surface.key != SEVERAL && sample.variance.sqrt() > self.allowed_noise(sample) + self.darkness
        })
    }

    fn allowed_noise(&self, sample: &Sample) -> f64 {
        NOISE_REDUCTION * self.interpolation.contrast * mean(&sample.value)
    }

    /// Traces the rays of pixels of a grid; `stream` numbers them.
    fn trace(&mut self, pixels: &[Wanted], (spacing, stream): (usize, usize)) {
        if spacing == 1 {
            self.finest.extend_from_slice(pixels);
        }
        // In parts, whose memory is used again: the first use of a page costs as much as a ray.
        for pixels in pixels.chunks(TRACED_TOGETHER) {
            let (renderer, block) = (self.renderer, &*self);
            let traced = |worker: &mut RayWorker<'_>, wanted: &Wanted| {
                let before = worker.rays_cast();
                let (sample, record) = block.sample_of(worker, wanted, (spacing, stream));
                (sample, record, worker.rays_cast() - before)
            };
            let samples: Vec<(Sample, Option<Arc<DirectRecord>>, u64)> =
                pixels.par_iter().with_min_len(16).map_init(|| renderer.worker(), traced).collect();
            for (Wanted { pixel, .. }, (sample, record, casts)) in pixels.iter().zip(samples) {
                self.casts += casts;
                self.casts_of_finest += if spacing == 1 { casts } else { 0 };
                let at = self.at(*pixel);
                self.samples.set(at, sample);
                self.spacing[at] = spacing as u8;
                if record.is_some() {
                    self.records[at] = record;
                }
            }
        }
    }

    /// Traces rays through a pixel until their mean is as accurate as the allowed contrast, unless
    /// they differ because they hit several surfaces. Also returns the direct light of the first
    /// one, if it is recorded.
    fn sample_of(
        &self,
        worker: &mut RayWorker<'_>,
        wanted: &Wanted,
        (spacing, stream): (usize, usize),
    ) -> (Sample, Option<Arc<DirectRecord>>) {
        let (column, row) = (wanted.pixel.0, wanted.pixel.1 + self.first_row);
        let (first, most) = rays_of(spacing, wanted.noise);
        let near = self.records_around(wanted);
        let mut record = None;
        let mut tally = self.sampled(wanted.pixel).map_or_else(Tally::default, Tally::of_one_ray);
        let mut wanted = first;
        loop {
            for number in tally.rays..wanted {
                let index = numbered([column, row], (spacing, stream), COARSE_RAYS.1, number);
                // Pixels of the finest grid are never corners of cells that are divided.
                let mut of_ray = (number == 0 && spacing > 1).then(DirectRecord::default);
                tally.add(self.value_of_ray(worker, ([column, row], index), (near.as_deref(), &mut of_ray)));
                record = record.or(of_ray.filter(|_| near.is_some()));
            }
            let sample = tally.sample();
            let is_exact = sample.variance.sqrt() <= self.allowed_noise(&sample) + self.darkness;
            if wanted >= most || sample.surface.key == SEVERAL || is_exact {
                return (sample, record.map(Arc::new));
            }
            wanted = (2 * wanted).min(most);
        }
    }

    /// Traces a ray with this number through a pixel of the picture, near others if their direct light is
    /// recorded; its own is added to `record`.
    pub(crate) fn value_of_ray(
        &self,
        worker: &mut RayWorker<'_>,
        ([column, row], index): ([usize; 2], u64),
        recorded: (Option<&[NearRecord]>, &mut Option<DirectRecord>),
    ) -> RayValue {
        let sampler = RaySampler::new(self.renderer.plan().seed(), index);
        let ray = self.lights.ray_beside(self.camera, column, row, &sampler);
        ray.map_or(RayValue::OUTSIDE, |ray| RayValue::trace(worker, index, &ray, recorded))
    }

    /// Whether direct light is recorded.
    pub(crate) fn has_records(&self) -> bool {
        !self.records.is_empty()
    }

    /// Direct light at the corners of the cell around a pixel, whose rays have numbers independent of
    /// those of the pixel; `None` if it is not recorded.
    pub(crate) fn records_around(&self, wanted: &Wanted) -> Option<Vec<NearRecord>> {
        if !self.has_records() {
            return None;
        }
        let Some(cell) = &wanted.cell else { return Some(Vec::new()) };
        let near = cell.corners().into_iter().zip(cell.shares(wanted.pixel)).filter_map(|(corner, share)| {
            let record = self.records[self.at(corner)].clone()?;
            Some(NearRecord { record, weight: share.max(LEAST_SHARE) as f32 })
        });
        Some(near.collect())
    }

    /// The first surface on a ray up to the aft clipping plane, without its radiance.
    pub(crate) fn first_surface(&self, ray: &CameraRay) -> Option<Surface> {
        let cast = Ray::new(ray.origin, ray.direction)?;
        let hit = self.renderer.plan().cast(&cast);
        let hit = hit.filter(|hit| ray.length.is_none_or(|length| hit.distance <= length));
        Some(Surface::new(1, hit, ray.direction))
    }

    /// All pixels: sampled ones, filtered within their noise, and interpolated ones.
    fn interpolated(&self, smooth: &[Cell]) -> Vec<[f32; 3]> {
        let averaged = self.all_averaged();
        let samples = (0..self.samples.count()).into_par_iter().with_min_len(256);
        let mut values: Vec<PixelMean> = samples.map(|index| self.antialiased(&averaged, index)).collect();
        self.add_spare_rays(&mut values);
        self.resolve_glints(&mut values);
        let mut pixels = vec![[0.0; 3]; self.samples.pixels()];
        for (index, value) in values.into_iter().enumerate() {
            pixels[self.samples.numbered(index).0] = value.mean.map(|band| band.max(0.0) as f32);
        }
        for cell in smooth {
            let corners = cell.corners().map(|corner| self.value_of(&averaged, self.at(corner)));
            for row in cell.top..=cell.bottom {
                for column in cell.left..=cell.right {
                    let at = self.at((column, row));
                    if self.samples.index(at).is_some() {
                        continue;
                    }
                    let shares = cell.shares((column, row));
                    pixels[at] = std::array::from_fn(|band| {
                        shares.iter().zip(&corners).map(|(share, corner)| share * corner[band]).sum::<f64>().max(0.0)
                            as f32
                    });
                }
            }
        }
        pixels
    }

    /// The averaged value of a pixel; black without a sample.
    fn value_of(&self, averaged: &[[f64; 3]], pixel: usize) -> [f64; 3] {
        self.samples.index(pixel).map_or([0.0; 3], |index| averaged[index])
    }

    /// A silhouette pixel: probe rays find the fraction of it that each adjacent surface covers.
    fn antialiased(&self, averaged: &[[f64; 3]], index: usize) -> PixelMean {
        let own = averaged[index];
        let (at, sample) = self.samples.numbered(index);
        let alone = PixelMean { mean: own, rays: sample.rays };
        // Several rays of a pixel are spread over its surfaces already.
        if sample.rays != 1 {
            return alone;
        }
        let (column, row) = self.pixel(at);
        // The pixel's own ray must not decide: if only pixels that met a small body were divided
        // between it and what is behind, some of its light would be lost.
        let (mut sees_own, mut sees_other) = (false, false);
        for (near_index, near) in self.around((column, row)).filter(|(near, _)| *near != index) {
            let continues = sample.surface.continues(&near.surface);
            sees_own |= continues;
            sees_other |= !continues && !self.is_alike(&own, &averaged[near_index]);
        }
        if !sees_own || !sees_other {
            return alone;
        }
        let (mut sum, probes) = (own, silhouette_probes(self.camera.columns() * self.camera.rows()));
        for probe in 0..probes {
            let index = numbered([column, row + self.first_row], (1, 1), probes, probe) | PROBES;
            let value = self.silhouette_probe((column, row), index, &sample.surface, averaged).unwrap_or(own);
            sum = std::array::from_fn(|band| sum[band] + value[band]);
        }
        PixelMean { mean: sum.map(|band| band / f64::from(probes + 1)), rays: probes + 1 }
    }

    /// Whether two values differ by no more than the allowed contrast.
    fn is_alike(&self, one: &[f64; 3], other: &[f64; 3]) -> bool {
        let is_alike = |(a, b): (&f64, &f64)| (a - b).abs() <= self.allowed_difference(*a, *b) + self.darkness;
        one.iter().zip(other).all(is_alike)
    }

    /// The samples of a pixel and of those adjacent to it, with their indices.
    pub(crate) fn around(&self, (column, row): (usize, usize)) -> impl Iterator<Item = (usize, &Sample)> {
        let [left, top] = [column, row].map(|at| at.saturating_sub(1));
        let [right, bottom] = [(column + 1).min(self.camera.columns() - 1), (row + 1).min(self.rows - 1)];
        (top..bottom + 1).flat_map(move |row| {
            let [first, last] = [left, right].map(|column| self.at((column, row)));
            let indices = (first..=last).filter_map(|at| self.samples.index(at));
            indices.map(|index| (index, self.samples.numbered(index).1))
        })
    }

    /// The value of the adjacent surface that a probe through a pixel hits; `None` for its own
    /// surface.
    fn silhouette_probe(
        &self,
        (column, row): (usize, usize),
        index: u64,
        own: &Surface,
        averaged: &[[f64; 3]],
    ) -> Option<[f64; 3]> {
        let sampler = RaySampler::new(self.renderer.plan().seed(), index);
        let ray = self.lights.ray_beside(self.camera, column, row + self.first_row, &sampler)?;
        let met = self.first_surface(&ray)?;
        if own.continues(&met) {
            return None;
        }
        self.around((column, row)).find(|(_, near)| near.surface.continues(&met)).map(|(index, _)| averaged[index])
    }
}

/// Number of probe rays of a silhouette pixel in a picture of so many pixels.
fn silhouette_probes(pixels: usize) -> u32 {
    let of_many = SILHOUETTE_PROBES as usize * MANY_PIXELS;
    ((of_many / pixels.max(1)) as u32).clamp(SILHOUETTE_PROBES, MAX_SILHOUETTE_PROBES)
}
