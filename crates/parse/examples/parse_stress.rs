//! Mutates scene files at random and reads them: `parse_stress SECONDS SEED FILE…`.
//!
//! Stops when reading takes more than five seconds, and prints the mutated text. A panic leaves the
//! text in `parse_stress.crash` of the working directory.

use radsight_loader::MemoryLoader;
use radsight_parse::{Input, ReadOptions, UnusedModifiers, bounds, read_scene, write_scene};
use std::time::{Duration, Instant};

const SLOWEST: Duration = Duration::from_secs(5);
const LONGEST: usize = 60_000;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let mut number = |what: &str| -> u64 {
        let word = arguments.next().unwrap_or_default();
        word.parse().unwrap_or_else(|_| panic!("usage: parse_stress SECONDS SEED FILE…; {what} is \"{word}\""))
    };
    let (seconds, seed) = (number("SECONDS"), number("SEED"));
    let mut loader = MemoryLoader::default();
    let mut seeds = Vec::new();
    for name in arguments {
        let Ok(bytes) = std::fs::read(&name) else { continue };
        let short = name.rsplit('/').next().unwrap_or(&name).to_owned();
        loader = loader.with(&short, &bytes);
        if bytes.len() <= LONGEST {
            seeds.push(bytes);
        }
    }
    let mut random = Random(seed);
    let end = Instant::now() + Duration::from_secs(seconds);
    let mut count = 0_u64;
    while Instant::now() < end && !seeds.is_empty() {
        let text = damaged(&seeds, &mut random);
        let _ = std::fs::write("parse_stress.crash", &text);
        let start = Instant::now();
        read(&loader, &text);
        assert!(start.elapsed() < SLOWEST, "too slow: see parse_stress.crash");
        count += 1;
    }
    let _ = std::fs::remove_file("parse_stress.crash");
    println!("{count} texts, none of which panics or takes more than {} s", SLOWEST.as_secs());
}

fn read(loader: &MemoryLoader, text: &[u8]) {
    let options = ReadOptions { unused: UnusedModifiers::Lower, most_surfaces: 200_000, ..ReadOptions::default() };
    let input = Input::Text { name: "damaged.rad".to_owned(), text: text.into() };
    let read = read_scene(&[input], loader, &options);
    let _ = (read.render(20), bounds(&read.scene));
    let mut written = String::new();
    let _ = write_scene(&read.scene, &mut written);
    let _ = read.scene.validate();
}

fn damaged(seeds: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let mut text = seeds[random.below(seeds.len())].clone();
    for _ in 0..=random.below(6) {
        let at = random.below(text.len() + 1);
        match random.below(7) {
            0 if at < text.len() => text[at] = random.below(256) as u8,
            1 => text.insert(at, b"0123456789 \"'\n\r\\-.e#!|~"[random.below(23)]),
            2 if at < text.len() => drop(text.remove(at)),
            3 => text.truncate(at.max(1)),
            4 => {
                let other = &seeds[random.below(seeds.len())];
                let from = random.below(other.len() + 1);
                let to = (from + random.below(400)).min(other.len());
                text.splice(at..at, other[from..to].iter().copied());
            }
            5 => {
                let number = ["1000000000", "-1", "1e308", "4294967296", "0", "nan", "1e-320"][random.below(7)];
                text.splice(at..at, number.bytes());
            }
            _ => {
                let to = (at + random.below(200)).min(text.len());
                text.drain(at..to);
            }
        }
    }
    text
}

/// A linear congruential generator; the same seed gives the same texts.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % bound.max(1)
    }
}
