//! `radsight sensor`: exposure on standard input, grey PNG on standard output.

use crate::args::Sensor;
use crate::commands::capture::grey_png;
use crate::failure::{Failure, Outcome};
use crate::input::{history, read_camera, read_standard_input};
use crate::output::write_standard_output;
use radsight_picture::read_image;

/// Runs the command.
pub(crate) fn run(arguments: &Sensor) -> Outcome {
    let file = read_camera(&arguments.camera)?;
    let sensor = file.sensor.ok_or_else(|| Failure::input(format!("\"{}\" has no [sensor]", arguments.camera)))?;
    let read = read_image(&read_standard_input()?)
        .map_err(|error| Failure::input(format!("standard input is no exposure: {error}")))?;
    if read.image.components() != 1 {
        let found = read.image.components();
        return Err(Failure::input(format!("the exposure has {found} components, expected 1 (J/m²)")));
    }
    if let Some(bad) = read.image.data().iter().find(|value| !(value.is_finite() && **value >= 0.0)) {
        return Err(Failure::input(format!("the exposure has the value {bad}, expected finite ones from 0 on (J/m²)")));
    }
    let mut header = read.header.map(|header| header.history()).unwrap_or_default();
    let own = history();
    own.lines().for_each(|line| header.push_line(&String::from_utf8_lossy(line)));
    write_standard_output(&grey_png(&sensor, &read.image, arguments.seed, &header)?)
}
