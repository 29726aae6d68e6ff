//! Evaluation errors of the scene's functions.

use crate::plan::RenderPlan;
use radsight_cal::Program;
use radsight_cal::limits::{MOST_LONG_EVALUATIONS, MOST_STEPS};
use radsight_diag::Diagnostic;
use radsight_ir::{Modifier, ModifierHandle, Scene};
use std::collections::BTreeSet;
use std::sync::Arc;

impl RenderPlan {
    /// Whether a function of the scene has failed so far.
    #[must_use]
    pub fn has_function_faults(&self) -> bool {
        self.called_functions().any(|called| called.program.faults().is_some())
    }

    /// Error of functions that took too many steps too often; the picture is then invalid.
    pub(crate) fn exhausted_function(&self) -> Option<Diagnostic> {
        let called = self.called_functions().find(|called| called.program.is_exhausted())?;
        let message = format!(
            "{MOST_LONG_EVALUATIONS} evaluations of the functions of \"{}\" take more than {MOST_STEPS} steps each",
            called.modifier_name()
        );
        Some(called.at(Diagnostic::error(message)))
    }

    /// A warning for each modifier whose functions have failed so far: the number of failures, and
    /// the kind and the point of one of the first.
    #[must_use]
    pub fn function_faults(&self) -> Vec<Diagnostic> {
        // Modifiers of the same file share a program.
        let mut reported = BTreeSet::new();
        let warning = |called: CalledFunctions<'_>| {
            let faults = called.program.faults().filter(|_| reported.insert(Arc::as_ptr(called.program)))?;
            let [x, y, z] = faults.point;
            let evaluations =
                if faults.count == 1 { "1 evaluation".to_owned() } else { format!("{} evaluations", faults.count) };
            let message = format!(
                "functions of \"{}\" failed in {evaluations}, such as at ({x:.6} {y:.6} {z:.6}): {}",
                called.modifier_name(),
                faults.kind
            );
            Some(called.at(Diagnostic::warning(message)))
        };
        self.called_functions().filter_map(warning).collect()
    }

    /// The functions that modifiers call, of the scene and of its instances.
    fn called_functions(&self) -> impl Iterator<Item = CalledFunctions<'_>> {
        self.scenes().into_iter().flat_map(|scene| {
            scene.modifiers.iter().filter_map(move |(handle, modifier)| {
                let program = &modifier.kind.function_call()?.program;
                Some(CalledFunctions { scene, handle, modifier, program })
            })
        })
    }

    /// The scene, and the scenes of its instances.
    fn scenes(&self) -> Vec<&Scene> {
        let mut seen = BTreeSet::new();
        let placed = self.shaders.iter().filter_map(|shader| shader.textures.home.0.as_ref());
        let placed = placed.filter(|scene| seen.insert(Arc::as_ptr(scene))).map(|scene| &**scene);
        std::iter::once(&*self.scene).chain(placed).collect()
    }
}

/// The functions of a modifier.
struct CalledFunctions<'p> {
    scene: &'p Scene,
    handle: ModifierHandle,
    modifier: &'p Modifier,
    program: &'p Arc<Program>,
}

impl CalledFunctions<'_> {
    fn modifier_name(&self) -> &str {
        self.scene.modifier_name(Some(self.handle))
    }

    /// A message that points to the modifier.
    fn at(&self, message: Diagnostic) -> Diagnostic {
        self.modifier.span.into_iter().fold(message, Diagnostic::at)
    }
}
