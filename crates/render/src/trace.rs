//! Following a ray to its radiance.
//!
//! At every point that is not perfectly specular all lights are sampled (or, where there are many, some by their promise), and the
//! highlight, and with `-ab` the diffuse component, is sampled too; the two ways of finding a light are weighted with the balance heuristic
//! (Veach and Guibas, SIGGRAPH 1995), so each is used where it is good and light that comes back by way of a mirror is found. Perfectly specular
//! reflections and refractions branch while branches are few, then one is chosen by weight; there is no limit to their depth but
//! Russian roulette.

use crate::antimatter::{Cut, CutId, Meeting};
use crate::bands::BandValues;
use crate::beyond::luminance;
use crate::contribution::Contributions;
use crate::direct::DirectSampler;
use crate::gather::{Caches, Survey};
use crate::geometry::is_flat;
use crate::indirect::Indirect;
use crate::link::{Link, Lobe};
use crate::medium::Medium;
use crate::model_light::ModelBatch;
use crate::options::{BackFaces, Lights, PathLimit, Quantity};
use crate::plan::RenderPlan;
use crate::ray::{Hit, PrimitiveId, Ray};
use crate::shader::{Appearance, Emitter, EmitterClass, GlossyKind, Kind, Shader, bands};
use crate::surface_light::{Drawn, LitPoint, colored, pane, sum};
use crate::tree::{Course, Image, NodeId, Tree};
use crate::view::Encounter;
use glam::DVec3;
use radsight_brdf::Density;
use radsight_cal::Scratch;
use radsight_ir::{Rgb, SurfaceHandle};
use radsight_sampling::{DimensionSet, RaySampler};
use radsight_spectrum::Sampling;
use std::f64::consts::PI;

/// Memory of one thread.
#[derive(Debug, Default)]
pub(crate) struct Workspace {
    pub(crate) scratch: Scratch,
    /// Places on lights, for a model that is asked about all of them at once.
    pub(crate) batch: ModelBatch,
}

/// Where the first ray ended.
#[derive(Clone, Copy, Debug)]
pub struct FirstHit {
    /// Distance, scene units.
    pub distance: f64,
    /// The point.
    pub point: DVec3,
    /// Unit geometric normal, the way the surface faces, which may be away from the ray.
    pub normal: DVec3,
    /// Unit normal with textures.
    pub perturbed_normal: DVec3,
    /// The surface of the whole scene: a mesh or an instance where the ray ends within one.
    pub surface: SurfaceHandle,
    /// Local coordinates on a mesh; zero elsewhere.
    pub local: [f64; 2],
    pub(crate) primitive: PrimitiveId,
}

/// What a ray brings.
#[derive(Clone, Copy, Debug)]
pub struct Traced {
    /// Radiance in W/(sr·m²), or irradiance in W/m², as the options ask; in a grey scene the three bands are equal, of a spectrum it is
    /// the colour.
    pub value: [f64; 3],
    /// The same in each band where spectra are traced.
    pub spectrum: Option<BandValues>,
    /// The first surface, or distant source.
    pub first_hit: Option<FirstHit>,
    /// Distance along the ray to what is seen, through plane mirrors and panes; infinite for none.
    pub effective_distance: f64,
}

/// Branches beyond this many are chosen from at random.
const MAX_BRANCHES: usize = 32;

/// A retroreflector that is seen by way of a mirror is lit by way of it too, and no light sampling finds that: its highlight is drawn
/// from this often, down to this depth.
const SPLIT_DRAWS: u32 = 8;
const LAST_SPLIT_DEPTH: u32 = 2;

/// No highlight is looked into by more rays (`-ss`): they have to wait for each other.
const MOST_HIGHLIGHT_SAMPLES: f64 = 16.0;

/// A path shorter than this is never ended by roulette.
const ROULETTE_DEPTH: u32 = 4;

/// Paths that carry less than this share may be ended.
const ROULETTE_SHARE: f64 = 0.25;

/// No path is longer. With a reflectance of 0.99 one in 10¹⁷ would be.
const MAX_DEPTH: u32 = 4096;

/// Names a medium that the present ray has met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct MediumId(u32);

/// A ray that waits to be traced.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment<const BANDS: usize> {
    pub(crate) ray: Ray,
    pub(crate) from: Option<PrimitiveId>,
    pub(crate) throughput: [f64; BANDS],
    pub(crate) travelled: f64,
    pub(crate) link: Option<Link>,
    pub(crate) depth: u32,
    /// Reflections of any kind, which are limited.
    pub(crate) reflections: u32,
    pub(crate) ambient_bounces: u32,
    /// What fills the space that the ray crosses.
    pub(crate) medium: MediumId,
    /// What is cut away for the ray, and for what passes through the surface that it has met.
    pub(crate) cut: CutId,
    pub(crate) cut_beyond: CutId,
    /// Whether interreflection is left out at the surface that the ray has met.
    pub(crate) follows_no_diffuse: bool,
    /// Whether this is still the direct view, through nothing but plane mirrors and panes.
    pub(crate) direct_view: bool,
    /// Its name, where rays are told; before it is sent on, that of the ray above it.
    pub(crate) node: NodeId,
}

