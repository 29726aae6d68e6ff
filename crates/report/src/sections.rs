//! The sections of text and tables.

use crate::escape::Escaped;
use crate::layer::Layers;
use crate::map::ErrorMap;
use crate::number::{seconds, short, significant};
use crate::progress_log::Progress;
use crate::record::{Decision, RunRecord, Setting, Stage};
use crate::scale::quantile;
use std::fmt::Write as _;

/// Width and height of the progress plot, in its own units.
const PLOT: [f64; 2] = [600.0, 200.0];

fn percent(share: f64) -> String {
    format!("{} %", significant(100.0 * share, 3))
}

/// The table at the top.
pub(crate) fn facts(facts: &[Setting], record: &RunRecord) -> String {
    let mut out = String::from("<section aria-label=\"summary\">\n");
    for note in &record.notes {
        let _ = writeln!(out, "<p class=\"note\" role=\"note\">{}</p>", Escaped(note));
    }
    out.push_str("<table class=\"facts\"><tbody>\n");
    let row = |name: &str, value: &str| {
        format!("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", Escaped(name), Escaped(value))
    };
    facts.iter().for_each(|fact| out.push_str(&row(&fact.name, &fact.value)));
    if let Some(error) = &record.error {
        out.push_str(&row("estimated error", &interval(error.reached, error.uncertainty)));
    }
    if let Some(rays) = record.rays {
        out.push_str(&row("camera rays", &grouped(rays)));
    }
    let elapsed: f64 = record.stages.iter().map(|stage| stage.elapsed_s).sum();
    if elapsed > 0.0 {
        out.push_str(&row("time", &seconds(elapsed)));
    }
    if let Some(date) = &record.date {
        out.push_str(&row("date", date));
    }
    out.push_str("</tbody></table></section>\n");
    out
}

/// A relative error with its confidence interval.
fn interval(error: f64, uncertainty: Option<f64>) -> String {
    match uncertainty {
        Some(uncertainty) => {
            format!("{} ± {} % (95 %)", percent(error), significant(100.0 * uncertainty, 2))
        }
        None => percent(error),
    }
}

/// Digits in groups of three.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut out = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            out.push('\u{202f}');
        }
        out.push(digit);
    }
    out
}

/// Minimum, median, maximum and percentiles of each quantity.
pub(crate) fn statistics(layers: &Layers) -> String {
    let mut out = String::from(
        "<section><h2>Values</h2><div class=\"wide\"><table><thead><tr><th scope=\"col\">of each pixel</th>\
         <th scope=\"col\">mean</th><th scope=\"col\">minimum</th><th scope=\"col\">1 %</th><th scope=\"col\">median</th>\
         <th scope=\"col\">99 %</th><th scope=\"col\">maximum</th><th scope=\"col\">unit</th></tr></thead><tbody>\n",
    );
    let mut missing = Vec::new();
    for (index, choice) in layers.choices.iter().enumerate() {
        let mut values: Vec<f32> = layers.values(index).map(|value| value as f32).collect();
        let all = values.len();
        values.retain(|value| value.is_finite());
        if values.len() < all {
            missing.push(format!("{}: {} of {all} pixels have no finite value.", choice.name, all - values.len()));
        }
        let _ = write!(out, "<tr><th scope=\"row\">{}</th>", Escaped(&choice.name));
        if values.is_empty() {
            out.push_str("<td colspan=\"6\">none</td>");
        } else {
            let mean = values.iter().map(|value| f64::from(*value)).sum::<f64>() / values.len() as f64;
            let quantiles = [0.0, 0.01, 0.5, 0.99, 1.0].map(|part| quantile(&mut values, part));
            for value in std::iter::once(mean).chain(quantiles) {
                let _ = write!(out, "<td>{}</td>", significant(value, 4));
            }
        }
        let _ = writeln!(out, "<td>{}</td></tr>", Escaped(&choice.unit));
    }
    out.push_str("</tbody></table></div>\n");
    for line in &missing {
        let _ = writeln!(out, "<p class=\"note\">{}</p>", Escaped(line));
    }
    out.push_str("</section>\n");
    out
}

