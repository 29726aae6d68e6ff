//! How a ray was drawn, to weigh the emission that it finds against the sampling of that light.

use crate::light_selection::selection_pdf;
use crate::specular_chain::SpecularChain;
use glam::DVec3;
use radsight_accel::{PrimitiveId, Ray, RayFrame};
use radsight_compile::RenderPlan;
use radsight_ir::SurfaceHandle;
use radsight_light::{Light, LightForm, LightId, Reception};

/// The longest chain of mirrors that is compared with those of mirrored lights.
const MAX_CHAIN: usize = 4;

/// A ray's last draw from a lobe, and what happened since.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MisState {
    /// Density with which the direction was drawn, 1/sr.
    pub(crate) pdf: f64,
    /// Where it was drawn, the direction, and what is made of light there.
    pub(crate) receiver: DVec3,
    pub(crate) direction: DVec3,
    pub(crate) reception: Reception,
    /// The primitive there.
    pub(crate) primitive: Option<PrimitiveId>,
    /// From what it was drawn.
    pub(crate) lobe: Lobe,
    /// How many times as often it was drawn as by the lobe alone.
    pub(crate) pdf_ratio: f64,
    /// Distance since then.
    pub(crate) length: f64,
    /// Mirrors passed since then.
    mirrors: [Option<SurfaceHandle>; MAX_CHAIN],
    passed: usize,
    reachability: Reachability,
    /// Whether an illum was passed that stands for what is behind it, so that only lights that shine through count.
    pub(crate) behind_illum: bool,
}

/// The chain that a path has to take, and the emitter where it has to end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CausticPath {
    pub(crate) chain: SpecularChain,
    pub(crate) light: SurfaceHandle,
}

/// What a direction was drawn from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Lobe {
    Diffuse,
    Highlight,
    /// The direction was solved for: only this path counts.
    Caustic(CausticPath),
    /// From directions with this density, 1/sr, to find large images of lamps behind specular surfaces.
    LargeImage(f64),
}

impl Lobe {
    /// Whether only lamps behind specular surfaces are looked for.
    pub(crate) fn seeks_caustics(self) -> bool {
        matches!(self, Lobe::Caustic(_) | Lobe::LargeImage(_))
    }
}

/// Whether sampling a light could have found the same path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reachability {
    /// Straight, but for mirrors and panes.
    Straight,
    /// Through a refracting body, as shadow rays go too.
    Refracted,
    /// In a way that no light sampling finds.
    Lost,
    /// In a way that light sampling finds with all its weight.
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

    /// Whether only lamps behind specular surfaces are looked for.
    pub(crate) fn seeks_caustics(&self) -> bool {
        self.lobe.seeks_caustics()
    }

    /// The only path that counts, where the direction was solved for.
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

    /// After anything that light sampling does not see through.
    pub(crate) fn lost(&mut self) {
        if self.reachability != Reachability::Covered {
            self.reachability = Reachability::Lost;
        }
    }

    /// After what light sampling sees through in its own way.
    pub(crate) fn covered(&mut self) {
        self.reachability = Reachability::Covered;
    }

    /// How much of the emission of a surface counts that was found after another `distance` under `cosine`: what light sampling leaves.
    pub(crate) fn share(&self, plan: &RenderPlan, surface: SurfaceHandle, distance: f64, cosine: f64) -> f64 {
        let mut lights = plan.lights_of(surface).peekable();
        if lights.peek().is_none() {
            return 1.0;
        }
        // As in Radiance, diffuse interreflection finds no sampled light by way of a curved mirror: direct light is for lights.
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
        // The distance factor of a spotlight belongs to its use as a sampled light; the same light must be found both ways.
        let focal = light.focal_factor(length);
        let straight = match self.reachability {
            Reachability::Refracted => self.straight_view(plan, light),
            _ => Some((length, if light.radius.is_infinite() { 1.0 } else { cosine })),
        };
        let Some((length, cosine)) = straight else { return focal * stray };
        if light.misses(self.receiver) {
            return focal;
        }
        // Near the surface of a round glow only some of it may be near enough, and none of the rest is found, as in Radiance.
        let is_direct = light.virtual_sources.is_empty();
        let in_range = if is_direct { light.fraction_in_radius(self.receiver, self.direction, length) } else { 1.0 };
        let focal = focal * in_range;
        if focal <= 0.0 {
            return 0.0;
        }
        let other = light.pdf(self.receiver, self.direction, length, cosine, &self.reception.peak);
        // A ray without a density leaves the light to its sampling, if that can find it there.
        if other <= 0.0 {
            return focal;
        }
        if self.pdf == 0.0 {
            return 0.0;
        }
        let other = other * selection_pdf(plan, self.receiver, &self.reception, id);
        focal * self.pdf / (self.pdf + other)
    }

    /// Distance and cosine at which the drawn direction would meet the light if nothing bent it.
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
