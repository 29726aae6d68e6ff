//! Measured values by size, and their growth.

use crate::table::Table;
use std::fmt::Write as _;

/// A quantity, with its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Measure {
    Seconds(&'static str),
    Microseconds(&'static str),
    Bytes(&'static str),
}

impl Measure {
    fn words(self) -> String {
        match self {
            Measure::Seconds(what) => format!("{what}, s"),
            Measure::Microseconds(what) => format!("{what}, µs"),
            Measure::Bytes(what) => format!("{what}, bytes"),
        }
    }
}

/// One quantity of a program as a function of a size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Series {
    with: &'static str,
    program: &'static str,
    pub(super) measure: Measure,
}

impl Series {
    pub(super) fn new(with: &'static str, program: &'static str, measure: Measure) -> Series {
        Series { with, program, measure }
    }

    /// Another program's, or another quantity, as a function of the same size.
    pub(super) fn of(self, program: &'static str, measure: Measure) -> Series {
        Series { program, measure, ..self }
    }
}

/// All points, by size and value.
#[derive(Debug, Default)]
pub(super) struct Points {
    series: Vec<(Series, Vec<[f64; 2]>)>,
}

impl Points {
    pub(super) fn push(&mut self, series: Series, size: f64, value: f64) {
        match self.series.iter_mut().find(|known| known.0 == series) {
            Some((_, points)) => points.push([size, value]),
            None => self.series.push((series, vec![[size, value]])),
        }
    }

    /// Whether a series should be measured at another size: its extrapolated value there is at most
    /// `most`.
    pub(super) fn may_go_on(&self, series: Series, size: f64, most: f64) -> bool {
        let last = self.series.iter().find(|known| known.0 == series).and_then(|known| known.1.last());
        last.is_none_or(|[last_size, value]| value * size / last_size <= most)
    }

    /// One line per series.
    pub(super) fn to_text(&self) -> String {
        let mut table = Table::new(&["with", "what", "program", "grows as", "at size: value"], 5);
        for (series, points) in &self.series {
            let power = exponent(points).map_or("-".to_owned(), |power| format!("size^{power:.2}"));
            let values: Vec<String> =
                points.iter().map(|[size, value]| format!("{}: {}", short(*size), short(*value))).collect();
            table.push(vec![
                series.with.to_owned(),
                series.measure.words(),
                series.program.to_owned(),
                power,
                values.join("  "),
            ]);
        }
        table.to_text()
    }

    /// One line per point.
    pub(super) fn to_csv(&self) -> String {
        let mut text = "with,what,program,size,value,exponent\n".to_owned();
        for (series, points) in &self.series {
            let power = exponent(points).unwrap_or(f64::NAN);
            for [size, value] in points {
                let _ = writeln!(
                    text,
                    "{},\"{}\",{},{size},{value},{power:.3}",
                    series.with,
                    series.measure.words(),
                    series.program
                );
            }
        }
        text
    }
}

/// Three digits.
fn short(value: f64) -> String {
    match value {
        _ if value >= 1e5 => format!("{value:.0e}"),
        _ if value >= 100.0 => format!("{value:.0}"),
        _ => format!("{value:.*}", (2.0 - value.abs().max(1e-4).log10().floor()) as usize),
    }
}

/// The exponent of growth: a least-squares line through the logarithms of the larger half of the
/// points. Small sizes are dominated by constant costs.
fn exponent(points: &[[f64; 2]]) -> Option<f64> {
    let larger = points.get(points.len().saturating_sub(points.len().div_ceil(2).max(2))..)?;
    let logarithms: Vec<[f64; 2]> = larger.iter().map(|point| point.map(f64::ln)).collect();
    let mean = |axis: usize| logarithms.iter().map(|point| point[axis]).sum::<f64>() / logarithms.len() as f64;
    let (size, value) = (mean(0), mean(1));
    let spread = |other: usize, about: f64| -> f64 {
        logarithms.iter().map(|point| (point[0] - size) * (point[other] - about)).sum()
    };
    Some(spread(1, value) / spread(0, size)).filter(|power| power.is_finite())
}

/// A section of a page with the content of a CSV file of [`Points::to_csv`]; empty without it.
pub(crate) fn section(csv: &str) -> String {
    let mut lines = csv.lines();
    if lines.next().is_none() {
        return String::new();
    }
    let mut section =
        "<h2>How cost grows</h2><p>The exponent is that of the larger sizes.</p><table><tr><th>with</th><th>what</th>\
        <th>program</th><th>size</th><th>value</th><th>exponent</th></tr>\n"
            .to_owned();
    for line in lines {
        let cells = line.split('"').enumerate().flat_map(|(part, text)| {
            // What is quoted is one cell.
            let commas: &[char] = if part % 2 == 1 { &[] } else { &[','] };
            text.trim_matches(',').split(commas).map(str::to_owned).collect::<Vec<_>>()
        });
        let _ = writeln!(section, "<tr><td>{}</td></tr>", cells.collect::<Vec<_>>().join("</td><td>"));
    }
    section.push_str("</table>\n");
    section
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exponent_is_that_of_the_larger_sizes() {
        let points = [1.0, 10.0, 100.0, 1000.0].map(|size: f64| [size, if size < 50.0 { 7.0 } else { size.powf(1.5) }]);
        assert!((exponent(&points).unwrap() - 1.5).abs() < 1e-12);
        assert_eq!(exponent(&points[..1]), None);
    }

    #[test]
    fn a_series_goes_on_while_it_may_become_no_dearer_than_what_is_left() {
        let mut points = Points::default();
        let series = Series::new("lights", "a", Measure::Seconds("picture"));
        assert!(points.may_go_on(series, 10.0, 1.0));
        points.push(series, 10.0, 0.5);
        assert!(points.may_go_on(series, 20.0, 1.0) && !points.may_go_on(series, 100.0, 1.0));
    }

    #[test]
    fn a_line_of_the_file_is_a_row_of_the_page() {
        let mut points = Points::default();
        points.push(Series::new("lights", "a", Measure::Microseconds("ray")), 10.0, 0.5);
        assert!(
            section(&points.to_csv())
                .contains("<tr><td>lights</td><td>ray, µs</td><td>a</td><td>10</td><td>0.5</td><td>NaN</td></tr>")
        );
        assert_eq!(section(""), "");
    }
}
