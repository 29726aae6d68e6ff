//! Direct light: from each light, a place on it, drawn with its true extent.

use crate::geometry::RayFrame;
use crate::light::{Light, LightForm, LightId, LightSample};
use crate::plan::RenderPlan;
use crate::ray::{Crossing, PrimitiveId, Ray};
use crate::reach::Between;
use crate::shader::{Kind, Shader, bands};
use crate::surface_light::{Densities, LitPoint, pane};
use crate::tilt::Peak;
use crate::trace::{Tracer, emission, product};
use crate::view::Encounter;
use glam::DVec3;
use radsight_cal::Scratch;
use radsight_sampling::DimensionSet;

/// Up to this many lights each one is sampled at every point.
const SAMPLE_ALL: usize = 64;

/// Beyond that, this many are drawn by their promise.
const DRAWN_LIGHTS: usize = 16;

/// The direct light at one point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DirectSampler {
    pub(crate) point: DVec3,
    pub(crate) primitive: Option<PrimitiveId>,
    /// How many rays are also drawn from the highlight, so that the two share the work.
    pub(crate) highlight_draws: u32,
    /// Whether one is drawn from the diffuse component that can find lights too.
    pub(crate) shares_diffuse: bool,
    /// Where on a light the highlight is bright.
    pub(crate) peak: Peak,
    pub(crate) travelled: f64,
}

impl DirectSampler {
    /// Radiance that the point sends on from all lights.
    pub(crate) fn sample<const BANDS: usize>(
        &self,
        tracer: &mut Tracer<'_, BANDS>,
        point: &LitPoint<'_, BANDS>,
    ) -> [f64; BANDS] {
        let count = tracer.plan.lights.len();
        let first_set = tracer.next_set;
        if count <= SAMPLE_ALL {
            tracer.next_set += count.div_ceil(2) as u32;
            return self.sample_all(tracer, point, first_set);
        }
        tracer.next_set += DRAWN_LIGHTS as u32;
        self.sample_some(tracer, point, first_set)
    }

    fn sample_all<const BANDS: usize>(
        &self,
        tracer: &mut Tracer<'_, BANDS>,
        point: &LitPoint<'_, BANDS>,
        first_set: u32,
    ) -> [f64; BANDS] {
        let plan = tracer.plan;
        let receiver = self.primitive.and_then(|primitive| plan.receiver(primitive));
        let mut sum = [0.0; BANDS];
        let mut drawn: (u32, [f64; 4]) = (u32::MAX, [0.0; 4]);
        for (index, light) in plan.lights.iter().enumerate() {
            let between = receiver.map_or(&Between::Anything, |receiver| &receiver.between[index]);
            if *between == Between::Dark || light.misses(self.point) {
                continue;
            }
            // Two lights share a set of four dimensions.
            let set = first_set + (index / 2) as u32;
            if drawn.0 != set {
                drawn = (set, tracer.sampler.take(DimensionSet::render(set)));
            }
            let half = 2 * (index % 2);
            let light = self.sample_light(tracer, point, light, between, [drawn.1[half], drawn.1[half + 1]], 1.0);
            for (sum, light) in sum.iter_mut().zip(light) {
                *sum += light;
            }
        }
        sum
    }

    /// Draws some lights with probability in proportion to a bound on what they can give (unbiased: each is divided by its chance).
    fn sample_some<const BANDS: usize>(
        &self,
        tracer: &mut Tracer<'_, BANDS>,
        point: &LitPoint<'_, BANDS>,
        first_set: u32,
    ) -> [f64; BANDS] {
        let plan = tracer.plan;
        let mut promises = std::mem::take(&mut tracer.workspace.promises);
        promises.clear();
        let mut total = 0.0;
        for index in 0..plan.lights.len() {
            total += promise(plan, self.point, self.primitive, index);
            promises.push(total);
        }
        let mut sum = [0.0; BANDS];
        if total > 0.0 {
            for draw in 0..DRAWN_LIGHTS {
                let u = tracer.sampler.take(DimensionSet::render(first_set + draw as u32));
                let pick = (draw as f64 + u[2]) / DRAWN_LIGHTS as f64 * total;
                let index = promises.partition_point(|cumulative| *cumulative <= pick).min(promises.len() - 1);
                let own = promises[index] - if index == 0 { 0.0 } else { promises[index - 1] };
                let expected = DRAWN_LIGHTS as f64 * own / total;
                let light = &plan.lights[index];
                let between = Between::Anything;
                let given = self.sample_light(tracer, point, light, &between, [u[0], u[1]], expected);
                for (sum, given) in sum.iter_mut().zip(given) {
                    *sum += given;
                }
            }
        }
        tracer.workspace.promises = promises;
        sum
    }

