//! Rays that go on from perfectly specular events.

use super::segment::{MediumId, Segment};
use super::{Tracer, product};
use crate::geometry::is_flat;
use crate::ray::{Hit, Ray};
use crate::tree::{Course, Image};
use glam::DVec3;

/// What kind of specular event a ray passes.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Passage {
    /// A `mirror`; `straight` without a texture.
    Mirror { straight: bool },
    /// A pane, going through.
    Pane { undisturbed: bool },
    /// A scattering surface, going straight through.
    Sheet { undisturbed: bool, image: Image },
    /// Into or out of a body; `flat` where what is beyond appears in its place.
    Refraction { flat: bool },
    /// Redirected by a prism; `flat` as before.
    Prism { flat: bool },
    /// Mirrored by glass.
    Reflection { image: Image },
    /// Any other.
    Other,
}

impl Passage {
    /// How the ray is told that goes this way on from a surface; `flat` or not.
    fn course(self, flat: bool) -> Course {
        match self {
            Passage::Mirror { straight } => Course::Mirrored { image: Image::in_place_if(straight && flat) },
            Passage::Reflection { image } => Course::Mirrored { image },
            Passage::Other => Course::Mirrored { image: Image::AtSurface },
            Passage::Pane { undisturbed } => Course::Onward { image: Image::in_place_if(undisturbed) },
            Passage::Refraction { flat } | Passage::Prism { flat } => {
                Course::Onward { image: Image::in_place_if(flat) }
            }
            Passage::Sheet { image, .. } => Course::Onward { image },
        }
    }
}

impl<const BANDS: usize> Tracer<'_, BANDS> {
    /// Sends a ray on from a perfectly specular event, in the medium from which it came.
    pub(crate) fn specular(
        &mut self,
        segment: &Segment<BANDS>,
        hit: &Hit,
        direction: DVec3,
        weight: [f64; BANDS],
        passage: Passage,
    ) {
        self.specular_into(segment, hit, (direction, segment.medium), weight, passage);
    }

    /// The same in another medium.
    pub(crate) fn specular_into(
        &mut self,
        segment: &Segment<BANDS>,
        hit: &Hit,
        (direction, medium): (DVec3, MediumId),
        weight: [f64; BANDS],
        passage: Passage,
    ) {
        let travelled = segment.travelled + hit.distance;
        let throughput = product(segment.throughput, weight);
        let mut link = segment.link;
        if let Some(link) = &mut link {
            link.length += hit.distance;
            match passage {
                Passage::Pane { undisturbed: true } | Passage::Sheet { undisturbed: true, .. } => {}
                Passage::Mirror { straight: true } => link.reflected(hit.surface),
                Passage::Refraction { .. } => link.refracted(),
                Passage::Prism { .. } => link.covered(),
                _ => link.lost(),
            }
        }
        let same_side = direction.dot(hit.front) * segment.ray.direction.dot(hit.front) < 0.0;
        let reflected = same_side && !matches!(passage, Passage::Prism { .. });
        let reflections = segment.reflections + u32::from(reflected);
        let cut = if reflected { segment.cut } else { segment.cut_beyond };
        let share = (throughput, segment.favour());
        let Some(throughput) = self.go_on(share, segment, reflections, None) else { return };
        let hides_what_is_beyond = match passage {
            Passage::Other | Passage::Reflection { .. } | Passage::Sheet { .. } => true,
            Passage::Refraction { flat } | Passage::Prism { flat } => !flat,
            Passage::Mirror { .. } | Passage::Pane { .. } => false,
        };
        let direct_view = segment.direct_view && !hides_what_is_beyond;
        if direct_view {
            self.effective_distance = f64::INFINITY;
        }
        let next = Segment {
            ray: Ray { origin: hit.point, direction },
            from: Some(hit.primitive),
            throughput,
            split: segment.split,
            travelled,
            link,
            depth: segment.depth + 1,
            reflections,
            ambient_bounces: segment.ambient_bounces,
            medium,
            cut,
            cut_beyond: cut,
            follows_no_diffuse: false,
            direct_view,
            node: segment.node,
        };
        let flat = self.tree.is_some() && is_flat(self.plan.scene.surfaces[hit.surface].shape);
        self.push_on(next, passage.course(flat));
    }
}
