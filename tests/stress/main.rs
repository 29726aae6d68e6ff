//! Scenes at the limits of number ranges, compared with a closed form, with brute force in higher
//! precision, or with themselves after translation and scaling.
//!
//! Every case prints its row of the table in `docs/stress.md`: `cargo test --release --test stress
//! -- --nocapture --test-threads 1 | grep '^|'`.

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
