//! `echo [-n] word …`: prints its arguments.
//!
//! As in Linux's `sh`: words are joined by blanks, escapes such as `\n` and `\t` are replaced, and
//! a line end follows unless `-n` or `\c` is given.

use crate::text::Text;
use crate::{Error, Invocation, Output};

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let (words, line_end) = match invocation.argv.get(1).map(String::as_str) {
        Some("-n") => (&invocation.argv[2..], false),
        _ => (&invocation.argv[1..], true),
    };
    let (mut bytes, stopped) = unescape(&words.join(" "));
    if line_end && !stopped {
        bytes.push(b'\n');
    }
    let mut text = Text::default();
    text.push_bytes(&bytes)?;
    Ok(Output { standard_output: text.into_bytes(), ..Output::default() })
}

/// Replaces the escapes of `echo`; the flag reports that `\c` ended the output.
fn unescape(words: &str) -> (Vec<u8>, bool) {
    let mut bytes = Vec::with_capacity(words.len());
    let mut rest = words.bytes().peekable();
    while let Some(byte) = rest.next() {
        if byte != b'\\' {
            bytes.push(byte);
            continue;
        }
        let replaced = match rest.peek() {
            Some(b'c') => return (bytes, true),
            Some(b'0') => {
                rest.next();
                let mut value = 0u32;
                for _ in 0..3 {
                    match rest.next_if(|digit| (b'0'..=b'7').contains(digit)) {
                        Some(digit) => value = value * 8 + u32::from(digit - b'0'),
                        None => break,
                    }
                }
                bytes.push((value & 255) as u8);
                continue;
            }
            Some(b'a') => 7,
            Some(b'b') => 8,
            Some(b'f') => 12,
            Some(b'n') => b'\n',
            Some(b'r') => b'\r',
            Some(b't') => b'\t',
            Some(b'v') => 11,
            Some(b'\\') => b'\\',
            _ => {
                bytes.push(b'\\');
                continue;
            }
        };
        rest.next();
        bytes.push(replaced);
    }
    (bytes, false)
}