impl<const BANDS: usize> Segment<BANDS> {
    /// Whether it was drawn from what a surface scatters, at its origin or before.
    pub(crate) fn is_scattered(&self) -> bool {
        self.link.is_some()
    }

    /// How many times as often its last drawn ray was drawn as by the lobe alone.
    pub(crate) fn favour(&self) -> f64 {
        self.link.map_or(1.0, |link| link.favour)
    }
}

/// Follows rays through a plan, in `BANDS` bands; one a thread.
#[derive(Debug)]
pub(crate) struct Tracer<'p, const BANDS: usize> {
    pub(crate) plan: &'p RenderPlan,
    /// Number of the ray in hand.
    pub(crate) index: u64,
    pub(crate) sampler: RaySampler,
    /// The next unused set of dimensions.
    pub(crate) next_set: u32,
    pub(crate) workspace: Workspace,
    waiting: Vec<Segment<BANDS>>,
    /// Media that the present ray has met; the first fills the scene.
    media: Vec<Medium<BANDS>>,
    /// What was cut away for the present ray; the first is nothing.
    pub(crate) cuts: Vec<Cut>,
    pub(crate) radiance: [f64; BANDS],
    first_hit: Option<FirstHit>,
    /// Whether the ray went on behind that as if nothing were there.
    first_is_passed: bool,
    effective_distance: f64,
    /// Irradiance that was gathered before.
    pub(crate) caches: Caches<'p, BANDS>,
    /// While looking for points whose irradiance is wanted.
    pub(crate) survey: Option<Survey<BANDS>>,
    /// What the present ray owes to the modifiers that are tracked; `None` where none is.
    pub(crate) contributions: Option<Box<Contributions<BANDS>>>,
    /// All rays that come of the present one; `None` where they are not wanted.
    pub(crate) tree: Option<Box<Tree<BANDS>>>,
    /// How far the rays are followed before they are reflected, scene units.
    pub(crate) limit: f64,
}

/// A ray that was put aside.
#[derive(Debug)]
pub(crate) struct SetAside<const BANDS: usize> {
    sampler: RaySampler,
    next_set: u32,
    waiting: Vec<Segment<BANDS>>,
    media: Vec<Medium<BANDS>>,
    cuts: Vec<Cut>,
    radiance: [f64; BANDS],
    first_hit: Option<FirstHit>,
    /// Whether the ray went on behind that as if nothing were there.
    first_is_passed: bool,
    effective_distance: f64,
    tree: Option<Box<Tree<BANDS>>>,
}

impl<'p, const BANDS: usize> Tracer<'p, BANDS> {
    pub(crate) fn new(plan: &'p RenderPlan, caches: Caches<'p, BANDS>) -> Self {
        Tracer {
            plan,
            index: 0,
            sampler: RaySampler::new(plan.options.seed, 0),
            next_set: 0,
            workspace: Workspace::default(),
            waiting: Vec::with_capacity(MAX_BRANCHES),
            media: vec![plan.global_medium()],
            cuts: vec![Cut::default()],
            radiance: [0.0; BANDS],
            first_hit: None,
            first_is_passed: false,
            effective_distance: f64::INFINITY,
            caches,
            survey: None,
            contributions: Contributions::wanted(&plan.options),
            tree: Tree::wanted(&plan.options),
            limit: f64::INFINITY,
        }
    }

    /// Traces ray number `index`.
    pub(crate) fn trace(&mut self, index: u64, ray: &Ray) -> Traced {
        self.index = index;
        let medium = self.begin(RaySampler::new(self.plan.options.seed, index), self.global_medium());
        self.tree.iter_mut().for_each(|tree| tree.clear());
        let start = Segment {
            ray: *ray,
            from: None,
            throughput: [1.0; BANDS],
            travelled: 0.0,
            link: None,
            depth: 0,
            reflections: 0,
            ambient_bounces: self.plan.options.ambient_bounces,
            medium,
            cut: CutId::default(),
            cut_beyond: CutId::default(),
            follows_no_diffuse: false,
            direct_view: true,
            node: NodeId::NONE,
        };
        if self.plan.options.quantity == Quantity::Irradiance {
            let node = self.told(&start, Course::Passed);
            self.irradiance(&Segment { throughput: [PI; BANDS], node, ..start });
            self.follow_waiting();
        } else {
            self.finish(start);
        }
        Traced {
            value: self.rgb(&self.radiance),
            spectrum: self.spectrum(&self.radiance),
            first_hit: self.first_hit,
            effective_distance: self.effective_distance,
        }
    }

    /// The values of bands where spectra are traced.
    pub(crate) fn spectrum(&self, places: &[f64; BANDS]) -> Option<BandValues> {
        (BANDS > 3).then(|| BandValues::new(self.plan.layout.collect(places)))
    }

    /// Values as red, green and blue.
    pub(crate) fn rgb(&self, places: &[f64; BANDS]) -> [f64; 3] {
        if BANDS <= 3 {
            return std::array::from_fn(|band| places[band.min(BANDS - 1)]);
        }
        let mut bands = [0.0; Sampling::MOST_BANDS];
        for (band, value) in bands.iter_mut().zip(self.plan.layout.collect(places)) {
            *band = value;
        }
        self.plan.layout.sampling().rgb(&bands)
    }

