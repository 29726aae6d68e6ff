//! `radsight sensor`: exposure on standard input, grey PNG on standard output; or the sensor's
//! characterisation.

use crate::args::Sensor;
use crate::failure::{Failure, Outcome, say};
use crate::input::{history, read_camera, read_standard_input};
use crate::output::{reserve_output, write_file, write_standard_output};
use crate::sensor_picture::SensorPicture;
use crate::trust::{Existing, Trust};
use radsight_camera::CameraFile;
use radsight_picture::read_image;
use radsight_sensor::characterise::{Series, evaluate, html, measure, table};
use radsight_sensor::{EvenLight, Sensor as SensorModel};

/// Largest side of the measured area, pixels: a part of a large sensor suffices.
const MOST_PIXELS_A_SIDE: u32 = 256;

/// Runs the command.
pub(crate) fn run(arguments: &Sensor, trust: &Trust) -> Outcome {
    for path in [&arguments.report, &arguments.color].into_iter().flatten() {
        reserve_output(&trust.output(path, Existing::Kept)?)?;
    }
    let file = read_camera(&arguments.camera)?;
    if arguments.characterise {
        return characterise(arguments, &file);
    }
    let sensor = file.sensor.ok_or_else(|| Failure::input(format!("\"{}\" has no [sensor]", arguments.camera)))?;
    let read = read_image(&read_standard_input()?)
        .map_err(|error| Failure::input(format!("standard input is not an exposure: {error}")))?;
    if read.image.components() != 1 {
        let found = read.image.components();
        return Err(Failure::input(format!("the exposure has {found} components, expected 1 (J/m²)")));
    }
    SensorModel::check_exposures(read.image.data().iter().copied())
        .map_err(|error| Failure::input(error.to_string()))?;
    let mut header = read.header.map(|header| header.history()).unwrap_or_default();
    let own = history();
    own.lines().for_each(|line| header.push_line(&String::from_utf8_lossy(line)));
    let picture = SensorPicture::new(&sensor, &read.image, arguments.seed);
    if let Some(path) = &arguments.color {
        let mosaic = file.mosaic.ok_or_else(|| no_mosaic(&arguments.camera))?;
        write_file(path, &picture.color_png(mosaic, &header)?)?;
    }
    write_standard_output(&picture.grey_png(&header)?)
}

/// The error of a colour picture without a mosaic.
pub(crate) fn no_mosaic(camera: &str) -> Failure {
    Failure::input(format!("\"{camera}\" has no colour filter mosaic\nhint: for example mosaic = \"RGGB\" in [sensor]"))
}

fn characterise(arguments: &Sensor, file: &CameraFile) -> Outcome {
    let name = &arguments.camera;
    let sensor = match &file.sensor {
        Some(SensorModel::Emva1288(sensor)) => *sensor,
        Some(_) => {
            let message = format!("\"{name}\" has no sensor with photon noise, which the measurement needs");
            return Err(Failure::input(format!(
                "{message}\nhint: response = \"emva1288\"; calibrate fits a power law"
            )));
        }
        None => return Err(Failure::input(format!("\"{name}\" has no [sensor]"))),
    };
    let pixels = [file.camera.columns(), file.camera.rows()].map(|count| count.min(MOST_PIXELS_A_SIDE));
    let sensor = sensor.with_columns(pixels[0]);
    let asked = Series { steps: arguments.steps, stack: arguments.stack };
    let failed =
        |error: radsight_sensor::characterise::CharacterisationError| Failure::input(format!("\"{name}\": {error}"));
    let series = measure(&EvenLight::new(sensor, pixels), &asked, arguments.seed).map_err(failed)?;
    let found = evaluate(&series).map_err(failed)?;
    if found.is_cut_in_the_dark() {
        say(&format!(
            "radsight: warning: {:.1} % of the grey values in the dark are 0, EMVA 1288 allows 0.5 %: dark noise, gain and quantum \
             efficiency come out wrong\nhint: a larger dark_offset_dn\n",
            100.0 * found.dark_at_zero
        ));
    }
    if let Some(path) = &arguments.report {
        write_file(path, html(name, &series, &found).as_bytes())?;
    }
    write_standard_output(table(&found).as_bytes())
}
