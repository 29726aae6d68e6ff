//! `psign`: a line of text as a picture.

use radsight_formats::{Font, Glyph};
use radsight_picture::encode_rgbe;

/// Subsamples of a pixel along each axis.
const SUBPIXELS: usize = 3;
/// Largest width and height of a sign, pixels.
const LARGEST: usize = 1 << 15;

/// The direction in which text runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextDirection {
    /// To the right.
    Right,
    /// Up.
    Up,
    /// To the left, upside down.
    Left,
    /// Down.
    Down,
}

/// The appearance of a sign.
#[derive(Clone, Debug, PartialEq)]
pub struct SignOptions {
    /// The colour around letters; white by default.
    pub background: [f32; 3],
    /// The colour of letters; black by default.
    pub foreground: [f32; 3],
    /// The direction of text; to the right by default.
    pub direction: TextDirection,
    /// Width in pixels; 0 to fit the text.
    pub columns: usize,
    /// Height in pixels; 0 to fit the text.
    pub rows: usize,
    /// Height of a character cell in pixels; 32 by default.
    pub height: usize,
    /// Height divided by width of a character cell; 0 to fill the given size; 1.67 by default.
    pub aspect: f64,
    /// Space between characters, in characters: above 0 in columns, below 0 squeezed, 0 (the
    /// default) in cells.
    pub spacing: f64,
}

impl Default for SignOptions {
    fn default() -> SignOptions {
        SignOptions {
            background: [1.0; 3],
            foreground: [0.0; 3],
            direction: TextDirection::Right,
            columns: 0,
            rows: 0,
            height: 32,
            aspect: 1.67,
            spacing: 0.0,
        }
    }
}

/// A sign: pixels as stored, four bytes each, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sign {
    /// Width in pixels.
    pub columns: usize,
    /// Height in pixels.
    pub rows: usize,
    /// The pixels.
    pub stored: Vec<u8>,
}

/// Draws lines of text, the first one at the top. `None` if there is nothing to draw, or it is too
/// large.
#[must_use]
pub fn sign(font: &Font, lines: &[&[u8]], options: &SignOptions) -> Option<Sign> {
    let spaced: Vec<(Vec<i64>, i64)> = lines.iter().map(|line| spaced(font, line, options.spacing)).collect();
    let width = spaced.iter().map(|(_, width)| *width).max()?;
    let layout = Layout::new(lines.len(), width, options)?;
    let mut bitmap = Bitmap::new(layout.columns, layout.rows);
    for (index, (line, (spaces, _))) in lines.iter().zip(&spaced).enumerate() {
        let bottom = 256 * (lines.len() - 1 - index) as i64;
        let mut left = 0;
        for (code, space) in line.iter().zip(spaces) {
            left += space;
            if let Some(glyph) = glyph(font, *code) {
                bitmap.draw(glyph, [left, bottom], &layout);
            }
        }
    }
    Some(bitmap.shaded(options))
}

fn glyph(font: &Font, code: u8) -> Option<&Glyph> {
    font.glyphs.get(usize::from(code))?.as_ref()
}

/// Left and right end of a glyph, which covers at least the centre of its cell.
fn ends(glyph: &Glyph) -> [i64; 2] {
    limits(glyph.vertices.iter().map(|(x, _)| i64::from(*x)))
}

fn limits(values: impl Iterator<Item = i64>) -> [i64; 2] {
    const MIDDLE: i64 = 128;
    values.fold([MIDDLE; 2], |[low, high], value| if value < low { [value, high] } else { [low, high.max(value)] })
}

/// Mean width of the glyphs of a font.
fn mean_width(font: &Font) -> i64 {
    let widths = font.glyphs.iter().flatten().filter_map(|glyph| {
        let [left, right] = ends(glyph);
        let [low, high] = limits(glyph.vertices.iter().map(|(_, y)| i64::from(*y)));
        (right > left && high > low).then_some(right - left)
    });
    let (sum, count) = widths.fold((0, 0), |(sum, count), width| (sum + width, count + 1));
    if count > 0 { sum / count } else { 0 }
}

