//! Looking for the portals of a scene.

use crate::plan::RenderPlan;
use crate::portals::{MOST_OPENINGS, Portal, Portals, turned};
use crate::shader::{EmitterClass, Kind, Shader};
use glam::DVec3;
use radsight_accel::{MemberId, PrimitiveId, Ray, is_flat};
use radsight_cal::Scratch;
use radsight_ir::{Surface, SurfaceHandle};
use radsight_light::LightForm;
use radsight_sampling::{DimensionSet, RaySampler, cosine_hemisphere};
use radsight_texture::SurfaceInteraction;

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
    pub fn new(plan: &RenderPlan) -> Portals {
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
}

impl Portal {
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
        let (Some((normal, _)), Some(point)) = (self.plane, self.form.point([u[0], u[1], 0.0])) else { return 0.0 };
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
}

fn is_sampled(plan: &RenderPlan, surface: SurfaceHandle) -> bool {
    plan.lights_of(surface).next().is_some()
}

/// Whether something bends light that comes in through openings: then irradiance has details as fine as can be seen.
pub(crate) fn makes_caustics(plan: &RenderPlan) -> bool {
    let bends = |(handle, surface): (SurfaceHandle, &Surface)| {
        !is_flat(surface.shape) && matches!(plan.shader(handle).kind, Kind::Dielectric(_))
    };
    !plan.portals.is_empty() && plan.scene.surfaces.iter().any(bends)
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
