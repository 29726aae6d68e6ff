//! The choice between builders of hierarchies.

/// How a hierarchy is built. It affects the speed of rays but not their hits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Builder {
    /// Top down, by binned splits.
    #[default]
    Quick,
    /// Also bottom up, by clustering and reinsertion; the hierarchy with the lower cost is kept.
    /// Takes about five times as long.
    Thorough,
}
