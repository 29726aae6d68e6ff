//! The table of Markdown.

/// Smallest time that can be measured, s.
const MIN_TIME: f64 = 0.1;

/// Tolerances within which two pictures are equally near: of shares of blocks, and of rms errors.
const SAME_BLOCKS: f64 = 1e-9;
const SAME_ERROR: f64 = 1e-4;

/// The first lines of the table.
pub(super) const HEADING: &str = "\
| picture | real, s | radsight, s | ratio | blocks within 5 %, real | radsight | rms error, real | radsight | of the truth |
|---|---|---|---|---|---|---|---|---|";

/// A value of each program.
#[derive(Clone, Copy, Debug)]
pub(super) struct Values {
    pub(super) real: f64,
    pub(super) own: f64,
}

/// A picture in the table.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub(super) name: String,
    /// Processor time, s.
    pub(super) seconds: Values,
    /// Share of blocks within the tolerance.
    pub(super) blocks: Values,
    /// Rms error of blocks.
    pub(super) error: Values,
    /// Noise of the reference itself.
    pub(super) noise: f64,
}

impl Row {
    /// Times below [`MIN_TIME`] of real Radiance count as that.
    fn ratio(&self) -> f64 {
        self.seconds.own / self.seconds.real.max(MIN_TIME)
    }

    fn is_dearer(&self) -> bool {
        self.ratio() > 1.0
    }

    fn has_fewer_blocks(&self) -> bool {
        self.blocks.own < self.blocks.real - SAME_BLOCKS
    }

    fn has_larger_error(&self) -> bool {
        self.error.own > self.error.real + SAME_ERROR
    }

    /// A line in which values that are worse than real Radiance's are bold.
    pub(super) fn to_markdown(&self) -> String {
        let mark = |text: String, is_worse| if is_worse { format!("**{text}**") } else { text };
        format!(
            "| {} | {:.3} | {:.3} | {} | {:.1} % | {} | {:.1} % | {} | {:.1} % |",
            self.name,
            self.seconds.real,
            self.seconds.own,
            mark(format!("{:.2}", self.ratio()), self.is_dearer()),
            100.0 * self.blocks.real,
            mark(format!("{:.1} %", 100.0 * self.blocks.own), self.has_fewer_blocks()),
            100.0 * self.error.real,
            mark(format!("{:.1} %", 100.0 * self.error.own), self.has_larger_error()),
            100.0 * self.noise,
        )
    }
}

/// How many pictures take no longer and are no worse.
pub(super) fn summary(rows: &[Row]) -> String {
    let count = rows.len();
    let mean = (rows.iter().map(|row| row.ratio().max(1e-3).ln()).sum::<f64>() / count.max(1) as f64).exp();
    let no = |is_worse: fn(&Row) -> bool| rows.iter().filter(|row| !is_worse(row)).count();
    format!(
        "geometric mean of {count} ratios of processor time (times of real Radiance below {MIN_TIME} s count as that): {mean:.2}\n\
         no longer than real Radiance: {} of {count}\n\
         at least as many blocks within 5 %: {} of {count}\n\
         no larger rms error: {} of {count}\n",
        no(Row::is_dearer),
        no(Row::has_fewer_blocks),
        no(Row::has_larger_error),
    )
}

/// The middle value, or the mean of the two middle values; NaN of none.
pub(super) fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = |at: usize| values.get(at).copied().unwrap_or(f64::NAN);
    0.5 * (middle(values.len().saturating_sub(1) / 2) + middle(values.len() / 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(real: f64, own: f64) -> Row {
        let seconds = Values { real, own };
        let blocks = Values { real: 0.5, own: 0.75 };
        Row { name: "a room 1".to_owned(), seconds, blocks, error: Values { real: 0.1, own: 0.2 }, noise: 0.01 }
    }

    #[test]
    fn worse_values_are_bold() {
        let expected = "| a room 1 | 0.010 | 0.050 | 0.50 | 50.0 % | 75.0 % | 10.0 % | **20.0 %** | 1.0 % |";
        assert_eq!(row(0.01, 0.05).to_markdown(), expected);
    }

    #[test]
    fn the_summary_counts_pictures() {
        let text = summary(&[row(0.4, 0.1), row(0.1, 0.4)]);
        assert!(text.contains("count as that): 1.00\n"), "{text}");
        assert!(text.contains("no longer than real Radiance: 1 of 2"), "{text}");
        assert!(text.contains("no larger rms error: 0 of 2"), "{text}");
    }

    #[test]
    fn a_median_is_between_two_values() {
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&mut [4.0, 1.0]), 2.5);
    }
}
