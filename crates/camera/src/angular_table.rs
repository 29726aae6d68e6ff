//! Relative intensity of an LED over the angle to its axis.

use crate::number_table::{NumberTable, NumberTableRow};
use radsight_diag::{Diagnostic, SourceId, SourceMap};

/// The most rows of a table.
const MOST_ROWS: usize = 2000;

/// Relative intensity over angle, linear between rows; the first value holds down to 0, nothing is
/// emitted beyond the last row or beyond 90°.
#[derive(Clone, Debug, PartialEq)]
pub struct AngularTable {
    /// (angle from the axis in degrees, relative intensity), angles ascending from 0 to at most 90.
    rows: Vec<(f64, f64)>,
}

impl AngularTable {
    /// Reads the table that stands in `sources` under `source`: columns `angle_deg` and
    /// `relative_intensity`.
    ///
    /// # Errors
    /// Every mistake of the table; never empty.
    pub fn read(source: SourceId, sources: &SourceMap) -> Result<(Self, Vec<Diagnostic>), Vec<Diagnostic>> {
        let table = NumberTable::read(source, sources, ["angle_deg", "relative_intensity"])?;
        let errors = mistakes(&table.rows, source, sources);
        if !errors.is_empty() {
            return Err(errors);
        }
        let warnings = doubts(&table.rows);
        let rows = table.rows.iter().map(|row| (row.values[0], row.values[1]));
        Ok((AngularTable { rows: front_half(rows.collect()) }, warnings))
    }

    /// Rows as (angle from the axis in degrees, relative intensity), angles ascending from 0 to at
    /// most 90.
    #[must_use]
    pub fn rows(&self) -> &[(f64, f64)] {
        &self.rows
    }

    /// Relative intensity at an angle from the axis, radians.
    #[must_use]
    pub fn intensity(&self, angle_rad: f64) -> f64 {
        let angle = angle_rad.to_degrees();
        let after = self.rows.partition_point(|row| row.0 <= angle);
        match (self.rows.get(after.wrapping_sub(1)), self.rows.get(after)) {
            (Some(&(a0, g0)), Some(&(a1, g1))) => g0 + (g1 - g0) * (angle - a0) / (a1 - a0),
            (Some(&(a0, g0)), None) if angle == a0 => g0,
            _ => 0.0,
        }
    }
}

fn mistakes(rows: &[NumberTableRow], source: SourceId, sources: &SourceMap) -> Vec<Diagnostic> {
    let mut errors = Vec::new();
    if !(2..=MOST_ROWS).contains(&rows.len()) {
        let message = format!("the LED table has {} row(s), expected 2 to {MOST_ROWS}", rows.len());
        errors.push(Diagnostic::error(message).at(sources.span(source, 0, 0)));
        return errors;
    }
    for row in rows {
        let [angle, intensity] = row.values;
        if !(0.0..=180.0).contains(&angle) {
            errors.push(Diagnostic::error(format!("angle {angle} is not between 0 and 180 degrees")).at(row.spans[0]));
        }
        if intensity < 0.0 {
            errors.push(Diagnostic::error(format!("relative intensity {intensity} is negative")).at(row.spans[1]));
        }
    }
    for pair in rows.windows(2).filter(|pair| pair[1].values[0] <= pair[0].values[0]) {
        let message = format!("angle {} does not come after {}", pair[1].values[0], pair[0].values[0]);
        let error = Diagnostic::error(message).at(pair[1].spans[0]);
        errors.push(error.hint("rows are in order of ascending angle, each angle once"));
    }
    if rows.iter().all(|row| row.values[1] == 0.0) {
        errors.push(Diagnostic::error("every relative intensity of the LED table is 0").at(sources.span(source, 0, 0)));
    }
    errors
}

