//! Surfaces that are part one material, part another.

use crate::options::BackFaces;
use crate::ray::Hit;
use crate::shader::{Kind, MixtureKind, Shader};
use crate::trace::{Segment, Tracer};
use crate::view::Encounter;

impl<const BANDS: usize> Tracer<'_, BANDS> {
    /// Both parts, each with its share, as Radiance does; where one has no material, the ray goes on. The segment comes with and without
    /// what lies between its origin and the surface.
    pub(crate) fn shade_mixture(
        &mut self,
        [segment, unseen]: [&Segment<BANDS>; 2],
        hit: &Hit,
        (shader, mixture): (&Shader, &MixtureKind),
        encounter: &Encounter,
    ) {
        let plan = self.plan;
        let scene = shader.home.scene(&plan.scene);
        let share = mixture.share.at(scene, encounter, &mut self.workspace.scratch);
        // After a fault of the function the surface is as if it had no material.
        let mut passing = if share.is_some() { 0.0 } else { 1.0 };
        let weights = share.map_or([0.0; 2], |share| [share, 1.0 - share]);
        for (weight, id) in weights.into_iter().zip(mixture.arms) {
            let arm = plan.shader_at(id);
            let hides = encounter.behind && plan.options.back_faces == BackFaces::Invisible && arm.can_hide_its_back();
            if matches!(arm.kind, Kind::Transparent) || hides {
                passing += weight;
            } else if weight > 0.0 {
                let part = Segment {
                    throughput: unseen.throughput.map(|band| band * weight),
                    follows_no_diffuse: plan.excludes_indirect(id),
                    ..*unseen
                };
                self.shade(&part, &Hit { shader: id, ..*hit }, arm);
            }
        }
        if passing > 0.0
            && let Some(throughput) = self.go_on(
                (segment.throughput.map(|band| band * passing), segment.favour()),
                segment,
                segment.reflections,
                None,
            )
        {
            let next = self.passed_through(Segment { throughput, ..*segment }, hit);
            self.push(next);
        }
    }
}
