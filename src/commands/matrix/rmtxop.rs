//! `rmtxop`: products, sums and quotients of matrices.
//!
//! `rmtxop [-v] [-f[adfc]] [-t] [-s F…] [-c coefficients|letters|file] [-C letters] [-rf|-rb]
//! matrix [.+*/ matrix]…`: options apply to the next matrix, or to the result if after the last
//! one. `.` is the matrix product, the default; `+ * /` are element-wise. `-t` transposes, `-s`
//! scales, `-c` transforms components. A BSDF file (`.xml`) is read as its transmission, with `-rf`
//! and `-rb` for its front and back reflection.

use super::input::{Change, format, mismatch, read_factor, result_format, wrong};
use crate::commands::words::Words;
use crate::disk::Commands;
use crate::failure::{Failure, Outcome, say};
use crate::input::use_default_threads;
use crate::output::write_standard_output;
use radsight_matrix::{Matrix, MatrixError, Stored, Wanted, product_of_chain};
use radsight_measured::Side;
use radsight_picture::Header;

/// The header line of Radiance about values of different kinds.
const MISMATCH_LINE: &str = "WARNING: data type mismatch";

/// A matrix with its changes.
struct Operand {
    source: String,
    change: Change,
    wanted: Wanted,
    /// The operation that joins it to what precedes it.
    operation: Operation,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Operation {
    /// Of matrices.
    Product,
    ByElement(ElementOperation),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ElementOperation {
    Sum,
    Multiplication,
    Division,
}

/// The command line.
struct Request {
    operands: Vec<Operand>,
    trailing: Change,
    format: Option<Stored>,
}

/// Runs the program.
pub(super) fn run(mut words: Words<'_>) -> Outcome {
    use_default_threads()?;
    let Request { operands, trailing, format } = Request::read(&mut words)?;
    let (program, commands) = (words.program(), words.commands());
    let result = combined(program, &operands, commands)?;
    let result = trailing.apply(program, "the result", result, commands)?;
    let mut header = Header::new("RADIANCE");
    header.push_command(words.all());
    header.push_body(&result.header);
    let written = result.write(&header, result_format(format, &result));
    write_standard_output(&written.map_err(|error| wrong(program, "the result", &error))?)
}

impl Request {
    fn read(words: &mut Words<'_>) -> Result<Request, Failure> {
        let usage = |what: &str| Failure::usage(format!("rmtxop: {what}"));
        let (mut operands, mut change, mut asked): (Vec<Operand>, Change, _) = (Vec::new(), Change::default(), None);
        let (mut wanted, mut operation, mut all) = (Wanted::Transmission, None, None);
        while let Some(word) = words.next_if(|_| true) {
            if let Some(found) = Operation::from_word(word) {
                if operands.is_empty() || operation.is_some() {
                    return Err(usage(&format!("\"{word}\" has no matrix before it")));
                }
                operation = Some(found);
            } else if word.len() < 2 || !word.starts_with('-') {
                if word == "-" && operands.iter().any(|operand| operand.source == "-") {
                    return Err(usage("standard input is named twice"));
                }
                let change = change.take_for_next(all.as_ref());
                let joined = operation.take().unwrap_or(Operation::Product);
                operands.push(Operand { source: word.to_owned(), change, wanted, operation: joined });
                wanted = Wanted::Transmission;
            } else if !change.take(words.meant(word)?, words, &mut all)? {
                match word {
                    "-v" => {}
                    "-t" => change.transposes = true,
                    "-rf" => wanted = Wanted::Reflection(Side::Front),
                    "-rb" => wanted = Wanted::Reflection(Side::Back),
                    _ => match word.strip_prefix("-f").and_then(format) {
                        Some(format) => asked = Some(format),
                        None => return Err(words.unknown(word)),
                    },
                }
            }
        }
        if operands.is_empty() {
            return Err(usage("no matrix is given"));
        }
        if operation.is_some() {
            return Err(usage("the last operation has no matrix after it"));
        }
        Ok(Request { operands, trailing: change, format: asked })
    }
}

impl Operation {
    fn from_word(word: &str) -> Option<Operation> {
        Some(match word {
            "." => Operation::Product,
            "+" => Operation::ByElement(ElementOperation::Sum),
            "*" => Operation::ByElement(ElementOperation::Multiplication),
            "/" => Operation::ByElement(ElementOperation::Division),
            _ => return None,
        })
    }
}

impl ElementOperation {
    fn join(self, program: &str, source: &str, mut left: Matrix, right: &Matrix) -> Result<Matrix, Failure> {
        let kinds = [left.stored, right.stored];
        let done = match self {
            ElementOperation::Sum => left.add(right),
            ElementOperation::Multiplication => left.multiply(right),
            ElementOperation::Division => left.divide(right).map(|zeros| {
                if zeros > 0 {
                    say(&format!("{program}: warning - {zeros} divisions by zero in \"{source}\" give zero\n"));
                }
            }),
        };
        done.map_err(|error: MatrixError| wrong(program, source, &error))?;
        warn_of_kinds(program, source, kinds, &mut left.header);
        Ok(left)
    }
}

impl Operand {
    fn load(&self, program: &str, commands: Commands) -> Result<Matrix, Failure> {
        let matrix = read_factor(program, &self.source, self.wanted, commands)?;
        self.change.apply(program, &self.source, matrix, commands)
    }
}

/// Combines the operands from the left. Products that follow each other are one chain, which may be
/// multiplied in any order; its first factor may be a sum.
fn combined(program: &str, operands: &[Operand], commands: Commands) -> Result<Matrix, Failure> {
    let mut chain: Vec<(&str, Matrix)> = Vec::new();
    for operand in operands {
        let (source, matrix) = (operand.source.as_str(), operand.load(program, commands)?);
        match operand.operation {
            Operation::ByElement(operation) if !chain.is_empty() => {
                let left = product(program, std::mem::take(&mut chain))?;
                chain.push((source, operation.join(program, source, left, &matrix)?));
            }
            _ => chain.push((source, matrix)),
        }
    }
    product(program, chain)
}

fn product(program: &str, chain: Vec<(&str, Matrix)>) -> Result<Matrix, Failure> {
    let (sources, matrices): (Vec<&str>, Vec<Matrix>) = chain.into_iter().unzip();
    let kinds: Vec<Stored> = matrices.iter().map(|matrix| matrix.stored).collect();
    let mut product = product_of_chain(matrices).map_err(|(index, error)| wrong(program, sources[index], &error))?;
    for (source, pair) in sources[1..].iter().zip(kinds.windows(2)) {
        warn_of_kinds(program, source, [pair[0], pair[1]], &mut product.header);
    }
    Ok(product)
}

/// Warns of values of different kinds, in the header too.
fn warn_of_kinds(program: &str, source: &str, kinds: [Stored; 2], header: &mut Header) {
    if kinds[0].with(kinds[1]).is_none() {
        say(&mismatch(program, source, kinds));
        header.push_line(MISMATCH_LINE);
    }
}
