//! Text patterns on a plane: `brighttext`, `colortext` and `mixtext`.
//!
//! The plane has coordinates in characters to the right and lines down. Glyph outlines have
//! coordinates 0…255 in their cell. The length of a line is the sum of its advances, which depend
//! on the spacing.

use glam::DVec3;
use radsight_ir::{Font, Glyph, TextPattern};

/// Side of a cell in outline units.
const CELL: i64 = 255;

/// A column ends at a character followed by this many blanks, itself included, and one more.
const COLUMN_GAP: usize = 3;

/// Typeset text.
#[derive(Clone, Debug)]
pub struct Lettering {
    origin: DVec3,
    /// Scaled axis: its dot product with an offset from the origin counts characters to the right.
    across: DVec3,
    down: DVec3,
    /// Outline units per character to the right.
    units: f64,
    lines: Vec<Line>,
    outlines: Vec<Outline>,
}

/// A line of text.
#[derive(Clone, Debug)]
struct Line {
    width: i64,
    letters: Vec<Letter>,
}

/// A character: the start of its cell, and its outline if the font has one.
#[derive(Clone, Copy, Debug)]
struct Letter {
    start: i64,
    outline: Option<usize>,
}

/// A closed polygon; holes are joined to it by seams.
#[derive(Clone, Debug)]
struct Outline {
    left: u8,
    right: u8,
    bottom: u8,
    top: u8,
    vertices: Vec<(u8, u8)>,
}

impl Outline {
    /// Radiance measures extents from the centre of the cell.
    fn new(glyph: &Glyph) -> Outline {
        let mut outline = Outline { left: 128, right: 128, bottom: 128, top: 128, vertices: glyph.vertices.clone() };
        for (x, y) in &glyph.vertices {
            outline.left = outline.left.min(*x);
            outline.right = outline.right.max(*x);
            outline.bottom = outline.bottom.min(*y);
            outline.top = outline.top.max(*y);
        }
        outline
    }

    fn is_blank(&self) -> bool {
        self.vertices.is_empty()
    }

    /// Whether a point with non-negative coordinates is inside: the number of edges that cross a
    /// ray to the right is odd. Crossings are decided for the centre of the unit square around the
    /// point, so that no vertex lies on the ray.
    fn holds(&self, x: f64, y: f64) -> bool {
        let (column, row) = (x as i64, y as i64);
        let within = |low: u8, at: i64, high: u8| i64::from(low) <= at && at < i64::from(high);
        if !within(self.left, column, self.right) || !within(self.bottom, row, self.top) {
            return false;
        }
        let is_past = |vertex: u8, at: i64| i64::from(vertex) > at;
        let mut inside = false;
        let Some(mut from) = self.vertices.last().copied() else { return false };
        for to in self.vertices.iter().copied() {
            if is_past(from.1, row) != is_past(to.1, row) {
                let crosses = match (is_past(from.0, column), is_past(to.0, column)) {
                    (true, true) => true,
                    (false, false) => false,
                    _ => {
                        let offset = |vertex: (u8, u8)| (f64::from(vertex.0) - x, f64::from(vertex.1) - y);
                        let ((x0, y0), (x1, y1)) = (offset(from), offset(to));
                        (to.1 > from.1) != (y0 * x1 > x0 * y1)
                    }
                };
                inside ^= crosses;
            }
            from = to;
        }
        inside
    }
}

impl Lettering {
    /// Typesets the text. `None` if its two directions do not span a plane.
    pub fn new(text: &TextPattern, font: &Font) -> Option<Lettering> {
        let normal = text.down.cross(text.right);
        let dual = |axis: DVec3, along: DVec3| {
            let scale = axis.dot(along);
            (scale.is_finite() && scale != 0.0).then(|| axis / scale)
        };
        let across = dual(normal.cross(text.down), text.right)?;
        let down = dual(text.right.cross(normal), text.down)?;
        let outlines: Vec<Option<Outline>> = font.glyphs.iter().map(|glyph| glyph.as_ref().map(Outline::new)).collect();
        let letters = Letters { mean_width: mean_width(&outlines), outlines: &outlines };
        let spacing = text.spacing.map(|spacing| (spacing * CELL as f64) as i64);
        let units = match text.spacing {
            Some(spacing) => letters.mean_width as f64 + CELL as f64 * spacing.abs(),
            None => CELL as f64,
        };
        let mut places = vec![None; outlines.len()];
        let lines = text.lines.iter().map(|line| letters.set(line, spacing.unwrap_or(0), &mut places)).collect();
        let outlines = outlines.into_iter().flatten().collect();
        Some(Lettering { origin: text.origin, across, down, units, lines, outlines })
    }

