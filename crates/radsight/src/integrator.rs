//! Custom integrators.

use radsight_render::{FirstHit, Ray, RayWorker, Traced};
use radsight_sampling::{DimensionSet, RaySampler};

/// Number of low bits of a ray's number that identify the pixel sample; higher bits number the rays
/// of one sample.
const FURTHER_RAYS_FROM: u32 = 40;

/// Computes the radiance along camera rays.
///
/// The library's integrator is [`PathIntegrator`]. A custom one queries the scene through
/// [`RayQueries`]: the first hit of a ray, the result of the library's integrator, and random
/// numbers that are stratified over the samples of a pixel.
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
    /// Radiance along a ray towards its origin, W/(sr·m²), or another quantity for the image. The
    /// result must be a function of the ray and of `queries` alone, so that threads do not change
    /// images. A number that is not finite is [`Error::OwnIntegrator`](crate::Error::OwnIntegrator).
    fn radiance(&self, queries: &mut RayQueries<'_, '_>, ray: &Ray) -> [f64; 3];
}

/// The library's integrator: path tracing with light sampling and cached irradiance, as the options
/// select.
///
/// ```
/// use glam::DVec3;
/// use radsight::{Camera, CameraRay, PathIntegrator, Renderer, Scene};
/// struct Ahead;
/// impl Camera for Ahead {
///     fn ray(&self, _film: [f64; 2], _aperture: [f64; 2]) -> Option<CameraRay> {
///         Some(CameraRay { origin: DVec3::ZERO, direction: DVec3::Y, weight: 1.0 })
///     }
/// }
/// let scene = Scene::from_text("void glow white 0 0 4 1 2 3 0 white sphere ball 0 0 4 0 9 0 2")?;
/// let mut renderer = Renderer::new(&scene)?.samples(1);
/// let image = renderer.render_with(&PathIntegrator, &Ahead, 2, 2)?;
/// assert_eq!(image.pixels(), renderer.render_camera(&Ahead, 2, 2)?.pixels());
/// # Ok::<(), radsight::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct PathIntegrator;

impl Integrator for PathIntegrator {
    fn radiance(&self, queries: &mut RayQueries<'_, '_>, ray: &Ray) -> [f64; 3] {
        queries.trace(ray).value
    }
}

/// The queries of an integrator during one sample.
///
/// ```
/// use radsight::{Integrator, Ray, RayQueries};
/// /// The radiance of what a ray sees, or of its mirror image in a flat surface.
/// struct Mirrored;
/// impl Integrator for Mirrored {
///     fn radiance(&self, queries: &mut RayQueries<'_, '_>, ray: &Ray) -> [f64; 3] {
///         let Some(hit) = queries.first_hit(ray) else { return [0.0; 3] };
///         let direction = ray.direction - 2.0 * ray.direction.dot(hit.normal) * hit.normal;
///         let point = ray.origin + hit.distance * ray.direction;
///         Ray::new(point + 1e-6 * direction, direction).map_or([0.0; 3], |mirrored| queries.trace(&mirrored).value)
///     }
/// }
/// ```
#[derive(Debug)]
pub struct RayQueries<'q, 'r> {
    worker: &'q mut RayWorker<'r>,
    seed: u64,
    /// Number of the camera ray.
    index: u64,
    /// Number of rays and random numbers requested.
    asked: u32,
}

impl<'q, 'r> RayQueries<'q, 'r> {
    pub(crate) fn new(worker: &'q mut RayWorker<'r>, seed: u64, index: u64) -> RayQueries<'q, 'r> {
        RayQueries { worker, seed, index, asked: 0 }
    }

    /// Traces a ray with the library's integrator. The first ray of a sample uses the sample points
    /// of the library's own images; further rays use independent points.
    ///
    /// ```
    /// use radsight::{Integrator, Ray, RayQueries};
    /// /// Half of the radiance.
    /// struct Dim;
    /// impl Integrator for Dim {
    ///     fn radiance(&self, queries: &mut RayQueries<'_, '_>, ray: &Ray) -> [f64; 3] {
    ///         queries.trace(ray).value.map(|band| 0.5 * band)
    ///     }
    /// }
    /// ```
    #[must_use]
    pub fn trace(&mut self, ray: &Ray) -> Traced {
        let number = self.index ^ u64::from(self.asked) << FURTHER_RAYS_FROM;
        self.asked += 1;
        self.worker.trace(number, ray)
    }

    /// The first surface or distant source on a ray, including clear panes and mirrors.
    ///
    /// ```
    /// use radsight::{Integrator, Ray, RayQueries};
    /// /// 1 where a ray hits something.
    /// struct Mask;
    /// impl Integrator for Mask {
    ///     fn radiance(&self, queries: &mut RayQueries<'_, '_>, ray: &Ray) -> [f64; 3] {
    ///         [f64::from(u8::from(queries.first_hit(ray).is_some())); 3]
    ///     }
    /// }
    /// ```
    #[must_use]
    pub fn first_hit(&mut self, ray: &Ray) -> Option<FirstHit> {
        self.trace(ray).first_hit
    }

    /// Four numbers in [0, 1): the next dimensions of a low-discrepancy sequence over the samples
    /// of a pixel.
    ///
    /// ```
    /// use radsight::{Integrator, Ray, RayQueries};
    /// /// Noise of the mean 1/2.
    /// struct Noise;
    /// impl Integrator for Noise {
    ///     fn radiance(&self, queries: &mut RayQueries<'_, '_>, _ray: &Ray) -> [f64; 3] {
    ///         [queries.random()[0]; 3]
    ///     }
    /// }
    /// ```
    #[must_use]
    pub fn random(&mut self) -> [f64; 4] {
        let set = DimensionSet::render(self.asked);
        self.asked += 1;
        RaySampler::new(self.seed, self.index).take(set)
    }
}
