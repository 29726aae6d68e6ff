//! Valid plugins pass; each kind of invalid plugin is reported with the right message.

use radsight_brdf_host::check::{self, ChildCommand, Example, Report, Stage, Verdict};
use radsight_test_support::plugins::{c_plugin, sdk_example, workspace_plugin};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Not a test: entry point of the child processes of the tests below.
#[test]
#[ignore = "run by other tests as a child process"]
fn child() {
    check::child_main().unwrap();
}

fn options(library: &Path) -> check::CheckOptions {
    let child = ChildCommand {
        program: std::env::current_exe().unwrap(),
        arguments: ["child", "--exact", "--ignored", "--nocapture"].map(str::to_owned).to_vec(),
    };
    check::CheckOptions::new(library, child)
}

fn broken(folder: &Path, define: &str) -> Option<PathBuf> {
    c_plugin(folder, "lambert.c", &define.to_lowercase(), &[&format!("-DBROKEN_{define}")])
}

fn failed_stages(report: &Report) -> Vec<Stage> {
    report.outcomes.iter().filter(|o| o.verdict == Verdict::Failed).map(|o| o.check).collect()
}

#[test]
fn the_built_in_models_pass() {
    let report = check::run(&options(&workspace_plugin("radsight-plugin-builtin")));
    assert!(report.passed(), "{}", report.text());
    assert_eq!(report.outcomes.len(), 19, "{}", report.text());
    let json: serde_json::Value = serde_json::from_str(&report.json()).unwrap();
    assert_eq!((json["passed"].as_bool(), json["seed"].as_u64()), (Some(true), Some(1)));
    assert_eq!(json["outcomes"][0]["check"], "load");
}

#[test]
fn an_honest_plugin_in_c_passes() {
    let folder = tempfile::tempdir().unwrap();
    let Some(library) = c_plugin(folder.path(), "lambert.c", "chalk", &[]) else { return };
    let report = check::run(&options(&library));
    assert!(report.passed(), "{}", report.text());
    assert!(report.text().contains("(seed 1)\n  load                   ok"), "{}", report.text());
    assert!(report.text().ends_with("10 passed, 0 failed, 0 skipped\n"), "{}", report.text());
}

#[test]
fn the_plugin_in_c_of_the_plugins_folder_passes() {
    let folder = tempfile::tempdir().unwrap();
    let Some(library) = c_plugin(folder.path(), "../../../../plugins/phong/phong.c", "phong", &[]) else { return };
    let report = check::run(&options(&library));
    assert!(report.passed(), "{}", report.text());
    assert!(report.text().contains("rho_s: rho_d + rho_s is 2, expected at most 1"), "{}", report.text());
}

#[test]
fn each_broken_plugin_is_caught_with_the_right_message() {
    let folder = tempfile::tempdir().unwrap();
    let cases: [(&str, Stage, &str); 15] = [
        ("PDF", Stage::Sampling, "samples do not have the density of eval_pdf"),
        ("WEIGHT", Stage::Sampling, "the weight of a sample is"),
        ("ENERGY", Stage::Energy, "% at outgoing angle"),
        ("RECIPROCITY", Stage::Reciprocity, "with exchanged directions in band"),
        ("GRAZING", Stage::Finite, "value NaN at outgoing angle"),
        ("NEGATIVE", Stage::Finite, "value -1 at outgoing angle"),
        ("INFINITE", Stage::Finite, "value inf at outgoing angle"),
        ("LENGTH", Stage::Finite, "sample returns a direction of length"),
        ("KIND", Stage::Finite, "sample returns the unknown kind 9 at the outgoing angle 0°, expected 0 to 2"),
        ("ANISOTROPY", Stage::Isotropy, "when both directions are rotated about the normal"),
        ("BATCH", Stage::Purity, "in a single call but"),
        ("STATE", Stage::Purity, "numbers differ when 4 threads evaluate the same batches at once"),
        ("UNWRITTEN", Stage::Finite, "value NaN"),
        ("STATUS", Stage::Finite, "value NaN"),
        ("LEAK", Stage::Lifecycle, "bytes are lost by each create and destroy (1000 rounds)"),
    ];
    for (define, stage, message) in cases {
        let Some(library) = broken(folder.path(), define) else { return };
        let report = check::run(&options(&library));
        let failed = failed_stages(&report);
        assert!(failed.contains(&stage), "{define}: {stage:?} should fail\n{}", report.text());
        assert!(
            report.failures().iter().any(|m| m.contains(message)),
            "{define}: no {message:?} in\n{}",
            report.text()
        );
    }
}

