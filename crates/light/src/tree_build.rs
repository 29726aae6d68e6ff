//! Builds the light tree from the top down, each time with the split of least cost.
//!
//! The cost of a node is its power times the area of its bounds times the solid angle of its
//! emission (Conty Estevez and Kulla, HPG 2018, section 4.4). Candidate splits lie between bins, as
//! in bounding volume hierarchies.

use crate::light::{Light, LightId};
use crate::tree_node::{Content, Emission, EmissionCone, Node, shown};
use glam::DVec3;
use std::f64::consts::PI;

/// A light during the build.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Item {
    light: LightId,
    /// Same fields as those of [`Node`].
    center: DVec3,
    radius: f64,
    pub(crate) is_distant: bool,
    emission: EmissionCone,
    strength: f64,
    range: f64,
}

/// Number of bins along each axis.
const BINS: usize = 12;

impl Item {
    pub(crate) fn new(light: LightId, of: &Light, radiance: f64) -> Item {
        let is_distant = of.radius.is_infinite();
        // A distant light's extent is the chord from its direction to its rim: 2·sin(θ/2).
        let chord = || (of.form.solid_angle(1.0) / PI).sqrt();
        Item {
            light,
            center: of.center,
            radius: if is_distant { chord() } else { of.radius },
            is_distant,
            emission: EmissionCone::of(of),
            strength: radiance * shown(&of.form),
            range: of.max_distance,
        }
    }
}

/// Bounds of several lights.
#[derive(Clone, Copy, Debug)]
struct Summary {
    low: DVec3,
    high: DVec3,
    emission: Option<EmissionCone>,
    strength: f64,
}

impl Summary {
    const NOTHING: Summary = Summary { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY, emission: None, strength: 0.0 };

    fn with(self, item: &Item) -> Summary {
        let of_item = Summary {
            low: item.center - DVec3::splat(item.radius),
            high: item.center + DVec3::splat(item.radius),
            emission: Some(item.emission),
            strength: item.strength,
        };
        self.and(&of_item)
    }

    fn and(self, other: &Summary) -> Summary {
        Summary {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            emission: match (self.emission, other.emission) {
                (Some(one), Some(two)) => Some(union(&one, &two)),
                (one, two) => one.or(two),
            },
            strength: self.strength + other.strength,
        }
    }

    fn cost(&self) -> f64 {
        let Some(emission) = self.emission else { return 0.0 };
        let size = self.high - self.low;
        let area = size.x * size.y + size.y * size.z + size.z * size.x;
        self.strength * (area + self.low.distance_squared(self.high) * FLAT) * into(&emission)
    }
}

/// Cost of a degenerate box, of lights along a line, relative to its squared length.
const FLAT: f64 = 1e-3;

/// Solid angle of emission, with the part beyond the normals weighted by the cosine (Eq. 1 there),
/// sr.
fn into(emission: &EmissionCone) -> f64 {
    let spread = emission.spread;
    let edge = (spread + emission.reach).min(PI);
    let (sin, cos) = spread.sin_cos();
    let outside = 2.0 * edge * sin - (spread - 2.0 * edge).cos() - 2.0 * spread * sin + cos;
    2.0 * PI * (1.0 - cos) + 0.5 * PI * outside
}

/// Smallest cone about two cones (algorithm 1 there).
fn union(one: &EmissionCone, two: &EmissionCone) -> EmissionCone {
    let (wide, narrow) = if one.spread >= two.spread { (one, two) } else { (two, one) };
    let reach = wide.reach.max(narrow.reach);
    let apart = 2.0 * (0.5 * wide.axis.distance(narrow.axis)).min(1.0).asin();
    if (apart + narrow.spread).min(PI) <= wide.spread {
        return EmissionCone { reach, ..*wide };
    }
    let spread = 0.5 * (wide.spread + apart + narrow.spread);
    let side = (narrow.axis - wide.axis * wide.axis.dot(narrow.axis)).try_normalize();
    let Some(side) = side.filter(|_| spread < PI) else {
        return EmissionCone { axis: wide.axis, spread: PI, reach };
    };
    let (sin, cos) = (spread - wide.spread).sin_cos();
    EmissionCone { axis: wide.axis * cos + side * sin, spread: spread + ROUNDED, reach }
}

/// Tolerance of the union of two cones against rounding, radians.
const ROUNDED: f64 = 1e-9;

/// Appends the tree of at least one light; returns the number of its root.
pub(crate) fn build(items: &mut [Item], nodes: &mut Vec<Node>) -> u32 {
    let number = nodes.len() as u32;
    let node = node(items);
    nodes.push(node);
    if items.len() > 1 {
        let middle = split(items);
        let (first, second) = items.split_at_mut(middle);
        build(first, nodes);
        let second = build(second, nodes);
        nodes[number as usize].content = Content::Two(second);
    }
    number
}

fn node(items: &[Item]) -> Node {
    let summary = items.iter().fold(Summary::NOTHING, Summary::with);
    let center = if let [item] = items { item.center } else { 0.5 * (summary.low + summary.high) };
    let reach_to = |item: &Item| item.center.distance(center) + item.radius;
    Node {
        center,
        radius: items.iter().map(reach_to).fold(0.0, f64::max),
        is_distant: items[0].is_distant,
        emission: Emission::new(&summary.emission.unwrap_or(EmissionCone::EVERYWHERE)),
        strength: summary.strength,
        range: items.iter().map(|item| item.range).fold(0.0, f64::max),
        content: Content::One(items[0].light),
    }
}

/// Partitions the items for two child nodes; returns the number of items in the first.
fn split(items: &mut [Item]) -> usize {
    let low = items.iter().fold(DVec3::INFINITY, |low, item| low.min(item.center));
    let high = items.iter().fold(DVec3::NEG_INFINITY, |high, item| high.max(item.center));
    let size = high - low;
    let longest = size.max_element();
    let bin = |item: &Item, axis: usize| {
        let share = (item.center[axis] - low[axis]) / size[axis];
        ((share * BINS as f64) as usize).min(BINS - 1)
    };
    let mut best: Option<(f64, usize, usize)> = None;
    for axis in (0..3).filter(|axis| size[*axis] > 0.0) {
        let mut bins = [Summary::NOTHING; BINS];
        for item in &*items {
            let summary = &mut bins[bin(item, axis)];
            *summary = summary.with(item);
        }
        // Regularisation: a thin box should not be split across its short side (section 4.4 there).
        let shape = longest / size[axis];
        for (border, cost) in costs(&bins).into_iter().enumerate() {
            let cost = cost * shape;
            if cost.is_finite() && best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, border + 1));
            }
        }
    }
    let half = items.len() / 2;
    let Some((_, axis, border)) = best else { return half };
    items.sort_by_key(|item| bin(item, axis) >= border);
    let middle = items.partition_point(|item| bin(item, axis) < border);
    if middle == 0 || middle == items.len() { half } else { middle }
}

/// Cost of a split after each bin but the last; infinite if one side is empty.
fn costs(bins: &[Summary; BINS]) -> [f64; BINS - 1] {
    let mut costs = [f64::INFINITY; BINS - 1];
    let mut before = Summary::NOTHING;
    for (cost, bin) in costs.iter_mut().zip(bins) {
        before = before.and(bin);
        *cost = if before.emission.is_some() { before.cost() } else { f64::INFINITY };
    }
    let mut after = Summary::NOTHING;
    for border in (0..BINS - 1).rev() {
        after = after.and(&bins[border + 1]);
        costs[border] += if after.emission.is_some() { after.cost() } else { f64::INFINITY };
    }
    costs
}
