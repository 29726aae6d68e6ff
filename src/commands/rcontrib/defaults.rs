//! What `rcontrib -defaults` prints.

use super::options::{Options, Wanted};
use crate::render_args;

/// The options as they stand, a line each, as Radiance prints those that both have.
pub(super) fn text(options: &Options) -> String {
    let [columns, rows] = options.size;
    let (sign, what) = match options.wanted {
        Wanted::Coefficients => ('-', "coefficients"),
        Wanted::Contributions => ('+', "contributions"),
    };
    let mut lines = vec![
        format!("-c {:<5}\t\t\t# accumulated rays per record", options.accumulate),
        format!("-V{sign}\t\t\t\t# output {what}"),
        format!("-x {columns:<9}\t\t\t# flush interval"),
        format!("-y {rows:<9}\t\t\t# y resolution"),
        format!("-ld{}\t\t\t\t# limit distance", if options.limits_distance { "+" } else { "-" }),
        format!("-h{}\t\t\t\t# output header", if options.header { "+" } else { "-" }),
        "-faa\t\t\t\t# format input/output = ascii/ascii".to_owned(),
        format!("-ad {:<9}\t\t\t# ambient divisions", options.render.gathering.divisions),
    ];
    lines.extend(render_args::defaults(&options.render));
    lines.join("\n") + "\n"
}
