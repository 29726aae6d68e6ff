//! Source spans, and diagnostics that show the line and a caret.
//!
//! A [`SourceMap`] keeps every text that was read, and which line of which text included it. A
//! [`Diagnostic`] created at any later time can thus be printed with file, line, column, caret,
//! hint and the chain of inclusion.
//!
//! Guarantees: printing never panics, whatever the span; equal diagnostics print equal text. The
//! crate knows nothing of Radiance and does no input or output.
//!
//! ```
//! use radsight_diag::{Diagnostic, SourceMap};
//! let mut sources = SourceMap::default();
//! let file = sources.add("scene.rad", "void plastic red 0 0 5 1 0 0 0 0\nblue sphere ball 0 0 4 0 0 0 1\n".as_bytes(), None);
//! let span = sources.span(file, 33, 37);
//! let message = Diagnostic::error("undefined modifier \"blue\"").at(span).hint("did you mean \"red\"?");
//! assert_eq!(
//!     message.render(&sources),
//!     "scene.rad:2:1: error: undefined modifier \"blue\"\n  2 | blue sphere ball 0 0 4 0 0 0 1\n    | ^^^^\nhint: did you mean \"red\"?\n"
//! );
//! ```
#![forbid(unsafe_code)]

mod diagnostic;
mod nearest;
mod source;

pub use diagnostic::{Diagnostic, Severity};
pub use nearest::{hint_nearest, nearest};
pub use source::{Position, SourceId, SourceMap, Span};
