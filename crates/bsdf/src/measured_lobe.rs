//! The lobe of a measured material: reflection and transmission by tabulated data.

use crate::frame::Frame;
use crate::sample::BsdfSample;
use crate::specular_threshold::{BelowThreshold, LobeStrength};
use crate::transmission_lobe::chance_of_second;
use glam::DVec3;
use radsight_brdf::Density;
use radsight_ir::Rgb;
use radsight_measured::{MeasuredBsdf, Scattering, Side};
use radsight_texture::{bands, luminance};
use std::f64::consts::FRAC_1_PI;

/// Data for one outgoing direction, without their Lambertian parts.
#[derive(Clone, Copy, Debug)]
pub struct MeasuredLobe<'a, const BANDS: usize> {
    /// Data for reflection.
    pub reflection: Option<&'a Scattering>,
    /// Data for transmission.
    pub transmission: Option<&'a Scattering>,
    /// Frame of the data: +z is the front's normal.
    pub frame: Frame,
    /// Outgoing direction in that frame.
    pub view: JitteredView,
    /// Factor of the transmitted light.
    pub pattern: [f64; BANDS],
    /// Cells whose light is transmitted straight through, apart from this lobe.
    pub peak: PeakCells,
    /// Whether the lobe is sampled.
    pub is_sampled: bool,
    /// Probability of sampling transmission.
    transmitted_chance: f64,
}

impl<'a, const BANDS: usize> MeasuredLobe<'a, BANDS> {
    /// `straight` is the luminance that the cells of `peak` transmit straight through. A side that
    /// scatters no more than `threshold` is not sampled; it is returned as well. None if nothing is
    /// scattered.
    pub fn new(
        [reflection, transmission]: [Option<&'a Scattering>; 2],
        (frame, view): (Frame, JitteredView),
        pattern: [f64; BANDS],
        (peak, straight): (PeakCells, f64),
        threshold: f64,
    ) -> Option<(Self, BelowThreshold<BANDS>)> {
        /// Samples that fall into the peak are lost; this many of the transmitted ones must fall
        /// beside it.
        const LEAST_BESIDE: f64 = 0.1;
        reflection.or(transmission)?;
        let total =
            |scattering: Option<&Scattering>| scattering.map_or(0.0, |scattering| scattering.total(view.jittered));
        let (reflected, through) = (total(reflection), total(transmission));
        let scattered = (through - straight).max(0.0);
        let below_threshold = BelowThreshold::new(
            threshold,
            [
                LobeStrength { share: reflected, color: [reflected; BANDS], diffuse: 1.0 },
                LobeStrength { share: scattered, color: pattern.map(|band| band * scattered), diffuse: 1.0 },
            ],
        );
        let beside = scattered.max(if straight > 0.0 { LEAST_BESIDE * through } else { 0.0 });
        let [no_reflection, no_transmission] = below_threshold.is_left_out();
        let transmitted_chance = chance_of_second(
            if no_reflection { 0.0 } else { reflected },
            if no_transmission { 0.0 } else { beside * luminance(&pattern) },
        );
        let is_sampled = reflection.is_some() && !no_reflection || transmission.is_some() && !no_transmission;
        let lobe =
            MeasuredLobe { reflection, transmission, frame, view, pattern, peak, is_sampled, transmitted_chance };
        Some((lobe, below_threshold))
    }

    /// `f·|cos θ_i|` for direct light, and the density of [`MeasuredLobe::sample`], both in 1/sr. A
    /// jittered outgoing direction has no density: direct light averages over other jittered
    /// directions, so BSDF samples leave it to light sampling.
    pub fn eval(&self, incident: DVec3) -> ([f64; BANDS], f64) {
        let incident = self.frame.to_local(incident);
        let is_transmitted = Side::of(incident) != Side::of(self.view.exact);
        let nothing = ([0.0; BANDS], 0.0);
        let part = if is_transmitted { self.transmitted() } else { self.reflected() };
        let Some((scattering, chance)) = part else { return nothing };
        if is_transmitted && self.peak.holds(scattering, self.view.exact, incident) {
            return nothing;
        }
        let value: [f64; BANDS] = bands(Rgb(self.view.value(scattering, incident)));
        let pattern = if is_transmitted { self.pattern } else { [1.0; BANDS] };
        let cosine = incident.z.abs();
        let pdf = if self.view.offset.is_some() { 0.0 } else { chance * scattering.density(self.view.exact, incident) };
        (std::array::from_fn(|band| value[band] * pattern[band] * cosine), pdf)
    }

    /// Samples a direction, returned in the scene.
    pub fn sample(&self, [u, v, choice]: [f64; 3]) -> Option<BsdfSample<BANDS>> {
        let is_transmitted = choice < self.transmitted_chance;
        let (scattering, chance) = if is_transmitted { self.transmitted() } else { self.reflected() }?;
        let sample = scattering.sample(self.view.jittered, [u, v])?;
        if is_transmitted && self.peak.holds(scattering, self.view.jittered, sample.direction) {
            return None;
        }
        let value: [f64; BANDS] = bands(Rgb(sample.weight));
        let pattern = if is_transmitted { self.pattern } else { [1.0; BANDS] };
        let pdf = if self.view.offset.is_some() { 0.0 } else { chance * sample.density };
        Some(BsdfSample {
            direction: self.frame.to_scene(sample.direction),
            weight: std::array::from_fn(|band| value[band] * pattern[band] / chance),
            pdf: Density::Continuous(pdf),
            pdf_ratio: 1.0,
        })
    }

    /// Data of reflection, and the probability of sampling it.
    fn reflected(&self) -> Option<(&'a Scattering, f64)> {
        Some((self.reflection?, 1.0 - self.transmitted_chance))
    }

    /// Data of transmission, and the probability of sampling it.
    fn transmitted(&self) -> Option<(&'a Scattering, f64)> {
        Some((self.transmission?, self.transmitted_chance))
    }
}

/// An outgoing direction jittered within a cell of the data, which hides the edges of cells.
#[derive(Clone, Copy, Debug)]
pub struct JitteredView {
    /// Unit vector towards the viewer, in the frame of the data.
    exact: DVec3,
    /// The direction jittered within the finest cell there; the lobe is sampled for it.
    jittered: DVec3,
    /// Jitter in widths of a cell, 0…1; none if edges must not be blurred.
    offset: Option<[f64; 2]>,
}

impl JitteredView {
    /// The direction without jitter.
    pub fn exact(outgoing: DVec3) -> JitteredView {
        JitteredView { exact: outgoing, jittered: outgoing, offset: None }
    }

