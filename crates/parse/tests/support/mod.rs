//! Real Radiance and published scenes, for comparison tests.
#![allow(dead_code, reason = "each test file uses a part")]

use radsight_loader::{FileKind, LoadError, Loaded, Loader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Real Radiance, whose programs also search the folder `lib` of a scene.
pub(crate) struct Radiance(radsight_test_support::Radiance);

impl Radiance {
    /// `None`, with a note, if real Radiance is not installed.
    pub(crate) fn find() -> Option<Radiance> {
        radsight_test_support::Radiance::find().map(Radiance)
    }

    pub(crate) fn command(&self, program: &str) -> Command {
        // Programs print their own name, so it is looked up on the path instead of given as a full
        // path.
        let mut command = Command::new(program);
        command.env("PATH", self.0.path());
        if let Some(library) = self.library() {
            command.env("RAYPATH", format!(".:lib:{}", library.display()));
        }
        command
    }

    /// Runs a program in a folder; returns its standard output and whether it succeeded.
    pub(crate) fn run(&self, program: &str, arguments: &[&str], folder: &Path) -> (Vec<u8>, bool) {
        let output = self.command(program).args(arguments).current_dir(folder).stdin(Stdio::null()).output().unwrap();
        (output.stdout, output.status.success())
    }

    /// The library folder of real Radiance, if known.
    pub(crate) fn library(&self) -> Option<PathBuf> {
        self.0.library()
    }
}

/// The folder with published scenes, if there is one: `RADSIGHT_SHARED`, or `radiance` in it.
pub(crate) fn shared() -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("RADSIGHT_SHARED").map(PathBuf::from) else {
        eprintln!("skipped: RADSIGHT_SHARED is not set");
        return None;
    };
    let below = folder.join("radiance");
    Some(if below.is_dir() { below } else { folder })
}

/// Files on the disk, searched for in a folder, its `lib`, and the library.
pub(crate) struct Disk {
    pub(crate) folder: PathBuf,
    pub(crate) library: Option<PathBuf>,
}

impl Loader for Disk {
    fn load(&self, name: &str, kind: FileKind) -> Result<Loaded, LoadError> {
        let places = [Some(self.folder.clone()), Some(self.folder.join("lib")), self.library.clone()];
        for place in places.into_iter().flatten() {
            if let Ok(bytes) = std::fs::read(place.join(name)) {
                let path = if place == self.folder { name.to_owned() } else { place.join(name).display().to_string() };
                return Ok(Loaded { path, bytes });
            }
        }
        Err(LoadError::NotFound { name: name.to_owned(), kind: kind.words(), searched: String::new() })
    }
}

/// All files below a folder, sorted.
pub(crate) fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() { folders.push(path) } else { found.push(path) }
        }
    }
    found.sort();
    found
}

/// The first difference between two texts, word by word; numbers may differ by rounding.
pub(crate) fn difference(ours: &[u8], theirs: &[u8], tolerance: f64) -> Option<String> {
    let [ours, theirs] = [ours, theirs].map(|text| String::from_utf8_lossy(text).into_owned());
    let line = |text: &str, number: usize| text.lines().nth(number).unwrap_or("(end)").to_owned();
    let [lines, expected] = [&ours, &theirs].map(|text| text.lines().count());
    for number in 0..lines.max(expected) {
        let (a, b) = (line(&ours, number), line(&theirs, number));
        if a != b && !equal_words(&a, &b, tolerance) {
            return Some(format!("line {}:\n  ours:   {a}\n  theirs: {b}", number + 1));
        }
        if number > 20_000 {
            break;
        }
    }
    None
}

fn equal_words(a: &str, b: &str, tolerance: f64) -> bool {
    let (a, b): (Vec<_>, Vec<_>) = (a.split_whitespace().collect(), b.split_whitespace().collect());
    let scale = a.iter().chain(&b).filter_map(|word| word.parse::<f64>().ok()).fold(1.0, |m: f64, v| m.max(v.abs()));
    a.len() == b.len()
        && a.iter().zip(&b).all(|(a, b)| match (a.parse::<f64>(), b.parse::<f64>()) {
            (Ok(a), Ok(b)) => (a - b).abs() <= tolerance * scale,
            _ => a == b,
        })
}
