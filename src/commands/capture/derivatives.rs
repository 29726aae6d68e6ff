//! `radsight capture --derivative`: the exposure's derivatives and the Fisher information.

use super::exposure_image;
use super::notes;
use super::series::{FileScenes, configured, with_ring};
use crate::args::Capture;
use crate::disk::{Commands, DiskLoader};
use crate::failure::{Failure, Outcome, say};
use crate::input::{Planner, history, read_file, scene_inputs, use_threads, valid_scene};
use crate::output::{reserve_output, write_file, write_image_file};
use crate::progress::Bar;
use crate::sensor_picture::SensorPicture;
use crate::trust::Existing;
use radsight::{ExposureDerivatives, FisherInformation, Parameter, ParameterDerivative, expose_derivatives};
use radsight_camera::CameraFile;
use radsight_capture::Progress;
use radsight_output::interrupt;
use radsight_render::RenderOptions;

/// Stands for a parameter in the names of files.
const NAME: &str = "{}";

/// Ends the name of a file with standard errors.
const ERRORS: &str = ".error";

/// Exposes a capture and differentiates it.
pub(super) fn run(arguments: &Capture, render: RenderOptions) -> Outcome {
    let parameters = parameters(arguments)?;
    use_threads(arguments.threads)?;
    for output in outputs(arguments, &parameters) {
        reserve_output(&arguments.reading.trust.output(&output, Existing::Kept)?)?;
    }
    let options = RenderOptions { seed: arguments.seed, ..render };
    let text = read_file(&arguments.camera, "camera file")?;
    let loader = DiskLoader::new(Commands::Refused);
    let capture = radsight::Capture::from_text(&arguments.camera, &text, &loader)?;
    let capture = configured(arguments, capture, &options);
    let file = capture.camera_file();
    super::check_sensor(arguments, file)?;
    let inputs = scene_inputs(&arguments.scenes, None, &arguments.reading.trust)?;
    let (scene, sources) = valid_scene(with_ring(&inputs, file), &arguments.reading, |_| Ok(()))?;
    let planner = Planner::new(&scene, &arguments.scenes, &arguments.reading, &sources)?;
    let scenes = FileScenes::new(inputs, &arguments.reading, planner, &sources).with_notes_on(&file.camera);
    let bar = Bar::new("differentiating");
    let postponed = interrupt::postpone();
    let exposed = expose_derivatives(&scenes, &capture, &parameters, arguments.derivative_error, &Stops(&bar));
    bar.finish();
    postponed.end();
    match exposed? {
        Some(exposed) => {
            let asked = arguments.error.unwrap_or(super::DEFAULT_ERROR);
            notes::say_each(notes::missed(&exposed.exposure, asked));
            write(arguments, file, &exposed)
        }
        None => {
            say("radsight: stopped: no derivative is written\n");
            Ok(())
        }
    }
}

/// Shows progress; a signal stops the work.
struct Stops<'b>(&'b Bar);

impl Progress for Stops<'_> {
    fn report(&self, done: u64, total: u64) {
        self.0.report(done, total);
    }

    fn stops(&self) -> bool {
        interrupt::is_asked()
    }
}

fn parameters(arguments: &Capture) -> Result<Vec<Parameter>, Failure> {
    super::check_budget(arguments)?;
    let accounts = arguments.accounts.paths().into_iter().flatten().next();
    if arguments.color.is_some() || arguments.specimen.is_some() || accounts.is_some() || arguments.resume {
        let message = "option \"--derivative\" goes with -o, --exposure, --derivatives and --fisher only";
        return Err(Failure::usage(message));
    }
    if arguments.derivatives.is_none() && arguments.fisher.is_none() {
        let message = "option \"--derivative\" writes nothing alone: it goes with --derivatives or --fisher\n\
                       hint: for example --derivatives \"derivative-{}.pfm\"";
        return Err(Failure::usage(message));
    }
    if let Some(output) = arguments.derivatives.as_ref().filter(|output| !output.contains(NAME)) {
        return Err(Failure::usage(format!(
            "\"{output}\" names one file for all derivatives, expected {NAME} in it for the parameter\n\
             hint: for example \"derivative-{NAME}.pfm\""
        )));
    }
    let read = |name: &String| name.parse::<Parameter>().map_err(|error| Failure::usage(error.to_string()));
    let parameters: Vec<Parameter> = arguments.derivative.iter().map(read).collect::<Result<_, _>>()?;
    let twice = (1..parameters.len())
        .find(|&index| parameters[..index].iter().any(|before| file_name(before) == file_name(&parameters[index])));
    match twice {
        Some(index) => Err(Failure::usage(format!("parameter \"{}\" is given twice", parameters[index]))),
        None => Ok(parameters),
    }
}

/// A parameter's name as part of a file's name: letters, digits, `.`, `_` and `-` of it.
fn file_name(parameter: &Parameter) -> String {
    parameter.name().chars().filter(|letter| letter.is_alphanumeric() || "._-".contains(*letter)).collect()
}

/// The files to be written.
fn outputs(arguments: &Capture, parameters: &[Parameter]) -> Vec<String> {
    let single = [&arguments.output, &arguments.exposure, &arguments.fisher].into_iter().flatten().cloned();
    let of_parameters = parameters.iter().filter_map(|parameter| {
        let pattern = arguments.derivatives.as_ref()?;
        let name = file_name(parameter);
        Some([pattern.replace(NAME, &name), pattern.replace(NAME, &format!("{name}{ERRORS}"))])
    });
    single.chain(of_parameters.flatten()).collect()
}

fn write(arguments: &Capture, file: &CameraFile, exposed: &ExposureDerivatives) -> Outcome {
    let image = exposure_image(&file.camera, &exposed.exposure.values)?;
    if let Some(path) = &arguments.exposure {
        write_image_file(path, &history(), &image)?;
    }
    if let (Some(path), Some(sensor)) = (&arguments.output, &file.sensor) {
        let picture = SensorPicture::new(sensor, &image, arguments.seed);
        write_file(path, &picture.grey_png(&history())?)?;
    }
    for by in &exposed.derivatives {
        say(&summary(by));
        if let Some(pattern) = &arguments.derivatives {
            write_derivative(pattern, file, by)?;
        }
    }
    match &arguments.fisher {
        Some(path) => {
            let information = FisherInformation::new(exposed, file.sensor.as_ref())?;
            write_file(path, information.to_json().as_bytes())
        }
        None => Ok(()),
    }
}

fn write_derivative(pattern: &str, file: &CameraFile, by: &ParameterDerivative) -> Outcome {
    let (name, unit) = (file_name(&by.parameter), by.parameter.unit());
    let mut header = history();
    header.push_variable("DERIVATIVE", &format!(" {} J/m2 per {unit}, step {:e} {unit}", by.parameter, by.step));
    let values = exposure_image(&file.camera, &by.derivative.values)?;
    write_image_file(&pattern.replace(NAME, &name), &header, &values)?;
    header.push_variable("STANDARD_ERROR", &format!(" {:.3e} relative to the rms", by.derivative.relative_error));
    let errors = exposure_image(&file.camera, &by.derivative.standard_errors)?;
    write_image_file(&pattern.replace(NAME, &format!("{name}{ERRORS}")), &header, &errors)
}

fn summary(by: &ParameterDerivative) -> String {
    let derivative = &by.derivative;
    format!(
        "radsight: {}: error {:.2} % of the rms, {:.2} % by the step of {:.3e} {}; {} rays\n",
        by.parameter,
        100.0 * derivative.relative_error,
        100.0 * derivative.step_error,
        by.step,
        by.parameter.unit(),
        derivative.rays
    )
}
