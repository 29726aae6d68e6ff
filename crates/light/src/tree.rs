//! A light tree, which selects a few of many lights by their importance at a point.
//!
//! Conty Estevez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", HPG
//! 2018. Each node has a sphere around its lights, a cone of their normals, and their power. A
//! point uses the tree through a [`TreeCut`]: nodes of a wide angle are split first, so that
//! importances are tight; below the cut each step chooses one of two children. Distant lights have
//! a tree of their own, over their directions.
//!
//! Guarantees: a light that can illuminate a point has a positive probability there; nothing is
//! allocated after the tree is built.

use crate::light::{Light, LightId};
use crate::lobe_weighting::LobePeak;
use crate::tree_build::{self, Item};
use crate::tree_node::{Angle, Content, Node};
use glam::DVec3;
use std::f64::consts::PI;

/// The lights of a plan.
#[derive(Debug)]
pub struct LightTree {
    /// Nodes in depth-first order: the first child of a node follows it.
    nodes: Vec<Node>,
    /// Root of the lights at a finite distance, and root of the distant ones.
    roots: Vec<u32>,
    /// The leaf of each light.
    leaf_of: Vec<u32>,
}

/// Half width of a lobe, in 1/e half-widths, beyond which its highlight is invisible.
const LOBE_REACH: f64 = 2.0;

/// Shape of a receiver's BSDF, for selecting lights.
#[derive(Clone, Copy, Debug)]
pub struct Reception {
    /// Unit normal of the diffuse component.
    pub normal: DVec3,
    /// Value of the diffuse component, without the cosine, 1/sr.
    pub diffuse: f64,
    /// Shape of the highlight.
    pub peak: LobePeak,
    /// Bound on everything else, from any direction, 1/sr.
    pub floor: f64,
    /// Number of selected lights; 0 if every light is sampled.
    pub draws: u32,
    /// Number of points sampled on each light.
    pub samples: LightSampleCount,
}

/// Number of points sampled on a light, if every light is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSampleCount {
    /// Points per steradian of the light.
    pub per_sr: f64,
    /// Minimum number of points.
    pub least: f64,
    /// Points on a light that a narrow lobe sees, per solid angle of the lobe, if light samples
    /// alone find the highlight; limited by `most_per_sr`.
    pub per_lobe: f64,
    /// Maximum number of these points per steradian of the light.
    pub most_per_sr: f64,
}

impl LightSampleCount {
    /// One point, whatever the light's size.
    pub const ONE: LightSampleCount = LightSampleCount { per_sr: 0.0, least: 1.0, per_lobe: 0.0, most_per_sr: 0.0 };
}

/// A selected light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// The light.
    pub light: LightId,
    /// Probability of selecting it.
    pub chance: f64,
}

/// Nodes that together hold every light once, with their importance at a point.
#[derive(Debug)]
pub struct TreeCut<'t> {
    tree: &'t LightTree,
    lights: &'t [Light],
    point: DVec3,
    reception: &'t Reception,
    nodes: [(u32, f64); MOST_NODES],
    len: usize,
    total: f64,
}

/// Largest number of nodes in a cut.
const MOST_NODES: usize = 32;

/// A node is split if the sine of its half angle exceeds this.
const WIDE: f64 = 0.35;

/// A lobe is negligible where its exponent is below minus this.
const NEGLIGIBLE: f64 = 30.0;

/// Largest number of points on a light, as in Radiance.
pub const MOST_SAMPLES: u32 = 64;

impl Reception {
    /// A point that samples every light, and where no component depends on direction.
    pub const NONE: Reception = Reception {
        normal: DVec3::Z,
        diffuse: 0.0,
        peak: LobePeak::NONE,
        floor: 1.0,
        draws: 0,
        samples: LightSampleCount::ONE,
    };

    /// Number of points to sample on a light, at a receiver that samples every light.
    #[inline]
    pub fn samples_on(&self, light: &Light, point: DVec3) -> u32 {
        if self.samples == LightSampleCount::ONE {
            return 1;
        }
        let distance = if light.radius.is_infinite() { 1.0 } else { point.distance(light.center).max(light.radius) };
        let by_area = self.samples.per_sr * light.form.solid_angle(distance);
        // A tube is thinner than a square of the division, and has one sample for each piece of its length.
        let by_length = (0.5 * self.samples.per_sr).sqrt() * light.form.angular_length(point - light.center);
        let wanted = by_area.max(by_length).max(self.highlight_samples(light, point));
        let samples = wanted.clamp(self.samples.least, MOST_SAMPLES.into());
        // Only powers of two of a scrambled sequence are stratified in both dimensions.
        if samples > 1.0 { (samples.ceil() as u32).next_power_of_two() } else { 1 }
    }

