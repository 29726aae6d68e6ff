//! Images of emitters that a camera may see: directly, in mirrors, and in polished flat surfaces.
//!
//! They tell where in a picture bright light may be, so that rays can be aimed at it. What an image
//! shows is not known here: something may hide it, and its pattern may be dark.

use glam::DVec3;
use radsight_accel::{Intersection, MemberId, Ray, flat_normal};
use radsight_compile::{Kind, RenderPlan};
use radsight_ir::{Shape, SurfaceHandle};
use radsight_light::{LightForm, VirtualSource, virtual_form};

/// Maximum number of pairs of emitter and mirror.
const MAX_PAIRS: usize = 1 << 14;

/// Distance from which parallel rays see a light, in its radii.
const FAR: f64 = 1e6;

/// From where a camera looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Viewpoint {
    /// From a point, scene units.
    Point(DVec3),
    /// In parallel rays of this unit direction.
    Direction(DVec3),
}

/// An image of an emitter.
#[derive(Clone, Debug)]
pub struct LightImage {
    /// Points in whose convex hull it lies, scene units; unit directions if it is infinitely
    /// distant.
    pub outline: Vec<DVec3>,
    /// Whether it is infinitely distant.
    pub is_distant: bool,
    /// Points in whose convex hull lies the surface that reflects it; empty for a direct view.
    pub frame: Vec<DVec3>,
    /// Points of a ring's hole, scene units; empty without one.
    pub hole: Vec<DVec3>,
    /// The share of the area in its outline that it covers, where it is round; else 1.
    pub share_of_outline: f64,
    emitter: SurfaceHandle,
    /// The surfaces that reflect a ray, in this order.
    mirrors: Vec<SurfaceHandle>,
}

impl LightImage {
    /// All images: of all emitters, their reflections in one surface, and in several mirrors as far
    /// as those make virtual sources. `may_show` excludes those whose bounding sphere a picture does
    /// not show, from its centre and its radius in scene units; distant ones are not excluded. None
    /// if more than `most` emitters are shown directly.
    #[must_use]
    pub fn all(
        plan: &RenderPlan,
        from: Viewpoint,
        may_show: impl Fn(DVec3, f64) -> bool,
        most: usize,
    ) -> Vec<LightImage> {
        let is_shown = |form: &LightForm| {
            let (center, radius) = form.bounding_sphere();
            radius.is_infinite() || may_show(center, radius)
        };
        let emitters = emitters(plan);
        if plan.has_antimatter || emitters.iter().filter(|(_, form)| is_shown(form)).count() > most {
            return Vec::new();
        }
        let mut mirrors = polished_surfaces(plan);
        if mirrors.len() * emitters.len() > MAX_PAIRS {
            mirrors.clear();
        }
        let shown = |form: &LightForm, surface, through: &[SurfaceHandle]| {
            is_shown(form).then(|| LightImage::new(form, surface, through, from)).flatten()
        };
        let direct = emitters.iter().filter_map(|(surface, form)| shown(form, *surface, &[]));
        let reflected = emitters.iter().flat_map(|(surface, form)| {
            let in_mirror = |mirror: &PolishedSurface| {
                let image = shown(&mirror.reflected(form, *surface, from)?, *surface, &[mirror.surface])?;
                Some(LightImage { frame: mirror.corners.clone(), ..image })
            };
            mirrors.iter().filter_map(in_mirror).collect::<Vec<_>>()
        });
        let several = plan.lights.iter().filter(|light| light.virtual_sources.len() > 1).filter_map(|light| {
            let is_mirror = |source: &VirtualSource| is_mirror(&plan.shader(source.surface).kind);
            let nearest = light.virtual_sources.first().filter(|_| light.virtual_sources.iter().all(is_mirror))?;
            let surfaces: Vec<SurfaceHandle> = light.virtual_sources.iter().map(|source| source.surface).collect();
            let image = shown(&light.form, light.surface, &surfaces)?;
            Some(LightImage { frame: corners(plan, nearest.surface), ..image })
        });
        direct.chain(reflected).chain(several).collect()
    }

    /// `None` for an image that shows its back, or has no outline.
    fn new(form: &LightForm, emitter: SurfaceHandle, mirrors: &[SurfaceHandle], from: Viewpoint) -> Option<LightImage> {
        let (center, radius) = form.bounding_sphere();
        let eye = match from {
            Viewpoint::Point(point) => point,
            Viewpoint::Direction(direction) if radius.is_finite() => center - direction * (FAR * radius),
            Viewpoint::Direction(_) => return None,
        };
        if form.plane().is_some_and(|(normal, point)| normal.dot(eye - point) <= 0.0) {
            return None;
        }
        let outline = form.outline(eye);
        let is_distant = radius.is_infinite();
        let image = LightImage {
            outline,
            is_distant,
            frame: Vec::new(),
            hole: form.hole(),
            share_of_outline: form.share_of_outline(),
            emitter,
            mirrors: mirrors.to_vec(),
        };
        (!image.outline.is_empty()).then_some(image)
    }

