//! Loads and uses valid and invalid plugins.

use glam::DVec3;
use radsight_brdf::{Brdf, Lambert, WardIsotropic};
use radsight_brdf_host::check::CHECK_BANDS;
use radsight_brdf_host::{Error, Instantiated, Label, Library, Registry, Request, SearchPath, SelfCheck, Token};
use radsight_test_support::plugins::{c_plugin, workspace_plugin};
use std::path::Path;
use std::sync::Arc;

fn label() -> Label {
    Label { material: "sheeting".to_owned(), place: "scene.rad:3:1".to_owned() }
}

fn instantiate(path: &Path, model: &str, numbers: &[f64], bands: usize) -> Result<Instantiated, Error> {
    let registry = Registry::new(SearchPath::default(), SelfCheck::Off);
    let library = registry.library_file(path)?;
    registry.instantiate_from(
        library,
        &Request {
            library: "",
            model,
            words: &[],
            numbers,
            bands: &CHECK_BANDS[..bands],
            label: &label(),
            folder: None,
        },
    )
}

/// Directions over the whole sphere, including grazing ones.
fn directions(count: usize) -> Vec<DVec3> {
    (0..count)
        .map(|i| {
            let (z, azimuth) = (1.0 - 2.0 * (i as f64 + 0.5) / count as f64, i as f64 * 2.399_963);
            let r = (1.0 - z * z).sqrt();
            DVec3::new(r * azimuth.cos(), r * azimuth.sin(), z)
        })
        .collect()
}

fn assert_same_bits<const N: usize>(plugin: &dyn Brdf, built_in: &dyn Brdf) {
    let all = directions(150);
    for &outgoing in &all {
        let (mut values, mut pdfs) = (vec![0.0; 150 * N], vec![0.0; 150]);
        let (mut values_in, mut pdfs_in) = (values.clone(), pdfs.clone());
        plugin.eval_pdf(outgoing, &all, &mut values, &mut pdfs);
        built_in.eval_pdf(outgoing, &all, &mut values_in, &mut pdfs_in);
        assert_eq!((values, pdfs), (values_in, pdfs_in));
        for k in 0..20 {
            let u = [f64::from(k) / 20.0, f64::from(k * 7 % 20) / 20.0, 0.5];
            let (mut weights, mut weights_in) = ([0.0; N], [0.0; N]);
            assert_eq!(plugin.sample(outgoing, u, &mut weights), built_in.sample(outgoing, u, &mut weights_in));
            if plugin.sample(outgoing, u, &mut weights).is_some() {
                assert_eq!(weights, weights_in);
            }
        }
    }
}

#[test]
fn a_model_as_a_plugin_gives_the_same_bits_as_built_in() {
    let path = workspace_plugin("radsight-plugin-builtin");
    let three = instantiate(&path, "ward", &[0.9, 0.5, 0.1, 0.15], 3).unwrap().brdf;
    assert_same_bits::<3>(&*three, &WardIsotropic { specularity: [0.9, 0.5, 0.1], roughness: 0.15 });
    let one = instantiate(&path, "ward", &[0.9, 0.9, 0.9, 0.15], 1).unwrap().brdf;
    assert_same_bits::<1>(&*one, &WardIsotropic { specularity: [0.9], roughness: 0.15 });
    let lambert = instantiate(&path, "lambert", &[0.9, 0.5, 0.1], 3).unwrap().brdf;
    assert_same_bits::<3>(&*lambert, &Lambert { reflectance: [0.9, 0.5, 0.1] });
    assert_eq!(three.faults().total() + one.faults().total() + lambert.faults().total(), 0);
    assert!(three.lobes().glossy && !three.lobes().diffuse);
    let refused = instantiate(&path, "lambert", &[0.9, 0.5, 0.1], 2).unwrap_err();
    assert_eq!(refused.to_string(), "plugin \"builtin\" cannot create \"lambert\": it works in 1 or 3 bands, not in 2");
}

#[test]
fn the_manual_page_comes_with_the_library() {
    let library = Library::load(&workspace_plugin("radsight-plugin-builtin")).unwrap();
    let manual = library.manual().unwrap();
    assert!(manual.starts_with("builtin: radsight's own models"), "{manual}");
    assert!(manual.trim_end().ends_with("Works in 1 or 3 bands."), "{manual}");
    assert_eq!(
        library.models()[1].usage("builtin"),
        "brdfplugin NAME  2 builtin ward  0  4 specularity.red specularity.green specularity.blue roughness"
    );
}

