//! Caustics: light of lamps that reaches diffuse surfaces through curved mirrors and refracting
//! bodies.
//!
//! Rays of the diffuse component hit a small lamp that way by chance only, so the path is found by
//! a search. A random direction towards a specular surface starts a chain of reflections and
//! refractions. Newton's method then changes the direction until the chain ends at a sampled point
//! of the lamp. The reciprocal of the probability of finding that solution has an unbiased
//! estimate: the number of further searches until it is found again (specular manifold sampling;
//! Zeltner, Georgiev and Jakob, "Specular Manifold Sampling for Rendering High-Frequency Caustics
//! and Glints", ACM Transactions on Graphics 39(4), 2020, section 4). Chains are evaluated by
//! tracing, so every chain that rays can follow is supported.
//!
//! Where a lamp's image is large, as at a focus, random directions hit it often enough. Random rays
//! count where the lamp's image is at least as large as a fraction of the cones from which they are
//! drawn, and solutions count where it is smaller. The image's size is a function of the path, so
//! every path belongs to exactly one of the two techniques. Random rays are cheap, so each point has
//! several: beside a focus, where searches rarely converge, they are the better technique.
//!
//! The solved path is traced like any other, but counts only if it takes the same chain and ends at
//! that lamp. Paths that light sampling finds, straight or through bodies, are left to it.

use crate::caustic_chain::ChainChoices;
use crate::direct::DirectSampler;
use crate::mis::{CausticPath, Lobe, MisState};
use crate::retrace::MAX_LIGHTS;
use crate::specular_chain::{SpecularChain, SpecularEvent};
use crate::specular_return::{RayBundle, TangentPlane};
use crate::trace::PathIntegrator;
use crate::trace::path_state::PathState;
use glam::{DMat2, DVec2, DVec3};
use radsight_accel::{PrimitiveId, Ray};
use radsight_brdf::Density;
use radsight_bsdf::{Bsdf, BsdfSample, PdfRequest};
use radsight_compile::Reflector;
use radsight_ir::SurfaceHandle;
use radsight_light::{Light, LightForm};
use radsight_sampling::{DimensionSet, choose, unit_disk};
use radsight_texture::strongest;
use std::f64::consts::PI;

/// Fraction of searches with a uniform initial direction, since a chain may begin at a surface that
/// is not a reflector, such as a pane in front of one.
const UNIFORM_FRACTION: f64 = 0.125;

/// Number of lights searched at one point.
const LIGHTS_AT_A_POINT: usize = 4;

/// Probability of a search behind a scattered ray, which is one of many.
const SCATTERED_PROBABILITY: f64 = 0.0625;

/// Random rays find a lamp whose expected number of hits exceeds one in this many. A random ray
/// costs a tenth of a search, so each point has several.
const LARGE_IMAGE_TRIALS: f64 = 32.0;
const LARGE_IMAGE_DRAWS: u32 = 8;

/// A chain whose throughput is below this is continued by Russian roulette: all chains cost the
/// same, but those with several reflections inside glass carry hardly any light.
const MIN_THROUGHPUT: f64 = 0.25;

/// Newton's method: steps, halvings of a diverging step, and the largest step as a tangent.
const MAX_STEPS: u32 = 20;
const MAX_HALVINGS: u32 = 6;
const MAX_STEP: f64 = 0.5;

/// A chain has converged within this fraction of the lamp's radius.
const TOLERANCE: f64 = 1e-7;

/// Two solutions are equal if they differ by less than this fraction of the lamp's image.
const SAME_IMAGE: f64 = 1e-3;

/// Maximum number of trials to find a solution again. They all fail with a probability of
/// exp(−`MAX_TRIALS`·p), where p is the probability that one search finds it.
const MAX_TRIALS: u32 = 4096;

/// A point of a lamp, in terms of passing rays: the nearest offset of a ray from the lamp's centre
/// in radii, on two axes across the ray.
struct LampPoint<'l> {
    light: &'l Light,
    across: [DVec3; 2],
    /// Within the unit disk.
    offset: DVec2,
}

