//! Intersection tests of surfaces and cubes.

use crate::TINY;
use glam::DVec3;
use radsight_ir::{Cube, Scene, Shape, Sphere, Transform};

/// Relation of a surface and a cube.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Touch {
    /// They are disjoint.
    Outside,
    /// The surface, or the boundary of a volume, crosses the cube.
    Crosses,
    /// The cube is inside the volume.
    Fills,
}

/// Geometry of a surface.
#[derive(Clone, Debug)]
pub(crate) enum Form<'a> {
    Polygon(&'a [DVec3]),
    Sphere(Sphere),
    Revolution(Revolution),
    /// The cube of an instanced octree, with its transform.
    Volume {
        cube: Cube,
        to_scene: Transform,
        to_file: Transform,
    },
    /// A distant source.
    Distant,
}

/// A surface of revolution of a line segment: cone, cylinder or ring.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Revolution {
    origin: DVec3,
    /// Unit vector.
    axis: DVec3,
    /// Position along the axis and distance from it, of both ends.
    ends: [[f64; 2]; 2],
}

impl<'a> Form<'a> {
    pub(crate) fn of(scene: &'a Scene, shape: Shape) -> Self {
        match shape {
            Shape::Polygon { start, count } => {
                let range = start as usize..start as usize + count as usize;
                Form::Polygon(scene.vertices.get(range).unwrap_or_default())
            }
            Shape::Sphere(handle) => Form::Sphere(scene.spheres[handle]),
            Shape::Cone(handle) => {
                let cone = &scene.cones[handle];
                let along = cone.apex - cone.base;
                let ends = [[0.0, cone.base_radius], [along.length(), cone.apex_radius]];
                Form::Revolution(Revolution { origin: cone.base, axis: along.normalize_or_zero(), ends })
            }
            Shape::Ring(handle) => {
                let ring = &scene.rings[handle];
                let ends = [[0.0, ring.inner_radius], [0.0, ring.outer_radius]];
                Form::Revolution(Revolution { origin: ring.center, axis: ring.normal, ends })
            }
            Shape::Mesh(handle) => {
                let placed = &scene.mesh_instances[handle];
                Form::volume(scene.meshes[placed.mesh].cube, placed.to_scene)
            }
            Shape::Instance(handle) => {
                let placed = &scene.instances[handle];
                Form::volume(scene.octrees[placed.octree].cube, placed.to_scene)
            }
            Shape::Source(_) => Form::Distant,
        }
    }

    fn volume(cube: Cube, to_scene: Transform) -> Self {
        Form::Volume { cube, to_scene, to_file: to_scene.inverse() }
    }

    /// Corners of the bounding box.
    pub(crate) fn bounds(&self) -> [DVec3; 2] {
        match self {
            Form::Polygon(vertices) => bounds(vertices.iter().copied()),
            Form::Sphere(sphere) => [sphere.center - sphere.radius, sphere.center + sphere.radius],
            Form::Revolution(form) => {
                let reach = DVec3::ONE - form.axis * form.axis;
                let reach = DVec3::new(reach.x.max(0.0).sqrt(), reach.y.max(0.0).sqrt(), reach.z.max(0.0).sqrt());
                bounds(form.ends.into_iter().flat_map(|[along, radius]| {
                    let center = form.origin + form.axis * along;
                    [center - reach * radius, center + reach * radius]
                }))
            }
            Form::Volume { cube, to_scene, .. } => bounds(corners(cube).map(|corner| to_scene.point(corner))),
            Form::Distant => bounds([]),
        }
    }

    /// Time that a test takes, relative to that of a triangle or a simple form.
    pub(crate) fn cost(&self) -> usize {
        match self {
            Form::Polygon(vertices) => vertices.len().div_ceil(4),
            _ => 1,
        }
    }

    pub(crate) fn touch(&self, cube: &Cube) -> Touch {
        let crosses = match self {
            Form::Polygon(vertices) => polygon_crosses(vertices, cube),
            Form::Sphere(sphere) => sphere_crosses(sphere, cube),
            Form::Revolution(form) => form.crosses(cube, 2),
            Form::Volume { cube: inner, to_scene, to_file } => return volume_touch(inner, to_scene, to_file, cube),
            Form::Distant => false,
        };
        if crosses { Touch::Crosses } else { Touch::Outside }
    }
}

fn bounds(points: impl IntoIterator<Item = DVec3>) -> [DVec3; 2] {
    let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    points.into_iter().fold(none, |[low, high], point| [low.min(point), high.max(point)])
}

fn corners(cube: &Cube) -> impl Iterator<Item = DVec3> {
    (0..8).map(|index| {
        let offset = [1, 2, 4].map(|bit| if index & bit == 0 { 0.0 } else { cube.size });
        cube.origin + DVec3::from_array(offset)
    })
}

