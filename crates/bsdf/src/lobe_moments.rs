//! Moments of a smooth lobe over a disk light, by vector instructions.
//!
//! The values of a rule's nodes are computed in groups of four where the processor has AVX2 and FMA,
//! and one by one on others, which differ in the last bits.

use glam::DVec3;
use radsight_light::{DiskFrame, DiskNodeGroup, LANES};

/// What a point scatters to the viewer from a disk whose radiance is 1, or a coordinate in its plane
/// relative to its radius.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LobeMoments {
    /// Integrals of the cosine of incidence over solid angle, for 1 and both coordinates.
    pub(crate) diffuse: [f64; 3],
    /// The same of the lobe, relative to its peak.
    pub(crate) lobe: [f64; 3],
}

/// Where a point scatters light from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LobeShape {
    /// Unit vector towards the viewer.
    pub(crate) outgoing: DVec3,
    /// Unit normals of the surface, and of its diffuse component.
    pub(crate) normal: DVec3,
    pub(crate) diffuse_normal: DVec3,
    /// The lobe is exp(−curvature·δ²); 0 for none.
    pub(crate) curvature: f64,
}

/// A point and the nodes of a disk, whose moments are added.
pub(crate) struct MomentSum<'n> {
    pub(crate) nodes: &'n [DiskNodeGroup],
    pub(crate) disk: DiskFrame,
    /// Focal distance of a spotlight; 0 for other lights.
    pub(crate) focal: f64,
    pub(crate) shape: LobeShape,
}

impl LobeShape {
    /// The cosine of incidence on the diffuse component, and the lobe relative to its peak, for a unit
    /// direction towards the light.
    #[inline]
    pub(crate) fn at(&self, incident: DVec3) -> [f64; 2] {
        let is_lit = self.curvature > 0.0 && self.normal.dot(incident) > 0.0;
        let squared_angle = squared_angle(self.outgoing.distance_squared(incident));
        let lobe = if is_lit { (-self.curvature * squared_angle).exp() } else { 0.0 };
        [self.diffuse_normal.dot(incident).max(0.0), lobe]
    }
}

impl MomentSum<'_> {
    #[inline]
    pub(crate) fn moments(self) -> LobeMoments {
        #[cfg(target_arch = "x86_64")]
        if let pulp::Arch::V3(simd) = pulp::Arch::new() {
            return simd.vectorize(avx2::Vectorized { simd, sum: self });
        }
        self.one_by_one()
    }

    fn one_by_one(&self) -> LobeMoments {
        let mut moments = LobeMoments::default();
        let DiskFrame { center, axes: [along, across], normal, radius } = self.disk;
        for (group, lane) in self.nodes.iter().flat_map(|group| (0..LANES).map(move |lane| (group, lane))) {
            let (x, y) = (group.x[lane], group.y[lane]);
            let offset = center + along * x + across * y;
            let distance = offset.length();
            let direction = offset / distance;
            let focus = distance / (distance + self.focal);
            let cosine = (-direction.dot(normal)).max(0.0) / (distance * distance);
            let share = group.area[lane] * cosine * focus * focus;
            let [diffuse, lobe] = self.shape.at(direction).map(|value| share * value);
            for (term, coordinate) in [1.0, x / radius, y / radius].into_iter().enumerate() {
                moments.diffuse[term] += diffuse * coordinate;
                moments.lobe[term] += lobe * coordinate;
            }
        }
        moments
    }
}

/// Squared length of the chord up to which a series gives the squared angle, to 2·10⁻¹³ of it.
const SHORT_CHORD: f64 = 0.02;

/// The squared angle between two unit vectors, rad², from the squared length of the chord:
/// 4·asin²(c/2).
#[inline(always)]
pub(crate) fn squared_angle(chord: f64) -> f64 {
    if chord < SHORT_CHORD {
        return chord * ANGLE_SERIES.into_iter().fold(0.0, |sum, factor| sum * chord + factor);
    }
    let angle = 2.0 * (0.5 * chord.sqrt()).min(1.0).asin();
    angle * angle
}

