//! With how much care hierarchies of boxes are built: what a better one takes must be won back by
//! the rays.

use crate::options::RenderOptions;
use radsight_accel::Builder;
use radsight_ir::Scene;
use std::collections::HashSet;
use std::sync::Arc;

/// Number of rays for each primitive from which a better hierarchy is worth its construction.
const RAYS_WORTH_CARE: f64 = 32.0;

/// Of fewer primitives every builder makes a good hierarchy.
const FEW_PRIMITIVES: usize = 1 << 13;

/// How many rays are expected, and how hierarchies are built for them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HierarchyChoice {
    pub(crate) builder: Builder,
    /// In all hierarchies, each counted once however often it is placed.
    primitives: usize,
    rays: f64,
}

impl HierarchyChoice {
    /// For a scene that is rendered with these options.
    pub(crate) fn new(scene: &Scene, options: &RenderOptions) -> HierarchyChoice {
        let primitives = primitives(scene);
        // A path has a camera ray and as many again for each bounce, each with a ray towards a
        // light.
        let rays = options.camera_rays * 2.0 * (1.0 + f64::from(options.ambient_bounces));
        let pays = primitives >= FEW_PRIMITIVES && rays >= RAYS_WORTH_CARE * primitives as f64;
        HierarchyChoice { builder: if pays { Builder::Thorough } else { Builder::Quick }, primitives, rays }
    }

    /// The decision and its reason, in words.
    pub(crate) fn words(&self) -> (String, String) {
        let HierarchyChoice { builder, primitives, rays } = *self;
        let what = match builder {
            Builder::Quick => "hierarchies are built by binned cuts",
            Builder::Thorough => "hierarchies are built by binned cuts and from clusters, and the cheaper one is kept",
        };
        let why = if primitives < FEW_PRIMITIVES {
            format!("{primitives} primitives are few")
        } else {
            format!("about {rays:.1e} rays are expected for {primitives} primitives")
        };
        (what.to_owned(), why)
    }
}

/// Surfaces and triangles of a scene and of all that it places.
fn primitives(scene: &Scene) -> usize {
    let mut seen = HashSet::new();
    let mut waiting = vec![scene];
    let mut count = 0_usize;
    while let Some(scene) = waiting.pop() {
        let triangles: usize = scene.meshes.items().iter().map(|mesh| mesh.triangles.len()).sum();
        count = count.saturating_add(scene.surfaces.len()).saturating_add(triangles);
        let octrees = scene.octrees.items().iter().map(|octree| &octree.scene);
        waiting.extend(octrees.filter(|inner| seen.insert(Arc::as_ptr(inner))).map(|inner| &**inner));
    }
    count
}
