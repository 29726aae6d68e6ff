//! Reads scene files and reports their surfaces, modifiers and reading time: `parse_read FILE…`.
//!
//! `parse_read --million` generates a million triangles in memory and reads those first.

use radsight_loader::{FileKind, LoadError, Loaded, Loader};
use radsight_parse::{Input, ReadOptions, UnusedModifiers, bounds, read_scene};
use std::fmt::Write;
use std::time::Instant;

struct Disk;

impl Loader for Disk {
    fn load(&self, name: &str, kind: FileKind) -> Result<Loaded, LoadError> {
        let library = std::env::var("RAYPATH").unwrap_or_else(|_| ".".to_owned());
        for folder in library.split(':') {
            let path =
                if name.starts_with('/') || folder == "." { name.to_owned() } else { format!("{folder}/{name}") };
            if let Ok(bytes) = std::fs::read(&path) {
                return Ok(Loaded { path, bytes });
            }
        }
        Err(LoadError::NotFound { name: name.to_owned(), kind: kind.words(), searched: format!(" in {library}") })
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let inputs: Vec<Input> = if arguments == ["--million"] {
        vec![Input::Text { name: "million.rad".to_owned(), text: million_triangles().into_bytes().into() }]
    } else {
        arguments.iter().map(|name| Input::File(name.clone())).collect()
    };
    let options = ReadOptions { unused: UnusedModifiers::Lower, ..ReadOptions::default() };
    let start = Instant::now();
    let read = read_scene(&inputs, &Disk, &options);
    let seconds = start.elapsed().as_secs_f64();
    print!("{}", read.render(20));
    println!("{} surfaces, {} modifiers in {seconds:.3} s", read.scene.surfaces.len(), read.scene.modifiers.len());
    if let Some(bounds) = bounds(&read.scene) {
        println!("{} to {}", bounds.low, bounds.high);
    }
    if let Ok(status) = std::fs::read_to_string("/proc/self/status") {
        let peak = status.lines().find(|line| line.starts_with("VmHWM"));
        println!("peak memory {}", peak.unwrap_or_default().trim_start_matches("VmHWM:").trim());
    }
}

fn million_triangles() -> String {
    let mut text = String::from("void plastic grey 0 0 5 .5 .5 .5 0 0\n");
    for index in 0..1_000_000_u32 {
        let (x, y) = (f64::from(index % 1000) / 7.0, f64::from(index / 1000) / 11.0);
        let _ = writeln!(
            text,
            "\ngrey polygon t.{index}\n0\n0\n9\n\t{x:18.12}\t{y:18.12}\t{:18.12}\n\t{:18.12}\t{y:18.12}\t{:18.12}\n\t{x:18.12}\t{:18.12}\t{:18.12}",
            x.sin(),
            x + 0.1,
            y.cos(),
            y + 0.1,
            (x * y).sin(),
        );
    }
    text
}
