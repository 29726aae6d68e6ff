//! Rows of the table, and their checks.

/// Prints a row and checks that the worst case is within the tolerance.
#[track_caller]
pub(crate) fn row(case: &str, checked: &str, tolerance: f64, worst: f64) {
    println!("| {case} | {checked} | {tolerance:.0e} | {worst:.1e} |");
    assert!(worst <= tolerance, "{case}: {checked}: {worst} is more than {tolerance}");
}

/// The same for counted faults, of which there may be none.
#[track_caller]
pub(crate) fn count(case: &str, checked: &str, tried: usize, wrong: usize) {
    println!("| {case} | {checked} | 0 of {tried} | {wrong} |");
    assert_eq!(wrong, 0, "{case}: {checked}: {wrong} of {tried}");
}
