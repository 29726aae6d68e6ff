//! Names and messages use the words of pbrt, Mitsuba and Radiance.
//!
//! Each word below once had a meaning of our own in this repository. The field has another word for
//! it, so the word is absent from names and messages, except where it has its ordinary meaning.

use crate::sources::{lines_without_comments, rust_files};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// A word, and the field's word for what it meant here.
const WORDS: &[(&str, &str)] = &[
    ("Between", "a visibility class"),
    ("BrightView", "a guiding distribution"),
    ("Coupling", "a Fresnel coat"),
    ("Course", "the state of a path"),
    ("Debt", "a deferred contribution"),
    ("DiskTilt", "lobe-weighted light sampling"),
    ("Drawn", "a sample"),
    ("Effort", "a sampling budget"),
    ("EmitterClass", "light samples"),
    ("Encounter", "a surface interaction"),
    ("Leaves", "a sampling policy"),
    ("LensRay", "a camera ray"),
    ("LitPoint", "a BSDF"),
    ("Look", "a gather or a view ray"),
    ("Meeting", "a surface interaction"),
    ("Met", "an intersection"),
    ("Misfit", "a fit residual"),
    ("Onward", "a bounce type"),
    ("Outlook", "visible portals"),
    ("Pooled", "a pooled variance"),
    ("Relay", "a virtual source"),
    ("Relayer", "a mirror or a prism"),
    ("Segment", "a path vertex or a path state"),
    ("SetAside", "a suspended path"),
    ("StraightPeak", "straight-through transmission"),
    ("Thrift", "a sampling policy"),
    ("ThroughLobe", "a transmission lobe"),
    ("ToldRay", "a ray of a ray tree"),
    ("Tracer", "an integrator"),
    ("Undrawn", "a lobe below the specular threshold"),
    ("bend", "an interpolation error or a curvature"),
    ("bent", "refracted, or an interpolation error"),
    ("bright_places", "guiding samples"),
    ("encounter", "a surface interaction"),
    ("evenness", "a sample allocation"),
    ("favour", "a pdf ratio"),
    ("glance", "a gather ray"),
    ("look", "a gather or a view ray"),
    ("look_around", "to gather"),
    ("look_out", "to gather"),
    ("looks", "gathers or view rays"),
    ("misfit", "a fit residual"),
    ("outlook", "visible portals"),
    ("prism_path", "manifold next-event estimation"),
    ("promise", "an importance"),
    ("promises", "importances"),
    ("recognise", "material specialisation"),
    ("relay", "a virtual source"),
    ("relays", "virtual sources"),
    ("respond", "to evaluate a BSDF"),
    ("survey", "an irradiance-cache pre-pass"),
    ("surveys", "irradiance-cache pre-passes"),
    ("thrift", "a sampling policy"),
];

/// A word, the files that use it in its ordinary meaning, and that meaning.
const EXCEPTIONS: &[(&str, &str, &str)] = &[
    ("Leaves", "crates/accel/src/", "the leaves of a hierarchy"),
    ("Segment", "crates/camera/src/lobe_pattern.rs", "a segment of a table"),
    ("relays", "crates/options/src/tables/rendering.rs", "Radiance's own text for -dr in -defaults"),
    ("looks", "src/trust/outputs.rs", "a message: a name looks like an option"),
    ("looks", "tests/hostile/trust_outputs.rs", "that message"),
    ("look", "crates/camera/tests/camera_file.rs", "an assertion: to look for a value"),
];

/// The words of names and string literals of a file; comments are omitted.
fn words(text: &str) -> BTreeSet<&str> {
    lines_without_comments(text).flat_map(|line| line.split(|c: char| !(c.is_alphanumeric() || c == '_'))).collect()
}

#[test]
fn names_and_messages_use_the_fields_words() {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = ["bindings", "crates", "fuzz", "plugins", "src", "tests", "xtask"];
    let files: Vec<_> = folders.iter().flat_map(|folder| rust_files(&repository.join(folder))).collect();
    let mut wrong = Vec::new();
    let mut used = vec![false; EXCEPTIONS.len()];
    for path in &files {
        let name = path.strip_prefix(repository).expect("it is inside").to_string_lossy().replace('\\', "/");
        if name == "tests/repository/words.rs" {
            continue;
        }
        let text = fs::read_to_string(path).expect("the file is read");
        let found = words(&text);
        for (word, instead) in WORDS.iter().filter(|(word, _)| found.contains(word)) {
            match EXCEPTIONS.iter().position(|(except, files, _)| except == word && name.starts_with(files)) {
                Some(index) => used[index] = true,
                None => wrong.push(format!("{name}: \"{word}\", expected a name for {instead}")),
            }
        }
    }
    let unused = EXCEPTIONS.iter().zip(used).filter(|(_, used)| !used);
    wrong.extend(unused.map(|((word, files, _), _)| format!("{files}: the exception for \"{word}\" is not needed")));
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn comments_have_no_part_in_names_and_messages() {
    let text = "let look = \"a survey\"; // promise\n/// relay\nfn on_look() {}";
    assert!(["look", "survey", "on_look"].iter().all(|word| words(text).contains(word)));
    assert!(["promise", "relay"].iter().all(|word| !words(text).contains(word)));
}
