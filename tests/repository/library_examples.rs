//! Every public item of the library has an example that is compiled and run: its own, or that of
//! its type, which calls it.

use crate::sources::rust_files;
use std::fs;
use std::path::Path;

/// Items without an example, and why.
const EXCEPTIONS: &[(&str, &str)] = &[
    ("CaptureDerivatives::expose_with_progress", "as expose, with progress"),
    ("CaptureSeries::expose_with_progress", "as expose, with progress"),
    ("ErrorBudget::MOST_SAMPLES", "a number"),
    ("ErrorBudget::asked_error", "a field"),
    ("ErrorBudget::asked_samples", "a field"),
    ("ExposureDerivatives", "the example of CaptureDerivatives makes it"),
    ("FisherInformation", "docs/derivatives.md: it needs a sensor, parts and parameters"),
    ("FisherInformation::new", "see its type"),
    ("FisherInformation::to_json", "see its type"),
    ("Image::MOST_PIXELS", "a number"),
    ("ParameterDerivative", "the example of CaptureDerivatives makes it"),
    ("RenderJob::expose", "Renderer::run_job calls it"),
    ("RenderJob::fill_irradiance_cache", "Renderer::irradiance_cache_for calls it"),
    ("RenderJob::render", "Renderer::run_job calls it"),
    ("RenderJob::trace", "Renderer::run_job_with_progress calls it"),
    ("Renderer::contributions_part", "as contributions, for a part as in trace_part"),
    ("Renderer::render_camera_with_progress", "as render_camera, with progress"),
    ("Renderer::render_with_progress", "as render, with progress"),
    ("Renderer::run_job_with_progress", "as run_job, with progress"),
    ("SceneBuilder::material", "CONTRIBUTING.md: a custom material"),
    ("SeriesExposure", "for programs with their own scenes; CaptureSeries uses it"),
    ("SeriesScenes", "for programs with their own scenes; CaptureSeries implements it"),
    ("expose_derivatives", "for programs with their own scenes; CaptureDerivatives calls it"),
    ("expose_series", "for programs with their own scenes; CaptureSeries calls it"),
];

/// A public item with its documentation.
struct Item {
    /// `Type::name` for a method or constant of a type.
    name: String,
    documentation: String,
}

impl Item {
    fn has_example(&self) -> bool {
        self.documentation.contains("```")
    }
}

/// The public items of a source: types, traits, functions, methods and constants.
fn items(text: &str) -> Vec<Item> {
    let (mut items, mut documentation, mut owner) = (Vec::new(), String::new(), String::new());
    for line in text.lines().take_while(|line| *line != "#[cfg(test)]") {
        let word = line.trim_start();
        if word.starts_with("///") {
            documentation.push_str(word);
            documentation.push('\n');
            continue;
        }
        if word.starts_with("#[") {
            continue;
        }
        if line.starts_with("impl") {
            owner = owner_of(line).to_owned();
        }
        let kinds = ["pub fn ", "pub struct ", "pub enum ", "pub trait ", "pub const "];
        if let Some(rest) = kinds.iter().find_map(|kind| word.strip_prefix(kind)) {
            let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
            let owned = if line.starts_with(' ') { format!("{owner}::") } else { String::new() };
            let documentation = std::mem::take(&mut documentation);
            items.push(Item { name: format!("{owned}{}", &rest[..end]), documentation });
        }
        documentation.clear();
    }
    items
}

/// The type of an `impl` block.
fn owner_of(line: &str) -> &str {
    let after = line.split_once(" for ").map_or(line, |(_, after)| after);
    let after = after.trim_start_matches("impl").trim_start();
    let after = if after.starts_with('<') { after.split_once("> ").map_or(after, |(_, rest)| rest) } else { after };
    after.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default()
}

#[test]
fn every_public_item_of_the_library_has_an_example() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/radsight/src");
    let files = rust_files(&folder).into_iter().filter(|path| !path.ends_with("example.rs"));
    let all: Vec<Item> = files.flat_map(|path| items(&fs::read_to_string(path).unwrap())).collect();
    assert!(all.len() > 150, "{} items are known", all.len());
    let called_by_its_type = |name: &str| {
        let Some((owner, method)) = name.split_once("::") else { return false };
        let calls = [format!(".{method}("), format!("{owner}::{method}(")];
        let examples = all.iter().filter(|item| item.name == owner).map(|item| item.documentation.as_str());
        examples.into_iter().any(|example| calls.iter().any(|call| example.contains(call.as_str())))
    };
    let is_listed = |name: &str| EXCEPTIONS.iter().any(|(exception, _)| *exception == name);
    let lacks = |item: &&Item| !item.has_example() && !called_by_its_type(&item.name);
    let missing: Vec<&str> = all.iter().filter(lacks).map(|item| item.name.as_str()).collect();
    let unlisted: Vec<&&str> = missing.iter().filter(|name| !is_listed(name)).collect();
    assert!(unlisted.is_empty(), "without an example: {unlisted:?}");
    let stale: Vec<&str> = EXCEPTIONS.iter().map(|(name, _)| *name).filter(|name| !missing.contains(name)).collect();
    assert!(stale.is_empty(), "exceptions that have an example: {stale:?}");
}

#[test]
fn an_item_without_an_example_is_found() {
    let text = "/// A.\npub struct A;\nimpl<'l> A {\n    /// ```\n    /// A::b();\n    /// ```\n    #[must_use]\n    pub fn b() {}\n    /// C.\n    pub fn c() {}\n}\n";
    let found: Vec<(String, bool)> = items(text).iter().map(|item| (item.name.clone(), item.has_example())).collect();
    let expected = [("A", false), ("A::b", true), ("A::c", false)];
    assert_eq!(found, expected.map(|(name, has)| (name.to_owned(), has)));
}