#[test]
fn a_crash_names_plugin_model_parameters_and_function() {
    let folder = tempfile::tempdir().unwrap();
    let Some(library) = broken(folder.path(), "SEGFAULT") else { return };
    let report = check::run(&options(&library));
    let failures = report.failures().join("\n");
    assert!(
        failures.contains(
            "crash: the process was ended by signal 11; crash in plugin \"segfault\", model \"lambert\", \
             material \"lambert(0.5, 0.45, 0.4)\" (plugin check), function eval_pdf: SIGSEGV, invalid memory access"
        ),
        "{failures}"
    );
    let aborted = check::run(&options(&broken(folder.path(), "ABORT").unwrap())).failures().join("\n");
    assert!(aborted.contains("signal 6") && aborted.contains("function eval_pdf: SIGABRT, abort"), "{aborted}");
    let careless = check::run(&options(&broken(folder.path(), "ARGUMENTS").unwrap())).failures().join("\n");
    assert!(careless.contains("function create: SIGSEGV"), "{careless}");
}

/// NaN is a finding of one check, not of all.
#[test]
fn a_value_that_is_always_nan_does_not_depend_on_its_batch() {
    let folder = tempfile::tempdir().unwrap();
    let Some(library) = broken(folder.path(), "GRAZING") else { return };
    let report = check::run(&options(&library));
    assert!(!failed_stages(&report).contains(&Stage::Purity), "{}", report.text());
}

#[test]
fn a_hang_is_ended() {
    let folder = tempfile::tempdir().unwrap();
    let Some(library) = broken(folder.path(), "HANG") else { return };
    let mut options = options(&library);
    options.time_limit = Duration::from_secs(2);
    assert_eq!(check::run(&options).failures(), ["hang: no answer within 2 s"]);
}

#[test]
fn what_does_not_load_fails_the_first_check_only() {
    let folder = tempfile::tempdir().unwrap();
    let text = folder.path().join("libnothing.so");
    std::fs::write(&text, "nothing").unwrap();
    let report = check::run(&options(&text));
    assert_eq!(report.outcomes.len(), 1);
    assert!(report.failures()[0].contains("is not a shared library"), "{}", report.text());
    for (define, message) in
        [("MAJOR", "was built for version 7.1"), ("SYMBOL", "exports no"), ("DESCRIBE", "returns NULL")]
    {
        let Some(library) = broken(folder.path(), define) else { return };
        let report = check::run(&options(&library));
        assert!(report.failures()[0].contains(message), "{}", report.text());
    }
}

#[test]
fn a_panic_is_a_finding_and_not_the_end() {
    let library = sdk_example("panics");
    let example = |place: &str| Example { model: "panics".to_owned(), words: vec![place.to_owned()], numbers: vec![] };
    let check = |place: &str| check::run(&check::CheckOptions { examples: vec![example(place)], ..options(&library) });
    let evaluating = check("evaluating");
    assert!(!evaluating.text().contains("crash"), "{}", evaluating.text());
    assert!(
        evaluating.text().contains("the plugin logged: panicked: there is no reflection at "),
        "{}",
        evaluating.text()
    );
    assert!(failed_stages(&evaluating).contains(&Stage::Finite));
    let creating = check("creating");
    assert!(creating.failures()[0].contains("panicked: cannot go on creating at "), "{}", creating.text());
    let dropping = check("dropping");
    assert!(!dropping.text().contains("crash"), "{}", dropping.text());
}

#[test]
fn a_wrong_example_and_an_unknown_model_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let Some(library) = c_plugin(folder.path(), "lambert.c", "chalk", &[]) else { return };
    let wrong = Example { model: "lambert".to_owned(), words: vec![], numbers: vec![0.5, 2.0, 0.5] };
    let report = check::run(&check::CheckOptions { examples: vec![wrong], ..options(&library) });
    assert_eq!(report.failures(), ["lambert(0.5, 2, 0.5): reflectance is 2, expected at least 0 and at most 1"]);
    let report = check::run(&check::CheckOptions { model: Some("velvet".to_owned()), ..options(&library) });
    assert_eq!(report.failures(), ["the library has no model \"velvet\"; it has lambert"]);
}
