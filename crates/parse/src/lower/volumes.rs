//! Instances of files: `mesh` and `instance`.

use super::reader::{Here, Reader};
use crate::Kind;
use crate::syntax::Primitive;
use radsight_diag::Diagnostic;
use radsight_ir::{Instance, MeshInstance, Shape};

impl Reader<'_> {
    pub(super) fn volume(&mut self, primitive: &Primitive<'_>, here: Here<'_>) {
        let modifier = self.surface_modifier(primitive, here);
        if self.has_integers(primitive, here) || self.has_most_surfaces(primitive, here) {
            return;
        }
        let raw = self.raw(primitive, None, here);
        let Some(file) = raw.strings.first() else {
            let message = format!("{} \"{}\" names no file", raw.kind, self.scene.names.get(raw.name));
            return self.log.push(Diagnostic::error(message).at(raw.counts[0]));
        };
        let Some((_, to_scene)) = self.split_transform(&raw, 1) else { return };
        let shape = match raw.kind {
            Kind::Mesh => self.mesh(file).map(|mesh| {
                let placed = MeshInstance { mesh, to_scene };
                Shape::Mesh(self.scene.mesh_instances.add(placed))
            }),
            _ => self.octree(file).map(|octree| {
                let placed = Instance { octree, to_scene };
                Shape::Instance(self.scene.instances.add(placed))
            }),
        };
        if let Some(shape) = shape {
            self.add_surface(primitive, shape, here, modifier);
        }
    }
}
