//! Compares cnt, rcalc, total, histo, rlam, ev, cat, zcat and pipes with the real programs.

mod oracle;

use oracle::{Numbers, Radiance, TestLoader, expect_same, ours, words};
use radsight_scene_generators::pipeline;

fn list(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| (*word).to_owned()).collect()
}

fn table(numbers: &mut Numbers) -> String {
    let mut table = String::new();
    for _ in 0..numbers.below(8) {
        let columns: Vec<String> = (0..1 + numbers.below(5)).map(|_| numbers.text(-9.0, 9.0)).collect();
        table += &columns.join(["\t", " ", "  "][numbers.below(3)]);
        table += if numbers.chance(9) { " x\n" } else { "\n" };
    }
    table
}

#[test]
fn computed_columns_equal_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    let mut numbers = Numbers(21);
    let definitions = [
        "$1=$2*2; $3=recno",
        "$2=$1+in(2); $1=in(0)",
        "$1=sum; sum=$1+$2; cond=$1",
        "$1=cos($1*PI/3);$2=sin($1*PI/3)",
        "$1=outno; $5=if($3,$3,1-$3); cond=recno-2",
        "f(x)=x^2; $1=f($1); $2=select(recno,1,$2)",
        "k:3; $1=k*$1+$4",
        "$1=rand($1); $2=floor($2)",
    ];
    for _ in 0..400 {
        let mut argv = list(&["rcalc"]);
        for option in [&["-b"][..], &["-t,"], &["-in", "3"], &["-on", "2"], &["-u"], &["-w"]] {
            if numbers.chance(6) {
                argv.extend(list(option));
            }
        }
        argv.extend(list(&["-e", definitions[numbers.below(definitions.len())]]));
        let input = table(&mut numbers).replace(if numbers.chance(5) { "\t" } else { "\u{1}" }, ",");
        expect_same(&radiance, &argv, input.as_bytes(), &TestLoader::default());
    }
}

#[test]
fn warnings_of_mathematical_errors_end_with_an_option() {
    for (options, warnings) in [(&[][..], &["division by zero"][..]), (&["-w"], &[])] {
        let argv = [&list(&["rcalc"])[..], &list(options), &list(&["-e", "$1=1/($1-1)"])].concat();
        let output = ours(&argv, b"1\n3\n", &TestLoader::default()).unwrap();
        assert_eq!((&output.standard_output[..], &output.warnings[..]), (&b"0\n0.5\n"[..], &list(warnings)[..]));
    }
}

#[test]
fn records_of_formats_equal_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    let input = "name=abc x= 12 y=3.5\nname=def x=7 y=-2e1\nnothing here\nname=abc  x=1   y=0.001 tail\n\nname= x=5 y=6\nname=q x=0 y=1000000";
    let inputs = [
        "name=$(n) x=${ x } y=${y}",
        "name=$(n) x=${x} y=$(rest)",
        "$(a) $(b)",
        "${x}",
        "x=${x}",
        "name=$(n) x=${x} y=${x}",
    ];
    let outputs = [
        "$(n): ${x+1} and ${x*y}",
        "<${   x   }|${        y/3        }>",
        "a${x}b$$${ recno }",
        "$(n)$(n) ${x}${x}\n",
        "   ${ x }   ",
    ];
    let (mut ran, mut failed) = (0, 0);
    for input_format in inputs {
        for output_format in outputs {
            for extra in
                [&[][..], &["-p"], &["-P", "-e", "cond=x-5"], &["-b"], &["-l"], &["-s", "n=abc"], &["-e", "cond=6-x"]]
            {
                let mut argv = list(&["rcalc"]);
                argv.extend(list(extra));
                argv.extend(list(&["-i", input_format, "-o", output_format]));
                let real = radiance.run(&argv, input.as_bytes(), None);
                ran += 1;
                match ours(&argv, input.as_bytes(), &TestLoader::default()) {
                    Ok(output) => {
                        let mine = String::from_utf8(output.standard_output).unwrap();
                        assert_eq!(mine, real.standard_output, "{argv:?}");
                    }
                    Err(error) => {
                        failed += 1;
                        assert!(!real.succeeded, "{argv:?}: {error}\nreal: {}", real.standard_output);
                    }
                }
            }
        }
    }
    println!("rcalc formats: {ran} combinations, {failed} of them errors in both");
}

