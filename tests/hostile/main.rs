//! Untrusted input: files with mistakes, malicious files, and failing plugins.

#[path = "../program/mod.rs"]
mod program;
#[path = "../trap/mod.rs"]
mod trap;

mod bad_input;
mod bad_input_programs;
mod function_faults;
mod hostile_files;
#[cfg(target_os = "linux")]
mod plugin_faults;
mod trust;
mod trust_outputs;
