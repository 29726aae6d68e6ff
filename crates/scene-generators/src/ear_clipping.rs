//! Triangulation of an outline by ear clipping, in the order of Radiance.
//!
//! The order decides which diagonal cuts a face, and so its shape if its corners lie in no plane, and how textures and
//! normals run over it.

use radsight_triangulation::doubled_area;

/// Doubled area of an ear, relative to that of the outline, below which its tip lies on a straight line.
const STRAIGHT: f64 = 1e-10;

/// The triangles of an outline, as indices of its points and with its orientation; `None` if it intersects itself.
///
/// The first ear is that of the first point, seen counter-clockwise: a quadrilateral is cut from its second to its
/// fourth point, and from its first to its third if it is clockwise. Points on a straight line are left out. Edges may
/// touch, as those of a seam do.
pub(crate) fn clip_ears(outline: &[[f64; 2]]) -> Option<Vec<[usize; 3]>> {
    let area = doubled_area(outline);
    let mut rest: Vec<usize> = (0..outline.len()).collect();
    if area <= 0.0 {
        rest.reverse();
    }
    let straight = STRAIGHT * area.abs();
    let mut triangles = Vec::new();
    let (mut current, mut rejected) = (rest.len().saturating_sub(1), 0);
    while rest.len() > 2 {
        if rejected == 2 * rest.len() {
            return None;
        }
        let before = if current < rest.len() { current } else { 0 };
        let tip = (before + 1) % rest.len();
        let after = (tip + 1) % rest.len();
        let ear = [before, tip, after].map(|at| rest[at]);
        let size = doubled_area(&ear.map(|index| outline[index]));
        let is_straight = size.abs() < straight;
        let is_ear = size >= straight && !rest.iter().any(|index| blocks(outline, ear, *index));
        if is_ear {
            triangles.push(if area <= 0.0 { [ear[2], ear[1], ear[0]] } else { ear });
        }
        rejected += 1;
        if is_ear || is_straight {
            rest.remove(tip);
            rejected = 0;
        }
        current = tip;
    }
    Some(triangles)
}

/// Whether a point lies in a counter-clockwise ear or on its border, but not at one of its corners.
fn blocks(outline: &[[f64; 2]], ear: [usize; 3], index: usize) -> bool {
    let [a, b, c] = ear.map(|corner| outline[corner]);
    let point = outline[index];
    if ear.contains(&index) || [a, b, c].contains(&point) {
        return false;
    }
    cross(a, b, point) >= 0.0 && cross(b, c, point) >= 0.0 && cross(c, a, point) >= 0.0
}

/// Twice the area of a triangle, positive if it is counter-clockwise.
fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [[f64; 2]; 4] = [[0., 0.], [1., 0.], [1., 1.], [0., 1.]];

    #[test]
    fn quadrilaterals_are_cut_from_the_second_to_the_fourth_point() {
        assert_eq!(clip_ears(&SQUARE), Some(vec![[3, 0, 1], [1, 2, 3]]));
    }

    #[test]
    fn clockwise_quadrilaterals_are_cut_from_the_first_to_the_third_point() {
        let turned = [SQUARE[0], SQUARE[3], SQUARE[2], SQUARE[1]];
        assert_eq!(clip_ears(&turned), Some(vec![[2, 3, 0], [0, 1, 2]]));
    }

    #[test]
    fn the_size_of_an_outline_has_no_influence() {
        for size in [1e-9, 1e9] {
            let outline = SQUARE.map(|point| point.map(|coordinate| size * coordinate));
            assert_eq!(clip_ears(&outline), clip_ears(&SQUARE));
        }
    }

    #[test]
    fn a_notch_stays_open() {
        let dart = [[0., 0.], [2., 1.], [0., 2.], [1., 1.]];
        let triangles = clip_ears(&dart).unwrap();
        let area: f64 = triangles.iter().map(|corners| doubled_area(&corners.map(|index| dart[index]))).sum();
        assert_eq!(area, doubled_area(&dart));
    }

    #[test]
    fn outlines_that_cross_themselves_have_no_triangles() {
        assert_eq!(clip_ears(&[[0., 0.], [1., 1.], [1., 0.], [0., 1.], [-1., 3.], [2., 3.]]), None);
        assert_eq!(clip_ears(&[]), Some(Vec::new()));
    }
}