/// Distance of each glyph from the previous one, in 256ths of a cell, with the end as the last; and
/// the width of the line.
fn spaced(font: &Font, line: &[u8], spacing: f64) -> (Vec<i64>, i64) {
    const NONE: f64 = 1.0 / 256.0;
    if spacing < -NONE {
        squeezed(font, line, (spacing * -256.0) as i64)
    } else if spacing > NONE {
        proportional(font, line, (spacing * 256.0) as i64)
    } else {
        let steps = line.iter().map(|code| if glyph(font, *code).is_some() { 255 } else { 0 });
        let spaces: Vec<i64> = std::iter::once(0).chain(steps).collect();
        let width = spaces.iter().sum();
        (spaces, width)
    }
}

/// Sets glyphs side by side.
fn squeezed(font: &Font, line: &[u8], between: i64) -> (Vec<i64>, i64) {
    let between = between / 2;
    let mean = mean_width(font);
    let mut spaces = vec![0; line.len() + 1];
    let mut width = 0;
    let glyphs: Vec<Option<&Glyph>> = line.iter().map(|code| glyph(font, *code)).collect();
    let first = glyphs.iter().position(Option::is_some).unwrap_or(line.len());
    spaces[first] = between;
    for (index, glyph) in glyphs.iter().enumerate().skip(first) {
        match glyph {
            Some(glyph) if !glyph.vertices.is_empty() => {
                let [left, right] = ends(glyph);
                spaces[index] += between - left;
                width += spaces[index];
                spaces[index + 1] = right + between;
            }
            Some(_) => {
                width += spaces[index];
                spaces[index + 1] = mean;
            }
            None => {
                width += spaces[index];
                spaces[index + 1] = 0;
            }
        }
    }
    spaces[line.len()] += between;
    (spaces.clone(), width + spaces[line.len()])
}

/// Sets glyphs side by side, and aligns words and gaps of three spaces to columns.
fn proportional(font: &Font, line: &[u8], between: i64) -> (Vec<i64>, i64) {
    const GAP: usize = 3;
    let (mut spaces, _) = squeezed(font, line, between);
    let cell = mean_width(font) + between;
    let is_space = |index: usize| {
        line.get(index).and_then(|code| glyph(font, *code)).is_some_and(|glyph| glyph.vertices.is_empty())
    };
    let mut width = spaces[0];
    let mut at = 0;
    while at < line.len() {
        // A run ends at a gap or at the end of the line.
        let (mut cells, mut found, mut next) = (0, 0, at);
        while next < line.len() {
            let letter = next;
            found += spaces[next + 1];
            next += 1;
            if glyph(font, line[letter]).is_some() {
                while is_space(next) {
                    found += spaces[next + 1];
                    next += 1;
                }
                cells += (next - letter) as i64;
            }
            if next - letter > GAP {
                break;
            }
        }
        let wanted = cells * cell;
        width += wanted;
        let mut left = wanted - found;
        let stretch = &mut spaces[at + 1..=next];
        let count = stretch.len();
        for (index, space) in stretch.iter_mut().enumerate() {
            let share = left / (count - index) as i64;
            *space += share;
            left -= share;
        }
        at = next;
    }
    (spaces, width)
}

/// Sizes in subpixels.
struct Layout {
    columns: usize,
    rows: usize,
    cell_width: i64,
    cell_height: i64,
    direction: TextDirection,
}

impl Layout {
    fn new(lines: usize, width: i64, options: &SignOptions) -> Option<Layout> {
        let lines = lines as f64;
        let is_upright = matches!(options.direction, TextDirection::Right | TextDirection::Left);
        let (columns, rows) = (options.columns * SUBPIXELS, options.rows * SUBPIXELS);
        // Sizes along the text and across it.
        let (mut along, mut across) = if is_upright { (columns, rows) } else { (rows, columns) };
        let mut cell_height = (options.height * SUBPIXELS) as i64;
        let cell_width;
        if along == 0 {
            cell_width = (cell_height as f64 / options.aspect + 0.5) as i64;
            along = usize::try_from((width * cell_width) >> 8).ok()?;
            across = (lines * cell_height as f64) as usize;
        } else {
            if across == 0 {
                across = (lines * cell_height as f64) as usize;
            }
            let mut aspect = options.aspect;
            if aspect > 1e-6 {
                let shape = 256.0 * lines * aspect / width as f64;
                if shape * (along as f64) < across as f64 {
                    across = (shape * along as f64 + 0.5) as usize;
                } else {
                    along = (across as f64 / shape + 0.5) as usize;
                }
            } else {
                aspect = across as f64 / along as f64 * width as f64 / (256.0 * lines);
            }
            cell_height = across as i64 / lines as i64;
            cell_width = (cell_height as f64 / aspect) as i64;
        }
        let (along, across) = (along.next_multiple_of(SUBPIXELS), across.next_multiple_of(SUBPIXELS));
        let (columns, rows) = if is_upright { (along, across) } else { (across, along) };
        let fits = |size: usize| (1..=LARGEST * SUBPIXELS).contains(&size);
        (fits(columns) && fits(rows)).then_some(Layout {
            columns,
            rows,
            cell_width,
            cell_height,
            direction: options.direction,
        })
    }

