//! The crates with unsafe code, tested under AddressSanitizer.

use crate::workspace;
use std::process::Command;

/// The crates that may hold unsafe code.
const UNSAFE_CRATES: [&str; 3] = ["radsight-brdf-abi", "radsight-brdf-sdk", "radsight-brdf-host"];

/// Plugins are loaded into the test's process, so they find the sanitizer's runtime there.
const FLAGS: &str = "-Zsanitizer=address -C link-arg=-rdynamic";

/// The first judges by what the sanitizer replaces: the allocator's count of bytes. The second builds a project with the same flags, whose
/// procedural macros the compiler cannot load then.
const LEFT_OUT: [&str; 2] =
    ["each_broken_plugin_is_caught_with_the_right_message", "a_new_project_in_rust_builds_and_passes_its_own_test"];

/// The sanitizer leaves the signal of a crash to the guard that the tests are about.
const RUNTIME_OPTIONS: &str = "handle_segv=0:handle_abort=0:handle_sigfpe=0:handle_sigill=0:handle_sigbus=0";

/// Builds into a folder of its own, since flags differ; without the examples of the documentation, which get no flags. A stable compiler takes the flag with `RUSTC_BOOTSTRAP`.
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
