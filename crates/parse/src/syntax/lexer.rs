//! Words and lines, as nom parsers over bytes.

use super::Word;
use nom::IResult;
use nom::Parser;
use nom::branch::alt;
use nom::bytes::complete::{tag, take_till, take_while, take_while1};
use nom::combinator::{opt, recognize};
use nom::multi::{fold_many0, fold_many1};
use nom::sequence::{delimited, preceded};

/// A parser's result. The error carries nothing: a missing word has no reason.
pub(super) type Lexed<'t, T> = IResult<&'t [u8], T, ()>;

/// White space as in C's `isspace`.
#[inline]
pub(crate) fn is_space(byte: u8) -> bool {
    byte == b' ' || (9..=13).contains(&byte)
}

fn is_quote(byte: u8) -> bool {
    byte == b'"' || byte == b'\''
}

fn is_plain(byte: u8) -> bool {
    !is_space(byte) && !is_quote(byte)
}

/// Any white space.
#[inline]
pub(super) fn space(input: &[u8]) -> Lexed<'_, &[u8]> {
    take_while(is_space).parse(input)
}

/// A word with the white space before it; the flag tells whether it has quotes.
#[inline]
pub(super) fn raw_word(input: &[u8]) -> Lexed<'_, (&[u8], bool)> {
    let (start, _) = space(input)?;
    let (rest, plain) = take_while(is_plain).parse(start)?;
    match rest.first() {
        Some(byte) if is_quote(*byte) => {
            recognize(fold_many1(word_part, || (), |(), _| ())).map(|word| (word, true)).parse(start)
        }
        _ if plain.is_empty() => Err(nom::Err::Error(())),
        _ => Ok((rest, (plain, false))),
    }
}

/// A run of characters without quotes, or the text between two quotes. An unclosed quote extends to
/// the end of the text.
fn word_part(input: &[u8]) -> Lexed<'_, &[u8]> {
    alt((take_while1(is_plain), quoted(b"\""), quoted(b"'"))).parse(input)
}

fn quoted<'t>(quote: &'static [u8; 1]) -> impl Parser<&'t [u8], Output = &'t [u8], Error = ()> {
    delimited(tag(&quote[..]), take_till(|byte| byte == quote[0]), opt(tag(&quote[..])))
}

/// The characters of a quoted word.
pub(super) fn without_quotes(raw: &[u8]) -> Vec<u8> {
    let append = |mut unquoted: Vec<u8>, part: &[u8]| {
        unquoted.extend_from_slice(part);
        unquoted
    };
    let joined: Lexed<'_, Vec<u8>> = fold_many0(word_part, Vec::new, append).parse(raw);
    joined.map_or_else(|_| raw.to_vec(), |(_, unquoted)| unquoted)
}

/// Offset of the last quote of a word if it is unclosed.
pub(super) fn unclosed_quote(raw: &[u8]) -> Option<usize> {
    let mut open: Option<(u8, usize)> = None;
    for (at, &byte) in raw.iter().enumerate() {
        match open {
            Some((quote, _)) if quote == byte => open = None,
            None if is_quote(byte) => open = Some((byte, at)),
            _ => {}
        }
    }
    open.map(|(_, at)| at)
}

/// From `#` to the end of the line.
pub(super) fn comment(input: &[u8]) -> Lexed<'_, &[u8]> {
    recognize(preceded(tag(&b"#"[..]), take_till(|byte| byte == b'\n'))).parse(input)
}

/// From `!` to a line end without a `\` before it. A carriage return also ends a line.
pub(super) fn command(input: &[u8]) -> Lexed<'_, &[u8]> {
    let plain = take_while1(|byte| !matches!(byte, b'\n' | b'\r' | b'\\'));
    let line_end = alt((tag(&b"\r\n"[..]), tag(&b"\n"[..]), tag(&b"\r"[..])));
    let escape = recognize((tag(&b"\\"[..]), opt(line_end)));
    recognize(preceded(tag(&b"!"[..]), fold_many0(alt((plain, escape)), || (), |(), _| ()))).parse(input)
}

/// All words of a text; `from` is the offset of `text` in the whole text.
pub(crate) fn words(text: &[u8], from: u32) -> impl Iterator<Item = Word> + '_ {
    let mut rest = text;
    std::iter::from_fn(move || {
        let (after, (raw, is_quoted)) = raw_word(rest).ok()?;
        let end = from + (text.len() - after.len()) as u32;
        rest = after;
        Some(Word { start: end - raw.len() as u32, end, is_quoted })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unquoted(text: &str) -> Vec<String> {
        words(text.as_bytes(), 0).map(|word| String::from_utf8_lossy(&word.of(text.as_bytes())).into_owned()).collect()
    }

    #[test]
    fn words_are_those_of_radiance() {
        assert_eq!(unquoted(" a  b\t\r\n\x0b\x0cc&d "), ["a", "b", "c&d"]);
        assert_eq!(unquoted("\"a b\" 'it\"s' x\"y z\"w''"), ["a b", "it\"s", "xy zw"]);
        assert_eq!(unquoted("\"never closed\n it"), ["never closed\n it"]);
        assert_eq!(unquoted("'' x"), ["", "x"]);
        assert_eq!(unquoted(" \n"), [""; 0]);
    }

    #[test]
    fn a_command_runs_over_escaped_line_ends() {
        let text = b"!a \\\nb \\\r\n c\\d\r\nnext";
        let (rest, line) = command(text).unwrap();
        assert_eq!((line, rest), (&b"!a \\\nb \\\r\n c\\d"[..], &b"\r\nnext"[..]));
        assert_eq!(command(b"!").unwrap().1, b"!");
        assert_eq!(command(b"!a\\").unwrap().1, b"!a\\");
    }
}
