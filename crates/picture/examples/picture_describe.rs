//! Prints the format, the size, and the least, mean and greatest value of each file. `cargo run
//! --release --example picture_describe -- FILE…`

use radsight_picture::{Header, ViewOptions, read_image};

fn main() {
    let mut failed = false;
    for path in std::env::args().skip(1) {
        match std::fs::read(&path).map_err(|error| error.to_string()).and_then(|bytes| describe(&bytes)) {
            Ok(words) => println!("{path}: {words}"),
            Err(error) => {
                eprintln!("{path}: {error}");
                failed = true;
            }
        }
    }
    std::process::exit(i32::from(failed));
}

fn describe(bytes: &[u8]) -> Result<String, String> {
    let read = read_image(bytes).map_err(|error| error.to_string())?;
    let image = &read.image;
    let data = image.data();
    let mean = data.iter().map(|value| f64::from(*value)).sum::<f64>() / data.len() as f64;
    let (least, greatest) =
        data.iter().fold((f32::MAX, f32::MIN), |(least, greatest), value| (least.min(*value), greatest.max(*value)));
    let header = read.header.unwrap_or_else(Header::default);
    let view = ViewOptions::from_header(&header).map_err(|error| error.to_string())?;
    let view = view.map_or_else(String::new, |view| format!(", view{}", view.to_minimal_string()));
    Ok(format!(
        "{:?}, {} x {} x {}, least {least:e}, mean {mean:e}, greatest {greatest:e}{view}",
        read.format,
        image.width(),
        image.height(),
        image.components()
    ))
}
