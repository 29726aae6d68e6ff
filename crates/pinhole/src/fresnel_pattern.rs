//! The Fresnel diffraction pattern of a round pinhole.
//!
//! A point at distance D in front of a pinhole of radius a gives, on a sensor at distance f behind
//! it, the irradiance (Fresnel's approximation of scalar diffraction; Born and Wolf, Principles of
//! Optics, sections 8.3.3 and 8.8.1)
//!
//! `I(v) = |2 ∫₀¹ exp(iπN t²) J₀(2πN t v) t dt|²`, N = a² (1/f + 1/D)/λ
//!
//! relative to the centre of a small pinhole without diffraction. v is the distance from the
//! central projection of the point, in units of the geometric shadow's radius a(1 + f/D). The
//! geometric image is therefore the disk v < 1 for every D, and distance and wavelength change the
//! Fresnel number N only. As a density over that plane it is `πN² I(v)`, with integral 1
//! (Parseval).

use std::f64::consts::PI;

/// Larger Fresnel numbers use the pattern of this one; they are even closer to the geometric disk.
pub(crate) const MAX_FRESNEL_NUMBER: f64 = 1000.0;

/// Cells of the table per interference fringe.
const CELLS_PER_FRINGE: f64 = 12.0;
/// Radius of the first dark ring of a small pinhole, times the Fresnel number: 1.22/2.
const AIRY_RADIUS: f64 = 0.61;
/// Inner radius of the transition from core to wing, in units of the main lobe, or of the shadow
/// for a large pinhole.
const INNER: f64 = 0.7;
const SHADOW_MARGIN: f64 = 1.3;
/// Width of the transition, in units of the main lobe.
const TRANSITION: f64 = 0.6;
/// Patterns whose Fresnel numbers have at most this ratio are split at the same radius.
const MAX_SPLIT_RATIO: f64 = 1.4;
/// Minimum number of cells.
const MIN_CELLS: f64 = 2048.0;

/// The relative irradiance I(v), 1 at the centre of a small pinhole: Lommel's series (Born and
/// Wolf, eqs. 8.8.15, 17 and 20).
#[must_use]
pub fn fresnel_irradiance(fresnel_number: f64, v: f64) -> f64 {
    let u = 2.0 * PI * fresnel_number;
    let x = u * v;
    if v >= 1.0 {
        let [first, second] = lommel(u / x, x, 1);
        return (2.0 / u).powi(2) * (first * first + second * second);
    }
    let [v0, v1] = lommel(v, x, 0);
    let phase = 0.5 * (u + x * v);
    let sum = 1.0 + v0 * v0 + v1 * v1 - 2.0 * (v0 * phase.cos() + v1 * phase.sin());
    (2.0 / u).powi(2) * sum.max(0.0)
}

/// `Σ (−1)ˢ rⁿ⁺²ˢ Jₙ₊₂ₛ(x)` for n = `first` and `first + 1`.
fn lommel(ratio: f64, x: f64, first: usize) -> [f64; 2] {
    let bessel = bessel(x);
    let mut sums = [0.0; 2];
    let mut power = ratio.powi(first as i32);
    for (index, value) in bessel.iter().skip(first).enumerate() {
        let sign = if index / 2 % 2 == 0 { 1.0 } else { -1.0 };
        sums[index % 2] += sign * power * value;
        power *= ratio;
    }
    sums
}

/// J₀(x), J₁(x), … until they vanish: Miller's downward recurrence, normalised by J₀ + 2J₂ + 2J₄ +
/// … = 1.
fn bessel(x: f64) -> Vec<f64> {
    if x < 1e-8 {
        return vec![1.0, 0.5 * x];
    }
    let count = (x + 12.0 * x.cbrt() + 24.0) as usize;
    let mut values = vec![0.0; count + 1];
    let (mut above, mut own) = (0.0, 1e-280);
    let mut sum = 0.0;
    for order in (0..=count).rev() {
        values[order] = own;
        if order % 2 == 0 {
            sum += if order == 0 { own } else { 2.0 * own };
        }
        (above, own) = (own, 2.0 * order as f64 / x * own - above);
        if own.abs() > 1e250 {
            values[order..].iter_mut().for_each(|value| *value *= 1e-280);
            (above, own, sum) = (above * 1e-280, own * 1e-280, sum * 1e-280);
        }
    }
    values.iter_mut().for_each(|value| *value /= sum);
    values
}

