//! Where light from outside comes in: panes with sky behind them, and glows that are not sampled as lights.
//!
//! Rays that look around from a point in a room find its windows by chance only. Half of those that are drawn one by one, and some more of those
//! that look around together, are sent towards openings instead; all are weighted with the balance heuristic (Veach and Guibas, SIGGRAPH
//! 1995), so that nothing is counted twice and an opening that turns out to be dark costs little.
//!
//! What an opening promises is looked up before the first ray. Guarantees: densities are those of the draws, with regard to openings
//! that are seen behind each other.

use crate::light_form::LightForm;
use crate::plan::RenderPlan;
use crate::shader::{EmitterClass, Kind, Shader};
use crate::surface_interaction::SurfaceInteraction;
use glam::DVec3;
use radsight_accel::{MemberId, PrimitiveId, Ray, is_flat};
use radsight_cal::Scratch;
use radsight_ir::{Surface, SurfaceHandle};
use radsight_sampling::{DimensionSet, RaySampler, cosine_hemisphere};

/// The openings of a scene.
#[derive(Debug, Default)]
pub(crate) struct Portals(Vec<Portal>);

/// One side of a flat surface through which light comes.
#[derive(Clone, Debug)]
struct Portal {
    /// Turned to where the light goes.
    form: LightForm,
    /// Unit normal on that side, and a point of the plane.
    normal: DVec3,
    place: DVec3,
    area: f64,
    /// Sphere around it.
    center: DVec3,
    radius: f64,
    /// Radiance that comes through, about.
    radiance: f64,
}

/// The openings as they are seen from a point.
#[derive(Debug)]
pub(crate) struct VisiblePortals<'p> {
    portals: &'p [Portal],
    point: DVec3,
    /// Those that promise something, and what.
    importances: [(u32, f64); MOST_OPENINGS],
    len: usize,
    total: f64,
    /// The share of rays that are sent towards openings.
    pub(crate) chance: f64,
}

/// No more openings are known: the brightest ones.
const MOST_OPENINGS: usize = 48;

/// Surfaces that are looked through to see whether they are openings: the largest ones.
const MOST_CANDIDATES: usize = 128;

/// Rays that look through each side of a surface.
const LOOKS: u32 = 16;

/// Openings that bring less than this share of what the brightest one does for its area are left out.
const LEAST_SHARE: f64 = 0.05;

/// Panes behind each other that a look goes through.
const MOST_PANES: u32 = 8;

impl Portals {
    /// Looks for the openings of a scene.
    pub(crate) fn new(plan: &RenderPlan) -> Portals {
        let has_sky = plan.sky.iter().any(|sky| !is_sampled(plan, sky.surface));
        let mut candidates: Vec<(MemberId, SurfaceHandle, LightForm)> = plan
            .geometry
            .members()
            .filter(|(member, handle)| plan.geometry.is_plain(*member) && can_let_in(plan, *handle, has_sky))
            .filter_map(|(member, handle)| {
                let form = LightForm::new(&plan.scene, plan.scene.surfaces[handle].shape)?;
                form.plane().is_some().then_some((member, handle, form))
            })
            .collect();
        candidates.sort_by(|one, two| two.2.area().total_cmp(&one.2.area()));
        candidates.truncate(MOST_CANDIDATES);
        let mut scratch = Scratch::default();
        let mut portals: Vec<Portal> = candidates
            .into_iter()
            .flat_map(|(member, handle, form)| {
                let turned = turned(&form);
                [form, turned].into_iter().filter_map(Portal::new).map(move |side| (member, handle, side))
            })
            .map(|(member, handle, side)| side.looked_through(plan, (member, handle), &mut scratch))
            .filter(|portal| portal.radiance > 0.0)
            .collect();
        let brightest = portals.iter().map(|portal| portal.radiance).fold(0.0, f64::max);
        portals.retain(|portal| portal.radiance >= LEAST_SHARE * brightest);
        portals.sort_by(|one, two| two.power().total_cmp(&one.power()));
        portals.truncate(MOST_OPENINGS);
        Portals(portals)
    }

    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    /// What a point of a surface sees of them on the side of its unit normal; `None` where it is nothing.
    pub(crate) fn seen_from(&self, point: DVec3, normal: DVec3) -> Option<VisiblePortals<'_>> {
        if self.0.is_empty() {
            return None;
        }
        let importances = [(0, 0.0); MOST_OPENINGS];
        let mut visible_portals = VisiblePortals {
            portals: &self.0,
            point,
            importances,
            len: 0,
            total: 0.0,
            chance: VisiblePortals::OF_SINGLE_RAYS,
        };
        for (index, portal) in self.0.iter().enumerate() {
            let importance = portal.importance(point, normal);
            if importance > 0.0 {
                visible_portals.importances[visible_portals.len] = (index as u32, importance);
                visible_portals.len += 1;
                visible_portals.total += importance;
            }
        }
        (visible_portals.total > 0.0).then_some(visible_portals)
    }
}

