//! Where a key of a camera file stands, for mistakes that only show beside a scene.

use radsight_diag::{SourceMap, Span};
use toml::de::{DeTable, DeValue};

/// The place of a table or key in the camera file that was read into `sources`, by its path.
///
/// ```
/// use radsight_camera::place_of;
/// use radsight_diag::SourceMap;
/// let mut sources = SourceMap::default();
/// let file = sources.add("camera.toml", &b"[sensor]\nband_weights = [1, 2]\n"[..], None);
/// let place = place_of(file, &["sensor", "band_weights"], &sources).unwrap();
/// assert_eq!(sources.position(place).line, 2);
/// assert!(place_of(file, &["sensor", "k"], &sources).is_none());
/// ```
#[must_use]
pub fn place_of(file: radsight_diag::SourceId, path: &[&str], sources: &SourceMap) -> Option<Span> {
    let text = std::str::from_utf8(sources.text(file)).ok()?;
    let document = DeTable::parse(text).ok()?;
    let mut table = document.get_ref();
    let (last, tables) = path.split_last()?;
    for name in tables {
        let DeValue::Table(inner) = table.get(*name)?.get_ref() else { return None };
        table = inner;
    }
    let (key, value) = table.get_key_value(*last)?;
    // A table is shown at its name.
    let place = if matches!(value.get_ref(), DeValue::Table(_)) { key.span() } else { value.span() };
    Some(sources.span(file, place.start, place.end))
}