/// A tabulated pattern of one or several wavelengths, for importance sampling.
///
/// Between the nodes of the table the density per area is constant. Beyond the last node the
/// fringes are averaged: the two ends of the rim give an irradiance that falls as `1/(v−1)² +
/// 1/(v+1)²`. Nothing is truncated, so energy is conserved.
#[derive(Clone, Debug)]
pub(crate) struct FresnelPattern {
    nodes: Vec<f64>,
    /// Cumulative energy at each node.
    within: Vec<f64>,
    /// For each band the energy of each cell relative to the mixture; the tail is last.
    ratios: Vec<Vec<f64>>,
}

/// A sampled point of the pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Draw {
    /// Distance from the centre, in units of the pinhole's radius.
    pub(crate) v: f64,
    pub(crate) cell: u32,
}

impl FresnelPattern {
    /// The equally weighted mixture of the patterns of bands with these Fresnel numbers.
    pub(crate) fn new(fresnel_numbers: &[f64]) -> FresnelPattern {
        let numbers: Vec<f64> = fresnel_numbers.iter().map(|number| number.min(MAX_FRESNEL_NUMBER)).collect();
        let nodes = nodes(&numbers);
        let of_bands: Vec<Vec<f64>> = numbers.iter().map(|&number| cell_energies(number, &nodes)).collect();
        FresnelPattern::mixed(nodes, &of_bands)
    }

    /// The equally weighted mixture of patterns with these energies in each cell and beyond the
    /// last node.
    fn mixed(nodes: Vec<f64>, of_bands: &[Vec<f64>]) -> FresnelPattern {
        let cells = nodes.len() - 1;
        let share = (of_bands.len() as f64).recip();
        let mixed: Vec<f64> =
            (0..=cells).map(|cell| share * of_bands.iter().map(|band| band[cell]).sum::<f64>()).collect();
        let mut within = vec![0.0];
        within.extend(mixed[..cells].iter().scan(0.0, |sum, energy| {
            *sum += energy;
            Some(*sum)
        }));
        FresnelPattern { ratios: of_bands.iter().map(|band| ratios(band, &mixed)).collect(), nodes, within }
    }

    /// Samples the distance from the centre, for a number from 0 to 1.
    #[inline]
    pub(crate) fn draw(&self, u: f64) -> Draw {
        let last = self.nodes.len() - 1;
        let end = self.within[last];
        if u >= end {
            // The fraction of the tail that is farther out, times its integral at the last node.
            let farther = ((1.0 - u) / (1.0 - end)).max(1e-12);
            let node = self.nodes[last];
            let integral = farther * 2.0 * node / (node * node - 1.0);
            return Draw { v: (1.0 + (1.0 + integral * integral).sqrt()) / integral, cell: last as u32 };
        }
        let cell = self.within.partition_point(|within| *within <= u) - 1;
        let (low, high) = (self.nodes[cell], self.nodes[cell + 1]);
        let share = (u - self.within[cell]) / (self.within[cell + 1] - self.within[cell]);
        Draw { v: (low * low + share * (high * high - low * low)).sqrt(), cell: cell as u32 }
    }

    /// The density of a band at a sampled point, relative to that of the mixture.
    #[inline]
    pub(crate) fn ratio(&self, band: usize, cell: u32) -> f64 {
        self.ratios[band.min(self.ratios.len() - 1)][cell as usize]
    }

    pub(crate) fn bands(&self) -> usize {
        self.ratios.len()
    }
}

/// How a pattern is split: its core is sampled by rays, its wings are added to the whole picture.
/// In units of the shadow's radius.
///
/// The core is everything within `inner`, the wing everything beyond `outer`; between them the
/// fraction of the core falls as a cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CoreSplit {
    inner: f64,
    outer: f64,
}

impl CoreSplit {
    /// The core contains the main lobe: the Airy disk of a small pinhole, the whole shadow of a
    /// large one. The core's transform then has no zero at frequencies that the pattern transmits.
    fn of(fresnel_number: f64) -> CoreSplit {
        let lobe = 1f64.hypot(AIRY_RADIUS / fresnel_number);
        let shadow = fresnel_number / (1.0 + fresnel_number);
        let inner = (INNER * lobe).max(SHADOW_MARGIN * shadow);
        CoreSplit { inner, outer: inner + TRANSITION * lobe }
    }

