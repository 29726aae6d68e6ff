//! Scenes that would exhaust time or memory without limits.

use proptest::prelude::*;
use radsight_diag::Severity;
use radsight_loader::MemoryLoader;
use radsight_parse::{Input, Read, ReadOptions, UnusedModifiers, read_scene};

fn read(loader: &MemoryLoader, text: &[u8], options: &ReadOptions) -> Read {
    read_scene(&[Input::Text { name: "scene.rad".to_owned(), text: text.into() }], loader, options)
}

fn first_error(loader: &MemoryLoader, text: &str) -> String {
    let read = read(loader, text.as_bytes(), &ReadOptions::default());
    read.diagnostics.first().map(|diagnostic| diagnostic.message.clone()).unwrap_or_default()
}

#[test]
fn files_that_all_include_each_other_come_to_an_end() {
    let mut loader = MemoryLoader::default();
    let all: String = (0..30).map(|file| format!("!xform f{file}\n!cat f{file}\n")).collect();
    for file in 0..30 {
        loader = loader.with(&format!("f{file}"), &all);
    }
    assert!(first_error(&loader, "!xform f0\n").ends_with("includes itself"));
}

#[test]
fn files_that_double_at_each_level_come_to_an_end() {
    let mut loader = MemoryLoader::default().with("f40", "void sphere s 0 0 4 0 0 0 1\n");
    for file in 0..40 {
        let next = file + 1;
        loader = loader.with(&format!("f{file}"), format!("!xform f{next}\n!xform -t 1 0 0 f{next}\n"));
    }
    let options = ReadOptions { most_surfaces: 10_000, ..ReadOptions::default() };
    let read = read(&loader, b"!xform f0\n", &options);
    assert_eq!(read.diagnostics[0].message, "the scene has more than 10000 surfaces");
    assert_eq!(read.scene.surfaces.len(), 10_000);
}

#[test]
fn deep_nesting_is_refused() {
    let mut loader = MemoryLoader::default();
    for file in 0..200 {
        loader = loader.with(&format!("f{file}"), format!("!cat f{}\n", file + 1));
    }
    let message = first_error(&loader, "!cat f0\n");
    assert_eq!(message, "files and commands include each other more than 64 deep");
}

#[test]
fn arrays_of_arrays_are_refused_before_they_are_made() {
    let loader = MemoryLoader::default().with("ball.rad", "void sphere s 0 0 4 0 0 0 1\n");
    let message = first_error(&loader, "!xform -a 1000000000 -t 1 0 0 ball.rad\n");
    assert_eq!(message, "xform: the array makes 1000000000 copies, expected at most 10000000");
}

/// Radiance has no such limits, so a scene without these surfaces would be another scene.
#[test]
fn commands_beyond_a_limit_are_errors() {
    let loader = MemoryLoader::default().with("ball.rad", "void sphere s 0 0 4 0 0 0 1\n");
    for command in ["!gensurf p s s t s*t 60000 60000\n", "!xform -a 1000000000 -t 1 0 0 ball.rad\n"] {
        let read = read(&loader, command.as_bytes(), &ReadOptions::default());
        assert_eq!(read.diagnostics[0].severity, Severity::Error, "{command}");
    }
}

#[test]
fn a_function_that_calls_itself_is_no_trouble() {
    let text = "void brightfunc f 2 f(1) bomb.cal 0 0\nf plastic p 0 0 5 1 1 1 0 0\np sphere s 0 0 4 0 0 0 1\n";
    let loader = MemoryLoader::default().with("bomb.cal", "f(x) = f(x+1);");
    let read = read(&loader, text.as_bytes(), &ReadOptions::default());
    assert_eq!(read.scene.surfaces.len(), 1);
}

#[test]
fn many_names_that_mean_nothing_take_no_time() {
    let mut text: String = (0..5000).map(|name| format!("void plastic name{name} 0 0 5 1 1 1 0 0\n")).collect();
    text.extend((0..5000).map(|name| format!("nema{name} sphere s 0 0 4 0 0 0 1\n")));
    let read = read(&MemoryLoader::default(), text.as_bytes(), &ReadOptions::default());
    assert_eq!(read.diagnostics.len() + read.omitted, 5000);
}

const SEEDS: &[&str] = &[
    include_str!("errors/arguments.rad"),
    include_str!("errors/names.rad"),
    include_str!("errors/shapes.rad"),
    include_str!("errors/commands.rad"),
    include_str!("errors/functions.rad"),
    include_str!("errors/replace.rad"),
    include_str!("errors/syntax.rad"),
];

fn loader() -> MemoryLoader {
    MemoryLoader::default()
        .with("ball.rad", include_str!("errors/ball.rad"))
        .with("table.txt", include_str!("errors/table.txt"))
        .with("plane.txt", include_str!("errors/plane.txt"))
        .with("bad.txt", include_str!("errors/bad.txt"))
}

proptest! {
    #[test]
    fn any_bytes_are_read_without_panic(text in proptest::collection::vec(any::<u8>(), 0..300)) {
        let options = ReadOptions { unused: UnusedModifiers::Lower, ..ReadOptions::default() };
        let read = read(&loader(), &text, &options);
        let _ = read.render(20);
    }

    #[test]
    fn damaged_scenes_are_read_without_panic(
        seed in 0..SEEDS.len(),
        edits in proptest::collection::vec((any::<prop::sample::Index>(), 0..4_u8, any::<prop::sample::Index>()), 1..12),
    ) {
        let mut text = SEEDS[seed].as_bytes().to_vec();
        for (place, edit, other) in edits {
            let (at, from) = (place.index(text.len()), other.index(text.len()));
            match edit {
                0 => { text.remove(at); }
                1 => text.insert(at, b"0 \"'\n-.e#!"[from % 10]),
                2 => text[at] = text[from],
                _ => { text.swap(at, from); }
            }
            if text.is_empty() { break; }
        }
        let options = ReadOptions { unused: UnusedModifiers::Lower, most_surfaces: 1000, ..ReadOptions::default() };
        let read = read(&loader(), &text, &options);
        let _ = read.render(20);
        let _ = radsight_parse::bounds(&read.scene);
        let _ = read.scene.validate();
    }
}
