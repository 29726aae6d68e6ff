//! Records by place.

use crate::record::{Limits, Record};
use glam::DVec3;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// Records, and where to find those that reach a point.
///
/// Space is divided into cubes of several sizes, halved from one to the next. A record stands in all cubes that it reaches, of the size that is at least
/// twice its reach, so that there are at most eight; a point looks into one cube of each size.
#[derive(Clone, Debug)]
pub struct Cache<const BANDS: usize> {
    limits: Limits,
    records: Vec<Record<BANDS>>,
    levels: Vec<Level>,
}

#[derive(Clone, Debug)]
struct Level {
    side: f64,
    cubes: HashMap<[i32; 3], Vec<u32>, BuildHasherDefault<CubeHasher>>,
}

impl<const BANDS: usize> Cache<BANDS> {
    /// An empty cache.
    #[must_use]
    pub fn new(limits: Limits) -> Self {
        let mut levels = Vec::new();
        let mut side = 2.0 * limits.most;
        while levels.len() < MAX_LEVELS {
            levels.push(Level { side, cubes: HashMap::default() });
            if 0.5 * side < 2.0 * limits.least {
                break;
            }
            side *= 0.5;
        }
        Cache { limits, records: Vec::new(), levels }
    }

    /// How many records there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.records.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    /// What bounds the use of the records.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Adds a record; it and its neighbours restrain each other's reach.
    pub fn insert(&mut self, mut record: Record<BANDS>) {
        let mut near = Vec::new();
        self.visit(record.position, |index| near.push(index));
        for index in &near {
            record.restrain(&self.records[*index as usize]);
        }
        record.scale = record.scale.max(self.limits.least / self.limits.accuracy);
        for index in near {
            // A shrunken record stays in its cubes; it only reaches less of them.
            self.records[index as usize].restrain(&record);
        }
        let reach = record.reach(&self.limits);
        let level = self.levels.iter().rposition(|level| level.side >= 2.0 * reach).unwrap_or(0);
        let index = self.records.len() as u32;
        let level = &mut self.levels[level];
        let low = cube(record.position - DVec3::splat(reach), level.side);
        let high = cube(record.position + DVec3::splat(reach), level.side);
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    level.cubes.entry([x, y, z]).or_default().push(index);
                }
            }
        }
        self.records.push(record);
    }

    /// The irradiance at a point of a surface with this unit normal, on a facet of it that is turned to the unit normal `facet`;
    /// `None` where no record reaches.
    #[must_use]
    pub fn irradiance(&self, position: DVec3, normal: DVec3, facet: DVec3) -> Option<[f64; BANDS]> {
        let mut sum = [0.0; BANDS];
        let mut weights = 0.0;
        self.visit(position, |index| {
            let record = &self.records[index as usize];
            let error = record.error(position, normal, &self.limits);
            if error < 1.0 {
                // Falls to zero at the border of the reach, so that nothing jumps there (Tabellion and Lamorlette 2004).
                let weight = 1.0 - error;
                weights += weight;
                for (sum, value) in sum.iter_mut().zip(record.at(position, facet)) {
                    *sum += weight * value;
                }
            }
        });
        (weights > LEAST_WEIGHT).then(|| sum.map(|band| band / weights))
    }

    fn visit(&self, position: DVec3, mut visit: impl FnMut(u32)) {
        for level in &self.levels {
            if level.cubes.is_empty() {
                continue;
            }
            for index in level.cubes.get(&cube(position, level.side)).into_iter().flatten() {
                visit(*index);
            }
        }
    }
}

/// Sizes of cubes; the smallest one may hold records that would fit a smaller one.
const MAX_LEVELS: usize = 24;

/// Below this total the nearest record is all but out of reach.
const LEAST_WEIGHT: f64 = 1e-4;

fn cube(position: DVec3, side: f64) -> [i32; 3] {
    // Casting saturates, so a far point shares a cube with others, which costs time only.
    (position / side).floor().to_array().map(|coordinate| coordinate as i32)
}

/// Multiplies and mixes: cubes need no defence against chosen keys.
#[derive(Clone, Copy, Debug, Default)]
struct CubeHasher(u64);

impl Hasher for CubeHasher {
    fn finish(&self) -> u64 {
        self.0 ^ (self.0 >> 32)
    }

    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.write_u32(u32::from(*byte));
        }
    }

    fn write_u32(&mut self, value: u32) {
        self.0 = (self.0.rotate_left(5) ^ u64::from(value)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }

    fn write_i32(&mut self, value: i32) {
        self.write_u32(value as u32);
    }

    fn write_usize(&mut self, value: usize) {
        self.write_u32(value as u32);
    }
}
