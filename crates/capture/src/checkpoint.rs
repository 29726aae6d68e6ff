//! The state of an unfinished exposure, which can be saved and resumed with the same bits.

use crate::radiance::bands_apart;
use crate::sums::{Pixel, Sums};
use radsight_adaptive::{MAX_SAMPLES, Replicas, SamplingState};
use radsight_pinhole::{BandWeights, Rays};
use std::fmt;

/// First bytes of every checkpoint, with the version of the format.
const MAGIC: &[u8; 20] = b"radsight checkpoint2";

/// The kind of the state that follows. For an adaptive state the number of separate bands is added.
const FIXED: u8 = 0;
const ADAPTIVE: u8 = 1;

/// An unfinished exposure.
///
/// It does not store the scene, the camera or the seed: [`Checkpoint::to_bytes`] takes a key that
/// identifies them, and [`Checkpoint::from_bytes`] expects the same key.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint(pub(crate) State);

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum State {
    Fixed(FixedState),
    Adaptive {
        state: AdaptiveState,
        /// Number of separate bands; 0 where bands are added up.
        bands: usize,
    },
}

/// A fixed number of rays for every pixel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FixedState {
    pub(crate) samples: u32,
    /// Exposure of each cell of the camera in J/m², by separate band; `None` where it is not known
    /// yet.
    pub(crate) values: Vec<Option<f64>>,
}

/// As many rays as an error needs.
pub(crate) type AdaptiveState = SamplingState<Sums>;

/// Why bytes are not a checkpoint of this exposure.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The bytes have another format, are truncated or differ from what was written.
    Malformed,
    /// The key differs.
    WrongKey,
}

impl fmt::Display for CheckpointError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            CheckpointError::Malformed => "the checkpoint is damaged or incomplete",
            CheckpointError::WrongKey => "it belongs to another scene, camera file, seed or version",
        })
    }
}

impl std::error::Error for CheckpointError {}

impl Checkpoint {
    /// The bytes of a file: magic, key, kind, numbers in little-endian order, and the CRC-32 of all
    /// that.
    #[must_use]
    pub fn to_bytes(&self, key: &[u8; 32]) -> Vec<u8> {
        let mut bytes = [&MAGIC[..], key].concat();
        match &self.0 {
            State::Fixed(state) => {
                bytes.push(FIXED);
                put_u32(&mut bytes, state.samples);
                put_u32(&mut bytes, state.values.len() as u32);
                for value in &state.values {
                    bytes.push(u8::from(value.is_some()));
                    put_f64(&mut bytes, value.unwrap_or(0.0));
                }
            }
            State::Adaptive { state, bands } => {
                bytes.push(ADAPTIVE + *bands as u8);
                put_u32(&mut bytes, state.passes);
                put_u32(&mut bytes, state.pixels.len() as u32);
                for pixel in &state.pixels {
                    put_u32(&mut bytes, pixel.samples);
                    let bands = &pixel.sums.bands[..*bands];
                    [pixel.sums.whole, pixel.last, pixel.before]
                        .iter()
                        .chain(bands)
                        .for_each(|value| put_f64(&mut bytes, *value));
                }
                put_u32(&mut bytes, state.pending.len() as u32);
                state.pending.iter().for_each(|index| put_u32(&mut bytes, *index as u32));
            }
        }
        let checksum = crc32fast::hash(&bytes);
        put_u32(&mut bytes, checksum);
        bytes
    }

    /// Reads the bytes of [`Checkpoint::to_bytes`] with the same key, for a picture of these rays
    /// and band weights.
    pub fn from_bytes(
        bytes: &[u8],
        key: &[u8; 32],
        rays: &Rays,
        weights: &BandWeights,
    ) -> Result<Checkpoint, CheckpointError> {
        let bands = bands_apart(rays, weights);
        let pixels = rays.camera().pixel_count() as usize;
        let counts = [pixels * Replicas::new(pixels, MAX_SAMPLES).count(), rays.cells() as usize];
        Self::of_counts(bytes, key, counts, bands)
    }

