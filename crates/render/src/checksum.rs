//! Hashes of bytes and rays.

use crate::ray_spacing::RaySpacing;
use radsight_accel::Ray;

/// A hash of a set of rays.
pub(crate) fn ray_set(rays: &[Option<Ray>], spread: RaySpacing) -> u64 {
    let mut hash = Checksum::default();
    hash.add(rays.len() as u64);
    [spread.width, spread.angle].iter().for_each(|number| hash.add(number.to_bits()));
    for ray in rays {
        match ray {
            None => hash.add(0),
            Some(ray) => {
                let numbers = [ray.origin.to_array(), ray.direction.to_array()];
                numbers.as_flattened().iter().for_each(|number| hash.add(number.to_bits()));
            }
        }
    }
    hash.0
}

/// A checksum of the bytes of a saved cache.
pub(crate) fn checksum(bytes: &[u8]) -> u64 {
    let mut sum = Checksum::default();
    let (words, rest) = bytes.as_chunks::<8>();
    words.iter().for_each(|word| sum.add(u64::from_le_bytes(*word)));
    rest.iter().for_each(|byte| sum.add(u64::from(*byte)));
    sum.0
}

/// FNV-1a over words: detects accidents, not attacks.
struct Checksum(u64);

impl Default for Checksum {
    fn default() -> Self {
        Checksum(0xcbf2_9ce4_8422_2325)
    }
}

impl Checksum {
    fn add(&mut self, word: u64) {
        self.0 = (self.0.rotate_left(23) ^ word).wrapping_mul(0x0000_0100_0000_01b3);
    }
}
