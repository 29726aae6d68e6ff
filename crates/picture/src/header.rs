//! The information header: the format of a file and its history.

use crate::error::shown;
use crate::{PictureError, RgbPrimaries};
use radsight_units::number::{self, trimmed};
use std::borrow::Cow;

/// The lines of a Radiance header, in order, unchanged, without line ends.
///
/// The first line is usually `#?RADIANCE`; old files lack it. Command lines (each program appends
/// its own), variables (`EXPOSURE=2.5`) and, indented by tabs, the headers of combined files follow
/// in any order. Indented lines do not describe this file. An empty line ends the header and is not
/// part of the lines.
///
/// ```
/// use radsight_picture::Header;
/// let bytes = b"#?RADIANCE\nrpict -vf \"a b.vf\"\nEXPOSURE=2\nEXPOSURE=.5\nFORMAT=32-bit_rle_rgbe\n\n...";
/// let (header, used) = Header::read(bytes).unwrap();
/// assert_eq!(&bytes[used..], b"...");
/// assert_eq!(header.exposure().unwrap(), 1.0);
/// let mut derived = header.history();
/// derived.push_command(["pfilt", "-x", "/2"]);
/// assert!(derived.to_bytes().ends_with(b"EXPOSURE=.5\npfilt -x /2\n\n"));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Header {
    lines: Vec<Vec<u8>>,
}

/// A `NAME=value` line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Assignment<'a> {
    /// The line in the header, from 1.
    pub line: usize,
    /// The text after the `=`, trimmed.
    pub value: Cow<'a, str>,
}

/// The variables that describe the storage of the values.
const STORAGE: [&str; 6] = ["FORMAT", "NROWS", "NCOLS", "NCOMP", "BigEndian", "WAVELENGTH_SPLITS"];

impl Header {
    /// A header that begins with `#?` and an identifier; Radiance writes `RADIANCE`.
    #[must_use]
    pub fn new(identifier: &str) -> Self {
        let mut header = Header::default();
        header.push_line(&format!("#?{identifier}"));
        header
    }

    /// Reads the lines up to the empty line. Also returns the number of bytes, including the empty
    /// line.
    ///
    /// # Errors
    /// [`PictureError::Unexpected`] if the first byte is not printable, [`PictureError::Truncated`]
    /// if no empty line follows.
    pub fn read(bytes: &[u8]) -> Result<(Header, usize), PictureError> {
        if !starts_header(bytes) {
            let found = shown(bytes);
            return Err(PictureError::Unexpected { offset: 0, expected: "a header such as #?RADIANCE".into(), found });
        }
        let (header, used, ended) = Header::scan(bytes);
        if !ended {
            let expected = "the empty line that ends the header".into();
            return Err(PictureError::Truncated { offset: bytes.len(), expected });
        }
        Ok((header, used))
    }

    /// Reads the lines of a text that may end without an empty line, such as a view file.
    #[must_use]
    pub fn read_text(bytes: &[u8]) -> Header {
        Header::scan(bytes).0
    }

    fn scan(bytes: &[u8]) -> (Header, usize, bool) {
        let mut header = Header::default();
        let mut used = 0;
        while used < bytes.len() {
            let rest = &bytes[used..];
            let length = rest.iter().position(|byte| *byte == b'\n');
            used += length.map_or(rest.len(), |length| length + 1);
            let line = &rest[..length.unwrap_or(rest.len())];
            if length.is_some() && (line.is_empty() || line == b"\r") {
                return (header, used, true);
            }
            header.lines.push(line.to_vec());
        }
        (header, used, false)
    }

    /// The lines without line ends.
    pub fn lines(&self) -> impl Iterator<Item = &[u8]> {
        self.lines.iter().map(Vec::as_slice)
    }

    /// The lines after the identifier (`#?RADIANCE`).
    pub fn body(&self) -> impl Iterator<Item = &[u8]> {
        self.lines().filter(|line| !line.starts_with(b"#?"))
    }

