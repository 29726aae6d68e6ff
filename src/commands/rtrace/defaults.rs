//! The output of `rtrace -defaults`.

use super::options::Options;
use crate::listed_options::{color_line, format_line, process_line, seed_line, size_line};
use crate::output_color::OutputColor;

/// The current options, one per line, as Radiance prints them, followed by radsight's own.
pub(super) fn text(options: &Options) -> String {
    let lines = options.settings.lines(&|option| match option.name {
        "-n" => Some(process_line(options.threads)),
        "-x" | "-y" => Some(size_line(option.name, options.size)),
        "-f" => Some(format_line(options.input_format, options.output_format)),
        "-o" => {
            let names: Vec<&str> = options.letters.chars().map(name_of).collect();
            Some(format!("-o{:<9}\t\t\t# output{}", options.letters, names.concat()))
        }
        "-pRGB" => (options.color != OutputColor::Bands).then(|| color_line(&options.settings)),
        "-co" => spectral_line(options),
        "--seed" => Some(seed_line(options.render.seed)),
        _ => None,
    });
    lines.join("\n") + "\n"
}

fn spectral_line(options: &Options) -> Option<String> {
    let components = options.components();
    match components {
        4.. => Some("-co+\t\t\t\t# output spectral values".to_owned()),
        3 if options.render.sampling.bands() > 3 => Some("-co-\t\t\t\t# output tristimulus colors".to_owned()),
        _ => None,
    }
}

/// The name of a letter of `-o`.
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
