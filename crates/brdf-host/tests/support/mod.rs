//! Builds the plugins that the tests load.
#![allow(dead_code, reason = "each test file uses a part")]

use radsight_brdf_host::Band;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Red, green and blue, in metres.
pub(crate) const RGB: [Band; 3] = [
    Band { centre_m: 650e-9, low_m: 588e-9, high_m: 780e-9 },
    Band { centre_m: 534e-9, low_m: 480e-9, high_m: 588e-9 },
    Band { centre_m: 430e-9, low_m: 380e-9, high_m: 480e-9 },
];

/// The library of a plugin package of the workspace, built by cargo.
pub(crate) fn workspace_plugin(package: &str) -> PathBuf {
    build(&["--package", package])
}

/// An example of the SDK, built by cargo.
pub(crate) fn sdk_example(name: &str) -> PathBuf {
    build(&["--package", "radsight-brdf-sdk", "--example", name])
}

/// The dynamic library that cargo makes last: dependencies come before what was asked for.
fn build(arguments: &[&str]) -> PathBuf {
    let output = Command::new(env!("CARGO"))
        .args(["build", "--quiet", "--message-format=json"])
        .args(arguments)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines()
        .filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok())
        .filter(|message| message["target"]["crate_types"].as_array().is_some_and(|t| t.iter().any(|t| t == "cdylib")))
        .filter_map(|message| message["filenames"].as_array().cloned())
        .flatten()
        .filter_map(|name| name.as_str().map(PathBuf::from))
        .rfind(|path| path.to_string_lossy().ends_with(std::env::consts::DLL_SUFFIX))
        .expect("the package has a dynamic library")
}

/// The folder of the crate: tests of the workspace's root package use this too.
fn crate_folder() -> PathBuf {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let inside = package.join("crates/brdf-host");
    if inside.is_dir() { inside } else { package.to_owned() }
}

/// Compiles a C file of `tests/c` to the library `name` in `folder`; `None` without a C compiler.
pub(crate) fn c_plugin(folder: &Path, source: &str, name: &str, options: &[&str]) -> Option<PathBuf> {
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".to_owned());
    let root = crate_folder();
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
