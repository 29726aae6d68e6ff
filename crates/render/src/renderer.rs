//! Rays in, radiance out.

use crate::cache_prepass::{GatheredIrradiance, gather};
use crate::caching::caches_irradiance;
use crate::contribution::Contribution;
use crate::mirrored_light::MirroredLight;
use crate::path_guide::PathGuide;
use crate::ray_spacing::RaySpacing;
use crate::ray_tree::TreeRay;
use crate::saved_cache::{CacheError, load, save};
use crate::trace::{PathIntegrator, Traced};
use glam::{DVec2, DVec3};
use radsight_accel::Ray;
use radsight_compile::RenderPlan;
use rayon::prelude::*;

/// Answers rays.
#[derive(Debug)]
pub struct Renderer {
    plan: RenderPlan,
    shared: CachedIrradiance,
    guide: Option<PathGuide>,
}

/// Irradiance that was gathered before the rays are answered, in as many bands as are traced; `None` before any was.
#[derive(Debug)]
enum CachedIrradiance {
    Grey(Option<GatheredIrradiance<1>>),
    Color(Option<GatheredIrradiance<3>>),
    NarrowSpectrum(Option<GatheredIrradiance<27>>),
    Spectrum(Option<GatheredIrradiance<36>>),
    WideSpectrum(Option<GatheredIrradiance<72>>),
}

/// The memory with which one thread answers rays.
#[derive(Debug)]
pub struct RayWorker<'r>(Bands<'r>);

