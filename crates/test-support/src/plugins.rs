//! Builds the plugins that the tests load.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The library of a plugin package of the workspace, built by cargo.
///
/// # Panics
/// When cargo fails.
#[must_use]
pub fn workspace_plugin(package: &str) -> PathBuf {
    build(&["--package", package])
}

/// An example of the SDK, built by cargo.
///
/// # Panics
/// When cargo fails.
#[must_use]
pub fn sdk_example(name: &str) -> PathBuf {
    build(&["--package", "radsight-brdf-sdk", "--example", name])
}

/// The last dynamic library that cargo builds; dependencies come first.
fn build(arguments: &[&str]) -> PathBuf {
    let output = Command::new(env!("CARGO"))
        .args(["build", "--quiet", "--message-format=json"])
        .args(arguments)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("cargo writes text");
    text.lines()
        .filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok())
        .filter(|message| message["target"]["crate_types"].as_array().is_some_and(|t| t.iter().any(|t| t == "cdylib")))
        .filter_map(|message| message["filenames"].as_array().cloned())
        .flatten()
        .filter_map(|name| name.as_str().map(PathBuf::from))
        .rfind(|path| path.to_string_lossy().ends_with(std::env::consts::DLL_SUFFIX))
        .expect("the package has a dynamic library")
}

/// The crate whose C files are compiled.
fn host_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../brdf-host")
}

/// Compiles a C file of `brdf-host/tests/c` to the library `name` in `folder`; `None` without a C
/// compiler.
///
/// # Panics
/// When the file does not compile.
#[must_use]
pub fn c_plugin(folder: &Path, source: &str, name: &str, options: &[&str]) -> Option<PathBuf> {
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".to_owned());
    let root = host_folder();
    let path = folder.join(format!("{}{name}{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX));
    let output = Command::new(compiler)
        .args(["-std=c11", "-O2", "-Wall", "-Wextra", "-Werror", "-fPIC", "-shared", "-I"])
        .arg(root.join("../brdf-abi/include"))
        .args(options)
        .arg("-o")
        .arg(&path)
        .arg(root.join("tests/c").join(source))
        .arg("-lm")
        .output();
    let Ok(output) = output else {
        eprintln!("skipped: no C compiler found");
        return None;
    };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(path)
}
