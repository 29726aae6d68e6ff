//! Description of a library, as text.

use crate::{Library, ModelInfo, ParameterInfo, ParameterKind};
use radsight_brdf_abi::flags;
use std::fmt::Write;

impl Library {
    /// Describes the models: usage in a scene, parameters with units and ranges, and citations.
    #[must_use]
    pub fn describe(&self) -> String {
        let (major, minor) = self.abi_version();
        let mut out = format!("{} ({}, interface {major}.{minor})\n", self.name(), self.path().display());
        for model in self.models() {
            describe_model(&mut out, self.name(), model);
        }
        out
    }
}

fn describe_model(out: &mut String, library: &str, model: &ModelInfo) {
    let dash = if model.summary.is_empty() { "" } else { ": " };
    let _ = writeln!(out, "\n  {}{dash}{}", model.name, model.summary);
    let _ = writeln!(out, "    {}", model.usage(library));
    let width = model.parameters.iter().map(|row| row.name.chars().count()).max().unwrap_or(0);
    for row in &model.parameters {
        let _ = writeln!(out, "      {:width$}  {}", row.name, describe_parameter(row));
    }
    let _ = writeln!(out, "    lobes: {}", lobes(model));
    if !model.citation.is_empty() {
        let _ = writeln!(out, "    after {}", model.citation);
    }
}

fn describe_parameter(row: &ParameterInfo) -> String {
    let mut parts = Vec::new();
    if !row.doc.is_empty() {
        parts.push(row.doc.clone());
    }
    match &row.kind {
        ParameterKind::Choice(choices) => parts.push(format!("one of {}", choices.join(", "))),
        ParameterKind::File => parts.push("a file".to_owned()),
        ParameterKind::Word => parts.push("a word".to_owned()),
        kind => {
            let unit = if row.unit.is_empty() || row.unit == "1" { String::new() } else { format!(" {}", row.unit) };
            let whole = if *kind == ParameterKind::Integer { "a whole number, " } else { "" };
            let bounded = row.range.minimum.is_finite() || row.range.maximum.is_finite();
            parts.push(if bounded {
                format!("{whole}{}{unit}", row.range)
            } else {
                format!("{whole}any number{unit}")
            });
        }
    }
    if row.optional {
        let default = if row.scene_numbers() == 0 { row.default_word.clone() } else { row.default_number.to_string() };
        parts.push(format!("default {default}"));
    }
    parts.join("; ")
}

fn lobes(model: &ModelInfo) -> String {
    let names = [
        (flags::DIFFUSE, "diffuse"),
        (flags::GLOSSY, "glossy"),
        (flags::DELTA, "perfectly specular"),
        (flags::TRANSMISSION, "transmission"),
        (flags::ANISOTROPIC, "anisotropic"),
        (flags::RECIPROCAL, "claims reciprocity"),
    ];
    let present: Vec<&str> = names.iter().filter(|(flag, _)| model.flags & flag != 0).map(|(_, name)| *name).collect();
    if present.is_empty() { "none declared".to_owned() } else { present.join(", ") }
}
