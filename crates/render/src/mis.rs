//! The state for multiple importance sampling: how a ray was sampled, to weight emission that it
//! hits against light sampling.

use crate::light_selection::selection_pdf;
use crate::specular_chain::SpecularChain;
use glam::DVec3;
use radsight_accel::{PrimitiveId, Ray, RayFrame};
use radsight_compile::RenderPlan;
use radsight_ir::SurfaceHandle;
use radsight_light::{Light, LightForm, LightId, Reception};

/// Maximum length of a chain of mirrors that is compared with virtual sources.
const MAX_CHAIN: usize = 4;

/// A ray's last sampled direction, and what happened since.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MisState {
    /// Pdf of the direction, 1/sr.
    pub(crate) pdf: f64,
    /// The receiver, the direction, and the response there.
    pub(crate) receiver: DVec3,
    pub(crate) direction: DVec3,
    pub(crate) reception: Reception,
    /// The primitive of the receiver.
    pub(crate) primitive: Option<PrimitiveId>,
    /// The sampling technique.
    pub(crate) lobe: Lobe,
    /// Ratio of the pdf to that of the lobe alone.
    pub(crate) pdf_ratio: f64,
    /// Distance since then.
    pub(crate) length: f64,
    /// Mirrors since then.
    mirrors: [Option<SurfaceHandle>; MAX_CHAIN],
    passed: usize,
    reachability: Reachability,
    /// Whether an illum was passed that represents what is behind it, so that only lights that
    /// shine through count.
    pub(crate) behind_illum: bool,
}

/// The chain that a path must take, and the emitter where it must end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CausticPath {
    pub(crate) chain: SpecularChain,
    pub(crate) light: SurfaceHandle,
}

/// A sampling technique of directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Lobe {
    Diffuse,
    Highlight,
    /// The direction was solved for: only this path counts.
    Caustic(CausticPath),
    /// A random direction with this pdf, 1/sr, for large images of lamps behind specular surfaces.
    LargeImage(f64),
}

impl Lobe {
    /// Whether only lamps behind specular surfaces count.
    pub(crate) fn seeks_caustics(self) -> bool {
        matches!(self, Lobe::Caustic(_) | Lobe::LargeImage(_))
    }
}

/// Whether light sampling could have found the same path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reachability {
    /// Straight, except for mirrors and panes.
    Straight,
    /// Through a dielectric, as for shadow rays.
    Refracted,
    /// Light sampling cannot find it.
    Lost,
    /// Light sampling finds it with full weight.
    Covered,
}

impl MisState {
    pub(crate) fn new(
        pdf: f64,
        (receiver, direction): (DVec3, DVec3),
        reception: Reception,
        primitive: Option<PrimitiveId>,
        lobe: Lobe,
    ) -> MisState {
        MisState {
            pdf,
            receiver,
            direction,
            reception,
            primitive,
            lobe,
            pdf_ratio: 1.0,
            length: 0.0,
            mirrors: [None; MAX_CHAIN],
            passed: 0,
            reachability: Reachability::Straight,
            behind_illum: false,
        }
    }

    /// Whether only lamps behind specular surfaces count.
    pub(crate) fn seeks_caustics(&self) -> bool {
        self.lobe.seeks_caustics()
    }

    /// The only path that counts, if the direction was solved for.
    pub(crate) fn caustic(&self) -> Option<CausticPath> {
        match self.lobe {
            Lobe::Caustic(path) => Some(path),
            _ => None,
        }
    }

    /// After a mirror.
    pub(crate) fn reflected(&mut self, surface: SurfaceHandle) {
        if self.passed < MAX_CHAIN {
            self.mirrors[self.passed] = Some(surface);
            self.passed += 1;
        } else {
            self.lost();
        }
    }

    /// After a refraction.
    pub(crate) fn refracted(&mut self) {
        if self.reachability == Reachability::Straight {
            self.reachability = Reachability::Refracted;
        }
    }

