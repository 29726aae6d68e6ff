//! Rays after perfectly specular events.

use super::PathIntegrator;
use super::path_state::{MediumId, PathState};
use crate::ray_tree::{BounceType, Image};
use crate::specular_chain::SpecularEvent;
use glam::DVec3;
use radsight_accel::{Intersection, Ray, is_flat};
use radsight_texture::product;

/// The kind of a specular event.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Passage {
    /// Reflection by a `mirror`; `straight` without a texture.
    Mirror { straight: bool },
    /// Transmission through a pane.
    Pane { undisturbed: bool, image: Image },
    /// Straight transmission through a scattering surface.
    Sheet { undisturbed: bool, image: Image },
    /// Into or out of a dielectric.
    Refraction { image: Image },
    /// Redirection by a prism.
    Prism { image: Image },
    /// Reflection by glass.
    Reflection { image: Image },
    /// Any other.
    Other,
}

impl Passage {
    /// The bounce type of the ray after a surface; `unperturbed` is the image in an unperturbed
    /// mirror of its shape.
    fn bounce(self, unperturbed: Image) -> BounceType {
        match self {
            Passage::Mirror { straight: true } => BounceType::Mirrored { image: unperturbed },
            Passage::Reflection { image } => BounceType::Mirrored { image },
            Passage::Mirror { straight: false } | Passage::Other => BounceType::Mirrored { image: Image::AtSurface },
            Passage::Pane { image, .. }
            | Passage::Refraction { image }
            | Passage::Prism { image }
            | Passage::Sheet { image, .. } => BounceType::Transmitted { image },
        }
    }
}

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// Adds a ray after a perfectly specular event, in the same medium.
    pub(crate) fn specular(
        &mut self,
        path: &PathState<BANDS>,
        hit: &Intersection,
        direction: DVec3,
        weight: [f64; BANDS],
        passage: Passage,
    ) {
        self.specular_into(path, hit, (direction, path.medium), weight, passage);
    }

    /// The same in another medium.
    pub(crate) fn specular_into(
        &mut self,
        path: &PathState<BANDS>,
        hit: &Intersection,
        (direction, medium): (DVec3, MediumId),
        weight: [f64; BANDS],
        passage: Passage,
    ) {
        let travelled = path.travelled + hit.distance;
        let throughput = product(path.throughput, weight);
        let mut mis = path.mis;
        if let Some(mis) = &mut mis {
            mis.length += hit.distance;
            match passage {
                Passage::Pane { undisturbed: true, .. } | Passage::Sheet { undisturbed: true, .. } => {}
                Passage::Mirror { straight: true } => mis.reflected(hit.surface),
                Passage::Refraction { .. } => mis.refracted(),
                Passage::Prism { .. } => mis.covered(),
                _ => mis.lost(),
            }
        }
        let same_side = direction.dot(hit.front) * path.ray.direction.dot(hit.front) < 0.0;
        let reflected = same_side && !matches!(passage, Passage::Prism { .. });
        let reflections = path.reflections + u32::from(reflected);
        let event = if same_side { SpecularEvent::Reflected } else { SpecularEvent::Transmitted };
        let chain = match passage {
            Passage::Pane { undisturbed: true, .. } | Passage::Sheet { undisturbed: true, .. } => {
                path.chain.after_straight_transmission()
            }
            _ => path.chain.after(event),
        };
        if path.caustic().is_some_and(|caustic| !caustic.chain.begins_with(chain)) {
            return;
        }
        let cut = if reflected { path.cut } else { path.subtraction_beyond };
        let share = (throughput, path.pdf_ratio());
        let Some(throughput) = self.roulette(share, path, reflections, None) else { return };
        let hides_what_is_beyond = match passage {
            Passage::Other | Passage::Reflection { .. } | Passage::Sheet { .. } => true,
            Passage::Refraction { image } | Passage::Prism { image } => image != Image::InPlace,
            Passage::Mirror { .. } | Passage::Pane { .. } => false,
        };
        let direct_view = path.direct_view && !hides_what_is_beyond;
        if direct_view {
            self.effective_distance = f64::INFINITY;
            self.passed_distance = self.passed_distance.max(travelled);
        }
        let next = PathState {
            ray: Ray { origin: hit.point, direction },
            from: Some(hit.primitive),
            throughput,
            split: path.split,
            travelled,
            mis,
            chain,
            depth: path.depth + 1,
            is_limited: path.is_limited && !reflected,
            reflections,
            ambient_bounces: path.ambient_bounces,
            medium,
            cut,
            subtraction_beyond: cut,
            follows_no_diffuse: false,
            direct_view,
            node: path.node,
        };
        let flat = self.tree.is_some() && is_flat(self.plan.scene.surfaces[hit.surface].shape);
        let unperturbed = if flat { Image::InPlace } else { Image::AtSurface };
        self.push_on(next, passage.bounce(unperturbed));
    }
}
