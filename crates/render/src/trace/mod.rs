//! The path integrator.
//!
//! At every point that is not perfectly specular all lights are sampled (or, if there are many,
//! some by importance), as well as the highlight and, with `-ab`, the diffuse component. Both
//! techniques of finding a light are combined by the balance heuristic (Veach and Guibas, SIGGRAPH
//! 1995), so each is used where it is good, and light reflected by mirrors is found. Perfectly
//! specular reflection and refraction branch while there are few branches; after that one is
//! selected by weight. Only Russian roulette limits their depth.

mod emission;
mod illumination;
pub(crate) mod passage;
pub(crate) mod path_state;
mod roulette;
mod scatterer;
mod shade;
mod split;

use path_state::{MediumId, PathState};

use crate::cache_query::{Caches, PointSearch};
use crate::contribution::Contributions;
use crate::cubature_error::CubatureError;
use crate::direct_record::DirectRecorder;
use crate::model_batch::ModelBatch;
use crate::path_guide::PathGuide;
use crate::ray_tree::{BounceType, NodeId, RayTree};
use crate::shadow_blockers::ShadowBlockers;
use crate::specular_chain::SpecularChain;
use crate::subtraction::{AntimatterEvent, Subtraction, SubtractionId};
use crate::unshadowed_sample::UnshadowedSample;
use glam::DVec3;
use radsight_accel::{Intersection, PrimitiveId, Ray};
use radsight_bsdf::Bsdf;
use radsight_cal::Scratch;
use radsight_compile::{FirstHit, Kind, Medium, Quantity, RenderPlan, Shader, Uncached};
use radsight_light::DiskNodes;
use radsight_sampling::RaySampler;
use radsight_spectrum::Sampling;
use radsight_texture::BandValues;
use std::f64::consts::PI;

/// The memory of one thread.
#[derive(Debug, Default)]
pub(crate) struct Workspace {
    pub(crate) scratch: Scratch,
    /// Light samples, for a model that evaluates all of them at once.
    pub(crate) batch: ModelBatch,
    /// Nodes of a cubature rule on a light.
    pub(crate) disk_nodes: DiskNodes,
}

/// The result of a ray.
#[derive(Clone, Copy, Debug)]
pub struct Traced {
    /// Radiance in W/(sr·m²), or irradiance in W/m² if the options request it. In a grey scene the
    /// three bands are equal; in spectral rendering it is the colour.
    pub value: [f64; 3],
    /// The value in each band in spectral rendering.
    pub spectrum: Option<BandValues>,
    /// The first surface, or distant source.
    pub first_hit: Option<FirstHit>,
    /// Apparent distance along the ray, through plane mirrors and panes; infinite for none.
    pub effective_distance: f64,
    /// Identifies what is seen directly and through specular surfaces: rays with equal keys hit
    /// surfaces of the same materials in the same order.
    pub surface_key: u64,
    /// Whether highlights of a surface were sampled that is seen directly or through specular
    /// surfaces: the value varies with the sampled directions, and rare bright ones may be missed.
    pub samples_highlight: bool,
}

/// Which part of the radiance of a ray is computed. The radiance is the sum of the light of images
/// and of the rest.
///
/// The light of images is emitted by a light that is sampled, and seen through mirrors or refracting
/// surfaces, without scattering.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CountedLight {
    /// The whole radiance.
    #[default]
    All,
    /// Without the light of images.
    WithoutImages,
    /// The light of images alone. Such rays are cheap: no light is sampled.
    Images,
}

/// Surfaces with less than this fraction of a ray's weight are not part of the key.
const MIN_SEEN: f64 = 0.15;

/// Beyond this number of branches one is selected at random.
const MAX_BRANCHES: usize = 32;

