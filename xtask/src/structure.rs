//! The figures of `docs/architecture.md`: crates, their sizes and edges, and lengths of functions.

use crate::function_lengths::function_lengths;
use crate::workspace::{self, Package};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::fs;

const BEGIN: &str = "<!-- `cargo xtask structure` writes the part below. -->\n";
const END: &str = "<!-- `cargo xtask structure` wrote the part above. -->\n";

/// Writes the figures between the marks of the page.
pub(crate) fn write() -> Result<(), String> {
    let path = workspace::root().join("docs/architecture.md");
    let page = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let marks = page.split_once(BEGIN).and_then(|(before, rest)| Some((before, rest.split_once(END)?.1)));
    let (before, after) = marks.ok_or("docs/architecture.md: the marks are missing")?;
    let page = format!("{before}{BEGIN}{}{END}{after}", figures()?);
    fs::write(&path, page).map_err(|error| format!("{}: {error}", path.display()))
}

/// A crate and its measurements.
struct Measured {
    package: Package,
    lines: usize,
    functions: Vec<usize>,
}

fn figures() -> Result<String, String> {
    let crates = workspace::root().join("crates");
    let packages = workspace::packages()?.into_iter().filter(|package| package.folder.starts_with(&crates));
    let measured: Vec<Measured> = packages.map(measure).collect::<Result<_, _>>()?;
    Ok(format!("\n{}\n{}\n{}\n", function_sentence(&measured), drawing(&measured), table(&measured)))
}

fn measure(package: Package) -> Result<Measured, String> {
    let (mut lines, mut functions) = (0, Vec::new());
    for path in package.sources() {
        let text = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        lines += text.lines().count();
        functions.extend(function_lengths(&text));
    }
    Ok(Measured { package, lines, functions })
}

fn function_sentence(crates: &[Measured]) -> String {
    let mut lengths: Vec<usize> = crates.iter().flat_map(|measured| measured.functions.iter().copied()).collect();
    lengths.sort_unstable();
    let part = |share: f64| lengths.get((share * lengths.len() as f64) as usize).copied().unwrap_or_default();
    format!(
        "{} functions in {} crates: the median has {} lines, 90 % have at most {}, 99 % at most {}.\n",
        lengths.len(),
        crates.len(),
        part(0.5),
        part(0.9),
        part(0.99)
    )
}

/// The layer of each crate: one above the highest crate that it depends on. Crates in a cycle would
/// have none.
fn layers(crates: &[Measured]) -> BTreeMap<&str, usize> {
    let mut layers: BTreeMap<&str, usize> = BTreeMap::new();
    while layers.len() < crates.len() {
        let known = layers.len();
        for Measured { package, .. } in crates {
            let below: Option<Vec<usize>> =
                package.edges.iter().map(|edge| layers.get(edge.as_str()).copied()).collect();
            if let Some(below) = below {
                layers.insert(&package.name, below.into_iter().max().map_or(0, |highest| highest + 1));
            }
        }
        if layers.len() == known {
            break;
        }
    }
    layers
}

/// The transitive reduction of the edges as a Mermaid flow chart.
fn drawing(crates: &[Measured]) -> String {
    let edges: BTreeMap<&str, &BTreeSet<String>> =
        crates.iter().map(|measured| (measured.package.name.as_str(), &measured.package.edges)).collect();
    let mut chart = "```mermaid\nflowchart BT\n".to_owned();
    for Measured { package, .. } in crates {
        for edge in package.edges.iter().filter(|edge| !is_implied(package, edge, &edges)) {
            let below = edge.strip_prefix("radsight-").unwrap_or(edge);
            writeln!(chart, "  {} --> {}", below, package.short_name()).expect("a string is written");
        }
    }
    chart + "```\n"
}

fn is_implied(package: &Package, edge: &str, edges: &BTreeMap<&str, &BTreeSet<String>>) -> bool {
    let mut waiting: Vec<&str> = package.edges.iter().map(String::as_str).filter(|other| *other != edge).collect();
    let mut seen = BTreeSet::new();
    while let Some(name) = waiting.pop() {
        if name == edge {
            return true;
        }
        if seen.insert(name) {
            waiting.extend(edges.get(name).into_iter().flat_map(|edges| edges.iter().map(String::as_str)));
        }
    }
    false
}

fn table(crates: &[Measured]) -> String {
    let layers = layers(crates);
    let mut table = "| layer | crate | lines | built on |\n|---|---|---|---|\n".to_owned();
    let mut rows: Vec<&Measured> = crates.iter().collect();
    rows.sort_by_key(|measured| (layers.get(measured.package.name.as_str()), &measured.package.name));
    for Measured { package, lines, .. } in rows {
        let layer = layers.get(package.name.as_str()).map_or("in a cycle".to_owned(), usize::to_string);
        let edges: Vec<&str> =
            package.edges.iter().map(|edge| edge.strip_prefix("radsight-").unwrap_or(edge)).collect();
        writeln!(table, "| {layer} | `{}` | {lines} | {} |", package.short_name(), edges.join(", "))
            .expect("a string is written");
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    fn package(name: &str, edges: &[&str]) -> Measured {
        let edges = edges.iter().map(|edge| (*edge).to_owned()).collect();
        let package = Package { name: name.to_owned(), folder: "".into(), edges, may_be_published: true };
        Measured { package, lines: 1, functions: vec![1] }
    }

    #[test]
    fn edges_that_a_longer_way_says_are_not_drawn() {
        let crates = [package("a", &[]), package("b", &["a"]), package("c", &["a", "b"])];
        assert_eq!(drawing(&crates), "```mermaid\nflowchart BT\n  a --> b\n  b --> c\n```\n");
        assert_eq!(layers(&crates)["c"], 2);
    }

    #[test]
    fn crates_of_a_cycle_have_no_layer() {
        let crates = [package("a", &["b"]), package("b", &["a"])];
        assert!(layers(&crates).is_empty());
        assert!(table(&crates).contains("in a cycle"));
    }
}
