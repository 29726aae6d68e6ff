//! Transmittance of shadow rays: straight through panes, refracted by dielectrics, attenuated by
//! mist.
//!
//! If nothing in the scene refracts or attenuates, the order of occluders does not matter, and an
//! any-hit query suffices. Otherwise the ray is traced from surface to surface. A refracted shadow
//! ray counts if it still ends on its light: Radiance's rule, which lights surfaces behind
//! dielectric panes and omits caustics.

use crate::direct::DirectSampler;
use crate::ray_tree::{BounceType, Image};
use crate::shadow_blockers::opaque_member;
use crate::subtraction::{AntimatterEvent, SubtractionId};
use crate::trace::PathIntegrator;
use glam::DVec3;
use radsight_accel::{Crossing, Intersection, MemberId, PrimitiveId, Ray, RayFrame};
use radsight_bsdf::pane;
use radsight_cal::Scratch;
use radsight_compile::{Kind, Medium, RaySide, RenderPlan, Shader, Substitution, VisibilityClass, emission, given};
use radsight_ir::Shape;
use radsight_light::{Light, LightSample, Redirection, VirtualSource};
use radsight_texture::{SurfaceInteraction, bands, product, reflect, shading_normal};

/// A shadow ray that crosses more surfaces than this is lost.
const MAX_CROSSINGS: u32 = 1000;

/// The effect of a surface on a shadow ray.
enum ShadowEvent<const BANDS: usize> {
    Blocked,
    /// The shadow ray continues in this direction, attenuated.
    SpecularBounce(DVec3, [f64; BANDS]),
    /// The shadow ray continues in another medium.
    Into(Medium<BANDS>, DVec3, [f64; BANDS]),
}

/// A shadow ray with its state.
struct ShadowRay<const BANDS: usize> {
    ray: Ray,
    from: Option<PrimitiveId>,
    medium: Medium<BANDS>,
    cut: SubtractionId,
    through: [f64; BANDS],
    travelled: f64,
    /// Number of the light's mirrors behind it.
    virtual_form: usize,
    /// Whether it was refracted, so that it may miss its light.
    is_refracted: bool,
}

impl<const BANDS: usize> ShadowRay<BANDS> {
    /// Continues behind a surface without effect.
    fn pass(&mut self, hit: &Intersection, cut: SubtractionId) {
        self.through = product(self.through, self.medium.shadow_transmission(hit.distance));
        self.ray.origin = hit.point;
        self.from = Some(hit.primitive);
        self.cut = cut;
    }
}

