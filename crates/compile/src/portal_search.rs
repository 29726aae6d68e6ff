//! Search for the portals of a scene.

use crate::plan::{IllumView, RenderPlan, Sky};
use crate::portals::{MOST_PORTALS, Portal, Portals, turned};
use crate::shader::{EmitterType, Kind, Shader};
use glam::DVec3;
use radsight_accel::{MemberId, PrimitiveId, Ray, is_flat};
use radsight_cal::Scratch;
use radsight_ir::{Surface, SurfaceHandle};
use radsight_light::LightForm;
use radsight_sampling::{DimensionSet, RaySampler, cosine_hemisphere};
use radsight_texture::SurfaceInteraction;

/// Maximum number of surfaces that are tested as portals: the largest ones.
const MOST_CANDIDATES: usize = 128;

/// Number of test rays through each side of a surface.
const TEST_RAYS: u32 = 16;

/// Portals with less than this fraction of the brightest one's radiance are left out.
const LEAST_RADIANCE: f64 = 0.05;

/// Maximum number of panes that a test ray passes.
const MOST_PANES: u32 = 8;

impl Portals {
    /// Finds the portals of a scene.
    pub fn new(plan: &RenderPlan) -> Portals {
        let open_sky = plan.sky.iter().find(|sky| !is_sampled(plan, sky.surface));
        let mut candidates: Vec<(MemberId, SurfaceHandle, LightForm)> = plan
            .geometry
            .listed_members()
            .filter(|(member, handle)| plan.geometry.is_plain(*member) && can_admit_light(plan, *handle, open_sky))
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
            .map(|(member, handle, side)| side.with_radiance(plan, (member, handle), &mut scratch))
            .filter(|portal| portal.radiance > 0.0)
            .collect();
        let brightest = portals.iter().map(|portal| portal.radiance).fold(0.0, f64::max);
        portals.retain(|portal| portal.radiance >= LEAST_RADIANCE * brightest);
        portals.sort_by(|one, two| two.power().total_cmp(&one.power()));
        portals.truncate(MOST_PORTALS);
        Portals(portals)
    }
}

impl Portal {
    /// The portal with its mean incident radiance.
    fn with_radiance(
        self,
        plan: &RenderPlan,
        (member, handle): (MemberId, SurfaceHandle),
        scratch: &mut Scratch,
    ) -> Portal {
        let shader = plan.shader(handle);
        let radiance_along = |index: u32| {
            let u = RaySampler::new(plan.options.seed, u64::from(index)).take(DimensionSet::CAMERA);
            self.radiance_along(plan, (shader, member.primitive()), u, scratch)
        };
        let radiance = (0..TEST_RAYS).map(radiance_along).sum::<f64>() / f64::from(TEST_RAYS);
        Portal { radiance, ..self }
    }

    /// Radiance of the strongest band along one test ray, W/(sr·m²).
    fn radiance_along(
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

/// Whether curved refracting objects can focus light from portals: irradiance then has details as
/// fine as pixels.
pub(crate) fn makes_caustics(plan: &RenderPlan) -> bool {
    let focuses = |(handle, surface): (SurfaceHandle, &Surface)| {
        !is_flat(surface.shape) && matches!(plan.shader(handle).kind, Kind::Dielectric(_))
    };
    !plan.portals.is_empty() && plan.scene.surfaces.iter().any(focuses)
}

/// Whether indirect light from outside may pass through a surface or leave it.
fn can_admit_light(plan: &RenderPlan, handle: SurfaceHandle, open_sky: Option<&Sky>) -> bool {
    let shader = plan.shader(handle);
    is_flat(plan.scene.surfaces[handle].shape)
        && match &shader.kind {
            Kind::Emitter(emitter) => matches!(emitter.class, EmitterType::Glow(radius) if radius == 0.0),
            Kind::Dielectric(_) => open_sky.is_some(),
            _ => open_sky.is_some() && shader.lets_light_through(),
        }
}

/// Radiance of the sky along a ray, if nothing but panes blocks it; zero otherwise, and where the
/// sky is a sampled light.
fn sky_along(plan: &RenderPlan, mut ray: Ray, own: PrimitiveId, scratch: &mut Scratch) -> f64 {
    let mut from = Some(own);
    for _ in 0..MOST_PANES {
        let Some(hit) = plan.first_hit(&ray, from) else {
            let Some((surface, shader)) = plan.sky_at(ray.direction, IllumView::Light) else { return 0.0 };
            return if is_sampled(plan, surface) {
                0.0
            } else {
                plan.strongest_emission(shader, &SurfaceInteraction::distant(&ray), scratch)
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
