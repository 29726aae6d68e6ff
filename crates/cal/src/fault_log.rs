//! What went wrong in all evaluations of a program, counted.

use crate::fault::FaultKind;
use crate::program::Host;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

/// The channel of the point's x in Radiance's numbering; y and z come behind it.
const POINT: u32 = 7;

/// Faults of a program, counted by all threads; clones of a program share them.
#[derive(Clone, Debug, Default)]
pub(crate) struct FaultLog(Arc<Counted>);

#[derive(Debug, Default)]
struct Counted {
    count: AtomicU64,
    first: OnceLock<(FaultKind, [f64; 3])>,
}

/// What went wrong in the evaluations of a program so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Faults {
    /// How many evaluations had a fault.
    pub count: u64,
    /// What one of the first was.
    pub kind: FaultKind,
    /// Channels 7 to 9 of that one: the point, where the host numbers its channels as Radiance does.
    pub point: [f64; 3],
}

impl FaultLog {
    #[cold]
    pub(crate) fn note<H: Host + ?Sized>(&self, kind: FaultKind, host: &H) {
        self.0.count.fetch_add(1, Ordering::Relaxed);
        self.0.first.get_or_init(|| (kind, [0, 1, 2].map(|axis| host.channel(POINT + axis))));
    }

    pub(crate) fn read(&self) -> Option<Faults> {
        let (kind, point) = *self.0.first.get()?;
        Some(Faults { count: self.0.count.load(Ordering::Relaxed), kind, point })
    }
}
