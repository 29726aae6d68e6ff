//! Compares the built-in font with the one of Radiance's older library, if there is a copy.

use radsight_formats::{Font, Glyph, library};
use std::path::PathBuf;

fn ours() -> Font {
    Font::read(library::file("helvet.fnt").unwrap().as_bytes()).unwrap()
}

/// Twice the area inside an outline; seams contribute zero.
fn doubled_area(glyph: &Glyph) -> i64 {
    let vertices: Vec<(i64, i64)> = glyph.vertices.iter().map(|&(x, y)| (i64::from(x), i64::from(y))).collect();
    let next = vertices.iter().cycle().skip(1);
    vertices.iter().zip(next).map(|(a, b)| a.0 * b.1 - b.0 * a.1).sum()
}

/// Smallest and largest x and y.
fn extent(glyph: &Glyph) -> Option<[u8; 4]> {
    let (x, y): (Vec<u8>, Vec<u8>) = glyph.vertices.iter().copied().unzip();
    Some([*x.iter().min()?, *x.iter().max()?, *y.iter().min()?, *y.iter().max()?])
}

#[test]
fn every_letter_and_digit_is_drawn() {
    for code in (b'0'..=b'9').chain(b'A'..=b'Z').chain(b'a'..=b'z') {
        let font = ours();
        let glyph = font.glyphs[usize::from(code)].as_ref().unwrap();
        let [left, right, bottom, top] = extent(glyph).unwrap();
        let filled = doubled_area(glyph) as f64 / 2.0;
        let whole = f64::from(right - left) * f64::from(top - bottom);
        let share = filled / whole;
        assert!((0.2..=1.0).contains(&share), "{} is filled to {share}", char::from(code));
    }
}

#[test]
fn lines_of_text_are_as_long_as_in_radiance() {
    let Some(folder) = std::env::var_os("RADSIGHT_SHARED").map(PathBuf::from) else {
        println!("skipped: RADSIGHT_SHARED is not set");
        return;
    };
    let places = ["radiance/loose/fnt/helvet.fnt", "loose/fnt/helvet.fnt"];
    let Some(bytes) = places.iter().find_map(|place| std::fs::read(folder.join(place)).ok()) else {
        println!("skipped: there is no helvet.fnt");
        return;
    };
    let (ours, theirs) = (ours(), Font::read(&bytes).unwrap());
    for code in 0..256 {
        let [a, b] = [&ours, &theirs].map(|font| font.glyphs[code].as_ref().map(extent));
        assert_eq!(a, b, "character {code}");
    }
}