    /// Forgets the ray before; the next one begins in this medium.
    pub(crate) fn begin(&mut self, sampler: RaySampler, medium: Medium<BANDS>) -> MediumId {
        self.sampler = sampler;
        self.next_set = 0;
        self.media.truncate(1);
        self.cuts.truncate(1);
        self.radiance = [0.0; BANDS];
        self.first_hit = None;
        self.first_is_passed = false;
        self.effective_distance = f64::INFINITY;
        if medium == self.media[0] {
            return MediumId(0);
        }
        self.media.push(medium);
        MediumId(1)
    }

    /// Follows a ray and all that come of it.
    pub(crate) fn finish(&mut self, segment: Segment<BANDS>) {
        self.push(segment);
        self.follow_waiting();
    }

    fn follow_waiting(&mut self) {
        while let Some(segment) = self.waiting.pop() {
            if let Some(contributions) = &mut self.contributions {
                contributions.close(self.radiance, self.waiting.len());
            }
            self.follow(segment);
        }
    }

    /// How many rays wait to be followed.
    pub(crate) fn waiting(&self) -> usize {
        self.waiting.len()
    }

    /// How far away the first surface was; infinite for none.
    pub(crate) fn first_distance(&self) -> f64 {
        self.first_hit.map_or(f64::INFINITY, |hit| hit.distance)
    }

    /// Puts the ray in hand aside, for others to be followed in between.
    pub(crate) fn set_aside(&mut self) -> SetAside<BANDS> {
        SetAside {
            sampler: self.sampler,
            next_set: self.next_set,
            waiting: std::mem::take(&mut self.waiting),
            media: self.media.clone(),
            cuts: self.cuts.clone(),
            radiance: self.radiance,
            first_hit: self.first_hit,
            first_is_passed: self.first_is_passed,
            effective_distance: self.effective_distance,
            tree: self.tree.take(),
        }
    }

    /// Goes on with the ray that was put aside.
    pub(crate) fn take_up(&mut self, ray: SetAside<BANDS>) {
        let SetAside {
            sampler,
            next_set,
            waiting,
            media,
            cuts,
            radiance,
            first_hit,
            first_is_passed,
            effective_distance,
            tree,
        } = ray;
        self.tree = tree;
        (self.sampler, self.next_set, self.waiting) = (sampler, next_set, waiting);
        (self.media, self.cuts) = (media, cuts);
        (self.radiance, self.effective_distance) = (radiance, effective_distance);
        (self.first_hit, self.first_is_passed) = (first_hit, first_is_passed);
    }

    /// Irradiance is π times the radiance of a white Lambertian surface.
    fn irradiance(&mut self, start: &Segment<BANDS>) {
        let white = GlossyKind { color: Rgb::WHITE, specularity: 0.0, roughness: 0.0, metallic: false };
        let normal = start.ray.direction;
        let point = LitPoint::glossy(&white, false, [1.0; BANDS], normal, normal, normal);
        self.light_and_scatter(start, start.ray.origin, None, &point, 0.0);
    }

    /// What fills the scene outside of all bodies.
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

    /// A ray that goes on as if nothing had been met, or a first one.
    pub(crate) fn push(&mut self, segment: Segment<BANDS>) {
        self.push_on(segment, Course::Passed);
    }

    fn push_on(&mut self, mut segment: Segment<BANDS>, course: Course) {
        if self.waiting.len() < MAX_BRANCHES && segment.throughput.iter().any(|band| *band > 0.0) {
            segment.node = self.told(&segment, course);
            self.waiting.push(segment);
        }
    }

    /// The name of a ray that is sent on, where rays are told.
    fn told(&mut self, segment: &Segment<BANDS>, course: Course) -> NodeId {
        let Some(tree) = &mut self.tree else { return NodeId::NONE };
        tree.begin(segment.node, course, segment.ray, segment.throughput)
    }

    fn follow(&mut self, mut segment: Segment<BANDS>) {
        // Invisible surfaces and back faces are passed in this loop.
        loop {
            let met = self.plan.first_hit(&segment.ray, segment.from);
            let distance = met.as_ref().map_or(f64::INFINITY, |hit| hit.distance);
            if segment.reflections == 0 && segment.travelled + distance > self.limit {
                return;
            }
            let Some(mut hit) = met else {
                return self.leave(&segment);
            };
            if self.plan.has_antimatter {
                let meeting = self.meet(segment.cut, segment.ray.direction, &mut hit);
                let (Meeting::Surface(beyond) | Meeting::Nothing(beyond)) = meeting;
                segment.cut_beyond = beyond;
                if meeting == Meeting::Nothing(beyond) {
                    segment = self.unmet(&segment, &hit);
                    continue;
                }
            }
            let shader = self.plan.shader_at(hit.shader);
            if matches!(shader.kind, Kind::Transparent) {
                segment = self.unmet(&segment, &hit);
                continue;
            }
            segment.follows_no_diffuse = self.plan.excludes_indirect(hit.shader);
            let behind = segment.ray.direction.dot(hit.front) > 0.0;
            let can_hide = self.plan.options.back_faces == BackFaces::Invisible && shader.can_hide_its_back();
            if behind && can_hide {
                segment = self.unmet(&segment, &hit);
                continue;
            }
            if self.contributions.is_some() {
                self.note_met(&segment, &hit, shader);
            }
            return self.shade(&segment, &hit, shader);
        }
    }

