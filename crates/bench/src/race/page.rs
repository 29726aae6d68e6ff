//! The self-contained page with curves and pictures.

use super::result::{Clock, Entrant, SceneResult, Summary};
use crate::table::Table;
use radsight_picture::{Image, write_png_rgb8};
use std::fmt::Write as _;

/// One colour per program.
const COLORS: [&str; 6] = ["#c0392b", "#2c6fbb", "#6aa5de", "#2e8b57", "#7fbf7f", "#888888"];

const STYLE: &str = "body{font:14px/1.4 sans-serif;max-width:1100px;margin:2em auto;padding:0 1em}pre{overflow-x:auto;background:#f5f5f5;\
padding:.6em}figure{display:inline-block;margin:.3em;text-align:center;font-size:12px}img{width:192px;height:192px;object-fit:contain;\
image-rendering:pixelated;background:#222}svg{font:11px sans-serif}";

/// The whole page; `growth` is a separate section.
pub(crate) fn page(
    machine: &str,
    missing: &[String],
    results: &[SceneResult],
    summary: &Summary,
    clock: Clock,
    growth: &str,
) -> String {
    let mut page = format!(
        "<!DOCTYPE html><html lang=\"en\"><meta charset=\"utf-8\"><title>radsight: error against time</title><style>{STYLE}</style>\n\
         <h1>Error against time</h1><pre>{}</pre>\n",
        escaped(machine)
    );
    for reason in missing {
        let _ = writeln!(page, "<p><b>Missing:</b> {}</p>", escaped(reason));
    }
    let _ = writeln!(
        page,
        "<p>Error: <code>sqrt(mean(d²/(r² + (0.01·m)²)))</code> over the values of all pixels, d the difference from the reference r, \
         m the mean of the band; the reference's own noise is taken off in squares. Time: {}.</p><h2>Time to an error</h2><pre>{}</pre>",
        clock.words(),
        escaped(&summary.to_text())
    );
    for result in results {
        scene(&mut page, result, clock);
    }
    page.push_str(growth);
    page.push_str("</html>\n");
    page
}

fn scene(page: &mut String, result: &SceneResult, clock: Clock) {
    let _ = writeln!(
        page,
        "<h2>{}</h2><p>{}, {}×{} pixels, <code>{}</code></p><p>Reference: {} rays a pixel, noise {:.2} %; {}.</p>",
        result.scene.name,
        escaped(result.scene.what),
        result.scene.size[0],
        result.scene.size[1],
        escaped(&result.scene.task.join(" ")),
        result.reference.rays,
        100.0 * result.reference.noise,
        escaped(&result.reference.check),
    );
    curves(page, result, clock);
    pictures(page, result, clock);
    let _ = writeln!(page, "<details><summary>All runs</summary><pre>{}</pre></details>", escaped(&runs(result)));
}

/// A table of every run.
pub(crate) fn runs(result: &SceneResult) -> String {
    let heading =
        ["program", "setting", "wall s", "processor s", "peak MiB", "error %", "95th %", "worst block %", "bias %"];
    let mut table = Table::new(&heading, 2);
    for entrant in &result.entrants {
        for run in &entrant.runs {
            let share = |value: f64| format!("{:.2}", 100.0 * value);
            table.push(vec![
                entrant.program.clone(),
                format!("{}: {}", entrant.series, run.label),
                format!("{:.2}", run.taken.wall),
                format!("{:.2}", run.taken.processor),
                format!("{:.0}", run.taken.peak),
                share(run.accuracy.error),
                share(run.accuracy.percentile_95),
                share(run.accuracy.worst_block),
                share(run.accuracy.bias),
            ]);
        }
    }
    table.to_text()
}

/// Size of the chart and of its margin, in pixels.
const SIZE: [f64; 2] = [760.0, 380.0];
const MARGIN: f64 = 46.0;

/// Logarithmic axes: decades of time and of error.
struct Chart {
    low: [f64; 2],
    high: [f64; 2],
}

impl Chart {
    fn around(points: &[[f64; 2]]) -> Chart {
        let bound = |axis: usize, round: fn(f64) -> f64, choose: fn(f64, f64) -> f64, start: f64| {
            points.iter().map(|point| round(2.0 * point[axis].log10()) / 2.0).fold(start, choose)
        };
        let low = [0, 1].map(|axis| bound(axis, f64::floor, f64::min, f64::INFINITY));
        let high = [0, 1].map(|axis| bound(axis, f64::ceil, f64::max, f64::NEG_INFINITY));
        Chart { low, high: [0, 1].map(|axis| high[axis].max(low[axis] + 0.5)) }
    }

    fn place(&self, point: [f64; 2]) -> [f64; 2] {
        let share = |axis: usize| (point[axis].log10() - self.low[axis]) / (self.high[axis] - self.low[axis]);
        [MARGIN + share(0) * (SIZE[0] - 2.0 * MARGIN), SIZE[1] - MARGIN - share(1) * (SIZE[1] - 2.0 * MARGIN)]
    }

    fn grid(&self, out: &mut String) {
        for axis in 0..2 {
            for decade in self.low[axis].floor() as i32..=self.high[axis].ceil() as i32 {
                for digit in [1.0, 2.0, 5.0] {
                    let value = digit * 10.0_f64.powi(decade);
                    if (self.low[axis] - 1e-9..=self.high[axis] + 1e-9).contains(&value.log10()) {
                        self.line(out, axis, value);
                    }
                }
            }
        }
    }

