//! What `rcontrib -defaults` prints.

use super::options::{Options, Wanted};
use crate::shown_options::{format_line, process_line, size_lines, warning_line};
use radsight_render::Quantity;

/// The options as they stand, a line each, as Radiance prints them, and after them our own.
pub(super) fn text(options: &Options) -> String {
    let (sign, what) = match options.wanted {
        Wanted::Coefficients => ('-', "coefficients"),
        Wanted::Contributions => ('+', "contributions"),
    };
    let mut lines = vec![
        format!("-c {:<5}\t\t\t# accumulated rays per record", options.accumulate),
        format!("-V{sign}\t\t\t\t# output {what}"),
    ];
    if options.render.quantity == Quantity::Irradiance {
        lines.push("-I+\t\t\t\t# immediate irradiance on".to_owned());
    }
    lines.push(process_line(options.threads));
    lines.extend(size_lines(options.size));
    lines.push(if options.limits_distance {
        "-ld+\t\t\t\t# limit distance on".to_owned()
    } else {
        "-ld-\t\t\t\t# limit distance off".to_owned()
    });
    lines.push(if options.header { "-h+\t\t\t\t# output header" } else { "-h-\t\t\t\t# no header" }.to_owned());
    lines.push(format_line(options.input_format, options.output_format));
    if options.report > 0 {
        lines.push(format!("-t {:<9}\t\t\t#  time between reports", options.report));
    }
    lines.push(warning_line(options.reading.no_warnings));
    lines.extend(options.shown.lines());
    lines.push(format!("--seed {:<6}\t\t\t# sample sequence", options.render.seed));
    lines.join("\n") + "\n"
}
