//! A spatial index of balls.

use glam::DVec3;
use rustc_hash::FxHashMap;

/// Numbered balls, found by the points that they contain.
///
/// Space is divided into cubes of several sizes, each half the previous one. A ball is stored in
/// all cubes that it overlaps, of the smallest size that is at least its radius, so there are at
/// most 27. A query visits one cube of each size, and most balls there contain the point.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    levels: Vec<Level>,
}

#[derive(Clone, Debug)]
struct Level {
    side: f64,
    cubes: FxHashMap<Cube, Vec<Ball>>,
}

/// The indices of a cube.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Cube {
    x: i32,
    y: i32,
    z: i32,
}

#[derive(Clone, Copy, Debug)]
struct Ball {
    center: DVec3,
    squared_radius: f64,
    number: u32,
}

impl Grid {
    /// For balls of these radii; others cost time only.
    pub(crate) fn new(min_reach: f64, max_reach: f64) -> Grid {
        let mut levels = Vec::new();
        let mut side = max_reach;
        while levels.len() < MAX_LEVELS {
            levels.push(Level { side, cubes: FxHashMap::default() });
            if 0.5 * side < min_reach {
                break;
            }
            side *= 0.5;
        }
        Grid { levels }
    }

    pub(crate) fn insert(&mut self, number: u32, center: DVec3, radius: f64) {
        let level = self.levels.iter().rposition(|level| level.side >= radius).unwrap_or(0);
        let level = &mut self.levels[level];
        let low = cube(center - DVec3::splat(radius), level.side);
        let high = cube(center + DVec3::splat(radius), level.side);
        let ball = Ball { center, squared_radius: radius * radius, number };
        for x in low.x..=high.x {
            for y in low.y..=high.y {
                for z in low.z..=high.z {
                    level.cubes.entry(Cube { x, y, z }).or_default().push(ball);
                }
            }
        }
    }

    /// Visits all balls that contain the point. Their order depends only on the order of insertion.
    pub(crate) fn visit(&self, point: DVec3, mut visit: impl FnMut(u32)) {
        for level in self.levels.iter().filter(|level| !level.cubes.is_empty()) {
            for ball in level.cubes.get(&cube(point, level.side)).into_iter().flatten() {
                if ball.center.distance_squared(point) < ball.squared_radius {
                    visit(ball.number);
                }
            }
        }
    }

    /// The same grid without balls.
    pub(crate) fn cleared(&self) -> Grid {
        let empty = |level: &Level| Level { side: level.side, cubes: FxHashMap::default() };
        Grid { levels: self.levels.iter().map(empty).collect() }
    }
}

/// Maximum number of cube sizes; the smallest cubes may hold balls that would fit a smaller size.
const MAX_LEVELS: usize = 24;

fn cube(point: DVec3, side: f64) -> Cube {
    // Casting saturates, so a distant point shares a cube with others, which costs time only.
    let [x, y, z] = (point / side).floor().to_array().map(|coordinate| coordinate as i32);
    Cube { x, y, z }
}
