//! Unit vectors in 32 bits, packed as in Radiance's `dircode.c`.
//!
//! Bits 0 to 2 are the signs of x, y and z. Two of the three magnitudes have 13 bits each, from bit
//! 5 and from bit 18; the largest is omitted, since the length is one. Bit 3 means that the first
//! is x rather than y, bit 4 that the second is z rather than the other of x and y. Code zero means
//! no direction.

/// Scale of a stored magnitude; the largest is 1/√2.
const SCALE: f64 = (8192.0 - 0.5) * std::f64::consts::SQRT_2;

const FIRST_IS_X: u32 = 1 << 3;
const SECOND_IS_Z: u32 = 1 << 4;
const FIRST_SHIFT: u32 = 5;
const SECOND_SHIFT: u32 = 18;
const MASK: u32 = 0x1fff;

/// The unit vector of a code; `None` for code zero.
pub(crate) fn decode(code: u32) -> Option<[f64; 3]> {
    if code == 0 {
        return None;
    }
    let stored = |shift: u32| f64::from((code >> shift) & MASK) / SCALE;
    let (first, second) = (stored(FIRST_SHIFT), stored(SECOND_SHIFT));
    let largest = (1.0 - first * first - second * second).max(0.0).sqrt();
    let mut direction = match (code & FIRST_IS_X != 0, code & SECOND_IS_Z != 0) {
        (true, true) => [first, largest, second],
        (true, false) => [first, second, largest],
        (false, true) => [largest, first, second],
        (false, false) => [second, first, largest],
    };
    // A damaged code can hold two magnitudes whose vector is longer than one.
    let length = direction.iter().map(|component| component * component).sum::<f64>().sqrt();
    for (axis, component) in direction.iter_mut().enumerate() {
        *component /= if code & (1 << axis) == 0 { length } else { -length };
    }
    Some(direction)
}

/// The code of a unit vector; zero for the zero vector.
pub(crate) fn encode(direction: [f64; 3]) -> u32 {
    let magnitude = direction.map(|component| (component.abs() * SCALE + 0.5) as u32);
    if magnitude == [0; 3] {
        return 0;
    }
    let signs = (0..3).filter(|&axis| direction[axis] < 0.0).map(|axis| 1 << axis).sum::<u32>();
    let [x, y, z] = magnitude;
    let (first, larger) = if x <= y { (FIRST_IS_X | x << FIRST_SHIFT, y) } else { (y << FIRST_SHIFT, x) };
    let second = if z <= larger { SECOND_IS_Z | z << SECOND_SHIFT } else { larger << SECOND_SHIFT };
    match signs | first | second {
        0 => FIRST_IS_X,
        code => code,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn length(vector: [f64; 3]) -> f64 {
        vector.iter().map(|component| component * component).sum::<f64>().sqrt()
    }

    proptest! {
        #[test]
        fn a_direction_comes_back_within_a_hundredth_of_a_degree(x in -1.0..1.0_f64, y in -1.0..1.0_f64, z in -1.0..1.0_f64) {
            let size = length([x, y, z]);
            prop_assume!(size > 1e-3);
            let unit = [x, y, z].map(|component| component / size);
            let back = decode(encode(unit)).unwrap();
            let apart = length([back[0] - unit[0], back[1] - unit[1], back[2] - unit[2]]);
            prop_assert!(apart.to_degrees() < 0.01, "{unit:?} becomes {back:?}");
        }

        #[test]
        fn every_code_is_a_unit_vector(code in 1_u32..) {
            prop_assert!((length(decode(code).unwrap()) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_axes_are_exact() {
        for axis in 0..3 {
            for sign in [1.0, -1.0] {
                let mut unit = [0.0; 3];
                unit[axis] = sign;
                assert_eq!(decode(encode(unit)).unwrap().map(|component| component + 0.0), unit);
            }
        }
        assert_eq!((encode([0.0; 3]), decode(0)), (0, None));
    }
}
