//! Plots as SVG: points and lines on linear or logarithmic axes.

use std::fmt::Write;

const WIDTH: f64 = 560.0;
const HEIGHT: f64 = 340.0;
const LEFT: f64 = 74.0;
const RIGHT: f64 = 16.0;
const TOP: f64 = 30.0;
const BOTTOM: f64 = 48.0;

/// Scale of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Linear scale.
    Linear,
    /// Logarithmic scale; values of 0 and below are left out.
    Logarithmic,
}

/// Style of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// Dots.
    Points,
    /// A line through the values.
    Line,
    /// A dashed line.
    Dashes,
}

/// A series of values (x, y) with its legend.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Text of the legend.
    pub name: String,
    /// Style of the curve.
    pub mark: Mark,
    /// Values; those that are not finite are left out.
    pub values: Vec<[f64; 2]>,
}

/// A plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// Title above the plot.
    pub title: String,
    /// Labels of the axes, with units.
    pub axes: [String; 2],
    /// Scales of both axes.
    pub scales: [Scale; 2],
    /// Curves; later ones are drawn above earlier ones.
    pub curves: Vec<Curve>,
}

const COLOURS: [&str; 5] = ["#1f5fa8", "#c2410c", "#15803d", "#7c3aed", "#555555"];

impl Plot {
    /// The plot as an SVG element.
    #[must_use]
    pub fn svg(&self) -> String {
        let axes = [Axis::of(self, 0), Axis::of(self, 1)];
        let mut out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" width=\"{WIDTH}\" \
             height=\"{HEIGHT}\" font-family=\"sans-serif\" font-size=\"12\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
        );
        let _ = writeln!(out, "<text x=\"{LEFT}\" y=\"18\" font-size=\"14\">{}</text>", escaped(&self.title));
        self.draw_axes(&axes, &mut out);
        for (index, curve) in self.curves.iter().enumerate() {
            draw(curve, &axes, COLOURS[index % COLOURS.len()], &mut out);
            legend(curve, index, &mut out);
        }
        out.push_str("</svg>\n");
        out
    }

    fn draw_axes(&self, [x, y]: &[Axis; 2], out: &mut String) {
        let (bottom, right) = (HEIGHT - BOTTOM, WIDTH - RIGHT);
        for tick in x.ticks() {
            let at = x.place(tick);
            let label = short(tick);
            let _ = writeln!(
                out,
                "<path d=\"M{at:.1} {TOP}V{bottom}\" stroke=\"#ddd\"/><text x=\"{at:.1}\" y=\"{:.1}\" \
                 text-anchor=\"middle\">{label}</text>",
                bottom + 16.0
            );
        }
        for tick in y.ticks() {
            let at = y.place(tick);
            let label = short(tick);
            let _ = writeln!(
                out,
                "<path d=\"M{LEFT} {at:.1}H{right}\" stroke=\"#ddd\"/><text x=\"{:.1}\" y=\"{:.1}\" \
                 text-anchor=\"end\">{label}</text>",
                LEFT - 6.0,
                at + 4.0
            );
        }
        let _ = writeln!(
            out,
            "<rect x=\"{LEFT}\" y=\"{TOP}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#333\"/>\n\
             <text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n\
             <text transform=\"translate(14 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            right - LEFT,
            bottom - TOP,
            0.5 * (LEFT + right),
            HEIGHT - 10.0,
            escaped(&self.axes[0]),
            0.5 * (TOP + bottom),
            escaped(&self.axes[1])
        );
    }
}

fn draw(curve: &Curve, axes: &[Axis; 2], colour: &str, out: &mut String) {
    let places: Vec<[f64; 2]> = curve
        .values
        .iter()
        .filter(|value| axes.iter().zip(*value).all(|(axis, value)| axis.holds(*value)))
        .map(|[x, y]| [axes[0].place(*x), axes[1].place(*y)])
        .collect();
    if curve.mark == Mark::Points {
        for [x, y] in places {
            let _ = writeln!(out, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.4\" fill=\"{colour}\"/>");
        }
        return;
    }
    let dashes = if curve.mark == Mark::Dashes { " stroke-dasharray=\"5 4\"" } else { "" };
    let path: String = places.iter().map(|[x, y]| format!(" {x:.1},{y:.1}")).collect();
    let _ = writeln!(
        out,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.5\"{dashes}/>",
        path.trim_start()
    );
}

