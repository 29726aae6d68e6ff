//! Lines of `-defaults` that depend on more than the words of an option.

use crate::output_format::OutputFormat;
use radsight_options::Settings;
use radsight_pinhole::stream::NumberFormat;

/// The options that select the components of values.
const COMPONENTS: [&str; 7] = ["-pRGB", "-pXYZ", "-pY", "-pS", "-pM", "-pA", "-pc"];

/// The components of values (`-p…`).
pub(crate) fn color_line(settings: &Settings) -> String {
    let (word, values) = settings.latest(&COMPONENTS).unwrap_or(("-pRGB", &[]));
    let what = match word {
        "-pXYZ" => "CIE XYZ color output",
        "-pY" => "photopic output",
        "-pS" => "scotopic output",
        "-pM" => "melanopic output",
        "-pA" => "average output",
        "-pc" => {
            let numbers = values.iter().filter_map(|word| word.parse().ok());
            let numbers: Vec<String> = numbers.map(|number: f64| format!(" {number:.4}")).collect();
            return format!("-pc{}\t# output color primaries and white point", numbers.concat());
        }
        _ => "standard RGB color output",
    };
    format!("{word}\t\t\t\t# {what}")
}

/// The number of threads (`-n`); by default that of the machine.
pub(crate) fn process_line(threads: Option<usize>) -> String {
    format!("-n {:<2}\t\t\t\t# number of rendering processes", threads.unwrap_or_else(rayon::current_num_threads))
}

/// Columns or rows of the output (`-x`, `-y`).
pub(crate) fn size_line(name: &str, [columns, rows]: [u64; 2]) -> String {
    match name {
        "-y" => format!("-y {rows:<9}\t\t\t# y resolution"),
        _ if columns > 0 && rows > 0 => format!("-x {columns:<9}\t\t\t# x resolution"),
        _ => format!("-x {columns:<9}\t\t\t# flush interval"),
    }
}

/// The formats of input and output (`-f`).
pub(crate) fn format_line(input: NumberFormat, output: OutputFormat) -> String {
    let [input, output] = [OutputFormat::Numbers(input), output].map(|format| format.name("32-bit_rle_rgbe"));
    let letter = |name: &str| if name.starts_with('3') { 'c' } else { name.chars().next().unwrap_or('a') };
    format!("-f{}{}\t\t\t\t# format input/output = {input}/{output}", letter(input), letter(output))
}

/// The seed of the sample sequence, which Radiance does not have.
pub(crate) fn seed_line(seed: u64) -> String {
    format!("--seed {seed:<6}\t\t\t# sample sequence")
}