#[test]
fn a_plugin_in_c_works() {
    let folder = tempfile::tempdir().unwrap();
    let Some(path) = c_plugin(folder.path(), "lambert.c", "chalk", &[]) else { return };
    let brdf = instantiate(&path, "lambert", &[0.9, 0.5, 0.1], 3).unwrap().brdf;
    let mut value = [0.0; 3];
    let mut pdf = [0.0];
    brdf.eval_pdf(DVec3::Z, &[DVec3::new(0.6, 0.0, 0.8)], &mut value, &mut pdf);
    assert_eq!(value, [0.9, 0.5, 0.1].map(|rho| rho / std::f64::consts::PI));
    assert_eq!(pdf[0], 0.8 / std::f64::consts::PI);
}

#[test]
fn older_and_newer_minor_versions_load() {
    let folder = tempfile::tempdir().unwrap();
    for minor in [0, 1, 2] {
        let option = format!("-DMINOR={minor}");
        let Some(path) = c_plugin(folder.path(), "lambert.c", &format!("minor{minor}"), &[&option]) else { return };
        let brdf = instantiate(&path, "lambert", &[0.5; 3], 3).unwrap().brdf;
        assert_eq!(brdf.library().abi_version(), (1, minor));
        assert!(brdf.library().extension(c"radsight.manual", 1).is_null());
        let (mut value, mut pdf) = ([0.0; 3], [0.0]);
        brdf.eval_pdf(DVec3::Z, &[DVec3::Z], &mut value, &mut pdf);
        assert_eq!(value, [0.5 / std::f64::consts::PI; 3]);
    }
}

#[test]
fn what_is_no_plugin_is_refused_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, content: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, content).unwrap();
        path
    };
    let message = |path: &Path| {
        Library::load(path).unwrap_err().to_string().replace(&format!("{}/", folder.path().display()), "")
    };
    assert_eq!(
        message(&file("libtext.so", b"#!/bin/sh\n")),
        "\"libtext.so\" is not a shared library: it begins with \"#!/bin/sh\\n\""
    );
    assert_eq!(message(&file("libempty.so", b"")), "\"libempty.so\" is not a shared library: it is empty");
    assert!(message(&folder.path().join("libnone.so")).starts_with("cannot read plugin library \"libnone.so\": "));
    if cfg!(all(target_os = "linux", target_endian = "little")) {
        // A library for an architecture without tests.
        let mut elf = b"\x7fELF\x02\x01\x01\0\0\0\0\0\0\0\0\0\x03\0\x15\0\x01\0\0\0".to_vec();
        elf.resize(64, 0);
        assert_eq!(
            message(&file("libpower.so", &elf)),
            format!("\"libpower.so\" was built for powerpc64 elf, this program needs {} linux", std::env::consts::ARCH)
        );
        // A valid header, followed by the name only.
        elf[18] = if cfg!(target_arch = "x86_64") { 62 } else { 183 };
        elf.extend(b"radsight_brdf_entry\0");
        assert!(message(&file("libcut.so", &elf)).starts_with("cannot load plugin library \"libcut.so\": "));
    }
    let broken =
        |define: &str| c_plugin(folder.path(), "lambert.c", &define.to_lowercase(), &[&format!("-DBROKEN_{define}")]);
    let Some(symbol) = broken("SYMBOL") else { return };
    assert_eq!(message(&symbol), "\"libsymbol.so\" is not a BRDF plugin: it exports no \"radsight_brdf_entry\"");
    assert_eq!(
        message(&broken("MAGIC").unwrap()),
        "\"libmagic.so\" is not a BRDF plugin: its \"radsight_brdf_entry\" begins with 0x000000000000002a, expected 0x5241445342524446"
    );
    assert_eq!(
        message(&broken("MAJOR").unwrap()),
        "\"libmajor.so\" was built for version 7.1 of the plugin interface, this program has 1.1"
    );
    assert_eq!(
        message(&broken("DESCRIBE").unwrap()),
        "plugin \"describe\" breaks the plugin interface: describe(0) returns NULL, but count() is 1"
    );
}

