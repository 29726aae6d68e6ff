//! The quick check of every instance before it is used, and the message of a crash while
//! rendering.

use radsight_brdf::Brdf;
use radsight_brdf_host::check::CHECK_BANDS;
use radsight_brdf_host::{Error, Label, Registry, Request, SearchPath, SelfCheck};
use radsight_test_support::plugins::{c_plugin, workspace_plugin};
use std::path::Path;

fn instantiate(
    path: &Path,
    mode: SelfCheck,
    model: &str,
    numbers: &[f64],
) -> Result<radsight_brdf_host::Instantiated, Error> {
    let label = Label { material: "paint".to_owned(), place: "room.rad:7:1".to_owned() };
    let registry = Registry::new(SearchPath::default(), mode);
    let library = registry.library_file(path)?;
    let request = Request { library: "", model, words: &[], numbers, bands: &CHECK_BANDS, label: &label, folder: None };
    registry.instantiate_from(library, &request)
}

#[test]
fn honest_models_give_no_warning() {
    let path = workspace_plugin("radsight-plugin-builtin");
    for roughness in [0.002, 0.02, 0.2, 0.6] {
        let made = instantiate(&path, SelfCheck::Strict, "ward", &[0.9, 0.5, 0.1, roughness]).unwrap();
        assert_eq!((made.warnings.len(), made.brdf.faults().total()), (0, 0));
    }
    assert!(instantiate(&path, SelfCheck::Strict, "lambert", &[1.0, 1.0, 1.0]).is_ok());
}

#[test]
fn dishonest_models_are_told_with_angle_and_value_and_refused_when_strict() {
    let folder = tempfile::tempdir().unwrap();
    for (define, message) in [
        ("ENERGY", "the albedo is 130.00 % at outgoing angle"),
        ("RECIPROCITY", "with exchanged directions in band 0 at outgoing angle"),
        ("GRAZING", "value NaN at outgoing angle"),
        ("WEIGHT", "the weight of a sample is"),
        ("ANISOTROPY", "when both directions are rotated about the normal at outgoing angle"),
    ] {
        let Some(path) = c_plugin(folder.path(), "lambert.c", &define.to_lowercase(), &[&format!("-DBROKEN_{define}")])
        else {
            return;
        };
        let made = instantiate(&path, SelfCheck::Warn, "lambert", &[1.0; 3]).unwrap();
        assert!(made.warnings[0].contains(message), "{define}: {:?}", made.warnings);
        assert_eq!(made.brdf.faults().total(), 0, "the self-check does not count");
        let refused = instantiate(&path, SelfCheck::Strict, "lambert", &[1.0; 3]).unwrap_err();
        assert!(
            refused.to_string().contains("fails its self-check: ") && refused.to_string().contains(message),
            "{refused}"
        );
    }
}

/// Not a test: crashes in a plugin on a thread, like a rendering.
#[test]
#[ignore = "run by the next test as a child process"]
fn crash() {
    let Some(path) = std::env::var_os("RADSIGHT_TEST_CRASH") else { return };
    let made = instantiate(Path::new(&path), SelfCheck::Off, "lambert", &[0.5; 3]).unwrap();
    let brdf = &made.brdf;
    std::thread::scope(|scope| {
        scope.spawn(move || brdf.eval_pdf(glam::DVec3::Z, &[glam::DVec3::Z], &mut [0.0; 3], &mut [0.0]));
    });
}

#[test]
#[cfg(unix)]
fn a_crash_while_rendering_is_preceded_by_plugin_material_and_place() {
    use std::os::unix::process::ExitStatusExt;
    let folder = tempfile::tempdir().unwrap();
    let Some(path) = c_plugin(folder.path(), "lambert.c", "segfault", &["-DBROKEN_SEGFAULT"]) else { return };
    let output = std::process::Command::new(std::env::current_exe().unwrap())
        .args(["crash", "--exact", "--ignored", "--nocapture"])
        .env("RADSIGHT_TEST_CRASH", path)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(
        said.contains(
            "radsight: crash in plugin \"segfault\", model \"lambert\", material \"paint\" (room.rad:7:1), \
             function eval_pdf: SIGSEGV, invalid memory access;"
        ),
        "{said}"
    );
    assert_eq!(output.status.signal(), Some(11), "the process ends as it would have");
}
