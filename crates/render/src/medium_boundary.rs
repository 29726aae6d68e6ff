//! Rays at the surfaces of dielectrics and mist, and at substitutes.

use crate::direct::DirectSampler;
use crate::trace::PathIntegrator;
use crate::trace::passage::Passage;
use crate::trace::path_state::PathState;
use glam::DVec3;
use radsight_accel::Intersection;
use radsight_compile::{
    DielectricInterface, Emitter, Kind, Medium, MistKind, PrismKind, RaySide, Shader, Substitution,
};
use radsight_light::{Light, Reception};
use radsight_sampling::DimensionSet;
use radsight_texture::{SurfaceInteraction, bands, product};

/// Maximum number of samples of a light along a ray in mist, as in Radiance.
const MAX_MIST_SAMPLES: f64 = 16.0;

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// The path at a surface: attenuated by the medium that it crossed, which the surface may know
    /// better.
    pub(crate) fn crossed(&mut self, path: &PathState<BANDS>, hit: &Intersection, shader: &Shader) -> PathState<BANDS> {
        let behind = path.ray.direction.dot(hit.front) > 0.0;
        let known = self.medium(path.medium);
        let medium = match &shader.kind {
            Kind::Dielectric(boundary) => match boundary.sides(RaySide::of(path.ray.direction, hit.front))[0] {
                Some(transmissivity) => {
                    let pattern = self.body_appearance(path, hit, shader).0;
                    Medium::absorbing(transmissivity, pattern, known.lights)
                }
                None => known,
            },
            Kind::Mist(mist) if behind => mist.crossed(known, self.body_appearance(path, hit, shader).0),
            _ => known,
        };
        let mut dimmed = self.dimmed(path, medium, hit.distance);
        if medium != known {
            dimmed.medium = self.add_medium(medium);
        }
        dimmed
    }

    /// The pattern's colour and the perturbed front normal of a dielectric.
    fn body_appearance(
        &mut self,
        path: &PathState<BANDS>,
        hit: &Intersection,
        shader: &Shader,
    ) -> ([f64; BANDS], DVec3) {
        let interaction = SurfaceInteraction::at(&path.ray, hit, path.travelled + hit.distance);
        shader.body_appearance(&self.plan.scene, &interaction, &mut self.workspace.scratch)
    }

    /// The path after a distance in a medium; light that the medium scatters is added to the ray's
    /// radiance.
    pub(crate) fn dimmed(&mut self, path: &PathState<BANDS>, medium: Medium<BANDS>, distance: f64) -> PathState<BANDS> {
        if medium.extinction == [0.0; BANDS] {
            return *path;
        }
        let left = medium.transmission(distance);
        let before = self.radiance;
        if medium.scatters() && !path.seeks_caustics() {
            let ambient: [f64; BANDS] = bands(self.plan.options.ambient_value);
            for band in 0..BANDS {
                let scattered = medium.albedo[band] * ambient[band] * (1.0 - left[band]);
                self.radiance[band] += path.throughput[band] * scattered;
            }
            if medium.scatters_lights() && distance.is_finite() {
                self.scatter_lights(path, &medium, distance);
            }
        }
        if let Some(tree) = &mut self.tree {
            let in_scattered = std::array::from_fn(|band| self.radiance[band] - before[band]);
            tree.dim(path.node, left, in_scattered);
        }
        PathState { throughput: product(path.throughput, left), ..*path }
    }

    /// Adds the light that mist scatters into a segment.
    fn scatter_lights(&mut self, path: &PathState<BANDS>, medium: &Medium<BANDS>, distance: f64) {
        let plan = self.plan;
        let length = plan.options.mist_sample_length;
        let samples = if length > 0.0 { (distance / length).round().clamp(1.0, MAX_MIST_SAMPLES) } else { 1.0 };
        let medium_id = self.add_medium(*medium);
        for (bit, id) in plan.mist_lights.0.iter().enumerate() {
            if medium.lights >> bit & 1 == 0 {
                continue;
            }
            let light = &plan.lights[id.0 as usize];
            let medium_sampler = MediumSampler::new(path, medium, light, distance);
            for sample in 0..samples as u32 {
                let u = self.sampler.take(DimensionSet::render(self.next_set));
                self.next_set += 1;
                let (along, pdf) = medium_sampler.draw((f64::from(sample) + u[0]) / samples, u[3]);
                let point = path.ray.at(along);
                let sampler = DirectSampler {
                    point,
                    primitive: None,
                    highlight_draws: 0,
                    shares_diffuse: false,
                    visible_portals: None,
                    specular_return: None,
                    reception: Reception::NONE,
                    travelled: path.travelled + along,
                    medium: medium_id,
                    cuts: [path.cut; 2],
                    normal: path.ray.direction,
                    drawn: path.mis.is_some(),
                    facing: None,
                };
                let arriving = sampler.light_at(self, light, [u[1], u[2]], |towards| {
                    medium.phase(path.ray.direction, towards) / (pdf * samples)
                });
                let left = medium.transmission(along);
                let share: [f64; BANDS] = std::array::from_fn(|band| {
                    path.throughput[band] * (medium.extinction[band] * medium.albedo[band] * left[band])
                });
                for band in 0..BANDS {
                    self.radiance[band] += share[band] * arriving[band];
                }
                if let Some(contributions) = &mut self.contributions {
                    contributions.settle(share);
                }
            }
        }
    }

    /// A dielectric interface.
    pub(crate) fn shade_dielectric(
        &mut self,
        path: &PathState<BANDS>,
        hit: &Intersection,
        shader: &Shader,
        boundary: &DielectricInterface,
    ) {
        let direction = path.ray.direction;
        let behind = direction.dot(hit.front) > 0.0;
        let (pattern, perturbation) = self.body_appearance(path, hit, shader);
        let refraction = boundary.refract(direction, hit.front, perturbation);
        // As in Radiance, the normal of a dielectric points outwards.
        self.note_normal(path, if behind { -refraction.normal } else { refraction.normal });
        if let Some((transmitted, factor)) = refraction.transmitted {
            let lights = self.medium(path.medium).lights;
            let next = match boundary.sides(RaySide::of(direction, hit.front))[1] {
                Some(transmissivity) => Medium::absorbing(transmissivity, pattern, lights),
                None => Medium { lights, ..self.global_medium() },
            };
            let next = self.add_medium(next);
            let image = self.image_behind(hit, perturbation);
            self.specular_into(path, hit, (transmitted, next), [factor; BANDS], Passage::Refraction { image });
        }
        let reflected = refraction.reflected(direction, hit.front);
        let image = self.image_behind(hit, perturbation);
        self.specular(path, hit, reflected, [refraction.reflectance; BANDS], Passage::Reflection { image });
    }

    /// The surface of mist: only the medium changes.
    pub(crate) fn shade_mist(&mut self, path: &PathState<BANDS>, hit: &Intersection, shader: &Shader, mist: &MistKind) {
        let pattern = self.body_appearance(path, hit, shader).0;
        let medium = self.medium(path.medium);
        let behind = path.ray.direction.dot(hit.front) > 0.0;
        let next = match behind {
            true => mist.left(medium, pattern, &self.global_medium()),
            false => mist.entered(medium, pattern),
        };
        let mut transmitted = self.passed_through(*path, hit);
        transmitted.medium = self.add_medium(next);
        self.push(transmitted);
    }

    /// A prism: a ray in the direction of each of its faces.
    pub(crate) fn shade_prism(
        &mut self,
        path: &PathState<BANDS>,
        hit: &Intersection,
        prism: &PrismKind,
        interaction: &SurfaceInteraction,
    ) {
        let image = self.image_behind(hit, DVec3::ZERO);
        for face in 0..prism.faces {
            let found = prism.redirect(face, interaction, DVec3::ZERO, &mut self.workspace.scratch);
            if let Some((coefficient, direction)) = found {
                self.specular(path, hit, direction, [coefficient; BANDS], Passage::Prism { image });
            }
        }
    }

    /// An illum. A sampled ray hits its light, and behind it counts only lights that it does not
    /// represent.
    ///
    /// `path` is attenuated by the medium in front of the surface, `unseen` is not yet.
    pub(crate) fn shade_illum(
        &mut self,
        [path, unseen]: [&PathState<BANDS>; 2],
        hit: &Intersection,
        shader: &Shader,
        (emitter, substitute): (&Emitter, Substitution),
        interaction: &SurfaceInteraction,
    ) {
        let behind = path.ray.direction.dot(hit.front) > 0.0;
        if behind || path.mis.is_none() {
            self.note_dark_emitter(path, shader, interaction);
            return self.shade_substitute([path, unseen], hit, substitute);
        }
        let share = self.emission_share(path, hit.surface, emitter, hit.distance, interaction.cosine);
        self.emit(path, shader, emitter, interaction, share);
        let behind_illum = |path: &PathState<BANDS>| {
            let mut path = *path;
            if let Some(mis) = &mut path.mis {
                mis.behind_illum = true;
            }
            path
        };
        self.shade_substitute([&behind_illum(path), &behind_illum(unseen)], hit, substitute);
    }

    /// The substitute of a surface.
    pub(crate) fn shade_substitute(
        &mut self,
        [path, unseen]: [&PathState<BANDS>; 2],
        hit: &Intersection,
        substitute: Substitution,
    ) {
        let behind = path.ray.direction.dot(hit.front) > 0.0;
        let plan = self.plan;
        match substitute {
            Substitution::Shader(id) => {
                let shader = plan.shader_at(id);
                if !(behind && plan.hides_its_back(shader)) {
                    return self.shade(unseen, hit, shader);
                }
                self.push(self.passed_through(*path, hit));
            }
            Substitution::Void => self.push(self.passed_through(*path, hit)),
        }
    }

    /// Whether a ray sees a mirror's substitute from the front: a sampled ray that searches for
    /// lights through the mirror hits the mirror itself.
    pub(crate) fn is_replaced(&self, path: &PathState<BANDS>, substitute: Substitution) -> bool {
        let lets_through = |id| self.plan.shader_at(id).kind.is_transparent();
        path.mis.is_none() || matches!(substitute, Substitution::Shader(id) if lets_through(id))
    }
}

