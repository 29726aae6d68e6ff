//! What one evaluation may take, so that no input hangs a program or eats its memory.

/// The deepest nesting of calls at run time.
pub const DEEPEST_CALL: usize = 100_000;
/// The most steps of one evaluation.
pub const MOST_STEPS: u64 = 50_000_000;
/// The most steps that folding the constants of one file takes.
pub(crate) const MOST_FOLDING_STEPS: u64 = 20_000_000;
/// The most mathematical faults of one evaluation that are kept as warnings.
pub(crate) const MOST_WARNINGS: usize = 100;
