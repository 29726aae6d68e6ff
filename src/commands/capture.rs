//! `radsight capture`: camera and scene in, grey picture out.

mod accounts;
mod derivatives;
mod lamps;
mod notes;
mod resume;
mod series;

use crate::args::Capture;
use crate::commands::sensor::no_mosaic;
use crate::expected_rays;
use crate::failure::{Failure, Outcome, say};
use crate::input::{Planned, band_weights, conclude_all, history, plan, plan_split, read_camera, use_threads};
use crate::output::{reserve_output, write_file, write_image_file};
use crate::progress::Bar;
use crate::run_record::Stopwatch;
use crate::sensor_picture::SensorPicture;
use crate::trust::Existing;
use lamps::FlickeringScenes;
use notes::whole_pattern_reason;
use radsight_camera::CameraFile;
use radsight_capture::{ErrorTarget, Exposer, Exposure, LightByRow};
use radsight_output::interrupt;
use radsight_picture::{Header, Image};
use radsight_pinhole::{PinholeCamera, Rays};
use radsight_render::{RenderOptions, RenderPlan, Renderer};
use resume::{CheckpointFile, Saving};

/// The default of the requested error.
pub(super) const DEFAULT_ERROR: f64 = 0.005;

/// Camera rays of a capture, about.
fn camera_rays(arguments: &Capture, camera: &CameraFile) -> f64 {
    let pixels = camera.camera.pixel_count();
    match arguments.samples {
        Some(samples) => pixels as f64 * f64::from(samples),
        None => expected_rays::to_error(pixels, arguments.error.unwrap_or(DEFAULT_ERROR)),
    }
}

/// Runs the command.
pub(crate) fn run(arguments: &Capture, render: RenderOptions) -> Outcome {
    if let Some(table) = &arguments.variants {
        return series::run(arguments, table, render);
    }
    if !arguments.derivative.is_empty() {
        return derivatives::run(arguments, render);
    }
    let mut stopwatch = Stopwatch::start();
    check_budget(arguments)?;
    use_threads(arguments.threads)?;
    let camera = read_camera(&arguments.camera)?;
    check_sensor(arguments, &camera)?;
    if arguments.color.is_some() && camera.mosaic.is_none() {
        return Err(no_mosaic(&arguments.camera));
    }
    if arguments.specimen.is_some() && camera.alignment.is_none() {
        return Err(no_alignment(&arguments.camera));
    }
    let outputs = [&arguments.output, &arguments.color, &arguments.exposure, &arguments.specimen];
    for path in outputs.into_iter().chain(arguments.accounts.paths()).flatten().filter(|path| *path != "-") {
        reserve_output(&arguments.reading.trust.output(path, Existing::Kept)?)?;
    }
    stopwatch.lap("camera file read");
    let options = RenderOptions { seed: arguments.seed, camera_rays: camera_rays(arguments, &camera), ..render };
    let split = |scene: &mut _| FlickeringScenes::split(scene, &camera, &arguments.camera).map(|scenes| scenes.by_row);
    let (planned, by_row) = match camera.flickering.is_empty() {
        true => (plan(&arguments.scenes, Some(&camera), &arguments.reading, options.clone())?, Vec::new()),
        false => plan_split(&arguments.scenes, Some(&camera), &arguments.reading, &options, split)?,
    };
    check_scene(&planned.plan, &camera, by_row.len())?;
    let checkpoint = CheckpointFile::new(arguments, &camera, &planned, &options)?;
    let rays = Rays::new(&camera.camera, arguments.samples.unwrap_or(1), arguments.seed);
    let Planned { plan, registry, sources, .. } = planned;
    notes::say_each(notes::left_out(&plan).into_iter().chain(notes::of_camera(&plan, &camera.camera)));
    // One of the plans may be grey, with equal values in all bands.
    let bands = by_row.iter().map(|(plan, _)| plan.bands()).fold(plan.bands(), usize::max);
    let weights = band_weights(&arguments.camera, &camera, bands)?;
    let start = checkpoint.read(arguments, &rays, &weights)?;
    let renderer = Renderer::new(plan);
    let by_row: Vec<LightByRow> =
        by_row.into_iter().map(|(plan, brightness)| LightByRow { renderer: Renderer::new(plan), brightness }).collect();
    let bar = Bar::new("capturing");
    stopwatch.lap("scene read, checked and compiled");
    // A signal stops the work; what is done is written then.
    let postponed = interrupt::postpone();
    let exposer = Exposer { renderer: &renderer, rays: &rays, weights: &weights, by_row: &by_row };
    let progress = Saving { bar: &bar, file: &checkpoint };
    let exposure = match arguments.samples {
        Some(_) => exposer.with_samples(start, &progress),
        None => exposer.to_error(ErrorTarget::new(arguments.error.unwrap_or(DEFAULT_ERROR)), start, &progress),
    };
    bar.finish();
    stopwatch.lap("rays traced, exposure");
    let plans = by_row.iter().map(|light| light.renderer.plan());
    conclude_all(std::iter::once(renderer.plan()).chain(plans), registry.as_ref(), &sources, &arguments.reading)?;
    let can_resume = exposure.is_partial && checkpoint.save(&exposure.checkpoint)?;
    let remainder = if can_resume { Remainder::Kept } else { Remainder::Lost };
    say_result(&exposure, arguments, remainder);
    if exposure.pixels_done > 0 {
        let image = exposure_image(&camera.camera, &exposure.values)?;
        let is_wanted = arguments.output.is_some() || arguments.color.is_some() || arguments.accounts.report.is_some();
        let sensor = camera.sensor.as_ref().filter(|_| is_wanted);
        let picture = sensor.map(|sensor| SensorPicture::new(sensor, &image, arguments.seed));
        write(arguments, &camera, &exposure, (&image, picture.as_ref()))?;
        stopwatch.lap("sensor, files written");
        accounts::write(arguments, &camera, &exposure, (&image, picture), || {
            accounts::record(
                &stopwatch,
                &renderer,
                (&options, whole_pattern_reason(&camera.camera)),
                arguments,
                &exposure,
            )
        })?;
    }
    if !exposure.is_partial {
        checkpoint.remove()?;
    }
    postponed.end();
    Ok(())
}

