//! Compares thousands of generated programs with `rcalc`.

use crate::close;
use crate::oracle::{Radiance, to_bytes, to_numbers};
use crate::writer::{Dice, program_text};
use radsight_cal::Environment;
use radsight_diag::SourceMap;
use std::fmt::Write;

const PROGRAMS: u64 = 8000;
const RECORDS: usize = 6;

/// Definitions and expressions of one program, under unique names.
fn numbered(seed: u64) -> (String, [String; 2]) {
    let (text, roots) = program_text(&mut Dice::new(seed + 90_000));
    let rename = |text: &str| {
        let mut renamed = text.to_owned();
        for name in ["f0(", "f1(", "f2("] {
            renamed = renamed.replace(name, &format!("f{seed}_{}", &name[1..]));
        }
        for name in ["v0", "v1", "v2"] {
            renamed = renamed.replace(name, &format!("v{seed}_{}", &name[1..]));
        }
        renamed
    };
    (rename(&text), roots.map(|root| rename(&root)))
}

/// radsight's values of one program, and whether each is without a fault; `None` if a constant is
/// invalid.
fn ours(text: &str, records: &[[f64; 4]]) -> Option<Vec<[(f64, bool); 2]>> {
    let mut environment = Environment::new();
    let mut sources = SourceMap::default();
    let source = sources.add("-e", text.as_bytes(), None);
    environment.define(source, text.as_bytes()).ok()?;
    let mut evaluate = |record: &[f64; 4]| {
        let values = environment.eval_outputs(&record[..]).unwrap().to_vec();
        let clean = environment.warnings().is_empty();
        [(values[0].1, clean), (values[1].1, clean)]
    };
    Some(records.iter().map(&mut evaluate).collect())
}

/// A program, and radsight's values of it by record.
struct Expected {
    seed: u64,
    values: Vec<[(f64, bool); 2]>,
}

/// Values of `rcalc` by record, then by program. A build that does not detect faults may stop at
/// one; such a program is left out.
fn theirs(radiance: &Radiance, programs: &[Expected], records: &[[f64; 4]]) -> Vec<Vec<Option<[f64; 2]>>> {
    let mut all = String::new();
    for (index, expected) in programs.iter().enumerate() {
        let (text, [first, second]) = numbered(expected.seed);
        writeln!(all, "{text}${}={first};\n${}={second};", 2 * index + 1, 2 * index + 2).unwrap();
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("x.cal");
    std::fs::write(&file, &all).unwrap();
    let arguments = ["-w", "-id4", "-od", "-f", file.to_str().unwrap()];
    if let Some((output, _)) = radiance.run("rcalc", &arguments, &to_bytes(records.as_flattened())) {
        let numbers = to_numbers(&output);
        assert_eq!(numbers.len(), 2 * programs.len() * records.len());
        let record = |chunk: &[f64]| chunk.chunks(2).map(|pair| Some([pair[0], pair[1]])).collect();
        return numbers.chunks(2 * programs.len()).map(record).collect();
    }
    if let [only] = programs {
        let faults = only.values.iter().flatten().any(|(_, clean)| !clean);
        assert!(faults && !radiance.sees_faults, "rcalc refuses {:?}", numbered(only.seed));
        return vec![vec![None]; records.len()];
    }
    let (left, right) = programs.split_at(programs.len() / 2);
    let (left, right) = (theirs(radiance, left, records), theirs(radiance, right, records));
    left.into_iter().zip(right).map(|(left, right)| [left, right].concat()).collect()
}

#[test]
fn generated_programs_have_the_values_of_rcalc() {
    let Some(radiance) = Radiance::find() else { return };
    let mut dice = Dice::new(7);
    let records: Vec<[f64; 4]> = (0..RECORDS).map(|_| std::array::from_fn(|_| dice.number())).collect();
    let (mut compared, mut faults) = (0, 0);
    for batch in 0..PROGRAMS / 100 {
        let programs: Vec<Expected> = (batch * 100..(batch + 1) * 100)
            .filter_map(|seed| {
                let (text, [first, second]) = numbered(seed);
                // A build that sees no faults has lost the sign of zero too, which decides what
                // atan2 is.
                let signed = text.contains("atan2") || first.contains("atan2") || second.contains("atan2");
                if signed && !radiance.sees_faults {
                    return None;
                }
                Some(Expected { seed, values: ours(&format!("{text}$1={first};$2={second};"), &records)? })
            })
            .collect();
        for (record, theirs) in theirs(&radiance, &programs, &records).iter().enumerate() {
            for (Expected { seed, values }, theirs) in programs.iter().zip(theirs) {
                let clean = values[record].iter().all(|(_, clean)| *clean);
                let Some(theirs) = theirs.filter(|_| clean || radiance.sees_faults) else {
                    faults += 2;
                    continue;
                };
                for ((value, _), theirs) in values[record].into_iter().zip(theirs) {
                    let same = close(value, theirs) || (value.is_nan() && theirs.is_nan());
                    assert!(same, "{seed}: {value} {theirs} at {:?}\n{:?}", records[record], numbered(*seed));
                    compared += 1;
                }
            }
        }
    }
    println!("{compared} values compared with rcalc, {faults} left out for faults that it does not see");
    assert!(compared > 10_000, "only {compared} values compared");
}

#[test]
fn messages_of_mathematical_faults_are_those_of_rcalc() {
    let Some(radiance) = Radiance::find().filter(|radiance| radiance.sees_faults) else { return };
    for text in ["1/(x-x)", "max(acos(x+2),1)", "(x-9)^.5+log(x-x)", "if(1/(x-x),1,sin(x))", "select(x+5,1,2)"] {
        let definition = format!("x = 1; y = {text}; $1 = y");
        let (_, messages) = radiance.run("rcalc", &["-n", "-e", &definition], b"").unwrap();
        let mut environment = Environment::new();
        let source = SourceMap::default().add("-e", definition.as_bytes(), None);
        environment.define(source, definition.as_bytes()).unwrap();
        let y = environment.variable("y");
        environment.eval(y, &[], &radsight_cal::NoHost).unwrap();
        let ours: Vec<String> =
            environment.warnings().iter().map(|warning| warning.to_string().to_lowercase()).collect();
        assert_eq!(ours, messages.lines().map(str::to_lowercase).collect::<Vec<_>>(), "{text}");
    }
}