#[test]
fn binary_records_equal_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    let singles: Vec<u8> = [1.5f32, -2.0, 3e9, 0.1, 7.0].iter().flat_map(|value| value.to_le_bytes()).collect();
    let doubles: Vec<u8> = [1.5f64, -2.0, 3e99, 0.1, 7.0].iter().flat_map(|value| value.to_le_bytes()).collect();
    for (input, argv) in [
        (&singles, &["rcalc", "-if2", "-e", "$1=$2;$2=$1+$3"][..]),
        (&singles, &["rcalc", "-if", "-e", "$1=$1"]),
        (&doubles, &["rcalc", "-id2", "-e", "$1=in(2)+in(0)"]),
        (&doubles, &["total", "-id5", "-p"]),
        (&singles, &["total", "-if1"]),
        (&singles, &["total", "-if3"]),
        (&doubles, &["total", "-id4", "-m", "-1"]),
    ] {
        assert!(expect_same(&radiance, &list(argv), input, &TestLoader::default()));
    }
    for (flag, expected) in [("-od", &doubles), ("-of", &singles)] {
        let argv =
            list(&["rcalc", if flag == "-od" { "-id5" } else { "-if5" }, flag, "-e", "$1=$1;$2=$2;$3=$3;$4=$4;$5=$5"]);
        assert_eq!(&ours(&argv, expected, &TestLoader::default()).unwrap().standard_output, expected);
    }
    let swapped = ours(&list(&["rcalc", "-n", "-oD", "-e", "$2=1"]), b"", &TestLoader::default()).unwrap();
    assert_eq!(swapped.standard_output, [[0; 8], 1f64.to_be_bytes()].concat());
}

#[test]
fn totals_equal_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    let mut numbers = Numbers(22);
    for _ in 0..400 {
        let mut argv = list(&["total"]);
        for option in [&["-m"][..], &["-t,"], &["-2"], &["-3", "-r"], &["-in", "3"], &["-on", "1"]] {
            if numbers.chance(5) {
                argv.extend(list(option));
            }
        }
        argv.extend(list([&[][..], &["-s2"], &["-s.5"], &["-p"], &["-u"], &["-l"]][numbers.below(6)]));
        let input = table(&mut numbers).replace(if numbers.chance(3) { "\t" } else { "\u{1}" }, ",");
        let real = radiance.run(&argv, input.as_bytes(), None);
        if real.succeeded {
            expect_same(&radiance, &argv, input.as_bytes(), &TestLoader::default());
        } else {
            assert!(ours(&argv, input.as_bytes(), &TestLoader::default()).is_err(), "{argv:?}");
        }
    }
}

#[test]
fn totals_of_groups_equal_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    let groups = "1 2\n3 4\n\n5 6\n7 8 9\n \n9 10\n\n\n11 12\n";
    for options in [&[][..], &["-m"], &["-r"], &["-2"], &["-3", "-m", "-r"], &["-u"], &["-in", "2"], &["-on", "2"]] {
        let argv = [&["total"], options].concat();
        assert!(expect_same(&radiance, &list(&argv), groups.as_bytes(), &TestLoader::default()));
    }
}

