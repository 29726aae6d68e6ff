//! The crates with unsafe code, tested under AddressSanitizer.

use crate::workspace;
use std::process::Command;

/// The crates that may contain unsafe code.
const UNSAFE_CRATES: [&str; 3] = ["radsight-brdf-abi", "radsight-brdf-sdk", "radsight-brdf-host"];

/// Plugins are loaded into the test's process and use its sanitizer runtime.
const FLAGS: &str = "-Zsanitizer=address -C link-arg=-rdynamic";

/// The first test measures the allocator's number of bytes, but the sanitizer replaces the
/// allocator. The second builds a project with the same flags, so the compiler cannot load its
/// procedural macros.
const LEFT_OUT: [&str; 2] =
    ["each_broken_plugin_is_caught_with_the_right_message", "a_new_project_in_rust_builds_and_passes_its_own_test"];

/// Crash signals are handled by the guard under test instead of the sanitizer.
const RUNTIME_OPTIONS: &str = "handle_segv=0:handle_abort=0:handle_sigfpe=0:handle_sigill=0:handle_sigbus=0";

/// Tests the crates in a separate target folder, because the flags differ. Documentation examples
/// are left out because they are compiled without the flags. A stable compiler accepts the flag
/// with `RUSTC_BOOTSTRAP`.
pub(crate) fn check() -> Result<(), String> {
    let triple = workspace::host_triple()?;
    let mut cargo = Command::new("cargo");
    cargo.args(["test", "--lib", "--tests", "--examples", "--target-dir", "target/sanitize", "--target", &triple]);
    for name in UNSAFE_CRATES {
        cargo.args(["--package", name]);
    }
    cargo.arg("--");
    for name in LEFT_OUT {
        cargo.args(["--skip", name]);
    }
    cargo.env("RUSTC_BOOTSTRAP", "1").env("RUSTFLAGS", FLAGS).env("ASAN_OPTIONS", RUNTIME_OPTIONS);
    workspace::finish(&mut cargo)
}
