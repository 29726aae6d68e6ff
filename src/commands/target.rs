//! `radsight target`: calibration targets as scene text.

use crate::args::{Target, TargetKind};
use crate::failure::{Failure, Outcome};
use crate::output::write_standard_output;
use radsight_scene_generators::{CalibrationTarget, TargetPattern};

/// Runs the command.
pub(crate) fn run(arguments: &Target) -> Outcome {
    let target = CalibrationTarget {
        pattern: match arguments.kind {
            TargetKind::Chessboard => TargetPattern::Chessboard,
            TargetKind::Dots => TargetPattern::Dots,
        },
        columns: arguments.columns,
        rows: arguments.rows,
        spacing: arguments.spacing,
        radiance: arguments.radiance,
    };
    let text = target.scene_text().map_err(|error| Failure::usage(format!("target: {error}")))?;
    write_standard_output(text.as_bytes())
}
