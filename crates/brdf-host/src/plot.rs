//! Plots of a model's lobes as SVG, for `radsight plugin plot`.
//!
//! On the left is the plane of incidence: f in every direction for each outgoing angle, with a
//! logarithmic radius. On the right is f against the angle to the mirror direction and to the retro
//! direction, both logarithmic, so that one plot shows lobes of a hundredth of a degree and of ten
//! degrees.

use glam::DVec3;
use radsight_brdf::Brdf;
use std::fmt::Write;

/// Options of a plot.
#[derive(Clone, Debug, PartialEq)]
pub struct PlotOptions {
    /// Title above the plot.
    pub title: String,
    /// Number of bands of the model.
    pub bands: usize,
    /// The band to draw, from 0.
    pub band: usize,
    /// Outgoing angles from the normal, degrees, each in its own colour.
    pub outgoing_deg: Vec<f64>,
}

impl PlotOptions {
    /// The first band at 0°, 30° and 60°.
    #[must_use]
    pub fn new(title: impl Into<String>, bands: usize) -> Self {
        PlotOptions { title: title.into(), bands, band: 0, outgoing_deg: vec![0.0, 30.0, 60.0] }
    }
}

const COLOURS: [&str; 6] = ["#0b62a4", "#c8511b", "#2b8a3e", "#8a2be2", "#b8860b", "#555555"];
/// Decades from the centre of the left plot to its rim.
const DECADES: f64 = 5.0;
const RADIUS: f64 = 300.0;
const CENTRE: (f64, f64) = (330.0, 400.0);
/// Panels on the right: left edge, width, height, and smallest angle in degrees.
const PANEL: (f64, f64, f64) = (730.0, 300.0, 140.0);
const SMALLEST_DEG: f64 = 1e-3;

/// Plots a model.
#[must_use]
pub fn svg(brdf: &dyn Brdf, options: &PlotOptions) -> String {
    let sampler = Sampler { brdf, bands: options.bands.max(1), band: options.band.min(options.bands.max(1) - 1) };
    let curves: Vec<Curves> = options.outgoing_deg.iter().map(|&degrees| sampler.curves(degrees)).collect();
    let all = curves.iter().flat_map(|c| c.plane.iter().chain(&c.mirror).chain(&c.retro)).map(|&(_, value)| value);
    let largest = all.filter(|value| value.is_finite()).fold(f64::MIN_POSITIVE, f64::max);
    let top = largest.log10().ceil();
    let mut out = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 1060 470\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"1060\" height=\"470\" fill=\"white\"/>\n",
    );
    let _ = writeln!(out, "<text x=\"20\" y=\"28\" font-size=\"16\">{}</text>", escape(&options.title));
    draw_rings(&mut out, top);
    draw_axes(&mut out, 60.0, "angle to the mirror direction", top);
    draw_axes(&mut out, 270.0, "angle to the retro direction", top);
    for (index, curve) in curves.iter().enumerate() {
        let colour = COLOURS[index % COLOURS.len()];
        polyline(&mut out, colour, curve.plane.iter().map(|&(angle, value)| polar_point(angle, value, top)));
        polyline(&mut out, colour, curve.mirror.iter().map(|&(angle, value)| panel_point(60.0, angle, value, top)));
        polyline(&mut out, colour, curve.retro.iter().map(|&(angle, value)| panel_point(270.0, angle, value, top)));
        draw_ray(&mut out, colour, options.outgoing_deg[index]);
        let y = 52 + 18 * index;
        let _ =
            writeln!(out, "<text x=\"20\" y=\"{y}\" fill=\"{colour}\">seen at {}°</text>", options.outgoing_deg[index]);
    }
    out.push_str("</svg>\n");
    out
}

/// Pairs of an angle (radians) and f (1/sr).
struct Curves {
    /// By the angle from the normal in the plane of incidence, positive on the side of the outgoing
    /// direction.
    plane: Vec<(f64, f64)>,
    mirror: Vec<(f64, f64)>,
    retro: Vec<(f64, f64)>,
}