/// The known errors.
pub(crate) fn error(record: &RunRecord, map: Option<&ErrorMap>) -> String {
    let mut out = String::from("<section><h2>Error</h2>\n");
    match &record.error {
        Some(error) => {
            let asked = error.asked.map_or(String::new(), |asked| format!("; requested: {}", percent(asked)));
            let _ = writeln!(
                out,
                "<p>Estimated error of the picture: <strong>{}</strong>{asked}. It is estimated from the picture's own samples.</p>",
                interval(error.reached, error.uncertainty)
            );
        }
        None => out.push_str("<p>The input has no estimate of the whole picture's error.</p>\n"),
    }
    if let Some(noise) = record.cache_noise {
        let bias = match record.error {
            Some(_) => {
                "The estimate above includes the noise and interpolation bias that remain after pixels were corrected."
            }
            None => "Its interpolation bias is not estimated and is not included.",
        };
        let _ = writeln!(out, "<p>Irradiance cache: {} noise. {bias}</p>", percent(noise));
    }
    out.push_str(match map {
        Some(_) => {
            "<p>The error map has the standard error of each pixel, smoothed over its neighbours, since one pixel's samples say \
             little. With 95 % confidence the value of a pixel lies within 1.96 standard errors; the picture above gives \
             that interval for the pixel under the pointer.</p>\n"
        }
        None => "<p>The input has no error map (<code>--error-map</code>).</p>\n",
    });
    out.push_str("</section>\n");
    out
}

/// The stages and their durations.
pub(crate) fn time(stages: &[Stage], progress: &[Progress]) -> String {
    let mut out = String::from("<section><h2>Time</h2>\n");
    if stages.is_empty() && progress.is_empty() {
        out.push_str("<p>The input has no times (<code>--record</code>).</p></section>\n");
        return out;
    }
    if !stages.is_empty() {
        out.push_str(&stage_table(stages));
    }
    if let Some(last) = progress.last() {
        out.push_str(&plot(progress, last));
    }
    out.push_str("</section>\n");
    out
}

fn stage_table(stages: &[Stage]) -> String {
    let total: f64 = stages.iter().map(|stage| stage.elapsed_s).sum();
    let mut out = String::from(
        "<div class=\"wide\"><table><thead><tr><th scope=\"col\">stage</th><th scope=\"col\">elapsed</th><th scope=\"col\">share</th>\
         <th scope=\"col\">processor</th><th scope=\"col\">threads busy</th><th></th></tr></thead><tbody>\n",
    );
    let row = |name: &str, elapsed: f64, processor: Option<f64>| {
        let share = if total > 0.0 { elapsed / total } else { 0.0 };
        let busy = processor.filter(|_| elapsed > 1e-3).map(|processor| format!("{:.1}", processor / elapsed));
        format!(
            "<th scope=\"row\">{}</th><td>{}</td><td>{:.1} %</td><td>{}</td><td>{}</td>\
             <td><svg class=\"bar\" viewBox=\"0 0 100 10\" preserveAspectRatio=\"none\" aria-hidden=\"true\"><rect width=\"{:.2}\" height=\"10\" /></svg></td>",
            Escaped(name),
            seconds(elapsed),
            100.0 * share,
            processor.map(seconds).unwrap_or_default(),
            busy.unwrap_or_default(),
            100.0 * share.clamp(0.0, 1.0),
        )
    };
    for stage in stages {
        let _ = writeln!(out, "<tr>{}</tr>", row(&stage.name, stage.elapsed_s, stage.processor_s));
    }
    let processor: Option<f64> = stages.iter().map(|stage| stage.processor_s).sum();
    let _ = writeln!(out, "<tr class=\"total\">{}</tr>", row("total", total, processor));
    out.push_str("</tbody></table></div>\n");
    out
}

/// The finished share against time.
fn plot(progress: &[Progress], last: &Progress) -> String {
    let [width, height] = PLOT;
    let end = last.elapsed_s.max(f64::MIN_POSITIVE);
    let point = |at: &Progress| {
        let [x, y] = [at.elapsed_s / end, 1.0 - at.share].map(|part| part.clamp(0.0, 1.0));
        format!("{:.1},{:.1} ", width * x, height * y)
    };
    let points: String = progress.iter().map(point).collect();
    format!(
        "<figure class=\"plot\"><svg viewBox=\"-4 -4 {} {}\" role=\"img\" aria-label=\"finished share against time\">\
         <path d=\"M0 0V{height}H{width}\" class=\"axis\" /><polyline points=\"{}\" /></svg>\
         <figcaption>Finished share of the picture, from 0 to {}: {} rays, {} of processor time, \
         {:.2} % done in the end.</figcaption></figure>\n",
        width + 8.0,
        height + 8.0,
        points.trim_end(),
        seconds(last.elapsed_s),
        short(last.rays),
        seconds(last.processor_s),
        100.0 * last.share
    )
}

