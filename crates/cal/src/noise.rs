//! The noise functions of Radiance: `noise3` with its gradient, and `fnoise3`.
//!
//! `noise3` is Perlin's improved gradient noise ("Improving Noise", Computer Graphics 35(3), 2002)
//! with his table of 256 values; its derivatives are backward differences over [`STEP`]. `fnoise3`
//! is a random midpoint subdivision of the unit cube, seeded by an integer hash. Both give the
//! values of Radiance's functions, bit for bit where the order of additions permits.

use crate::builtin::truncated;

/// Step of the differences, and finest detail of the fractal.
const STEP: f64 = 0.0005;

/// Perlin's permutation of 0..=255.
const PERMUTATION: [u8; 256] = [
    151, 160, 137, 91, 90, 15, 131, 13, 201, 95, 96, 53, 194, 233, 7, 225, 140, 36, 103, 30, 69, 142, 8, 99, 37, 240,
    21, 10, 23, 190, 6, 148, 247, 120, 234, 75, 0, 26, 197, 62, 94, 252, 219, 203, 117, 35, 11, 32, 57, 177, 33, 88,
    237, 149, 56, 87, 174, 20, 125, 136, 171, 168, 68, 175, 74, 165, 71, 134, 139, 48, 27, 166, 77, 146, 158, 231, 83,
    111, 229, 122, 60, 211, 133, 230, 220, 105, 92, 41, 55, 46, 245, 40, 244, 102, 143, 54, 65, 25, 63, 161, 1, 216,
    80, 73, 209, 76, 132, 187, 208, 89, 18, 169, 200, 196, 135, 130, 116, 188, 159, 86, 164, 100, 109, 198, 173, 186,
    3, 64, 52, 217, 226, 250, 124, 123, 5, 202, 38, 147, 118, 126, 255, 82, 85, 212, 207, 206, 59, 227, 47, 16, 58, 17,
    182, 189, 28, 42, 223, 183, 170, 213, 119, 248, 152, 2, 44, 154, 163, 70, 221, 153, 101, 155, 167, 43, 172, 9, 129,
    22, 39, 253, 19, 98, 108, 110, 79, 113, 224, 232, 178, 185, 112, 104, 218, 246, 97, 228, 251, 34, 242, 193, 238,
    210, 144, 12, 191, 179, 162, 241, 81, 51, 145, 235, 249, 14, 239, 107, 49, 192, 214, 31, 181, 199, 106, 157, 184,
    84, 204, 176, 115, 121, 50, 45, 127, 4, 150, 254, 138, 236, 205, 93, 222, 114, 67, 29, 24, 72, 243, 141, 128, 195,
    78, 66, 215, 61, 156, 180,
];

/// `noise3(x,y,z)`: between −1 and 1.
pub(crate) fn value(point: [f64; 3]) -> f64 {
    let mut corner = [0_i32; 3];
    let mut offset = [0.0; 3];
    for axis in 0..3 {
        let floor = truncated(point[axis]).wrapping_sub(i32::from(point[axis] < 0.0));
        offset[axis] = point[axis] - f64::from(floor);
        corner[axis] = floor & 0xff;
    }
    let [x, y, z] = offset;
    let hash = |i: i32| i32::from(PERMUTATION[(i & 0xff) as usize]);
    let left = hash(corner[0]) + corner[1];
    let right = hash(corner[0] + 1) + corner[1];
    let [left_low, left_high] = [hash(left) + corner[2], hash(left + 1) + corner[2]];
    let [right_low, right_high] = [hash(right) + corner[2], hash(right + 1) + corner[2]];
    let [u, v, w] = offset.map(fade);
    let layer = |up: i32, z: f64| {
        let low = mix(u, gradient(hash(left_low + up), x, y, z), gradient(hash(right_low + up), x - 1.0, y, z));
        let high =
            mix(u, gradient(hash(left_high + up), x, y - 1.0, z), gradient(hash(right_high + up), x - 1.0, y - 1.0, z));
        mix(v, low, high)
    };
    mix(w, layer(0, z), layer(1, z - 1.0))
}

/// `noise3x`, `noise3y`, `noise3z`: derivative of [`value`] along one axis (0, 1, 2).
pub(crate) fn slope(point: [f64; 3], axis: usize) -> f64 {
    let mut before = point;
    before[axis] -= STEP;
    (value(point) - value(before)) / STEP
}

