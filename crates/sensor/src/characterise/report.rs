//! Report of a characterisation, as a table and as an HTML page with plots.

use super::estimate::Characterisation;
use super::measure::PhotonTransfer;
use crate::interval::{CONFIDENCE, Estimate};
use crate::plot::{Curve, Mark, Plot, Scale};
use std::fmt::Write;

/// Rows of name, unit and value.
fn rows(found: &Characterisation) -> Vec<(&'static str, &'static str, Option<Estimate>)> {
    let percent = |part: Estimate| Some(part.scaled(100.0));
    vec![
        ("gain K", "DN/e", Some(found.gain_dn_per_e)),
        ("quantum efficiency", "e/photon", Some(found.quantum_efficiency)),
        ("responsivity", "DN/photon", Some(found.responsivity)),
        ("dark noise sigma_d", "e", Some(found.dark_noise_e)),
        ("dark grey level", "DN", Some(found.dark_grey)),
        ("dark current", "e/s", Some(found.dark_current_e_per_s)),
        ("DSNU", "e", Some(found.dsnu_e.total)),
        ("DSNU, pixel part", "e", Some(found.dsnu_e.pixel)),
        ("DSNU, row part", "e", Some(found.dsnu_e.row)),
        ("DSNU, column part", "e", Some(found.dsnu_e.column)),
        ("PRNU", "%", percent(found.prnu.total)),
        ("PRNU, pixel part", "%", percent(found.prnu.pixel)),
        ("PRNU, row part", "%", percent(found.prnu.row)),
        ("PRNU, column part", "%", percent(found.prnu.column)),
        ("full well", "e", found.full_well_e),
    ]
}

/// Quantities without an interval.
fn plain_rows(found: &Characterisation) -> [(&'static str, &'static str, f64); 5] {
    let decibels = |ratio: f64| 20.0 * ratio.log10();
    [
        ("saturation capacity", "e", found.saturation_capacity_e),
        ("largest SNR", "dB", decibels(found.largest_snr)),
        ("dynamic range", "dB", decibels(found.dynamic_range)),
        ("linearity error", "%", 100.0 * found.linearity_error),
        ("dark grey values at 0", "%", 100.0 * found.dark_at_zero),
    ]
}

/// The table as comma-separated text; the first line names the columns.
#[must_use]
pub fn table(found: &Characterisation) -> String {
    let percent = 100.0 * CONFIDENCE;
    let mut out = format!("quantity,unit,value,low_{percent:.0},high_{percent:.0}\n");
    for (name, unit, value) in rows(found) {
        let _ = match value {
            Some(Estimate { value, low, high }) => {
                writeln!(out, "\"{name}\",{unit},{value:.6},{low:.6},{high:.6}")
            }
            // The converter saturates before the well.
            None => writeln!(out, "\"{name}\",{unit},,{:.6},", found.saturation_capacity_e),
        };
    }
    for (name, unit, value) in plain_rows(found) {
        let _ = writeln!(out, "\"{name}\",{unit},{value:.6},,");
    }
    out
}

/// A self-contained HTML page.
#[must_use]
pub fn html(name: &str, series: &PhotonTransfer, found: &Characterisation) -> String {
    let name = name.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    let [columns, pixel_rows] = series.pixels;
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{name}: EMVA 1288</title>\n\
         <style>body{{font-family:sans-serif;margin:2em;max-width:74em}}td,th{{padding:.2em .8em;text-align:right}}\
         td:first-child,th:first-child{{text-align:left}}svg{{margin:.5em}}</style></head><body>\n\
         <h1>{name}</h1>\n<p>Photon transfer method of EMVA Standard 1288, release 4.0 (linear): {columns} × {pixel_rows} \
         pixels, {} steps of light, stacks of {} pictures, exposure time {} s. Intervals have a confidence of {:.0} %.</p>\n\
         <table><tr><th>quantity</th><th>value</th><th>from</th><th>to</th><th>unit</th></tr>\n",
        series.light.len(),
        series.dark.pictures,
        series.exposure_s,
        100.0 * CONFIDENCE
    );
    for (name, unit, value) in rows(found) {
        let cells = match value {
            Some(Estimate { value, low, high }) => {
                format!("<td>{}</td><td>{}</td><td>{}</td>", digits(value), digits(low), digits(high))
            }
            None => format!("<td>not reached</td><td>{}</td><td></td>", digits(found.saturation_capacity_e)),
        };
        let _ = writeln!(out, "<tr><td>{name}</td>{cells}<td>{unit}</td></tr>");
    }
    for (name, unit, value) in plain_rows(found) {
        let _ = writeln!(out, "<tr><td>{name}</td><td>{}</td><td></td><td></td><td>{unit}</td></tr>", digits(value));
    }
    out.push_str("</table>\n");
    plots(series, found).iter().for_each(|plot| out.push_str(&plot.svg()));
    out.push_str("</body></html>\n");
    out
}

