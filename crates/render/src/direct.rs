//! Direct light: samples points on each light, over its true extent.

use crate::specular_return::SpecularReturn;
use crate::subtraction::SubtractionId;
use crate::trace::PathIntegrator;
use crate::trace::path_state::MediumId;
use glam::DVec3;
use radsight_accel::{Beam, PrimitiveId, Shaft};
use radsight_bsdf::{Bsdf, BsdfValue, Highlight, PdfRequest};
use radsight_compile::{RenderPlan, VisibilityClass, VisiblePortals, emission, given, uniform_emission};
use radsight_light::{Light, LightForm, LightSample, LightSampler, LightTree, MOST_SAMPLES, Reception, TreeCut};
use radsight_sampling::DimensionSet;
use radsight_texture::{SurfaceInteraction, product};

/// The direct light at one point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DirectSampler<'o> {
    pub(crate) point: DVec3,
    pub(crate) primitive: Option<PrimitiveId>,
    /// Number of rays drawn from the highlight as well, for multiple importance sampling.
    pub(crate) highlight_draws: u32,
    /// Whether a ray is drawn from the diffuse component that can hit lights as well.
    pub(crate) shares_diffuse: bool,
    /// Portals to which that ray may be directed.
    pub(crate) visible_portals: Option<&'o VisiblePortals<'o>>,
    /// Images of lights to which rays are directed, in addition to the highlight.
    pub(crate) specular_return: Option<&'o SpecularReturn>,
    /// The receiver's response to lights, and where on a light the highlight is.
    pub(crate) reception: Reception,
    pub(crate) travelled: f64,
    /// The medium around the point.
    pub(crate) medium: MediumId,
    /// The subtraction for rays on the side of the normal, and on the other side.
    pub(crate) cuts: [SubtractionId; 2],
    /// Unit.
    pub(crate) normal: DVec3,
    /// Whether the path to it contains a sampled ray.
    pub(crate) drawn: bool,
    /// The unit normal of an opaque point, which receives no light from behind.
    pub(crate) facing: Option<DVec3>,
}

/// A light and its index in the plan.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NumberedLight<'p> {
    pub(crate) index: usize,
    pub(crate) sampler: LightSampler<'p>,
    /// Number of points sampled on it.
    pub(crate) samples: u32,
}

/// A light that can contribute.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ReachingLight<'p> {
    pub(crate) index: usize,
    pub(crate) light: &'p Light,
    pub(crate) between: &'p VisibilityClass,
}

/// The numbers of a set of four dimensions.
pub(crate) struct DrawnSet {
    set: u32,
    numbers: [f64; 4],
}

impl DrawnSet {
    /// No set yet.
    pub(crate) fn none() -> DrawnSet {
        DrawnSet { set: u32::MAX, numbers: [0.0; 4] }
    }

    /// The set of a light, and its first dimension in it: two lights share a set.
    fn of(light: usize, first_set: u32) -> (u32, usize) {
        (first_set + (light / 2) as u32, 2 * (light % 2))
    }

    /// The point of the unit square for one sample of a light.
    fn point<const BANDS: usize>(
        &mut self,
        tracer: &PathIntegrator<'_, BANDS>,
        light: usize,
        first_set: u32,
    ) -> [f64; 2] {
        let (set, half) = DrawnSet::of(light, first_set);
        if self.set != set {
            *self = DrawnSet { set, numbers: tracer.sampler.take(DimensionSet::render(set)) };
        }
        [self.numbers[half], self.numbers[half + 1]]
    }
}

