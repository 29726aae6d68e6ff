//! The bounding box of a scene, as Radiance computes it.

use glam::DVec3;
use radsight_ir::{Cone, Cube, Ring, Scene, Shape, Sphere, Surface, Transform};

/// Margin by which the cube of `oconv` exceeds the scene on each side, as in Radiance.
const CUBE_MARGIN: f64 = 1e-5;

/// An axis-aligned bounding box, scene units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The corner with the smallest coordinates.
    pub low: DVec3,
    /// The corner with the largest coordinates.
    pub high: DVec3,
}

/// The bounding box that real `getbbox` prints; `None` for a scene without local surfaces.
///
/// Flat and round surfaces are bounded exactly, meshes and instances by the cubes of their files.
#[must_use]
pub fn bounds(scene: &Scene) -> Option<Bounds> {
    let mut all = Bounds::EMPTY;
    scene.surfaces.items().iter().for_each(|surface| all.add_shape(scene, &surface.shape));
    all.checked()
}

/// The bounding box of one surface, computed as in [`bounds`]; `None` for a distant source.
#[must_use]
pub fn surface_bounds(scene: &Scene, surface: &Surface) -> Option<Bounds> {
    let mut own = Bounds::EMPTY;
    own.add_shape(scene, &surface.shape);
    own.checked()
}

/// The cube in which real `oconv` builds its octree; `None` for a scene without local surfaces.
#[must_use]
pub fn cube(scene: &Scene) -> Option<Cube> {
    bounds(scene).map(|bounds| bounds.cube(CUBE_MARGIN))
}

impl Bounds {
    const EMPTY: Bounds = Bounds { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    /// The box itself if it is not empty.
    fn checked(self) -> Option<Bounds> {
        self.low.cmple(self.high).all().then_some(self)
    }

    fn add_shape(&mut self, scene: &Scene, shape: &Shape) {
        match *shape {
            Shape::Polygon { start, count } => {
                let range = start as usize..start as usize + count as usize;
                let vertices = scene.vertices.get(range).unwrap_or_default();
                vertices.iter().for_each(|vertex| self.add(*vertex));
            }
            Shape::Sphere(handle) => self.add_sphere(&scene.spheres[handle]),
            Shape::Cone(handle) => self.add_cone(&scene.cones[handle]),
            Shape::Ring(handle) => self.add_ring(&scene.rings[handle]),
            Shape::Source(_) => {}
            Shape::Mesh(handle) => {
                let placed = &scene.mesh_instances[handle];
                self.add_cube(&scene.meshes[placed.mesh].cube, &placed.to_scene);
            }
            Shape::Instance(handle) => {
                let placed = &scene.instances[handle];
                self.add_cube(&scene.octrees[placed.octree].cube, &placed.to_scene);
            }
        }
    }

    fn add(&mut self, point: DVec3) {
        self.low = self.low.min(point);
        self.high = self.high.max(point);
    }

    fn add_sphere(&mut self, sphere: &Sphere) {
        self.add(sphere.center - sphere.radius);
        self.add(sphere.center + sphere.radius);
    }

    fn add_cone(&mut self, cone: &Cone) {
        let axis = (cone.apex - cone.base).normalize_or_zero();
        self.add_circle(cone.base, axis, cone.base_radius);
        self.add_circle(cone.apex, axis, cone.apex_radius);
    }

    fn add_ring(&mut self, ring: &Ring) {
        self.add_circle(ring.center, ring.normal, ring.outer_radius);
    }

    /// Extends the box by a circle. A circle extends `radius·sin(angle between axis and
    /// coordinate)` along each coordinate; the sine comes from the two other components of the
    /// axis, which keeps its digits where it is small.
    fn add_circle(&mut self, center: DVec3, axis: DVec3, radius: f64) {
        let reach = radius * DVec3::new(axis.y.hypot(axis.z), axis.z.hypot(axis.x), axis.x.hypot(axis.y));
        self.add(center - reach);
        self.add(center + reach);
    }

    fn add_cube(&mut self, cube: &Cube, to_scene: &Transform) {
        for corner in 0..8 {
            let offset = [1, 2, 4].map(|bit| if corner & bit == 0 { 0.0 } else { cube.size });
            self.add(to_scene.point(cube.origin + DVec3::from_array(offset)));
        }
    }

    fn cube(&self, margin: f64) -> Cube {
        let size = (self.high - self.low).max_element() + 2.0 * margin;
        Cube { origin: 0.5 * (self.low + self.high - size), size }
    }
}
