//! A hierarchy of lights, from which a few of many are drawn by their importance at a point.
//!
//! Conty Estevez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", HPG 2018: each node knows a sphere around its
//! lights, a cone that holds their normals, and their power. A point looks at the tree through a [`TreeCut`]: nodes that are seen
//! under a wide angle are opened first, so that the importances are tight; the rest of the way down is a choice between two.
//! Distant lights have a tree of their own, over their directions.
//!
//! Guarantees: a light that can give something at a point has a chance there; nothing is allocated after the tree is built.

use crate::light::{Light, LightId};
use crate::lobe_weighting::LobePeak;
use crate::tree_build::{self, Item};
use crate::tree_node::{Angle, Content, Node};
use glam::DVec3;

/// The lights of a plan.
#[derive(Debug)]
pub struct LightTree {
    /// A node's first child is the next one.
    nodes: Vec<Node>,
    /// Of the lights that have a place, and of the distant ones.
    roots: Vec<u32>,
    /// The leaf of each light.
    leaf_of: Vec<u32>,
}

/// What a point makes of light by its direction, as far as drawing lights needs it.
#[derive(Clone, Copy, Debug)]
pub struct Reception {
    /// Unit normal of the diffuse component.
    pub normal: DVec3,
    /// The diffuse component without the cosine, 1/sr.
    pub diffuse: f64,
    /// The highlight.
    pub peak: LobePeak,
    /// What may come back from any direction beside these two, 1/sr.
    pub floor: f64,
    /// How many lights are drawn here; 0 where each is sampled.
    pub draws: u32,
    /// How many points are drawn on each light.
    pub places: LightSampleCount,
}

/// How many places on a light are sampled where each light is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSampleCount {
    /// For each steradian that it fills.
    pub per_sr: f64,
    /// At least so many.
    pub least: f64,
}

impl LightSampleCount {
    /// One, whatever its size.
    pub const ONE: LightSampleCount = LightSampleCount { per_sr: 0.0, least: 1.0 };
}

/// A light that was drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Which one.
    pub light: LightId,
    /// The probability with which a draw chooses it.
    pub chance: f64,
}

/// Nodes that together hold all lights, none twice, with their importance at a point.
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

/// A cut has no more nodes.
const MOST_NODES: usize = 32;

/// A node is opened that is seen under more than this sine of half an angle.
const WIDE: f64 = 0.35;

/// Below the exponential of minus this a peak is nothing.
const NEGLIGIBLE: f64 = 30.0;

/// No more places on a light are sampled, as in Radiance.
pub const MOST_PLACES: u32 = 64;

impl Reception {
    /// Of a point that samples every light, and wherever it is.
    pub const NONE: Reception = Reception {
        normal: DVec3::Z,
        diffuse: 0.0,
        peak: LobePeak::NONE,
        floor: 1.0,
        draws: 0,
        places: LightSampleCount::ONE,
    };

    /// How many places on a light are sampled at a point where each light is.
    #[inline]
    pub fn places_on(&self, light: &Light, point: DVec3) -> u32 {
        if self.places == LightSampleCount::ONE {
            return 1;
        }
        let distance = if light.radius.is_infinite() { 1.0 } else { point.distance(light.center).max(light.radius) };
        let places =
            (self.places.per_sr * light.form.solid_angle(distance)).clamp(self.places.least, MOST_PLACES.into());
        // Only powers of two of a scrambled sequence are evenly spread in both directions.
        if places > 1.0 { (places.ceil() as u32).next_power_of_two() } else { 1 }
    }

    /// A bound on what is made of light from within `half_width` of a unit direction, with the cosine.
    fn bsdf_value(&self, towards: DVec3, half_width: Angle) -> f64 {
        let mut bsdf_value = self.floor;
        if self.diffuse > 0.0 {
            let nearest = Angle::of_cosine(self.normal.dot(towards)).without(half_width);
            bsdf_value += self.diffuse * nearest.cos.max(0.0);
        }
        if self.peak.width > 0.0 {
            // The chord of the angle.
            let width = (2.0 - 2.0 * half_width.cos).max(0.0).sqrt();
            let off = (towards.distance(self.peak.axis) - width).max(0.0);
            let exponent = self.peak.width * off * off;
            // Away from the peak there is the floor.
            if exponent < NEGLIGIBLE {
                bsdf_value += self.peak.height * (-exponent).exp();
            }
        }
        bsdf_value
    }

    /// The same from all around.
    fn most(&self) -> f64 {
        self.floor + self.diffuse + if self.peak.width > 0.0 { self.peak.height } else { 0.0 }
    }
}