/// Clips the polygon by the six faces of the cube (Sutherland and Hodgman, "Reentrant polygon
/// clipping", 1974). A clipped concave polygon may have seams without area, so the test can report
/// false positives, but no false negatives.
fn polygon_crosses(vertices: &[DVec3], cube: &Cube) -> bool {
    let (low, high) = (cube.origin - TINY, cube.origin + cube.size + TINY);
    let is_inside = |vertex: &DVec3| vertex.cmpge(low).all() && vertex.cmple(high).all();
    if vertices.iter().any(is_inside) {
        return true;
    }
    let mut kept = vertices.to_vec();
    let mut cut = Vec::new();
    for axis in 0..3 {
        for (side, border) in [(1.0, low[axis]), (-1.0, -high[axis])] {
            let height = |vertex: DVec3| side * vertex[axis] - border;
            cut.clear();
            let Some(mut before) = kept.last().copied() else { return false };
            for vertex in kept.iter().copied() {
                let (h0, h1) = (height(before), height(vertex));
                if (h0 < 0.0) != (h1 < 0.0) {
                    cut.push(before + (vertex - before) * (h0 / (h0 - h1)));
                }
                if h1 >= 0.0 {
                    cut.push(vertex);
                }
                before = vertex;
            }
            std::mem::swap(&mut kept, &mut cut);
        }
    }
    !kept.is_empty()
}

/// Whether the closest point of the cube is inside the sphere and the farthest outside it.
fn sphere_crosses(sphere: &Sphere, cube: &Cube) -> bool {
    let (low, high) = (cube.origin, cube.origin + cube.size);
    let nearest = sphere.center.clamp(low, high).distance(sphere.center);
    let farthest = (sphere.center - low).abs().max((sphere.center - high).abs()).length();
    nearest <= sphere.radius + TINY && farthest >= sphere.radius - TINY
}

impl Revolution {
    /// Compares the distance of the cube's centre with the inscribed and the circumscribed sphere
    /// of the cube; if these disagree, tests the eight parts.
    fn crosses(&self, cube: &Cube, depth: u32) -> bool {
        let half = 0.5 * cube.size;
        let distance = self.distance(cube.origin + half);
        if distance > half * 3.0_f64.sqrt() + TINY {
            return false;
        }
        if distance <= half || depth == 0 {
            return true;
        }
        corners(&Cube { origin: cube.origin, size: half })
            .any(|origin| self.crosses(&Cube { origin, size: half }, depth - 1))
    }

    /// Distance of a point from the surface. The closest point is in the plane of the point and the
    /// axis.
    fn distance(&self, point: DVec3) -> f64 {
        let offset = point - self.origin;
        let along = offset.dot(self.axis);
        let from_axis = (offset - self.axis * along).length();
        let [[along_0, radius_0], [along_1, radius_1]] = self.ends;
        let segment = [along_1 - along_0, radius_1 - radius_0];
        let squared = segment[0] * segment[0] + segment[1] * segment[1];
        let dot = (along - along_0) * segment[0] + (from_axis - radius_0) * segment[1];
        let share = if squared > 0.0 { (dot / squared).clamp(0.0, 1.0) } else { 0.0 };
        let nearest = [along_0 + share * segment[0], radius_0 + share * segment[1]];
        (along - nearest[0]).hypot(from_axis - nearest[1])
    }
}

