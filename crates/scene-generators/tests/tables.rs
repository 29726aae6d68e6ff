//! Compares rcollate and tabfunc with the real programs or their recorded output.

mod oracle;

use oracle::{Numbers, Radiance, TestLoader, ours, words};

/// Bytes from text with C's escapes.
fn unescaped(text: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut rest = text.bytes();
    while let Some(byte) = rest.next() {
        if byte != b'\\' {
            bytes.push(byte);
            continue;
        }
        bytes.push(match rest.next().expect("something is escaped") {
            b'n' => b'\n',
            b't' => b'\t',
            b'r' => b'\r',
            b'x' => {
                let digits = [rest.next(), rest.next()].map(|digit| digit.expect("two digits") as char);
                u8::from_str_radix(&String::from_iter(digits), 16).expect("a byte")
            }
            other => other,
        });
    }
    bytes
}

#[test]
fn matrices_are_collated_as_by_the_real_program() {
    let references = include_str!("references/rcollate.txt");
    let mut lines = references.lines().skip(1);
    let mut count = 0;
    while let Some(command) = lines.next() {
        let mut part =
            |name: &str| lines.next().and_then(|line| line.strip_prefix(name)).map(unescaped).expect("a part");
        let (input, expected) = (part("input "), part("output "));
        let argv = words(command.strip_prefix("command ").expect("a command"));
        let output = ours(&argv, &input, &TestLoader::default()).unwrap_or_else(|error| panic!("{command}: {error}"));
        let found = output.standard_output;
        assert_eq!(String::from_utf8_lossy(&found), String::from_utf8_lossy(&expected), "{command}");
        assert_eq!(found, expected, "{command}");
        count += 1;
    }
    assert_eq!(count, 59);
}

#[test]
fn what_real_rcollate_writes_in_part_is_whole() {
    let made = |line: &str, input: &[u8]| ours(&words(line), input, &TestLoader::default()).unwrap();
    let text = |line: &str, input: &str| String::from_utf8(made(line, input.as_bytes()).standard_output).unwrap();
    // The real program fails after the last row.
    assert_eq!(text("rcollate -h -fa1 -oc 3", "1 2 3 4 5 6\n"), "1\t2\t3\n4\t5\t6\n");
    let warned = made("rcollate -h -fa1 -ir 2 -ic 2 -oc 4 -or 1", b"1 2 3 4\n5\n");
    assert_eq!(warned.standard_output, b"1\t2\t3\t4\n");
    assert_eq!(warned.warnings, ["there are 5 records, expected 2 × 2"]);
    let left = made("rcollate -h -ff -ic 2 -ir 2 -t", &[0; 19]);
    assert_eq!(
        (left.standard_output.len(), &left.warnings[0][..]),
        (16, "3 bytes follow 2 × 2 records, expected none")
    );
    assert!(made("rcollate -w -h -fa1 -ir 2 -ic 2 -oc 4 -or 1", b"1 2 3 4\n5\n").warnings.is_empty());
}

#[test]
fn wrong_matrices_are_reported() {
    let header = "#?RADIANCE\nNROWS=2\nNCOLS=2\nNCOMP=1\nFORMAT=ascii\n\n1 2\n3 4\n";
    let message = |line: &str, input: &str| match ours(&words(line), input.as_bytes(), &TestLoader::default()) {
        Ok(output) => panic!("{line} gives {:?}", String::from_utf8_lossy(&output.standard_output)),
        Err(error) => error.to_string(),
    };
    for (line, input, mistake) in [
        (
            "rcollate -t",
            "1 2 3\n",
            "standard input: the header does not end with an empty line; use option -hi for input without a header",
        ),
        ("rcollate -ff -t", header, "the format is ascii in the header, but float in the options"),
        ("rcollate -fa2 -t", header, "the header has 1 components, but the options request 2"),
        ("rcollate -ic 3 -t", header, "the header has 2 columns, but the options request 3"),
        ("rcollate -oc 3", header, "there are 4 records, expected 1 rows of 3"),
        ("rcollate -oc 3 -or 2", header, "there are 4 records, expected 2 rows of 3"),
        ("rcollate -t", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n", "the format is \"32-bit_rle_rgbe\", expected ascii"),
        ("rcollate -t", "#?RADIANCE\nNROWS=no\n\n", "the header has \"no\" rows, expected a count above zero"),
        (
            "rcollate -h -t",
            "1 2 3\n4 5\n",
            "line 2 of the data ends after 2 of 3 components of a record; -fa1 is for single",
        ),
        ("rcollate -h -fa1 -t -ic 2", "1 2\n3\n", "there are 3 records"),
        ("rcollate -h -fa1 -ic 3 -ir 2 -oc 6", "1 2\n3\n", "there are 3 records, expected 2 × 3"),
        ("rcollate -h -fa1 -c -oc 1", "1\nx\n", "\"x\" is not a number"),
        ("rcollate -h -fd -ir 3 -t", "1234567812345678", "there are 2 records"),
        ("rcollate -o 3x", header, "rcollate: blocks (-o) are \"3x\", expected counts as in 4x8 or 2x2x4x8"),
        ("rcollate -o 99999999999x99999999999x99999999999x99999999999", header, "there are 4 records"),
        ("rcollate -oc 0", header, "output columns (-oc) is 0, expected an integer above zero"),
        ("rcollate -fx", header, "rcollate: unknown option \"-fx\""),
        ("rcollate -fa0 -t", header, "rcollate: unknown option \"-fa0\""),
        ("rcollate -q", header, "rcollate: unknown option \"-q\""),
        ("rcollate -t a b", header, "rcollate: unexpected argument \"b\""),
    ] {
        assert!(message(line, input).contains(mistake), "{line}: {}", message(line, input));
    }
}

