//! `rcalc [-b] [-l] [-n] [-p|-P] [-w] [-u] [-tS] [-s svar=sval] [-e expr] [-f source] [-i infmt]
//! [-o outfmt] [file …]`: computes records from records.
//!
//! Columns of the input are `$1`, `$2`, …; columns of the output are the definitions of `$1`, `$2`,
//! …. A record passes if `cond` is above zero; `recno` and `outno` count records. `-i` and `-o`
//! give formats instead of columns, `-id3` `-if` `-od` `-of` (and `D`, `F` with swapped bytes)
//! binary numbers, `-in` and `-on` the largest number of records. `-b` matches blanks literally,
//! `-l` treats line ends as blanks, `-t` sets the separator, `-s` a string variable. `-p` copies
//! input that does not match the format, `-P` also records that `cond` rejects. `-n` reads nothing
//! and writes one record. `-w` and `-u` have no effect: output is always flushed before input is
//! awaited.

use std::cell::Cell;

use radsight_cal::{Environment, Handle, Host, Slot};
use radsight_loader::FileKind;

use crate::arguments::Arguments;
use crate::functions::Functions;
use crate::matching::{Blanks, Matcher, Passing, Strings};
use crate::record_format::{self, Field};
use crate::record_output::{self, OutputField};
use crate::records::{Encoding, InputForm, Record, encode};
use crate::supply::Supply;
use crate::text::{Text, general};
use crate::{Error, Invocation, Output};

struct Options {
    input: InputForm,
    input_format: Option<Vec<Field>>,
    output: Encoding,
    output_format: Option<Vec<OutputField>>,
    across_lines: bool,
    passing: Passing,
    no_input: bool,
    no_warnings: bool,
    most_input: usize,
    most_output: usize,
}

impl Options {
    /// Whether enough records were read or written.
    fn is_enough(&self, records: usize, written: usize) -> bool {
        records == self.most_input || written > 0 && written == self.most_output
    }
}

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let mut environment = Environment::new();
    environment.set_constant("PI", std::f64::consts::PI);
    environment.offer_function("in", 1);
    let mut calculator = Calculator {
        functions: Functions::over(environment, &arguments),
        strings: Strings::default(),
        text: invocation.text(),
        outputs: Vec::new(),
        condition: None,
        counts: [None; 2],
        program: arguments.program().to_owned(),
    };
    let options = calculator.read_options(&mut arguments, invocation)?;
    calculator.check(&options, &arguments)?;
    calculator.outputs = calculator.functions.environment.outputs();
    let environment = &mut calculator.functions.environment;
    calculator.counts = ["recno", "outno"].map(|name| environment.is_mentioned(name).then(|| environment.slot(name)));
    if options.no_input {
        calculator.put_record(&options, &Channels::none())?;
    } else {
        for name in arguments.files() {
            calculator.execute(&options, invocation.supply(name, FileKind::Input)?)?;
        }
    }
    let standard_output = calculator.text.finish()?;
    if options.no_warnings {
        calculator.functions.warnings.clear();
    }
    Ok(Output { standard_output, warnings: calculator.functions.all_warnings(arguments), ..Output::default() })
}

struct Calculator {
    functions: Functions,
    strings: Strings,
    text: Text,
    outputs: Vec<(u32, Handle)>,
    condition: Option<Handle>,
    /// `recno` and `outno`, if they are used.
    counts: [Option<Slot>; 2],
    program: String,
}

impl Calculator {
    fn read_options(&mut self, arguments: &mut Arguments<'_>, invocation: &Invocation<'_>) -> Result<Options, Error> {
        let ascii = InputForm { encoding: Encoding::Ascii, columns: 0, separator: b'\t', blanks_join: true };
        let mut options = Options {
            input: ascii,
            input_format: None,
            output: Encoding::Ascii,
            output_format: None,
            across_lines: false,
            passing: Passing::Nothing,
            no_input: false,
            no_warnings: false,
            most_input: 0,
            most_output: 0,
        };
        while let Some(option) = arguments.option_before_files()? {
            match option.name {
                "-b" => options.input.blanks_join = !options.input.blanks_join,
                "-l" => options.across_lines = !options.across_lines,
                "-p" => options.passing = Passing::Unmatched,
                "-P" => options.passing = Passing::UnmatchedAndRefused,
                "-t" => options.input.take_separator(option.text, arguments)?,
                "-s" => self.strings.preset(arguments.required("svar=sval (-s)")?),
                "-f" => self.functions.take_file(arguments, invocation.loader)?,
                "-e" => self.functions.take_definitions(arguments)?,
                "-n" => options.no_input = true,
                "-w" => options.no_warnings = true,
                "-u" => {}
                "-i" if option.text.is_empty() => {
                    options.input = InputForm { encoding: Encoding::Ascii, columns: 0, ..options.input };
                    options.input_format = Some(read_format(arguments, invocation, &options)?);
                }
                "-o" if option.text.is_empty() => {
                    options.output = Encoding::Ascii;
                    let position = arguments.position();
                    let fields = read_format(arguments, invocation, &options)?;
                    options.output_format = Some(self.output_fields(fields, position)?);
                }
                "-in" => options.most_input = arguments.integer("most records (-in)")?.max(0) as usize,
                "-on" => options.most_output = arguments.integer("most records (-on)")?.max(0) as usize,
                "-i" => options.input.take_encoding(option.text, arguments)?,
                "-o" => {
                    options.output = Encoding::of_text(option.text).ok_or_else(|| arguments.unknown())?;
                }
                _ => return Err(arguments.unknown()),
            }
        }
        Ok(options)
    }

