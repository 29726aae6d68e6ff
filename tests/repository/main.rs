//! What the repository promises about itself: its crates, their imports, its documentation.

#[path = "../program/mod.rs"]
mod program;
#[path = "../real_radiance/mod.rs"]
mod real_radiance;

mod book;
mod crate_edges;
mod gallery;
mod import_cycles;
