//! Shared memory between the program and a worker: channels with room for one question and its
//! answer.

use super::Question;
use crate::functions::RawSample;
use glam::DVec3;
use radsight_brdf_abi::Status;
use rustix::fd::{AsFd, OwnedFd};
use rustix::mm::{MapFlags, ProtFlags};
use rustix::thread::futex;
use std::io;
use std::sync::atomic::{AtomicU32, Ordering};

/// Maximum number of directions of a question.
const MOST_DIRECTIONS: usize = 64;
/// Maximum number of bands of a question.
pub(super) const MOST_BANDS: usize = 512;
/// Maximum number of values of a question and its answer: outgoing direction, incident directions,
/// values, densities.
const MOST_NUMBERS: usize = 3 + MOST_DIRECTIONS * (3 + MOST_BANDS + 1);
const HEAD_BYTES: usize = size_of::<Head>();
const PAGE_BYTES: usize = 4096;
const CHANNEL_BYTES: usize = (HEAD_BYTES + MOST_NUMBERS * size_of::<f64>()).next_multiple_of(PAGE_BYTES);

/// Header of a channel.
#[repr(C, align(128))]
struct Head {
    /// One of [`state`].
    state: AtomicU32,
    program_sleeps: AtomicU32,
    worker_sleeps: AtomicU32,
    /// One of [`function`].
    function: AtomicU32,
    instance: AtomicU32,
    count: AtomicU32,
    bands: AtomicU32,
    status: AtomicU32,
    sample_kind: AtomicU32,
    /// Processor of the asking thread.
    processor: AtomicU32,
}

mod state {
    pub(super) const ASKED: u32 = 1;
    pub(super) const ANSWERED: u32 = 2;
}

mod function {
    pub(super) const EVAL: u32 = 0;
    pub(super) const SAMPLE: u32 = 1;
}

/// The shared mapping. It stays until the process ends, since threads wait in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct SharedMemory {
    base: *mut u8,
    channels: usize,
}

// SAFETY: it is memory that stays, and what is shared in it is atomic or handed over by an atomic.
unsafe impl Send for SharedMemory {}
// SAFETY: as above.
unsafe impl Sync for SharedMemory {}

impl SharedMemory {
    /// Creates zeroed memory for `channels` channels; returns it with the descriptor by which
    /// another process maps it.
    pub(super) fn make(channels: usize) -> io::Result<(SharedMemory, OwnedFd)> {
        let file = rustix::fs::memfd_create("radsight-plugin", rustix::fs::MemfdFlags::CLOEXEC)?;
        rustix::fs::ftruncate(&file, Self::bytes(channels) as u64)?;
        Ok((Self::map(&file, channels)?, file))
    }

    /// Maps the memory of another process.
    pub(super) fn map(file: impl AsFd, channels: usize) -> io::Result<SharedMemory> {
        let access = ProtFlags::READ | ProtFlags::WRITE;
        // SAFETY: a fresh mapping that nothing else in this process knows; it is never undone.
        let base = unsafe {
            rustix::mm::mmap(std::ptr::null_mut(), Self::bytes(channels), access, MapFlags::SHARED, file, 0)?
        };
        Ok(SharedMemory { base: base.cast(), channels })
    }

    const fn bytes(channels: usize) -> usize {
        PAGE_BYTES + channels * CHANNEL_BYTES
    }

    /// Number of messages that the worker has written.
    pub(super) fn spoken(&self) -> &'static AtomicU32 {
        // SAFETY: the mapping begins with it and stays; zero is a valid number.
        unsafe { &*self.base.cast::<AtomicU32>() }
    }

    /// Counter that advances while the worker makes calls to answer a request of the socket.
    pub(super) fn progress(&self) -> &'static AtomicU32 {
        // SAFETY: as for `spoken`, behind which it is.
        unsafe { &*self.base.cast::<AtomicU32>().add(1) }
    }

    pub(super) fn channel(&self, index: usize) -> Channel {
        assert!(index < self.channels, "the channel exists");
        // SAFETY: inside of the mapping, whose layout this is; zero is a valid head, and all of it
        // is atomic.
        unsafe {
            let start = self.base.add(PAGE_BYTES + index * CHANNEL_BYTES);
            Channel { head: &*start.cast::<Head>(), numbers: start.add(HEAD_BYTES).cast() }
        }
    }
}

/// A channel for one question at a time. Its values belong to the program until it has asked, then
/// to the worker until it has answered.
#[derive(Clone, Copy)]
pub(super) struct Channel {
    head: &'static Head,
    numbers: *mut f64,
}

// SAFETY: as for `SharedMemory`.
unsafe impl Send for Channel {}