impl<'l> LampPoint<'l> {
    /// A point of a lamp from the unit square, seen from `from`; `None` for a lamp without extent.
    fn new(light: &'l Light, from: DVec3, [u, v]: [f64; 2]) -> Option<LampPoint<'l>> {
        let axis = match light.form {
            LightForm::Distant { direction, half_angle_sin_squared_half: half, .. } if half > 0.0 && half < 0.25 => {
                direction
            }
            LightForm::Distant { .. } | LightForm::DistantImage { .. } => return None,
            _ => (light.center - from).normalize_or(DVec3::Z),
        };
        let is_usable = light.virtual_sources.is_empty() && light.radius > 0.0;
        let across = axis.any_orthonormal_pair();
        is_usable.then(|| LampPoint { light, across: across.into(), offset: unit_disk(u, v).into() })
    }

    /// The offset of the central ray of a bundle, and its derivative by the ray's direction.
    fn passed(&self, bundle: &RayBundle) -> Option<(DVec2, DMat2)> {
        let [middle, x, y] = bundle.ends().map(|end| self.miss(end));
        let middle = middle?;
        Some((middle, DMat2::from_cols((x? - middle) / bundle.step(), (y? - middle) / bundle.step())))
    }

    /// The vector from this point to the point where a ray passes the lamp, in the lamp's radii.
    fn miss(&self, ray: &Ray) -> Option<DVec2> {
        let [x, y] = self.across;
        let passed = match self.light.form {
            LightForm::Distant { direction, half_angle_sin_squared_half: half, .. } => {
                let along = ray.direction.dot(direction);
                let tangent = 2.0 * (half * (1.0 - half)).sqrt() / (1.0 - 2.0 * half);
                (along > 0.0).then(|| DVec2::new(ray.direction.dot(x), ray.direction.dot(y)) / (along * tangent))?
            }
            _ => {
                let to_center = self.light.center - ray.origin;
                let along = to_center.dot(ray.direction);
                let offset = ray.direction * along - to_center;
                let x = (x - ray.direction * x.dot(ray.direction)).try_normalize()?;
                let y = ray.direction.cross(x);
                (along > 0.0).then(|| DVec2::new(offset.dot(x), offset.dot(y)) / self.light.radius)?
            }
        };
        Some(passed - self.offset)
    }
}

/// The initial directions of searches: within the cones of reflectors, or uniform.
struct SeedDirections<'p> {
    reflectors: &'p [Reflector],
    from: DVec3,
    /// Of an opaque surface.
    facing: Option<DVec3>,
    /// Sum of the weights of all cones.
    total: f64,
}

impl<'p> SeedDirections<'p> {
    fn new<const BANDS: usize>(reflectors: &'p [Reflector], from: DVec3, point: &Bsdf<'_, BANDS>) -> Self {
        let facing = point.transmission.is_none().then_some(point.normal);
        let mut seeds = SeedDirections { reflectors, from, facing, total: 0.0 };
        seeds.total = seeds.cones().map(|(_, worth)| worth).sum();
        seeds
    }

    /// The cones of all reflectors, with their selection probabilities; `None` for a reflector that
    /// surrounds the point.
    fn cones(&self) -> impl Iterator<Item = (Option<(DVec3, f64)>, f64)> {
        self.reflectors.iter().map(|reflector| {
            let cone = reflector.cone(self.from);
            let worth = match cone {
                Some((axis, tangent)) => {
                    let is_below = self.facing.is_some_and(|normal| normal.dot(axis) + tangent.min(1.0) <= 0.0);
                    if is_below { 0.0 } else { tangent * tangent / (1.0 + tangent * tangent) }
                }
                None => 1.0,
            };
            (cone, worth)
        })
    }

    fn draw(&self, [u, v, choice]: [f64; 3]) -> Option<DVec3> {
        if choice < UNIFORM_FRACTION {
            return Some(self.uniform([u, v]));
        }
        if self.total <= 0.0 {
            return None;
        }
        let choice = (choice - UNIFORM_FRACTION) / (1.0 - UNIFORM_FRACTION);
        let (chosen, _) = choose(self.cones().map(|(_, worth)| worth / self.total), choice)?;
        let (cone, _) = self.cones().nth(chosen)?;
        let Some((axis, tangent)) = cone else { return Some(self.uniform([u, v])) };
        Some(TangentPlane::new(axis).direction(DVec2::from(unit_disk(u, v)) * tangent))
    }

    /// A uniform direction of the sphere, or of the hemisphere that the surface faces.
    fn uniform(&self, [u, v]: [f64; 2]) -> DVec3 {
        let axis = self.facing.unwrap_or(DVec3::Z);
        let (x, y) = axis.any_orthonormal_pair();
        let height = if self.facing.is_some() { u } else { 1.0 - 2.0 * u };
        let (sin, cos) = (2.0 * PI * v).sin_cos();
        let radius = (1.0 - height * height).max(0.0).sqrt();
        (x * (radius * cos) + y * (radius * sin) + axis * height).normalize()
    }