    /// Whether a point, in the text's coordinates, lies on a letter in projection along the plane's
    /// normal.
    pub fn has_ink(&self, point: DVec3) -> bool {
        let offset = point - self.origin;
        let x = offset.dot(self.across) * self.units;
        let y = offset.dot(self.down);
        if !(x >= 0.0 && y >= 0.0) {
            return false;
        }
        let (row, column) = (y as usize, x as i64);
        let Some(line) = self.lines.get(row).filter(|line| column < line.width) else { return false };
        let height = (row as f64 + 1.0 - y) * CELL as f64;
        line.letters.iter().take_while(|letter| letter.start <= column).any(|letter| {
            let outline = letter.outline.filter(|_| column - letter.start < CELL);
            outline.is_some_and(|index| self.outlines[index].holds(x - letter.start as f64, height))
        })
    }
}

/// Mean width of the characters with ink.
fn mean_width(outlines: &[Option<Outline>]) -> i64 {
    let widths =
        outlines.iter().flatten().filter(|outline| outline.right > outline.left && outline.top > outline.bottom);
    let (count, sum) =
        widths.fold((0, 0), |(count, sum), outline| (count + 1, sum + i64::from(outline.right - outline.left)));
    if count > 0 { sum / count } else { 0 }
}

/// Characters of a font by code.
struct Letters<'f> {
    outlines: &'f [Option<Outline>],
    mean_width: i64,
}