impl DirectSampler<'_> {
    /// The subtraction for a ray in this direction.
    pub(crate) fn subtraction_towards(&self, direction: DVec3) -> SubtractionId {
        self.cuts[usize::from(self.normal.dot(direction) < 0.0)]
    }

    /// Radiance reflected and transmitted by the point from all lights.
    pub(crate) fn sample<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        point: &Bsdf<'_, BANDS>,
    ) -> [f64; BANDS] {
        let plan = tracer.plan;
        let first_set = tracer.next_set;
        if let (Some(tree), 1..) = (&plan.light_tree, self.reception.draws) {
            tracer.next_set += 1 + self.reception.draws.div_ceil(2);
            return self.sample_some(tracer, point, tree, first_set);
        }
        tracer.next_set += plan.lights.len().div_ceil(2) as u32;
        match point.highlight {
            Highlight::Model(model) => self.sample_all_of_model(tracer, point, model, first_set),
            _ if self.selects_shadow_rays(tracer) => match tracer.recorder.take() {
                Some(mut recorder) => {
                    let sum = self.sample_and_record(tracer, point, first_set, &mut recorder);
                    tracer.recorder = Some(recorder);
                    sum
                }
                None => self.sample_strong(tracer, point, first_set),
            },
            _ => self.sample_all(tracer, point, first_set),
        }
    }

    fn sample_all<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        point: &Bsdf<'_, BANDS>,
        first_set: u32,
    ) -> [f64; BANDS] {
        let cubature = self.light_cubature(tracer, point);
        let mut sum = [0.0; BANDS];
        let mut add = |given: [f64; BANDS]| sum.iter_mut().zip(given).for_each(|(sum, given)| *sum += given);
        self.for_each_reaching_light(tracer, |tracer, lit, drawn| {
            if let Some((allowed, lobe)) = &cubature {
                let u = |tracer: &mut PathIntegrator<'_, BANDS>| drawn.point(tracer, lit.index, first_set);
                if let Some(given) = self.integrate(tracer, (*allowed, lobe), &lit, u) {
                    return add(given);
                }
            }
            self.for_each_point(tracer, &lit, (first_set, drawn), |tracer, light, between, u| {
                add(self.sample_light(tracer, point, &light.sampler, between, u, f64::from(light.samples)));
            });
        });
        sum
    }

    /// Calls `visit` for each light that can contribute, with its visibility class and a point of
    /// the unit square.
    #[inline]
    pub(crate) fn for_each_light<'p, const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'p, BANDS>,
        first_set: u32,
        mut visit: impl FnMut(&mut PathIntegrator<'p, BANDS>, &NumberedLight<'p>, &'p VisibilityClass, [f64; 2]),
    ) {
        self.for_each_reaching_light(tracer, |tracer, lit, drawn| {
            self.for_each_point(tracer, &lit, (first_set, drawn), &mut visit);
        });
    }

    /// Calls `visit` for each light that can contribute.
    #[inline]
    fn for_each_reaching_light<'p, const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'p, BANDS>,
        mut visit: impl FnMut(&mut PathIntegrator<'p, BANDS>, ReachingLight<'p>, &mut DrawnSet),
    ) {
        let plan = tracer.plan;
        let receiver = self.primitive.and_then(|primitive| plan.receiver(primitive));
        let mut drawn = DrawnSet::none();
        for (index, light) in plan.lights.iter().enumerate() {
            let between = receiver.map_or(&VisibilityClass::Anything, |receiver| &receiver.between[index]);
            if self.may_receive(light, between) {
                visit(tracer, ReachingLight { index, light, between }, &mut drawn);
            }
        }
    }

    /// Whether a light can contribute.
    #[inline]
    pub(crate) fn may_receive(&self, light: &Light, between: &VisibilityClass) -> bool {
        *between != VisibilityClass::Dark && !light.misses(self.point) && !self.faces_away(light)
    }

    /// Calls `visit` for each point to be sampled on a light.
    #[inline]
    pub(crate) fn for_each_point<'p, const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'p, BANDS>,
        &ReachingLight { index, light, between }: &ReachingLight<'p>,
        (first_set, drawn): (u32, &mut DrawnSet),
        mut visit: impl FnMut(&mut PathIntegrator<'p, BANDS>, &NumberedLight<'p>, &'p VisibilityClass, [f64; 2]),
    ) {
        let samples = self.reception.samples_on(light, self.point);
        tracer.samples_highlight |= samples > 1 && self.reception.highlight_samples(light, self.point) > 1.0;
        // Without shadow rays, twice as many points cost less.
        let (between, samples) = if samples >= SAMPLES_FOR_A_SHAFT && self.sees_all_of(tracer.plan, light, between) {
            (&VisibilityClass::Nothing, (2 * samples).min(MOST_SAMPLES))
        } else {
            (between, samples)
        };
        let numbered = NumberedLight { index, sampler: light.sampler(self.point, &self.reception.peak), samples };
        if samples == 1 {
            let u = drawn.point(tracer, index, first_set);
            return visit(tracer, &numbered, between, u);
        }
        let sampler = tracer.sampler;
        let (set, half) = DrawnSet::of(index, first_set);
        for light_sample in 0..samples {
            let u = sampler
                .branch(DimensionSet::render(set), light_sample, samples)
                .take(DimensionSet::render(half as u32));
            visit(tracer, &numbered, between, [u[0], u[1]]);
        }
    }

    /// Whether nothing is between the point and any point of a light that something may block.
    pub(crate) fn sees_all_of(&self, plan: &RenderPlan, light: &Light, between: &VisibilityClass) -> bool {
        if !light.virtual_sources.is_empty() {
            return false;
        }
        match between {
            VisibilityClass::Few(blockers) if light.radius.is_finite() => {
                let beam = Beam { from: self.point, to: light.center, radius: light.radius };
                !blockers.iter().any(|blocker| plan.geometry.may_block(&plan.scene, *blocker, &beam))
            }
            VisibilityClass::Within(bounds) if light.radius.is_finite() => {
                let beam = Beam { from: self.point, to: light.center, radius: light.radius };
                beam.misses_bounds(bounds, plan.geometry.tolerance()) || self.has_empty_shaft(plan, light)
            }
            VisibilityClass::Within(_) | VisibilityClass::Anything => self.has_empty_shaft(plan, light),
            VisibilityClass::Few(_) | VisibilityClass::Dark | VisibilityClass::Nothing => false,
        }
    }

    /// Whether nothing is in the shaft to a light; false where there is no shaft.
    fn has_empty_shaft(&self, plan: &RenderPlan, light: &Light) -> bool {
        let ends = [self.primitive, light.primitive];
        let is_empty = |shaft: &Shaft| !plan.geometry.reaches_into(&plan.scene, shaft, ends);
        light.form.shaft(self.point).as_ref().is_some_and(is_empty)
    }

    /// Whether a light is entirely behind an opaque point. Skies consist of hundreds of suns, half of
    /// them behind each wall.
    fn faces_away(&self, light: &Light) -> bool {
        match (self.facing, &light.form) {
            (Some(normal), LightForm::Distant { direction, half_angle_sin_squared_half, .. }) => {
                let (half, above) = (*half_angle_sin_squared_half, normal.dot(*direction));
                half < 0.5 && above < 0.0 && above * above > 4.0 * half * (1.0 - half)
            }
            (Some(normal), _) if light.virtual_sources.is_empty() => {
                // False for lights at infinity, which have no bounding sphere.
                normal.dot(light.center - self.point) < -BEHIND * light.radius
            }
            _ => false,
        }
    }

    /// The visibility class of the point and a light.
    pub(crate) fn between<'p>(&self, plan: &'p RenderPlan, light: usize) -> &'p VisibilityClass {
        let receiver = self.primitive.and_then(|primitive| plan.receiver(primitive));
        receiver.map_or(&VisibilityClass::Anything, |receiver| &receiver.between[light])
    }

    /// Samples some lights by importance (unbiased: each is divided by its expected number of
    /// samples).
    fn sample_some<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        point: &Bsdf<'_, BANDS>,
        tree: &LightTree,
        first_set: u32,
    ) -> [f64; BANDS] {
        let plan = tracer.plan;
        let cut = TreeCut::new(tree, &plan.lights, self.point, &self.reception);
        let draws = self.reception.draws;
        // A number of the sequence has 24 bits, too few for this many lights.
        let [coarse, fine, ..] = tracer.sampler.take(DimensionSet::render(first_set));
        let offset = coarse + fine * SEQUENCE_STEP;
        let mut samples = [0.0; 4];
        let mut sum = [0.0; BANDS];
        for draw in 0..draws {
            let half = 2 * (draw as usize % 2);
            if half == 0 {
                samples = tracer.sampler.take(DimensionSet::render(first_set + 1 + draw / 2));
            }
            let Some(choice) = cut.sample((f64::from(draw) + offset) / f64::from(draws)) else { continue };
            let index = choice.light.0 as usize;
            let between = self.between(plan, index);
            if *between == VisibilityClass::Dark {
                continue;
            }
            let (u, expected) = ([samples[half], samples[half + 1]], f64::from(draws) * choice.chance);
            let sampler = plan.lights[index].sampler(self.point, &self.reception.peak);
            let given = self.sample_light(tracer, point, &sampler, between, u, expected);
            for (sum, given) in sum.iter_mut().zip(given) {
                *sum += given;
            }
        }
        sum
    }

    /// The contribution of one sample of a light; `expected` is the expected number of samples of
    /// the light.
    fn sample_light<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        point: &Bsdf<'_, BANDS>,
        sampler: &LightSampler<'_>,
        between: &VisibilityClass,
        u: [f64; 2],
        expected: f64,
    ) -> [f64; BANDS] {
        let Some(sample) = self.light_sample(tracer, sampler, u) else { return [0.0; BANDS] };
        let scratch = &mut tracer.workspace.scratch;
        let bsdf_value = point.eval(sample.direction, sample.pdf, self.pdf_request(), scratch);
        self.gather(tracer, sampler.light(), &sample, between, expected, &bsdf_value)
    }

    /// Whether light samples are weighted against sampled rays.
    #[inline]
    pub(crate) fn pdf_request(&self) -> PdfRequest {
        if self.highlight_draws > 0 || self.shares_diffuse { PdfRequest::Wanted } else { PdfRequest::Unused }
    }

    /// A point of a light that can contribute.
    #[inline]
    pub(crate) fn light_sample<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        sampler: &LightSampler<'_>,
        u: [f64; 2],
    ) -> Option<LightSample> {
        let light = sampler.light();
        let redirected = if light.is_redirected() { self.connect_through_prism(tracer, light, u) } else { None };
        let sample = match redirected {
            Some(sample) => sample,
            None => sampler.sample(u)?,
        };
        (light.fraction_in_radius(self.point, sample.direction, sample.distance) > 0.0).then_some(sample)
    }

    /// The contribution of a light sample to a point with this BSDF value.
    #[inline]
    pub(crate) fn gather<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        light: &Light,
        sample: &LightSample,
        between: &VisibilityClass,
        expected: f64,
        bsdf_value: &BsdfValue<BANDS>,
    ) -> [f64; BANDS] {
        let Some([weight, radiance]) = self.unshadowed(tracer, light, sample, expected, bsdf_value) else {
            return [0.0; BANDS];
        };
        tracer.begin_shadow(self, (light, sample), weight, radiance);
        let arriving = self.arriving(tracer, light, sample, between, radiance);
        let given = product(weight, arriving);
        self.note_light(tracer, light, sample, given);
        given
    }

    /// The weight and the radiance of a light sample that nothing blocks; `None` if it contributes
    /// nothing.
    #[inline]
    pub(crate) fn unshadowed<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        light: &Light,
        sample: &LightSample,
        expected: f64,
        bsdf_value: &BsdfValue<BANDS>,
    ) -> Option<[[f64; BANDS]; 2]> {
        let weight = self.weight(light, sample, expected, bsdf_value)?;
        let radiance = self.radiance(tracer, light, sample);
        product(weight, radiance).iter().any(|band| *band != 0.0).then_some([weight, radiance])
    }

    /// The weight of the radiance of a light sample; `None` if it is zero.
    #[inline]
    pub(crate) fn weight<const BANDS: usize>(
        &self,
        light: &Light,
        sample: &LightSample,
        expected: f64,
        bsdf_value: &BsdfValue<BANDS>,
    ) -> Option<[f64; BANDS]> {
        let pdf = sample.pdf * expected;
        // No sampled ray reaches a light through a prism.
        let shares_diffuse = self.shares_diffuse && !light.is_redirected();
        let diffuse_share = if shares_diffuse {
            let by_cosine = bsdf_value.diffuse_pdf;
            let visible_portals = self.visible_portals.filter(|_| by_cosine > 0.0);
            let mixed = visible_portals
                .map_or(by_cosine, |visible_portals| visible_portals.mixed_pdf(sample.direction, by_cosine));
            pdf / (pdf + mixed)
        } else {
            1.0
        };
        let drawn = if light.is_redirected() { 0 } else { self.highlight_draws };
        let mut drawn_pdf = f64::from(drawn) * bsdf_value.highlight_pdf;
        if drawn > 0
            && let Some(images) = self.specular_return
        {
            drawn_pdf += images.density(sample.direction);
        }
        let highlight_share = pdf / (pdf + drawn_pdf);
        let mut weight: [f64; BANDS] = std::array::from_fn(|band| {
            (bsdf_value.diffuse[band] * diffuse_share + bsdf_value.highlight[band] * highlight_share) / pdf
        });
        if weight.iter().all(|band| *band == 0.0) {
            return None;
        }
        if light.focal_distance > 0.0 {
            weight = weight.map(|band| band * light.focal_factor(sample.distance));
        }
        Some(weight)
    }

    /// Records a contribution if requested.
    fn note_light<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        light: &Light,
        sample: &LightSample,
        given: [f64; BANDS],
    ) {
        let Some(contributions) = &mut tracer.contributions else { return };
        contributions.defer(tracer.plan.shader(light.surface), &self.interaction(light, sample), given);
    }

    /// Radiance from a light sample to a point in space, scaled by `weight` of its direction and
    /// divided by the pdf of the sample.
    pub(crate) fn light_at<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        light: &Light,
        u: [f64; 2],
        weight: impl Fn(DVec3) -> f64,
    ) -> [f64; BANDS] {
        let dark = [0.0; BANDS];
        if light.misses(self.point) {
            return dark;
        }
        let sampler = light.sampler(self.point, &self.reception.peak);
        let Some(sample) = self.light_sample(tracer, &sampler, u) else { return dark };
        let focal = light.focal_factor(sample.distance);
        let radiance = self.radiance(tracer, light, &sample);
        if radiance.iter().all(|band| *band == 0.0) {
            return dark;
        }
        let scale = focal * weight(sample.direction) / sample.pdf;
        let given =
            self.arriving(tracer, light, &sample, &VisibilityClass::Anything, radiance).map(|band| band * scale);
        self.note_light(tracer, light, &sample, given);
        given
    }

    /// Radiance of the light sample towards the point; for a glow, the part that has the point
    /// within its radius.
    pub(crate) fn radiance<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        light: &Light,
        sample: &LightSample,
    ) -> [f64; BANDS] {
        let plan = tracer.plan;
        let in_range = light.fraction_in_radius(self.point, sample.direction, sample.distance);
        if light.is_redirected() {
            // The arriving radiance is known only afterwards.
            return [in_range; BANDS];
        }
        let shader = plan.shader(light.surface);
        let Some(emitter) = shader.kind.emitter() else { return [0.0; BANDS] };
        // Most lights need no interaction.
        let radiance = uniform_emission(shader, emitter).unwrap_or_else(|| {
            let interaction = self.interaction(light, sample);
            emission(&plan.scene, shader, emitter, &interaction, &mut tracer.workspace.scratch)
        });
        given(radiance).map(|band: f64| in_range * band)
    }

    /// The interaction of a ray from the point with the light.
    fn interaction(&self, light: &Light, sample: &LightSample) -> SurfaceInteraction {
        let ray = light.real_ray(self.point, sample.direction);
        if matches!(light.form, LightForm::Distant { .. }) {
            return SurfaceInteraction::distant(&ray);
        }
        let normal = light
            .virtual_sources
            .iter()
            .fold(sample.normal, |normal, virtual_source| virtual_source.image_of_direction(normal));
        let total = self.travelled + sample.distance;
        SurfaceInteraction::new(&ray, ray.at(sample.distance), normal, sample.distance, total)
    }
}

/// A light is behind a point if it is that many radii of its bounding sphere below its plane: more
/// than one, because of rounding.
const BEHIND: f64 = 1.0 + 1e-6;

/// Number of samples of a light from which a shaft query pays: it costs about two shadow rays.
const SAMPLES_FOR_A_SHAFT: u32 = 8;

/// The step between the numbers of a sample sequence.
const SEQUENCE_STEP: f64 = 1.0 / (1 << 24) as f64;
