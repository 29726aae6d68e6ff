//! Images of lights in curved mirrors, seen from a point: bright points that rays through a pixel
//! hit by chance only.
//!
//! A grid of rays over each mirror is traced until they leave the last mirror. Where one passes a
//! light nearer than its neighbours do, Newton's method finds the ray to the light's centre
//! (Hanika, Droske and Fascione 2015). Images that are not found are not lost: random rays still
//! hit them.

use crate::retrace::{MAX_LIGHTS, MirroredRay};
use crate::specular_chain::SpecularEvent;
use crate::specular_return::{TangentPlane, passing_point};
use crate::trace::PathIntegrator;
use glam::{DVec2, DVec3};
use radsight_accel::Ray;
use radsight_compile::{Kind, Reflector, RenderPlan};
use radsight_ir::{Ring, Shape, SurfaceHandle};
use radsight_light::{Light, LightForm};
use std::ops::Range;

/// Total number of rays over all mirrors, and minimum over the side of one.
const MAX_RAYS: f64 = 1e5;
const MIN_SIDE: usize = 8;
const MAX_SIDE: usize = 96;

/// Newton's method takes at most this many steps, and converges within this fraction of a light's
/// radius.
const MAX_STEPS: u32 = 12;
const MET: f64 = 1e-3;

/// A ray towards the mirror image of a light in a flat surface passes it within so many radii, if
/// refraction shifts it.
const NEAR_LIGHT: f64 = 8.0;

/// Accepted distance where it does not converge, as between the facets of a mesh, in radii of the
/// light.
const MAX_MISS: f64 = 1.5;

/// Two directions closer than this fraction of an image's size are the same image.
const SAME_IMAGE: f64 = 0.5;

/// A light that is seen from a point through mirrors.
#[derive(Clone, Debug)]
pub struct MirroredLight {
    light: usize,
    /// The specular events along a ray. Empty for a virtual source, whose rays are straight.
    events: Vec<SpecularEvent>,
    /// The plane mirror of a virtual source, and its outline if it is a ring.
    mirror: Option<SurfaceHandle>,
    outline: Option<Ring>,
    /// The plane in which rays' distances from the light's centre are measured.
    plane: TangentPlane,
    direction: DVec3,
    /// Approximate half angle of the image, as a tangent.
    size: f64,
    /// The cone around the plane mirror from the observer: its unit axis and the tangent of its half
    /// angle.
    mirror_cone: Option<(DVec3, f64)>,
}

impl MirroredLight {
    /// Unit direction from the observer to the image's centre.
    #[must_use]
    pub fn direction(&self) -> DVec3 {
        self.direction
    }

    /// Index of the light.
    #[must_use]
    pub fn light(&self) -> usize {
        self.light
    }

    /// The specular events along its rays, as in [`SpecularEnd::chain`](crate::SpecularEnd::chain).
    #[must_use]
    pub fn chain(&self) -> u32 {
        self.events.iter().fold(1, |chain, event| event.appended_to(chain))
    }

    /// A cone around all directions in which a virtual source may be seen: its unit axis and the
    /// tangent of its half angle. `None` if it is not known.
    #[must_use]
    pub fn mirror_cone(&self) -> Option<(DVec3, f64)> {
        self.mirror_cone
    }

    /// Whether a ray first hits the plane mirror of a virtual source.
    #[must_use]
    pub fn is_in_plane_mirror(&self, plan: &RenderPlan, ray: &Ray) -> bool {
        plan.first_hit(ray, None).is_some_and(|hit| Some(hit.surface) == self.mirror)
    }

    /// Where a ray crosses the plane of a mirror that is a ring: its position relative to the
    /// ring's centre, in outer radii.
    #[must_use]
    pub fn place_in_ring(&self, ray: &Ray) -> Option<DVec2> {
        let ring = self.outline.as_ref()?;
        let distance = (ring.center - ray.origin).dot(ring.normal) / ray.direction.dot(ring.normal);
        let place = TangentPlane::new(ring.normal).components(ray.at(distance) - ring.center) / ring.outer_radius;
        place.is_finite().then_some(place)
    }

