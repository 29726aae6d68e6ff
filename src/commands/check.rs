//! `radsight check`: reports every mistake of a scene.

use crate::args::Check;
use crate::failure::{Failure, Outcome, render, say};
use crate::input::{Planner, read, scene_inputs};
use crate::output::write_standard_output;
use crate::plugins::report_faults;
use radsight_diag::{Diagnostic, Severity};
use radsight_parse::{Read, ReadOptions, Tolerance, UnusedModifiers};

/// Runs the command.
pub(crate) fn run(arguments: &Check) -> Outcome {
    let commands = arguments.reading.commands();
    let options = ReadOptions {
        unused: UnusedModifiers::Lower,
        tolerance: Tolerance::Strict,
        ..arguments.reading.read_options()?
    };
    let Read { scene, sources, mut diagnostics, .. } =
        read(scene_inputs(&arguments.scenes, None, &arguments.reading.trust)?, commands, &options);
    let surfaces = scene.surfaces.len();
    let modifiers = scene.modifiers.len();
    match scene.validate() {
        Ok(valid) => {
            let planner = Planner::new(&valid.scene, &arguments.scenes, &arguments.reading, &sources)?;
            diagnostics.extend(valid.warnings.into_iter().chain(planner.check_materials(&valid.scene)));
            report_faults(planner.registry());
        }
        Err(errors) => diagnostics.extend(errors),
    }
    let fails = |found: &Diagnostic| match found.severity {
        Severity::Error => true,
        Severity::Warning => arguments.reading.strict,
        Severity::Note => false,
    };
    if diagnostics.iter().any(fails) {
        return Err(Failure::diagnostics(&diagnostics, &sources));
    }
    say(&render(&diagnostics, &sources));
    write_standard_output(format!("{surfaces} surfaces, {modifiers} modifiers: no error\n").as_bytes())
}
