//! The blur of an unblurred film.

use crate::adaptive::AdaptiveSampler;
use crate::film::UnblurredFilm;
use crate::lattice::{Lattice, STRIDE};
use crate::pinhole_blur::PinholeBlur;
use crate::pinhole_derivatives::{PinholeDerivatives, PinholeProbe};
use crate::radiance::radiance;
use crate::{Exposer, Workers};
use glam::DVec2;
use radsight_adaptive::ray_number;
use rayon::prelude::*;

/// The finest level of the lattice on which the dependence on the pinhole's point is measured: it
/// changes less from pixel to pixel than radiance.
const FINEST_PROBED: u8 = 2;

impl<'a> AdaptiveSampler<'a> {
    /// The blur of a film, with its dependence on the point of the pinhole from a coarse lattice.
    pub(crate) fn blur<'f>(&self, film: &'f UnblurredFilm, (lattice, levels): (&Lattice, &[u8])) -> PinholeBlur<'f> {
        let levels: Vec<u8> = levels.iter().map(|level| *level.min(&FINEST_PROBED)).collect();
        let nodes = lattice.nodes(&levels);
        let probed: Vec<usize> = (0..nodes.len()).filter(|pixel| nodes[*pixel] > 0).collect();
        let has_rare_rays = self.exposer.renderer.plan().has_rare_rays();
        let probe = |worker: &mut Workers<'a>, pixel: usize| {
            if let Some(known) = self.shared.known().and_then(|known| known.probe(pixel)) {
                return (pixel, known);
            }
            let mut probe = |sample: u32| {
                self.report_discarded(4);
                PinholeProbe::new(|on_pinhole| self.light_of_film(worker, film, (pixel, sample), on_pinhole))
            };
            let first = probe(0);
            (pixel, if has_rare_rays { first.smooth_with(|| probe(1)) } else { first.smooth() })
        };
        let probes: Vec<_> =
            probed.into_par_iter().with_min_len(8).map_init(|| self.exposer.workers(), probe).collect();
        if let Some(mut record) = self.shared.record() {
            record.probes = vec![None; nodes.len()];
            probes.iter().for_each(|(pixel, probe)| record.probes[*pixel] = Some(*probe));
        }
        let derivatives = PinholeDerivatives::new(film, (lattice, &nodes), &probes, STRIDE as usize);
        PinholeBlur { film, derivatives, subpixels: None }
    }

    /// The light of a film pixel through a point of the pinhole. All points have the same random
    /// numbers, those of a sample of the pixel.
    fn light_of_film(
        &self,
        worker: &mut Workers<'a>,
        film: &UnblurredFilm,
        (pixel, sample): (usize, u32),
        on_pinhole: DVec2,
    ) -> f64 {
        let Exposer { rays, weights, .. } = *self.exposer;
        let number = pixel as u64;
        let Some(ray) = film.ray(rays, pixel, [0.5; 2], on_pinhole) else { return 0.0 };
        worker.count(self.counted_on_film(&ray));
        ray.ray.cos4 * radiance(worker, ray_number(number, sample), (rays, number), &ray.ray, weights)
    }
}