    /// Inner radius of a mirror that is a ring, in outer radii.
    #[must_use]
    pub fn ring_opening(&self) -> Option<f64> {
        self.outline.as_ref().map(|ring| ring.inner_radius / ring.outer_radius)
    }

    /// The virtual sources that a point may see in plane mirrors; scene units.
    #[must_use]
    pub fn in_plane_mirrors(plan: &RenderPlan, from: DVec3) -> Vec<MirroredLight> {
        if plan.has_antimatter || plan.lights.len() > MAX_LIGHTS {
            return Vec::new();
        }
        let image = |(index, light): (usize, &Light)| {
            let nearest = light.virtual_sources.first()?;
            let shader = plan.virtual_source_shader(nearest.surface);
            if !matches!(shader.kind, Kind::Mirror { substitute: None, .. }) {
                return None;
            }
            let [direction, axis] = match light.form {
                LightForm::Distant { direction, .. } => [direction, direction],
                LightForm::DistantImage { .. } => return None,
                // In its own plane the image of a flat light is exact.
                LightForm::Disk { normal, .. } => [(light.center - from).normalize_or_zero(), -normal],
                _ => [(light.center - from).normalize_or_zero(); 2],
            };
            let size = light.radius / from.distance(light.center);
            let shape = plan.scene.surfaces[nearest.surface].shape;
            let around = plan.geometry.bounds(&plan.scene, shape).map(|bounds| Reflector::around(bounds, None));
            (direction.dot(axis) > 0.0).then(|| MirroredLight {
                light: index,
                events: Vec::new(),
                mirror: Some(nearest.surface),
                outline: match shape {
                    Shape::Ring(ring) => Some(plan.scene.rings[ring]),
                    _ => None,
                },
                plane: TangentPlane::new(axis),
                direction,
                size,
                mirror_cone: around.and_then(|around| around.cone(from)),
            })
        };
        plan.lights.iter().enumerate().filter_map(image).collect()
    }
}

/// Where a ray passes a light: its offset from the light's centre in the light's plane, in radii of the
/// light. The plane of a light that is not flat is perpendicular to `towards`. `None` where the ray
/// cannot see the light.
#[must_use]
pub fn light_offset(plan: &RenderPlan, light: usize, towards: DVec3, ray: &Ray) -> Option<DVec2> {
    let light = &plan.lights[light];
    if !light.virtual_sources.is_empty() || light.misses(ray.origin) {
        return None;
    }
    let axis = light.form.plane().map_or(towards, |(normal, _)| -normal);
    let (position, radius) = passing_point(light, &TangentPlane::new(axis), ray)?;
    Some(position / radius)
}

/// The squared distance from a light's centre at which a ray passes it, in radii of the light. `None` where
/// it cannot see the light.
fn passing(light: &Light, ray: &Ray) -> Option<f64> {
    if light.misses(ray.origin) {
        return None;
    }
    let (position, radius) = passing_point(light, &TangentPlane::new(ray.direction), ray)?;
    Some((position / radius).length_squared())
}

/// A square grid of directions around the cone of a reflector.
struct DirectionGrid {
    /// Around the axis of the cone.
    frame: TangentPlane,
    /// Tangent of the cone's half angle.
    reach: f64,
    /// Number of directions along each side.
    side: usize,
}

impl DirectionGrid {
    /// Unit.
    fn direction(&self, index: usize) -> DVec3 {
        let along = |index: usize| self.reach * (2.0 * (index as f64 + 0.5) / self.side as f64 - 1.0);
        self.frame.direction(DVec2::new(along(index % self.side), along(index / self.side)))
    }
}

/// Each image once.
fn distinct(found: Vec<MirroredLight>) -> Vec<MirroredLight> {
    let mut distinct: Vec<MirroredLight> = Vec::new();
    for image in found {
        let is_same = |other: &MirroredLight| {
            other.light == image.light
                && other.events == image.events
                && other.direction.distance(image.direction) < SAME_IMAGE * image.size.max(other.size)
        };
        if !distinct.iter().any(is_same) {
            distinct.push(image);
        }
    }
    distinct
}

