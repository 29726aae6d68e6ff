//! What `rtrace -defaults` prints.

use super::options::Options;
use crate::render_args;

/// The options as they stand, a line each, as Radiance prints those that both have.
pub(super) fn text(options: &Options) -> String {
    let [columns, rows] = options.size;
    let mut lines = vec![
        format!("-x {columns:<9}\t\t\t# flush interval"),
        format!("-y {rows:<9}\t\t\t# y resolution"),
        format!("-ld{}\t\t\t\t# limit distance", if options.limits_distance { "+" } else { "-" }),
        format!("-h{}\t\t\t\t# output header", if options.header { "+" } else { "-" }),
        "-faa\t\t\t\t# format input/output = ascii/ascii".to_owned(),
        "-ov\t\t\t\t# output value".to_owned(),
        "-pRGB\t\t\t\t# standard RGB color output".to_owned(),
    ];
    lines.extend(render_args::defaults(&options.render));
    lines.join("\n") + "\n"
}
