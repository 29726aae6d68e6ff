//! `rcollate [-h[io]] [-w] [-c] [-f[afdb][N]] [-t] [-ic COLUMNS] [-ir ROWS] [-oc COLUMNS] [-or
//! ROWS] [-o RxC[xR1xC1..]] [MATRIX]`: rearranges the records of a matrix into other rows and
//! columns, transposed (`-t`) or in blocks (`-o`). Numbers are copied without parsing, except that
//! `-c` checks them.
//!
//! A record has `N` components of text (`-fa`), 4 bytes (`-ff`), 8 (`-fd`) or 1 (`-fb`), unless a
//! header declares another format.

mod pass_on;

use crate::arguments::Arguments;
use crate::number_text::{leading_integer, whole_number};
use crate::records::is_blank;
use crate::supply::Supply;
use crate::text::{Quoted, Text};
use crate::{Error, Invocation, Output, source_name};
use pass_on::{Plan, WordCheck, copy, copy_lines, pass_bytes, pass_words};
use radsight_loader::FileKind;
use std::fmt::Write;
use std::ops::Range;

/// Default number of components of a record.
const COMPONENTS: usize = 3;

/// Largest nesting depth of blocks.
const DEEPEST: usize = 16;

/// Rows and columns; 0 for unknown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Shape {
    rows: usize,
    columns: usize,
}

impl Shape {
    fn records(self) -> usize {
        self.rows.saturating_mul(self.columns)
    }

    fn turned(self) -> Shape {
        Shape { rows: self.columns, columns: self.rows }
    }

    /// Unknown values replaced by those of another shape.
    fn or(self, other: Shape) -> Shape {
        let either = |own: usize, other: usize| if own > 0 { own } else { other };
        Shape { rows: either(self.rows, other.rows), columns: either(self.columns, other.columns) }
    }

    /// Unknown values derived from the number of records.
    fn filled(self, records: usize) -> Shape {
        match self {
            Shape { rows: 0, columns } if columns > 0 => Shape { rows: records / columns, columns },
            Shape { rows, columns: 0 } if rows > 0 => Shape { rows, columns: records / rows },
            known => known,
        }
    }
}

/// The format of records.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Format {
    /// The format's name in a header.
    name: &'static str,
    /// Bytes per component; `None` for text.
    size: Option<usize>,
}

const FORMATS: [Format; 4] = [
    Format { name: "ascii", size: None },
    Format { name: "float", size: Some(4) },
    Format { name: "double", size: Some(8) },
    Format { name: "byte", size: Some(1) },
];

struct Options {
    reads_header: bool,
    writes_header: bool,
    checks: bool,
    warns: bool,
    transposes: bool,
    format: Option<Format>,
    components: Option<usize>,
    input: Shape,
    output: Shape,
    /// The levels of `-o`, from the whole down: rows and columns of each.
    blocks: Vec<Shape>,
}

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let options = Options::read(&mut arguments)?;
    let command = &invocation.argv[..arguments.position()];
    let name = arguments.word().unwrap_or("-");
    if arguments.word().is_some() {
        return Err(arguments.unknown());
    }
    let mut input = invocation.supply(name, FileKind::Input)?;
    let mut text = invocation.text();
    let mut collation = Collation { options, header: Vec::new(), warnings: arguments.warnings };
    collation.collate(&mut input, command, &mut text).map_err(|mistake| match mistake {
        Mistake::Other(error) => error,
        Mistake::Text(mistake) => {
            Error::Input { program: "rcollate".to_owned(), source_name: source_name(name).to_owned(), mistake }
        }
    })?;
    let warnings = if collation.options.warns { collation.warnings } else { Vec::new() };
    Ok(Output { standard_output: text.finish()?, warnings, ..Output::default() })
}

