//! Two-phase sampling of pixels that see the outline of a surface (double sampling for
//! stratification: Neyman 1938; Cochran, "Sampling Techniques", 1977, chapter 12).
//!
//! Where a pixel sees two surfaces, most of the error is that of their shares of the pixel. A first
//! hit costs a fiftieth of a radiance with a dozen lights. So many rays find their first surface,
//! which divides them into strata, and the radiance of a few rays of each stratum is computed. The
//! mean over a stratum counts by the stratum's share of all rays. All rays of a stratum have the
//! same probability of being chosen, so the mean is unbiased, however the strata are chosen.

/// Rays of the first phase for each of the second.
pub(crate) const FIRST_PHASE: u32 = 16;

/// Maximum number of strata of a pixel; what is left belongs to the last one.
pub(crate) const MAX_STRATA: usize = 4;

/// A ray of the second phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Chosen {
    /// Its index among the rays of the first phase.
    pub(crate) index: usize,
    /// Its weight; the weights of all chosen rays add up to the number of wanted ones, or less if
    /// the first phase has rays without stratum.
    pub(crate) weight: f64,
}

/// The number of each ray's stratum, from 0.
pub(crate) fn numbered<K: Copy + PartialEq>(strata: &[Option<K>]) -> Vec<Option<usize>> {
    let mut keys: Vec<K> = Vec::with_capacity(MAX_STRATA);
    let mut stratum_of = |key: K| {
        keys.iter().position(|known| *known == key).unwrap_or_else(|| {
            if keys.len() < MAX_STRATA {
                keys.push(key);
            }
            keys.len() - 1
        })
    };
    strata.iter().map(|key| key.map(&mut stratum_of)).collect()
}

/// Chooses about `wanted` rays, at least one of each stratum, by systematic sampling. `strata` gives
/// the stratum of each ray of the first phase; `None` for a ray without radiance. `offset` is
/// uniform over the unit interval.
pub(crate) fn choose<K: Copy + PartialEq>(strata: &[Option<K>], wanted: u32, offset: f64) -> Vec<Chosen> {
    let mut members: [Vec<usize>; MAX_STRATA] = Default::default();
    for (index, stratum) in numbered(strata).into_iter().enumerate() {
        if let Some(stratum) = stratum {
            members[stratum].push(index);
        }
    }
    let mut chosen = Vec::with_capacity(wanted as usize + MAX_STRATA);
    for members in members.iter().filter(|members| !members.is_empty()) {
        let share = f64::from(wanted) * members.len() as f64 / strata.len() as f64;
        let count = share.round().clamp(1.0, members.len() as f64);
        let step = members.len() as f64 / count;
        for turn in 0..count as usize {
            let at = ((turn as f64 + offset) * step) as usize;
            chosen.push(Chosen { index: members[at.min(members.len() - 1)], weight: share / count });
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strata(text: &str) -> Vec<Option<u8>> {
        text.bytes().map(|key| (key != b'.').then_some(key)).collect()
    }

    #[test]
    fn every_stratum_counts_by_its_share() {
        let strata = strata("aaaaaaaaaaabbb.c");
        let chosen = choose(&strata, 4, 0.3);
        let weight_of =
            |key: u8| -> f64 { chosen.iter().filter(|ray| strata[ray.index] == Some(key)).map(|ray| ray.weight).sum() };
        for (key, count) in [(b'a', 11.0), (b'b', 3.0), (b'c', 1.0)] {
            assert!((weight_of(key) - 4.0 * count / 16.0).abs() < 1e-12);
        }
    }

    /// Over all offsets the mean weight of each ray is the same.
    #[test]
    fn the_choice_is_unbiased() {
        let strata = strata("abcdefaab.bbcaaa");
        let (steps, mut sums) = (100_000, vec![0.0; 16]);
        for step in 0..steps {
            for ray in choose(&strata, 4, (f64::from(step) + 0.5) / f64::from(steps)) {
                sums[ray.index] += ray.weight / f64::from(steps);
            }
        }
        for (sum, stratum) in sums.iter().zip(&strata) {
            let correct = if stratum.is_some() { 0.25 } else { 0.0 };
            assert!((sum - correct).abs() < 1e-3, "{sums:?}");
        }
    }

    #[test]
    fn no_ray_is_chosen_twice() {
        let strata: Vec<Option<usize>> = (0..64).map(|index| Some(usize::from(index > 2))).collect();
        for wanted in [1, 3, 32, 64] {
            let mut chosen = choose(&strata, wanted, 0.999_999_999);
            let count = chosen.len();
            chosen.dedup_by_key(|ray| ray.index);
            assert_eq!(chosen.len(), count);
        }
    }
}
