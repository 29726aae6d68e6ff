//! A job and what it names.

use super::failure;
use crate::ambient_file::FORMAT;
use crate::args::Reading;
use crate::failure::Failure;
use crate::input::{Planned, plan, read_camera, read_file};
use crate::plugin_guard::PluginGuard;
use crate::ray_input::RayReader;
use crate::trust::Trust;
use radsight::{JobTarget, RayFormat, RenderJob};
use radsight_camera::CameraFile;
use radsight_picture::Header;
use radsight_pinhole::stream::NumberFormat;
use radsight_render::{Ray, Renderer};

/// A job, the camera or the rays that it names, and the size of its whole picture.
pub(super) struct Inputs {
    pub(super) job: RenderJob,
    pub(super) camera: Option<CameraFile>,
    pub(super) rays: Vec<Ray>,
    /// Columns and rows; rays are one row.
    pub(super) size: [usize; 2],
    /// The job's file.
    path: String,
}

impl Inputs {
    /// Reads a job. What it names are files: a job is data, and runs nothing.
    pub(super) fn read(path: &str) -> Result<Inputs, Failure> {
        let job = RenderJob::from_json(path, &read_file(path, "job")?).map_err(failure)?;
        let seen_by = match &job.target {
            JobTarget::Capture { camera } => Some(camera),
            JobTarget::Trace { rays, .. } => Some(rays),
            _ => None,
        };
        let mut names = job.scenes.iter().chain(seen_by).chain(&job.irradiance_cache);
        if let Some(name) = names.find(|name| name.starts_with('!') || *name == "-") {
            return Err(Failure::input(format!("\"{path}\": \"{name}\" is no file, expected names of files")));
        }
        let (mut camera, mut rays) = (None, Vec::new());
        let size = match &job.target {
            JobTarget::Capture { camera: name } => {
                let file = camera.insert(read_camera(name)?);
                [file.camera.columns() as usize, file.camera.rows() as usize]
            }
            JobTarget::Trace { rays: name, format, .. } => {
                rays = read_rays(name, *format)?;
                [rays.len(), 1]
            }
            _ => job.picture_size().map_err(failure)?,
        };
        Ok(Inputs { job, camera, rays, size, path: path.to_owned() })
    }

    /// Reads the scene and plans its rendering.
    pub(super) fn plan(&self, guard: &PluginGuard, trust: &Trust) -> Result<(Planned, Reading), Failure> {
        if self.job.scenes.is_empty() {
            return Err(Failure::input(format!("\"{}\" names no scene, expected \"scenes\": [\"FILE\"]", self.path)));
        }
        let mut reading = Reading::trusted(&trust.for_file());
        reading.plugin_guard = guard.clone();
        reading.irradiance_cache.clone_from(&self.job.irradiance_cache);
        let options = self.job.render_options().map_err(failure)?;
        Ok((plan(&self.job.scenes, self.camera.as_ref(), &reading, options)?, reading))
    }

    /// Gives a renderer the irradiance cache of the whole job.
    pub(super) fn load_cache(&self, renderer: &mut Renderer, fingerprint: Option<u64>) -> Result<(), Failure> {
        if !self.job.caches_irradiance() {
            return Ok(());
        }
        let Some((name, scene)) = self.job.irradiance_cache.as_ref().zip(fingerprint) else {
            return Err(Failure::input(format!(
                "\"{}\" has \"ambient_accuracy\", expected \"irradiance_cache\": \"FILE\" for all its parts\nhint: `radsight job cache` makes the file",
                self.path
            )));
        };
        let wrong = |what: String| Failure::input(format!("irradiance cache \"{name}\": {what}"));
        let bytes = read_file(name, "irradiance cache")?;
        let used = match Header::read(&bytes) {
            Ok((header, used)) if header.format().as_deref() == Some(FORMAT) => used,
            _ => return Err(wrong("expected what `radsight job cache` or `-af` has written".to_owned())),
        };
        renderer.load_irradiance_cache(&bytes[used..], scene).map(drop).map_err(|error| wrong(error.to_string()))
    }
}

/// All rays of a file.
fn read_rays(name: &str, format: RayFormat) -> Result<Vec<Ray>, Failure> {
    let format = match format {
        RayFormat::Ascii => NumberFormat::Ascii,
        RayFormat::Float => NumberFormat::Float,
        RayFormat::Double => NumberFormat::Double,
    };
    let bytes = read_file(name, "file of rays")?;
    let mut reader = RayReader::of(format!("\"{name}\""), bytes.as_slice(), format);
    let (mut rays, mut some) = (Vec::new(), Vec::new());
    loop {
        reader.read(usize::MAX, &mut some)?;
        for ray in &some {
            rays.push(
                ray.ray.ok_or_else(|| {
                    Failure::input(format!("\"{name}\", ray {}: its direction is zero", rays.len() + 1))
                })?,
            );
        }
        if some.is_empty() {
            break;
        }
    }
    match rays.is_empty() {
        true => Err(Failure::input(format!("\"{name}\" has no rays, expected six numbers each"))),
        false => Ok(rays),
    }
}