impl Options {
    fn read(arguments: &mut Arguments<'_>) -> Result<Options, Error> {
        let mut options = Options {
            reads_header: true,
            writes_header: true,
            checks: false,
            warns: true,
            transposes: false,
            format: None,
            components: None,
            input: Shape::default(),
            output: Shape::default(),
            blocks: Vec::new(),
        };
        while let Some(option) = arguments.option_before_files()? {
            match option.name {
                "-h" => (options.reads_header, options.writes_header) = (false, false),
                "-hi" => options.reads_header = false,
                "-ho" => options.writes_header = false,
                "-w" => options.warns = !options.warns,
                "-c" => options.checks = true,
                "-t" => options.transposes = !options.transposes,
                "-ic" => options.input.columns = arguments.count("input columns (-ic)")?,
                "-ir" => options.input.rows = arguments.count("input rows (-ir)")?,
                "-oc" => options.output.columns = arguments.count("output columns (-oc)")?,
                "-or" => options.output.rows = arguments.count("output rows (-or)")?,
                "-o" => options.blocks = read_blocks(arguments)?,
                "-f" => {
                    let (format, components) = read_format(option.text).ok_or_else(|| arguments.unknown())?;
                    (options.format, options.components) = (Some(format), Some(components));
                }
                _ => return Err(arguments.unknown()),
            }
        }
        if let Some(whole) = options.blocks.first() {
            options.output = *whole;
        }
        Ok(options)
    }

    /// Whether records change their order.
    fn reorders(&self) -> bool {
        self.transposes || self.blocks.len() > 1
    }

    /// Whether the output equals the input.
    fn changes_nothing(&self) -> bool {
        let is_same = self.reads_header == self.writes_header && self.input == self.output;
        is_same && !self.reorders() && !self.checks
    }

    /// Whether lines stay as they are: the output has the input's shape, which is known if a header
    /// needs it.
    fn keeps_order(&self) -> bool {
        let is_same = self.output.or(self.input) == self.input && (self.input.records() > 0 || !self.writes_header);
        is_same && !self.reorders() && !self.checks
    }
}

/// Parses `L` or `LN`: the letter of a format and a number of components.
fn read_format(text: &str) -> Option<(Format, usize)> {
    let letter = text.chars().next()?;
    let index = "afdb".find(letter.to_ascii_lowercase())?;
    let count = &text[letter.len_utf8()..];
    Some((FORMATS[index], if count.is_empty() { 1 } else { whole_count(count)? }))
}

/// Parses the levels of `RxCxR1xC1…`: blocks of blocks, the whole first.
fn read_blocks(arguments: &mut Arguments<'_>) -> Result<Vec<Shape>, Error> {
    let position = arguments.position();
    let word = arguments.required("blocks (-o)")?;
    let wrong =
        || arguments.mistake(position, format!("blocks (-o) are \"{word}\", expected counts as in 4x8 or 2x2x4x8"));
    let counts: Option<Vec<usize>> = word.split(['x', 'X']).map(whole_count).collect();
    let counts = counts.filter(|counts| counts.len() % 2 == 0 && counts.len() <= 2 * DEEPEST).ok_or_else(wrong)?;
    let mut levels: Vec<Shape> = counts.chunks(2).map(|pair| Shape { rows: pair[0], columns: pair[1] }).collect();
    for level in (1..levels.len()).rev() {
        let inner = levels[level];
        let outer = &mut levels[level - 1];
        *outer =
            Shape { rows: outer.rows.saturating_mul(inner.rows), columns: outer.columns.saturating_mul(inner.columns) };
    }
    Ok(levels)
}

/// A count above zero.
fn whole_count(word: &str) -> Option<usize> {
    let (count, end) = leading_integer(word).filter(|_| word.starts_with(|first: char| first.is_ascii_digit()))?;
    usize::try_from(count).ok().filter(|count| *count > 0 && end == word.len())
}

/// A mistake of the input, or another error.
enum Mistake {
    Text(String),
    Other(Error),
}

impl From<std::fmt::Error> for Mistake {
    fn from(error: std::fmt::Error) -> Self {
        Mistake::Other(error.into())
    }
}

impl From<Error> for Mistake {
    fn from(error: Error) -> Self {
        Mistake::Other(error)
    }
}

impl From<String> for Mistake {
    fn from(mistake: String) -> Self {
        Mistake::Text(mistake)
    }
}

struct Collation {
    options: Options,
    /// Text before the records.
    header: Vec<u8>,
    warnings: Vec<String>,
}

