//! Light that comes back to a retroreflector by way of curved mirrors and refracting bodies.
//!
//! A lobe about the way back sends light to lamps beside the eye. By way of curved mirrors and through refracting bodies no light sampling finds these
//! lamps, and the lobe meets a small one by chance only. But a ray that takes such a way and ends near a lamp is known: where the point is seen by
//! way of specular surfaces, the way back through them; else a ray towards a lamp that meets a mirror. Two rays beside it give the linear map
//! from directions at the point to places at each lamp, and its inverse turns the lamp's outline into a disk of directions: the lamp's
//! image. Directions are drawn from these disks with a density in closed form and followed as any other, so that the map need not be exact for
//! the estimate to be unbiased; draws from the lobe stay, and the balance heuristic weighs both (Veach and Guibas 1995, eq. 9).
//!
//! This is a manifold walk of two Newton steps (Hanika, Droske and Fascione 2015; Zeltner, Georgiev and Jakob 2020) in the space of
//! directions, taken for whole lamps at once. Since no root is looked for, none can be missed or found twice.

use crate::retrace::MOST_LIGHTS;
use crate::specular_chain::{SpecularChain, SpecularEvent};
use crate::trace::PathIntegrator;
use glam::{DMat2, DVec2, DVec3};
use radsight_accel::{PrimitiveId, Ray};
use radsight_bsdf::{Bsdf, PdfRequest};
use radsight_light::{DiskWarp, Light, LightForm, LobePeak};
use radsight_sampling::{choose, unit_disk};
use radsight_texture::strongest;
use std::f64::consts::PI;

/// Tangent of the angle at which rays beside another leave it: less than an image's size, more than rounding.
const BESIDE: f64 = 1e-6;

/// An image farther from the traced ray than this, as a tangent, or larger, is not drawn from: the map is not linear there.
const FARTHEST: f64 = 1.0;

/// How many directions are drawn from the images of lamps.
const DRAWS: u32 = 4;

/// Rays towards no more lamps are looked at closer.
const MOST_SEEDS: usize = 4;

/// An image that is worth less than this share of all is left to the lobe.
const NEGLIGIBLE: f64 = 1e-3;

/// A ray to the middle of an image that ends within this share of the light's radius from its middle is good enough.
const NEAR: f64 = 0.1;

/// Images are this much larger than the map makes them, since it is not quite linear.
const MARGIN: f64 = 1.15;

/// Newton's method takes no more steps.
const MOST_STEPS: u32 = 4;

/// A lamp where the lobe is below this share of its peak is not looked for.
const FAINT: f64 = 1e-9;

/// Directions from a point to the images of lamps in specular surfaces.
#[derive(Debug, Default)]
pub(crate) struct SpecularReturn {
    images: Vec<LightImage>,
}

/// A disk of directions, in the tangent plane of one of them.
#[derive(Debug)]
struct LightImage {
    /// Of which light, by its place in the plan.
    light: usize,
    frame: TangentPlane,
    center: DVec2,
    /// From the unit disk to the tangent plane, without the centre; and back.
    map: DMat2,
    inverse: DMat2,
    /// Draws more where the lobe is higher.
    warp: DiskWarp,
    /// How often it is chosen.
    chance: f64,
    /// Times the warp's density, that of all draws in the tangent plane.
    density: f64,
}

impl LightImage {
    /// The point of the unit disk that a unit direction comes from; `None` outside of the image.
    fn place(&self, direction: DVec3) -> Option<DVec2> {
        let cosine = direction.dot(self.frame.axis);
        let at = self.inverse * (self.frame.components(direction) / cosine - self.center);
        (cosine > 0.0 && at.length_squared() <= 1.0).then_some(at)
    }
}

/// The plane that touches the unit sphere of directions at one of them.
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
    fn components(&self, vector: DVec3) -> DVec2 {
        DVec2::new(vector.dot(self.across[0]), vector.dot(self.across[1]))
    }
}

impl SpecularReturn {
    /// How many directions are drawn.
    pub(crate) const fn draws(&self) -> u32 {
        DRAWS
    }