    /// What one place on one light gives; `expected` is how often the light is drawn on average.
    fn sample_light<const BANDS: usize>(
        &self,
        tracer: &mut Tracer<'_, BANDS>,
        point: &LitPoint<'_, BANDS>,
        light: &Light,
        between: &Between,
        u: [f64; 2],
        expected: f64,
    ) -> [f64; BANDS] {
        let dark = [0.0; BANDS];
        let Some(sample) = light.sample(self.point, u, &self.peak) else { return dark };
        if sample.distance > light.max_distance {
            return dark;
        }
        let densities = if self.highlight_draws > 0 { Densities::Wanted } else { Densities::Unused };
        let scratch = &mut tracer.workspace.scratch;
        let response = point.respond(sample.direction, sample.density, densities, scratch);
        let density = sample.density * expected;
        let diffuse_share = if self.shares_diffuse { density / (density + response.diffuse_density) } else { 1.0 };
        let drawn_density = f64::from(self.highlight_draws) * response.highlight_density;
        let highlight_share = density / (density + drawn_density);
        let mut value: [f64; BANDS] = std::array::from_fn(|band| {
            (response.diffuse[band] * diffuse_share + response.highlight[band] * highlight_share) / density
        });
        if value.iter().all(|band| *band == 0.0) {
            return dark;
        }
        if light.focal_distance > 0.0 {
            let focal = (sample.distance / (sample.distance + light.focal_distance)).powi(2);
            value = value.map(|band| band * focal);
        }
        let radiance = self.radiance(tracer, light, &sample);
        let value = product(value, radiance);
        if value.iter().all(|band| *band == 0.0) {
            return dark;
        }
        product(value, self.visibility(tracer, light, &sample, between))
    }

    /// Radiance of the place in the direction of the point.
    fn radiance<const BANDS: usize>(
        &self,
        tracer: &mut Tracer<'_, BANDS>,
        light: &Light,
        sample: &LightSample,
    ) -> [f64; BANDS] {
        let plan = tracer.plan;
        let shader = plan.shader(light.surface);
        let Kind::Emitter(emitter) = &shader.kind else { return [0.0; BANDS] };
        let ray = light.real_ray(self.point, sample.direction);
        let distant = matches!(light.form, LightForm::Distant { .. });
        let encounter = if distant {
            Encounter::distant(ray.direction)
        } else {
            let normal = light.mirrors.iter().fold(sample.normal, |normal, mirror| mirror.image_of_direction(normal));
            let total = self.travelled + sample.distance;
            Encounter::new(&ray, ray.at(sample.distance), normal, sample.distance, total)
        };
        emission(plan, shader, emitter, &encounter, &mut tracer.workspace.scratch)
    }

