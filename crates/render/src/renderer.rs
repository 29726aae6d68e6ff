//! Traces rays and returns their radiance.

use crate::cache_prepass::{GatheredIrradiance, gather};
use crate::caching::caches_irradiance;
use crate::contribution::Contribution;
use crate::cubature_error::CubatureError;
use crate::direct_record::{DirectRecord, DirectRecorder, NearRecord, records_direct_light};
use crate::light_cubature::integrates_all_lights;
use crate::mirrored_light::MirroredLight;
use crate::path_guide::PathGuide;
use crate::ray_spacing::RaySpacing;
use crate::ray_tree::TreeRay;
use crate::saved_cache::{CacheError, load, save};
use crate::specular_ends::SpecularEnd;
use crate::trace::{CountedLight, PathIntegrator, Traced};
use glam::{DVec2, DVec3};
use radsight_accel::Ray;
use radsight_compile::RenderPlan;
use rayon::prelude::*;

/// Renders a plan.
#[derive(Debug)]
pub struct Renderer {
    plan: RenderPlan,
    shared: CachedIrradiance,
    guide: Option<PathGuide>,
}

/// Irradiance that was gathered before tracing, in as many bands as are traced; `None` before the
/// first gather.
#[derive(Debug)]
enum CachedIrradiance {
    Grey(Option<GatheredIrradiance<1>>),
    Color(Option<GatheredIrradiance<3>>),
    NarrowSpectrum(Option<GatheredIrradiance<27>>),
    Spectrum(Option<GatheredIrradiance<36>>),
    WideSpectrum(Option<GatheredIrradiance<72>>),
}

/// The working memory of one thread.
#[derive(Debug)]
pub struct RayWorker<'r>(Bands<'r>, Option<Box<DirectRecorder>>);

