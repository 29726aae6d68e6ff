//! The scene and its arenas.

use crate::{
    Arena, BsdfData, Cone, DataGrid, Font, FunctionCall, GridCall, Handle, Material, Mesh, MeshInstance, Mixture,
    MixtureAmount, NameId, Names, Pattern, PictureCall, PictureData, Ring, Source, Sphere, Surface, Texture, Transform,
};
use glam::DVec3;
use radsight_diag::Span;
use std::collections::HashMap;
use std::sync::Arc;

/// Names a modifier.
pub type ModifierHandle = Handle<Modifier>;
/// Names a surface.
pub type SurfaceHandle = Handle<Surface>;

/// A modifier primitive.
#[derive(Clone, Debug)]
pub struct Modifier {
    /// Its identifier in the scene text.
    pub name: NameId,
    /// Where it stands in the scene text.
    pub span: Option<Span>,
    /// What modifies it in turn; always added to the arena before it.
    pub modifier: Option<ModifierHandle>,
    /// What it does.
    pub kind: ModifierKind,
}

/// What a modifier does.
#[derive(Clone, Debug)]
pub enum ModifierKind {
    /// Ends the chain of a surface.
    Material(Material),
    /// Turns the normal.
    Texture(Texture),
    /// Multiplies the colour.
    Pattern(Pattern),
    /// Chooses between two others.
    Mixture(Mixture),
}

impl ModifierKind {
    /// The call of functions that it evaluates where a ray meets a surface, if it has one.
    #[must_use]
    pub fn function_call(&self) -> Option<&FunctionCall> {
        match self {
            ModifierKind::Texture(Texture::Function(call))
            | ModifierKind::Texture(Texture::Data(GridCall { call, .. }))
            | ModifierKind::Pattern(
                Pattern::BrightFunction(call)
                | Pattern::ColorFunction(call)
                | Pattern::BrightData(GridCall { call, .. })
                | Pattern::ColorData(GridCall { call, .. })
                | Pattern::ColorPicture(PictureCall { call, .. })
                | Pattern::SpectrumFunction { call, .. }
                | Pattern::SpectrumData(GridCall { call, .. })
                | Pattern::SpectrumPicture(GridCall { call, .. }),
            ) => Some(call),
            ModifierKind::Pattern(Pattern::Text(_) | Pattern::Spectrum(_)) => None,
            ModifierKind::Mixture(mixture) => match &mixture.amount {
                MixtureAmount::Function(call)
                | MixtureAmount::Data(GridCall { call, .. })
                | MixtureAmount::Picture(PictureCall { call, .. }) => Some(call),
                MixtureAmount::Text(_) => None,
            },
            ModifierKind::Material(material) => material.function_call(),
        }
    }
}

/// A cube along the axes, scene units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cube {
    /// The corner with the smallest coordinates.
    pub origin: DVec3,
    /// Length of an edge.
    pub size: f64,
}

/// A whole scene that other scenes place.
#[derive(Clone, Debug)]
pub struct OctreeScene {
    /// For messages and for writing back.
    pub file: String,
    /// What the file says that its surfaces lie in; Radiance sees nothing of them outside.
    pub cube: Cube,
    /// Its content; shared by all the scenes that place it.
    pub scene: Arc<Scene>,
}

/// A placed [`OctreeScene`].
#[derive(Clone, Debug)]
pub struct Instance {
    /// The shared scene.
    pub octree: Handle<OctreeScene>,
    /// From its coordinates to the scene's.
    pub to_scene: Transform,
}

/// Everything that a scene file says.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Identifiers.
    pub names: Names,
    /// In the order of the text; a modifier's parent comes before it.
    pub modifiers: Arena<Modifier>,
    /// What each alias stands for is called, where that is a modifier of its own here.
    pub originals: HashMap<ModifierHandle, NameId>,
    /// In the order of the text.
    pub surfaces: Arena<Surface>,
    /// Vertices of all polygons, scene units.
    pub vertices: Vec<DVec3>,
    /// Spheres and bubbles.
    pub spheres: Arena<Sphere>,
    /// Cones, cups, cylinders, tubes.
    pub cones: Arena<Cone>,
    /// Rings.
    pub rings: Arena<Ring>,
    /// Distant sources.
    pub sources: Arena<Source>,
    /// Shared meshes.
    pub meshes: Arena<Mesh>,
    /// Placed meshes.
    pub mesh_instances: Arena<MeshInstance>,
    /// Shared scenes.
    pub octrees: Arena<OctreeScene>,
    /// Placed scenes.
    pub instances: Arena<Instance>,
    /// Tables.
    pub grids: Arena<DataGrid>,
    /// Pictures.
    pub pictures: Arena<PictureData>,
    /// Fonts.
    pub fonts: Arena<Font>,
    /// BSDF files.
    pub bsdfs: Arena<BsdfData>,
}

impl Scene {
    /// The chain of modifiers from `first` on.
    pub fn chain(&self, first: Option<ModifierHandle>) -> impl Iterator<Item = (ModifierHandle, &Modifier)> {
        std::iter::successors(first.map(|handle| (handle, &self.modifiers[handle])), |(_, modifier)| {
            modifier.modifier.map(|handle| (handle, &self.modifiers[handle]))
        })
    }

    /// The name of a surface.
    #[must_use]
    pub fn surface_name(&self, handle: SurfaceHandle) -> &str {
        self.names.get(self.surfaces[handle].name)
    }

    /// The name of a modifier; `void` for none.
    #[must_use]
    pub fn modifier_name(&self, handle: Option<ModifierHandle>) -> &str {
        handle.map_or("void", |handle| self.names.get(self.modifiers[handle].name))
    }

    /// The name under which a modifier was first defined, if an alias was used; `void` for none.
    #[must_use]
    pub fn original_name(&self, handle: Option<ModifierHandle>) -> &str {
        let original = handle.and_then(|handle| self.originals.get(&handle));
        original.map_or_else(|| self.modifier_name(handle), |name| self.names.get(*name))
    }
}

/// A scene whose numbers, handles and forms were all checked. Read-only.
#[derive(Clone, Debug)]
pub struct ValidScene(pub(crate) Scene);

impl std::ops::Deref for ValidScene {
    type Target = Scene;

    fn deref(&self) -> &Scene {
        &self.0
    }
}
