//! Planes of polygons, and polygons whose vertices do not lie in one.
//!
//! Radiance intersects the plane whose normal is that of the area vector, at the mean height of the
//! vertices, and compares the point with the edges in the two coordinates in which the polygon is
//! largest (`common/face.c`). Vertices that are moved along the third coordinate into this plane make
//! the same polygon for everything that uses them.

use crate::{Scene, Shape};
use glam::DVec3;
use std::collections::HashMap;
use std::sync::Arc;

/// Distance of a vertex from the plane, relative to the polygon's size, up to which it stays: more
/// than rounding.
pub(crate) const ROUNDING: f64 = 1e-6;

/// The plane of a polygon.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PolygonPlane {
    normal: DVec3,
    first: DVec3,
    /// Mean height of the vertices above the first one.
    height: f64,
    /// The largest distance of a vertex from the first one.
    size: f64,
}

impl PolygonPlane {
    /// The plane of three vertices or more; `None` if they enclose no area.
    pub(crate) fn of(vertices: &[DVec3]) -> Option<PolygonPlane> {
        let first = vertices[0];
        // Twice the area vector (Newell), relative to the first vertex for accuracy.
        let area: DVec3 = vertices[1..].windows(2).map(|pair| (pair[0] - first).cross(pair[1] - first)).sum();
        let size = vertices.iter().map(|vertex| vertex.distance(first)).fold(0.0, f64::max);
        if area.length() <= 1e-18 * size * size || size == 0.0 {
            return None;
        }
        let normal = area.normalize();
        let height = vertices.iter().map(|vertex| normal.dot(*vertex - first)).sum::<f64>() / vertices.len() as f64;
        Some(PolygonPlane { normal, first, height, size })
    }

    /// Vertices in coordinates of the plane.
    pub(crate) fn flattened(&self, vertices: &[DVec3]) -> Vec<[f64; 2]> {
        radsight_triangulation::flattened(vertices, self.normal)
    }

    fn above(&self, vertex: DVec3) -> f64 {
        self.normal.dot(vertex - self.first) - self.height
    }

    /// The largest distance of a vertex from the plane, relative to the polygon's size.
    pub(crate) fn deviation(&self, vertices: &[DVec3]) -> f64 {
        vertices.iter().map(|vertex| self.above(*vertex).abs()).fold(0.0, f64::max) / self.size
    }

    /// The point of the plane with the same coordinates, except for that in which it is steepest.
    fn projected(&self, vertex: DVec3) -> DVec3 {
        let axis = self.normal.abs().max_position();
        let mut moved = vertex;
        moved[axis] -= self.above(vertex) / self.normal[axis];
        moved
    }
}

/// Moves the vertices of all polygons into their planes, those of placed scenes too.
pub(crate) fn make_planar(scene: &mut Scene) {
    Moved::of(scene, &mut HashMap::new()).apply(scene);
}

/// What changes in a scene.
struct Moved {
    vertices: Vec<(usize, DVec3)>,
    octrees: Vec<(usize, Arc<Scene>)>,
}

/// The changed scenes by the address of the original, which may be placed many times.
type Changed = HashMap<*const Scene, Option<Arc<Scene>>>;

impl Moved {
    fn of(scene: &Scene, changed: &mut Changed) -> Moved {
        let mut vertices = Vec::new();
        for surface in scene.surfaces.items() {
            let Shape::Polygon { start, count } = surface.shape else { continue };
            let corners = scene.polygon_vertices(start, count);
            let Some(plane) = PolygonPlane::of(corners).filter(|plane| plane.deviation(corners) > ROUNDING) else {
                continue;
            };
            vertices.extend((start as usize..).zip(corners.iter().map(|corner| plane.projected(*corner))));
        }
        let octrees = scene.octrees.items().iter().enumerate();
        let octrees = octrees.filter_map(|(index, octree)| Some((index, changed_scene(&octree.scene, changed)?)));
        Moved { vertices, octrees: octrees.collect() }
    }

    fn apply(self, scene: &mut Scene) {
        self.vertices.into_iter().for_each(|(index, vertex)| scene.vertices[index] = vertex);
        self.octrees.into_iter().for_each(|(index, inner)| scene.octrees.items_mut()[index].scene = inner);
    }
}

/// A placed scene with planar polygons; `None` if it is the same.
fn changed_scene(scene: &Arc<Scene>, changed: &mut Changed) -> Option<Arc<Scene>> {
    if let Some(known) = changed.get(&Arc::as_ptr(scene)) {
        return known.clone();
    }
    let moved = Moved::of(scene, changed);
    let new = (!moved.vertices.is_empty() || !moved.octrees.is_empty()).then(|| {
        let mut inner = Scene::clone(scene);
        moved.apply(&mut inner);
        Arc::new(inner)
    });
    changed.insert(Arc::as_ptr(scene), new.clone());
    new
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_warped_polygon_is_projected_to_its_mean_height_along_its_steepest_axis() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.3], [0.0, 1.0, 0.0]].map(DVec3::from_array);
        let plane = PolygonPlane::of(&corners).unwrap();
        let moved = corners.map(|corner| plane.projected(corner));
        assert!(plane.deviation(&corners) > 0.01 && plane.deviation(&moved) < 1e-12);
        for (corner, moved) in corners.iter().zip(moved) {
            assert_eq!([corner.x, corner.y], [moved.x, moved.y]);
        }
        // Radiance: the mean of the four heights at the middle.
        let middle = moved.iter().sum::<DVec3>() / 4.0;
        assert!((middle - DVec3::new(0.5, 0.5, 0.075)).length() < 1e-12, "{middle}");
        let again = PolygonPlane::of(&moved).unwrap();
        assert!(again.normal.distance(plane.normal) < 1e-12);
    }
}
