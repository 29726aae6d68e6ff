//! The fonts that are built into radsight, for machines without Radiance.

/// The built-in files, by the name that scenes use.
const FILES: &[(&str, &str)] = &[("helvet.fnt", include_str!("../library/helvet.fnt"))];

/// The text of a built-in font.
#[must_use]
pub fn file(name: &str) -> Option<&'static str> {
    FILES.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}
