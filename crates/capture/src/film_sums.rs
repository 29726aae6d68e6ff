//! The samples of a film, recorded by subpixel.
//!
//! Where a pixel is sampled in two phases ([`two_phase`](crate::two_phase)), all rays of the first phase
//! count, with the light of their stratum.

use crate::Workers;
use crate::adaptive::{AdaptiveSampler, DrawnRay, Phases};
use crate::subpixels::SubpixelSamples;
use crate::sums::Sums;
use crate::two_phase::{Chosen, FIRST_PHASE, MAX_STRATA};
use std::ops::Range;

impl<'a> AdaptiveSampler<'a> {
    /// Sums over some samples of a pixel of the film, which are recorded by subpixel.
    pub(crate) fn film_sums(&self, worker: &mut Workers<'a>, pixel: usize, samples: Range<u32>) -> Sums {
        let (mut whole, mut parts) = (0.0, SubpixelSamples::default());
        for sample in samples {
            let (number, u) = self.sample_point(pixel, sample);
            let light = self.drawn(pixel, number, u).map_or(0.0, |ray| self.light(worker, pixel, ray));
            whole += light;
            parts.add([u[0], u[1]], 1.0, light);
        }
        self.subpixels.add(pixel, &parts);
        Sums { whole, ..Sums::default() }
    }

    /// The same in two phases.
    pub(crate) fn two_phase_film_sums(&self, worker: &mut Workers<'a>, pixel: usize, samples: Range<u32>) -> Sums {
        let Phases { mut rays, strata, chosen } = self.phases(pixel, samples);
        let (mut whole, mut parts) = (0.0, SubpixelSamples::dense());
        let mut lit: Vec<(Chosen, f64)> = Vec::with_capacity(chosen.len());
        for chosen in chosen {
            let Some(ray) = rays[chosen.index].1.take() else { continue };
            let light = self.light(worker, pixel, DrawnRay { weight: 1.0, ..ray });
            whole += chosen.weight * light;
            lit.push((chosen, light));
        }
        let means = stratum_means(&strata, &lit);
        let mean = |index: usize| strata[index].map_or(0.0, |stratum| means[stratum]);
        for (index, (place, _)) in rays.iter().enumerate() {
            parts.add(*place, f64::from(FIRST_PHASE).recip(), mean(index));
        }
        for (chosen, light) in lit {
            parts.add_light(rays[chosen.index].0, chosen.weight * (light - mean(chosen.index)));
        }
        self.subpixels.add(pixel, &parts);
        Sums { whole, ..Sums::default() }
    }

    fn light(&self, worker: &mut Workers<'a>, pixel: usize, ray: DrawnRay) -> f64 {
        self.summed(worker, pixel, std::iter::once(ray)).whole
    }
}

/// The mean light of the chosen rays of each stratum.
fn stratum_means(strata: &[Option<usize>], lit: &[(Chosen, f64)]) -> [f64; MAX_STRATA] {
    let mut sums = [[0.0; 2]; MAX_STRATA];
    for (chosen, light) in lit {
        if let Some(stratum) = strata[chosen.index] {
            let [weight, weighted] = sums[stratum];
            sums[stratum] = [weight + chosen.weight, weighted + chosen.weight * light];
        }
    }
    sums.map(|[weight, light]| if weight > 0.0 { light / weight } else { 0.0 })
}