    fn line(&self, out: &mut String, axis: usize, value: f64) {
        let corner = |other: f64| {
            let mut point = [10.0_f64.powf(self.low[0]), 10.0_f64.powf(self.low[1])];
            point[axis] = value;
            point[1 - axis] = 10.0_f64.powf(other);
            self.place(point)
        };
        let ([x0, y0], [x1, y1]) = (corner(self.low[1 - axis]), corner(self.high[1 - axis]));
        let _ = write!(out, "<path d=\"M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}\" stroke=\"#ddd\"/>");
        let _ = if axis == 0 {
            write!(out, "<text x=\"{x0:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{value} s</text>", y0 + 15.0)
        } else {
            write!(
                out,
                "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{:.3}</text>",
                x0 - 4.0,
                y0 + 4.0,
                100.0 * value
            )
        };
    }
}

fn curves(page: &mut String, result: &SceneResult, clock: Clock) {
    let points = |entrant: &Entrant| -> Vec<[f64; 2]> {
        let runs = entrant.runs.iter().map(|run| [clock.of(&run.taken), run.accuracy.error]);
        runs.filter(|point| point.iter().all(|value| *value > 0.0)).collect()
    };
    let all: Vec<[f64; 2]> = result.entrants.iter().flat_map(points).collect();
    if all.is_empty() {
        return;
    }
    let chart = Chart::around(&all);
    let _ = write!(page, "<svg width=\"{}\" height=\"{}\" viewBox=\"0 0 {0} {1}\" fill=\"none\">", SIZE[0], SIZE[1]);
    let mut grid = String::new();
    chart.grid(&mut grid);
    page.push_str(&grid.replace("<text", "<text fill=\"#444\""));
    let mut programs: Vec<&str> = Vec::new();
    for entrant in &result.entrants {
        if !programs.contains(&entrant.program.as_str()) {
            programs.push(&entrant.program);
        }
        let color =
            COLORS[(programs.iter().position(|program| *program == entrant.program).unwrap_or(0)) % COLORS.len()];
        let places: Vec<[f64; 2]> = points(entrant).into_iter().map(|point| chart.place(point)).collect();
        let path: Vec<String> = places.iter().map(|[x, y]| format!("{x:.1} {y:.1}")).collect();
        let dash = if entrant.unbiased { "" } else { " stroke-dasharray=\"6 3\"" };
        let _ = write!(page, "<path d=\"M{}\" stroke=\"{color}\" stroke-width=\"1.6\"{dash}/>", path.join("L"));
        for [x, y] in places {
            let title = escaped(&format!("{} {}", entrant.program, entrant.series));
            let _ = write!(
                page,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"{color}\"><title>{title}</title></circle>"
            );
        }
    }
    for (at, program) in programs.iter().enumerate() {
        let (x, y) = (SIZE[0] - MARGIN - 130.0, MARGIN + 14.0 * at as f64);
        let _ = write!(
            page,
            "<text x=\"{x}\" y=\"{y}\" fill=\"{}\">{}</text>",
            COLORS[at % COLORS.len()],
            escaped(program)
        );
    }
    page.push_str("</svg><p>Error in % against time in s; broken lines are series with a bias.</p>\n");
}

/// The most accurate picture of each program within the time of our first picture with an error of
/// a few per cent.
fn pictures(page: &mut String, result: &SceneResult, clock: Clock) {
    let time = result.equal_time(clock);
    let white = exposure(&result.reference.image);
    let _ = write!(page, "<p>The best within {time:.2} s:</p>");
    let mut show = |image: &Image<f32>, caption: &str| {
        if let Some(png) = png(image, white) {
            let _ = write!(
                page,
                "<figure><img alt=\"\" src=\"data:image/png;base64,{}\"><figcaption>{}</figcaption></figure>",
                base64(&png),
                escaped(caption)
            );
        }
    };
    show(&result.reference.image, "reference");
    for program in result.programs() {
        if let Some(run) = result.best_within(&program, time * 1.05, clock) {
            show(
                &run.picture,
                &format!("{program}: {:.1} % in {:.2} s", 100.0 * run.accuracy.error, clock.of(&run.taken)),
            );
        }
    }
    page.push('\n');
}

/// The radiance displayed as white: 97 % of the values are darker.
fn exposure(image: &Image<f32>) -> f32 {
    let mut values = image.data().to_vec();
    values.sort_by(f32::total_cmp);
    values[values.len() * 97 / 100].max(f32::MIN_POSITIVE)
}

fn png(image: &Image<f32>, white: f32) -> Option<Vec<u8>> {
    let bytes =
        image.data().iter().map(|value| (255.0 * (value / white).clamp(0.0, 1.0).powf(1.0 / 2.2)).round() as u8);
    let image = Image::new(image.width(), image.height(), image.components(), bytes.collect()).ok()?;
    write_png_rgb8(&image, None).ok()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// Bytes as text (RFC 4648, section 4).
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let word = (0..3).fold(0_u32, |word, at| word << 8 | u32::from(group.get(at).copied().unwrap_or(0)));
        for digit in 0..4 {
            let used = digit <= group.len();
            text.push(if used { char::from(DIGITS[(word >> (18 - 6 * digit) & 63) as usize]) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_become_the_text_of_the_standard() {
        for (bytes, text) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }

    #[test]
    fn a_chart_puts_its_corners_at_its_margins() {
        let chart = Chart::around(&[[0.1, 0.01], [10.0, 1.0]]);
        assert_eq!(chart.place([0.1, 0.01]), [MARGIN, SIZE[1] - MARGIN]);
        assert_eq!(chart.place([10.0, 1.0]), [SIZE[0] - MARGIN, MARGIN]);
    }
}
