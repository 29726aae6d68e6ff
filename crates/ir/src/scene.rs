//! The scene and its arenas.

use crate::{
    Arena, BsdfData, Cone, DataGrid, Font, FunctionCall, GridCall, Handle, Material, Mesh, MeshInstance, Mixture,
    MixtureAmount, NameId, Names, Pattern, PictureCall, PictureData, Rgb, Ring, Source, Sphere, Surface, Texture,
    Transform,
};
use glam::DVec3;
use radsight_diag::Span;
use std::collections::HashMap;
use std::sync::Arc;

/// Handle of a modifier.
pub type ModifierHandle = Handle<Modifier>;
/// Handle of a surface.
pub type SurfaceHandle = Handle<Surface>;

/// A modifier primitive.
#[derive(Clone, Debug)]
pub struct Modifier {
    /// Identifier in the scene text.
    pub name: NameId,
    /// Position in the scene text.
    pub span: Option<Span>,
    /// Modifier of this modifier; it precedes this one in the arena.
    pub modifier: Option<ModifierHandle>,
    /// Kind of modifier.
    pub kind: ModifierKind,
}

impl Modifier {
    /// Radiance of an emitter before patterns, W/(sr·m²); `None` for other modifiers.
    #[must_use]
    pub fn radiance_mut(&mut self) -> Option<&mut Rgb> {
        match &mut self.kind {
            ModifierKind::Material(material) => material.radiance_mut(),
            _ => None,
        }
    }
}

/// Kind of a modifier.
#[derive(Clone, Debug)]
pub enum ModifierKind {
    /// Material: ends a modifier chain.
    Material(Material),
    /// Texture: perturbs the normal.
    Texture(Texture),
    /// Pattern: multiplies the colour.
    Pattern(Pattern),
    /// Mixture of two modifiers.
    Mixture(Mixture),
}

impl ModifierKind {
    /// Function call that is evaluated at intersections, if there is one.
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

/// An axis-aligned cube, scene units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cube {
    /// Corner with the smallest coordinates.
    pub origin: DVec3,
    /// Length of an edge.
    pub size: f64,
}

/// A scene that other scenes place as an instance.
#[derive(Clone, Debug)]
pub struct OctreeScene {
    /// File name, for messages and for output.
    pub file: String,
    /// Bounding cube given by the file; Radiance ignores surfaces outside of it.
    pub cube: Cube,
    /// Content, shared by all scenes that place it.
    pub scene: Arc<Scene>,
}

/// A placed [`OctreeScene`].
#[derive(Clone, Debug)]
pub struct Instance {
    /// The shared scene.
    pub octree: Handle<OctreeScene>,
    /// Transform from its coordinates to the scene's.
    pub to_scene: Transform,
}

/// A scene.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Identifiers.
    pub names: Names,
    /// Modifiers in the order of the text; a modifier's parent precedes it.
    pub modifiers: Arena<Modifier>,
    /// Original name of each alias that has a modifier of its own here.
    pub originals: HashMap<ModifierHandle, NameId>,
    /// Surfaces in the order of the text.
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
    /// The vertices of a polygon, by the numbers of its [`crate::Shape`].
    ///
    /// # Panics
    /// When there are no such vertices, which no polygon of a valid scene has.
    #[inline(always)]
    #[must_use]
    pub fn polygon_vertices(&self, start: u32, count: u32) -> &[DVec3] {
        &self.vertices[start as usize..][..count as usize]
    }

    /// The modifier chain from `first` on.
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

    /// Original name of a modifier, if it is used by an alias; `void` for none.
    #[must_use]
    pub fn original_name(&self, handle: Option<ModifierHandle>) -> &str {
        let original = handle.and_then(|handle| self.originals.get(&handle));
        original.map_or_else(|| self.modifier_name(handle), |name| self.names.get(*name))
    }
}

/// A scene whose numbers, handles and shapes were checked. Read-only.
#[derive(Clone, Debug)]
pub struct ValidScene(pub(crate) Scene);

impl std::ops::Deref for ValidScene {
    type Target = Scene;

    fn deref(&self) -> &Scene {
        &self.0
    }
}