    fn of_counts(
        bytes: &[u8],
        key: &[u8; 32],
        [pixels, cells]: [usize; 2],
        bands: usize,
    ) -> Result<Checkpoint, CheckpointError> {
        let mut reader = Reader(bytes);
        let magic: [u8; 20] = reader.take()?;
        if magic != *MAGIC {
            let is_of_another_version = magic[..19] == MAGIC[..19];
            return Err(if is_of_another_version { CheckpointError::WrongKey } else { CheckpointError::Malformed });
        }
        reader.check_sum(bytes)?;
        if reader.take::<32>()? != *key {
            return Err(CheckpointError::WrongKey);
        }
        let state = match reader.take()? {
            [FIXED] => State::Fixed(reader.fixed(cells * bands.max(1))?),
            [kind] if usize::from(kind) == usize::from(ADAPTIVE) + bands => {
                State::Adaptive { state: reader.adaptive(pixels, bands)?, bands }
            }
            _ => return Err(CheckpointError::Malformed),
        };
        if reader.0.is_empty() { Ok(Checkpoint(state)) } else { Err(CheckpointError::Malformed) }
    }
}

fn put_u32(bytes: &mut Vec<u8>, value: u32) {
    bytes.extend(value.to_le_bytes());
}

fn put_f64(bytes: &mut Vec<u8>, value: f64) {
    bytes.extend(value.to_le_bytes());
}

/// Reads numbers from the front of bytes.
struct Reader<'b>(&'b [u8]);

