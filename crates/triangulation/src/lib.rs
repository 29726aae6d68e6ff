//! Triangulation of planar outlines in a limited time.
//!
//! Ear clipping also repairs an outline that intersects itself, but its time for such an outline grows with the third
//! power of the number of corners. It is therefore used for up to 1,000 corners. Above, a constrained Delaunay
//! triangulation takes n log n to n² steps for n corners; outlines that intersect themselves and those of more than
//! 20,000 corners are refused.
//!
//! ```
//! let dart = [[0., 0.], [2., 1.], [0., 2.], [1., 1.]];
//! assert_eq!(radsight_triangulation::triangulate(&dart).unwrap().len(), 2);
//! ```
#![forbid(unsafe_code)]

mod polygon;

pub use polygon::{TriangulatedPolygon, flattened};

use earcut::Earcut;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};
use std::collections::{HashMap, HashSet};

/// Largest number of corners for ear clipping, with which every outline has a triangulation.
pub const MOST_EAR_CLIPPED: usize = 1000;

/// Largest number of corners of an outline. A Delaunay triangulation of as many points close to a few lines takes
/// several seconds, and its time grows with the square of the number.
const MOST_CORNERS: usize = 20_000;

/// Relative difference of the area of an outline and that of its triangles from which the outline intersects itself.
const AREA_TOLERANCE: f64 = 1e-6;

/// Why an outline cannot be triangulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum OutlineError {
    /// It is large and intersects itself.
    #[error("has an outline that intersects itself")]
    SelfIntersecting,
    /// It is too large.
    #[error("has an outline of more than {MOST_CORNERS} corners")]
    TooManyCorners,
}

/// Triangulates an outline; each triangle is given by the indices of its corners.
///
/// The sense of rotation of the triangles is unspecified. Edges may touch, as those of a seam between the border and a
/// hole do.
///
/// # Errors
/// If the outline has more than 1,000 corners and intersects itself, or has more than 20,000 corners.
pub fn triangulate(outline: &[[f64; 2]]) -> Result<Vec<[u32; 3]>, OutlineError> {
    if outline.len() <= MOST_EAR_CLIPPED {
        return Ok(clip_ears(outline));
    }
    if outline.len() > MOST_CORNERS {
        return Err(OutlineError::TooManyCorners);
    }
    delaunay(outline)
}

fn clip_ears(outline: &[[f64; 2]]) -> Vec<[u32; 3]> {
    let mut corners: Vec<u32> = Vec::new();
    Earcut::new().earcut(outline.iter().copied(), &[], &mut corners);
    corners.as_chunks().0.to_vec()
}

type Delaunay = ConstrainedDelaunayTriangulation<Point2<f64>>;

fn delaunay(outline: &[[f64; 2]]) -> Result<Vec<[u32; 3]>, OutlineError> {
    let outline = normalized(outline);
    let (points, first_corners, edges) = distinct(&outline);
    let mut is_crossed = false;
    let triangulation = Delaunay::try_bulk_load_cdt(points, edges, |_| is_crossed = true);
    let triangulation = triangulation.map_err(|_| OutlineError::SelfIntersecting)?;
    let inside = faces_inside(&triangulation);
    let mut triangles = Vec::new();
    let mut area = 0.0;
    for face in triangulation.inner_faces().filter(|face| inside[face.fix().index()] == Some(true)) {
        triangles.push(face.vertices().map(|vertex| first_corners[vertex.fix().index()]));
        area += face.area();
    }
    let enclosed = 0.5 * doubled_area(&outline).abs();
    let is_simple = !is_crossed && (area - enclosed).abs() <= AREA_TOLERANCE * enclosed;
    is_simple.then_some(triangles).ok_or(OutlineError::SelfIntersecting)
}

/// Maps an outline into the square from -1 to 1, where all coordinates are in the range of the triangulation.
fn normalized(outline: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let [origin, ..] = outline else { return Vec::new() };
    let moved = |point: &[f64; 2]| [point[0] - origin[0], point[1] - origin[1]];
    let size = outline.iter().flat_map(moved).map(f64::abs).fold(0.0, f64::max);
    let scale = if size > 0.0 { size } else { 1.0 };
    let on_range = |share: f64| if share.abs() < f64::EPSILON * f64::EPSILON { 0.0 } else { share };
    outline.iter().map(|point| moved(point).map(|coordinate| on_range(coordinate / scale))).collect()
}

