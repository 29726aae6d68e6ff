//! The Rust programs of `CONTRIBUTING.md` and of the book, compiled and run as documentation tests.
//!
//! Guarantees: a program in these pages that does not compile, or whose assertions fail, fails
//! `cargo test -p radsight-recipes`. The crate is not published and has no code of its own, so that
//! the packages of published crates need no file outside of their folder.
#![forbid(unsafe_code)]

/// The recipes of `CONTRIBUTING.md`.
#[cfg(doctest)]
#[doc = include_str!("../../../CONTRIBUTING.md")]
struct Recipes;

/// The first program of the library's page, which is compiled and not run.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/library.md")]
struct LibraryPage;