    /// A unit direction; draw number `draw` of [`Self::draws`] chooses among the images evenly with the others.
    pub(crate) fn draw(&self, draw: u32, u: [f64; 3]) -> Option<DVec3> {
        let choice = (f64::from(draw) + u[2]) / f64::from(DRAWS);
        let (chosen, _) = choose(self.images.iter().map(|image| image.chance), choice)?;
        let image = &self.images[chosen];
        let at: DVec2 = image.warp.apply(unit_disk(u[0], u[1])).into();
        Some(image.frame.direction(image.center + image.map * at))
    }

    /// Expected number of draws of [`Self::draw`] per solid angle about a unit direction, 1/sr.
    pub(crate) fn density(&self, direction: DVec3) -> f64 {
        let density = |image: &LightImage| {
            let Some(at) = image.place(direction) else { return 0.0 };
            let cosine = direction.dot(image.frame.axis);
            // dω = cos³θ of the area in the tangent plane.
            image.density * image.warp.pdf(at.into()) / (cosine * cosine * cosine)
        };
        self.images.iter().map(density).sum()
    }

    /// Whether the middle of an image lies in one of the same light that is known: it was found from another side.
    fn holds(&self, other: &LightImage) -> bool {
        let direction = other.frame.direction(other.center);
        self.images.iter().any(|image| image.light == other.light && image.place(direction).is_some())
    }

    /// Divides the draws in proportion to what each image is worth; `None` without images.
    fn settled(mut self) -> Option<SpecularReturn> {
        let total: f64 = self.images.iter().map(|image| image.chance).sum();
        for image in &mut self.images {
            image.chance /= total;
            image.density = f64::from(DRAWS) * image.chance / (PI * image.map.determinant().abs());
        }
        (total > 0.0 && total.is_finite()).then_some(self)
    }
}

/// Where a ray and two beside it end after the same interactions.
pub(crate) struct RayBundle {
    pub(crate) frame: TangentPlane,
    pub(crate) middle: Ray,
    beside: [Ray; 2],
}

impl RayBundle {
    /// The ends of the ray and of the two beside it, each [`Self::step`] away in the tangent plane.
    pub(crate) fn ends(&self) -> [&Ray; 3] {
        [&self.middle, &self.beside[0], &self.beside[1]]
    }

    /// Distance in the tangent plane between the ray and those beside it.
    pub(crate) const fn step(&self) -> f64 {
        BESIDE
    }

    /// The image of a light: centre in the tangent plane, and map from the unit disk.
    pub(crate) fn image_of(&self, light: &Light) -> Option<(DVec2, DMat2)> {
        if !light.virtual_sources.is_empty() || light.misses(self.middle.origin) {
            return None;
        }
        let plane = TangentPlane::new(self.middle.direction);
        let [middle, a, b] =
            [&self.middle, &self.beside[0], &self.beside[1]].map(|ray| passing_place(light, &plane, ray));
        let (middle, radius) = middle?;
        let slope = DMat2::from_cols((a?.0 - middle) / BESIDE, (b?.0 - middle) / BESIDE);
        let inverse = slope.inverse();
        let (center, map) = (inverse * -middle, inverse * radius);
        let largest = map.x_axis.length().max(map.y_axis.length());
        let is_good = center.is_finite() && map.determinant().abs() > f64::MIN_POSITIVE;
        (is_good && center.length() <= FARTHEST && largest <= FARTHEST).then_some((center, map))
    }
}

