//! Direct and indirect light at a point of a surface.

use super::CountedLight;
use super::PathIntegrator;
use super::path_state::PathState;
use super::split::Branches;
use crate::direct::DirectSampler;
use crate::hemisphere_sampling::{sample_outward, visible_portals};
use crate::indirect::Indirect;
use crate::mis::{Lobe, MisState};
use crate::ray_tree::BounceType;
use crate::specular_chain::SpecularChain;
use crate::specular_return::SpecularReturn;
use glam::DVec3;
use radsight_accel::{PrimitiveId, Ray};
use radsight_brdf::Density;
use radsight_bsdf::{Bsdf, BsdfSample, PdfRequest, sum};
use radsight_compile::LightDivision;
use radsight_sampling::DimensionSet;
use radsight_texture::product;

/// Number of highlight samples of a retroreflector that is seen through a mirror, up to this depth:
/// it is lit through the mirror as well, and no light sampling finds that.
const SPLIT_DRAWS: u32 = 8;
const LAST_SPLIT_DEPTH: u32 = 2;

/// Maximum pdf ratio for Russian roulette of a ray to a light's image that the lobe would hardly
/// ever sample.
const MAX_PDF_RATIO: f64 = 1e6;

/// Maximum number of highlight rays (`-ss`): they are all pending at once.
const MAX_HIGHLIGHT_SAMPLES: f64 = 16.0;

/// Maximum number of diffuse rays from a point of a preview that no record reaches.
const MAX_RAYS_OF_UNREACHED: u32 = 16;

/// Minimum number of rays whose sum is an irradiance: the sum of fewer may be negative by chance.
const MIN_RAYS_OF_IRRADIANCE: u32 = 16;