/// Traces rays through a plan, in `BANDS` bands; one per thread.
#[derive(Debug)]
pub(crate) struct PathIntegrator<'p, const BANDS: usize> {
    pub(crate) plan: &'p RenderPlan,
    /// Number of the current ray.
    pub(crate) index: u64,
    pub(crate) sampler: RaySampler,
    /// The next unused set of dimensions.
    pub(crate) next_set: u32,
    pub(crate) workspace: Workspace,
    waiting: Vec<PathState<BANDS>>,
    /// Number of rays that were cast in all: first hits and tests of shadows.
    pub(crate) casts: u64,
    /// Number of specular branches of the current ray that no sampled ray precedes.
    view_rays: u32,
    /// Media of the current ray; the first fills the scene.
    media: Vec<Medium<BANDS>>,
    /// Subtractions of the current ray; the first is empty.
    pub(crate) cuts: Vec<Subtraction>,
    /// Light samples of a point, before their shadow rays.
    pub(crate) unshadowed: Vec<UnshadowedSample<'p, BANDS>>,
    /// What blocked the last shadow rays.
    pub(crate) shadow_blockers: ShadowBlockers,
    /// Records the direct light of the current ray; `None` if not requested.
    pub(crate) recorder: Option<Box<DirectRecorder>>,
    pub(crate) radiance: [f64; BANDS],
    pub(crate) first_hit: Option<FirstHit>,
    effective_distance: f64,
    /// Distance of the last plane mirror or pane of the direct view; 0 for none.
    passed_distance: f64,
    surface_key: u64,
    pub(crate) samples_highlight: bool,
    /// Cached irradiance.
    pub(crate) caches: Caches<'p, BANDS>,
    /// The path guide, if there is one.
    pub(crate) guide: Option<&'p PathGuide>,
    /// The search for the cache points of the current ray, in a pre-pass.
    pub(crate) point_search: Option<PointSearch<BANDS>>,
    /// Contributions of tracked modifiers to the current ray; `None` without tracked ones.
    pub(crate) contributions: Option<Box<Contributions<BANDS>>>,
    /// The tree of the current ray; `None` if not requested.
    pub(crate) tree: Option<Box<RayTree<BANDS>>>,
    /// Maximum distance of rays before their first reflection, scene units.
    pub(crate) limit: f64,
    /// The allowed error of cubature on small lights; `None` where all lights are sampled.
    pub(crate) light_cubature: Option<CubatureError>,
    /// Whether the current ray splits by its weight; rays that gather irradiance do not.
    splits: bool,
    /// What counts of the light of rays.
    pub(crate) counted: CountedLight,
}

impl<'p, const BANDS: usize> PathIntegrator<'p, BANDS> {
    pub(crate) fn new(plan: &'p RenderPlan, caches: Caches<'p, BANDS>) -> Self {
        PathIntegrator {
            plan,
            index: 0,
            sampler: RaySampler::new(plan.options.seed, 0),
            next_set: 0,
            workspace: Workspace::default(),
            waiting: Vec::with_capacity(MAX_BRANCHES),
            casts: 0,
            view_rays: 0,
            media: vec![plan.global_medium()],
            cuts: vec![Subtraction::default()],
            unshadowed: Vec::new(),
            shadow_blockers: ShadowBlockers::default(),
            recorder: None,
            radiance: [0.0; BANDS],
            first_hit: None,
            effective_distance: f64::INFINITY,
            passed_distance: 0.0,
            surface_key: 0,
            samples_highlight: false,
            caches,
            guide: None,
            point_search: None,
            contributions: Contributions::wanted(&plan.options),
            tree: RayTree::wanted(&plan.options),
            limit: f64::INFINITY,
            light_cubature: None,
            splits: false,
            counted: CountedLight::All,
        }
    }

    /// The same with a path guide.
    pub(crate) fn guided_by(self, guide: Option<&'p PathGuide>) -> Self {
        PathIntegrator { guide, ..self }
    }

    /// Traces ray number `index`.
    pub(crate) fn trace(&mut self, index: u64, ray: &Ray) -> Traced {
        self.index = index;
        let medium = self.begin(RaySampler::new(self.plan.options.seed, index), self.global_medium());
        self.splits = self.plan.options.gathering.uncached == Uncached::Split;
        self.tree.iter_mut().for_each(|tree| tree.clear());
        let mut start = PathState {
            ray: *ray,
            from: None,
            throughput: [1.0; BANDS],
            split: 1.0,
            travelled: 0.0,
            mis: None,
            chain: SpecularChain::default(),
            depth: 0,
            is_limited: true,
            reflections: 0,
            ambient_bounces: self.plan.options.ambient_bounces,
            medium,
            cut: SubtractionId::default(),
            subtraction_beyond: SubtractionId::default(),
            follows_no_diffuse: false,
            direct_view: true,
            node: NodeId::NONE,
        };
        if self.plan.options.quantity == Quantity::Irradiance {
            let node = self.new_node(&start, BounceType::Passed);
            self.irradiance(&PathState { throughput: [PI; BANDS], node, ..start });
            self.follow_waiting();
        } else {
            self.finish(&mut start);
        }
        self.plan.unbounded.bound(&mut self.radiance, self.first_hit.as_ref());
        Traced {
            value: self.rgb(&self.radiance),
            spectrum: self.spectrum(&self.radiance),
            first_hit: self.first_hit,
            effective_distance: self.effective_distance,
            surface_key: self.surface_key,
            samples_highlight: self.samples_highlight,
        }
    }

    /// The values of bands in spectral rendering.
    pub(crate) fn spectrum(&self, values: &[f64; BANDS]) -> Option<BandValues> {
        (BANDS > 3).then(|| BandValues::new(self.plan.layout.collect(values)))
    }