    /// How much of the light comes through: 1 in each band where nothing is in the way.
    fn visibility<const BANDS: usize>(
        &self,
        tracer: &mut Tracer<'_, BANDS>,
        light: &Light,
        sample: &LightSample,
        between: &Between,
    ) -> [f64; BANDS] {
        let mut ray = Ray { origin: self.point, direction: sample.direction };
        let mut from = self.primitive;
        let mut left = sample.distance;
        let mut through = [1.0; BANDS];
        for mirror in &light.mirrors {
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
            let reflectance = self.mirror_reflectance(tracer, mirror, &ray, distance);
            through = product(through, reflectance);
            let clear = self.segment(tracer, &ray, from, distance, crossing.primitive, &Between::Anything);
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

    fn mirror_reflectance<const BANDS: usize>(
        &self,
        tracer: &mut Tracer<'_, BANDS>,
        mirror: &crate::light::Mirror,
        ray: &Ray,
        distance: f64,
    ) -> [f64; BANDS] {
        let shader = tracer.plan.shader(mirror.surface);
        let Kind::Mirror { reflectance } = &shader.kind else { return [0.0; BANDS] };
        let total = self.travelled + distance;
        let encounter = Encounter::new(ray, ray.at(distance), mirror.normal, distance, total);
        let pattern = shader.appearance::<BANDS>(&tracer.plan.scene, &encounter, &mut tracer.workspace.scratch);
        product(bands(*reflectance), pattern.color)
    }

    /// One straight piece of a shadow ray, up to the primitive `target`.
    fn segment<const BANDS: usize>(
        &self,
        tracer: &mut Tracer<'_, BANDS>,
        ray: &Ray,
        from: Option<PrimitiveId>,
        distance: f64,
        target: PrimitiveId,
        between: &Between,
    ) -> [f64; BANDS] {
        let plan = tracer.plan;
        let mut through = [1.0; BANDS];
        // The target itself lies at the end, give or take rounding.
        let end = distance * (1.0 - 1e-9);
        let travelled = self.travelled;
        let scratch = &mut tracer.workspace.scratch;
        let mut block = |crossing: Crossing| {
            if crossing.primitive == target {
                return false;
            }
            if !plan.see_through {
                through = [0.0; BANDS];
                return true;
            }
            let hit = plan.geometry.hit(&plan.scene, &plan.shader_table, ray, crossing);
            let shader = plan.shader_at(hit.shader);
            if matches!(shader.kind, Kind::Transparent) {
                return false;
            }
            let behind = ray.direction.dot(hit.front) > 0.0;
            if behind && plan.options.back_faces == crate::BackFaces::Invisible && shader.can_hide_its_back() {
                return false;
            }
            let encounter = Encounter::at(ray, &hit, travelled + hit.distance);
            match passage(plan, shader, &encounter, scratch) {
                Some(share) => through = product(through, share),
                None => through = [0.0; BANDS],
            }
            through.iter().all(|band| *band == 0.0)
        };
        match between {
            Between::Dark => through = [0.0; BANDS],
            Between::Nothing => {}
            Between::Few(list) => {
                let frame = RayFrame::new(ray);
                for member in list {
                    if plan.geometry.any_of_member(&plan.scene, *member, (ray, &frame), from, end, &mut block) {
                        break;
                    }
                }
            }
            Between::Anything => {
                plan.geometry.any_between(&plan.scene, ray, from, end, block);
            }
        }
        through
    }
}

/// What of a shadow ray goes on through a surface; none where it is opaque.
fn passage<const BANDS: usize>(
    plan: &RenderPlan,
    shader: &Shader,
    encounter: &Encounter,
    scratch: &mut Scratch,
) -> Option<[f64; BANDS]> {
    if !shader.lets_light_through() {
        return None;
    }
    let appearance = shader.appearance::<BANDS>(&plan.scene, encounter, scratch);
    match &shader.kind {
        Kind::Glass { transmissivity, refractive_index } => {
            let [_, transmitted] = pane(bands(*transmissivity), *refractive_index, encounter.cosine.max(1e-9));
            Some(product(transmitted, appearance.color))
        }
        Kind::Scatterer(scatterer) => scatterer.passage(shader.home.scene(&plan.scene), encounter, appearance, scratch),
        _ => None,
    }
}

/// A bound on what a light can give at a point, up to a common factor.
fn promise(plan: &RenderPlan, point: DVec3, primitive: Option<PrimitiveId>, index: usize) -> f64 {
    let light = &plan.lights[index];
    let dark = primitive
        .and_then(|primitive| plan.receiver(primitive))
        .is_some_and(|receiver| receiver.between[index] == Between::Dark);
    if dark || light.misses(point) {
        return 0.0;
    }
    let Kind::Emitter(emitter) = &plan.shader(light.surface).kind else { return 0.0 };
    let strength = emitter.radiance.0.iter().copied().fold(0.0, f64::max);
    if light.radius.is_infinite() {
        return strength * light.form.solid_angle(1.0);
    }
    let squared = point.distance_squared(light.center).max(light.radius * light.radius);
    let nearest = (squared.sqrt() - light.radius).max(0.0);
    if nearest > light.max_distance {
        return 0.0;
    }
    strength * light.form.area() / squared
}

/// How often a light is drawn at a point, on average.
pub(crate) fn selection_density(plan: &RenderPlan, point: DVec3, primitive: Option<PrimitiveId>, id: LightId) -> f64 {
    if plan.lights.len() <= SAMPLE_ALL {
        return 1.0;
    }
    let total: f64 = (0..plan.lights.len()).map(|index| promise(plan, point, primitive, index)).sum();
    DRAWN_LIGHTS as f64 * promise(plan, point, primitive, id.0 as usize) / total
}
