//! Following a ray to its radiance.
//!
//! At every point that is not perfectly specular all lights are sampled (or, where there are many, some by their promise), and the
//! highlight, and with `-ab` the diffuse component, is sampled too; the two ways of finding a light are weighted with the balance heuristic
//! (Veach and Guibas, SIGGRAPH 1995), so each is used where it is good and light that comes back by way of a mirror is found. Perfectly specular
//! reflections and refractions branch while branches are few, then one is chosen by weight; there is no limit to their depth but
//! Russian roulette.

use crate::direct::DirectSampler;
use crate::light::LightForm;
use crate::options::{BackFaces, Quantity};
use crate::plan::RenderPlan;
use crate::ray::{Hit, PrimitiveId, Ray};
use crate::shader::{Appearance, Emitter, GlossyKind, Kind, Shader, bands};
use crate::surface_light::{Drawn, LitPoint, colored, pane};
use crate::tilt::Peak;
use crate::view::Encounter;
use glam::DVec3;
use radsight_brdf::Density;
use radsight_cal::Scratch;
use radsight_ir::{Rgb, SurfaceHandle};
use radsight_sampling::{DimensionSet, RaySampler};
use std::f64::consts::PI;

/// Memory of one thread.
#[derive(Debug, Default)]
pub(crate) struct Workspace {
    pub(crate) scratch: Scratch,
    /// Promise of each light, where only some are sampled.
    pub(crate) promises: Vec<f64>,
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
    pub(crate) primitive: PrimitiveId,
}

/// What a ray brings.
#[derive(Clone, Copy, Debug)]
pub struct Traced {
    /// Radiance in W/(sr·m²), or irradiance in W/m², as the options ask; in a grey scene the three bands are equal.
    pub value: [f64; 3],
    /// The first surface that is not invisible.
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

/// A path shorter than this is never ended by roulette.
const ROULETTE_DEPTH: u32 = 4;

/// Paths that carry less than this share may be ended.
const ROULETTE_SHARE: f64 = 0.25;

/// No path is longer. With a reflectance of 0.99 one in 10¹⁷ would be.
const MAX_DEPTH: u32 = 4096;

/// The longest chain of mirrors that is compared with those of mirrored lights.
const MAX_CHAIN: usize = 4;

/// How a ray was drawn, to weigh the emission that it finds against the sampling of that light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link {
    /// Density with which the direction was drawn, 1/sr.
    density: f64,
    /// Where it was drawn, the direction, and the highlight there.
    receiver: DVec3,
    direction: DVec3,
    peak: Peak,
    /// The primitive there.
    primitive: Option<PrimitiveId>,
    /// Distance since then.
    length: f64,
    /// Mirrors passed since then.
    mirrors: [Option<SurfaceHandle>; MAX_CHAIN],
    passed: usize,
    /// Whether something was passed that light sampling does not see through.
    broken: bool,
}

/// A ray that waits to be traced.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment<const BANDS: usize> {
    ray: Ray,
    from: Option<PrimitiveId>,
    throughput: [f64; BANDS],
    travelled: f64,
    link: Option<Link>,
    depth: u32,
    ambient_bounces: u32,
    /// Whether this is still the direct view, through nothing but plane mirrors and panes.
    direct_view: bool,
}

/// Follows rays through a plan, in `BANDS` bands; one a thread.
#[derive(Debug)]
pub(crate) struct Tracer<'p, const BANDS: usize> {
    pub(crate) plan: &'p RenderPlan,
    pub(crate) sampler: RaySampler,
    /// The next unused set of dimensions.
    pub(crate) next_set: u32,
    pub(crate) workspace: Workspace,
    waiting: Vec<Segment<BANDS>>,
    radiance: [f64; BANDS],
    first_hit: Option<FirstHit>,
    effective_distance: f64,
}

impl<'p, const BANDS: usize> Tracer<'p, BANDS> {
    pub(crate) fn new(plan: &'p RenderPlan) -> Self {
        Tracer {
            plan,
            sampler: RaySampler::new(plan.options.seed, 0),
            next_set: 0,
            workspace: Workspace::default(),
            waiting: Vec::with_capacity(MAX_BRANCHES),
            radiance: [0.0; BANDS],
            first_hit: None,
            effective_distance: f64::INFINITY,
        }
    }

