//! Records that keep their order and are streamed.

use super::{Mistake, Options, Shape, broken, check_number, words};
use crate::supply::Supply;
use crate::text::Text;

/// The copy plan of records that keep their order.
pub(super) struct Plan {
    pub(super) input: Shape,
    pub(super) output: Shape,
    /// Number of requested records; `None` for all.
    pub(super) wanted: Option<usize>,
}

impl Plan {
    /// `None` if all records must be read first.
    pub(super) fn new(options: &Options) -> Option<Plan> {
        let (mut input, mut output) = (options.input, options.output);
        if output.columns == 0 {
            output.columns = input.columns;
        }
        if options.reorders() || output.columns == 0 {
            return None;
        }
        if input == Shape::default() {
            input = output;
        }
        let wanted = Some(input.records()).filter(|count| *count > 0);
        match wanted {
            Some(count) => {
                output = output.filled(count);
                (output.records() == count).then_some(Plan { input, output, wanted })
            }
            // A header must contain the number of rows.
            None if options.writes_header || output.rows > 0 || input.rows > 0 => None,
            None => Some(Plan { input, output, wanted }),
        }
    }
}

/// The records found.
#[derive(Default)]
pub(super) struct Found {
    pub(super) records: usize,
    /// Trailing bytes that form no requested record.
    pub(super) bytes_behind: usize,
}

pub(super) fn copy(input: &mut Supply<'_>, text: &mut Text) -> Result<(), Mistake> {
    loop {
        let window = input.take(usize::MAX);
        text.push_bytes(input.bytes(window))?;
        if !input.more(text)? {
            return Ok(());
        }
    }
}

/// Copies lines that contain whole records.
pub(super) fn copy_lines(input: &mut Supply<'_>, text: &mut Text, components: usize) -> Result<(), Mistake> {
    let mut number = 0;
    while let Some(range) = input.line(text)? {
        number += 1;
        let line = input.bytes(range);
        let words = words(line).count();
        if !words.is_multiple_of(components) {
            return Err(broken(number, words % components, components));
        }
        text.push_bytes(line)?;
    }
    Ok(())
}

pub(super) fn pass_bytes(input: &mut Supply<'_>, text: &mut Text, plan: &Plan, size: usize) -> Result<Found, Mistake> {
    let mut found = Found::default();
    while plan.wanted.is_none_or(|wanted| found.records < wanted) {
        let Some(record) = input.exactly(size, text)? else { break };
        text.push_bytes(input.bytes(record))?;
        found.records += 1;
    }
    loop {
        found.bytes_behind += input.take(usize::MAX).len();
        if !input.more(text)? {
            return Ok(found);
        }
    }
}

/// How each word is checked.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum WordCheck {
    Nothing,
    /// The word is a number.
    Number,
}

/// Copies words, with new line ends.
pub(super) fn pass_words(
    input: &mut Supply<'_>,
    text: &mut Text,
    plan: &Plan,
    components: usize,
    check: WordCheck,
) -> Result<Found, Mistake> {
    let (mut found, mut number) = (Found::default(), 0);
    while let Some(range) = input.line(text)? {
        number += 1;
        let line = input.bytes(range);
        let left = words(line).count() % components;
        if left > 0 {
            return Err(broken(number, left, components));
        }
        for (place, word) in words(line).enumerate() {
            let is_last = place % components == components - 1;
            let is_wanted = plan.wanted.is_none_or(|wanted| found.records < wanted);
            found.records += usize::from(is_last);
            if !is_wanted {
                continue;
            }
            if check == WordCheck::Number {
                check_number(word)?;
            }
            text.push_bytes(word)?;
            text.push_bytes(match (is_last, found.records % plan.output.columns) {
                (false, _) => b" ",
                (true, 0) => b"\n",
                (true, _) => b"\t",
            })?;
        }
    }
    Ok(found)
}
