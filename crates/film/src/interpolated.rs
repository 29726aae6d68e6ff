//! Pictures that are sampled as finely as they change: what `rpict -ps -pt` ask for.
//!
//! Pixels on a square grid are sampled first. A cell of the grid is interpolated where its corners
//! see the same surfaces, are nearly coplanar, and differ by no more than the contrast that is
//! allowed or than their noise; else it is divided into four, down to single pixels. Probes that
//! only look for the first surface find silhouettes between the corners. Samples that agree within
//! their noise are averaged with their neighbours before anything is interpolated.
//!
//! Source of the scheme: Radiance's `rpict` (Ward 1994), with the tests of surfaces and noise of
//! edge-aware reconstruction (Bala, Walter and Greenberg 2003; Rousselle, Manzi and Zwicker 2013).

use crate::view_camera::{CameraRay, ViewCamera, traced};
use glam::DVec3;
use radsight_render::{FirstHit, Ray, RayWorker, Renderer};
use radsight_sampling::RaySampler;
use rayon::prelude::*;
use std::ops::Range;

/// How a picture is interpolated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interpolation {
    /// Pixels between the samples of the coarsest grid (`-ps`), at least 1.
    pub spacing: f64,
    /// The largest difference between corners over their mean that is interpolated (`-pt`).
    pub contrast: f64,
}

/// The widest cell, pixels, and the fewest cells across a picture.
const WIDEST_CELL: usize = 16;
const LEAST_CELLS: usize = 8;

/// Rays through a pixel, at first and at most: where it stands for a cell of the coarsest grids, for one of the finer ones where samples around
/// are noisy, and where they are not.
const COARSE_RAYS: (u32, u32) = (4, 8);
const NOISY_RAYS: (u32, u32) = (2, 3);
const FINE_RAYS: (u32, u32) = (1, 1);

/// Rays that tell the surfaces in a pixel on a silhouette, and what sets their numbers apart.
const SILHOUETTE_PROBES: u32 = 4;
const PROBES: u64 = 1 << (46 + INDEX_LOG2);

/// Least cosine between the normals of corners of an interpolated cell.
const LEAST_COSINE: f64 = 0.9;

/// A corner is off the plane of another by at most this share of the distance between them.
const MOST_SLOPE: f64 = 0.3;

/// Samples are averaged with those up to so many steps of their grid away.
const REACH: isize = 2;

/// The least weight ([`Block::neighbors`]) of samples one step away.
const BESIDE: f64 = 4.0;

/// What is darker than this share of what is typical need not be more exact.
const DARK: f64 = 0.03;

/// Averaging with neighbours makes noise so many times smaller.
const FILTERED: f64 = 3.0;

/// Standard errors by which two samples may differ by chance.
const CHANCE: f64 = 2.0;

/// Every grid has random numbers of its own, which follow a Z-order curve, so that those of
/// neighbouring samples are evenly spread together.
const TILE_LOG2: u32 = 6;
const INDEX_LOG2: u32 = 16;

/// What the rays through a pixel found.
#[derive(Clone, Copy, Debug)]
struct Sample {
    rays: u32,
    value: [f64; 3],
    /// Squared standard error of the mean of the bands, from the rays' own spread.
    variance: f64,
    surface: Surface,
}

/// The rays through a pixel so far.
#[derive(Debug, Default)]
struct Tally {
    rays: u32,
    sum: [f64; 3],
    squares: f64,
    surface: Option<Surface>,
}

impl Tally {
    fn add(&mut self, (value, met): ([f64; 3], Surface)) {
        self.rays += 1;
        self.sum = std::array::from_fn(|band| self.sum[band] + value[band]);
        self.squares += mean(&value).powi(2);
        self.surface = Some(match self.surface {
            Some(before) if !before.joins(&met) => Surface { key: SEVERAL, ..before },
            Some(before) => before,
            None => met,
        });
    }