impl Letters<'_> {
    fn get(&self, code: u8) -> Option<&Outline> {
        self.outlines.get(usize::from(code)).and_then(Option::as_ref)
    }

    fn is_blank(&self, code: u8) -> bool {
        self.get(code).is_some_and(Outline::is_blank)
    }

    /// Typesets a line. `places` gets the index of each outline in the font.
    fn set(&self, line: &[u8], spacing: i64, places: &mut Vec<Option<usize>>) -> Line {
        if places.iter().all(Option::is_none) {
            let indices = self.outlines.iter().scan(0, |next, outline| {
                *next += usize::from(outline.is_some());
                Some(outline.as_ref().map(|_| *next - 1))
            });
            *places = indices.collect();
        }
        let steps = match spacing {
            0 => self.uniform(line),
            _ if spacing < 0 => self.squeezed(line, -spacing),
            _ => self.in_columns(line, spacing),
        };
        let mut start = 0;
        let letters = line.iter().zip(&steps).map(|(code, step)| {
            start += step;
            Letter { start, outline: places.get(usize::from(*code)).copied().flatten() }
        });
        Line { letters: letters.collect(), width: steps.iter().sum() }
    }

    /// Advances before each character and after the last: one cell for each character in the font.
    fn uniform(&self, line: &[u8]) -> Vec<i64> {
        let widths = line.iter().map(|code| if self.get(*code).is_some() { CELL } else { 0 });
        std::iter::once(0).chain(widths).collect()
    }

    /// Advances with the same gap between the ink of all characters.
    fn squeezed(&self, line: &[u8], gap: i64) -> Vec<i64> {
        let margin = gap / 2;
        let mut steps = Vec::with_capacity(line.len() + 1);
        // Advance to the next character in the font, so far.
        let mut pending = None;
        for code in line {
            let Some(outline) = self.get(*code) else {
                steps.push(pending.unwrap_or(0));
                pending = pending.map(|_| 0);
                continue;
            };
            let step = pending.unwrap_or(margin);
            let (before, after) = match outline.is_blank() {
                true => (0, self.mean_width),
                false => (margin - i64::from(outline.left), i64::from(outline.right) + margin),
            };
            steps.push(step + before);
            pending = Some(after);
        }
        steps.push(pending.unwrap_or(margin) + margin);
        steps
    }

    /// Squeezed advances, stretched so that each column has the length of its characters at their
    /// mean width. Columns of a table stay aligned.
    fn in_columns(&self, line: &[u8], gap: i64) -> Vec<i64> {
        let mut steps = self.squeezed(line, gap);
        let mut first = 0;
        while first < line.len() {
            let (end, characters) = self.column(line, first);
            let present: i64 = steps[first + 1..=end].iter().sum();
            let mut missing = characters * (self.mean_width + gap) - present;
            for (step, left) in steps[first + 1..=end].iter_mut().zip((1..=(end - first) as i64).rev()) {
                let share = missing / left;
                *step += share;
                missing -= share;
            }
            first = end;
        }
        steps
    }

    /// End of the column that begins at a character, and its number of characters.
    fn column(&self, line: &[u8], first: usize) -> (usize, i64) {
        let (mut at, mut characters) = (first, 0);
        while at < line.len() {
            let mut next = at + 1;
            if self.get(line[at]).is_some() {
                next += line[next..].iter().take_while(|code| self.is_blank(**code)).count();
                characters += (next - at) as i64;
            }
            let is_last = next - at > COLUMN_GAP;
            at = next;
            if is_last {
                break;
            }
        }
        (at, characters)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use radsight_ir::{Arena, Rgb};

    /// A font with a blank and a letter that fills its cell from 55 to 205, with a hole.
    fn font() -> Font {
        let mut glyphs = vec![None; 256];
        glyphs[usize::from(b' ')] = Some(Glyph { vertices: vec![] });
        let (outer, inner) =
            ([(55, 0), (205, 0), (205, 255), (55, 255)], [(100, 100), (100, 200), (150, 200), (150, 100)]);
        let seam = [&outer[..], &outer[..1], &inner[..], &inner[..1]].concat();
        glyphs[usize::from(b'o')] = Some(Glyph { vertices: seam });
        Font { file: String::new(), glyphs }
    }

    fn lettering(lines: &[&str], spacing: Option<f64>) -> Lettering {
        let mut fonts = Arena::default();
        let text = TextPattern {
            font: fonts.add(font()),
            lines: lines.iter().map(|line| line.as_bytes().to_vec()).collect(),
            origin: DVec3::new(1.0, 2.0, 0.0),
            right: DVec3::X,
            down: DVec3::NEG_Y,
            spacing,
            foreground: Rgb::WHITE,
            background: Rgb::BLACK,
            words: Vec::new(),
        };
        Lettering::new(&text, &font()).unwrap()
    }

    #[test]
    fn letters_have_holes_and_stand_in_their_cells() {
        let text = lettering(&["oo", " o"], None);
        let ink = |x: f64, y: f64| text.has_ink(DVec3::new(1.0 + x, 2.0 - y, 7.0));
        assert!(ink(0.3, 0.5) && !ink(0.1, 0.5) && !ink(0.45, 0.4), "in the stroke, beside the letter, in the hole");
        assert!(ink(1.3, 0.5) && !ink(2.3, 0.5) && !ink(0.3, 1.5) && ink(1.3, 1.5) && !ink(-0.3, 0.5));
    }

    #[test]
    fn squeezed_letters_keep_their_gap() {
        // The mean width is 150, so one character to the right is 150 + 51 units.
        let text = lettering(&["oo"], Some(-0.2));
        let ink = |units: f64| text.has_ink(DVec3::new(1.0 + units / 201.0, 1.95, 0.0));
        // Half a gap at the start of the line, and half on either side of each letter.
        assert!(!ink(45.0) && ink(55.0) && ink(195.0) && !ink(205.0) && !ink(245.0) && ink(255.0));
    }

    #[test]
    fn columns_stay_aligned() {
        let letters =
            |lines: &[&str]| lettering(lines, Some(0.1)).lines.iter().map(|line| line.width).collect::<Vec<_>>();
        let widths = letters(&["oo oo", "o   o"]);
        assert!((widths[0] - widths[1]).abs() <= 25, "{widths:?}");
    }

    #[test]
    fn parallel_directions_are_refused() {
        let mut fonts = Arena::default();
        let text = TextPattern {
            font: fonts.add(font()),
            lines: vec![],
            origin: DVec3::ZERO,
            right: DVec3::X,
            down: DVec3::X,
            spacing: None,
            foreground: Rgb::WHITE,
            background: Rgb::BLACK,
            words: Vec::new(),
        };
        assert!(Lettering::new(&text, &font()).is_none());
    }
}
