//! The reports of a capture: error map, ray map, run record, and the page with all of them.

use super::{DEFAULT_ERROR, exposure_image, header, partial};
use crate::args::{Accounts, Capture};
use crate::commands::report::{ERROR_MAP, of_camera};
use crate::failure::{Failure, Outcome};
use crate::input::{read_file, words_of_process};
use crate::output::{write_file, write_image_file};
use crate::run_record::Stopwatch;
use crate::sensor_picture::SensorPicture;
use radsight_camera::CameraFile;
use radsight_capture::{Exposure, PixelStatistics};
use radsight_picture::Image;
use radsight_render::{RenderOptions, Renderer};
use radsight_report::{ErrorEstimate, ErrorMap, Page, Quantity, ReportError, RunRecord};

impl Accounts {
    /// The files that are to be written.
    pub(super) fn paths(&self) -> [&Option<String>; 4] {
        [&self.report, &self.error_map, &self.ray_map, &self.record]
    }
}

/// Writes the requested files; `record` is called only if there are some.
pub(super) fn write(
    arguments: &Capture,
    camera: &CameraFile,
    exposure: &Exposure,
    (image, picture): (&Image<f32>, Option<SensorPicture>),
    record: impl FnOnce() -> RunRecord,
) -> Outcome {
    let accounts = &arguments.accounts;
    let header = header(arguments, exposure);
    if let Some(path) = &accounts.error_map {
        let mut header = header.clone();
        header.push_variable(ERROR_MAP, " absolute");
        write_image_file(path, &header, &error_image(camera, statistics(exposure)?)?)?;
    }
    if let Some(path) = &accounts.ray_map {
        write_image_file(path, &header, &ray_image(camera, statistics(exposure)?)?)?;
    }
    if accounts.record.is_none() && accounts.report.is_none() {
        return Ok(());
    }
    let record = record();
    if let Some(path) = &accounts.record {
        write_file(path, record.to_json().as_bytes())?;
    }
    match &accounts.report {
        Some(path) => {
            let page = page(arguments, camera, exposure, (image, picture))?.record(record);
            write_file(path, page.to_html().as_bytes())
        }
        None => Ok(()),
    }
}

fn statistics(exposure: &Exposure) -> Result<&PixelStatistics, Failure> {
    let stopped = "the work was stopped before the error of pixels was known: no error map, no ray map";
    exposure.pixels.as_ref().ok_or_else(|| Failure::fault(stopped))
}

fn error_image(camera: &CameraFile, statistics: &PixelStatistics) -> Result<Image<f32>, Failure> {
    exposure_image(&camera.camera, &statistics.standard_errors)
}

fn ray_image(camera: &CameraFile, statistics: &PixelStatistics) -> Result<Image<f32>, Failure> {
    let samples: Vec<f64> = statistics.samples.iter().map(|samples| f64::from(*samples)).collect();
    exposure_image(&camera.camera, &samples)
}

/// How the capture went.
pub(super) fn record(
    stopwatch: &Stopwatch,
    renderer: &Renderer,
    (options, camera_note): (&RenderOptions, Option<String>),
    arguments: &Capture,
    exposure: &Exposure,
) -> RunRecord {
    let mut record = stopwatch.record(renderer.plan(), &words_of_process());
    let asked = arguments.samples.is_none().then(|| arguments.error.unwrap_or(DEFAULT_ERROR));
    record.error = exposure.estimated_error.map(|reached| ErrorEstimate { asked, reached, uncertainty: None });
    record.rays = Some(exposure.rays);
    if exposure.is_partial {
        record.notes.push(format!("the exposure is partial: {}", partial(exposure, arguments)));
    }
    if renderer.plan().leaves_out_interreflection() {
        record.notes.push("light between diffuse surfaces is left out (-ab 0)".to_owned());
    }
    record.notes.extend(camera_note);
    record.push_setting("camera file", &arguments.camera);
    record.push_setting("scene", arguments.scenes.join(" "));
    match (arguments.samples, asked) {
        (Some(samples), _) => record.push_setting("rays a pixel", samples.to_string()),
        (None, asked) => record.push_setting("requested error", asked.unwrap_or(DEFAULT_ERROR).to_string()),
    }
    record.push_setting("seed", arguments.seed.to_string());
    record.push_setting("threads", rayon::current_num_threads().to_string());
    record.push_setting("diffuse interreflections (-ab)", options.ambient_bounces.to_string());
    record.push_setting("mirror reflections of a light (-dr)", options.mirror_sources.to_string());
    record
}

fn page(
    arguments: &Capture,
    camera: &CameraFile,
    exposure: &Exposure,
    (image, picture): (&Image<f32>, Option<SensorPicture>),
) -> Result<Page, Failure> {
    let failed = |error: ReportError| Failure::fault(format!("no report: {error}"));
    let named = arguments.output.as_ref().or(arguments.exposure.as_ref()).filter(|name| *name != "-");
    let mut page = Page::new(named.unwrap_or(&arguments.camera), image.clone(), Quantity::Exposure).map_err(failed)?;
    let text = read_file(&arguments.camera, "camera file")?;
    page = of_camera(page, camera, &arguments.camera, &text).map_err(failed)?;
    if let Some(statistics) = &exposure.pixels {
        page = page.error_map(ErrorMap::Absolute(error_image(camera, statistics)?)).map_err(failed)?;
        page = page.ray_map(ray_image(camera, statistics)?).map_err(failed)?;
    }
    if let Some(picture) = picture {
        page = page.grey_picture(picture.into_greys()?).map_err(failed)?;
    }
    Ok(page.text("Header", header(arguments, exposure).to_text()))
}