#[test]
fn numbers_are_those_of_atof() {
    let Some(radiance) = Radiance::find() else { return };
    let input = "inf -INF 0x10 -0x1.8p3\n1 Infinity 0x 0xfg\n2e 3e+ information .5.5\n";
    for argv in [
        &["total", "-u"][..],
        &["total", "-m"],
        &["rcalc", "-e", "$1=$1;$2=$2;$3=$3;$4=$4"],
        &["total", "-l"],
        &["histo", "0", "20", "4"],
    ] {
        expect_same(&radiance, &list(argv), input.as_bytes(), &TestLoader::default());
    }
    let output = ours(&list(&["histo", "0", "2", "2"]), b"1.5 nan\n", &TestLoader::default()).unwrap();
    assert_eq!(output.standard_output, b"0.5\t0\t0\n1.5\t1\t0\n");
    assert_eq!(output.warnings, ["1 of the numbers are nan, which no bin counts"]);
}

#[test]
fn histograms_equal_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    let mut numbers = Numbers(23);
    for _ in 0..60 {
        let mut argv = list(&["histo"]);
        for option in ["-c", "-p"] {
            if numbers.chance(2) {
                argv.push(option.to_owned());
            }
        }
        argv.extend(list(
            [&["-5", "5", "7"][..], &["-3", "4"], &["0", "1e2", "1"], &["-.25", "9.5", "40"]][numbers.below(4)],
        ));
        let input: String = (0..6).map(|_| table(&mut numbers)).collect();
        expect_same(&radiance, &argv, input.as_bytes(), &TestLoader::default());
    }
}

#[test]
fn laminated_records_equal_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = std::env::temp_dir().join("radsight-generate-rlam");
    std::fs::create_dir_all(&folder).unwrap();
    for (name, bytes) in [
        ("a", "a1\na2\na3\n"),
        ("b", "b1\r\n\nb 3\n"),
        ("c", "c1\nc2\nc3\n"),
        ("e", "e1\ne2"),
        ("d", "0123456789abcdefghijklmn"),
    ] {
        std::fs::write(folder.join(name), bytes).unwrap();
    }
    let loader = TestLoader { folders: vec![folder], ..TestLoader::default() };
    for (line, end_together) in [
        ("rlam a b c", true),
        ("rlam a", true),
        ("rlam -t, a -t b -t:; - -t c", false),
        ("rlam -u -in 2 a b c", true),
        ("rlam -ia3 a b", true),
        ("rlam -t. -ia1 a -ia3 b", false),
        ("rlam -if d -if d", true),
        ("rlam -id -t, d -t; d", true),
        ("rlam -ib8 d -ia a", true),
        ("rlam a -iw4 d", true),
        ("rlam -id d -t, -ia a -t; b", true),
        ("rlam -t, a -id d -ia b", true),
        ("rlam - - - a", true),
        ("rlam !echo_5 a", false),
    ] {
        let argv: Vec<String> = words(line).iter().map(|word| word.replace('_', " ")).collect();
        let input = b"1\n2\n3\n4\n5\n6\n7\n8\n9\n";
        let real = radiance.run(&argv, input, Some(&loader.folders[0]));
        let ours = String::from_utf8(ours(&argv, input, &loader).unwrap().standard_output).unwrap();
        let real = real.standard_output;
        // At the end of one input, real rlam stops in the middle of the record.
        assert!(ours.starts_with(&real) && (ours == real) == end_together, "{line}: {ours:?}, real {real:?}");
    }
    let text = |line: &str| String::from_utf8(ours(&words(line), b"x\n", &loader).unwrap().standard_output).unwrap();
    assert_eq!(text("rlam - a b"), "x\ta1\tb1\r\n\ta2\t\n\ta3\tb 3\n", "shorter inputs stop contributing");
    assert_eq!(text("rlam e"), "e1\ne2\n", "the last line may have no end");
    let message = |line: &str| ours(&words(line), b"", &loader).unwrap_err().to_string();
    for (line, mistake) in [
        ("rlam", "rlam: missing input1"),
        ("rlam -q a", "rlam: unknown option \"-q\""),
        ("rlam -ix a", "rlam: unknown option \"-ix\""),
        ("rlam -id99999999999999999999 a", "rlam: unknown option \"-id99999999999999999999\""),
        ("rlam -in x a", "rlam: most records (-in) is \"x\", expected an integer"),
        ("rlam a nofile", "cannot find file \"nofile\""),
        ("rlam !nosuch", "refused to run \"nosuch\""),
        ("histo 1", "histo: missing max"),
        ("histo .5 2", "histo: missing n, as min and max are not integers"),
        ("histo 2 1 4", "histo: max is 1, expected more than min, 2"),
        ("histo 1 2 0", "histo: 0 divisions, expected 1 to 1024"),
        ("histo 1 1e9", "histo: 1000000000 divisions, expected 1 to 1024"),
        ("histo 1 2 3 4", "histo: unexpected argument \"4\""),
    ] {
        assert!(message(line).starts_with(mistake), "{line}: {}", message(line));
    }
    assert!(ours(&words("rlam -id999999999999999999 d"), b"", &loader).unwrap().standard_output.is_empty());
}

