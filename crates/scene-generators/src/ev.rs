//! `ev expression …`: prints the values of expressions, one per line.

use std::fmt::Write;

use radsight_cal::Environment;

use crate::arguments::Arguments;
use crate::functions::Functions;
use crate::text::general;
use crate::{Error, Invocation, Output};

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let mut functions = Functions::over(Environment::new(), &arguments);
    let mut text = invocation.text();
    while let Some(expression) = arguments.word() {
        match functions.number(expression, "expression", arguments.position() - 1) {
            Ok(value) => writeln!(text, "{}", general(value, 9))?,
            Err(error) => {
                // As in Radiance, the values before a mistake are printed.
                text.finish()?;
                return Err(error);
            }
        }
    }
    Ok(Output { standard_output: text.finish()?, warnings: functions.all_warnings(arguments), ..Output::default() })
}
