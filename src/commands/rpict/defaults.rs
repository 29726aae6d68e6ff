//! What `rpict -defaults` prints.

use super::options::Options;
use crate::shown_options::warning_line;
use radsight_film::SamplingBudget;
use radsight_picture::ViewKind;

/// The options as they stand, a line each, as Radiance prints them, and after them our own.
pub(super) fn text(options: &Options) -> String {
    let view = options.view;
    let mut lines = vec![format!("-vt{}\t\t\t\t# view type {}", view.kind.letter(), name_of(view.kind))];
    for (name, vector, what) in
        [("vp", view.point, "view point"), ("vd", view.direction, "view direction"), ("vu", view.up, "view up")]
    {
        lines.push(format!("-{name} {:.6} {:.6} {:.6}\t# {what}", vector.x, vector.y, vector.z));
    }
    for (name, value, what) in [
        ("vh", view.horizontal, "view horizontal size"),
        ("vv", view.vertical, "view vertical size"),
        ("vo", view.fore, "view fore clipping plane"),
        ("va", view.aft, "view aft clipping plane"),
        ("vs", view.shift, "view shift"),
        ("vl", view.lift, "view lift"),
    ] {
        lines.push(format!("-{name} {value:.6}\t\t\t# {what}"));
    }
    lines.push(format!("-x  {:<9}\t\t\t# x resolution", options.size[0]));
    lines.push(format!("-y  {:<9}\t\t\t# y resolution", options.size[1]));
    lines.push(options.shown.color_line());
    for (name, value, what) in [
        ("pa", options.pixel_aspect, "pixel aspect ratio"),
        ("pj", options.jitter(), "pixel jitter"),
        ("pm", options.motion, "pixel motion"),
        ("pd", options.aperture, "pixel depth-of-field"),
    ] {
        lines.push(format!("-{name} {value:.6}\t\t\t# {what}"));
    }
    lines.extend(options.shown.pixel_lines());
    lines.push(format!("-t  {:<9}\t\t\t# time between reports", options.report));
    lines.push(warning_line(options.reading.no_warnings));
    lines.extend(options.shown.lines());
    match options.effort {
        Some(SamplingBudget::Samples(samples)) => lines.push(format!("--samples {samples}\t\t\t# rays a pixel")),
        Some(SamplingBudget::Error { error, .. }) => {
            lines.push(format!("--error {error}\t\t\t# estimated error of the picture"));
        }
        Some(SamplingBudget::Interpolated(_)) | None => {}
    }
    lines.push(format!("--seed {:<6}\t\t\t# sample sequence", options.render.seed));
    lines.join("\n") + "\n"
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
