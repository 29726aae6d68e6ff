//! `ev expression …`: prints the values of expressions, one per line.

use std::fmt::Write;

use radsight_cal::Environment;

use crate::arguments::Arguments;
use crate::functions::Functions;
use crate::text::{Text, general};
use crate::{Error, Invocation, Output};

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let mut functions = Functions::over(Environment::new(), &arguments);
    let mut text = Text::default();
    while let Some(expression) = arguments.word() {
        let value = functions.number(expression, "expression", arguments.position() - 1)?;
        writeln!(text, "{}", general(value, 9))?;
    }
    Ok(Output { standard_output: text.into_bytes(), warnings: functions.all_warnings(arguments), files: Vec::new() })
}