    fn sample(&self) -> Sample {
        let count = f64::from(self.rays.max(1));
        let value = self.sum.map(|band| band / count);
        let spread = (self.squares / count - mean(&value).powi(2)).max(0.0);
        let variance = spread / (count - 1.0).max(1.0);
        Sample { rays: self.rays, value, variance, surface: self.surface.unwrap_or(Surface::NONE) }
    }
}

/// The surface that a pixel sees.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Surface {
    /// Zero where the rays through the pixel saw several.
    key: u64,
    material: u32,
    point: DVec3,
    normal: DVec3,
    distance: f64,
}

/// Outside of the view, or beyond the aft clipping plane.
const OUTSIDE: Surface = Surface { key: 1, ..Surface::NONE };

/// No single surface.
const SEVERAL: u64 = 0;

impl Surface {
    const NONE: Surface =
        Surface { key: SEVERAL, material: u32::MAX, point: DVec3::ZERO, normal: DVec3::ZERO, distance: f64::INFINITY };

    /// What a ray in this direction met first; `key` tells what it met in all.
    fn new(key: u64, hit: Option<FirstHit>, direction: DVec3) -> Surface {
        let key = key.max(1);
        match hit {
            Some(FirstHit { distance, point, normal, material, .. }) if distance.is_finite() => {
                let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
                Surface { key, material, point, normal, distance }
            }
            _ => Surface { key, ..Surface::NONE },
        }
    }

    /// Whether what is between two pixels can be told from both.
    fn joins(&self, other: &Surface) -> bool {
        self.key == other.key && self.key != SEVERAL && self.continues(other)
    }

    /// Whether the first surface is the same, or goes on smoothly in another.
    fn continues(&self, other: &Surface) -> bool {
        if self.material != other.material || self.distance.is_finite() != other.distance.is_finite() {
            return false;
        }
        if !self.distance.is_finite() {
            return true;
        }
        let way = other.point - self.point;
        let (length, normals) = (way.length(), [self.normal, other.normal]);
        normals[0].dot(normals[1]) >= LEAST_COSINE
            && normals.iter().all(|normal| normal.dot(way).abs() <= MOST_SLOPE * length + 1e-9)
    }
}

/// A square of pixels with a sampled pixel at each corner.
#[derive(Clone, Copy, Debug)]
struct Cell {
    left: usize,
    top: usize,
    right: usize,
    bottom: usize,
}

impl Cell {
    fn corners(&self) -> [(usize, usize); 4] {
        [(self.left, self.top), (self.right, self.top), (self.left, self.bottom), (self.right, self.bottom)]
    }

    fn is_divisible(&self) -> bool {
        self.right - self.left > 1 || self.bottom - self.top > 1
    }

    /// The columns and rows at which it is divided.
    fn parts(&self) -> (Vec<usize>, Vec<usize>) {
        let halves = |first: usize, last: usize| {
            let middle = first + (last - first) / 2;
            if middle > first { vec![first, middle, last] } else { vec![first, last] }
        };
        (halves(self.left, self.right), halves(self.top, self.bottom))
    }

    fn divided(&self) -> impl Iterator<Item = Cell> + use<> {
        let (columns, rows) = self.parts();
        let rows: Vec<(usize, usize)> = rows.windows(2).map(|pair| (pair[0], pair[1])).collect();
        rows.into_iter().flat_map(move |(top, bottom)| {
            let cells: Vec<Cell> =
                columns.windows(2).map(|pair| Cell { left: pair[0], right: pair[1], top, bottom }).collect();
            cells
        })
    }
}

/// Samples of a block of rows, and the rows around it that its interpolation needs.
#[derive(Debug)]
struct Block<'b> {
    renderer: &'b Renderer,
    camera: &'b ViewCamera,
    interpolation: Interpolation,
    /// Differences below this are not seen.
    darkness: f64,
    first_row: usize,
    rows: usize,
    /// Those of its rows, from `first_row` on, that are wanted.
    wanted: Range<usize>,
    samples: Vec<Option<Sample>>,
    /// The spacing of the grid by which each pixel was sampled; 0 for none.
    spacing: Vec<u8>,
}