/// The skipped and the computed work.
pub(crate) fn decisions(decisions: &[Decision]) -> String {
    let mut out = String::from("<section><h2>Skipped</h2>\n");
    let list = |skipped: bool| {
        let chosen = decisions.iter().filter(|decision| decision.skipped == skipped);
        chosen
            .map(|d| format!("<li><strong>{}</strong>: {}</li>\n", Escaped(&d.what), Escaped(&d.why)))
            .collect::<String>()
    };
    let (skipped, done) = (list(true), list(false));
    match (decisions.is_empty(), skipped.is_empty()) {
        (true, _) => out.push_str("<p>The input has no list of skipped work (<code>--record</code>).</p>\n"),
        (false, true) => out.push_str("<p>Nothing.</p>\n"),
        (false, false) => out.push_str(&format!("<ul>\n{skipped}</ul>\n")),
    }
    if !done.is_empty() {
        let _ = write!(out, "<h3>Computed</h3>\n<ul>\n{done}</ul>\n");
    }
    out.push_str("</section>\n");
    out
}

/// The options.
pub(crate) fn settings(record: &RunRecord) -> String {
    let mut out = String::from("<section><h2>Settings</h2>\n");
    if !record.command.is_empty() {
        let words: Vec<String> = record.command.iter().map(|word| quoted(word)).collect();
        let _ = writeln!(out, "<pre>{}</pre>", Escaped(&words.join(" ")));
    }
    if !record.settings.is_empty() {
        out.push_str("<div class=\"wide\"><table class=\"facts\"><tbody>\n");
        for Setting { name, value } in &record.settings {
            let _ = writeln!(out, "<tr><th scope=\"row\">{}</th><td>{}</td></tr>", Escaped(name), Escaped(value));
        }
        out.push_str("</tbody></table></div>\n");
    }
    if record.command.is_empty() && record.settings.is_empty() {
        out.push_str("<p>See the header below.</p>\n");
    }
    out.push_str("</section>\n");
    out
}

/// A word quoted for a shell.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./=:,+@%".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

/// Verbatim texts.
pub(crate) fn texts(texts: &[(String, String)], messages: &[String]) -> String {
    let mut out = String::new();
    let said = (!messages.is_empty()).then(|| ("Messages".to_owned(), messages.join("\n")));
    for (name, text) in texts.iter().chain(said.iter()) {
        let _ = writeln!(
            out,
            "<section><details open=\"open\"><summary><h2>{}</h2></summary><pre>{}</pre></details></section>",
            Escaped(name),
            Escaped(text)
        );
    }
    out
}

/// The versions of the programs that made the picture and the page.
pub(crate) fn versions(record: &RunRecord) -> String {
    let mut out = String::from("<section><h2>Versions</h2>\n<p>");
    if !record.software.is_empty() {
        let _ = write!(out, "Picture: {}. ", Escaped(&record.software));
    }
    let _ = writeln!(
        out,
        "Page: radsight {}. False colour: viridis. The page holds the values to 0.05 % and loads nothing.</p></section>",
        env!("CARGO_PKG_VERSION")
    );
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_as_a_shell_needs() {
        assert_eq!(["a.rad", "it's", ""].map(quoted), ["a.rad", "'it'\\''s'", "''"]);
    }

    #[test]
    fn long_numbers_are_grouped() {
        assert_eq!([0, 999, 1000, 1_234_567].map(grouped), ["0", "999", "1\u{202f}000", "1\u{202f}234\u{202f}567"]);
    }

    #[test]
    fn shares_of_stages_add_up() {
        let stage = |name: &str, elapsed_s| Stage { name: name.into(), elapsed_s, processor_s: Some(2.0 * elapsed_s) };
        let html = time(&[stage("read", 1.0), stage("rays", 3.0)], &[]);
        assert!(html.contains("25.0 %") && html.contains("75.0 %") && html.contains("100.0 %"), "{html}");
        assert!(html.contains("<td>2.0</td>"), "{html}");
    }
}