/// The points of an outline without repetition, the first corner at each, and the edges that an odd number of sides
/// runs along.
fn distinct(outline: &[[f64; 2]]) -> (Vec<Point2<f64>>, Vec<u32>, Vec<[usize; 2]>) {
    let mut numbers: HashMap<[u64; 2], usize> = HashMap::new();
    let (mut points, mut first_corners) = (Vec::new(), Vec::new());
    let mut corners = Vec::with_capacity(outline.len());
    for (corner, &[x, y]) in (0..).zip(outline) {
        // Adding zero makes a negative zero positive.
        let number = *numbers.entry([x + 0.0, y + 0.0].map(f64::to_bits)).or_insert_with(|| {
            points.push(Point2::new(x + 0.0, y + 0.0));
            first_corners.push(corner);
            points.len() - 1
        });
        corners.push(number);
    }
    let mut odd: HashSet<[usize; 2]> = HashSet::new();
    let sides = corners.iter().zip(corners.iter().cycle().skip(1));
    for (&from, &to) in sides.filter(|(from, to)| from != to) {
        let edge = [from.min(to), from.max(to)];
        if !odd.remove(&edge) {
            odd.insert(edge);
        }
    }
    let mut edges: Vec<[usize; 2]> = odd.into_iter().collect();
    edges.sort_unstable();
    (points, first_corners, edges)
}

/// For each face whether an odd number of edges separates it from the outside; `None` for the outside itself.
fn faces_inside(triangulation: &Delaunay) -> Vec<Option<bool>> {
    let outside = triangulation.outer_face();
    let mut inside = vec![None; triangulation.num_all_faces()];
    let hull = triangulation.directed_edges().filter(|edge| edge.face() == outside);
    let mut waiting: Vec<_> = hull.map(|edge| (edge, false)).collect();
    while let Some((edge, is_inside)) = waiting.pop() {
        // The edge belongs to the face that was left; its reverse to the next one.
        let (next, is_inside) = (edge.rev(), is_inside != edge.is_constraint_edge());
        let face = next.face();
        if face != outside && inside[face.fix().index()].replace(is_inside).is_none() {
            waiting.extend([(next.next(), is_inside), (next.prev(), is_inside)]);
        }
    }
    inside
}

