//! The plugin passes all checks.

use radsight_brdf_host::check;

#[test]
fn the_plugin_passes_its_checks() {
    let library = check::library_beside(&std::env::current_exe().expect("tests have a program"), "prismatic");
    let report = check::run_in_process(&library, Vec::new(), 1);
    assert!(report.passed(), "{}", report.text());
}
