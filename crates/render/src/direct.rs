//! Direct light: from each light, a place on it, drawn with its true extent.

use crate::antimatter::CutId;
use crate::light::{Light, LightForm, LightId, LightSample};
use crate::plan::RenderPlan;
use crate::ray::PrimitiveId;
use crate::reach::Between;
use crate::surface_light::{Densities, Highlight, LitPoint, Response};
use crate::tilt::Peak;
use crate::trace::{MediumId, Tracer, emission, product};
use crate::view::Encounter;
use glam::DVec3;
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
    /// What fills the space around it.
    pub(crate) medium: MediumId,
    /// What is cut for rays to the side of the normal, and to the other.
    pub(crate) cuts: [CutId; 2],
    /// Unit.
    pub(crate) normal: DVec3,
    /// Whether the path to it has a drawn ray.
    pub(crate) drawn: bool,
}

/// A light and its place in the plan's list.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NumberedLight<'p> {
    pub(crate) index: usize,
    pub(crate) light: &'p Light,
}

impl DirectSampler {
    /// What is cut for a ray that leaves in this direction.
    pub(crate) fn cut_towards(&self, direction: DVec3) -> CutId {
        self.cuts[usize::from(self.normal.dot(direction) < 0.0)]
    }

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
            return match point.highlight {
                Highlight::Model(model) => self.sample_all_of_model(tracer, point, model, first_set),
                _ => self.sample_all(tracer, point, first_set),
            };
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
        let mut sum = [0.0; BANDS];
        self.for_each_light(tracer, first_set, |tracer, light, between, u| {
            let given = self.sample_light(tracer, point, light.light, between, u, 1.0);
            for (sum, given) in sum.iter_mut().zip(given) {
                *sum += given;
            }
        });
        sum
    }

    /// Calls for each light that can give something here, with what stands between and a point of the unit square.
    #[inline]
    pub(crate) fn for_each_light<'p, const BANDS: usize>(
        &self,
        tracer: &mut Tracer<'p, BANDS>,
        first_set: u32,
        mut visit: impl FnMut(&mut Tracer<'p, BANDS>, NumberedLight<'p>, &'p Between, [f64; 2]),
    ) {
        let plan = tracer.plan;
        let receiver = self.primitive.and_then(|primitive| plan.receiver(primitive));
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
            visit(tracer, NumberedLight { index, light }, between, [drawn.1[half], drawn.1[half + 1]]);
        }
    }

    /// What stands between the point and a light.
    pub(crate) fn between<'p>(&self, plan: &'p RenderPlan, light: usize) -> &'p Between {
        let receiver = self.primitive.and_then(|primitive| plan.receiver(primitive));
        receiver.map_or(&Between::Anything, |receiver| &receiver.between[light])
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
        let Some(sample) = self.place(light, u) else { return [0.0; BANDS] };
        let densities = if self.highlight_draws > 0 { Densities::Wanted } else { Densities::Unused };
        let scratch = &mut tracer.workspace.scratch;
        let response = point.respond(sample.direction, sample.density, densities, scratch);
        self.gather(tracer, light, &sample, between, expected, &response)
    }

    /// A place on a light that can give something.
    #[inline]
    pub(crate) fn place(&self, light: &Light, u: [f64; 2]) -> Option<LightSample> {
        light.sample(self.point, u, &self.peak).filter(|sample| sample.distance <= light.max_distance)
    }

    /// What one place gives to a point that responds to it like this.
    #[inline]
    pub(crate) fn gather<const BANDS: usize>(
        &self,
        tracer: &mut Tracer<'_, BANDS>,
        light: &Light,
        sample: &LightSample,
        between: &Between,
        expected: f64,
        response: &Response<BANDS>,
    ) -> [f64; BANDS] {
        let dark = [0.0; BANDS];
        let density = sample.density * expected;
        // No drawn ray is followed to a light by way of a prism.
        let shares_diffuse = self.shares_diffuse && !light.is_redirected();
        let diffuse_share = if shares_diffuse { density / (density + response.diffuse_density) } else { 1.0 };
        let drawn = if light.is_redirected() { 0 } else { self.highlight_draws };
        let drawn_density = f64::from(drawn) * response.highlight_density;
        let highlight_share = density / (density + drawn_density);
        let mut weight: [f64; BANDS] = std::array::from_fn(|band| {
            (response.diffuse[band] * diffuse_share + response.highlight[band] * highlight_share) / density
        });
        if weight.iter().all(|band| *band == 0.0) {
            return dark;
        }
        if light.focal_distance > 0.0 {
            weight = weight.map(|band| band * light.focal_factor(sample.distance));
        }
        let radiance = self.radiance(tracer, light, sample);
        if product(weight, radiance).iter().all(|band| *band == 0.0) {
            return dark;
        }
        let arriving = self.arriving(tracer, light, sample, between, radiance);
        product(weight, arriving)
    }

    /// Radiance that comes from a light to a point in space, from one place on the light, scaled by `weight` of the direction to it and divided
    /// by the density of the place.
    pub(crate) fn light_at<const BANDS: usize>(
        &self,
        tracer: &mut Tracer<'_, BANDS>,
        light: &Light,
        u: [f64; 2],
        weight: impl Fn(DVec3) -> f64,
    ) -> [f64; BANDS] {
        let dark = [0.0; BANDS];
        if light.misses(self.point) {
            return dark;
        }
        let Some(sample) = self.place(light, u) else { return dark };
        let focal = light.focal_factor(sample.distance);
        let radiance = self.radiance(tracer, light, &sample);
        if radiance.iter().all(|band| *band == 0.0) {
            return dark;
        }
        let scale = focal * weight(sample.direction) / sample.density;
        self.arriving(tracer, light, &sample, &Between::Anything, radiance).map(|band| band * scale)
    }

    /// Radiance of the place in the direction of the point.
    pub(crate) fn radiance<const BANDS: usize>(
        &self,
        tracer: &mut Tracer<'_, BANDS>,
        light: &Light,
        sample: &LightSample,
    ) -> [f64; BANDS] {
        let plan = tracer.plan;
        if light.is_redirected() {
            // What arrives is known when it has arrived.
            return [1.0; BANDS];
        }
        let shader = plan.shader(light.surface);
        let Some(emitter) = shader.kind.emitter() else { return [0.0; BANDS] };
        let ray = light.real_ray(self.point, sample.direction);
        let distant = matches!(light.form, LightForm::Distant { .. });
        let encounter = if distant {
            Encounter::distant(ray.direction)
        } else {
            let normal = light.relays.iter().fold(sample.normal, |normal, relay| relay.image_of_direction(normal));
            let total = self.travelled + sample.distance;
            Encounter::new(&ray, ray.at(sample.distance), normal, sample.distance, total)
        };
        emission(plan, shader, emitter, &encounter, &mut tracer.workspace.scratch)
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
    let Some(emitter) = plan.shader(light.surface).kind.emitter() else { return 0.0 };
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
