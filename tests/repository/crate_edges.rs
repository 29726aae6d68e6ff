//! The dependencies between the crates.
//!
//! Cargo enforces the boundaries, so a new edge is added here first, with its reason in the commit
//! message.

use crate::sources::crate_folders;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The allowed dependencies of each crate of the workspace, without the common prefix `radsight-`.
/// A crate that is missing here may not exist.
const ALLOWED: &[(&str, &[&str])] = &[
    ("accel", &["diag", "ir"]),
    ("adaptive", &[]),
    (
        "bench",
        &[
            "brdf",
            "brdf-host",
            "camera",
            "capture",
            "diag",
            "ir",
            "loader",
            "memory",
            "parse",
            "picture",
            "pinhole",
            "render",
            "sensor",
            "units",
        ],
    ),
    ("brdf", &["sampling"]),
    ("brdf-abi", &[]),
    ("brdf-host", &["brdf", "brdf-abi", "diag"]),
    ("brdf-sdk", &["brdf-abi"]),
    ("bsdf", &["brdf", "cal", "ir", "light", "measured", "retro", "sampling", "texture"]),
    ("cal", &["diag"]),
    ("camera", &["diag", "loader", "pinhole", "sensor"]),
    ("capture", &["adaptive", "pinhole", "render", "sampling"]),
    ("compile", &["accel", "brdf", "bsdf", "cal", "diag", "ir", "light", "retro", "sampling", "spectrum", "texture"]),
    ("diag", &[]),
    ("film", &["adaptive", "picture", "render", "sampling"]),
    ("flux", &["measured", "sampling", "sky", "triangulation"]),
    ("formats", &["picture"]),
    ("ir", &["cal", "diag", "measured", "triangulation"]),
    ("irradiance-cache", &[]),
    ("light", &["accel", "ir", "sampling", "triangulation"]),
    ("loader", &[]),
    ("matrix", &["cal", "diag", "measured", "picture", "spectrum"]),
    ("measured", &[]),
    ("octree", &["formats", "ir"]),
    ("options", &["diag"]),
    ("memory", &[]),
    ("output", &[]),
    ("parse", &["cal", "diag", "formats", "ir", "loader", "measured", "options", "picture", "scene-generators"]),
    ("picture", &["units"]),
    ("picture-ops", &["cal", "diag", "formats", "picture", "units"]),
    ("pinhole", &["sampling"]),
    ("rad-project", &["scene-generators"]),
    (
        "render",
        &[
            "accel",
            "brdf",
            "bsdf",
            "cal",
            "compile",
            "ir",
            "irradiance-cache",
            "light",
            "sampling",
            "spectrum",
            "texture",
        ],
    ),
    (
        "radsight",
        &[
            "adaptive", "brdf", "cal", "camera", "capture", "diag", "film", "ir", "loader", "parse", "picture",
            "pinhole", "render", "report", "sampling", "sensor",
        ],
    ),
    ("recipes", &["radsight"]),
    ("report", &["picture"]),
    ("retro", &["brdf"]),
    ("sampling", &[]),
    ("scene-generators", &["cal", "diag", "loader", "measured", "options", "sky", "triangulation", "units"]),
    ("sensor", &[]),
    ("sky", &[]),
    ("spectrum", &["units"]),
    ("test-support", &[]),
    ("texture", &["accel", "cal", "ir", "spectrum", "units"]),
    ("triangulation", &[]),
    ("units", &[]),
];

/// Additional dependencies of a crate's tests, benchmarks and examples.
const ALLOWED_IN_TESTS: &[(&str, &[&str])] = &[
    ("accel", &["sampling"]),
    ("bench", &["cal", "irradiance-cache"]),
    ("brdf-host", &["test-support"]),
    ("bsdf", &["accel"]),
    ("cal", &["test-support"]),
    ("camera", &["sampling", "test-support"]),
    ("irradiance-cache", &["sampling"]),
    ("measured", &["test-support"]),
    ("parse", &["test-support"]),
    ("picture", &["test-support"]),
    ("pinhole", &["test-support"]),
    ("render", &["diag"]),
    ("scene-generators", &["test-support"]),
    ("texture", &["diag"]),
];