#[test]
fn counts_and_values_equal_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    for argv in [
        &["cnt", "5"][..],
        &["cnt", "2", "3", "4"],
        &["ev", "1/3", "2^10", "sin(1)", "atan2(1,2)", "-2.5e-7*3", "1e20"],
        &["ev", "if(1,2,3)", "select(2,7,8,9)", "rand(4)"],
        &["rcalc", "-n", "-e", "$1=PI;$2=exp(1)"],
    ] {
        assert!(expect_same(&radiance, &list(argv), b"", &TestLoader::default()));
    }
}

/// Values before a mistake are printed, as in Radiance, and those after it are not.
#[test]
fn ev_prints_the_values_before_a_mistake() {
    let sink = std::rc::Rc::new(std::cell::RefCell::new(Vec::new()));
    let argv = list(&["ev", "1+1", "2*3", "1+", "7"]);
    let error = radsight_scene_generators::run_to(sink.clone(), &argv, &b"", &TestLoader::default()).unwrap_err();
    assert_eq!(sink.borrow().as_slice(), b"2\n6\n");
    assert!(error.to_string().contains("expected an expression, found the end"), "{error}");
}

#[test]
fn mistakes_are_named() {
    let message = |argv: &[&str]| ours(&list(argv), b"1 2 3\n", &TestLoader::default()).unwrap_err().to_string();
    assert_eq!(
        message(&["cnt", "1"]),
        "cnt: count is 1, expected a whole number of at least 2\nusage: cnt [-s] N0 [N1 ..]"
    );
    assert_eq!(message(&["cnt", "-s"]), "cnt: missing count\nusage: cnt [-s] N0 [N1 ..]");
    assert_eq!(message(&["cnt", "100000", "100000"]), "the output exceeds 1073741824 bytes");
    assert_eq!(message(&["rcalc", "-e", "cond:1;$1=1"]), "rcalc: cond is defined as a constant");
    assert!(message(&["rcalc", "-e", "$1=nosuch"]).contains("nosuch"));
    assert!(message(&["rcalc", "-n", "-e", "$1=$2"]).contains("no column input"));
    assert!(message(&["rcalc", "-i", "$x"]).contains("record format: \"$\" is followed by neither"));
    assert!(message(&["total", "-q"]).starts_with("total: unknown option \"-q\""));
}

