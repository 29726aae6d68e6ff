//! Light that returns to a retroreflector through curved mirrors and dielectrics.
//!
//! A retroreflective lobe sends light to lamps next to the eye. Through curved mirrors and
//! dielectrics no light sampling finds these lamps, and the lobe hits a small one by chance only.
//! But a ray along such a path that ends near a lamp is known: if the point is seen through
//! specular surfaces, the reversed path; otherwise a ray towards a lamp that hits a mirror. Two
//! adjacent rays give the linear map from directions at the point to positions at each lamp. Its
//! inverse maps the lamp's outline to a disk of directions: the lamp's image. Directions are
//! sampled from these disks with a pdf in closed form and traced like any others, so the map need
//! not be exact for the estimate to be unbiased. The lobe is sampled as well, and the balance
//! heuristic weights both (Veach and Guibas 1995, eq. 9).
//!
//! This is a manifold walk of two Newton steps (Hanika, Droske and Fascione 2015; Zeltner, Georgiev
//! and Jakob 2020) in the space of directions, for whole lamps at once. Since it does not depend on
//! a root, none can be missed or found twice.

use crate::retrace::MAX_LIGHTS;
use crate::specular_chain::{SpecularChain, SpecularEvent};
use crate::trace::PathIntegrator;
use glam::{DMat2, DVec2, DVec3};
use radsight_accel::{PrimitiveId, Ray};
use radsight_bsdf::{Bsdf, PdfRequest};
use radsight_light::{DiskWarp, Light, LightForm, LobePeak};
use radsight_sampling::{choose, unit_disk};
use radsight_texture::strongest;
use std::f64::consts::PI;

/// Tangent of the angle between a ray and its adjacent rays: less than an image's size, more than
/// rounding errors.
const DIFFERENCE_STEP: f64 = 1e-6;

/// Maximum distance of an image from the traced ray, and maximum size, as tangents: beyond it the
/// map is not linear.
const MAX_TANGENT: f64 = 1.0;

/// Number of directions sampled from the images of lamps.
const DRAWS: u32 = 4;

/// Maximum number of rays towards lamps that are refined.
const MAX_SEEDS: usize = 4;

/// Images with less than this fraction of the total weight are left to the lobe.
const NEGLIGIBLE: f64 = 1e-3;

/// A ray to the centre of an image is accurate if it ends within this fraction of the light's
/// radius from its centre.
const NEAR: f64 = 0.1;

/// Factor by which images are enlarged, since the map is not exactly linear.
const MARGIN: f64 = 1.15;

/// Maximum number of Newton steps.
const MAX_STEPS: u32 = 4;

/// Lamps where the lobe is below this fraction of its peak are ignored.
const MIN_LOBE: f64 = 1e-9;

/// Directions from a point to the images of lamps in specular surfaces.
#[derive(Debug, Default)]
pub(crate) struct SpecularReturn {
    images: Vec<LightImage>,
}

/// A disk of directions, in the tangent plane of one of them.
#[derive(Debug)]
struct LightImage {
    /// Index of the light in the plan.
    light: usize,
    frame: TangentPlane,
    center: DVec2,
    /// From the unit disk to the tangent plane, without the centre; and its inverse.
    map: DMat2,
    inverse: DMat2,
    /// Places more samples where the lobe is higher.
    warp: DiskWarp,
    /// Selection probability.
    chance: f64,
    /// The pdf of all samples in the tangent plane, without the warp's pdf.
    density: f64,
}

impl LightImage {
    /// The point of the unit disk of a unit direction; `None` outside the image.
    fn disk_point(&self, direction: DVec3) -> Option<DVec2> {
        let cosine = direction.dot(self.frame.axis);
        let at = self.inverse * (self.frame.components(direction) / cosine - self.center);
        (cosine > 0.0 && at.length_squared() <= 1.0).then_some(at)
    }
}

/// The tangent plane of the unit sphere of directions at one of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TangentPlane {
    axis: DVec3,
    across: [DVec3; 2],
}

