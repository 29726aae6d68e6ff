//! Streams of rays, as `rtrace` reads them: text, and numbers of single and of double precision.
#![no_main]
#![allow(dead_code)]

#[path = "../../src/failure.rs"]
mod failure;
#[path = "../../src/output.rs"]
mod output;
#[path = "../../src/ray_input.rs"]
mod ray_input;

use radsight_pinhole::stream::NumberFormat;
use ray_input::RayReader;
use std::io::Read;

/// Gives a stream in pieces of a few bytes, as a slow pipe does.
struct Pieces<'b>(&'b [u8]);

impl Read for Pieces<'_> {
    fn read(&mut self, to: &mut [u8]) -> std::io::Result<usize> {
        let most = 1 + self.0.len() % 7;
        self.0.take(most as u64).read(to).inspect(|read| self.0 = &self.0[*read..])
    }
}

/// The rays of a stream, and whether it ended in a mistake.
fn rays(input: impl Read, format: NumberFormat, most: usize) -> (Vec<String>, bool) {
    let mut reader = RayReader::new("rtrace", input, format);
    let (mut all, mut some) = (Vec::new(), Vec::new());
    loop {
        let is_wrong = reader.read(most, &mut some).is_err();
        for ray in &some {
            assert!(ray.origin.is_finite() && ray.ray.is_none_or(|ray| (ray.direction.length() - 1.0).abs() < 1e-9));
        }
        all.extend(some.iter().map(|ray| format!("{ray:?}")));
        if is_wrong || some.is_empty() {
            return (all, is_wrong);
        }
    }
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    for format in [NumberFormat::Ascii, NumberFormat::Float, NumberFormat::Double] {
        assert_eq!(rays(bytes, format, 100), rays(Pieces(bytes), format, 1));
    }
});
