//! Runs a scene command line with files from the working directory: `cargo run --example run --
//! "genbox m b 1 1 1"`.

use std::cell::OnceCell;
use std::io::{self, Write};

use radsight_loader::{FileKind, LoadError, Loaded, Loader};
use radsight_scene_generators::StandardInput;

struct Disk;

impl Loader for Disk {
    fn load(&self, name: &str, kind: FileKind) -> Result<Loaded, LoadError> {
        let search = std::env::var("RAYPATH").unwrap_or_else(|_| ".".to_owned());
        for folder in search.split(':') {
            let path = std::path::Path::new(folder).join(name);
            if let Ok(bytes) = std::fs::read(&path) {
                return Ok(Loaded { path: path.display().to_string(), bytes });
            }
        }
        Err(LoadError::NotFound { name: name.to_owned(), kind: kind.words(), searched: format!(" in {search}") })
    }
}

/// Standard input, read on demand.
struct Piped(OnceCell<String>);

impl StandardInput for Piped {
    fn bytes(&self) -> Result<&[u8], LoadError> {
        Ok(self.0.get_or_init(|| io::read_to_string(io::stdin()).expect("text")).as_bytes())
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let result = if let [line] = &words[..] {
        radsight_scene_generators::pipeline(line, &Disk, &|_, _| None)
            .map_err(|failed| format!("{:?}: {failed}", failed.range))
    } else {
        let input = Piped(OnceCell::new());
        radsight_scene_generators::run(&words, &input, &Disk).map_err(|error| error.to_string())
    };
    match result {
        Ok(output) => {
            output.warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
            for (name, bytes) in &output.files {
                eprintln!("writes {name}, {} bytes", bytes.len());
            }
            io::stdout().write_all(&output.standard_output).expect("writable standard output");
        }
        Err(message) => {
            eprintln!("{message}");
            std::process::exit(1);
        }
    }
}