#[derive(Debug)]
enum Bands<'r> {
    Grey(PathIntegrator<'r, 1>),
    Color(PathIntegrator<'r, 3>),
    NarrowSpectrum(Box<PathIntegrator<'r, 27>>),
    Spectrum(Box<PathIntegrator<'r, 36>>),
    WideSpectrum(Box<PathIntegrator<'r, 72>>),
}

/// Calls the same code for any number of bands.
macro_rules! in_bands {
    ($of:expr, $kind:ident($inner:ident) => $done:expr) => {
        match $of {
            $kind::Grey($inner) => $done,
            $kind::Color($inner) => $done,
            $kind::NarrowSpectrum($inner) => $done,
            $kind::Spectrum($inner) => $done,
            $kind::WideSpectrum($inner) => $done,
        }
    };
}

/// Rays of a thread's unit of work.
const CHUNK: usize = 1024;

impl Renderer {
    /// Renders with a plan.
    #[must_use]
    pub fn new(plan: RenderPlan) -> Renderer {
        let shared = match plan.bands {
            1 => CachedIrradiance::Grey(None),
            3 => CachedIrradiance::Color(None),
            27 => CachedIrradiance::NarrowSpectrum(None),
            36 => CachedIrradiance::Spectrum(None),
            _ => CachedIrradiance::WideSpectrum(None),
        };
        Renderer { plan, shared, guide: None }
    }

    /// The plan.
    #[must_use]
    pub fn plan(&self) -> &RenderPlan {
        &self.plan
    }

    /// Gathers irradiance for rays like these, if the options cache it (`-aa`), and returns the
    /// number of new cache points. Irradiance gathered before is kept. The rays should be
    /// distributed over all that will be traced later: one per pixel is plenty. Details smaller
    /// than `spread` are ignored.
    pub fn gather_irradiance(&mut self, rays: &[Option<Ray>], spread: RaySpacing) -> usize {
        self.gather_irradiance_until(rays, spread, &|| false).expect("nobody stops it")
    }

    /// The same with cancellation: `stops` is called often and on all threads. Once it returns
    /// true, the result is `None`, and all irradiance gathered so far is discarded.
    pub fn gather_irradiance_until(
        &mut self,
        rays: &[Option<Ray>],
        spread: RaySpacing,
        stops: &(dyn Fn() -> bool + Sync),
    ) -> Option<usize> {
        if !caches_irradiance(&self.plan) {
            return Some(0);
        }
        let plan = &self.plan;
        // In the thread pool throughout: entering it for each group of gathers costs more than some
        // of them.
        rayon::scope(
            |_| in_bands!(&mut self.shared, CachedIrradiance(gathered) => gather((plan, stops), gathered, rays, spread)),
        )
    }

    /// Learns where rays like these find light via diffuse surfaces, if that is left to chance:
    /// patches of sun, spots of lamps, gaps between slats. All later independent paths are guided
    /// there, with the same mean. Returns the number of such patches; with 0 nothing changes.
    pub fn guide_paths(&mut self, rays: &[Option<Ray>], spread: RaySpacing) -> usize {
        self.guide = None;
        if self.plan.options.ambient_bounces > 0 {
            let plan = &self.plan;
            self.guide = in_bands!(&self.shared, CachedIrradiance(gathered) => learn(plan, gathered, rays, spread));
        }
        self.guide.as_ref().map_or(0, PathGuide::len)
    }

    /// The irradiance gathered or loaded so far, as bytes for [`Renderer::load_irradiance_cache`];
    /// `None` before the first gather. `scene` identifies the scene, such as
    /// `radsight_ir::Scene::fingerprint`.
    pub fn save_irradiance_cache(&mut self, scene: u64) -> Option<Vec<u8>> {
        let plan = &self.plan;
        in_bands!(&mut self.shared, CachedIrradiance(gathered) => save(plan, gathered, scene))
    }

    /// Loads saved irradiance, and returns the resulting number of records. Irradiance gathered
    /// here since the last save or load is kept where no loaded record reaches. If everything was
    /// saved before, rays have the same values as before, bit for bit.
    ///
    /// # Errors
    /// If the bytes are not a cache of this scene and these options. The renderer is then
    /// unchanged.
    pub fn load_irradiance_cache(&mut self, bytes: &[u8], scene: u64) -> Result<usize, CacheError> {
        let plan = &self.plan;
        in_bands!(&mut self.shared, CachedIrradiance(gathered) => load(plan, gathered, bytes, scene))
    }

    /// Whether the options ask for an irradiance cache (`-ab`, `-aa`, `-ad`).
    #[must_use]
    pub fn caches_irradiance(&self) -> bool {
        caches_irradiance(&self.plan)
    }

    /// The relative standard error of gathered irradiance due to rays: rms over its cache points.
    /// `None` if none is cached. Interpolation bias is not included.
    #[must_use]
    pub fn irradiance_noise(&self) -> Option<f64> {
        in_bands!(&self.shared, CachedIrradiance(gathered) => gathered.as_ref().map(GatheredIrradiance::noise))
    }

    /// Estimate of the number of rays that were cast for the cached irradiance: those gathered, and
    /// from what they hit to lights. 0 if none is cached.
    #[must_use]
    pub fn casts_of_cache(&self) -> f64 {
        let lights = match self.plan.light_draws[1] {
            0 => self.plan.lights.len() as f64,
            draws => f64::from(draws),
        };
        let rays = in_bands!(&self.shared, CachedIrradiance(gathered) => {
            gathered.as_ref().map_or(0.0, GatheredIrradiance::rays)
        });
        rays * (1.0 + lights)
    }

    /// Whether all lights are disks, which [`RayWorker::integrate_lights`] integrates
    /// where they are far enough.
    #[must_use]
    pub fn integrates_all_lights(&self) -> bool {
        integrates_all_lights(&self.plan)
    }

    /// Whether [`RayWorker::trace_near`] can record direct light: in interpolated pictures with many
    /// lights, but not too many to sample each.
    #[must_use]
    pub fn records_direct_light(&self) -> bool {
        records_direct_light(&self.plan)
    }

    /// A worker for the calling thread.
    #[must_use]
    pub fn worker(&self) -> RayWorker<'_> {
        let (plan, guide) = (&self.plan, self.guide.as_ref());
        let bands = match &self.shared {
            CachedIrradiance::Grey(gathered) => Bands::Grey(tracer((plan, guide), gathered)),
            CachedIrradiance::Color(gathered) => Bands::Color(tracer((plan, guide), gathered)),
            CachedIrradiance::NarrowSpectrum(gathered) => {
                Bands::NarrowSpectrum(Box::new(tracer((plan, guide), gathered)))
            }
            CachedIrradiance::Spectrum(gathered) => Bands::Spectrum(Box::new(tracer((plan, guide), gathered))),
            CachedIrradiance::WideSpectrum(gathered) => Bands::WideSpectrum(Box::new(tracer((plan, guide), gathered))),
        };
        RayWorker(bands, None)
    }

    /// Traces a batch of rays on all threads; the first has number `first_index`. A gap has a
    /// number and no value.
    #[must_use]
    pub fn trace_all(&self, first_index: u64, rays: &[Option<Ray>]) -> Vec<Option<Traced>> {
        rays.par_chunks(CHUNK)
            .enumerate()
            .map_init(
                || self.worker(),
                |worker, (chunk, rays)| {
                    let first = first_index + (chunk * CHUNK) as u64;
                    let trace = |(ray, index): (&Option<Ray>, u64)| ray.as_ref().map(|ray| worker.trace(index, ray));
                    rays.iter().zip(first..).map(trace).collect::<Vec<_>>()
                },
            )
            .flatten_iter()
            .collect()
    }
}

fn tracer<'r, const BANDS: usize>(
    (plan, guide): (&'r RenderPlan, Option<&'r PathGuide>),
    gathered: &'r Option<GatheredIrradiance<BANDS>>,
) -> PathIntegrator<'r, BANDS> {
    let caches = gathered.as_ref().map_or([None; 2], GatheredIrradiance::caches);
    PathIntegrator::new(plan, caches).guided_by(guide)
}

/// A path guide in the bands of the irradiance.
fn learn<const BANDS: usize>(
    plan: &RenderPlan,
    _: &Option<GatheredIrradiance<BANDS>>,
    rays: &[Option<Ray>],
    spread: RaySpacing,
) -> Option<PathGuide> {
    PathGuide::learn::<BANDS>(plan, rays, spread)
}

impl RayWorker<'_> {
    /// Traces ray number `index` of its stream and passes the contribution of each tracked
    /// modifier, in the order of hits.
    pub fn contributions(&mut self, index: u64, ray: &Ray, visit: impl FnMut(Contribution)) {
        let _ = self.trace(index, ray);
        in_bands!(&mut self.0, Bands(tracer) => tracer.take_contributions(visit))
    }

    /// Traces ray number `index` of its stream. Returns its tree if the options request it,
    /// children before their parents; the last one is the ray itself.
    pub fn tree(&mut self, index: u64, ray: &Ray) -> (Traced, Vec<TreeRay>) {
        let traced = self.trace(index, ray);
        let tree = in_bands!(&mut self.0, Bands(tracer) => tracer.take_tree());
        (traced, tree)
    }

    /// The images of lights in curved mirrors that are found from a point; scene units. `is_seen`
    /// says whether a mirror may be seen, from the unit direction and the tangent of the half angle
    /// of a cone around it.
    #[must_use]
    pub fn mirrored_lights(&mut self, from: DVec3, is_seen: impl Fn(DVec3, f64) -> bool) -> Vec<MirroredLight> {
        in_bands!(&mut self.0, Bands(tracer) => tracer.mirrored_lights(from, &is_seen))
    }

    /// Where a ray passes a mirrored light: its offset from the light's centre across the light, in
    /// radii of the light. `None` if it takes another path than over the same number of mirrors.
    #[must_use]
    pub fn offset_from(&mut self, image: &MirroredLight, ray: &Ray) -> Option<DVec2> {
        in_bands!(&mut self.0, Bands(tracer) => tracer.offset_from(image, ray))
    }

    /// Adds the ends of a ray behind the mirrors and dielectrics to which it leads, if there are any.
    pub fn specular_ends(&mut self, ray: &Ray, ends: &mut Vec<SpecularEnd>) {
        in_bands!(&mut self.0, Bands(tracer) => tracer.specular_ends(ray, ends))
    }

    /// Ignores everything on later rays beyond a distance, scene units, up to their first
    /// reflection.
    pub fn limit_distance(&mut self, distance: f64) {
        in_bands!(&mut self.0, Bands(tracer) => tracer.limit = distance)
    }

    /// Integrates the light of small disks by cubature where that is accurate enough, instead of
    /// sampling points on them. `None` samples all lights again.
    pub fn integrate_lights(&mut self, allowed: Option<CubatureError>) {
        in_bands!(&mut self.0, Bands(tracer) => tracer.light_cubature = allowed)
    }

    /// Computes a part of the radiance of later rays.
    pub fn count(&mut self, counted: CountedLight) {
        in_bands!(&mut self.0, Bands(tracer) => tracer.counted = counted)
    }

    /// Number of rays that this worker has cast: camera rays, their branches, and tests of shadows.
    #[must_use]
    pub fn rays_cast(&self) -> u64 {
        in_bands!(&self.0, Bands(tracer) => tracer.casts)
    }

    /// Traces ray number `index` of its stream.
    #[must_use]
    pub fn trace(&mut self, index: u64, ray: &Ray) -> Traced {
        in_bands!(&mut self.0, Bands(tracer) => tracer.trace(index, ray))
    }

    /// Traces ray number `index` of its stream. Lights are not all sampled where rays beside it
    /// recorded their direct light; this adds noise, but no bias if the numbers of those rays are
    /// independent of this one's. Its own direct light is added to `record`, if that is not `None`.
    pub fn trace_near(
        &mut self,
        index: u64,
        ray: &Ray,
        near: &[NearRecord],
        record: &mut Option<DirectRecord>,
    ) -> Traced {
        let mut recorder = self.1.take().unwrap_or_default();
        recorder.begin(near, record.take());
        in_bands!(&mut self.0, Bands(tracer) => {
            tracer.recorder = Some(recorder);
            let traced = tracer.trace(index, ray);
            self.1 = tracer.recorder.take();
            *record = self.1.as_mut().and_then(|recorder| recorder.finish());
            traced
        })
    }

    /// Traces ray number `index` of its stream as an independent path, without cached irradiance:
    /// more noise, and no bias.
    #[must_use]
    pub fn trace_uncached(&mut self, index: u64, ray: &Ray) -> Traced {
        in_bands!(&mut self.0, Bands(tracer) => {
            let caches = std::mem::take(&mut tracer.caches);
            let traced = tracer.trace(index, ray);
            tracer.caches = caches;
            traced
        })
    }
}
