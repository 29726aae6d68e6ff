//! The ratio of Radiance's time to ours at equal error.

use crate::curve::{Curve, TimeTo};
use crate::figure::Figure;
use crate::run::{RadianceOptions, Run, Setting};
use crate::table::Table;

/// Compares processor times at each error that Radiance reached, and at the target error of the
/// figure.
///
/// Extrapolation assumes time in proportion to 1/error², as for independent unbiased samples. This
/// makes Radiance look faster: it folds a light's extent into the highlight's width, and a bias
/// does not decrease with more rays.
pub(crate) fn report(runs: &[Run], figures: &[Figure]) -> String {
    let heading = ["figure", "rtrace", "at error %", "rtrace s", "--samples s", "ratio", "--error s", "ratio", "note"];
    let mut table = Table::new(&heading, 2);
    for &figure in figures {
        let of_figure = |kind: fn(&Setting) -> bool| {
            runs.iter().filter(move |run| run.figure == figure && kind(&run.setting)).map(point)
        };
        let ours = [
            Curve::new(of_figure(|setting| matches!(setting, Setting::Samples(_)))),
            Curve::new(of_figure(|setting| matches!(setting, Setting::Error(_)))),
        ];
        let subdivided = of_figure(|setting| matches!(setting, Setting::Radiance(RadianceOptions::Subdivided, _)));
        let defaults = of_figure(|setting| matches!(setting, Setting::Radiance(RadianceOptions::Defaults, _)));
        compare(&mut table, figure, RadianceOptions::Subdivided, &subdivided.collect::<Vec<_>>(), &ours);
        compare(&mut table, figure, RadianceOptions::Defaults, &defaults.collect::<Vec<_>>(), &ours);
    }
    table.to_text()
}

/// If more rays reduce the error by less than this factor, it is mostly bias and is not
/// extrapolated.
const STALLED: f64 = 0.9;

/// (error, processor time in s); measured errors for both programs.
fn point(run: &Run) -> (f64, f64) {
    (run.accuracy.error, run.cost.processor)
}

fn compare(table: &mut Table, figure: Figure, options: RadianceOptions, peer: &[(f64, f64)], ours: &[Curve; 2]) {
    for &(error, time) in peer {
        table.push(row(figure, options, error, time, ours, ""));
    }
    let target = figure.target_error();
    let [.., (earlier, _), (error, time)] = *peer else { return };
    if error <= target {
        return;
    }
    if error > STALLED * earlier {
        let cells = [figure.to_string(), options.to_string(), format!("{:.2}", 100.0 * target)];
        let unknown = std::iter::repeat_n("-".to_owned(), 5);
        let note = "not reached: more rays hardly lower rtrace's error".to_owned();
        table.push(cells.into_iter().chain(unknown).chain([note]).collect());
        return;
    }
    let extrapolated = time * (error / target).powi(2);
    table.push(row(figure, options, target, extrapolated, ours, "extrapolated, time ~ 1/error²"));
}

fn row(figure: Figure, options: RadianceOptions, error: f64, time: f64, ours: &[Curve; 2], note: &str) -> Vec<String> {
    let mut row = vec![figure.to_string(), options.to_string(), format!("{:.2}", 100.0 * error), format!("{time:.2}")];
    for curve in ours {
        row.extend(match curve.time_to(error) {
            TimeTo::Interpolated(own) => [format!("{own:.3}"), ratio(time / own)],
            TimeTo::AtMost(own) => [format!("<{own:.3}"), format!(">{}", ratio(time / own))],
            TimeTo::NotReached => ["-".to_owned(), "-".to_owned()],
        });
    }
    row.push(note.to_owned());
    row
}

/// With one decimal if significant.
fn ratio(value: f64) -> String {
    if value < 10.0 { format!("{value:.1}") } else { format!("{value:.0}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::Accuracy;
    use crate::cost::Cost;

    fn run(setting: Setting, error: f64, processor: f64) -> Run {
        let accuracy = Accuracy { error, own_error: error, within_one_grey: 1.0 };
        Run { figure: Figure::T10, setting, cost: Cost { wall: 1.0, processor }, accuracy, repetitions: 1 }
    }

    #[test]
    fn measured_bounded_and_extrapolated_ratios_are_distinguished() {
        let text = report(
            &[
                run(Setting::Samples(4), 0.04, 0.5),
                run(Setting::Samples(16), 0.01, 2.0),
                run(Setting::Radiance(RadianceOptions::Subdivided, 1), 0.08, 50.0),
                run(Setting::Radiance(RadianceOptions::Subdivided, 4), 0.02, 200.0),
            ],
            &[Figure::T10],
        );
        let rows: Vec<Vec<&str>> = text.lines().skip(1).map(|line| line.split_whitespace().collect()).collect();
        assert_eq!(rows[0][5..], ["8.00", "50.00", "<0.500", ">100", "-", "-"]);
        assert_eq!(rows[1][5..], ["2.00", "200.00", "1.000", "200", "-", "-"]);
        assert_eq!(rows[2][5..9], ["0.50", "3200.00", "-", "-"]);
        assert!(text.lines().nth(3).is_some_and(|line| line.contains("extrapolated")), "{text}");
    }

    #[test]
    fn an_error_that_stalls_is_not_extrapolated() {
        let peer =
            |samples, error| run(Setting::Radiance(RadianceOptions::Defaults, samples), error, f64::from(samples));
        let text = report(&[run(Setting::Samples(4), 0.5, 0.5), peer(1, 0.812), peer(2, 0.811)], &[Figure::T10]);
        let last = text.lines().last().unwrap_or_default();
        assert!(last.contains("0.50") && last.contains("not reached") && !last.contains("extrapolated"), "{text}");
    }
}
