//! Octrees: as whole scenes, and as instances.

use super::meshes::Meshes;
use super::modifiers::{ModifierTable, RawHandle, RawWord};
use super::numbering::Numberer;
use super::reader::{Context, Here, Reader};
use crate::placement::Placement;
use glam::DVec3;
use radsight_diag::{Diagnostic, SourceId, Span};
use radsight_formats::{Octree, OctreeContent, PackedObjects};
use radsight_ir::{BsdfData, Cube, DataGrid, Font, Handle, OctreeScene, PictureData, Scene};
use radsight_loader::{FileKind, Loader};
use std::collections::HashMap;
use std::mem::take;
use std::sync::Arc;

/// Largest depth of nested instances.
const MAX_DEPTH: usize = 64;

/// The octrees used by the scene and by its instances.
#[derive(Default)]
pub(super) struct Octrees {
    /// Octrees of the scene being read, by file name; `None` for those that could not be read.
    by_file: HashMap<String, Option<Handle<OctreeScene>>>,
    /// Octrees of all scenes, by file name.
    read: HashMap<String, Option<(Cube, Arc<Scene>)>>,
    /// The octrees being read, outermost first.
    active: Vec<String>,
}

/// The state of one scene, put aside while one of its instances is read.
#[derive(Default)]
struct Aside {
    scene: Scene,
    modifiers: ModifierTable,
    surface_modifiers: Vec<Option<RawHandle>>,
    grids: HashMap<String, Option<Handle<DataGrid>>>,
    pictures: HashMap<String, Option<Handle<PictureData>>>,
    fonts: HashMap<String, Option<Handle<Font>>>,
    bsdfs: HashMap<String, Option<Handle<BsdfData>>>,
    meshes: Meshes,
    octrees: HashMap<String, Option<Handle<OctreeScene>>>,
    numberer: Numberer,
}

impl Reader<'_> {
    /// Whether the scene being read is the outermost one.
    pub(super) fn is_outermost(&self) -> bool {
        self.octrees.active.is_empty()
    }

    /// Reads an octree as the scene or a part of it.
    pub(super) fn read_octree(&mut self, path: &str, bytes: &[u8]) {
        match Octree::read_packed(bytes) {
            Ok(octree) => {
                self.history.push_body(&octree.header.history());
                self.read_content(path, &octree, None);
            }
            Err(error) => self.log.push(Diagnostic::error(format!("\"{path}\": {error}"))),
        }
    }

    /// The octree of an instance, loaded at its first use. `None` after a mistake, which was
    /// reported.
    pub(super) fn octree(&mut self, file: &RawWord) -> Option<Handle<OctreeScene>> {
        if let Some(known) = self.octrees.by_file.get(&file.text) {
            return *known;
        }
        let octree = match self.octrees.read.get(&file.text) {
            Some(known) => known.clone(),
            None => {
                let read = self.placed_scene(file);
                self.octrees.read.insert(file.text.clone(), read.clone());
                read
            }
        };
        let handle =
            octree.map(|(cube, scene)| self.scene.octrees.add(OctreeScene { file: file.text.clone(), cube, scene }));
        self.octrees.by_file.insert(file.text.clone(), handle);
        handle
    }

    fn placed_scene(&mut self, file: &RawWord) -> Option<(Cube, Arc<Scene>)> {
        if self.octrees.active.contains(&file.text) {
            self.log.push(
                Diagnostic::error(format!("octree \"{}\" contains itself as an instance", file.text)).at(file.span),
            );
            return None;
        }
        if self.octrees.active.len() >= MAX_DEPTH {
            let message = format!("instances of octrees are nested more than {MAX_DEPTH} deep");
            self.stop(Diagnostic::error(message).at(file.span));
            return None;
        }
        let wrong = |message: String| Diagnostic::error(message).at(file.span);
        let loaded = match self.loader.load(&file.text, FileKind::Octree) {
            Ok(loaded) => loaded,
            Err(error) => {
                self.log.push(wrong(error.to_string()));
                return None;
            }
        };
        if !self.count_bytes(loaded.bytes.len(), Some(file.span)) {
            return None;
        }
        match Octree::read_packed(&loaded.bytes) {
            Ok(octree) => {
                let cube = Cube { origin: DVec3::from_array(octree.origin), size: octree.size };
                self.octrees.active.push(file.text.clone());
                let scene = self.read_aside(|reader| reader.read_content(&loaded.path, &octree, Some(file.span)));
                self.octrees.active.pop();
                Some((cube, Arc::new(scene)))
            }
            Err(error) => {
                self.log.push(wrong(format!("\"{}\": {error}", loaded.path)));
                None
            }
        }
    }

    /// Reads another scene with fresh state, then restores the state of the current one.
    fn read_aside(&mut self, read: impl FnOnce(&mut Self)) -> Scene {
        let mut outer = Aside::default();
        self.exchange(&mut outer);
        read(self);
        self.lower_modifiers();
        let scene = take(&mut self.scene);
        self.exchange(&mut outer);
        scene
    }

    fn exchange(&mut self, aside: &mut Aside) {
        std::mem::swap(&mut self.scene, &mut aside.scene);
        std::mem::swap(&mut self.modifiers, &mut aside.modifiers);
        std::mem::swap(&mut self.surface_modifiers, &mut aside.surface_modifiers);
        std::mem::swap(&mut self.grids, &mut aside.grids);
        std::mem::swap(&mut self.pictures, &mut aside.pictures);
        std::mem::swap(&mut self.fonts, &mut aside.fonts);
        std::mem::swap(&mut self.bsdfs, &mut aside.bsdfs);
        std::mem::swap(&mut self.meshes, &mut aside.meshes);
        std::mem::swap(&mut self.octrees.by_file, &mut aside.octrees);
        std::mem::swap(&mut self.numberer, &mut aside.numberer);
    }

    fn read_content(&mut self, path: &str, octree: &Octree<'_, PackedObjects<'_>>, placed_at: Option<Span>) {
        match &octree.content {
            OctreeContent::Objects(objects) => {
                self.read_objects(format!("<objects of {path}>"), objects, placed_at, |_, _| {});
            }
            OctreeContent::Files(files) => {
                let context = Context::new(Placement::default(), String::new());
                let text = files.join(&b'\n');
                let source = self.sources.add(format!("<files of {path}>"), text, placed_at);
                self.read_files(files, source, &context);
            }
        }
    }

    fn read_files(&mut self, files: &[&[u8]], source: SourceId, context: &Context) {
        let mut start = 0;
        for file in files {
            let end = start + file.len() as u32;
            let here = Here { source, context };
            if file.starts_with(b"!") {
                self.command(start..end, here);
            } else {
                self.include_file(&String::from_utf8_lossy(file), context, here.span(start..end));
            }
            if self.is_stopped {
                return;
            }
            start = end + 1;
        }
    }
}