struct Sampler<'a> {
    brdf: &'a dyn Brdf,
    bands: usize,
    band: usize,
}

impl Sampler<'_> {
    fn curves(&self, outgoing_deg: f64) -> Curves {
        let view = outgoing_deg.to_radians();
        let value = |incident: f64| self.value(in_plane(view), in_plane(incident));
        // Fine steps around both directions, where narrow lobes lie, and uniform ones elsewhere.
        let mut angles: Vec<f64> = (-900..=900).map(|step| (f64::from(step) * 0.1).to_radians()).collect();
        let near: Vec<f64> =
            (0..=200).map(|step| SMALLEST_DEG.to_radians() * 10f64.powf(f64::from(step) / 40.0)).collect();
        for axis in [view, -view] {
            angles.extend(near.iter().flat_map(|offset| [axis - offset, axis + offset]).chain([axis]));
        }
        angles.retain(|angle| angle.abs() <= std::f64::consts::FRAC_PI_2);
        angles.sort_by(f64::total_cmp);
        // Away from the normal the mirror direction would soon be below the horizon, so both curves
        // go towards the normal.
        let towards = |axis: f64, offset: f64| if axis > 0.0 { axis - offset } else { axis + offset };
        Curves {
            plane: angles.into_iter().map(|angle| (angle, value(angle))).collect(),
            mirror: near.iter().map(|&offset| (offset, value(towards(-view, offset)))).collect(),
            retro: near.iter().map(|&offset| (offset, value(towards(view, offset)))).collect(),
        }
    }

    fn value(&self, outgoing: DVec3, incident: DVec3) -> f64 {
        let (mut values, mut pdf) = (vec![0.0; self.bands], [0.0]);
        self.brdf.eval_pdf(outgoing, &[incident], &mut values, &mut pdf);
        values[self.band]
    }
}

fn in_plane(angle: f64) -> DVec3 {
    DVec3::new(angle.sin(), 0.0, angle.cos())
}

/// Position on the logarithmic scale, 0…1; 0 for values below it.
fn height(value: f64, top: f64) -> f64 {
    if value > 0.0 { ((value.log10() - top) / DECADES + 1.0).clamp(0.0, 1.0) } else { 0.0 }
}

fn polar_point(angle: f64, value: f64, top: f64) -> (f64, f64) {
    let radius = RADIUS * height(value, top);
    (CENTRE.0 + radius * angle.sin(), CENTRE.1 - radius * angle.cos())
}

fn panel_point(y: f64, angle: f64, value: f64, top: f64) -> (f64, f64) {
    let (x, width, panel_height) = PANEL;
    let share = (angle.to_degrees() / SMALLEST_DEG).log10() / (90.0 / SMALLEST_DEG).log10();
    (x + width * share.clamp(0.0, 1.0), y + panel_height * (1.0 - height(value, top)))
}

fn polyline(out: &mut String, colour: &str, points: impl Iterator<Item = (f64, f64)>) {
    let list: Vec<String> = points.map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
    let _ = writeln!(
        out,
        "<polyline fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.5\" points=\"{}\"/>",
        list.join(" ")
    );
}

fn draw_rings(out: &mut String, top: f64) {
    let (x, y) = CENTRE;
    for step in 1..=DECADES as u32 {
        let radius = RADIUS * f64::from(step) / DECADES;
        let power = top - DECADES + f64::from(step);
        let _ = writeln!(
            out,
            "<path d=\"M {} {y} A {radius} {radius} 0 0 1 {} {y}\" fill=\"none\" stroke=\"#ccc\"/>\
             <text x=\"{}\" y=\"{}\" fill=\"#777\" text-anchor=\"middle\">1e{power}</text>",
            x - radius,
            x + radius,
            x + radius,
            y + 16.0
        );
    }
    let _ = writeln!(
        out,
        "<path d=\"M {} {y} H {} M {x} {y} V {}\" stroke=\"#999\"/>\
         <text x=\"{x}\" y=\"{}\" text-anchor=\"middle\" fill=\"#777\">f in 1/sr, in the plane of incidence</text>",
        x - RADIUS,
        x + RADIUS,
        y - RADIUS,
        y + 40.0
    );
}

