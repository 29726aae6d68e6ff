//! Properties of the repository: its crates, their imports, its documentation.

#[path = "../../xtask/src/function_lengths.rs"]
mod function_lengths;
#[path = "../program/mod.rs"]
mod program;

mod book;
mod crate_edges;
mod dependencies;
mod gallery;
mod import_cycles;
mod library_examples;
mod option_words;
mod packages;
mod signatures;
mod sources;
mod top_level;
mod words;
