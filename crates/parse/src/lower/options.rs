//! Inputs, options and result of reading a scene.

use super::{BrdfReplacement, Numbering};
use radsight_diag::{Diagnostic, Severity, SourceMap};
use radsight_ir::Scene;
use radsight_picture::Header;
use std::sync::Arc;

/// One input of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Input {
    /// A file by name, or the output of a command after `!`.
    File(String),
    /// A text given directly.
    Text {
        /// The name used in messages.
        name: String,
        /// The text; shared, so that a large one is not copied.
        text: Arc<[u8]>,
    },
}

/// How a scene is read.
#[derive(Clone, Debug)]
pub struct ReadOptions {
    /// The purpose of reading. Default: rendering.
    pub purpose: Purpose,
    /// How modifiers without a surface are treated. Default: they are skipped.
    pub unused: UnusedModifiers,
    /// How mistakes that real Radiance tolerates are treated. Default: as warnings.
    pub tolerance: Tolerance,
    /// Materials replaced by models from shared libraries, as in `--brdf`. Default: none.
    pub brdf: Vec<BrdfReplacement>,
    /// Texts of definitions that all functions of the scene may use, with their names for messages
    /// (Radiance's `-f` and `-e`). Default: none.
    pub definitions: Vec<(String, Arc<[u8]>)>,
    /// Texts longer than this are dropped after reading unless a message refers to them. Later
    /// messages about them give line and column but do not show the line. Bytes; default: 16 MiB.
    pub longest_kept_text: usize,
    /// Whether to keep the primitives as lists of words and numbers beside the scene. Default: no.
    pub primitives: KeepPrimitives,
    /// Largest number of surfaces; more is an error instead of exhausted memory. Default: 50
    /// million.
    pub most_surfaces: usize,
}

impl Default for ReadOptions {
    fn default() -> Self {
        ReadOptions {
            purpose: Purpose::Render,
            unused: UnusedModifiers::Skip,
            tolerance: Tolerance::AsRadiance,
            brdf: Vec::new(),
            definitions: Vec::new(),
            longest_kept_text: 16 << 20,
            primitives: KeepPrimitives::No,
            most_surfaces: 50_000_000,
        }
    }
}

/// The purpose of reading a scene: which parts are required and which are ignored, as in Radiance's
/// programs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Purpose {
    /// Rendering: everything that surfaces use is read. A scene of empty files is an error, since
    /// the program that should have written them failed.
    #[default]
    Render,
    /// An octree: names must be defined, but the files of modifiers are not read, and all inputs
    /// may be empty.
    Octree,
    /// Bounding boxes: modifiers need not be defined.
    Bounds,
}

/// Whether to keep the primitives in the form of a frozen octree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum KeepPrimitives {
    /// Do not keep them.
    #[default]
    No,
    /// Keep them in [`Numbering::primitives`].
    Yes,
}

/// How modifiers without a surface are treated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UnusedModifiers {
    /// They are left out of the scene, their files are not loaded, and mistakes in them are
    /// warnings.
    #[default]
    Skip,
    /// Unused modifiers are treated as if a surface used them.
    Lower,
}

/// How mistakes that real Radiance tolerates are treated: failed commands, and modifiers with wrong
/// arguments, functions or files that no ray meets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tolerance {
    /// As warnings; the modifier becomes [`radsight_ir::Material::Unusable`].
    #[default]
    AsRadiance,
    /// As errors.
    Strict,
}

/// The result of reading.
#[derive(Debug)]
pub struct Read {
    /// The scene; incomplete after errors.
    pub scene: Scene,
    /// All texts that were read.
    pub sources: SourceMap,
    /// The numbers of the primitives.
    pub numbering: Numbering,
    /// The headers of the octrees among the inputs: the commands that made them, for the header of
    /// the output.
    pub history: Header,
    /// Errors, warnings and notes, in the order in which they were found.
    pub diagnostics: Vec<Diagnostic>,
    /// Number of further diagnostics that were left out.
    pub omitted: usize,
}

impl Read {
    /// Whether there is any error.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(|diagnostic| diagnostic.severity == Severity::Error)
    }

    /// The diagnostics as text: errors first, at most `most` of them, then the number of the
    /// others.
    #[must_use]
    pub fn render(&self, most: usize) -> String {
        let mut ordered: Vec<&Diagnostic> = self.diagnostics.iter().collect();
        ordered.sort_by_key(|diagnostic| std::cmp::Reverse(diagnostic.severity));
        let mut text: String = ordered.iter().take(most).map(|diagnostic| diagnostic.render(&self.sources)).collect();
        let more = ordered.len().saturating_sub(most) + self.omitted;
        if more > 0 {
            text.push_str(&format!("and {more} more\n"));
        }
        text
    }
}
