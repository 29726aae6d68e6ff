//! Measures the speed of filtering: `cargo run --release --example filter_speed`.

use radsight_picture::{Header, Image, Picture, PictureReader};
use radsight_picture_ops::filter::{FilterOptions, Kernel, Size, filter_one_pass};
use std::time::Instant;

fn main() {
    const WIDTH: usize = 6000;
    const HEIGHT: usize = 4000;
    let value = |index: usize| ((index.wrapping_mul(2_654_435_761) >> 7) % 1009) as f32 / 400.0;
    let values = Image::new(WIDTH, HEIGHT, 3, (0..WIDTH * HEIGHT * 3).map(value).collect()).expect("a shape");
    let bytes = Picture::from_rgb(Header::new("RADIANCE"), &values).expect("a picture").to_bytes();
    drop(values);
    let halved = FilterOptions { columns: Size::Scale(0.5), rows: Size::Scale(0.5), ..FilterOptions::default() };
    let soft = FilterOptions { kernel: Kernel::Gaussian { radius: 0.6 }, ..halved.clone() };
    for (name, options) in [("same size", FilterOptions::default()), ("box to half", halved), ("gauss to half", soft)] {
        let start = Instant::now();
        let reader = PictureReader::new(&bytes[..]).expect("a picture");
        let mut written = Vec::new();
        filter_one_pass(reader, &options, &["pfilt"], &mut written).expect("it is filtered");
        let seconds = start.elapsed().as_secs_f64();
        println!("{name}: {seconds:.2} s, {:.0} megapixels a second", (WIDTH * HEIGHT) as f64 / seconds / 1e6);
    }
}
