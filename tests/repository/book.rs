//! The documentation: each page is in the book once, and every link resolves.
//!
//! Links are checked in the sources, without a network. If `mdbook` is on the path, the book is
//! built as well.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The pages of the folder `docs`.
fn pages() -> BTreeSet<String> {
    let entries = root().join("docs").read_dir().expect("the folder is read");
    let names = entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned());
    names.filter(|name| name.ends_with(".md") && name != "SUMMARY.md").collect()
}

/// The targets of a page's links and pictures, except in code.
fn links(text: &str) -> Vec<String> {
    let mut links = Vec::new();
    let mut in_code = false;
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            in_code = !in_code;
        }
        if in_code {
            continue;
        }
        // Every other part between backticks is code.
        let prose: String = line.split('`').step_by(2).collect::<Vec<_>>().join("`");
        links.extend(prose.split("](").skip(1).filter_map(|rest| rest.split(')').next()).map(str::to_owned));
    }
    links
}

/// The anchor of a heading in mdBook and on forges.
fn anchors(text: &str) -> BTreeSet<String> {
    let headings = text.lines().filter(|line| line.starts_with('#')).map(|line| line.trim_start_matches('#').trim());
    let kept = |c: char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    headings
        .map(|heading| heading.to_lowercase().chars().filter(|c| kept(*c)).collect::<String>().replace(' ', "-"))
        .collect()
}

/// The broken links of a file.
fn dead_links(file: &Path) -> Vec<String> {
    let text = fs::read_to_string(file).expect("a page is text");
    let folder = file.parent().expect("a page is in a folder");
    let dead = |link: &String| {
        if link.contains("://") || link.starts_with("mailto:") {
            return false;
        }
        let (path, anchor) = link.split_once('#').map_or((link.as_str(), None), |(path, anchor)| (path, Some(anchor)));
        let target: PathBuf = if path.is_empty() { file.to_owned() } else { folder.join(path) };
        let has_anchor = |anchor: &str| fs::read_to_string(&target).is_ok_and(|text| anchors(&text).contains(anchor));
        !target.exists() || anchor.is_some_and(|anchor| !has_anchor(anchor))
    };
    links(&text).into_iter().filter(dead).map(|link| format!("{}: {link}", file.display())).collect()
}

#[test]
fn every_page_stands_in_the_book_once() {
    let summary = fs::read_to_string(root().join("docs/SUMMARY.md")).expect("a table of contents");
    let listed = links(&summary);
    let unique: BTreeSet<String> = listed.iter().cloned().collect();
    assert_eq!(unique.len(), listed.len(), "a page stands in the book twice");
    assert_eq!(unique, pages());
}

#[test]
fn every_link_leads_to_something() {
    let docs = pages().into_iter().map(|name| root().join("docs").join(name));
    let others = ["README.md", "docs/SUMMARY.md", "bindings/python/README.md"].map(|name| root().join(name));
    let dead: Vec<String> = docs.chain(others).flat_map(|file| dead_links(&file)).collect();
    assert!(dead.is_empty(), "{}", dead.join("\n"));
}

#[test]
fn a_dead_link_is_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let page = folder.path().join("page.md");
    fs::write(folder.path().join("other.md"), "# One heading: `with` code\n").expect("a page");
    let text = "# Top\n[a](other.md) [b](none.md) ![c](none.png) [d](#top) [e](#bottom) `[f](code.md)`\n\
        [g](other.md#one-heading-with-code) [h](other.md#two) [i](https://radiance-online.org)\n```\n[j](block.md)\n```\n";
    fs::write(&page, text).expect("a page");
    let dead = dead_links(&page);
    let found: Vec<&str> = dead.iter().filter_map(|line| line.rsplit(": ").next()).collect();
    assert_eq!(found, ["none.md", "none.png", "#bottom", "other.md#two"]);
}

#[test]
fn the_book_is_built() {
    let mdbook = std::env::var("RADSIGHT_MDBOOK").unwrap_or_else(|_| "mdbook".to_owned());
    if !Command::new(&mdbook).arg("--version").output().is_ok_and(|run| run.status.success()) {
        return println!("skipped: no mdbook found");
    }
    let folder = tempfile::tempdir().expect("a folder");
    let run = Command::new(&mdbook).arg("build").arg("--dest-dir").arg(folder.path()).arg(root().join("docs")).output();
    let run = run.expect("mdbook starts");
    let said = String::from_utf8_lossy(&run.stderr).into_owned();
    assert!(run.status.success() && !said.contains("WARN"), "{said}");
    for page in pages() {
        let built = folder.path().join(page.replace(".md", ".html"));
        assert!(fs::metadata(&built).is_ok_and(|found| found.len() > 2000), "{}", built.display());
    }
}