/// Tests two cubes of different orientation: they are disjoint if a plane along a face of one, or
/// along an edge of each, separates them (Gottschalk, Lin and Manocha, "OBBTree", 1996).
fn volume_touch(inner: &Cube, to_scene: &Transform, to_file: &Transform, cube: &Cube) -> Touch {
    let low = inner.origin;
    let high = inner.origin + inner.size;
    if corners(cube)
        .map(|corner| to_file.point(corner))
        .all(|corner| corner.cmpge(low).all() && corner.cmple(high).all())
    {
        return Touch::Fills;
    }
    let turned = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| to_scene.direction(axis));
    let half = [0.5 * cube.size, 0.5 * inner.size * to_scene.scale];
    let between = to_scene.point(inner.origin + half[1] / to_scene.scale) - (cube.origin + half[0]);
    let reach = |axis: DVec3| {
        let of_turned: f64 = turned.iter().map(|edge| edge.dot(axis).abs()).sum();
        half[0] * axis.abs().element_sum() + half[1] * of_turned + TINY
    };
    let straight = [DVec3::X, DVec3::Y, DVec3::Z];
    let crossed = straight.iter().flat_map(|edge| turned.iter().map(|other| edge.cross(*other)));
    let mut planes = straight.into_iter().chain(turned).chain(crossed);
    let are_apart = planes.any(|axis| between.dot(axis).abs() > reach(axis));
    if are_apart { Touch::Outside } else { Touch::Crosses }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat3;
    use proptest::prelude::*;
    use radsight_ir::{Cone, Ring, Surface};

    const CUBE: Cube = Cube { origin: DVec3::ZERO, size: 1.0 };

    fn point(range: std::ops::Range<f64>) -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(range).prop_map(DVec3::from_array)
    }

    fn revolution(scene: &Scene) -> Form<'_> {
        Form::of(scene, scene.surfaces.items()[0].shape)
    }

    fn cone(base: DVec3, apex: DVec3, radii: [f64; 2]) -> Scene {
        let mut scene = Scene::default();
        let cone = Cone { base, apex, base_radius: radii[0], apex_radius: radii[1], facing: Default::default() };
        let shape = Shape::Cone(scene.cones.add(cone));
        let name = scene.names.add("c");
        scene.surfaces.add(Surface { name, span: None, modifier: None, shape });
        scene
    }

    proptest! {
        #[test]
        fn a_triangle_with_a_point_in_the_cube_touches_it(a in point(-3.0..3.0), b in point(-3.0..3.0), inside in point(0.0..1.0), s in 0.05..0.9_f64, t in 0.05..0.9_f64) {
            // The third vertex is chosen so that the point lies on the triangle.
            let (s, t) = if s + t < 0.95 { (s, t) } else { (0.4 * s, 0.4 * t) };
            let c = (inside - a * s - b * t) / (1.0 - s - t);
            prop_assert!(polygon_crosses(&[a, b, c], &CUBE));
        }

        #[test]
        fn a_cone_with_a_point_in_the_cube_touches_it(
            inside in point(0.0..1.0),
            length in point(-2.0..2.0),
            radii in prop::array::uniform2(0.01..2.0_f64),
            along in 0.0..1.0_f64,
            turn in 0.0..std::f64::consts::TAU,
        ) {
            prop_assume!(length.length() > 0.01);
            let axis = length.normalize();
            let side = axis.any_orthonormal_vector();
            let radius = radii[0] + (radii[1] - radii[0]) * along;
            let base = inside - length * along - (side * turn.cos() + axis.cross(side) * turn.sin()) * radius;
            let scene = cone(base, base + length, radii);
            let form = revolution(&scene);
            prop_assert_eq!(form.touch(&CUBE), Touch::Crosses);
            let [low, high] = form.bounds();
            prop_assert!((low - 1e-9).cmple(inside).all() && (high + 1e-9).cmpge(inside).all());
        }

        #[test]
        fn a_placed_cube_with_a_point_in_the_cube_touches_it(inside in point(0.0..1.0), own in point(0.0..1.0), turns in prop::array::uniform2(0.0..6.0_f64), scale in 0.1..4.0_f64) {
            let rotation = DMat3::from_rotation_x(turns[0]) * DMat3::from_rotation_z(turns[1]);
            let mut to_scene = Transform { rotation, scale, translation: DVec3::ZERO };
            to_scene.translation = inside - to_scene.point(own);
            let form = Form::volume(CUBE, to_scene);
            prop_assert_ne!(form.touch(&CUBE), Touch::Outside);
        }
    }

    #[test]
    fn what_lies_beside_a_cube_is_outside() {
        let triangle = [DVec3::new(1.5, -1.0, 0.5), DVec3::new(-1.0, 1.5, 0.5), DVec3::new(1.5, 1.5, 0.5)];
        assert!(polygon_crosses(&triangle, &CUBE));
        assert!(!polygon_crosses(&triangle.map(|vertex| vertex + 1.6 * DVec3::new(1.0, 1.0, 0.0)), &CUBE));
        let beside = Sphere { center: DVec3::new(2.0, 2.0, 0.5), radius: 1.4, facing: Default::default() };
        assert!(!sphere_crosses(&beside, &CUBE) && sphere_crosses(&Sphere { radius: 1.45, ..beside }, &CUBE));
        let around = Sphere { center: DVec3::splat(0.5), radius: 0.9, facing: Default::default() };
        assert!(!sphere_crosses(&around, &CUBE), "the cube is inside, not on, the sphere");
        let thin = cone(DVec3::new(2.2, 0.0, 0.5), DVec3::new(0.0, 2.2, 0.5), [0.1, 0.1]);
        assert_eq!(revolution(&thin).touch(&Cube { origin: DVec3::ZERO, size: 0.9 }), Touch::Outside);
        let turned =
            Transform { rotation: DMat3::from_rotation_z(0.785), scale: 1.0, translation: DVec3::new(1.9, 0.8, 0.0) };
        assert_eq!(Form::volume(CUBE, turned).touch(&CUBE), Touch::Outside);
        assert_eq!(Form::volume(CUBE, Transform { scale: 9.0, ..Transform::IDENTITY }).touch(&CUBE), Touch::Fills);
    }

    #[test]
    fn a_ring_is_its_area_without_the_hole() {
        let mut scene = Scene::default();
        let ring = Ring { center: DVec3::splat(0.5), normal: DVec3::Z, inner_radius: 2.0, outer_radius: 3.0 };
        let shape = Shape::Ring(scene.rings.add(ring));
        assert_eq!(Form::of(&scene, shape).touch(&CUBE), Touch::Outside);
        assert_eq!(
            Form::of(&scene, shape).touch(&Cube { origin: DVec3::new(2.0, 0.0, 0.0), size: 1.0 }),
            Touch::Crosses
        );
    }
}