    /// Number of points on a light whose reflection in a narrow lobe is sampled by light samples
    /// alone; 0 where the lobe does not see the light.
    ///
    /// One sample finds the lobe with the probability `l / ω`, with the solid angles l of the lobe
    /// and ω of the light. With the share h of the highlight in the light that it reflects, the
    /// relative variance of one sample is about `h² ω / l`, and so many samples are taken.
    pub fn highlight_samples(&self, light: &Light, point: DVec3) -> f64 {
        if self.samples.per_lobe <= 0.0 || self.peak.width <= 0.0 || light.radius.is_infinite() {
            return 0.0;
        }
        let offset = light.center - point;
        let distance = offset.length().max(light.radius);
        let chord = light.radius / distance + LOBE_REACH / self.peak.width.sqrt();
        if offset.distance_squared(self.peak.axis * distance) > (chord * distance).powi(2) {
            return 0.0;
        }
        let (lobe, solid_angle) = (PI / self.peak.width, light.form.solid_angle(distance));
        let highlight = self.peak.height * lobe;
        let share = highlight / (highlight + self.peak.floor * solid_angle);
        let wanted = self.samples.per_lobe * share * share * solid_angle / lobe;
        wanted.min(self.samples.most_per_sr * solid_angle)
    }

    /// Upper bound on the BSDF times cosine within `half_width` of a unit direction, 1/sr.
    fn bsdf_value(&self, towards: DVec3, half_width: Angle) -> f64 {
        let mut bsdf_value = self.floor;
        if self.diffuse > 0.0 {
            let nearest = Angle::of_cosine(self.normal.dot(towards)).without(half_width);
            bsdf_value += self.diffuse * nearest.cos.max(0.0);
        }
        if self.peak.width > 0.0 {
            // Chord of the angle.
            let width = (2.0 - 2.0 * half_width.cos).max(0.0).sqrt();
            let off = (towards.distance(self.peak.axis) - width).max(0.0);
            let exponent = self.peak.width * off * off;
            // Away from the peak only the floor remains.
            if exponent < NEGLIGIBLE {
                bsdf_value += self.peak.height * (-exponent).exp();
            }
        }
        bsdf_value
    }

    /// The same bound over all directions.
    fn most(&self) -> f64 {
        self.floor + self.diffuse + if self.peak.width > 0.0 { self.peak.height } else { 0.0 }
    }
}

impl LightTree {
    /// Builds a tree; `radiance` estimates the radiance that each light emits towards a point.
    pub fn new(lights: &[Light], radiance: impl Fn(&Light) -> f64) -> LightTree {
        let radiances: Vec<f64> = lights.iter().map(radiance).collect();
        // The estimate may be zero for a light that does emit: every light gets a minimum.
        let least = LEAST_RADIANCE * radiances.iter().sum::<f64>() / radiances.len().max(1) as f64;
        let item = |(index, light): (usize, &Light)| {
            Item::new(LightId(index as u32), light, radiances[index].max(least).max(f64::MIN_POSITIVE))
        };
        let mut items: Vec<Item> = lights.iter().enumerate().map(item).collect();
        items.sort_by_key(|item| item.is_distant);
        let near = items.partition_point(|item| !item.is_distant);
        let (near, distant) = items.split_at_mut(near);
        let mut nodes = Vec::with_capacity(2 * lights.len());
        let roots = [near, distant]
            .into_iter()
            .filter(|part| !part.is_empty())
            .map(|part| tree_build::build(part, &mut nodes))
            .collect();
        let mut leaf_of = vec![0; lights.len()];
        for (number, node) in nodes.iter().enumerate() {
            if let Content::One(light) = node.content {
                leaf_of[light.0 as usize] = number as u32;
            }
        }
        LightTree { nodes, roots, leaf_of }
    }

    /// Importance of a node at a point, up to a common factor.
    #[inline]
    fn importance(&self, lights: &[Light], number: u32, point: DVec3, reception: &Reception) -> f64 {
        let node = &self.nodes[number as usize];
        if let Content::One(light) = node.content
            && lights[light.0 as usize].misses(point)
        {
            return 0.0;
        }
        let offset = if node.is_distant { node.center } else { node.center - point };
        let squared = offset.length_squared();
        let radius_squared = node.radius * node.radius;
        let bsdf_value = if squared <= radius_squared {
            reception.most()
        } else {
            let distance = squared.sqrt();
            if distance - node.radius > node.range {
                return 0.0;
            }
            let towards = offset / distance;
            let half_width = Angle::of_sine_squared(radius_squared / squared);
            let shown = if node.is_distant { 1.0 } else { node.emission.cosine(towards, half_width) };
            if shown > 0.0 { shown * reception.bsdf_value(towards, half_width) } else { 0.0 }
        };
        let fall_off = if node.is_distant { 1.0 } else { squared.max(radius_squared).max(f64::MIN_POSITIVE) };
        node.strength * bsdf_value / fall_off
    }

