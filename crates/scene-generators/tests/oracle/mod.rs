//! Runs the real Radiance programs and compares their output with ours.
#![allow(dead_code, unreachable_pub)]

use std::collections::HashMap;
use std::io::{Read, Write};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use radsight_loader::{FileKind, LoadError, Loaded, Loader};
use radsight_scene_generators::{Error, Output, run};

/// The location of the real programs.
pub struct Radiance {
    bin: Option<PathBuf>,
    library: Option<PathBuf>,
}

/// The outcome of a real program.
pub struct RealOutput {
    pub standard_output: String,
    pub standard_error: String,
    pub succeeded: bool,
}

impl Radiance {
    /// `None`, with a note, if real Radiance is not installed.
    pub fn find() -> Option<Radiance> {
        let real = radsight_test_support::Radiance::find()?;
        Some(Radiance { bin: real.programs(), library: real.library() })
    }

    pub fn library(&self) -> Option<&Path> {
        self.library.as_deref()
    }

    pub fn run(&self, argv: &[String], standard_input: &[u8], directory: Option<&Path>) -> RealOutput {
        let program = self.bin.as_ref().map_or(PathBuf::from(&argv[0]), |bin| bin.join(&argv[0]));
        let mut command = Command::new(program);
        command.arg0(&argv[0]).args(&argv[1..]).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        if let Some(library) = &self.library {
            command.env("RAYPATH", format!(".:{}", library.display()));
        }
        // mgf2rad runs ies2rad.
        if let Some(bin) = &self.bin {
            let path = std::env::var_os("PATH").unwrap_or_default();
            let folders = std::iter::once(bin.clone()).chain(std::env::split_paths(&path));
            command.env("PATH", std::env::join_paths(folders).expect("a search path"));
        }
        if let Some(directory) = directory {
            command.current_dir(directory);
        }
        let mut child = command.spawn().expect("the real program starts");
        let mut pipe = child.stdin.take().expect("a pipe");
        let bytes = standard_input.to_vec();
        let writer = std::thread::spawn(move || drop(pipe.write_all(&bytes)));
        let mut errors = child.stderr.take().expect("a pipe");
        let listener = std::thread::spawn(move || {
            let mut text = Vec::new();
            errors.read_to_end(&mut text).map(|_| text).unwrap_or_default()
        });
        // Some inputs make the real program write forever.
        let mut output = Vec::new();
        let limited = child.stdout.take().expect("a pipe").take(LONGEST_OUTPUT).read_to_end(&mut output);
        limited.expect("the real program's output");
        let is_endless = output.len() as u64 == LONGEST_OUTPUT;
        if is_endless {
            child.kill().expect("the real program can be stopped");
        }
        let status = child.wait().expect("the real program ends");
        writer.join().expect("the writer ends");
        RealOutput {
            standard_output: String::from_utf8_lossy(&output).into_owned(),
            standard_error: String::from_utf8_lossy(&listener.join().expect("the listener ends")).into_owned(),
            succeeded: status.success() && !is_endless,
        }
    }
}

/// Real output is truncated at this size.
const LONGEST_OUTPUT: u64 = 1 << 24;

/// Files in memory, then real folders.
#[derive(Default)]
pub struct TestLoader {
    pub files: HashMap<String, Vec<u8>>,
    pub folders: Vec<PathBuf>,
}

impl Loader for TestLoader {
    fn load(&self, name: &str, kind: FileKind) -> Result<Loaded, LoadError> {
        if let Some(bytes) = self.files.get(name) {
            return Ok(Loaded { path: name.to_owned(), bytes: bytes.clone() });
        }
        for folder in &self.folders {
            let path = folder.join(name);
            if let Ok(bytes) = std::fs::read(&path) {
                return Ok(Loaded { path: path.display().to_string(), bytes });
            }
        }
        Err(LoadError::NotFound { name: name.to_owned(), kind: kind.words(), searched: String::new() })
    }
}

pub fn words(line: &str) -> Vec<String> {
    line.split_whitespace().map(str::to_owned).collect()
}

pub fn ours(argv: &[String], standard_input: &[u8], loader: &dyn Loader) -> Result<Output, Error> {
    run(argv, &standard_input, loader)
}

/// The similarity of two outputs.
#[derive(Debug, PartialEq, Eq)]
pub enum Likeness {
    Identical,
    /// The same words, and numbers that differ only in the last printed digits.
    Rounded,
    Different(String),
}

/// Compares word by word.
pub fn compare(ours: &str, real: &str) -> Likeness {
    if ours == real {
        return Likeness::Identical;
    }
    let (mut left, mut right) = (ours.split_whitespace(), real.split_whitespace());
    let mut place = 0;
    loop {
        place += 1;
        match (left.next(), right.next()) {
            (None, None) => return Likeness::Rounded,
            (Some(a), Some(b)) if a == b || close(a, b) => {}
            (a, b) => return Likeness::Different(format!("word {place}: ours {a:?}, real {b:?}")),
        }
    }
}

