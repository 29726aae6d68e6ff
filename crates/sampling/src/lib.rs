//! Low-discrepancy sample points, as a function of seed, ray number and dimension only.
//!
//! All rays of a picture use one Owen-scrambled Sobol' sequence in stream order: ray `pixel·N + s`
//! takes point `pixel·N + s`. With `N` a power of two, the points of a pixel form a net in each set
//! of four dimensions: those of the camera and those of the renderer, although neither knows of the
//! other. A ray stream through a pipe therefore uses the same numbers as the single command. After
//! 2¹⁶ points a new, independent scramble begins.
//!
//! Owen scrambling by hashing: Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020
//! (crate `sobol_burley`).
//!
//! Guarantees: no state, so results do not depend on threads or on the order of evaluation. Values
//! are in [0, 1).
//!
//! ```
//! use radsight_sampling::{DimensionSet, RaySampler};
//! let sampler = RaySampler::new(7, 123_456);
//! assert_eq!(sampler.take(DimensionSet::CAMERA), RaySampler::new(7, 123_456).take(DimensionSet::CAMERA));
//! assert_ne!(sampler.take(DimensionSet::CAMERA), sampler.take(DimensionSet::render(0)));
//! ```
#![forbid(unsafe_code)]

mod sobol;
mod warp;

pub use warp::{choose, cosine_hemisphere, unit_disk};

/// Number of points after which the sequence is scrambled anew; `sobol_burley` has no more.
const SEQUENCE_LENGTH_LOG2: u32 = 16;

/// Distinguishes the sequences of branches from those of rays.
const BRANCH_SEED: u64 = 0x6272_616e_6368;

/// A set of four dimensions that are used together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DimensionSet(u32);

impl DimensionSet {
    /// Pixel x, pixel y, and two dimensions of the camera's aperture.
    pub const CAMERA: DimensionSet = DimensionSet(0);

    /// Time within the exposure, and position along the axis in an aperture of finite depth.
    pub const SHUTTER: DimensionSet = DimensionSet(u32::MAX);

    /// The renderer's set number `index`.
    #[must_use]
    pub const fn render(index: u32) -> DimensionSet {
        DimensionSet(index + 1)
    }
}

/// Sampler of one ray.
#[derive(Clone, Copy, Debug)]
pub struct RaySampler {
    seed: u64,
    ray: u64,
    index: u32,
    scramble: u32,
}

impl RaySampler {
    /// Sampler of ray number `ray` (from 0, in stream order) for a seed.
    #[inline]
    #[must_use]
    pub fn new(seed: u64, ray: u64) -> Self {
        let index = (ray & ((1 << SEQUENCE_LENGTH_LOG2) - 1)) as u32;
        let block = ray >> SEQUENCE_LENGTH_LOG2;
        RaySampler { seed, ray, index, scramble: (mix(seed ^ mix(block)) >> 32) as u32 }
    }

    /// Sampler of one of `branches` rays into which this ray splits where it would take `set`.
    ///
    /// Branches use a sequence of their own, with an aligned block of a power of two for each ray,
    /// like the rays of a pixel. The branches of one ray are stratified, and so are those of
    /// neighbouring rays together.
    #[must_use]
    pub fn branch(&self, set: DimensionSet, branch: u32, branches: u32) -> Self {
        let seed = mix(self.seed ^ mix(BRANCH_SEED ^ u64::from(set.0)));
        RaySampler::new(
            seed,
            self.ray.wrapping_mul(u64::from(branches.next_power_of_two())).wrapping_add(branch.into()),
        )
    }

    /// Four coordinates of the ray's point.
    ///
    /// Every set uses the first four dimensions of the sequence, under a scramble and a shuffle of
    /// its own. Higher dimensions would form nets over several sets at once, but their projections
    /// are poor up to thousands of points: errors then stall between 16 and 256 points per pixel.
    #[inline]
    #[must_use]
    pub fn take(&self, set: DimensionSet) -> [f64; 4] {
        let scramble = (mix(u64::from(self.scramble) << 32 | u64::from(set.0)) >> 32) as u32;
        sobol::point(self.index, scramble).map(f64::from)
    }
}

/// The finaliser of SplitMix64: a bijection in which every input bit affects all output bits
/// (Steele, Lea, Flood, OOPSLA 2014).
fn mix(value: u64) -> u64 {
    let mut z = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every aligned block of 2^k rays has one point in each of 2^k strips, in every dimension.
    #[test]
    fn an_aligned_block_of_rays_is_stratified_in_every_dimension() {
        for (first, count) in [(0u64, 64u64), (64 * 31, 64), (65_536 + 1024, 256)] {
            for set in [DimensionSet::CAMERA, DimensionSet::render(0), DimensionSet::render(9)] {
                for dimension in 0..4 {
                    let mut seen = vec![false; count as usize];
                    for ray in first..first + count {
                        let u = RaySampler::new(3, ray).take(set)[dimension];
                        assert!((0.0..1.0).contains(&u));
                        seen[(u * count as f64) as usize] = true;
                    }
                    assert!(seen.iter().all(|&s| s), "strip missed: block {first}, dimension {dimension} of {set:?}");
                }
            }
        }
    }

    #[test]
    fn branches_of_one_ray_and_of_neighbouring_rays_are_stratified() {
        let (set, branches) = (DimensionSet::render(3), 32_u32);
        let mut all = vec![false; 256];
        for ray in 0..8 {
            let mut own = [false; 32];
            for branch in 0..branches {
                let u = RaySampler::new(5, ray).branch(set, branch, branches).take(DimensionSet::render(0))[0];
                own[(u * 32.0) as usize] = true;
                all[(u * 256.0) as usize] = true;
            }
            assert!(own.iter().all(|&filled| filled), "ray {ray} misses a strip");
        }
        assert!(all.iter().all(|&filled| filled));
    }

    #[test]
    fn branches_at_another_set_take_other_points() {
        let of = |set| {
            let points =
                (0..8).map(|branch| RaySampler::new(5, 7).branch(set, branch, 8).take(DimensionSet::CAMERA)[0]);
            points.collect::<Vec<_>>()
        };
        assert_ne!(of(DimensionSet::render(0)), of(DimensionSet::render(1)));
    }

    #[test]
    fn each_seed_has_its_own_sequence() {
        let of = |seed| (0..8).map(|ray| RaySampler::new(seed, ray).take(DimensionSet::CAMERA)[0]).collect::<Vec<_>>();
        assert_ne!(of(0), of(1));
    }

    /// Two sets are independent: their coordinates are not significantly correlated.
    #[test]
    fn two_sets_are_not_correlated() {
        let n = 4096;
        let mean: f64 = (0..n)
            .map(|ray| {
                let sampler = RaySampler::new(0, ray);
                let (a, b) = (sampler.take(DimensionSet::CAMERA), sampler.take(DimensionSet::render(0)));
                (a[0] - 0.5) * (b[0] - 0.5)
            })
            .sum::<f64>()
            / n as f64;
        assert!((mean * 12.0).abs() < 0.06, "correlation {}", mean * 12.0);
    }

    /// Within a set the points form a net: the mean of a smooth product converges faster than with
    /// random points.
    #[test]
    fn a_set_is_jointly_stratified() {
        let n = 1024;
        let mean: f64 = (0..n)
            .map(|ray| RaySampler::new(0, ray).take(DimensionSet::render(3)).iter().product::<f64>())
            .sum::<f64>()
            / n as f64;
        assert!((mean * 16.0 - 1.0).abs() < 0.01, "mean of the product is {mean}, expected 1/16");
    }
}