#[derive(Debug)]
enum Bands<'r> {
    Grey(PathIntegrator<'r, 1>),
    Color(PathIntegrator<'r, 3>),
    NarrowSpectrum(Box<PathIntegrator<'r, 27>>),
    Spectrum(Box<PathIntegrator<'r, 36>>),
    WideSpectrum(Box<PathIntegrator<'r, 72>>),
}

/// The same for whichever number of bands it is.
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

/// Rays that one thread takes at a time.
const CHUNK: usize = 1024;

impl Renderer {
    /// Renders according to a plan.
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

    /// Gathers irradiance where rays like these will want it, if the options ask for sharing (`-aa`), and says from how many points. What was
    /// gathered for other rays before is kept. The rays should be
    /// spread over all that will be asked for later: one a pixel is plenty. Details that are smaller than their `spread` are not looked for.
    pub fn gather_irradiance(&mut self, rays: &[Option<Ray>], spread: RaySpacing) -> usize {
        self.gather_irradiance_until(rays, spread, &|| false).expect("nobody stops it")
    }

    /// The same until `stops`, which is asked often and on all threads: it gives `None` then, and nothing is gathered any more, neither before nor now.
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
        in_bands!(&mut self.shared, CachedIrradiance(gathered) => gather((plan, stops), gathered, rays, spread))
    }

    /// Learns where rays like these find light by way of diffuse surfaces, if they find it by chance only: patches of sun, spots of
    /// lamps, gaps between slats. Single paths of all rays that follow are sent there more often; their mean is
    /// the same. Says how many such places there are; 0 leaves everything as it is.
    pub fn guide_paths(&mut self, rays: &[Option<Ray>], spread: RaySpacing) -> usize {
        self.guide = None;
        if self.plan.options.ambient_bounces > 0 {
            let plan = &self.plan;
            self.guide = in_bands!(&self.shared, CachedIrradiance(gathered) => learn(plan, gathered, rays, spread));
        }
        self.guide.as_ref().map_or(0, PathGuide::len)
    }

    /// The irradiance that was gathered or loaded so far, as bytes that [`Renderer::load_irradiance_cache`] reads; `None` before any was. `scene` is a number by
    /// which the scene is known again, such as `radsight_ir::Scene::fingerprint`.
    pub fn save_irradiance_cache(&mut self, scene: u64) -> Option<Vec<u8>> {
        let plan = &self.plan;
        in_bands!(&mut self.shared, CachedIrradiance(gathered) => save(plan, gathered, scene))
    }

    /// Takes over irradiance that was saved, and says how many records there are then. What was gathered here since the last time it was saved or loaded stays
    /// where the saved one reaches nothing. Where all was saved before, rays get the same answers from it as before, bit for bit.
    ///
    /// # Errors
    /// Where the bytes are not of a cache for this scene and these options. The renderer is as it was then.
    pub fn load_irradiance_cache(&mut self, bytes: &[u8], scene: u64) -> Result<usize, CacheError> {
        let plan = &self.plan;
        in_bands!(&mut self.shared, CachedIrradiance(gathered) => load(plan, gathered, bytes, scene))
    }

    /// Whether the options ask for an irradiance cache (`-ab`, `-aa`, `-ad`).
    #[must_use]
    pub fn caches_irradiance(&self) -> bool {
        caches_irradiance(&self.plan)
    }

    /// The standard error that rays left in gathered irradiance, as a share of it: rms over the points it was gathered from. `None` where none is shared. What
    /// sharing bends away from the truth comes on top.
    #[must_use]
    pub fn irradiance_noise(&self) -> Option<f64> {
        in_bands!(&self.shared, CachedIrradiance(gathered) => gathered.as_ref().map(GatheredIrradiance::noise))
    }

    /// A worker for the calling thread.
    #[must_use]
    pub fn worker(&self) -> RayWorker<'_> {
        let (plan, guide) = (&self.plan, self.guide.as_ref());
        RayWorker(match &self.shared {
            CachedIrradiance::Grey(gathered) => Bands::Grey(tracer((plan, guide), gathered)),
            CachedIrradiance::Color(gathered) => Bands::Color(tracer((plan, guide), gathered)),
            CachedIrradiance::NarrowSpectrum(gathered) => {
                Bands::NarrowSpectrum(Box::new(tracer((plan, guide), gathered)))
            }
            CachedIrradiance::Spectrum(gathered) => Bands::Spectrum(Box::new(tracer((plan, guide), gathered))),
            CachedIrradiance::WideSpectrum(gathered) => Bands::WideSpectrum(Box::new(tracer((plan, guide), gathered))),
        })
    }

    /// Answers a batch of rays on all threads; the first has number `first_index`. A gap has its number and no answer.
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

/// A guide in the bands of the irradiance.
fn learn<const BANDS: usize>(
    plan: &RenderPlan,
    _: &Option<GatheredIrradiance<BANDS>>,
    rays: &[Option<Ray>],
    spread: RaySpacing,
) -> Option<PathGuide> {
    PathGuide::learn::<BANDS>(plan, rays, spread)
}

impl RayWorker<'_> {
    /// Answers ray number `index` of its stream by what it owes to each modifier that is tracked, in the order in which it met them.
    pub fn contributions(&mut self, index: u64, ray: &Ray, visit: impl FnMut(Contribution)) {
        let _ = self.trace(index, ray);
        in_bands!(&mut self.0, Bands(tracer) => tracer.take_contributions(visit))
    }

    /// Answers ray number `index` of its stream, and tells all rays that came of it where the options ask for that: each after those that came of
    /// it, so that the last is the ray itself.
    pub fn tree(&mut self, index: u64, ray: &Ray) -> (Traced, Vec<TreeRay>) {
        let traced = self.trace(index, ray);
        let told = in_bands!(&mut self.0, Bands(tracer) => tracer.take_tree());
        (traced, told)
    }

    /// The lights that a point sees by way of curved mirrors, as far as they are found; scene units.
    #[must_use]
    pub fn mirrored_lights(&mut self, from: DVec3) -> Vec<MirroredLight> {
        in_bands!(&mut self.0, Bands(tracer) => tracer.mirrored_lights(from))
    }

    /// Where a ray passes a mirrored light: its place across the light from the light's middle, in radii of the light. `None` where it
    /// takes another way than by the same number of mirrors.
    #[must_use]
    pub fn offset_from(&mut self, image: &MirroredLight, ray: &Ray) -> Option<DVec2> {
        in_bands!(&mut self.0, Bands(tracer) => tracer.offset_from(image, ray))
    }

    /// Sees nothing of the rays that follow beyond a distance, scene units, before they are reflected.
    pub fn limit_distance(&mut self, distance: f64) {
        in_bands!(&mut self.0, Bands(tracer) => tracer.limit = distance)
    }

    /// Answers ray number `index` of its stream.
    #[must_use]
    pub fn trace(&mut self, index: u64, ray: &Ray) -> Traced {
        in_bands!(&mut self.0, Bands(tracer) => tracer.trace(index, ray))
    }

    /// Answers ray number `index` of its stream by single paths, without irradiance that was gathered before: more noise, and no bias.
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
