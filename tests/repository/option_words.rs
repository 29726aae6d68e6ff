//! Programs named like Radiance's know their options from the one table (`crates/options`).

use crate::sources::{lines_without_comments, rust_files};
use std::fs;
use std::path::Path;

/// The calls by which a program parses a word with the table.
const READERS: [&str; 8] = [
    ".option()",
    ".option_before_files()",
    ".option_before_numbers()",
    ".last_options()",
    ".last_signed_options()",
    ".meant(",
    "parse_option(",
    "parse_word(",
];

/// Files that match options without these calls, and why.
const EXCEPTIONS: &[(&str, &str)] = &[
    ("crates/parse/src/transform_words.rs", "transforms are words of scene files, too"),
    ("crates/scene-generators/src/mgf/transform.rs", "transforms are words of MGF files"),
    ("crates/scene-generators/src/cat.rs", "cat is a program of Unix"),
    ("crates/scene-generators/src/echo.rs", "echo is a program of Unix"),
    ("src/commands/features.rs", "the answers of -features"),
    ("src/commands/matrix/input.rs", "rmtxop, rcomb and dctimestep parsed the word"),
    ("src/commands/mkillum/options.rs", "src/expand.rs parsed the word"),
    ("src/commands/rcontrib/defaults.rs", "lines of -defaults"),
    ("src/commands/rcontrib/options.rs", "src/expand.rs parsed the word"),
    ("src/commands/rpict/defaults.rs", "lines of -defaults"),
    ("src/commands/rpict/options.rs", "src/expand.rs parsed the word"),
    ("src/commands/rtrace/defaults.rs", "lines of -defaults"),
    ("src/commands/rtrace/options.rs", "src/expand.rs parsed the word"),
    ("src/listed_options.rs", "lines of -defaults"),
    ("src/output_color.rs", "src/expand.rs parsed the word"),
    ("src/render_args.rs", "src/expand.rs parsed the word"),
    ("src/view_args.rs", "src/expand.rs parsed the word"),
];

/// Whether a line is an arm of a match on an option, by its name or by its letters.
fn matches_option(line: &str) -> bool {
    let arm = line.trim_start();
    let pattern = arm.strip_prefix("Some(").unwrap_or(arm);
    let is_name = ["\"-", "\"+"].iter().any(|quoted| {
        pattern.strip_prefix(quoted).is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_alphanumeric()))
    });
    let is_letters = pattern.starts_with("[b'-'") || pattern.starts_with("b\"-");
    (is_name || is_letters) && arm.contains("=>")
}

#[test]
fn options_are_matched_by_names_of_the_table() {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = rust_files(&repository.join("src"));
    files.extend(rust_files(&repository.join("crates/scene-generators/src")));
    files.extend(rust_files(&repository.join("crates/parse/src")));
    let (mut wrong, mut used) = (Vec::new(), vec![false; EXCEPTIONS.len()]);
    for path in files {
        let name = path.strip_prefix(repository).expect("it is inside").to_string_lossy().replace('\\', "/");
        let text = fs::read_to_string(&path).expect("the file is read");
        if !lines_without_comments(&text).any(matches_option) || READERS.iter().any(|reader| text.contains(reader)) {
            continue;
        }
        match EXCEPTIONS.iter().position(|(file, _)| *file == name) {
            Some(index) => used[index] = true,
            None => wrong.push(format!("{name} matches options that the table did not parse")),
        }
    }
    let unused = EXCEPTIONS.iter().zip(used).filter(|(_, used)| !used);
    wrong.extend(unused.map(|((file, _), _)| format!("the exception for {file} is not needed")));
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn arms_of_options_are_found() {
    let found = ["    \"-a\" => a,", "Some(\"-r\") => r,", "[b'-', b'x', ..] => x,", "\"-a\" | \"-b\" if c => b,"];
    assert!(found.iter().all(|line| matches_option(line)));
    assert!(["let a = \"-a\";", "\"-\" => a,", "_ if word == \"-a\" => b,"].iter().all(|line| !matches_option(line)));
}