    /// The direction jittered by two numbers in [0,1).
    pub fn new(bsdf: &MeasuredBsdf, outgoing: DVec3, offset: [f64; 2]) -> JitteredView {
        let jittered = jitter(outgoing, bsdf.resolution(outgoing).least, offset);
        JitteredView { exact: outgoing, jittered, offset: Some(offset) }
    }

    /// Value towards a light: the mean over one jittered direction in each quarter of the cell of
    /// this pair.
    fn value(&self, scattering: &Scattering, incident: DVec3) -> [f64; 3] {
        /// Jittered directions in a cell smaller by this factor are left out: a rare bright one
        /// would be noise (Radiance's).
        const LEAST_CELL: f64 = 0.12;
        let Some([u, v]) = self.offset else { return scattering.value(self.exact, incident) };
        let Some(size) = scattering.projected_solid_angle(self.exact, incident) else { return [0.0; 3] };
        let (mut sum, mut count) = ([0.0; 3], 0.0);
        for (i, j) in [(0.0, 0.0), (0.0, 0.5), (0.5, 0.0), (0.5, 0.5)] {
            let view = jitter(self.exact, size, [0.5 * u + i, 0.5 * v + j]);
            let value = scattering.value(view, incident);
            let is_dark = value == [0.0; 3];
            let other = scattering.projected_solid_angle(view, incident);
            if !is_dark && other.is_none_or(|other| other < LEAST_CELL * size) {
                continue;
            }
            sum = std::array::from_fn(|band| sum[band] + value[band]);
            count += 1.0;
        }
        sum.map(|band| if count > 0.0 { band / count } else { 0.0 })
    }
}

/// A direction jittered within a square of the given projected solid angle.
fn jitter(direction: DVec3, projected_solid_angle: f64, [u, v]: [f64; 2]) -> DVec3 {
    (direction + DVec3::new(0.5 - u, 0.5 - v, 0.0) * projected_solid_angle.sqrt()).normalize()
}

/// A peak never fills all tested cells: it must stand out from some.
const MOST_CELLS: usize = STEPS.len() - 1;

/// Cells of the data that transmit a peak straight through.
#[derive(Clone, Copy, Debug)]
pub struct PeakCells {
    cells: [u32; MOST_CELLS],
    count: u32,
}

impl PeakCells {
    /// No cells.
    pub const NONE: PeakCells = PeakCells { cells: [0; MOST_CELLS], count: 0 };

    fn holds(&self, scattering: &Scattering, outgoing: DVec3, incident: DVec3) -> bool {
        let cells = &self.cells[..self.count as usize];
        !cells.is_empty() && scattering.cell(outgoing, incident).is_some_and(|cell| cells.contains(&(cell as u32)))
    }

    fn is_full(&self) -> bool {
        self.count as usize == MOST_CELLS
    }

