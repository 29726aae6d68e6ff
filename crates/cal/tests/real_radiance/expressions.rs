//! Thousands of generated programs against `rcalc`.

use crate::close;
use crate::oracle::{Radiance, to_bytes, to_numbers};
use crate::writer::{Dice, program_text};
use radsight_cal::Environment;
use radsight_diag::SourceMap;
use std::fmt::Write;

const PROGRAMS: u64 = 3000;
const RECORDS: usize = 6;

/// Definitions and expressions of one program, under names of its own.
fn numbered(seed: u64) -> (String, [String; 2]) {
    let (text, roots) = program_text(&mut Dice::new(seed + 90_000), false);
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

/// Our values of one program, and whether each came without a fault; `None` if it has a constant that cannot be.
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

#[test]
fn generated_programs_have_the_values_of_rcalc() {
    let Some(radiance) = Radiance::find() else { return };
    let mut dice = Dice::new(7);
    let records: Vec<[f64; 4]> = (0..RECORDS).map(|_| std::array::from_fn(|_| dice.number())).collect();
    let (mut compared, mut faults) = (0, 0);
    for batch in 0..PROGRAMS / 100 {
        let mut all = String::new();
        let mut expected = Vec::new();
        for seed in batch * 100..(batch + 1) * 100 {
            let (text, [first, second]) = numbered(seed);
            let Some(values) = ours(&format!("{text}$1={first};$2={second};"), &records) else { continue };
            let output = 2 * expected.len() + 1;
            writeln!(all, "{text}${output}={first};\n${}={second};", output + 1).unwrap();
            expected.push((seed, values));
        }
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("x.cal");
        std::fs::write(&file, &all).unwrap();
        let input = to_bytes(records.as_flattened());
        let arguments = ["-w", "-id4", "-od", "-f", file.to_str().unwrap()];
        let (output, _) = radiance.run("rcalc", &arguments, &input).expect("rcalc takes what we take");
        let theirs = to_numbers(&output);
        assert_eq!(theirs.len(), 2 * expected.len() * RECORDS);
        for (record, theirs) in theirs.chunks(2 * expected.len()).enumerate() {
            for ((seed, values), theirs) in expected.iter().zip(theirs.chunks(2)) {
                for (root, &theirs) in theirs.iter().enumerate() {
                    let (value, clean) = values[record][root];
                    if !clean && !radiance.sees_faults {
                        faults += 1;
                        continue;
                    }
                    let same = close(value, theirs) || (value.is_nan() && theirs.is_nan());
                    assert!(same, "{seed}: {value} {theirs} at {:?}\n{:?}", records[record], numbered(*seed));
                    compared += 1;
                }
            }
        }
    }
    println!("{compared} values compared with rcalc, {faults} left out for faults that it does not see");
    assert!(compared > 20_000, "only {compared} values compared");
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
