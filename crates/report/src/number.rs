//! Formats numbers for display.

/// A number with this many significant digits; very small and very large ones with an exponent.
pub(crate) fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "none".to_owned();
    }
    let magnitude = if value == 0.0 { 0 } else { value.abs().log10().floor() as i32 };
    if !(-4..6).contains(&magnitude) {
        return format!("{value:.*e}", digits.saturating_sub(1));
    }
    format!("{value:.*}", (digits as i32 - 1 - magnitude).max(0) as usize)
}

/// The same without trailing zeros, for scales.
pub(crate) fn short(value: f64) -> String {
    let text = significant(value, 3);
    let (number, power) = text.split_at(text.find('e').unwrap_or(text.len()));
    match number.contains('.') {
        true => format!("{}{power}", number.trim_end_matches('0').trim_end_matches('.')),
        false => text,
    }
}

/// A duration in a suitable unit.
pub(crate) fn seconds(value: f64) -> String {
    match value {
        v if v < 0.0995 => format!("{:.1} ms", 1e3 * v),
        v if v < 99.95 => format!("{v:.2} s"),
        v if v < 7200.0 => format!("{:.1} min", v / 60.0),
        v => format!("{:.2} h", v / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_count_from_the_first() {
        let shown = [0.0, 1.0, 123.456, 0.00123456, 1.23456e-7, 1.5e9, 999_999.0].map(|value| significant(value, 4));
        assert_eq!(shown, ["0.000", "1.000", "123.5", "0.001235", "1.235e-7", "1.500e9", "999999"]);
        assert_eq!([0.0, 0.5, 100.0, 2e-9].map(short), ["0", "0.5", "100", "2e-9"]);
        assert_eq!(
            [0.0123, 1.0, 90.0, 600.0, 8000.0].map(seconds),
            ["12.3 ms", "1.00 s", "90.00 s", "10.0 min", "2.22 h"]
        );
    }
}