    /// Goes on as if nothing had been hit.
    pub(crate) fn pass_through(&mut self, segment: &Segment<BANDS>, hit: &Hit) {
        if segment.direct_view {
            self.effective_distance = f64::INFINITY;
        }
        let next = self.passed_through(*segment, hit);
        self.push(next);
    }

    /// The ray goes on behind a surface that does nothing to it.
    fn unmet(&mut self, segment: &Segment<BANDS>, hit: &Hit) -> Segment<BANDS> {
        if segment.depth == 0 && self.first_hit.is_none() {
            self.first_hit = Some(FirstHit::at(hit, segment.travelled + hit.distance));
            self.first_is_passed = true;
        }
        let segment = self.dimmed(segment, self.medium(segment.medium), hit.distance);
        let mut onward = self.passed_through(segment, hit);
        if let Some(tree) = &mut self.tree {
            tree.end(segment.node, FirstHit::at(hit, hit.distance));
            onward.node = tree.begin(segment.node, Course::Passed, onward.ray, onward.throughput);
        }
        onward
    }

    /// The same ray, on the other side of what it hit.
    pub(crate) fn passed_through(&self, mut segment: Segment<BANDS>, hit: &Hit) -> Segment<BANDS> {
        segment.ray.origin = hit.point;
        segment.from = Some(hit.primitive);
        segment.cut = segment.cut_beyond;
        segment.travelled += hit.distance;
        if let Some(link) = &mut segment.link {
            link.length += hit.distance;
        }
        segment
    }

    /// What a ray finds that met a surface with this shader.
    pub(crate) fn shade(&mut self, segment: &Segment<BANDS>, hit: &Hit, shader: &Shader) {
        let behind = segment.ray.direction.dot(hit.front) > 0.0;
        let travelled = segment.travelled + hit.distance;
        let encounter = Encounter::at(&segment.ray, hit, travelled);
        self.note_hit(segment, hit, &encounter);
        let unseen = segment;
        let arrived;
        let segment = if self.plan.has_media {
            arrived = self.crossed(segment, hit, shader);
            &arrived
        } else {
            segment
        };
        if self.plan.options.quantity == Quantity::SurfaceIrradiance
            && segment.reflections == 0
            && segment.link.is_none()
        {
            match &shader.kind {
                Kind::Mixture(_) => {}
                kind if kind.emitter().is_some() => {}
                kind if kind.is_transparent() => return self.push(self.passed_through(*segment, hit)),
                _ => return self.shade_white(segment, hit, &encounter),
            }
        }
        if segment.link.is_some_and(|link| link.behind_illum) && !shader.matters_to_shadow_rays() {
            return;
        }
        match &shader.kind {
            Kind::Emitter(emitter) if !behind => {
                let share = if hit.placed.is_some() && segment.link.is_some() {
                    placed_share(emitter, hit.distance)
                } else {
                    self.emission_share(segment, hit.surface, emitter, hit.distance, encounter.cosine)
                };
                self.emit(segment, shader, emitter, &encounter, share);
            }
            Kind::Illum { emitter, substitute } => {
                self.shade_illum([segment, unseen], hit, shader, (emitter, *substitute), &encounter);
            }
            Kind::Mirror { substitute: Some(substitute), .. } if self.is_replaced(segment, *substitute, behind) => {
                self.shade_substitute([segment, unseen], hit, *substitute);
            }
            Kind::Mirror { reflectance, .. } if !behind => {
                self.shade_mirror(segment, hit, shader, bands(*reflectance), &encounter);
            }
            // From behind, lights and mirrors are black; what has no material and what only cuts was passed.
            Kind::Emitter(_) | Kind::Mirror { .. } | Kind::Transparent | Kind::Antimatter(_) => {}
            Kind::Mixture(mixture) => self.shade_mixture([segment, unseen], hit, (shader, mixture), &encounter),
            Kind::Unusable => {
                let _ = self.plan.unusable_met.set((hit.surface, hit.shader));
            }
            Kind::Glass { transmissivity, refractive_index } => {
                self.shade_glass(segment, hit, shader, (bands(*transmissivity), *refractive_index), &encounter);
            }
            Kind::Dielectric(boundary) => self.shade_dielectric(segment, hit, shader, boundary),
            Kind::Mist(mist) => self.shade_mist(segment, hit, shader, mist),
            Kind::Prism(prism) => self.shade_prism(segment, hit, prism, &encounter),
            Kind::Glossy(glossy) | Kind::Retro(glossy) => {
                let (appearance, normal) = self.appearance(segment, shader, &encounter);
                let retro = matches!(shader.kind, Kind::Retro(_));
                let color = colored(glossy, appearance.color);
                let point = LitPoint::glossy(glossy, retro, color, -encounter.direction, encounter.normal, normal)
                    .with_threshold(glossy, self.plan.options.highlight_threshold);
                if point.mirror.iter().any(|band| *band > 0.0) {
                    let direction = point.mirror_direction();
                    self.specular(segment, hit, direction, point.mirror, Passage::Other);
                }
                self.light_and_scatter(segment, hit.point, Some(hit.primitive), &point, travelled);
            }
            Kind::Scatterer(scatterer) => self.shade_scatterer(segment, hit, shader, scatterer, &encounter),
            Kind::Plugin(model) => {
                let (appearance, normal) = self.appearance(segment, shader, &encounter);
                let point = LitPoint::model(model.as_ref(), -encounter.direction, encounter.normal, normal);
                let patterned = Segment { throughput: product(segment.throughput, appearance.color), ..*segment };
                self.light_and_scatter(&patterned, hit.point, Some(hit.primitive), &point, travelled);
            }
        }
    }

