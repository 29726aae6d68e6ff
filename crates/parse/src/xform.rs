//! The `xform` program: its arguments, and text in, text out.
//!
//! [`xform`] writes the same text as Radiance's `xform`, up to rounding. A scene that calls `xform`
//! does not go through text: the reader gets the copies from `visit_copies` and places the
//! primitives itself.

mod arguments;
mod text;

pub(crate) use arguments::{Copy, Event, MAX_COPIES, visit_copies};
pub(crate) use text::run as run_xform;
pub use text::xform;

/// Whether a command's first word means `xform`; a leading directory is ignored.
pub(crate) fn is_xform(program: &str) -> bool {
    program.rsplit('/').next() == Some("xform")
}
