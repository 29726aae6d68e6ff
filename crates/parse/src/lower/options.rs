//! What is read, how, and what comes of it.

use super::{BrdfReplacement, Numbering};
use radsight_diag::{Diagnostic, Severity, SourceMap};
use radsight_ir::Scene;
use radsight_picture::Header;
use std::sync::Arc;

/// One of the texts that make up a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Input {
    /// A file by its name; with `!` in front, the output of a command.
    File(String),
    /// A text given directly.
    Text {
        /// For messages.
        name: String,
        /// The text; shared, so that a large one is not copied.
        text: Arc<[u8]>,
    },
}

/// How a scene is read.
#[derive(Clone, Debug)]
pub struct ReadOptions {
    /// What the scene is read for. Default: to be rendered.
    pub purpose: Purpose,
    /// What becomes of modifiers that no surface uses. Default: they are skipped.
    pub unused: UnusedModifiers,
    /// What becomes of mistakes that real Radiance reads past. Default: they are warnings.
    pub tolerance: Tolerance,
    /// Materials to be replaced by models from shared libraries, as `--brdf` gives them. Default: none.
    pub brdf: Vec<BrdfReplacement>,
    /// Texts of definitions that all functions of the scene may use, by their names for messages (Radiance's `-f` and `-e`). Default: none.
    pub definitions: Vec<(String, Arc<[u8]>)>,
    /// Texts with more bytes are forgotten once they were read, unless a message is about them; later messages about them
    /// then have line and column, but do not show the line. Default: 16 MiB.
    pub longest_kept_text: usize,
    /// Whether the primitives are kept as lists of words and numbers beside the scene. Default: no.
    pub primitives: KeepPrimitives,
    /// The most surfaces that a scene may have; more is an error instead of an exhausted machine. Default: 50 million.
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

/// What a scene is read for: what it must have, and what of it is left alone, as Radiance's programs do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Purpose {
    /// To be rendered: everything that surfaces use is read, and a scene of empty files is an error, since the
    /// program that should have written them failed.
    #[default]
    Render,
    /// For an octree: names must be defined, but the files of modifiers are left alone, and all may be empty.
    Octree,
    /// For the places of surfaces: modifiers need not be defined either.
    Places,
}

/// Whether the primitives of a scene are kept as they will stand in a frozen octree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum KeepPrimitives {
    /// They are not.
    #[default]
    No,
    /// They are, in [`Numbering::primitives`].
    Yes,
}

/// What becomes of modifiers that no surface uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UnusedModifiers {
    /// They are not in the scene, their files are not loaded, and what is wrong with them is a warning.
    #[default]
    Skip,
    /// They are treated as if they were used.
    Lower,
}

/// What becomes of mistakes that real Radiance reads past: a command that fails, and a modifier whose arguments, functions
/// or files are wrong, as long as no ray meets it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tolerance {
    /// They are warnings; the modifier becomes [`radsight_ir::Material::Unusable`].
    #[default]
    AsRadiance,
    /// They are errors.
    Strict,
}

/// What came of reading.
#[derive(Debug)]
pub struct Read {
    /// The scene; incomplete if there are errors.
    pub scene: Scene,
    /// All texts that were read.
    pub sources: SourceMap,
    /// The numbers of the primitives.
    pub numbering: Numbering,
    /// The headers of the octrees among the inputs: how they came to be, for the header of what is made of them.
    pub history: Header,
    /// What is wrong or suspect, in the order in which it was found.
    pub diagnostics: Vec<Diagnostic>,
    /// How many further messages were left out.
    pub omitted: usize,
}

impl Read {
    /// Whether anything is wrong.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(|diagnostic| diagnostic.severity == Severity::Error)
    }

    /// The messages as text for people: errors first, at most `most` messages, then how many more there are.
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
