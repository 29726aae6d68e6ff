//! The `xform` program: its arguments, and text in, text out.
//!
//! [`xform`] gives the text that Radiance's `xform` gives, to rounding. A scene that calls `xform` does not go through text:
//! the reader takes the copies that `visit_copies` makes of the arguments and places the primitives themselves.

mod arguments;
mod text;

pub(crate) use arguments::{Copy, Event, MAX_COPIES, visit_copies};
pub(crate) use text::run as run_xform;
pub use text::xform;

/// Whether a command's first word means `xform`; a leading directory is ignored.
pub(crate) fn is_xform(program: &str) -> bool {
    program.rsplit('/').next() == Some("xform")
}
