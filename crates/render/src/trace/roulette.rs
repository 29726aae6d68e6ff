//! How long paths are, and how weak ones end.

use super::path_state::PathState;
use super::{MAX_BRANCHES, PathIntegrator};
use crate::mis::Lobe;
use radsight_compile::PathLimit;
use radsight_sampling::DimensionSet;

/// A path shorter than this is never ended by roulette.
const ROULETTE_DEPTH: u32 = 4;

/// Paths that carry less than this share may be ended where their next ray is drawn from the diffuse component.
const ROULETTE_SHARE: f64 = 0.25;

/// Other rays may be the narrow view of a light, thousands of times as bright as what is around. One that was kept by chance shows it so many times as bright again as
/// the chance was small: these paths end later.
const ROULETTE_SHARE_OF_VIEWS: f64 = 0.05;

/// No path is longer. With a reflectance of 0.99 one in 10¹⁷ would be.
const MAX_DEPTH: u32 = 4096;

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// Whether a path goes on, and with what: ends long paths, and weak ones at random without bias, more readily when many branches wait. A
    /// path is as weak as it would be if its rays were not favoured. `lobe` is from what the next ray is drawn, if it is.
    ///
    /// The least weight (`-lw`) is compared with what a ray carries, as in Radiance: one of many
    /// into which a ray has split carries little. What `PathLimit::Cut` throws away is weak by what
    /// surfaces have taken from it, not by splitting, which would lose light.
    pub(crate) fn go_on(
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
            // A path with a drawn ray is noisy as it is; one from the eye by way of mirrors is not, and stays so.
            let drawn = path.mis.is_some() && depth >= ROULETTE_DEPTH;
            let usual = if lobe == Some(Lobe::Diffuse) { ROULETTE_SHARE } else { ROULETTE_SHARE_OF_VIEWS };
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
