//! Lamp tables: the colour of a lamp from its description.
//!
//! A table has a line for each kind of lamp: a pattern between two equal delimiters, then the
//! chromaticity x y and the lumen depreciation, or in parentheses the description of a lamp above.
//! The first matching pattern is used. Patterns are those of `grep` and ignore case.

use crate::cie::rgb_of_chromaticity;
use crate::number_text::leading_number;

/// The built-in table, for machines without Radiance's `lamp.tab`: chromaticities of common lamps.
pub(crate) const BUILT_IN: &str = "\
# Fluorescent lamps, by the names of their whites.
/deluxe warm white/ .440 .403 .85
/warm white deluxe/ (deluxe warm white)
/deluxe cool white/ .376 .368 .85
/cool white deluxe/ (deluxe cool white)
/warm[- ]white/ .436 .406 .85
/cool[- ]white/ .373 .385 .85
/white\\>.*\\<fluor/ .41 .398 .85
/daylight\\>.*\\<fluor/ .316 .345 .85
# Discharge lamps.
/clear mercury/ .326 .39 .8
/phosphor\\>.*\\<mercury/ .373 .415 .8
/mercury\\>.*\\<phosphor/ (phosphor mercury)
/mercury/ (clear mercury)
/clear metal halide/ .396 .390 .8
/metal halide/ (clear metal halide)
/xenon/ .324 .324 1
/high[- ]pressure\\>.*\\<sodium/ .519 .418 .9
/low[- ]pressure\\>.*\\<sodium/ .569 .421 .93
/sodium/ (low pressure sodium)
# Filaments.
/halogen/ .424 .399 1
/quartz/ (halogen)
/incandescent/ .453 .405 .95
/\\<incand/ (incandescent)
# Less specific words.
/fluorescent/ (cool white)
/\\<fluor/ (fluorescent)
/\\<spot\\>/ (incandescent)
/\\<flood\\>/ (incandescent)
/headlamp/ (incandescent)
/headlight/ (headlamp)
/phosphor[- ]coated HID\\>/ (phosphor mercury)
/diffuse\\>.*\\<HID\\>/ (high pressure sodium)
/frosted\\>.*\\<HID\\>/ (diffuse HID)
/HPS/ (high pressure sodium)
/\\<LPS/ (low pressure sodium)
/\\<[EP]AR\\>/ (incandescent)
/ER30/ (incandescent)
/\\<D65WHITE\\>/ .313 .329 1
/\\<WHITE\\>/ .3333 .3333 1
/\\<MH\\>/ (metal halide)
/\\<clear HID\\>/ (high pressure sodium)
/\\<HID\\>/ (clear HID)
";

/// A kind of lamp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lamp {
    pub(crate) chromaticity: [f64; 2],
    /// Mean output over the lamp's life divided by its initial output.
    pub(crate) depreciation: f64,
}

impl Lamp {
    /// Red, green and blue, multiplied by the depreciation.
    pub(crate) fn rgb(&self) -> [f64; 3] {
        rgb_of_chromaticity(self.chromaticity, self.depreciation)
    }
}

/// A table, in order.
#[derive(Default)]
pub(crate) struct Lamps {
    entries: Vec<(Pattern, Lamp)>,
}

impl Lamps {
    /// Parses a table; the error names the line.
    pub(crate) fn read(text: &str) -> Result<Lamps, String> {
        let mut lamps = Lamps::default();
        for (index, line) in text.lines().enumerate() {
            let line = line.trim();
            if line.is_empty() || line.starts_with('#') {
                continue;
            }
            let entry = lamps.read_entry(line).map_err(|mistake| format!("line {}: {mistake}", index + 1))?;
            lamps.entries.push(entry);
        }
        Ok(lamps)
    }

