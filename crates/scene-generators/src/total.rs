//! `total [-m] [-sE|-p|-u|-l] [-tC] [-i{f|d}[N]] [-o{f|d}] [-count [-r]] [file …]`: sums columns.
//!
//! Prints sums, with `-p` products, with `-u` and `-l` the largest and smallest value, with `-m`
//! means, with `-sE` sums of absolute values to the power E; for each `count` records, or for all.
//! `-r` continues the sum. `-in` and `-on` are the largest numbers of records read and written.

use radsight_loader::FileKind;

use crate::arguments::Arguments;
use crate::number_text::{leading_integer, leading_number};
use crate::records::{Encoding, InputForm, Record, encode, is_blank, number_at_start};
use crate::supply::Supply;
use crate::text::{Text, general};
use crate::{Error, Invocation, Output};

/// Further columns of a line are ignored.
const MOST_COLUMNS: usize = 81_920;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Reduction {
    Sum,
    Product,
    Largest,
    Smallest,
}

impl Reduction {
    /// The initial value, which is also that of an empty column.
    fn start(self) -> f64 {
        match self {
            Reduction::Sum => 0.0,
            Reduction::Product => 1.0,
            Reduction::Largest => -1e12,
            Reduction::Smallest => 1e12,
        }
    }
}

struct Options {
    reduction: Reduction,
    power: f64,
    mean: bool,
    /// Records per total; zero for all.
    count: usize,
    running: bool,
    input: InputForm,
    output: Encoding,
    most_input: usize,
    most_output: usize,
}

/// The accumulator of a column; for a product, the logarithm of its magnitude and its sign.
#[derive(Clone, Copy)]
struct Tally {
    value: f64,
    sign: f64,
}

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let options = read(&mut arguments)?;
    let (mut text, mut written) = (invocation.text(), 0);
    for name in arguments.files() {
        if options.most_output > 0 && written >= options.most_output {
            break;
        }
        reduce(&options, &mut invocation.supply(name, FileKind::Input)?, &mut text, &mut written)?;
    }
    Ok(Output { standard_output: text.finish()?, warnings: arguments.warnings, ..Output::default() })
}

fn read(arguments: &mut Arguments<'_>) -> Result<Options, Error> {
    let ascii = InputForm { encoding: Encoding::Ascii, columns: 0, separator: b'\t', blanks_join: true };
    let mut options = Options {
        reduction: Reduction::Sum,
        power: 0.0,
        mean: false,
        count: 0,
        running: false,
        input: ascii,
        output: Encoding::Ascii,
        most_input: 0,
        most_output: 0,
    };
    while let Some(option) = arguments.option_before_files()? {
        match option.name {
            "-" if option.text.starts_with(|first: char| first.is_ascii_digit()) => {
                options.count = leading_integer(option.text).map_or(0, |(count, _)| count as usize);
            }
            "-m" => options.mean = !options.mean,
            "-p" => options.reduction = Reduction::Product,
            "-u" => options.reduction = Reduction::Largest,
            "-l" => options.reduction = Reduction::Smallest,
            "-s" => options.power = leading_number(option.text).map_or(0.0, |(power, _)| power),
            "-t" => options.input.take_separator(option.text, arguments)?,
            "-r" => options.running = !options.running,
            "-in" => options.most_input = arguments.integer("most records (-in)")?.max(0) as usize,
            "-on" => options.most_output = arguments.integer("most records (-on)")?.max(0) as usize,
            "-i" if option.text.starts_with(['a', 'd', 'f']) => options.input.take_encoding(option.text, arguments)?,
            "-o" if option.text.starts_with(['a', 'd', 'f']) => {
                options.output = Encoding::of_text(option.text).ok_or_else(|| arguments.unknown())?;
            }
            _ => return Err(arguments.unknown()),
        }
    }
    if options.power != 0.0 && options.reduction != Reduction::Sum {
        return Err(arguments.impossible("-sE requires a sum"));
    }
    if options.mean && matches!(options.reduction, Reduction::Largest | Reduction::Smallest) {
        return Err(arguments.impossible("there is no mean of the largest or smallest"));
    }
    Ok(options)
}

