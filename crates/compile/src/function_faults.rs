//! Evaluation errors of the scene's functions.

use crate::plan::RenderPlan;
use radsight_cal::limits::{MOST_LONG_EVALUATIONS, MOST_STEPS};
use radsight_diag::Diagnostic;
use radsight_ir::{Modifier, Scene};
use std::collections::BTreeSet;
use std::sync::Arc;

impl RenderPlan {
    /// Whether a function of the scene has failed so far.
    #[must_use]
    pub fn has_function_faults(&self) -> bool {
        self.scenes().into_iter().any(|scene| {
            scene.modifiers.items().iter().any(|modifier| program_of(modifier).is_some_and(|p| p.faults().is_some()))
        })
    }

    /// Error of functions that took too many steps too often; the picture is then invalid.
    #[must_use]
    pub(crate) fn exhausted_function(&self) -> Option<Diagnostic> {
        self.scenes().into_iter().find_map(|scene| {
            let (handle, modifier) = scene
                .modifiers
                .iter()
                .find(|(_, modifier)| program_of(modifier).is_some_and(|program| program.is_exhausted()))?;
            let name = scene.modifier_name(Some(handle));
            let message = format!(
                "{MOST_LONG_EVALUATIONS} evaluations of the functions of \"{name}\" take more than {MOST_STEPS} steps each"
            );
            Some(modifier.span.into_iter().fold(Diagnostic::error(message), Diagnostic::at))
        })
    }

    /// A warning for each modifier whose functions have failed so far: the number of failures, and
    /// the kind and the point of one of the first.
    #[must_use]
    pub fn function_faults(&self) -> Vec<Diagnostic> {
        // Modifiers of the same file share a program.
        let mut reported = BTreeSet::new();
        let scenes = self.scenes().into_iter();
        let all = scenes.flat_map(|scene| scene.modifiers.iter().map(move |(handle, item)| (scene, handle, item)));
        all.filter_map(|(scene, handle, modifier)| {
            let program = program_of(modifier)?;
            let faults = program.faults().filter(|_| reported.insert(Arc::as_ptr(program)))?;
            let [x, y, z] = faults.point;
            let evaluations =
                if faults.count == 1 { "1 evaluation".to_owned() } else { format!("{} evaluations", faults.count) };
            let message = format!(
                "functions of \"{}\" failed in {evaluations}, such as at ({x:.6} {y:.6} {z:.6}): {}",
                scene.modifier_name(Some(handle)),
                faults.kind
            );
            Some(modifier.span.into_iter().fold(Diagnostic::warning(message), Diagnostic::at))
        })
        .collect()
    }

    /// The scene, and the scenes of its instances.
    fn scenes(&self) -> Vec<&Scene> {
        let mut seen = BTreeSet::new();
        let placed = self.shaders.iter().filter_map(|shader| shader.textures.home.0.as_ref());
        let placed = placed.filter(|scene| seen.insert(Arc::as_ptr(scene))).map(|scene| &**scene);
        std::iter::once(&*self.scene).chain(placed).collect()
    }
}

fn program_of(modifier: &Modifier) -> Option<&Arc<radsight_cal::Program>> {
    modifier.kind.function_call().map(|call| &call.program)
}
