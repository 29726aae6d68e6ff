//! `histo [-c] [-p] min max n`, or `histo [-c] [-p] imin imax` for integers: histograms of the
//! columns of standard input; `-c` cumulative, `-p` in percent.

use crate::arguments::Arguments;
use crate::records::{is_blank, number_at_start};
use crate::supply::Supply;
use crate::text::{Text, general};
use crate::{Error, Invocation, Output};
use radsight_loader::FileKind;
use std::fmt::Write;

/// Largest number of bins.
const MOST_DIVISIONS: i64 = 1024;

/// Further columns of a line are ignored.
const MOST_COLUMNS: usize = 2048;

struct Range {
    low: f64,
    high: f64,
    divisions: usize,
}

/// The bins of a column.
#[derive(Clone)]
struct Column {
    below: u64,
    above: u64,
    inside: Vec<u64>,
}

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let (mut cumulative, mut percent) = (false, false);
    while let Some(option) = arguments.option_before_numbers() {
        match option.name {
            "-c" => cumulative = true,
            "-p" => percent = true,
            _ => return Err(arguments.unknown()),
        }
    }
    let range = Range::read(&mut arguments)?;
    let mut text = invocation.text();
    let (columns, not_numbers) = range.count(&mut invocation.supply("-", FileKind::Input)?, &mut text)?;
    if not_numbers > 0 {
        arguments.warnings.push(format!("{not_numbers} of the numbers are nan, which no bin counts"));
    }
    let steps = range.divisions + usize::from(cumulative);
    let mut sums: Vec<u64> = columns.iter().map(|column| column.below).collect();
    for step in 0..steps {
        let place = step as f64 + if cumulative { 0.0 } else { 0.5 };
        write!(text, "{}", general(range.low + (range.high - range.low) * place / range.divisions as f64, 6))?;
        for (column, sum) in columns.iter().zip(&mut sums) {
            let inside = column.inside.get(step).copied().unwrap_or(0);
            let count = if cumulative { *sum } else { inside };
            match percent {
                true => write!(text, "\t{:.6}", 100.0 * count as f64 / column.total() as f64)?,
                false => write!(text, "\t{count}")?,
            }
            *sum += inside;
        }
        text.write_str("\n")?;
    }
    Ok(Output { standard_output: text.finish()?, warnings: arguments.warnings, ..Output::default() })
}

impl Range {
    fn read(arguments: &mut Arguments<'_>) -> Result<Range, Error> {
        let [low, high] = [arguments.number("min")?, arguments.number("max")?];
        let position = arguments.position();
        let is_whole = |number: f64| (number + 1e-6).floor() != (number - 1e-6).floor();
        let (low, high, divisions) = match arguments.peek() {
            Some(_) => (low, high, arguments.integer("n")?),
            None if is_whole(low) && is_whole(high) => (low - 0.5, high + 0.5, (high - low + 1.5) as i64),
            None => return Err(arguments.mistake(position, "missing n, as min and max are not integers")),
        };
        if arguments.word().is_some() {
            return Err(arguments.unknown());
        }
        if low >= high {
            return Err(arguments.impossible(format!("max is {high}, expected more than min, {low}")));
        }
        if !(1..=MOST_DIVISIONS).contains(&divisions) {
            return Err(arguments.impossible(format!("{divisions} divisions, expected 1 to {MOST_DIVISIONS}")));
        }
        Ok(Range { low, high, divisions: divisions as usize })
    }

    /// The bins of all columns, and how many numbers are nan.
    fn count(&self, input: &mut Supply<'_>, text: &mut Text) -> Result<(Vec<Column>, u64), Error> {
        let empty = Column { below: 0, above: 0, inside: vec![0; self.divisions] };
        let (mut columns, mut not_numbers): (Vec<Column>, u64) = (Vec::new(), 0);
        while let Some(line) = input.line(text)? {
            let words = input.bytes(line).split(|byte| is_blank(*byte)).filter(|word| !word.is_empty());
            for (place, word) in words.take(MOST_COLUMNS).enumerate() {
                if place == columns.len() {
                    columns.push(empty.clone());
                }
                let (column, number) = (&mut columns[place], number_at_start(word));
                if number.is_nan() {
                    not_numbers += 1;
                } else if number < self.low {
                    column.below += 1;
                } else if number >= self.high {
                    column.above += 1;
                } else {
                    let division = (self.divisions as f64 * (number - self.low) / (self.high - self.low)) as usize;
                    column.inside[division.min(self.divisions - 1)] += 1;
                }
            }
        }
        Ok((columns, not_numbers))
    }
}

impl Column {
    fn total(&self) -> u64 {
        self.below + self.above + self.inside.iter().sum::<u64>()
    }
}