/// The pixels of a block of rows.
pub(crate) fn block(
    renderer: &Renderer,
    camera: &ViewCamera,
    interpolation: Interpolation,
    rows: &Range<usize>,
) -> Vec<[f32; 3]> {
    let spacing = interpolation.grid(camera.columns().min(camera.rows()));
    // Whole cells, and one more on either side for averages.
    let first_row = (rows.start / spacing).saturating_sub(1) * spacing;
    let last_row = (rows.end.div_ceil(spacing) * spacing + spacing).min(camera.rows() - 1);
    let count = last_row + 1 - first_row;
    let mut block = Block {
        renderer,
        camera,
        interpolation,
        darkness: 0.0,
        first_row,
        rows: count,
        wanted: rows.start - first_row..rows.end - first_row,
        samples: vec![None; count * camera.columns()],
        spacing: vec![0; count * camera.columns()],
    };
    let smooth = block.sample(spacing);
    let pixels = block.interpolated(&smooth);
    let columns = camera.columns();
    pixels[(rows.start - first_row) * columns..(rows.end - first_row) * columns].to_vec()
}

impl Interpolation {
    /// The spacing of the coarsest grid for a picture whose shorter side has so many pixels, a power of two.
    fn grid(&self, side: usize) -> usize {
        let spacing = self.spacing.clamp(1.0, WIDEST_CELL as f64) as usize;
        1 << spacing.min(side / LEAST_CELLS).max(1).ilog2()
    }
}