/// Removes the number that distinguishes helper functions of one run from those of another.
fn anonymous(text: &str) -> String {
    let mut parts = text.split("`p");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| text + "`p" + part.trim_start_matches(|c: char| c.is_ascii_digit()))
}

#[test]
fn tables_are_the_functions_of_the_real_program() {
    let Some(radiance) = Radiance::find() else { return };
    let mut numbers = Numbers(5);
    let mut tables = vec![
        "# head\n1 2 3\n2 5 -1e3\n3 1 .5\n".to_owned(),
        "0, 1, 4\n.5, 2, 1e-5\n1, 3, 0\n1.5, 4.25, 7\n".to_owned(),
        " 5\t1 2\n4\t8 3\n3\t9 4 \n2\t0 1\n".to_owned(),
        "1 4 5\n2 6 1\n4 9 9\n7 3 2\n".to_owned(),
        "9 4 5\nnothing\n8.5 6 1\n2 9 9\n".to_owned(),
        "3 4 5\n4 6 1\n5 9 9\n".to_owned(),
        "7 4 5\n".to_owned(),
        "10 1 2\n8 3 4\n6 5 6\n4 7 8\n".to_owned(),
        "100000 1 2\n100001 3 4\n1000002 5 6\n".to_owned(),
    ];
    for _ in 0..20 {
        let mut variable = numbers.between(-5.0, 5.0);
        let uneven = numbers.chance(2);
        let mut row = |numbers: &mut Numbers| {
            variable += if uneven { numbers.between(0.1, 3.0) } else { 0.25 };
            format!("{variable:.4} {} {}\n", numbers.text(-9.0, 9.0), numbers.text(0.0, 1e6))
        };
        tables.push((0..30).map(|_| row(&mut numbers)).collect());
    }
    for table in &tables {
        for line in ["tabfunc f g", "tabfunc -i f g", "tabfunc -i 0 second", "tabfunc longer_name"] {
            let real = radiance.run(&words(line), table.as_bytes(), None).standard_output;
            let made = ours(&words(line), table.as_bytes(), &TestLoader::default()).unwrap();
            let made = String::from_utf8(made.standard_output).unwrap();
            // Line breaks depend on the length of the numbers.
            let words = |text: &str| anonymous(text).split_whitespace().collect::<String>();
            assert_eq!(words(&made), words(&real), "{line}\n{table}");
        }
    }
}

#[test]
fn functions_of_tables_are_computed() {
    let table = b"0 1 10\n1 3 20\n4 9 80\n";
    let made = ours(&words("tabfunc -i f g"), table, &TestLoader::default()).unwrap().standard_output;
    let loader = TestLoader { files: [("t.cal".to_owned(), made)].into(), ..TestLoader::default() };
    let line = "rcalc -f t.cal -e $1=f($1);$2=g($1)";
    let output = ours(&words(line), b"-1\n0\n.5\n2.5\n4\n9\n", &loader).unwrap().standard_output;
    assert_eq!(String::from_utf8(output).unwrap(), "1\t10\n1\t10\n2\t15\n6\t50\n9\t80\n9\t80\n");
    let message =
        |line: &str, table: &str| ours(&words(line), table.as_bytes(), &TestLoader::default()).unwrap_err().to_string();
    for (line, table, mistake) in [
        ("tabfunc", "1 2\n", "tabfunc: missing func1"),
        ("tabfunc -x f", "1 2\n", "tabfunc: unknown option \"-x\""),
        ("tabfunc f", "no table\n", "standard input: no line begins with a number, expected rows of a table"),
        ("tabfunc f g", "1 2\n", "line 1: 1 columns beside the variable, expected 2, one for each function"),
        ("tabfunc f", "# x\n1 two\n", "line 2: column 1 beside the variable is not a number"),
        ("tabfunc f", "1 2x\n", "line 1: column 1 beside the variable is not a number"),
        ("tabfunc f", "1 2\n3 4\n2 5\n", "row 3: the variable is not monotonic"),
        ("tabfunc f", "1 2\n1 4\n", "row 2: the variable is not monotonic"),
    ] {
        assert!(message(line, table).contains(mistake), "{line}: {}", message(line, table));
    }
}
