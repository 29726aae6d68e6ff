//! Measures the speed of reading and writing a picture of 3840 x 2160 pixels, in megabytes of
//! decoded bytes per second. `cargo run --release --example picture_speed [picture]`

use radsight_picture::{Header, Image, Picture};
use std::time::Instant;

fn main() {
    let picture = match std::env::args().nth(1) {
        Some(path) => std::fs::read(&path)
            .map_err(|error| error.to_string())
            .and_then(|bytes| Picture::read(&bytes).map_err(|error| format!("{path}: {error}"))),
        None => Picture::from_rgb(Header::new("RADIANCE"), &noisy(3840, 2160)).map_err(|error| error.to_string()),
    };
    let picture = match picture {
        Ok(picture) => picture,
        Err(error) => {
            eprintln!("{error}");
            std::process::exit(1);
        }
    };
    let megabytes = picture.pixels().data().len() as f64 / 1e6;
    let bytes = picture.to_bytes();
    println!(
        "{} x {} pixels, {megabytes:.1} MB decoded, {:.1} MB in the file",
        picture.width(),
        picture.height(),
        bytes.len() as f64 / 1e6
    );
    time("copy of the decoded bytes", megabytes, || picture.pixels().data().to_vec());
    time("read (file to RGBE)", megabytes, || Picture::read(&bytes));
    time("values (RGBE to f32)", megabytes, || picture.values());
    time("from_rgb (f32 to RGBE)", megabytes, {
        let values = picture.values();
        move || Picture::from_rgb(Header::default(), &values)
    });
    time("write (RGBE to file)", megabytes, || picture.to_bytes());
}

fn time<T>(what: &str, megabytes: f64, mut work: impl FnMut() -> T) {
    let mut best = f64::INFINITY;
    for _ in 0..9 {
        let start = Instant::now();
        std::hint::black_box(work());
        best = best.min(start.elapsed().as_secs_f64());
    }
    println!("{what:28} {:8.1} ms {:8.0} MB/s", best * 1e3, megabytes / best);
}

/// A smooth sky above noise, similar to a rendered picture.
fn noisy(width: usize, height: usize) -> Image<f32> {
    let mut state = 1u32;
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32
    };
    let mut data = Vec::with_capacity(width * height * 3);
    for y in 0..height {
        for x in 0..width {
            let sky = 0.2 + (x / 64) as f32 * 0.01;
            let rough = if y < height / 3 { 0.0 } else { 0.5 * noise() };
            data.extend_from_slice(&[sky + rough, 0.9 * sky + rough, 0.5 * sky]);
        }
    }
    Image::new(width, height, 3, data).expect("three values for every pixel")
}