impl Portal {
    fn new(form: LightForm) -> Option<Portal> {
        let (normal, place) = form.plane()?;
        let (center, radius) = form.bounding_sphere();
        Some(Portal { area: form.area(), form, normal, place, center, radius, radiance: 0.0 })
    }

    /// With the radiance that comes through a surface.
    fn looked_through(
        self,
        plan: &RenderPlan,
        (member, handle): (MemberId, SurfaceHandle),
        scratch: &mut Scratch,
    ) -> Portal {
        let shader = plan.shader(handle);
        let look = |index: u32| {
            let u = RaySampler::new(plan.options.seed, u64::from(index)).take(DimensionSet::CAMERA);
            self.look(plan, (shader, member.primitive()), u, scratch)
        };
        let radiance = (0..LOOKS).map(look).sum::<f64>() / f64::from(LOOKS);
        Portal { radiance, ..self }
    }

    /// The radiance that comes along one way, its strongest band.
    fn look(
        &self,
        plan: &RenderPlan,
        (shader, own): (&Shader, PrimitiveId),
        u: [f64; 4],
        scratch: &mut Scratch,
    ) -> f64 {
        let Some((normal, point)) = self.form.point([u[0], u[1]]) else { return 0.0 };
        let (x, y) = normal.any_orthonormal_pair();
        let local = DVec3::from_array(cosine_hemisphere(u[2], u[3]));
        let direction = -(x * local.x + y * local.y + normal * local.z).normalize();
        let ray = Ray { origin: point, direction };
        if matches!(shader.kind, Kind::Emitter(_)) {
            let distance = plan.bounding_sphere().1;
            let from = Ray { origin: ray.at(-distance), direction };
            let interaction = SurfaceInteraction::new(&from, point, normal, distance, distance);
            return plan.strongest_emission(shader, &interaction, scratch);
        }
        sky_along(plan, ray, own, scratch)
    }

    fn power(&self) -> f64 {
        self.radiance * self.area
    }

    /// About what it gives to a point with this unit normal.
    fn importance(&self, point: DVec3, normal: DVec3) -> f64 {
        let height = self.normal.dot(point - self.place);
        let offset = self.center - point;
        let squared = offset.length_squared().max(self.radius * self.radius);
        let above = normal.dot(offset) + self.radius;
        if height <= 0.0 || above <= 0.0 {
            return 0.0;
        }
        let distance = squared.sqrt();
        let shown = (height / distance).min(1.0);
        let cosine = (above / (distance + self.radius)).min(1.0);
        self.power() * shown * cosine / squared
    }
}

impl VisiblePortals<'_> {
    /// The share of rays that are drawn one by one.
    const OF_SINGLE_RAYS: f64 = 0.5;

    /// Draws a unit direction towards an opening.
    pub(crate) fn draw(&self, [choice, u, v]: [f64; 3]) -> Option<DVec3> {
        let mut left = choice * self.total;
        let mut chosen = None;
        for (index, importance) in &self.importances[..self.len] {
            chosen = Some(*index);
            if left < *importance {
                break;
            }
            left -= importance;
        }
        let (_, place) = self.portals[chosen? as usize].form.point([u, v])?;
        (place - self.point).try_normalize()
    }

    /// The nearest opening in a unit direction: how far away it is, and its unit normal on the side of the point.
    pub(crate) fn crossed(&self, direction: DVec3) -> Option<(f64, DVec3)> {
        let met = |(index, _): &(u32, f64)| {
            let portal = &self.portals[*index as usize];
            portal.form.met(self.point, direction).map(|(distance, _)| (distance, portal.normal))
        };
        let nearer = |one: &(f64, DVec3), two: &(f64, DVec3)| one.0.total_cmp(&two.0);
        self.importances[..self.len].iter().filter_map(met).min_by(nearer)
    }

    /// The density with which [`VisiblePortals::draw`] finds a unit direction, 1/sr.
    pub(crate) fn pdf(&self, direction: DVec3) -> f64 {
        let of_one = |(index, importance): &(u32, f64)| {
            let portal = &self.portals[*index as usize];
            let met = portal.form.met(self.point, direction);
            met.map_or(0.0, |(distance, cosine)| importance * distance * distance / (portal.area * cosine))
        };
        self.importances[..self.len].iter().map(of_one).sum::<f64>() / self.total
    }
}

fn is_sampled(plan: &RenderPlan, surface: SurfaceHandle) -> bool {
    plan.lights_of(surface).next().is_some()
}

/// Whether something bends light that comes in through openings: then irradiance has details as fine as can be seen.
pub(crate) fn makes_caustics(plan: &RenderPlan) -> bool {
    let bends = |(handle, surface): (SurfaceHandle, &Surface)| {
        !is_flat(surface.shape) && matches!(plan.shader(handle).kind, Kind::Dielectric(_))
    };
    plan.portals.len() > 0 && plan.scene.surfaces.iter().any(bends)
}