impl DirectSampler<'_> {
    /// The radiance that arrives from a point of a light that emits `radiance`.
    pub(crate) fn arriving<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        light: &Light,
        sample: &LightSample,
        between: &VisibilityClass,
        radiance: [f64; BANDS],
    ) -> [f64; BANDS] {
        // A ray does not hit the light on which it starts.
        if sample.distance <= tracer.plan.geometry.tolerance() {
            return [0.0; BANDS];
        }
        tracer.casts += 1;
        let straight = !light.is_redirected()
            && tracer.tree.is_none()
            && (!tracer.plan.shadow_rays_interact || self.is_clear(tracer, between));
        if straight {
            let visibility = self.visibility(tracer, light, sample, between);
            // Infinite radiance times zero is not a number.
            let is_hidden = visibility == [0.0; BANDS];
            return if is_hidden { visibility } else { product(radiance, visibility) };
        }
        self.walk(tracer, light, sample, radiance)
    }

    /// Whether all possible occluders are opaque, in a medium without effect.
    fn is_clear<const BANDS: usize>(&self, tracer: &PathIntegrator<'_, BANDS>, between: &VisibilityClass) -> bool {
        let plan = tracer.plan;
        let blocks = |member: &MemberId| {
            let shader = plan.shader(plan.geometry.surface_of(*member));
            plan.geometry.is_plain(*member) && !shader.matters_to_shadow_rays()
        };
        tracer.medium(self.medium).extinction == [0.0; BANDS]
            && match between {
                VisibilityClass::Dark | VisibilityClass::Nothing => true,
                VisibilityClass::Few(list) => list.iter().all(blocks),
                VisibilityClass::Within(_) | VisibilityClass::Anything => false,
            }
    }

    fn walk<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        light: &Light,
        sample: &LightSample,
        radiance: [f64; BANDS],
    ) -> [f64; BANDS] {
        let plan = tracer.plan;
        let dark = [0.0; BANDS];
        let target = light.primitive.unwrap_or(PrimitiveId::NONE);
        let mut walk = ShadowRay {
            ray: Ray { origin: self.point, direction: sample.direction },
            from: self.primitive,
            medium: tracer.medium(self.medium),
            cut: self.subtraction_towards(sample.direction),
            through: [1.0; BANDS],
            travelled: self.travelled,
            virtual_form: 0,
            is_refracted: false,
        };
        for _ in 0..MAX_CROSSINGS {
            let probable = tracer.shadow_blockers.last(target);
            // Its place in memory stays: a copy costs as much as the test of a box.
            let mut first = plan.first_hit_near(&walk.ray, walk.from, probable);
            let Some(hit) = &mut first else {
                return leave(tracer, &walk, light, radiance);
            };
            walk.travelled += hit.distance;
            let mut beyond = walk.cut;
            if plan.has_antimatter {
                match tracer.resolve(walk.cut, walk.ray.direction, hit) {
                    AntimatterEvent::Surface(cut) => beyond = cut,
                    AntimatterEvent::Nothing(cut) => {
                        tracer.note_shadow_hit(hit, walk.medium.shadow_transmission(hit.distance));
                        walk.pass(hit, cut);
                        tracer.note_shadow_bounce(walk.ray, BounceType::Passed, [1.0; BANDS]);
                        continue;
                    }
                }
            }
            if let Some(virtual_source) = light.virtual_sources.get(walk.virtual_form) {
                if virtual_source.member.primitive() == hit.primitive {
                    if !self.virtual_source(tracer, &mut walk, virtual_source, hit) {
                        return dark;
                    }
                    continue;
                }
            } else if light.primitive == Some(hit.primitive) {
                return arrive(tracer, &walk, light, hit, radiance);
            }
            let last = walk.virtual_form == light.virtual_sources.len();
            let crossing = self.cross(tracer, &mut walk, hit, plan.shader_at(hit.shader), last.then_some(light));
            let dimmed = walk.medium.shadow_transmission(hit.distance);
            tracer.note_shadow_hit(hit, dimmed);
            walk.through = product(walk.through, dimmed);
            let (direction, weight) = match crossing {
                ShadowEvent::Blocked => {
                    tracer.shadow_blockers.note(target, opaque_member(plan, hit.primitive));
                    return dark;
                }
                ShadowEvent::SpecularBounce(direction, weight) => {
                    tracer.note_shadow_side(hit);
                    (direction, weight)
                }
                ShadowEvent::Into(medium, direction, weight) => {
                    walk.medium = medium;
                    (direction, weight)
                }
            };
            walk.is_refracted |= direction != walk.ray.direction;
            walk.through = product(walk.through, weight);
            if walk.through.iter().all(|band| *band <= 0.0) {
                return dark;
            }
            walk.ray = Ray { origin: hit.point, direction };
            walk.from = Some(hit.primitive);
            walk.cut = beyond;
            tracer.note_shadow_bounce(walk.ray, BounceType::Transmitted { image: Image::InPlace }, weight);
        }
        dark
    }

    /// Passes a mirror or a prism on the path to the light; false if the ray ends.
    fn virtual_source<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        walk: &mut ShadowRay<BANDS>,
        virtual_source: &VirtualSource,
        hit: &Intersection,
    ) -> bool {
        if let Some(redirection) = &virtual_source.redirection {
            return redirect(tracer, walk, virtual_source, redirection, hit);
        }
        let dimmed = walk.medium.shadow_transmission(hit.distance);
        tracer.note_shadow_hit(hit, dimmed);
        if walk.ray.direction.dot(hit.front) >= 0.0 {
            return false;
        }
        walk.through = product(walk.through, dimmed);
        let length = walk.travelled - self.travelled;
        let reflectance = self.mirror_reflectance(tracer, virtual_source, (&walk.ray, hit.point), length);
        walk.through = product(walk.through, reflectance);
        walk.ray = Ray { origin: hit.point, direction: reflect(walk.ray.direction, hit.front) };
        walk.from = Some(hit.primitive);
        walk.virtual_form += 1;
        tracer.note_shadow_bounce(walk.ray, BounceType::Mirrored { image: Image::InPlace }, reflectance);
        walk.through.iter().any(|band| *band > 0.0)
    }

    /// The effect of a surface that is neither the light nor a mirror on the path; `target` is the
    /// light if the ray is aimed at it directly.
    fn cross<'p, const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'p, BANDS>,
        walk: &mut ShadowRay<BANDS>,
        hit: &Intersection,
        mut shader: &'p Shader,
        target: Option<&Light>,
    ) -> ShadowEvent<BANDS> {
        let plan = tracer.plan;
        let direction = walk.ray.direction;
        let behind = direction.dot(hit.front) > 0.0;
        let unchanged = ShadowEvent::SpecularBounce(direction, [1.0; BANDS]);
        loop {
            let substitute = match &shader.kind {
                Kind::Transparent => return unchanged,
                Kind::Illum { substitute, .. } => {
                    let is_weak =
                        |light: &Light| plan.shader(light.surface).kind.emitter().is_some_and(|e| e.is_weak());
                    if !behind && target.is_some_and(is_weak) {
                        return ShadowEvent::Blocked;
                    }
                    *substitute
                }
                Kind::Mirror { substitute: Some(substitute), .. } => match *substitute {
                    substitute if behind || !self.drawn => substitute,
                    Substitution::Shader(id) if plan.shader_at(id).kind.is_transparent() => *substitute,
                    _ => return ShadowEvent::Blocked,
                },
                _ => break,
            };
            match substitute {
                Substitution::Void => return unchanged,
                Substitution::Shader(id) => shader = plan.shader_at(id),
            }
        }
        let scene = &plan.scene;
        let global = tracer.global_medium();
        let interaction = SurfaceInteraction::at(&walk.ray, hit, walk.travelled);
        let scratch = &mut tracer.workspace.scratch;
        match &shader.kind {
            Kind::Dielectric(boundary) => {
                let (pattern, perturbation) = shader.body_appearance::<BANDS>(scene, &interaction, scratch);
                let [before, after] = boundary.sides(RaySide::of(direction, hit.front));
                let lights = walk.medium.lights;
                if let Some(before) = before {
                    walk.medium = Medium::absorbing(before, pattern, lights);
                }
                let after = match after {
                    Some(after) => Medium::absorbing(after, pattern, lights),
                    None => Medium { lights, ..global },
                };
                match boundary.refract(direction, hit.front, perturbation).transmitted {
                    Some((transmitted, factor)) => ShadowEvent::Into(after, transmitted, [factor; BANDS]),
                    None => ShadowEvent::Blocked,
                }
            }
            Kind::Mist(mist) => {
                let (pattern, _) = shader.body_appearance(scene, &interaction, scratch);
                let next = if behind {
                    walk.medium = mist.crossed(walk.medium, pattern);
                    mist.left(walk.medium, pattern, &global)
                } else {
                    mist.entered(walk.medium, pattern)
                };
                ShadowEvent::Into(next, direction, [1.0; BANDS])
            }
            _ => match straight(plan, shader, (&walk.ray, hit, walk.travelled), scratch) {
                Some(weight) => ShadowEvent::SpecularBounce(direction, weight),
                None => ShadowEvent::Blocked,
            },
        }
    }

    /// Transmittance to the light without refraction: 1 in each band if nothing is in between.
    fn visibility<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        light: &Light,
        sample: &LightSample,
        between: &VisibilityClass,
    ) -> [f64; BANDS] {
        let mut ray = Ray { origin: self.point, direction: sample.direction };
        let mut from = self.primitive;
        let mut left = sample.distance;
        let mut length = 0.0;
        let mut through = [1.0; BANDS];
        for mirror in &light.virtual_sources {
            let geometry = &tracer.plan.geometry;
            let frame = RayFrame::new(&ray);
            let scene = &tracer.plan.scene;
            let Some(crossing) = geometry.intersect(scene, mirror.member, &ray, &frame, from, left) else {
                return [0.0; BANDS];
            };
            let distance = crossing.distance;
            if ray.direction.dot(mirror.normal) >= 0.0 {
                return [0.0; BANDS];
            }
            length += distance;
            let reflectance = self.mirror_reflectance(tracer, mirror, (&ray, ray.at(distance)), length);
            through = product(through, reflectance);
            let clear = self.segment(tracer, &ray, from, distance, crossing.primitive, &VisibilityClass::Anything);
            through = product(through, clear);
            ray = Ray { origin: ray.at(distance), direction: mirror.image_of_direction(ray.direction) };
            from = Some(crossing.primitive);
            left -= distance;
            if through.iter().all(|band| *band == 0.0) {
                return through;
            }
        }
        let target = light.primitive.unwrap_or(PrimitiveId::NONE);
        product(through, self.segment(tracer, &ray, from, left, target, between))
    }

    /// The reflectance of a mirror for a ray that hits it at a point; `length` is that of the shadow
    /// ray so far, over all mirrors.
    fn mirror_reflectance<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        mirror: &VirtualSource,
        (ray, point): (&Ray, DVec3),
        length: f64,
    ) -> [f64; BANDS] {
        let shader = tracer.plan.virtual_source_shader(mirror.surface);
        let Kind::Mirror { reflectance, .. } = &shader.kind else { return [0.0; BANDS] };
        let interaction = SurfaceInteraction::new(ray, point, mirror.normal, length, self.travelled + length);
        let pattern = shader.appearance::<BANDS>(&tracer.plan.scene, &interaction, &mut tracer.workspace.scratch);
        product(bands(*reflectance), pattern.color)
    }

    /// One straight segment of a shadow ray, up to the primitive `target`.
    fn segment<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        ray: &Ray,
        from: Option<PrimitiveId>,
        distance: f64,
        target: PrimitiveId,
        between: &VisibilityClass,
    ) -> [f64; BANDS] {
        let plan = tracer.plan;
        let mut through = [1.0; BANDS];
        let travelled = self.travelled;
        // A surface coincident with the target may hide it.
        let tolerance = plan.geometry.tolerance();
        let is_searched = matches!(between, VisibilityClass::Within(_) | VisibilityClass::Anything);
        if is_searched && tracer.shadow_blockers.block_again(plan, (ray, from), distance - tolerance, target) {
            return [0.0; BANDS];
        }
        let mut blocker = None;
        let scratch = &mut tracer.workspace.scratch;
        let mut passed = plan.see_through.then(Passed::default);
        let mut is_blocked = false;
        let mut block = |crossing: Crossing| {
            if crossing.primitive == target {
                return false;
            }
            if crossing.distance > distance - tolerance {
                is_blocked = plan.geometry.chosen_near(&plan.scene, ray, from, distance) != Some(target);
                return is_blocked;
            }
            let open = if let Some(passed) = &mut passed {
                let hit = plan.geometry.hit(&plan.scene, &plan.shader_table, ray, crossing);
                let shader = plan.shader_at(hit.shader);
                passed.add(crossing.distance, tolerance);
                straight(plan, shader, (ray, &hit, travelled + hit.distance), scratch)
            } else {
                None
            };
            match open {
                Some(open) => through = product(through, open),
                None if plan.is_veiled(ray, from, &crossing) => {
                    passed.get_or_insert_default().is_tied = true;
                }
                None => {
                    blocker = Some(crossing);
                    is_blocked = true;
                }
            }
            is_blocked
        };
        let end = distance + tolerance;
        match between {
            VisibilityClass::Dark => is_blocked = true,
            VisibilityClass::Nothing => {}
            VisibilityClass::Few(list) => {
                let frame = RayFrame::new(ray);
                for member in list {
                    if plan.geometry.any_of_member(&plan.scene, *member, (ray, &frame), from, end, &mut block) {
                        break;
                    }
                }
            }
            VisibilityClass::Within(_) | VisibilityClass::Anything => {
                plan.geometry.any_between(&plan.scene, ray, (from, target), end, block);
            }
        }
        if is_searched {
            tracer.shadow_blockers.note(target, blocker.and_then(|crossing| opaque_member(plan, crossing.primitive)));
        }
        if is_blocked {
            return [0.0; BANDS];
        }
        match passed {
            Some(Passed { is_tied: true, .. }) => self.one_by_one(tracer, ray, from, distance),
            _ => through,
        }
    }

    /// [`DirectSampler::segment`] where transmitting surfaces are coincident: only one of them
    /// affects the ray.
    #[cold]
    fn one_by_one<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        ray: &Ray,
        from: Option<PrimitiveId>,
        distance: f64,
    ) -> [f64; BANDS] {
        let plan = tracer.plan;
        let scratch = &mut tracer.workspace.scratch;
        let end = distance - plan.geometry.tolerance();
        let (mut rest, mut from, mut gone) = (*ray, from, 0.0);
        let mut through = [1.0; BANDS];
        for _ in 0..MAX_CROSSINGS {
            let Some(hit) = plan.first_hit(&rest, from).filter(|hit| gone + hit.distance <= end) else {
                return through;
            };
            gone += hit.distance;
            let Some(open) = straight(plan, plan.shader_at(hit.shader), (ray, &hit, self.travelled + gone), scratch)
            else {
                return [0.0; BANDS];
            };
            through = product(through, open);
            (rest.origin, from) = (hit.point, Some(hit.primitive));
        }
        [0.0; BANDS]
    }
}

