//! Scenes at the ends of what numbers can say, each against a closed form, brute force in higher precision, or itself moved and scaled.
//!
//! Every case prints its row of the table in `docs/stress.md`:
//! `cargo test --release --test stress -- --nocapture --test-threads 1 | grep '^|'`.

#[path = "../program/mod.rs"]
mod program;

mod double_double;
mod geometry;
mod light;
mod materials;
mod pictures;
mod rays;
mod shapes;
mod table;
mod watertight;