    /// Whether a ray meets the emitter by way of the image's mirrors, or may do so because it first
    /// meets something else that transmits light.
    #[must_use]
    pub fn may_be_seen_by(&self, plan: &RenderPlan, ray: &Ray) -> bool {
        let (mut ray, mut start) = (*ray, None);
        for mirror in &self.mirrors {
            let Some(hit) = plan.first_hit(&ray, start) else { return false };
            if hit.surface != *mirror {
                return transmits(plan, &hit);
            }
            let direction = ray.direction.reflect(hit.front);
            (ray, start) = (Ray { origin: hit.point, direction }, Some(hit.primitive));
        }
        match plan.first_hit(&ray, start) {
            Some(hit) => hit.surface == self.emitter || transmits(plan, &hit),
            None => self.is_distant,
        }
    }
}

/// All surfaces that emit light and show it.
fn emitters(plan: &RenderPlan) -> Vec<(SurfaceHandle, LightForm)> {
    let form = |(surface, shape): (SurfaceHandle, Shape)| {
        let Kind::Emitter(emitter) = &plan.shader(surface).kind else { return None };
        let form = LightForm::new(&plan.scene, shape)?;
        (!emitter.radiance.is_black()).then_some((surface, form))
    };
    plan.scene.surfaces.iter().map(|(handle, surface)| (handle, surface.shape)).filter_map(form).collect()
}

/// A flat surface that reflects like a mirror, at least partly.
struct PolishedSurface {
    surface: SurfaceHandle,
    plane: VirtualSource,
    corners: Vec<DVec3>,
    /// Whether it reflects on its front only.
    is_one_sided: bool,
}

fn polished_surfaces(plan: &RenderPlan) -> Vec<PolishedSurface> {
    let polished = |(member, surface): (MemberId, SurfaceHandle)| {
        let kind = &plan.shader(surface).kind;
        if !is_polished(kind) {
            return None;
        }
        let normal = flat_normal(&plan.scene, plan.scene.surfaces[surface].shape)?;
        let corners = corners(plan, surface);
        let (point, shift) = (*corners.first()?, normal * -2.0);
        let plane = VirtualSource { surface, member, point, normal, shift, redirection: None };
        Some(PolishedSurface { surface, plane, corners, is_one_sided: is_mirror(kind) })
    };
    plan.geometry.listed_members().filter_map(polished).collect()
}

fn is_mirror(kind: &Kind) -> bool {
    matches!(kind, Kind::Mirror { substitute: None, .. })
}

fn is_polished(kind: &Kind) -> bool {
    match kind {
        Kind::Glossy(glossy) => glossy.is_smooth() && glossy.specularity > 0.0,
        Kind::Glass { .. } | Kind::Dielectric(_) => true,
        _ => is_mirror(kind),
    }
}

/// Points in whose convex hull a flat surface lies.
fn corners(plan: &RenderPlan, surface: SurfaceHandle) -> Vec<DVec3> {
    match plan.scene.surfaces[surface].shape {
        Shape::Polygon { start, count } => plan.scene.polygon_vertices(start, count).to_vec(),
        shape => LightForm::new(&plan.scene, shape).map_or_else(Vec::new, |form| form.outline(DVec3::ZERO)),
    }
}

impl PolishedSurface {
    /// The reflection of an emitter; `None` unless the two, and the camera, are on the same side.
    fn reflected(&self, form: &LightForm, emitter: SurfaceHandle, from: Viewpoint) -> Option<LightForm> {
        let (center, radius) = form.bounding_sphere();
        let height = |point: DVec3| self.plane.normal.dot(point - self.plane.point);
        let of_camera = match from {
            Viewpoint::Point(point) => height(point),
            Viewpoint::Direction(direction) => -self.plane.normal.dot(direction),
        };
        let side = of_camera.signum();
        let is_in_front = if radius.is_infinite() {
            side * self.plane.normal.dot(center) > 0.0
        } else {
            side * height(center) > -radius
        };
        let is_dark = emitter == self.surface || of_camera == 0.0 || self.is_one_sided && of_camera < 0.0;
        (!is_dark && is_in_front).then(|| virtual_form(form, &self.plane))
    }
}

/// Whether a ray may continue behind a hit.
fn transmits(plan: &RenderPlan, hit: &Intersection) -> bool {
    let shader = plan.shader_at(hit.shader);
    let is_passed = matches!(
        shader.kind,
        Kind::Illum { .. } | Kind::Prism(_) | Kind::Antimatter(_) | Kind::Mirror { substitute: Some(_), .. }
    );
    is_passed || shader.kind.is_transparent() || shader.lets_light_through()
}