fn legend(curve: &Curve, index: usize, out: &mut String) {
    let y = TOP + 16.0 + 16.0 * index as f64;
    let (colour, x) = (COLOURS[index % COLOURS.len()], LEFT + 12.0);
    let _ = writeln!(
        out,
        "<rect x=\"{x}\" y=\"{:.1}\" width=\"10\" height=\"4\" fill=\"{colour}\"/><text x=\"{}\" y=\"{y:.1}\">{}</text>",
        y - 6.0,
        x + 16.0,
        escaped(&curve.name)
    );
}

/// An axis: its range and its position on the page.
struct Axis {
    scale: Scale,
    low: f64,
    high: f64,
    page: [f64; 2],
}

impl Axis {
    fn of(plot: &Plot, index: usize) -> Axis {
        let scale = plot.scales[index];
        let page = if index == 0 { [LEFT, WIDTH - RIGHT] } else { [HEIGHT - BOTTOM, TOP] };
        let values = plot.curves.iter().flat_map(|curve| curve.values.iter().map(move |value| value[index]));
        let shown = values.filter(|value| value.is_finite() && (scale == Scale::Linear || *value > 0.0));
        let (mut low, mut high) = shown.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
        if low > high {
            (low, high) = (1.0, 10.0);
        }
        match scale {
            Scale::Linear => {
                let margin = if high > low { 0.04 * (high - low) } else { 0.5 * high.abs().max(1.0) };
                low = if low >= 0.0 && low < 0.3 * high { 0.0 } else { low - margin };
                high += margin;
            }
            Scale::Logarithmic => (low, high) = (low / 1.2, high * 1.2),
        }
        Axis { scale, low, high, page }
    }

    fn holds(&self, value: f64) -> bool {
        value.is_finite() && (self.scale == Scale::Linear || value > 0.0)
    }

    fn place(&self, value: f64) -> f64 {
        let share = match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Logarithmic => (value / self.low).ln() / (self.high / self.low).ln(),
        };
        self.page[0] + share * (self.page[1] - self.page[0])
    }

    /// Tick values: about six round numbers, or the powers of ten.
    fn ticks(&self) -> Vec<f64> {
        if self.scale == Scale::Logarithmic {
            let powers = self.low.log10().ceil() as i32..=self.high.log10().floor() as i32;
            return powers.map(|power| 10f64.powi(power)).collect();
        }
        let rough = (self.high - self.low) / 6.0;
        let power = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|digit| digit * power).into_iter().find(|step| *step >= rough);
        let step = step.unwrap_or(10.0 * power);
        let first = (self.low / step).ceil() as i64;
        (first..first + 12).map(|number| number as f64 * step).take_while(|tick| *tick <= self.high).collect()
    }
}

/// A number in short form.
fn short(number: f64) -> String {
    let size = number.abs();
    if size != 0.0 && !(1e-3..1e5).contains(&size) {
        return format!("{number:.0e}");
    }
    let text = format!("{number:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_placed_by_their_axes_and_text_is_escaped() {
        let plot = Plot {
            title: "a < b".to_owned(),
            axes: ["x".to_owned(), "y".to_owned()],
            scales: [Scale::Linear, Scale::Logarithmic],
            curves: vec![Curve {
                name: "c".to_owned(),
                mark: Mark::Points,
                values: vec![[0.0, 1.0], [10.0, 100.0], [f64::NAN, 5.0], [3.0, 0.0]],
            }],
        };
        let svg = plot.svg();
        assert!(svg.contains("a &lt; b"));
        // Values that cannot be shown are left out: NaN, and 0 on a logarithmic axis.
        assert_eq!(svg.matches("<circle").count(), 2);
        assert!(svg.contains("<circle cx=\"74.0\""), "0 stands at the left edge: {svg}");
    }
}