/// The surfaces crossed by a shadow ray, to detect coincident ones.
#[derive(Default)]
struct Passed {
    distances: [f64; MAX_PASSED],
    count: usize,
    is_tied: bool,
}

/// Maximum number of surfaces on a shadow ray that are compared with each other.
const MAX_PASSED: usize = 16;

impl Passed {
    #[inline]
    fn add(&mut self, distance: f64, tolerance: f64) {
        self.is_tied |= self.distances[..self.count].iter().any(|passed| (passed - distance).abs() <= tolerance);
        if let Some(slot) = self.distances.get_mut(self.count) {
            *slot = distance;
            self.count += 1;
        }
    }
}

/// Redirects a shadow ray at a prism on the path to its light; false if the ray ends.
fn redirect<const BANDS: usize>(
    tracer: &mut PathIntegrator<'_, BANDS>,
    walk: &mut ShadowRay<BANDS>,
    virtual_source: &VirtualSource,
    redirection: &Redirection,
    hit: &Intersection,
) -> bool {
    let Kind::Prism(prism) = &tracer.plan.virtual_source_shader(virtual_source.surface).kind else { return false };
    let Redirection { face, target, is_distant } = *redirection;
    let aim = if is_distant { target } else { (target - hit.point).normalize_or_zero() };
    let interaction = SurfaceInteraction::at(&walk.ray, hit, walk.travelled);
    let found = prism.redirect(face, &interaction, aim, &mut tracer.workspace.scratch);
    let Some((coefficient, direction)) = found else { return false };
    let dimmed = walk.medium.shadow_transmission(hit.distance);
    tracer.note_shadow_hit(hit, dimmed);
    walk.through = product(walk.through, dimmed).map(|band| band * coefficient);
    walk.ray = Ray { origin: hit.point, direction };
    tracer.note_shadow_bounce(walk.ray, BounceType::Transmitted { image: Image::InPlace }, [coefficient; BANDS]);
    walk.from = Some(hit.primitive);
    walk.virtual_form += 1;
    walk.is_refracted = true;
    true
}