/// The same where a highlight ray ends: in a room with a ball of rough gold, four have two thirds of
/// the rms error of one in 1.3 times the time.
const MAX_RAYS_BEHIND_HIGHLIGHT: u32 = 4;

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// Direct light, and the rays for indirect light.
    pub(crate) fn light_and_scatter(
        &mut self,
        path: &PathState<BANDS>,
        at: DVec3,
        primitive: Option<PrimitiveId>,
        point: &Bsdf<'_, BANDS>,
        travelled: f64,
    ) {
        if path.seeks_caustics() || self.counted == CountedLight::Images {
            return;
        }
        let untextured;
        let point = if self.contributions.is_some() {
            // A patch of a sky must not contribute less than nothing.
            untextured = Bsdf { indirect_ignores_texture: true, ..*point };
            &untextured
        } else {
            point
        };
        let receiver = primitive.and_then(|primitive| self.plan.receiver(primitive));
        let lights_suffice = receiver.is_some_and(|receiver| receiver.lights_suffice);
        let alone = receiver.is_some_and(|receiver| receiver.sees_only_lights);
        let follow_highlight = point.has_highlight() && !(alone && lights_suffice);
        self.samples_highlight |= follow_highlight && !path.is_scattered();
        // Other highlights are combined with light sampling, whose number of samples must not
        // depend on the receiver.
        let lights_suffice = lights_suffice && point.is_retroreflector();
        let bounces = if path.follows_no_diffuse { 0 } else { path.ambient_bounces };
        let indirect = Indirect::after(bounces);
        let wants_indirect = point.has_diffuse() && indirect == Indirect::Followed && !alone;
        let gathered = if wants_indirect { self.gathered(path, at, primitive, point, travelled) } else { None };
        if self.point_search.is_some() {
            return;
        }
        let follow_diffuse = wants_indirect && gathered.is_none();
        let images = if follow_highlight && point.may_retroreflect() && path.mis.is_none() {
            self.specular_return(path.chain, (at, primitive), point)
        } else {
            None
        };
        let requested = Branches {
            diffuse: u32::from(follow_diffuse),
            highlight: match images {
                Some(_) => 1,
                None if follow_highlight => self.highlight_draws(path, point),
                None => 0,
            },
        };
        let mut branches = if self.splits {
            self.branches(path, point, requested)
        } else if follow_diffuse && self.lacks_record(path) {
            Branches { diffuse: self.rays_of_unreached(path), ..requested }
        } else {
            requested
        };
        if images.is_some() {
            branches.highlight = requested.highlight;
        }
        let set = self.next_set;
        // An unsplit ray uses the sample points of pictures.
        let is_split = branches != requested;
        self.next_set += if is_split { Branches::SETS } else { branches.highlight.max(1) };
        let mut reception = point.reception(self.plan.light_draws[usize::from(path.is_scattered())]);
        reception.samples = self.light_samples(path, point, branches);
        // Mist attenuates shadow rays less than others, so MIS does not apply.
        let shared = !self.plan.lights_are_covered;
        let mut visible_portals =
            if follow_diffuse { visible_portals(point, (self.plan, self.guide), at) } else { None };
        let outward = branches.outward();
        if let (Some(visible_portals), 2.., None) = (&mut visible_portals, branches.diffuse, self.guide) {
            visible_portals.chance = f64::from(outward) / f64::from(branches.diffuse);
        }
        let highlight = if is_split { branches.shared_highlight() } else { branches.highlight };
        let direct = DirectSampler {
            point: at,
            primitive,
            highlight_draws: if shared && !lights_suffice { highlight } else { 0 },
            shares_diffuse: shared && follow_diffuse && point.diffuse_finds_lights(),
            visible_portals: visible_portals.as_ref(),
            specular_return: images.as_ref(),
            reception,
            travelled,
            medium: path.medium,
            cuts: [path.cut, path.subtraction_beyond],
            normal: point.normal,
            drawn: path.mis.is_some(),
            facing: point.facing(),
        };
        if let Some(tree) = &mut self.tree {
            tree.light(path.throughput, path.node);
        }
        let mut light = direct.sample(self, point);
        if let Some(contributions) = &mut self.contributions {
            contributions.settle(path.throughput);
        }
        if indirect == Indirect::Constant {
            self.add_constant(&mut light, &point.ambient_reflectance());
        }
        if let Some(gathered) = gathered {
            light = sum(light, gathered);
        }
        self.add(path, product(path.throughput, light));
        self.sample_caustics(path, &direct, point);
        if branches.highlight > 1 && is_split {
            self.split_highlight(path, &direct, point, (set, branches.highlight));
        } else {
            self.sample_highlight(path, &direct, point, (set, branches.highlight));
        }
        match branches.diffuse {
            0 => {}
            1 => self.sample_diffuse(path, &direct, point, set + u32::from(is_split)),
            rays => self.split_diffuse(path, &direct, point, (set + 1, rays)),
        }
    }

    /// Whether this is a point of a preview before the first diffuse bounce. Where no record of the
    /// irradiance cache reaches it, as between leaves or along a highlight ray, few other rays average
    /// what a single ray would find from there.
    fn lacks_record(&self, path: &PathState<BANDS>) -> bool {
        let options = &self.plan.options;
        let is_preview = options.light_division != LightDivision::Whole;
        let is_first = path.ambient_bounces == options.ambient_bounces;
        is_preview && is_first && self.caches[0].is_some()
    }

    /// Number of diffuse rays from such a point.
    fn rays_of_unreached(&self, path: &PathState<BANDS>) -> u32 {
        let most = if path.is_scattered() { MAX_RAYS_BEHIND_HIGHLIGHT } else { MAX_RAYS_OF_UNREACHED };
        self.plan.options.gathering.divisions.clamp(1, most)
    }

    /// Adds highlight rays, which are pending at once.
    fn sample_highlight(
        &mut self,
        path: &PathState<BANDS>,
        direct: &DirectSampler<'_>,
        point: &Bsdf<'_, BANDS>,
        (set, draws): (u32, u32),
    ) {
        for draw in 0..draws {
            let u = self.highlight_point(set, draw, draws);
            if let Some(drawn) = point.sample_highlight([u[0], u[1], u[2]]) {
                let drawn = drawn.split(f64::from(draws));
                let drawn = match (direct.specular_return, drawn.pdf) {
                    (Some(images), Density::Continuous(pdf)) => {
                        drawn.split(1.0 + images.density(drawn.direction) / pdf)
                    }
                    _ => drawn,
                };
                self.scatter(path, direct, (drawn, Lobe::Highlight), path.ambient_bounces);
            }
        }
        if let Some(images) = direct.specular_return {
            self.sample_images(path, direct, point, (images, draws));
        }
    }

    /// The sample point of one of the highlight rays, which are stratified together.
    fn highlight_point(&self, set: u32, draw: u32, draws: u32) -> [f64; 4] {
        if draws == 1 {
            return self.sampler.take(DimensionSet::render(set));
        }
        self.sampler.branch(DimensionSet::render(set), draw, draws).take(DimensionSet::render(0))
    }

    /// Adds rays to the images of lights through a specular chain; `draws` is the number of
    /// highlight samples.
    fn sample_images(
        &mut self,
        path: &PathState<BANDS>,
        direct: &DirectSampler<'_>,
        point: &Bsdf<'_, BANDS>,
        (images, draws): (&SpecularReturn, u32),
    ) {
        let first_set = self.next_set;
        self.next_set += images.draws();
        for draw in 0..images.draws() {
            let u = self.sampler.take(DimensionSet::render(first_set + draw));
            let Some(direction) = images.draw(draw, [u[0], u[1], u[2]]) else { continue };
            let value = point.eval(direction, 1.0, PdfRequest::Wanted, &mut self.workspace.scratch);
            let by_lobe = f64::from(draws) * value.highlight_pdf;
            let pdf = by_lobe + images.density(direction);
            let weight = value.highlight.map(|band| band / pdf);
            let pdf_ratio = (pdf / by_lobe).min(MAX_PDF_RATIO);
            let drawn = BsdfSample { direction, weight, pdf: Density::Continuous(pdf), pdf_ratio };
            self.scatter(path, direct, (drawn, Lobe::Highlight), path.ambient_bounces);
        }
    }

    /// Traces highlight rays one after the other.
    fn split_highlight(
        &mut self,
        path: &PathState<BANDS>,
        direct: &DirectSampler<'_>,
        point: &Bsdf<'_, BANDS>,
        (set, rays): (u32, u32),
    ) {
        let share = f64::from(rays);
        let part = PathState { split: path.split * share, ..*path };
        let next_set = self.next_set;
        let suspended = self.split(set);
        for branch in 0..rays {
            let u = self.begin_branch(&suspended, branch, rays);
            if let Some(drawn) = point.sample_highlight([u[0], u[1], u[2]]) {
                self.scatter(&part, direct, (drawn.branch(share), Lobe::Highlight), path.ambient_bounces);
                self.end_branch(&suspended);
            }
        }
        self.end_split(&suspended, next_set);
    }

    /// Adds one ray of the diffuse component.
    fn sample_diffuse(
        &mut self,
        path: &PathState<BANDS>,
        direct: &DirectSampler<'_>,
        point: &Bsdf<'_, BANDS>,
        set: u32,
    ) {
        let u = self.sampler.take(DimensionSet::render(set));
        if let Some(drawn) = diffuse_ray(direct, point, u) {
            self.scatter(path, direct, (drawn, Lobe::Diffuse), path.ambient_bounces - 1);
        }
    }

    /// Traces rays of the diffuse component one after the other: first those towards portals, then
    /// the others, each group stratified separately.
    fn split_diffuse(
        &mut self,
        path: &PathState<BANDS>,
        direct: &DirectSampler<'_>,
        point: &Bsdf<'_, BANDS>,
        (set, rays): (u32, u32),
    ) {
        let share = f64::from(rays);
        let part = PathState { split: path.split * share, ..*path };
        let next_set = self.next_set;
        let before = self.radiance;
        let (outward, chance) = direct.visible_portals.map_or((0, 0.0), |visible_portals| {
            ((visible_portals.chance * share).round() as u32, visible_portals.chance)
        });
        for (set, group, choices) in [(set, outward, [0.0, chance]), (set + 1, rays - outward, [chance, 1.0])] {
            let suspended = self.split(set);
            for branch in 0..group {
                let [u, v, choice, _] = self.begin_branch(&suspended, branch, group);
                let choice = choices[0] + choice * (choices[1] - choices[0]);
                if let Some(drawn) = diffuse_ray(direct, point, [choice, 0.0, u, v]) {
                    self.scatter(&part, direct, (drawn.branch(share), Lobe::Diffuse), path.ambient_bounces - 1);
                    self.end_branch(&suspended);
                }
            }
            self.end_split(&suspended, next_set);
        }
        if rays >= MIN_RAYS_OF_IRRADIANCE {
            self.no_negative_irradiance(path, before);
        }
    }

    /// Irradiance is at least 0, though its gradient by rotation would make it negative on facets
    /// that face away from the light ([`DiffuseLobe`](radsight_bsdf::DiffuseLobe)). `before` is the
    /// ray's radiance without it.
    fn no_negative_irradiance(&mut self, path: &PathState<BANDS>, before: [f64; BANDS]) {
        for ((sum, before), throughput) in self.radiance.iter_mut().zip(before).zip(path.throughput) {
            if (*sum - before) * throughput < 0.0 {
                *sum = before;
            }
        }
    }

    /// Number of highlight samples at a point without splitting.
    fn highlight_draws(&self, path: &PathState<BANDS>, point: &Bsdf<'_, BANDS>) -> u32 {
        let is_near = (1..=LAST_SPLIT_DEPTH).contains(&path.depth);
        if point.is_retroreflector() && is_near && !path.chain.is_straight() {
            SPLIT_DRAWS
        } else {
            self.highlight_samples(path)
        }
    }

    /// Number of highlight samples: the requested number times the path's weight, and one after
    /// scattering, since many such paths are averaged.
    fn highlight_samples(&self, path: &PathState<BANDS>) -> u32 {
        if path.is_scattered() {
            return 1;
        }
        let strongest = path.throughput.iter().copied().fold(0.0, f64::max).min(1.0);
        (self.plan.options.highlight_samples * strongest + 0.5).clamp(1.0, MAX_HIGHLIGHT_SAMPLES) as u32
    }

    /// Adds a sampled ray.
    pub(crate) fn scatter(
        &mut self,
        path: &PathState<BANDS>,
        from: &DirectSampler<'_>,
        (drawn, lobe): (BsdfSample<BANDS>, Lobe),
        ambient_bounces: u32,
    ) {
        let throughput = product(path.throughput, drawn.weight);
        let reflections = path.reflections + 1;
        let share = (throughput, drawn.pdf_ratio);
        let Some(throughput) = self.roulette(share, path, reflections, Some(lobe)) else { return };
        let mut mis = match drawn.pdf {
            Density::Continuous(pdf) => {
                let at = (from.point, drawn.direction);
                // A highlight that leaves all light sources to light sampling has pdf 0 for them.
                let pdf = if lobe == Lobe::Highlight && from.highlight_draws == 0 { 0.0 } else { pdf };
                let mut mis = MisState::new(pdf, at, from.reception, from.primitive, lobe);
                mis.pdf_ratio = drawn.pdf_ratio;
                Some(mis)
            }
            Density::Delta => path.mis,
        };
        match (&mut mis, drawn.pdf) {
            (Some(mis), Density::Continuous(_)) if self.plan.lights_are_covered => mis.covered(),
            (Some(mis), Density::Delta) => mis.lost(),
            _ => {}
        }
        let next = PathState {
            ray: Ray { origin: from.point, direction: drawn.direction.normalize() },
            from: from.primitive,
            throughput,
            split: path.split,
            travelled: from.travelled,
            mis,
            chain: if lobe.seeks_caustics() { SpecularChain::default() } else { path.chain.lost() },
            depth: path.depth + 1,
            is_limited: path.is_limited && from.normal.dot(drawn.direction) < 0.0,
            reflections,
            ambient_bounces,
            medium: path.medium,
            cut: from.subtraction_towards(drawn.direction),
            subtraction_beyond: from.subtraction_towards(drawn.direction),
            follows_no_diffuse: false,
            direct_view: false,
            node: path.node,
        };
        self.push_on(next, BounceType::Sampled);
    }
}

/// A ray from the diffuse component, or towards a visible portal.
fn diffuse_ray<const BANDS: usize>(
    direct: &DirectSampler<'_>,
    point: &Bsdf<'_, BANDS>,
    u: [f64; 4],
) -> Option<BsdfSample<BANDS>> {
    match direct.visible_portals {
        Some(portals) => sample_outward(point, portals, u),
        None => point.sample_diffuse(u[2], u[3]),
    }
}
