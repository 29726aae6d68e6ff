//! XML of BSDF files: elements by name, in any name space, with their positions.

use crate::mistake::{Mistake, Place};
use roxmltree::{Document, Node, ParsingOptions};
use std::borrow::Cow;

/// Maximum number of elements of a BSDF file.
const MOST_NODES: u32 = 1 << 20;

/// The XML of a BSDF file as text, decoded as for [`crate::MeasuredBsdf::read`], without text around it.
///
/// # Errors
/// If there is no XML in it.
pub fn xml_text(bytes: &[u8]) -> Result<Cow<'_, str>, Mistake> {
    let Text { text, xml, .. } = Text::decode(bytes)?;
    Ok(match text {
        Cow::Borrowed(text) => Cow::Borrowed(&text[xml]),
        Cow::Owned(text) => Cow::Owned(text[xml].to_owned()),
    })
}

/// How the bytes of a file stand for characters.
#[derive(Clone, Copy, PartialEq)]
enum Encoding {
    Utf8,
    /// Of bytes that are not UTF-8, which is common in makers' names.
    Latin1,
    /// After a byte order mark.
    Utf16,
}

impl Encoding {
    /// Number of bytes of a text before an index.
    fn bytes_before(self, text: &str, index: usize) -> usize {
        let Some(before) = text.get(..index) else { return index };
        match self {
            Encoding::Utf8 => index,
            Encoding::Latin1 => before.chars().count(),
            Encoding::Utf16 => BYTE_ORDER_MARK + 2 * before.encode_utf16().count(),
        }
    }
}

/// Length of the byte order mark of UTF-16.
const BYTE_ORDER_MARK: usize = 2;

/// A file as text.
pub(crate) struct Text<'b> {
    text: Cow<'b, str>,
    encoding: Encoding,
    /// Range of the XML: the pipeline that made the file may have added text around it, as
    /// `genBSDF` does with its command line. Radiance ignores such text.
    xml: Place,
}

impl<'b> Text<'b> {
    pub(crate) fn decode(bytes: &'b [u8]) -> Result<Self, Mistake> {
        let (text, encoding) = decoded(bytes);
        let Some(start) = first_tag(&text) else {
            let first_line = text.lines().next().unwrap_or("").len();
            return Err(Mistake::NoXml { place: 0..encoding.bytes_before(&text, first_line) });
        };
        let end = text.rfind('>').map_or(text.len(), |last| last + 1);
        Ok(Text { text, encoding, xml: start..end.max(start) })
    }

    fn xml(&self) -> &str {
        &self.text[self.xml.clone()]
    }

    /// Converts the position of an error from the XML to the file's bytes.
    pub(crate) fn in_bytes(&self, mistake: &mut Mistake) {
        let place = mistake.place_mut();
        *place = self.xml.start + place.start..self.xml.start + place.end;
        let bytes = |index: usize| self.encoding.bytes_before(&self.text, index);
        *place = bytes(place.start)..bytes(place.end);
    }
}

/// The characters of a file. Wrong UTF-16 becomes the replacement character, which no number contains.
fn decoded(bytes: &[u8]) -> (Cow<'_, str>, Encoding) {
    let utf16 = |from_bytes: fn([u8; 2]) -> u16| {
        let (units, _) = bytes[BYTE_ORDER_MARK..].as_chunks::<2>();
        let units = units.iter().map(|unit| from_bytes(*unit));
        char::decode_utf16(units).map(|found| found.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
    };
    match bytes {
        [0xff, 0xfe, ..] => (Cow::Owned(utf16(u16::from_le_bytes)), Encoding::Utf16),
        [0xfe, 0xff, ..] => (Cow::Owned(utf16(u16::from_be_bytes)), Encoding::Utf16),
        _ => match std::str::from_utf8(bytes) {
            Ok(text) => (Cow::Borrowed(text), Encoding::Utf8),
            Err(_) => (Cow::Owned(bytes.iter().map(|byte| char::from(*byte)).collect()), Encoding::Latin1),
        },
    }
}

/// Position of the first tag; the `<` of a command line is followed by a blank or a file name.
fn first_tag(text: &str) -> Option<usize> {
    let begins_tag = |rest: &str| rest.starts_with(|c: char| c.is_alphabetic() || matches!(c, '?' | '!' | '_'));
    text.find("<?xml").or_else(|| text.match_indices('<').map(|(at, _)| at).find(|at| begins_tag(&text[at + 1..])))
}

/// A document.
pub(crate) struct Xml<'t> {
    document: Document<'t>,
}

