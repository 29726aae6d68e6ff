//! The program as a process: signals, pipes and limits of memory.
//!
//! These tests send signals and wait for answers, so nothing that takes long shares their binary.

#[path = "../program/mod.rs"]
mod program;

#[cfg(target_os = "linux")]
mod memory;
#[cfg(unix)]
mod outputs;
#[cfg(unix)]
mod streams;