impl Block<'_> {
    fn at(&self, (column, row): (usize, usize)) -> usize {
        row * self.camera.columns() + column
    }

    fn sampled(&self, pixel: (usize, usize)) -> Option<&Sample> {
        self.samples[self.at(pixel)].as_ref()
    }

    /// Samples the block and gives the cells that are interpolated.
    fn sample(&mut self, spacing: usize) -> Vec<Cell> {
        let steps = |count: usize| -> Vec<usize> {
            let mut steps: Vec<usize> = (0..count).step_by(spacing).collect();
            if steps.last().is_some_and(|last| *last + 1 < count) {
                steps.push(count - 1);
            }
            steps
        };
        let (columns, rows) = (steps(self.camera.columns()), steps(self.rows));
        let first: Vec<(usize, usize)> =
            rows.iter().flat_map(|row| columns.iter().map(move |column| (*column, *row))).collect();
        self.trace(first.into_iter().map(|pixel| (pixel, false)).collect(), spacing);
        self.darkness = DARK * self.interpolation.contrast * self.typical();
        let pairs = |steps: &[usize]| -> Vec<(usize, usize)> {
            if steps.len() < 2 { vec![(0, 0)] } else { steps.windows(2).map(|pair| (pair[0], pair[1])).collect() }
        };
        let mut cells: Vec<Cell> = Vec::new();
        for (top, bottom) in pairs(&rows) {
            // Beyond what is wanted only the first samples count, for averages.
            if top < self.wanted.end && bottom >= self.wanted.start {
                cells.extend(pairs(&columns).into_iter().map(|(left, right)| Cell { left, right, top, bottom }));
            }
        }
        let mut smooth = Vec::new();
        let mut finer = spacing;
        while !cells.is_empty() {
            let is_smooth: Vec<bool> = cells.par_iter().with_min_len(64).map(|cell| self.is_smooth(cell)).collect();
            let mut divided = Vec::new();
            let mut wanted = Vec::new();
            for (cell, is_smooth) in cells.into_iter().zip(is_smooth) {
                if is_smooth {
                    smooth.push(cell);
                } else if cell.is_divisible() {
                    let (columns, rows) = cell.parts();
                    let noisy = self.is_noisy(&cell);
                    wanted
                        .extend(rows.iter().flat_map(|row| columns.iter().map(move |column| ((*column, *row), noisy))));
                    divided.extend(cell.divided());
                }
            }
            finer = (finer / 2).max(1);
            wanted.retain(|(pixel, _)| self.samples[self.at(*pixel)].is_none());
            // A pixel between cells is as noisy as the noisier of them.
            wanted.sort_unstable_by_key(|((column, row), noisy)| (*row, *column, !noisy));
            wanted.dedup_by_key(|(pixel, _)| *pixel);
            self.trace(wanted, finer);
            cells = divided.into_iter().filter(Cell::is_divisible).collect();
        }
        smooth
    }

    /// The median of the samples so far that are not black.
    fn typical(&self) -> f64 {
        let mut values: Vec<f64> =
            self.samples.iter().flatten().map(|sample| mean(&sample.value)).filter(|value| *value > 0.0).collect();
        let middle = values.len() / 2;
        if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
    }

    /// Whether the light on the surfaces at the corners of a cell is noisy.
    fn is_noisy(&self, cell: &Cell) -> bool {
        cell.corners().into_iter().filter_map(|corner| self.sampled(corner)).any(|sample| {
            sample.surface.key != SEVERAL && sample.variance.sqrt() > self.allowed_noise(sample) + self.darkness
        })
    }

    fn allowed_noise(&self, sample: &Sample) -> f64 {
        FILTERED * self.interpolation.contrast * mean(&sample.value)
    }

    fn trace(&mut self, pixels: Vec<((usize, usize), bool)>, spacing: usize) {
        let (renderer, block) = (self.renderer, &*self);
        let samples: Vec<Sample> = pixels
            .par_iter()
            .with_min_len(16)
            .map_init(
                || renderer.worker(),
                |worker, (pixel, noisy)| block.sample_of(worker, *pixel, spacing, block.rays_of(spacing, *noisy)),
            )
            .collect();
        for ((pixel, _), sample) in pixels.into_iter().zip(samples) {
            let at = self.at(pixel);
            self.samples[at] = Some(sample);
            self.spacing[at] = spacing as u8;
        }
    }

    /// How many rays go through a pixel of a grid, at first and at most.
    fn rays_of(&self, spacing: usize, noisy: bool) -> (u32, u32) {
        match spacing {
            4.. => COARSE_RAYS,
            _ if noisy => NOISY_RAYS,
            _ => FINE_RAYS,
        }
    }

    /// Rays go through a pixel until their mean is as exact as the contrast that is allowed, unless they differ since they meet several surfaces.
    fn sample_of(
        &self,
        worker: &mut RayWorker<'_>,
        (column, row): (usize, usize),
        spacing: usize,
        (first, most): (u32, u32),
    ) -> Sample {
        let row = row + self.first_row;
        let mut tally = Tally::default();
        let mut wanted = first;
        loop {
            for number in tally.rays..wanted {
                let index = numbered([column, row], spacing, COARSE_RAYS.1, number);
                let sampler = RaySampler::new(self.renderer.plan().seed(), index);
                // A single ray stands for the pixel best from its middle: what lies on its border is found by probes.
                let ray = if most == 1 {
                    self.camera.middle_ray(column, row, &sampler)
                } else {
                    self.camera.ray(column, row, &sampler)
                };
                tally.add(ray.map_or(([0.0; 3], OUTSIDE), |ray| seen(worker, index, &ray)));
            }
            let sample = tally.sample();
            let is_exact = sample.variance.sqrt() <= self.allowed_noise(&sample) + self.darkness;
            if wanted >= most || sample.surface.key == SEVERAL || is_exact {
                return sample;
            }
            wanted = (2 * wanted).min(most);
        }
    }

    /// Whether all pixels of a cell can be told from its corners.
    fn is_smooth(&self, cell: &Cell) -> bool {
        let corners = cell.corners().map(|corner| self.sampled(corner));
        let [Some(first), Some(second), Some(third), Some(fourth)] = corners else { return false };
        let corners = [first, second, third, fourth];
        for (index, one) in corners.iter().enumerate() {
            for other in &corners[index + 1..] {
                if !one.surface.joins(&other.surface) || !self.agree(one, other) {
                    return false;
                }
            }
        }
        self.probes(cell).all(|pixel| self.probe(pixel, &first.surface))
    }

    /// Whether two samples differ by no more than is allowed, or than moderate noise.
    fn agree(&self, one: &Sample, other: &Sample) -> bool {
        let chance = CHANCE * (one.variance + other.variance).sqrt();
        (0..3).all(|band| {
            let [a, b] = [one, other].map(|sample| sample.value[band]);
            let allowed = 0.5 * self.interpolation.contrast * (a + b);
            (a - b).abs() <= allowed + chance.min(FILTERED * allowed) + self.darkness
        })
    }

    /// Pixels of a cell through which a ray looks for other surfaces.
    fn probes(&self, cell: &Cell) -> impl Iterator<Item = (usize, usize)> + use<> {
        let quarters = |first: usize, last: usize| {
            let size = last - first;
            if size >= 4 { vec![first + size / 4, last - size / 4] } else { vec![first + size / 2] }
        };
        let (columns, rows) = (quarters(cell.left, cell.right), quarters(cell.top, cell.bottom));
        rows.into_iter().flat_map(move |row| {
            let row: Vec<(usize, usize)> = columns.iter().map(|column| (*column, row)).collect();
            row
        })
    }

    /// Whether a pixel sees the surface of a corner first.
    fn probe(&self, (column, row): (usize, usize), corner: &Surface) -> bool {
        let ray = self.camera.central_ray(column, row + self.first_row);
        ray.and_then(|ray| self.first_surface(&ray)).is_some_and(|surface| corner.continues(&surface))
    }

    /// What a ray meets first, without what it brings.
    fn first_surface(&self, ray: &CameraRay) -> Option<Surface> {
        let cast = Ray::new(ray.origin, ray.direction)?;
        Some(Surface::new(1, self.renderer.plan().cast(&cast), ray.direction))
    }

    /// All pixels: those that were sampled, averaged with those around as far as their noise goes,
    /// and those between them.
    fn interpolated(&self, smooth: &[Cell]) -> Vec<[f32; 3]> {
        let columns = self.camera.columns();
        let all = || (0..self.samples.len()).into_par_iter().with_min_len(256);
        let patches: Vec<Patch> = all().map(|at| self.patch(at)).collect();
        let averaged: Vec<[f64; 3]> = all().map(|at| self.averaged(&patches, at)).collect();
        let mut pixels: Vec<[f64; 3]> =
            all().map(|at| self.antialiased(&averaged, (at % columns, at / columns))).collect();
        for cell in smooth {
            let corners = cell.corners().map(|corner| averaged[self.at(corner)]);
            let [width, height] = [cell.right - cell.left, cell.bottom - cell.top].map(|size| size.max(1) as f64);
            for row in cell.top..=cell.bottom {
                for column in cell.left..=cell.right {
                    let at = self.at((column, row));
                    if self.samples[at].is_some() {
                        continue;
                    }
                    let right = (column - cell.left) as f64 / width;
                    let down = (row - cell.top) as f64 / height;
                    let shares =
                        [(1.0 - right) * (1.0 - down), right * (1.0 - down), (1.0 - right) * down, right * down];
                    pixels[at] = std::array::from_fn(|band| {
                        shares.iter().zip(&corners).map(|(share, corner)| share * corner[band]).sum()
                    });
                }
            }
        }
        pixels.into_iter().map(|pixel| pixel.map(|band| band as f32)).collect()
    }

    /// A pixel on a silhouette: probes find which share of it each of the surfaces around fills.
    fn antialiased(&self, averaged: &[[f64; 3]], (column, row): (usize, usize)) -> [f64; 3] {
        let own = averaged[self.at((column, row))];
        let Some(sample) = self.sampled((column, row)) else { return own };
        let [left, top] = [column, row].map(|at| at.saturating_sub(1));
        let [right, bottom] = [(column + 1).min(self.camera.columns() - 1), (row + 1).min(self.rows - 1)];
        let around = (top..=bottom).flat_map(|row| (left..=right).map(move |column| (column, row)));
        let near: Vec<(&Surface, [f64; 3])> = around
            .filter_map(|pixel| self.sampled(pixel).map(|sample| (&sample.surface, averaged[self.at(pixel)])))
            .collect();
        if near.iter().all(|(surface, _)| sample.surface.continues(surface)) {
            return own;
        }
        let mut sum = own;
        for probe in 0..SILHOUETTE_PROBES {
            let index = numbered([column, row + self.first_row], 1, SILHOUETTE_PROBES, probe) | PROBES;
            let value = self.silhouette_probe((column, row), index, &sample.surface, &near).unwrap_or(own);
            sum = std::array::from_fn(|band| sum[band] + value[band]);
        }
        sum.map(|band| band / f64::from(SILHOUETTE_PROBES + 1))
    }

    /// The value of the surface around that a probe through a pixel meets; `None` for its own.
    fn silhouette_probe(
        &self,
        (column, row): (usize, usize),
        index: u64,
        own: &Surface,
        near: &[(&Surface, [f64; 3])],
    ) -> Option<[f64; 3]> {
        let sampler = RaySampler::new(self.renderer.plan().seed(), index);
        let ray = self.camera.ray(column, row + self.first_row, &sampler)?;
        let met = self.first_surface(&ray)?;
        if own.continues(&met) {
            return None;
        }
        near.iter().find(|(surface, _)| surface.continues(&met)).map(|(_, value)| *value)
    }

    /// The spacing of the finest grid that has samples beside a pixel.
    fn step_around(&self, (column, row): (usize, usize)) -> usize {
        let spacing = usize::from(self.spacing[self.at((column, row))]);
        let has = |x: usize, y: usize| x < self.camera.columns() && y < self.rows && self.sampled((x, y)).is_some();
        let mut step = 1;
        while step < spacing
            && !has(column + step, row)
            && !has(column, row + step)
            && !has(column.wrapping_sub(step), row)
            && !has(column, row.wrapping_sub(step))
        {
            step *= 2;
        }
        step.max(1)
    }

    /// Samples of the same surface on the grid of a pixel, up to two steps away, with the weight of their distance; itself among them.
    fn neighbors(&self, (column, row): (usize, usize)) -> impl Iterator<Item = (usize, f64)> {
        let at = self.at((column, row));
        let step = self.step_around((column, row)) as isize;
        let own = self.samples[at].as_ref();
        (-REACH..=REACH).flat_map(move |down| (-REACH..=REACH).map(move |right| (right, down))).filter_map(
            move |(right, down)| {
                let x = column.checked_add_signed(right * step).filter(|x| *x < self.camera.columns())?;
                let y = row.checked_add_signed(down * step).filter(|y| *y < self.rows)?;
                let other = self.at((x, y));
                let (own, near) = (own?, self.samples[other].as_ref()?);
                // Between samples that are not side by side light may do anything, unless they agree.
                let joins = own.surface.joins(&near.surface) && (step == 1 || self.agree(own, near));
                let weight = ((REACH + 1 - right.abs()) * (REACH + 1 - down.abs())) as f64;
                (joins || other == at).then_some((other, weight))
            },
        )
    }

    /// What the samples around a pixel tell together.
    fn patch(&self, at: usize) -> Patch {
        let columns = self.camera.columns();
        let Some(sample) = self.samples[at].filter(|sample| sample.surface.key != SEVERAL) else {
            return Patch::default();
        };
        let (mut variance, mut weights) = (0.0, 0.0);
        let (mut sum, mut near) = (0.0, 0.0);
        for (index, weight) in self.neighbors((at % columns, at / columns)) {
            let Some(other) = &self.samples[index] else { continue };
            let rays = f64::from(other.rays);
            if other.rays > 1 {
                variance += weight * (rays - 1.0) * other.variance * rays;
                weights += weight * (rays - 1.0);
            }
            // Those next to it.
            if weight >= BESIDE {
                sum += rays * mean(&other.value);
                near += rays;
            }
        }
        if weights <= 0.0 || near <= 0.0 {
            return Patch::default();
        }
        let variance = variance / weights;
        let own = variance / f64::from(sample.rays);
        Patch { variance: own, mean: sum / near, variance_of_mean: variance / near }
    }

    /// The mean of a sample and those around it that see the same surface and differ by no more than noise, each by itself and with
    /// what is next to it (non-local means: Buades, Coll and Morel 2005; Rousselle, Knaus and Zwicker 2012).
    fn averaged(&self, patches: &[Patch], at: usize) -> [f64; 3] {
        let columns = self.camera.columns();
        let Some(sample) = &self.samples[at] else { return [0.0; 3] };
        let patch = &patches[at];
        if patch.variance <= 0.0 {
            return sample.value;
        }
        let (mut sum, mut weights) = ([0.0; 3], 0.0);
        for (index, weight) in self.neighbors((at % columns, at / columns)) {
            let (Some(other), near) = (&self.samples[index], &patches[index]) else { continue };
            let own = (mean(&sample.value) - mean(&other.value)).powi(2) / (patch.variance + near.variance);
            let together = (patch.mean - near.mean).powi(2) / (patch.variance_of_mean + near.variance_of_mean);
            let difference = if index == at { 0.0 } else { 0.5 * own.max(together) };
            let weight = weight * f64::from(other.rays) / (1.0 + difference.powi(2));
            sum = std::array::from_fn(|band| sum[band] + weight * other.value[band]);
            weights += weight;
        }
        sum.map(|band| band / weights)
    }
}

