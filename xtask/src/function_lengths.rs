//! Measures the lengths of functions.

/// Lengths in lines of the functions of a source formatted by rustfmt, from `fn` to the closing
/// brace, without tests.
///
/// In formatted text a function ends at the first closing brace with the indentation of its first
/// line, so no parser is needed.
pub(crate) fn function_lengths(source: &str) -> Vec<usize> {
    let lines: Vec<&str> = source.lines().take_while(|line| *line != "#[cfg(test)]").collect();
    let lengths = lines.iter().enumerate().filter(|(_, line)| begins_function(line));
    lengths.filter_map(|(at, _)| length(&lines[at..])).collect()
}

fn begins_function(line: &str) -> bool {
    let mut words = line.split_whitespace();
    words.by_ref().find(|word| !is_qualifier(word)) == Some("fn")
}

fn is_qualifier(word: &str) -> bool {
    word.starts_with("pub") || ["const", "async", "unsafe", "extern", "\"C\""].contains(&word)
}

/// Length of the function that begins at the first line; `None` if it has no body.
fn length(lines: &[&str]) -> Option<usize> {
    let indent = lines[0].len() - lines[0].trim_start().len();
    let opening = lines.iter().position(|line| line.ends_with(['{', '}', ';']))?;
    match lines[opening].chars().last() {
        Some('{') => {
            let is_end = |line: &&str| line.len() == indent + 1 && line.ends_with('}');
            let body = lines[opening + 1..].iter().position(is_end)?;
            Some(opening + 1 + body + 1)
        }
        Some('}') => Some(opening + 1),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_end_at_their_own_brace() {
        let source = "impl A {\n    pub(crate) const fn one(&self) -> u8 {\n        if x {\n        }\n    }\n\n    fn two() {}\n}\n\
                      trait B {\n    fn three();\n}\nfn four(\n    a: u8,\n) -> u8 {\n    a\n}\n// fn five() {\n\
                      #[cfg(test)]\nmod tests {\n    fn six() {}\n}\n";
        assert_eq!(function_lengths(source), [4, 1, 5]);
    }
}