    fn note_hit(&mut self, segment: &Segment<BANDS>, hit: &Hit, encounter: &Encounter) {
        if segment.depth == 0 && self.first_hit.is_none() {
            let hit = FirstHit::at(hit, encounter.total_distance);
            self.first_hit = Some(FirstHit { perturbed_normal: encounter.normal, ..hit });
        }
        if let Some(tree) = &mut self.tree {
            let hit = FirstHit::at(hit, hit.distance);
            tree.end(segment.node, FirstHit { perturbed_normal: encounter.normal, ..hit });
        }
        if segment.direct_view {
            self.effective_distance = self.effective_distance.min(encounter.total_distance);
        }
    }

    /// A measurement of irradiance where a surface is: the surface does not matter.
    fn shade_white(&mut self, segment: &Segment<BANDS>, hit: &Hit, encounter: &Encounter) {
        let white = GlossyKind { color: Rgb::WHITE, specularity: 0.0, roughness: 0.0, metallic: false };
        let normal = encounter.normal;
        let point = LitPoint::glossy(&white, false, [1.0; BANDS], -encounter.direction, normal, normal);
        let segment = Segment { throughput: segment.throughput.map(|band| band * PI), ..*segment };
        self.light_and_scatter(&segment, hit.point, Some(hit.primitive), &point, encounter.total_distance);
    }

    /// Patterns and textures, and the normal that they make.
    pub(crate) fn appearance(
        &mut self,
        segment: &Segment<BANDS>,
        shader: &Shader,
        encounter: &Encounter,
    ) -> (Appearance<BANDS>, DVec3) {
        let appearance = shader.appearance(&self.plan.scene, encounter, &mut self.workspace.scratch);
        let normal = match &shader.kind {
            Kind::Retro(_) => encounter.normal,
            _ => shading_normal(encounter, appearance.perturbation),
        };
        let seen_normal = if matches!(shader.kind, Kind::Retro(_)) { -encounter.direction } else { normal };
        self.note_normal(segment, seen_normal);
        (appearance, normal)
    }

    fn shade_mirror(
        &mut self,
        segment: &Segment<BANDS>,
        hit: &Hit,
        shader: &Shader,
        reflectance: [f64; BANDS],
        encounter: &Encounter,
    ) {
        let (appearance, normal) = self.appearance(segment, shader, encounter);
        let mut direction = reflect(encounter.direction, normal);
        if direction.dot(encounter.normal) <= 0.0 {
            direction = reflect(encounter.direction, encounter.normal);
        }
        let straight = appearance.perturbation == DVec3::ZERO;
        let weight = product(reflectance, appearance.color);
        self.specular(segment, hit, direction, weight, Passage::Mirror { straight });
    }

    fn shade_glass(
        &mut self,
        segment: &Segment<BANDS>,
        hit: &Hit,
        shader: &Shader,
        (transmissivity, refractive_index): ([f64; BANDS], f64),
        encounter: &Encounter,
    ) {
        let (appearance, normal) = self.appearance(segment, shader, encounter);
        let cosine = -encounter.direction.dot(normal);
        let [reflected, transmitted] = pane(transmissivity, refractive_index, cosine.max(1e-9));
        let mut onward = encounter.direction;
        if appearance.perturbation != DVec3::ZERO {
            let bent = onward + appearance.perturbation * (2.0 * (1.0 - refractive_index));
            onward = bent.normalize_or(onward);
        }
        let undisturbed = onward == encounter.direction;
        let through = product(transmitted, appearance.color);
        self.specular(segment, hit, onward, through, Passage::Pane { undisturbed });
        let image = self.image_behind(hit, appearance.perturbation);
        self.specular(segment, hit, reflect(encounter.direction, normal), reflected, Passage::Reflection { image });
    }

    /// Where a mirror image in a surface appears.
    pub(crate) fn image_behind(&self, hit: &Hit, perturbation: DVec3) -> Image {
        Image::in_place_if(is_flat(self.plan.scene.surfaces[hit.surface].shape) && perturbation == DVec3::ZERO)
    }

    pub(crate) fn note_normal(&mut self, segment: &Segment<BANDS>, normal: DVec3) {
        if segment.depth == 0
            && !self.first_is_passed
            && let Some(first) = &mut self.first_hit
        {
            first.perturbed_normal = normal;
        }
        if let Some(tree) = &mut self.tree {
            tree.note_normal(segment.node, normal);
        }
    }

    /// Sends a ray on from a perfectly specular event, in the medium from which it came.
    pub(crate) fn specular(
        &mut self,
        segment: &Segment<BANDS>,
        hit: &Hit,
        direction: DVec3,
        weight: [f64; BANDS],
        passage: Passage,
    ) {
        self.specular_into(segment, hit, (direction, segment.medium), weight, passage);
    }

