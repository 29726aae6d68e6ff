//! Cumulative distributions of histograms.

/// The cumulative distribution at the start of each bin, and 1 at the end.
pub(crate) fn cumulative(counts: impl Iterator<Item = f64>, total: f64) -> Vec<f64> {
    let below = counts.scan(0.0, |sum, count| {
        let below = *sum;
        *sum += count;
        Some(below / total)
    });
    below.chain([1.0]).collect()
}

/// The cumulative distribution at a position in bins, linear within each bin.
pub(crate) fn share_at(cumulative: &[f64], position: f64) -> f64 {
    let bin = (position as usize).min(cumulative.len() - 2);
    let part = position - bin as f64;
    (1.0 - part) * cumulative[bin] + part * cumulative[bin + 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_rise_evenly_within_a_bin() {
        let shares = cumulative([1.0, 3.0, 4.0].into_iter(), 8.0);
        assert_eq!(shares, [0.0, 0.125, 0.5, 1.0]);
        let found = [0.0, 0.5, 1.0, 2.5, 3.0].map(|position| share_at(&shares, position));
        assert_eq!(found, [0.0, 0.0625, 0.125, 0.75, 1.0]);
    }
}