    /// The splits of several bands. Similar patterns are split at the same radius: the bands of a
    /// ray then have nearly equal weights, and colours have little more noise than white.
    fn of_bands(numbers: &[f64]) -> impl Fn(f64) -> CoreSplit {
        let least = numbers.iter().copied().fold(f64::INFINITY, f64::min);
        let most = numbers.iter().copied().fold(0.0, f64::max);
        let common = (most <= MAX_SPLIT_RATIO * least).then(|| CoreSplit::of(0.5 * (least + most)));
        move |number| common.unwrap_or_else(|| CoreSplit::of(number))
    }

    fn core_share(&self, v: f64) -> f64 {
        let position = ((v - self.inner) / (self.outer - self.inner)).clamp(0.0, 1.0);
        0.5 + 0.5 * (PI * position).cos()
    }
}

/// The densities of a pattern's core and wing over the sensor.
#[derive(Clone, Debug)]
pub(crate) struct Wing {
    pattern: FresnelPattern,
    split: CoreSplit,
    core_share: f64,
    /// Energy beyond the last node relative to the asymptote `T/2`, T = 2v/(v²−1).
    tail: f64,
    /// Radius of the shadow, metres on the sensor.
    unit_m: f64,
}

impl Wing {
    /// Splits the patterns of bands with these Fresnel numbers into the mixture of the cores, which
    /// rays sample, and the wing of each band.
    pub(crate) fn split(fresnel_numbers: &[f64], unit_m: f64) -> (FresnelPattern, Vec<Wing>) {
        let numbers: Vec<f64> = fresnel_numbers.iter().map(|number| number.min(MAX_FRESNEL_NUMBER)).collect();
        let nodes = nodes(&numbers);
        let split_of = CoreSplit::of_bands(&numbers);
        let parts: Vec<(Wing, Vec<f64>)> =
            numbers.iter().map(|number| Wing::of_band((*number, split_of(*number)), &nodes, unit_m)).collect();
        let cells = parts.iter().map(|(_, core)| core.len() - 1).max().unwrap_or(0);
        // Outside its own core the wing of a band has all its energy.
        let within = |core: &[f64], node: usize| core[node.min(core.len() - 1)];
        let share = (parts.len() as f64).recip();
        let mixed: Vec<f64> =
            (0..=cells).map(|node| share * parts.iter().map(|(_, core)| within(core, node)).sum::<f64>()).collect();
        let area_ratio = |within: &dyn Fn(usize) -> f64| -> Vec<f64> {
            (0..cells).map(|cell| within(cell + 1) - within(cell)).chain([0.0]).collect()
        };
        let of_mixture = area_ratio(&|node| mixed[node]);
        let of_band = |(_, core): &(Wing, Vec<f64>)| ratios(&area_ratio(&|node| within(core, node)), &of_mixture);
        let core = FresnelPattern {
            ratios: parts.iter().map(of_band).collect(),
            nodes: nodes[..=cells].to_vec(),
            within: mixed,
        };
        (core, parts.into_iter().map(|(wing, _)| wing).collect())
    }

    /// The wing of one band, and the fraction of its core within each node.
    fn of_band((number, split): (f64, CoreSplit), nodes: &[f64], unit_m: f64) -> (Wing, Vec<f64>) {
        let pattern = FresnelPattern::mixed(nodes.to_vec(), &[cell_energies(number, nodes)]);
        let mut within = vec![0.0];
        for (cell, energy) in pattern.nodes.windows(2).zip(pattern.within.windows(2)) {
            if cell[0] >= split.outer {
                break;
            }
            let share = split.core_share(0.5 * (cell[0] + cell[1]));
            within.push(within[within.len() - 1] + share * (energy[1] - energy[0]));
        }
        let core_share = within[within.len() - 1];
        within.iter_mut().for_each(|energy| *energy /= core_share);
        let last = pattern.nodes[pattern.nodes.len() - 1];
        let tail = (1.0 - pattern.within[pattern.nodes.len() - 1]) * (last * last - 1.0) / (2.0 * last);
        (Wing { pattern, split, core_share, tail, unit_m }, within)
    }

    /// The fraction of the energy in the core.
    pub(crate) fn core_share(&self) -> f64 {
        self.core_share
    }