    /// The same in another medium.
    pub(crate) fn specular_into(
        &mut self,
        segment: &Segment<BANDS>,
        hit: &Hit,
        (direction, medium): (DVec3, MediumId),
        weight: [f64; BANDS],
        passage: Passage,
    ) {
        let travelled = segment.travelled + hit.distance;
        let throughput = product(segment.throughput, weight);
        let mut link = segment.link;
        if let Some(link) = &mut link {
            link.length += hit.distance;
            match passage {
                Passage::Pane { undisturbed: true } | Passage::Sheet { undisturbed: true, .. } => {}
                Passage::Mirror { straight: true } => link.reflected(hit.surface),
                Passage::Refraction { .. } => link.refracted(),
                Passage::Prism { .. } => link.covered(),
                _ => link.lost(),
            }
        }
        let same_side = direction.dot(hit.front) * segment.ray.direction.dot(hit.front) < 0.0;
        let reflected = same_side && !matches!(passage, Passage::Prism { .. });
        let reflections = segment.reflections + u32::from(reflected);
        let cut = if reflected { segment.cut } else { segment.cut_beyond };
        let Some(throughput) = self.go_on((throughput, segment.favour()), segment, reflections) else { return };
        let hides_what_is_beyond = match passage {
            Passage::Other | Passage::Reflection { .. } | Passage::Sheet { .. } => true,
            Passage::Refraction { flat } | Passage::Prism { flat } => !flat,
            Passage::Mirror { .. } | Passage::Pane { .. } => false,
        };
        let direct_view = segment.direct_view && !hides_what_is_beyond;
        if direct_view {
            self.effective_distance = f64::INFINITY;
        }
        let next = Segment {
            ray: Ray { origin: hit.point, direction },
            from: Some(hit.primitive),
            throughput,
            travelled,
            link,
            depth: segment.depth + 1,
            reflections,
            ambient_bounces: segment.ambient_bounces,
            medium,
            cut,
            cut_beyond: cut,
            follows_no_diffuse: false,
            direct_view,
            node: segment.node,
        };
        let flat = self.tree.is_some() && is_flat(self.plan.scene.surfaces[hit.surface].shape);
        self.push_on(next, passage.course(flat));
    }

    /// Direct light, and the rays that look for the rest.
    pub(crate) fn light_and_scatter(
        &mut self,
        segment: &Segment<BANDS>,
        at: DVec3,
        primitive: Option<PrimitiveId>,
        point: &LitPoint<'_, BANDS>,
        travelled: f64,
    ) {
        let receiver = primitive.and_then(|primitive| self.plan.receiver(primitive));
        let lights_suffice = receiver.is_some_and(|receiver| receiver.sees_only_lights && receiver.lights_suffice);
        let follow_highlight = point.has_highlight() && !lights_suffice;
        let alone = receiver.is_some_and(|receiver| receiver.sees_only_lights);
        let bounces = if segment.follows_no_diffuse { 0 } else { segment.ambient_bounces };
        let indirect = Indirect::after(bounces);
        let wants_indirect = point.has_diffuse() && indirect == Indirect::Followed && !alone;
        let gathered = if wants_indirect { self.gathered(segment, at, primitive, point, travelled) } else { None };
        if self.survey.is_some() {
            return;
        }
        let follow_diffuse = wants_indirect && gathered.is_none();
        let highlight_draws = if !follow_highlight {
            0
        } else if point.is_retroreflector() && (1..=LAST_SPLIT_DEPTH).contains(&segment.depth) {
            SPLIT_DRAWS
        } else {
            self.highlight_samples(segment)
        };
        let set = self.next_set;
        self.next_set += highlight_draws.max(1);
        let reception = point.reception(self.plan.light_draws[usize::from(segment.is_scattered())]);
        // Light from mist comes to shadow rays less dimmed than to others: then the two cannot share the work.
        let shared = !self.plan.lights_are_covered;
        let outlook = if follow_diffuse { point.outlook(self.plan, at) } else { None };
        let direct = DirectSampler {
            point: at,
            primitive,
            highlight_draws: if shared { highlight_draws } else { 0 },
            shares_diffuse: shared && follow_diffuse && point.diffuse_finds_lights(),
            outlook: outlook.as_ref(),
            reception,
            travelled,
            medium: segment.medium,
            cuts: [segment.cut, segment.cut_beyond],
            normal: point.normal,
            drawn: segment.link.is_some(),
        };
        if let Some(tree) = &mut self.tree {
            tree.light(segment.throughput, segment.node);
        }
        let mut light = direct.sample(self, point);
        if let Some(contributions) = &mut self.contributions {
            contributions.settle(segment.throughput);
        }
        if indirect == Indirect::Constant {
            self.add_constant(&mut light, &point.ambient_reflectance());
        }
        if let Some(gathered) = gathered {
            light = sum(light, gathered);
        }
        self.add(segment, product(segment.throughput, light));
        for draw in 0..highlight_draws {
            let u = self.sampler.take(DimensionSet::render(set + draw));
            if let Some(drawn) = point.draw_highlight([u[0], u[1], u[2]]) {
                let share = f64::from(highlight_draws);
                self.scatter(segment, &direct, (drawn.split(share), Lobe::Highlight), segment.ambient_bounces);
            }
        }
        if follow_diffuse {
            let u = self.sampler.take(DimensionSet::render(set));
            let drawn = match &outlook {
                Some(outlook) => point.draw_outward(outlook, u),
                None => point.draw_diffuse(u[2], u[3]),
            };
            if let Some(drawn) = drawn {
                self.scatter(segment, &direct, (drawn, Lobe::Diffuse), segment.ambient_bounces - 1);
            }
        }
    }

