//! The numbers by which this crate and its users name things.

use radsight_ir::ModifierHandle;
use std::sync::Arc;

/// Names a surface of one scene that has a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MemberId(pub u32);

impl MemberId {
    /// The primitive that a surface is which holds no others.
    #[inline]
    #[must_use]
    pub fn primitive(self) -> PrimitiveId {
        PrimitiveId(u64::from(self.0))
    }
}

/// Names what a ray can hit: a surface of the scene, a triangle of a mesh, a surface of a scene that is placed in it. Each copy
/// has a name of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PrimitiveId(pub u64);

impl PrimitiveId {
    /// Names nothing.
    pub const NONE: PrimitiveId = PrimitiveId(u64::MAX);

    /// The member that has this primitive's name, for one that no other holds.
    #[inline]
    #[must_use]
    pub fn member(self) -> MemberId {
        MemberId(self.0 as u32)
    }
}

/// Names what shades a surface. What it is, only the caller knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ShaderId(pub u32);

/// The shader of each modifier that surfaces of a scene name, and those of the scenes that it places.
#[derive(Debug)]
pub struct ShaderTable {
    of_modifier: Vec<ShaderId>,
    octrees: Vec<Arc<ShaderTable>>,
}

impl ShaderTable {
    /// `of_modifier` holds the shader of a surface without a modifier first, then one for each modifier handle; `octrees` the
    /// tables of the octrees, by their handles.
    #[must_use]
    pub fn new(of_modifier: Vec<ShaderId>, octrees: Vec<Arc<ShaderTable>>) -> ShaderTable {
        ShaderTable { of_modifier, octrees }
    }

    /// The shader of a modifier that a surface or a triangle of the scene has.
    ///
    /// # Panics
    /// If the table is that of another scene.
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
