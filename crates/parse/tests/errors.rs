//! Compares whole messages of `tests/errors/*.rad` with the files beside them. `RADSIGHT_BLESS=1`
//! rewrites these.

use radsight_loader::MemoryLoader;
use radsight_parse::{Input, ReadOptions, Tolerance, read_scene};
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/errors")
}

#[test]
fn every_message_is_unchanged() {
    let mut loader = MemoryLoader::default();
    let mut scenes = Vec::new();
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    for file in files {
        let name = file.file_name().unwrap().to_str().unwrap().to_owned();
        loader = loader.with(&name, std::fs::read(&file).unwrap());
        scenes.extend(file.extension().is_some_and(|extension| extension == "rad").then_some(name));
    }
    let mut changed = Vec::new();
    for name in scenes {
        let options = ReadOptions { tolerance: Tolerance::Strict, ..ReadOptions::default() };
        let read = read_scene(&[Input::File(name.clone())], &loader, &options);
        let text = read.render(100);
        let path = folder().join(&name).with_extension("expected");
        if std::env::var_os("RADSIGHT_BLESS").is_some() {
            std::fs::write(&path, &text).unwrap();
        } else if std::fs::read_to_string(&path).unwrap_or_default() != text {
            changed.push(format!("== {name}\n{text}"));
        }
    }
    assert!(changed.is_empty(), "messages changed:\n{}", changed.join("\n"));
}

#[test]
fn only_so_many_messages_are_printed() {
    let text = "nosuch sphere s 0 0 4 0 0 0 1\n".repeat(5000);
    let input = Input::Text { name: "many.rad".to_owned(), text: text.into_bytes().into() };
    let read = read_scene(&[input], &MemoryLoader::default(), &ReadOptions::default());
    let printed = read.render(20);
    assert_eq!(printed.matches("error: ").count(), 20);
    assert!(printed.ends_with("and 4980 more\n"), "{}", printed.lines().last().unwrap());
}

#[test]
fn what_real_radiance_reads_past_is_a_warning_unless_asked() {
    let text = "!xform nosuch.rad\nvoid plastic red 0 0 4 1 1 1 0\nred sphere s 0 0 4 0 0 0 1\n";
    let input = [Input::Text { name: "scene.rad".to_owned(), text: text.as_bytes().into() }];
    let read = read_scene(&input, &MemoryLoader::default(), &ReadOptions::default());
    assert!(!read.has_errors(), "{}", read.render(9));
    assert_eq!(read.diagnostics.len(), 2);
    let radsight_ir::ModifierKind::Material(radsight_ir::Material::Unusable { reason }) =
        &read.scene.modifiers.items()[0].kind
    else {
        panic!("{:?}", read.scene.modifiers)
    };
    assert_eq!(reason, "plastic \"red\" has 4 real arguments, expected 5");
    let strict = ReadOptions { tolerance: Tolerance::Strict, ..ReadOptions::default() };
    assert!(read_scene(&input, &MemoryLoader::default(), &strict).has_errors());
}

/// Real programs warn too; `genworm` makes such spheres where its radius is zero.
#[test]
fn surfaces_without_an_extent_are_left_out_with_a_warning() {
    for (surface, reason) in [
        ("sphere s 0 0 4 0 0 0 0", "has a radius of zero"),
        ("sphere s 0 0 4 0 0 0 1e-6", "has a radius of zero"),
        ("bubble s 0 0 4 0 0 0 -1e-7", "has a radius of zero"),
        ("cylinder s 0 0 7 0 0 0 1 0 0 0", "has radii that are zero or of opposite signs"),
        ("cone s 0 0 8 0 0 0 1 0 0 1 -1", "has radii that are zero or of opposite signs"),
        ("tube s 0 0 7 0 0 0 0 0 0 1", "has no length"),
        ("ring s 0 0 8 0 0 0 0 0 1 1 1", "has radii that enclose no area"),
        ("ring s 0 0 8 0 0 0 0 0 0 0 1", "has no direction"),
    ] {
        let text = format!("void plastic red 0 0 5 1 1 1 0 0\nred {surface}\nred sphere rest 0 0 4 0 0 0 1\n");
        let input = [Input::Text { name: "scene.rad".to_owned(), text: text.into_bytes().into() }];
        let read = read_scene(&input, &MemoryLoader::default(), &ReadOptions::default());
        assert!(!read.has_errors(), "{surface}: {}", read.render(9));
        let message = &read.diagnostics[0].message;
        assert!(message.ends_with(&format!("\"s\" {reason}; it is left out")), "{surface}: {message}");
        assert_eq!(read.scene.surfaces.len(), 1, "{surface}");
    }
}