    /// Traces ray number `index`.
    pub(crate) fn trace(&mut self, index: u64, ray: &Ray) -> Traced {
        self.sampler = RaySampler::new(self.plan.options.seed, index);
        self.next_set = 0;
        self.radiance = [0.0; BANDS];
        self.first_hit = None;
        self.effective_distance = f64::INFINITY;
        let start = Segment {
            ray: *ray,
            from: None,
            throughput: [1.0; BANDS],
            travelled: 0.0,
            link: None,
            depth: 0,
            ambient_bounces: self.plan.options.ambient_bounces,
            direct_view: true,
        };
        match self.plan.options.quantity {
            Quantity::Radiance => self.push(start),
            Quantity::Irradiance => self.irradiance(&Segment { throughput: [PI; BANDS], ..start }),
        }
        while let Some(segment) = self.waiting.pop() {
            self.follow(segment);
        }
        Traced {
            value: std::array::from_fn(|band| self.radiance[band.min(BANDS - 1)]),
            first_hit: self.first_hit,
            effective_distance: self.effective_distance,
        }
    }

    /// Irradiance is π times the radiance of a white Lambertian surface.
    fn irradiance(&mut self, start: &Segment<BANDS>) {
        let white = GlossyKind { color: Rgb::WHITE, specularity: 0.0, roughness: 0.0, metallic: false };
        let normal = start.ray.direction;
        let point = LitPoint::glossy(&white, false, [1.0; BANDS], normal, normal, normal);
        self.light_and_scatter(start, start.ray.origin, None, &point, 0.0);
    }

    fn push(&mut self, segment: Segment<BANDS>) {
        if self.waiting.len() < MAX_BRANCHES && segment.throughput.iter().any(|band| *band > 0.0) {
            self.waiting.push(segment);
        }
    }

    fn follow(&mut self, mut segment: Segment<BANDS>) {
        // Invisible surfaces and back faces are passed in this loop.
        loop {
            let Some(hit) = self.plan.first_hit(&segment.ray, segment.from) else {
                return self.leave(&segment);
            };
            let shader = self.plan.shader_at(hit.shader);
            if matches!(shader.kind, Kind::Transparent) {
                segment = self.passed_through(segment, &hit);
                continue;
            }
            let behind = segment.ray.direction.dot(hit.front) > 0.0;
            if behind && self.plan.options.back_faces == BackFaces::Invisible && shader.can_hide_its_back() {
                segment = self.passed_through(segment, &hit);
                continue;
            }
            return self.shade(&segment, &hit, shader, behind);
        }
    }

    /// The same ray, on the other side of what it hit.
    fn passed_through(&self, mut segment: Segment<BANDS>, hit: &Hit) -> Segment<BANDS> {
        segment.ray.origin = hit.point;
        segment.from = Some(hit.primitive);
        segment.travelled += hit.distance;
        if let Some(link) = &mut segment.link {
            link.length += hit.distance;
        }
        segment
    }