impl Reader<'_> {
    /// Takes the checksum from the end; fails if it is not that of all bytes before it.
    fn check_sum(&mut self, bytes: &[u8]) -> Result<(), CheckpointError> {
        let (rest, sum) = self.0.split_last_chunk::<4>().ok_or(CheckpointError::Malformed)?;
        self.0 = rest;
        let found = crc32fast::hash(&bytes[..bytes.len() - sum.len()]);
        if found == u32::from_le_bytes(*sum) { Ok(()) } else { Err(CheckpointError::Malformed) }
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], CheckpointError> {
        let (first, rest) = self.0.split_first_chunk::<N>().ok_or(CheckpointError::Malformed)?;
        self.0 = rest;
        Ok(*first)
    }

    fn u32(&mut self) -> Result<u32, CheckpointError> {
        self.take().map(u32::from_le_bytes)
    }

    /// Reads a finite number, as all sums of radiance and of squares are.
    fn amount(&mut self) -> Result<f64, CheckpointError> {
        let value = self.take().map(f64::from_le_bytes)?;
        if value.is_finite() { Ok(value) } else { Err(CheckpointError::Malformed) }
    }

    /// Reads the number of pixels, which must be `pixels`.
    fn pixel_count(&mut self, pixels: usize) -> Result<(), CheckpointError> {
        if self.u32()? as usize == pixels { Ok(()) } else { Err(CheckpointError::Malformed) }
    }

    fn fixed(&mut self, pixels: usize) -> Result<FixedState, CheckpointError> {
        let samples = self.u32()?;
        self.pixel_count(pixels)?;
        let value = |_| match (self.take()?, self.amount()?) {
            ([0], _) => Ok(None),
            ([1], value) => Ok(Some(value)),
            _ => Err(CheckpointError::Malformed),
        };
        let values: Result<Vec<_>, _> = (0..pixels).map(value).collect();
        Ok(FixedState { samples, values: values? })
    }

    fn adaptive(&mut self, pixels: usize, bands: usize) -> Result<AdaptiveState, CheckpointError> {
        let passes = self.u32()?;
        self.pixel_count(pixels)?;
        let pixel = |_| {
            let samples = self.u32()?;
            if samples != 0 && !(samples.is_power_of_two() && samples <= MAX_SAMPLES) {
                return Err(CheckpointError::Malformed);
            }
            let [sum, last, before] = [self.amount()?, self.amount()?, self.amount()?];
            let sums = Sums { whole: sum, ..Sums::default() };
            let mut pixel = Pixel { samples, sums, last, before };
            for band in &mut pixel.sums.bands[..bands] {
                *band = self.amount()?;
            }
            Ok(pixel)
        };
        let known: Result<Vec<Pixel>, CheckpointError> = (0..pixels).map(pixel).collect();
        let known = known?;
        let count = self.u32()? as usize;
        let index = |_| match self.u32()? as usize {
            index if known.get(index).is_some_and(|pixel| pixel.samples > 0) => Ok(index),
            _ => Err(CheckpointError::Malformed),
        };
        let pending: Result<Vec<usize>, _> = (0..count).map(index).collect();
        let pending = pending?;
        match pending.is_sorted_by(|before, after| before < after) {
            true => Ok(AdaptiveState { passes, pending, pixels: known }),
            false => Err(CheckpointError::Malformed),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn adaptive() -> Checkpoint {
        with_bands(0)
    }

    fn with_bands(bands: usize) -> Checkpoint {
        let pixel = |samples| {
            let sums = Sums { whole: 0.1 * f64::from(samples), ..Sums::default() };
            let mut pixel = Pixel { samples, sums, last: 1e-9, before: 2e-7 };
            pixel.sums.bands[..bands].iter_mut().zip([0.3, 0.5, 0.7]).for_each(|(sum, value)| *sum = value);
            pixel
        };
        let pixels = vec![pixel(4), pixel(0), pixel(64)];
        Checkpoint(State::Adaptive { state: AdaptiveState { passes: 3, pixels, pending: vec![0, 2] }, bands })
    }

    #[test]
    fn a_checkpoint_stores_separate_bands() {
        let bytes = with_bands(3).to_bytes(&[7; 32]);
        assert_eq!(Checkpoint::of_counts(&bytes, &[7; 32], [3; 2], 3), Ok(with_bands(3)));
        for other in [0, 1, 2] {
            assert_eq!(Checkpoint::of_counts(&bytes, &[7; 32], [3; 2], other), Err(CheckpointError::Malformed));
        }
        let fixed = Checkpoint(State::Fixed(FixedState { samples: 16, values: vec![Some(0.5); 6] })).to_bytes(&[7; 32]);
        assert!(Checkpoint::of_counts(&fixed, &[7; 32], [2; 2], 3).is_ok());
        assert_eq!(Checkpoint::of_counts(&fixed, &[7; 32], [2; 2], 2), Err(CheckpointError::Malformed));
    }

    #[test]
    fn a_checkpoint_is_read_as_it_was_written() {
        let fixed = FixedState { samples: 16, values: vec![Some(1.5e-7), None, Some(0.0)] };
        for checkpoint in [adaptive(), Checkpoint(State::Fixed(fixed))] {
            let bytes = checkpoint.to_bytes(&[7; 32]);
            assert_eq!(Checkpoint::of_counts(&bytes, &[7; 32], [3; 2], 0), Ok(checkpoint));
            assert_eq!(Checkpoint::of_counts(&bytes, &[8; 32], [3; 2], 0), Err(CheckpointError::WrongKey));
            assert_eq!(Checkpoint::of_counts(&bytes, &[7; 32], [4; 2], 0), Err(CheckpointError::Malformed));
        }
    }

    #[test]
    fn truncated_checkpoints_are_refused() {
        let bytes = adaptive().to_bytes(&[7; 32]);
        for length in 0..bytes.len() {
            assert_eq!(
                Checkpoint::of_counts(&bytes[..length], &[7; 32], [3; 2], 0),
                Err(CheckpointError::Malformed),
                "{length}"
            );
        }
        let longer = [&bytes[..], &[0]].concat();
        assert_eq!(Checkpoint::of_counts(&longer, &[7; 32], [3; 2], 0), Err(CheckpointError::Malformed));
    }

    #[test]
    fn checkpoints_with_a_changed_bit_are_refused() {
        let fixed = Checkpoint(State::Fixed(FixedState { samples: 16, values: vec![Some(0.5); 3] }));
        for checkpoint in [adaptive(), fixed] {
            let bytes = checkpoint.to_bytes(&[7; 32]);
            for bit in 0..8 * bytes.len() {
                let mut damaged = bytes.clone();
                damaged[bit / 8] ^= 1 << (bit % 8);
                assert!(Checkpoint::of_counts(&damaged, &[7; 32], [3; 2], 0).is_err(), "bit {bit}");
            }
        }
    }

    #[test]
    fn checkpoints_of_another_version_say_so() {
        let mut bytes = adaptive().to_bytes(&[7; 32]);
        bytes[19] = b'1';
        assert_eq!(Checkpoint::of_counts(&bytes, &[7; 32], [3; 2], 0), Err(CheckpointError::WrongKey));
    }

    #[test]
    fn a_pending_pixel_without_samples_is_refused() {
        let Checkpoint(State::Adaptive { mut state, bands }) = adaptive() else { unreachable!() };
        state.pending = vec![1];
        let bytes = Checkpoint(State::Adaptive { state, bands }).to_bytes(&[7; 32]);
        assert_eq!(Checkpoint::of_counts(&bytes, &[7; 32], [3; 2], 0), Err(CheckpointError::Malformed));
    }
}