    fn add(&mut self, cell: usize) {
        self.cells[self.count as usize] = cell as u32;
        self.count += 1;
    }
}

/// A peak of transmission about the straight-through direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StraightTransmission {
    /// Transmittance of the peak: red, green, blue.
    pub transmittance: [f64; 3],
    pub cells: PeakCells,
}

/// Offsets at which a peak is searched, in widths of the finest cell.
const STEPS: [(f64, f64); 29] = [
    (0.0, 0.0),
    (-0.6, 0.0),
    (0.0, 0.6),
    (0.0, -0.6),
    (0.6, 0.0),
    (-0.6, 0.6),
    (-0.6, -0.6),
    (0.6, 0.6),
    (0.6, -0.6),
    (-1.2, 0.0),
    (0.0, 1.2),
    (0.0, -1.2),
    (1.2, 0.0),
    (-1.2, 1.2),
    (-1.2, -1.2),
    (1.2, 1.2),
    (1.2, -1.2),
    (-1.8, 0.0),
    (0.0, 1.8),
    (0.0, -1.8),
    (1.8, 0.0),
    (-1.8, 1.8),
    (-1.8, -1.8),
    (1.8, 1.8),
    (1.8, -1.8),
    (-2.4, 0.0),
    (0.0, 2.4),
    (0.0, -2.4),
    (2.4, 0.0),
];

/// A cell that may contain the straight-through direction.
struct Candidate {
    luminance: f64,
    color: [f64; 3],
    cell: usize,
    projected_solid_angle: f64,
}

/// Finds the peak of transmission about the straight-through direction: the brightest of the finest
/// cells there, if they stand out from enough surrounding cells. This is the search of Radiance's
/// `aBSDF` (Ward and others, "Modeling specular transmission of complex fenestration systems with
/// data-driven BSDFs", Building and Environment 196, 2021).
pub(crate) fn straight_peak(bsdf: &MeasuredBsdf, outgoing: DVec3) -> Option<StraightTransmission> {
    /// Cells larger than the finest by this factor, or darker than the peak's mean by it, are not
    /// part of a peak.
    const LARGEST_CELL: f64 = 1.5;
    const DARKEST: f64 = 8.0;
    /// Smallest solid angle of the surrounding cells, as a fraction of the peak's.
    const LEAST_SURROUNDINGS: f64 = 0.2;
    /// A peak of smaller transmittance is ignored.
    const LEAST_PEAK: f64 = 0.0005;
    const DARK: f64 = 1e-6;

    let side = Side::of(outgoing);
    let finest = bsdf.transmission(side)?.least_projected_solid_angle();
    let candidates = candidates(bsdf, outgoing)?;
    if candidates.first()?.luminance <= DARK {
        return None;
    }
    let diffuse = bsdf.diffuse_transmittance(side).map(|band| band * FRAC_1_PI);
    let mut cells = PeakCells::NONE;
    let (mut transmittance, mut luminances) = ([0.0; 3], 0.0);
    let (mut peak_size, mut surrounding_size) = (0.0, 0.0);
    for candidate in candidates {
        let size = candidate.projected_solid_angle;
        let is_faint = luminances > DARKEST * candidate.luminance * f64::from(cells.count);
        if size > LARGEST_CELL * finest || is_faint {
            if cells.count == 0 {
                return None;
            }
            surrounding_size += size;
            continue;
        }
        if cells.is_full() {
            return None;
        }
        cells.add(candidate.cell);
        luminances += candidate.luminance;
        peak_size += size;
        for (sum, (band, diffuse)) in transmittance.iter_mut().zip(candidate.color.iter().zip(diffuse)) {
            *sum += (band - diffuse).max(0.0) * size;
        }
    }
    let stands_out = surrounding_size >= LEAST_SURROUNDINGS * peak_size;
    (stands_out && luminance(&transmittance) >= LEAST_PEAK).then_some(StraightTransmission { transmittance, cells })
}

/// The cells near the straight-through direction, each once, brightest first.
fn candidates(bsdf: &MeasuredBsdf, outgoing: DVec3) -> Option<Vec<Candidate>> {
    let transmission = bsdf.transmission(Side::of(outgoing))?;
    let width = transmission.least_projected_solid_angle().sqrt();
    let mut found: Vec<Candidate> = Vec::with_capacity(STEPS.len());
    for (x, y) in STEPS {
        let direction = (DVec3::new(x * width, y * width, 0.0) - outgoing).normalize();
        let Some(cell) = transmission.cell(outgoing, direction) else { continue };
        if found.iter().any(|known| known.cell == cell) {
            continue;
        }
        let color = bsdf.value(outgoing, direction);
        let projected_solid_angle = transmission.projected_solid_angle(outgoing, direction)?;
        found.push(Candidate { luminance: luminance(&color), color, cell, projected_solid_angle });
    }
    found.sort_by(|a, b| b.luminance.total_cmp(&a.luminance));
    Some(found)
}