    /// Whether a node's angle is too wide for a tight importance.
    fn is_wide(&self, number: u32, point: DVec3) -> bool {
        let node = &self.nodes[number as usize];
        let offset = if node.is_distant { node.center } else { node.center - point };
        node.radius * node.radius > WIDE * WIDE * offset.length_squared()
    }
}

/// Smallest radiance of a light, as a fraction of the mean of all lights.
const LEAST_RADIANCE: f64 = 0.01;

impl<'t> TreeCut<'t> {
    /// The cut of the tree for a point.
    pub fn new(tree: &'t LightTree, lights: &'t [Light], point: DVec3, reception: &'t Reception) -> TreeCut<'t> {
        let mut cut = TreeCut { tree, lights, point, reception, nodes: [(0, 0.0); MOST_NODES], len: 0, total: 0.0 };
        for root in &tree.roots {
            cut.nodes[cut.len] = (*root, cut.importance(*root));
            cut.len += 1;
        }
        while cut.len < MOST_NODES && cut.open_all() {}
        cut.total = cut.nodes[..cut.len].iter().map(|(_, importance)| importance).sum();
        cut
    }

    fn importance(&self, number: u32) -> f64 {
        self.tree.importance(self.lights, number, self.point, self.reception)
    }

    /// Splits all wide nodes while there is room; returns whether there were any.
    fn open_all(&mut self) -> bool {
        let before = self.len;
        for entry in 0..before {
            let (number, importance) = self.nodes[entry];
            let Content::Two(second) = self.tree.nodes[number as usize].content else { continue };
            if self.len == MOST_NODES || importance <= 0.0 || !self.tree.is_wide(number, self.point) {
                continue;
            }
            self.nodes[entry] = (number + 1, self.importance(number + 1));
            self.nodes[self.len] = (second, self.importance(second));
            self.len += 1;
        }
        self.len > before
    }

    /// Selects a light by a number of the unit interval; `None` where that falls on a node without
    /// importance.
    pub fn sample(&self, u: f64) -> Option<Choice> {
        let mut left = u * self.total;
        let mut selected = None;
        for (number, importance) in &self.nodes[..self.len] {
            if *importance > 0.0 {
                selected = Some((*number, *importance, left));
                if left < *importance {
                    break;
                }
                left -= importance;
            }
        }
        let (number, importance, left) = selected?;
        self.descend(number, importance / self.total, (left / importance).clamp(0.0, BELOW_ONE))
    }

    fn descend(&self, mut number: u32, mut chance: f64, mut u: f64) -> Option<Choice> {
        loop {
            let second = match self.tree.nodes[number as usize].content {
                Content::One(light) => return Some(Choice { light, chance }),
                Content::Two(second) => second,
            };
            let share = self.probability_of_first(number + 1, second)?;
            if u < share {
                (number, chance, u) = (number + 1, chance * share, u / share);
            } else {
                (number, chance, u) = (second, chance * (1.0 - share), (u - share) / (1.0 - share));
            }
            u = u.min(BELOW_ONE);
        }
    }

    /// Probability of the first of two nodes; `None` if both have no importance.
    fn probability_of_first(&self, first: u32, second: u32) -> Option<f64> {
        let importances = [self.importance(first), self.importance(second)];
        let total = importances[0] + importances[1];
        (total > 0.0).then(|| importances[0] / total)
    }

    /// Probability with which [`TreeCut::sample`] selects a light.
    pub fn chance(&self, light: LightId) -> f64 {
        let leaf = self.tree.leaf_of[light.0 as usize];
        // A node's descendants have consecutive numbers, so the last node that begins before the
        // leaf contains it.
        let held =
            self.nodes[..self.len].iter().filter(|(number, _)| *number <= leaf).max_by_key(|(number, _)| *number);
        let Some((mut number, importance)) = held.copied().filter(|(_, importance)| *importance > 0.0) else {
            return 0.0;
        };
        let mut chance = importance / self.total;
        while let Content::Two(second) = self.tree.nodes[number as usize].content {
            let Some(share) = self.probability_of_first(number + 1, second) else { return 0.0 };
            if leaf < second {
                (number, chance) = (number + 1, chance * share);
            } else {
                (number, chance) = (second, chance * (1.0 - share));
            }
        }
        chance
    }
}

/// The largest number below one.
const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form::LightForm;
    use crate::light::LightCone;
    use radsight_ir::{Facing, Scene, Surface};

