//! How much care hierarchies are built with.

/// How a hierarchy is built. What rays meet does not depend on it, only how soon.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Builder {
    /// From the top down, by binned cuts.
    #[default]
    Quick,
    /// Also from the bottom up, by clusters whose nodes are then moved to where they cost least; the hierarchy that costs rays less is
    /// kept. It takes about five times as long.
    Thorough,
}
