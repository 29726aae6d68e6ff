//! Compares gensky, gendaylit and epw2wea with the real programs.

mod oracle;

use oracle::{Numbers, Radiance, TestLoader, expect_same, ours, words};

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

/// The real programs take `+` for `-`, but not where it decides about the sun.
#[test]
fn a_plus_stands_for_a_minus() {
    let Some(radiance) = Radiance::find() else { return };
    let loader = TestLoader::default();
    let sky = ["y 2020", "a 40", "o 70", "m 75", "r 5", "R 5", "t 3", "b 20", "B 20", "g .3", "c", "u", "i", "s"];
    let daylit = ["a 40", "o 70", "m 75", "g .3", "i 60", "w", "C", "s", "O 1"];
    let argvs = sky.map(|option| format!("gensky 6 21 12 +{option}"));
    for argv in argvs.into_iter().chain(daylit.map(|option| format!("gendaylit 6 21 12 -W 800 100 +{option}"))) {
        expect_same(&radiance, &words(&argv), b"", &loader);
    }
    expect_same(&radiance, &words("gendaylit 6 21 12 +P 6 .1"), b"", &loader);
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

/// An EPW file with this many records.
fn weather(records: usize) -> String {
    let mut text = "LOCATION,S\u{e3}o Paulo,SP,BRA,SWERA,837800,-23.62,-46.65,-3.0,803.0\n".to_owned();
    text +=
        "DESIGN CONDITIONS,0\nTYPICAL/EXTREME PERIODS,0\nGROUND TEMPERATURES,0\nHOLIDAYS/DAYLIGHT SAVINGS,No,0,0,0\n";
    text += "COMMENTS 1,none\nCOMMENTS 2,none\nDATA PERIODS,1,1,Data,Sunday, 1/ 1,12/31\n";
    for record in 0..records {
        let (day, hour) = (1 + record / 24, 1 + record % 24);
        let (direct, diffuse, cover) = (record * 37 % 900, record * 13 % 300, record % 11);
        text +=
            &format!("1999,1,{day},{hour},60,?9?9?9E0,22.5,18.1,76,92000,30,1415,400,300,{direct},{diffuse}.5,30000,");
        text += &format!("20000,9000,2000,180,2.5,{cover},{cover},10.0,77777,9,999999999,20,0.{record:03},0,88\n");
    }
    text
}

#[test]
fn weather_files_are_those_of_the_real_program() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = std::env::temp_dir();
    let loader = TestLoader { folders: vec![folder.clone()], ..TestLoader::default() };
    for (name, text) in [("radsight.epw", weather(50)), ("radsight-dos.epw", weather(30).replace('\n', "\r\n"))] {
        std::fs::write(folder.join(name), text).unwrap();
        for option in ["", "-a "] {
            assert!(expect_same(&radiance, &words(&format!("epw2wea {option}{name}")), b"", &loader));
        }
    }
    let made = ours(&words("epw2wea radsight.epw made.wea"), b"", &loader).unwrap();
    assert!(made.standard_output.is_empty() && made.files[0].0 == "made.wea");
    // The result can be read back; the time zone of India keeps its half hour, which the real
    // program loses.
    let india = weather(24).replace("-3.0,803.0", "5.5,803.0");
    let made = ours(&words("epw2wea -"), india.as_bytes(), &loader).unwrap().standard_output;
    assert!(String::from_utf8(made.clone()).unwrap().contains("\ntime_zone -82.5\n"));
    assert!(!ours(&words("gendaymtx -m 1"), &made, &loader).unwrap().standard_output.is_empty());
}

#[test]
fn a_quoted_city_holds_a_comma() {
    let text = weather(24).replace("S\u{e3}o Paulo", "\"S\u{e3}o, Paulo\"");
    let loader = TestLoader::default();
    let made = ours(&words("epw2wea -"), text.as_bytes(), &loader).unwrap().standard_output;
    let made = String::from_utf8(made).unwrap();
    assert!(made.starts_with("place S\u{e3}o, Paulo_BRA\nlatitude -23.62\nlongitude 46.65"), "{made}");
    let sky = |input: &str| ours(&words("gendaymtx -m 1 -h"), input.as_bytes(), &loader).unwrap().standard_output;
    assert_eq!(sky(&text), sky(&weather(24)));
}

#[test]
fn invalid_weather_is_reported_with_its_line() {
    let text = weather(3);
    let cut = |lines: usize| text.lines().take(lines).collect::<Vec<_>>().join("\n");
    for (line, input, mistake) in [
        ("epw2wea -", String::new(), "line 1: expected"),
        ("epw2wea -", "place x\n".to_owned(), "line 1: expected"),
        ("epw2wea -", text.replace("-46.65", "west"), "line 1: expected numbers for latitude"),
        ("epw2wea -", cut(7), "line 8: expected \"DATA PERIODS\""),
        ("epw2wea -", cut(9) + "\n1999,1,1,2\n", "line 10: expected a date, an hour,"),
        (
            "epw2wea -a -",
            text.replace(",0.000,0,88", ""),
            "line 9: expected cloud cover and aerosol optical depth (-a)",
        ),
        (
            "epw2wea -",
            text.replace("1999,1,1,2,", "1999,13,1,2,"),
            "line 10: there is no hour 1.5 of day 1 in month 13",
        ),
        ("epw2wea -", text.replace("1999,1,1,2,", "1999,1,1,26,"), "line 10: there is no hour 25.5 of day 1"),
        ("epw2wea -", text.replace("1999,1,1,2,", "1999,1,1.5,2,"), "line 10: the day is 1.5, expected a whole number"),
        ("epw2wea -", text.replace(",300,37,", ",300,9999,"), "line 10: direct or diffuse irradiance is missing"),
        ("epw2wea -q -", String::new(), "unknown option \"-q\""),
        ("epw2wea", String::new(), "missing file-name.epw"),
        ("epw2wea - a b", String::new(), "unexpected argument \"b\""),
    ] {
        let message = ours(&words(line), input.as_bytes(), &TestLoader::default()).unwrap_err().to_string();
        assert!(message.contains(mistake), "{line}: {message}");
    }
}