fn doubts(rows: &[NumberTableRow]) -> Vec<Diagnostic> {
    let mut warnings = Vec::new();
    let (first, last) = (rows[0], rows[rows.len() - 1]);
    if first.values[0] > 0.0 {
        let message = format!("the LED table begins at {} degrees: its first value holds down to 0", first.values[0]);
        warnings.push(Diagnostic::warning(message).at(first.spans[0]));
    }
    if first.values[0] == 0.0 && first.values[1] != 1.0 {
        let message = format!(
            "relative intensity on the axis is {}, not 1: the intensity there is that times \"led_intensity_w_per_sr\"",
            first.values[1]
        );
        warnings.push(Diagnostic::warning(message).at(first.spans[1]));
    }
    if last.values[0] < 90.0 && last.values[1] > 0.0 {
        let message = format!("the LED table ends at {} degrees: nothing is emitted beyond", last.values[0]);
        warnings.push(Diagnostic::warning(message).at(last.spans[1]));
    }
    if last.values[0] > 90.0 {
        let message = "a flat LED emits nothing beyond 90 degrees: the rest of the LED table is not used";
        warnings.push(Diagnostic::warning(message).at(last.spans[0]));
    }
    warnings
}

/// Rows from exactly 0 to at most 90 degrees.
fn front_half(mut rows: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let beyond = rows.partition_point(|row| row.0 <= 90.0);
    if let (Some(&(a1, g1)), Some(&(a0, g0))) = (rows.get(beyond), rows.get(beyond.wrapping_sub(1))) {
        rows.truncate(beyond);
        if a0 < 90.0 {
            rows.push((90.0, g0 + (g1 - g0) * (90.0 - a0) / (a1 - a0)));
        }
    }
    match rows.first().copied() {
        // All rows are behind the disk, where the first value holds.
        Some((angle, value)) if angle > 90.0 => rows = vec![(0.0, value), (90.0, value)],
        Some((angle, value)) if angle > 0.0 => rows.insert(0, (0.0, value)),
        _ => {}
    }
    rows
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The rows of the paper's assumed LED.
    pub(crate) const HLMP_8104: &str = "angle_deg,relative_intensity
0,1.0
1,0.96
2,0.84
3,0.62
3.5,0.5
4,0.39
5,0.22
6,0.13
7,0.08
8,0.055
10,0.03
12,0.018
15,0.010
20,0.005
30,0.001
90,0
";

    pub(crate) fn table(text: &str) -> Result<(AngularTable, Vec<String>), String> {
        let mut sources = SourceMap::default();
        let source = sources.add("led.csv", text.as_bytes(), None);
        let render = |messages: Vec<Diagnostic>| messages.iter().map(|m| m.render(&sources)).collect::<Vec<_>>();
        AngularTable::read(source, &sources)
            .map(|(table, warnings)| (table, render(warnings)))
            .map_err(|errors| render(errors).concat())
    }

    #[test]
    fn values_are_linear_between_rows_and_nothing_beyond() {
        let (led, warnings) = table(HLMP_8104).unwrap();
        assert!(warnings.is_empty());
        let at = |degrees: f64| led.intensity(degrees.to_radians());
        assert!((at(0.0) - 1.0).abs() < 1e-15 && (at(3.25) - 0.56).abs() < 1e-12 && (at(60.0) - 0.0005).abs() < 1e-12);
        assert_eq!(at(91.0), 0.0);
    }

    #[test]
    fn rows_behind_the_disk_are_cut_at_90_degrees() {
        let (led, warnings) = table("10,1\n80,0.5\n100,0.1\n").unwrap();
        assert_eq!(led.rows(), [(0.0, 1.0), (10.0, 1.0), (80.0, 0.5), (90.0, 0.3)]);
        assert_eq!(warnings.len(), 2);
        let (behind, _) = table("100,1\n120,0\n").unwrap();
        assert_eq!(behind.rows(), [(0.0, 1.0), (90.0, 1.0)]);
    }

    #[test]
    fn mistakes_are_shown_on_the_tables_own_lines() {
        insta::assert_snapshot!(table("angle_deg,relative_intensity\n0,1\n5,-0.5\n4,0.2\n200,0\n").unwrap_err());
    }

    #[test]
    fn a_table_of_one_row_is_refused() {
        assert!(table("0,1\n").unwrap_err().contains("1 row(s), expected 2 to 2000"));
        assert!(table("0,0\n90,0\n").unwrap_err().contains("every relative intensity"));
    }
}