/// The outgoing direction, as a short stroke at the rim.
fn draw_ray(out: &mut String, colour: &str, degrees: f64) {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let at = |radius: f64| (CENTRE.0 + radius * sin, CENTRE.1 - radius * cos);
    let ((x0, y0), (x1, y1)) = (at(RADIUS + 4.0), at(RADIUS + 20.0));
    let _ = writeln!(out, "<path d=\"M {x0:.1} {y0:.1} L {x1:.1} {y1:.1}\" stroke=\"{colour}\" stroke-width=\"3\"/>");
}

fn draw_axes(out: &mut String, y: f64, label: &str, top: f64) {
    let (x, width, panel_height) = PANEL;
    let _ = writeln!(
        out,
        "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{panel_height}\" fill=\"none\" stroke=\"#999\"/>\
         <text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{label}</text>",
        x + 0.5 * width,
        y - 8.0
    );
    for power in -3..=1 {
        let degrees = 10f64.powi(power);
        let at = panel_point(y, degrees.to_radians(), 0.0, top).0;
        let _ = writeln!(
            out,
            "<path d=\"M {at:.1} {y} V {}\" stroke=\"#ddd\"/><text x=\"{at:.1}\" y=\"{}\" fill=\"#777\" text-anchor=\"middle\">{degrees}°</text>",
            y + panel_height,
            y + panel_height + 16.0
        );
    }
    for step in 0..=DECADES as u32 {
        let power = top - DECADES + f64::from(step);
        let at = y + panel_height * (1.0 - f64::from(step) / DECADES);
        let _ = writeln!(
            out,
            "<text x=\"{}\" y=\"{:.1}\" fill=\"#777\" text-anchor=\"end\">1e{power}</text>",
            x - 6.0,
            at + 4.0
        );
    }
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use radsight_brdf::{Lambert, WardIsotropic};

    fn points(svg: &str, polyline: usize) -> Vec<(f64, f64)> {
        let line = svg.lines().filter(|line| line.starts_with("<polyline")).nth(polyline).unwrap();
        let list = line.split("points=\"").nth(1).unwrap().split('"').next().unwrap();
        list.split(' ')
            .map(|pair| pair.split_once(',').unwrap())
            .map(|(x, y)| (x.parse().unwrap(), y.parse().unwrap()))
            .collect()
    }

    #[test]
    fn lambert_is_a_half_circle() {
        let svg = svg(&Lambert { reflectance: [0.5] }, &PlotOptions::new("white & grey", 1));
        assert!(svg.contains("white &amp; grey"));
        let curve = points(&svg, 0);
        let radius = |&(x, y): &(f64, f64)| (x - CENTRE.0).hypot(y - CENTRE.1);
        let inner = &curve[20..curve.len() - 20];
        assert!(inner.iter().all(|point| (radius(point) - radius(&inner[0])).abs() < 0.2));
    }

    #[test]
    fn a_narrow_highlight_peaks_in_the_mirror_direction() {
        let options = PlotOptions { outgoing_deg: vec![30.0], ..PlotOptions::new("ward", 1) };
        let svg = svg(&WardIsotropic { specularity: [0.5], roughness: 0.001 }, &options);
        let curve = points(&svg, 0);
        let farthest = curve
            .iter()
            .max_by(|a, b| (a.0 - CENTRE.0).hypot(a.1 - CENTRE.1).total_cmp(&(b.0 - CENTRE.0).hypot(b.1 - CENTRE.1)))
            .unwrap();
        let angle = (farthest.0 - CENTRE.0).atan2(CENTRE.1 - farthest.1).to_degrees();
        assert!((angle + 30.0).abs() < 0.5, "{angle}");
    }
}
