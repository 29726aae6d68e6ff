//! The fonts that come with radsight, for machines without Radiance.

/// Every file, by the name under which scenes ask for it.
const FILES: &[(&str, &str)] = &[("helvet.fnt", include_str!("../library/helvet.fnt"))];

/// The text of a font that comes with radsight.
#[must_use]
pub fn file(name: &str) -> Option<&'static str> {
    FILES.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}
