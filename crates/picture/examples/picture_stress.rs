//! Mutates files of every format for some seconds and reads them in every way. Panics if a reader
//! does, and prints the number of files and the peak memory. The third argument names a copy of the
//! slowest file. `cargo run --release --all-features --example picture_stress -- SECONDS SEED
//! [FILE]`

#[path = "../tests/mutation/mod.rs"]
mod mutation;

use std::time::{Duration, Instant};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let mut number = |usual: u64| arguments.next().and_then(|word| word.parse().ok()).unwrap_or(usual);
    let (seconds, seed) = (number(60), number(1));
    let kept = std::env::args().nth(3);
    let (seeds, mut random) = (mutation::seeds(), mutation::Random(seed.max(1)));
    let (start, mut files, mut slowest) = (Instant::now(), 0u64, Duration::ZERO);
    while start.elapsed() < Duration::from_secs(seconds) {
        let mut bytes = seeds[random.below(seeds.len())].clone();
        mutation::spoil(&mut bytes, &mut random);
        let before = Instant::now();
        mutation::read_all_ways(&bytes);
        if before.elapsed() > slowest {
            slowest = before.elapsed();
            let format = radsight_picture::FileFormat::from_content(&bytes);
            println!("file {files}: {slowest:?} for {} bytes of {format:?}", bytes.len());
            if let Some(path) = &kept {
                std::fs::write(path, &bytes).expect("cannot save the slowest file");
            }
        }
        files += 1;
    }
    let memory = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = memory.lines().find(|line| line.starts_with("VmHWM")).unwrap_or("peak memory unknown");
    println!("{files} files, none panicked; slowest {slowest:?}; {peak}");
}