/// The squared angle of a short chord is the sum of its powers from the first on, with these factors,
/// the last one first: 2/(n²·(2n choose n)).
const ANGLE_SERIES: [f64; 5] = [1.0 / 3150.0, 1.0 / 560.0, 1.0 / 90.0, 1.0 / 12.0, 1.0];

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::{ANGLE_SERIES, LobeMoments, LobeShape, MomentSum, SHORT_CHORD, squared_angle};
    use glam::DVec3;
    use pulp::NullaryFnOnce;
    use pulp::x86::V3;
    use radsight_light::DiskNodeGroup;
    use std::arch::x86_64::{__m256d, _CMP_GE_OQ, _CMP_GT_OQ};
    use std::f64::consts::LOG2_E;

    /// A sum over groups of four nodes.
    pub(super) struct Vectorized<'n> {
        pub(super) simd: V3,
        pub(super) sum: MomentSum<'n>,
    }

    /// Exponents below this give 0 or nearly so.
    const LEAST_EXPONENT: f64 = -700.0;

    /// Adding it rounds a number to an integer in the last bits of the mantissa.
    const ROUNDING: f64 = 6_755_399_441_055_744.0;

    /// ln 2 in two parts; the first has few bits, so that its products with small integers are exact.
    const LN_2_HIGH: f64 = 0.693_147_180_369_123_8;
    const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;

    /// The exponent of 1 in a number's bits, and its place.
    const EXPONENT_OF_ONE: i64 = 1023;
    const MANTISSA_BITS: i32 = 52;

    /// 1/n!.
    const TERMS: [f64; 12] = {
        let mut terms = [1.0; 12];
        let mut index = 1;
        while index < terms.len() {
            terms[index] = terms[index - 1] / index as f64;
            index += 1;
        }
        terms
    };

    impl NullaryFnOnce for Vectorized<'_> {
        type Output = LobeMoments;

        #[inline(always)]
        fn call(self) -> LobeMoments {
            let mut sums = [[self.all(0.0); 3]; 2];
            for group in self.sum.nodes {
                self.add(group, &mut sums);
            }
            let [diffuse, lobe] = sums;
            LobeMoments { diffuse: diffuse.map(total), lobe: lobe.map(total) }
        }
    }

    fn total(lanes: __m256d) -> f64 {
        let [a, b, c, d]: [f64; 4] = pulp::cast(lanes);
        (a + b) + (c + d)
    }

    // No closures: they would not be compiled with these instructions.
    impl Vectorized<'_> {
        #[inline(always)]
        fn add(&self, group: &DiskNodeGroup, sums: &mut [[__m256d; 3]; 2]) {
            let (avx, fma, disk) = (self.simd.avx, self.simd.fma, &self.sum.disk);
            let LobeShape { outgoing, normal, diffuse_normal, curvature } = self.sum.shape;
            let (x, y): (__m256d, __m256d) = (pulp::cast(group.x), pulp::cast(group.y));
            let [along, across] = disk.axes;
            let mut way = [self.all(disk.center.x), self.all(disk.center.y), self.all(disk.center.z)];
            for (way, (along, across)) in way.iter_mut().zip(along.to_array().into_iter().zip(across.to_array())) {
                *way = fma._mm256_fmadd_pd(self.all(along), x, *way);
                *way = fma._mm256_fmadd_pd(self.all(across), y, *way);
            }
            let distance = avx._mm256_sqrt_pd(self.dot(way, way));
            let inverse = avx._mm256_div_pd(self.all(1.0), distance);
            let mut toward = way;
            for part in &mut toward {
                *part = avx._mm256_mul_pd(*part, inverse);
            }
            let mut chord = toward;
            for (part, outgoing) in chord.iter_mut().zip(outgoing.to_array()) {
                *part = avx._mm256_sub_pd(*part, self.all(outgoing));
            }
            let at_light = avx._mm256_max_pd(self.along(toward, -disk.normal), self.all(0.0));
            let area = avx._mm256_mul_pd(pulp::cast(group.area), avx._mm256_mul_pd(inverse, inverse));
            let mut share = avx._mm256_mul_pd(area, at_light);
            if self.sum.focal > 0.0 {
                let focus = avx._mm256_div_pd(distance, avx._mm256_add_pd(distance, self.all(self.sum.focal)));
                share = avx._mm256_mul_pd(share, avx._mm256_mul_pd(focus, focus));
            }
            let cosine = avx._mm256_max_pd(self.along(toward, diffuse_normal), self.all(0.0));
            let diffuse = avx._mm256_mul_pd(share, cosine);
            let unit = self.all(disk.radius.recip());
            let coordinates = [avx._mm256_mul_pd(x, unit), avx._mm256_mul_pd(y, unit)];
            self.add_to(&mut sums[0], diffuse, coordinates);
            if curvature > 0.0 {
                let height = self.along(toward, normal);
                let is_lit = avx._mm256_cmp_pd::<_CMP_GT_OQ>(height, self.all(0.0));
                let lobe = avx._mm256_mul_pd(share, self.lobe(self.dot(chord, chord)));
                self.add_to(&mut sums[1], avx._mm256_and_pd(is_lit, lobe), coordinates);
            }
        }

        /// Adds values, and their products with the coordinates.
        #[inline(always)]
        fn add_to(&self, sums: &mut [__m256d; 3], values: __m256d, [x, y]: [__m256d; 2]) {
            sums[0] = self.simd.avx._mm256_add_pd(sums[0], values);
            sums[1] = self.simd.fma._mm256_fmadd_pd(values, x, sums[1]);
            sums[2] = self.simd.fma._mm256_fmadd_pd(values, y, sums[2]);
        }

        /// The lobe relative to its peak, from squared chords.
        #[inline(always)]
        fn lobe(&self, chord: __m256d) -> __m256d {
            let (avx, fma) = (self.simd.avx, self.simd.fma);
            let mut squared = self.all(0.0);
            for factor in ANGLE_SERIES {
                squared = fma._mm256_fmadd_pd(squared, chord, self.all(factor));
            }
            squared = avx._mm256_mul_pd(squared, chord);
            if avx._mm256_movemask_pd(avx._mm256_cmp_pd::<_CMP_GE_OQ>(chord, self.all(SHORT_CHORD))) != 0 {
                let [a, b, c, d]: [f64; 4] = pulp::cast(chord);
                squared = pulp::cast([squared_angle(a), squared_angle(b), squared_angle(c), squared_angle(d)]);
            }
            self.exp(avx._mm256_mul_pd(squared, self.all(-self.sum.shape.curvature)))
        }

        /// eˣ for x ≤ 0, to 10⁻¹⁴ of it: 2ⁿ·eʳ with |r| ≤ ln 2/2, and Taylor's series of eʳ.
        #[inline(always)]
        fn exp(&self, exponent: __m256d) -> __m256d {
            let (avx, avx2, fma) = (self.simd.avx, self.simd.avx2, self.simd.fma);
            let exponent = avx._mm256_max_pd(exponent, self.all(LEAST_EXPONENT));
            let shifted = fma._mm256_fmadd_pd(exponent, self.all(LOG2_E), self.all(ROUNDING));
            let whole = avx._mm256_sub_pd(shifted, self.all(ROUNDING));
            let rest = fma._mm256_fnmadd_pd(whole, self.all(LN_2_HIGH), exponent);
            let rest = fma._mm256_fnmadd_pd(whole, self.all(LN_2_LOW), rest);
            let mut value = self.all(TERMS[11]);
            for index in (0..11).rev() {
                value = fma._mm256_fmadd_pd(value, rest, self.all(TERMS[index]));
            }
            let bits = avx2._mm256_add_epi64(pulp::cast(shifted), avx._mm256_set1_epi64x(EXPONENT_OF_ONE));
            avx._mm256_mul_pd(value, pulp::cast(avx2._mm256_slli_epi64::<MANTISSA_BITS>(bits)))
        }

        #[inline(always)]
        fn all(&self, value: f64) -> __m256d {
            self.simd.avx._mm256_set1_pd(value)
        }

        #[inline(always)]
        fn dot(&self, a: [__m256d; 3], b: [__m256d; 3]) -> __m256d {
            let (avx, fma) = (self.simd.avx, self.simd.fma);
            let sum = fma._mm256_fmadd_pd(a[1], b[1], avx._mm256_mul_pd(a[0], b[0]));
            fma._mm256_fmadd_pd(a[2], b[2], sum)
        }

        #[inline(always)]
        fn along(&self, way: [__m256d; 3], axis: DVec3) -> __m256d {
            self.dot(way, [self.all(axis.x), self.all(axis.y), self.all(axis.z)])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(nodes: &[DiskNodeGroup], spread: f64) -> MomentSum<'_> {
        let disk = DiskFrame { center: DVec3::Z, axes: [DVec3::X, DVec3::Y], normal: DVec3::NEG_Z, radius: 0.5 };
        let diffuse_normal = DVec3::new(0.0, 0.6, 0.8);
        let curvature = (4.0 * spread * spread).recip();
        let shape = LobeShape { outgoing: DVec3::Z, normal: DVec3::Z, diffuse_normal, curvature };
        MomentSum { nodes, disk, focal: 0.3, shape }
    }

    #[test]
    #[cfg(target_arch = "x86_64")]
    fn vectors_give_what_single_nodes_give() {
        let pulp::Arch::V3(simd) = pulp::Arch::new() else { return };
        let lanes = |step: f64| std::array::from_fn(|lane| (step * (lane as f64 + 1.0)).sin() * 0.5);
        for spread in [1e-4, 0.003, 0.03, 0.3, 3.0] {
            for step in 0..200 {
                let (angle, step) = (f64::min(spread, 0.5), f64::from(step));
                let scaled = |values: [f64; LANES]| values.map(|value| 8.0 * angle * value);
                let (x, y) = (scaled(lanes(step)), scaled(lanes(1.7 * step)));
                let nodes = [DiskNodeGroup { x, y, area: [0.1, 0.3, 0.2, 0.0] }];
                let one_by_one = sum(&nodes, spread).one_by_one();
                let vectors = simd.vectorize(avx2::Vectorized { simd, sum: sum(&nodes, spread) });
                for (a, b) in [(one_by_one.diffuse, vectors.diffuse), (one_by_one.lobe, vectors.lobe)] {
                    let close = |index: usize| (a[index] - b[index]).abs() <= 1e-12 * a[0] + 1e-290;
                    assert!((0..3).all(close), "{a:?}, not {b:?}, spread {spread}");
                }
            }
        }
    }

    #[test]
    fn squared_angles_are_continuous() {
        for angle in [1e-9, 1e-3, 0.1414, 0.1415, 1.0, 3.0_f64] {
            let chord = (2.0 * (0.5 * angle).sin()).powi(2);
            assert!((squared_angle(chord) / (angle * angle) - 1.0).abs() < 1e-12, "{angle}");
        }
    }
}