impl Collation {
    fn collate(&mut self, input: &mut Supply<'_>, command: &[String], text: &mut Text) -> Result<(), Mistake> {
        if self.options.changes_nothing() {
            self.warnings.push("no other order is requested: the input is copied unchanged".to_owned());
            return copy(input, text);
        }
        if self.options.reads_header {
            self.read_header(input, text)?;
        }
        let format = self.options.format.unwrap_or(FORMATS[0]);
        let components = self.options.components.unwrap_or(COMPONENTS);
        if format.size.is_none() && self.options.keeps_order() {
            self.write_header(text, command, self.options.input, format, components)?;
            return copy_lines(input, text, components);
        }
        if let Some(plan) = Plan::new(&self.options) {
            self.write_header(text, command, plan.output, format, components)?;
            return self.pass_on(input, text, plan, (format, components));
        }
        while input.more(text)? {}
        let all = input.window();
        let records = Records::find(all, format, components)?;
        let count = match &records {
            Records::Text(ranges) => ranges.len(),
            Records::Bytes { size } => all.len() / size,
        };
        let (from, to) = self.shapes(all, &records, count)?;
        self.write_header(text, command, to, format, components)?;
        self.write_records(text, all, &records, from, to)
    }

    fn write_header(
        &mut self,
        text: &mut Text,
        command: &[String],
        output: Shape,
        format: Format,
        components: usize,
    ) -> Result<(), Mistake> {
        if !self.options.writes_header {
            return Ok(());
        }
        text.push_bytes(&self.header)?;
        if !self.options.reads_header {
            text.write_str("#?RADIANCE\n")?;
        }
        let words: Vec<String> = command.iter().map(|word| Quoted(word).to_string()).collect();
        writeln!(text, "{}\nNCOMP={components}", words.join(" "))?;
        Ok(writeln!(text, "NROWS={}\nNCOLS={}\nFORMAT={}\n", output.rows, output.columns, format.name)?)
    }

    /// Reads the description of the records from the header, and keeps its other lines.
    fn read_header(&mut self, input: &mut Supply<'_>, text: &mut Text) -> Result<(), Mistake> {
        loop {
            let line = match input.line(text)? {
                Some(range) => input.bytes(range).to_vec(),
                None => Vec::new(),
            };
            let Some(line) = line.strip_suffix(b"\n") else {
                return Err("the header does not end with an empty line; use option -hi for input without a header"
                    .to_owned()
                    .into());
            };
            if line.is_empty() || line == b"\r" {
                return Ok(());
            }
            if !self.take_line(&String::from_utf8_lossy(line))? {
                self.header.extend_from_slice(line);
                self.header.push(b'\n');
            }
        }
    }

