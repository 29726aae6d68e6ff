//! The function files of real Radiance, evaluated by `rcalc` and by this crate, and radsight's
//! equivalents of them.

use crate::close;
use crate::oracle::{Radiance, to_bytes, to_numbers};
use crate::writer::Dice;
use radsight_cal::{Definitions, Environment, Handle};
use radsight_diag::SourceMap;
use std::path::{Path, PathBuf};

/// Number of channels of a ray; arguments of functions follow them.
pub(crate) const CHANNELS: usize = 37;
pub(crate) const ARGUMENTS: usize = 12;
const RECORDS: usize = 24;

/// Real arguments, as a scene would give them.
const REAL_ARGUMENTS: &str = "arg(n) = if(n-.5, select(n, .4, 1.3, 2.2, .7, 1.5, 3.1, .2, .8, 1.1, .9, .35, 1.7,
    .6, 1.2, .45, 2.1, .75, 1.4, .3, .95, 1.6, .55, .85, 1.05, .65), 25); PI : 3.14159265358979323846;";

/// Definitions that `pcomb` provides, and a function to pass to functions.
const OF_PICTURES: &str = "xmax : 64; ymax : 48; xres : 64; yres : 48; nfiles : 2; we : 179;
    ri(i) = .3+.1*i; gi(i) = .4+.05*i; bi(i) = .2+.2*i; li(i) = .3+.1*i; re(i) : 1; ge(i) : 1; be(i) : 1; le(i) : 1; pa(i) : 1;
    some_function(i) = .4+.3*i-.02*i*i;";

/// Definitions of a file: names and numbers of arguments (0 for a variable).
pub(crate) fn definitions(text: &str) -> Vec<(String, usize)> {
    let mut depth = 0;
    let bare: String = text
        .chars()
        .filter(|&c| {
            depth += i32::from(c == '{') - i32::from(c == '}');
            depth == 0 && c != '}'
        })
        .collect();
    let mut found: Vec<(String, usize)> = Vec::new();
    for statement in bare.split(';') {
        let Some((head, _)) = statement.split_once(['=', ':']) else { continue };
        let (name, arguments) = head.trim().split_once('(').unwrap_or((head.trim(), ""));
        let is_name = |c: char| c.is_ascii_alphanumeric() || "_.`".contains(c);
        if name.is_empty() || !name.chars().all(is_name) {
            continue;
        }
        let arity = if arguments.is_empty() { 0 } else { arguments.split(',').count() };
        found.retain(|(known, _)| known != name);
        found.push((name.to_owned(), arity));
    }
    found
}

/// A call whose arguments are columns of a record, or functions where a bit of `functions` is set.
pub(crate) fn call(name: &str, arity: usize, functions: usize) -> String {
    let argument = |index| match functions >> index & 1 {
        0 => format!("${}", CHANNELS + 1 + index),
        _ => "some_function".to_owned(),
    };
    let arguments: Vec<String> = (0..arity).map(argument).collect();
    if arity == 0 { name.to_owned() } else { format!("{name}({})", arguments.join(",")) }
}

pub(crate) type Record = [f64; CHANNELS + ARGUMENTS];

/// Rays with an intersection, and arguments of several magnitudes.
pub(crate) fn records() -> Vec<Record> {
    let mut dice = Dice::new(3);
    let mut uniform = move || dice.below(1 << 20) as f64 / (1 << 20) as f64;
    (0..RECORDS)
        .map(|record| {
            let mut values = [0.0; CHANNELS + ARGUMENTS];
            values[..CHANNELS].fill_with(|| 2.0 * uniform() - 1.0);
            for vector in [0, 3, 27, 34] {
                let length = values[vector..vector + 3].iter().map(|x| x * x).sum::<f64>().sqrt();
                values[vector..vector + 3].iter_mut().for_each(|x| *x /= length);
            }
            // T, S and Ts are positive.
            for positive in [9, 11, 24] {
                values[positive] = 0.5 + uniform();
            }
            for (index, value) in values[CHANNELS..].iter_mut().enumerate() {
                *value = match (record + index / 4) % 7 {
                    0 | 1 => uniform(),
                    2 => 2.0 * uniform() - 1.0,
                    3 => 100.0 * uniform(),
                    5 => 400.0 + 300.0 * uniform(),
                    4 => 1.0 + (8.0 * uniform()).floor(),
                    _ => 1.0 + 2.0 * uniform(),
                };
            }
            values
        })
        .collect()
}

