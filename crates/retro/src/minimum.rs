//! Minimum coefficients of retroreflection of common types of sheeting.
//!
//! Source: ASTM D4956-01, "Standard Specification for Retroreflective Sheeting for Traffic Control", tables of types I to III, as
//! reprinted at angelfire.com/trek/cityton/american.htm. The reprint that was at hand ends within type III, of which the rows
//! of 0.5° and of darker colours are therefore missing. Types IV, VIII, IX and XI are left out: no source was at hand.

/// A row: cd/(lx m²) of white, yellow, orange, green, red, blue, brown; none where the source has no number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MinimumRow {
    /// Degrees.
    pub observation_deg: f64,
    /// Degrees.
    pub entrance_deg: f64,
    /// In the order of [`MinimumTable::COLOURS`].
    pub coefficients: [Option<f64>; 7],
}

/// The minimum coefficients of a type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MinimumTable {
    /// "I", "II"…
    pub name: &'static str,
    /// What it usually is.
    pub construction: &'static str,
    /// Where the numbers are from.
    pub source: &'static str,
    /// By observation angle, then entrance angle.
    pub rows: &'static [MinimumRow],
}

const SOURCE: &str = "ASTM D4956-01, as reprinted at angelfire.com/trek/cityton/american.htm";

const fn row(observation_deg: f64, entrance_deg: f64, numbers: [f64; 7]) -> MinimumRow {
    let mut coefficients = [None; 7];
    let mut colour = 0;
    while colour < 7 {
        if numbers[colour] > 0.0 {
            coefficients[colour] = Some(numbers[colour]);
        }
        colour += 1;
    }
    MinimumRow { observation_deg, entrance_deg, coefficients }
}

/// All that are known.
pub const MINIMUM_TABLES: [MinimumTable; 3] = [
    MinimumTable {
        name: "I",
        construction: "enclosed glass beads, engineering grade",
        source: SOURCE,
        rows: &[
            row(0.2, -4.0, [70.0, 50.0, 25.0, 9.0, 14.0, 4.0, 1.0]),
            row(0.2, 30.0, [30.0, 22.0, 7.0, 3.5, 6.0, 1.7, 0.3]),
            row(0.5, -4.0, [30.0, 25.0, 13.0, 4.5, 7.5, 2.0, 0.3]),
            row(0.5, 30.0, [15.0, 13.0, 4.0, 2.2, 3.0, 0.8, 0.2]),
        ],
    },
    MinimumTable {
        name: "II",
        construction: "enclosed glass beads, super engineering grade",
        source: SOURCE,
        rows: &[
            row(0.2, -4.0, [140.0, 100.0, 60.0, 30.0, 30.0, 10.0, 5.0]),
            row(0.2, 30.0, [60.0, 36.0, 22.0, 10.0, 12.0, 4.0, 2.0]),
            row(0.5, -4.0, [50.0, 33.0, 20.0, 9.0, 10.0, 3.0, 2.0]),
            row(0.5, 30.0, [28.0, 20.0, 12.0, 6.0, 6.0, 2.0, 1.0]),
        ],
    },
    MinimumTable {
        name: "III",
        construction: "encapsulated glass beads, high intensity",
        source: SOURCE,
        rows: &[
            row(0.1, -4.0, [300.0, 200.0, 120.0, 54.0, 54.0, 24.0, 14.0]),
            row(0.1, 30.0, [180.0, 120.0, 72.0, 32.0, 32.0, 14.0, 10.0]),
            row(0.2, -4.0, [250.0, 170.0, 100.0, 45.0, 45.0, 20.0, 12.0]),
            row(0.2, 30.0, [150.0, 100.0, 60.0, 25.0, 25.0, 11.0, 8.5]),
            row(0.5, -4.0, [95.0, 62.0, 30.0, 15.0, 15.0, 0.0, 0.0]),
        ],
    },
];

impl MinimumTable {
    /// The columns.
    pub const COLOURS: [&'static str; 7] = ["white", "yellow", "orange", "green", "red", "blue", "brown"];
}

/// The table of a type, such as "III".
#[must_use]
pub fn minimum_table(name: &str) -> Option<&'static MinimumTable> {
    MINIMUM_TABLES.iter().find(|table| table.name.eq_ignore_ascii_case(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_fall_with_either_angle_and_white_is_the_brightest() {
        for table in &MINIMUM_TABLES {
            for a in table.rows {
                for b in table.rows {
                    let farther = b.observation_deg >= a.observation_deg && b.entrance_deg >= a.entrance_deg;
                    for (near, far) in a.coefficients.iter().zip(b.coefficients) {
                        assert!(!farther || far.is_none() || far <= *near, "type {}: {a:?} {b:?}", table.name);
                    }
                }
                assert!(a.coefficients.iter().flatten().all(|colour| Some(*colour) <= a.coefficients[0]));
            }
        }
    }
}
