//! Numbers as C's `printf` writes them.

use std::fmt::{self, Display, Formatter, Write};

/// A number as C's `%{width}.{precision}g` prints it: no trailing zeros, an exponent only below 1e-4 and from
/// 10^precision on.
#[derive(Clone, Copy)]
pub(crate) struct General {
    pub(crate) value: f64,
    pub(crate) width: usize,
    pub(crate) precision: usize,
}

/// `%18.12g`, the form of `xform`.
pub(crate) fn wide(value: f64) -> General {
    General { value, width: 18, precision: 12 }
}

/// `%12.6g`.
pub(crate) fn short(value: f64) -> General {
    General { value, width: 12, precision: 6 }
}

impl Display for General {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        let mut text = String::with_capacity(24);
        write_general(&mut text, self.value, self.precision)?;
        write!(formatter, "{text:>width$}", width = self.width)
    }
}

fn write_general(out: &mut String, value: f64, precision: usize) -> fmt::Result {
    if value.is_finite() && value == value.trunc() && value.abs() < 1e6 && (value != 0.0 || value.is_sign_positive()) {
        return write!(out, "{}", value as i64);
    }
    if !value.is_finite() {
        let word = if value.is_nan() { "nan" } else { "inf" };
        return write!(out, "{}{word}", if value.is_sign_negative() { "-" } else { "" });
    }
    let scientific = format!("{:.*e}", precision - 1, value);
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if exponent < -4 || exponent >= precision as i32 {
        let mantissa = without_trailing_zeros(mantissa);
        return write!(out, "{mantissa}e{}{:02}", if exponent < 0 { '-' } else { '+' }, exponent.abs());
    }
    let decimals = (precision as i32 - 1 - exponent) as usize;
    out.push_str(without_trailing_zeros(&format!("{value:.decimals$}")));
    Ok(())
}

fn without_trailing_zeros(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn general_numbers_are_those_of_c() {
        for (value, expected) in [
            (0.0, "0"),
            (-0.0, "-0"),
            (0.1, "0.1"),
            (1e12, "1e+12"),
            (123_456_789_012.0, "123456789012"),
            (1e-4, "0.0001"),
            (1e-5, "1e-05"),
            (1.0 / 3.0, "0.333333333333"),
            (-2.0 / 3.0 * 1e-7, "-6.66666666667e-08"),
            (99_999.999_999_999_9, "100000"),
            (1_234_500_000.25, "1234500000.25"),
        ] {
            assert_eq!(wide(value).to_string().trim(), expected);
        }
        assert_eq!(wide(0.5).to_string(), "               0.5");
        assert_eq!(short(1_234_567.0).to_string(), " 1.23457e+06");
    }
}