fn reduce(options: &Options, input: &mut Supply<'_>, text: &mut Text, written: &mut usize) -> Result<(), Error> {
    let mut values = Vec::new();
    let mut tallies: Vec<Tally> = Vec::new();
    let mut total_records = 0usize;
    loop {
        let (mut records, mut columns) = (0, 0);
        while (options.count == 0 || records < options.count)
            && (options.most_input == 0 || records < options.most_input)
        {
            values.clear();
            match options.input.next_record(input, text)? {
                Some(record) => read_values(options, &record, &mut values),
                None => {
                    if let Some(record) = options.input.last_record(input) {
                        read_values(options, &record, &mut values);
                    }
                }
            }
            // A line without columns ends a group.
            if values.is_empty() {
                break;
            }
            columns = columns.max(values.len());
            add(options, &mut tallies, &values);
            records += 1;
        }
        // A second such line ends the input, as in the real program.
        if records == 0 {
            input.stop();
            return Ok(());
        }
        total_records += records;
        let results: Vec<f64> = tallies[..columns].iter().map(|tally| result(options, *tally, total_records)).collect();
        put(options, &results, text)?;
        *written += 1;
        if *written == options.most_output || options.most_input > 0 && records >= options.most_input {
            return Ok(());
        }
        if !options.running {
            total_records = 0;
            tallies.clear();
        }
    }
}

fn read_values(options: &Options, record: &Record<'_>, values: &mut Vec<f64>) {
    if options.input.encoding != Encoding::Ascii {
        return values.extend((1..=record.columns()).map(|column| record.column(column)));
    }
    let separates = |byte: u8| match is_blank(options.input.separator) {
        true => is_blank(byte),
        false => byte == options.input.separator,
    };
    let mut rest = record.bytes;
    while values.len() < MOST_COLUMNS {
        rest = &rest[rest.iter().take_while(|byte| is_blank(**byte)).count()..];
        if rest.is_empty() {
            break;
        }
        let length = rest.iter().take_while(|byte| !separates(**byte)).count();
        let field = &rest[..length];
        values.push(if field.is_empty() { options.reduction.start() } else { number_at_start(field) });
        rest = rest.get(length + 1..).unwrap_or_default();
    }
}

fn add(options: &Options, tallies: &mut Vec<Tally>, values: &[f64]) {
    let start = if options.reduction == Reduction::Product { 0.0 } else { options.reduction.start() };
    if tallies.len() < values.len() {
        tallies.resize(values.len(), Tally { value: start, sign: 1.0 });
    }
    for (tally, &value) in tallies.iter_mut().zip(values) {
        match options.reduction {
            Reduction::Sum if value == 0.0 => {}
            Reduction::Sum if options.power == 0.0 => tally.value += value,
            Reduction::Sum => tally.value += value.abs().powf(options.power),
            Reduction::Product => {
                tally.sign *= if value == 0.0 { 0.0 } else { value.signum() };
                if tally.sign != 0.0 {
                    tally.value += value.abs().ln();
                }
            }
            Reduction::Largest => tally.value = if value > tally.value { value } else { tally.value },
            Reduction::Smallest => tally.value = if value < tally.value { value } else { tally.value },
        }
    }
}

fn result(options: &Options, tally: Tally, records: usize) -> f64 {
    let mut value = tally.value;
    if options.mean {
        value /= records as f64;
        if options.reduction == Reduction::Sum && options.power != 0.0 && value != 0.0 {
            value = value.powf(1.0 / options.power);
        }
    }
    if options.reduction == Reduction::Product { tally.sign * value.exp() } else { value }
}

fn put(options: &Options, results: &[f64], text: &mut Text) -> Result<(), Error> {
    if let Encoding::Binary(number) = options.output {
        return results.iter().try_for_each(|value| encode(text, *value, number));
    }
    for (index, value) in results.iter().enumerate() {
        if index > 0 {
            text.push_bytes(&[options.input.separator])?;
        }
        text.number(general(*value, 9))?;
    }
    Ok(text.push_bytes(b"\n")?)
}
