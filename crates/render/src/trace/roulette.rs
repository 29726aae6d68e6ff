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

/// Number of rays in the tree of a view ray beyond which Russian roulette gets stricter, and the
/// minimum weight there. Without absorption, as many branches stay above the minimum weight at each
/// of a hundred bounces as it allows.
const LARGE_TREE: u32 = 4096;
const LEAST_WEIGHT_IN_LARGE_TREE: f64 = 1e-4;

/// Maximum path length. With a reflectance of 0.99 one path in 10¹⁷ would be longer.
const MAX_DEPTH: u32 = 4096;

/// The minimum weight of a view ray in a tree of this many rays. It grows as their cube, so that a
/// tree ends after a few times `LARGE_TREE`.
fn least_weight_in_tree(least: f64, rays: u32) -> f64 {
    let excess = f64::from(rays) / f64::from(LARGE_TREE);
    if excess <= 1.0 { least } else { least.max(LEAST_WEIGHT_IN_LARGE_TREE) * excess.powi(3) }
}

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
        let strongest = pdf_ratio * throughput.iter().fold(0.0, |most: f64, band| most.max(band.abs()));
        let unsplit = path.split * strongest;
        let depth = path.depth + 1;
        if strongest <= 0.0 || depth > MAX_DEPTH {
            return None;
        }
        let least = self.plan.options.least_weight;
        let is_view = path.mis.is_none() && lobe.is_none();
        self.view_rays += u32::from(is_view);
        let roulette = match self.plan.options.path_limit {
            PathLimit::Cut(most) if reflections > most || unsplit < least => return None,
            PathLimit::RouletteUpTo(most) if reflections > most => return None,
            _ if is_view => least_weight_in_tree(least, self.view_rays),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_trees_have_the_requested_minimum_weight() {
        for rays in [1, 100, LARGE_TREE] {
            assert_eq!(least_weight_in_tree(2e-3, rays), 2e-3);
            assert_eq!(least_weight_in_tree(0.0, rays), 0.0);
        }
    }

    #[test]
    fn hardly_any_branch_goes_on_in_a_tree_of_a_hundred_times_as_many_rays() {
        assert!(least_weight_in_tree(0.0, 100 * LARGE_TREE) >= 1.0);
        assert!(least_weight_in_tree(1e-2, 10 * LARGE_TREE) >= 1.0);
    }
}