    /// Well distributed numbers of the unit interval.
    fn scattered(index: u32, dimension: u32) -> f64 {
        (f64::from(index + 1) * [0.819_172, 0.671_043, 0.549_700, 0.450_299][dimension as usize % 4]).fract()
    }

    fn light(center: DVec3, radius: f64, form: LightForm) -> Light {
        let mut scene = Scene::default();
        let name = scene.names.add("light");
        let sphere = radsight_ir::Sphere { center: DVec3::ZERO, radius: 1.0, facing: Facing::Outward };
        let shape = radsight_ir::Shape::Sphere(scene.spheres.add(sphere));
        let surface = scene.surfaces.add(Surface { name, span: None, modifier: None, shape });
        Light {
            surface,
            primitive: None,
            form,
            center,
            radius,
            cone: None,
            dark_beyond: None,
            profile: None,
            max_distance: f64::INFINITY,
            focal_distance: 0.0,
            virtual_sources: Vec::new(),
        }
    }

    /// Spheres, squares, spotlights, near glows and distant lights.
    fn lights(count: u32) -> Vec<Light> {
        (0..count)
            .map(|index| {
                let center = DVec3::new(scattered(index, 0), scattered(index, 1), scattered(index, 2)) * 4.0;
                let turned = DVec3::new(scattered(index, 3), scattered(index + 7, 1), scattered(index + 3, 2)) - 0.5;
                let normal = turned.normalize();
                let (x, y) = normal.any_orthonormal_pair();
                let square = LightForm::Parallelogram {
                    corner: center - (x + y) * 0.1,
                    x: x * 0.2,
                    y: y * 0.2,
                    normal,
                    area: 0.04,
                };
                match index % 5 {
                    0 => light(center, 0.05, LightForm::Sphere { center, radius: 0.05, facing: Facing::Outward }),
                    1 => light(center, 0.15, square),
                    2 => {
                        let cone = Some(LightCone::new(normal, 0.6));
                        Light { cone, ..light(center, 0.15, square) }
                    }
                    3 => Light { max_distance: 1.5, ..light(center, 0.15, square) },
                    _ => {
                        let cap = 0.01 * scattered(index, 0);
                        let form = LightForm::Distant { direction: normal, x, y, half_angle_sin_squared_half: cap };
                        light(normal, f64::INFINITY, form)
                    }
                }
            })
            .collect()
    }

    #[test]
    fn narrow_lobes_take_more_samples_of_lights_that_they_reflect() {
        let normal = DVec3::NEG_Z;
        let corner = DVec3::new(-1.0, -1.0, 4.0);
        let form = LightForm::Parallelogram { corner, x: 2.0 * DVec3::X, y: 2.0 * DVec3::Y, normal, area: 4.0 };
        let panel = light(DVec3::new(0.0, 0.0, 4.0), 2.0_f64.sqrt(), form);
        let samples = LightSampleCount { per_lobe: 4.0, most_per_sr: 50.0, ..LightSampleCount::ONE };
        let lobe = |axis: DVec3, width: f64| {
            let peak = LobePeak { axis, width, height: width, floor: 0.0, ..LobePeak::NONE };
            Reception { peak, samples, ..Reception::NONE }.samples_on(&panel, DVec3::ZERO)
        };
        // The panel has 1/4 sr, the lobe π/100 sr: four times the quotient is 31.8, and the maximum 12.5.
        assert_eq!(lobe(DVec3::Z, 10.0), 4);
        assert_eq!(lobe(DVec3::Z, 100.0), 16);
        assert_eq!(lobe(DVec3::X, 100.0), 1);
    }

    fn receptions() -> [Reception; 2] {
        let matte = Reception {
            normal: DVec3::Z,
            diffuse: 0.3,
            peak: LobePeak::NONE,
            floor: 0.0,
            draws: 1,
            samples: LightSampleCount::ONE,
        };
        let peak =
            LobePeak { axis: DVec3::new(0.6, 0.0, 0.8), width: 100.0, height: 20.0, floor: 0.1, ..LobePeak::NONE };
        [matte, Reception { peak, floor: 0.01, ..matte }]
    }

    fn points() -> impl Iterator<Item = DVec3> {
        (0..6).map(|index| DVec3::new(scattered(index, 3), scattered(index, 0), scattered(index, 1)) * 6.0 - 1.0)
    }

