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

/// Runs a script of Bash in which `$R` is the program.
#[cfg(unix)]
fn bash(folder: &program::Folder, script: &str) -> program::Run {
    let mut bash = std::process::Command::new("bash");
    bash.args(["-c", script]).env("R", env!("CARGO_BIN_EXE_radsight")).env_remove("RAYPATH");
    program::run_with(bash.current_dir(folder.path("")), b"")
}