    /// The densities of core and wing at a distance from the centre, per square metre of the
    /// sensor.
    pub(crate) fn densities(&self, distance_m: f64) -> [f64; 2] {
        let v = distance_m / self.unit_m;
        let nodes = &self.pattern.nodes;
        let last = nodes.len() - 1;
        let cell = (v / nodes[last] * last as f64) as usize;
        let density = if cell < last {
            let (low, high) = (nodes[cell], nodes[cell + 1]);
            (self.pattern.within[cell + 1] - self.pattern.within[cell]) / (PI * (high * high - low * low))
        } else {
            // −dT/dv = 1/(v−1)² + 1/(v+1)².
            self.tail * ((v - 1.0).powi(-2) + (v + 1.0).powi(-2)) / (2.0 * PI * v)
        };
        let density = density / (self.unit_m * self.unit_m);
        let core = self.split.core_share(v);
        [core * density, (1.0 - core) * density]
    }
}

/// The edges of the cells in which patterns of these Fresnel numbers are tabulated together.
fn nodes(numbers: &[f64]) -> Vec<f64> {
    let least = numbers.iter().copied().fold(f64::INFINITY, f64::min);
    let most = numbers.iter().copied().fold(0.0, f64::max);
    let end = 1.0 + 10.0 / least + 4.0 / least.sqrt();
    let cells = (end * 2.0 * most * CELLS_PER_FRINGE).ceil().max(MIN_CELLS) as usize;
    (0..=cells).map(|node| end * node as f64 / cells as f64).collect()
}

/// Energies of a band relative to those of the mixture.
fn ratios(band: &[f64], mixed: &[f64]) -> Vec<f64> {
    band.iter().zip(mixed).map(|(own, mixed)| if *mixed > 0.0 { own / mixed } else { 1.0 }).collect()
}

