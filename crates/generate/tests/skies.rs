//! gensky and gendaylit against the real programs.

mod oracle;

use oracle::{Numbers, Radiance, TestLoader, expect_same, words};

#[test]
fn cie_skies_equal_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    let mut numbers = Numbers(4);
    let loader = TestLoader::default();
    let (mut identical, lines) = (0, 1500);
    for _ in 0..lines {
        let mut argv = words("gensky");
        if numbers.chance(4) {
            argv.extend(["-ang".into(), numbers.text(-10.0, 90.0), numbers.text(-180.0, 180.0)]);
        } else {
            argv.extend([(1 + numbers.below(12)).to_string(), (1 + numbers.below(31)).to_string()]);
            argv.push(hour(&mut numbers));
        }
        sky_options(&mut numbers, &mut argv);
        identical += usize::from(expect_same(&radiance, &argv, b"", &loader));
    }
    assert!(expect_same(&radiance, &words("gensky -defaults"), b"", &loader));
    println!("gensky: {identical} of {lines} outputs are the same bytes");
}

fn hour(numbers: &mut Numbers) -> String {
    let hour = numbers.below(24);
    match numbers.below(5) {
        0 => format!("{hour}:{:02}", numbers.below(60)),
        1 => format!("+{hour}.5"),
        2 => format!("{hour}.25est"),
        3 => format!(
            "{hour}:{:02}{}",
            numbers.below(60),
            ["CET", "PST", "NZST", "GMT", "EEST", "JST", "AST"][numbers.below(7)]
        ),
        _ => format!("{:.3}", numbers.between(0.0, 24.0)),
    }
}

fn sky_options(numbers: &mut Numbers, argv: &mut Vec<String>) {
    if numbers.chance(2) {
        argv.push(["-s", "+s", "-c", "-u", "-i", "+i"][numbers.below(6)].into());
    }
    let ranges: [(&str, f64, f64); 9] = [
        ("-a", -80.0, 80.0),
        ("-o", -180.0, 180.0),
        ("-m", -180.0, 180.0),
        ("-t", 1.0, 8.0),
        ("-g", 0.0, 1.0),
        ("-b", 0.0, 100.0),
        ("-B", 0.0, 100.0),
        ("-r", 0.0, 1e6),
        ("-R", 0.0, 1000.0),
    ];
    for (option, low, high) in ranges {
        if numbers.chance(4) {
            argv.extend([option.into(), numbers.text(low, high)]);
        }
    }
    if numbers.chance(4) {
        argv.extend(["-y".into(), (1950 + numbers.below(101)).to_string()]);
    }
}

#[test]
fn perez_skies_equal_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    let mut numbers = Numbers(6);
    let loader = TestLoader::default();
    let (mut identical, lines) = (0, 3000);
    for _ in 0..lines {
        let mut argv = words("gendaylit");
        if numbers.chance(4) {
            argv.extend(["-ang".into(), numbers.text(-10.0, 90.0), numbers.text(-180.0, 180.0)]);
        } else {
            argv.extend([(1 + numbers.below(12)).to_string(), (1 + numbers.below(31)).to_string()]);
            argv.push(format!("{}{:.3}", ["", "+"][numbers.below(2)], numbers.between(0.0, 23.99)));
        }
        daylight_options(&mut numbers, &mut argv);
        identical += usize::from(expect_same(&radiance, &argv, b"", &loader));
    }
    assert!(expect_same(&radiance, &words("gendaylit -defaults"), b"", &loader));
    println!("gendaylit: {identical} of {lines} outputs are the same bytes");
}

fn daylight_options(numbers: &mut Numbers, argv: &mut Vec<String>) {
    match numbers.below(5) {
        0 => argv.extend(["-P".into(), numbers.text(0.5, 13.0), numbers.text(0.0, 0.7)]),
        1 => argv.extend(["-W".into(), numbers.text(-10.0, 1000.0), numbers.text(1.0, 400.0)]),
        2 => argv.extend(["-L".into(), numbers.text(0.0, 100_000.0), numbers.text(100.0, 40_000.0)]),
        3 => argv.extend(["-G".into(), numbers.text(0.0, 600.0), numbers.text(1.0, 400.0)]),
        _ => argv.extend(["-E".into(), numbers.text(1.0, 900.0)]),
    }
    let ranges: [(&str, f64, f64); 7] = [
        ("-a", -60.0, 60.0),
        ("-o", -180.0, 180.0),
        ("-m", -180.0, 180.0),
        ("-g", 0.0, 1.0),
        ("-d", -45.0, 45.0),
        ("-i", 0.0, 60.0),
        ("-t", 0.0, 1.0),
    ];
    for (option, low, high) in ranges {
        if numbers.chance(4) {
            argv.extend([option.into(), numbers.text(low, high)]);
        }
    }
    for option in ["-s", "+s", "-c", "+c", "-C", "-CIE", "-w", "-O 1", "-O 2", "-y 1999", "-y 2024", "-l 1 2 3 4 5 6 7"]
    {
        if numbers.chance(8) {
            argv.extend(words(option));
        }
    }
}