/// Where a ray passes the middle of a light, in the plane through it across `plane`'s axis, and the light's radius there.
pub(crate) fn passing_place(light: &Light, plane: &TangentPlane, ray: &Ray) -> Option<(DVec2, f64)> {
    let along = ray.direction.dot(plane.axis);
    let (place, radius) = match light.form {
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
    (along > 0.0).then(|| (plane.components(place), radius))
}

/// A point whose highlight looks for lamps.
struct ReturnPoint<'b, const BANDS: usize> {
    from: (DVec3, Option<PrimitiveId>),
    bsdf: &'b Bsdf<'b, BANDS>,
    peak: LobePeak,
    /// A lamp where the lobe is no higher is not looked for.
    least: f64,
}

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// The images of lamps in specular surfaces that a point sees about the way back; `None` where there are none.
    ///
    /// `chain` is how the point itself is seen from the path's beginning.
    pub(crate) fn specular_return(
        &mut self,
        chain: SpecularChain,
        from: (DVec3, Option<PrimitiveId>),
        bsdf: &Bsdf<'_, BANDS>,
    ) -> Option<SpecularReturn> {
        let plan = self.plan;
        if plan.has_antimatter || plan.lights_are_covered || plan.lights.len() > MOST_LIGHTS {
            return None;
        }
        let mut point = ReturnPoint { from, bsdf, peak: bsdf.peak(), least: 0.0 };
        let mut found = SpecularReturn::default();
        if let Some(events) = chain.backwards() {
            let events: Vec<SpecularEvent> = events.collect();
            self.add_images(&mut found, &point, (bsdf.outgoing, &events));
        }
        if plan.reflectors.iter().any(|reflector| reflector.is_near(from.0, bsdf.outgoing)) {
            point.least = FAINT * self.lobe(&point, bsdf.outgoing);
            let mut seeds = 0;
            for light in plan.lights.iter().filter(|light| light.virtual_sources.is_empty()) {
                if seeds == MOST_SEEDS {
                    break;
                }
                let Some((direction, events)) = self.mirrored_way(light, &point) else { continue };
                if !found.images.iter().any(|image| image.place(direction).is_some()) {
                    seeds += 1;
                    self.add_images(&mut found, &point, (direction, &events));
                }
            }
        }
        found.settled()
    }

    /// A way to somewhere near a light by way of mirrors: the direction of its middle, if a mirror is there.
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

    /// Adds the images of all lights by way of these interactions about a direction.
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

    /// Whether the ray to the middle of an image ends near enough to the middle of its light.
    fn is_met(
        &mut self,
        (at, primitive): (DVec3, Option<PrimitiveId>),
        image: &LightImage,
        events: &[SpecularEvent],
    ) -> bool {
        let direction = image.frame.direction(image.center);
        let end = self.retrace(Ray { origin: at, direction }, primitive, events.iter().copied());
        let passed =
            end.and_then(|end| passing_place(&self.plan.lights[image.light], &TangentPlane::new(end.direction), &end));
        passed.is_some_and(|(place, radius)| place.length() <= NEAR * radius)
    }

    /// The image of the same light from a bundle about its own middle: Newton's method; `None` where that does not converge.
    fn refined(
        &mut self,
        point: &ReturnPoint<'_, BANDS>,
        image: &LightImage,
        events: &[SpecularEvent],
    ) -> Option<LightImage> {
        let mut axis = image.frame.direction(image.center);
        for _ in 0..MOST_STEPS {
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
        let beside = [follow(DVec2::X * BESIDE)?, follow(DVec2::Y * BESIDE)?];
        Some(RayBundle { frame, middle, beside })
    }

    /// The images of all lights that a bundle ends near, each with what it is worth.
    fn images(&mut self, bundle: &RayBundle, point: &ReturnPoint<'_, BANDS>) -> Vec<LightImage> {
        let mut images = Vec::new();
        for (index, light) in self.plan.lights.iter().enumerate() {
            let Some((center, map)) = bundle.image_of(light) else { continue };
            images.extend(self.image(bundle, (index, center, map), point));
        }
        images
    }

    /// A light's image with what it is worth; `None` where that is nothing.
    fn image(
        &mut self,
        bundle: &RayBundle,
        (light, center, map): (usize, DVec2, DMat2),
        point: &ReturnPoint<'_, BANDS>,
    ) -> Option<LightImage> {
        let frame = bundle.frame;
        let map = map * MARGIN;
        let inverse = map.inverse();
        // The lobe at the middle of the image and where it is nearest to the way back.
        let outgoing = point.bsdf.outgoing;
        let back = frame.components(outgoing) / outgoing.dot(frame.axis).max(FARTHEST / 2.0);
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

    /// Two ellipses that overlap, and one far away.
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
        // ∫ smooth over all images, by draws and by a grid in the tangent plane.
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