    /// Whether there are no lines.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty()
    }

    /// The text after `#?` in the first such line.
    #[must_use]
    pub fn identifier(&self) -> Option<Cow<'_, str>> {
        let line = self.lines().find_map(|line| line.strip_prefix(b"#?"))?;
        let end = line.iter().position(|byte| number::is_space(*byte)).unwrap_or(line.len());
        Some(String::from_utf8_lossy(&line[..end]))
    }

    /// All lines `NAME=value` with this name, in order. Indented lines belong to other files and
    /// are skipped.
    pub fn assignments(&self, name: &str) -> impl Iterator<Item = Assignment<'_>> {
        self.lines.iter().enumerate().filter_map(move |(index, line)| {
            let value = line.strip_prefix(name.as_bytes())?.strip_prefix(b"=")?;
            Some(Assignment { line: index + 1, value: String::from_utf8_lossy(trimmed(value)) })
        })
    }

    /// The value of the last line `NAME=value`.
    #[must_use]
    pub fn variable(&self, name: &str) -> Option<Cow<'_, str>> {
        self.assignments(name).last().map(|assignment| assignment.value)
    }

    /// The last `FORMAT=`.
    #[must_use]
    pub fn format(&self) -> Option<Cow<'_, str>> {
        self.variable("FORMAT")
    }

    /// The product of all `EXPOSURE=`: the factor from radiance to stored values. 1 without any.
    ///
    /// # Errors
    /// [`PictureError::HeaderValue`] for a value that is not positive and finite.
    pub fn exposure(&self) -> Result<f64, PictureError> {
        self.exposures().try_fold(1.0, |product, exposure| Ok(product * exposure?))
    }

    /// The product of all `COLORCORR=`, by component. It multiplies the stored values as the
    /// exposure does. 1 without any.
    ///
    /// # Errors
    /// [`PictureError::HeaderValue`] for a value that is not three positive, finite numbers.
    pub fn color_correction(&self) -> Result<[f64; 3], PictureError> {
        self.corrections().try_fold([1.0; 3], |product, correction| {
            let correction = correction?;
            Ok(std::array::from_fn(|i| product[i] * f64::from(correction[i])))
        })
    }

    /// The factors from stored values to radiance: the reciprocal of all EXPOSURE and COLORCORR,
    /// rounded to single precision at each line, as in Radiance's `pvalue -o`.
    ///
    /// # Errors
    /// [`PictureError::HeaderValue`] for a value that is not positive and finite, or that makes a
    /// factor so.
    pub fn radiance_scale(&self) -> Result<[f32; 3], PictureError> {
        let mut scale = [1.0f32; 3];
        for (index, line) in self.lines.iter().enumerate() {
            let (name, stored);
            if let Some(value) = line.strip_prefix(b"EXPOSURE=") {
                (name, stored) = ("EXPOSURE", value);
                let exposure = parse_exposure(index + 1, value)?;
                scale = scale.map(|value| (f64::from(value) * (1.0 / exposure)) as f32);
            } else if let Some(value) = line.strip_prefix(b"COLORCORR=") {
                (name, stored) = ("COLORCORR", value);
                let correction = parse_correction(index + 1, value)?;
                scale = std::array::from_fn(|i| scale[i] / correction[i]);
            } else {
                continue;
            }
            if !scale.iter().all(|factor| factor.is_finite() && *factor > 0.0) {
                return Err(bad_value(index + 1, name, stored, "all such values together within 1e-38 to 1e38"));
            }
        }
        Ok(scale)
    }

    fn exposures(&self) -> impl Iterator<Item = Result<f64, PictureError>> {
        let lines = self.lines.iter().enumerate();
        lines.filter_map(|(index, line)| Some(parse_exposure(index + 1, line.strip_prefix(b"EXPOSURE=")?)))
    }

    fn corrections(&self) -> impl Iterator<Item = Result<[f32; 3], PictureError>> {
        let lines = self.lines.iter().enumerate();
        lines.filter_map(|(index, line)| Some(parse_correction(index + 1, line.strip_prefix(b"COLORCORR=")?)))
    }

    /// The product of all `PIXASPECT=`: the height of a pixel divided by its width. 1 without any.
    ///
    /// # Errors
    /// [`PictureError::HeaderValue`] for a value that is not positive and finite.
    pub fn pixel_aspect(&self) -> Result<f64, PictureError> {
        self.assignments("PIXASPECT").try_fold(1.0, |product, Assignment { line, value }| {
            Ok(product * positive(line, "PIXASPECT", value.as_bytes())?)
        })
    }

    /// The last `PRIMARIES=`, the chromaticities of red, green, blue and white.
    ///
    /// # Errors
    /// [`PictureError::HeaderValue`] if it is not eight numbers.
    pub fn primaries(&self) -> Result<Option<RgbPrimaries>, PictureError> {
        let Some(Assignment { line, value }) = self.assignments("PRIMARIES").last() else { return Ok(None) };
        match number::leading_numbers::<8>(value.as_bytes()) {
            Some(numbers) => Ok(Some(RgbPrimaries::from_array(numbers))),
            None => Err(bad_value(line, "PRIMARIES", value.as_bytes(), "eight chromaticities")),
        }
    }

    /// The last `NCOMP=`: values per pixel.
    ///
    /// # Errors
    /// [`PictureError::HeaderValue`] if it is not a positive integer.
    pub fn components(&self) -> Result<Option<usize>, PictureError> {
        self.count("NCOMP")
    }

    /// The last value of a variable that is a count.
    ///
    /// # Errors
    /// [`PictureError::HeaderValue`] if it is not an integer from 1 to 2^31 - 1.
    pub fn count(&self, name: &'static str) -> Result<Option<usize>, PictureError> {
        let Some(Assignment { line, value }) = self.assignments(name).last() else { return Ok(None) };
        let count = number::integer_or_zero(value.as_bytes());
        match i32::try_from(count).ok().and_then(|count| usize::try_from(count).ok()).filter(|count| *count > 0) {
            Some(count) => Ok(Some(count)),
            None => Err(bad_value(line, name, value.as_bytes(), "an integer from 1 to 2147483647")),
        }
    }

    /// The last `WAVELENGTH_SPLITS=`: the longest wavelength, the limits between red and green and
    /// between green and blue, and the shortest wavelength, all in nm.
    ///
    /// # Errors
    /// [`PictureError::HeaderValue`] if it is not four decreasing, positive numbers.
    pub fn wavelength_splits(&self) -> Result<Option<[f32; 4]>, PictureError> {
        let Some(Assignment { line, value }) = self.assignments("WAVELENGTH_SPLITS").last() else { return Ok(None) };
        let splits = number::leading_numbers::<4>(value.as_bytes()).map(|numbers| numbers.map(|number| number as f32));
        match splits.filter(|splits| splits[3] > 0.0 && splits[0].is_finite() && splits.windows(2).all(|w| w[0] > w[1]))
        {
            Some(splits) => Ok(Some(splits)),
            None => Err(bad_value(line, "WAVELENGTH_SPLITS", value.as_bytes(), "four decreasing wavelengths in nm")),
        }
    }

    /// Whether binary values are big-endian, by the last `BigEndian` line.
    #[must_use]
    pub fn is_big_endian(&self) -> Option<bool> {
        let values = self.lines().filter_map(|line| trimmed(line.strip_prefix(b"BigEndian")?).strip_prefix(b"="));
        values.last().map(|value| trimmed(value).first() == Some(&b'1'))
    }

    /// Adds a line. Line ends in it become spaces, and an empty line is not added, since either
    /// would end the header.
    pub fn push_line(&mut self, line: &str) {
        let line: Vec<u8> = line.bytes().map(|byte| if matches!(byte, b'\n' | b'\r') { b' ' } else { byte }).collect();
        if !line.is_empty() {
            self.lines.push(line);
        }
    }

    /// Adds `NAME=value`.
    pub fn push_variable(&mut self, name: &str, value: &str) {
        self.push_line(&format!("{name}={value}"));
    }

    /// Adds `EXPOSURE=` with five digits, as Radiance prints it.
    pub fn push_exposure(&mut self, exposure: f64) {
        self.push_variable("EXPOSURE", &number::scientific(exposure, 4));
    }

    /// Adds a command line; words are quoted as in Radiance.
    pub fn push_command<'a>(&mut self, words: impl IntoIterator<Item = &'a str>) {
        let quoted: Vec<Cow<'a, str>> = words.into_iter().map(quoted_word).collect();
        self.push_line(&quoted.join(" "));
    }

    /// Adds the lines of another header after its identifier.
    pub fn push_body(&mut self, other: &Header) {
        other.body().for_each(|line| self.push_line(&String::from_utf8_lossy(line)));
    }

    /// Adds all lines of another header, indented by a tab, below the name of its file. Programs
    /// that combine files record their inputs this way.
    pub fn push_nested(&mut self, name: &str, nested: &Header) {
        self.push_line(&format!("{name}:"));
        for line in nested.body() {
            self.lines.push([b"\t", line].concat());
        }
    }

    /// Removes every line `NAME=…`.
    pub fn remove(&mut self, name: &str) {
        self.lines.retain(|line| line.strip_prefix(name.as_bytes()).is_none_or(|rest| !rest.starts_with(b"=")));
    }

    /// A copy without the lines that describe the storage (FORMAT, NROWS, NCOLS, NCOMP, BigEndian,
    /// WAVELENGTH_SPLITS). A program copies this before it adds its own command line and format.
    #[must_use]
    pub fn history(&self) -> Header {
        let mut copy = self.clone();
        for name in STORAGE {
            copy.remove(name);
        }
        copy
    }

    /// The header as bytes, including the empty line. Prepends `#?RADIANCE` if the first line does
    /// not begin with a printable character, as a header must.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::with_capacity(self.lines.iter().map(|line| line.len() + 1).sum::<usize>() + 16);
        if !self.lines.first().is_some_and(|line| starts_header(line)) {
            out.extend_from_slice(b"#?RADIANCE\n");
        }
        for line in &self.lines {
            out.extend_from_slice(line);
            out.push(b'\n');
        }
        out.push(b'\n');
        out
    }

    /// The lines as text, for formats that keep the history in one string. Invalid UTF-8 is
    /// replaced.
    #[must_use]
    pub fn to_text(&self) -> String {
        let lines: Vec<Cow<'_, str>> = self.lines().map(String::from_utf8_lossy).collect();
        lines.join("\n")
    }
}