    /// Pdf of [`Self::draw`], 1/sr.
    fn pdf(&self, direction: DVec3) -> f64 {
        let uniform = match self.facing {
            Some(normal) if normal.dot(direction) <= 0.0 => 0.0,
            Some(_) => 0.5 / PI,
            None => 0.25 / PI,
        };
        let in_cones = self.cones().map(|(cone, worth)| match cone {
            _ if worth <= 0.0 => 0.0,
            None => worth * uniform,
            Some((axis, tangent)) => {
                let cosine = axis.dot(direction);
                let sine_squared = 1.0 - cosine * cosine;
                let is_inside = cosine > 0.0 && sine_squared <= (tangent * cosine).powi(2);
                // dω = cos³θ of the area in the tangent plane.
                if is_inside { worth / (PI * tangent * tangent * cosine.powi(3)) } else { 0.0 }
            }
        });
        let by_cones = if self.total > 0.0 { in_cones.sum::<f64>() / self.total } else { 0.0 };
        UNIFORM_FRACTION * uniform + (1.0 - UNIFORM_FRACTION) * by_cones
    }
}

/// Whether the image of a lamp is so large that random directions with this pdf, 1/sr, find it
/// often enough.
fn is_large(magnification: f64, pdf: f64) -> bool {
    magnification / PI < LARGE_IMAGE_TRIALS * pdf
}

/// A direction from which a chain leads to a point of a lamp.
struct Solution {
    /// Unit.
    direction: DVec3,
    events: Vec<SpecularEvent>,
    /// Ratio of area on the lamp, in squared radii, to the solid angle of directions, 1/sr.
    magnification: f64,
}

impl Solution {
    fn is_same_as(&self, other: &Solution) -> bool {
        let image = self.magnification.sqrt().recip();
        self.events == other.events && self.direction.distance(other.direction) < SAME_IMAGE * image
    }

