//! Signatures and lengths of functions: no parameter is a bool, no tuple hides a list of
//! parameters, and most functions are short.

use crate::function_lengths::function_lengths;
use crate::sources::{lines_without_comments, rust_files};
use std::fs;
use std::path::Path;

/// A tuple with more members than this needs names: a struct.
const MOST_MEMBERS: usize = 3;

/// The file and the name of a function that may have a bool parameter, and why.
const EXCEPTIONS: &[(&str, &str, &str)] =
    &[("src/switch.rs", "switched", "Radiance's switches toggle a state that is on or off")];

/// A function's name, parameters and result.
#[derive(Debug, PartialEq)]
struct Signature<'t> {
    name: &'t str,
    parameters: &'t str,
    result: &'t str,
}

/// The functions of a source without comments. A source that compiles has balanced brackets.
fn signatures(text: &str) -> Vec<Signature<'_>> {
    text.match_indices("fn ")
        .filter(|(at, _)| text[..*at].ends_with([' ', '\n', '(']))
        .filter_map(|(at, _)| signature(&text[at + 3..]))
        .collect()
}

/// The signature whose name begins here; none for a function pointer's type.
fn signature(text: &str) -> Option<Signature<'_>> {
    let name_end = text.find(|c: char| !(c.is_alphanumeric() || c == '_')).filter(|end| *end > 0)?;
    let open = name_end + generics(&text[name_end..])?;
    let close = open + closing(&text[open..])?;
    let rest = &text[close + 1..];
    let end = rest.find(['{', ';']).unwrap_or(rest.len());
    Some(Signature { name: &text[..name_end], parameters: &text[open + 1..close], result: &rest[..end] })
}

/// Length of the generic parameters before the opening parenthesis.
fn generics(text: &str) -> Option<usize> {
    if !text.starts_with('<') {
        return text.starts_with('(').then_some(0);
    }
    let mut depth = 0;
    let end = text.char_indices().find(|(at, c)| {
        depth += i32::from(*c == '<') - i32::from(*c == '>' && !text[..*at].ends_with('-'));
        depth == 0
    })?;
    text[end.0 + 1..].starts_with('(').then_some(end.0 + 1)
}

/// Position of the parenthesis that closes the first one.
fn closing(text: &str) -> Option<usize> {
    let mut depth = 0;
    text.char_indices().find_map(|(at, c)| {
        depth += i32::from(c == '(') - i32::from(c == ')');
        (depth == 0).then_some(at)
    })
}

/// Whether a parameter is a bool.
fn has_bool(parameters: &str) -> bool {
    let words: Vec<&str> = parameters.split_inclusive([',', ':']).collect();
    words.windows(2).any(|pair| {
        let kind = pair[1].trim().trim_end_matches(',').trim_start_matches('&').trim_start_matches("mut ");
        pair[0].ends_with(':') && ["bool", "Option<bool>"].contains(&kind)
    })
}

/// Number of members of the longest tuple type, parameters of closures aside.
fn longest_tuple(types: &str) -> usize {
    let opens = types.match_indices('(').map(|(at, _)| at).filter(|at| {
        let before = types[..*at].trim_end();
        !["Fn", "FnMut", "FnOnce", "fn"].iter().any(|callable| before.ends_with(callable))
    });
    opens.filter_map(|at| Some(members(&types[at + 1..at + closing(&types[at..])?]))).max().unwrap_or(0)
}

/// Number of members of a tuple's content.
fn members(content: &str) -> usize {
    let mut depth = 0;
    let inner: Vec<&str> = content
        .split(|c: char| {
            depth += i32::from("([<".contains(c)) - i32::from(")]>".contains(c));
            c == ',' && depth == 0
        })
        .collect();
    inner.iter().filter(|member| !member.trim().is_empty()).count()
}

#[test]
fn no_parameter_is_a_bool_or_a_long_tuple() {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR"));
    let files =
        ["bindings", "crates", "plugins", "src", "tests", "xtask"].map(|folder| rust_files(&repository.join(folder)));
    let (mut wrong, mut used, mut count) = (Vec::new(), vec![false; EXCEPTIONS.len()], 0);
    for path in files.concat() {
        let name = path.strip_prefix(repository).expect("it is inside").to_string_lossy().replace('\\', "/");
        if name == "tests/repository/signatures.rs" {
            continue;
        }
        let text = fs::read_to_string(&path).expect("the file is read");
        let text = lines_without_comments(&text).collect::<Vec<_>>().join("\n");
        for Signature { name: function, parameters, result } in signatures(&text) {
            count += 1;
            if longest_tuple(parameters).max(longest_tuple(result)) > MOST_MEMBERS {
                wrong.push(format!("{name}: {function} has a tuple of more than {MOST_MEMBERS} members"));
            }
            let exception = EXCEPTIONS.iter().position(|(file, except, _)| *file == name && *except == function);
            match exception {
                _ if !has_bool(parameters) => {}
                Some(index) => used[index] = true,
                None => wrong.push(format!("{name}: {function} has a bool parameter")),
            }
        }
    }
    let unused = EXCEPTIONS.iter().zip(used).filter(|(_, used)| !used);
    wrong.extend(unused.map(|((file, function, _), _)| format!("{file}: the exception for {function} is not needed")));
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(count > 5000, "{count} functions were found");
}

#[test]
fn functions_are_short() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates");
    let sources =
        rust_files(&crates).into_iter().filter(|path| path.components().any(|part| part.as_os_str() == "src"));
    let mut lengths: Vec<usize> =
        sources.flat_map(|path| function_lengths(&fs::read_to_string(path).expect("the file is read"))).collect();
    lengths.sort_unstable();
    let [median, most] = [0.5, 0.9].map(|share| lengths[(share * lengths.len() as f64) as usize]);
    assert!(median <= 8 && most < 25, "the median is {median} lines, 90 % have at most {most}");
}

#[test]
fn signatures_are_parsed() {
    let text = "impl A {\n    pub fn one<T: Fn(u8) -> u8>(&self, (a, b): (u8, [u8; 2]), c: &mut bool) -> (u8, u8, u8, u8) {\n}\n}\n\
                fn two(f: impl Fn(bool, u8, u8, u8)) -> Vec<(u8, Option<(u8, u8)>)>;\ntype Three = fn (bool);\nlet fn_four = (1, 2, 3, 4);";
    let found = signatures(text);
    assert_eq!(found.iter().map(|found| found.name).collect::<Vec<_>>(), ["one", "two"]);
    assert_eq!(found.iter().map(|found| has_bool(found.parameters)).collect::<Vec<_>>(), [true, false]);
    assert_eq!(found.iter().map(|found| longest_tuple(found.parameters)).collect::<Vec<_>>(), [2, 0]);
    assert_eq!(found.iter().map(|found| longest_tuple(found.result)).collect::<Vec<_>>(), [4, 2]);
}
