//! Pictures as notebooks show them.

/// This share of the pixels is shown darker than white.
const SHOWN: f64 = 0.98;

/// Width of the bar of false colours, and of its numbers.
const BAR: usize = 12;
const NUMBERS: usize = 8 * GLYPH_STEP;

/// A letter of five columns and its gap.
const GLYPH_STEP: usize = 6;
const GLYPH_ROWS: usize = 7;

/// So many pixels are enough for a row of numbers.
const NUMBER_STEP: usize = 24;

/// Paper.
const WHITE: [u8; 3] = [255; 3];

/// Bytes of a PNG of 8 bits: radiances scaled so that few pixels are white, with a gamma of 2.2.
pub(crate) fn of_radiance(columns: usize, pixels: &[[f32; 3]]) -> Option<Vec<u8>> {
    let brightness = pixels.iter().map(|pixel| f64::from(pixel.iter().sum::<f32>() / 3.0)).collect();
    let white = quantile(brightness)?.max(f64::from(f32::MIN_POSITIVE)) as f32;
    let shown = |value: f32| (255.0 * (value / white).clamp(0.0, 1.0).powf(1.0 / 2.2) + 0.5) as u8;
    radsight::png_rgb8(columns, pixels.iter().flatten().map(|value| shown(*value)).collect())
}

/// Bytes of a PNG of values in false colour (viridis), from 0, with a scale of their unit on the right.
pub(crate) fn false_color(columns: usize, values: &[f64], unit: &str) -> Option<Vec<u8>> {
    let rows = values.len().checked_div(columns)?;
    let largest = quantile(values.to_vec())?.max(f64::from(f32::MIN_POSITIVE));
    // Small pictures are shown larger, so that the numbers have room.
    let zoom = 160_usize.div_ceil(columns.max(rows).max(1)).max(1);
    let (width, height) = (zoom * columns + 2 + BAR + 2 + NUMBERS, (zoom * rows).max(3 * NUMBER_STEP));
    let mut page = Page { width, bytes: vec![WHITE; width * height] };
    for row in 0..zoom * rows {
        for column in 0..zoom * columns {
            let value = values[row / zoom * columns + column / zoom];
            page.set(column, row, radsight::viridis(value / largest));
        }
    }
    let left = zoom * columns + 2;
    let (top, bottom) = (GLYPH_ROWS + 4, height - GLYPH_ROWS);
    for row in top..bottom {
        let share = (bottom - row) as f64 / (bottom - top) as f64;
        (left..left + BAR).for_each(|column| page.set(column, row, radsight::viridis(share)));
    }
    page.write(left, 0, unit);
    let numbers = ((bottom - top) / NUMBER_STEP).clamp(1, 8);
    for number in 0..=numbers {
        let share = number as f64 / numbers as f64;
        let row = bottom - ((bottom - top) as f64 * share) as usize;
        page.write(left + BAR + 2, row.saturating_sub(GLYPH_ROWS / 2), &format!("{:.2e}", share * largest));
    }
    radsight::png_rgb8(width, page.bytes.into_iter().flatten().collect())
}

/// The value below which most values are.
fn quantile(mut values: Vec<f64>) -> Option<f64> {
    values.retain(|value| value.is_finite());
    let place = (values.len().checked_sub(1)? as f64 * SHOWN) as usize;
    Some(*values.select_nth_unstable_by(place, f64::total_cmp).1)
}

struct Page {
    width: usize,
    bytes: Vec<[u8; 3]>,
}

impl Page {
    fn set(&mut self, column: usize, row: usize, color: [u8; 3]) {
        if let Some(pixel) = self.bytes.get_mut(row * self.width + column).filter(|_| column < self.width) {
            *pixel = color;
        }
    }

    fn write(&mut self, left: usize, top: usize, text: &str) {
        for (place, letter) in text.chars().enumerate() {
            for (row, bits) in glyph(letter).into_iter().enumerate() {
                for column in (0..5).filter(|column| bits >> (4 - column) & 1 == 1) {
                    self.set(left + GLYPH_STEP * place + column, top + row, [0; 3]);
                }
            }
        }
    }
}

/// Rows of five bits, from the top.
fn glyph(letter: char) -> [u8; GLYPH_ROWS] {
    match letter {
        '0' => [14, 17, 19, 21, 25, 17, 14],
        '1' => [4, 12, 4, 4, 4, 4, 14],
        '2' => [14, 17, 1, 2, 4, 8, 31],
        '3' => [31, 2, 4, 2, 1, 17, 14],
        '4' => [2, 6, 10, 18, 31, 2, 2],
        '5' => [31, 16, 30, 1, 1, 17, 14],
        '6' => [6, 8, 16, 30, 17, 17, 14],
        '7' => [31, 1, 2, 4, 8, 8, 8],
        '8' => [14, 17, 17, 14, 17, 17, 14],
        '9' => [14, 17, 17, 15, 1, 2, 12],
        '.' => [0, 0, 0, 0, 0, 12, 12],
        '-' => [0, 0, 0, 31, 0, 0, 0],
        '/' => [1, 1, 2, 4, 8, 16, 16],
        'e' => [0, 0, 14, 17, 31, 16, 14],
        'c' => [0, 0, 14, 16, 16, 17, 14],
        'd' => [1, 1, 13, 19, 17, 17, 15],
        'm' => [0, 0, 26, 21, 21, 17, 17],
        'J' => [7, 2, 2, 2, 2, 18, 12],
        _ => [0; GLYPH_ROWS],
    }
}
