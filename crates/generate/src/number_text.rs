//! Numbers at the start of a word, as C's `atof` and `atoi` find them.

/// The number that starts `word`, after white space, and how many bytes it takes with that white space.
///
/// Takes what `strtod` takes in decimal: a sign, digits with at most one point, an exponent. Not `inf`, `nan` or hexadecimal.
pub(crate) fn leading_number(word: &str) -> Option<(f64, usize)> {
    let bytes = word.as_bytes();
    let start = skip(bytes, 0, |byte| crate::text::is_space(byte as char));
    let digits_start = if matches!(bytes.get(start), Some(b'+' | b'-')) { start + 1 } else { start };
    let whole_end = skip(bytes, digits_start, |byte| byte.is_ascii_digit());
    let (mut end, mut count) = (whole_end, whole_end - digits_start);
    if bytes.get(end) == Some(&b'.') {
        let fraction_end = skip(bytes, end + 1, |byte| byte.is_ascii_digit());
        count += fraction_end - end - 1;
        end = fraction_end;
    }
    if count == 0 {
        return None;
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent_end = skip(bytes, end + 1 + sign, |byte| byte.is_ascii_digit());
        if exponent_end > end + 1 + sign {
            end = exponent_end;
        }
    }
    Some((word[start..end].parse().ok()?, end))
}

/// The decimal integer that starts `word`, after white space, and how many bytes it takes with that white space.
pub(crate) fn leading_integer(word: &str) -> Option<(i64, usize)> {
    let bytes = word.as_bytes();
    let start = skip(bytes, 0, |byte| crate::text::is_space(byte as char));
    let digits_start = if matches!(bytes.get(start), Some(b'+' | b'-')) { start + 1 } else { start };
    let end = skip(bytes, digits_start, |byte| byte.is_ascii_digit());
    if end == digits_start {
        return None;
    }
    Some((word[start..end].parse().ok()?, end))
}

/// Whether the whole word is a number, as Radiance's own readers demand.
pub(crate) fn whole_number(word: &str) -> Option<f64> {
    leading_number(word).filter(|(_, end)| *end == word.len()).map(|(value, _)| value)
}

fn skip(bytes: &[u8], from: usize, wanted: impl Fn(u8) -> bool) -> usize {
    let rest = bytes.get(from..).unwrap_or_default();
    from + rest.iter().take_while(|byte| wanted(**byte)).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_end_where_c_ends_them() {
        assert_eq!(leading_number(" -.5e1x"), Some((-5.0, 6)));
        assert_eq!(leading_number("1.e"), Some((1.0, 2)));
        assert_eq!(leading_number("+3e+"), Some((3.0, 2)));
        assert_eq!(leading_number("."), None);
        assert_eq!(leading_number("nan"), None);
        assert_eq!(leading_integer("12:30"), Some((12, 2)));
        assert_eq!(leading_integer("99999999999999999999"), None);
    }
}
