//! Polygons with many vertices: a grid of the parts of their plane that are entirely inside or
//! outside.
//!
//! Testing a polygon takes a test of each edge, and a wall with holes has hundreds. A grid over the
//! plane answers at once in all cells that no edge comes near. In the others, the edges of the
//! cell's row are counted. Within [`NEAR_EDGE`] of an edge, and at grazing angles, all edges are
//! tested, so every ray has the same result as without the grid.

use crate::polygon::area_vector;
use crate::ray::Ray;
use glam::DVec3;
use std::ops::Range;
use std::sync::OnceLock;

/// Minimum number of vertices for a grid.
pub(crate) const MANY_VERTICES: u32 = 12;

/// Number of cells along the longer side of a grid, relative to the square root of the number of
/// vertices.
const CELLS_PER_ROOT: f64 = 4.0;
const MAX_CELLS: f64 = 256.0;

/// Maximum distance of a vertex from the plane for a grid, relative to the polygon's size: scenes
/// have few decimals.
const MAX_OFFSET: f64 = 1e-4;

/// Nearer to an edge than this, in cells, rounding may decide.
const NEAR_EDGE: f64 = 0.01;

/// The edges of a row include those that come this near to it, in cells.
const ROW_MARGIN: f64 = 0.5;

/// For a smaller sine of the angle between ray and plane, the edges are tested.
const MIN_GRAZING_SINE: f64 = 1e-4;

/// The position of a cell relative to the polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cover {
    Outside,
    Inside,
    /// An edge is in the cell or next to it.
    Edge,
}

/// The grid over a polygon's plane.
#[derive(Debug)]
pub(crate) struct Outline {
    /// Twice the area vector.
    area: DVec3,
    area_length: f64,
    /// Unit.
    pub(crate) normal: DVec3,
    first_vertex: DVec3,
    /// Maximum distance of a vertex from the plane, cells.
    offset: f64,
    /// The coordinates of the projection along the axis of the largest area.
    axes: [usize; 2],
    origin: [f64; 2],
    /// Cells in a unit of length.
    resolution: f64,
    counts: [usize; 2],
    cells: Vec<Cover>,
    /// The edges of each row, in cells from the grid's corner.
    edges: Vec<Edge>,
    /// The first edge of each row, and the number of all.
    rows: Vec<u32>,
}

/// The grid of a polygon, made at the first test: most polygons of a large scene are never tested.
#[derive(Debug, Default)]
pub(crate) struct PendingOutline(OnceLock<Option<Box<Outline>>>);

impl PendingOutline {
    /// The grid of the polygon with these vertices.
    #[inline]
    pub(crate) fn get(&self, vertices: &[DVec3]) -> Option<&Outline> {
        self.0.get_or_init(|| Outline::new(vertices).map(Box::new)).as_deref()
    }
}

/// The ends of an edge.
type Edge = [[f64; 2]; 2];

/// The grid's result for a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum GridResult {
    /// The ray misses.
    Miss,
    /// The ray hits the polygon at this distance.
    Hit(f64),
    /// The edges must be tested.
    Unknown,
}

impl Outline {
    /// `None` for a polygon that has no area or is not flat.
    pub(crate) fn new(vertices: &[DVec3]) -> Option<Outline> {
        let area = area_vector(vertices);
        let normal = area.try_normalize()?;
        let (least, most) =
            vertices.iter().fold((vertices[0], vertices[0]), |(least, most), v| (least.min(*v), most.max(*v)));
        let size = (most - least).max_element();
        let offset = vertices.iter().map(|vertex| normal.dot(*vertex - vertices[0]).abs()).fold(0.0, f64::max);
        if offset > MAX_OFFSET * size {
            return None;
        }
        let largest = (0..3).max_by(|a, b| normal[*a].abs().total_cmp(&normal[*b].abs()))?;
        let mut axes = [(largest + 1) % 3, (largest + 2) % 3];
        let [along_rows, across_rows] = axes.map(|axis| total_extent(vertices, axis));
        // Rows are chosen so that edges are in few of them.
        if across_rows > along_rows {
            axes.reverse();
        }
        let sides = axes.map(|axis| most[axis] - least[axis]);
        let cell = sides[0].max(sides[1]) / (CELLS_PER_ROOT * (vertices.len() as f64).sqrt()).min(MAX_CELLS);
        if cell <= 0.0 || !cell.is_finite() {
            return None;
        }
        // A border of one cell on each side.
        let counts = sides.map(|side| (side / cell) as usize + 3);
        let origin = axes.map(|axis| least[axis] - cell);
        let mut outline = Outline {
            area,
            area_length: area.length(),
            normal,
            first_vertex: vertices[0],
            offset: offset / cell,
            axes,
            origin,
            resolution: cell.recip(),
            counts,
            cells: vec![Cover::Outside; counts[0] * counts[1]],
            edges: Vec::new(),
            rows: Vec::new(),
        };
        let corners: Vec<[f64; 2]> = vertices.iter().map(|vertex| outline.coordinates(*vertex)).collect();
        outline.fill(&corners);
        outline.mark_edges(&corners);
        outline.list_edges(&corners);
        Some(outline)
    }