    fn read_entry(&self, line: &str) -> Result<(Pattern, Lamp), String> {
        let mark = line.chars().next().unwrap_or('/');
        let (pattern, specification) =
            split_at_mark(&line[mark.len_utf8()..], mark).ok_or("the pattern is not closed")?;
        let pattern = Pattern::read(pattern)?;
        let specification = specification.trim_start();
        if let Some(alias) = specification.strip_prefix('(') {
            let (alias, _) = split_at_mark(alias, ')').ok_or("the parenthesis is not closed")?;
            let lamp = self.find(alias).ok_or_else(|| format!("no lamp above is \"{alias}\""))?;
            return Ok((pattern, lamp));
        }
        let numbers: Vec<f64> = specification
            .split_ascii_whitespace()
            .map_while(|word| leading_number(word).map(|(value, _)| value))
            .collect();
        match numbers[..] {
            [x, y, depreciation, ..] if y > 0.0 => Ok((pattern, Lamp { chromaticity: [x, y], depreciation })),
            _ => Err(format!("\"{specification}\" is neither x, y and depreciation nor a lamp in parentheses")),
        }
    }

    /// The first lamp whose pattern occurs in a description.
    pub(crate) fn find(&self, description: &str) -> Option<Lamp> {
        self.entries.iter().find(|(pattern, _)| pattern.is_in(description)).map(|(_, lamp)| *lamp)
    }
}

/// Splits a text at the first delimiter not preceded by a backslash.
fn split_at_mark(text: &str, mark: char) -> Option<(&str, &str)> {
    let mut before = '\0';
    for (index, character) in text.char_indices() {
        if character == mark && before != '\\' {
            return Some((&text[..index], &text[index + mark.len_utf8()..]));
        }
        before = character;
    }
    None
}

/// Red, green and blue of a lamp by its description, multiplied by its depreciation. Uses the first
/// match in the given table, or in the built-in one. `None` if there is no match.
///
/// # Errors
/// The mistake in the table, with its line.
pub fn lamp_color(table: Option<&str>, description: &str) -> Result<Option<[f64; 3]>, String> {
    let lamps = Lamps::read(table.unwrap_or(BUILT_IN))?;
    Ok(lamps.find(description).map(|lamp| lamp.rgb()))
}

/// One element of a pattern.
enum Step {
    /// A byte in a class or outside it; repetition allows any number, including none.
    Byte {
        set: Box<[bool; 256]>,
        repeated: bool,
    },
    WordStart,
    WordEnd,
    LineEnd,
}

/// A `grep` pattern that ignores case.
struct Pattern {
    steps: Vec<Step>,
    at_line_start: bool,
}

impl Pattern {
    fn read(text: &str) -> Result<Pattern, String> {
        let (at_line_start, text) = match text.strip_prefix('^') {
            Some(rest) => (true, rest),
            None => (false, text),
        };
        let mut steps: Vec<Step> = Vec::new();
        let mut bytes = text.bytes().peekable();
        let either_case = |byte: u8| {
            let mut set = [false; 256];
            set[usize::from(byte.to_ascii_lowercase())] = true;
            set[usize::from(byte.to_ascii_uppercase())] = true;
            Step::Byte { set: Box::new(set), repeated: false }
        };
        while let Some(byte) = bytes.next() {
            let step = match byte {
                b'*' => {
                    match steps.last_mut() {
                        Some(Step::Byte { repeated, .. }) => *repeated = true,
                        _ => return Err("\"*\" has nothing to repeat".to_owned()),
                    }
                    continue;
                }
                b'.' => Step::Byte { set: Box::new([true; 256]), repeated: false },
                b'$' if bytes.peek().is_none() => Step::LineEnd,
                b'[' => read_class(&mut bytes)?,
                b'\\' => match bytes.next() {
                    Some(b'<') => Step::WordStart,
                    Some(b'>') => Step::WordEnd,
                    Some(escaped) => either_case(escaped),
                    None => return Err("nothing follows the backslash".to_owned()),
                },
                byte => either_case(byte),
            };
            steps.push(step);
        }
        Ok(Pattern { steps, at_line_start })
    }