impl<'t> Xml<'t> {
    pub(crate) fn parse(text: &'t Text<'_>) -> Result<Xml<'t>, Mistake> {
        // A document type would permit expanding entities without bound; BSDF files have none.
        let options = ParsingOptions { allow_dtd: false, nodes_limit: MOST_NODES, ..ParsingOptions::default() };
        let document = Document::parse_with_options(text.xml(), options).map_err(|error| {
            let at = offset(text.xml(), error.pos());
            let line = text.xml()[at..].lines().next().unwrap_or("").len();
            Mistake::Xml { what: error.to_string(), place: at..at + line.clamp(1, 20) }
        })?;
        Ok(Xml { document })
    }

    pub(crate) fn root(&self) -> Element<'_, 't> {
        Element(self.document.root_element())
    }
}

/// Byte offset of a row and column, both from 1.
fn offset(text: &str, position: roxmltree::TextPos) -> usize {
    let row = text.split_inclusive('\n').take(position.row.saturating_sub(1) as usize).map(str::len).sum::<usize>();
    let line = &text[row..];
    line.char_indices().nth(position.col.saturating_sub(1) as usize).map_or(text.len(), |(at, _)| row + at)
}

/// An element.
#[derive(Clone, Copy)]
pub(crate) struct Element<'a, 't>(Node<'a, 't>);

impl<'a, 't: 'a> Element<'a, 't> {
    pub(crate) fn name(&self) -> &'a str {
        self.0.tag_name().name()
    }

    pub(crate) fn attribute(&self, name: &str) -> Option<&'a str> {
        self.0.attribute(name)
    }

    pub(crate) fn children(self, name: &'static str) -> impl Iterator<Item = Element<'a, 't>> {
        self.0.children().filter(move |child| child.is_element() && child.tag_name().name() == name).map(Element)
    }

    pub(crate) fn child(self, name: &str) -> Option<Element<'a, 't>> {
        self.0.children().find(|child| child.is_element() && child.tag_name().name() == name).map(Element)
    }

    pub(crate) fn need(self, element: &'static str) -> Result<Element<'a, 't>, Mistake> {
        self.child(element).ok_or_else(|| Mistake::Missing {
            element,
            inside: self.name().chars().take(40).collect(),
            place: self.tag_place(),
        })
    }

    /// Text of the element, without that of its children.
    pub(crate) fn text(&self) -> Cow<'a, str> {
        let mut texts = self.0.children().filter(Node::is_text).filter_map(|child| child.text());
        let first = texts.next().unwrap_or("");
        match texts.next() {
            None => Cow::Borrowed(first),
            Some(second) => Cow::Owned([first, second].into_iter().chain(texts).collect()),
        }
    }

    /// Range of the opening tag up to the end of its name.
    pub(crate) fn tag_place(&self) -> Place {
        let start = self.0.range().start;
        start..start + 1 + self.name().len()
    }

    /// Range of the text without surrounding white space.
    pub(crate) fn text_place(&self) -> Place {
        let Some(child) = self.0.children().find(Node::is_text) else { return self.tag_place() };
        let (range, text) = (child.range(), child.text().unwrap_or(""));
        let inner = text.trim();
        if range.len() != text.len() || inner.is_empty() {
            return range;
        }
        let start = range.start + (text.len() - text.trim_start().len());
        start..start + inner.len()
    }

    /// Converts the position of an error from this element's text to the file; if the two differ,
    /// the position is that of the whole text.
    pub(crate) fn within(&self, mut mistake: Mistake) -> Mistake {
        let place = mistake.place_mut();
        let mut texts = self.0.children().filter(Node::is_text);
        *place = match (texts.next(), texts.next()) {
            (Some(only), None) if only.range().len() == only.text().unwrap_or("").len() => {
                only.range().start + place.start..only.range().start + place.end
            }
            _ => self.tag_place(),
        };
        mistake
    }
}
