//! `radsight rig`: the light ring as scene text.

use crate::args::Rig;
use crate::failure::{Failure, Outcome};
use crate::input::read_camera;
use crate::output::write_standard_output;

/// Runs the command.
pub(crate) fn run(arguments: &Rig) -> Outcome {
    let file = read_camera(&arguments.camera)?;
    let rig = file.rig.ok_or_else(|| Failure::input(format!("\"{}\" has no [rig]", arguments.camera)))?;
    write_standard_output(rig.scene_text().as_bytes())
}
