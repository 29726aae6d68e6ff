//! Checks materials without rendering them.

use crate::compile::compile_shaders;
use crate::model_source::{ModelRequest, ModelSource};
use crate::native_model::native_or;
use crate::options::RenderOptions;
use radsight_diag::Diagnostic;
use radsight_ir::{Scene, ValidScene};
use radsight_texture::BandLayout;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Bands of a scene that may have colours.
const COLORS: usize = 3;

/// Compiles the materials of a scene as a [`RenderPlan`](crate::RenderPlan) does, and makes the
/// models that no surface uses. Returns the mistakes, each once.
#[must_use]
pub fn check_materials(scene: &ValidScene, models: &dyn ModelSource) -> Vec<Diagnostic> {
    let options = RenderOptions::default();
    let layout = Arc::new(BandLayout::new(options.sampling));
    let mut found = compile_shaders(scene, models, &[], &layout, options.skipping).err().unwrap_or_default();
    check_models(scene, models, &mut found, &mut BTreeSet::new());
    found
}

/// Makes each model that a scene or its octrees name.
fn check_models(
    scene: &Scene,
    models: &dyn ModelSource,
    found: &mut Vec<Diagnostic>,
    octrees: &mut BTreeSet<*const Scene>,
) {
    for modifier in scene.modifiers.items() {
        let request = ModelRequest::of(scene, modifier, COLORS);
        let error = request.and_then(|request| native_or(models, &request).err());
        found.extend(error.filter(|error| !found.contains(error)));
    }
    for octree in scene.octrees.items() {
        if octrees.insert(Arc::as_ptr(&octree.scene)) {
            check_models(&octree.scene, models, found, octrees);
        }
    }
}
