//! Compares radsight's function files with Radiance's originals, both evaluated by this crate;
//! other tests compare its evaluation with `rcalc` and `rtrace`. `RADSIGHT_FUNCTION_FILES` lists
//! further folders with originals, separated by colons, for files that a package of Radiance may
//! lack.

use crate::close;
use crate::library::{call, definitions, records};
use crate::oracle::Radiance;
use radsight_cal::{Definitions, Environment};
use radsight_diag::SourceMap;
use std::path::PathBuf;

/// Real arguments; in some files the first selects a variant.
fn real_arguments(first: &str, count: usize) -> String {
    // An index of refraction, or something smaller.
    let second = if first == ".4" { "1.5" } else { ".3" };
    format!(
        "arg(n) = if(n-.5, select(n, {first}, {second}, .2, .7, .5, .1, .62, .8, .55, .9, .35, .7, .6, .2, .45, .1, .75,
         .4, .3, .95, .6, .55, .85, .05, .65), {count}); PI : 3.14159265358979323846;"
    )
}

/// Definitions that some files require beforehand, or from their users.
const WANTED: &str = "MF : 2; SALT = 20+$40; SAZI = 30+$41; x1 = 1; x2 = 2+$40; x3 = 4; y1 = .3; y2 = $41; y3 = -.2;
    nrows = 4; ncols = 8; W(i,j) = 1+.1*i-.03*j; w : 2; h : 1.5; d : .1; MONTH = 1+floor(mod($40,12)); DAY = 7; TIME = 9.5+mod($41,3);
    Tn = .8; Rn = .1; YEAR = 1990+floor(mod($42,40)); Tbin = 1+floor(mod($40*7,145)); Rbin = floor(mod($41*29,578));
    A = 1+$40; B = 7*$41; C = $42; kbin = 1+floor(mod($41*31,145)); fprism_val(a,b,c) = a+10*b+100*c+Dx; bezier(p1,p2,p3,p4,t) : p1*(1-t)^3+p2*3*t*(1-t)^2+p3*3*t*t*(1-t)+p4*t^3;";
/// Points of a patch, which shadow the variables of a ray, and key frames of an animation.
const POINTS: &str = "Px(i,j) = i+.1*j*j; Py(i,j) = j-.2*i*i; Pz(i,j) = .3*i*j;";
const FRAMES: &str = "T(i) = select(i+1, 5, 1, 1.5, 2, 1, 3); t = mod($41,8); f(i) = i*i-2*i;";

fn load(texts: &[&str]) -> (Environment, SourceMap) {
    let mut environment = Environment::over(Definitions::with_initial_library());
    let mut sources = SourceMap::default();
    for text in texts {
        let source = sources.add("x.cal", text.as_bytes(), None);
        if let Err(problems) = environment.define(source, text.as_bytes()) {
            panic!("{}", problems[0].render(&sources));
        }
    }
    (environment, sources)
}

fn original(radiance: &Radiance, name: &str) -> Option<String> {
    let more = std::env::var("RADSIGHT_FUNCTION_FILES").unwrap_or_default();
    let folders =
        radiance.lib.iter().cloned().chain(more.split(':').filter(|path| !path.is_empty()).map(PathBuf::from));
    folders
        .into_iter()
        .find_map(|folder| std::fs::read(folder.join(name)).ok())
        .map(|bytes| String::from_utf8_lossy(&bytes).into_owned())
}

/// Compares the definitions of two texts under the original's names; returns the number of compared
/// values and names.
fn compare(name: &str, original: &str, ours: &str) -> (usize, usize) {
    let extra = match name {
        "bezier2.cal" | "patch3w.cal" => POINTS,
        "spline.cal" => FRAMES,
        _ => "",
    };
    let mut values = 0;
    let mut seen = std::collections::BTreeSet::new();
    for (first, count) in [("1", 25), ("2", 18), ("3", 4), ("4", 2), ("0", 1), (".4", 13), (".05", 0)] {
        let arguments = real_arguments(first, count);
        let [mut theirs, mut own] = [original, ours].map(|text| load(&[&arguments, WANTED, text, extra]));
        for (defined, arity) in definitions(original).into_iter().filter(|(name, _)| !name.contains('`')) {
            for functions in [0, 1 << arity.saturating_sub(1)] {
                let text = call(&defined, arity, functions)
                    .replace("some_function", if extra.is_empty() { "frac" } else { "f" });
                let handles = [&mut theirs, &mut own].map(|(environment, sources)| {
                    let source = sources.add("-e", text.as_bytes(), None);
                    environment.expression(source, text.as_bytes())
                });
                let [Ok(their_handle), Ok(our_handle)] = handles else { continue };
                for record in records() {
                    let Ok(expected) = theirs.0.eval(their_handle, &[], &record[..]) else { break };
                    if !theirs.0.warnings().is_empty() {
                        continue;
                    }
                    let value = own.0.eval(our_handle, &[], &record[..]);
                    let value = value.unwrap_or_else(|problems| panic!("{name}: {}", problems[0].render(&own.1)));
                    assert!(own.0.warnings().is_empty(), "{name}: {text}: {} at {record:?}", own.0.warnings()[0]);
                    assert!(
                        close(value, expected) || (value.is_nan() && expected.is_nan()),
                        "{name}: {text} is {value}, not {expected}, at {record:?}"
                    );
                    values += 1;
                    seen.insert(defined.clone());
                }
            }
        }
    }
    (values, seen.len())
}

#[test]
fn our_function_files_have_the_values_of_the_originals() {
    let Some(radiance) = Radiance::find() else { return };
    let (mut files, mut names, mut values, mut missing) = (0, 0, 0, Vec::new());
    for name in radsight_cal::library::names().filter(|name| *name != "ray_variables.cal") {
        let Some(original) = original(&radiance, name) else {
            missing.push(name);
            continue;
        };
        let ours = radsight_cal::library::file(name).unwrap();
        let (compared, of) = compare(name, &original, ours);
        let public = definitions(&original).iter().filter(|(name, _)| !name.contains('`')).count();
        println!("{name}: {of} of {public} names compared");
        assert!(compared > 0, "{name}: nothing could be compared");
        (files, names, values) = (files + 1, names + of, values + compared);
    }
    println!("{files} files, {names} names, {values} values compared; no original for {missing:?}");
    assert!(files > 30, "only {files} files compared");
}

#[test]
fn every_function_file_reads_without_an_error() {
    for name in radsight_cal::library::names() {
        let arguments = real_arguments("1", 25);
        load(&[&arguments, WANTED, radsight_cal::library::file(name).unwrap()]);
    }
}
