//! The function files that come with radsight, for machines without Radiance.

/// The variables of a ray, on their channels.
pub(crate) const RAY_VARIABLES: &str = include_str!("../library/ray_variables.cal");

/// The curves that Radiance's generators offer.
pub(crate) const CURVES: &str = include_str!("../library/curves.cal");

/// Our equivalent of Radiance's `rayinit.cal`.
pub(crate) const RAYINIT: &str = include_str!("../library/rayinit.cal");

/// Every file, by the name under which scenes ask for it.
const FILES: &[(&str, &str)] = &[("ray_variables.cal", RAY_VARIABLES), ("rayinit.cal", RAYINIT)];

/// The text of a function file, by its name.
#[must_use]
pub fn file(name: &str) -> Option<&'static str> {
    FILES.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

/// The names of all the files.
pub fn names() -> impl Iterator<Item = &'static str> {
    FILES.iter().map(|(name, _)| *name)
}
