//! Command lines that come from a file: lists of options, and the gate of trust before them.
//!
//! All of the program is here but its `main`, so that its options are read by what reads them.
#![no_main]
#![allow(dead_code, clippy::all)]

#[path = "../../src/ambient_file.rs"]
mod ambient_file;
#[path = "../../src/args.rs"]
mod args;
#[path = "../../src/budget.rs"]
mod budget;
#[path = "../../src/clock.rs"]
mod clock;
#[path = "../../src/commands/mod.rs"]
mod commands;
#[path = "../../src/control_file.rs"]
mod control_file;
#[path = "../../src/disk.rs"]
mod disk;
#[path = "../../src/effort_args.rs"]
mod effort_args;
#[path = "../../src/expand.rs"]
mod expand;
#[path = "../../src/failure.rs"]
mod failure;
#[path = "../../src/file_pattern.rs"]
mod file_pattern;
#[path = "../../src/input.rs"]
mod input;
#[path = "../../src/listed_options.rs"]
mod listed_options;
#[path = "../../src/option_table.rs"]
mod option_table;
#[path = "../../src/output.rs"]
mod output;
#[path = "../../src/output_color.rs"]
mod output_color;
#[path = "../../src/output_format.rs"]
mod output_format;
#[path = "../../src/plugin_guard.rs"]
mod plugin_guard;
#[path = "../../src/plugins.rs"]
mod plugins;
#[path = "../../src/progress.rs"]
mod progress;
#[path = "../../src/ray_input.rs"]
mod ray_input;
#[path = "../../src/read_once.rs"]
mod read_once;
#[path = "../../src/render_args.rs"]
mod render_args;
#[path = "../../src/run_record.rs"]
mod run_record;
#[path = "../../src/sensor_picture.rs"]
mod sensor_picture;
#[path = "../../src/switch.rs"]
mod switch;
#[path = "../../src/trust/mod.rs"]
mod trust;
#[path = "../../src/view_args.rs"]
mod view_args;

use trust::{Commands, Existing, Trust, WORDS_OF_FILE};

/// Programs that stop at the first mistake before they do anything; here each ends in one.
const PROGRAMS: [&str; 5] = ["rpict", "rtrace", "rcontrib", "rfluxmtx", "mkillum"];

/// Options that name what is written at once, or read as long as somebody writes.
const LEFT_OUT: [&str; 7] = ["-P", "-PP", "-e", "-S", "-", "-vf", "-af"];

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let text = String::from_utf8_lossy(bytes);
    let words: Vec<String> = text.split_whitespace().map(str::to_owned).collect();
    gate(&words);
    let Some(first) = bytes.first() else { return };
    if words.iter().any(|word| LEFT_OUT.contains(&word.as_str()) || word.starts_with('@') || word.contains('/')) {
        return;
    }
    let program = PROGRAMS[usize::from(*first) % PROGRAMS.len()];
    let lead = ["radsight", WORDS_OF_FILE, program].map(str::to_owned);
    // No scene has this name.
    let all = lead.into_iter().chain(words).chain(["no scene/at all".to_owned()]).collect();
    let Ok((trust, words)) = Trust::of_process(all) else { return };
    let _ = commands::run_radiance_program(&words[1..], &trust);
    assert!(trust.own_commands() == Commands::Refused && !trust.allows_plugins_of_scenes());
});

/// Nothing that a file says lets it run commands, load libraries, or write where it likes.
fn gate(words: &[String]) {
    let of_file: Vec<String> =
        ["radsight", WORDS_OF_FILE].iter().map(|word| (*word).to_owned()).chain(words.iter().cloned()).collect();
    let Ok((mut trust, mut rest)) = Trust::of_process(of_file) else { return };
    rest.remove(0);
    while !rest.is_empty() {
        let used = trust.take(&rest).unwrap_or(1).max(1);
        rest.drain(..used.min(rest.len()));
    }
    assert!(trust.own_commands() == Commands::Refused && trust.commands() == Commands::Refused);
    assert!(!trust.may_load_beside_scenes() && trust.plugin_folders().is_empty());
    for word in words {
        if let Ok(name) = trust.output(word, Existing::Kept) {
            let name = &*name;
            assert!(!name.starts_with(['/', '-', '!']), "{name}");
            assert!(!name.split('/').any(|part| part.starts_with('.') && part != "."), "{name}");
        }
    }
}
