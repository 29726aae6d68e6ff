//! Limits of one evaluation, so that no input hangs a program or exhausts its memory.

/// Maximum depth of nested calls at run time.
pub const DEEPEST_CALL: usize = 100_000;
/// Maximum number of steps of one evaluation.
pub const MOST_STEPS: u64 = 50_000_000;
/// Number of evaluations of a file's functions that may exceed [`MOST_STEPS`]; then none is tried.
pub const MOST_LONG_EVALUATIONS: u64 = 8;
/// Maximum number of steps for folding the constants of one file.
pub(crate) const MOST_FOLDING_STEPS: u64 = 20_000_000;
/// Maximum number of mathematical faults of one evaluation that are kept as warnings.
pub(crate) const MOST_WARNINGS: usize = 100;
/// Number of distinct messages about mathematical faults after which a program's list of them ends.
pub(crate) const LISTED_WARNINGS: usize = 10;