/// Five significant digits.
fn digits(value: f64) -> String {
    let before_point = if value == 0.0 { 1 } else { value.abs().log10().floor() as i32 + 1 };
    format!("{value:.*}", (5 - before_point).clamp(0, 9) as usize)
}

fn curve(name: &str, mark: Mark, values: Vec<[f64; 2]>) -> Curve {
    Curve { name: name.to_owned(), mark, values }
}

fn plot(title: &str, axes: [&str; 2], scales: [Scale; 2], curves: Vec<Curve>) -> Plot {
    Plot { title: title.to_owned(), axes: axes.map(str::to_owned), scales, curves }
}

fn plots(series: &PhotonTransfer, found: &Characterisation) -> [Plot; 5] {
    let dark = series.dark.mean();
    let light = || series.light.iter();
    let linear = [Scale::Linear; 2];
    let gain = found.gain_dn_per_e.value;
    let response = found.responsivity.value;
    let top = found.saturation_capacity_e * gain;
    let line = |slope: f64, from: f64, to: f64| vec![[0.0, from], [to, from + slope * to]];
    let transfer = vec![
        curve("measured", Mark::Points, light().map(|step| [step.mean - dark, step.variance]).collect()),
        curve("line fitted up to 70 %", Mark::Line, line(gain, series.dark.variance, top)),
    ];
    let rising = vec![
        curve("measured", Mark::Points, light().map(|step| [step.photons, step.mean - dark]).collect()),
        curve("line fitted up to 70 %", Mark::Line, line(response, 0.0, top / response)),
    ];
    let off = light().filter(|step| step.mean - dark < 0.98 * top);
    let deviation =
        off.map(|step| [step.photons, 100.0 * (step.mean - dark - response * step.photons) / top]).collect();
    // Saturated steps do not fluctuate, which does not make them free of noise.
    let unsaturated = light().filter(|step| step.mean - dark < 0.98 * top);
    let snr = unsaturated.map(|step| [step.photons, (step.mean - dark) / step.variance.sqrt()]).collect();
    let ideal = light().map(|step| [step.photons, step.photons.sqrt()]).collect();
    let model = light().map(|step| {
        let electrons = found.quantum_efficiency.value * step.photons;
        let noise = found.dark_noise_e.value.powi(2) + electrons + (12.0 * gain * gain).recip();
        [step.photons, electrons / noise.sqrt()]
    });
    let times = series.dark_times.iter().map(|step| [step.exposure_s, step.mean]).collect();
    [
        plot("Photon transfer", ["mean grey value above dark (DN)", "variance in time (DN²)"], linear, transfer),
        plot("Response", ["photons a pixel", "mean grey value above dark (DN)"], linear, rising),
        plot(
            "Deviation from the line",
            ["photons a pixel", "share of saturation (%)"],
            linear,
            vec![curve("measured", Mark::Points, deviation)],
        ),
        plot(
            "Signal to noise ratio",
            ["photons a pixel", "ratio"],
            [Scale::Logarithmic; 2],
            vec![
                curve("measured", Mark::Points, snr),
                curve("from K, quantum efficiency and dark noise", Mark::Line, model.collect()),
                curve("a perfect sensor", Mark::Dashes, ideal),
            ],
        ),
        plot(
            "Dark signal",
            ["exposure time (s)", "mean grey value (DN)"],
            linear,
            vec![curve("measured", Mark::Points, times)],
        ),
    ]
}
