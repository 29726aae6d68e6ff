//! The subcommands, a file each.

mod calibrate;
mod capture;
mod check;
mod explain;
mod install_links;
mod pinhole;
mod plugin;
mod rig;
mod rtrace;
mod sensor;

use crate::args::{Command, Program};
use crate::failure::Outcome;
use radsight_render::RenderOptions;

/// A program of Radiance's.
type RadianceProgram = fn(&[String]) -> Outcome;

/// The programs that radsight can stand in for, by name.
pub(crate) const RADIANCE_PROGRAMS: [(&str, RadianceProgram); 1] = [("rtrace", rtrace::run)];

/// The stand-in for a program of Radiance's.
pub(crate) fn radiance_program(name: &str) -> Option<RadianceProgram> {
    RADIANCE_PROGRAMS.iter().find(|(known, _)| *known == name).map(|(_, program)| *program)
}

/// Runs a subcommand.
pub(crate) fn run(program: Program, render: RenderOptions) -> Outcome {
    match program.command {
        Command::Capture(arguments) => capture::run(&arguments, render),
        Command::Check(arguments) => check::run(&arguments),
        Command::Explain(arguments) => explain::run(&arguments, render),
        Command::Pinhole(arguments) => pinhole::run(&arguments),
        Command::Sensor(arguments) => sensor::run(&arguments),
        Command::Rig(arguments) => rig::run(&arguments),
        Command::Calibrate(arguments) => calibrate::run(&arguments),
        Command::Plugin(arguments) => plugin::run(&arguments),
        Command::InstallLinks(arguments) => install_links::run(&arguments),
    }
}
