//! `radsight explain`: prints what a capture computes, and what it skips and why.

use crate::args::Explain;
use crate::commands::capture::DEFAULT_ERROR;
use crate::expected_rays;
use crate::failure::{Failure, Outcome};
use crate::input::{band_weights, plan, read_camera, use_default_threads};
use crate::output::write_standard_output;
use radsight_camera::CameraFile;
use radsight_capture::{Exposer, Silent};
use radsight_pinhole::Rays;
use radsight_render::{RenderOptions, Renderer, Skip};
use std::time::{Duration, Instant};

/// Number of rays per pixel for the measurement.
const MEASURED_SAMPLES: u32 = 4;

/// Number of alternating measurements of each variant; the smallest time is used, since it is least
/// disturbed by other processes.
const TURNS: u32 = 5;

/// Runs the command.
pub(crate) fn run(arguments: &Explain, render: RenderOptions) -> Outcome {
    use_default_threads()?;
    let camera = read_camera(&arguments.camera)?;
    let camera_rays = expected_rays::to_error(camera.camera.pixel_count(), DEFAULT_ERROR);
    let render = RenderOptions { camera_rays, ..render };
    let planned = plan(&arguments.scenes, Some(&camera), &arguments.reading, render.clone())?;
    let decisions = planned.plan.decisions().to_vec();
    let renderer = Renderer::new(planned.plan);
    let mut measured: Vec<Skip> = Vec::new();
    let mut text = String::new();
    for decision in decisions {
        text.push_str(&format!("{}: {}", decision.what, decision.why));
        // Several decisions may skip the same kind of work; it is measured once.
        if let Some(skip) = decision.skip.filter(|skip| arguments.measure && !measured.contains(skip)) {
            measured.push(skip);
            let options = RenderOptions { skipping: render.skipping.without(skip), ..render.clone() };
            let other = plan(&arguments.scenes, Some(&camera), &arguments.reading, options)?;
            let share = share_saved((&arguments.camera, &camera), &renderer, &Renderer::new(other.plan))?;
            text.push_str(&format!("; skipping {} saves {:.1} % of the time", skip.words(), 100.0 * share));
        }
        text.push('\n');
    }
    write_standard_output(text.as_bytes())
}

/// The share of the second renderer's time that the first one saves.
fn share_saved(camera: (&str, &CameraFile), skipping: &Renderer, computing: &Renderer) -> Result<f64, Failure> {
    let mut least = [Duration::MAX; 2];
    for _ in 0..TURNS {
        for (least, renderer) in least.iter_mut().zip([skipping, computing]) {
            *least = time(camera, renderer)?.min(*least);
        }
    }
    Ok(1.0 - least[0].as_secs_f64() / least[1].as_secs_f64().max(f64::MIN_POSITIVE))
}

fn time((path, camera): (&str, &CameraFile), renderer: &Renderer) -> Result<Duration, Failure> {
    let weights = band_weights(path, camera, renderer.plan().bands())?;
    let rays = Rays::new(&camera.camera, MEASURED_SAMPLES, renderer.plan().seed());
    let start = Instant::now();
    let _ = Exposer { renderer, rays: &rays, weights: &weights, by_row: &[] }.with_samples(None, &Silent);
    Ok(start.elapsed())
}