/// A question, as the worker finds it in a channel.
pub(super) enum Call {
    Eval { outgoing: DVec3, incident: [&'static [f64]; 3], values: &'static mut [f64], pdfs: &'static mut [f64] },
    Sample { outgoing: DVec3, u: [f64; 3], weights: &'static mut [f64] },
}

impl Channel {
    /// The program's side of `eval_pdf`.
    pub(super) fn eval(&self, instance: u32, question: Question<'_>, values: &mut [f64], pdfs: &mut [f64]) -> Status {
        let count = pdfs.len();
        let bands = values.len().checked_div(count).unwrap_or(0);
        let mut at = self.put(0, &question.outgoing.to_array());
        for axis in question.incident {
            at = self.put(at, axis);
        }
        // Values that a plugin does not write are detected as NaN here too.
        self.put(self.put(at, values), pdfs);
        self.ask(function::EVAL, instance, count, bands);
        self.take(self.take(at, values), pdfs);
        self.head.status.load(Ordering::Relaxed)
    }

    /// The program's side of `sample`.
    pub(super) fn sample(
        &self,
        instance: u32,
        outgoing: DVec3,
        u: [f64; 3],
        weights: &mut [f64],
    ) -> (Status, RawSample) {
        let mut sampled = RawSample::NOTHING;
        let at = self.put(self.put(0, &outgoing.to_array()), &u);
        self.put(at, weights);
        self.ask(function::SAMPLE, instance, 1, weights.len());
        let at = self.take(at, weights);
        self.take(self.take(at, &mut sampled.incident), std::slice::from_mut(&mut sampled.pdf));
        sampled.kind = u8::try_from(self.head.sample_kind.load(Ordering::Relaxed)).unwrap_or(u8::MAX);
        (self.head.status.load(Ordering::Relaxed), sampled)
    }

    fn ask(&self, function: u32, instance: u32, count: usize, bands: usize) {
        let head = self.head;
        head.function.store(function, Ordering::Relaxed);
        head.instance.store(instance, Ordering::Relaxed);
        head.count.store(count as u32, Ordering::Relaxed);
        head.bands.store(bands as u32, Ordering::Relaxed);
        head.processor.store(rustix::thread::sched_getcpu() as u32, Ordering::Relaxed);
        hand_over(&head.state, state::ASKED, &head.worker_sleeps);
        wait_for(&head.state, state::ANSWERED, &head.program_sleeps);
    }

    /// Waits for the next question: the instance and the call. `processor` is the processor of this
    /// thread, which follows the asking thread: only one of the two runs at a time, and waking a
    /// thread on another processor takes longer.
    pub(super) fn next_question(&self, processor: &mut Option<u32>) -> (u32, Call) {
        let head = self.head;
        wait_for(&head.state, state::ASKED, &head.worker_sleeps);
        let of_program = head.processor.load(Ordering::Relaxed);
        if *processor != Some(of_program) {
            *processor = Some(of_program);
            follow(of_program);
        }
        let (count, bands) = (head.count.load(Ordering::Relaxed) as usize, head.bands.load(Ordering::Relaxed) as usize);
        let outgoing = DVec3::from_slice(self.part(0, 3));
        let call = if head.function.load(Ordering::Relaxed) == function::SAMPLE {
            let u = self.part(3, 3);
            Call::Sample { outgoing, u: [u[0], u[1], u[2]], weights: self.part(6, bands) }
        } else {
            let values_at = 3 + 3 * count;
            Call::Eval {
                outgoing,
                incident: [0, 1, 2].map(|axis| &*self.part(3 + axis * count, count)),
                values: self.part(values_at, count * bands),
                pdfs: self.part(values_at + count * bands, count),
            }
        };
        (head.instance.load(Ordering::Relaxed), call)
    }

    /// Answers a question; the buffers of its call must not be used afterwards. `sampled` is the
    /// result of `sample`.
    pub(super) fn answer(&self, status: Status, sampled: Option<RawSample>) {
        let head = self.head;
        head.status.store(status, Ordering::Relaxed);
        if let Some(sampled) = sampled {
            let at = 6 + head.bands.load(Ordering::Relaxed) as usize;
            self.put(self.put(at, &sampled.incident), &[sampled.pdf]);
            head.sample_kind.store(u32::from(sampled.kind), Ordering::Relaxed);
        }
        hand_over(&head.state, state::ANSWERED, &head.program_sleeps);
    }

    /// Writes numbers and returns the position after them.
    fn put(&self, at: usize, numbers: &[f64]) -> usize {
        let end = at + numbers.len();
        assert!(end <= MOST_NUMBERS, "a question fits into its channel");
        // SAFETY: inside of the channel, whose numbers are this side's now.
        unsafe { std::ptr::copy_nonoverlapping(numbers.as_ptr(), self.numbers.add(at), numbers.len()) };
        end
    }

    /// Reads numbers and returns the position after them.
    fn take(&self, at: usize, numbers: &mut [f64]) -> usize {
        let end = at + numbers.len();
        assert!(end <= MOST_NUMBERS, "an answer fits into its channel");
        // SAFETY: as in `put`. Whatever bits a plugin left are numbers.
        unsafe { std::ptr::copy_nonoverlapping(self.numbers.add(at), numbers.as_mut_ptr(), numbers.len()) };
        end
    }

    /// A part of the numbers, owned by the worker until it answers. Parts in simultaneous use do
    /// not overlap.
    fn part(&self, at: usize, length: usize) -> &'static mut [f64] {
        assert!(at + length <= MOST_NUMBERS, "a question fits into its channel");
        // SAFETY: inside of the channel, whose numbers are the worker's now; the mapping stays.
        unsafe { std::slice::from_raw_parts_mut(self.numbers.add(at), length) }
    }
}

/// Moves this thread to a processor, if the system permits it.
fn follow(processor: u32) {
    let mut set = rustix::thread::CpuSet::new();
    if (processor as usize) < rustix::thread::CpuSet::MAX_CPU {
        set.set(processor as usize);
        let _ = rustix::thread::sched_setaffinity(None, &set);
    }
}

/// Changes the state, and wakes the other side if it sleeps.
fn hand_over(state: &AtomicU32, value: u32, other_sleeps: &AtomicU32) {
    state.store(value, Ordering::SeqCst);
    if other_sleeps.load(Ordering::SeqCst) != 0 {
        let _ = futex::wake(state, futex::Flags::empty(), 1);
    }
}

/// Sleeps until the other side changes the state. Both run on the same processor, so spinning would
/// gain nothing.
fn wait_for(state: &AtomicU32, wanted: u32, sleeps: &AtomicU32) {
    sleeps.store(1, Ordering::SeqCst);
    loop {
        let found = state.load(Ordering::SeqCst);
        if found == wanted {
            break;
        }
        // The call returns at once if the state has changed in the meantime.
        let _ = futex::wait(state, futex::Flags::empty(), found, None);
    }
    sleeps.store(0, Ordering::SeqCst);
}

#[cfg(test)]
mod tests {
    use super::*;
    use radsight_brdf_abi::status;

    #[test]
    fn questions_and_answers_keep_every_bit() {
        let (memory, file) = SharedMemory::make(2).unwrap();
        let other = SharedMemory::map(&file, 2).unwrap();
        let worker = std::thread::spawn(move || {
            let channel = other.channel(1);
            let mut processor = None;
            for _ in 0..100 {
                let (instance, call) = channel.next_question(&mut processor);
                match call {
                    Call::Eval { outgoing, incident: [x, y, z], values, pdfs } => {
                        for (index, value) in values.iter_mut().enumerate() {
                            assert!(value.is_nan());
                            *value = outgoing.x + x[index % x.len()] + f64::from(instance);
                        }
                        pdfs.iter_mut().zip(y.iter().zip(z)).for_each(|(pdf, (y, z))| *pdf = y - z);
                        channel.answer(status::OK, None);
                    }
                    Call::Sample { u, weights, .. } => {
                        weights.fill(u[2]);
                        let sampled = RawSample { incident: [0.1, u[0], u[1]], pdf: f64::INFINITY, kind: 2 };
                        channel.answer(status::PANIC, Some(sampled));
                    }
                }
            }
        });
        let channel = memory.channel(1);
        for round in 0..50 {
            let x: Vec<f64> = (0..64).map(|i| f64::from(i) / 3.0).collect();
            let (mut values, mut pdfs) = (vec![f64::NAN; 64 * 3], vec![f64::NAN; 64]);
            let question = Question { outgoing: DVec3::new(0.1, 0.2, 0.3), incident: [&x, &x, &x] };
            assert_eq!(channel.eval(round, question, &mut values, &mut pdfs), status::OK);
            assert_eq!(values[65], 0.1 + x[1] + f64::from(round));
            assert_eq!(pdfs, [0.0; 64]);
            let mut weights = [f64::NAN; 3];
            let (found, sampled) = channel.sample(round, DVec3::Z, [0.25, -0.0, 0.7], &mut weights);
            assert_eq!((found, weights, sampled.kind), (status::PANIC, [0.7; 3], 2));
            assert_eq!(sampled.incident.map(f64::to_bits), [0.1, 0.25, -0.0].map(f64::to_bits));
            assert_eq!(sampled.pdf, f64::INFINITY);
        }
        worker.join().unwrap();
    }
}