impl TangentPlane {
    pub(crate) fn new(axis: DVec3) -> TangentPlane {
        let x = axis.any_orthonormal_vector();
        TangentPlane { axis, across: [x, axis.cross(x)] }
    }

    pub(crate) fn direction(&self, at: DVec2) -> DVec3 {
        (self.axis + self.across[0] * at.x + self.across[1] * at.y).normalize()
    }

    /// Components of a vector in the plane.
    pub(crate) fn components(&self, vector: DVec3) -> DVec2 {
        DVec2::new(vector.dot(self.across[0]), vector.dot(self.across[1]))
    }
}

impl SpecularReturn {
    /// Number of sampled directions.
    pub(crate) const fn draws(&self) -> u32 {
        DRAWS
    }

    /// Samples a unit direction; number `draw` of [`Self::draws`], stratified over the images.
    pub(crate) fn draw(&self, draw: u32, u: [f64; 3]) -> Option<DVec3> {
        let choice = (f64::from(draw) + u[2]) / f64::from(DRAWS);
        let (chosen, _) = choose(self.images.iter().map(|image| image.chance), choice)?;
        let image = &self.images[chosen];
        let at: DVec2 = image.warp.apply(unit_disk(u[0], u[1])).into();
        Some(image.frame.direction(image.center + image.map * at))
    }

    /// Expected number of samples of [`Self::draw`] per solid angle in a unit direction, 1/sr.
    pub(crate) fn density(&self, direction: DVec3) -> f64 {
        let density = |image: &LightImage| {
            let Some(at) = image.disk_point(direction) else { return 0.0 };
            let cosine = direction.dot(image.frame.axis);
            // dω = cos³θ of the area in the tangent plane.
            image.density * image.warp.pdf(at.into()) / (cosine * cosine * cosine)
        };
        self.images.iter().map(density).sum()
    }

    /// Whether the centre of an image lies in a known image of the same light: it was found twice.
    fn holds(&self, other: &LightImage) -> bool {
        let direction = other.frame.direction(other.center);
        self.images.iter().any(|image| image.light == other.light && image.disk_point(direction).is_some())
    }

    /// Distributes the samples in proportion to the weights of the images; `None` without images.
    fn settled(mut self) -> Option<SpecularReturn> {
        let total: f64 = self.images.iter().map(|image| image.chance).sum();
        for image in &mut self.images {
            image.chance /= total;
            image.density = f64::from(DRAWS) * image.chance / (PI * image.map.determinant().abs());
        }
        (total > 0.0 && total.is_finite()).then_some(self)
    }
}

/// The ends of a ray and of two adjacent ones after the same interactions.
pub(crate) struct RayBundle {
    pub(crate) frame: TangentPlane,
    pub(crate) middle: Ray,
    adjacent: [Ray; 2],
}

impl RayBundle {
    /// The ends of the ray and of the two adjacent ones, each [`Self::step`] away in the tangent
    /// plane.
    pub(crate) fn ends(&self) -> [&Ray; 3] {
        [&self.middle, &self.adjacent[0], &self.adjacent[1]]
    }

    /// Distance in the tangent plane between the ray and the adjacent ones.
    pub(crate) const fn step(&self) -> f64 {
        DIFFERENCE_STEP
    }

    /// The image of a light: centre in the tangent plane, and map from the unit disk.
    pub(crate) fn image_of(&self, light: &Light) -> Option<(DVec2, DMat2)> {
        if !light.virtual_sources.is_empty() || light.misses(self.middle.origin) {
            return None;
        }
        let plane = TangentPlane::new(self.middle.direction);
        let [middle, a, b] =
            [&self.middle, &self.adjacent[0], &self.adjacent[1]].map(|ray| passing_point(light, &plane, ray));
        let (middle, radius) = middle?;
        let slope = DMat2::from_cols((a?.0 - middle) / DIFFERENCE_STEP, (b?.0 - middle) / DIFFERENCE_STEP);
        let inverse = slope.inverse();
        let (center, map) = (inverse * -middle, inverse * radius);
        let largest = map.x_axis.length().max(map.y_axis.length());
        let is_good = center.is_finite() && map.determinant().abs() > f64::MIN_POSITIVE;
        (is_good && center.length() <= MAX_TANGENT && largest <= MAX_TANGENT).then_some((center, map))
    }
}