    fn output_fields(&mut self, fields: Vec<Field>, argument: usize) -> Result<Vec<OutputField>, Error> {
        let mut converted = Vec::with_capacity(fields.len());
        for field in fields {
            converted.push(match field {
                Field::Literal(bytes) => OutputField::Literal(bytes),
                Field::Text { name, width } => OutputField::Text { name, width },
                Field::Number { name, width } => {
                    let handle = self.functions.expression(&name, "output format", argument)?;
                    OutputField::Number { handle, width }
                }
            });
        }
        Ok(converted)
    }

    /// Checks the combination of options.
    fn check(&mut self, options: &Options, arguments: &Arguments<'_>) -> Result<(), Error> {
        if options.no_input && !arguments.rest().is_empty() {
            return Err(arguments.mistake(arguments.position(), "a file cannot be read with -n"));
        }
        let both_formats = options.input_format.is_some() && options.output_format.is_some();
        if options.passing != Passing::Nothing && !options.no_input && !both_formats {
            return Err(arguments.impossible("options -p and -P require -i and -o formats"));
        }
        let environment = &mut self.functions.environment;
        if environment.is_constant("cond") && !options.no_input {
            return Err(arguments.impossible("cond is defined as a constant"));
        }
        if environment.is_variable("cond") {
            self.condition = Some(environment.variable("cond"));
        }
        Ok(())
    }

    /// Processes all records of one input. A mistake is reported with the position of its record.
    fn execute(&mut self, options: &Options, mut input: Supply<'_>) -> Result<(), Error> {
        let mut records = 0;
        let name = input.name().to_owned();
        let unit = if matches!(options.input.encoding, Encoding::Ascii) && options.input_format.is_none() {
            "line"
        } else {
            "record"
        };
        let executed = match &options.input_format {
            Some(fields) => self.execute_matched(options, fields, input, &mut records),
            None => self.execute_columns(options, &mut input, &mut records),
        };
        executed.map_err(|error| self.at(error, &name, &format!("{unit} {records}")))
    }

    fn at(&self, error: Error, source_name: &str, place: &str) -> Error {
        let program = self.program.clone();
        match error {
            Error::Impossible { mistake, .. } => {
                Error::Input { program, source_name: source_name.to_owned(), mistake: format!("{place}: {mistake}") }
            }
            Error::Expression { message, argument, .. } => {
                Error::Expression { program, message: format!("{source_name}, {place}:\n{message}"), argument }
            }
            other => other,
        }
    }

    fn execute_columns(&mut self, options: &Options, input: &mut Supply<'_>, records: &mut usize) -> Result<(), Error> {
        let mut written = 0;
        while let Some(record) = options.input.next_record(input, &mut self.text)? {
            let channels = Channels::of(record);
            if self.accepts(records, written, &channels)? {
                self.put_record(options, &channels)?;
                written += 1;
            }
            if options.is_enough(*records, written) {
                break;
            }
        }
        Ok(())
    }

    fn execute_matched(
        &mut self,
        options: &Options,
        fields: &[Field],
        input: Supply<'_>,
        records: &mut usize,
    ) -> Result<(), Error> {
        let blanks = Blanks { join: options.input.blanks_join, across_lines: options.across_lines };
        let mut matcher = Matcher::new(fields, input, blanks, options.passing);
        let mut written = 0;
        while matcher.next_record(&mut self.strings, &mut self.text)? {
            if matcher.is_empty_match() {
                let mistake = "the input format matches the empty text, so it would match forever".to_owned();
                return Err(Error::Impossible { program: self.program.clone(), mistake });
            }
            for (name, value) in matcher.numbers() {
                self.functions.environment.set_variable(name, *value);
            }
            let channels = Channels::none();
            let accepted = self.accepts(records, written, &channels)?;
            if accepted {
                matcher.accept();
                self.put_record(options, &channels)?;
                written += 1;
            } else {
                matcher.refuse(&mut self.text)?;
            }
            if options.is_enough(*records, written) {
                break;
            }
        }
        Ok(())
    }