fn check_budget(arguments: &Capture) -> Outcome {
    if arguments.samples == Some(0) {
        return Err(Failure::usage("option \"--samples\" is 0, expected at least 1"));
    }
    match arguments.error {
        Some(error) if !(error.is_finite() && error > 0.0) => Err(Failure::usage(format!(
            "option \"--error\" is {error}, expected a relative error above 0, such as 0.005"
        ))),
        _ => Ok(()),
    }
}

/// Why there is no specimen.
fn no_alignment(camera: &str) -> Failure {
    Failure::input(format!(
        "\"{camera}\" has neither [alignment] nor [tolerances]: there is no specimen to be written\n\
         hint: for example [tolerances] with specimen = 1 and camera_turn_deg = 0.3"
    ))
}

/// Whether there is a sensor, if a grey picture or its Fisher information is wanted.
fn check_sensor(arguments: &Capture, camera: &CameraFile) -> Outcome {
    let expected = match (&arguments.output, &arguments.fisher) {
        (Some(_), _) => "for a grey picture (or only --exposure)",
        (None, Some(_)) => "for --fisher: without noise a picture tells all parameters exactly (or only --derivatives)",
        (None, None) => return Ok(()),
    };
    if camera.sensor.is_some() {
        return Ok(());
    }
    Err(Failure::input(format!("\"{}\" has no [sensor], expected one {expected}", arguments.camera)))
}

/// `flickering` is the number of scenes of lamps that flicker.
fn check_scene(plan: &RenderPlan, camera: &CameraFile, flickering: usize) -> Outcome {
    let leds = camera.rig.as_ref().map_or(0, |rig| rig.leds as usize);
    if plan.surface_count() <= leds {
        return Err(Failure::input("the scene is empty: nothing that a ray could hit"));
    }
    if !plan.has_emitters() && flickering == 0 {
        return Err(Failure::input("the scene has no light: nothing in it emits, and the camera file has no [rig]"));
    }
    Ok(())
}

/// The header's text for an exposure that was stopped.
fn partial(exposure: &Exposure, arguments: &Capture) -> String {
    let (done, total) = (exposure.pixels_done, exposure.values.len());
    let asked = arguments.error.unwrap_or(DEFAULT_ERROR);
    match exposure.estimated_error {
        Some(error) => format!("estimated error {:.3} %, requested {:.3} %", 100.0 * error, 100.0 * asked),
        None => format!("{done} of {total} pixels"),
    }
}

/// Whether an interrupted capture can be resumed.
#[derive(Clone, Copy)]
enum Remainder {
    Kept,
    Lost,
}

fn say_result(exposure: &Exposure, arguments: &Capture, remainder: Remainder) {
    if exposure.is_partial {
        let what = partial(exposure, arguments);
        let how = match remainder {
            Remainder::Kept => "; --resume continues it",
            Remainder::Lost => "",
        };
        return say(&format!("radsight: interrupted: the exposure is partial ({what}){how}\n"));
    }
    notes::say_each(notes::missed(exposure, arguments.error.unwrap_or(DEFAULT_ERROR)));
}

/// How the outputs came to be.
fn header(arguments: &Capture, exposure: &Exposure) -> Header {
    let mut header = history();
    if exposure.is_partial {
        header.push_variable("PARTIAL", &format!(" {}", partial(exposure, arguments)));
    }
    header
}

fn write(
    arguments: &Capture,
    camera: &CameraFile,
    exposure: &Exposure,
    (image, picture): (&Image<f32>, Option<&SensorPicture>),
) -> Outcome {
    let mut header = header(arguments, exposure);
    if let Some(alignment) = &camera.alignment {
        // One line of the header with the content of several lines of the camera file.
        header.push_variable("ALIGNMENT", &format!(" {}", alignment.to_toml().trim_end().replace('\n', "; ")));
    }
    if let (Some(path), Some(alignment)) = (&arguments.specimen, &camera.alignment) {
        write_file(path, alignment.to_toml().as_bytes())?;
    }
    if let Some(path) = &arguments.exposure {
        write_image_file(path, &header, image)?;
    }
    let Some(picture) = picture else { return Ok(()) };
    if let (Some(path), Some(mosaic)) = (&arguments.color, camera.mosaic) {
        write_file(path, &picture.color_png(mosaic, &header)?)?;
    }
    match &arguments.output {
        Some(output) => write_file(output, &picture.grey_png(&header)?),
        None => Ok(()),
    }
}

/// The exposure as it is stored: in single precision.
pub(crate) fn exposure_image(camera: &PinholeCamera, values: &[f64]) -> Result<Image<f32>, Failure> {
    let data = values.iter().map(|value| *value as f32).collect();
    Image::new(camera.columns() as usize, camera.rows() as usize, 1, data)
        .map_err(|error| Failure::fault(error.to_string()))
}