fn starts_header(bytes: &[u8]) -> bool {
    bytes.first().is_some_and(|byte| (0x20..0x7f).contains(byte))
}

fn parse_exposure(line: usize, value: &[u8]) -> Result<f64, PictureError> {
    positive(line, "EXPOSURE", value)
}

fn positive(line: usize, name: &'static str, value: &[u8]) -> Result<f64, PictureError> {
    let number = number::number_or_zero(value);
    if number > 0.0 && number.is_finite() { Ok(number) } else { Err(bad_value(line, name, value, "a positive number")) }
}

fn parse_correction(line: usize, value: &[u8]) -> Result<[f32; 3], PictureError> {
    let numbers = number::leading_numbers::<3>(value).map(|numbers| numbers.map(|number| number as f32));
    match numbers.filter(|numbers| numbers.iter().all(|number| *number > 0.0 && number.is_finite())) {
        Some(numbers) => Ok(numbers),
        None => Err(bad_value(line, "COLORCORR", value, "three positive numbers")),
    }
}

fn bad_value(line: usize, name: &'static str, value: &[u8], expected: &'static str) -> PictureError {
    const LONGEST: usize = 60;
    let value: String = String::from_utf8_lossy(trimmed(value)).chars().take(LONGEST).collect();
    PictureError::HeaderValue { line, name, value, expected }
}