    /// Values as red, green and blue.
    pub(crate) fn rgb(&self, values: &[f64; BANDS]) -> [f64; 3] {
        if BANDS <= 3 {
            return std::array::from_fn(|band| values[band.min(BANDS - 1)]);
        }
        let mut bands = [0.0; Sampling::MOST_BANDS];
        for (band, value) in bands.iter_mut().zip(self.plan.layout.collect(values)) {
            *band = value;
        }
        self.plan.layout.sampling().rgb(&bands)
    }

    /// Removes the previous ray; the next one starts in this medium.
    pub(crate) fn begin(&mut self, sampler: RaySampler, medium: Medium<BANDS>) -> MediumId {
        self.sampler = sampler;
        self.next_set = 0;
        self.view_rays = 0;
        self.splits = false;
        self.media.truncate(1);
        self.cuts.truncate(1);
        self.radiance = [0.0; BANDS];
        self.first_hit = None;
        self.effective_distance = f64::INFINITY;
        self.passed_distance = 0.0;
        self.surface_key = 0;
        self.samples_highlight = false;
        if medium == self.media[0] {
            return MediumId(0);
        }
        self.media.push(medium);
        MediumId(1)
    }

    /// Traces a ray and all its branches.
    pub(crate) fn finish(&mut self, path: &mut PathState<BANDS>) {
        if self.contributions.is_some() {
            self.push(*path);
            self.follow_waiting();
        } else {
            let first = self.cast(&path.ray, path.from);
            self.finish_from(path, first);
        }
    }

    /// The first surface on a ray.
    fn cast(&mut self, ray: &Ray, from: Option<PrimitiveId>) -> Option<Intersection> {
        self.casts += 1;
        self.plan.first_hit(ray, from)
    }

    /// The same as [`PathIntegrator::finish`] for a ray whose first surface is known, without contributions.
    pub(crate) fn finish_from(&mut self, path: &mut PathState<BANDS>, first: Option<Intersection>) {
        debug_assert!(self.contributions.is_none());
        // Without the copies of a pending ray.
        path.node = self.new_node(path, BounceType::Passed);
        self.follow_from(path, first);
        self.follow_waiting();
    }

    fn follow_waiting(&mut self) {
        self.follow_until(0);
    }

    /// Traces rays until at most this many are pending.
    fn follow_until(&mut self, waiting: usize) {
        while self.waiting.len() > waiting
            && let Some(mut path) = self.waiting.pop()
        {
            if let Some(contributions) = &mut self.contributions {
                contributions.close(self.radiance, self.waiting.len());
            }
            self.follow(&mut path);
        }
    }

    /// Number of pending rays.
    pub(crate) fn waiting(&self) -> usize {
        self.waiting.len()
    }

    /// Distance of the first surface; infinite for none.
    pub(crate) fn first_distance(&self) -> f64 {
        self.first_hit.map_or(f64::INFINITY, |hit| hit.distance)
    }

    /// Unit geometric normal of the first surface, on the side of the ray's origin; `None` for
    /// none.
    pub(crate) fn first_normal(&self, direction: DVec3) -> Option<DVec3> {
        let hit = self.first_hit.filter(|hit| hit.distance.is_finite())?;
        Some(if hit.normal.dot(direction) > 0.0 { -hit.normal } else { hit.normal })
    }

    /// Apparent distance, through plane mirrors and panes; infinite for none.
    pub(crate) fn effective_distance(&self) -> f64 {
        self.effective_distance
    }

    /// Apparent distance, or else that of the last pane or plane mirror with nothing behind it;
    /// infinite for none.
    pub(crate) fn shown_distance(&self) -> f64 {
        let seen = self.effective_distance;
        if seen.is_finite() || self.passed_distance == 0.0 { seen } else { self.passed_distance }
    }

    /// Irradiance is π times the radiance of a white Lambertian surface.
    fn irradiance(&mut self, start: &PathState<BANDS>) {
        let normal = start.ray.direction;
        let point = Bsdf::white(normal, normal);
        self.light_and_scatter(start, start.ray.origin, None, &point, 0.0);
    }

    /// The medium outside all others.
    pub(crate) fn global_medium(&self) -> Medium<BANDS> {
        self.media[0]
    }

    pub(crate) fn medium(&self, id: MediumId) -> Medium<BANDS> {
        self.media[id.0 as usize]
    }

    pub(crate) fn add_medium(&mut self, medium: Medium<BANDS>) -> MediumId {
        if medium == self.media[0] {
            return MediumId(0);
        }
        self.media.push(medium);
        MediumId((self.media.len() - 1) as u32)
    }

    /// Adds a first ray, or one that continues without interaction.
    pub(crate) fn push(&mut self, path: PathState<BANDS>) {
        self.push_on(path, BounceType::Passed);
    }

