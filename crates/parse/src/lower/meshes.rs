//! Meshes, with the materials inside their files.

use super::modifiers::{RawHandle, RawWord};
use super::reader::Reader;
use glam::DVec3;
use radsight_diag::{Diagnostic, Span};
use radsight_formats::{Mesh as MeshFile, Object};
use radsight_ir::{Cube, Handle, Mesh, MeshTriangle, ModifierHandle, Shape};
use radsight_loader::{FileKind, Loader};
use std::collections::HashMap;

/// The meshes of a scene.
#[derive(Default)]
pub(super) struct Meshes {
    /// By file name; `None` for those that could not be read.
    by_file: HashMap<String, Option<Handle<Mesh>>>,
    /// By mesh index.
    materials: Vec<Materials>,
}

/// The materials of a mesh, until their handles are known.
struct Materials {
    modifiers: Vec<Option<RawHandle>>,
    /// For each triangle, an index into the materials above.
    of_triangles: Vec<Option<u32>>,
}

impl Reader<'_> {
    /// A mesh, loaded at its first use. `None` after a mistake, which was reported.
    pub(super) fn mesh(&mut self, file: &RawWord) -> Option<Handle<Mesh>> {
        if let Some(known) = self.meshes.by_file.get(&file.text) {
            return *known;
        }
        let handle = match self.load_mesh(file) {
            Ok(handle) => Some(handle),
            Err(message) => {
                self.log.push(Diagnostic::error(message).at(file.span));
                None
            }
        };
        self.meshes.by_file.insert(file.text.clone(), handle);
        handle
    }

    fn load_mesh(&mut self, file: &RawWord) -> Result<Handle<Mesh>, String> {
        let loaded = self.loader.load(&file.text, FileKind::Mesh).map_err(|error| error.to_string())?;
        let read = MeshFile::read(&loaded.bytes).map_err(|error| format!("\"{}\": {error}", loaded.path))?;
        let modifiers = self.embedded_modifiers(&loaded.path, &read.objects, file.span);
        let of_triangles = read.triangles.iter().map(|triangle| triangle.material).collect();
        self.meshes.materials.push(Materials { modifiers, of_triangles });
        Ok(self.scene.meshes.add(mesh(&file.text, &read)))
    }

    /// The modifiers inside a mesh file. They may use those of the scene, but the scene cannot use
    /// them.
    fn embedded_modifiers(&mut self, path: &str, objects: &[Object<'_>], span: Span) -> Vec<Option<RawHandle>> {
        if objects.is_empty() {
            return Vec::new();
        }
        let surfaces = self.surface_modifiers.len();
        let numberer = std::mem::take(&mut self.numberer);
        self.modifiers.open_scope();
        let mut handles = Vec::with_capacity(objects.len());
        self.read_objects(format!("<materials of {path}>"), objects, Some(span), |reader, object| {
            handles.push(reader.modifiers.find(&object.name));
        });
        handles.resize(objects.len(), None);
        self.modifiers.close_scope();
        self.numberer = numberer;
        if self.surface_modifiers.len() > surfaces {
            self.log.push(Diagnostic::error(format!("\"{path}\" has surfaces among its materials")).at(span));
        }
        handles
    }

    /// The modifiers of meshes that some surface shows.
    pub(super) fn materials_of_meshes(&self) -> Vec<RawHandle> {
        let mut is_shown = vec![false; self.meshes.materials.len()];
        for (surface, modifier) in self.scene.surfaces.items().iter().zip(&self.surface_modifiers) {
            if let (Shape::Mesh(placed), None) = (surface.shape, modifier) {
                is_shown[self.scene.mesh_instances[placed].mesh.index()] = true;
            }
        }
        let shown = self.meshes.materials.iter().zip(is_shown).filter(|(_, is_shown)| *is_shown);
        let modifiers = shown.flat_map(|(materials, _)| {
            let mut indices: Vec<u32> = materials.of_triangles.iter().flatten().copied().collect();
            indices.sort_unstable();
            indices.dedup();
            indices.into_iter().filter_map(|index| materials.modifiers[index as usize])
        });
        modifiers.collect()
    }

    /// Sets the modifier handles of the triangles of all meshes.
    pub(super) fn finish_meshes(&mut self, at: &dyn Fn(RawHandle) -> Option<ModifierHandle>) {
        let materials = std::mem::take(&mut self.meshes.materials);
        for (mesh, materials) in self.scene.meshes.items_mut().iter_mut().zip(materials) {
            for (triangle, index) in mesh.triangles.iter_mut().zip(materials.of_triangles) {
                triangle.modifier = index.and_then(|index| materials.modifiers[index as usize]).and_then(at);
            }
        }
    }
}

fn mesh(file: &str, read: &MeshFile<'_>) -> Mesh {
    let triangles = read.triangles.iter().map(|triangle| MeshTriangle {
        vertices: triangle.vertices,
        smooth: have_all(&read.normals, triangle.vertices),
        textured: have_all(&read.coordinates, triangle.vertices),
        modifier: None,
    });
    Mesh {
        file: file.to_owned(),
        cube: Cube { origin: DVec3::from_array(read.origin), size: read.size },
        vertices: read.vertices.iter().map(|vertex| DVec3::from_array(*vertex)).collect(),
        normals: read.normals.iter().map(|normal| normal.map_or(DVec3::ZERO, DVec3::from_array)).collect(),
        uvs: read.coordinates.iter().map(|pair| pair.unwrap_or_default()).collect(),
        triangles: triangles.collect(),
    }
}

/// Whether all three vertices have an attribute.
fn have_all<T>(of_vertices: &[Option<T>], vertices: [u32; 3]) -> bool {
    vertices.iter().all(|&vertex| of_vertices.get(vertex as usize).is_some_and(Option::is_some))
}