/// Whether light that is no light's may come through a surface or from it.
fn can_let_in(plan: &RenderPlan, handle: SurfaceHandle, has_sky: bool) -> bool {
    let shader = plan.shader(handle);
    is_flat(plan.scene.surfaces[handle].shape)
        && match &shader.kind {
            Kind::Emitter(emitter) => matches!(emitter.class, EmitterClass::Glow(radius) if radius == 0.0),
            Kind::Dielectric(_) => has_sky,
            _ => has_sky && shader.lets_light_through(),
        }
}

/// The radiance of the sky along a ray, where nothing but panes is in the way; zero elsewhere, and where the sky is a sampled light.
fn sky_along(plan: &RenderPlan, mut ray: Ray, own: PrimitiveId, scratch: &mut Scratch) -> f64 {
    let mut from = Some(own);
    for _ in 0..MOST_PANES {
        let Some(hit) = plan.first_hit(&ray, from) else {
            let Some((surface, shader)) = plan.sky_at(ray.direction, true) else { return 0.0 };
            return if is_sampled(plan, surface) {
                0.0
            } else {
                plan.strongest_emission(shader, &SurfaceInteraction::distant(ray.direction), scratch)
            };
        };
        let shader = plan.shader_at(hit.shader);
        if !(shader.lets_light_through() || shader.kind.is_transparent()) {
            return 0.0;
        }
        ray.origin = hit.point;
        from = Some(hit.primitive);
    }
    0.0
}

/// The other side of a flat form.
fn turned(form: &LightForm) -> LightForm {
    let mut form = form.clone();
    match &mut form {
        LightForm::Disk { normal, .. }
        | LightForm::Parallelogram { normal, .. }
        | LightForm::Triangles { normal, .. } => *normal = -*normal,
        _ => {}
    }
    form
}

#[cfg(test)]
mod tests {
    use super::*;

    fn portals() -> Portals {
        let corner = DVec3::new(-1.0, 0.5, 0.2);
        let (x, y) = (DVec3::new(0.8, 0.1, 0.0), DVec3::new(0.0, 0.2, 0.9));
        let across = x.cross(y);
        let pane = LightForm::Parallelogram { corner, x, y, normal: -across.normalize(), area: across.length() };
        let behind = LightForm::Parallelogram {
            corner: corner + DVec3::Y * 0.3,
            x,
            y,
            normal: -across.normalize(),
            area: across.length(),
        };
        let skylight = LightForm::Disk {
            center: DVec3::new(0.3, 0.0, 1.5),
            normal: -DVec3::Z,
            x: DVec3::X,
            y: DVec3::Y,
            inner_squared: 0.04,
            outer_squared: 0.5,
        };
        let gable = LightForm::Triangles {
            triangles: vec![
                [DVec3::new(1.0, -1.0, 0.1), DVec3::new(1.0, 1.0, 0.1), DVec3::new(1.0, 0.0, 1.0)],
                [DVec3::new(1.0, -1.0, 0.1), DVec3::new(1.0, 0.0, 1.0), DVec3::new(1.0, -1.0, 0.8)],
            ],
            cumulative: vec![0.9 / 1.25, 1.0],
            normal: -DVec3::X,
            area: 1.25,
        };
        let away = turned(&gable);
        let portal = |form| Portal { radiance: 2.0, ..Portal::new(form).expect("the form is flat") };
        Portals([pane, behind, skylight, gable, away].map(portal).to_vec())
    }

    #[test]
    fn openings_are_drawn_with_the_density_that_they_claim() {
        let portals = portals();
        for (point, normal) in [(DVec3::ZERO, DVec3::Z), (DVec3::new(0.2, -0.4, 0.1), DVec3::new(0.6, 0.0, 0.8))] {
            let visible_portals = portals.seen_from(point, normal).expect("something is seen");
            let mut sums = [0.0; 3];
            let (heights, turns) = (800, 1600);
            for cell in 0..heights * turns {
                let z = (2.0 * (f64::from(cell / turns) + 0.5) / f64::from(heights)) - 1.0;
                let turn = std::f64::consts::TAU * (f64::from(cell % turns) + 0.5) / f64::from(turns);
                let rim = (1.0 - z * z).sqrt();
                let direction = DVec3::new(rim * turn.cos(), rim * turn.sin(), z);
                let share = visible_portals.pdf(direction) * 4.0 * std::f64::consts::PI / f64::from(heights * turns);
                for (sum, moment) in sums.iter_mut().zip([1.0, direction.x, direction.z * direction.y]) {
                    *sum += share * moment;
                }
            }
            let draws = 1 << 14;
            let mut means = [0.0; 3];
            for draw in 0..draws {
                let [choice, u, v, _] = RaySampler::new(1, draw).take(DimensionSet::CAMERA);
                let direction = visible_portals.draw([choice, u, v]).expect("every draw finds a place");
                assert!(visible_portals.pdf(direction) > 0.0);
                for (mean, moment) in means.iter_mut().zip([1.0, direction.x, direction.z * direction.y]) {
                    *mean += moment / draws as f64;
                }
            }
            for (sum, mean) in sums.iter().zip(means) {
                assert!((sum - mean).abs() < 3e-3, "{sums:?} is not {means:?}");
            }
        }
    }
}
