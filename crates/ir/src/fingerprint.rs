//! Fingerprint of a scene.

use crate::{Axis, Mesh, Scene, Shape, Transform};
use glam::DVec3;
use std::fmt::{self, Write};

impl Scene {
    /// Fingerprint of the scene, which identifies data computed and saved for it.
    ///
    /// Scenes of equal fingerprint have the same surfaces, materials, functions and data, except
    /// for collisions of 64 bits. Names of surfaces, positions in the text and file names do not
    /// count.
    #[must_use]
    pub fn fingerprint(&self) -> u64 {
        let mut hash = Fingerprint::default();
        hash.scene(self);
        hash.0
    }
}

/// FNV-1a over 64-bit words.
struct Fingerprint(u64);

impl Default for Fingerprint {
    fn default() -> Self {
        Fingerprint(0xcbf2_9ce4_8422_2325)
    }
}

impl Fingerprint {
    fn scene(&mut self, scene: &Scene) {
        for modifier in scene.modifiers.items() {
            self.debug(&modifier.modifier);
            self.debug(&modifier.kind);
            // Options such as `-ae` select modifiers by name.
            self.debug(&scene.names.get(modifier.name));
        }
        self.points(&scene.vertices);
        for surface in scene.surfaces.items() {
            self.word(surface.modifier.map_or(0, |modifier| modifier.index() as u64 + 1));
            match &surface.shape {
                Shape::Polygon { start, count } => self.word(u64::from(*start) << 32 | u64::from(*count)),
                other => self.debug(other),
            }
        }
        self.debug(&(scene.spheres.items(), scene.cones.items(), scene.rings.items(), scene.sources.items()));
        scene.meshes.items().iter().for_each(|mesh| self.mesh(mesh));
        for placed in scene.mesh_instances.items() {
            self.word(placed.mesh.index() as u64);
            self.transform(&placed.to_scene);
        }
        scene.octrees.items().iter().for_each(|octree| self.scene(&octree.scene));
        for placed in scene.instances.items() {
            self.word(placed.octree.index() as u64);
            self.transform(&placed.to_scene);
        }
        self.data(scene);
    }

    fn data(&mut self, scene: &Scene) {
        for grid in scene.grids.items() {
            grid.axes.iter().for_each(|axis: &Axis| self.debug(axis));
            grid.values.iter().for_each(|value| self.word(u64::from(value.to_bits())));
        }
        for picture in scene.pictures.items() {
            self.debug(&(picture.width, picture.height, picture.extent));
            picture.pixels.as_flattened().iter().for_each(|value| self.word(u64::from(value.to_bits())));
        }
        scene.fonts.items().iter().for_each(|font| self.debug(&font.glyphs));
        scene.bsdfs.items().iter().for_each(|data| self.debug(&data.bsdf));
    }

    fn mesh(&mut self, mesh: &Mesh) {
        self.points(&mesh.vertices);
        self.points(&mesh.normals);
        mesh.uvs.as_flattened().iter().for_each(|number| self.word(number.to_bits()));
        for triangle in &mesh.triangles {
            triangle.vertices.iter().for_each(|vertex| self.word(u64::from(*vertex)));
            let modifier = triangle.modifier.map_or(0, |modifier| modifier.index() as u64 + 1);
            self.word(modifier << 2 | u64::from(triangle.smooth) << 1 | u64::from(triangle.textured));
        }
    }

    fn transform(&mut self, transform: &Transform) {
        transform.rotation.to_cols_array().iter().for_each(|number| self.word(number.to_bits()));
        self.word(transform.scale.to_bits());
        self.points(&[transform.translation]);
    }

    fn points(&mut self, points: &[DVec3]) {
        self.word(points.len() as u64);
        points.iter().flat_map(|point| point.to_array()).for_each(|number| self.word(number.to_bits()));
    }

    /// Hashes the debug output of a small value.
    fn debug(&mut self, what: &impl fmt::Debug) {
        // Our `write_str` never fails.
        let _ = write!(self, "{what:?}");
    }

    fn word(&mut self, word: u64) {
        self.0 = (self.0.rotate_left(23) ^ word).wrapping_mul(0x0000_0100_0000_01b3);
    }
}

impl Write for Fingerprint {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.word(text.len() as u64);
        text.bytes().for_each(|byte| self.word(u64::from(byte)));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::{Glossy, Material, Modifier, ModifierKind, Rgb, Scene, Shape, Sphere, Surface};
    use glam::DVec3;

    fn ball(radius: f64, reflectance: f64) -> Scene {
        let mut scene = Scene::default();
        let name = scene.names.add("ball");
        let paint = Material::Plastic(Glossy { color: Rgb([reflectance; 3]), specularity: 0.0, roughness: 0.0 });
        let paint = Modifier { name, span: None, modifier: None, kind: ModifierKind::Material(paint) };
        let paint = scene.modifiers.add(paint);
        let sphere = scene.spheres.add(Sphere { center: DVec3::ZERO, radius, facing: Default::default() });
        scene.surfaces.add(Surface { name, span: None, modifier: Some(paint), shape: Shape::Sphere(sphere) });
        scene
    }

    #[test]
    fn a_changed_size_or_colour_is_another_scene() {
        assert_eq!(ball(1.0, 0.5).fingerprint(), ball(1.0, 0.5).fingerprint());
        assert_ne!(ball(1.0, 0.5).fingerprint(), ball(1.0 + 1e-15, 0.5).fingerprint());
        assert_ne!(ball(1.0, 0.5).fingerprint(), ball(1.0, 0.6).fingerprint());
    }
}
