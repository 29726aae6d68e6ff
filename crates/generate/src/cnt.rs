//! `cnt N0 [N1 …]`: counts. Each line has one number for each argument, the last running fastest.
//!
//! The real program's option `-s`, which shuffles the lines by the clock, is refused: a scene must not change by itself.

use std::fmt::Write;

use crate::arguments::Arguments;
use crate::{Error, Invocation, Output};

const USAGE: &str = "cnt N0 [N1 ..]";

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv, USAGE);
    if arguments.peek().is_some_and(|word| word.starts_with("-s")) {
        let position = arguments.position();
        return Err(arguments.mistake(position, "-s shuffles by the clock, so that each run would give another scene"));
    }
    let mut limits = Vec::new();
    loop {
        let position = arguments.position();
        let limit = arguments.count("count")?;
        if limit < 2 {
            return Err(arguments.mistake(position, format!("count is {limit}, expected at least 2")));
        }
        limits.push(limit);
        if arguments.peek().is_none() {
            break;
        }
    }
    let lines = limits.iter().map(|limit| *limit as f64).product::<f64>();
    let mut text = invocation.text();
    text.expect_room(lines, 2.0 * limits.len() as f64 + 1.0)?;
    let mut counters = vec![0; limits.len()];
    loop {
        for counter in &counters {
            write!(text, "\t{counter}")?;
        }
        text.write_str("\n")?;
        let Some(place) = (0..limits.len()).rev().find(|place| counters[*place] + 1 < limits[*place]) else { break };
        counters[place] += 1;
        counters[place + 1..].fill(0);
    }
    Ok(Output { standard_output: text.finish()?, warnings: arguments.warnings, files: Vec::new() })
}