/// The allowed dependencies of plugins: the layer for plugin authors. The plugin of the built-in
/// models wraps them.
const ALLOWED_IN_PLUGINS: &[&str] = &["brdf-sdk"];
const ALLOWED_IN_BUILTIN_PLUGIN: &[&str] = &["brdf", "brdf-sdk"];
/// The plugin of cube corners wraps the one of `retro`: one implementation with two entry points.
const ALLOWED_IN_PRISMATIC_PLUGIN: &[&str] = &["brdf-sdk", "retro"];
const ALLOWED_IN_PLUGIN_TESTS: &[&str] = &["brdf-host"];

/// Crates without a dependency in either direction, direct or indirect, except for the edges of
/// `CROSSINGS`.
const WALLED: &[&str] = &["ir", "parse", "render", "retro", "pinhole", "sensor"];

/// Lowering fills the scene; rendering reads it, and uses the retroreflectors through their
/// interface.
const CROSSINGS: &[(&str, &str)] = &[("parse", "ir"), ("render", "ir"), ("render", "retro")];

/// External packages that some crates must not use, directly or indirectly, with the reason.
const FORBIDDEN_PACKAGES: &[(&str, &[&str])] = &[
    ("ir", &["nom", "obvhs", "image", "png", "clap", "libloading"]),
    ("parse", &["obvhs", "rayon", "clap", "libloading", "memmap2"]),
    ("render", &["nom", "libloading", "clap", "image", "png", "indicatif"]),
    ("brdf", &["libloading"]),
    ("retro", &["obvhs", "libloading"]),
    ("pinhole", &["obvhs", "clap"]),
    ("sensor", &["obvhs", "clap"]),
];

/// One `Cargo.toml`.
struct Manifest {
    path: PathBuf,
    name: String,
    dependencies: BTreeSet<String>,
    test_dependencies: BTreeSet<String>,
}

impl Manifest {
    fn read(folder: &Path) -> Manifest {
        let path = folder.join("Cargo.toml");
        let text = fs::read_to_string(&path).expect("a Cargo.toml");
        let table: toml::Table = text.parse().expect("Cargo.toml is TOML");
        let name = table["package"]["name"].as_str().expect("a package has a name").to_owned();
        let mut manifest = Manifest { path, name, dependencies: BTreeSet::new(), test_dependencies: BTreeSet::new() };
        manifest.add(&table);
        for target in table.get("target").and_then(toml::Value::as_table).into_iter().flat_map(toml::Table::values) {
            manifest.add(target.as_table().expect("a target is a table"));
        }
        manifest
    }

    fn add(&mut self, table: &toml::Table) {
        let names = |key: &str| {
            let found = table.get(key).and_then(toml::Value::as_table);
            let package = |(name, value): (&String, &toml::Value)| {
                value.get("package").and_then(toml::Value::as_str).unwrap_or(name).to_owned()
            };
            found.map(|table| table.iter().map(package).collect::<Vec<_>>()).unwrap_or_default()
        };
        self.dependencies.extend(names("dependencies"));
        self.dependencies.extend(names("build-dependencies"));
        self.test_dependencies.extend(names("dev-dependencies"));
    }

    /// Edges to crates of the workspace, by their short names.
    fn edges(dependencies: &BTreeSet<String>) -> BTreeSet<&str> {
        dependencies.iter().filter_map(|name| Manifest::short(name)).collect()
    }

    /// A crate's name without the common prefix; none for external packages.
    fn short(name: &str) -> Option<&str> {
        if name == "radsight" { Some(name) } else { name.strip_prefix("radsight-") }
    }
}

fn manifests(folder: &str) -> Vec<Manifest> {
    crate_folders(folder).iter().map(|folder| Manifest::read(folder)).collect()
}

fn allowed(list: &[(&str, &'static [&'static str])], name: &str) -> BTreeSet<&'static str> {
    let edges = list.iter().find(|(known, _)| *known == name).map(|(_, edges)| *edges);
    edges.unwrap_or_default().iter().copied().collect()
}

