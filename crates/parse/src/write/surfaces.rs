//! Writes surfaces.

use super::{Arguments, Writer};
use crate::Kind;
use radsight_ir::{Facing, Shape, Surface};
use std::fmt;

impl Writer<'_> {
    pub(super) fn surface(&mut self, surface: &Surface) -> fmt::Result {
        let (kind, arguments) = self.shape(surface.shape);
        let name = self.scene.names.get(surface.name).replace('\t', " ");
        self.primitive(surface.modifier, kind.name(), &name, &arguments)
    }

    fn shape(&self, shape: Shape) -> (Kind, Arguments) {
        let scene = self.scene;
        match shape {
            Shape::Polygon { start, count } => {
                let vertices = scene.polygon_vertices(start, count);
                (Kind::Polygon, Arguments::of_reals(vertices.iter().flat_map(|vertex| vertex.to_array())))
            }
            Shape::Sphere(handle) => {
                let sphere = &scene.spheres[handle];
                let kind = if sphere.facing == Facing::Outward { Kind::Sphere } else { Kind::Bubble };
                (kind, Arguments::of_reals(sphere.center.to_array().into_iter().chain([sphere.radius])))
            }
            Shape::Cone(handle) => {
                let cone = &scene.cones[handle];
                let ends = cone.base.to_array().into_iter().chain(cone.apex.to_array());
                let is_cylinder = cone.base_radius == cone.apex_radius;
                let kind = match (is_cylinder, cone.facing) {
                    (true, Facing::Outward) => Kind::Cylinder,
                    (true, Facing::Inward) => Kind::Tube,
                    (false, Facing::Outward) => Kind::Cone,
                    (false, Facing::Inward) => Kind::Cup,
                };
                let second = (!is_cylinder).then_some(cone.apex_radius);
                (kind, Arguments::of_reals(ends.chain([cone.base_radius]).chain(second)))
            }
            Shape::Ring(handle) => {
                let ring = &scene.rings[handle];
                let place = ring.center.to_array().into_iter().chain(ring.normal.to_array());
                (Kind::Ring, Arguments::of_reals(place.chain([ring.inner_radius, ring.outer_radius])))
            }
            Shape::Source(handle) => {
                let source = &scene.sources[handle];
                let degrees = source.extent.full_angle.to_degrees();
                (Kind::Source, Arguments::of_reals(source.direction.to_array().into_iter().chain([degrees])))
            }
            Shape::Mesh(handle) => {
                let placed = &scene.mesh_instances[handle];
                let strings = vec![scene.meshes[placed.mesh].file.clone()];
                (Kind::Mesh, Arguments { strings, reals: Vec::new() }.with_transform(&placed.to_scene))
            }
            Shape::Instance(handle) => {
                let placed = &scene.instances[handle];
                let strings = vec![scene.octrees[placed.octree].file.clone()];
                (Kind::Instance, Arguments { strings, reals: Vec::new() }.with_transform(&placed.to_scene))
            }
        }
    }
}