#[test]
fn a_wrong_parameter_names_its_token() {
    let folder = tempfile::tempdir().unwrap();
    let Some(path) = c_plugin(folder.path(), "lambert.c", "chalk", &[]) else { return };
    let wrong = instantiate(&path, "lambert", &[0.5, 1.5, 0.5], 3).unwrap_err();
    assert_eq!(
        (wrong.token(), wrong.to_string().as_str()),
        (Token::Number(1), "reflectance is 1.5, expected at least 0 and at most 1")
    );
    let refused = instantiate(&path, "lambert", &[0.125, 0.5, 0.5], 3).unwrap_err();
    assert_eq!(
        (refused.token(), refused.to_string().as_str()),
        (Token::Number(0), "plugin \"chalk\" cannot create \"lambert\": reflectance: one eighth is an unlucky number")
    );
    let unknown = instantiate(&path, "lamber", &[], 3).unwrap_err();
    assert_eq!(unknown.to_string(), "plugin \"chalk\" has no model \"lamber\"; it has \"lambert\"");
    assert_eq!((unknown.token(), unknown.hint().as_deref()), (Token::Model, Some("did you mean \"lambert\"?")));
}

#[test]
fn wrong_results_become_zero_and_are_told_with_material_and_place() {
    let folder = tempfile::tempdir().unwrap();
    let use_it = |define: &str| {
        let path = c_plugin(folder.path(), "lambert.c", &define.to_lowercase(), &[&format!("-DBROKEN_{define}")])?;
        let brdf = instantiate(&path, "lambert", &[0.5; 3], 3).unwrap().brdf;
        let grazing = DVec3::new(1.0, 0.0, 0.01).normalize();
        let (mut values, mut pdfs) = ([0.0; 6], [0.0; 2]);
        brdf.eval_pdf(DVec3::Z, &[DVec3::Z, grazing], &mut values, &mut pdfs);
        assert!(values.iter().chain(&pdfs).all(|x| x.is_finite() && *x >= 0.0), "{define}: {values:?} {pdfs:?}");
        let mut weights = [0.0; 3];
        brdf.sample(DVec3::Z, [0.3, 0.6, 0.5], &mut weights);
        Some(brdf.fault_report().unwrap().to_string())
    };
    let Some(grazing) = use_it("GRAZING") else { return };
    assert_eq!(
        grazing,
        "scene.rad:3:1: plugin \"grazing\", model \"lambert\", material \"sheeting\" returned 3 wrong results, which count as zero: \
         3 NaN; the first: value NaN at outgoing angle 0.0000°, incident angle 89.4271°, azimuth between them 0.0000°"
    );
    assert!(use_it("NEGATIVE").unwrap().contains("9 negative"));
    assert!(use_it("INFINITE").unwrap().contains("9 infinite"));
    assert!(use_it("UNWRITTEN").unwrap().contains("3 NaN"));
    assert!(use_it("LENGTH").unwrap().contains("sampled direction that is not a unit vector"));
    assert!(use_it("STATUS").unwrap().contains("eval_pdf failed (internal fault)"));
}

#[test]
fn a_library_is_loaded_once_and_counts_are_kept_for_the_end() {
    let folder = tempfile::tempdir().unwrap();
    if c_plugin(folder.path(), "lambert.c", "nan", &["-DBROKEN_GRAZING"]).is_none() {
        return;
    }
    let mut search = SearchPath::default();
    search.push(folder.path());
    let registry = Registry::new(search, SelfCheck::Off);
    let label = label();
    let request = Request {
        library: "nan",
        model: "lambert",
        words: &[],
        numbers: &[0.5; 3],
        bands: &CHECK_BANDS,
        label: &label,
        folder: None,
    };
    let (first, second) = (registry.instantiate(&request).unwrap().brdf, registry.instantiate(&request).unwrap().brdf);
    assert!(Arc::ptr_eq(first.library(), second.library()));
    second.eval_pdf(DVec3::Z, &[DVec3::new(1.0, 0.0, 1e-3).normalize()], &mut [0.0; 3], &mut [0.0]);
    let reports = registry.fault_reports();
    assert_eq!((reports.len(), reports[0].counts.nan), (1, 3));
}
