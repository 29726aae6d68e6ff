use super::*;
use radsight_loader::MemoryLoader;

fn words(line: &str) -> Vec<String> {
    match &split(line).unwrap().pipelines[0].stages[0] {
        Stage::Command(command) => command.words.iter().map(|word| word.text.clone()).collect(),
        Stage::Group { .. } => panic!("a group"),
    }
}

fn needs_shell(line: &str) -> (&'static str, String) {
    match split(line).unwrap_err() {
        SyntaxError::NeedsShell { construct, text, range } => {
            assert_eq!(line[range].to_owned(), text);
            (construct, text)
        }
        other => panic!("{other}"),
    }
}

#[test]
fn quotes_and_backslashes_are_taken_away() {
    assert_eq!(words(r#"a 'b c' "d 'e'" f\ g h'i'"j" "" "#), ["a", "b c", "d 'e'", "f g", "hij", ""]);
    assert_eq!(words(r#"echo "a\"b\\c\d" '\n' \'"#), ["echo", "a\"b\\c\\d", "\\n", "'"]);
    assert_eq!(words("rcalc -e '$1=2' \"$\" a$ x#y # rest"), ["rcalc", "-e", "$1=2", "$", "a$", "x#y"]);
}

#[test]
fn a_backslash_joins_lines() {
    assert_eq!(words("genbox m n \\\n  1 2 3"), ["genbox", "m", "n", "1", "2", "3"]);
    assert_eq!(words("genbox m n \\\r\n 1 2 3\r"), ["genbox", "m", "n", "1", "2", "3"]);
    assert_eq!(words("xfo\\\nrm a"), ["xform", "a"]);
}

#[test]
fn ranges_point_into_the_line() {
    let line = "cat  'a b' | xform -t 0 0 1 < in";
    let script = split(line).unwrap();
    let Stage::Command(cat) = &script.pipelines[0].stages[0] else { panic!() };
    assert_eq!(&line[cat.words[1].range.clone()], "'a b'");
    let Stage::Command(xform) = &script.pipelines[0].stages[1] else { panic!() };
    assert_eq!(&line[xform.input.as_ref().unwrap().range.clone()], "in");
}

#[test]
fn groups_hold_sequences() {
    let script = split("( echo a ; cnt 3 | rcalc -e x ) | xform\ncat b;").unwrap();
    assert_eq!(script.pipelines.len(), 2);
    let Stage::Group { script: inner, .. } = &script.pipelines[0].stages[0] else { panic!() };
    assert_eq!(inner.pipelines.len(), 2);
    assert_eq!(inner.pipelines[1].stages.len(), 2);
}

#[test]
fn what_needs_a_shell_is_named() {
    assert_eq!(needs_shell("xform $HOME/a.rad"), ("a variable", "$HOME".into()));
    assert_eq!(needs_shell("rcalc -e \"$1=2\""), ("a variable", "$1".into()));
    assert_eq!(needs_shell("xform `ls a` b"), ("a command in back-quotes", "`ls a`".into()));
    assert_eq!(needs_shell("a && b"), ("the operator \"and\"", "&&".into()));
    assert_eq!(needs_shell("a > b"), ("output into a file", ">".into()));
    assert_eq!(needs_shell("a 2> b"), ("a numbered redirection", "2>".into()));
    assert_eq!(needs_shell("A=1 b"), ("a variable setting", "A=".into()));
    assert_eq!(needs_shell("cat ~/a"), ("a home directory", "~".into()));
    assert_eq!(words("rcalc -e x=1"), ["rcalc", "-e", "x=1"]);
}

#[test]
fn broken_lines_say_what_is_wrong() {
    let message = |line: &str| split(line).unwrap_err().to_string();
    assert_eq!(message("echo 'a"), "the quote ' is never closed");
    assert_eq!(message("echo a |"), "expected a command, found the end of the line");
    assert_eq!(message("| b"), "expected a command, found \"|\"");
    assert_eq!(message("(a; b"), "the parenthesis is never closed");
    assert_eq!(message("a )"), "unexpected \")\"");
    assert_eq!(message("a (b)"), "unexpected \"(\"");
    assert_eq!(message("a <"), "unexpected end of the line after \"<\"");
    assert_eq!(message(&"(".repeat(100)), "more than 32 nested parentheses");
    assert!(message("a $b").ends_with("if it is meant literally, put it in single quotes"));
}

#[test]
fn joined_words_split_to_the_same_words() {
    let originals: Vec<String> = ["a", "", "b c", "it's", "$1=\"x\"", "a\\b", "*"].map(String::from).into();
    assert_eq!(words(&join(&originals)), originals);
}

#[test]
fn a_pattern_becomes_the_files_that_it_matches_and_else_stays() {
    let loader = MemoryLoader::default().with("a.rad", "").with("b.rad", "").with(".c.rad", "").with("d/e.rad", "");
    let after = |line: &str| -> Vec<String> {
        let script = split(line).unwrap();
        let Stage::Command(command) = &script.pipelines[0].stages[0] else { panic!() };
        expanded(&command.words, &loader).into_iter().map(|word| word.text).collect()
    };
    assert_eq!(after("xform *.rad"), ["xform", "a.rad", "b.rad"]);
    assert_eq!(after("xform [b-z].rad ?.rad"), ["xform", "b.rad", "a.rad", "b.rad"]);
    assert_eq!(after("xform .*.rad d/*"), ["xform", ".c.rad", "d/e.rad"]);
    assert_eq!(after("xform '*.rad' \\*.rad \"?\".rad"), ["xform", "*.rad", "*.rad", "?.rad"]);
    assert_eq!(after("genrev m tube t*0.994 0.05 32"), ["genrev", "m", "tube", "t*0.994", "0.05", "32"]);
    assert_eq!(after("gensurf a b 'x[1]' a[1 [ ]"), ["gensurf", "a", "b", "x[1]", "a[1", "[", "]"]);
    assert_eq!(after("xform '['*.rad"), ["xform", "[*.rad"]);
    assert_eq!(after("xform **.rad **/e.rad"), ["xform", "a.rad", "b.rad", "d/e.rad"]);
    assert_eq!(after("xform '*'*.rad"), ["xform", "**.rad"]);
}
