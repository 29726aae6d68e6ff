//! New projects build and pass their checks unchanged, outside the workspace.

use radsight_brdf_host::check;
use radsight_brdf_host::template::{Language, new_project, own_sources};
use std::path::Path;
use std::process::Command;

fn write(folder: &Path, name: &str, language: &Language) {
    for file in new_project(name, language).unwrap() {
        let path = folder.join(file.path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, file.text).unwrap();
    }
}

#[test]
fn a_new_project_in_c_builds_from_the_header_alone_and_passes() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "my-paint", &Language::C);
    let Ok(made) = Command::new("make").current_dir(folder.path()).env("CFLAGS", "-O2 -Wall -Wextra -Werror").output()
    else {
        eprintln!("skipped: no make found");
        return;
    };
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let report = check::run_in_process(&folder.path().join("libmy_paint.so"), Vec::new(), 1);
    assert!(report.passed(), "{}", report.text());
}

#[test]
fn a_new_project_in_rust_builds_and_passes_its_own_test() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "my-paint", &Language::Rust { sources: own_sources().unwrap() });
    // The lock file of the workspace has versions that are available offline; dependencies are
    // built once.
    let root = own_sources().unwrap();
    let _ = std::fs::copy(root.join("Cargo.lock"), folder.path().join("Cargo.lock"));
    let tested = Command::new(env!("CARGO"))
        .args(["test", "--quiet"])
        .current_dir(folder.path())
        .env("CARGO_TARGET_DIR", Path::new(env!("CARGO_TARGET_TMPDIR")).join("new-plugin"))
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&tested.stdout).into_owned() + &String::from_utf8_lossy(&tested.stderr);
    assert!(tested.status.success(), "{said}");
    assert!(said.contains("1 passed"), "{said}");
}
