//! radsight as a library: Radiance scenes in; radiances, pictures, exposures and grey values out.
//!
//! | type | what it is |
//! |---|---|
//! | [`Scene`] | scene files, read and validated; custom materials can be added |
//! | [`View`], [`Camera`] | camera rays: a Radiance view, or a custom camera |
//! | [`Integrator`] | radiance along a ray: the library's [`PathIntegrator`], or a custom one |
//! | [`Renderer`] | a compiled scene; renders [`Image`]s to a requested error and traces rays |
//! | [`Capture`] | a real camera: finite pinhole, exposure in J/m², sensor, grey values |
//! | [`CaptureSeries`] | captures of similar scenes: poses of parts, rings, exposures, sensors |
//! | [`CaptureDerivatives`] | derivatives of a capture by poses, ring and camera, and their [`FisherInformation`] |
//! | [`RenderJob`] | a rectangle of a picture or capture, or a range of rays, as plain data for another process or machine |
//! | [`options`], [`camera_file`] | the types of render options, and of the content of a camera file |
//! | [`Error`] | errors as data: each message with file, line and column |
//!
//! Units: lengths are in scene units, radiance is W/(sr·m²) in three bands (red, green, blue of
//! Radiance's primaries), irradiance W/m², exposure J/m². Requested errors are relative: 0.02 is 2
//! %.
//!
//! Guarantees: results are functions of scene, options and seed, whatever the number of threads. A
//! [`Renderer`] keeps its irradiance cache, so with `ambient_bounces` a second picture of the same
//! renderer also uses records of the first. Nothing is printed, no command is run and no shared
//! library is loaded; files are read through a [`Loader`], which can be replaced. Work runs on the
//! rayon pool of the caller (`ThreadPool::install`).
//!
//! ```
//! use radsight::{Renderer, Scene, View};
//! # fn main() -> Result<(), radsight::Error> {
//! let scene = Scene::from_text("void glow white 0 0 4 1 1 1 0 white sphere ball 0 0 4 0 9 0 2")?;
//! let view = View::from_args("-vp 0 0 0 -vd 0 1 0 -vh 40 -vv 40")?;
//! let image = Renderer::new(&scene)?.error(0.05).render(&view, 32, 32)?;
//! assert_eq!(image.pixel(16, 16), [1.0; 3]);
//! assert!(image.report().error.unwrap() <= 0.05);
//! # Ok(())
//! # }
//! ```
#![forbid(unsafe_code)]

mod camera;
pub mod camera_file;
mod camera_picture;
mod capture;
mod capture_series;
mod contributions;
mod derivatives;
mod error;
mod error_budget;
#[doc(hidden)]
pub mod example;
mod file_loader;
mod image;
mod integrator;
mod irradiance_cache;
mod material;
mod option_check;
pub mod options;
mod part_move;
mod recording_loader;
mod render_job;
mod renderer;
mod report_page;
mod scene;
mod series_file;
mod view;

/// The vectors of rays: `radsight::glam::DVec3` fits whatever other version a program uses.
pub use glam;

pub use camera::{Camera, CameraRay};
pub use capture::{Capture, CaptureCamera, CapturedImage};
pub use capture_series::{CaptureSeries, SeriesExposure, SeriesPicture, SeriesScenes, expose_series};
pub use contributions::ModifierContribution;
pub use derivatives::{
    CaptureDerivatives, ExposureDerivatives, FisherInformation, Parameter, ParameterDerivative, expose_derivatives,
};
pub use error::{Error, Report};
pub use error_budget::ErrorBudget;
pub use file_loader::FileLoader;
pub use image::{Image, RenderReport, png_rgb8};
pub use integrator::{Integrator, PathIntegrator, RayQueries};
pub use material::Material;
pub use part_move::PartMove;
pub use radsight_brdf::{BrdfSample, Density, Lobes};
pub use radsight_capture::{Derivative, PixelStatistics, Progress, Silent};
pub use radsight_diag::{Diagnostic, Severity};
pub use radsight_film::{ErrorTarget, Estimate, Interpolation, SamplingBudget};
pub use radsight_loader::{FileKind, LoadError, Loaded, Loader, MemoryLoader};
pub use radsight_render::Quantity as TracedQuantity;
pub use radsight_render::{CacheError, Contribution, FirstHit, Ray, RenderOptions, Traced};
pub use radsight_report::{ErrorMap, Page, Quantity, RunRecord, Stage, viridis};
pub use recording_loader::RecordingLoader;
pub use render_job::{JobResult, JobTarget, MergedJob, RayFormat, RayQuantity, RenderJob, Tile};
pub use renderer::Renderer;
pub use scene::{Scene, SceneBuilder};
pub use series_file::{SeriesRow, check_moved_parts, read_series};
pub use view::View;