/// The energy of one Fresnel number in each cell by Simpson's rule, and the energy beyond the last
/// node.
fn cell_energies(fresnel_number: f64, nodes: &[f64]) -> Vec<f64> {
    let density = |v: f64| 2.0 * PI * v * PI * fresnel_number.powi(2) * fresnel_irradiance(fresnel_number, v);
    let mut before = density(nodes[0]);
    let mut energies: Vec<f64> = nodes
        .windows(2)
        .map(|cell| {
            let after = density(cell[1]);
            let energy = (cell[1] - cell[0]) / 6.0 * (before + 4.0 * density(0.5 * (cell[0] + cell[1])) + after);
            before = after;
            energy
        })
        .collect();
    let rest = 1.0 - energies.iter().sum::<f64>();
    energies.push(rest.max(0.0));
    energies
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The defining integral by Simpson's rule, with J₀ from its own integral: independent of the
    /// series.
    fn direct(fresnel_number: f64, v: f64) -> f64 {
        let steps = 2 * (200.0 + 40.0 * fresnel_number * (1.0 + v)) as usize;
        let j0 = |x: f64| {
            let angles = 64 + 2 * x as usize;
            (0..angles).map(|k| (x * (PI * (k as f64 + 0.5) / angles as f64).sin()).cos()).sum::<f64>() / angles as f64
        };
        let (mut real, mut imaginary) = (0.0, 0.0);
        for step in 0..=steps {
            let t = step as f64 / steps as f64;
            let weight = if step == 0 || step == steps { 1.0 } else { 2.0 + 2.0 * (step % 2) as f64 };
            let value = weight * j0(2.0 * PI * fresnel_number * t * v) * t;
            let (sin, cos) = (PI * fresnel_number * t * t).sin_cos();
            real += value * cos;
            imaginary += value * sin;
        }
        let scale = 2.0 / (3.0 * steps as f64);
        (scale * real).powi(2) + (scale * imaginary).powi(2)
    }

    #[test]
    fn lommels_series_agree_with_the_integral() {
        for number in [0.02, 0.3, 0.578, 1.0, 2.0, 3.7, 12.0] {
            let places: Vec<f64> = (0..60).map(|k| f64::from(k) * 0.05 * (1.0 + 1.0 / number)).chain([1.0]).collect();
            let peak = places.iter().map(|&v| direct(number, v)).fold(0.0, f64::max);
            for v in places {
                let (found, expected) = (fresnel_irradiance(number, v), direct(number, v));
                assert!((found - expected).abs() < 1e-6 * peak, "N {number}, v {v}: {found} against {expected}");
            }
        }
    }

    #[test]
    fn on_the_axis_it_is_the_closed_form() {
        // |2 ∫ exp(iπN t²) t dt|² = (sin(πN/2)/(πN/2))²; an even N is dark.
        for number in [0.1, 0.578, 2.0, 5.3] {
            let half = 0.5 * PI * number;
            assert!((fresnel_irradiance(number, 0.0) - (half.sin() / half).powi(2)).abs() < 1e-12);
        }
    }

    #[test]
    fn a_small_hole_gives_airys_pattern_with_its_zero_at_1_22() {
        let number = 1e-3;
        // s = 1.22 λ f/d for a distant object is v = s/a = 1.22/(2 N).
        let dark = 1.219_67 / (2.0 * number);
        assert!(fresnel_irradiance(number, dark) < 1e-6);
        assert!(fresnel_irradiance(number, 0.9 * dark) > 1e-3 && fresnel_irradiance(number, 1.1 * dark) > 1e-3);
        let half = 0.514_5 / (2.0 * number);
        assert!((fresnel_irradiance(number, half) - 0.5).abs() < 2e-3, "half of the full width 1.029 λ f/d");
    }

    #[test]
    fn a_large_hole_gives_the_geometric_disk() {
        let number = 300.0;
        let pattern = FresnelPattern::new(&[number]);
        let energy = |v: f64| {
            let node = pattern.nodes.partition_point(|node| *node < v);
            pattern.within[node]
        };
        for v in [0.2, 0.5, 0.8] {
            assert!((energy(v) - v * v).abs() < 0.02, "{v}: {}", energy(v));
        }
        assert!(energy(1.1) > 0.99);
    }

    #[test]
    fn the_energy_is_kept_to_a_ten_thousandth() {
        for number in [0.05, 0.3, 0.578, 1.0, 4.0, 20.0, 100.0] {
            let pattern = FresnelPattern::new(&[number]);
            let end = *pattern.nodes.last().unwrap();
            // Beyond the last node, from the two ends of the rim: T/(2π²N) with T = 2v/(v²−1).
            let tail = 2.0 * end / (end * end - 1.0) / (2.0 * PI * PI * number);
            let whole = pattern.within.last().unwrap() + tail;
            assert!((whole - 1.0).abs() < 1e-4, "N {number}: {whole}");
        }
    }

    #[test]
    fn draws_follow_the_energy_and_reach_into_the_tail() {
        let pattern = FresnelPattern::new(&[0.578]);
        let last = pattern.within.last().copied().unwrap();
        let end = pattern.nodes.last().copied().unwrap();
        for (node, within) in pattern.nodes.iter().zip(&pattern.within).skip(1).step_by(37) {
            assert!((pattern.draw(within - 1e-9).v / node - 1.0).abs() < 1e-4);
        }
        assert!((pattern.draw(last + 1e-9).v / end - 1.0).abs() < 1e-3);
        assert!(pattern.draw(0.5 * (1.0 + last)).v > 1.9 * end);
        assert!(pattern.draw(1.0).v.is_finite());
    }

    #[test]
    fn bands_are_weighted_to_their_own_pattern() {
        let pattern = FresnelPattern::new(&[0.5, 0.8]);
        let cells = pattern.nodes.len() - 1;
        for band in 0..2 {
            let mean: f64 = (0..cells)
                .map(|cell| (pattern.within[cell + 1] - pattern.within[cell]) * pattern.ratio(band, cell as u32))
                .sum::<f64>()
                + (1.0 - pattern.within[cells]) * pattern.ratio(band, cells as u32);
            assert!((mean - 1.0).abs() < 1e-9, "{mean}");
            assert!((0..=cells as u32).all(|cell| pattern.ratio(band, cell) <= 2.0 + 1e-9));
        }
    }

    #[test]
    fn jointly_sampled_cores_are_weighted_to_each_own() {
        let numbers = [0.5, 0.6, 0.8];
        let (drawn, wings) = Wing::split(&numbers, 1.0);
        let cells = drawn.nodes.len() - 1;
        for (band, wing) in wings.iter().enumerate() {
            let energy = |cell: usize| (drawn.within[cell + 1] - drawn.within[cell]) * drawn.ratio(band, cell as u32);
            assert!(((0..cells).map(energy).sum::<f64>() - 1.0).abs() < 1e-9);
            for cell in (0..cells).step_by(7) {
                let (low, high) = (drawn.nodes[cell], drawn.nodes[cell + 1]);
                let [core, _] = wing.densities(0.5 * (low + high));
                let density = energy(cell) / (PI * (high * high - low * low));
                assert!((density - core / wing.core_share()).abs() < 1e-6, "band {band}, cell {cell}");
            }
            let (_, alone) = Wing::split(&numbers[band..=band], 1.0);
            assert!((alone[0].core_share() - wing.core_share()).abs() < 1e-4);
        }
    }
}
