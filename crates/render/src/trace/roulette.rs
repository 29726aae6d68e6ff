//! Path termination.

use super::path_state::PathState;
use super::{MAX_BRANCHES, PathIntegrator};
use crate::mis::Lobe;
use radsight_compile::PathLimit;
use radsight_sampling::DimensionSet;

/// Minimum path length for Russian roulette.
const ROULETTE_DEPTH: u32 = 4;

/// Throughput below which paths may be terminated before a diffuse bounce.
const ROULETTE_THROUGHPUT: f64 = 0.25;

/// Throughput below which other paths may be terminated. They may be the narrow view of a light,
/// thousands of times as bright as its surroundings. Surviving paths are weighted by 1/p, so a
/// small p makes fireflies.
const ROULETTE_VIEW_THROUGHPUT: f64 = 0.05;

/// Maximum path length. With a reflectance of 0.99 one path in 10¹⁷ would be longer.
const MAX_DEPTH: u32 = 4096;

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// Whether a path continues, and with which weight: ends long paths, and weak ones by Russian
    /// roulette, with higher probability if many branches are pending. The pdf ratio does not
    /// affect the weight. `lobe` is the lobe from which the next ray is sampled, if it is.
    ///
    /// The minimum weight (`-lw`) is compared with the weight of the ray, as in Radiance: one of
    /// many branches has a small weight. `PathLimit::Cut` ignores splitting, since cutting branches
    /// would lose light.
    pub(crate) fn roulette(
        &mut self,
        (throughput, pdf_ratio): ([f64; BANDS], f64),
        path: &PathState<BANDS>,
        reflections: u32,
        lobe: Option<Lobe>,
    ) -> Option<[f64; BANDS]> {
        let strongest = pdf_ratio * throughput.iter().copied().fold(0.0, f64::max);
        let unsplit = path.split * strongest;
        let depth = path.depth + 1;
        if strongest <= 0.0 || depth > MAX_DEPTH {
            return None;
        }
        let least = self.plan.options.least_weight;
        let roulette = match self.plan.options.path_limit {
            PathLimit::Cut(most) if reflections > most || unsplit < least => return None,
            PathLimit::RouletteUpTo(most) if reflections > most => return None,
            _ => least,
        };
        let crowded = self.waiting.len() + 2 >= MAX_BRANCHES;
        let survival = if crowded {
            unsplit.min(0.5)
        } else {
            // A path with a sampled ray is noisy anyway; one through mirrors from the eye is not,
            // and stays so.
            let drawn = path.mis.is_some() && depth >= ROULETTE_DEPTH;
            let usual = if lobe == Some(Lobe::Diffuse) { ROULETTE_THROUGHPUT } else { ROULETTE_VIEW_THROUGHPUT };
            let by_weight = if roulette > 0.0 { strongest / roulette } else { 1.0 };
            let by_share = if drawn { unsplit / usual } else { 1.0 };
            by_weight.min(by_share).min(1.0)
        };
        if survival >= 1.0 {
            return Some(throughput);
        }
        let u = self.sampler.take(DimensionSet::render(self.next_set))[0];
        self.next_set += 1;
        (u < survival).then(|| throughput.map(|band| band / survival))
    }
}
