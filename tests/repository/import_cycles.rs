//! The imports between the files of a crate have no cycle.
//!
//! A file outside cycles can be read, tested and extracted with the files below it. Only `use` and
//! paths that begin with `crate` or `super` count; a `mod` line is not an import, so a child may
//! depend on its parent.

use crate::sources::{lines_without_comments, rust_files};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Crates whose files import each other in cycles: the benchmark, the guard of plugin calls, the
/// compiler of functions, and the reader of scenes, which reads what scenes include.
const WITH_CYCLES: &[&str] = &["bench", "brdf-host", "cal", "parse"];

/// The sources of all crates.
fn sources() -> Vec<PathBuf> {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates");
    let entries = fs::read_dir(crates).expect("the folder is read");
    entries.map(|entry| entry.expect("an entry").path().join("src")).filter(|source| source.is_dir()).collect()
}

fn has_cycles(source: &Path) -> bool {
    WITH_CYCLES.iter().any(|name| source.ends_with(Path::new(name).join("src")))
}

/// The modules of a crate by their paths, `a::b`; the root is `lib`.
fn modules(source: &Path) -> BTreeMap<String, PathBuf> {
    let module = |path: PathBuf| {
        let inner = path.strip_prefix(source).expect("it is inside").with_extension("");
        let words: Vec<_> = inner.iter().map(|word| word.to_string_lossy()).filter(|word| word != "mod").collect();
        (words.join("::"), path)
    };
    rust_files(source).into_iter().map(module).collect()
}

/// The code of a file without comments and without its tests, which may use anything.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).expect("the file is read");
    let code = text.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
    lines_without_comments(code).collect::<Vec<_>>().join("\n")
}

/// The paths in a file that begin with `crate` or `super`, with lists in braces expanded, relative
/// to the root of the crate.
fn paths(module: &str, code: &str) -> Vec<String> {
    let parent = module.rsplit_once("::").map_or("", |(parent, _)| parent);
    let mut found = Vec::new();
    for (root, base) in [("crate::", ""), ("super::", parent)] {
        for (at, _) in code.match_indices(root) {
            let rest = &code[at + root.len()..];
            let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':')).unwrap_or(rest.len());
            let path = rest[..end].trim_end_matches(':');
            let joined = |more: &str| {
                [base, path, more].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("::")
            };
            match rest[end..].strip_prefix('{').and_then(|list| list.split('}').next()) {
                Some(list) => found.extend(list.split(',').map(str::trim).filter(|name| !name.is_empty()).map(joined)),
                None => found.push(joined("")),
            }
        }
    }
    found
}

/// The module that a path names.
fn target<'m>(modules: &'m BTreeMap<String, PathBuf>, path: &str) -> Option<&'m str> {
    let mut path = path;
    loop {
        if let Some((module, _)) = modules.get_key_value(path) {
            return Some(module);
        }
        path = path.rsplit_once("::")?.0;
    }
}

/// The imports of each module.
fn imports(source: &Path) -> BTreeMap<String, BTreeSet<String>> {
    let modules = modules(source);
    let of = |(module, path): (&String, &PathBuf)| {
        let found = paths(module, &code(path));
        let targets = found.iter().filter_map(|path| target(&modules, path)).filter(|target| target != module);
        (module.clone(), targets.map(str::to_owned).collect())
    };
    modules.iter().map(of).collect()
}

/// The rest after modules without imports are removed repeatedly: modules in cycles, and those that
/// import them.
fn in_cycles(mut imports: BTreeMap<String, BTreeSet<String>>) -> BTreeMap<String, BTreeSet<String>> {
    loop {
        let free: BTreeSet<String> =
            imports.iter().filter(|(_, targets)| targets.is_empty()).map(|(module, _)| module.clone()).collect();
        if free.is_empty() {
            return imports;
        }
        imports.retain(|module, _| !free.contains(module));
        imports.values_mut().for_each(|targets| targets.retain(|target| !free.contains(target)));
    }
}

#[test]
fn no_files_of_a_crate_import_each_other_in_a_cycle() {
    for source in sources() {
        let left = in_cycles(imports(&source));
        assert_eq!(!left.is_empty(), has_cycles(&source), "{}: {left:#?}", source.display());
    }
}

#[test]
fn a_cycle_is_found() {
    let imports = [("a", "b"), ("b", "c"), ("c", "a"), ("d", "a"), ("e", "f")];
    let mut graph: BTreeMap<String, BTreeSet<String>> = BTreeMap::from([("f".to_owned(), BTreeSet::new())]);
    for (from, to) in imports {
        graph.entry(from.to_owned()).or_default().insert(to.to_owned());
    }
    assert_eq!(in_cycles(graph).into_keys().collect::<String>(), "abcd");
}

#[test]
fn imports_are_read_from_lists_and_parents() {
    let code = "use crate::{a::One, b};\nuse super::c::{Two, Three};\nlet x = crate::d::four();";
    assert_eq!(paths("trace::shade", code), ["a::One", "b", "d::four", "trace::c::Two", "trace::c::Three"]);
}

#[test]
fn the_imports_of_all_crates_are_read() {
    let sources = sources();
    assert!(sources.len() > 40 && WITH_CYCLES.len() == sources.iter().filter(|source| has_cycles(source)).count());
    for source in &sources {
        let modules = modules(source);
        assert!(modules.contains_key("lib") || modules.contains_key("main"), "{}", source.display());
    }
    let render = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/render/src");
    assert!(imports(&render).values().map(BTreeSet::len).sum::<usize>() > 50, "imports are found");
}
