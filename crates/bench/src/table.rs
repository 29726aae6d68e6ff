//! Text tables and comma-separated values.

use crate::run::Run;

/// Rows under a heading, with columns of the required width.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    rows: Vec<Vec<String>>,
    /// Number of left-aligned text columns.
    text_columns: usize,
}

impl Table {
    /// An empty table.
    pub(crate) fn new(heading: &[&str], text_columns: usize) -> Table {
        Table { rows: vec![heading.iter().map(|&word| word.to_owned()).collect()], text_columns }
    }

    /// Adds a row.
    pub(crate) fn push(&mut self, row: Vec<String>) {
        self.rows.push(row);
    }

    /// One line per row.
    pub(crate) fn to_text(&self) -> String {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let width = |column: usize| {
            self.rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..columns).map(width).collect();
        let mut text = String::new();
        for row in &self.rows {
            let cells = row.iter().zip(&widths).enumerate().map(|(column, (cell, &width))| {
                if column < self.text_columns { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
            });
            text.push_str(cells.collect::<Vec<_>>().join("  ").trim_end());
            text.push('\n');
        }
        text
    }
}

/// All runs as a table.
pub(crate) fn runs(runs: &[Run]) -> String {
    let heading =
        ["figure", "program", "setting", "wall s", "processor s", "error %", "less truth's %", "within 1 grey %"];
    let mut table = Table::new(&heading, 3);
    for run in runs {
        table.push(vec![
            run.figure.to_string(),
            run.setting.program().to_owned(),
            run.setting.to_string(),
            format!("{:.3}", run.cost.wall),
            format!("{:.3}", run.cost.processor),
            format!("{:.3}", 100.0 * run.accuracy.error),
            format!("{:.3}", 100.0 * run.accuracy.own_error),
            format!("{:.2}", 100.0 * run.accuracy.within_one_grey),
        ]);
    }
    table.to_text()
}

/// All runs as comma-separated values.
pub(crate) fn csv(runs: &[Run]) -> String {
    let mut text =
        "figure,program,setting,wall_s,processor_s,error,error_less_truth_noise,within_one_grey,repetitions\n"
            .to_owned();
    for Run { figure, setting, cost, accuracy, repetitions } in runs {
        // A setting may hold a comma.
        text.push_str(&format!(
            "{figure},{},\"{setting}\",{},{},{},{},{},{repetitions}\n",
            setting.program(),
            cost.wall,
            cost.processor,
            accuracy.error,
            accuracy.own_error,
            accuracy.within_one_grey,
        ));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::Accuracy;
    use crate::cost::Cost;
    use crate::figure::Figure;
    use crate::run::{RadianceOptions, Setting};

    fn run(figure: Figure, setting: Setting) -> Run {
        let accuracy = Accuracy { error: 0.125, own_error: 0.0625, within_one_grey: 0.5 };
        Run { figure, setting, cost: Cost { wall: 0.25, processor: 10.5 }, accuracy, repetitions: 3 }
    }

    #[test]
    fn columns_are_as_wide_as_they_need() {
        let text = runs(&[
            run(Figure::T8, Setting::Samples(64)),
            run(Figure::T10, Setting::Radiance(RadianceOptions::Subdivided, 2)),
        ]);
        assert_eq!(
            text,
            "figure  program   setting                 wall s  processor s  error %  less truth's %  within 1 grey %\n\
             t8      radsight  --samples 64             0.250       10.500   12.500           6.250            50.00\n\
             t10     rtrace    -ds .002 -dj 1, 2 rays   0.250       10.500   12.500           6.250            50.00\n"
        );
    }

    #[test]
    fn a_comma_in_a_setting_stays_in_its_field() {
        let text = csv(&[run(Figure::T9, Setting::Radiance(RadianceOptions::Defaults, 1))]);
        assert_eq!(text.lines().nth(1), Some("t9,rtrace,\"defaults, 1 ray\",0.25,10.5,0.125,0.0625,0.5,3"));
    }
}
