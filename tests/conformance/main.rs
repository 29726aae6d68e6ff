//! Conformance with real Radiance: the same scenes and options, and pictures that agree.
//!
//! - `cases`: small scenes of this repository, one a primitive type, argument variant or option,
//!   against references that real Radiance made once (`cargo test --release --test conformance
//!   make_references -- --ignored` makes the missing ones).
//! - `renders`, `scripts`: Radiance's own render tests, and scenes of others with their scripts, in
//!   the folder that `RADSIGHT_SHARED` names; they take minutes, so they run only when asked for
//!   (`-- --ignored --nocapture`).
//! - `truth`: who is nearer to what many rays find, in the blocks of the render tests that do not
//!   agree and in whole pictures, and what both programs find where neither shares irradiance
//!   (`docs/render-tests.md`).
//!
//! Each writes expected | difference | actual beside the build's other results. References are
//! never our own pictures.

#[path = "../program/mod.rs"]
mod program;

mod blocks;
mod cases;
mod commands;
mod exceptions;
mod renders;
mod scripts;
mod side_by_side;
mod truth;

use std::path::{Path, PathBuf};

/// The folder with scenes of others and what real Radiance made of them.
fn shared() -> Option<PathBuf> {
    let shared = std::env::var_os("RADSIGHT_SHARED").map(|folder| PathBuf::from(folder).join("radiance"));
    let shared = shared.filter(|folder| folder.is_dir());
    if shared.is_none() {
        println!("skipped: RADSIGHT_SHARED names no folder with scenes");
    }
    shared
}

/// Where pictures for people go.
fn pictures_folder() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("conformance")
}
