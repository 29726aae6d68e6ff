//! Compares genworm, genrev and gensurf with the real programs.

mod oracle;

use oracle::{Numbers, Radiance, TestLoader, expect_same, ours, words};

/// A smooth and finite function of the given parameters.
fn function(numbers: &mut Numbers, parameters: &[&str]) -> String {
    let p = parameters[numbers.below(parameters.len())];
    let q = parameters[numbers.below(parameters.len())];
    let (a, b) = (numbers.text(0.5, 3.0), numbers.text(-2.0, 2.0));
    match numbers.below(9) {
        0 => format!("hermite({a},{b},1.5,-.7,{p})"),
        1 => format!("bezier({a},{b},.25,{b},{p})"),
        2 => format!("bspline(0,{a},{b},1,{p})"),
        3 => format!("{a}*sin(2*PI*{p}) + {b}*{q}"),
        4 => format!("{a}+{b}*cos({q}*PI) - {p}*{p}^3"),
        5 => format!("if({p}-.5, {a}*{p}, {a}*.5+{b}*({p}-.5))+{q}"),
        6 => format!("twist({p},{q})*{a}"),
        7 => format!("select(1+floor({p}*2.999),{a},{b},{p})+{q}*sqrt({a})"),
        _ => format!("{a}*{p}+({b})*{q}"),
    }
}

const TWIST: &str = "twist(u,v)=sin(u)*w(v)+u; w(x):exp(-x*x)/2";

#[test]
fn worms_equal_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    let mut numbers = Numbers(11);
    let mut loader = TestLoader::default();
    let folder = std::env::temp_dir();
    std::fs::write(folder.join("radsight-generate-worm.cal"), TWIST).unwrap();
    loader.folders.push(folder);
    let (mut identical, lines) = (0, 300);
    for _ in 0..lines {
        let mut argv = words("genworm mat worm");
        argv.extend((0..3).map(|_| function(&mut numbers, &["t"])));
        argv.push(["0.3", "1+t/2", "2.5-t*t", "hermite(1,2,0,0,t)"][numbers.below(4)].to_owned());
        argv.push(["7", "3*4", "2^3+.2", "1"][numbers.below(4)].to_owned());
        match numbers.below(2) {
            0 => argv.extend(["-e".to_owned(), TWIST.to_owned()]),
            _ => argv.extend(words("-f radsight-generate-worm.cal")),
        }
        identical += usize::from(expect_same(&radiance, &argv, b"", &loader));
    }
    println!("genworm: {identical} of {lines} outputs are the same bytes");
}

#[test]
fn surfaces_of_revolution_equal_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    let mut numbers = Numbers(12);
    let loader = TestLoader::default();
    let (mut identical, lines) = (0, 300);
    for _ in 0..lines {
        let mut argv = words("genrev mat rev");
        argv.push(["t", "1-t", "3", "sin(2*PI*t)", "if(t-.5,.5,t)"][numbers.below(5)].to_owned());
        if numbers.chance(2) {
            *argv.last_mut().unwrap() = function(&mut numbers, &["t"]);
        }
        argv.push(["2", "1+t", "2+cos(2*PI*t)", "if(t-.5,t,.5)", "t"][numbers.below(5)].to_owned());
        argv.push((1 + numbers.below(20)).to_string());
        argv.extend(["-e".to_owned(), TWIST.to_owned()]);
        // If consecutive profile points coincide, the real program divides by zero and prints text
        // that no program can read.
        let real = radiance.run(&argv, b"", None);
        if numbers.chance(2) && !real.standard_output.is_empty() {
            argv.push("-s".to_owned());
        }
        identical += usize::from(expect_same(&radiance, &argv, b"", &loader));
    }
    println!("genrev: {identical} of {lines} outputs are the same bytes");
}