/// The straight transmittance of a surface; `None` if it is opaque.
fn straight<const BANDS: usize>(
    plan: &RenderPlan,
    shader: &Shader,
    (ray, hit, travelled): (&Ray, &Intersection, f64),
    scratch: &mut Scratch,
) -> Option<[f64; BANDS]> {
    if matches!(shader.kind, Kind::Transparent) {
        return Some([1.0; BANDS]);
    }
    if !shader.lets_light_through() {
        return None;
    }
    // `-bv-` affects transmitting surfaces only: in Radiance opaque ones cast shadows from behind
    // as well.
    let behind = ray.direction.dot(hit.front) > 0.0;
    if behind && plan.hides_its_back(shader) {
        return Some([1.0; BANDS]);
    }
    let interaction = SurfaceInteraction::at(ray, hit, travelled);
    if let Kind::Mixture(mixture) = &shader.kind {
        // After an error of the function the surface has no material.
        let Some(share) = mixture.share.at(shader.textures.home.scene(&plan.scene), &interaction, scratch) else {
            return Some([1.0; BANDS]);
        };
        let mut through = None;
        for (weight, arm) in [share, 1.0 - share].into_iter().zip(mixture.arms) {
            if weight > 0.0
                && let Some(part) = straight::<BANDS>(plan, plan.shader_at(arm), (ray, hit, travelled), scratch)
            {
                let sum = through.get_or_insert([0.0; BANDS]);
                *sum = std::array::from_fn(|band| sum[band] + weight * part[band]);
            }
        }
        return through;
    }
    let appearance = shader.appearance::<BANDS>(&plan.scene, &interaction, scratch);
    match &shader.kind {
        Kind::Glass { transmissivity, refractive_index } => {
            let cosine = -ray.direction.dot(shading_normal(&interaction, appearance.perturbation));
            let [_, transmitted] = pane(bands(*transmissivity), *refractive_index, cosine.max(1e-9));
            Some(product(transmitted, appearance.color))
        }
        Kind::Scatterer(scatterer) => {
            scatterer.passage(shader.textures.home.scene(&plan.scene), &interaction, appearance, scratch)
        }
        Kind::Unusable(_) => {
            plan.note_unusable(hit.surface, shader);
            None
        }
        _ => None,
    }
}