/// Where the rays of a grid pass a light, by their chains.
#[derive(Default)]
struct Passings {
    /// For each ray the range of its passings.
    of_ray: Vec<Range<usize>>,
    /// The chain, and the squared distance from the light's centre, in its radii.
    all: Vec<(u32, f64)>,
}

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// The images of lights in curved mirrors that are found from a point.
    pub(crate) fn mirrored_lights(&mut self, from: DVec3, is_seen: &dyn Fn(DVec3, f64) -> bool) -> Vec<MirroredLight> {
        let plan = self.plan;
        let mut found = Vec::new();
        if plan.has_antimatter || plan.lights.len() > MAX_LIGHTS {
            return found;
        }
        self.add_lights_in_flat_reflectors(from, is_seen, &mut found);
        if plan.reflectors.is_empty() {
            return distinct(found);
        }
        let in_plane_mirrors = MirroredLight::in_plane_mirrors(plan, from);
        let side = ((MAX_RAYS / plan.reflectors.len() as f64).sqrt() as usize).clamp(MIN_SIDE, MAX_SIDE);
        for reflector in &plan.reflectors {
            if let Some((axis, reach)) = reflector.cone(from).filter(|(axis, reach)| is_seen(*axis, *reach)) {
                let grid = DirectionGrid { frame: TangentPlane::new(axis), reach, side };
                found.extend(self.lights_in_reflector(from, reflector, &grid, &in_plane_mirrors));
            }
        }
        distinct(found)
    }

    /// Adds the images of lights in flat surfaces. A ray towards the mirror image of a light's centre shows
    /// it, or, by way of dielectrics, comes near it.
    fn add_lights_in_flat_reflectors(
        &mut self,
        from: DVec3,
        is_seen: &dyn Fn(DVec3, f64) -> bool,
        found: &mut Vec<MirroredLight>,
    ) {
        let plan = self.plan;
        let lights = || plan.lights.iter().enumerate().filter(|(_, light)| light.virtual_sources.is_empty());
        for reflector in &plan.flat_reflectors.surfaces {
            for (index, light) in lights() {
                let (direction, size) = match light.form {
                    LightForm::Distant { direction, .. } => (reflector.image_of_direction(direction), 0.0),
                    LightForm::DistantImage { .. } => continue,
                    _ => {
                        let offset = reflector.image_of_point(light.center) - from;
                        (offset.normalize_or_zero(), light.radius / offset.length())
                    }
                };
                let is_possible = direction != DVec3::ZERO && is_seen(direction, NEAR_LIGHT * size);
                let rays = if is_possible { self.image_rays((from, None), direction) } else { Vec::new() };
                for MirroredRay { ray, events, .. } in rays {
                    if passing(light, &ray).is_some_and(|squared| squared <= NEAR_LIGHT * NEAR_LIGHT) {
                        found.extend(self.mirrored_light(from, direction, (index, events)));
                    }
                }
            }
        }
    }

    /// The images of lights that directions towards a reflector lead to, except those with one
    /// reflection that are known to be in plane mirrors. An image may be found several times.
    fn lights_in_reflector(
        &mut self,
        from: DVec3,
        reflector: &Reflector,
        grid: &DirectionGrid,
        in_plane_mirrors: &[MirroredLight],
    ) -> Vec<MirroredLight> {
        let (plan, mut found) = (self.plan, Vec::new());
        let mut rays_at = |index: usize| {
            let direction = grid.direction(index);
            let is_hit = reflector.is_hit(&plan.geometry, &plan.scene, &Ray { origin: from, direction });
            if is_hit { self.image_rays((from, None), direction) } else { Vec::new() }
        };
        let rays: Vec<_> = (0..grid.side * grid.side).map(&mut rays_at).collect();
        if rays.iter().all(Vec::is_empty) {
            return found;
        }
        for light in (0..plan.lights.len()).filter(|light| plan.lights[*light].virtual_sources.is_empty()) {
            let is_known = |direction: DVec3| {
                let is_of_light =
                    |image: &&MirroredLight| plan.lights[image.light].surface == plan.lights[light].surface;
                let mut images = in_plane_mirrors.iter().filter(is_of_light);
                let ray = Ray::new(from, direction);
                ray.is_some_and(|ray| images.any(|image| image.is_in_plane_mirror(plan, &ray)))
            };
            for (seed, chain) in self.passings(light, &rays).nearest(grid.side) {
                let Some(ray) = rays[seed].iter().find(|ray| ray.chain == chain) else { continue };
                let (direction, events) = (grid.direction(seed), ray.events.clone());
                if !(events.len() == 1 && is_known(direction)) {
                    found.extend(self.mirrored_light(from, direction, (light, events)));
                }
            }
        }
        found
    }

    fn passings(&self, light: usize, grid: &[Vec<MirroredRay>]) -> Passings {
        let light = &self.plan.lights[light];
        let mut passings = Passings::default();
        for rays in grid {
            let first = passings.all.len();
            passings.all.extend(rays.iter().filter_map(|ray| Some((ray.chain, passing(light, &ray.ray)?))));
            passings.of_ray.push(first..passings.all.len());
        }
        passings
    }

    /// Newton's method from a direction to the centre of a light.
    fn mirrored_light(
        &mut self,
        from: DVec3,
        mut axis: DVec3,
        (light, events): (usize, Vec<SpecularEvent>),
    ) -> Option<MirroredLight> {
        let mut best: Option<(f64, MirroredLight)> = None;
        for _ in 0..MAX_STEPS {
            let Some(bundle) = self.bundle((from, None), axis, &events) else { break };
            let Some((center, map)) = bundle.image_of(&self.plan.lights[light]) else { break };
            let miss = (map.inverse() * center).length();
            let direction = bundle.frame.direction(center);
            if best.as_ref().is_none_or(|(least, _)| miss < *least) {
                let size = map.determinant().abs().sqrt();
                let plane = TangentPlane::new(bundle.middle.direction);
                best = Some((
                    miss,
                    MirroredLight {
                        light,
                        events: events.clone(),
                        mirror: None,
                        outline: None,
                        plane,
                        direction,
                        size,
                        mirror_cone: None,
                    },
                ));
            }
            if miss <= MET {
                break;
            }
            axis = direction;
        }
        best.filter(|(miss, _)| *miss <= MAX_MISS).map(|(_, image)| image)
    }

    /// Where a ray passes a mirrored light, in radii of the light from its centre; `None` if it
    /// takes another path.
    pub(crate) fn offset_from(&mut self, image: &MirroredLight, ray: &Ray) -> Option<DVec2> {
        let end = self.retrace(*ray, None, image.events.iter().copied())?;
        let (position, radius) = passing_point(&self.plan.lights[image.light], &image.plane, &end)?;
        Some(position / radius)
    }
}

impl Passings {
    /// The rays of a grid of `side`² that pass nearer than those beside them, and by which chains.
    fn nearest(&self, side: usize) -> Vec<(usize, u32)> {
        let of_ray = |index: usize| &self.all[self.of_ray[index].clone()];
        let is_least = |index: usize, chain: u32, own: f64| {
            let (column, row) = (index % side, index / side);
            let rows = row.saturating_sub(1)..=(row + 1).min(side - 1);
            rows.flat_map(|y| (column.saturating_sub(1)..=(column + 1).min(side - 1)).map(move |x| y * side + x))
                .flat_map(of_ray)
                .all(|(other_chain, other)| *other_chain != chain || own <= *other)
        };
        let all = (0..self.of_ray.len()).flat_map(|index| of_ray(index).iter().map(move |passing| (index, passing)));
        all.filter(|(index, (chain, own))| is_least(*index, *chain, *own))
            .map(|(index, (chain, _))| (index, *chain))
            .collect()
    }
}