    #[test]
    fn the_length_of_a_light_counts_in_distances_of_its_parts() {
        let strip = |length: f64, width: f64| {
            let (x, y) = (DVec3::X * length, DVec3::Y * width);
            LightForm::Parallelogram { corner: (x + y) * -0.5, x, y, normal: -DVec3::Z, area: length * width }
        };
        let length_from = |form: &LightForm, x: f64, z: f64| form.angular_length(DVec3::new(x, 0.0, -z));
        assert_eq!(length_from(&strip(1.0, 0.5), 0.0, 1.0), 0.0);
        // Pieces of a thousandth of the length, each relative to its own distance.
        let summed = |x: f64, z: f64| {
            (0..1000).map(|piece| 4e-3 / ((f64::from(piece) + 0.5) * 4e-3 - 2.0 - x).hypot(z)).sum::<f64>()
        };
        for (x, z) in [(0.0, 0.3), (0.0, 5.0), (1.9, 0.5), (7.0, 0.1)] {
            let found = length_from(&strip(4.0, 0.02), x, z);
            assert!((found / summed(x, z) - 1.0).abs() < 1e-3, "{x} {z}: {found}");
        }
    }

    #[test]
    fn lights_are_selected_with_their_probability() {
        for count in [1, 2, 40, 700] {
            let lights = lights(count);
            let tree = LightTree::new(&lights, |_| 1.0);
            for (point, reception) in points().flat_map(|point| receptions().map(|reception| (point, reception))) {
                let cut = TreeCut::new(&tree, &lights, point, &reception);
                let draws = 2000;
                let mut found = vec![0u32; lights.len()];
                let mut lost = 0u32;
                for draw in 0..draws {
                    match cut.sample((f64::from(draw) + 0.5) / f64::from(draws)) {
                        Some(choice) => {
                            found[choice.light.0 as usize] += 1;
                            let chance = cut.chance(choice.light);
                            assert!((chance / choice.chance - 1.0).abs() < 1e-9, "{chance} is not {}", choice.chance);
                        }
                        None => lost += 1,
                    }
                }
                let chances: Vec<f64> = (0..count).map(|index| cut.chance(LightId(index))).collect();
                assert!(chances.iter().sum::<f64>() <= 1.0 + 1e-9);
                let missing = 1.0 - chances.iter().sum::<f64>();
                assert!((missing - f64::from(lost) / f64::from(draws)).abs() < 1e-2);
                // Stratified numbers select each light as often as expected, within one.
                for (found, chance) in found.iter().zip(&chances) {
                    assert!((f64::from(*found) - f64::from(draws) * chance).abs() <= 1.01);
                }
            }
        }
    }

    #[test]
    fn a_light_that_can_illuminate_a_point_has_a_probability() {
        let lights = lights(500);
        let tree = LightTree::new(&lights, |_| 1.0);
        for (point, reception) in points().flat_map(|point| receptions().map(|reception| (point, reception))) {
            let cut = TreeCut::new(&tree, &lights, point, &reception);
            for (index, light) in lights.iter().enumerate() {
                let gives = (0..64).any(|index| {
                    let u = [scattered(index, 0), scattered(index, 1)];
                    let sample = light.sample(point, u, &reception.peak);
                    sample.is_some_and(|sample| {
                        let shines =
                            light.cone.is_none_or(|cone| -cone.axis.dot(sample.direction) >= cone.half_angle.cos());
                        shines
                            && sample.distance <= light.max_distance
                            && (reception.floor > 0.0 || reception.normal.dot(sample.direction) > 0.0)
                    })
                });
                assert!(!gives || light.misses(point) || cut.chance(LightId(index as u32)) > 0.0, "{index} at {point}");
            }
        }
    }

    #[test]
    fn probabilities_are_proportional_to_the_irradiance_of_small_lights() {
        let lights: Vec<Light> = (0..300)
            .map(|index| {
                let center = DVec3::new(scattered(index, 0), scattered(index, 1), 1.0 + scattered(index, 2)) * 3.0;
                light(center, 1e-3, LightForm::Sphere { center, radius: 1e-3, facing: Facing::Outward })
            })
            .collect();
        let tree = LightTree::new(&lights, |_| 1.0);
        let reception = receptions()[0];
        let cut = TreeCut::new(&tree, &lights, DVec3::ZERO, &reception);
        let gives = |light: &Light| light.center.z / light.center.length().powi(3);
        let total: f64 = lights.iter().map(gives).sum();
        for (index, light) in lights.iter().enumerate() {
            let ratio = cut.chance(LightId(index as u32)) * total / gives(light);
            assert!((0.4..2.5).contains(&ratio), "{index}: {ratio}");
        }
    }
}