#[test]
fn surfaces_equal_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    let mut numbers = Numbers(13);
    let loader = TestLoader::default();
    let (mut identical, lines) = (0, 400);
    for _ in 0..lines {
        let mut argv = words("gensurf mat surf");
        argv.extend((0..3).map(|_| function(&mut numbers, &["s", "t"])));
        argv.extend([(1 + numbers.below(6)).to_string(), (1 + numbers.below(6)).to_string()]);
        let mut definitions = TWIST.to_owned();
        if numbers.chance(3) {
            definitions += "; valid(a,b)=if(a-.61,1,b-.31)";
        } else if numbers.chance(3) {
            argv.push("-s".to_owned());
            // A surface in general position; on others the last bit decides whether normals can be
            // interpolated.
            argv[3] = format!("4*s+.2*({})", argv[3]);
            argv[4] = format!("3*t+.2*({})", argv[4]);
        }
        argv.extend(["-e".to_owned(), definitions]);
        for option in ["-o", "-i"] {
            if numbers.chance(3) {
                argv.push(option.to_owned());
            }
        }
        if argv.contains(&"-s".to_owned()) && !argv.contains(&"-o".to_owned()) {
            oracle::expect_same_smoothing(&radiance, &argv, b"", &loader);
        } else {
            identical += usize::from(expect_same(&radiance, &argv, b"", &loader));
        }
    }
    println!("gensurf: {identical} of {lines} outputs are the same bytes");
}

#[test]
fn surfaces_from_data_equal_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    let mut numbers = Numbers(14);
    for _ in 0..100 {
        let (m, n) = (2 + numbers.below(4), 2 + numbers.below(4));
        let points = if numbers.chance(2) { (m + 1) * (n + 1) } else { m * n };
        let triplets = numbers.chance(2);
        let count = if triplets { 3 * points } else { points };
        let data: Vec<String> = (0..count).map(|_| numbers.text(-3.0, 3.0)).collect();
        let coordinates = if triplets { "- - -" } else { "s*4 t*5+s -" };
        let smooth = if numbers.chance(3) { "-s" } else { "" };
        let argv = words(&format!("gensurf m d {coordinates} {m} {n} {smooth}"));
        match smooth {
            "" => drop(expect_same(&radiance, &argv, data.join(" ").as_bytes(), &TestLoader::default())),
            _ => oracle::expect_same_smoothing(&radiance, &argv, data.join(" ").as_bytes(), &TestLoader::default()),
        }
    }
}

#[test]
fn a_wrong_expression_is_shown_with_a_caret() {
    let argv: Vec<String> = ["genworm", "m", "w", "sin(t", "0", "t", ".1", "5"].map(String::from).into();
    let error = ours(&argv, b"", &TestLoader::default()).unwrap_err();
    assert_eq!(error.argument(), Some(3));
    assert!(error.to_string().contains('^'), "{error}");
}

#[test]
fn a_value_that_is_no_number_is_an_error() {
    let argv = words("genworm m w 1/t 0 t .1 5");
    assert_eq!(ours(&argv, b"", &TestLoader::default()).unwrap().warnings, ["division by zero"]);
    let argv = words("genrev m w exp(600*t)*exp(600*t) t 5");
    let message = ours(&argv, b"", &TestLoader::default()).unwrap_err().to_string();
    assert_eq!(message, "genrev: z(0.6) is inf, expected a finite number");
}

#[test]
fn a_wish_for_too_many_segments_is_refused_at_once() {
    for line in [
        "genworm m w t t t .1 1e9",
        "genrev m w t t 1000000000",
        "gensurf m w s t 0 1e5 1e5",
        "gensurf m w s t 0 1e9 1",
        "gensurf m w s t 0 1 1e9 -s",
        "genbox m b 1 1 1 -r .1 -n 1000000000",
        "genbox m b 1 1 1 -r .1 -n 9223372036854775807",
        "genblinds m b 1 1 1 1000000000 0",
        "genbeads m b 0 0 0 1 1 1 1 1 1 1 1 1 .1 1e-9",
    ] {
        let error = ours(&words(line), b"", &TestLoader::default()).unwrap_err().to_string();
        assert!(error.starts_with("the output exceeds"), "{line}: {error}");
    }
}
