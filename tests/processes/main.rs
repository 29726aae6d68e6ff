//! The program as a process: signals, pipes and memory limits.
//!
//! These tests send signals and wait for answers, so slow tests do not share their binary.

#[path = "../program/mod.rs"]
mod program;

#[cfg(target_os = "linux")]
mod memory;
#[cfg(unix)]
mod outputs;
#[cfg(unix)]
mod streams;