impl LightTree {
    /// A tree of lights; `radiance` is that of each where it faces a point, about.
    pub fn new(lights: &[Light], radiance: impl Fn(&Light) -> f64) -> LightTree {
        let radiances: Vec<f64> = lights.iter().map(radiance).collect();
        // What is known of a light may miss where it shines: all have some share.
        let least = LEAST_SHARE * radiances.iter().sum::<f64>() / radiances.len().max(1) as f64;
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

    /// What a node promises at a point, up to a factor that all have in common.
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

    /// Whether a node is seen under too wide an angle for its promise to be good.
    fn is_wide(&self, number: u32, point: DVec3) -> bool {
        let node = &self.nodes[number as usize];
        let offset = if node.is_distant { node.center } else { node.center - point };
        node.radius * node.radius > WIDE * WIDE * offset.length_squared()
    }
}

/// Of the mean radiance of all lights: what each is taken to have at least.
const LEAST_SHARE: f64 = 0.01;

impl<'t> TreeCut<'t> {
    /// The tree as a point sees it.
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

    /// Opens all nodes that are seen under a wide angle, while there is room; says whether there were any.
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

    /// Draws a light by a number of the unit interval; `None` where it falls on what gives nothing.
    pub fn draw(&self, u: f64) -> Option<Choice> {
        let mut left = u * self.total;
        let mut drawn = None;
        for (number, importance) in &self.nodes[..self.len] {
            if *importance > 0.0 {
                drawn = Some((*number, *importance, left));
                if left < *importance {
                    break;
                }
                left -= importance;
            }
        }
        let (number, importance, left) = drawn?;
        self.descend(number, importance / self.total, (left / importance).clamp(0.0, BELOW_ONE))
    }

    fn descend(&self, mut number: u32, mut chance: f64, mut u: f64) -> Option<Choice> {
        loop {
            let second = match self.tree.nodes[number as usize].content {
                Content::One(light) => return Some(Choice { light, chance }),
                Content::Two(second) => second,
            };
            let share = self.share_of_first(number + 1, second)?;
            if u < share {
                (number, chance, u) = (number + 1, chance * share, u / share);
            } else {
                (number, chance, u) = (second, chance * (1.0 - share), (u - share) / (1.0 - share));
            }
            u = u.min(BELOW_ONE);
        }
    }

    /// The chance of the first of two nodes; `None` where neither promises anything.
    fn share_of_first(&self, first: u32, second: u32) -> Option<f64> {
        let importances = [self.importance(first), self.importance(second)];
        let total = importances[0] + importances[1];
        (total > 0.0).then(|| importances[0] / total)
    }

    /// The chance with which [`TreeCut::draw`] finds a light.
    pub fn chance(&self, light: LightId) -> f64 {
        let leaf = self.tree.leaf_of[light.0 as usize];
        // Nodes below a node have the next numbers, so the last one that begins before the leaf holds it.
        let held =
            self.nodes[..self.len].iter().filter(|(number, _)| *number <= leaf).max_by_key(|(number, _)| *number);
        let Some((mut number, importance)) = held.copied().filter(|(_, importance)| *importance > 0.0) else {
            return 0.0;
        };
        let mut chance = importance / self.total;
        while let Content::Two(second) = self.tree.nodes[number as usize].content {
            let Some(share) = self.share_of_first(number + 1, second) else { return 0.0 };
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

    /// Numbers of the unit interval that are all over the place.
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
                        let cone = Some(LightCone { axis: normal, half_angle: 0.6 });
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

    fn receptions() -> [Reception; 2] {
        let matte = Reception {
            normal: DVec3::Z,
            diffuse: 0.3,
            peak: LobePeak::NONE,
            floor: 0.0,
            draws: 1,
            places: LightSampleCount::ONE,
        };
        let peak = LobePeak { axis: DVec3::new(0.6, 0.0, 0.8), width: 100.0, height: 20.0, floor: 0.1 };
        [matte, Reception { peak, floor: 0.01, ..matte }]
    }

    fn points() -> impl Iterator<Item = DVec3> {
        (0..6).map(|index| DVec3::new(scattered(index, 3), scattered(index, 0), scattered(index, 1)) * 6.0 - 1.0)
    }

    #[test]
    fn lights_are_found_as_often_as_their_chance_says() {
        for count in [1, 2, 40, 700] {
            let lights = lights(count);
            let tree = LightTree::new(&lights, |_| 1.0);
            for (point, reception) in points().flat_map(|point| receptions().map(|reception| (point, reception))) {
                let cut = TreeCut::new(&tree, &lights, point, &reception);
                let draws = 2000;
                let mut found = vec![0u32; lights.len()];
                let mut lost = 0u32;
                for draw in 0..draws {
                    match cut.draw((f64::from(draw) + 0.5) / f64::from(draws)) {
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
                // Evenly spread numbers find each light within one of what is expected.
                for (found, chance) in found.iter().zip(&chances) {
                    assert!((f64::from(*found) - f64::from(draws) * chance).abs() <= 1.01);
                }
            }
        }
    }

    #[test]
    fn a_light_that_can_give_something_has_a_chance() {
        let lights = lights(500);
        let tree = LightTree::new(&lights, |_| 1.0);
        for (point, reception) in points().flat_map(|point| receptions().map(|reception| (point, reception))) {
            let cut = TreeCut::new(&tree, &lights, point, &reception);
            for (index, light) in lights.iter().enumerate() {
                let gives = (0..64).any(|place| {
                    let u = [scattered(place, 0), scattered(place, 1)];
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
    fn chances_follow_what_small_lights_give() {
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
