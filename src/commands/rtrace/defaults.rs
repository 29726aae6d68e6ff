//! What `rtrace -defaults` prints.

use super::options::Options;
use crate::output_color::OutputColor;
use crate::shown_options::{format_line, process_line, size_lines, warning_line};
use radsight_render::Quantity;

/// The options as they stand, a line each, as Radiance prints them, and after them our own.
pub(super) fn text(options: &Options) -> String {
    let mut lines = vec![warning_line(options.reading.no_warnings)];
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
    let names: Vec<&str> = options.letters.chars().map(name_of).collect();
    lines.push(format!("-o{:<9}\t\t\t# output{}", options.letters, names.concat()));
    let has_bands = options.color == OutputColor::Bands;
    if !has_bands {
        lines.push(options.shown.color_line());
    }
    if options.components() > 3 {
        lines.push("-co+\t\t\t\t# output spectral values".to_owned());
    } else if options.render.sampling.bands() > 3 && options.components() == 3 {
        lines.push("-co-\t\t\t\t# output tristimulus colors".to_owned());
    }
    lines.extend(options.shown.lines());
    lines.push(format!("--seed {:<6}\t\t\t# sample sequence", options.render.seed));
    lines.join("\n") + "\n"
}

/// What a letter of `-o` is called.
fn name_of(letter: char) -> &'static str {
    match letter {
        't' | 'T' => " trace",
        'o' => " origin",
        'd' => " direction",
        'r' => " reflect_contrib",
        'R' => " reflect_length",
        'x' => " unreflect_contrib",
        'X' => " unreflect_length",
        'v' => " value",
        'V' => " contribution",
        'l' => " length",
        'L' => " first_length",
        'p' => " point",
        'n' => " normal",
        'N' => " unperturbed_normal",
        's' => " surface",
        'w' => " weight",
        'W' => " coefficient",
        'm' => " modifier",
        'M' => " material",
        '~' => " tilde",
        _ => "",
    }
}