/// Perlin's quintic blending curve, 6t⁵ − 15t⁴ + 10t³.
fn fade(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

fn mix(t: f64, from: f64, to: f64) -> f64 {
    from + t * (to - from)
}

/// Perlin's twelve edge directions, four of them twice. A table avoids branches that processors
/// cannot predict.
const DIRECTIONS: [[f64; 3]; 16] = [
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [1.0, -1.0, 0.0],
    [-1.0, -1.0, 0.0],
    [1.0, 0.0, 1.0],
    [-1.0, 0.0, 1.0],
    [1.0, 0.0, -1.0],
    [-1.0, 0.0, -1.0],
    [0.0, 1.0, 1.0],
    [0.0, -1.0, 1.0],
    [0.0, 1.0, -1.0],
    [0.0, -1.0, -1.0],
    [1.0, 1.0, 0.0],
    [0.0, -1.0, 1.0],
    [-1.0, 1.0, 0.0],
    [0.0, -1.0, -1.0],
];

/// The dot product of (x,y,z) with one of the edge directions.
fn gradient(hash: i32, x: f64, y: f64, z: f64) -> f64 {
    let [along_x, along_y, along_z] = DIRECTIONS[(hash & 15) as usize];
    x * along_x + y * along_y + z * along_z
}

/// `fnoise3(x,y,z)`: fractal noise, between −1 and 1.
///
/// The cube that contains the point is halved eleven times. A new corner is the mean of the corners
/// around it, plus a random number scaled by the cube's size.
pub(crate) fn fractal(point: [f64; 3]) -> f64 {
    const FINEST: i64 = 2000; // 1/STEP steps along a unit cube
    let mut size = FINEST;
    let target = point.map(|x| (FINEST as f64 * x) as i64);
    let mut origin = point.map(|x| (FINEST as f64 * x.floor()) as i64);
    let mut corners: [f64; 8] = std::array::from_fn(|corner| {
        lattice(seed(std::array::from_fn(|axis| {
            if corner >> axis & 1 == 1 { origin[axis].wrapping_add(size) } else { origin[axis] }
        })))
    });
    loop {
        let mean = corners.iter().sum::<f64>() * 0.125;
        size >>= 1;
        if size == 0 {
            return mean;
        }
        let centre = origin.map(|start| start.wrapping_add(size));
        let branch = (0..3).fold(0, |mask, axis| mask | usize::from(target[axis] > centre[axis]) << axis);
        subdivide(&mut corners, mean, centre, branch, size);
        for (axis, start) in origin.iter_mut().enumerate() {
            *start = start.wrapping_add(size * (branch as i64 >> axis & 1));
        }
    }
}

/// The corners of the lower and of the upper face of a cube across each axis. A table avoids branches.
const FACES: [[[usize; 4]; 2]; 3] =
    [[[0, 2, 4, 6], [1, 3, 5, 7]], [[0, 1, 4, 5], [2, 3, 6, 7]], [[0, 1, 2, 3], [4, 5, 6, 7]]];

/// Replaces the corners of a cube by those of its octant `branch`: first the corner at the old
/// cube's centre, then those on its faces, then those on its edges, each from the corners at that
/// stage.
fn subdivide(corners: &mut [f64; 8], mean: f64, centre: [i64; 3], branch: usize, size: i64) {
    let amplitude = size as f64 * STEP;
    let centre = seed(centre);
    // From the centre to the face or edge of the octant, along each axis.
    let toward: [i64; 3] = std::array::from_fn(|axis| {
        let step = size.wrapping_mul(SEED_STEPS[axis]);
        if branch >> axis & 1 == 1 { step } else { -step }
    });
    corners[!branch & 7] = mean + amplitude * lattice(centre);
    for axis in 0..3 {
        let face = centre.wrapping_add(toward[axis]);
        let on_face = FACES[axis][branch >> axis & 1];
        let sum = on_face.into_iter().fold(0.0, |sum, corner| sum + corners[corner & 7]);
        corners[!(branch ^ 1 << axis) & 7] = 0.25 * sum + amplitude * lattice(face);
    }
    for axis in 0..3 {
        let edge = centre.wrapping_add(toward[(axis + 1) % 3]).wrapping_add(toward[(axis + 2) % 3]);
        let sum = corners[branch & !(1 << axis) & 7] + corners[(branch | 1 << axis) & 7];
        corners[(branch ^ 1 << axis) & 7] = 0.5 * sum + amplitude * lattice(edge);
    }
}

/// How much the seed changes with each coordinate of a lattice point.
const SEED_STEPS: [i64; 3] = [17, 23, 29];

/// The seed of a lattice point, a linear function in 64-bit arithmetic.
fn seed(point: [i64; 3]) -> i64 {
    let [x, y, z] = std::array::from_fn(|axis| point[axis].wrapping_mul(SEED_STEPS[axis]));
    x.wrapping_add(y).wrapping_add(z)
}

/// A random number in (−1, 1] for a seed, by a common integer hash.
fn lattice(seed: i64) -> f64 {
    let s = seed.wrapping_shl(13) ^ seed;
    let cubic = s.wrapping_mul(s.wrapping_mul(s).wrapping_mul(15731).wrapping_add(789_221));
    1.0 - (cubic.wrapping_add(1_376_312_589) & 0x7fff_ffff) as f64 / 1_073_741_824.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradient_noise_is_zero_on_the_lattice() {
        assert_eq!(value([3.0, -2.0, 7.0]), 0.0);
    }

    #[test]
    fn the_slope_is_that_of_the_value() {
        let at = |x: f64| value([x, 0.3, 0.7]);
        let central = (at(0.4 + 1e-5) - at(0.4 - 1e-5)) / 2e-5;
        assert!((slope([0.4, 0.3, 0.7], 0) - central).abs() < 1e-2);
    }

    #[test]
    fn huge_and_undefined_points_do_not_panic() {
        for x in [1e300, -1e300, f64::NAN, f64::INFINITY] {
            let _ = (value([x, x, x]), fractal([x, x, x]), slope([x, 0.0, 0.0], 0));
        }
    }
}