/// The radiance of a shadow ray that hits its light.
fn arrive<const BANDS: usize>(
    tracer: &mut PathIntegrator<'_, BANDS>,
    walk: &ShadowRay<BANDS>,
    light: &Light,
    hit: &Intersection,
    radiance: [f64; BANDS],
) -> [f64; BANDS] {
    let plan = tracer.plan;
    tracer.note_shadow_hit(hit, walk.medium.shadow_transmission(hit.distance));
    let mut found = radiance;
    if walk.is_refracted {
        if walk.ray.direction.dot(hit.front) >= 0.0 {
            return [0.0; BANDS];
        }
        let shader = plan.shader(light.surface);
        let Some(emitter) = shader.kind.emitter() else { return [0.0; BANDS] };
        let interaction = SurfaceInteraction::at(&walk.ray, hit, walk.travelled);
        found = given(emission(&plan.scene, shader, emitter, &interaction, &mut tracer.workspace.scratch));
    }
    tracer.note_shadow_found(None, found);
    product(product(found, walk.through), walk.medium.shadow_transmission(hit.distance))
}

/// The radiance of a shadow ray that leaves the scene.
fn leave<const BANDS: usize>(
    tracer: &mut PathIntegrator<'_, BANDS>,
    walk: &ShadowRay<BANDS>,
    light: &Light,
    radiance: [f64; BANDS],
) -> [f64; BANDS] {
    let plan = tracer.plan;
    let Shape::Source(source) = plan.scene.surfaces[light.surface].shape else { return [0.0; BANDS] };
    if walk.virtual_form < light.virtual_sources.len() {
        return [0.0; BANDS];
    }
    let mut found = radiance;
    if walk.is_refracted {
        let source = &plan.scene.sources[source];
        let sin = (0.25 * source.extent.full_angle).sin();
        if 0.25 * source.direction.distance_squared(walk.ray.direction) > sin * sin {
            return [0.0; BANDS];
        }
        let shader = plan.shader(light.surface);
        let Some(emitter) = shader.kind.emitter() else { return [0.0; BANDS] };
        let interaction = SurfaceInteraction::distant(&walk.ray);
        found = given(emission(&plan.scene, shader, emitter, &interaction, &mut tracer.workspace.scratch));
    }
    tracer.note_shadow_found(Some(light.surface), found);
    product(product(found, walk.through), walk.medium.shadow_transmission(f64::INFINITY))
}
