//! A camera file with some of its keys replaced, for series of captures.

use toml::de::{DeTable, DeValue};

/// Why a key cannot be replaced.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum KeyError {
    /// The word is not the name of a table, a dot, and the name of a key.
    Name,
    /// Its table is not written under a header of its own.
    NoHeader,
}

impl std::fmt::Display for KeyError {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(match self {
            KeyError::Name => "expected a table and a key of the camera file, such as rig.ring_diameter_mm",
            KeyError::NoHeader => "the camera file does not have its table under a header such as [rig]",
        })
    }
}

impl std::error::Error for KeyError {}

/// Replaces the value of `table.key` in the text of a camera file, or adds it. A value that is not
/// TOML becomes a string.
///
/// A text that is not TOML is returned unchanged. Such a text, unknown keys and wrong values are
/// reported when the result is read.
///
/// ```
/// let text = "[rig]\nleds = 12 # of 5 mm\n";
/// let replaced = radsight_camera::with_key(text, "rig.leds", "6").unwrap();
/// assert_eq!(replaced, "[rig]\nleds = 6 # of 5 mm\n");
/// let added = radsight_camera::with_key(text, "sensor.preset", "imx174").unwrap();
/// assert_eq!(added, "[rig]\nleds = 12 # of 5 mm\n\n[sensor]\npreset = \"imx174\"\n");
/// ```
///
/// # Errors
/// [`KeyError`].
pub fn with_key(text: &str, key: &str, value: &str) -> Result<String, KeyError> {
    let (table_name, key) = key.split_once('.').ok_or(KeyError::Name)?;
    if [table_name, key].iter().any(|name| name.is_empty() || !name.bytes().all(is_bare)) {
        return Err(KeyError::Name);
    }
    let value = as_toml(value);
    let Ok(document) = DeTable::parse(text) else { return Ok(text.to_owned()) };
    let Some((header, table)) = document.get_ref().get_key_value(table_name) else {
        return Ok(format!("{}\n\n[{table_name}]\n{key} = {value}\n", text.trim_end()));
    };
    let DeValue::Table(table) = table.get_ref() else { return Ok(text.to_owned()) };
    if let Some(old) = table.get(key) {
        let span = old.span();
        return Ok([&text[..span.start], &value, &text[span.end..]].concat());
    }
    let start = text[..header.span().start].rfind('\n').map_or(0, |at| at + 1);
    let end = text[start..].find('\n').map_or(text.len(), |at| start + at);
    if !text[start..end].trim_start().starts_with('[') {
        return Err(KeyError::NoHeader);
    }
    Ok(format!("{}\n{key} = {value}{}", &text[..end], &text[end..]))
}

fn is_bare(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-')
}

fn as_toml(value: &str) -> String {
    let line = format!("value = {value}");
    let is_value = !value.contains(['\n', '\r', '#'])
        && DeTable::parse(&line).is_ok_and(|table| table.get_ref().len() == 1 && table.get_ref().contains_key("value"));
    if is_value {
        return value.to_owned();
    }
    // Numbers such as .5, which TOML does not allow, and lists of them.
    let number = |text: &str| -> Option<String> {
        let number: f64 = text.trim().parse().ok()?;
        number.is_finite().then(|| format!("{number:?}"))
    };
    let list = || -> Option<String> {
        let numbers = value.trim().strip_prefix('[')?.strip_suffix(']')?;
        let numbers: Option<Vec<String>> = numbers.split(',').map(number).collect();
        Some(format!("[{}]", numbers?.join(", ")))
    };
    number(value).or_else(list).unwrap_or_else(|| format!("\"{}\"", value.replace('\\', "\\\\").replace('"', "\\\"")))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "[camera]\npixels = [2, 3]\n# more\n[rig]\nleds = 12\n";

    #[test]
    fn a_key_is_replaced_where_it_stands() {
        let text = with_key(TEXT, "camera.pixels", "[4, 5]").unwrap();
        assert_eq!(text, "[camera]\npixels = [4, 5]\n# more\n[rig]\nleds = 12\n");
    }

    #[test]
    fn a_key_is_added_under_its_header() {
        let text = with_key(TEXT, "camera.pinhole_model", "point").unwrap();
        assert_eq!(text, "[camera]\npinhole_model = \"point\"\npixels = [2, 3]\n# more\n[rig]\nleds = 12\n");
    }

    #[test]
    fn what_is_no_key_is_told() {
        for key in ["leds", ".leds", "rig.", "rig.a.b", "rig.a b"] {
            assert_eq!(with_key(TEXT, key, "1"), Err(KeyError::Name), "{key}");
        }
        assert_eq!(with_key("rig.leds = 2\n", "rig.ring", "1"), Err(KeyError::NoHeader));
    }

    #[test]
    fn a_number_needs_no_zero_before_the_point() {
        assert_eq!(with_key(TEXT, "rig.leds", ".5").unwrap(), TEXT.replace("12", "0.5"));
        assert_eq!(with_key(TEXT, "camera.pixels", "[0,-.5, 2.]").unwrap(), TEXT.replace("[2, 3]", "[0.0, -0.5, 2.0]"));
        assert_eq!(with_key(TEXT, "rig.leds", "[.5, x]").unwrap(), TEXT.replace("12", "\"[.5, x]\""));
    }

    #[test]
    fn a_value_cannot_add_another_key() {
        let text = with_key(TEXT, "rig.leds", "1\nring = 2").unwrap();
        assert!(DeTable::parse(&text).is_err(), "{text}");
        assert_eq!(with_key(TEXT, "rig.leds", "1 # x").unwrap(), TEXT.replace("12", "\"1 # x\""));
    }
}
