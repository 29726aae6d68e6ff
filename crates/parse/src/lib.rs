//! Reads Radiance scene text and lowers it to the scene; writes scenes; places text as `xform`
//! does.
//!
//! Four layers, each of which knows only those before it:
//! - [`syntax`]: the grammar. A walk over a text gives its items with their places, and all
//!   mistakes of form.
//! - *placement*: what `xform` does to each type; [`xform`](fn@xform) applies it from text to text.
//! - *lowering*: [`read_scene`] resolves names, runs commands, compiles functions, reads tables and
//!   pictures, and gives a [`radsight_ir::Scene`]. Arrays and nested `xform`s place the primitives
//!   without going through text again.
//! - *writing*: [`write_scene`] gives text that real Radiance reads to the same scene;
//!   [`bounds`](fn@bounds) and [`cube`] are those of `getbbox` and `oconv`.
//!
//! Guarantees: no input makes reading panic, hang or exhaust the memory; every mistake of every
//! file is found, each with its place, what was expected, and how the text came to be read; the
//! same inputs give the same scene.
//!
//! May not know the disk (files and commands come through a [`radsight_loader::Loader`]) nor how
//! rays are traced.
//!
//! ```
//! use radsight_loader::MemoryLoader;
//! use radsight_parse::{Input, ReadOptions, read_scene};
//! let loader = MemoryLoader::default().with("ball.rad", "paint sphere ball 0 0 4 0 0 0 1\n");
//! let text = b"void plastic paint 0 0 5 .5 .5 .5 0 0\n!xform -n row -a 3 -t 2 0 0 ball.rad\n";
//! let read = read_scene(&[Input::Text { name: "scene.rad".to_owned(), text: text[..].into() }], &loader, &ReadOptions::default());
//! assert!(!read.has_errors());
//! let last = read.scene.surfaces.items().last().unwrap();
//! assert_eq!(read.scene.names.get(last.name), "row.2.ball");
//! ```
#![forbid(unsafe_code)]

mod bounds;
mod commands;
mod kind;
mod lower;
mod placement;
mod signature;
pub mod syntax;
mod transform_words;
mod write;
mod xform;

pub use bounds::{Bounds, bounds, cube, surface_bounds};
pub use kind::{Kind, Role};
pub use lower::{
    BrdfReplacement, Input, KeepPrimitives, Numbering, Purpose, Read, ReadOptions, Tolerance, UnusedModifiers,
    read_scene,
};
pub use transform_words::transform;
pub use write::write_scene;
pub use xform::xform;
