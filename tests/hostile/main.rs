//! What may come from anyone: files with mistakes, files that mean harm, and plugins that fail.

#[path = "../program/mod.rs"]
mod program;
#[path = "../../crates/brdf-host/tests/support/mod.rs"]
mod support;
#[path = "../trap/mod.rs"]
mod trap;

mod bad_input;
mod bad_input_programs;
mod function_faults;
#[cfg(target_os = "linux")]
mod plugin_faults;
mod trust;
mod trust_outputs;