/// Twice the area of an outline, positive if it is counter-clockwise.
#[must_use]
pub fn doubled_area(outline: &[[f64; 2]]) -> f64 {
    let Some(&[x, y]) = outline.first() else { return 0.0 };
    let cross = |pair: &[[f64; 2]]| (pair[0][0] - x) * (pair[1][1] - y) - (pair[0][1] - y) * (pair[1][0] - x);
    outline.windows(2).map(cross).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn area(outline: &[[f64; 2]], triangles: &[[u32; 3]]) -> f64 {
        let corners = |triangle: &[u32; 3]| triangle.map(|corner| outline[corner as usize]);
        let size = |[a, b, c]: [[f64; 2]; 3]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        triangles.iter().map(|triangle| 0.5 * size(corners(triangle)).abs()).sum()
    }

    /// A bar of height 1 with square teeth of length 2; its area is four times the number of teeth.
    fn comb(teeth: u32) -> Vec<[f64; 2]> {
        let tooth = |i: u32| [[2 * i, 1], [2 * i, 3], [2 * i + 1, 3], [2 * i + 1, 1]];
        let bar = [[2 * teeth, 1], [2 * teeth, 0], [0, 0]];
        (0..teeth).flat_map(tooth).chain(bar).map(|point| point.map(f64::from)).collect()
    }

    fn circle(corners: u32, radius: f64) -> Vec<[f64; 2]> {
        let angle = |i: u32| TAU * f64::from(i) / f64::from(corners);
        (0..corners).map(|i| [radius * angle(i).cos(), radius * angle(i).sin()]).collect()
    }

    #[test]
    fn both_methods_fill_the_outline() {
        for teeth in [3, 100, 1_000, 4_999] {
            let outline = comb(teeth);
            let triangles = triangulate(&outline).unwrap();
            let expected = f64::from(4 * teeth);
            assert!((area(&outline, &triangles) - expected).abs() < 1e-9 * expected, "{teeth} teeth");
        }
    }

    #[test]
    fn size_and_offset_do_not_matter() {
        for (size, offset) in [(1e-250, 0.0), (1e140, 0.0), (1e-9, 1.0), (1.0, -1e9)] {
            let outline: Vec<_> = comb(1_000).iter().map(|p| p.map(|c| c * size + offset)).collect();
            let triangles = triangulate(&outline).unwrap();
            let moved: Vec<_> = outline.iter().map(|p| [0, 1].map(|i| (p[i] - outline[0][i]) / size)).collect();
            assert!((area(&moved, &triangles) - 4_000.0).abs() < 1e-3, "{size} {offset}");
        }
    }

    #[test]
    fn a_seam_leaves_the_hole_open() {
        for corners in [50, 800, 4_000] {
            let (hole, border) = (circle(corners, 0.5), circle(corners, 1.0));
            let mut outline = hole.clone();
            outline.extend([hole[0], border[0]]);
            outline.extend(border.iter().rev());
            let triangles = triangulate(&outline).unwrap();
            let expected = 0.375 * f64::from(corners) * (TAU / f64::from(corners)).sin();
            assert!((area(&outline, &triangles) - expected).abs() < 1e-9, "{corners} corners");
        }
    }

    #[test]
    fn large_outlines_that_intersect_themselves_are_refused() {
        let corners = [[0., 0.], [1., 0.], [0., 1.]];
        let laps = |step: f64| -> Vec<[f64; 2]> {
            (0..6_000).map(|i| corners[i % 3].map(|c| 1.0 + c * (1.0 + step * (i / 3) as f64))).collect()
        };
        let star: Vec<_> = (0..5_001).map(|i| f64::from(i * 2_500 % 5_001) * TAU / 5_001.0).collect();
        let star: Vec<_> = star.iter().map(|angle| [angle.cos(), angle.sin()]).collect();
        let line: Vec<_> = (0..2_000).map(|i| [f64::from(i), 0.0]).collect();
        for (name, outline) in [("laps", laps(0.0)), ("spiral", laps(1e-3)), ("star", star), ("line", line)] {
            assert!(triangulate(&outline).map_or(true, |triangles| triangles.is_empty()), "{name}");
        }
    }

    #[test]
    fn small_outlines_that_intersect_themselves_are_triangulated() {
        let bow_tie = [[0., 0.], [1., 1.], [1., 0.], [0., 1.]];
        assert!(!triangulate(&bow_tie).unwrap().is_empty());
        assert_eq!(triangulate(&[]), Ok(Vec::new()));
    }

    /// Outlines through the points of coarse grids repeat points and edges, and overlap.
    #[test]
    fn degenerate_outlines_end() {
        for case in 0..200_u32 {
            let cells = 1 + case % 40;
            let mut state = case;
            let mut next = || {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                f64::from((state >> 16) % (cells + 1))
            };
            let outline: Vec<_> = (0..1_001 + 3 * case).map(|_| [next(), next()]).collect();
            let enclosed = 0.5 * doubled_area(&outline).abs();
            if let Ok(triangles) = triangulate(&outline) {
                assert!((area(&outline, &triangles) - enclosed).abs() <= 1e-5 * enclosed, "case {case}");
            }
        }
        for wrong in [f64::NAN, f64::INFINITY, f64::MAX, 1e-320] {
            let mut outline = comb(1_000);
            outline[500][1] = wrong;
            let _ended = triangulate(&outline);
            outline.iter_mut().for_each(|point| *point = point.map(|coordinate| coordinate * wrong));
            let _ended = triangulate(&outline);
        }
    }

    #[test]
    fn larger_outlines_are_refused() {
        assert_eq!(triangulate(&comb(5_000)), Err(OutlineError::TooManyCorners));
    }
}
