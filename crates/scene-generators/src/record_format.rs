//! The record formats of `rcalc -i` and `-o`: literal text, `${number}` and `$(string)`.

/// One part of a format.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Field {
    Literal(Vec<u8>),
    /// A string variable; `width` is the length of the field in the format.
    Text {
        name: String,
        width: usize,
    },
    /// A variable on input, an expression on output.
    Number {
        name: String,
        width: usize,
    },
}

/// Parses the format of a record that ends at a line end.
pub(crate) fn read_line(specification: &[u8]) -> Result<Vec<Field>, String> {
    let mut fields = read(specification)?;
    if !specification.is_empty() && !specification.ends_with(b"\n") {
        fields.push(Field::Literal(b"\n".to_vec()));
    }
    Ok(fields)
}

/// Parses a format.
pub(crate) fn read(specification: &[u8]) -> Result<Vec<Field>, String> {
    let mut fields: Vec<Field> = Vec::new();
    let mut rest = specification;
    while !rest.is_empty() {
        let (field, behind) = read_field(rest)?;
        fields.push(field);
        rest = behind;
    }
    Ok(fields)
}

fn read_field(text: &[u8]) -> Result<(Field, &[u8]), String> {
    let close = match text {
        [b'$', b'{', ..] => b'}',
        [b'$', b'(', ..] => b')',
        [b'$', b'$', ..] => return Ok(literal(&text[1..])),
        [b'$', ..] => return Err("\"$\" is followed by neither \"{\", \"(\" nor \"$\"".to_owned()),
        _ => return Ok(literal(text)),
    };
    let end = text.iter().position(|byte| *byte == close).unwrap_or(text.len());
    let inside: Vec<u8> = text[2..end].iter().copied().filter(|byte| !byte.is_ascii_whitespace()).collect();
    let name = String::from_utf8_lossy(&inside).into_owned();
    let width = (end + 1).min(text.len());
    let field = if close == b'}' { Field::Number { name, width } } else { Field::Text { name, width } };
    Ok((field, &text[width..]))
}

/// Text up to the next dollar sign after the first byte.
fn literal(text: &[u8]) -> (Field, &[u8]) {
    let end = text.iter().skip(1).position(|byte| *byte == b'$').map_or(text.len(), |index| index + 1);
    (Field::Literal(text[..end].to_vec()), &text[end..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_have_names_and_widths() {
        let fields = read_line(b"a$$b ${ x }\n$(word)").unwrap();
        assert_eq!(
            fields,
            [
                Field::Literal(b"a".to_vec()),
                Field::Literal(b"$b ".to_vec()),
                Field::Number { name: "x".into(), width: 6 },
                Field::Literal(b"\n".to_vec()),
                Field::Text { name: "word".into(), width: 7 },
                Field::Literal(b"\n".to_vec()),
            ]
        );
        assert!(read_line(b"$x").is_err());
    }
}
