//! Text as a pattern, and its fonts.

use super::modifiers::{Raw, RawWord};
use super::reader::Reader;
use crate::Kind;
use glam::DVec3;
use radsight_diag::Diagnostic;
use radsight_formats::{Font as FontFile, library};
use radsight_ir::{Font, Glyph, Handle, Rgb, TextPattern};
use radsight_loader::{FileKind, LoadError, Loader};

/// Positions of the arguments of a text pattern.
struct TextForm {
    /// Index of the font among the strings; the text follows it.
    font: usize,
    /// Index of the spacing among the real arguments.
    spacing: usize,
}

impl Reader<'_> {
    /// Lowers `brighttext`, `colortext` or `mixtext`, whose argument counts were checked.
    pub(super) fn text(&mut self, raw: &Raw) -> Option<TextPattern> {
        let form = match raw.kind {
            Kind::MixText => TextForm { font: 2, spacing: 9 },
            Kind::ColorText => TextForm { font: 0, spacing: 15 },
            _ => TextForm { font: 0, spacing: 11 },
        };
        let reals = &raw.reals;
        let [origin, right, down] = [0, 3, 6].map(|first| DVec3::from_slice(&reals[first..]));
        if down.cross(right).cross(down).length_squared() <= 1e-24 {
            let (kind, name) = (raw.kind, self.scene.names.get(raw.name));
            let message = format!(
                "{kind} \"{name}\" has parallel or zero right and down vectors, expected vectors that span a plane"
            );
            let span = self.real_span(raw, 3);
            self.log.push(Diagnostic::error(message).at(span));
            return None;
        }
        let [foreground, background] = match raw.kind {
            Kind::BrightText => [9, 10].map(|index| Rgb([reals[index]; 3])),
            Kind::ColorText => [9, 12].map(|first| super::materials::rgb(reals, first)),
            _ => [Rgb::WHITE, Rgb::BLACK],
        };
        Some(TextPattern {
            font: self.font(&raw.strings[form.font])?,
            lines: self.lines(raw, form.font + 1)?,
            origin,
            right,
            down,
            spacing: reals.get(form.spacing).copied(),
            foreground,
            background,
            words: raw.strings.iter().map(|word| word.text.clone()).collect(),
        })
    }

    /// The lines of a text: those of a file, or the words after a placeholder as one line.
    fn lines(&mut self, raw: &Raw, first: usize) -> Option<Vec<Vec<u8>>> {
        let [file, words @ ..] = &raw.strings[first..] else { return None };
        if !words.is_empty() {
            let words: Vec<&str> = words.iter().map(|word| &*word.text).collect();
            return Some(vec![words.join(" ").into_bytes()]);
        }
        match self.loader.load(&file.text, FileKind::Text) {
            Ok(loaded) => {
                let mut lines: Vec<Vec<u8>> = loaded.bytes.split(|byte| *byte == b'\n').map(<[u8]>::to_vec).collect();
                lines.pop_if(|last| last.is_empty());
                Some(lines)
            }
            Err(error) => {
                self.log.push(Diagnostic::error(error.to_string()).at(file.span));
                None
            }
        }
    }

    /// A font, loaded at its first use. `None` after a mistake, which was reported.
    fn font(&mut self, file: &RawWord) -> Option<Handle<Font>> {
        if let Some(known) = self.fonts.get(&file.text) {
            return *known;
        }
        let handle = match self.load_font(&file.text) {
            Ok(font) => Some(self.scene.fonts.add(font)),
            Err(message) => {
                self.log.push(Diagnostic::error(message).at(file.span));
                None
            }
        };
        self.fonts.insert(file.text.clone(), handle);
        handle
    }

    fn load_font(&self, file: &str) -> Result<Font, String> {
        let (path, bytes) = match self.loader.load(file, FileKind::Font) {
            Ok(loaded) => (loaded.path, loaded.bytes),
            Err(error @ LoadError::NotFound { .. }) => {
                let text = library::file(file).ok_or_else(|| error.to_string())?;
                (file.to_owned(), text.as_bytes().to_vec())
            }
            Err(error) => return Err(error.to_string()),
        };
        let read = FontFile::read(&bytes).map_err(|error| format!("\"{path}\": {error}"))?;
        let glyphs = read.glyphs.into_iter().map(|glyph| glyph.map(|glyph| Glyph { vertices: glyph.vertices }));
        Ok(Font { file: file.to_owned(), glyphs: glyphs.collect() })
    }
}