    /// Cells from the grid's corner.
    fn coordinates(&self, point: DVec3) -> [f64; 2] {
        [0, 1].map(|index| (point[self.axes[index]] - self.origin[index]) * self.resolution)
    }

    /// Fills cells by the parity of edges on one side of their centres.
    fn fill(&mut self, corners: &[[f64; 2]]) {
        let mut crossings = Vec::new();
        for row in 0..self.counts[1] {
            let y = row as f64 + 0.5;
            crossings.clear();
            for (a, b) in edges(corners) {
                if (a[1] < y) != (b[1] < y) {
                    crossings.push(a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
                }
            }
            crossings.sort_unstable_by(f64::total_cmp);
            for pair in crossings.chunks_exact(2) {
                let [first, end] = [pair[0], pair[1]].map(|x| ((x + 0.5) as usize).min(self.counts[0]));
                let from = row * self.counts[0];
                self.cells[from + first..from + end.max(first)].fill(Cover::Inside);
            }
        }
    }

    /// Marks every cell that an edge crosses, and adjacent ones.
    fn mark_edges(&mut self, corners: &[[f64; 2]]) {
        for (a, b) in edges(corners) {
            let [low, high] = [a[1].min(b[1]), a[1].max(b[1])];
            for row in cells_around(low, high, self.counts[1]) {
                // The part of the edge in this row and adjacent ones.
                let clipped = [row as f64 - 1.0, row as f64 + 2.0].map(|y| {
                    let share = if high > low { ((y - a[1]) / (b[1] - a[1])).clamp(0.0, 1.0) } else { 0.0 };
                    a[0] + share * (b[0] - a[0])
                });
                let ends = if high > low { clipped } else { [a[0], b[0]] };
                for column in cells_around(ends[0].min(ends[1]), ends[0].max(ends[1]), self.counts[0]) {
                    self.cells[row * self.counts[0] + column] = Cover::Edge;
                }
            }
        }
    }

    /// Lists the edges of each row.
    fn list_edges(&mut self, corners: &[[f64; 2]]) {
        let rows_of = |[a, b]: &Edge| {
            let [low, high] = [a[1].min(b[1]) - ROW_MARGIN, a[1].max(b[1]) + ROW_MARGIN];
            low.max(0.0) as usize..(high as usize + 1).min(self.counts[1])
        };
        let edges: Vec<Edge> = edges(corners).map(|(a, b)| [a, b]).collect();
        let mut rows = vec![0; self.counts[1] + 1];
        edges.iter().flat_map(rows_of).for_each(|row| rows[row + 1] += 1);
        for row in 0..self.counts[1] {
            rows[row + 1] += rows[row];
        }
        let mut next = rows.clone();
        let mut listed = vec![Edge::default(); rows[self.counts[1]] as usize];
        for (edge, row) in edges.iter().flat_map(|edge| rows_of(edge).map(move |row| (edge, row))) {
            listed[next[row] as usize] = *edge;
            next[row] += 1;
        }
        (self.edges, self.rows) = (listed, rows);
    }

    /// Whether a point of a row is inside, by the parity of edges on one side of it; `None` if one
    /// is no farther than `margin`.
    fn is_inside(&self, [x, y]: [f64; 2], margin: f64) -> Option<bool> {
        let row = y as usize;
        let mut inside = false;
        for [a, b] in &self.edges[self.rows[row] as usize..self.rows[row + 1] as usize] {
            let (along, across) = ([b[0] - a[0], b[1] - a[1]], [x - a[0], y - a[1]]);
            // Positive where the point is to the left of the edge.
            let side = along[0] * across[1] - along[1] * across[0];
            let length_squared = along[0] * along[0] + along[1] * along[1];
            let is_beside =
                |axis: usize, at: f64| at >= a[axis].min(b[axis]) - margin && at <= a[axis].max(b[axis]) + margin;
            if side * side <= margin * margin * length_squared && is_beside(0, x) && is_beside(1, y) {
                return None;
            }
            inside ^= ((a[1] > y) != (b[1] > y)) & ((side > 0.0) == (along[1] > 0.0));
        }
        Some(inside)
    }

    /// Whether a ray hits the polygon in a range of distances, and where.
    pub(crate) fn classify(&self, ray: &Ray, range: &Range<f64>) -> GridResult {
        let slope = self.area.dot(ray.direction);
        let distance = self.area.dot(self.first_vertex - ray.origin) / slope;
        // Also where the edges must be tested, since they do not change the distance.
        if distance <= range.start || distance >= range.end {
            return GridResult::Miss;
        }
        let sine = slope.abs() / (self.area_length * ray.direction.length());
        // Vertices off the plane move along the ray to it.
        let margin = NEAR_EDGE + self.offset / sine;
        // False if a number is not one.
        let is_certain = sine >= MIN_GRAZING_SINE && margin < ROW_MARGIN;
        if !is_certain {
            return GridResult::Unknown;
        }
        let [x, y] = self.coordinates(ray.at(distance));
        let within = |at: f64, count: usize| at >= 0.0 && at < count as f64;
        if !within(x, self.counts[0]) || !within(y, self.counts[1]) {
            // Far from everything, unless the coordinates are NaN.
            return if x.is_finite() && y.is_finite() { GridResult::Miss } else { GridResult::Unknown };
        }
        let is_inside = match self.cells[y as usize * self.counts[0] + x as usize] {
            Cover::Outside => Some(false),
            Cover::Inside => Some(true),
            Cover::Edge => self.is_inside([x, y], margin),
        };
        match is_inside {
            Some(false) => GridResult::Miss,
            Some(true) => GridResult::Hit(distance),
            None => GridResult::Unknown,
        }
    }
}

/// The sum of the extents of all edges along an axis.
fn total_extent(vertices: &[DVec3], axis: usize) -> f64 {
    let last = vertices.last().into_iter();
    last.chain(vertices).zip(vertices).map(|(a, b)| (b[axis] - a[axis]).abs()).sum()
}

fn edges(corners: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
    let next = corners.iter().cycle().skip(1);
    corners.iter().copied().zip(next.copied())
}

/// The cells between two coordinates, and one more on each side.
fn cells_around(low: f64, high: f64, count: usize) -> std::ops::Range<usize> {
    (low - 1.0).max(0.0) as usize..((high + 2.0).max(0.0) as usize).min(count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polygon::{RayFrame, intersect};

    /// A star with many points and a round hole, joined by a seam, in a tilted plane.
    fn star_with_a_hole(points: usize) -> Vec<DVec3> {
        let turned = |x: f64, y: f64| DVec3::new(x, y, 3.0 + 0.4 * x - 0.7 * y);
        let angle = |index: usize| std::f64::consts::TAU * index as f64 / points as f64;
        let mut vertices: Vec<DVec3> = (0..=points)
            .map(|index| {
                let radius = if index % 2 == 0 { 2.0 } else { 1.4 };
                turned(radius * angle(index).cos(), radius * angle(index).sin())
            })
            .collect();
        vertices.extend((0..=points).map(|index| {
            let back = angle(points - index);
            turned(0.5 * back.cos(), 0.5 * back.sin())
        }));
        vertices
    }

    #[test]
    fn grid_and_edges_agree_for_every_ray() {
        let flat = star_with_a_hole(80);
        let (answered, met) = agreeing(&flat);
        assert!(answered > 19_000 && met > 2_500, "{answered} answered, {met} met");
        // Rounded to five decimals, as files are.
        let rounded: Vec<DVec3> = flat.iter().map(|vertex| (1e5 * *vertex).round() / 1e5).collect();
        let (answered, met) = agreeing(&rounded);
        assert!(answered > 19_000 && met > 2_500, "{answered} answered, {met} met");
    }

    /// Number of rays that the grid answers, all like the edges, and of those that hit.
    fn agreeing(vertices: &[DVec3]) -> (u32, u32) {
        let outline = Outline::new(vertices).unwrap();
        let (mut answered, mut met) = (0, 0);
        for index in 0..20_000 {
            let place = |step: f64| (f64::from(index) * step).fract();
            let target = DVec3::new(5.0 * place(0.754_877) - 2.5, 5.0 * place(0.569_840) - 2.5, 3.0);
            let origin = DVec3::new(8.0 * place(0.819_172) - 4.0, 8.0 * place(0.671_043) - 4.0, 9.0 * place(0.549_7));
            let Some(ray) = Ray::new(origin, target - origin) else { continue };
            let exact = intersect(vertices, &ray, &RayFrame::new(&ray), f64::NEG_INFINITY..f64::INFINITY);
            match outline.classify(&ray, &(f64::NEG_INFINITY..f64::INFINITY)) {
                GridResult::Miss => assert_eq!(exact, None, "ray {index}"),
                GridResult::Hit(distance) => {
                    met += 1;
                    assert_eq!(exact, Some(distance), "ray {index}");
                }
                GridResult::Unknown => continue,
            }
            answered += 1;
        }
        (answered, met)
    }

    #[test]
    fn nonplanar_polygons_have_no_grid() {
        let mut vertices = star_with_a_hole(40);
        vertices[3].z += 1e-3;
        assert!(Outline::new(&vertices).is_none());
        assert!(Outline::new(&[DVec3::ZERO; 40]).is_none());
    }
}