#[test]
fn compressed_files_come_back() {
    // "aaaaaaaaaabcabcabcabc\n" repeated 40 times, compressed by gzip and compress.
    let expected = "aaaaaaaaaabcabcabcabc\n".repeat(40).into_bytes();
    let mut loader = TestLoader::default();
    loader.files.insert("a.gz".into(), gzip(&expected));
    loader.files.insert("b.Z".into(), compress(&expected, 10));
    loader.files.insert("c.Z".into(), compress(&expected, 16));
    for name in ["a.gz", "a", "b", "b.Z", "c.Z"] {
        assert_eq!(ours(&list(&["zcat", name]), b"", &loader).unwrap().standard_output, expected, "{name}");
    }
    let piped = ours(&list(&["zcat"]), &gzip(&expected), &loader).unwrap();
    assert_eq!(piped.standard_output, expected);
    let message = ours(&list(&["zcat"]), b"plain", &loader).unwrap_err().to_string();
    assert_eq!(message, "zcat: standard input: the format is neither that of gzip nor that of compress");
    for length in 0..45 {
        let _ = ours(&list(&["zcat"]), &compress(&expected, 12)[..length], &loader);
        let _ = ours(&list(&["zcat"]), &gzip(&expected)[..length], &loader);
    }
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    use std::io::Write;
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// The output of `compress` without resets of the table.
fn compress(bytes: &[u8], widest: u32) -> Vec<u8> {
    let (mut bits, mut width, mut group) = (Vec::<bool>::new(), 9u32, 0usize);
    let mut codes = std::collections::HashMap::<(usize, u8), usize>::new();
    let mut next = 257usize;
    let put = |code: usize, width: u32, bits: &mut Vec<bool>| bits.extend((0..width).map(|bit| code >> bit & 1 == 1));
    let mut prefix = usize::from(bytes[0]);
    for &byte in &bytes[1..] {
        if let Some(code) = codes.get(&(prefix, byte)) {
            prefix = *code;
            continue;
        }
        put(prefix, width, &mut bits);
        if next < 1 << widest {
            // The reader is one entry behind the writer.
            if next > (1 << width) - 1 && width < widest {
                let full = group + (bits.len() - group).next_multiple_of(8 * width as usize);
                bits.resize(full, false);
                (width, group) = (width + 1, full);
            }
            codes.insert((prefix, byte), next);
            next += 1;
        }
        prefix = usize::from(byte);
    }
    put(prefix, width, &mut bits);
    let packed = bits.chunks(8).map(|byte| byte.iter().rev().fold(0u8, |sum, bit| sum << 1 | u8::from(*bit)));
    [0x1f, 0x9d, 0x80 | widest as u8].into_iter().chain(packed).collect()
}

#[test]
fn pipes_run_from_left_to_right() {
    let mut loader = TestLoader::default();
    loader.files.insert("in".into(), b"3 4\n".to_vec());
    let text = |line: &str| match pipeline(line, &loader, &|_, _| None) {
        Ok(output) => String::from_utf8(output.standard_output).unwrap(),
        Err(failed) => format!("{}: {failed}", &line[failed.range.clone()]),
    };
    assert_eq!(text("cnt 3 | rcalc -e '$1=$1*2' | total"), "6\n");
    assert_eq!(text("( echo a; cnt 2 ) | cat; echo b"), "a\n\t0\n\t1\nb\n");
    assert_eq!(text("rcalc -e '$1=$1+$2' < in"), "7\n");
    assert_eq!(text("(cat; cat) < in"), "3 4\n3 4\n");
    assert_eq!(text("cnt 3 | nosuch 1"), "nosuch: refused to run \"nosuch 1\": a scene file is input, not a program");
    assert!(text("cnt 3 | genbox m b 1 x 3").starts_with("x: genbox: ysize is \"x\", expected a finite number"));
    assert!(text("cat nofile | cat").starts_with("cat: cannot find file \"nofile\""));
    assert!(text("cat < nofile").starts_with("nofile: cannot find"));
    assert!(text("echo $x").starts_with("$x: a variable"));
}

#[test]
fn the_caller_can_add_programs() {
    let extra = |argv: &[String], input: Option<&[u8]>| {
        (argv[0] == "double").then(|| {
            let bytes = input.unwrap_or_default().repeat(2);
            Ok(radsight_scene_generators::Output { standard_output: bytes, ..Default::default() })
        })
    };
    let output = pipeline("echo x | double | cat", &TestLoader::default(), &extra).unwrap();
    assert_eq!(output.standard_output, b"x\nx\n");
    let argv = words("replmarks -e -x a.rad mark");
    assert!(ours(&argv, b"!double a", &TestLoader::default()).is_err());
}