/// What a sample and those next to it tell of light and noise.
#[derive(Clone, Copy, Debug, Default)]
struct Patch {
    /// Squared standard error of the sample by itself, from the spread of rays around; 0 where nothing tells it.
    variance: f64,
    mean: f64,
    variance_of_mean: f64,
}

fn mean(value: &[f64; 3]) -> f64 {
    (value[0] + value[1] + value[2]) / 3.0
}

/// The number of a ray: along a Z-order curve through the samples of a grid.
fn numbered([column, row]: [usize; 2], spacing: usize, rays: u32, ray: u32) -> u64 {
    let [x, y] = [column / spacing, row / spacing].map(|at| at as u64);
    let tile = (spacing as u64) << 40 | (y >> TILE_LOG2) << 20 | (x >> TILE_LOG2);
    let within = 1 << TILE_LOG2;
    let along = morton(x % within) | morton(y % within) << 1;
    // Pixels between the grid's lines, at the border of the picture, come after all others.
    let off = u64::from(column % spacing != 0 || row % spacing != 0);
    ((tile | off << 45) << INDEX_LOG2) | (along * u64::from(rays) + u64::from(ray))
}

/// The bits of a number below 2⁸, each followed by a zero.
fn morton(number: u64) -> u64 {
    (0..8).map(|bit| (number >> bit & 1) << (2 * bit)).sum()
}

/// The radiance of a ray, and the surfaces that it shows.
fn seen(worker: &mut RayWorker<'_>, index: u64, ray: &CameraRay) -> ([f64; 3], Surface) {
    traced(worker, index, ray).map_or(([0.0; 3], OUTSIDE), |traced| {
        (traced.value, Surface::new(traced.surface_key, traced.first_hit, ray.direction))
    })
}