/// Where a ray passes the centre of a light, in the plane through it perpendicular to `plane`'s
/// axis, and the light's radius there.
pub(crate) fn passing_point(light: &Light, plane: &TangentPlane, ray: &Ray) -> Option<(DVec2, f64)> {
    let along = ray.direction.dot(plane.axis);
    let (disk_point, radius) = match light.form {
        LightForm::Distant { direction, half_angle_sin_squared_half: half, .. } => {
            let cosine = direction.dot(plane.axis);
            if half >= 0.25 || cosine <= 0.0 {
                return None;
            }
            let tangent = 2.0 * (half * (1.0 - half)).sqrt() / (1.0 - 2.0 * half);
            (ray.direction / along - direction / cosine, tangent)
        }
        LightForm::DistantImage { .. } => return None,
        _ => {
            let distance = (light.center - ray.origin).dot(plane.axis);
            if distance <= light.radius {
                return None;
            }
            (ray.at(distance / along) - light.center, light.radius)
        }
    };
    (along > 0.0).then(|| (plane.components(disk_point), radius))
}

/// A point whose highlight searches for lamps.
struct ReturnPoint<'b, const BANDS: usize> {
    from: (DVec3, Option<PrimitiveId>),
    bsdf: &'b Bsdf<'b, BANDS>,
    peak: LobePeak,
    /// Lamps where the lobe is not higher are ignored.
    least: f64,
}

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// The images of lamps in specular surfaces that a point sees around the retroreflected
    /// direction; `None` if there are none.
    ///
    /// `chain` is the chain between the path's origin and the point.
    pub(crate) fn specular_return(
        &mut self,
        chain: SpecularChain,
        from: (DVec3, Option<PrimitiveId>),
        bsdf: &Bsdf<'_, BANDS>,
    ) -> Option<SpecularReturn> {
        let plan = self.plan;
        if plan.has_antimatter || plan.lights_are_covered || plan.lights.len() > MAX_LIGHTS {
            return None;
        }
        let mut point = ReturnPoint { from, bsdf, peak: bsdf.peak(), least: 0.0 };
        let mut found = SpecularReturn::default();
        if let Some(events) = chain.backwards().filter(|_| !chain.is_straight()) {
            let events: Vec<SpecularEvent> = events.collect();
            self.add_images(&mut found, &point, (bsdf.outgoing, &events));
        }
        if plan.reflectors.iter().any(|reflector| reflector.is_near(from.0, bsdf.outgoing)) {
            point.least = MIN_LOBE * self.lobe(&point, bsdf.outgoing);
            let mut seeds = 0;
            for light in plan.lights.iter().filter(|light| light.virtual_sources.is_empty()) {
                if seeds == MAX_SEEDS {
                    break;
                }
                let Some((direction, events)) = self.mirrored_way(light, &point) else { continue };
                if !found.images.iter().any(|image| image.disk_point(direction).is_some()) {
                    seeds += 1;
                    self.add_images(&mut found, &point, (direction, &events));
                }
            }
        }
        found.settled()
    }

    /// A path close to a light through mirrors: the direction of its centre, if it hits a mirror.
    fn mirrored_way(&mut self, light: &Light, point: &ReturnPoint<'_, BANDS>) -> Option<(DVec3, Vec<SpecularEvent>)> {
        let (at, _) = point.from;
        let (direction, distance) = match light.form {
            LightForm::Distant { direction, .. } => (direction, f64::INFINITY),
            _ => ((light.center - at).normalize_or_zero(), light.center.distance(at)),
        };
        if self.lobe(point, direction) <= point.least {
            return None;
        }
        let mut rays = self.mirrored_rays(point.from, direction);
        let is_before_the_light = rays.first().is_some_and(|first| first.ray.origin.distance(at) < distance);
        is_before_the_light.then(|| rays.pop()).flatten().map(|last| (direction, last.events))
    }

    /// Adds the images of all lights through these interactions around a direction.
    fn add_images(
        &mut self,
        found: &mut SpecularReturn,
        point: &ReturnPoint<'_, BANDS>,
        (axis, events): (DVec3, &[SpecularEvent]),
    ) {
        let Some(first) = self.bundle(point.from, axis, events) else { return };
        let mut images = self.images(&first, point);
        if images.iter().any(|image| found.holds(image)) {
            return;
        }
        let total: f64 = images.iter().map(|image| image.chance).sum();
        images.retain(|image| image.chance > NEGLIGIBLE * total);
        for mut image in images {
            if !self.is_met(point.from, &image, events)
                && let Some(better) = self.refined(point, &image, events)
            {
                image = better;
            }
            found.images.push(image);
        }
    }

    /// Whether the ray to the centre of an image ends near enough to the centre of its light.
    fn is_met(
        &mut self,
        (at, primitive): (DVec3, Option<PrimitiveId>),
        image: &LightImage,
        events: &[SpecularEvent],
    ) -> bool {
        let direction = image.frame.direction(image.center);
        let end = self.retrace(Ray { origin: at, direction }, primitive, events.iter().copied());
        let passed =
            end.and_then(|end| passing_point(&self.plan.lights[image.light], &TangentPlane::new(end.direction), &end));
        passed.is_some_and(|(disk_point, radius)| disk_point.length() <= NEAR * radius)
    }

    /// The image of the same light from a bundle around its own centre: Newton's method; `None` if
    /// it does not converge.
    fn refined(
        &mut self,
        point: &ReturnPoint<'_, BANDS>,
        image: &LightImage,
        events: &[SpecularEvent],
    ) -> Option<LightImage> {
        let mut axis = image.frame.direction(image.center);
        for _ in 0..MAX_STEPS {
            let bundle = self.bundle(point.from, axis, events)?;
            let (center, map) = bundle.image_of(&self.plan.lights[image.light])?;
            if (map.inverse() * center).length() <= 0.5 {
                return self.image(&bundle, (image.light, center, map), point);
            }
            axis = bundle.frame.direction(center);
        }
        None
    }

    pub(crate) fn bundle(
        &mut self,
        (at, primitive): (DVec3, Option<PrimitiveId>),
        axis: DVec3,
        events: &[SpecularEvent],
    ) -> Option<RayBundle> {
        let frame = TangentPlane::new(axis);
        let mut follow = |tangent: DVec2| {
            let ray = Ray { origin: at, direction: frame.direction(tangent) };
            self.retrace(ray, primitive, events.iter().copied())
        };
        let middle = follow(DVec2::ZERO)?;
        let adjacent = [follow(DVec2::X * DIFFERENCE_STEP)?, follow(DVec2::Y * DIFFERENCE_STEP)?];
        Some(RayBundle { frame, middle, adjacent })
    }

    /// The images of all lights that a bundle ends near, with their weights.
    fn images(&mut self, bundle: &RayBundle, point: &ReturnPoint<'_, BANDS>) -> Vec<LightImage> {
        let mut images = Vec::new();
        for (index, light) in self.plan.lights.iter().enumerate() {
            let Some((center, map)) = bundle.image_of(light) else { continue };
            images.extend(self.image(bundle, (index, center, map), point));
        }
        images
    }

    /// A light's image with its weight; `None` for 0.
    fn image(
        &mut self,
        bundle: &RayBundle,
        (light, center, map): (usize, DVec2, DMat2),
        point: &ReturnPoint<'_, BANDS>,
    ) -> Option<LightImage> {
        let frame = bundle.frame;
        let map = map * MARGIN;
        let inverse = map.inverse();
        // The lobe at the centre of the image and where it is nearest to the retroreflected
        // direction.
        let outgoing = point.bsdf.outgoing;
        let back = frame.components(outgoing) / outgoing.dot(frame.axis).max(MAX_TANGENT / 2.0);
        let step = inverse * (back - center);
        let nearest = center + map * (step / step.length().max(1.0));
        let lobe = self.lobe(point, frame.direction(center)) + self.lobe(point, frame.direction(nearest));
        let chance = lobe * map.determinant().abs();
        let gradient = map.transpose() * frame.components(point.peak.gradient(frame.direction(center)));
        let warp = DiskWarp::new(gradient.x, gradient.y);
        let image = LightImage { light, frame, center, map, inverse, warp, chance, density: 0.0 };
        (chance > 0.0 && chance.is_finite()).then_some(image)
    }

    /// The strongest band of the highlight times the cosine, 1/sr.
    fn lobe(&mut self, point: &ReturnPoint<'_, BANDS>, direction: DVec3) -> f64 {
        strongest(&point.bsdf.eval(direction, 1.0, PdfRequest::Unused, &mut self.workspace.scratch).highlight)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use radsight_sampling::{DimensionSet, RaySampler};

    fn image(center: DVec2, map: DMat2, chance: f64) -> LightImage {
        let frame = TangentPlane::new(DVec3::new(0.3, -0.2, 0.9).normalize());
        let warp = DiskWarp::new(1.5, -0.7);
        LightImage { light: 0, frame, center, map, inverse: map.inverse(), warp, chance, density: 0.0 }
    }

    /// Two overlapping ellipses, and one far away.
    fn images() -> SpecularReturn {
        let round = DMat2::from_diagonal(DVec2::splat(0.1));
        let long = DMat2::from_cols(DVec2::new(0.02, 0.15), DVec2::new(-0.05, 0.01));
        let far = image(DVec2::new(-0.6, 0.5), round, 0.5);
        let images = vec![image(DVec2::new(0.1, 0.0), round, 3.0), image(DVec2::new(0.15, 0.05), long, 1.0), far];
        SpecularReturn { images }.settled().expect("there are images")
    }

    #[test]
    fn directions_have_the_density_that_is_claimed() {
        let images = images();
        let axis = DVec3::new(0.3, -0.2, 0.9).normalize();
        let smooth = |direction: DVec3| 1.0 + direction.x - 2.0 * direction.y * direction.z;
        // ∫ smooth over all images, by sampling and by a grid in the tangent plane.
        let points = 1 << 18;
        let mut by_draws = 0.0;
        for index in 0..points {
            let [u, v, choice, _] = RaySampler::new(1, index).take(DimensionSet::CAMERA);
            for draw in 0..images.draws() {
                let direction = images.draw(draw, [u, v, choice]).expect("a direction");
                by_draws += smooth(direction) / images.density(direction);
            }
        }
        by_draws /= points as f64;
        let frame = TangentPlane::new(axis);
        let steps = 3000;
        let mut by_grid = 0.0;
        for index in 0..steps * steps {
            let at = |k: u32| 2.0 * (f64::from(k) + 0.5) / f64::from(steps) - 1.0;
            let direction = frame.direction(DVec2::new(at(index % steps), at(index / steps)));
            if images.density(direction) > 0.0 {
                by_grid += smooth(direction) * direction.dot(axis).powi(3);
            }
        }
        by_grid *= 4.0 / f64::from(steps * steps);
        assert!((by_draws / by_grid - 1.0).abs() < 2e-3, "{by_draws} and {by_grid}");
    }

    #[test]
    fn an_image_that_is_known_is_found_again_by_its_light_alone() {
        let images = images();
        let inside = image(DVec2::new(0.12, 0.01), DMat2::IDENTITY, 1.0);
        assert!(images.holds(&inside));
        assert!(!images.holds(&LightImage { light: 1, ..inside }));
        assert!(!images.holds(&image(DVec2::new(0.8, 0.8), DMat2::IDENTITY, 1.0)));
    }

    #[test]
    fn without_images_nothing_is_drawn() {
        assert!(SpecularReturn::default().settled().is_none());
    }
}
