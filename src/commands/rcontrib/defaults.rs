//! The output of `rcontrib -defaults`.

use super::options::Options;
use crate::listed_options::{format_line, process_line, seed_line, size_line};

/// The current options, one per line, as Radiance prints them, followed by radsight's own.
pub(super) fn text(options: &Options) -> String {
    let lines = options.settings.lines(&|option| match option.name {
        "-c" => Some(format!("-c {:<5}\t\t\t# accumulated rays per record", options.accumulate)),
        "-n" => Some(process_line(options.threads)),
        "-x" | "-y" => Some(size_line(option.name, options.size)),
        "-f" => Some(format_line(options.input_format, options.output_format)),
        "-t" if options.report > 0 => Some(format!("-t {:<9}\t\t\t#  time between reports", options.report)),
        "--seed" => Some(seed_line(options.render.seed)),
        _ => None,
    });
    lines.join("\n") + "\n"
}