    /// The subpixel of a point of the text, from the bottom left.
    fn subpixel(&self, [x, y]: [i64; 2]) -> [i64; 2] {
        let (x, y) = ((x * self.cell_width) >> 8, (y * self.cell_height) >> 8);
        let (right, top) = (self.columns as i64 - 1, self.rows as i64 - 1);
        match self.direction {
            TextDirection::Right => [x, y],
            TextDirection::Up => [right - y, x],
            TextDirection::Left => [right - x, top - y],
            TextDirection::Down => [y, top - x],
        }
    }
}

/// For each row, the positions at which it enters or leaves a glyph.
struct Bitmap {
    columns: usize,
    rows: usize,
    crossings: Vec<bool>,
}

impl Bitmap {
    fn new(columns: usize, rows: usize) -> Bitmap {
        Bitmap { columns, rows, crossings: vec![false; columns * rows] }
    }

    fn draw(&mut self, glyph: &Glyph, [left, bottom]: [i64; 2], layout: &Layout) {
        let subpixel = |(x, y): &(u8, u8)| layout.subpixel([i64::from(*x) + left, i64::from(*y) + bottom]);
        let Some(mut from) = glyph.vertices.last().map(subpixel) else { return };
        for vertex in &glyph.vertices {
            let to = subpixel(vertex);
            self.edge(from, to);
            from = to;
        }
    }

    /// Marks an edge in each row that it crosses, always upwards.
    fn edge(&mut self, from: [i64; 2], to: [i64; 2]) {
        let (low, high) = if to[1] < from[1] { (to, from) } else { (from, to) };
        let (run, rise) = (high[0] - low[0], high[1] - low[1]);
        let step = run.signum();
        let (mut x, mut crossed_runs, mut crossed_rises) = (low[0], 0, 0);
        for y in low[1]..high[1] {
            while crossed_rises < crossed_runs {
                x += step;
                crossed_rises += rise;
            }
            self.toggle(x, y);
            crossed_runs += run.abs();
        }
    }

    fn toggle(&mut self, x: i64, y: i64) {
        if let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y))
            && x < self.columns
            && y < self.rows
        {
            self.crossings[y * self.columns + x] ^= true;
        }
    }

    /// The pixels: the share of the foreground is the share of subsamples inside a glyph.
    fn shaded(&self, options: &SignOptions) -> Sign {
        const MOST: usize = SUBPIXELS * SUBPIXELS;
        let shade = |count: usize| {
            let part = count as f64 / MOST as f64;
            let mixed = |i: usize| {
                let foreground = (f64::from(options.foreground[i]) * part) as f32;
                foreground + (f64::from(options.background[i]) * (1.0 - part)) as f32
            };
            encode_rgbe(std::array::from_fn(mixed))
        };
        let shades: Vec<[u8; 4]> = (0..=MOST).map(shade).collect();
        let (columns, rows) = (self.columns / SUBPIXELS, self.rows / SUBPIXELS);
        let mut stored = Vec::with_capacity(columns * rows * 4);
        for row in (0..rows).rev() {
            let mut inside = [false; SUBPIXELS];
            for column in 0..columns {
                let mut count = 0;
                for (offset, inside) in inside.iter_mut().enumerate() {
                    let start = (row * SUBPIXELS + offset) * self.columns + column * SUBPIXELS;
                    for crossing in &self.crossings[start..start + SUBPIXELS] {
                        *inside ^= crossing;
                        count += usize::from(*inside);
                    }
                }
                stored.extend_from_slice(&shades[count]);
            }
        }
        Sign { columns, rows, stored }
    }
}