    fn push_on(&mut self, mut path: PathState<BANDS>, bounce: BounceType) {
        if self.waiting.len() < MAX_BRANCHES && path.throughput.iter().any(|band| *band != 0.0) {
            path.node = self.new_node(&path, bounce);
            self.waiting.push(path);
        }
    }

    /// The node of a new ray, if a tree is requested.
    fn new_node(&mut self, path: &PathState<BANDS>, bounce: BounceType) -> NodeId {
        let Some(tree) = &mut self.tree else { return NodeId::NONE };
        tree.begin(path.node, bounce, path.ray, path.throughput)
    }

    fn follow(&mut self, path: &mut PathState<BANDS>) {
        let first = self.cast(&path.ray, path.from);
        self.follow_from(path, first);
    }

    fn follow_from(&mut self, path: &mut PathState<BANDS>, mut first: Option<Intersection>) {
        // Invisible surfaces and back faces are passed in this loop.
        loop {
            let distance = first.as_ref().map_or(f64::INFINITY, |hit| hit.distance);
            if path.is_limited && path.travelled + distance > self.limit {
                return;
            }
            let Some(hit) = &mut first else {
                return self.leave(path);
            };
            if let Some(shader) = self.interacting(path, hit) {
                return self.shade(path, hit, shader);
            }
            *path = self.without_interaction(path, hit);
            first = self.cast(&path.ray, path.from);
        }
    }

    /// The shader of a hit; `None` if the surface has no effect on the ray.
    fn interacting(&mut self, path: &mut PathState<BANDS>, hit: &mut Intersection) -> Option<&'p Shader> {
        if self.plan.has_antimatter {
            let meeting = self.resolve(path.cut, path.ray.direction, hit);
            let (AntimatterEvent::Surface(beyond) | AntimatterEvent::Nothing(beyond)) = meeting;
            path.subtraction_beyond = beyond;
            if meeting == AntimatterEvent::Nothing(beyond) {
                return None;
            }
        }
        let shader = self.plan.shader_at(hit.shader);
        if matches!(shader.kind, Kind::Transparent) {
            return None;
        }
        path.follows_no_diffuse = self.plan.excludes_indirect(hit.shader);
        let behind = path.ray.direction.dot(hit.front) > 0.0;
        if behind && self.plan.hides_its_back(shader) {
            return None;
        }
        if self.contributions.is_some() {
            self.note_tracked_hit(path, hit, shader);
        }
        Some(shader)
    }

    /// Continues without interaction.
    pub(crate) fn pass_through(&mut self, path: &PathState<BANDS>, hit: &Intersection) {
        if path.direct_view {
            self.effective_distance = f64::INFINITY;
        }
        let next = self.passed_through(*path, hit);
        self.push(next);
    }

    /// The ray behind a surface that has no effect on it.
    fn without_interaction(&mut self, path: &PathState<BANDS>, hit: &Intersection) -> PathState<BANDS> {
        if path.depth == 0 && self.first_hit.is_none() {
            self.first_hit = Some(FirstHit::at(hit, path.travelled + hit.distance));
        }
        let path = self.dimmed(path, self.medium(path.medium), hit.distance);
        let mut continued = self.passed_through(path, hit);
        if let Some(tree) = &mut self.tree {
            tree.end(path.node, FirstHit::at(hit, hit.distance));
            continued.node = tree.begin(path.node, BounceType::Passed, continued.ray, continued.throughput);
        }
        continued
    }

    /// The same ray, on the other side of its hit.
    pub(crate) fn passed_through(&self, mut path: PathState<BANDS>, hit: &Intersection) -> PathState<BANDS> {
        path.ray.origin = hit.point;
        path.from = Some(hit.primitive);
        path.cut = path.subtraction_beyond;
        path.travelled += hit.distance;
        if let Some(mis) = &mut path.mis {
            mis.length += hit.distance;
        }
        path
    }

    /// Adds a hit of an unscattered ray to the surface key, if its weight is large enough.
    pub(crate) fn note_surface(&mut self, path: &PathState<BANDS>, number: u32) {
        let seen = path.throughput.iter().copied().fold(0.0, f64::max);
        if path.mis.is_none() && seen >= MIN_SEEN {
            let name = u64::from(path.depth) << 32 | u64::from(number);
            // The order of branches must not matter: a sum of hashes (the multiplier of
            // SplitMix64).
            self.surface_key =
                self.surface_key.wrapping_add((name + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29));
        }
    }

    /// Adds a contribution from the end of a ray to the first ray.
    fn add(&mut self, path: &PathState<BANDS>, brought: [f64; BANDS]) {
        for (sum, brought) in self.radiance.iter_mut().zip(brought) {
            *sum += brought;
        }
        if let Some(tree) = &mut self.tree {
            tree.add(path.node, brought);
        }
    }
}
