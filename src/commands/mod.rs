//! The subcommands, one file each.

mod calibrate;
mod capture;
mod check;
mod explain;
mod features;
mod genskyvec;
mod install_links;
pub(crate) mod job;
mod matrix;
mod missing;
mod mkillum;
pub(crate) mod mksource;
mod obj2mesh;
pub(crate) mod oconv;
mod picture;
mod pinhole;
mod plugin;
mod rad;
mod rcontrib;
pub(crate) mod report;
pub(crate) mod retro;
mod rfluxmtx;
mod rig;
mod rpict;
mod rsplit;
mod rtrace;
mod scene_program;
mod sensor;
mod target;
mod vwrays;
mod words;

use crate::args::{Command, Program};
use crate::failure::{Failure, Outcome};
use crate::trust::{Origin, Trust};
use radsight_options::help;
use radsight_render::RenderOptions;

/// Runs a program of Radiance's if radsight provides it, or prints an alternative; `words[0]` is
/// its name.
pub(crate) fn run_radiance_program(words: &[String], trust: &Trust) -> Option<Outcome> {
    let name = words.first()?.as_str();
    if let (Some(program), Some("--help")) = (radsight_options::program(name), words.get(1).map(String::as_str)) {
        return Some(Err(Failure::answer(help(program))));
    }
    if let Some(outcome) = features::answer(words) {
        return Some(outcome);
    }
    match name {
        "genskyvec" => return Some(genskyvec::run(words, trust)),
        "mkillum" => return Some(mkillum::run(words, trust)),
        "mksource" => return Some(mksource::run(words, trust)),
        "obj2mesh" => return Some(obj2mesh::run(words, trust)),
        "oconv" => return Some(oconv::run(words, trust)),
        "rad" => return Some(rad::run(&words[1..], trust)),
        "rcontrib" => return Some(rcontrib::run(words, trust)),
        "rfluxmtx" => return Some(rfluxmtx::run(words, trust)),
        "rpict" => return Some(rpict::run(words, trust)),
        "rsplit" => return Some(rsplit::run(words, trust)),
        "rtrace" => return Some(rtrace::run(words, trust)),
        "vwrays" => return Some(vwrays::run(&words[1..])),
        _ => {}
    }
    if let Some(outcome) = picture::run(words, trust).or_else(|| matrix::run(words, trust)) {
        return Some(outcome);
    }
    if scene_program::names().any(|known| known == name) {
        return Some(scene_program::run(words, trust));
    }
    missing::refused(name).map(Err)
}

/// Runs a subcommand.
pub(crate) fn run(program: Program, render: RenderOptions, trust: &Trust) -> Outcome {
    match program.command {
        Command::Capture(mut arguments) => {
            arguments.reading.entrust(trust)?;
            capture::run(&arguments, render)
        }
        Command::Check(mut arguments) => {
            arguments.reading.entrust(trust)?;
            check::run(&arguments)
        }
        Command::Explain(mut arguments) => {
            arguments.reading.entrust(trust)?;
            explain::run(&arguments, render)
        }
        Command::Pinhole(arguments) => pinhole::run(&arguments),
        Command::Sensor(arguments) => sensor::run(&arguments, trust),
        Command::Report(arguments) => report::run(&arguments, trust),
        Command::Job(command) => job::run(&command, trust),
        Command::Rig(arguments) => rig::run(&arguments),
        Command::Target(arguments) => target::run(&arguments),
        Command::Retro(command) => retro::run(&command),
        Command::Calibrate(arguments) => calibrate::run(&arguments, trust),
        Command::Plugin(_) | Command::InstallLinks(_) if trust.origin() == Origin::File => Err(Failure::input(
            "plugin and install-links cannot be called from a file\nhint: call them on the command line",
        )),
        Command::Plugin(arguments) => plugin::run(&arguments),
        Command::InstallLinks(arguments) => install_links::run(&arguments),
    }
}
