//! Integrators of one's own.

use radsight_render::{FirstHit, Ray, RayWorker, Traced};
use radsight_sampling::{DimensionSet, RaySampler};

/// Bits of a ray's number below those that tell the rays of one answer.
const FURTHER_RAYS_FROM: u32 = 40;

/// Says what radiance comes along a camera's rays.
///
/// The library's own is [`PathIntegrator`]. Another one asks the scene through [`RayQueries`]: what a ray meets, what the library's
/// own integrator answers, random numbers that are evenly spread over the rays of a pixel.
///
/// ```
/// use radsight::{Camera, CameraRay, Integrator, Ray, RayQueries, Renderer, Scene};
/// # use glam::DVec3;
/// # struct Ahead;
/// # impl Camera for Ahead {
/// #     fn ray(&self, [x, y]: [f64; 2], _aperture: [f64; 2]) -> Option<CameraRay> {
/// #         Some(CameraRay { origin: DVec3::ZERO, direction: DVec3::new(x - 0.5, 1.0, 0.5 - y), weight: 1.0 })
/// #     }
/// # }
/// /// How far away things are, scene units.
/// struct Depth;
/// impl Integrator for Depth {
///     fn radiance(&self, queries: &mut RayQueries<'_, '_>, ray: &Ray) -> [f64; 3] {
///         [queries.first_hit(ray).map_or(0.0, |hit| hit.distance); 3]
///     }
/// }
/// let scene = Scene::from_text("void plastic white 0 0 5 .5 .5 .5 0 0  white bubble room 0 0 4 0 0 0 7")?;
/// let image = Renderer::new(&scene)?.samples(1).render_with(&Depth, &Ahead, 8, 8)?;
/// assert!(image.pixels().iter().all(|pixel| (pixel[0] - 7.0).abs() < 1e-5));
/// # Ok::<(), radsight::Error>(())
/// ```
pub trait Integrator: Sync {
    /// Radiance that comes along a ray towards its origin, W/(sr·m²), or whatever else the picture is to hold. What it answers must be
    /// a function of the ray and of what `queries` give, so that threads do not change pictures.
    fn radiance(&self, queries: &mut RayQueries<'_, '_>, ray: &Ray) -> [f64; 3];
}

/// The library's own integrator: single paths, light sampling, cached irradiance, as the options ask.
#[derive(Clone, Copy, Debug, Default)]
pub struct PathIntegrator;

impl Integrator for PathIntegrator {
    fn radiance(&self, queries: &mut RayQueries<'_, '_>, ray: &Ray) -> [f64; 3] {
        queries.trace(ray).value
    }
}

/// What an integrator may ask while it answers one ray.
#[derive(Debug)]
pub struct RayQueries<'q, 'r> {
    worker: &'q mut RayWorker<'r>,
    seed: u64,
    /// Number of the camera's ray.
    index: u64,
    /// Rays and random numbers that were asked for.
    asked: u32,
}

impl<'q, 'r> RayQueries<'q, 'r> {
    pub(crate) fn new(worker: &'q mut RayWorker<'r>, seed: u64, index: u64) -> RayQueries<'q, 'r> {
        RayQueries { worker, seed, index, asked: 0 }
    }

    /// Follows a ray with the library's own integrator. The first ray of an answer has the points of a sample sequence that the
    /// library's own pictures give it; further ones have points of their own.
    #[must_use]
    pub fn trace(&mut self, ray: &Ray) -> Traced {
        let number = self.index ^ u64::from(self.asked) << FURTHER_RAYS_FROM;
        self.asked += 1;
        self.worker.trace(number, ray)
    }

    /// The first surface or distant source that a ray meets; clear panes and mirrors are surfaces, too.
    #[must_use]
    pub fn first_hit(&mut self, ray: &Ray) -> Option<FirstHit> {
        self.trace(ray).first_hit
    }

    /// Four numbers in [0, 1): the next ones of a low-discrepancy sequence over the rays of a pixel.
    #[must_use]
    pub fn random(&mut self) -> [f64; 4] {
        let set = DimensionSet::render(self.asked);
        self.asked += 1;
        RaySampler::new(self.seed, self.index).take(set)
    }
}
