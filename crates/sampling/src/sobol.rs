//! A point of the first four dimensions of the scrambled and shuffled Sobol' sequence.
//!
//! The same values as `sobol_burley::sample_4d` (Burley, "Practical Hash-based Owen Scrambling",
//! JCGT 9(4), 2020), which takes one step for each bit of the index that is set: half of its time,
//! since their number cannot be predicted. Here four bits at once select from a table.

use sobol_burley::parts::{Int4, hash, hash_int4, owen_scramble_int4_rev, owen_scramble_rev};

/// Number of bits of an index.
const BITS: usize = 16;

/// Bits of an index that are looked up at once.
const DIGIT: usize = 4;

const DIMENSIONS: usize = 4;

/// Degree, inner coefficients and first numbers of the primitive polynomials after that of the
/// first dimension (Joe and Kuo, SIAM J. Sci. Comput. 30(5), 2008).
const POLYNOMIALS: [(usize, u32, [u32; 3]); DIMENSIONS - 1] = [(1, 0, [1, 0, 0]), (2, 1, [1, 3, 0]), (3, 1, [1, 3, 1])];

/// Direction numbers of each bit of an index in each dimension, with reversed bits.
const DIRECTIONS: [[u32; DIMENSIONS]; BITS] = {
    let mut directions = [[0; DIMENSIONS]; BITS];
    let mut bit = 0;
    while bit < BITS {
        directions[bit][0] = 1 << bit;
        bit += 1;
    }
    let mut dimension = 1;
    while dimension < DIMENSIONS {
        let numbers = direction_numbers(POLYNOMIALS[dimension - 1]);
        let mut bit = 0;
        while bit < BITS {
            directions[bit][dimension] = (numbers[bit] << (u32::BITS as usize - 1 - bit)).reverse_bits();
            bit += 1;
        }
        dimension += 1;
    }
    directions
};

/// The direction numbers m of a polynomial, by Bratley and Fox's recurrence.
const fn direction_numbers((degree, coefficients, first): (usize, u32, [u32; 3])) -> [u32; BITS] {
    let mut numbers = [0; BITS];
    let mut bit = 0;
    while bit < BITS {
        if bit < degree {
            numbers[bit] = first[bit];
        } else {
            let mut number = numbers[bit - degree] ^ numbers[bit - degree] << degree;
            let mut back = 1;
            while back < degree {
                if coefficients >> (degree - 1 - back) & 1 == 1 {
                    number ^= numbers[bit - back] << back;
                }
                back += 1;
            }
            numbers[bit] = number;
        }
        bit += 1;
    }
    numbers
}

/// By digit of a reversed index, from the highest, and by its value: the sum of the direction numbers.
static SUMS: [[[u32; DIMENSIONS]; 1 << DIGIT]; BITS / DIGIT] = {
    let mut sums = [[[0; DIMENSIONS]; 1 << DIGIT]; BITS / DIGIT];
    let mut entry = 0;
    while entry < BITS * DIMENSIONS * (1 << DIGIT) {
        let (dimension, rest) = (entry % DIMENSIONS, entry / DIMENSIONS);
        let (bit, rest) = (rest % DIGIT, rest / DIGIT);
        let (value, digit) = (rest % (1 << DIGIT), rest >> DIGIT);
        if value >> (DIGIT - 1 - bit) & 1 == 1 {
            sums[digit][value][dimension] ^= DIRECTIONS[digit * DIGIT + bit][dimension];
        }
        entry += 1;
    }
    sums
};

/// Point number `index`, below 2¹⁶, of the sequence of a seed.
#[inline]
pub(crate) fn point(index: u32, seed: u32) -> [f32; DIMENSIONS] {
    let shuffled = owen_scramble_rev(index.reverse_bits(), hash(seed ^ 0x79c6_8e4a));
    let sum = |digit: usize| -> Int4 {
        SUMS[digit][(shuffled >> (u32::BITS as usize - DIGIT * (digit + 1))) as usize % (1 << DIGIT)].into()
    };
    let sobol = sum(0) ^ sum(1) ^ sum(2) ^ sum(3);
    let seeds: Int4 = [seed.wrapping_mul(0x9c8f_2d3b); DIMENSIONS].into();
    let scramble = seeds ^ [0x912f_69ba, 0x174f_18ab, 0x691e_72ca, 0xb40c_c1b8].into();
    owen_scramble_int4_rev(sobol, hash_int4(scramble)).reverse_bits().to_f32_norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_those_of_the_sequence_bit_by_bit() {
        for index in 0..1_u32 << BITS {
            let seed = index.wrapping_mul(0x9e37_79b9) ^ 0x1234_5678;
            assert_eq!(point(index, seed), sobol_burley::sample_4d(index, 0, seed), "point {index}");
        }
    }
}
