//! `radsight explain`: what a capture computes, and what it skips and why.

use crate::args::Explain;
use crate::failure::Outcome;
use crate::input::{plan, read_camera};
use crate::output::write_standard_output;
use radsight_render::RenderOptions;

/// Runs the command.
pub(crate) fn run(arguments: &Explain, render: RenderOptions) -> Outcome {
    let camera = read_camera(&arguments.camera)?;
    let plan = plan(&arguments.scenes, Some(&camera), &arguments.reading, render)?.plan;
    let mut text = String::new();
    for decision in plan.decisions() {
        text.push_str(&format!("{}: {}\n", decision.what, decision.why));
    }
    write_standard_output(text.as_bytes())
}