/// Samples points along a segment in mist: half of them near the light, equiangular (Kulla and
/// Fajardo, Computer Graphics Forum 31, 2012), half by transmittance to the viewer.
struct MediumSampler {
    distance: f64,
    /// Mean extinction, 1/scene unit.
    extinction: f64,
    /// The distance along the ray at which the light's centre is nearest, and its distance there;
    /// `None` for a distant light.
    nearest: Option<(f64, f64)>,
}

impl MediumSampler {
    fn new<const BANDS: usize>(
        path: &PathState<BANDS>,
        medium: &Medium<BANDS>,
        light: &Light,
        distance: f64,
    ) -> MediumSampler {
        let extinction = medium.extinction.iter().sum::<f64>() / BANDS as f64;
        let nearest = light.radius.is_finite().then(|| {
            let offset = light.center - path.ray.origin;
            let along = offset.dot(path.ray.direction);
            let offset_distance = (offset - path.ray.direction * along).length();
            (along, offset_distance.max(0.5 * light.radius).max(1e-6 * distance))
        });
        MediumSampler { distance, extinction, nearest }
    }

    /// A point from a number of the unit interval and another that selects the technique; its pdf,
    /// 1/scene unit.
    fn draw(&self, u: f64, choice: f64) -> (f64, f64) {
        let Some((along, offset_distance)) = self.nearest else {
            let position = self.exponential(u);
            return (position, self.exponential_pdf(position));
        };
        let first = (-along / offset_distance).atan();
        let range = ((self.distance - along) / offset_distance).atan() - first;
        let position =
            if choice < 0.5 { along + offset_distance * (first + u * range).tan() } else { self.exponential(u) };
        let position = position.clamp(0.0, self.distance);
        let off = position - along;
        let by_angle = offset_distance / (range * (offset_distance * offset_distance + off * off));
        (position, 0.5 * (by_angle + self.exponential_pdf(position)))
    }

    fn exponential(&self, u: f64) -> f64 {
        let lost = -(-self.extinction * self.distance).exp_m1();
        (-(-u * lost).ln_1p() / self.extinction).min(self.distance)
    }

    fn exponential_pdf(&self, position: f64) -> f64 {
        let lost = -(-self.extinction * self.distance).exp_m1();
        self.extinction * (-self.extinction * position).exp() / lost
    }
}
