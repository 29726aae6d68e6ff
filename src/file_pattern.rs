//! File name patterns with a number or a word, in the syntax of `printf`.

use crate::failure::Failure;

/// Whether a name contains a number format.
pub(crate) fn holds_number(pattern: &str) -> bool {
    named("", pattern, "", 0).is_ok_and(|(_, _, holds_number)| holds_number)
}

/// The name that a pattern gives, and whether it contains the modifier's name and the bin's number. As in
/// Radiance, a pattern with neither is the name as it is.
pub(crate) fn named(program: &str, pattern: &str, modifier: &str, bin: usize) -> Result<(String, bool, bool), Failure> {
    let (name, has_modifier, has_bin) = expanded(program, pattern, modifier, bin)?;
    let name = if has_modifier || has_bin { name } else { pattern.to_owned() };
    Ok((name, has_modifier, has_bin))
}

/// The same, with formats as in `printf`: `%s`, `%d` (also `%03d`, `%o`, `%x`), `%%`.
pub(crate) fn expanded(
    program: &str,
    pattern: &str,
    modifier: &str,
    bin: usize,
) -> Result<(String, bool, bool), Failure> {
    let wrong = || {
        Failure::usage(format!(
            "{program}: output \"{pattern}\" has an unknown % format, expected at most one %s and one %d"
        ))
    };
    let (mut name, mut has_modifier, mut has_bin) = (String::new(), false, false);
    let mut rest = pattern;
    while let Some(at) = rest.find('%') {
        name.push_str(&rest[..at]);
        rest = &rest[at + 1..];
        let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let width: usize = if digits == 0 { 0 } else { rest[..digits].parse().map_err(|_| wrong())? };
        const WIDEST: usize = 255;
        if width > WIDEST {
            return Err(wrong());
        }
        let zeros = rest.starts_with('0');
        let letter = rest[digits..].chars().next().ok_or_else(wrong)?;
        let number = match letter {
            '%' => "%".to_owned(),
            's' if !has_modifier => modifier.to_owned(),
            'd' | 'i' if !has_bin => bin.to_string(),
            'o' if !has_bin => format!("{bin:o}"),
            'x' if !has_bin => format!("{bin:x}"),
            'X' if !has_bin => format!("{bin:X}"),
            _ => return Err(wrong()),
        };
        has_modifier |= letter == 's';
        has_bin |= !matches!(letter, 's' | '%');
        let padding = if zeros && letter != 's' { '0' } else { ' ' };
        (number.chars().count()..width).for_each(|_| name.push(padding));
        name.push_str(&number);
        rest = &rest[digits + letter.len_utf8()..];
    }
    name.push_str(rest);
    Ok((name, has_modifier, has_bin))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percent_signs_are_halved_only_beside_a_format() {
        for (pattern, expected) in
            [("%%.mtx", "%%.mtx"), ("%%%s", "%glow"), ("%%%03d", "%007"), ("%s%%%d", "glow%7"), ("plain", "plain")]
        {
            assert_eq!(named("rcontrib", pattern, "glow", 7).expect("a name").0, expected);
        }
        assert!(named("rcontrib", "%%%q", "glow", 7).is_err());
    }
}
