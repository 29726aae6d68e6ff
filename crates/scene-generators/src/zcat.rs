//! `zcat [file …]`: decompresses files of `gzip` and of the older `compress`; `-` or no file means
//! standard input.
//!
//! The suffix `.gz` or `.Z` of a file may be omitted.

use std::borrow::Cow;
use std::io::Read;

use flate2::read::MultiGzDecoder;
use radsight_loader::FileKind;

use crate::cat::file_names;
use crate::text::Text;
use crate::{Error, Invocation, MAX_OUTPUT_BYTES, Output, source_name};

const USAGE: &str = "zcat [file …]";

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut text = Text::default();
    for name in file_names(invocation, USAGE)? {
        let bytes = load(invocation, name)?;
        let room = MAX_OUTPUT_BYTES - text.len();
        let content = decompress(&bytes, room).map_err(|problem| match problem {
            Problem::TooLarge => Error::OutputTooLarge { limit_bytes: MAX_OUTPUT_BYTES },
            Problem::Damaged(mistake) => {
                Error::Input { program: "zcat".to_owned(), source_name: source_name(name).to_owned(), mistake }
            }
        })?;
        text.push_bytes(&content)?;
    }
    Ok(Output { standard_output: text.into_bytes(), ..Output::default() })
}

fn load<'a>(invocation: &Invocation<'a>, name: &str) -> Result<Cow<'a, [u8]>, Error> {
    let attempt = |suffix: &str| invocation.input(&format!("{name}{suffix}"), FileKind::Input);
    attempt("").or_else(|error| attempt(".gz").or_else(|_| attempt(".Z")).map_err(|_| error))
}

enum Problem {
    TooLarge,
    Damaged(String),
}

fn decompress(bytes: &[u8], room: usize) -> Result<Vec<u8>, Problem> {
    match bytes {
        [0x1f, 0x8b, ..] => {
            let mut content = Vec::new();
            let mut decoder = MultiGzDecoder::new(bytes).take(room as u64 + 1);
            decoder.read_to_end(&mut content).map_err(|error| Problem::Damaged(error.to_string()))?;
            if content.len() > room { Err(Problem::TooLarge) } else { Ok(content) }
        }
        [0x1f, 0x9d, flags, codes @ ..] => expand(*flags, codes, room),
        _ => Err(Problem::Damaged("the format is neither that of gzip nor that of compress".to_owned())),
    }
}

/// Decompresses `compress` data: adaptive Lempel-Ziv-Welch codes of 9 to 16 bits, lowest bit first.
/// Codes of one width come in groups of eight; the rest of a group is omitted when the width
/// changes.
fn expand(flags: u8, codes: &[u8], room: usize) -> Result<Vec<u8>, Problem> {
    const CLEAR: usize = 256;
    let (widest, can_clear) = (u32::from(flags & 31), flags & 128 != 0);
    if !(9..=16).contains(&widest) {
        return Err(Problem::Damaged(format!("codes of {widest} bits, expected 9 to 16")));
    }
    let first_free = if can_clear { 257 } else { 256 };
    // Each string is a shorter one and a last byte.
    let mut strings: Vec<(usize, u8)> = (0..first_free).map(|byte| (usize::MAX, byte as u8)).collect();
    let mut content: Vec<u8> = Vec::new();
    let (mut width, mut bit, mut group) = (9u32, 0usize, 0usize);
    // The previous code and the first byte of its string.
    let mut previous: Option<(usize, u8)> = None;
    let mut reversed = Vec::new();
    while bit + width as usize <= codes.len() * 8 {
        let window: usize = (0..3).map(|i| usize::from(*codes.get(bit / 8 + i).unwrap_or(&0)) << (8 * i)).sum();
        let code = (window >> (bit % 8)) & ((1 << width) - 1);
        bit += width as usize;
        let end_of_group = |bit: usize, width: u32| group + (bit - group).next_multiple_of(8 * width as usize);
        if can_clear && code == CLEAR {
            (bit, strings, previous) = (end_of_group(bit, width), strings[..first_free].to_vec(), None);
            (width, group) = (9, bit);
            continue;
        }
        let known = code < strings.len();
        if !known && (previous.is_none() || code > strings.len()) {
            return Err(Problem::Damaged(format!("code {code} at bit {bit} is undefined")));
        }
        // A code being defined is the previous string followed by its own first byte.
        let mut at = match previous {
            Some((last, first)) if !known => {
                reversed.push(first);
                last
            }
            _ => code,
        };
        while at >= first_free {
            reversed.push(strings[at].1);
            at = strings[at].0;
        }
        let first = strings[at].1;
        reversed.push(first);
        if content.len() + reversed.len() > room {
            return Err(Problem::TooLarge);
        }
        content.extend(reversed.drain(..).rev());
        if let Some((last, _)) = previous
            && strings.len() < 1 << widest
        {
            strings.push((last, first));
        }
        previous = Some((code, first));
        if strings.len() >= 1 << width && width < widest {
            bit = end_of_group(bit, width);
            (width, group) = (width + 1, bit);
        }
    }
    Ok(content)
}
