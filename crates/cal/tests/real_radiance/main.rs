//! Differential tests against real Radiance, which are skipped if it is not found:
//! `RADSIGHT_RADIANCE` names a folder with `bin` and `lib`, otherwise `PATH` and `RAYPATH` are
//! searched.

mod equivalents;
mod expressions;
mod library;
mod oracle;
mod rays;
#[path = "../../src/differential/writer.rs"]
#[allow(dead_code)]
mod writer;

/// Whether two values agree to 1e-6 relative.
fn close(a: f64, b: f64) -> bool {
    a == b || (a - b).abs() <= 1e-6 * a.abs().max(b.abs()).max(1e-9)
}