/// Function files loaded as `rcalc` loads them, one after the other without scopes.
struct Ours {
    environment: Environment,
    sources: SourceMap,
}

impl Ours {
    fn load(texts: &[&str]) -> Result<Ours, String> {
        let mut ours =
            Ours { environment: Environment::over(Definitions::with_initial_library()), sources: SourceMap::default() };
        for text in [REAL_ARGUMENTS, OF_PICTURES].iter().chain(texts) {
            let source = ours.sources.add("x.cal", text.as_bytes(), None);
            ours.environment.define(source, text.as_bytes()).map_err(|problems| ours.render(&problems))?;
        }
        Ok(ours)
    }

    fn render(&self, problems: &[radsight_diag::Diagnostic]) -> String {
        problems.iter().map(|problem| problem.render(&self.sources)).collect()
    }

    fn expression(&mut self, text: &str) -> Result<Handle, String> {
        let source = self.sources.add("-e", text.as_bytes(), None);
        self.environment.expression(source, text.as_bytes()).map_err(|problem| self.render(&[problem]))
    }

    /// The value, and whether it is without a fault.
    fn value(&mut self, handle: &Result<Handle, String>, record: &[f64]) -> Result<(f64, bool), String> {
        match self.environment.eval(handle.clone()?, &[], record) {
            Ok(value) => Ok((value, self.environment.warnings().is_empty())),
            Err(problems) => Err(self.render(&problems)),
        }
    }
}

/// `rcalc` with the same files as [`Ours`].
struct Theirs<'r> {
    radiance: &'r Radiance,
    file: &'r Path,
    input: Vec<u8>,
}

impl Theirs<'_> {
    /// Values by expression and record, or the error of `rcalc`.
    fn run(&self, calls: &[String], extra: &str) -> Result<Vec<Vec<f64>>, String> {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: String| {
            let path = folder.path().join(name);
            std::fs::write(&path, text).unwrap();
            path
        };
        let variables = radsight_cal::library::file("ray_variables.cal").unwrap();
        let outputs: String = calls.iter().enumerate().map(|(at, call)| format!("${}={call};", at + 1)).collect();
        let files = [
            write("prelude.cal", [variables, REAL_ARGUMENTS].concat()),
            self.radiance.lib.as_ref().unwrap().join("rayinit.cal"),
            write("pictures.cal", OF_PICTURES.to_owned()),
            write("extra.cal", extra.to_owned()),
            self.file.to_owned(),
            write("outputs.cal", outputs),
        ];
        let mut arguments = vec!["-w".to_owned(), format!("-id{}", CHANNELS + ARGUMENTS), "-od".to_owned()];
        for file in files {
            arguments.extend(["-f".to_owned(), file.display().to_string()]);
        }
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let numbers = to_numbers(&self.radiance.try_run("rcalc", &arguments, &self.input)?);
        if numbers.len() != calls.len() * RECORDS {
            return Err(String::new());
        }
        Ok((0..calls.len()).map(|at| numbers.iter().skip(at).step_by(calls.len()).copied().collect()).collect())
    }

    /// The values of each expression that `rcalc` accepts.
    fn values(&self, calls: &[String]) -> Vec<Option<Vec<f64>>> {
        match (self.run(calls, ""), calls.len()) {
            (Ok(values), _) => values.into_iter().map(Some).collect(),
            (Err(_), 0..=1) => vec![None; calls.len()],
            (Err(_), count) => {
                let (left, right) = calls.split_at(count / 2);
                [self.values(left), self.values(right)].concat()
            }
        }
    }

    /// The values of a function that `rcalc` does not accept with numbers alone: with functions as
    /// arguments, and with definitions for what it finds undefined. The call, the definitions and
    /// the values.
    fn coax(&self, name: &str, arity: usize) -> Option<(String, String, Vec<f64>)> {
        for functions in 0..1 << arity.min(5) {
            let call = call(name, arity, functions);
            let mut extra = String::new();
            for _ in 0..12 {
                match self.run(std::slice::from_ref(&call), &extra) {
                    Ok(mut values) => return Some((call, extra, values.swap_remove(0))),
                    Err(message) => match definition_for(&message) {
                        Some(text) if !extra.contains(&text) => extra += &text,
                        _ => break,
                    },
                }
            }
        }
        None
    }
}