    fn shade(&mut self, segment: &Segment<BANDS>, hit: &Hit, shader: &Shader, behind: bool) {
        let travelled = segment.travelled + hit.distance;
        let encounter = Encounter::at(&segment.ray, hit, travelled);
        if segment.depth == 0 && self.first_hit.is_none() {
            self.first_hit = Some(FirstHit {
                distance: travelled,
                point: hit.point,
                normal: hit.front,
                perturbed_normal: encounter.normal,
                surface: hit.surface,
                primitive: hit.primitive,
            });
        }
        if segment.direct_view {
            self.effective_distance = self.effective_distance.min(travelled);
        }
        match &shader.kind {
            Kind::Emitter(emitter) if !behind => {
                let share = self.emission_share(segment, hit.surface, hit.distance, encounter.cosine);
                self.emit(segment, shader, emitter, &encounter, share);
            }
            Kind::Mirror { reflectance } if !behind => {
                self.shade_mirror(segment, hit, shader, bands(*reflectance), &encounter);
            }
            // From behind, lights and mirrors are black; what has no material was passed.
            Kind::Emitter(_) | Kind::Mirror { .. } | Kind::Transparent => {}
            Kind::Unusable => {
                let _ = self.plan.unusable_met.set((hit.surface, hit.shader));
            }
            Kind::Glass { transmissivity, refractive_index } => {
                self.shade_glass(segment, hit, shader, (bands(*transmissivity), *refractive_index), &encounter);
            }
            Kind::Glossy(glossy) | Kind::Retro(glossy) => {
                let (appearance, normal) = self.appearance(segment, shader, &encounter);
                let retro = matches!(shader.kind, Kind::Retro(_));
                let color = colored(glossy, appearance.color);
                let point = LitPoint::glossy(glossy, retro, color, -encounter.direction, encounter.normal, normal);
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
        self.specular(segment, hit, reflect(encounter.direction, normal), reflected, Passage::Other);
    }

    fn note_normal(&mut self, segment: &Segment<BANDS>, normal: DVec3) {
        if segment.depth == 0
            && let Some(first) = &mut self.first_hit
        {
            first.perturbed_normal = normal;
        }
    }

    /// Sends a ray on from a perfectly specular event.
    pub(crate) fn specular(
        &mut self,
        segment: &Segment<BANDS>,
        hit: &Hit,
        direction: DVec3,
        weight: [f64; BANDS],
        passage: Passage,
    ) {
        let travelled = segment.travelled + hit.distance;
        let throughput = product(segment.throughput, weight);
        let mut link = segment.link;
        if let Some(link) = &mut link {
            link.length += hit.distance;
            match passage {
                Passage::Pane { undisturbed: true } | Passage::Sheet { undisturbed: true } => {}
                Passage::Mirror { straight: true } if link.passed < MAX_CHAIN => {
                    link.mirrors[link.passed] = Some(hit.surface);
                    link.passed += 1;
                }
                _ => link.broken = true,
            }
        }
        let Some(throughput) = self.roulette(throughput, segment.depth + 1) else { return };
        let direct_view = segment.direct_view && !matches!(passage, Passage::Other | Passage::Sheet { .. });
        if direct_view {
            self.effective_distance = f64::INFINITY;
        }
        self.push(Segment {
            ray: Ray { origin: hit.point, direction },
            from: Some(hit.primitive),
            throughput,
            travelled,
            link,
            depth: segment.depth + 1,
            ambient_bounces: segment.ambient_bounces,
            direct_view,
        });
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
        let follow_diffuse = point.has_diffuse() && segment.ambient_bounces > 0 && !alone;
        let highlight_draws = if !follow_highlight {
            0
        } else if point.is_retroreflector() && (1..=LAST_SPLIT_DEPTH).contains(&segment.depth) {
            SPLIT_DRAWS
        } else {
            1
        };
        let set = self.next_set;
        self.next_set += highlight_draws.max(1);
        let peak = point.peak();
        let shares_diffuse = follow_diffuse && point.diffuse_finds_lights();
        let direct = DirectSampler { point: at, primitive, highlight_draws, shares_diffuse, peak, travelled };
        let light = direct.sample(self, point);
        for (sum, (share, light)) in self.radiance.iter_mut().zip(segment.throughput.iter().zip(light)) {
            *sum += share * light;
        }
        for draw in 0..highlight_draws {
            let u = self.sampler.take(DimensionSet::render(set + draw));
            if let Some(drawn) = point.draw_highlight([u[0], u[1], u[2]]) {
                let share = f64::from(highlight_draws);
                self.scatter(segment, &direct, drawn.split(share), segment.ambient_bounces);
            }
        }
        if follow_diffuse {
            let u = self.sampler.take(DimensionSet::render(set));
            if let Some(drawn) = point.draw_diffuse(u[2], u[3]) {
                self.scatter(segment, &direct, drawn, segment.ambient_bounces - 1);
            }
        }
    }

    /// Sends a drawn ray on from a lit point.
    fn scatter(&mut self, segment: &Segment<BANDS>, from: &DirectSampler, drawn: Drawn<BANDS>, ambient_bounces: u32) {
        let throughput = product(segment.throughput, drawn.weight);
        let Some(throughput) = self.roulette(throughput, segment.depth + 1) else { return };
        let link = match drawn.density {
            Density::Continuous(density) => Some(Link {
                density,
                receiver: from.point,
                direction: drawn.direction,
                peak: from.peak,
                primitive: from.primitive,
                length: 0.0,
                mirrors: [None; MAX_CHAIN],
                passed: 0,
                broken: false,
            }),
            Density::Delta => segment.link.map(|link| Link { broken: true, ..link }),
        };
        self.push(Segment {
            ray: Ray { origin: from.point, direction: drawn.direction.normalize() },
            from: from.primitive,
            throughput,
            travelled: from.travelled,
            link,
            depth: segment.depth + 1,
            ambient_bounces,
            direct_view: false,
        });
    }

    /// Ends weak and long paths without bias; more readily when many branches wait.
    fn roulette(&mut self, throughput: [f64; BANDS], depth: u32) -> Option<[f64; BANDS]> {
        let strongest = throughput.iter().copied().fold(0.0, f64::max);
        if strongest <= 0.0 || depth > MAX_DEPTH {
            return None;
        }
        let crowded = self.waiting.len() + 2 >= MAX_BRANCHES;
        if depth < ROULETTE_DEPTH && !crowded {
            return Some(throughput);
        }
        let share = if crowded { 1.0 } else { ROULETTE_SHARE };
        let survival = (strongest / share).min(if crowded { 0.5 } else { 1.0 });
        if survival >= 1.0 {
            return Some(throughput);
        }
        let u = self.sampler.take(DimensionSet::render(self.next_set))[0];
        self.next_set += 1;
        (u < survival).then(|| throughput.map(|band| band / survival))
    }

    /// The ray met no surface: the first distant source around its direction.
    fn leave(&mut self, segment: &Segment<BANDS>) {
        let direction = segment.ray.direction;
        let found = self.plan.sky.iter().find(|sky| {
            // 1 − cos between the directions, from the chord: exact for the sun's quarter degree.
            0.25 * sky.direction.distance_squared(direction) <= sky.cap
        });
        let Some(sky) = found else { return };
        let shader = self.plan.shader(sky.surface);
        let Kind::Emitter(emitter) = &shader.kind else { return };
        let encounter = Encounter::distant(direction);
        if segment.depth == 0 {
            self.first_hit = Some(FirstHit {
                distance: f64::INFINITY,
                point: direction,
                normal: -direction,
                perturbed_normal: -direction,
                surface: sky.surface,
                primitive: PrimitiveId::NONE,
            });
        }
        let share = self.emission_share(segment, sky.surface, f64::INFINITY, 1.0);
        self.emit(segment, shader, emitter, &encounter, share);
    }

    fn emit(
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
        let radiance: [f64; BANDS] = emission(self.plan, shader, emitter, encounter, &mut self.workspace.scratch);
        for (sum, (throughput, radiance)) in self.radiance.iter_mut().zip(segment.throughput.iter().zip(radiance)) {
            *sum += throughput * radiance * share;
        }
    }

    /// How much of the emission that a ray found counts: all of it, unless light sampling could have found it too.
    fn emission_share(&self, segment: &Segment<BANDS>, surface: SurfaceHandle, distance: f64, cosine: f64) -> f64 {
        let Some(link) = &segment.link else { return 1.0 };
        if link.broken {
            return 1.0;
        }
        let first = self.plan.lights_of.partition_point(|(handle, _)| *handle < surface);
        let passed = link.mirrors[..link.passed].iter().copied();
        let sampled =
            self.plan.lights_of[first..].iter().take_while(|(handle, _)| *handle == surface).map(|(_, id)| *id).find(
                |id| {
                    let light = &self.plan.lights[id.0 as usize];
                    passed.clone().eq(light.mirrors.iter().map(|mirror| Some(mirror.surface)))
                },
            );
        let Some(id) = sampled else { return 1.0 };
        let light = &self.plan.lights[id.0 as usize];
        let length = link.length + distance;
        if length > light.max_distance {
            return 1.0;
        }
        // The distance factor of a spotlight belongs to its use as a sampled light; the same light must be found both ways.
        let focal = if light.focal_distance > 0.0 { (length / (length + light.focal_distance)).powi(2) } else { 1.0 };
        if light.misses(link.receiver) {
            return focal;
        }
        let cosine = if matches!(light.form, LightForm::Distant { .. }) { 1.0 } else { cosine };
        let other = light.density(link.receiver, link.direction, length, cosine, &link.peak) * self.selection(link, id);
        focal * link.density / (link.density + other)
    }

    fn selection(&self, link: &Link, id: crate::light::LightId) -> f64 {
        crate::direct::selection_density(self.plan, link.receiver, link.primitive, id)
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
    Sheet { undisturbed: bool },
    /// Any other.
    Other,
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

#[inline]
fn reflect(direction: DVec3, normal: DVec3) -> DVec3 {
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