#[test]
fn crates_know_what_the_list_allows() {
    let mut seen = BTreeSet::new();
    for manifest in manifests("crates") {
        let name = manifest.name.strip_prefix("radsight-").unwrap_or("radsight").to_owned();
        let folder = manifest.path.parent().and_then(Path::file_name).expect("a folder");
        assert_eq!(folder.to_string_lossy(), name, "a crate's folder has its name");
        assert!(ALLOWED.iter().any(|(known, _)| *known == name), "crate {name} is not in the list");
        // Equality: an allowed edge that is not used must be removed.
        assert_eq!(Manifest::edges(&manifest.dependencies), allowed(ALLOWED, &name), "edges of {name}");
        let in_tests = Manifest::edges(&manifest.test_dependencies);
        assert_eq!(in_tests, allowed(ALLOWED_IN_TESTS, &name), "edges of the tests of {name}");
        seen.insert(name);
    }
    assert_eq!(seen.len(), ALLOWED.len(), "every crate of the list exists");
}

#[test]
fn plugins_know_the_layer_for_plugin_authors() {
    for manifest in manifests("plugins") {
        let is = |name: &str| manifest.path.parent().is_some_and(|folder| folder.ends_with(name));
        let list = match () {
            () if is("builtin") => ALLOWED_IN_BUILTIN_PLUGIN,
            () if is("prismatic") => ALLOWED_IN_PRISMATIC_PLUGIN,
            () => ALLOWED_IN_PLUGINS,
        };
        for edge in Manifest::edges(&manifest.dependencies) {
            assert!(list.contains(&edge), "plugin {} knows {edge}", manifest.name);
        }
        for edge in Manifest::edges(&manifest.test_dependencies) {
            assert!(ALLOWED_IN_PLUGIN_TESTS.contains(&edge), "the tests of plugin {} know {edge}", manifest.name);
        }
    }
}

#[test]
fn the_walls_hold_by_any_detour() {
    let edges: BTreeMap<&str, &[&str]> = ALLOWED.iter().copied().collect();
    let reachable = |from: &'static str| {
        let mut reached = BTreeSet::new();
        let mut waiting = vec![from];
        while let Some(name) = waiting.pop() {
            waiting.extend(edges[name].iter().copied().filter(|next| reached.insert(*next)));
        }
        reached
    };
    for from in WALLED.iter().copied() {
        let reached = reachable(from);
        for to in WALLED.iter().copied().filter(|to| reached.contains(to)) {
            assert!(CROSSINGS.contains(&(from, to)), "{from} knows {to}");
        }
    }
    assert!(!reachable("render").contains("loader"), "the renderer reads no files");
    assert!(!reachable("render").contains("brdf-host"), "the renderer loads no libraries");
    assert_eq!(
        reachable("accel"),
        reachable("ir").into_iter().chain(["ir"]).collect(),
        "hierarchies know shapes and ids, no shading"
    );
    assert!(reachable("measured").is_empty(), "scattering data know no scenes");
    assert!(!reachable("brdf").contains("ir"), "reflectance models know no scenes");
    assert!(reachable("brdf-abi").is_empty(), "the C interface stands alone");
    let for_tests = ALLOWED.iter().filter(|(_, edges)| edges.contains(&"test-support"));
    assert_eq!(for_tests.count(), 0, "tests alone know what is made for them");
    assert!(!reachable("brdf-sdk").contains("brdf-host"), "plugins do not know their host");
    assert!(reachable("sensor").is_empty(), "the sensor knows nothing upstream");
}

#[test]
fn crates_keep_away_from_packages_that_are_none_of_their_business() {
    let manifests = manifests("crates");
    for (name, forbidden) in FORBIDDEN_PACKAGES {
        let manifest = manifests.iter().find(|found| found.name == format!("radsight-{name}")).expect("a crate");
        for package in *forbidden {
            assert!(!manifest.dependencies.contains(*package), "{name} depends on {package}");
        }
    }
}

#[test]
fn nobody_knows_the_program() {
    for manifest in manifests("crates").into_iter().chain(manifests("plugins")) {
        let all = manifest.dependencies.union(&manifest.test_dependencies);
        assert!(all.into_iter().all(|name| name != "radsight-cli"), "{} depends on the program", manifest.name);
    }
}