    /// How many rays look into a highlight: as many as are asked for, times what the path carries.
    fn highlight_samples(&self, segment: &Segment<BANDS>) -> u32 {
        let strongest = segment.throughput.iter().copied().fold(0.0, f64::max).min(1.0);
        (self.plan.options.highlight_samples * strongest + 0.5).clamp(1.0, MOST_HIGHLIGHT_SAMPLES) as u32
    }

    /// Sends a drawn ray on from a lit point.
    fn scatter(
        &mut self,
        segment: &Segment<BANDS>,
        from: &DirectSampler<'_>,
        (drawn, lobe): (Drawn<BANDS>, Lobe),
        ambient_bounces: u32,
    ) {
        let throughput = product(segment.throughput, drawn.weight);
        let reflections = segment.reflections + 1;
        let Some(throughput) = self.go_on((throughput, drawn.favour), segment, reflections) else { return };
        let mut link = match drawn.density {
            Density::Continuous(density) => {
                let at = (from.point, drawn.direction);
                let mut link = Link::new(density, at, from.reception, from.primitive, lobe);
                link.favour = drawn.favour;
                Some(link)
            }
            Density::Delta => segment.link,
        };
        match (&mut link, drawn.density) {
            (Some(link), Density::Continuous(_)) if self.plan.lights_are_covered => link.covered(),
            (Some(link), Density::Delta) => link.lost(),
            _ => {}
        }
        let next = Segment {
            ray: Ray { origin: from.point, direction: drawn.direction.normalize() },
            from: from.primitive,
            throughput,
            travelled: from.travelled,
            link,
            depth: segment.depth + 1,
            reflections,
            ambient_bounces,
            medium: segment.medium,
            cut: from.cut_towards(drawn.direction),
            cut_beyond: from.cut_towards(drawn.direction),
            follows_no_diffuse: false,
            direct_view: false,
            node: segment.node,
        };
        self.push_on(next, Course::Drawn);
    }

    /// Whether a path goes on, and with what: ends long paths, and weak ones at random without bias, more readily when many branches wait. A
    /// path is as weak as it would be if its rays were not favoured.
    pub(crate) fn go_on(
        &mut self,
        (throughput, favour): ([f64; BANDS], f64),
        segment: &Segment<BANDS>,
        reflections: u32,
    ) -> Option<[f64; BANDS]> {
        let strongest = favour * throughput.iter().copied().fold(0.0, f64::max);
        let depth = segment.depth + 1;
        if strongest <= 0.0 || depth > MAX_DEPTH {
            return None;
        }
        let least = self.plan.options.least_weight;
        let roulette = match self.plan.options.path_limit {
            PathLimit::Cut(most) if reflections > most || strongest < least => return None,
            PathLimit::RouletteUpTo(most) if reflections > most => return None,
            PathLimit::Cut(_) => 0.0,
            PathLimit::Roulette | PathLimit::RouletteUpTo(_) => least,
        };
        let crowded = self.waiting.len() + 2 >= MAX_BRANCHES;
        let survival = if crowded {
            strongest.min(0.5)
        } else {
            // A path with a drawn ray is noisy as it is; one from the eye by way of mirrors is not, and stays so.
            let drawn = segment.link.is_some() && depth >= ROULETTE_DEPTH;
            let share = if drawn { roulette.max(ROULETTE_SHARE) } else { roulette };
            if share > 0.0 { (strongest / share).min(1.0) } else { 1.0 }
        };
        if survival >= 1.0 {
            return Some(throughput);
        }
        let u = self.sampler.take(DimensionSet::render(self.next_set))[0];
        self.next_set += 1;
        (u < survival).then(|| throughput.map(|band| band / survival))
    }

    /// The ray met no surface: the first distant source around its direction.
    fn leave(&mut self, segment: &Segment<BANDS>) {
        let segment = &self.dimmed(segment, self.medium(segment.medium), f64::INFINITY);
        let direction = segment.ray.direction;
        let plan = self.plan;
        let Some((surface, shader)) = plan.sky_at(direction, segment.link.is_some()) else { return };
        let Some(emitter) = shader.kind.emitter() else { return };
        let encounter = Encounter::distant(direction);
        if segment.depth == 0 && self.first_hit.is_none() {
            self.first_hit = Some(FirstHit::distant(surface, direction));
        }
        if let Some(tree) = &mut self.tree {
            tree.end(segment.node, FirstHit::distant(surface, direction));
        }
        let share = self.emission_share(segment, surface, emitter, f64::INFINITY, 1.0);
        self.emit(segment, shader, emitter, &encounter, share);
    }

    pub(crate) fn emit(
        &mut self,
        segment: &Segment<BANDS>,
        shader: &Shader,
        emitter: &Emitter,
        encounter: &Encounter,
        share: f64,
    ) {
        if share <= 0.0 {
            return;
        }
        let mut radiance: [f64; BANDS] = emission(self.plan, shader, emitter, encounter, &mut self.workspace.scratch);
        if share < 1.0 {
            radiance = given(radiance);
        }
        self.add(segment, product(segment.throughput, radiance).map(|band| band * share));
        if let Some(contributions) = &mut self.contributions {
            contributions.add(shader, encounter, product(segment.throughput, radiance).map(|band| band * share));
        }
    }