    /// Parses a line of the header; returns whether it describes the records.
    fn take_line(&mut self, line: &str) -> Result<bool, Mistake> {
        let Some((key, value)) = line.split_once('=') else { return Ok(false) };
        let value = value.trim();
        // Components of picture bytes are split as requested.
        let is_open = |options: &Options| {
            let is_byte = options.format.is_some_and(|format| format.size == Some(1));
            is_byte && options.components.is_some_and(|count| count > 1) && !options.checks
        };
        match key {
            "FORMAT" if is_open(&self.options) => {}
            "FORMAT" => {
                let found = FORMATS.iter().find(|format| format.name == value);
                match (self.options.format, found) {
                    (None, None) => {
                        return Err(format!("the format is \"{value}\", expected ascii, float, double or byte").into());
                    }
                    (None, Some(found)) => self.options.format = Some(*found),
                    (Some(wanted), _) if wanted.name != value => {
                        return Err(
                            format!("the format is {value} in the header, but {} in the options", wanted.name).into()
                        );
                    }
                    _ => {}
                }
            }
            "NCOMP" if is_open(&self.options) => {}
            "NCOMP" => {
                let mut found = self.options.components.unwrap_or(0);
                agree(&mut found, value, "components")?;
                self.options.components = Some(found);
            }
            "NROWS" => agree(&mut self.options.input.rows, value, "rows")?,
            "NCOLS" => agree(&mut self.options.input.columns, value, "columns")?,
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Copies records while they arrive.
    fn pass_on(
        &mut self,
        input: &mut Supply<'_>,
        text: &mut Text,
        plan: Plan,
        (format, components): (Format, usize),
    ) -> Result<(), Mistake> {
        let found = match format.size {
            Some(size) => pass_bytes(input, text, &plan, size.saturating_mul(components))?,
            None => {
                let check = if self.options.checks { WordCheck::Number } else { WordCheck::Nothing };
                pass_words(input, text, &plan, components, check)?
            }
        };
        let Shape { rows, columns } = plan.input;
        let what = match plan.wanted {
            Some(wanted) if found.records < wanted => {
                return Err(format!("there are {} records, expected {rows} × {columns}", found.records).into());
            }
            Some(wanted) if found.bytes_behind > 0 || found.records > wanted => match format.size {
                Some(_) => format!("{} bytes follow {rows} × {columns} records, expected none", found.bytes_behind),
                None => format!("there are {} records, expected {rows} × {columns}", found.records),
            },
            None if found.records % columns.max(1) > 0 => {
                let (count, rows) = (found.records, found.records / columns);
                return Err(format!("there are {count} records, expected {rows} × {columns}").into());
            }
            None if found.records % plan.output.columns.max(1) > 0 => {
                let (columns, count) = (plan.output.columns, found.records);
                return Err(format!("there are {count} records, expected {} rows of {columns}", count / columns).into());
            }
            None if found.bytes_behind > 0 => {
                format!("{} bytes follow the last record, expected none", found.bytes_behind)
            }
            _ => return Ok(()),
        };
        if self.options.checks {
            return Err(what.into());
        }
        self.warnings.push(what);
        Ok(())
    }

    /// The shapes of the input and of the output.
    fn shapes(&mut self, bytes: &[u8], records: &Records, count: usize) -> Result<(Shape, Shape), Mistake> {
        let turn = |shape: Shape| if self.options.transposes { shape.turned() } else { shape };
        let (mut input, mut output) = (self.options.input, self.options.output);
        let reorders = self.options.reorders();
        if !reorders && output.columns == 0 {
            output.columns = input.columns;
        }
        if reorders || output == Shape::default() {
            input = input.or(turn(output));
        } else if output.rows == 0 && output.columns > 0 && input.records() > 0 {
            output.rows = input.records() / output.columns;
        }
        if input == Shape::default() && (reorders || output == Shape::default()) {
            input.columns = records.in_first_line(bytes);
        }
        if input == Shape::default() {
            // Input lines are as long as output lines.
            input = output;
        }
        // Further bytes may follow the last requested one.
        let used = if input.records() > 0 { input.records() } else { count };
        if used > count {
            return Err(format!("there are {count} records, expected {} × {}", input.rows, input.columns).into());
        }
        input = input.filled(used);
        output = output.or(if output.columns > 0 || output.rows > 0 { output.filled(used) } else { turn(input) });
        let rest = match records {
            Records::Text(_) => count - used,
            Records::Bytes { size } => bytes.len() - used * size,
        };
        if rest > 0 || input.records() != used {
            let Shape { rows, columns } = input;
            let what = match records {
                Records::Bytes { .. } if rest > 0 => {
                    format!("{rest} bytes follow {rows} × {columns} records, expected none")
                }
                _ => format!("there are {count} records, expected {rows} × {columns}"),
            };
            let is_text = matches!(records, Records::Text(_));
            if self.options.checks || reorders && is_text || input.records() != used {
                return Err(what.into());
            }
            self.warnings.push(what);
        }
        if output.records() != used {
            let Shape { rows, columns } = output;
            return Err(format!("there are {used} records, expected {rows} rows of {columns}").into());
        }
        Ok((input, output))
    }

    fn write_records(
        &self,
        text: &mut Text,
        bytes: &[u8],
        records: &Records,
        input: Shape,
        output: Shape,
    ) -> Result<(), Mistake> {
        for row in 0..output.rows {
            for column in 0..output.columns {
                let index = self.source_index(row, column, input, output);
                match records {
                    Records::Bytes { size } => text.push_bytes(&bytes[index * size..(index + 1) * size])?,
                    Records::Text(ranges) => {
                        let record = ranges.get(index).cloned().unwrap_or_default();
                        for (index, word) in words(&bytes[record]).enumerate() {
                            text.push_bytes(if index > 0 { b" " } else { b"" })?;
                            if self.options.checks {
                                check_number(word)?;
                            }
                            text.push_bytes(word)?;
                        }
                        text.push_bytes(if column + 1 < output.columns { b"\t" } else { b"\n" })?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Index of the input record at a position of the output.
    fn source_index(&self, row: usize, column: usize, input: Shape, output: Shape) -> usize {
        let transposed = |row: usize, column: usize| column * input.columns + row;
        match (self.options.blocks.len() > 1, self.options.transposes) {
            (false, false) => row * output.columns + column,
            (false, true) => transposed(row, column),
            (true, transposes) => {
                let index = index_in_blocks(&self.options.blocks, row, column);
                if transposes { transposed(index / input.rows, index % input.rows) } else { index }
            }
        }
    }
}

fn words(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    bytes.split(|byte| is_between(*byte)).filter(|word| !word.is_empty())
}

fn check_number(word: &[u8]) -> Result<(), Mistake> {
    match std::str::from_utf8(word).ok().and_then(whole_number) {
        Some(_) => Ok(()),
        None => Err(format!("\"{}\" is not a number", String::from_utf8_lossy(word)).into()),
    }
}

/// Blocks are consecutive in the input and side by side in the output.
fn index_in_blocks(levels: &[Shape], mut row: usize, mut column: usize) -> usize {
    let mut index = 0;
    for two in levels.windows(2) {
        let (whole, block) = (two[0], two[1]);
        index += row / block.rows * block.rows * whole.columns + column / block.columns * block.records();
        (row, column) = (row % block.rows, column % block.columns);
    }
    index + row * levels.last().map_or(0, |block| block.columns) + column
}

/// Takes a count from a header; an option may have set the same value.
fn agree(known: &mut usize, value: &str, what: &str) -> Result<(), Mistake> {
    let found =
        whole_count(value).ok_or_else(|| format!("the header has \"{value}\" {what}, expected a count above zero"))?;
    if *known > 0 && *known != found {
        return Err(format!("the header has {found} {what}, but the options request {known}").into());
    }
    *known = found;
    Ok(())
}

/// The ranges of the records.
enum Records {
    Text(Vec<Range<usize>>),
    Bytes {
        /// Size of a record.
        size: usize,
    },
}

impl Records {
    fn find(bytes: &[u8], format: Format, components: usize) -> Result<Records, Mistake> {
        if let Some(size) = format.size {
            return Ok(Records::Bytes { size: size.saturating_mul(components) });
        }
        let (mut ranges, mut words, mut begin, mut line) = (Vec::new(), 0, 0, 1);
        let mut at = 0;
        while at < bytes.len() {
            let is_word = !is_between(bytes[at]);
            let length = bytes[at..].iter().take_while(|byte| is_between(**byte) != is_word).count();
            if is_word {
                begin = if words == 0 { at } else { begin };
                words += 1;
                if words == components {
                    ranges.push(begin..at + length);
                    words = 0;
                }
            } else {
                let lines = bytes[at..at + length].iter().filter(|byte| **byte == b'\n').count();
                if lines > 0 && words > 0 {
                    return Err(broken(line, words, components));
                }
                line += lines;
            }
            at += length;
        }
        if words > 0 { Err(broken(line, words, components)) } else { Ok(Records::Text(ranges)) }
    }

    /// Number of records that begin in the first line.
    fn in_first_line(&self, bytes: &[u8]) -> usize {
        let Records::Text(ranges) = self else { return 0 };
        let begin = ranges.first().map_or(0, |first| first.start);
        let end = bytes[begin..].iter().position(|byte| *byte == b'\n').map_or(bytes.len(), |length| begin + length);
        ranges.partition_point(|range| range.start < end)
    }
}

fn broken(line: usize, words: usize, components: usize) -> Mistake {
    Mistake::Text(format!(
        "line {line} of the data ends after {words} of {components} components of a record; -fa1 is for single numbers"
    ))
}

fn is_between(byte: u8) -> bool {
    byte == 0 || is_blank(byte)
}