fn close(a: &str, b: &str) -> bool {
    let (Ok(left), Ok(right)) = (a.parse::<f64>(), b.parse::<f64>()) else { return false };
    let largest = left.abs().max(right.abs());
    let unit = last_digit(a).min(last_digit(b));
    let tolerance = if unit <= (0.01 * largest).max(1e-6) { 1.01 * unit } else { 0.0 };
    (left - right).abs() <= tolerance.max(1e-10 * largest.max(1e-2))
}

/// The value of one unit in the last printed digit; infinite for an integer.
fn last_digit(text: &str) -> f64 {
    let (mantissa, exponent) = text.split_once('e').unwrap_or((text, "0"));
    match mantissa.split_once('.') {
        Some((_, decimals)) => 10f64.powi(exponent.parse::<i32>().unwrap_or(0) - decimals.len() as i32),
        None => f64::INFINITY,
    }
}

/// Runs both and panics unless the outputs agree; returns whether they are identical.
pub fn expect_same(radiance: &Radiance, argv: &[String], standard_input: &[u8], loader: &TestLoader) -> bool {
    let real = radiance.run(argv, standard_input, loader.folders.first().map(PathBuf::as_path));
    let mine = ours(argv, standard_input, loader);
    let mine = match mine {
        Ok(output) => String::from_utf8(output.standard_output).expect("text"),
        Err(error) => panic!("{argv:?}: ours fails with {error}; real says {}", real.standard_error),
    };
    match compare(&mine, &real.standard_output) {
        Likeness::Identical => true,
        // The real program lost the numbers, so there is nothing to compare.
        _ if real.standard_output.split_whitespace().any(|word| word.ends_with("nan")) => false,
        Likeness::Rounded => false,
        Likeness::Different(what) => {
            panic!(
                "{argv:?}: {what}\n--- ours\n{mine:.3000}\n--- real\n{:.3000}\n{}",
                real.standard_output, real.standard_error
            )
        }
    }
}

/// Compares the words outside interpolation functions, and the values of those functions at the
/// corners of their faces.
///
/// A symmetric face has two longest axes, and the last bit selects the projection axis; so the
/// functions' coefficients may differ where their values do not.
pub fn expect_same_smoothing(radiance: &Radiance, argv: &[String], standard_input: &[u8], loader: &TestLoader) {
    let real = smoothing(&radiance.run(argv, standard_input, None).standard_output);
    let mine = ours(argv, standard_input, loader).expect("ours runs");
    let mine = smoothing(&String::from_utf8(mine.standard_output).expect("text"));
    let likeness = compare(&mine.0.join(" "), &real.0.join(" "));
    assert!(!matches!(likeness, Likeness::Different(_)), "{argv:?}: {likeness:?}");
    assert_eq!(mine.1.len(), real.1.len(), "{argv:?}");
    for (a, b) in mine.1.iter().zip(&real.1) {
        assert!((a - b).abs() < 2e-6 * a.abs().max(1.0), "{argv:?}: {a} {b}");
    }
}

/// The words outside the arguments of `tmesh.cal` and `surf.cal`, and the interpolated vectors at
/// the corners after each.
fn smoothing(text: &str) -> (Vec<String>, Vec<f64>) {
    let (mut others, mut vectors) = (Vec::new(), Vec::new());
    let mut function: Option<(usize, Vec<f64>)> = None;
    let mut words = text.split_whitespace();
    while let Some(word) = words.next() {
        others.push(word.to_owned());
        let numbers = |count: usize, words: &mut dyn Iterator<Item = &str>| -> Vec<f64> {
            words.take(count).map(|word| word.parse().expect("a number")).collect()
        };
        match (word, &function) {
            ("10" | "13", None) => {
                let axis: usize = words.next().and_then(|word| word.parse().ok()).expect("an axis");
                function = Some((axis, numbers(word.parse::<usize>().expect("a count") - 1, &mut words)));
            }
            ("9" | "12", Some((axis, coefficients))) => {
                let corners = numbers(word.parse().expect("a count"), &mut words);
                for corner in corners.chunks(3) {
                    let (u, v) = (corner[(axis + 1) % 3], corner[(axis + 2) % 3]);
                    vectors.extend((0..3).map(|i| match coefficients.len() {
                        9 => coefficients[3 * i] * u + coefficients[3 * i + 1] * v + coefficients[3 * i + 2],
                        _ => {
                            let k = |row: usize| coefficients[3 * row + i];
                            k(0) * u * v + k(1) * u + k(2) * v + k(3)
                        }
                    }));
                }
                others.extend(corners.iter().map(|number| format!("{number:.9}")));
                function = None;
            }
            _ => {}
        }
    }
    (others, vectors)
}

/// A small generator of reproducible numbers.
pub struct Numbers(pub u64);

impl Numbers {
    pub fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 16
    }

    pub fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit as u64) as usize
    }

    pub fn chance(&mut self, of: usize) -> bool {
        self.below(of) == 0
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() & 0xFFFF_FFFF) as f64 / 4_294_967_296.0
    }

    /// A number with few or many digits, as text.
    pub fn text(&mut self, low: f64, high: f64) -> String {
        let value = self.between(low, high);
        match self.below(4) {
            0 => format!("{value:.0}"),
            1 => format!("{value:.2}"),
            2 => format!("{value:.5e}"),
            _ => format!("{value:.9}"),
        }
    }
}