/// A definition of the name that `rcalc` reports as undefined, if that is its error.
fn definition_for(message: &str) -> Option<String> {
    let (name, complaint) = message.lines().last()?.split_once(": undefined ")?;
    let number = 0.3 + name.bytes().map(f64::from).sum::<f64>() % 17.0 / 20.0;
    Some(match complaint {
        "variable" => format!("{name}:{number};"),
        _ => format!("{}(i)=.2+{number}*i-.01*i*i;", name.trim_end_matches("()")),
    })
}

fn function_files(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "cal"))
        .collect();
    files.sort();
    files
}

/// Compares the values of one call; returns the number of compared points.
fn compare(
    ours: &mut Ours,
    call: &str,
    theirs: &[f64],
    records: &[Record],
    radiance: &Radiance,
) -> Result<usize, String> {
    let handle = ours.expression(call);
    let mut compared = 0;
    for (record, &theirs) in records.iter().zip(theirs) {
        let (value, clean) = ours.value(&handle, record)?;
        if !clean && !radiance.sees_faults {
            continue;
        }
        let same = close(value, theirs) || (value.is_nan() && theirs.is_nan());
        if !same {
            return Err(format!("is {value}, rcalc has {theirs} at {record:?}"));
        }
        compared += 1;
    }
    Ok(compared)
}

#[test]
fn functions_of_the_library_have_the_values_of_rcalc() {
    let Some(radiance) = Radiance::find() else { return };
    let Some(lib) = &radiance.lib else { return };
    let records = records();
    let (mut functions, mut points, mut left_out) = (0, 0, Vec::new());
    for file in function_files(lib) {
        let text = String::from_utf8_lossy(&std::fs::read(&file).unwrap()).into_owned();
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        let theirs = Theirs { radiance: &radiance, file: &file, input: to_bytes(records.as_flattened()) };
        let defined = definitions(&text);
        let calls: Vec<String> = defined.iter().map(|(name, arity)| call(name, *arity, 0)).collect();
        let values = theirs.values(&calls);
        let mut ours = Ours::load(&[&text]);
        for ((call, (function, arity)), values) in calls.into_iter().zip(&defined).zip(values) {
            let result = match (values, &mut ours) {
                (Some(values), Ok(ours)) => compare(ours, &call, &values, &records, &radiance),
                (Some(_), Err(problems)) => Err(problems.clone()),
                (None, _) => match theirs.coax(function, *arity) {
                    Some((call, extra, values)) => Ours::load(&[&extra, &text])
                        .and_then(|mut ours| compare(&mut ours, &call, &values, &records, &radiance)),
                    None => Ok(0),
                },
            };
            match result {
                Ok(0) => left_out.push(format!("{name}: {call}")),
                Ok(compared) => (functions, points) = (functions + 1, points + compared),
                // Definitions made up by the test may be invalid, which not every build detects.
                Err(problem) if problem.contains("bad constant") && !radiance.sees_faults => {
                    left_out.push(format!("{name}: {call}"));
                }
                Err(problem) => panic!("{name}: {call}: {problem}"),
            }
        }
    }
    println!("{functions} functions compared with rcalc at {points} points; {} left out: {left_out:?}", left_out.len());
    assert!(functions > 1000, "only {functions} functions compared");
}
