//! `tabfunc [-i] NAME …`: converts a table on standard input to functions of one variable, in the
//! function language.
//!
//! The first column is the variable, each further one a function; the name `0` skips a column. With
//! `-i` values are interpolated; otherwise functions are defined at the tabulated values only.
//! Names of helper functions end with a hash of the table, where the real program uses its process
//! number.

use crate::arguments::Arguments;
use crate::number_text::leading_number;
use crate::text::{Text, general, is_space};
use crate::{Error, Invocation, Output};
use std::fmt::{self, Write};

/// Longest output line, unless a single number exceeds it.
const LINE: usize = 64;

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let mut interpolates = false;
    while let Some(option) = arguments.option()? {
        match option.name {
            "-i" => interpolates = true,
            _ => return Err(arguments.unknown()),
        }
    }
    arguments.required("func1")?;
    let names = &invocation.argv[arguments.position() - 1..];
    let content = String::from_utf8_lossy(invocation.standard_input()?);
    let table = Table::read(&content, names.len()).map_err(|mistake| Error::Input {
        program: arguments.program().to_owned(),
        source_name: "standard input".to_owned(),
        mistake,
    })?;
    let mut text = Text::default();
    if interpolates {
        writeln!(text, "interp_arr2`(i,x,f):(i+1-x)*f(i)+(x-i)*f(i+1);")?;
        writeln!(text, "interp_arr`(x,f):if(x-1,if(f(0)-x,interp_arr2`(floor(x),x,f),f(f(0))),f(1));")?;
    }
    let place = table.place(&mut text).map_err(|error| match error {
        PlaceError::Full(error) => Error::from(error),
        PlaceError::Turns { row } => Error::Input {
            program: arguments.program().to_owned(),
            source_name: "standard input".to_owned(),
            mistake: format!("row {row}: the variable is not monotonic, expected values that only rise or only fall"),
        },
    })?;
    for (name, column) in
        names.iter().zip(&table.columns).filter(|(name, _)| !name.is_empty() && !name.starts_with('0'))
    {
        let number = table.number;
        if interpolates {
            write!(text, "{name}`p{number}(i):select(i,")?;
            put_list(&mut text, column, 27 + name.len())?;
            writeln!(text, ");\n{name}(x):interp_arr`({place},{name}`p{number});")?;
        } else {
            write!(text, "{name}(x):select({place},")?;
            put_list(&mut text, column, name.len() + place.len() + 12)?;
            writeln!(text, ");")?;
        }
    }
    Ok(Output { standard_output: text.into_bytes(), warnings: arguments.warnings, ..Output::default() })
}

struct Table {
    /// The first column, with at least one row.
    variable: Vec<f64>,
    /// The other columns, of the same length.
    columns: Vec<Vec<f64>>,
    /// Distinguishes this table's helper functions from those of others.
    number: u32,
}

enum PlaceError {
    Full(fmt::Error),
    Turns { row: usize },
}

impl From<fmt::Error> for PlaceError {
    fn from(error: fmt::Error) -> Self {
        PlaceError::Full(error)
    }
}

impl Table {
    /// Lines that do not begin with a number are skipped.
    fn read(content: &str, count: usize) -> Result<Table, String> {
        let mut table = Table { variable: Vec::new(), columns: vec![Vec::new(); count], number: fingerprint(content) };
        for (line, number) in content.lines().zip(1..) {
            let Some((value, end)) = leading_number(line) else { continue };
            table.variable.push(value);
            let mut rest = &line[end..];
            for (column, found) in table.columns.iter_mut().zip(1..) {
                rest = rest.trim_start_matches(is_delimiter);
                if rest.is_empty() {
                    let found = found - 1;
                    return Err(format!(
                        "line {number}: {found} columns beside the variable, expected {count}, one for each function"
                    ));
                }
                let value =
                    leading_number(rest).filter(|(_, end)| rest[*end..].chars().next().is_none_or(is_delimiter));
                let (value, end) = value
                    .ok_or_else(|| format!("line {number}: column {found} beside the variable is not a number"))?;
                column.push(value);
                rest = &rest[end..];
            }
        }
        if table.variable.is_empty() {
            return Err("no line begins with a number, expected rows of a table".to_owned());
        }
        Ok(table)
    }

    /// Writes the helper functions that find the row of `x`. Returns the expression for the row,
    /// counted from 1, with a fraction between rows.
    fn place(&self, text: &mut Text) -> Result<String, PlaceError> {
        let [first, second, ..] = self.variable[..] else { return Ok("1".to_owned()) };
        let step = second - first;
        let tolerance = 1e-3 * step.abs();
        let mut uniform = true;
        for (row, two) in (2..).zip(self.variable.windows(2)) {
            uniform &= (two[1] - two[0] - step).abs() <= tolerance;
            let turns = if step > 0.0 { two[1] <= two[0] } else { two[1] >= two[0] };
            if turns {
                return Err(PlaceError::Turns { row });
            }
        }
        let g = |value: f64| general(value, 6);
        if !uniform {
            return self.uneven_place(text);
        }
        Ok(if step > 0.0 && (step - 1.0).abs() < tolerance {
            if (first - 1.0).abs() < tolerance { "x".to_owned() } else { format!("x-{}", g(first - 1.0)) }
        } else if first.abs() < tolerance {
            format!("x/{}+1", g(step))
        } else {
            format!("(x-{})/{}+1", g(first), g(step))
        })
    }

    fn uneven_place(&self, text: &mut Text) -> Result<String, PlaceError> {
        let rises = self.variable[1] > self.variable[0];
        let (number, rows) = (self.number, self.variable.len());
        let [first, last] = [self.variable[0], self.variable[rows - 1]].map(|value| general(value, 6));
        write!(text, "X`p{number}(i):select(i,")?;
        put_list(text, &self.variable, 20)?;
        writeln!(text, ");")?;
        let beyond = if rises { format!("x-X`p{number}(i)") } else { format!("X`p{number}(i)-x") };
        writeln!(text, "fx2`p{number}(x,i):if({beyond},")?;
        writeln!(text, "\ti+(x-X`p{number}(i))/(X`p{number}(i+1)-X`p{number}(i)),\n\tfx2`p{number}(x,i-1));")?;
        let (after, before) = if rises {
            (format!("x-{first}"), format!("{last}-x"))
        } else {
            (format!("{first}-x"), format!("x-{last}"))
        };
        writeln!(text, "fx`p{number}(x):if({after},if({before},fx2`p{number}(x,{rows}),{rows}),1);")?;
        Ok(format!("fx`p{number}(x)"))
    }
}

fn is_delimiter(character: char) -> bool {
    is_space(character) || character == ','
}

/// FNV-1a, a 32-bit hash: G. Fowler, L. C. Noll, K.-P. Vo, D. Eastlake, "The FNV Non-Cryptographic
/// Hash Algorithm", IETF draft.
fn fingerprint(content: &str) -> u32 {
    content.bytes().fold(0x811c_9dc5, |hash: u32, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193))
}

/// Writes numbers after commas, in lines; `column` is the start column of the list.
fn put_list(text: &mut Text, values: &[f64], mut column: usize) -> fmt::Result {
    for (place, value) in values.iter().enumerate() {
        let digits = general(*value, 7).to_string();
        column += digits.len() + 1;
        if column >= LINE {
            text.write_str("\n")?;
            column = digits.len() + 1;
        }
        text.write_str(&digits)?;
        if place + 1 < values.len() {
            text.write_str(",")?;
        }
    }
    Ok(())
}
