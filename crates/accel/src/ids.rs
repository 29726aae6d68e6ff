//! Identifiers of members, primitives and shaders.

use radsight_ir::ModifierHandle;
use std::sync::Arc;

/// A local surface of one scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MemberId(pub u32);

impl MemberId {
    /// The primitive of a surface that contains no others.
    #[inline]
    #[must_use]
    pub fn primitive(self) -> PrimitiveId {
        PrimitiveId(u64::from(self.0))
    }
}

/// Anything that a ray can hit: a surface of the scene, a triangle of a mesh, a surface of an
/// instanced scene. Each copy has its own identifier.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PrimitiveId(pub u64);

impl PrimitiveId {
    /// No primitive.
    pub const NONE: PrimitiveId = PrimitiveId(u64::MAX);

    /// The member of a primitive that belongs to no other.
    #[inline]
    #[must_use]
    pub fn member(self) -> MemberId {
        MemberId(self.0 as u32)
    }
}

/// The shader of a surface. Its meaning belongs to the caller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ShaderId(pub u32);

/// The shader of each modifier of the surfaces of a scene, and those of its instanced scenes.
#[derive(Debug)]
pub struct ShaderTable {
    of_modifier: Vec<ShaderId>,
    octrees: Vec<Arc<ShaderTable>>,
}

impl ShaderTable {
    /// `of_modifier` holds the shader of a surface without a modifier first, then one for each
    /// modifier handle; `octrees` the tables of the octrees, by their handles.
    #[must_use]
    pub fn new(of_modifier: Vec<ShaderId>, octrees: Vec<Arc<ShaderTable>>) -> ShaderTable {
        ShaderTable { of_modifier, octrees }
    }

    /// The shader of a modifier of a surface or triangle of the scene.
    ///
    /// # Panics
    /// If the table belongs to another scene.
    #[inline]
    #[must_use]
    pub fn of(&self, modifier: Option<ModifierHandle>) -> ShaderId {
        self.of_modifier[modifier.map_or(0, |handle| handle.index() + 1)]
    }

    /// The tables of the octrees, by their handles.
    #[must_use]
    pub fn octrees(&self) -> &[Arc<ShaderTable>] {
        &self.octrees
    }
}
