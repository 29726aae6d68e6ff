//! What `rpict -defaults` prints.

use super::options::Options;
use crate::render_args;
use radsight_frame::Effort;

/// The options as they stand, a line each, as Radiance prints those that both have.
pub(super) fn text(options: &Options) -> String {
    let view = options.view;
    let mut lines = vec![format!("-vt{}\t\t\t\t# view type", view.kind.letter())];
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
    for (name, value, what) in [
        ("pa", options.pixel_aspect, "pixel aspect ratio"),
        ("pj", options.pixel_jitter, "pixel jitter"),
        ("pm", options.motion, "pixel motion"),
        ("pd", options.aperture, "pixel depth-of-field"),
    ] {
        lines.push(format!("-{name} {value:.6}\t\t\t# {what}"));
    }
    lines.push(match options.effort() {
        Effort::Samples(samples) => format!("--samples {samples}\t\t\t# rays a pixel"),
        Effort::Error { error, .. } => format!("--error {error}\t\t\t# estimated error of the picture"),
    });
    lines.push(format!("-t  {:<9}\t\t\t# time between reports", options.report));
    lines.extend(render_args::defaults(&options.render));
    lines.join("\n") + "\n"
}