    /// Counts a record and returns whether it passes.
    fn accepts(&mut self, records: &mut usize, written: usize, channels: &Channels<'_>) -> Result<bool, Error> {
        *records += 1;
        for (slot, value) in self.counts.into_iter().zip([*records, written + 1]) {
            if let Some(slot) = slot {
                self.functions.environment.set(slot, value as f64);
            }
        }
        match self.condition {
            Some(condition) => Ok(self.value(condition, channels)? > 0.0),
            None => Ok(true),
        }
    }

    fn value(&mut self, handle: Handle, channels: &Channels<'_>) -> Result<f64, Error> {
        let value = self.functions.value(handle, &[], channels)?;
        match channels.illegal.get() {
            Some(mistake) => Err(Error::Impossible { program: self.program.clone(), mistake: mistake.to_owned() }),
            None => Ok(value),
        }
    }

    fn put_record(&mut self, options: &Options, channels: &Channels<'_>) -> Result<(), Error> {
        if let Some(fields) = &options.output_format {
            return self.put_fields(fields, options, channels);
        }
        // The current column, from 1.
        let mut column = 1;
        let mut wrote = false;
        for index in 0..self.outputs.len() {
            let (channel, handle) = self.outputs[index];
            let value = self.value(handle, channels)?;
            match options.output {
                Encoding::Ascii => {
                    while column < channel {
                        self.text.push_bytes(&[options.input.separator])?;
                        column += 1;
                    }
                    self.text.number(general(value, 9))?;
                }
                Encoding::Binary(number) => {
                    while column < channel {
                        encode(&mut self.text, 0.0, number)?;
                        column += 1;
                    }
                    encode(&mut self.text, value, number)?;
                    column += 1;
                }
            }
            wrote = true;
        }
        if wrote && options.output == Encoding::Ascii {
            self.text.push_bytes(b"\n")?;
        }
        Ok(())
    }

    fn put_fields(&mut self, fields: &[OutputField], options: &Options, channels: &Channels<'_>) -> Result<(), Error> {
        let mut writer = record_output::Writer::new(fields, &options.input);
        for (index, field) in fields.iter().enumerate() {
            match field {
                OutputField::Literal(bytes) => writer.literal(&mut self.text, bytes)?,
                OutputField::Text { name, width } => match self.strings.value(name) {
                    Some(value) => writer.string(&mut self.text, index, value, *width)?,
                    None => {
                        let mistake = format!("string \"{name}\" is undefined");
                        return Err(Error::Impossible { program: self.program.clone(), mistake });
                    }
                },
                OutputField::Number { handle, width } => {
                    let value = self.value(*handle, channels)?;
                    writer.number(&mut self.text, index, value, *width)?;
                }
            }
        }
        Ok(())
    }
}

fn read_format(
    arguments: &mut Arguments<'_>,
    invocation: &Invocation<'_>,
    options: &Options,
) -> Result<Vec<Field>, Error> {
    let position = arguments.position();
    let specification = arguments.required("record format")?;
    let from_file = match specification.contains('$') {
        true => None,
        false => Some(invocation.loader.load(specification, FileKind::Input)?.bytes),
    };
    let bytes = from_file.as_deref().unwrap_or(specification.as_bytes());
    let fields = if options.across_lines { record_format::read(bytes) } else { record_format::read_line(bytes) };
    fields.map_err(|mistake| arguments.mistake(position, format!("record format: {mistake}")))
}

/// The columns of a record.
struct Channels<'a> {
    record: Option<Record<'a>>,
    /// The error of an access to a column without a value.
    illegal: Cell<Option<&'static str>>,
    /// Cached columns.
    known: [Cell<Option<f64>>; 32],
}

impl<'a> Channels<'a> {
    fn of(record: Record<'a>) -> Self {
        Channels { record: Some(record), illegal: Cell::new(None), known: std::array::from_fn(|_| Cell::new(None)) }
    }

    fn none() -> Channels<'static> {
        Channels { record: None, illegal: Cell::new(None), known: std::array::from_fn(|_| Cell::new(None)) }
    }
}

impl Host for Channels<'_> {
    fn channel(&self, channel: u32) -> f64 {
        let column = channel as usize;
        let Some(record) = &self.record else {
            self.illegal.set(Some("no column input: $N has no value with -n or with an input format"));
            return 0.0;
        };
        if column == 0 {
            self.illegal.set(Some("illegal channel number 0"));
            return 0.0;
        }
        let Some(cell) = self.known.get(column - 1) else { return record.column(column) };
        let value = cell.get().unwrap_or_else(|| record.column(column));
        cell.set(Some(value));
        value
    }

    /// `in(n)` is column n, and the number of columns for n = 0.
    fn call(&self, _function: u32, arguments: &[f64]) -> f64 {
        let column = (arguments.first().copied().unwrap_or(0.0) + 0.5) as i64;
        match (column, &self.record) {
            (0, Some(record)) => record.columns() as f64,
            (0, None) => 0.0,
            (column, _) => self.channel(u32::try_from(column).unwrap_or(0)),
        }
    }
}