    /// Pdf of the direction for a uniform point of the lamp's disk, 1/sr.
    fn pdf(&self) -> f64 {
        self.magnification / PI
    }
}

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// Adds rays towards lamps that a point sees through specular surfaces, for its diffuse
    /// component.
    pub(crate) fn sample_caustics(
        &mut self,
        path: &PathState<BANDS>,
        direct: &DirectSampler<'_>,
        point: &Bsdf<'_, BANDS>,
    ) {
        let plan = self.plan;
        let lights = plan.lights.len();
        if !plan.samples_caustics() || lights == 0 || lights > MAX_LIGHTS || !point.has_diffuse() {
            return;
        }
        let chance = if path.is_scattered() { SCATTERED_PROBABILITY } else { 1.0 };
        let [first, survival, ..] = self.take_set();
        if survival >= chance {
            return;
        }
        let seeds = SeedDirections::new(&plan.reflectors, direct.point, point);
        self.sample_large_images(path, direct, point, (&seeds, chance));
        let requested = lights.min(LIGHTS_AT_A_POINT);
        let share = requested as f64 / lights as f64;
        for step in 0..requested {
            // All lights if they are few, otherwise evenly spaced ones.
            let light = ((step as f64 + first) / share) as usize % lights;
            self.sample_caustic(path, direct, point, (&plan.lights[light], &seeds, chance * share));
        }
    }

    fn take_set(&mut self) -> [f64; 4] {
        self.next_set += 1;
        self.sampler.take(DimensionSet::render(self.next_set - 1))
    }

    /// Adds rays in random directions, which find lamps with large images.
    fn sample_large_images(
        &mut self,
        path: &PathState<BANDS>,
        direct: &DirectSampler<'_>,
        point: &Bsdf<'_, BANDS>,
        (seeds, chance): (&SeedDirections<'_>, f64),
    ) {
        for _ in 0..LARGE_IMAGE_DRAWS {
            let [u, v, choice, _] = self.take_set();
            let Some(direction) = seeds.draw([u, v, choice]) else { continue };
            let pdf = seeds.pdf(direction);
            let density = f64::from(LARGE_IMAGE_DRAWS) * chance * pdf;
            self.scatter_caustic(path, direct, point, (direction, density, Lobe::LargeImage(pdf)));
        }
    }

    /// Adds a ray that only counts lamps behind a chain of specular surfaces.
    fn scatter_caustic(
        &mut self,
        path: &PathState<BANDS>,
        direct: &DirectSampler<'_>,
        point: &Bsdf<'_, BANDS>,
        (direction, pdf, lobe): (DVec3, f64, Lobe),
    ) {
        let value = point.eval(direction, 1.0, PdfRequest::Unused, &mut self.workspace.scratch).diffuse;
        let weight = value.map(|band| band / pdf);
        // The ray's throughput is small because the lamp is small, but it matters like any diffuse
        // ray.
        let pdf_ratio = strongest(&point.ambient_reflectance()) / strongest(&weight);
        if pdf_ratio.is_finite() {
            let drawn = BsdfSample { direction, weight, pdf: Density::Continuous(0.0), pdf_ratio };
            self.scatter(path, direct, (drawn, lobe), path.ambient_bounces);
        }
    }

    /// Whether a random ray with the pdf `pdf` has found a lamp with a large image.
    pub(crate) fn is_large_image(
        &mut self,
        mis: &MisState,
        (chain, pdf): (SpecularChain, f64),
        surface: SurfaceHandle,
    ) -> bool {
        let plan = self.plan;
        let Some(events) = chain.forwards() else { return false };
        let events: Vec<SpecularEvent> = events.collect();
        let mut lights = plan.lights_of(surface).map(|id| &plan.lights[id.0 as usize]);
        let Some(light) = lights.find(|light| light.virtual_sources.is_empty()) else { return false };
        let Some(middle) = LampPoint::new(light, mis.receiver, [0.0; 2]) else { return false };
        let Some(bundle) = self.bundle((mis.receiver, mis.primitive), mis.direction, &events) else { return false };
        middle.passed(&bundle).is_none_or(|(_, slope)| is_large(slope.determinant().abs(), pdf))
    }

    /// The same for one lamp, which is selected with the probability `chance`.
    fn sample_caustic(
        &mut self,
        path: &PathState<BANDS>,
        direct: &DirectSampler<'_>,
        point: &Bsdf<'_, BANDS>,
        (light, seeds, chance): (&Light, &SeedDirections<'_>, f64),
    ) {
        let [u, v, roulette, _] = self.take_set();
        let Some(goal) = LampPoint::new(light, direct.point, [u, v]) else { return };
        let from = (direct.point, direct.primitive);
        let Some(found) = self.search(from, seeds, &goal) else { return };
        let is_before = seeds.facing.is_none_or(|normal| normal.dot(found.direction) > 0.0);
        let is_left_to_chance = is_large(found.magnification, seeds.pdf(found.direction));
        if !is_before || is_left_to_chance || !self.reaches(from, &found, light) {
            return;
        }
        let survival =
            (self.chain_throughput(Ray { origin: from.0, direction: found.direction }, from.1, &found.events)
                / MIN_THROUGHPUT)
                .min(1.0);
        if roulette >= survival {
            return;
        }
        let mut trials = 1;
        while trials < MAX_TRIALS && !self.search(from, seeds, &goal).is_some_and(|again| again.is_same_as(&found)) {
            trials += 1;
        }
        let pdf = found.pdf() * chance * survival / f64::from(trials);
        let lobe = Lobe::Caustic(CausticPath { chain: SpecularChain::of(&found.events), light: light.surface });
        self.scatter_caustic(path, direct, point, (found.direction, pdf, lobe));
    }

    /// One search for a direction from which a chain leads to a point of a lamp.
    fn search(
        &mut self,
        from: (DVec3, Option<PrimitiveId>),
        seeds: &SeedDirections<'_>,
        goal: &LampPoint<'_>,
    ) -> Option<Solution> {
        let [u, v, choice, chain] = self.take_set();
        let direction = seeds.draw([u, v, choice])?;
        let events = self.random_chain(from, direction, ChainChoices::new(chain))?;
        self.solve(from, direction, events, goal)
    }

    /// Whether a solution's chain has no occluder before its lamp.
    fn reaches(&mut self, from: (DVec3, Option<PrimitiveId>), found: &Solution, light: &Light) -> bool {
        let ray = Ray { origin: from.0, direction: found.direction };
        let Some((end, primitive)) = self.retraced(ray, from.1, found.events.iter().copied()) else { return false };
        if light.misses(end.origin) {
            return false;
        }
        let next = self.next_visible(end, primitive);
        if light.radius.is_infinite() { next.is_none() } else { next.is_some_and(|hit| hit.surface == light.surface) }
    }

    /// Newton's method from a direction.
    fn solve(
        &mut self,
        from: (DVec3, Option<PrimitiveId>),
        mut axis: DVec3,
        events: Vec<SpecularEvent>,
        goal: &LampPoint<'_>,
    ) -> Option<Solution> {
        for _ in 0..MAX_STEPS {
            let bundle = self.bundle(from, axis, &events)?;
            let (middle, slope) = goal.passed(&bundle)?;
            let magnification = slope.determinant().abs();
            if !(magnification.is_finite() && magnification > f64::MIN_POSITIVE) {
                return None;
            }
            if middle.length() < TOLERANCE {
                return Some(Solution { direction: axis, events, magnification });
            }
            let step = slope.inverse() * -middle;
            let step = step * (MAX_STEP / step.length()).min(1.0);
            axis = (0..=MAX_HALVINGS).find_map(|halvings| {
                let next = bundle.frame.direction(step * 0.5f64.powi(halvings as i32));
                let ray = Ray { origin: from.0, direction: next };
                let end = self.retrace(ray, from.1, events.iter().copied())?;
                (goal.miss(&end)?.length_squared() < middle.length_squared()).then_some(next)
            })?;
        }
        None
    }
}