    /// After a surface that light sampling cannot pass.
    pub(crate) fn lost(&mut self) {
        if self.reachability != Reachability::Covered {
            self.reachability = Reachability::Lost;
        }
    }

    /// After a surface that light sampling handles by itself.
    pub(crate) fn covered(&mut self) {
        self.reachability = Reachability::Covered;
    }

    /// The MIS weight of emission that was hit after another `distance` under `cosine`.
    pub(crate) fn share(&self, plan: &RenderPlan, surface: SurfaceHandle, distance: f64, cosine: f64) -> f64 {
        let mut lights = plan.lights_of(surface).peekable();
        if lights.peek().is_none() {
            return 1.0;
        }
        // As in Radiance, diffuse interreflection does not count sampled lights through curved
        // mirrors: direct light is for light sampling.
        let stray = if self.lobe != Lobe::Diffuse && !self.behind_illum { 1.0 } else { 0.0 };
        match self.reachability {
            Reachability::Lost => return stray,
            Reachability::Covered => return 0.0,
            Reachability::Straight | Reachability::Refracted => {}
        }
        let passed = self.mirrors[..self.passed].iter().copied();
        let is_seen = |id: &LightId| {
            let light = &plan.lights[id.0 as usize];
            passed.clone().eq(light.virtual_sources.iter().map(|mirror| Some(mirror.surface)))
        };
        let Some(id) = lights.find(is_seen) else { return stray };
        let light = &plan.lights[id.0 as usize];
        let length = self.length + distance;
        if length > light.max_distance {
            return 1.0;
        }
        // The distance factor of a spotlight belongs to its use as a sampled light; both techniques
        // must have the same light.
        let focal = light.focal_factor(length);
        let straight = match self.reachability {
            Reachability::Refracted => self.straight_view(plan, light),
            _ => Some((length, if light.radius.is_infinite() { 1.0 } else { cosine })),
        };
        let Some((length, cosine)) = straight else { return focal * stray };
        if light.misses(self.receiver) {
            return focal;
        }
        // Near the surface of a round glow only a part of it may be within its radius; the rest
        // counts in neither technique, as in Radiance.
        let is_direct = light.virtual_sources.is_empty();
        let in_range = if is_direct { light.fraction_in_radius(self.receiver, self.direction, length) } else { 1.0 };
        let focal = focal * in_range;
        if focal <= 0.0 {
            return 0.0;
        }
        let other = light.pdf(self.receiver, self.direction, length, cosine, &self.reception.peak);
        // Without a pdf all of the light is left to light sampling, if that can find it there.
        if other <= 0.0 {
            return focal;
        }
        if self.pdf == 0.0 {
            return 0.0;
        }
        let other = other * selection_pdf(plan, self.receiver, &self.reception, id);
        focal * self.pdf / (self.pdf + other)
    }

    /// Distance and cosine at which the sampled direction would hit the light without refraction.
    fn straight_view(&self, plan: &RenderPlan, light: &Light) -> Option<(f64, f64)> {
        if !light.virtual_sources.is_empty() {
            return None;
        }
        if let LightForm::Distant { direction, half_angle_sin_squared_half, .. } = light.form {
            let met = 0.25 * direction.distance_squared(self.direction) <= half_angle_sin_squared_half;
            return met.then_some((f64::INFINITY, 1.0));
        }
        let member = light.primitive?.member();
        let ray = Ray { origin: self.receiver, direction: self.direction };
        let (frame, scene) = (RayFrame::new(&ray), &plan.scene);
        let crossing = plan.geometry.intersect(scene, member, &ray, &frame, self.primitive, f64::INFINITY)?;
        let hit = plan.geometry.hit(scene, &plan.shader_table, &ray, crossing);
        let cosine = -ray.direction.dot(hit.front);
        (cosine > 0.0).then_some((hit.distance, cosine))
    }
}
