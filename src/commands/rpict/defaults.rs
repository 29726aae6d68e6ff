//! The output of `rpict -defaults`.

use super::options::Options;
use crate::listed_options::{color_line, seed_line};
use glam::DVec3;
use radsight_film::{ErrorTarget, SamplingBudget};
use radsight_picture::ViewKind;

/// The current options, one per line, as Radiance prints them, followed by radsight's own.
pub(super) fn text(options: &Options) -> String {
    let lines = options.settings.lines(&|option| match option.name {
        "-x" => Some(format!("-x  {:<9}\t\t\t# x resolution", options.size[0])),
        "-y" => Some(format!("-y  {:<9}\t\t\t# y resolution", options.size[1])),
        "-t" => Some(format!("-t  {:<9}\t\t\t# time between reports", options.report)),
        "-pj" => Some(format!("-pj {:.6}\t\t\t# pixel jitter", options.jitter())),
        "-pRGB" => Some(color_line(&options.settings)),
        "--seed" => Some(seed_line(options.render.seed)),
        "--samples" | "--error" => budget_line(options, option.name),
        name => view_line(options, name),
    });
    lines.join("\n") + "\n"
}

fn budget_line(options: &Options, name: &str) -> Option<String> {
    match (options.sampling_budget?, name) {
        (SamplingBudget::Samples(samples), "--samples") => Some(format!("--samples {samples}\t\t\t# rays a pixel")),
        (SamplingBudget::Error(ErrorTarget { error, .. }), "--error") => {
            Some(format!("--error {error}\t\t\t# estimated error of the picture"))
        }
        _ => None,
    }
}

/// The line of a view option; the view may come from a file.
fn view_line(options: &Options, name: &str) -> Option<String> {
    let view = options.view;
    let vector =
        |vector: DVec3, what: &str| format!("{name} {:.6} {:.6} {:.6}\t# view {what}", vector.x, vector.y, vector.z);
    let number = |value: f64, what: &str| format!("{name} {value:.6}\t\t\t# view {what}");
    Some(match name {
        "-vt" => format!("-vt{}\t\t\t\t# view type {}", view.kind.letter(), name_of(view.kind)),
        "-vp" => vector(view.point, "point"),
        "-vd" => vector(view.direction, "direction"),
        "-vu" => vector(view.up, "up"),
        "-vh" => number(view.horizontal, "horizontal size"),
        "-vv" => number(view.vertical, "vertical size"),
        "-vo" => number(view.fore, "fore clipping plane"),
        "-va" => number(view.aft, "aft clipping plane"),
        "-vs" => number(view.shift, "shift"),
        "-vl" => number(view.lift, "lift"),
        _ => return None,
    })
}

fn name_of(kind: ViewKind) -> &'static str {
    match kind {
        ViewKind::Perspective => "perspective",
        ViewKind::Parallel => "parallel",
        ViewKind::Hemispherical => "hemispherical",
        ViewKind::Angular => "angular",
        ViewKind::Cylindrical => "cylindrical",
        ViewKind::Planispheric => "planisphere",
    }
}
