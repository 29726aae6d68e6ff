//! Minimum coefficients of retroreflection of common types of sheeting.
//!
//! Types I to III are those of ASTM D4956-01, "Standard Specification for Retroreflective Sheeting
//! for Traffic Control", as reprinted at angelfire.com/trek/cityton/american.htm. The reprint ends
//! within type III; values that US law (49 CFR 571.131) repeats are filled in, the others are
//! missing. Prismatic sheeting is listed as in US law: `III-prismatic` for school buses (49 CFR
//! 571.131), `FRA-224` for railway cars (49 CFR 224.103), `DOT-C2`, `DOT-C3` and `DOT-C4` for
//! trailers (49 CFR 571.108). Types IV and VI to XI of ASTM D4956 are left out: no public source of
//! their values was found.

/// A row of coefficients in cd/(lx m²) for white, yellow, orange, green, red, blue, brown; none if
/// the source has no value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MinimumRow {
    /// Observation angle, degrees.
    pub observation_deg: f64,
    /// Entrance angle, degrees.
    pub entrance_deg: f64,
    /// Coefficients in the order of [`MinimumTable::COLOURS`], cd/(lx m²).
    pub coefficients: [Option<f64>; 7],
}

/// Minimum coefficients of a type of sheeting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MinimumTable {
    /// Name of the type, such as "I" or "FRA-224".
    pub name: &'static str,
    /// Usual construction.
    pub construction: &'static str,
    /// Source of the values.
    pub source: &'static str,
    /// Rows by observation angle, then entrance angle.
    pub rows: &'static [MinimumRow],
}

const SOURCE: &str = "ASTM D4956-01, as reprinted at angelfire.com/trek/cityton/american.htm";
const SCHOOL_BUS: &str = "49 CFR 571.131 (2015), table 1, B; 1 cd/(fc ft2) is 1 cd/(lx m2)";
const RAILWAY_CAR: &str = "49 CFR 224.103 (2015), table 1";
const TRAILER: &str = "49 CFR 571.108 (2015), table XVI-c";
const PRISMS: &str = "prisms, any construction";

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

const fn white_and_red(white: f64, red: f64) -> [f64; 7] {
    [white, 0.0, 0.0, 0.0, red, 0.0, 0.0]
}

const fn white_and_yellow(white: f64, yellow: f64) -> [f64; 7] {
    [white, yellow, 0.0, 0.0, 0.0, 0.0, 0.0]
}

/// Conspicuity markings of trailers and truck tractors.
const fn trailer(name: &'static str, rows: &'static [MinimumRow]) -> MinimumTable {
    MinimumTable { name, construction: PRISMS, source: TRAILER, rows }
}

/// All known types.
pub const MINIMUM_TABLES: [MinimumTable; 8] = [
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
        source: "ASTM D4956-01, as reprinted at angelfire.com/trek/cityton/american.htm; its last row: 49 CFR 571.131 (2015), \
                 table 1, A",
        rows: &[
            row(0.1, -4.0, [300.0, 200.0, 120.0, 54.0, 54.0, 24.0, 14.0]),
            row(0.1, 30.0, [180.0, 120.0, 72.0, 32.0, 32.0, 14.0, 10.0]),
            row(0.2, -4.0, [250.0, 170.0, 100.0, 45.0, 45.0, 20.0, 12.0]),
            row(0.2, 30.0, [150.0, 100.0, 60.0, 25.0, 25.0, 11.0, 8.5]),
            row(0.5, -4.0, [95.0, 62.0, 30.0, 15.0, 15.0, 0.0, 0.0]),
            row(0.5, 30.0, [65.0, 0.0, 0.0, 0.0, 10.0, 0.0, 0.0]),
        ],
    },
    MinimumTable {
        name: "III-prismatic",
        construction: "prisms, high intensity",
        source: SCHOOL_BUS,
        rows: &[
            row(0.2, -4.0, white_and_red(250.0, 45.0)),
            row(0.2, 30.0, white_and_red(95.0, 13.3)),
            row(0.5, -4.0, white_and_red(200.0, 28.0)),
            row(0.5, 30.0, white_and_red(65.0, 10.0)),
        ],
    },
    MinimumTable {
        name: "FRA-224",
        construction: "prisms, of types V (coated with metal) and VII (not coated) of ASTM D4956-04 but for these minima",
        source: RAILWAY_CAR,
        rows: &[
            row(0.2, -4.0, white_and_yellow(600.0, 400.0)),
            row(0.2, 30.0, white_and_yellow(350.0, 220.0)),
            row(0.5, -4.0, white_and_yellow(160.0, 100.0)),
            row(0.5, 30.0, white_and_yellow(75.0, 45.0)),
        ],
    },
    trailer(
        "DOT-C2",
        &[
            row(0.2, -4.0, white_and_red(250.0, 60.0)),
            row(0.2, 30.0, white_and_red(250.0, 60.0)),
            row(0.2, 45.0, white_and_red(60.0, 15.0)),
            row(0.5, -4.0, white_and_red(65.0, 15.0)),
            row(0.5, 30.0, white_and_red(65.0, 15.0)),
            row(0.5, 45.0, white_and_red(15.0, 4.0)),
        ],
    ),
    trailer(
        "DOT-C3",
        &[
            row(0.2, -4.0, white_and_red(165.0, 40.0)),
            row(0.2, 30.0, white_and_red(165.0, 40.0)),
            row(0.2, 45.0, white_and_red(40.0, 10.0)),
            row(0.5, -4.0, white_and_red(43.0, 10.0)),
            row(0.5, 30.0, white_and_red(43.0, 10.0)),
            row(0.5, 45.0, white_and_red(10.0, 3.0)),
        ],
    ),
    trailer(
        "DOT-C4",
        &[
            row(0.2, -4.0, white_and_red(125.0, 30.0)),
            row(0.2, 30.0, white_and_red(125.0, 30.0)),
            row(0.2, 45.0, white_and_red(30.0, 8.0)),
            row(0.5, -4.0, white_and_red(33.0, 8.0)),
            row(0.5, 30.0, white_and_red(33.0, 8.0)),
            row(0.5, 45.0, white_and_red(8.0, 2.0)),
        ],
    ),
];

impl MinimumTable {
    /// Colours of the columns.
    pub const COLOURS: [&'static str; 7] = ["white", "yellow", "orange", "green", "red", "blue", "brown"];
}

/// Table of a type, such as "III".
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
