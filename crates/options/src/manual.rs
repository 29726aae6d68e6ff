//! Manual pages in the `man(7)` language.

use crate::help::explanation;
use crate::program::Program;
use roff::{Roff, bold, roman};

/// The manual page of a program.
#[must_use]
pub fn manual_page(program: &Program) -> String {
    let mut page = Roff::new();
    page.control("TH", [program.name, "1", "", concat!("radsight ", env!("CARGO_PKG_VERSION")), "Radiance programs"]);
    page.control("SH", ["NAME"]);
    page.text([roman(format!("{} - {}", program.name, program.summary))]);
    page.control("SH", ["SYNOPSIS"]);
    page.text([roman(program.synopsis)]);
    page.control("SH", ["DESCRIPTION"]);
    page.text([roman(sentence(program.summary))]);
    if !program.description.is_empty() {
        page.control("PP", []);
        page.text([roman(program.description)]);
    }
    page.control("PP", []);
    page.text([
        roman("This is radsight, called by the name of a program of Radiance's. "),
        bold("radsight "),
        bold(program.name),
        roman(" is the same program."),
    ]);
    for group in program.groups {
        page.control("SH", [group.title.to_uppercase().as_str()]);
        for option in group.options {
            page.control("TP", []);
            page.text([bold(option.usage())]);
            page.text([roman(format!("{}.", explanation(program, option)))]);
        }
    }
    page.control("SH", ["EXIT STATUS"]);
    page.text([roman("0 success, 1 wrong input, 2 wrong command line, 3 a limit was exceeded or a fault occurred.")]);
    page.control("SH", ["SEE ALSO"]);
    page.text([bold("radsight"), roman("(1)")]);
    page.render()
}

/// A summary as a sentence with a capital letter and a full stop.
fn sentence(summary: &str) -> String {
    let mut letters = summary.chars();
    letters.next().map_or_else(String::new, |first| format!("{}{}.", first.to_uppercase(), letters.as_str()))
}

/// The path of a program's page in a folder of manual pages.
#[must_use]
pub fn manual_page_file(name: &str) -> String {
    format!("man1/{name}.1")
}