    /// Follows all paths through the pattern at once, so that time is the product of the lengths.
    fn is_in(&self, text: &str) -> bool {
        let text = text.as_bytes();
        let mut alive = vec![false; self.steps.len() + 1];
        for position in 0..=text.len() {
            if position == 0 || !self.at_line_start {
                alive[0] = true;
            }
            let here = text.get(position).copied();
            let is_word = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_';
            let after_word = position > 0 && is_word(text[position - 1]);
            let before_word = here.is_some_and(is_word);
            // Elements that consume no byte.
            for index in 0..self.steps.len() {
                let passes = match &self.steps[index] {
                    Step::Byte { repeated, .. } => *repeated,
                    Step::WordStart => position == 0 || before_word && !after_word,
                    Step::WordEnd => !before_word,
                    Step::LineEnd => here.is_none(),
                };
                alive[index + 1] |= alive[index] && passes;
            }
            if alive[self.steps.len()] {
                return true;
            }
            let Some(byte) = here else { break };
            let mut next = vec![false; self.steps.len() + 1];
            for (index, step) in self.steps.iter().enumerate() {
                if let Step::Byte { set, repeated } = step
                    && alive[index]
                    && set[usize::from(byte)]
                {
                    next[if *repeated { index } else { index + 1 }] = true;
                }
            }
            alive = next;
        }
        false
    }
}

/// Parses a class of bytes, up to the bracket.
fn read_class(bytes: &mut std::iter::Peekable<std::str::Bytes<'_>>) -> Result<Step, String> {
    let negated = bytes.next_if_eq(&b'^').is_some();
    let mut listed = [false; 256];
    let mut before: Option<u8> = None;
    loop {
        let byte = bytes.next().ok_or("a class of characters is not closed")?;
        if byte == b']' && before.is_some() {
            break;
        }
        match (byte, before, bytes.peek()) {
            (b'-', Some(low), Some(&high)) if high != b']' => {
                bytes.next();
                listed[usize::from(low)..=usize::from(high).max(usize::from(low))].fill(true);
                before = Some(high);
            }
            _ => {
                listed[usize::from(byte)] = true;
                before = Some(byte);
            }
        }
    }
    let set = std::array::from_fn(|byte| {
        let byte = byte as u8;
        let either = listed[usize::from(byte.to_ascii_lowercase())] || listed[usize::from(byte.to_ascii_uppercase())];
        either != negated
    });
    Ok(Step::Byte { set: Box::new(set), repeated: false })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lamps_are_found_by_their_description() {
        let lamps = Lamps::read(BUILT_IN).unwrap();
        let chromaticity = |text: &str| lamps.find(text).map(|lamp| lamp.chromaticity);
        assert_eq!(chromaticity("2 x F32T8 Cool-White lamps"), Some([0.373, 0.385]));
        assert_eq!(chromaticity("one 100W HIGH PRESSURE clear sodium lamp"), Some([0.519, 0.418]));
        assert_eq!(chromaticity("an HID."), Some([0.519, 0.418]));
        assert_eq!(chromaticity("HIDDEN"), None);
        assert_eq!(chromaticity("a PAR lamp"), Some([0.453, 0.405]));
        assert_eq!(chromaticity("a PART"), None);
    }

    #[test]
    fn patterns_take_little_time() {
        let pattern = Pattern::read(&".*x".repeat(80)).unwrap();
        assert!(!pattern.is_in(&"x".repeat(79)));
        assert!(pattern.is_in(&"x".repeat(80)));
    }

    #[test]
    fn mistakes_name_the_line() {
        let message = |text: &str| Lamps::read(text).map(|_| ()).unwrap_err();
        assert_eq!(message("# x\n/a b"), "line 2: the pattern is not closed");
        assert_eq!(message("/a/ (b)"), "line 1: no lamp above is \"b\"");
        assert_eq!(message("/[a/ 1 1 1"), "line 1: a class of characters is not closed");
    }
}