/// Quotes a word as Radiance does: if it is empty or contains white space or a quote.
fn quoted_word(word: &str) -> Cow<'_, str> {
    let inner = &word.as_bytes()[usize::from(!word.is_empty())..];
    let last_quote = inner.split_last().and_then(|(_, body)| body.iter().rfind(|byte| matches!(**byte, b'"' | b'\'')));
    let quote = match last_quote {
        Some(b'"') => '\'',
        Some(_) => '"',
        None if word.is_empty() || word.bytes().any(number::is_space) => '"',
        None => return Cow::Borrowed(word),
    };
    Cow::Owned(format!("{quote}{word}{quote}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indented_lines_belong_to_other_files() {
        let (header, _) = Header::read(b"a.hdr:\n\tEXPOSURE=7\nEXPOSURE=2\n\n").unwrap();
        assert_eq!(header.exposure().unwrap(), 2.0);
        assert_eq!(header.identifier(), None);
    }

    #[test]
    fn unknown_lines_keep_their_order_and_bytes() {
        let bytes = b"#?RADIANCE\nrpict -x 3\n\xff\xfe odd\nVIEW= -vtv\n\n";
        let (header, used) = Header::read(bytes).unwrap();
        assert_eq!(used, bytes.len());
        assert_eq!(header.to_bytes(), bytes);
    }

    #[test]
    fn words_are_quoted_as_radiance_quotes_them() {
        let mut header = Header::default();
        header.push_command(["pcomb", "-e", "ro=ri(1) + 1", "", "a\"b", "it's", "\"x"]);
        assert_eq!(header.lines().next().unwrap(), b"pcomb -e \"ro=ri(1) + 1\" \"\" 'a\"b' \"it's\" \"x");
    }

    #[test]
    fn a_pushed_line_cannot_end_the_header() {
        let mut header = Header::new("RADIANCE");
        header.push_line("a\n\nEXPOSURE=3");
        header.push_line("");
        assert_eq!(header.to_bytes(), b"#?RADIANCE\na  EXPOSURE=3\n\n");
    }

    #[test]
    fn a_header_that_would_begin_with_a_tab_gets_a_first_line() {
        let (header, _) = Header::read(b"FORMAT=ascii\n\trpict\n\n").unwrap();
        assert_eq!(header.history().to_bytes(), b"#?RADIANCE\n\trpict\n\n");
    }

    #[test]
    fn a_bad_exposure_names_its_line() {
        let (header, _) = Header::read(b"#?RADIANCE\nEXPOSURE=-2\n\n").unwrap();
        let message = header.exposure().unwrap_err().to_string();
        assert_eq!(message, "header line 2: EXPOSURE is \"-2\", expected a positive number");
    }

    #[test]
    fn a_header_without_an_end_is_an_error() {
        assert!(matches!(Header::read(b"#?RADIANCE\n"), Err(PictureError::Truncated { offset: 11, .. })));
        assert!(matches!(Header::read(b"\x89PNG"), Err(PictureError::Unexpected { offset: 0, .. })));
        assert!(Header::read(b"").is_err());
        assert_eq!(Header::read(b"x\r\n\r\nz").unwrap().1, 5);
    }
}