    /// Adds what the first ray gets from the end of one of its own.
    fn add(&mut self, segment: &Segment<BANDS>, brought: [f64; BANDS]) {
        for (sum, brought) in self.radiance.iter_mut().zip(brought) {
            *sum += brought;
        }
        if let Some(tree) = &mut self.tree {
            tree.add(segment.node, brought);
        }
    }

    /// How much of the emission that a ray found counts: all of it, unless light sampling could have found it too.
    pub(crate) fn emission_share(
        &self,
        segment: &Segment<BANDS>,
        surface: SurfaceHandle,
        emitter: &Emitter,
        distance: f64,
        cosine: f64,
    ) -> f64 {
        let Some(link) = &segment.link else {
            // A glow that is too far away to be sampled is a surface as any other.
            let total = segment.travelled + distance;
            let far = matches!(emitter.class, EmitterClass::Glow(radius) if radius >= 0.0 && total > radius);
            return if far || self.plan.options.lights == Lights::Visible { 1.0 } else { 0.0 };
        };
        let overcounted = match emitter.class {
            EmitterClass::Glow(radius) => link.behind_illum || radius < 0.0,
            EmitterClass::Illum => link.behind_illum,
            EmitterClass::Light => false,
        };
        if overcounted { 0.0 } else { link.share(self.plan, surface, distance, cosine) }
    }
}

/// How much of the emission counts that a drawn ray finds within a mesh or an instance, where no light is sampled: as in Radiance only
/// glows that are far away take part in interreflection.
fn placed_share(emitter: &Emitter, distance: f64) -> f64 {
    match emitter.class {
        EmitterClass::Glow(radius) if radius >= 0.0 && distance > radius => 1.0,
        _ => 0.0,
    }
}

/// What kind of specular event a ray passes.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Passage {
    /// A `mirror`; `straight` without a texture.
    Mirror { straight: bool },
    /// A pane, going through.
    Pane { undisturbed: bool },
    /// A scattering surface, going straight through.
    Sheet { undisturbed: bool, image: Image },
    /// Into or out of a body; `flat` where what is beyond appears in its place.
    Refraction { flat: bool },
    /// Redirected by a prism; `flat` as before.
    Prism { flat: bool },
    /// Mirrored by glass.
    Reflection { image: Image },
    /// Any other.
    Other,
}

impl Passage {
    /// How the ray is told that goes this way on from a surface; `flat` or not.
    fn course(self, flat: bool) -> Course {
        match self {
            Passage::Mirror { straight } => Course::Mirrored { image: Image::in_place_if(straight && flat) },
            Passage::Reflection { image } => Course::Mirrored { image },
            Passage::Other => Course::Mirrored { image: Image::AtSurface },
            Passage::Pane { undisturbed } => Course::Onward { image: Image::in_place_if(undisturbed) },
            Passage::Refraction { flat } | Passage::Prism { flat } => {
                Course::Onward { image: Image::in_place_if(flat) }
            }
            Passage::Sheet { image, .. } => Course::Onward { image },
        }
    }
}

/// Radiance that leaves an emitter against the ray.
pub(crate) fn emission<const BANDS: usize>(
    plan: &RenderPlan,
    shader: &Shader,
    emitter: &Emitter,
    encounter: &Encounter,
    scratch: &mut Scratch,
) -> [f64; BANDS] {
    if let Some((cos_half_angle, axis)) = emitter.cone
        && -encounter.direction.dot(axis) < cos_half_angle
    {
        return [0.0; BANDS];
    }
    let own = bands(emitter.radiance);
    if shader.steps.is_empty() {
        return own;
    }
    product(own, shader.appearance::<BANDS>(&plan.scene, encounter, scratch).color)
}

/// What a light gives where it is sampled: nothing where a pattern makes it darker than black, as one may that is read beyond the ends of its
/// table. It is still seen as that, as in Radiance.
pub(crate) fn given<const BANDS: usize>(emission: [f64; BANDS]) -> [f64; BANDS] {
    if luminance(&emission) > 0.0 { emission } else { [0.0; BANDS] }
}

#[inline]
pub(crate) fn reflect(direction: DVec3, normal: DVec3) -> DVec3 {
    direction - normal * (2.0 * normal.dot(direction))
}

/// The normal with its texture; one that would turn away from the viewer is reflected back (Radiance's `raynormal`).
pub(crate) fn shading_normal(encounter: &Encounter, perturbation: DVec3) -> DVec3 {
    if perturbation == DVec3::ZERO {
        return encounter.normal;
    }
    let Some(normal) = (encounter.normal + perturbation).try_normalize() else { return encounter.normal };
    let cosine = -normal.dot(encounter.direction);
    if cosine > 0.0 { normal } else { normal + encounter.direction * (2.0 * cosine) }
}

#[inline]
pub(crate) fn product<const BANDS: usize>(a: [f64; BANDS], b: [f64; BANDS]) -> [f64; BANDS] {
    std::array::from_fn(|band| a[band] * b[band])
}
